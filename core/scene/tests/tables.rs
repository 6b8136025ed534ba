//! Tables of supports: what is read, and what is refused with file, row, column, value and what would be right.

use scene::{Files, Scene, SceneFile};

const TOML: &str = include_str!("../../../scenes/as-built.toml");
const CSV: &str = include_str!("../../../scenes/as-built.csv");
const WALK: &str = include_str!("../../../scenes/walk.toml");
const WALK_CSV: &str = include_str!("../../../scenes/walk.csv");

/// The scene of a text and the one table beside it.
fn read(text: &str, csv: &str, overrides: &[&str]) -> Result<Scene, String> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let csv = csv.to_owned();
    let files = Files::new(move |path| match path {
        "as-built.csv" | "walk.csv" => Ok(csv.clone()),
        other => Err(format!("cannot be read: no file {other}")),
    });
    let file = SceneFile::read(text, "line.toml", &overrides, &files).map_err(|error| error.to_string())?;
    file.check(&|_| Vec::new()).map_err(|error| error.to_string())?;
    Ok(file.scene)
}

/// The table with cell `column` of the row in line `line` replaced.
fn with(csv: &str, line: usize, column: &str, value: &str) -> String {
    let lines: Vec<&str> = csv.lines().collect();
    let header = lines.iter().find(|line| !line.starts_with('#')).unwrap();
    let place = header.split(',').position(|name| name == column).unwrap();
    let mut cells: Vec<&str> = lines[line - 1].split(',').collect();
    cells[place] = value;
    let changed = cells.join(",");
    let mut lines: Vec<&str> = lines;
    lines[line - 1] = &changed;
    lines.join("\n")
}

#[test]
fn a_table_gives_the_line_that_lists_give() {
    let scene = read(TOML, CSV, &[]).unwrap();
    let (line, _) = scene.modelled_line().unwrap();
    let geometry = &line.tension_lengths[0];
    assert_eq!(geometry.spans(), 12);
    assert_eq!(geometry.contact_wire_height[6], 5.5);
    assert_eq!((geometry.stagger[1], geometry.encumbrance[3]), (-0.19, 1.195));
    assert_eq!(line.droppers.positions.len(), 12);
    let again = Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap();
    assert_eq!(again, scene);
}

#[test]
fn rows_of_two_tension_lengths_are_two_tension_lengths_with_a_common_origin() {
    let scene = read(WALK, WALK_CSV, &[]).unwrap();
    let (line, _) = scene.modelled_line().unwrap();
    assert_eq!(line.tension_lengths.len(), 2);
    assert_eq!(line.tension_lengths[1].start_x, 476.0);
    assert_eq!((line.spans(), line.length()), (20, 1190.0));
    // Droppers by rule: 5 m from the supports, at most 8 m apart.
    let positions = &line.tension_lengths[0].dropper_positions[0];
    assert_eq!((positions[0], positions[positions.len() - 1]), (5.0, 60.0));
    assert!(positions.windows(2).all(|pair| pair[1] - pair[0] <= 8.0));
    assert_eq!(Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap(), scene);
}

#[test]
fn the_mark_of_an_encoding_and_other_line_ends_are_no_matter() {
    let other = format!("\u{feff}{}", CSV.replace('\n', "\r\n"));
    assert_eq!(read(TOML, &other, &[]).unwrap(), read(TOML, CSV, &[]).unwrap());
}

#[test]
fn names_of_patterns_stand_for_positions() {
    let text = TOML.replace(
        "[catenary.droppers]",
        "[catenary.droppers]\npatterns = { short = [10, 30], long = [5, 15, 25, 35, 45] }",
    );
    let scene = read(&text, &with(CSV, 5, "droppers", "long"), &[]).unwrap();
    let (line, _) = scene.modelled_line().unwrap();
    assert_eq!(line.droppers.positions[2], [5.0, 15.0, 25.0, 35.0, 45.0]);
    let message = read(&text, &with(CSV, 5, "droppers", "longer"), &[]).unwrap_err();
    assert!(
        message.contains("as-built.csv, row 5, column droppers") && message.contains("\"long\""),
        "{message}"
    );
}

/// Changed cells of the survey: line, column, value, and parts of the message.
const WRONG_CELLS: &[(usize, &str, &str, &[&str])] = &[
    (
        4,
        "chainage_m",
        "many",
        &["row 4, column chainage_m", "\"many\"", "a number"],
    ),
    (
        4,
        "chainage_m",
        "",
        &["row 4, column chainage_m", "is missing", "every row"],
    ),
    (
        4,
        "chainage_m",
        "2310.0",
        &["row 4, column chainage_m", "2310 m", "greater than 2310"],
    ),
    (
        4,
        "chainage_m",
        "2300",
        &["row 4, column chainage_m", "2300 m", "greater than 2310"],
    ),
    (
        4,
        "chainage_m",
        "2310.05",
        &["row 3, column droppers", "inside its span"],
    ),
    (4, "chainage_m", "NaN", &["row 4, column chainage_m", "NaN"]),
    (4, "chainage_m", "inf", &["row 4, column chainage_m", "\"inf\""]),
    (
        4,
        "chainage_m",
        "9000",
        &["row 5, column chainage_m", "greater than 9000 m"],
    ),
    (
        5,
        "contact_wire_height_mm",
        "53000",
        &["row 5, column contact_wire_height_mm", "53 m", "at most 20 m"],
    ),
    (
        5,
        "contact_wire_height_mm",
        "-5300",
        &["row 5, column contact_wire_height_mm", "-5.3 m", "positive"],
    ),
    (
        5,
        "contact_wire_height_mm",
        "0",
        &["row 5, column contact_wire_height_mm", "positive"],
    ),
    (
        5,
        "contact_wire_height_mm",
        "five",
        &["row 5, column contact_wire_height_mm", "\"five\""],
    ),
    (
        5,
        "contact_wire_height_mm",
        "",
        &["row 5, column contact_wire_height_mm", "is missing"],
    ),
    (
        5,
        "contact_wire_height_mm",
        "5300;0",
        &["row 5, column contact_wire_height_mm", "\"5300;0\""],
    ),
    (6, "encumbrance_mm", "0", &["row 6, column encumbrance_mm", "positive"]),
    (
        6,
        "encumbrance_mm",
        "-1200",
        &["row 6, column encumbrance_mm", "-1.2 m"],
    ),
    (
        6,
        "encumbrance_mm",
        "1200mm",
        &["row 6, column encumbrance_mm", "\"1200mm\""],
    ),
    (6, "encumbrance_mm", "", &["row 6, column encumbrance_mm", "is missing"]),
    (7, "stagger_mm", "left", &["row 7, column stagger_mm", "\"left\""]),
    (7, "stagger_mm", "", &["row 7, column stagger_mm", "is missing"]),
    (
        7,
        "stagger_mm",
        "2000",
        &["row 7, column stagger_mm", "2 m", "within ±0.8 m"],
    ),
    (
        7,
        "stagger_mm",
        "-900",
        &["row 7, column stagger_mm", "-0.9 m", "within ±0.8 m"],
    ),
    (7, "stagger_mm", "inf", &["row 7, column stagger_mm", "\"inf\""]),
    (8, "presag_mm", "thirty", &["row 8, column presag_mm", "\"thirty\""]),
    (8, "presag_mm", "", &["row 8, column presag_mm", "is missing"]),
    (
        8,
        "presag_mm",
        "6000",
        &["row 8, column presag_mm", "6 m", "less than contact_wire_height"],
    ),
    (8, "presag_mm", "inf", &["row 8, column presag_mm", "\"inf\""]),
    (
        15,
        "presag_mm",
        "30",
        &["row 15, column presag_mm", "\"30\"", "empty in the last row"],
    ),
    (
        15,
        "droppers",
        "5 10",
        &["row 15, column droppers", "empty in the last row"],
    ),
    (
        9,
        "droppers",
        "5 10 70",
        &["row 9, column droppers", "70 m", "inside its span"],
    ),
    (
        9,
        "droppers",
        "-5 10",
        &["row 9, column droppers", "-5 m", "inside its span"],
    ),
    (
        9,
        "droppers",
        "10 5",
        &["row 9, column droppers", "5 m", "greater than the position before"],
    ),
    (
        9,
        "droppers",
        "10 10",
        &["row 9, column droppers", "10 m", "greater than the position before"],
    ),
    (
        9,
        "droppers",
        "10 10.01",
        &["row 9, column droppers", "10.01 m", "at least 0.1 m"],
    ),
    (
        9,
        "droppers",
        "0.01 10",
        &["row 9, column droppers", "0.01 m", "at least 0.1 m"],
    ),
    (9, "droppers", "five ten", &["row 9, column droppers", "five ten"]),
    (9, "droppers", "5;10", &["row 9, column droppers", "5;10"]),
    (9, "droppers", "NaN", &["row 9, column droppers"]),
];

#[test]
fn wrong_cells_are_refused_with_row_column_value_and_what_would_be_right() {
    for (line, column, value, parts) in WRONG_CELLS {
        let message = match read(TOML, &with(CSV, *line, column, value), &[]) {
            Err(message) => message,
            Ok(_) => panic!("line {line}, {column} = {value:?} is taken"),
        };
        assert!(message.contains("as-built.csv"), "{message}");
        for part in *parts {
            assert!(
                message.contains(part),
                "{line}, {column} = {value:?}: no {part:?} in {message}"
            );
        }
    }
}

#[test]
fn wrong_tables_are_refused_as_a_whole() {
    let header = CSV.lines().nth(1).unwrap();
    let replaced = |new: &str| CSV.replace(header, new);
    let cases: &[(String, &[&str])] = &[
        (String::new(), &["as-built.csv", "empty", "names of its columns"]),
        ("# nothing\n\n".to_owned(), &["empty"]),
        (header.to_owned(), &["without rows"]),
        (CSV.replace(',', ";"), &["separated by commas"]),
        (
            replaced(&header.replace("stagger_mm", "stagger")),
            &["stagger", "unknown", "stagger_m"],
        ),
        (
            replaced(&header.replace("stagger_mm", "staggr_mm")),
            &["staggr_mm", "did you mean", "stagger_mm"],
        ),
        (
            replaced(&header.replace("encumbrance_mm", "stagger_mm")),
            &["stagger_mm", "twice"],
        ),
        (
            replaced(&header.replace("remark", "stagger_m")),
            &["stagger_mm", "stagger_m has it"],
        ),
        (
            replaced(&header.replace("remark", "span_length_m")),
            &["chainage_m or span_length_m, one of the two"],
        ),
        (replaced(&header.replace("chainage_m", "remark")), &["remark", "twice"]),
        (
            CSV.lines()
                .filter(|line| !line.starts_with('#'))
                .map(|line| {
                    line.split_once(',').map_or(line, |(_, rest)| rest).to_owned()
                        + "
"
                })
                .collect(),
            &["chainage_m or span_length_m"],
        ),
        (
            CSV.lines().take(3).collect::<Vec<_>>().join("\n"),
            &["1 row", "at least two rows"],
        ),
        (CSV.replace(",ramp,", ",ramp,again,"), &["8 cells", "must have 7"]),
        (CSV.replace(",level crossing,", ","), &["6 cells", "must have 7"]),
    ];
    for (csv, parts) in cases {
        let message = read(TOML, csv, &[]).unwrap_err();
        for part in *parts {
            assert!(message.contains(part), "no {part:?} in {message}");
        }
    }
}

#[test]
fn what_a_table_and_the_scene_both_say_is_refused() {
    for (header, added, parts) in [
        ("[catenary]\n", "spans = 12", ["catenary.spans", "as-built.csv"]),
        ("[catenary]\n", "span_length = 50", ["catenary.span_length", "has it"]),
        ("[catenary]\n", "stagger = [0.2]", ["catenary.stagger", "has it"]),
        ("[catenary]\n", "presag = 0", ["catenary.presag", "has it"]),
        (
            "[catenary]\n",
            "presag_ratio = 0.001",
            ["catenary.presag_ratio", "has it"],
        ),
        (
            "[catenary]\n",
            "contact_wire_height = 5.3",
            ["catenary.contact_wire_height", "has it"],
        ),
        (
            "[catenary.droppers]",
            "\nrule = { first = 5, longest = 8 }",
            ["catenary.droppers.rule", "has it"],
        ),
        (
            "[catenary.droppers]",
            "\npositions = [5, 10]",
            ["catenary.droppers.positions", "has it"],
        ),
        (
            "[catenary.droppers]",
            "\ntable = \"as-built.csv\"",
            ["catenary.droppers.table", "has it"],
        ),
        (
            "[catenary.contact_wire]",
            "\nx = 1\n[[catenary.tension_length]]\nspans = 2",
            ["catenary.tension_length", "has it"],
        ),
    ] {
        let message = read(&TOML.replace(header, &format!("{header}{added}\n")), CSV, &[]).unwrap_err();
        for part in parts {
            assert!(message.contains(part), "{added}: no {part:?} in {message}");
        }
    }
    for (override_, parts) in [
        ("catenary.table=other.csv", ["catenary.table", "no file other.csv"]),
        ("catenary.table=3", ["catenary.table = 3", "the path of a file"]),
        ("catenary.from=lib.toml", ["catenary.from", "no file lib.toml"]),
    ] {
        let message = read(TOML, CSV, &[override_]).unwrap_err();
        for part in parts {
            assert!(message.contains(part), "{override_}: no {part:?} in {message}");
        }
    }
}

#[test]
fn an_override_takes_the_place_of_what_a_table_gave() {
    let line = |override_: &str| {
        let scene = read(TOML, CSV, &[override_]).unwrap();
        scene.modelled_line().unwrap().0.clone()
    };
    assert_eq!(line("catenary.stagger=[0.1]").tension_lengths[0].stagger, [0.1]);
    let changed = line("catenary.contact_wire_height[3]=5.31");
    assert_eq!(
        changed.tension_lengths[0].contact_wire_height[1..4],
        [5.302, 5.31, 5.305]
    );
    let presag = line("catenary.presag_ratio=0.001").tension_lengths[0].presag.clone();
    assert_eq!(presag[1], 0.0598);
    let droppers = line("catenary.droppers.rule={first=5, longest=10}").droppers;
    assert_eq!(droppers.positions[1], [5.0, 14.96, 24.92, 34.88, 44.84, 54.8]);
    let message = read(TOML, CSV, &["catenary.stagger[4]=0.9"]).unwrap_err();
    assert!(
        message.contains("--set catenary.stagger[4]=0.9: catenary.stagger[4] = 0.9 m"),
        "{message}"
    );
}

#[test]
fn wrong_rows_of_several_tension_lengths_are_refused() {
    let cases: &[(usize, &str, &str, &[&str])] = &[
        (4, "tension_length", "3", &["1 row", "at least two rows"]),
        (16, "chainage_m", "700", &["column chainage_m", "greater than 700"]),
        (
            16,
            "contact_wire_height_m",
            "30",
            &["row 16, column contact_wire_height_m", "at most 20 m"],
        ),
        (
            15,
            "presag_mm",
            "60",
            &["row 15, column presag_mm", "empty in the last row"],
        ),
    ];
    for (line, column, value, parts) in cases {
        let message = match read(WALK, &with(WALK_CSV, *line, column, value), &[]) {
            Err(message) => message,
            Ok(_) => panic!("line {line}, {column} = {value:?} is taken"),
        };
        for part in *parts {
            assert!(
                message.contains(part),
                "{line}, {column} = {value:?}: no {part:?} in {message}"
            );
        }
    }
    // The second tension length begins behind the end of the first.
    let gap: String = WALK_CSV
        .lines()
        .filter(|line| {
            !line.starts_with("1,651")
                && !line.starts_with("1,601")
                && !line.starts_with("1,541")
                && !line.starts_with("1,476")
        })
        .map(|line| format!("{line}\n"))
        .collect();
    let message = read(
        WALK,
        &gap.replace("1,413,5.300,1.4,-0.25,63", "1,413,5.300,1.4,-0.25,"),
        &[],
    )
    .unwrap_err();
    assert!(
        message.contains("start_x") && message.contains("strips need a wire everywhere"),
        "{message}"
    );
}

#[test]
fn wrong_rules_and_stitch_wires_are_refused() {
    for (override_, parts) in [
        (
            "catenary.droppers.rule={first=0, longest=8}",
            ["rule.first", "at least 0.1 m"],
        ),
        ("catenary.droppers.rule={first=5}", ["rule.longest", "missing"]),
        (
            "catenary.droppers.rule={first=5, longest=8, last=3}",
            ["rule.last", "unknown"],
        ),
        ("catenary.droppers.rule=5", ["catenary.droppers.rule = 5", "first"]),
        (
            "catenary.droppers.rule={first=\"5\", longest=8}",
            ["rule.first", "\"5\""],
        ),
        (
            "catenary.stitch_wires.length=130",
            ["stitch_wires.length = 130 m", "must be less"],
        ),
        (
            "catenary.stitch_wires.length=10.1",
            ["stitch_wires.length = 10.1 m", "between a clamp and the droppers"],
        ),
        (
            "catenary.stitch_wires.tension=28",
            ["stitch_wires.tension = 28 N", "at least 100 N"],
        ),
        (
            "catenary.stitch_wires.clamp_mass=-1",
            ["stitch_wires.clamp_mass", "zero or positive"],
        ),
        (
            "catenary.statics=nodal_displacement",
            ["catenary.statics", "form_finding"],
        ),
    ] {
        let message = read(WALK, WALK_CSV, &[override_]).unwrap_err();
        for part in parts {
            assert!(message.contains(part), "{override_}: no {part:?} in {message}");
        }
    }
}

#[test]
fn wrong_changes_and_masses_are_refused() {
    for (override_, parts) in [
        (
            "catenary.change.dropper[1].span=13",
            ["change.dropper[1].span = 13", "from 1 to 12"],
        ),
        (
            "catenary.change.dropper[1].dropper=40",
            ["change.dropper[1].dropper = 40", "from 1 to"],
        ),
        (
            "catenary.change.dropper[1].tension_length=2",
            ["change.dropper[1].tension_length = 2", "from 1 to 1"],
        ),
        (
            "catenary.change.dropper[1].longer_by=0.1",
            ["change.dropper[1].longer_by", "left out"],
        ),
        (
            "catenary.change.dropper[2].longer_by=0",
            ["change.dropper[2]", "longer_by in m"],
        ),
        (
            "catenary.point_mass[1].x=5000",
            ["point_mass[1].x = 5000 m", "inside its tension length"],
        ),
        ("catenary.point_mass[1].mass=0", ["point_mass[1].mass", "positive"]),
        (
            "catenary.point_mass[1].wire=stitch",
            ["point_mass[1].wire", "contact_wire"],
        ),
        (
            "catenary.surface={x=[1, 0], height=[0, 0]}",
            ["surface.x", "must ascend"],
        ),
        ("catenary.surface={x=[0, 1], height=[0]}", ["surface.height", "1 entry"]),
    ] {
        let message = read(TOML, CSV, &[override_]).unwrap_err();
        for part in parts {
            assert!(message.contains(part), "{override_}: no {part:?} in {message}");
        }
    }
}

#[test]
fn a_library_gives_keys_that_the_scene_may_replace() {
    let text = include_str!("../../../scenes/en50318-2018-ac-simple.toml");
    let library = include_str!("../../../pantographs/benchmark-2015.toml");
    let read = |library: &str| {
        let library = library.to_owned();
        let files = Files::new(move |_| Ok(library.clone()));
        let file = SceneFile::read(text, "line.toml", &[], &files).map_err(|error| error.to_string())?;
        Ok::<_, String>(file.scene)
    };
    assert_eq!(read(library).unwrap().pantographs.len(), 2);
    let replaced = read(&format!("{library}static_force = 1.0\n")).unwrap();
    let scene::PantographModel::Lumped(lumped) = &replaced.pantographs[0].model else {
        panic!("a lumped pantograph");
    };
    assert_eq!(lumped.static_force, 143.4);
    let message = read(&library.replace("masses = [7.5", "masses = [-7.5")).unwrap_err();
    assert!(
        message.contains("../pantographs/benchmark-2015.toml:") && message.contains("-7.5 kg"),
        "{message}"
    );
    let message = read(&library.replace("dampings", "damping")).unwrap_err();
    assert!(
        message.contains("benchmark-2015.toml") && message.contains("did you mean"),
        "{message}"
    );
    assert!(read("masses = [").unwrap_err().contains("not valid TOML"));
}

#[test]
fn every_shipped_pantograph_is_read() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../pantographs");
    let base = include_str!("../../../scenes/en50318-250.toml");
    let (line, _) = base.split_once("[[pantograph]]").unwrap();
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let text = format!("{line}[[pantograph]]\nfrom = {path:?}\nstatic_force = 100.0\n");
            let files = Files::new(|path| std::fs::read_to_string(path).map_err(|error| error.to_string()));
            SceneFile::read(&text, "line.toml", &[], &files)
                .map_err(|error| error.to_string())
                .unwrap();
            count += 1;
        }
    }
    assert!(count >= 5);
}

#[test]
fn no_cell_makes_the_reader_panic() {
    let lines = CSV.lines().count();
    let header = CSV.lines().nth(1).unwrap();
    for line in 3..=lines {
        for column in header.split(',') {
            for value in [
                "", "0", "-1", "1e308", "1e-308", "nan", "-inf", "a b c", "\"", "é", "1 2 3",
            ] {
                let _ = read(TOML, &with(CSV, line, column, value), &[]);
            }
        }
    }
}
