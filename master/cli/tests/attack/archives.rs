//! FMU archives that are changed at random in their zip structure or in their model description: read or refused.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use cosim::package::{self, Libraries};
use fmi2::archive::{Package, zipped};
use fmi2::import::Fmu;
use fmi2::model_description::ModelDescription;
use suppliers::{Side, Wiring};
use system::equilibrium;

use crate::scenes::text;
use crate::zip::Archive;
use crate::{SEEDS, by_thousands, caught, dice, kept, program_fault, unsaid, xml};

/// FMUs of a small line and of its pantograph.
pub static PACKAGES: LazyLock<Vec<Package>> = LazyLock::new(|| {
    let short = [
        "catenary.spans=2",
        "run.duration=0.2",
        "run.start_x=5",
        "run.evaluate={ time = [0.0, 0.2] }",
    ];
    let short = short.map(str::to_owned);
    let mut scene = system::load(&text("tram-single-wire"), "scene.toml", &short).unwrap();
    let statics = catenary::static_line(&scene).unwrap();
    equilibrium::resolve(&mut scene, &statics).unwrap();
    let archives = package::archives(&scene, &Libraries::find().unwrap()).unwrap();
    archives.into_iter().map(|(_, package)| package).collect()
});

/// Both FMUs, unpacked, and the folder of their archives.
pub struct Whole {
    pub fmus: Vec<Fmu>,
    _folder: tempfile::TempDir,
}

/// Both FMUs as they are.
pub fn whole() -> Whole {
    let folder = tempfile::tempdir().unwrap();
    let fmus = PACKAGES.iter().enumerate().map(|(number, package)| {
        let path = folder.path().join(format!("{number}.fmu"));
        package.write(&path).unwrap();
        Fmu::open(&path).unwrap()
    });
    Whole {
        fmus: fmus.collect(),
        _folder: folder,
    }
}

/// Archives with their model descriptions; `whole` for those with their libraries, which an importer would load.
fn bases(whole: bool) -> Vec<(Archive, String)> {
    let base = |package: &Package| {
        let mut package = package.clone();
        if !whole {
            package.library = b"no library".repeat(50);
        }
        let bytes = package.to_bytes(Path::new("base.fmu")).unwrap();
        (Archive::parsed(&bytes), package.description)
    };
    let mut bases: Vec<_> = PACKAGES.iter().map(base).collect();
    if !whole {
        // Few bytes that become many.
        let description = PACKAGES[0].description.clone();
        let entries = BTreeMap::from([
            ("modelDescription.xml".to_owned(), description.clone().into_bytes()),
            ("resources/zeros".to_owned(), vec![0; 3 << 20]),
        ]);
        bases.push((Archive::parsed(&zipped(&entries).unwrap()), description));
    }
    bases
}

/// An archive that is changed in its structure, its model description or its bytes.
fn changed(rng: &mut fastrand::Rng, (archive, description): &(Archive, String), escape: &str) -> Vec<u8> {
    let mut archive = archive.clone();
    let kind = rng.u8(..8);
    if kind >= 4 {
        archive.put("modelDescription.xml", &xml::changed(rng, description));
    }
    if kind < 4 || rng.u8(..8) == 0 {
        for _ in 0..rng.usize(1..4) {
            archive.change(rng, escape);
        }
    }
    let mut bytes = archive.to_bytes();
    match kind {
        0 => bytes.truncate(rng.usize(..bytes.len())),
        1 => {
            // The directory at the end, which all readers begin with.
            let from = bytes.len().saturating_sub(rng.usize(22..400));
            let place = rng.usize(from..bytes.len());
            bytes[place] = rng.u8(..);
        }
        _ => {}
    }
    bytes
}

/// Wires a description as every side.
fn used(description: &ModelDescription) {
    for side in [Side::Pantograph, Side::Line, Side::Controller] {
        let _ = Wiring::resolve(description, &mut scene::Supplied::unwired(""), side, 1);
    }
}

/// Fault where a file of that name came to lie outside.
pub fn escaped(escape: &str) -> Option<String> {
    let places = [std::env::temp_dir(), "/tmp".into(), "/".into(), "..".into()];
    let found = places.iter().map(|place| place.join(escape)).find(|path| path.exists());
    found.map(|path| format!("it writes {}", path.display()))
}

fn read(seed: u64, count: usize) {
    let (bases, folder) = (bases(false), tempfile::tempdir().unwrap());
    let path = folder.path().join("changed.fmu");
    let escape = format!("escaped-{}-{seed}", std::process::id());
    for number in 0..count {
        let bytes = changed(&mut dice(seed, number), &bases[number % bases.len()], &escape);
        std::fs::write(&path, &bytes).unwrap();
        let fault = caught(|| match Fmu::open(&path) {
            Ok(fmu) => {
                used(fmu.description());
                None
            }
            Err(error) => {
                let said = error.to_string();
                let names = said.contains("changed.fmu");
                unsaid(&said).or((!names).then(|| format!("it does not name the file: {said}")))
            }
        });
        if let Some(fault) = fault.or_else(|| escaped(&escape)) {
            panic!("seed {seed}, {}: {fault}", kept(&bytes, "fmu", seed, number));
        }
    }
}

/// The program on archives with their libraries.
fn inspect(seed: u64, count: usize) {
    let (bases, folder) = (bases(true), tempfile::tempdir().unwrap());
    let path = folder.path().join("changed.fmu");
    let escape = format!("escaped-{}-inspect-{seed}", std::process::id());
    for number in 0..count {
        let bytes = changed(&mut dice(seed ^ 0x1000, number), &bases[number % bases.len()], &escape);
        std::fs::write(&path, &bytes).unwrap();
        let arguments = if number % 4 == 0 {
            &["inspect", "changed.fmu", "--json"][..]
        } else {
            &["inspect", "changed.fmu"][..]
        };
        let fault = program_fault(folder.path(), arguments, &["changed.fmu"]);
        if let Some(fault) = fault.or_else(|| escaped(&escape)) {
            panic!("seed {seed}, {}: {fault}", kept(&bytes, "fmu", seed, number));
        }
    }
}

#[test]
fn archives_that_are_not_changed_are_read() {
    for (archive, _) in &bases(false)[..2] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole.fmu");
        std::fs::write(&path, archive.to_bytes()).unwrap();
        Fmu::open(&path).unwrap();
        assert!(
            archive
                .entries
                .iter()
                .any(|entry| entry.name() == "modelDescription.xml")
        );
    }
}

#[test]
fn changed_archives_are_read_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| read(seed, 200));
}

#[test]
fn changed_archives_are_inspected_or_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| inspect(seed, 8));
}

#[test]
#[ignore = "for hours: thousands of archives; ATTACK_SEED chooses others"]
fn attack_by_archives() {
    by_thousands(read, 5_000, "archives read");
    by_thousands(inspect, 300, "archives inspected");
}
