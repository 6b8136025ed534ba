use super::note::Note;
use super::report::{Ending, Obituary, Text, obituary, sentence};
use std::time::Duration;

fn number(value: f64) -> String {
    let mut text = Text::new();
    text.number(value);
    String::from_utf8(text.bytes().to_vec()).unwrap()
}

#[test]
fn numbers_are_written_with_six_decimals_at_most() {
    for (value, expected) in [
        (0.0, "0"),
        (0.05, "0.05"),
        (12.345_678_9, "12.345679"),
        (-2.5, "-2.5"),
        (60.0, "60"),
        (1e-9, "0"),
    ] {
        assert_eq!(number(value), expected);
    }
}

#[test]
fn a_call_can_be_seen_only_while_it_is_under_way() {
    let note = Note::taken("pantograph 1 (Vendor)", None);
    assert!(note.call().is_none());
    note.at(0.25);
    note.during("fmi2DoStep", || {
        let call = note.call().expect("it is under way");
        assert_eq!((call.function, call.time), ("fmi2DoStep", 0.25));
        let words = sentence(&call, Ending::Signal(11));
        let words = String::from_utf8(words.bytes().to_vec()).unwrap();
        assert!(
            words.starts_with("error: pantograph 1 (Vendor): fmi2DoStep at t = 0.25 s crashed with "),
            "{words}"
        );
        assert!(words.contains("isolate = true"), "{words}");
    });
    assert!(note.call().is_none());
    note.release();
}

#[test]
fn an_obituary_is_read_as_it_was_written() {
    let note = Note::taken("x", Some(Duration::from_secs(1000)));
    note.during("fmi2Reset", || {
        let words = obituary(&note.call().unwrap(), Ending::Exit(3));
        let (length, rest) = words.bytes().split_at(4);
        assert_eq!(u32::from_le_bytes(length.try_into().unwrap()) as usize, rest.len());
        let read = Obituary::from_bytes(rest).unwrap();
        let expected = Obituary {
            ending: Ending::Exit(3),
            time: None,
            function: "fmi2Reset".to_owned(),
        };
        assert_eq!(read, expected);
        assert_eq!(Obituary::from_bytes(&rest[..13]), None);
    });
    note.release();
}

#[test]
fn a_label_is_cut_between_characters() {
    let note = Note::taken(&"ü".repeat(200), None);
    let mut label = [0; 256];
    let length = note.label(&mut label);
    assert_eq!(std::str::from_utf8(&label[..length]).unwrap(), "ü".repeat(120));
    note.release();
}
