use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use scene::{Division, Scene};

use super::page::page;
use super::text::text;
use super::*;
use crate::engine::export::{Csv, Exporter as _};
use crate::engine::table::{RunRow, Status};
use crate::engine::tests::executed_in;
use crate::engine::{Store, Table as _};
use simulation::Mode;
use simulation::identity::{identity, settings};

/// A line of three short spans under the standard's pantograph, slow, filtered at 10 Hz: four elements per interval and
/// 2 ms resolve that, and a run takes some hundredths of a second.
fn short(overrides: &[&str]) -> Scene {
    let text = include_str!("../../../../scenes/en50318-250.toml");
    let mut keys = vec![
        "catenary.spans=3",
        "catenary.span_length=30",
        "catenary.droppers.positions=[10.0, 20.0]",
        "catenary.mesh.elements_per_interval=2",
        "run.start_x=10",
        "run.speed_kmh=60",
        "run.duration=2.0",
        "run.evaluate={ time = [0.2, 0.8] }",
        "run.low_pass_hz=10",
        "solver.micro_step=0.002",
    ];
    keys.extend(overrides);
    let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
    system::load(text, "scene.toml", &keys).unwrap()
}

/// As little as a study can be.
fn tiny() -> Options {
    Options {
        elements: vec![1, 2, 4],
        micro_steps: vec![4e-3, 2e-3],
        macro_steps: vec![2e-3],
        rho_inf: vec![0.8],
        repeats: 1,
        quick: true,
        // The second level is near enough.
        tolerance: 90.0,
        ..Options::usual(true)
    }
}

fn scripted(scene: Scene, options: Options) -> Script {
    let mut script = script(scene, "short", Path::new("."), &[], options).unwrap();
    // Small machines and large ones plan the same; two threads are enough to get in each other's way.
    script.machine.cores = 2;
    script
}

/// The store of a study in `folder`.
fn store(script: &Script, folder: &Path) -> Store {
    Store::open(&folder.join(FOLDER), &script.machine).unwrap()
}

/// Makes a study in `folder`; with `stop`, it is interrupted when so many rows are known.
fn studied(script: &Script, folder: &Path, stop: Option<usize>) -> Study {
    let store = store(script, folder);
    let interrupted = AtomicBool::new(false);
    executed_in(&store, script, script.machine.cores, &interrupted, &mut |study| {
        if stop.is_some_and(|stop| study.made().0 >= stop) {
            interrupted.store(true, Ordering::Relaxed);
        }
    })
}

/// Rows without the columns that depend on the clock.
fn without_times(study: &Study) -> Vec<RunRow> {
    let strip = |entry: &Entry| RunRow {
        wall: None,
        real_time_factor: None,
        ..entry.row.clone()
    };
    study.rows.iter().map(strip).collect()
}

#[test]
fn a_study_changes_one_thing_at_a_time_and_no_run_is_planned_twice() {
    let script = scripted(short(&[]), Options::usual(false));
    let planned = &script.planned;
    for (index, run) in planned.iter().enumerate() {
        assert!(planned[..index].iter().all(|other| !other.same(run)), "{run:?}");
    }
    let of = |sweep: Sweep| planned.iter().filter(move |run| run.sweeps.contains(&sweep));
    let elements = |run: &StudyRun| match run.spec.mesh {
        Mesh::Of {
            division: Division::PerInterval(elements),
            ..
        } => elements,
        _ => 0,
    };
    for count in script.options.elements.iter().copied() {
        assert!(of(Sweep::Mesh).any(|run| elements(run) == count));
    }
    let base = script.subject.micro_step;
    // 10 Hz: twice the step that 20 Hz needs.
    assert_eq!((base, script.subject.elements), (2e-3, 4));
    assert!(of(Sweep::Mesh).all(|run| run.spec.micro_step == base && run.variant.mode == Mode::Monolithic));
    for step in script.options.micro_steps.iter().copied() {
        assert!(
            of(Sweep::MicroStep).any(|run| run.spec.micro_step == step && elements(run) == script.subject.elements)
        );
    }
    assert!(of(Sweep::Coupling).all(|run| run.variant.mode == Mode::Inprocess));
    assert!(of(Sweep::Coupling).count() >= script.options.macro_steps.len() + crate::compare::algorithms().len() - 1);
    assert_eq!(of(Sweep::RhoInf).count(), script.options.rho_inf.len());
    // The scene as it is: alone and coupled.
    assert_eq!(of(Sweep::Scene).count(), 2);
    // Both things change on the ladder.
    let mut steps: Vec<u64> = of(Sweep::Ladder).map(|run| run.spec.micro_step.to_bits()).collect();
    steps.sort_unstable();
    steps.dedup();
    assert!(steps.len() >= 3);
    assert_eq!(script.refinements[0].0, Family::Nonlinear);
}

#[test]
fn the_ladder_has_elements_of_one_length_and_the_steps_that_they_take() {
    let text = include_str!("../../../../scenes/en50318-300.toml");
    let scene = system::load(text, "scene.toml", &[]).unwrap();
    let script = scripted(scene, Options::usual(false));
    let division = |run: &StudyRun| match &run.spec.mesh {
        Mesh::Of { division, .. } => Some(*division),
        Mesh::Scene => None,
    };
    let of = |sweep: Sweep| script.planned.iter().filter(move |run| run.sweeps.contains(&sweep));
    let has = |limit: f64, micro_step: f64| {
        let mut rungs = of(Sweep::Ladder);
        rungs.any(|run| division(run) == Some(Division::UpTo(limit)) && run.spec.micro_step == micro_step)
    };
    // 6.5 m in seven and in eight; what the scene refuses is no rung.
    assert!(has(0.9286, 1.6e-3) && has(0.9286, 1.375e-3) && has(0.8125, 1.45e-3) && has(0.4063, 5e-4));
    assert!(of(Sweep::Ladder).all(|run| run.scene.is_some()));
    // What is doubled to be judged stays so many in each interval.
    assert!(of(Sweep::Mesh).all(|run| !matches!(division(run), Some(Division::UpTo(_)))));
    let row = |run: &StudyRun| {
        let scene = system::load(run.scene.as_ref().unwrap(), "scene.toml", &[]).unwrap();
        RunRow::planned("", &scene, run.variant.mode, "")
    };
    let said = |run: &StudyRun| outcome::label(&row(run), script.subject.intervals);
    let rung = of(Sweep::Ladder)
        .find(|run| division(run) == Some(Division::UpTo(0.9286)))
        .unwrap();
    assert_eq!(
        said(rung),
        "elements of up to 0.9286 m (66 per span), contact_compliance+bending_layers+mass_correction, micro step 1.6 \
         ms, planar"
    );
    let base = of(Sweep::Mesh).next().unwrap();
    assert!(
        said(base).starts_with("8 elements per dropper interval, contact_compliance"),
        "{}",
        said(base)
    );
}

#[test]
fn a_reduced_study_is_smaller_and_lists_are_taken_as_typed() {
    let quick = Options {
        quick: true,
        ..Options::usual(false)
    };
    let count = |options: Options| scripted(short(&[]), options).planned.len();
    assert!(count(quick) < count(Options::usual(false)));
    let asked = Options {
        reductions: vec!["none".to_owned(), "planar".to_owned()],
        spans: vec![3, 4],
        ..tiny()
    };
    let script = scripted(short(&[]), asked);
    let of = |sweep: Sweep| script.planned.iter().filter(move |run| run.sweeps.contains(&sweep));
    let sets: Vec<&[String]> = of(Sweep::Reductions)
        .map(|run| run.spec.reductions.as_slice())
        .collect();
    assert_eq!(sets.len(), 2);
    assert!(sets.contains(&&[][..]));
    assert_eq!(
        of(Sweep::Spans).map(|run| run.spec.spans).collect::<Vec<_>>(),
        [Some(3), Some(4)]
    );
}

#[test]
fn what_a_run_spec_changes_does_not_make_another_scene() {
    let identity = |key: &str| identity(&short(&[key]), Path::new("."));
    let own = identity("run.speed_kmh=60");
    for key in [
        "catenary.mesh.elements_per_interval=7",
        "catenary.mesh.element_length=0.9",
        "solver.rho_inf=0.5",
        "solver.micro_step=1e-4",
        "coupling={ algorithm = \"jacobi\", macro_step = 0.004 }",
        "model.reduce=none",
        "run.duration=1.8",
        "title=another",
        "measurement={ strip_mass = 3.0 }",
        "assessment={ editions = [\"EN 50367:2012\"] }",
    ] {
        assert_eq!(identity(key), own, "{key}");
    }
    for key in [
        "run.speed_kmh=61",
        "catenary.spans=4",
        "contact.stiffness=6e4",
        "pantograph[1].masses=[7, 15]",
    ] {
        assert_ne!(identity(key), own, "{key}");
    }
}

#[test]
fn a_table_counts_by_its_content_wherever_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let identity = |file: &str, content: &str| {
        std::fs::write(folder.path().join(file), content).unwrap();
        let more = format!("[vehicle]\nmodel = \"rigid_motion\"\nmotion = {{ file = \"{file}\" }}\n");
        let text = format!("{}\n{more}", short(&[]).to_toml());
        identity(&system::load(&text, "short", &[]).unwrap(), folder.path())
    };
    let own = identity("a.csv", "time,z\n0,0\n1,0.01\n");
    assert_eq!(identity("b.csv", "time,z\n0,0\n1,0.01\n"), own);
    assert_ne!(identity("a.csv", "time,z\n0,0\n1,0.02\n"), own);
}

#[test]
fn keys_that_no_run_spec_says_tell_runs_of_one_run_spec_apart() {
    let of = |key: &str| {
        let text = short(&[key]).to_toml();
        [false, true].map(|coupled| settings(&text, coupled))
    };
    let own = of("run.speed_kmh=60");
    for key in [
        "coupling.force=end",
        "coupling.order=catenary_first",
        "coupling.max_iterations=3",
        "coupling.force_tolerance=0.1",
        "coupling.macro_step={ tolerance = 0.5 }",
    ] {
        let found = of(key);
        assert!(found[0] == own[0] && found[1] != own[1], "{key}");
    }
    for key in [
        "solver.jacobian=full",
        "solver.max_iterations=9",
        "catenary.mesh.axial_strain=full",
    ] {
        let found = of(key);
        assert!(found[0] != own[0] && found[1] != own[1], "{key}");
    }
    for key in [
        "coupling.macro_step=0.004",
        "coupling.parallel=never",
        "solver.rho_inf=0.8",
        "solver.micro_step=1e-4",
        "catenary.mesh.elements_per_interval=4",
        "catenary.mesh.element_length=0.9",
        "model.reduce=none",
    ] {
        assert_eq!(of(key), own, "{key}");
    }
}

#[test]
fn what_is_left_out_of_a_scene_is_left_out_where_it_stands_only() {
    let of = |more: &str, keys: &[&str]| {
        let text = format!("{}\n{more}", include_str!("../../../../scenes/thesis-own-mesh.toml"));
        let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
        identity(
            &system::load(&text, "thesis-own-mesh.toml", &keys).unwrap(),
            Path::new("."),
        )
    };
    let curves = |starts: [f64; 2]| {
        let curve = |start: f64| {
            format!(
                "[[track.curve]]\nstart = {start:?}\nlength = 100.0\ntransition = 60.0\nradius = 3000.0\ncant = 0.05\n\
                 direction = \"left\"\nrounding = 10.0\n"
            )
        };
        of(&starts.map(curve).concat(), &[])
    };
    assert_ne!(curves([300.0, 700.0]), curves([300.0, 750.0]));
    let found = "pantograph[1].start={ height = 4.9, force = 100.0 }";
    assert_eq!(of("", &[found]), of("", &[]));
}

#[test]
fn a_supplied_fmu_is_what_it_holds_and_not_where_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in [("a.fmu", "one"), ("b.fmu", "one"), ("c.fmu", "two")] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let of = |fmu: &str| {
        let text = include_str!("../../../../scenes/en50318-250.toml");
        let (line, _) = text.split_once("[[pantograph]]").unwrap();
        let text = format!("{line}[[pantograph]]\nfmu = {fmu:?}\n");
        identity(&system::load(&text, "scene.toml", &[]).unwrap(), folder.path())
    };
    assert_eq!(of("a.fmu"), of("b.fmu"));
    assert_ne!(of("a.fmu"), of("c.fmu"));
}

#[test]
fn a_small_study_ends_with_a_front_a_table_and_a_page_and_ranks_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let mut options = tiny();
    options.spans = vec![3, 4];
    // Unequal intervals, so that the ladder has meshes of its own.
    let short = |more: &[&str]| short(&[&["catenary.droppers.positions=[8.0, 20.0]"], more].concat());
    let script = scripted(short(&[]), options);
    let study = studied(&script, folder.path(), None);
    assert!(study.complete, "{:?}", without_times(&study));
    let reference = study.reference(Family::Nonlinear).unwrap();
    assert!(reference.converged && reference.uncertainty_percent.unwrap() < 90.0);
    let truth = &study.rows[reference.row.unwrap()];
    assert!(truth.row.filtered_error.is_none() && truth.sweep.contains("reference") && !truth.pareto);
    let stable = |entry: &&Entry| entry.row.status == Some(Status::Stable);
    assert!(study.rows.iter().filter(stable).count() > 5);
    for entry in study.rows.iter().filter(stable) {
        // Every stable run has its figures and its cost.
        assert!(
            entry.row.std.is_some() && entry.row.real_time_factor.unwrap() > 0.0,
            "{entry:?}"
        );
    }
    // More elements and shorter steps are nearer to the truth.
    let error = |elements: u64| {
        let found = study.of(Sweep::Mesh).find(|entry| {
            entry.row.elements_per_span == Some(3 * elements)
                && entry.row.mesh == "plain"
                && entry.row.macro_step.is_none()
        });
        found.unwrap().row.filtered_error.unwrap()
    };
    assert!(error(4) < error(1), "{} {}", error(4), error(1));
    assert!(study.rows.iter().any(|entry| entry.pareto) && !study.recommendations.is_empty());
    // Runs on other lines have a cost and no error.
    for entry in study.of(Sweep::Spans) {
        assert_eq!(
            (entry.row.status, entry.row.filtered_error),
            (Some(Status::Stable), None)
        );
        assert!(entry.spans.is_some() && entry.row.wall.unwrap() > 0.0);
    }

    // The table: the promised columns first, a status in every row, and it reads back.
    let rows = study.sheet().rows;
    let out = Csv.string(&study).unwrap();
    let store = store(&script, folder.path());
    keep_ranks(&store, &study).unwrap();
    let mut reader = csv::Reader::from_reader(out.as_bytes());
    let head = reader.headers().unwrap().clone();
    assert!(
        RunRow::COLUMNS
            .iter()
            .zip(&head)
            .all(|(promised, found)| *promised == found)
    );
    for (record, row) in reader.records().zip(&rows) {
        assert_eq!(record.unwrap().deserialize::<RunRow>(Some(&head)).unwrap(), *row);
    }
    let text = text(&study);
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    let page = page(&study).finish();
    for id in ["plot-precision", "plot-mesh", "plot-micro", "plot-growth"] {
        assert!(page.contains(id), "{id}");
    }
    assert!(!page.contains("<script src") && !page.contains("Incomplete:"));
    assert!(serde_json::to_value(&study).unwrap()["rows"][0]["rms_error_filtered_percent_of_std"].is_number());

    let rank = |scene: &Scene, mode: Mode| rank(folder.path(), scene, Path::new("."), mode);
    // A run of the scene finds its own row; one of another scene finds nothing.
    let said = rank(&short(&[]), Mode::Monolithic).unwrap();
    let own = study
        .of(Sweep::Scene)
        .find(|entry| entry.row.macro_step.is_none())
        .unwrap();
    assert!(
        said.contains(&format!("{:.2} % of σ", own.row.filtered_error.unwrap())),
        "{said}"
    );
    let coupled = rank(&short(&[]), Mode::Cosimulation).unwrap();
    assert!(!coupled.contains("without the coupling"), "{coupled}");
    let unknown = rank(&short(&["catenary.mesh.elements_per_interval=7"]), Mode::Monolithic);
    assert!(unknown.unwrap().contains("not known"));
    // A row that is not stable says so, and the reference is itself.
    let write = |change: &dyn Fn(&mut RunRow)| {
        let mut study = study.clone();
        let rows = study.rows.iter_mut().map(|entry| &mut entry.row);
        rows.filter(|row| row.macro_step.is_none()).for_each(change);
        keep_ranks(&store, &study).unwrap();
    };
    write(&|row| {
        row.status = Some(Status::Limit);
        row.reason = "it rings".to_owned();
    });
    let limit = rank(&short(&[]), Mode::Monolithic).unwrap();
    assert!(
        limit.contains("% of σ (rms") && limit.ends_with("there it is limit: it rings"),
        "{limit}"
    );
    write(&|row| {
        row.status = Some(Status::Diverged);
        row.filtered_error = None;
        row.reason = "it rings".to_owned();
    });
    let diverged = rank(&short(&[]), Mode::Monolithic).unwrap();
    assert!(
        !diverged.contains('%') && diverged.ends_with("there it is diverged: it rings"),
        "{diverged}"
    );
    write(&|_| {});
    let finest = [
        format!(
            "catenary.mesh.elements_per_interval={}",
            truth.row.elements_per_span.unwrap() / 3
        ),
        format!(
            "catenary.mesh.corrections=[\"{}\"]",
            truth.row.mesh.replace('+', "\", \"")
        )
        .replace("[\"plain\"]", "none"),
        format!("solver.micro_step={:?}", truth.row.micro_step.unwrap()),
    ];
    let said = rank(&short(&finest.each_ref().map(String::as_str)), Mode::Monolithic).unwrap();
    assert!(said.contains("is the reference of the nonlinear line"), "{said}");
    // How well the reference is known is said wherever an error is claimed against it.
    let known = text::known(reference);
    assert!(known.starts_with("known to ") && said.contains(&known), "{said}");
    assert!(limit.contains(&known), "{limit}");
    let percent = reference.uncertainty_percent.unwrap();
    for target in TARGETS {
        let caveat = study.caveat(Family::Nonlinear, target);
        assert_eq!(caveat.is_empty(), percent <= target, "{caveat}");
        let found = study
            .recommendations
            .iter()
            .find(|found| found.target_percent == target && found.row.is_some());
        assert!(found.is_none_or(|found| found.text.contains(&caveat) && page.contains(&caveat)));
    }
    // Another exchange has another error, another solver is another run altogether.
    let exchange = rank(&short(&["coupling.force=end"]), Mode::Cosimulation).unwrap();
    assert!(
        exchange.contains("without the coupling (its keys are others there): "),
        "{exchange}"
    );
    let solver = rank(&short(&["solver.jacobian=full"]), Mode::Monolithic).unwrap();
    assert!(solver.contains("other keys") && !solver.contains('%'), "{solver}");
    // A rung of the ladder, by another length that makes the same elements: 3, 4 and 4 in 8, 12 and 10 m.
    let rung = [
        "catenary.mesh.element_length=3.1",
        "coupling.macro_step=0.002",
        "solver.newton_tolerance=0.3",
    ];
    let said = rank(&short(&rung), Mode::Monolithic).unwrap();
    assert!(said.contains("% of σ (rms"), "{said}");
    assert_eq!(rank(&short(&["run.speed_kmh=61"]), Mode::Monolithic), None);
    let nowhere = Path::new("/nonexistent");
    assert_eq!(super::rank(nowhere, &short(&[]), nowhere, Mode::Monolithic), None);
}

#[test]
fn orders_are_observed_where_the_scene_has_the_mesh_of_the_base_case_itself() {
    let scene = short(&["catenary.mesh.elements_per_interval=4", "coupling.macro_step=0.002"]);
    let options = Options {
        sweeps: vec![Sweep::Scene, Sweep::Mesh],
        ..tiny()
    };
    let script = scripted(scene, options);
    let both = |run: &&StudyRun| run.sweeps == [Sweep::Scene, Sweep::Mesh];
    assert_eq!(script.planned.iter().filter(both).count(), 1);
    let folder = tempfile::tempdir().unwrap();
    let study = studied(&script, folder.path(), None);
    let found: Vec<(bool, [f64; 3])> = study
        .orders
        .iter()
        .map(|order| (order.of.starts_with("plain"), order.sizes))
        .collect();
    assert_eq!(found, [(false, [3.0, 6.0, 12.0]), (true, [3.0, 6.0, 12.0])]);
}

#[test]
fn a_sweep_that_was_asked_for_and_has_no_run_says_why() {
    let options = Options {
        sweeps: vec![Sweep::Vehicle, Sweep::Spans],
        ..tiny()
    };
    let folder = tempfile::tempdir().unwrap();
    let study = studied(&scripted(short(&[]), options), folder.path(), None);
    assert!(study.complete && study.rows.is_empty());
    let said = text(&study);
    assert!(
        said.contains("sweep vehicle has no run: the scene has no [vehicle]"),
        "{said}"
    );
    assert!(said.contains("sweep spans has no run: --spans"), "{said}");
}

#[test]
fn strips_held_on_the_wire_are_studied_as_one_system() {
    let scene = short(&["contact={ law = \"sliding_joint\" }"]);
    let options = Options {
        sweeps: vec![
            Sweep::Scene,
            Sweep::Mesh,
            Sweep::MicroStep,
            Sweep::Coupling,
            Sweep::Reductions,
        ],
        ..tiny()
    };
    let script = scripted(scene, options);
    assert!(script.planned.iter().all(|run| run.variant.mode == Mode::Monolithic));
    assert_eq!(
        script.subject.corrections.as_deref(),
        Some(&["bending_layers", "mass_correction"].map(str::to_owned)[..])
    );
    let folder = tempfile::tempdir().unwrap();
    let study = studied(&script, folder.path(), None);
    assert!(study.complete);
    let said = "sweep coupling has no run: contact.law = \"sliding_joint\" makes line and pantograph one system";
    assert!(
        study.notes.iter().any(|note| note.starts_with(said)),
        "{:?}",
        study.notes
    );
    for sweep in [Sweep::Scene, Sweep::Mesh, Sweep::MicroStep, Sweep::Reductions] {
        let known = |entry: &Entry| entry.row.filtered_error.is_some() || entry.row.reference.is_empty();
        assert!(study.of(sweep).count() > 0 && study.of(sweep).all(known), "{sweep:?}");
    }
    // The finer of two meshes under a joint, which takes waves of any length, is nearer to the reference.
    let errors: Vec<f64> = (study.of(Sweep::Mesh))
        .filter(|entry| entry.row.mesh == "plain")
        .filter_map(|entry| entry.row.filtered_error)
        .collect();
    assert!(errors.len() >= 3 && errors.is_sorted_by(|a, b| a > b), "{errors:?}");
    // Where nothing is named, it is said too.
    let all = scripted(short(&["contact={ law = \"sliding_joint\" }"]), tiny());
    assert!(all.empty_sweeps().iter().any(|note| note.starts_with(said)));
}

#[test]
fn a_scene_without_contact_has_a_note_and_neither_errors_nor_recommendations() {
    let scene = short(&[
        "run.initialise=as_given",
        "pantograph[1].static_force=0.5",
        "pantograph[1].reference_height=4.9",
    ]);
    let options = Options {
        sweeps: vec![Sweep::Mesh],
        ..tiny()
    };
    let folder = tempfile::tempdir().unwrap();
    let study = studied(&scripted(scene, options), folder.path(), None);
    assert!(study.complete && study.recommendations.is_empty() && study.orders.is_empty());
    for entry in &study.rows {
        let row = &entry.row;
        assert_eq!((row.status, row.std), (Some(Status::Stable), Some(0.0)), "{row:?}");
        assert_eq!((row.filtered_error, row.raw_error, row.std_error), (None, None, None));
        assert!(
            !entry.pareto && (row.reference.is_empty() || row.reason.contains("does not vary")),
            "{row:?}"
        );
    }
    assert!(
        study.notes.iter().any(|note| note.contains("does not vary")),
        "{:?}",
        study.notes
    );
    assert!(page(&study).finish().contains("does not vary") && text(&study).contains("does not vary"));
}

#[test]
fn a_study_that_was_ended_goes_on_and_comes_to_the_same() {
    let (whole, parts) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let script = scripted(short(&["catenary.droppers.positions=[8.0, 20.0]"]), tiny());
    let expected = studied(&script, whole.path(), None);
    let first = studied(&script, parts.path(), Some(4));
    assert!(!first.complete);
    assert!(page(&first).finish().contains("Incomplete:") && text(&first).contains("INCOMPLETE"));
    let kept = || {
        let names = std::fs::read_dir(parts.path().join("study")).unwrap();
        let names = names.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name.ends_with(".force")).collect();
        names.sort();
        names
    };
    let before = kept();
    assert!(!before.is_empty());
    let modified = |name: &String| {
        std::fs::metadata(parts.path().join("study").join(name))
            .unwrap()
            .modified()
            .unwrap()
    };
    let written: Vec<_> = before.iter().map(modified).collect();
    let second = studied(&script, parts.path(), None);
    assert!(second.complete && kept().len() > before.len());
    // What was there was not made again.
    assert_eq!(before.iter().map(modified).collect::<Vec<_>>(), written);
    assert_eq!(without_times(&second), without_times(&expected));
    // A third time nothing is left to do: the very same, wall times included.
    let third = studied(&script, parts.path(), None);
    let all = |study: &Study| -> Vec<RunRow> { study.rows.iter().map(|entry| entry.row.clone()).collect() };
    assert_eq!(all(&third), all(&second));
}

#[test]
fn a_run_spec_that_the_scene_refuses_has_a_row_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        reductions: vec!["planar+nonsense".to_owned()],
        ..tiny()
    };
    let script = scripted(short(&[]), options);
    let study = studied(&script, folder.path(), None);
    assert!(study.complete);
    let row = &study.of(Sweep::Reductions).next().unwrap().row;
    assert_eq!(row.status, Some(Status::Refused));
    assert!(
        row.reason.contains("nonsense") && row.reduction == "planar+nonsense",
        "{row:?}"
    );
}

/// The thesis' scene on four spans, with this model of the vehicle.
fn short_thesis(vehicle: &str) -> Scene {
    let toml = include_str!("../../../../scenes/thesis-own-mesh.toml");
    let model = format!("vehicle.model={vehicle}");
    let keys = [
        &model,
        "catenary.spans=4",
        "run.duration=1.2",
        "run.evaluate={ time = [0.3, 1.0] }",
        "run.low_pass_hz=10",
        "catenary.mesh.elements_per_interval=1",
        "solver.micro_step=0.002",
    ];
    system::load(toml, "thesis-own-mesh.toml", &keys.map(str::to_owned)).unwrap()
}

#[test]
fn a_study_says_what_each_vehicle_changes_and_keeps_it_apart_from_the_front() {
    let scene = short_thesis("full");
    let options = Options {
        sweeps: vec![Sweep::Vehicle],
        ..tiny()
    };
    let script = scripted(scene, options);
    // What the pantograph stands on is no matter of a converged line.
    assert!(script.refinements.is_empty());
    let folder = tempfile::tempdir().unwrap();
    let study = studied(&script, folder.path(), None);
    assert!(study.complete, "{:?}", without_times(&study));
    let row = |track: &str, vehicle: &str| {
        let of = |entry: &&Entry| {
            entry
                .vehicle_variant
                .is_some_and(|name| name.track == track && name.vehicle == vehicle)
        };
        let mut rows = study.of(Sweep::Vehicle).filter(of);
        (rows.next().unwrap(), rows.next().is_none())
    };
    for track in ["scene", "ore_b176_low"] {
        let error = |vehicle: &str| {
            let (entry, alone) = row(track, vehicle);
            assert!(alone && entry.row.status == Some(Status::Stable), "{:?}", entry.row);
            assert!(entry.row.real_time_factor.is_some());
            if entry.sweep == "vehicle" {
                assert!(
                    !entry.pareto
                        && study
                            .recommendations
                            .iter()
                            .all(|found| { found.row.is_none_or(|index| study.rows[index].sweep != "vehicle") })
                );
            }
            assert!(vehicle == "full" || entry.row.reference == format!("vehicle full, track {track}"));
            entry.row.filtered_error
        };
        let [vertical, given, none] = ["vertical", "rigid_motion", "none"].map(|vehicle| error(vehicle).unwrap());
        println!("{track}: vertical {vertical} %, rigid motion {given} %, none {none} %");
        error("full");
        if track == "scene" {
            // Nothing but the pantograph moves the vehicle.
            assert!(vertical.max(given).max(none) < 0.5, "{vertical} {given} {none}");
        } else {
            // Bounce and pitch are in the plane along the track, and a given motion has all; a straight one has nothing
            // of the track.
            assert!(
                vertical < 0.5 && given < 0.1 && 10.0 * vertical.max(given) < none,
                "{vertical} {given} {none}"
            );
        }
    }
    // The scene's own vehicle on its own track is the base case.
    assert_eq!(row("ore_b176_low", "full").0.sweep, "vehicle");
    let page = page(&study).finish();
    assert!(page.contains("What the pantograph stands on") && page.contains("ore_<wbr>b176_<wbr>low"));
    assert!(text(&study).contains("rigid_motion"));
    let columns = study.sheet().trailing;
    let vehicles = &columns.iter().find(|(name, _)| *name == "vehicle").unwrap().1;
    assert!(vehicles.iter().any(|vehicle| vehicle == "none"));
}

#[test]
fn a_scene_on_a_vehicle_that_is_not_the_most_detailed_is_judged_by_that_and_by_its_own_mesh() {
    let scene = short_thesis("vertical");
    let options = Options {
        sweeps: vec![Sweep::Vehicle, Sweep::Mesh],
        elements: Vec::new(),
        ..tiny()
    };
    let script = scripted(scene, options);
    let named = |run: &&StudyRun, track: &str, vehicle: &str| {
        let name = script.subject.vehicle_of(&run.spec);
        (name.track, name.vehicle) == (track, vehicle)
    };
    let of = |track: &'static str, vehicle: &'static str| {
        let runs = script.planned.iter().filter(move |run| named(run, track, vehicle));
        runs.map(|run| run.sweeps.clone()).collect::<Vec<_>>()
    };
    // Once with the mesh's reference, once with the full vehicle: the same scene, two questions.
    assert_eq!(of("scene", "vertical"), [[Sweep::Mesh], [Sweep::Vehicle]]);
    let [mesh, vehicle] = ["mesh", "vehicle"].map(|name| {
        let mut runs = script.planned.iter().filter(|run| named(run, "scene", "vertical"));
        runs.find(|run| run.sweeps[0].name() == name).unwrap()
    });
    assert!(mesh.scene == vehicle.scene && !mesh.same(vehicle), "{mesh:?}");
    for track in ["scene", "ore_b176_low"] {
        for vehicle in ["full", "rigid_motion", "none"] {
            assert_eq!(of(track, vehicle), [[Sweep::Vehicle]], "{track} {vehicle}");
        }
    }
    // What stands on no track is the same run on both, and judged by another one on each.
    let on = |track: &str| script.planned.iter().find(|run| named(run, track, "none")).unwrap();
    let (smooth, rough) = (on("scene"), on("ore_b176_low"));
    assert!(smooth.scene == rough.scene && !smooth.same(rough));
    let folder = tempfile::tempdir().unwrap();
    let study = studied(&script, folder.path(), None);
    let judged = |entry: &&Entry| {
        let name = entry.vehicle_variant.unwrap();
        (name.track, name.vehicle) == ("scene", "vertical")
    };
    let rows: Vec<&Entry> = study.rows.iter().filter(judged).collect();
    let own = rows.iter().find(|entry| entry.sweep == "vehicle").unwrap();
    assert_eq!(own.row.reference, "vehicle full, track scene");
    assert!(own.row.filtered_error.is_some_and(|error| error > 0.0 && error < 0.5));
    let mesh = rows.iter().find(|entry| entry.sweep.contains("mesh")).unwrap();
    assert!(mesh.row.reference.starts_with("nonlinear"), "{}", mesh.row.reference);
}
