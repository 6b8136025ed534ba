//! Model descriptions and archives that we write.

mod support;

use fmi2::model_description::{
    BaseUnit, Causality, DisplayUnit, EnumerationItem, Initial, Kind, ModelDescription, RealAttributes, TypeDefinition,
    TypeShape, Unit, Variability, Variable,
};

/// A description with every kind of content.
fn rich() -> ModelDescription {
    let mut d = support::description();
    d.guid = "{a<b>&\"c\"}".into();
    d.author = Some("Ä & Ö".into());
    let degree = DisplayUnit {
        name: "deg".into(),
        factor: 57.295_779_513_082_32,
        offset: 0.0,
    };
    d.units.push(Unit {
        name: "rad".into(),
        base: Unit::from_name("rad").unwrap().base,
        display_units: vec![degree],
    });
    let celsius = BaseUnit {
        exponents: [0, 0, 0, 0, 1, 0, 0, 0],
        factor: 1.0,
        offset: 273.15,
    };
    d.units.push(Unit {
        name: "degC".into(),
        base: Some(celsius),
        display_units: vec![],
    });
    d.units.push(Unit {
        name: "furlong".into(),
        base: None,
        display_units: vec![],
    });
    let angle = RealAttributes {
        quantity: Some("Angle".into()),
        unit: Some("rad".into()),
        display_unit: Some("deg".into()),
        min: Some(-1e-300),
        max: Some(0.1 + 0.2),
        nominal: Some(1e22),
    };
    let shapes = [
        ("Angle", TypeShape::Real(angle)),
        (
            "Count",
            TypeShape::Integer {
                min: Some(-3),
                max: Some(i32::MAX),
            },
        ),
        ("Flag", TypeShape::Boolean),
        ("Text", TypeShape::String),
        (
            "Mode",
            TypeShape::Enumeration(vec![
                EnumerationItem {
                    name: "off".into(),
                    value: 1,
                },
                EnumerationItem {
                    name: "on".into(),
                    value: 2,
                },
            ]),
        ),
    ];
    d.types = shapes
        .into_iter()
        .map(|(name, shape)| TypeDefinition {
            name: name.into(),
            description: None,
            shape,
        })
        .collect();
    let mut mode = Variable::integer_parameter("mode", 0, "line 1\nline 2\ttab");
    mode.declared_type = Some("Mode".into());
    mode.kind = Kind::Enumeration { start: Some(2) };
    mode.value_reference = u32::MAX;
    let mut angle = Variable::output("angle", "rad", "An angle");
    angle.declared_type = Some("Angle".into());
    angle.kind = Kind::Real {
        attributes: RealAttributes::default(),
        start: None,
        derivative_of: Some(1),
    };
    angle.value_reference = 77;
    let mut constant = Variable::output("pi", "1", "A constant");
    constant.variability = Variability::Constant;
    constant.initial = Some(Initial::Exact);
    constant.kind = Kind::Real {
        attributes: RealAttributes::default(),
        start: Some(std::f64::consts::PI),
        derivative_of: None,
    };
    let mut derived = Variable::parameter("derived", "kg", 0.0, "Follows from others");
    derived.causality = Causality::CalculatedParameter;
    derived.initial = Some(Initial::Calculated);
    derived.kind = Kind::Real {
        attributes: RealAttributes::default(),
        start: None,
        derivative_of: None,
    };
    d.variables.extend([mode, angle, constant, derived]);
    d
}

#[test]
fn what_is_written_reads_back_the_same() {
    for d in [support::description(), rich()] {
        let xml = d.to_xml();
        assert_eq!(ModelDescription::from_xml(xml.as_bytes()).unwrap(), d, "{xml}");
        assert_eq!(ModelDescription::from_xml(xml.as_bytes()).unwrap().to_xml(), xml);
    }
}

#[test]
fn byte_order_mark_crlf_comments_doctype_and_vendor_annotations_are_tolerated() {
    let expected = rich();
    let mut xml = expected.to_xml();
    xml = xml.replacen("?>", "?>\n<!DOCTYPE fmiModelDescription>\n<!-- made by hand -->", 1);
    xml = xml.replacen(
        "  <ModelVariables>",
        "  <VendorAnnotations><Tool name=\"x\"><a:b xmlns:a=\"urn:x\" a:c=\"1\">text</a:b></Tool>\
         </VendorAnnotations>\n  \
         <ModelVariables>",
        1,
    );
    xml = xml.replacen("<CoSimulation ", "<CoSimulation x:foreign=\"1\" ", 1);
    xml = format!("\u{feff}{}", xml.replace('\n', "\r\n"));
    assert_eq!(ModelDescription::from_xml(xml.as_bytes()).unwrap(), expected);
}

#[test]
fn latin_1_is_read_where_it_is_declared() {
    let xml = rich().to_xml().replacen("UTF-8", "ISO-8859-1", 1);
    let bytes: Vec<u8> = xml.chars().map(|c| u8::try_from(c as u32).unwrap()).collect();
    assert_eq!(
        ModelDescription::from_xml(&bytes).unwrap().author.as_deref(),
        Some("Ä & Ö")
    );
}

#[test]
fn unit_and_bounds_are_inherited_from_the_declared_type() {
    let d = rich();
    let angle = d.variable("angle").unwrap();
    assert_eq!(d.unit_of(angle).unwrap().name, "rad");
    assert_eq!(d.real_attributes(angle).unwrap().max, Some(0.1 + 0.2));
}

#[test]
fn indices_in_the_model_structure_are_positions_from_one() {
    let xml = support::description().to_xml();
    assert!(
        xml.contains(r#"<Unknown index="4" dependencies="1"/>"#),
        "a depends on force: {xml}"
    );
    assert!(
        xml.contains(r#"<Unknown index="2" dependencies="8"/>"#),
        "x depends on start.x: {xml}"
    );
    assert!(
        xml.contains(r#"<Unknown index="2" dependencies=""/>"#),
        "x depends on no input: {xml}"
    );
}

#[test]
fn the_same_content_gives_the_same_bytes_and_any_change_another_guid() {
    let package = support::package();
    let path = std::path::Path::new("Oscillator.fmu");
    let bytes = package.to_bytes(path).unwrap();
    assert_eq!(package.to_bytes(path).unwrap(), bytes);
    let guid = package.guid(path).unwrap();
    let mut other = package.clone();
    other.resources.insert("scene.toml".into(), b"title = \"\"".to_vec());
    assert_ne!(other.guid(path).unwrap(), guid);
    assert!(
        guid.chars().all(|c| c.is_ascii_hexdigit() || "{}-".contains(c)) && guid.len() == 38,
        "{guid}"
    );
    // headers: no extra fields, version needed at most 2.0, date 1980-01-01
    let mut names = Vec::new();
    for at in (0..bytes.len() - 46).filter(|at| bytes[*at..].starts_with(b"PK\x01\x02")) {
        let short = |offset: usize| u16::from_le_bytes([bytes[at + offset], bytes[at + offset + 1]]);
        assert!(short(6) <= 20, "version needed {}", short(6));
        assert!(matches!(short(10), 0 | 8), "method {}", short(10));
        assert_eq!(short(14), 1 << 5 | 1, "date");
        assert_eq!((short(30), short(32)), (0, 0), "extra field and comment");
        let name = String::from_utf8(bytes[at + 46..at + 46 + usize::from(short(28))].to_vec()).unwrap();
        let mode = u16::from_le_bytes([bytes[at + 40], bytes[at + 41]]);
        assert_eq!(
            mode & 0o777,
            if name.starts_with("binaries/") { 0o755 } else { 0o644 },
            "{name}"
        );
        names.push(name);
    }
    assert!(names.is_sorted() && names.len() == 5, "{names:?}");
}

#[test]
fn the_packaged_fmu_opens_with_its_guid_filled_in() {
    let example = support::example();
    let mut expected = support::description();
    expected.guid = support::package().guid(example.fmu.path()).unwrap();
    assert_eq!(*example.fmu.description(), expected);
    let folder = example.fmu.folder().to_owned();
    assert_eq!(std::fs::read(folder.join("resources/note.txt")).unwrap(), b"nothing\n");
    // left for other tools to be tried on it
    std::fs::copy(
        example.fmu.path(),
        concat!(env!("CARGO_TARGET_TMPDIR"), "/Oscillator.fmu"),
    )
    .unwrap();
    drop(example);
    assert!(!folder.exists(), "the folder is removed at the end");
}

#[test]
fn a_package_without_placeholder_or_with_a_bad_name_is_refused() {
    let path = std::path::Path::new("X.fmu");
    let mut package = support::package();
    package.resources.insert("../evil".into(), Vec::new());
    let message = package.to_bytes(path).unwrap_err().to_string();
    assert!(
        message.contains("resources/../evil") && message.contains("leads out"),
        "{message}"
    );
    let mut package = support::package();
    package.description = package.description.replace("{00000000", "{10000000");
    let message = package.to_bytes(path).unwrap_err().to_string();
    assert!(message.contains("placeholder"), "{message}");
}

#[test]
fn the_folder_of_an_open_fmu_lives_as_long_as_its_last_instance() {
    let example = support::example();
    let mut instance = support::instance(&example.fmu);
    let folder = example.fmu.folder().to_owned();
    drop(example);
    assert!(folder.exists());
    support::initialise(&mut instance);
    drop(instance);
    assert!(!folder.exists());
}
