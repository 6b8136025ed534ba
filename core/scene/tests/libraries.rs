//! Library files: a table takes its keys from another file, which names its own places.

use scene::{Files, PantographModel, Scene, SceneFile};
use std::collections::BTreeMap;

const EN: &str = include_str!("../../../scenes/en50318-250.toml");
const LINE: &str = include_str!("../../../lines/en50318-2002.toml");
const PANTOGRAPH: &str = include_str!("../../../pantographs/dsa380.toml");

/// The scene of EN 50318 whose line is that of the library; only the mesh is its own.
fn of_library(own_keys: &str) -> String {
    let (head, rest) = EN.split_once("[catenary]\n").unwrap();
    let (_, rest) = rest.split_once("[catenary.mesh]").unwrap();
    format!("{head}[catenary]\nfrom = \"../lines/en.toml\"\n{own_keys}\n[catenary.mesh]{rest}")
}

fn read(text: &str, files: &[(&str, &str)], overrides: &[&str]) -> Result<Scene, String> {
    let files: BTreeMap<String, String> = files
        .iter()
        .map(|(path, text)| ((*path).into(), (*text).into()))
        .collect();
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let opened = Files::new(|path| {
        files
            .get(path)
            .cloned()
            .ok_or_else(|| "cannot be read: no such file".to_owned())
    });
    let read = SceneFile::read(text, "scenes/x.toml", &overrides, &opened);
    let read = read.and_then(|file| file.check(&|_| Vec::new()).map(|()| file.scene));
    read.map_err(|error| error.to_string())
}

fn refused(text: &str, files: &[(&str, &str)], parts: &[&str]) {
    let message = read(text, files, &[]).unwrap_err();
    for part in parts {
        assert!(message.contains(part), "no {part:?} in\n{message}");
    }
}

#[test]
fn the_line_of_the_library_is_that_of_the_shipped_scene() {
    let scene = read(&of_library(""), &[("../lines/en.toml", LINE)], &[]).unwrap();
    assert_eq!(scene, Scene::from_toml(EN, "en.toml", &[]).unwrap());
    // The written scene needs no file.
    assert_eq!(Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap(), scene);
}

#[test]
fn keys_of_the_scene_win_over_those_of_a_library() {
    let own = "contact_wire_height = 5.5\npresag_ratio = 0.001\n[catenary.contact_wire]\ntension = 22000\n\
               [catenary.droppers]\nrule = { first = 5, longest = 10 }\n";
    let scene = read(&of_library(own), &[("../lines/en.toml", LINE)], &[]).unwrap();
    let (line, _) = scene.modelled_line().unwrap();
    let geometry = &line.tension_lengths[0];
    assert_eq!((geometry.contact_wire_height[0], geometry.presag[0]), (5.5, 0.06));
    assert_eq!(
        (line.contact_wire.tension, line.contact_wire.mass_per_length),
        (22_000.0, 1.35)
    );
    assert_eq!(line.droppers.positions, [[5.0, 15.0, 25.0, 35.0, 45.0, 55.0]]);
}

#[test]
fn an_override_wins_over_a_library() {
    let text = EN.replace("model = \"lumped\"", "from = \"p.toml\"");
    let start = text.find("masses = ").unwrap();
    let end = text.find("[coupling]").unwrap();
    let text = format!("{}{}", &text[..start], &text[end..]);
    let files = [
        ("p.toml", PANTOGRAPH),
        (
            "q.toml",
            "masses = [1.0]\nstiffnesses = [0.0]\ndampings = [1.0]\nmodel = \"lumped\"\n",
        ),
    ];
    let masses = |overrides: &[&str]| {
        let scene = read(&text, &files, overrides).unwrap();
        let PantographModel::Lumped(lumped) = &scene.pantographs[0].model else {
            panic!("a lumped pantograph");
        };
        lumped.masses.clone()
    };
    assert_eq!(masses(&[]), [7.12, 6.0, 5.8]);
    assert_eq!(masses(&["pantograph[1].masses[2]=6.5"]), [7.12, 6.5, 5.8]);
    assert_eq!(masses(&["pantograph[1].from=q.toml"]), [1.0]);
    let message = read(&text, &files, &["pantograph[1].masses[4]=6.5"]).unwrap_err();
    assert!(message.contains("has 3 entries, [1] to [3], and no [4]"), "{message}");
}

#[test]
fn problems_of_a_library_name_its_file_and_line() {
    let text = of_library("");
    let with = |from: &str, to: &str| {
        assert!(LINE.contains(from));
        LINE.replacen(from, to, 1)
    };
    let line = |what: &str| LINE.lines().position(|line| line.starts_with(what)).unwrap() + 1;
    let place = |what: &str| format!("../lines/en.toml:{}: ", line(what));
    refused(
        &text,
        &[],
        &["scenes/x.toml:16: catenary.from = \"../lines/en.toml\": cannot be read"],
    );
    let misspelt = with("axial_stiffness = 1.7e7", "axial_stifness = 1.7e7");
    let unknown = format!(
        "{}catenary.contact_wire.axial_stifness: unknown key",
        place("axial_stiffness")
    );
    refused(
        &text,
        &[("../lines/en.toml", &misspelt)],
        &[&unknown, "did you mean \"axial_stiffness\"?"],
    );
    let negative = with("tension = 20000.0", "tension = -20000.0");
    let expected = format!(
        "{}catenary.contact_wire.tension = -20000 N: must be positive",
        place("tension")
    );
    refused(&text, &[("../lines/en.toml", &negative)], &[&expected]);
    let outside = with("49.5, 55.0]", "49.5, 65.0]");
    let expected = format!(
        "{}catenary.droppers.positions[9] = 65 m: must be inside its span",
        place("positions")
    );
    refused(&text, &[("../lines/en.toml", &outside)], &[&expected]);
    refused(
        &text,
        &[("../lines/en.toml", "spans = [")],
        &["../lines/en.toml:1: not valid TOML"],
    );
    refused(&text, &[("../lines/en.toml", "")], &["catenary.spans is missing"]);
    let header = format!("[catenary]\n{LINE}");
    refused(
        &text,
        &[("../lines/en.toml", &header)],
        &["catenary.catenary: unknown key"],
    );
    refused(
        &text.replace("\"../lines/en.toml\"", "7"),
        &[],
        &["catenary.from = 7: must be the path of a file"],
    );
    let complete = Scene::from_toml(&text, "x.toml", &[]).unwrap_err().to_string();
    assert!(
        complete.contains("must be left out: a scene without files beside it is needed"),
        "{complete}"
    );
}

#[test]
fn a_library_takes_tables_and_libraries_beside_itself() {
    let (geometry, rest) = LINE.split_once("[contact_wire]").unwrap();
    let kept: Vec<&str> = geometry
        .lines()
        .filter(|line| ["wire", "stat", "grav"].iter().any(|key| line.starts_with(key)))
        .collect();
    let table = format!("table = \"en.csv\"\n{}\n[contact_wire]{rest}", kept.join("\n"));
    let mut csv = "chainage_m,contact_wire_height_m,encumbrance_m,stagger_m,presag_m\n".to_owned();
    for i in 0..=10 {
        csv += &format!("{},5.3,1.2,0,{}\n", 1000 + 60 * i, if i < 10 { "0" } else { "" });
    }
    let files = [("../lines/en.toml", table.as_str()), ("../lines/en.csv", csv.as_str())];
    let plain = Scene::from_toml(EN, "en.toml", &[]).unwrap();
    assert_eq!(read(&of_library(""), &files, &[]).unwrap(), plain);
    let chain = [
        ("../lines/en.toml", "from = \"old/en.toml\"\n"),
        ("../lines/old/en.toml", LINE),
    ];
    assert_eq!(read(&of_library(""), &chain, &[]).unwrap(), plain);
    // A key of the scene wins over a column of the library's table.
    let own = read(&of_library("presag = 0.05\ncontact_wire_height = 5.5"), &files, &[]).unwrap();
    let geometry = &own.modelled_line().unwrap().0.tension_lengths[0];
    assert_eq!((geometry.presag[0], geometry.contact_wire_height[0]), (0.05, 5.5));
    // A table of the scene wins over keys of the library.
    let of_scene = of_library("table = \"../lines/en.csv\"");
    let higher = csv.replace("5.3,1.2", "5.4,1.2");
    let scene = read(
        &of_scene,
        &[("../lines/en.toml", LINE), ("../lines/en.csv", &higher)],
        &[],
    )
    .unwrap();
    assert_eq!(
        scene.modelled_line().unwrap().0.tension_lengths[0].contact_wire_height[0],
        5.4
    );
    refused(
        &of_library("spans = 3"),
        &files,
        &["scenes/x.toml:17: catenary.spans: must be left out: the table"],
    );
    let wrong = csv.replacen("5.3,1.2", "53,1.2", 1);
    let files = [("../lines/en.toml", table.as_str()), ("../lines/en.csv", &wrong)];
    refused(
        &of_library(""),
        &files,
        &[
            "../lines/en.csv, row 2, column contact_wire_height_m",
            "= 53 m: must be at most 20 m",
        ],
    );
    let endless = [
        ("../lines/en.toml", "from = \"en.toml\"\n"),
        ("../lines/en.toml", "from = \"en.toml\"\n"),
    ];
    refused(
        &of_library(""),
        &endless,
        &["catenary.from = \"en.toml\": must be left out: at most 4 files"],
    );
}

#[test]
fn every_shipped_line_and_pantograph_is_read() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let files = |folder: &str| -> Vec<(String, String)> {
        let entries = std::fs::read_dir(format!("{root}/{folder}")).unwrap();
        let paths = entries.map(|entry| entry.unwrap().path());
        let toml = paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
        toml.map(|path| (path.display().to_string(), std::fs::read_to_string(&path).unwrap()))
            .collect()
    };
    let (lines, pantographs) = (files("lines"), files("pantographs"));
    assert!(!lines.is_empty() && pantographs.len() >= 6);
    for (path, text) in &lines {
        read(&of_library(""), &[("../lines/en.toml", text)], &[]).unwrap_or_else(|error| panic!("{path}: {error}"));
    }
    let (head, rest) = EN.split_once("[[pantograph]]\n").unwrap();
    let (_, rest) = rest.split_once("[coupling]").unwrap();
    let scene = format!("{head}[[pantograph]]\nfrom = \"p.toml\"\nstatic_force = 120.0\n[coupling]{rest}");
    for (path, text) in &pantographs {
        read(&scene, &[("p.toml", text)], &[]).unwrap_or_else(|error| panic!("{path}: {error}"));
        // Each value says where it comes from.
        for line in text
            .lines()
            .filter(|line| !line.starts_with('#') && !line.starts_with("model"))
        {
            assert!(line.contains("# "), "{path}: {line}");
        }
    }
}
