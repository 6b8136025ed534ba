//! System structures that are changed at random: a scene comes out of them, or a message.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use fastrand::Rng;
use fmi2::archive::{Limits, extract};
use suppliers::ssp::{STRUCTURE_FILE, import};

use crate::archives::escaped;
use crate::scenes::scenes;
use crate::zip::Archive;
use crate::{SEEDS, by_thousands, caught, dice, kept, program_fault, unsaid, xml};

/// A line that runs in a fraction of a second.
const SHORT: [&str; 4] = [
    "catenary.spans=3",
    "catenary.mesh.elements_per_interval=1",
    "run.duration=0.05",
    "run.evaluate={ time = [0.0, 0.05] }",
];

/// An archive and the XML in it.
struct Base {
    archive: Archive,
    documents: BTreeMap<String, String>,
}

impl Base {
    fn new(path: &Path) -> Self {
        let folder = extract(path, STRUCTURE_FILE, &Limits::default()).unwrap();
        let archive = Archive::parsed(&std::fs::read(path).unwrap());
        let names = archive.entries.iter().map(|entry| entry.name());
        let documents = names.filter(|name| [".ssd", ".ssv", ".ssm"].iter().any(|ending| name.ends_with(ending)));
        let documents = documents.map(|name| {
            let text = std::fs::read_to_string(folder.path().join(&name)).unwrap();
            (name, text)
        });
        Self {
            documents: documents.collect(),
            archive,
        }
    }

    /// The same system without our annotation, as another tool would make it.
    fn foreign(&self) -> Self {
        let mut documents = self.documents.clone();
        let structure = documents.get_mut(STRUCTURE_FILE).unwrap();
        *structure = structure.replace("<ssc:Annotation type=\"", "<ssc:Annotation type=\"org.example.");
        let mut archive = self.archive.clone();
        archive.put(STRUCTURE_FILE, structure.as_bytes());
        Self { archive, documents }
    }
}

/// Archives of a short scene: as exported, and as of another tool.
static BASES: LazyLock<[Base; 2]> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command
        .arg("export")
        .arg(scenes().join("en50318-250.toml"))
        .arg("--out")
        .arg(folder.path());
    for key in SHORT {
        command.args(["--set", key]);
    }
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let own = Base::new(&folder.path().join("en50318-250.ssp"));
    let foreign = own.foreign();
    [own, foreign]
});

fn changed(rng: &mut Rng, base: &Base, escape: &str) -> Vec<u8> {
    let mut archive = base.archive.clone();
    let kind = rng.u8(..6);
    if kind > 0 {
        // Most often the structure itself.
        let names: Vec<&String> = base.documents.keys().collect();
        let name = if rng.bool() {
            STRUCTURE_FILE
        } else {
            names[rng.usize(..names.len())]
        };
        archive.put(name, &xml::changed(rng, &base.documents[name]));
    }
    if kind == 0 || rng.u8(..12) == 0 {
        for _ in 0..rng.usize(1..3) {
            archive.change(rng, escape);
        }
    }
    archive.to_bytes()
}

fn read(seed: u64, count: usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.ssp");
    let escape = format!("escaped-{}-ssp-{seed}", std::process::id());
    for number in 0..count {
        let bytes = changed(&mut dice(seed, number), &BASES[number % 2], &escape);
        std::fs::write(&path, &bytes).unwrap();
        let fault = caught(|| match import(&path, &[]) {
            Ok(imported) => imported
                .scene
                .to_toml()
                .is_empty()
                .then(|| "its scene is empty".to_owned()),
            Err(error) => {
                let said = error.to_string();
                let names = said.contains("changed.ssp");
                unsaid(&said).or((!names).then(|| format!("it does not name the file: {said}")))
            }
        });
        if let Some(fault) = fault.or_else(|| escaped(&escape)) {
            panic!("seed {seed}, {}: {fault}", kept(&bytes, "ssp", seed, number));
        }
    }
}

/// The program on systems: `check` and `run` in turn.
fn solve(seed: u64, count: usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("changed.ssp");
    let escape = format!("escaped-{}-solve-{seed}", std::process::id());
    for number in 0..count {
        let bytes = changed(&mut dice(seed ^ 0x1000, number), &BASES[1 - number % 2], &escape);
        std::fs::write(&path, &bytes).unwrap();
        let arguments = if number % 4 < 2 {
            &["check", "changed.ssp", "-q", "--json"][..]
        } else {
            &["run", "changed.ssp", "-q", "--no-report", "--out", "out"][..]
        };
        let fault = program_fault(folder.path(), arguments, &["changed.ssp", "out"]);
        if let Some(fault) = fault.or_else(|| escaped(&escape)) {
            panic!("seed {seed}, {}: {fault}", kept(&bytes, "ssp", seed, number));
        }
        let out = folder.path().join("out");
        if out.exists() {
            std::fs::remove_dir_all(out).unwrap();
        }
    }
}

#[test]
fn systems_that_are_not_changed_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("whole.ssp");
    for base in &*BASES {
        std::fs::write(&path, base.archive.to_bytes()).unwrap();
        import(&path, &[]).unwrap();
    }
}

#[test]
fn changed_systems_are_read_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| read(seed, 40));
}

#[test]
fn changed_systems_are_solved_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| solve(seed, 4));
}

#[test]
#[ignore = "for hours: thousands of systems; ATTACK_SEED chooses others"]
fn attack_by_systems() {
    by_thousands(read, 5_000, "systems read");
    by_thousands(solve, 200, "systems solved");
}
