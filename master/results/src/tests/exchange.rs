//! Results in place of older ones.

use std::path::Path;

use super::*;

const OLD: [&str; 5] = [
    "animation.json",
    "report.html",
    "scene.toml",
    "summary.json",
    "timeseries.csv",
];

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// A folder with five files of an older run that are no files of this program.
fn folder_of_an_older_run() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for name in OLD {
        std::fs::write(folder.path().join(name), "precious").unwrap();
    }
    folder
}

#[test]
fn a_run_that_has_begun_leaves_older_results_as_they_are_until_its_own_are_complete() {
    let folder = folder_of_an_older_run();
    let mut directory = OutputDirectory::open(folder.path()).unwrap().without_animation();
    directory.lock("a test").unwrap();
    directory.begin("title = \"new\"\n").unwrap();
    for name in OLD {
        assert_eq!(
            std::fs::read_to_string(folder.path().join(name)).unwrap(),
            "precious",
            "{name}"
        );
    }
    let fmu = folder.path().join("elsewhere.fmu");
    std::fs::write(&fmu, "fmu").unwrap();
    directory.add("fmu/side.fmu".into(), fmu);
    let (info, record) = run(true);
    directory.finish(&info, record, "title = \"new\"\n").unwrap();
    drop(directory);
    let expected = ["elsewhere.fmu", "fmu", "scene.toml", "summary.json", "timeseries.csv"];
    assert_eq!(
        names(folder.path()),
        expected,
        "neither pictures nor the page of the older run"
    );
    assert_eq!(
        std::fs::read_to_string(folder.path().join("fmu/side.fmu")).unwrap(),
        "fmu"
    );
    assert_eq!(RunBundle::read(folder.path()).unwrap().scene, "title = \"new\"\n");
}

#[test]
fn an_exchange_that_was_broken_off_after_any_move_is_finished_by_the_next_run() {
    // Moves in their order; the folder of complete results holds those that are left.
    let moves = ["timeseries.csv", "animation.json", "scene.toml", "summary.json"];
    for done in 0..=moves.len() {
        let folder = folder_of_an_older_run();
        let at = |name: &str| folder.path().join(name);
        let complete = at(".results.complete");
        std::fs::create_dir(&complete).unwrap();
        for name in &moves[done..] {
            std::fs::write(complete.join(name), "new").unwrap();
        }
        if done > 0 {
            std::fs::remove_file(at("summary.json")).unwrap();
            std::fs::remove_file(at("report.html")).unwrap();
        }
        for name in &moves[..done] {
            std::fs::write(at(name), "new").unwrap();
        }
        std::fs::create_dir(at(".results-half")).unwrap();
        std::fs::write(at(".summary.json.x1.partial"), "half").unwrap();
        let mut directory = OutputDirectory::open(folder.path()).unwrap();
        directory.lock("a test").unwrap();
        drop(directory);
        let mut expected = moves;
        expected.sort_unstable();
        assert_eq!(names(folder.path()), expected, "after {done} moves");
        for name in moves {
            assert_eq!(
                std::fs::read_to_string(at(name)).unwrap(),
                "new",
                "{name} after {done} moves"
            );
        }
    }
}

#[test]
fn a_folder_is_held_by_one_run_whose_words_the_next_one_hears() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = OutputDirectory::open(folder.path()).unwrap();
    first.lock("`master run` of line.toml").unwrap();
    let mut second = OutputDirectory::open(folder.path()).unwrap();
    let said = second.lock("another").unwrap_err().to_string();
    let process = format!("`master run` of line.toml (process {})", std::process::id());
    assert!(said.contains(&process), "{said}");
    drop(first);
    second.lock("another").unwrap();
    drop(second);
    assert!(names(folder.path()).is_empty());
}

#[cfg(unix)]
#[test]
fn links_that_lie_in_the_way_lead_no_file_out_of_the_folder() {
    let (folder, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let target = outside.path().join("precious");
    let link = |name: &str| {
        std::fs::write(&target, "precious").unwrap();
        std::os::unix::fs::symlink(&target, folder.path().join(name)).unwrap();
    };
    for name in [".summary.json.partial", ".timeseries.csv.partial", "summary.json"] {
        link(name);
    }
    let (info, record) = run(true);
    let directory = OutputDirectory::open(folder.path()).unwrap();
    directory.finish(&info, record, "").unwrap();
    assert_eq!(std::fs::read_to_string(&target).unwrap(), "precious");
    link(".pantoline.lock");
    let said = OutputDirectory::open(folder.path())
        .unwrap()
        .lock("a test")
        .unwrap_err();
    assert!(said.to_string().contains(".pantoline.lock"), "{said}");
    assert_eq!(std::fs::read_to_string(&target).unwrap(), "precious");
}
