use component::{DropperLine, Frame, Share};

use super::*;
use crate::statistics::Filter;

mod curve;
mod exchange;
mod instrument;
mod undecided;

/// A run of 2 s with two pantographs and easily known figures: the raw force of pantograph 1 is
/// 100 N, that of pantograph 2 is 0 N in half of the samples.
pub fn run(complete: bool) -> (RunInfo, Record) {
    let n = if complete { 2001 } else { 501 };
    let time: Vec<f64> = (0..n).map(|i| f64::from(i) * 1e-3).collect();
    let strip = |force: Vec<f64>, offset: f64| StripRecord {
        force,
        contact_x: time.iter().map(|t| offset + 50.0 * t).collect(),
        contact_y: vec![0.0; time.len()],
        wire_z: time.iter().map(|t| 5.1 + 0.02 * t).collect(),
        strip_z: time.iter().map(|t| 5.0 + 0.02 * t).collect(),
        strip_vz: vec![0.02; time.len()],
        gap: vec![-0.001; time.len()],
        wind: None,
        control: None,
        aside: Vec::new(),
        strips: Vec::new(),
    };
    let half = (0..n).map(|i| if i % 2 == 0 { 0.0 } else { 200.0 }).collect();
    let record = Record {
        pantographs: vec![strip(vec![100.0; time.len()], 20.0), strip(half, -80.0)],
        supports: vec![
            SupportRecord {
                number: 3,
                uplift: time.iter().map(|t| 0.03 * t * (2.0 - t)).collect(),
            },
            SupportRecord {
                number: 4,
                uplift: vec![-0.001; time.len()],
            },
        ],
        line: LineGeometry {
            support_x: vec![0.0, 60.0, 120.0],
            dropper_x: vec![10.0, 30.0],
            tension_lengths: Vec::new(),
            droppers: Vec::new(),
        },
        animation: Animation {
            frames: vec![Frame {
                time: 0.0,
                contact_wire: vec![(0.0, 5.0), (60.0, 5.123456)],
                messenger_wire: vec![(0.0, 6.2), (60.0, 6.2)],
                further_wires: Vec::new(),
                droppers: vec![DropperLine {
                    top: (10.0, 6.0),
                    bottom: (10.0, 5.0),
                    slack: true,
                }],
                pantographs: vec![vec![vec![(20.0, 5.0)], vec![(20.0, 5.0), (20.0, 4.5)]]],
                forces: vec![100.0, 0.0],
                contacts: vec![20.1, -80.0],
            }],
        },
        time,
    };
    let info = RunInfo {
        assessment: scene::Assessment::default(),
        scene: "sample".to_owned(),
        title: "A <sample> & more".to_owned(),
        mode: "monolithic".to_owned(),
        complete,
        incomplete_reason: if complete {
            String::new()
        } else {
            "diverged at t = 0.5 s".to_owned()
        },
        evaluation: Evaluation {
            time: vec![(1.0, 2.0), (1.0, 2.0)],
            low_pass_hz: 20.0,
            filter: Filter::ZeroPhase,
            bands_hz: vec![[0.0, 5.0], [5.0, 20.0]],
            output_step: 1e-3,
            speed: 50.0,
        },
        coupling: Coupling {
            algorithm: "none".to_owned(),
            reason: "one system".to_owned(),
            energy_residual: Some(0.0),
            energy_share: 0.0,
        },
        model: Model {
            coordinates: 120,
            constraints: 3,
            elements: 20,
            reductions: vec!["planar".to_owned()],
            parts: vec![Part {
                part: "wind_wires".to_owned(),
                modelled: false,
                reason: "scene has no [wind]".to_owned(),
            }],
        },
        cost: Cost {
            wall_s: 1.0,
            simulated_s: 2.0,
            real_time_factor: Some(0.5),
            micro_steps: 2000,
            shares: [("catenary", 0.2), ("pantograph[1]", 0.795), ("master", 0.005)]
                .map(|(part, share)| Share {
                    part: part.to_owned(),
                    share,
                })
                .to_vec(),
            ..Cost::default()
        },
        notes: vec!["coarse mesh".to_owned()],
        ..RunInfo::default()
    };
    (info, record)
}

/// Fields at the JSON `path`, with `/` between them.
fn at<'a>(value: &'a serde_json::Value, path: &str) -> &'a serde_json::Value {
    value.pointer(path).unwrap_or_else(|| panic!("{path} is missing"))
}

#[test]
fn the_summary_has_the_agreed_keys_and_the_known_figures() {
    let (info, record) = run(true);
    let json = serde_json::to_value(Summary::new(&info, &record)).unwrap();
    for path in [
        "/scene",
        "/mode",
        "/complete",
        "/uplift/max_at_support_m",
        "/coupling/algorithm",
        "/coupling/reason",
        "/coupling/energy_residual_J",
        "/model/coordinates",
        "/model/constraints",
        "/model/elements",
        "/model/reductions/0",
        "/model/parts/0/part",
        "/model/parts/0/modelled",
        "/model/parts/0/reason",
        "/cost/wall_s",
        "/cost/setup_s",
        "/cost/simulated_s",
        "/cost/real_time_factor",
        "/cost/macro_steps",
        "/cost/micro_steps",
        "/cost/newton_iterations",
        "/cost/factorizations",
        "/cost/rollbacks",
        "/cost/shares/0/part",
        "/cost/shares/0/share",
        "/limits/0/standard",
        "/limits/0/quantity",
        "/limits/0/value",
        "/limits/0/limit",
        "/limits/0/unit",
        "/limits/0/pass",
        "/limits/0/clause",
        "/limits/0/bound",
        "/limits/0/applicable",
        "/limits/0/reason",
        "/limits/0/certainty",
    ] {
        at(&json, path);
    }
    for kind in ["filtered", "raw"] {
        for figure in ["mean", "std", "max", "min", "statistical_max", "statistical_min"] {
            let value = at(&json, &format!("/pantographs/1/contact_force/{kind}/{figure}"));
            assert!(value.is_f64(), "{kind} {figure} = {value}");
        }
    }
    let near = |path: &str, expected: f64, tolerance: f64| {
        let found = at(&json, path).as_f64().unwrap();
        assert!(
            (found - expected).abs() <= tolerance,
            "{path} = {found}, expected {expected}"
        );
    };
    near("/pantographs/0/contact_force/filtered/mean", 100.0, 1e-9);
    near("/pantographs/0/contact_force/filtered/std", 0.0, 1e-9);
    near("/pantographs/0/contact_force/loss_of_contact_percent", 0.0, 0.0);
    // 1001 samples from 1 s to 2 s, 501 of them even.
    near(
        "/pantographs/1/contact_force/loss_of_contact_percent",
        100.0 * 501.0 / 1001.0,
        1e-12,
    );
    near("/pantographs/1/contact_force/raw/max", 200.0, 0.0);
    near("/pantographs/0/strip/vertical_amplitude_m", 0.02, 1e-12);
    // The largest uplift is at t = 1 s of the whole run.
    near("/uplift/max_at_support_m", 0.03, 1e-12);
}

#[test]
fn a_run_that_ended_early_has_no_statistics_and_no_verdict() {
    let (info, record) = run(false);
    let summary = Summary::new(&info, &record);
    assert_eq!(summary.pantographs[0].contact_force.filtered, None);
    assert_eq!(summary.pantographs[0].contact_force.loss_of_contact_percent, None);
    assert!(summary.limits.iter().all(|limit| limit.pass.is_none()));
    assert!(summary.notes.iter().any(|note| note.contains("evaluation range")));
    assert!(summary.uplift.max_at_support.is_some());
}

#[test]
fn a_summary_written_before_limits_had_clauses_is_still_read() {
    let (info, record) = run(true);
    let mut json = serde_json::to_value(Summary::new(&info, &record)).unwrap();
    for limit in json["limits"].as_array_mut().unwrap() {
        let limit = limit.as_object_mut().unwrap();
        for new in ["clause", "bound", "applicable", "reason", "certainty"] {
            assert!(limit.remove(new).is_some(), "{new}");
        }
    }
    let read: Summary = serde_json::from_value(json).unwrap();
    assert!(read.limits.iter().all(|limit| limit.applicable));
}

#[test]
fn the_limits_of_a_run_are_those_of_its_line() {
    let (mut info, record) = run(true); // 180 km/h; half of the samples of pantograph 2 are 0 N, one by one
    let limit = |info: &RunInfo, quantity: &str, pantograph| {
        let limits = Summary::new(info, &record).limits;
        let found = limits
            .into_iter()
            .find(|l| l.quantity == quantity && l.pantograph == pantograph);
        found.unwrap_or_else(|| panic!("{quantity}"))
    };
    assert!(!limit(&info, "mean", Some(1)).applicable);
    info.line.electrification = Some(scene::Electrification::Dc3Kv);
    info.line.free_uplift = Some(0.05);
    let mean = limit(&info, "mean", Some(1));
    // 0.00097 · 180² + 110 N, rounding of the conversion.
    assert!((mean.limit.unwrap() - 141.428).abs() < 1e-6 && mean.pass == Some(true));
    // No loss is longer than one sample of 1 ms.
    assert_eq!(limit(&info, "arcing", Some(2)).value, Some(0.0));
    // Largest uplift 30 mm, twice that is needed.
    assert_eq!(limit(&info, "free_uplift", None).pass, Some(false));
    // 1 s at 50 m/s.
    assert_eq!(limit(&info, "control_section", Some(1)).value, Some(50.0));
}

#[test]
fn a_force_that_is_not_finite_gives_no_figures_instead_of_wrong_ones() {
    let (info, mut record) = run(true);
    record.pantographs[0].force[1500] = f64::NAN;
    let summary = Summary::new(&info, &record);
    assert_eq!(summary.pantographs[0].contact_force.raw, None);
    assert_eq!(summary.pantographs[0].contact_force.filtered, None);
    assert!(summary.notes.iter().any(|note| note.contains("not finite")));
}

#[test]
fn the_time_series_has_the_agreed_columns() {
    let (_, record) = run(true);
    let mut file = Vec::new();
    write_timeseries(&mut file, "timeseries.csv".as_ref(), &record).unwrap();
    let text = String::from_utf8(file).unwrap();
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "time,contact[1].force,contact[1].x,contact[1].y,contact[1].wire.z,strip[1].z,strip[1].vz,\
         contact[1].gap,contact[2].force,contact[2].x,contact[2].y,contact[2].wire.z,strip[2].z,\
         strip[2].vz,contact[2].gap,support[3].uplift,support[4].uplift"
    );
    assert_eq!(lines.next().unwrap().split(',').next(), Some("0.0"));
    assert_eq!(lines.count(), 2000);
}

#[test]
fn a_directory_that_was_read_back_holds_the_same_run_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (info, mut record) = run(true);
    // Numbers with all digits, very small and very large.
    record.pantographs[0].gap[..3].copy_from_slice(&[0.1 + 0.2, 1.0e-300, -1.0 / 3.0e20]);
    record.animation = record.animation.rounded();
    let directory = OutputDirectory::open(folder.path().join("a/b")).unwrap();
    directory.begin("title = \"x\"\n").unwrap();
    // The wind acts on the second pantograph only, which is controlled.
    record.pantographs[1].control = Some(record.time.iter().map(|t| 20.0 * t.sin()).collect());
    record.pantographs[1].wind = Some(WindRecord {
        drag: record.time.iter().map(|t| 170.0 + t.sin()).collect(),
        lift: record.time.iter().map(|t| 70.0 + t.cos()).collect(),
    });
    let written = directory.finish(&info, record.clone(), "title = \"x\"\n").unwrap();
    let page = crate::report::render(std::slice::from_ref(&written));
    assert!(page.contains("plot-control"));
    directory.write_report(&page).unwrap();
    let read = RunBundle::read(directory.path()).unwrap();
    assert_eq!(read.record, record);
    assert_eq!(read.scene, "title = \"x\"\n");
    assert_eq!(read.summary.limits.len(), written.summary.limits.len());
    assert_eq!(read.summary.model, written.summary.model);
    let mut names: Vec<String> = std::fs::read_dir(directory.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "animation.json",
            "report.html",
            "scene.toml",
            "summary.json",
            "timeseries.csv"
        ]
    );
}

#[test]
fn a_directory_without_animation_holds_no_pictures_and_its_page_no_player() {
    let folder = tempfile::tempdir().unwrap();
    let (info, record) = run(true);
    let output = OutputDirectory::open(folder.path()).unwrap().without_animation();
    let bundle = output.finish(&info, record, "").unwrap();
    assert!(!folder.path().join("animation.json").exists());
    assert!(!report::render(&[bundle]).contains("id=\"player\""));
    RunBundle::read(folder.path()).unwrap();
}

#[test]
fn a_folder_that_cannot_be_made_is_refused_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let error = OutputDirectory::open(file.join("out")).unwrap_err().to_string();
    assert!(error.contains("out: cannot create the folder"), "{error}");
}

#[test]
fn series_of_different_length_are_refused_by_name() {
    let (_, mut record) = run(true);
    record.pantographs[1].strip_vz.pop();
    let error = record.check().unwrap_err().to_string();
    assert_eq!(error, "column strip[2].vz has 2000 samples, time has 2001");
}

#[test]
fn a_damaged_time_series_is_refused_with_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("timeseries.csv");
    let head = "time,contact[1].force,contact[1].x,contact[1].y,contact[1].wire.z,strip[1].z,\
                strip[1].vz,contact[1].gap";
    std::fs::write(&path, format!("{head}\n0,1,2,3,4,5,6,7\n1,1,2,x,4,5,6,7\n")).unwrap();
    let error = read_timeseries(&path).unwrap_err().to_string();
    assert!(
        error.ends_with("line 3, column contact[1].y: \"x\" is not a number"),
        "{error}"
    );
    std::fs::write(&path, format!("{head},strip[1].wind.lift\n")).unwrap();
    let error = read_timeseries(&path).unwrap_err().to_string();
    assert!(
        error.contains("column 9 is \"strip[1].wind.lift\", expected \"strip[i].wind.drag\""),
        "{error}"
    );
    std::fs::write(&path, "time,contact[1].force,contact[1].y\n").unwrap();
    let error = read_timeseries(&path).unwrap_err().to_string();
    assert!(
        error.contains("column 3 is \"contact[1].y\", expected \"contact[1].x\""),
        "{error}"
    );
}
