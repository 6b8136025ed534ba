use super::frame::{Malformed, Reader, Receiver, Writer};
use super::protocol::Code;

fn frame(write: impl FnOnce(&mut Writer)) -> Vec<u8> {
    let (mut writer, mut bytes) = (Writer::new(), Vec::new());
    write(&mut writer);
    writer.send(&mut bytes).unwrap();
    bytes
}

#[test]
fn values_are_read_as_they_were_written_bit_for_bit() {
    let nan = f64::from_bits(0x7ff8_0000_dead_beef);
    let bytes = frame(|frame| {
        frame.u8(7);
        frame.f64s(&[-0.0, 5e-324, nan]);
        frame.i32s(&[i32::MIN]);
        frame.u32s(&[u32::MAX, 0]);
        frame.text("ü");
        frame.u64(u64::MAX);
    });
    assert_eq!(
        bytes[..5],
        [bytes.len() as u8 - 4, 0, 0, 0, 7],
        "the length is little-endian"
    );
    let mut reader = Reader::new(&bytes[4..]);
    let (mut reals, mut integers, mut references) = (Vec::new(), Vec::new(), Vec::new());
    assert_eq!(reader.u8(), Ok(7));
    reader.f64s(&mut reals).unwrap();
    reader.i32s(&mut integers).unwrap();
    reader.u32s(&mut references).unwrap();
    assert_eq!(reader.text(), Ok("ü"));
    assert_eq!(reader.u64(), Ok(u64::MAX));
    let bits: Vec<u64> = reals.iter().map(|value| value.to_bits()).collect();
    assert_eq!(bits, [(-0.0_f64).to_bits(), 1, nan.to_bits()]);
    assert_eq!((integers, references), (vec![i32::MIN], vec![u32::MAX, 0]));
    assert_eq!(reader.u8(), Err(Malformed), "there is no more");
}

#[test]
fn a_list_longer_than_its_frame_is_refused_before_memory_is_taken_for_it() {
    let bytes = u32::MAX.to_le_bytes();
    assert_eq!(Reader::new(&bytes).f64s(&mut Vec::new()), Err(Malformed));
    assert_eq!(Reader::new(&bytes).bytes(), Err(Malformed));
}

#[test]
fn frames_are_found_however_they_arrive() {
    /// Gives one byte at a time.
    struct Slow<'a>(&'a [u8]);
    impl std::io::Read for Slow<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            let Some((first, rest)) = self.0.split_first() else {
                return Ok(0);
            };
            (into[0], self.0) = (*first, rest);
            Ok(1)
        }
    }
    let long = vec![3; 200_000];
    let mut bytes = frame(|frame| frame.u8(1));
    bytes.extend(frame(|frame| frame.bytes(&long)));
    bytes.extend(frame(|_| ()));
    let content = |length: usize| {
        let mut content = (length as u32).to_le_bytes().to_vec();
        content.resize(length + 4, 3);
        content
    };
    let mut slow = Receiver::new(Slow(&bytes));
    let mut fast = Receiver::new(&bytes[..]);
    for expected in [Some(vec![1]), Some(content(200_000)), Some(Vec::new()), None] {
        assert_eq!(slow.receive().unwrap().map(<[u8]>::to_vec), expected);
        assert_eq!(fast.receive().unwrap().map(<[u8]>::to_vec), expected);
    }
    let mut endless = Receiver::new(&[0xff; 8][..]);
    assert!(endless.receive().is_err(), "a length beyond any frame");
}

/// The length of a frame took as much memory before a byte of it had come.
#[test]
fn regress_35_memory_is_taken_for_what_has_come_of_a_frame_and_not_for_what_is_said() {
    let bytes = [&(1_u32 << 30).to_le_bytes()[..], &[3; 200_000]].concat();
    let mut receiver = Receiver::new(&bytes[..]);
    assert!(receiver.receive().unwrap().is_none(), "it is cut off");
    assert!(receiver.room() < 1 << 20, "{}", receiver.room());
}

#[test]
fn every_code_is_its_own_byte() {
    for byte in 0..=u8::MAX {
        if let Some(code) = Code::from_byte(byte) {
            assert_eq!(code as u8, byte);
        }
    }
}
