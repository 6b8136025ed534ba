use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fmi2::archive::{Package, write as write_archive, zipped};
use fmi2::model_description::{ModelDescription, Variable};
use scene::{Line, Offset, PantographModel, ParameterValue, Scene, Supplied};
use tempfile::TempDir;

use super::*;

mod units;

/// An FMU that can be read but not run.
fn fmu(name: &str, variables: Vec<Variable>) -> Vec<u8> {
    let package = Package {
        description: ModelDescription::of_slave(name, variables).to_xml(),
        library: b"none".to_vec(),
        ..Package::default()
    };
    package.to_bytes(Path::new(name)).unwrap()
}

/// A line and a pantograph with names of their own; the pantograph measures in millimetres and pulls where we push.
fn fmus() -> [Vec<u8>; 2] {
    let mut collector = ModelDescription::of_slave(
        "Kollektor",
        vec![
            Variable::input("Fc", "N", -100.0, "Force of the wire"),
            Variable::output("lage", "m", "Position of the collector"),
            Variable::output("tempo", "m/s", "Velocity of the collector"),
            Variable::parameter("m1", "kg", 7.2, "Mass"),
            Variable::parameter("speed", "m/s", 50.0, "Speed"),
            Variable::parameter("k", "N/m", 4200.0, "Stiffness"),
            Variable::parameter("bare", "", 1.0, "Without a unit"),
            Variable::integer_parameter("n", 3, "Number"),
            Variable::boolean_parameter("on", true, "Switch"),
        ],
    );
    // The definition of the unit is the collector's own.
    for unit in &mut collector.units {
        if unit.name == "m" {
            unit.name = "mm".to_owned();
            unit.base.as_mut().unwrap().factor = 1e-3;
        }
    }
    for variable in &mut collector.variables {
        if let fmi2::model_description::Kind::Real { attributes, .. } = &mut variable.kind
            && attributes.unit.as_deref() == Some("m")
        {
            attributes.unit = Some("mm".to_owned());
        }
    }
    for variable in &mut collector.variables {
        if let fmi2::model_description::Kind::Real { attributes, .. } = &mut variable.kind
            && variable.name == "bare"
        {
            attributes.unit = None;
        }
    }
    let package = Package {
        description: collector.to_xml(),
        library: b"none".to_vec(),
        ..Package::default()
    };
    let wire = fmu(
        "Draht",
        vec![
            Variable::input("hoehe", "m", 5.0, "Height of the strip"),
            Variable::input("hoehenrate", "m/s", 0.0, "Its rate"),
            Variable::output("kraft", "N", "Contact force"),
            Variable::parameter("T", "N", 20_000.0, "Tension"),
        ],
    );
    [wire, package.to_bytes(Path::new("Kollektor")).unwrap()]
}

const HEAD: &str = include_str!("tests/head.xml");

/// Another tool's way of writing: other prefixes, connections from input to output, values inline and in files.
const BODY: &str = include_str!("tests/body.xml");

const SSV: &str = include_str!("tests/vendor.ssv");

/// An archive of that body in a folder of its own.
fn archive(body: &str) -> (TempDir, PathBuf) {
    let [wire, collector] = fmus();
    let entries = BTreeMap::from([
        (STRUCTURE_FILE.to_owned(), format!("{HEAD}{body}").into_bytes()),
        ("resources/k.fmu".to_owned(), collector),
        ("resources/d.fmu".to_owned(), wire),
        ("resources/set one.ssv".to_owned(), SSV.as_bytes().to_vec()),
    ]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fremd.ssp");
    write_archive(&path, &zipped(&entries).unwrap()).unwrap();
    (folder, path)
}

fn imported(body: &str) -> Result<Imported, SspError> {
    let (_folder, path) = archive(body);
    import(&path, &["run.start_x=10".to_owned()])
}

fn refusal(body: &str) -> String {
    match imported(body) {
        Ok(_) => panic!("it is accepted:\n{body}"),
        Err(error) => cosim::chain(&error),
    }
}

fn pantograph(scene: &Scene) -> &Supplied {
    match &scene.pantographs[0].model {
        PantographModel::Supplied(side) => side,
        other => panic!("{other:?}"),
    }
}

#[test]
fn thousands_of_components_of_one_fmu_are_read_and_the_idle_one_is_named() {
    let idle: String = (0..3000)
        .map(|n| format!("<s:Component name=\"idle {n}\" source=\"resources/k.fmu\"/>\n"))
        .collect();
    let said = refusal(&BODY.replacen("<s:Elements>", &format!("<s:Elements>{idle}"), 1));
    assert!(
        said.contains("component \"idle 0\" is connected to no other one"),
        "{said}"
    );
}

/// Every unpacked archive holds a handle; thousands took minutes.
#[cfg(unix)]
#[test]
fn regress_35_components_of_one_fmu_share_its_unpacked_archive() {
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", "ulimit -n 200; exec \"$0\" \"$@\""]);
    shell.arg(std::env::current_exe().unwrap()).args([
        "--exact",
        "ssp::tests::thousands_of_components_of_one_fmu_are_read_and_the_idle_one_is_named",
    ]);
    let output = shell.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}

#[test]
fn a_system_of_another_tool_becomes_a_scene() {
    let imported = imported(BODY).unwrap();
    let scene = &imported.scene;
    assert_eq!(scene.title, "Operator's \"line\"");
    assert_eq!((scene.run.duration, scene.run.start_x), (4.0, 10.0));
    assert!((scene.run.speed - 50.0).abs() < 1e-12, "180 km/h: {}", scene.run.speed);
    let Line::Supplied(line) = &scene.catenary else {
        panic!("the line is supplied")
    };
    assert_eq!(
        (line.fmu.as_str(), line.inputs["strip[1].z"].variable.as_str()),
        ("resources/d.fmu", "hoehe")
    );
    assert_eq!(line.inputs["strip[1].vz"].variable, "hoehenrate");
    assert_eq!(line.outputs["contact[1].force"].variable, "kraft");

    let side = pantograph(scene);
    assert_eq!(side.fmu, "resources/k.fmu");
    let height = &side.outputs["height"];
    assert_eq!(
        (height.variable.as_str(), height.factor),
        ("lage", Some(1e-3)),
        "millimetres, by the unit"
    );
    assert_eq!(height.offset, Offset::Value(5.3));
    assert_eq!(side.outputs["velocity"].factor, Some(1.0));
    let force = &side.inputs["force"];
    assert_eq!((force.variable.as_str(), force.factor), ("Fc", Some(-1.0)));
    // The set of the system is stronger than that of the component.
    assert_eq!(side.parameters["m1"], ParameterValue::Number(8.5));
    assert_eq!(side.parameters["n"], ParameterValue::Number(4.0));
    assert_eq!(side.parameters["on"], ParameterValue::Boolean(false));
    assert!(!side.parameters.contains_key("unknown"));
    assert!(
        imported
            .notes
            .iter()
            .any(|note| note.contains("has no variable \"unknown\"")),
        "{:?}",
        imported.notes
    );
    assert!(imported.base.join(&side.fmu).is_file());
}

#[test]
fn a_force_without_a_telling_name_is_told_by_the_sign_that_it_starts_with() {
    // The collector starts at −100 N; without a change of sign the line's force is that on the strip.
    let imported = imported(&BODY.replace("<c:LinearTransformation factor=\"-1\"/>", "")).unwrap();
    assert_eq!(pantograph(&imported.scene).inputs["force_z"].factor, Some(1.0));
}

#[test]
fn what_is_not_of_this_shape_is_refused_with_the_element_and_its_line() {
    let with = |from: &str, to: &str| {
        assert!(BODY.contains(from), "{from}");
        BODY.replace(from, to)
    };
    let cases = [
        (
            with("<s:Elements>", "<s:Elements>\n<s:System name=\"innen\"/>"),
            "line 14: element \"innen\": a nested \
            system",
        ),
        (
            with(
                "<s:Elements>",
                "<s:Elements><s:SignalDictionaryReference name=\"d\" dictionary=\"x\"/>",
            ),
            "element \"d\": signal dictionaries are not supported",
        ),
        (
            with("endConnector=\"kraft\"", "endConnector=\"Kraft\""),
            "component \"draht\" has no connector \"Kraft\"",
        ),
        (
            with(
                "endElement=\"draht\" endConnector=\"hoehe\"",
                "endElement=\"wire\" endConnector=\"hoehe\"",
            ),
            "there is \
            no component \"wire\", only \"sammler\", \"draht\"",
        ),
        (
            with("name=\"Fc\" kind=\"input\"", "name=\"Fc\" kind=\"output\""),
            "sammler.Fc is an output in the system, \
            but its variable in the FMU is none",
        ),
        (
            with("startConnector=\"Fc\"", "startConnector=\"lage\""),
            "it joins an output to an output",
        ),
        (
            with(
                "startConnector=\"tempo\" endElement=\"draht\" \
                endConnector=\"hoehenrate\"",
                "startConnector=\"tempo\" endElement=\"draht\" endConnector=\"hoehe\"",
            ),
            "the input \"hoehe\" is connected twice",
        ),
        (
            with("<c:Real unit=\"m/s\"/>", "<c:Boolean/>"),
            "sammler.tempo is not real",
        ),
        (
            with(
                "<c:LinearTransformation \
            factor=\"-1\"/>",
                "<c:BooleanMappingTransformation/>",
            ),
            "BooleanMappingTransformation is not supported",
        ),
        (
            with("factor=\"-1\"", "factor=\"0\""),
            "factor of <c:LinearTransformation> is \"0\"",
        ),
        (
            with("resources/k.fmu", "../k.fmu"),
            "component \"sammler\": source \"../k.fmu\"",
        ),
        (
            with("resources/k.fmu", "resources/x.fmu"),
            "there is no such file in the archive",
        ),
        (
            with("resources/k.fmu", "resources/set%20one.ssv"),
            "component \"sammler\"",
        ),
        (with("set%20one.ssv", "two.ssv"), "source \"resources/two.ssv\""),
        (
            with("value=\"4\"", "value=\"four\""),
            "value of <v:Integer> is \"four\", expected a whole number",
        ),
        (
            with("<v:Integer value=\"4\"/>", "<v:String value=\"4\"/>"),
            "parameter \"n\" of component \"sammler\": the \
            value must be of type Integer",
        ),
        (
            with("m=\"1\" s=\"-1\" factor=\"0.2777777777777778\"", "m=\"1\""),
            "cannot be converted to m/s, the \
            dimensions differ",
        ),
        (
            with(
                "source=\"resources/k.fmu\"",
                "source=\"resources/k.fmu\" type=\"application/x-ssp-package\"",
            ),
            "the \
            type application/x-ssp-package is not supported",
        ),
        (
            BODY.replace(
                "<s:Connection startElement=\"sammler\" startConnector=\"Fc\" endElement=\"draht\" \
            endConnector=\"kraft\"><c:LinearTransformation factor=\"-1\"/></s:Connection>",
                "",
            ),
            "no component is a \
            line",
        ),
        (
            with("name=\"draht\"", "name=\"sammler\""),
            "the component name \"sammler\" is used twice",
        ),
        (with("stopTime=\"4\"", ""), "run.duration"),
        (
            with("stopTime=\"4\"", "stopTime=\"inf\""),
            "stopTime of <s:DefaultExperiment> is \"inf\"",
        ),
        (with("startTime=\"0\"", "startTime=\"1\""), "startTime = 1 s"),
    ];
    for (body, expected) in cases {
        let found = refusal(&body);
        assert!(found.contains("fremd.ssp"), "{found}");
        assert!(found.contains(expected), "expected …{expected}…, found {found}");
    }
}

#[test]
fn a_file_that_is_no_system_structure_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.ssp");
    let message = |entries: &[(&str, &str)]| {
        let entries = entries
            .iter()
            .map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec()))
            .collect();
        write_archive(&path, &zipped(&entries).unwrap()).unwrap();
        match import(&path, &[]) {
            Ok(_) => panic!("accepted"),
            Err(error) => error.to_string(),
        }
    };
    assert!(message(&[("a.txt", "")]).contains("has no SystemStructure.ssd at its root"));
    let other = HEAD.replace("SSP1/SystemStructureDescription", "SSP2/Something") + "</s:SystemStructureDescription>";
    assert!(
        message(&[(STRUCTURE_FILE, &other)])
            .contains("line 2: the element is <s:SystemStructureDescription>, expected")
    );
    let newer = HEAD.replace("version=\"1.0\" name", "version=\"2.0\" name") + "</s:SystemStructureDescription>";
    assert!(message(&[(STRUCTURE_FILE, &newer)]).contains("is \"2.0\", expected 1.0"));
    assert!(message(&[(STRUCTURE_FILE, "<a")]).contains("SystemStructure.ssd: line 1: not well-formed XML"));
}

#[test]
fn two_pantographs_are_ordered_by_where_they_start() {
    let strip = |i: usize| {
        vec![
            Variable::input(&format!("strip[{i}].z"), "m", 5.0, ""),
            Variable::input(&format!("strip[{i}].x"), "m", 0.0, ""),
            Variable::output(&format!("contact[{i}].fz"), "N", ""),
            Variable::output(&format!("contact[{i}].mean_fz"), "N", ""),
        ]
    };
    let line = fmu("Line", [strip(1), strip(2)].concat());
    let side = |x: f64| {
        let variables = vec![
            Variable::input("contact[1].fz", "N", 0.0, ""),
            Variable::output("strip[1].z", "m", ""),
            Variable::parameter("start.x", "m", x, ""),
        ];
        fmu("Side", variables)
    };
    let component = |name: &str, i: usize| {
        format!(
            "<s:Component name=\"{name}\" source=\"{name}.fmu\"><s:Connectors><s:Connector name=\"contact[1].fz\" \
                kind=\"input\"/>\
             <s:Connector name=\"strip[1].z\" kind=\"output\"/></s:Connectors></s:Component><!-- {i} -->"
        )
    };
    let wires = |name: &str, i: usize| {
        format!(
            "<s:Connection startElement=\"{name}\" startConnector=\"strip[1].z\" endElement=\"L\" \
                endConnector=\"strip[{i}].z\"/>\
             <s:Connection startElement=\"L\" startConnector=\"contact[{i}].fz\" endElement=\"{name}\" \
                 endConnector=\"contact[1].fz\"/>"
        )
    };
    let connectors: String = (1..=2)
        .map(|i| {
            format!(
                "<s:Connector name=\"strip[{i}].z\" kind=\"input\"/><s:Connector name=\"contact[{i}].fz\" \
                kind=\"output\"/>"
            )
        })
        .collect();
    let text = format!(
        "{HEAD}<s:System name=\"x\"><s:Elements>{}{}<s:Component name=\"L\" \
            source=\"L.fmu\"><s:Connectors>{connectors}</s:Connectors>\
         </s:Component></s:Elements><s:Connections>{}{}</s:Connections></s:System><s:DefaultExperiment stopTime=\"1\"/>\
         </s:SystemStructureDescription>",
        component("Back", 1),
        component("Front", 2),
        wires("Back", 1),
        wires("Front", 2),
    );
    let entries = BTreeMap::from([
        (STRUCTURE_FILE.to_owned(), text.into_bytes()),
        ("L.fmu".to_owned(), line),
        ("Back.fmu".to_owned(), side(20.0)),
        ("Front.fmu".to_owned(), side(120.0)),
    ]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.ssp");
    write_archive(&path, &zipped(&entries).unwrap()).unwrap();
    let scene = import(&path, &["run.speed_kmh=250".to_owned()]).unwrap().scene;
    assert_eq!((scene.run.start_x, scene.pantographs[1].offset_x), (120.0, -100.0));
    assert_eq!(pantograph(&scene).fmu, "Front.fmu");
    let Line::Supplied(line) = &scene.catenary else {
        panic!("the line is supplied")
    };
    // The leading pantograph is the line's second strip.
    assert_eq!(line.inputs["strip[1].z"].variable, "strip[2].z");
    assert_eq!(
        line.inputs["strip[1].x"].variable, "strip[2].x",
        "given though the system leaves it open"
    );
    assert_eq!(line.outputs["contact[2].mean_fz"].variable, "contact[1].mean_fz");
}

#[test]
fn maps_compose_and_turn_round() {
    let (a, b) = (
        document::Linear {
            factor: 2.0,
            offset: 1.0,
        },
        document::Linear {
            factor: -3.0,
            offset: 0.5,
        },
    );
    assert_eq!(a.then(b).apply(4.0), b.apply(a.apply(4.0)));
    assert_eq!(a.then(a.inverse()), document::Linear::IDENTITY);
}

#[test]
fn a_head_with_several_strips_is_not_exported_and_the_refusal_says_what_to_connect() {
    let text = include_str!("../../../../scenes/en50318-300.toml");
    let strips = "pantograph[1].strips=[{ x = 0.29 }, { x = -0.29 }]".to_owned();
    let scene = Scene::from_toml(text, "x.toml", &[strips]).unwrap();
    let here = Path::new(".");
    let refused = export(&scene, "x", &[], here, &[None], Path::new("x.ssp"));
    let message = refused.map(|_| ()).unwrap_err().to_string();
    for fragment in ["x.ssp: pantograph[1].strips: must be one strip", "master package"] {
        assert!(message.contains(fragment), "{message}");
    }
}
