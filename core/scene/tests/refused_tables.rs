//! Wrong tables of two tension lengths and of their droppers: refused with file, row, column, value and what is right.

use scene::{Catenary, Files, Scene, SceneFile};

const OVERLAP: &str = include_str!("../../../scenes/overlap.toml");

const SUPPORTS: &str = "\
# Two tension lengths that overlap between chainages 1180 and 1300 m.
tension_length,chainage_m,contact_wire_height_m,encumbrance_m,stagger_m,presag_m,droppers

east,1000,5.3,1.2,0.2,0,long
east,1060,5.3,1.2,-0.2,0,long
east,1120,5.3,1.2,0.2,0,5 15 25 35 45 55
east,1180,5.3,1.2,-0.1,0,short
east,1240,5.34,1.2,-0.25,0,short
east,1300,5.8,1.2,-0.4,,
west,1180,5.8,1.2,0.5,0,short
west,1240,5.3,1.2,0.3,0,long
west,1300,5.3,1.2,0.1,0,long
west,1360,5.3,1.2,-0.1,0,none
west,1420,5.3,1.2,0.2,0,long
west,1480,5.3,1.2,-0.2,,
";

const DROPPERS: &str = "\
tension_length,span,position_m
east,1,20
east,1,40
east,2,30
east,3,30
east,4,30
east,5,30
west,1,30
west,2,30
west,3,
west,4,30
west,5,10
west,5,50
";

/// The scene of the overlap with a table in place of its tension lengths.
fn scene() -> String {
    let (head, rest) = OVERLAP.split_once("[[catenary.tension_length]]").unwrap();
    let (_, rest) = rest.split_once("[catenary.contact_wire]").unwrap();
    let text = format!("{head}table = \"supports.csv\"\n[catenary.contact_wire]{rest}");
    let start = text.find("positions = ").unwrap();
    let end = start + text[start..].find('\n').unwrap();
    let patterns = "patterns = { long = [5, 20, 40, 55], short = [10, 50] }";
    let text = format!("{}{patterns}{}", &text[..start], &text[end..]);
    let evaluate = text.replace("evaluate = { spans = [4, 8] }", "evaluate = { spans = [3, 5] }");
    evaluate.replace("duration = 9.0", "duration = 6.0")
}

/// The same with the droppers in a table of their own.
fn scene_with_droppers() -> String {
    scene().replace(
        "[catenary.droppers]\n",
        "[catenary.droppers]\ntable = \"droppers.csv\"\n",
    )
}

fn without_column(csv: &str, name: &str) -> String {
    let header = csv.lines().find(|line| !line.starts_with('#')).unwrap();
    let place = header.split(',').position(|column| column == name).unwrap();
    let line = |line: &str| match line.starts_with('#') || line.is_empty() {
        true => line.to_owned(),
        false => {
            let cells = line.split(',').enumerate().filter(|(index, _)| *index != place);
            cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
        }
    };
    csv.lines().map(|text| line(text) + "\n").collect()
}

fn read(text: &str, supports: &str, droppers: &str) -> Result<Scene, String> {
    let files = Files::new(|path| match path {
        "supports.csv" => Ok(supports.to_owned()),
        "droppers.csv" => Ok(droppers.to_owned()),
        other => Err(format!("cannot be read: no file {other}")),
    });
    let read = SceneFile::read(text, "line.toml", &[], &files);
    let read = read.and_then(|file| file.check(&|_| Vec::new()).map(|()| file.scene));
    read.map_err(|error| error.to_string())
}

fn line(scene: &Scene) -> &Catenary {
    scene.modelled_line().unwrap().0
}

fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from:?} in\n{text}");
    text.replacen(from, to, 1)
}

fn holds(message: &Result<Scene, String>, edit: &str, parts: &[&str]) {
    match message {
        Ok(_) => panic!("{edit}: is taken"),
        Err(message) => {
            for part in parts {
                assert!(message.contains(part), "{edit}: no {part:?} in\n{message}");
            }
        }
    }
}

/// (what is replaced in the table of supports, by what, parts of the message).
#[rustfmt::skip]
const SUPPORTS_EDITS: &[(&str, &str, &[&str])] = &[
    // The header.
    ("chainage_m", "chainage", &["supports.csv:2: column = \"chainage\": unknown without its unit: must be \
        chainage_m or chainage_mm"]),
    ("stagger_m", "stagger", &["supports.csv:2: column = \"stagger\": unknown without its unit: must be stagger_m or \
        stagger_mm"]),
    ("stagger_m", "stagger_ft", &["supports.csv:2: column = \"stagger_ft\": unknown column, did you mean \
        \"stagger_m\"?"]),
    ("encumbrance_m", "encumberance_m", &["column = \"encumberance_m\": unknown column, did you mean \
        \"encumbrance_m\"?"]),
    ("droppers", "dropper", &["column = \"dropper\": unknown column, did you mean \"droppers\"?", "known columns: \
        tension_length"]),
    ("stagger_m", "presag_m", &["supports.csv:2: column = \"presag_m\": must be there once, is there twice"]),
    ("stagger_m", "presag_mm", &["supports.csv:2: presag_mm: must be left out: presag_m has it"]),
    ("presag_m", "span_length_m", &["supports.csv:2: columns = both: must be chainage_m or span_length_m, one of the \
        two"]),
    ("chainage_m", "span_length_m", &["columns = span_length_m: must be chainage_m in place of span_length_m, so \
        that 2 tension lengths have places"]),
    ("stagger_m", "messenger_stagger_m", &["supports.csv:2: stagger_m is missing: must be a column of the table, or \
        catenary.stagger"]),
    ("presag_m", "curve_radius_m", &["supports.csv:2: presag_m is missing", "catenary.presag a key of the scene"]),
    ("contact_wire_height_m", "messenger_stagger_m", &["supports.csv:2: contact_wire_height_m is missing"]),
    ("encumbrance_m", "messenger_stagger_m", &["supports.csv:2: encumbrance_m is missing"]),
    ("chainage_m,", "chainage_m;", &["supports.csv:2: table = \"tension_length", "must be separated by commas, with \
        points in decimals"]),
    ("chainage_m,", "chainage_m\t", &["supports.csv:2", "must be separated by commas"]),
    ("chainage_m", "\"chainage_m", &["supports.csv:2", "must end each \"…\" with a quotation mark"]),
    ("tension_length,", ",", &["supports.csv:2: column = \"\": unknown column"]),
    ("tension_length,", "", &["supports.csv:4: row = 7 cells: must have 6, one per column; a decimal comma"]),
    // Rows as a whole.
    ("east,1060,", "east,1060,0,", &["supports.csv:5: row = 8 cells: must have 7, one per column; a decimal comma \
        makes two cells of one"]),
    ("east,1060,5.3", "east,1060,5,3", &["supports.csv:5: row = 8 cells: must have 7", "write points"]),
    ("east,1060,", "east,", &["supports.csv:5: row = 6 cells: must have 7, one per column"]),
    ("east,1060,5.3,1.2,-0.2,0,long", "east,1060,5.3,1.2,-0.2,0,\"long", &["supports.csv:5: row = east", "must end \
        each"]),
    ("east,1000", "eest,1000", &["supports.csv:4: tension_length = 1 row: must have at least two rows, one for each \
        support of tension length \"eest\""]),
    ("east,1060", ",1060", &["supports.csv, row 5, column tension_length: tension_length is missing: must be the \
        number or name of a tension length, in every row"]),
    // Chainages.
    ("east,1060", "east,", &["row 5, column chainage_m: chainage_m is missing: must be a number in m"]),
    ("east,1060", "east,km 1", &["row 5, column chainage_m: chainage_m = \"km 1\": must be a number in m, with a \
        point in decimals"]),
    ("east,1060", "east,1060 m", &["row 5, column chainage_m: chainage_m = \"1060 m\": must be a number in m"]),
    ("east,1060", "east,1000", &["row 5, column chainage_m: chainage_m = 1000 m: must be greater than 1000 m in row \
        4 of the same tension length"]),
    ("east,1060", "east,990", &["row 5, column chainage_m: chainage_m = 990 m: must be greater than 1000 m in row 4"]),
    ("east,1060", "east,1e999", &["row 5, column chainage_m: chainage_m = \"1e999\": must be a number in m"]),
    ("east,1060", "east,-inf", &["row 5, column chainage_m", "\"-inf\""]),
    ("east,1060", "east,1000.0000001", &["row 4, column chainage_m: catenary.tension_length[1].span_length[1] = 0 m: \
        must be positive"]),
    ("west,1480", "west,91480", &["row 14, column chainage_m: catenary.tension_length[2].span_length[5] = 90060 m: \
        must be at most 5000 m"]),
    ("west,1180,5.8,1.2,0.5,0,short\nwest,1240,5.3,1.2,0.3,0,long\nwest,1300", "west,1310", &["row 10, column \
        chainage_m: \
        catenary.tension_length[2].start_x = 310 m: must be at most 300 m", "strips need a wire everywhere"]),
    // Heights.
    ("east,1060,5.3,", "east,1060,,", &["row 5, column contact_wire_height_m: contact_wire_height_m is missing: must \
        be a number in m"]),
    ("east,1060,5.3,", "east,1060,nan,", &["row 5, column contact_wire_height_m: contact_wire_height_m = \"nan\""]),
    ("east,1060,5.3,", "east,1060,5300,", &["row 5, column contact_wire_height_m: \
        catenary.tension_length[1].contact_wire_height[2] = \
        5300 m: must be at most 20 m above the top of rail; 5300 mm are 5.3 m"]),
    ("east,1060,5.3,", "east,1060,0,", &["row 5, column contact_wire_height_m: \
        catenary.tension_length[1].contact_wire_height[2] = 0 m: \
        must be positive and finite"]),
    ("east,1060,5.3,1.2", "east,1060,5.3,-1.2", &["row 5, column encumbrance_m: \
        catenary.tension_length[1].encumbrance[2] = -1.2 m: must \
        be positive and finite"]),
    ("east,1060,5.3,1.2", "east,1060,5.3,", &["row 5, column encumbrance_m: encumbrance_m is missing"]),
    // Lateral positions.
    ("1.2,-0.2,0,long", "1.2,,0,long", &["row 5, column stagger_m: stagger_m is missing"]),
    ("1.2,-0.2,0,long", "1.2,-0.9,0,long", &["row 5, column stagger_m: catenary.tension_length[1].stagger[2] = -0.9 \
        m: must be within \
        ±0.8 m, half the width of the strip of pantograph[1]"]),
    ("1.2,-0.2,0,long", "1.2,-200,0,long", &["row 5, column stagger_m: catenary.tension_length[1].stagger[2] = -200 \
        m"]),
    ("1.2,-0.2,0,long", "1.2,left,0,long", &["row 5, column stagger_m: stagger_m = \"left\": must be a number in m"]),
    // Presag.
    ("1.2,-0.2,0,long", "1.2,-0.2,,long", &["row 5, column presag_m: presag_m is missing: must be a number in m"]),
    ("1.2,-0.2,0,long", "1.2,-0.2,5.4,long", &["row 5, column presag_m: catenary.tension_length[1].presag[2] = 5.4 \
        m: must be less than \
        contact_wire_height = 5.3 m"]),
    ("5.8,1.2,-0.4,,", "5.8,1.2,-0.4,0,", &["row 9, column presag_m: presag_m = \"0\": must be empty in the last row \
        of a tension length"]),
    ("5.3,1.2,-0.2,,", "5.3,1.2,-0.2,,long", &["row 15, column droppers: droppers = \"long\": must be empty in the \
        last row"]),
    // Droppers.
    ("0.3,0,long", "0.3,0,", &["row 11, column droppers: droppers is missing: must be positions in m with spaces \
        between, the name of a \
        pattern, or none"]),
    ("0.3,0,long", "0.3,0,lang", &["row 11, column droppers: catenary.tension_length[2].dropper_positions = \
        \"lang\": unknown word, did you \
        mean \"long\"?; must be \"long\" or \"short\""]),
    ("0.3,0,long", "0.3,0,10 sixty", &["row 11, column droppers: catenary.tension_length[2].dropper_positions = \"10 \
        sixty\": unknown word"]),
    ("0.3,0,long", "0.3,0,10 70", &["row 11, column droppers: catenary.tension_length[2].dropper_positions[2][2] = \
        70 m: must be inside its \
        span, between 0 and 60 m"]),
    ("0.3,0,long", "0.3,0,50 10", &["row 11, column droppers: catenary.tension_length[2].dropper_positions[2][2] = \
        10 m: must be greater \
        than the position before it, 50 m"]),
    ("0.3,0,long", "0.3,0,50 50.05", &["row 11, column droppers", "50.05 m: must be at least 0.1 m from the position \
        before it"]),
    ("west,1300", "west,1296", &["accepted"]),
    // Overlaps.
    ("east,1300,5.8", "east,1300,5.1", &["supports.csv, row 9, column contact_wire_height_m: \
        catenary.tension_length[1].contact_wire_height[6] = 5.1 m: must be at least 5.200 m where its tension length \
        ends, at x = 300 m: \
        the contact wire of tension length 2 is at 5.300 m there, and a strip would lose its wire"]),
    ("west,1180,5.8", "west,1180,5.1", &["supports.csv, row 10, column contact_wire_height_m: \
        catenary.tension_length[2].contact_wire_height[1] = 5.1 m: must be at least 5.200 m where its tension length \
        begins, at x = 180 m",
        "a strip would come under it"]),
    ("east,1240,5.34", "east,1240,4.8", &["accepted"]),
];

#[test]
fn wrong_supports_are_refused() {
    read(&scene(), SUPPORTS, "").unwrap();
    for (from, to, parts) in SUPPORTS_EDITS {
        let message = read(&scene(), &edited(SUPPORTS, from, to), "");
        if parts.contains(&"accepted") {
            assert!(message.is_ok(), "{to:?}: {message:?}");
        } else {
            holds(&message, &format!("{to:?}"), parts);
        }
    }
}

/// (what is replaced in the table of droppers, by what, parts of the message).
#[rustfmt::skip]
const DROPPERS_EDITS: &[(&str, &str, &[&str])] = &[
    ("position_m", "position", &["droppers.csv:1: column = \"position\": unknown without its unit: must be \
        position_m or position_mm"]),
    ("position_m", "remark", &["droppers.csv:1: position_m is missing: must be a column of the table"]),
    ("span,", "spam,", &["droppers.csv:1: column = \"spam\": unknown column, did you mean \"span\"?"]),
    ("span,", "remark,", &["droppers.csv:1: span is missing: must be a column of the table"]),
    ("tension_length,", "remark,", &["droppers.csv:1: tension_length is missing: must be a column of the table where \
        there are several"]),
    ("east,1,20", "eest,1,20", &["droppers.csv, row 2, column tension_length: tension_length = \"eest\": must be one \
        of the tension \
        lengths east, west"]),
    ("east,1,20", "1,1,20", &["droppers.csv, row 2, column tension_length: tension_length = \"1\""]),
    ("east,1,20", "east,0,20", &["droppers.csv, row 2, column span: span = \"0\": must be a whole number from 1 to 5"]),
    ("east,1,20", "east,6,20", &["droppers.csv, row 2, column span: span = \"6\": must be a whole number from 1 to 5"]),
    ("east,1,20", "east,1.5,20", &["droppers.csv, row 2, column span: span = \"1.5\""]),
    ("east,1,20", "east,,20", &["droppers.csv, row 2, column span: span is missing: must be a whole number from 1 to \
        5, in every row"]),
    ("east,1,20", "east,1,left", &["droppers.csv, row 2, column position_m: position_m = \"left\": must be a number \
        in m"]),
    ("east,1,20", "east,1,60", &["droppers.csv, row 2, column position_m: \
        catenary.tension_length[1].dropper_positions[1][1] = 60 m: must \
        be inside its span, between 0 and 60 m"]),
    ("east,1,20", "east,1,50", &["droppers.csv, row 3, column position_m: \
        catenary.tension_length[1].dropper_positions[1][2] = 40 m: must \
        be greater than the position before it, 50 m"]),
    ("east,1,20", "east,1,", &["droppers.csv, row 3, column position_m: position_m = 40: must be left out: a row \
        before says that this \
        span has no droppers"]),
    ("east,1,40", "east,1,", &["droppers.csv, row 3, column position_m: position_m is missing: must be a position, \
        as the span has another row"]),
    ("west,4,30\n", "", &["droppers.csv:1: span is missing: must be a row for span 4 of tension length west, with an \
        empty position"]),
    ("west,4,30", "west,4,30,5", &["droppers.csv:11: row = 4 cells: must have 3"]),
];

#[test]
fn wrong_tables_of_droppers_are_refused() {
    let supports = without_column(SUPPORTS, "droppers");
    let good = read(&scene_with_droppers(), &supports, DROPPERS).unwrap();
    let [east, west] = line(&good).tension_lengths.as_slice() else {
        panic!("two tension lengths");
    };
    assert_eq!(east.dropper_positions[0], [20.0, 40.0]);
    assert_eq!(west.dropper_positions[2..], [vec![], vec![30.0], vec![10.0, 50.0]]);
    for (from, to, parts) in DROPPERS_EDITS {
        let message = read(&scene_with_droppers(), &supports, &edited(DROPPERS, from, to));
        holds(&message, &format!("{to:?}"), parts);
    }
    let both = read(&scene_with_droppers(), SUPPORTS, DROPPERS);
    holds(
        &both,
        "both",
        &[
            "line.toml:",
            "catenary.droppers.table: must be left out: the table \"supports.csv\" has it",
        ],
    );
}

/// (what is replaced in the scene, by what, parts of the message), without the column of droppers.
#[rustfmt::skip]
const SCENE_EDITS: &[(&str, &str, &[&str])] = &[
    ("patterns = {", "pattern = \"lang\"\npatterns = {", &["catenary.droppers.pattern = \"lang\": unknown word, did \
        you mean \"long\"?"]),
    ("patterns = {", "pattern = [\"long\", \"short\"]\npatterns = {", &["catenary.droppers.pattern = [\"long\", \
        \"short\"]: must be one name \
        for all spans: give each tension length its own dropper_pattern"]),
    ("patterns = {", "pattern = 3\npatterns = {", &["catenary.droppers.pattern = 3: must be the name of a pattern"]),
    ("patterns = {", "pattern = \"long\"\nrule = { first = 5, longest = 8 }\npatterns = {", &["catenary.droppers"]),
    ("patterns = { long", "pattern = \"long\"\npatterns = { 5 = [10], long", &["catenary.droppers.patterns.5 = [10]: \
        must have a name that is \
        no number and not none"]),
    ("short = [10, 50]", "short = 10", &["catenary.droppers.patterns.short = 10: must be a list of numbers in m"]),
    ("short = [10, 50]", "short = [10, \"x\"]", &["catenary.droppers.patterns.short[2] = \"x\": must be a number in \
        m"]),
    ("patterns = {", "rule = { first = 40, longest = 8 }\npatterns = {", &["catenary.droppers.rule.first = 40 m: \
        must be at most 30 m, half \
        of the shortest span of catenary.tension_length[1]"]),
    ("patterns = {", "rule = { frist = 4, longest = 8 }\npatterns = {", &["catenary.droppers.rule.frist: unknown \
        key, did you mean \
        \"first\"?"]),
    ("patterns = {", "rule = { first = 5, longest = -8 }\npatterns = {", &["catenary.droppers.rule.longest = -8: \
        must be a length of at least \
        0.1 m"]),
    ("patterns = {", "patterns = {", &["catenary.droppers.positions is missing: must be a list of numbers in m, at \
        least one, or a rule"]),
    ("table = \"supports.csv\"", "table = \"other.csv\"", &["line.toml:17: catenary.table = \"other.csv\": cannot be \
        read: no file other.csv"]),
    ("[catenary.droppers]\n", "[catenary.droppers]\ntable = \"other.csv\"\n", &["catenary.droppers.table = \
        \"other.csv\": cannot be read"]),
    ("table = \"supports.csv\"", "", &["catenary.spans is missing"]),
    ("table = \"supports.csv\"", "table = \"supports.csv\"\ntables = \"x\"", &["catenary.tables: unknown key, did \
        you mean \"table\"?"]),
    ("table = \"supports.csv\"", "table = \"supports.csv\"\npresag = 0.0", &["line.toml:18: catenary.presag: must be \
        left out: the table \
        \"supports.csv\" has it"]),
    ("table = \"supports.csv\"", "table = \"supports.csv\"\npresag_ratio = 0.001", &["catenary.presag_ratio: must be \
        left out"]),
];

#[test]
fn wrong_keys_beside_a_table_are_refused() {
    let supports = without_column(SUPPORTS, "droppers");
    for (from, to, parts) in SCENE_EDITS {
        holds(
            &read(&edited(&scene(), from, to), &supports, ""),
            &format!("{to:?}"),
            parts,
        );
    }
    let supports = without_column(&supports, "presag_m");
    for (ratio, part) in [
        (
            "0.05",
            "catenary.tension_length[1].presag_ratio = 0.05: must be a share of each span within ±0.02",
        ),
        ("\"1/1000\"", "presag_ratio = \"1/1000\": must be a share of each span"),
    ] {
        let text = edited(&scene(), "patterns = {", "pattern = \"long\"\npatterns = {");
        let text = edited(&text, "table = ", &format!("presag_ratio = {ratio}\ntable = "));
        holds(&read(&text, &supports, ""), ratio, &[part]);
    }
}

#[test]
fn a_table_leaves_to_the_scene_what_it_has_no_column_for() {
    let supports = without_column(&without_column(SUPPORTS, "presag_m"), "encumbrance_m");
    let text = edited(
        &scene(),
        "table = ",
        "encumbrance = 1.3\npresag_ratio = 0.001\ntable = ",
    );
    let scene = read(&text, &supports, "").unwrap();
    for tension_length in &line(&scene).tension_lengths {
        assert_eq!(
            (tension_length.encumbrance.as_slice(), tension_length.presag.as_slice()),
            (&[1.3][..], &[0.06][..])
        );
    }
    assert_eq!(Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap(), scene);
}

#[test]
fn millimetres_quotation_marks_and_remarks_change_nothing() {
    let plain = read(&scene(), SUPPORTS, "").unwrap();
    let quoted = SUPPORTS
        .replace("5 15 25 35 45 55", "\"5 15 25 35 45 55\"")
        .replace("east", "\"east\"");
    assert_eq!(read(&scene(), &quoted, "").unwrap(), plain);
    let millimetres = SUPPORTS.replace("contact_wire_height_m", "contact_wire_height_mm");
    let millimetres = millimetres
        .replace(",5.34,", ",5340,")
        .replace(",5.3,", ",5300,")
        .replace(",5.8,", ",5800,");
    assert_eq!(read(&scene(), &millimetres, "").unwrap(), plain);
    let spaced = SUPPORTS.replace("\nwest,1300", "\n\n# A remark, with a comma\n  west , 1300");
    assert_eq!(read(&scene(), &spaced, "").unwrap(), plain);
    // Rows in the order of their chainages.
    let mut rows: Vec<&str> = SUPPORTS.lines().skip(3).collect();
    rows.sort_by_key(|row| row.split(',').nth(1).unwrap().parse::<u32>().unwrap());
    let head: Vec<&str> = SUPPORTS.lines().take(3).collect();
    let sorted = format!("{}\n{}\n", head.join("\n"), rows.join("\n"));
    assert_eq!(read(&scene(), &sorted, "").unwrap(), plain);
}

#[test]
fn differences_of_decimal_chainages_are_decimals() {
    // The place 1060.1 m and those of the overlap have no short binary fraction.
    let supports = SUPPORTS
        .replace("east,1060", "east,1060.1")
        .replace(",1180,", ",1180.3,")
        .replace(",1240,", ",1240.7,");
    let scene = read(&scene(), &supports, "").unwrap();
    let [east, west] = line(&scene).tension_lengths.as_slice() else {
        panic!("two tension lengths");
    };
    assert_eq!(east.span_lengths, [60.1, 59.9, 60.3, 60.4, 59.3]);
    assert_eq!((west.start_x, west.span_lengths[0]), (180.3, 60.4));
    // Supports of both at one chainage are one mast.
    assert_eq!(line(&scene).spans(), 8);
}

#[test]
fn a_wire_on_its_way_to_the_anchor_may_be_beside_the_strips() {
    let supports = SUPPORTS.replace("east,1300,5.8,1.2,-0.4", "east,1300,5.8,1.2,-2.5");
    read(&scene(), &supports, "").unwrap();
}

#[test]
fn no_table_makes_the_reader_panic() {
    let values = [
        "",
        "0",
        "-1",
        "1e308",
        "-1e308",
        "1e-308",
        "nan",
        "-inf",
        "a b c",
        "\"",
        "\"\"",
        "é",
        "1 2 3",
        "1;2",
        "none",
        "long",
        "#",
        "9007199254740993",
        "0x10",
        "1_000",
        "+5",
        "\u{feff}",
        "1e400",
        ",",
        "\u{0}",
        "१",
    ];
    let mutate = |csv: &str, mut visit: Box<dyn FnMut(String) + '_>| {
        let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        for (row, cells) in lines.iter().enumerate() {
            for column in 0..cells.len() {
                for value in values {
                    let mut changed = lines.clone();
                    changed[row][column] = value;
                    let text: Vec<String> = changed.iter().map(|cells| cells.join(",")).collect();
                    visit(text.join("\n"));
                }
            }
        }
        // Cut anywhere, and lines left out.
        for end in csv.char_indices().map(|(end, _)| end).step_by(7) {
            visit(csv[..end].to_owned());
        }
        for left_out in 0..lines.len() {
            let text = csv.lines().enumerate().filter(|(row, _)| *row != left_out);
            visit(text.map(|(_, line)| line.to_owned() + "\n").collect());
        }
    };
    let text = scene();
    mutate(SUPPORTS, Box::new(|csv| drop(read(&text, &csv, ""))));
    let (text, supports) = (scene_with_droppers(), without_column(SUPPORTS, "droppers"));
    mutate(DROPPERS, Box::new(|csv| drop(read(&text, &supports, &csv))));
}

#[test]
fn a_rule_that_makes_droppers_beyond_counting_is_refused_before_they_are_made() {
    let curve = include_str!("../../../scenes/curve.toml");
    let said = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        let files = Files::none();
        let file = SceneFile::read(curve, "curve.toml", &overrides, &files).and_then(|file| {
            file.check(&|_| scene::Found::new())?;
            Ok(file.scene)
        });
        file.expect_err("it is refused").to_string()
    };
    let said_of_rule = said(&[
        "catenary.spans=5000",
        "catenary.span_length=50",
        "catenary.droppers.rule.longest=0.5",
    ]);
    assert!(
        said_of_rule.contains("catenary.droppers.rule.longest = 0.5 m: must be at least 2.5 m"),
        "{said_of_rule}"
    );
    let said_of_span = said(&["catenary.span_length=1e13"]);
    assert!(said_of_span.contains("catenary.span_length"), "{said_of_span}");
}
