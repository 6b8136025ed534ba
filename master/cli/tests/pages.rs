//! Every page in a browser: no error, every figure drawn, every button at work, nothing wider than the screen.

mod browser;
mod validate;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use browser::{look, printed};

/// Widths of a telephone, a tablet and a desk, px.
const WIDTHS: [u32; 3] = [380, 800, 1600];

/// A short line on a coarse mesh: pages do not depend on its accuracy.
const SHORT: [&str; 5] = [
    "catenary.spans=6",
    "run.duration=2.6",
    "run.evaluate={time=[0.8,2.4]}",
    "catenary.mesh.elements_per_interval=1",
    "run.start_x=80",
];

fn scene(name: &str) -> String {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    scenes.join(format!("{name}.toml")).display().to_string()
}

/// The program with these arguments and keys, into a folder.
fn program(arguments: &[&str], keys: &[&str], folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
    command.args(arguments).arg("-q").arg("--out").arg(folder);
    for key in keys {
        command.args(["--set", key]);
    }
    command
}

/// Runs the program into a folder and reads the page.
fn page(arguments: &[&str], keys: &[&str], folder: &Path, name: &str) -> String {
    let output = program(arguments, keys, folder).output().unwrap();
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    std::fs::read_to_string(folder.join(name)).unwrap()
}

/// Looks at a page with at least so many figures.
fn sound(name: &str, html: &str, least: usize) {
    let figures = html.matches("class=\"plot\"").count();
    assert!(figures >= least, "{name}: {figures} figures");
    let seen = look(html, &WIDTHS);
    assert_eq!(seen.len(), WIDTHS.len());
    let faults: Vec<String> = seen.iter().flat_map(browser::Seen::faults).collect();
    assert!(faults.is_empty(), "{name}: {faults:#?}");
    for seen in seen {
        assert_eq!(seen.figures, figures, "{name}: figures");
        assert!(
            figures == 0 || seen.buttons >= 2 * figures,
            "{name}: {} buttons",
            seen.buttons
        );
    }
}

/// Report of a stitched line under two pantographs, with a limit that fails, and that of two runs.
fn reports() -> [String; 2] {
    let folder = tempfile::tempdir().unwrap();
    let [stitched, light] = ["stitched", "light"].map(|name| folder.path().join(name));
    let text = std::fs::read_to_string(scene("ac-stitched")).unwrap();
    let (text, ranges) = text.split_once("[ranges]").unwrap();
    let pantograph = &text[text.find("[[pantograph]]").unwrap()..];
    let path = folder.path().join("two.toml");
    let instruments = "[measurement]\nstrip_mass = 4.0\nbending_frequency = 60.0\n";
    let two = format!("{text}\n{pantograph}offset_x = -60.0\n{instruments}\n[ranges]{ranges}");
    std::fs::write(&path, two).unwrap();
    let path = path.display().to_string();
    let run = ["run", &path, "--mode", "monolithic", "--no-report"];
    let mut html = Vec::new();
    for (to, more) in [(&stitched, "run.speed_kmh=330"), (&light, "run.speed_kmh=250")] {
        let keys: Vec<&str> = SHORT.iter().copied().chain([more]).collect();
        page(&run, &keys, to, "summary.json");
    }
    let report = ["report", &stitched.display().to_string()];
    html.push(page(&report, &[], folder.path(), "report.html"));
    let both = ["report", &stitched.display().to_string(), &light.display().to_string()];
    html.push(page(&both, &[], folder.path(), "report.html"));
    html.try_into().unwrap()
}

#[test]
fn reports_of_a_run_and_of_two_are_sound() {
    let [one, two] = reports();
    sound("report", &one, 6);
    sound("two runs", &two, 7);
    for part in ["As measured", "unstressed lengths and forces at rest"] {
        assert!(one.contains(part) && two.contains(part), "{part}");
    }
    assert!(two.contains("plot-difference") && !one.contains("plot-difference"));
    assert!(one.len() < 2_500_000, "{} bytes", one.len());
}

#[test]
fn pages_of_check_sweep_stability_and_compare_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path();
    let line = scene("en50318-250");
    sound(
        "check",
        &page(&["check", &scene("ac-stitched")], &SHORT, to, "check.html"),
        0,
    );
    let vary = [
        "--vary",
        "run.speed_kmh=200,240",
        "--vary",
        "pantograph[1].static_force=110,120",
        "--vary",
        "contact.stiffness=4e4,5e4",
    ];
    let sweep = |count: usize, name: &str| {
        let arguments: Vec<&str> = ["sweep", &line]
            .into_iter()
            .chain(vary[..2 * count].iter().copied())
            .collect();
        page(&arguments, &SHORT, &to.join(name), "sweep.html")
    };
    sound("sweep of one key", &sweep(1, "one"), 6);
    sound("sweep of two keys", &sweep(2, "two"), 6);
    sound("sweep of three keys", &sweep(3, "three"), 1);
    sound(
        "stability",
        &page(
            &["stability", "--quick", "--cases", "no_bending"],
            &[],
            to,
            "stability.html",
        ),
        0,
    );
    let compare = ["compare", &line, "--macro-steps", "2,5"];
    sound("compare", &page(&compare, &SHORT, to, "compare.html"), 1);
}

#[test]
fn pages_of_sensitivity_and_validation_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path();
    let line = scene("en50318-250");
    let arguments = ["sensitivity", &line, "--range", "contact.stiffness=4e4:6e4"];
    let html = page(&arguments, &SHORT, &to.join("sensitivity"), "sensitivity.html");
    // Loss of contact does not depend on any of the numbers here: no figure.
    sound("sensitivity", &html, 5);
    let model = validate::model(to, (0.0, 1000.0));
    let html = page(&["validate", &model], &[], &to.join("validation"), "validation.html");
    sound("validation", &html, 0);
}

/// Begins an experiment that takes minutes, ends it when so many runs are kept, and reads its page.
fn ended(arguments: &[&str], keys: &[&str], folder: &Path, (kept, least): (&str, usize), name: &str) -> String {
    let mut child = program(arguments, keys, folder).stderr(Stdio::null()).spawn().unwrap();
    // Many times what these runs take on a slow machine.
    let last = Instant::now() + Duration::from_secs(300);
    let runs = || std::fs::read_dir(folder.join(kept)).map_or(0, Iterator::count);
    while runs() < least && child.try_wait().unwrap().is_none() {
        assert!(Instant::now() < last, "{arguments:?}: {} files", runs());
        std::thread::sleep(Duration::from_millis(50));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.unwrap().success(), "{arguments:?} ended by itself");
    child.wait().unwrap();
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn pages_of_a_study_and_of_a_reproduction_that_were_ended_are_sound() {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path();
    let line = scene("en50318-250");
    let study = [
        "study",
        &line,
        "--quick",
        "--repeats",
        "1",
        "--elements",
        "1",
        "--reference-tolerance",
        "90",
    ];
    let keys = [&SHORT[..1], &["run.duration=1.6", "run.evaluate={time=[0.5,1.4]}"]].concat();
    // A run is kept in two or three files.
    let html = ended(&study, &keys, &to.join("study"), ("study", 12), "study.html");
    sound("study", &html, 1);
    let thesis = ["reproduce", "thesis", "--quick"];
    let html = ended(
        &thesis,
        &[],
        &to.join("reproduce"),
        ("reproduce", 6),
        "reproduction.html",
    );
    sound("reproduction", &html, 1);
}

#[test]
fn a_broken_figure_and_a_table_that_is_too_wide_are_seen() {
    let [one, _] = reports();
    let broken = one.replacen("data-for=\"plot-force\"", "data-for=\"plot-none\"", 1);
    let faults: Vec<String> = look(&broken, &[800]).iter().flat_map(browser::Seen::faults).collect();
    assert!(
        faults.iter().any(|fault| fault.contains("plot-force is empty")),
        "{faults:?}"
    );
    let wide = one.replacen(
        "<section>",
        "<section><table style=\"width:2000px\"><tr><td>wide</td></tr></table>",
        1,
    );
    let faults: Vec<String> = look(&wide, &[800]).iter().flat_map(browser::Seen::faults).collect();
    assert!(faults.iter().any(|fault| fault.contains("wider by")), "{faults:?}");
    let throwing = one.replacen("</main>", "</main><script>nothing.here()</script>", 1);
    let faults: Vec<String> = look(&throwing, &[800]).iter().flat_map(browser::Seen::faults).collect();
    assert!(
        faults.iter().any(|fault| fault.contains("nothing is not defined")),
        "{faults:?}"
    );
}

#[test]
fn a_report_prints_to_a_few_pages_of_which_the_last_has_the_scene() {
    let [one, _] = reports();
    let pages = printed(&one);
    // Verdict and figures, curves, spans, frequencies, limits, model, scene.
    assert!((6..=16).contains(&pages), "{pages} pages");
    let long = one.replacen("</main>", &format!("<pre>{}</pre></main>", "line\n".repeat(2000)), 1);
    assert!(printed(&long) > pages + 10);
}
