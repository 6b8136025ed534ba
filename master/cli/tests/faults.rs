//! Faults from outside at every write: kills at random moments, a disk that is full, a folder that cannot be written, a
//! reader that is gone. Earlier results stay as they were, no mixture is left, and the next run comes to its end.
#![cfg(unix)]

mod short;

use short::SHORT;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Commands that write results.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Run,
    Sweep,
    Study,
}

impl Kind {
    /// The command on a scene with a speed, into a folder.
    fn arguments(self, out: &Path, speed: u32) -> Vec<String> {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/en50318-250.toml");
        let words: &[&str] = match self {
            Self::Run => &["run", "--mode", "inprocess"],
            Self::Sweep => &["sweep", "--vary", "pantograph[1].static_force=100:120:2"],
            Self::Study => &[
                "study",
                "--sweeps=micro_step",
                "--micro-steps=1,2",
                "--repeats=1",
                "--reference-tolerance=50",
            ],
        };
        let mut all: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        let keys = SHORT.iter().map(|key| (*key).to_owned());
        for key in keys.chain([format!("run.speed_kmh={speed}")]) {
            all.extend(["--set".to_owned(), key]);
        }
        all.extend(["-q".to_owned(), "--out".to_owned(), out.display().to_string()]);
        all.push(scene.display().to_string());
        all
    }

    fn command(self, out: &Path, speed: u32) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_master"));
        command.args(self.arguments(out, speed));
        command
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        command
    }

    fn done(self, out: &Path, speed: u32) {
        let output = self.command(out, speed).output().unwrap();
        assert!(output.status.success(), "{self:?}: {}", said(&output));
    }

    /// The file by which results are told apart.
    fn table(self) -> &'static str {
        match self {
            Self::Run => "timeseries.csv",
            Self::Sweep => "sweep.csv",
            Self::Study => "study.csv",
        }
    }

    /// The table without wall times; nothing where there is none.
    fn results(self, out: &Path) -> Option<Vec<String>> {
        let text = std::fs::read_to_string(out.join(self.table())).ok()?;
        if !matches!(self, Self::Study) {
            return Some(text.lines().map(str::to_owned).collect());
        }
        let mut table = csv::Reader::from_reader(text.as_bytes());
        let names = table.headers().unwrap().clone();
        let figures = [
            "micro_step_s",
            "mesh",
            "status",
            "mean_N",
            "std_N",
            "reference",
            "sweep",
        ];
        let places: Vec<usize> = figures
            .iter()
            .map(|figure| names.iter().position(|name| name == *figure).unwrap())
            .collect();
        let row = |row: csv::StringRecord| {
            let figures: Vec<&str> = places.iter().map(|&place| &row[place]).collect();
            figures.join(",")
        };
        // Ranks go by wall time.
        let mut rows: Vec<String> = table.records().map(|each| row(each.unwrap())).collect();
        rows.sort();
        Some(rows)
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Names in a folder but for those of the lock, and of what is not complete.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .filter(|name| !name.starts_with('.'))
        .collect();
    names.sort();
    names
}

/// Results of two speeds, and the time that a run takes.
struct References {
    results: [Vec<String>; 2],
    names: Vec<String>,
    takes: Duration,
}

const SPEEDS: [u32; 2] = [200, 220];

impl References {
    fn new(kind: Kind) -> Self {
        let mut all = SPEEDS.map(|speed| {
            let folder = tempfile::tempdir().unwrap();
            let begin = Instant::now();
            kind.done(folder.path(), speed);
            let results = kind.results(folder.path()).unwrap();
            (results, names(folder.path()), begin.elapsed())
        });
        assert_ne!(all[0].0, all[1].0, "{kind:?}: the speed tells them apart");
        Self {
            results: [std::mem::take(&mut all[0].0), std::mem::take(&mut all[1].0)],
            names: std::mem::take(&mut all[0].1),
            takes: all[0].2.max(all[1].2),
        }
    }
}

/// Starts the command and kills it after a random part of the time that it takes; true where it was not at its end.
fn killed(mut command: Command, takes: Duration, rng: &mut fastrand::Rng) -> bool {
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    std::thread::sleep(takes.mul_f64(1.1 * rng.f64()));
    // SIGKILL; an error where it has ended.
    let _ = child.kill();
    !child.wait().unwrap().success()
}

/// Kills runs over earlier results: these are there, or the new ones, or a rest without a summary that the next run
/// completes or clears.
fn kills_of_runs(count: usize) -> usize {
    let (kind, mut rng) = (Kind::Run, fastrand::Rng::with_seed(35));
    let of = References::new(kind);
    let folder = tempfile::tempdir().unwrap();
    let mut now = 0;
    kind.done(folder.path(), SPEEDS[now]);
    let (mut kills, mut number) = (0, 0);
    while kills < count {
        number += 1;
        let next = 1 - now;
        kills += usize::from(killed(kind.command(folder.path(), SPEEDS[next]), of.takes, &mut rng));
        let found = kind.results(folder.path());
        if folder.path().join("summary.json").exists() {
            let found = found.unwrap_or_else(|| panic!("kill {number}: a summary without its series"));
            assert!(of.results.contains(&found), "kill {number}: a series of neither");
            let summary = std::fs::read(folder.path().join("summary.json")).unwrap();
            let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
            assert_eq!(summary["complete"], true, "kill {number}");
            let scene = std::fs::read_to_string(folder.path().join("scene.toml")).unwrap();
            let is = usize::from(found == of.results[1]);
            assert!(
                scene.contains(&format!("speed_kmh = {:?}", f64::from(SPEEDS[is]))),
                "kill {number}: series of {}, scene\n{scene}",
                SPEEDS[is]
            );
        } else {
            // The new ones are complete and were being moved; else those of the run before are lost.
            let complete = folder.path().join(".results.complete");
            assert!(complete.is_dir(), "kill {number}: no results at all");
        }
        kind.done(folder.path(), SPEEDS[next]);
        assert!(
            kind.results(folder.path()).unwrap() == of.results[next],
            "kill {number}"
        );
        assert_eq!(names(folder.path()), of.names, "kill {number}");
        now = next;
    }
    kills
}

/// Kills a command again and again, which goes on in the same folder, until it comes to its end.
fn kills_of_many(kind: Kind, count: usize) -> usize {
    let mut rng = fastrand::Rng::with_seed(35);
    let of = References::new(kind);
    let mut kills = 0;
    while kills < count {
        let folder = tempfile::tempdir().unwrap();
        for _ in 0..rng.usize(1..5) {
            kills += usize::from(killed(kind.command(folder.path(), SPEEDS[0]), of.takes, &mut rng));
            // A study that has not come to its end holds its runs against another reference.
            if let (Kind::Sweep, Some(found)) = (kind, kind.results(folder.path())) {
                let known = |row: &String| of.results[0].contains(row);
                assert!(found.iter().all(known), "after {kills} kills: a row of nowhere");
            }
        }
        kind.done(folder.path(), SPEEDS[0]);
        let found = kind.results(folder.path()).unwrap();
        assert!(
            found == of.results[0],
            "after {kills} kills:\n{found:#?}\n{:#?}",
            of.results[0]
        );
        assert_eq!(names(folder.path()), of.names, "after {kills} kills");
    }
    kills
}

#[test]
fn kills_at_random_moments_cost_no_earlier_results_and_the_next_run_goes_on() {
    kills_of_runs(3);
    kills_of_many(Kind::Sweep, 4);
    kills_of_many(Kind::Study, 2);
}

#[test]
#[ignore = "for many minutes: a hundred kills of each command"]
fn attack_by_kills() {
    let runs = kills_of_runs(100);
    println!("{runs} kills of runs");
    for kind in [Kind::Sweep, Kind::Study] {
        println!("{} kills of {kind:?}", kills_of_many(kind, 100));
    }
}

/// The command where no file can become larger than some blocks of the shell.
fn bounded(kind: Kind, out: &Path, blocks: u64) -> Output {
    let mut command = Command::new("sh");
    command
        .args(["-c", "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\""])
        .arg(blocks.to_string())
        .arg(env!("CARGO_BIN_EXE_master"))
        .args(kind.arguments(out, SPEEDS[1]));
    command.stdin(Stdio::null()).output().unwrap()
}

fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut content = BTreeMap::new();
    for name in names(folder) {
        let path = folder.join(name);
        if path.is_file() {
            content.insert(path.clone(), std::fs::read(path).unwrap());
        }
    }
    content
}

/// Has writes refused beyond each of some sizes, over earlier results and without.
fn full_disks(kind: Kind, blocks: impl Iterator<Item = u64>) {
    let of = References::new(kind);
    for blocks in blocks {
        let (earlier, none) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        if matches!(kind, Kind::Run) {
            kind.done(earlier.path(), SPEEDS[0]);
            let before = content(earlier.path());
            let output = bounded(kind, earlier.path(), blocks);
            if !output.status.success() {
                let after = content(earlier.path());
                // A page is written when the new results are in their places.
                let is_new = || kind.results(earlier.path()).as_ref() == Some(&of.results[1]);
                let but_page = || after.keys().all(|path| !path.ends_with("report.html")) && is_new();
                assert!(
                    after == before || but_page(),
                    "{blocks} blocks: earlier results are others"
                );
            }
        }
        let output = bounded(kind, none.path(), blocks);
        let said = said(&output);
        if output.status.success() {
            assert!(
                kind.results(none.path()).unwrap() == of.results[1],
                "{kind:?}, {blocks} blocks: other results"
            );
        } else {
            let code = output.status.code();
            assert!(
                matches!(code, Some(1 | 2)),
                "{kind:?}, {blocks} blocks: {code:?} {said}"
            );
            let other = [
                "a defect of this program",
                "not a file of this program",
                "not a CSV table",
            ];
            let told = said.contains("File too large") && other.iter().all(|other| !said.contains(other));
            assert!(told, "{kind:?}, {blocks} blocks: {said}");
        }
        for folder in [earlier, none] {
            kind.done(folder.path(), SPEEDS[1]);
            assert!(
                kind.results(folder.path()).unwrap() == of.results[1],
                "{kind:?}, after {blocks} blocks"
            );
            assert_eq!(names(folder.path()), of.names, "{kind:?}, after {blocks} blocks");
        }
    }
}

#[test]
fn a_full_disk_is_told_at_every_write_and_costs_no_earlier_results() {
    full_disks(Kind::Run, [0, 4, 30, 60, 200].into_iter());
    full_disks(Kind::Sweep, [0, 6, 40].into_iter());
    full_disks(Kind::Study, [0, 20].into_iter());
}

#[test]
#[ignore = "for many minutes: all sizes of files"]
fn attack_by_full_disks() {
    full_disks(Kind::Run, (0..40).chain((40..1500).step_by(50)));
    full_disks(Kind::Sweep, (0..40).chain((40..1500).step_by(50)));
    full_disks(Kind::Study, (0..30).chain((40..1500).step_by(100)));
}

#[test]
fn a_folder_that_cannot_be_written_is_told_before_anything_is_computed() {
    // Also for the superuser, whom no permission keeps out.
    for kind in [Kind::Run, Kind::Sweep, Kind::Study] {
        let output = kind.command(Path::new("/proc/pantoline"), SPEEDS[0]).output().unwrap();
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{kind:?}: {said}");
        assert!(said.contains("/proc/pantoline"), "{kind:?}: {said}");
    }
}

#[test]
fn closed_and_full_streams_cost_no_results() {
    let of = References::new(Kind::Run);
    for (streams, status) in [
        (">&-", 0),
        (">/dev/full", 1),
        ("2>&-", 0),
        ("2>/dev/full", 0),
        (">&- 2>&- <&-", 0),
        ("| true", 0),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let arguments = Kind::Run.arguments(folder.path(), SPEEDS[0]).into_iter();
        // Of a killed run, which is told on standard error.
        std::fs::write(folder.path().join(".pantoline.lock"), "an earlier run").unwrap();
        let mut command = Command::new("bash");
        command
            .args(["-c", &format!("set -o pipefail; \"$0\" \"$@\" --json {streams}")])
            .arg(env!("CARGO_BIN_EXE_master"))
            .args(arguments.filter(|word| word != "-q"));
        let output = command.output().unwrap();
        assert_eq!(output.status.code(), Some(status), "{streams}: {}", said(&output));
        let told = said(&output).contains("did not come to its end");
        assert!(told || streams.contains("2>"), "{streams}: {}", said(&output));
        assert!(Kind::Run.results(folder.path()).unwrap() == of.results[0], "{streams}");
        assert_eq!(names(folder.path()), of.names, "{streams}");
    }
}
