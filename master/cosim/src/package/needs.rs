//! Needs of a shared library from the system that loads it, read from its own tables.

use std::collections::BTreeSet;

/// Dynamic section, [ELF-64 Object File Format 1.5, tables 16 and 17; Linux Standard Base 5.0, 10.7 for the versions].
const PT_LOAD: u32 = 1;
const PT_DYNAMIC: u32 = 2;
const DT_NEEDED: u64 = 1;
const DT_STRTAB: u64 = 5;
const DT_VERNEED: u64 = 0x6fff_fffe;
const DT_VERNEEDNUM: u64 = 0x6fff_ffff;

/// Most entries of a list that are read: a damaged table is not followed for ever.
const MOST: u64 = 10_000;

/// Libraries and versions that the dynamic linker looks for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Needs {
    /// File names of shared libraries, in the binary's order.
    pub libraries: Vec<String>,
    /// Names of symbol versions, such as `GLIBC_2.34`.
    pub versions: BTreeSet<String>,
}

impl Needs {
    /// Reads a 64-bit little-endian ELF library; `None` for anything else, and for tables that do not hold together.
    #[must_use]
    pub fn of(library: &[u8]) -> Option<Self> {
        let file = File(library);
        if library.get(..6)? != b"\x7fELF\x02\x01" {
            return None;
        }
        let (table, size, count) = (file.u64(32)?, u64::from(file.u16(54)?), u64::from(file.u16(56)?));
        let headers: Option<Vec<Segment>> = (0..count)
            .map(|k| file.segment(table.saturating_add(k * size)))
            .collect();
        let headers = headers?;
        let dynamic = headers.iter().find(|segment| segment.kind == PT_DYNAMIC)?;
        let mut entries = Vec::new();
        for k in 0..(dynamic.size / 16).min(MOST) {
            let at = dynamic.offset.saturating_add(16 * k);
            match file.u64(at)? {
                0 => break,
                tag => entries.push((tag, file.u64(at.saturating_add(8))?)),
            }
        }
        let value = |tag: u64| entries.iter().find(|entry| entry.0 == tag).map(|entry| entry.1);
        let offset = |address: u64| {
            let holds = |segment: &&Segment| {
                segment.kind == PT_LOAD
                    && (segment.address..segment.address.saturating_add(segment.size)).contains(&address)
            };
            let segment = headers.iter().find(holds)?;
            segment.offset.checked_add(address - segment.address)
        };
        let strings = offset(value(DT_STRTAB)?)?;
        let needed = entries.iter().filter(|entry| entry.0 == DT_NEEDED);
        let libraries = needed
            .map(|entry| file.text(strings.saturating_add(entry.1)))
            .collect::<Option<_>>()?;
        let mut versions = BTreeSet::new();
        if let (Some(address), Some(count)) = (value(DT_VERNEED), value(DT_VERNEEDNUM)) {
            let mut at = offset(address)?;
            for _ in 0..count.min(MOST) {
                let mut version = at + u64::from(file.u32(at + 8)?);
                for _ in 0..file.u16(at + 2)? {
                    versions.insert(file.text(strings + u64::from(file.u32(version + 8)?))?);
                    version += u64::from(file.u32(version + 12)?);
                }
                at += u64::from(file.u32(at + 12)?);
            }
        }
        Some(Self { libraries, versions })
    }

    /// The oldest GNU C library that has all symbols: major and minor number.
    #[must_use]
    pub fn glibc(&self) -> Option<(u32, u32)> {
        let numbers = |version: &String| {
            let mut parts = version.strip_prefix("GLIBC_")?.split('.').map(str::parse);
            Some((parts.next()?.ok()?, parts.next()?.ok()?))
        };
        self.versions.iter().filter_map(numbers).max()
    }
}

/// A program header.
struct Segment {
    kind: u32,
    offset: u64,
    address: u64,
    size: u64,
}

struct File<'a>(&'a [u8]);

impl File<'_> {
    fn bytes<const N: usize>(&self, at: u64) -> Option<[u8; N]> {
        let at = usize::try_from(at).ok()?;
        self.0.get(at..at.checked_add(N)?)?.try_into().ok()
    }

    fn u16(&self, at: u64) -> Option<u16> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    fn u32(&self, at: u64) -> Option<u32> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    fn u64(&self, at: u64) -> Option<u64> {
        self.bytes(at).map(u64::from_le_bytes)
    }

    fn segment(&self, at: u64) -> Option<Segment> {
        at.checked_add(40)?;
        Some(Segment {
            kind: self.u32(at)?,
            offset: self.u64(at + 8)?,
            address: self.u64(at + 16)?,
            size: self.u64(at + 32)?,
        })
    }

    fn text(&self, at: u64) -> Option<String> {
        let rest = self.0.get(usize::try_from(at).ok()?..)?;
        let end = rest.iter().position(|&byte| byte == 0)?;
        String::from_utf8(rest[..end].to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_version_counts_by_number_and_not_by_letter() {
        let versions = ["GLIBC_2.9", "GLIBC_2.34", "GLIBC_2.3.4", "GCC_4.2.0", "GLIBC_PRIVATE"];
        let needs = Needs {
            libraries: Vec::new(),
            versions: versions.map(str::to_owned).into(),
        };
        assert_eq!(needs.glibc(), Some((2, 34)));
        assert_eq!(Needs::default().glibc(), None);
    }

    #[test]
    fn what_is_no_elf_library_needs_nothing_that_is_known() {
        for bytes in [&b""[..], b"MZ\x90\x00", b"\x7fELF\x02\x01", &[0x7f; 4096]] {
            assert_eq!(Needs::of(bytes), None);
        }
    }

    #[test]
    #[cfg(all(
        target_os = "linux",
        target_pointer_width = "64",
        target_endian = "little",
        target_env = "gnu"
    ))]
    fn this_very_program_needs_the_c_library_and_a_cut_copy_of_it_does_not_crash() {
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let needs = Needs::of(&program).unwrap();
        assert!(needs.libraries.iter().any(|name| name == "libc.so.6"), "{needs:?}");
        assert!(needs.glibc().unwrap() >= (2, 2), "{needs:?}");
        for length in [64, 100, 1000] {
            assert_eq!(Needs::of(&program[..length]), None, "{length} bytes");
        }
    }
}
