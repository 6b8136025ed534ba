//! FMUs with damaged libraries, which the program loads: a result or a message, and no end without one.

use crate::archives::PACKAGES;
use crate::scenes::text;
use crate::{SEEDS, by_thousands, dice, kept, program, program_fault};

/// A scene with the FMU in the program.
fn scene() -> String {
    let text = text("tram-single-wire");
    let (before, rest) = text.split_once("[[pantograph]]").unwrap();
    assert!(rest.contains("[ranges]"), "the pantograph is the last table but one");
    format!("{before}[[pantograph]]\nfmu = \"changed.fmu\"\nstep_timeout = 3\n")
}

/// A library that is damaged in its head, in its tables or anywhere.
fn damaged(rng: &mut fastrand::Rng, library: &[u8]) -> Vec<u8> {
    let mut bytes = library.to_vec();
    let end = match rng.u8(..3) {
        0 => 0x400,
        1 => 0x8000,
        _ => bytes.len(),
    };
    match rng.u8(..8) {
        0 => bytes.truncate(rng.usize(..bytes.len())),
        1 => {
            let from = rng.usize(..end.min(bytes.len()));
            let until = (from + rng.usize(1..4096)).min(bytes.len());
            bytes[from..until].fill(rng.u8(..));
        }
        _ => {
            for _ in 0..1 << rng.u32(..8) {
                let place = rng.usize(..end);
                bytes[place] = rng.u8(..);
            }
        }
    }
    bytes
}

fn attack(seed: u64, count: usize) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), scene()).unwrap();
    let short = [
        "run",
        "scene.toml",
        "--mode",
        "inprocess",
        "-q",
        "--no-report",
        "--out",
        "out",
        "--set",
        "catenary.spans=2",
        "--set",
        "run.duration=0.05",
        "--set",
        "run.start_x=5",
        "--set",
        "run.evaluate={ time = [0.0, 0.05] }",
        "--set",
        "run.initialise=\"as_given\"",
    ];
    PACKAGES[1].write(&folder.path().join("changed.fmu")).unwrap();
    let whole = program(folder.path(), &short).unwrap();
    assert!(whole.status.success(), "{}", whole.said);
    for number in 0..count {
        let mut package = PACKAGES[1].clone();
        package.library = damaged(&mut dice(seed, number), &package.library);
        package.write(&folder.path().join("changed.fmu")).unwrap();
        let names = ["changed.fmu", "scene.toml", "out"];
        if let Some(fault) = program_fault(folder.path(), &short, &names) {
            let bytes = std::fs::read(folder.path().join("changed.fmu")).unwrap();
            panic!("seed {seed}, {}: {fault}", kept(&bytes, "fmu", seed, number));
        }
    }
}

#[test]
fn damaged_libraries_end_with_a_result_or_a_message() {
    SEEDS.iter().for_each(|&seed| attack(seed, 5));
}

#[test]
#[ignore = "for many minutes: thousands of libraries; ATTACK_SEED chooses others"]
fn attack_by_libraries() {
    by_thousands(attack, 2_000, "damaged libraries");
}
