//! Tables of real lines that are changed at random: the scene is read with them, or file, row and column are named.

use fastrand::Rng;
use scene::{Files, Scene};

use crate::scenes::{scenes, text};
use crate::texts::{ODD, change_bytes};
use crate::{SEEDS, by_thousands, caught, dice, kept, unsaid};

/// A scene with a table beside it.
struct Base {
    scene: String,
    name: &'static str,
    table: String,
}

/// Tables of lines, of droppers and of the roughness of a track.
fn bases() -> Vec<Base> {
    let table = |name| std::fs::read_to_string(scenes().join(name)).unwrap();
    let of_droppers = || {
        let spans = (1..=10).flat_map(|span| [5.0, 15.0, 25.0, 35.0, 45.0].map(|at| format!("1,{span},{at:.1}\n")));
        format!("tension_length,span,position_m\n{}", spans.collect::<String>())
    };
    let with_droppers = {
        let scene = text("en50318-250");
        let (before, after) = scene.split_once("[catenary.droppers]").unwrap();
        let lines = after.lines().filter(|line| !line.starts_with("positions"));
        format!(
            "{before}[catenary.droppers]\ntable = \"droppers.csv\"{}",
            lines.collect::<Vec<_>>().join("\n")
        )
    };
    vec![
        Base {
            scene: text("walk"),
            name: "walk.csv",
            table: table("walk.csv"),
        },
        Base {
            scene: text("as-built"),
            name: "as-built.csv",
            table: table("as-built.csv"),
        },
        Base {
            scene: with_droppers,
            name: "droppers.csv",
            table: of_droppers(),
        },
    ]
}

/// Another cell in place of this one.
fn other(rng: &mut Rng, cell: &str) -> String {
    match (cell.trim().parse::<f64>(), rng.u8(..8)) {
        (Ok(number), 0..=2) => {
            let factor = [-1.0, 0.0, 0.5, 1.001, 2.0, 10.0, 1e3, 1e9, 1e-6][rng.usize(..9)];
            (number * factor).to_string()
        }
        (Ok(number), 3) => (number + [1e-9, 0.1, -5.0, 1e4][rng.usize(..4)]).to_string(),
        (_, 4) => format!("\"{cell}"),
        (_, 5) => format!("\"{cell}\""),
        (_, 6) => format!("{cell} {cell} 1e9 {cell}"),
        _ => ODD[rng.usize(..ODD.len())].to_owned(),
    }
}

/// Changes one thing of a table.
fn change(rng: &mut Rng, rows: &mut Vec<Vec<String>>) {
    if rows.is_empty() {
        return;
    }
    let row = rng.usize(..rows.len());
    // The names of the columns are found among the first rows.
    let row = if rng.u8(..5) == 0 { row.min(3) } else { row };
    let column = rng.usize(..rows[row].len().max(1));
    match rng.u8(..16) {
        0 => drop(rows.remove(row)),
        1 => {
            let again = rows[row].clone();
            let target = rng.usize(..=rows.len());
            rows.insert(target, again);
        }
        2 => {
            let other = rng.usize(..rows.len());
            rows.swap(row, other);
        }
        3 => rows.truncate(row),
        4 => rows
            .iter_mut()
            .filter(|row| column < row.len())
            .for_each(|row| drop(row.remove(column))),
        5 => rows
            .iter_mut()
            .filter(|row| column < row.len())
            .for_each(|row| row.push(row[column].clone())),
        6 => drop(rows[row].pop()),
        7 => rows[row].push(ODD[rng.usize(..ODD.len())].to_owned()),
        8 => {
            let again = rows[row].clone();
            let count = 1 << rng.u32(..11);
            rows.splice(row..row, std::iter::repeat_n(again, count));
        }
        _ => {
            if let Some(cell) = rows[row].get_mut(column) {
                *cell = other(rng, cell);
            }
        }
    }
}

/// A table that is changed in one to three cells, rows or columns, or as bytes.
fn changed(rng: &mut Rng, table: &str) -> Vec<u8> {
    if rng.u8(..8) == 0 {
        let mut bytes = table.as_bytes().to_vec();
        change_bytes(rng, &mut bytes);
        return bytes;
    }
    let mut rows: Vec<Vec<String>> = table
        .lines()
        .map(|line| match line.starts_with('#') {
            true => vec![line.to_owned()],
            false => line.split(',').map(str::to_owned).collect(),
        })
        .collect();
    for _ in 0..rng.usize(1..4) {
        change(rng, &mut rows);
    }
    let (comma, end) = match rng.u8(..20) {
        0 => (";", "\n"),
        1 => (",", "\r\n"),
        2 => ("\t", "\n"),
        _ => (",", "\n"),
    };
    let lines: Vec<String> = rows.iter().map(|row| row.join(comma)).collect();
    let mark = if rng.u8(..20) == 0 { "\u{feff}" } else { "" };
    format!("{mark}{}{end}", lines.join(end)).into_bytes()
}

fn load(base: &Base, table: &str) -> Result<Scene, String> {
    let files = Files::new(|path| match path == base.name {
        true => Ok(table.to_owned()),
        false => std::fs::read_to_string(scenes().join(path)).map_err(|error| error.to_string()),
    });
    system::load_with(&base.scene, "changed.toml", &[], &files).map_err(|error| error.to_string())
}

fn read(seed: u64, count: usize) {
    let bases = bases();
    for number in 0..count {
        let base = &bases[number % bases.len()];
        let bytes = changed(&mut dice(seed, number), &base.table);
        let table = String::from_utf8_lossy(&bytes);
        let fault = caught(|| match load(base, &table) {
            Err(said) => unsaid(&said),
            Ok(scene) => match system::load(&scene.to_toml(), "again.toml", &[]) {
                Ok(again) if again == scene => None,
                Ok(_) => Some("it reads back as another scene".to_owned()),
                Err(said) => Some(format!("it does not read back: {said}")),
            },
        });
        if let Some(fault) = fault {
            let name = base.name;
            panic!("seed {seed}, {name}: {}: {fault}", kept(&bytes, "csv", seed, number));
        }
    }
}

#[test]
fn tables_that_are_not_changed_are_read() {
    for base in bases() {
        let result = load(&base, &base.table);
        assert!(result.is_ok(), "{}: {result:?}", base.name);
    }
}

#[test]
fn changed_tables_are_read_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| read(seed, 200));
}

#[test]
#[ignore = "for hours: thousands of tables; ATTACK_SEED chooses others"]
fn attack_by_tables() {
    by_thousands(read, 20_000, "tables");
}
