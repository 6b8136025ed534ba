use std::collections::BTreeMap;

use super::super::open::OPEN;
use super::{line, page, plan, reproduction, text};
use crate::engine::table::{Column, RunRow, Status};
use crate::engine::{Exporter as _, Sheet, Table as _, export};
use crate::reproduce::{Mesh, Reproduction, RunGroup};
use results::curve::ForceCurve;
use simulation::Mode;

/// The table as a program reads it: each row by the names of its columns.
fn read(made: &Reproduction) -> Vec<BTreeMap<String, String>> {
    let text = export::Csv.string(made).unwrap();
    csv::Reader::from_reader(text.as_bytes())
        .deserialize()
        .map(Result::unwrap)
        .collect()
}

/// Every planned run, made with figures of its own or not at all.
fn all(quick: bool, made: bool) -> Reproduction {
    let runs = plan(quick, &[]);
    let lines = runs.iter().enumerate().map(|(index, run)| {
        let case = crate::reproduce::CASES
            .iter()
            .position(|case| case == run.case)
            .unwrap();
        let std = 30.0 + 0.1 * index as f64;
        let mut line = line(run.group, case, run.mesh, 100.0 + index as f64, std);
        line.quantity = run.quantity;
        line.value = run.value.clone();
        line.row.mode = run.variant.mode.name().to_owned();
        if !made {
            line.row = RunRow {
                mode: line.row.mode,
                ..RunRow::default()
            };
            line.raw_std = None;
        }
        line
    });
    reproduction(lines.collect())
}

#[test]
fn the_table_holds_every_run_every_relation_and_every_spread() {
    for quick in [false, true] {
        let made = all(quick, true);
        let rows = read(&made);
        let of = |group: &str| rows.iter().filter(|row| row["group"] == group).collect::<Vec<_>>();
        let meshes = if quick { 2 } else { Mesh::ALL.len() };
        // Three pairs of cases, mean and standard deviation.
        assert_eq!(of("relation").len(), 6 * meshes);
        let refined = OPEN.iter().filter(|open| !quick && open.is_on(Mesh::Corrected)).count();
        assert_eq!(of("spread").len(), OPEN.len() + refined);
        assert_eq!(rows.len(), made.lines.len() + 6 * meshes + OPEN.len() + refined);
        for row in of("relation").into_iter().chain(of("spread")) {
            assert!(!row["verdict"].is_empty() && !row["reason"].is_empty(), "{row:?}");
            assert_eq!(row["status"], "stable");
            // Figures of runs stand in their own rows only.
            assert_eq!(row["std_N"], "");
        }
        for row in rows.iter().take(made.lines.len()) {
            assert_eq!(row["verdict"], "");
        }
    }
}

#[test]
fn a_relation_stands_in_the_table_with_both_figures_and_its_verdict() {
    let mut to = line(RunGroup::Published, 1, Mesh::Plain(1), 107.21, 42.59);
    to.row.elements_per_span = Some(9);
    let made = reproduction(vec![line(RunGroup::Published, 0, Mesh::Plain(1), 106.98, 47.41), to]);
    let rows = read(&made);
    let [mean, std] = &rows[2..] else {
        panic!("two runs and two relations: {rows:?}")
    };
    for (row, of) in [(mean, "mean"), (std, "std")] {
        assert_eq!(row["group"], "relation");
        assert_eq!(row["case"], "sliding joint, no wind");
        assert_eq!(row["quantity"], of);
        assert_eq!(row["value"], "change from penalty contact, no wind");
        assert_eq!(row["elements_per_span"], "9");
    }
    let number = |text: &str| text.parse::<f64>().unwrap();
    // 110.427/107.79 and 37.3033/36.73; 107.21/106.98 and 42.59/47.41.
    assert!((number(&mean["published_change_percent"]) - 2.446).abs() < 5e-4); // printed digits
    assert!((number(&std["published_change_percent"]) - 1.561).abs() < 5e-4); // printed digits
    assert!((number(&mean["computed_change_percent"]) - 0.215).abs() < 5e-4); // printed digits
    assert!((number(&std["computed_change_percent"]) + 10.167).abs() < 5e-4); // printed digits
    assert_eq!(mean["verdict"], "direction only");
    assert_eq!(std["verdict"], "refuted");
}

#[test]
fn a_spread_stands_in_the_table_with_its_ends_and_whether_the_published_value_lies_inside() {
    let mesh = Mesh::Corrected;
    let mut lines = vec![line(RunGroup::Mesh, 0, mesh, 106.31, 37.31)];
    for (value, std) in [("10000.0 N/m", 34.2), ("20000.0 N/m", 35.5)] {
        let mut run = line(RunGroup::Open, 0, mesh, 106.0, std);
        run.quantity = "contact stiffness k";
        run.value = value.to_owned();
        lines.push(run);
    }
    let rows = read(&reproduction(lines));
    let row = rows.last().unwrap();
    assert_eq!(row["group"], "spread");
    assert_eq!(row["quantity"], "contact stiffness k");
    assert_eq!(row["value"], "10000.0 N/m; 20000.0 N/m");
    assert_eq!((&*row["smallest_std_N"], &*row["largest_std_N"]), ("34.2", "37.31"));
    assert_eq!(row["published_std_N"], "36.73");
    assert_eq!(row["verdict"], "inside");
}

#[test]
fn columns_that_were_there_keep_their_names_and_places() {
    let Sheet { leading, trailing, .. } = all(true, true).sheet();
    let names = |columns: &[Column]| columns.iter().map(|(name, _)| *name).collect::<Vec<_>>();
    assert_eq!(names(&leading), ["group", "case", "quantity", "value"]);
    assert_eq!(
        names(&trailing)[..12],
        [
            "raw_std_N",
            "head_drag_min_N",
            "head_drag_mean_N",
            "head_drag_max_N",
            "head_lift_min_N",
            "head_lift_mean_N",
            "head_lift_max_N",
            "published_mean_N",
            "published_std_N",
            "mean_difference_percent",
            "std_difference_percent",
            "source"
        ]
    );
}

#[test]
fn runs_that_were_not_made_are_shown_as_such() {
    for quick in [false, true] {
        let none = all(quick, false);
        assert!(!none.complete);
        for row in read(&none) {
            assert_eq!(row["status"], "", "{row:?}");
            if row["group"] == "relation" || row["group"] == "spread" {
                assert_eq!(row["verdict"], "not computed");
            }
        }
        assert!(page(&none).finish().contains("Incomplete: 0 of"));
        assert!(text(&none).contains("0 of"));
    }
    // Any run may be the one that is missing.
    let whole = all(true, true);
    for missing in 0..whole.lines.len() {
        let mut lines = whole.lines.clone();
        lines.remove(missing);
        let made = reproduction(lines);
        assert_eq!(read(&made).len(), made.sheet().rows.len());
        assert!(!text(&made).is_empty());
    }
    assert!(read(&reproduction(Vec::new())).is_empty());
}

#[test]
fn a_refused_run_makes_its_relation_and_its_spread_refused() {
    let mut made = all(true, true);
    for line in &mut made.lines {
        let open = line.quantity == "contact damping d" && line.value == "10.0 N s/m";
        let joint = line.group == RunGroup::Published && line.case.scene == "thesis-sliding-joint";
        if open || joint {
            line.row.status = Some(Status::Refused);
            (line.row.mean, line.row.std) = (None, None);
        }
    }
    let rows = read(&reproduction(made.lines));
    let spread = rows
        .iter()
        .find(|row| row["group"] == "spread" && row["quantity"] == "contact damping d");
    let spread = spread.unwrap();
    assert_eq!(spread["status"], "refused");
    assert!(spread["reason"].ends_with("3 of 4 values computed"), "{spread:?}");
    let relation = rows.iter().find(|row| row["group"] == "relation").unwrap();
    assert_eq!(
        (&*relation["status"], &*relation["verdict"]),
        ("refused", "not computed")
    );
}

#[test]
fn figures_are_drawn_on_the_thesis_mesh_and_beside_it_on_the_finest_that_was_computed() {
    let drawn = |mesh: Mesh, case: usize, force: f64| {
        let group = if mesh == Mesh::Plain(1) {
            RunGroup::Published
        } else {
            RunGroup::Mesh
        };
        let mut run = line(group, case, mesh, 100.0, 40.0);
        run.output_step = 4.0;
        run.curve = Some(ForceCurve {
            x: vec![0.0, 1.0, 2.0],
            filtered: vec![force; 3],
            raw: vec![force; 3],
            range: 0..3,
        });
        run
    };
    let plain = vec![
        drawn(Mesh::Plain(1), 0, 111.5),
        drawn(Mesh::Plain(2), 0, 122.5),
        drawn(Mesh::Plain(2), 1, 123.5),
    ];
    let html = page(&reproduction(plain.clone())).finish();
    for id in [
        "figure-6-thesis",
        "figure-6-refined",
        "figure-7-thesis",
        "figure-7-refined",
    ] {
        assert!(html.contains(id), "{id}");
    }
    assert!(html.contains("122.5"));
    // The converged mesh takes the place of a coarser one, where it has all cases that a figure shows.
    let mut more = plain;
    more.push(drawn(Mesh::Corrected, 0, 133.5));
    let html = page(&reproduction(more)).finish();
    assert!(html.contains("133.5"));
    assert!(
        html.contains("123.5"),
        "Fig. 8 shows the joint, which has no converged run"
    );
    // Nothing refined, nothing beside.
    let alone = page(&reproduction(vec![drawn(Mesh::Plain(1), 0, 111.5)])).finish();
    assert!(alone.contains("figure-6-thesis") && !alone.contains("figure-6-refined"));
    // A co-simulated run is no published case of another mesh, and not drawn for one.
    let mut coupled = drawn(Mesh::Plain(2), 0, 144.5);
    coupled.row.mode = Mode::Cosimulation.name().to_owned();
    assert!(!page(&reproduction(vec![coupled])).finish().contains("144.5"));
}
