//! Zip archives as their structure, so that each part of it can lie.

use fastrand::Rng;

use crate::texts::change_bytes;

/// An entry as the archive says it, twice: before the content and in the directory at the end.
#[derive(Clone)]
pub struct Entry {
    name: Vec<u8>,
    /// Name before the content, where it is another one.
    local_name: Option<Vec<u8>>,
    flags: u16,
    method: u16,
    crc: u32,
    size: u32,
    packed_size: u32,
    packed: Vec<u8>,
    /// System that the attributes are of, and these.
    made_by: u16,
    attributes: u32,
    extra: Vec<u8>,
    /// Place that the directory says, where it is another one.
    offset: Option<u32>,
}

/// An archive.
#[derive(Clone)]
pub struct Archive {
    pub entries: Vec<Entry>,
    /// Number of entries that the end says, where it is another one.
    count: Option<u16>,
    comment: Vec<u8>,
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap())
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

impl Entry {
    /// A stored entry.
    pub fn stored(name: &str, content: &[u8]) -> Self {
        Self {
            name: name.as_bytes().to_vec(),
            local_name: None,
            flags: 0,
            method: 0,
            crc: crc32fast::hash(content),
            size: content.len() as u32,
            packed_size: content.len() as u32,
            packed: content.to_vec(),
            made_by: 0x0314,
            attributes: 0o100_644 << 16,
            extra: Vec::new(),
            offset: None,
        }
    }

    pub fn name(&self) -> String {
        String::from_utf8_lossy(&self.name).into_owned()
    }

    fn header(&self, name: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for number in [20, self.flags, self.method, 0, 0x21] {
            bytes.extend(number.to_le_bytes());
        }
        for number in [self.crc, self.packed_size, self.size] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend((self.extra.len() as u16).to_le_bytes());
        bytes
    }
}

impl Archive {
    /// Structure of an intact archive without 64-bit extensions.
    pub fn parsed(bytes: &[u8]) -> Self {
        let end = (0..=bytes.len() - 22)
            .rev()
            .find(|at| bytes[*at..].starts_with(b"PK\x05\x06"))
            .unwrap();
        let (count, mut at) = (u16_at(bytes, end + 10), u32_at(bytes, end + 16) as usize);
        let mut entries = Vec::new();
        for _ in 0..count {
            let lengths = [28, 30, 32].map(|field| usize::from(u16_at(bytes, at + field)));
            let packed_size = u32_at(bytes, at + 20);
            let local = u32_at(bytes, at + 42) as usize;
            let begin = local + 30 + usize::from(u16_at(bytes, local + 26)) + usize::from(u16_at(bytes, local + 28));
            entries.push(Entry {
                name: bytes[at + 46..at + 46 + lengths[0]].to_vec(),
                local_name: None,
                flags: u16_at(bytes, at + 8) & !8,
                method: u16_at(bytes, at + 10),
                crc: u32_at(bytes, at + 16),
                size: u32_at(bytes, at + 24),
                packed_size,
                packed: bytes[begin..begin + packed_size as usize].to_vec(),
                made_by: u16_at(bytes, at + 4),
                attributes: u32_at(bytes, at + 38),
                extra: Vec::new(),
                offset: None,
            });
            at += 46 + lengths.iter().sum::<usize>();
        }
        Self {
            entries,
            count: None,
            comment: Vec::new(),
        }
    }

    pub fn to_bytes(&self) -> Vec<u8> {
        let (mut bytes, mut directory) = (Vec::new(), Vec::new());
        for entry in &self.entries {
            let offset = entry.offset.unwrap_or(bytes.len() as u32);
            let local_name = entry.local_name.as_ref().unwrap_or(&entry.name);
            bytes.extend(b"PK\x03\x04");
            bytes.extend(entry.header(local_name));
            bytes.extend(local_name);
            bytes.extend(&entry.extra);
            bytes.extend(&entry.packed);
            directory.extend(b"PK\x01\x02");
            directory.extend(entry.made_by.to_le_bytes());
            directory.extend(entry.header(&entry.name));
            directory.extend([0; 6]);
            directory.extend(entry.attributes.to_le_bytes());
            directory.extend(offset.to_le_bytes());
            directory.extend(&entry.name);
            directory.extend(&entry.extra);
        }
        let begin = bytes.len() as u32;
        bytes.extend(&directory);
        bytes.extend(b"PK\x05\x06\0\0\0\0");
        let count = self.count.unwrap_or(self.entries.len() as u16);
        bytes.extend([count.to_le_bytes(), count.to_le_bytes()].concat());
        bytes.extend((directory.len() as u32).to_le_bytes());
        bytes.extend(begin.to_le_bytes());
        bytes.extend((self.comment.len() as u16).to_le_bytes());
        bytes.extend(&self.comment);
        bytes
    }

    /// Replaces an entry or adds one.
    pub fn put(&mut self, name: &str, content: &[u8]) {
        let entry = Entry::stored(name, content);
        match self.entries.iter_mut().find(|entry| entry.name == name.as_bytes()) {
            Some(place) => *place = entry,
            None => self.entries.push(entry),
        }
    }

    /// Changes one thing of the structure; `escape` is the name of a file that no archive may make.
    pub fn change(&mut self, rng: &mut Rng, escape: &str) {
        if self.entries.is_empty() {
            return;
        }
        let last = self.entries.len() - 1;
        let other = self.entries[rng.usize(..=last)].clone();
        let index = rng.usize(..=last);
        let entry = &mut self.entries[index];
        let number = [0, 1, 100, 1 << 20, 1 << 31, u32::MAX, u32::MAX - 1, rng.u32(..)][rng.usize(..8)];
        match rng.u8(..20) {
            0 => drop(self.entries.remove(index)),
            1 => {
                let again = entry.clone();
                self.entries.push(again);
            }
            2 => entry.name = odd_name(rng, escape, &other.name),
            3 => entry.local_name = Some(odd_name(rng, escape, &other.name)),
            4 => entry.size = number,
            5 => entry.packed_size = number,
            6 => entry.crc ^= 1 << rng.u32(..32),
            7 => entry.method = [0, 8, 9, 12, 14, 93, 99, u16::MAX][rng.usize(..8)],
            8 => entry.flags = [1, 8, 1 << 11, 1 << 13, u16::MAX][rng.usize(..5)],
            9 => {
                let kinds = [
                    0o120_777, 0o010_644, 0o020_644, 0o060_644, 0o040_755, 0o140_644, 0o104_755,
                ];
                entry.attributes = kinds[rng.usize(..7)] << 16;
                entry.packed = format!("../../{escape}").into_bytes();
                (entry.size, entry.packed_size) = (entry.packed.len() as u32, entry.packed.len() as u32);
                (entry.method, entry.crc) = (0, crc32fast::hash(&entry.packed));
            }
            10 => entry.offset = Some(number),
            11 => entry.offset = Some(0),
            12 => change_bytes(rng, &mut entry.packed),
            13 => entry.packed.clear(),
            14 => entry.extra = vec![[0x55, 0x01, 0x75, 0xff][rng.usize(..4)]; rng.usize(..40)],
            15 => self.count = Some([0, 1, u16::MAX, u16::MAX - 1][rng.usize(..4)]),
            16 => self.comment = b"PK\x05\x06".repeat(rng.usize(1..9)),
            17 => {
                // A link, and a file that would come to lie behind it.
                let mut link = Entry::stored("link", format!("/{escape}").as_bytes());
                link.attributes = 0o120_777 << 16;
                let within = Entry::stored(&format!("link/{escape}"), b"escaped");
                self.entries.splice(0..0, [link, within]);
            }
            18 => {
                let many = (0..1 << rng.u32(..14)).map(|number| Entry::stored(&format!("many/{number}"), b""));
                self.entries.extend(many);
            }
            _ => {
                let (a, b) = (index, rng.usize(..=last));
                self.entries.swap(a, b);
            }
        }
    }
}

/// A name that leads elsewhere, or means something else on other systems.
fn odd_name(rng: &mut Rng, escape: &str, other: &[u8]) -> Vec<u8> {
    match rng.u8(..16) {
        0 => format!("../{escape}").into_bytes(),
        1 => format!("../../../../../../../../tmp/{escape}").into_bytes(),
        2 => format!("/tmp/{escape}").into_bytes(),
        3 => format!("resources/../../{escape}").into_bytes(),
        4 => format!("..\\{escape}").into_bytes(),
        5 => format!("C:\\{escape}").into_bytes(),
        6 => other.to_ascii_uppercase(),
        7 => [other, b"/"].concat(),
        8 => [other, b"/below"].concat(),
        9 => Vec::new(),
        10 => b"a\x07\x1b[31mb".to_vec(),
        11 => b"\xff\xfe".to_vec(),
        12 => b"a\0b".to_vec(),
        13 => vec![b'a'; 300],
        14 => b"d/".repeat(2000),
        _ => other.to_vec(),
    }
}
