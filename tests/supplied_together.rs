//! Supplied FMUs in several places of one scene: two pantographs, a line, both, and the way through an `.ssp`.
use integration_tests::installed::{Ended, Program};
use integration_tests::runs::rms;
use integration_tests::vendor::{LINE, OWN, Pantograph};
use std::fs;
use std::path::Path;

/// Contact closed at the start, not in balance.
const HEIGHT: f64 = 5.347;

/// The second pantograph stands this far behind the first, m.
const BEHIND: f64 = -15.0;

/// A pantograph that is modelled here.
fn own(offset: f64) -> String {
    format!("{OWN}offset_x = {offset:?}\nstart = {{ height = {HEIGHT}, force = 115.88 }}\n")
}

/// Supplied pantograph of the same data, with other masses in `more`.
fn theirs(offset: f64, more: &str) -> String {
    format!(
        "\n[[pantograph]]\nfmu = \"two_mass.fmu\"\noffset_x = {offset:?}\n\
         parameters = {{ reference_height = 5.28, start_height = {HEIGHT}{more} }}\n"
    )
}

/// The scene without the tables of the line, which is an FMU.
fn with_their_line(pantographs: &str) -> String {
    let mut text = String::new();
    let mut skipping = false;
    for line in LINE.lines() {
        if line.starts_with('[') {
            skipping = line.starts_with("[catenary") || line == "[contact]";
        }
        if !skipping {
            text.push_str(line);
            text.push('\n');
        }
    }
    format!("{text}\n[catenary]\nfmu = \"Catenary.fmu\"\n{pantographs}")
}

fn run(program: &Program, name: &str, scene: &str, more: &[&str]) -> Ended {
    program.run(&program.scene(name, scene), more).done()
}

fn program() -> Program {
    let program = Program::new();
    let _ = Pantograph::new().write(program.folder(), "two_mass");
    program
}

/// Packs the line of a scene beside the program.
fn pack_line(program: &Program, scene: &str) {
    let scene = program.scene("line", scene);
    let _ = program.call(&["package", scene.to_str().unwrap(), "--out", "."]).done();
}

fn forces(ended: &Ended) -> [Vec<f64>; 2] {
    ["contact[1].force", "contact[2].force"].map(|column| ended.series(column))
}

#[test]
fn two_pantographs_of_a_supplier_have_the_forces_of_two_of_ours() {
    let program = program();
    // Second-order errors of our own pantograph are left, see `supplied.rs`.
    let fine = ["--set", "solver.micro_step=2.5e-4"];
    let ours = run(&program, "ours", &format!("{LINE}{}{}", own(0.0), own(BEHIND)), &fine);
    let both = format!("{LINE}{}{}", theirs(0.0, ""), theirs(BEHIND, ""));
    let both = run(&program, "both", &both, &fine);
    let mixed = run(
        &program,
        "mixed",
        &format!("{LINE}{}{}", own(0.0), theirs(BEHIND, "")),
        &fine,
    );
    let expected = forces(&ours);
    // The two pantographs differ: each meets the line elsewhere.
    assert!(rms(&expected[0], &expected[1]) > 10.0);
    for other in [&both, &mixed] {
        for (expected, found) in expected.iter().zip(forces(other)) {
            let difference = rms(expected, &found);
            assert!(difference < 0.03, "{difference} N");
        }
    }
    // Values of one do not reach the other before the wire does.
    let heavier = format!("{LINE}{}{}", theirs(0.0, ""), theirs(BEHIND, ", m1 = 9.0"));
    let heavier = forces(&run(&program, "heavier", &heavier, &fine));
    assert!(rms(&expected[1], &heavier[1]) > 1.0 && rms(&expected[0][..20], &heavier[0][..20]) < 0.03);
}

#[test]
fn a_line_and_pantographs_of_others_have_the_forces_of_ours() {
    let program = program();
    let fine = ["--set", "solver.micro_step=2.5e-4"];
    // The line's FMU has the step of the scene that it is made of.
    let scene =
        |pantographs: &str| format!("{LINE}{pantographs}").replace("micro_step = 0.001", "micro_step = 0.00025");
    for offsets in [&[0.0][..], &[0.0, BEHIND]] {
        let ours: String = offsets.iter().map(|offset| own(*offset)).collect();
        let others: String = offsets.iter().map(|offset| theirs(*offset, "")).collect();
        pack_line(&program, &scene(&ours));
        let expected = run(&program, "ours", &scene(&ours), &[]);
        let together = run(&program, "together", &with_their_line(&others), &fine);
        for i in 1..=offsets.len() {
            let column = format!("contact[{i}].force");
            let (expected, found) = (expected.series(&column), together.series(&column));
            let difference = rms(&expected, &found);
            println!("{} pantograph(s), {column}: {difference} N", offsets.len());
            assert!(difference < 0.05, "{column}: {difference} N");
        }
        // A monolithic run is impossible, because no side is modelled here.
        let refused = program.run(&program.folder().join("together.toml"), &["--mode", "monolithic"]);
        let _ = refused.refused(2, &["monolithic", "no equations"]);
    }
}

#[test]
fn a_system_with_fmus_of_others_runs_as_the_scene_it_was_made_of() {
    let program = program();
    pack_line(&program, &format!("{LINE}{}", own(0.0)));
    for (name, scene) in [
        ("theirs", format!("{LINE}{}", theirs(0.0, ", m1 = 8.0"))),
        (
            "two",
            format!("{LINE}{}{}", theirs(0.0, ""), theirs(BEHIND, ", m1 = 9.0")),
        ),
        ("all", with_their_line(&theirs(0.0, ", m1 = 8.0"))),
    ] {
        let first = run(&program, name, &scene, &[]);
        let path = program.folder().join(format!("{name}.toml"));
        let arguments = ["export", path.to_str().unwrap(), "--out", "systems", "-q"];
        let _ = program.call(&arguments).done();
        // Away from the FMUs, which are in the archive.
        let folder = program.folder().join(format!("{name}-elsewhere"));
        fs::create_dir(&folder).unwrap();
        let system = folder.join(format!("{name}.ssp"));
        fs::rename(program.folder().join("systems").join(format!("{name}.ssp")), &system).unwrap();
        let again = program.run(&system, &[]).done();
        let read = |folder: &Path| fs::read(folder.join("timeseries.csv")).unwrap();
        assert!(read(&first.results) == read(&again.results), "{name}");
        // The resolved scene finds the FMUs kept beside it, without the archive.
        fs::remove_file(&system).unwrap();
        let resolved = program.run(&again.results.join("scene.toml"), &[]).done();
        assert!(read(&first.results) == read(&resolved.results), "{name}");
    }
}
