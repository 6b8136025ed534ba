//! Scenes that are changed at random: whatever a file says, the program answers with a scene or with a message.

use std::path::{Path, PathBuf};

use fastrand::Rng;
use scene::{Files, Scene};
use toml::{Table, Value};

use crate::texts::change_bytes;
use crate::{SEEDS, by_thousands, caught, kept, program_fault, unsaid};

/// Scenes that are changed, small ones among them.
const SCENES: [&str; 8] = [
    "ac-stitched",
    "as-built",
    "conductor-rail",
    "en50318-250",
    "overlap",
    "thesis-pantograph",
    "tram-single-wire",
    "walk",
];

/// Small lines, whose static state takes no time.
const SMALL: [&str; 2] = ["conductor-rail", "tram-single-wire"];

/// Folder of the scenes.
pub fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// Text of a scene of the source tree.
pub fn text(name: &str) -> String {
    std::fs::read_to_string(scenes().join(format!("{name}.toml"))).unwrap()
}

/// A way to a value: keys of tables and places in lists.
type Way = Vec<Step>;

#[derive(Clone)]
enum Step {
    Key(String),
    Place(usize),
}

/// Ways to all values below a value.
fn ways(value: &Value, way: &mut Way, found: &mut Vec<Way>) {
    let below: Vec<(Step, &Value)> = match value {
        Value::Table(table) => table
            .iter()
            .map(|(key, value)| (Step::Key(key.clone()), value))
            .collect(),
        Value::Array(list) => list
            .iter()
            .enumerate()
            .map(|(place, value)| (Step::Place(place), value))
            .collect(),
        _ => Vec::new(),
    };
    for (step, value) in below {
        way.push(step);
        found.push(way.clone());
        ways(value, way, found);
        way.pop();
    }
}

fn at<'a>(value: &'a mut Value, way: &[Step]) -> &'a mut Value {
    way.iter().fold(value, |value, step| match (value, step) {
        (Value::Table(table), Step::Key(key)) => &mut table[key.as_str()],
        (Value::Array(list), Step::Place(place)) => &mut list[*place],
        _ => unreachable!("the way was found in this value"),
    })
}

/// A value in place of another one.
fn other(rng: &mut Rng, value: &Value) -> Value {
    let number = value.as_float().or(value.as_integer().map(|number| number as f64));
    let numbers = [
        0.0,
        -1.0,
        1e-300,
        1e300,
        -1e300,
        f64::NAN,
        f64::INFINITY,
        1e-9,
        1e9,
        0.5,
        7.0,
    ];
    let integers = [0, -1, 1, 2, 1000, 1 << 40, i64::MAX, i64::MIN];
    let texts = [
        "",
        "auto",
        "none",
        "a\u{7}\u{1b}[31mb",
        "/dev/zero",
        "../walk.csv",
        "no such word",
        "π",
    ];
    match rng.u8(..12) {
        0..=3 if number.is_some() => {
            let factor = [-1.0, 0.1, 0.9, 1.1, 2.0, 10.0, 1e3, 1e6][rng.usize(..8)];
            Value::Float(number.unwrap_or(1.0) * factor)
        }
        0..=4 => Value::Float(numbers[rng.usize(..numbers.len())]),
        5 => Value::Integer(integers[rng.usize(..integers.len())]),
        6 => Value::String(texts[rng.usize(..texts.len())].to_owned()),
        7 => Value::Boolean(rng.bool()),
        8 => Value::Array(Vec::new()),
        9 => Value::Array(vec![value.clone(); 1 << rng.u32(..12)]),
        10 => Value::Table(Table::new()),
        _ => {
            let table = Table::from_iter([
                ("value".to_owned(), value.clone()),
                ("low".to_owned(), Value::Float(1.0)),
            ]);
            Value::Table(table)
        }
    }
}

/// Changes one thing of a scene.
fn change(rng: &mut Rng, scene: &mut Value) {
    let mut found = Vec::new();
    ways(scene, &mut Way::new(), &mut found);
    let way = &found[rng.usize(..found.len())];
    let (last, above) = way.split_last().expect("no way is empty");
    match rng.u8(..8) {
        0 => match (at(scene, above), last) {
            (Value::Table(table), Step::Key(key)) => drop(table.remove(key)),
            (Value::Array(list), Step::Place(place)) => drop(list.remove(*place)),
            _ => {}
        },
        1 => {
            let moved = at(scene, way).clone();
            match (at(scene, above), last) {
                (Value::Table(table), Step::Key(key)) => drop(table.insert(format!("{key}x"), moved)),
                (Value::Array(list), Step::Place(place)) => list.insert(*place, moved),
                _ => {}
            }
        }
        2 => {
            let taken = at(scene, &found[rng.usize(..found.len())]).clone();
            *at(scene, way) = taken;
        }
        _ => {
            let value = at(scene, way);
            *value = other(rng, value);
        }
    }
}

/// A text of TOML that is changed in one to three things, or as bytes.
pub fn changed(rng: &mut Rng, text: &str) -> String {
    if rng.u8(..8) == 0 {
        let mut bytes = text.as_bytes().to_vec();
        change_bytes(rng, &mut bytes);
        return String::from_utf8_lossy(&bytes).into_owned();
    }
    let mut scene = Value::Table(text.parse().unwrap());
    for _ in 0..rng.usize(1..4) {
        change(rng, &mut scene);
    }
    toml::to_string(&scene).unwrap()
}

fn load(text: &str) -> Result<Scene, String> {
    let files = Files::new(|path| std::fs::read_to_string(scenes().join(path)).map_err(|error| error.to_string()));
    system::load_with(text, "changed.toml", &[], &files).map_err(|error| error.to_string())
}

/// Reads changed scenes: a scene, which reads back as it is written, or a message.
fn read(seed: u64, count: usize) {
    let mut rng = Rng::with_seed(seed);
    for number in 0..count {
        let text = changed(&mut rng, &text(SCENES[number % SCENES.len()]));
        let fault = caught(|| match load(&text) {
            // Control characters are escaped where they are printed.
            Err(said) => unsaid(&said),
            Ok(scene) => match load(&scene.to_toml()) {
                Ok(again) if again == scene => None,
                Ok(_) => Some("it reads back as another scene".to_owned()),
                Err(said) => Some(format!("it does not read back: {said}")),
            },
        });
        if let Some(fault) = fault {
            panic!("seed {seed}, {}: {fault}", kept(text.as_bytes(), "toml", seed, number));
        }
    }
}

/// Solves changed scenes: the program ends in time and memory, with status 0, 1 or 2 and a message where it is not 0.
fn solve(seed: u64, count: usize) {
    let mut rng = Rng::with_seed(seed);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.toml");
    let mut number = 0;
    while number < count {
        let text = changed(&mut rng, &text(SMALL[number % SMALL.len()]));
        // Most changes are refused when they are read, which `read` tries.
        if load(&text).is_err() {
            continue;
        }
        number += 1;
        std::fs::write(&path, &text).unwrap();
        let arguments = ["check", "-q", "--json", "changed.toml"];
        if let Some(fault) = program_fault(folder.path(), &arguments, &["changed.toml"]) {
            panic!("seed {seed}, {}: {fault}", kept(text.as_bytes(), "toml", seed, number));
        }
    }
}

#[test]
fn changed_scenes_are_read_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| read(seed, 400));
}

#[test]
fn changed_scenes_are_solved_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| solve(seed, 12));
}

#[test]
#[ignore = "for hours: thousands of scenes; ATTACK_SEED chooses others"]
fn attack_by_scenes() {
    by_thousands(read, 20_000, "scenes read");
    by_thousands(solve, 500, "scenes solved");
}
