//! Archives and model descriptions that are refused, each with its message.

mod support;

use fmi2::archive::Limits;
use fmi2::import::{Fmu, Options};
use std::io::{Cursor, Write};
use std::path::Path;

/// A zip entry as it is, right or wrong.
struct Entry<'a> {
    name: &'a str,
    content: &'a [u8],
    method: u16,
    flags: u16,
    mode: u32,
}

fn entry<'a>(name: &'a str, content: &'a [u8]) -> Entry<'a> {
    Entry {
        name,
        content,
        method: 0,
        flags: 0,
        mode: 0o100_644,
    }
}

/// A zip archive of stored entries without any check.
fn raw_zip(entries: &[Entry<'_>]) -> Vec<u8> {
    let (mut file, mut directory) = (Vec::new(), Vec::new());
    for e in entries {
        let offset = file.len() as u32;
        let mut common = Vec::new();
        for short in [20, e.flags, e.method, 0, 33] {
            common.extend_from_slice(&short.to_le_bytes());
        }
        let size = e.content.len() as u32;
        for long in [crc32fast::hash(e.content), size, size] {
            common.extend_from_slice(&long.to_le_bytes());
        }
        common.extend_from_slice(&(e.name.len() as u16).to_le_bytes());
        common.extend_from_slice(&[0, 0]);
        file.extend_from_slice(b"PK\x03\x04");
        file.extend_from_slice(&common);
        file.extend_from_slice(e.name.as_bytes());
        file.extend_from_slice(e.content);
        directory.extend_from_slice(b"PK\x01\x02\x14\x03");
        directory.extend_from_slice(&common);
        directory.extend_from_slice(&[0; 6]);
        directory.extend_from_slice(&(e.mode << 16).to_le_bytes());
        directory.extend_from_slice(&offset.to_le_bytes());
        directory.extend_from_slice(e.name.as_bytes());
    }
    let (count, offset) = (entries.len() as u16, file.len() as u32);
    file.extend_from_slice(&directory);
    file.extend_from_slice(b"PK\x05\x06\0\0\0\0");
    file.extend_from_slice(&count.to_le_bytes());
    file.extend_from_slice(&count.to_le_bytes());
    file.extend_from_slice(&(directory.len() as u32).to_le_bytes());
    file.extend_from_slice(&offset.to_le_bytes());
    file.extend_from_slice(&[0, 0]);
    file
}

/// Opens the bytes as an FMU; the message, which must begin with the path.
fn message_with(bytes: &[u8], limits: Limits) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.fmu");
    std::fs::write(&path, bytes).unwrap();
    let error = Fmu::open_with(
        &path,
        &Options {
            limits,
            time_limit: None,
        },
    )
    .unwrap_err()
    .to_string();
    let start = format!("{}: ", path.display());
    error
        .strip_prefix(&start)
        .unwrap_or_else(|| panic!("{error} does not name the file"))
        .to_owned()
}

fn message(bytes: &[u8]) -> String {
    message_with(bytes, Limits::default())
}

fn xml() -> String {
    support::description().to_xml()
}

#[test]
fn archives_are_refused_with_entry_and_limit() {
    let xml = xml();
    let xml = xml.as_bytes();
    let whole = raw_zip(&[entry("modelDescription.xml", xml)]);
    let with = |bad: Entry<'_>| raw_zip(&[entry("modelDescription.xml", xml), bad]);
    let many: Vec<String> = (0..10_001).map(|n| format!("resources/{n}")).collect();
    let many: Vec<_> = many.iter().map(|name| entry(name, b"")).collect();
    let mut damaged = whole.clone();
    damaged[100] ^= 1;
    let cases: [(&str, Vec<u8>, &str); 17] = [
        ("empty file", vec![], "is empty (0 bytes); a zip archive is expected"),
        (
            "text",
            b"title = \"a scene, no FMU\"\n".to_vec(),
            "is no intact zip archive: ",
        ),
        (
            "truncated",
            whole[..whole.len() / 2].to_vec(),
            "is no intact zip archive: ",
        ),
        (
            "no description",
            raw_zip(&[entry("readme.txt", b"x")]),
            "has no modelDescription.xml at its root",
        ),
        (
            "description in a folder",
            raw_zip(&[entry("a/modelDescription.xml", xml)]),
            "has no modelDescription.xml at its root",
        ),
        (
            "traversal",
            with(entry("resources/../../evil", b"x")),
            "entry resources/../../evil: the name is refused: it leads out of the folder (..)",
        ),
        (
            "absolute",
            with(entry("/etc/evil", b"x")),
            "entry /etc/evil: the name is refused: it is absolute",
        ),
        (
            "drive",
            with(entry("C:/evil", b"x")),
            "entry C:/evil: the name is refused: it holds a colon, as drives do",
        ),
        (
            "backslash",
            with(entry("..\\evil", b"x")),
            "entry ..\\evil: the name is refused: it holds a backslash; the separator is /",
        ),
        (
            "dot",
            with(entry("resources/./x", b"x")),
            "entry resources/./x: the name is refused: it has an empty part or the part .",
        ),
        (
            "same name",
            with(entry("modelDescription.xml", b"other")),
            "the name is used twice",
        ),
        (
            "same name but for case",
            with(entry("MODELDESCRIPTION.XML", b"other")),
            "entry MODELDESCRIPTION.XML: the name is used twice (upper and lower case count as the same)",
        ),
        ("too many", raw_zip(&many), "has 10001 entries, the limit is 10000"),
        (
            "link",
            with(Entry {
                mode: 0o120_777,
                ..entry("resources/link", b"/etc/passwd")
            }),
            "entry resources/link: is a link or a special file",
        ),
        (
            "encrypted",
            with(Entry {
                flags: 1,
                ..entry("resources/secret", b"x")
            }),
            "entry resources/secret: is encrypted",
        ),
        (
            "other method",
            with(Entry {
                method: 14,
                ..entry("resources/lzma", b"x")
            }),
            "entry resources/lzma: the compression method ",
        ),
        ("damaged", damaged, "entry modelDescription.xml: cannot be inflated: "),
    ];
    for (what, bytes, expected) in cases {
        let found = message(&bytes);
        assert!(found.contains(expected), "{what}: expected …{expected}…, found {found}");
    }
}

#[test]
fn bombs_are_refused_while_inflating() {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    writer.start_file("modelDescription.xml", options).unwrap();
    writer.write_all(xml().as_bytes()).unwrap();
    writer.start_file("resources/zeros", options).unwrap();
    for _ in 0..64 {
        writer.write_all(&[0; 1 << 20]).unwrap();
    }
    let bytes = writer.finish().unwrap().into_inner();
    let found = message(&bytes);
    assert!(found.starts_with("entry resources/zeros: inflates from "), "{found}");
    assert!(found.ends_with(" to more than 1000 times as many bytes"), "{found}");
    let limits = Limits {
        bytes: 1 << 20,
        ratio: u64::MAX,
        ..Limits::default()
    };
    let found = message_with(&bytes, limits);
    assert_eq!(
        found,
        "entry resources/zeros: the archive inflates to more than 1048576 bytes"
    );
}

#[test]
fn a_missing_file_and_a_folder_are_refused() {
    let error = Fmu::open("no/such.fmu").unwrap_err().to_string();
    assert!(error.starts_with("no/such.fmu: cannot be read: "), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let error = Fmu::open(folder.path()).unwrap_err().to_string();
    assert!(error.ends_with("is no intact zip archive: it is a folder"), "{error}");
}

#[test]
fn model_descriptions_are_refused_with_line_and_value() {
    let change = |from: &str, to: &str| {
        let xml = xml();
        assert!(xml.contains(from), "{from} is not in {xml}");
        xml.replacen(from, to, 1)
    };
    let deep = change("<ModelStructure>", &"<a>".repeat(80));
    let x = r#"name="x" valueReference="1""#;
    let cases: [(String, &str); 28] = [
        (String::new(), "is empty"),
        ("hello".into(), "text outside the root element"),
        ("<?xml version=\"1.0\"?>".into(), "there is no element"),
        (xml()[..600].to_owned(), "line "),
        (change("</ModelVariables>", "</Variables>"), "not well-formed XML"),
        (
            change("</fmiModelDescription>", "</fmiModelDescription><x/>"),
            "there is a second root element",
        ),
        (
            "<SystemStructureDescription/>".into(),
            "the root element is <SystemStructureDescription>",
        ),
        (
            change("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\""),
            "fmiVersion is \"3.0\", expected \"2.0\"",
        ),
        (
            change("fmiVersion=\"2.0\" ", ""),
            "<fmiModelDescription> lacks the attribute fmiVersion",
        ),
        (
            change("guid=\"{00000000-0000-0000-0000-000000000000}\"", ""),
            "lacks the attribute guid",
        ),
        (
            change("<CoSimulation", "<ModelExchange"),
            "lacks CoSimulation (the FMU is for model exchange only)",
        ),
        (
            change("<CoSimulation modelIdentifier=\"Oscillator\"", "<CoSimulation"),
            "<CoSimulation> lacks the attribute modelIdentifier",
        ),
        (
            change(
                "<CoSimulation modelIdentifier=\"Oscillator\"",
                "<CoSimulation modelIdentifier=\"../evil\"",
            ),
            "modelIdentifier of <CoSimulation> is \"../evil\", expected a C identifier",
        ),
        (
            change("canInterpolateInputs=\"true\"", "canInterpolateInputs=\"yes\""),
            "expected true or false",
        ),
        (
            change("name=\"v\"", "name=\"x\""),
            "the variable name \"x\" is used twice, first at line ",
        ),
        (
            change(x, "name=\"x\" valueReference=\"-1\""),
            "valueReference of variable \"x\" is \"-1\", expected a whole number from 0 to 4294967295",
        ),
        (
            change(x, "name=\"x\" valueReference=\"4294967296\""),
            "expected a whole number from 0 to 4294967295",
        ),
        (
            change(x, "name=\"x\""),
            "<ScalarVariable> lacks the attribute valueReference",
        ),
        (
            change(x, "valueReference=\"1\""),
            "<ScalarVariable> lacks the attribute name",
        ),
        (
            change("start=\"800.0\"", "start=\"NaN\""),
            "start of variable \"stiffness\" is \"NaN\", expected a finite number with a decimal point",
        ),
        (
            change("start=\"800.0\"", "start=\"1,5\""),
            "start of variable \"stiffness\" is \"1,5\"",
        ),
        (
            change("<Real unit=\"N/m\"", "<Real unit=\"lbf/in\""),
            "variable \"stiffness\" refers to the unit \"lbf/in\", which is not defined",
        ),
        (
            change("<Real unit=\"N/m\"", "<Real declaredType=\"T\""),
            "variable \"stiffness\" refers to the type \"T\", which is not defined",
        ),
        (
            change("causality=\"input\"", "causality=\"in\""),
            "causality of variable \"force\" is \"in\"",
        ),
        (
            change("<Unknown index=\"2\"", "<Unknown index=\"99\""),
            "index of <Unknown> in <Outputs> is \"99\", expected the position of a variable, counted from 1",
        ),
        (
            change(
                "<fmiModelDescription",
                "<!DOCTYPE d [<!ENTITY a \"b\"><!ENTITY c \"&a;&a;\">]>\n<fmiModelDescription",
            ),
            "line 2: entity <!ENTITY a \"b\"> is refused",
        ),
        (change("Driven", "&boom;"), "entity &boom; is refused"),
        (deep, "elements are nested more than 64 deep"),
    ];
    for (text, expected) in cases {
        let found = message(&raw_zip(&[entry("modelDescription.xml", text.as_bytes())]));
        assert!(found.starts_with("modelDescription.xml: "), "{found}");
        assert!(found.contains(expected), "expected …{expected}…, found {found}");
    }
    let found = message(&raw_zip(&[entry("modelDescription.xml", b"<a b=\"\xff\"/>")]));
    assert!(found.ends_with("is not UTF-8: bad byte at offset 6"), "{found}");
}

#[test]
fn a_binary_that_is_missing_or_unusable_is_said_plainly() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("X.fmu");
    let instantiated = |binary: &str, content: &[u8]| {
        let xml = xml();
        let bytes = raw_zip(&[entry("modelDescription.xml", xml.as_bytes()), entry(binary, content)]);
        std::fs::write(&path, bytes).unwrap();
        let fmu = Fmu::open(&path).unwrap();
        let error = fmu.instantiate("x", false, false).unwrap_err().to_string();
        error.replace(&path.display().to_string(), "X.fmu")
    };
    let here = fmi2::archive::binary_entry("Oscillator");
    assert_eq!(
        instantiated("binaries/amiga/Oscillator.so", b"x"),
        format!("X.fmu: no binary for this platform, {here}; the archive has amiga")
    );
    assert_eq!(
        instantiated("resources/x", b"x"),
        format!("X.fmu: no binary for this platform, {here}; the archive has none")
    );
    let found = instantiated(&here, b"this is no shared library, whatever its name says");
    assert!(found.starts_with("X.fmu: the binary cannot be loaded: "), "{found}");
    assert!(!Path::new("X.fmu").exists());
}
