use super::*;
use crate::engine::Sheet;
use results::curve::Errors;

/// The columns of tables that compare runs, as the command line promises them.
const PROMISED: &str = "scene, mode, algorithm, extrapolation, macro_step_s, micro_step_s, elements_per_span, mesh, \
    reduction, status, mean_N, std_N, max_N, min_N, loss_percent, uplift_m, reference, \
    rms_error_filtered_percent_of_std, rms_error_raw_percent_of_std, std_error_percent, energy_residual_J, wall_s, \
    repeats, real_time_factor, coordinates, macro_steps, micro_steps, newton_iterations, factorizations, rollbacks";

fn csv(rows: &[RunRow], leading: &[Column], trailing: &[Column]) -> String {
    let sheet = Sheet {
        leading: leading.to_vec(),
        rows: rows.to_vec(),
        trailing: trailing.to_vec(),
    };
    sheet.csv().unwrap()
}

#[test]
fn the_table_begins_with_the_promised_columns() {
    let promised: Vec<&str> = PROMISED.split(", ").collect();
    let text = csv(&[], &[], &[]);
    let written: Vec<&str> = text.trim_end().split(',').collect();
    assert_eq!(written[..promised.len()], promised[..]);
    assert_eq!(
        written[promised.len()..],
        ["observed_order", "element_length_m", "reason"]
    );
}

#[test]
fn a_cell_without_meaning_is_empty_and_numbers_read_back() {
    let row = RunRow {
        scene: "thesis, short".to_owned(),
        macro_step: Some(1e-4),
        std: Some(f64::NAN),
        status: Some(Status::Limit),
        rollbacks: Some(0),
        ..RunRow::default()
    };
    let text = csv(std::slice::from_ref(&row), &[], &[]);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let head = reader.headers().unwrap().clone();
    let cells = reader.records().next().unwrap().unwrap();
    let cell = |name: &str| &cells[head.iter().position(|column| column == name).unwrap()];
    assert_eq!(cell("scene"), "thesis, short");
    assert_eq!(cell("macro_step_s").parse::<f64>().unwrap(), 1e-4);
    assert_eq!((cell("std_N"), cell("mean_N"), cell("wall_s")), ("", "", ""));
    assert_eq!((cell("status"), cell("rollbacks")), ("limit", "0"));
    let json = serde_json::to_value(&row).unwrap();
    assert_eq!(json["status"], "limit");
    assert!(json["std_N"].is_null());
    assert_eq!(json.as_object().unwrap().len(), RunRow::COLUMNS.len());
}

#[test]
fn other_columns_may_lead_and_follow() {
    let column = |name: &'static str, cell: &str| (name, vec![cell.to_owned()]);
    let text = csv(
        &[RunRow::default()],
        &[column("case", "head of 1 kg")],
        &[column("passes", "1.5")],
    );
    let mut lines = text.lines();
    let head = lines.next().unwrap();
    assert!(head.starts_with("case,scene,mode") && head.ends_with(",reason,passes"));
    let cells = lines.next().unwrap();
    assert!(cells.starts_with("head of 1 kg,,") && cells.ends_with(",1.5"));
}

#[test]
fn the_status_follows_the_stated_bounds() {
    let row = |loss: f64| RunRow {
        mean: Some(100.0),
        std: Some(20.0),
        loss: Some(loss),
        ..RunRow::default()
    };
    let errors = |filtered: f64, raw: f64| Errors {
        filtered: Some(filtered),
        raw: Some(raw),
        std: Some(0.0),
    };
    let reference = row(2.0);
    let status =
        |loss: f64, complete: bool, errors: Errors| Status::of(&row(loss), complete, Some(&errors), Some(&reference)).0;
    assert_eq!(status(2.0, true, errors(5.0, 20.0)), Status::Stable);
    assert_eq!(status(4.0 + 0.9 * LOSS, true, errors(5.0, 20.0)), Status::Stable);
    assert_eq!(status(4.0 + 1.1 * LOSS, true, errors(5.0, 20.0)), Status::Limit);
    assert_eq!(status(2.0, true, errors(5.0, 1.01 * RAW_ERROR)), Status::Limit);
    assert_eq!(status(2.0, true, errors(1.01 * RUNAWAY, 300.0)), Status::Diverged);
    assert_eq!(status(2.0, false, errors(5.0, 20.0)), Status::Diverged);
    assert_eq!(status(2.0, true, errors(f64::NAN, 20.0)), Status::Diverged);
    assert_eq!(status(2.0, true, Errors::default()), Status::Diverged);
    // A reference is compared with nothing, but must have a force.
    assert_eq!(Status::of(&row(50.0), true, None, None).0, Status::Stable);
    assert_eq!(Status::of(&RunRow::default(), true, None, None).0, Status::Diverged);
}

#[test]
fn orders_are_slopes_between_neighbours_of_the_same_method() {
    let row = |algorithm: &str, step: f64, error: f64, status: Status| RunRow {
        mode: "cosimulation".to_owned(),
        algorithm: algorithm.to_owned(),
        macro_step: Some(step),
        filtered_error: Some(error),
        status: Some(status),
        ..RunRow::default()
    };
    let mut rows = [
        row("jacobi", 4e-3, 6.0, Status::Stable),
        row("auto", 1e-3, 0.5, Status::Stable),
        row("jacobi", 1e-3, 1.5, Status::Stable),
        row("auto", 2e-3, 2.0, Status::Stable),
        row("auto", 4e-3, 90.0, Status::Limit),
        row("auto", 8e-3, 95.0, Status::Stable),
    ];
    observed_orders(&mut rows);
    let orders: Vec<Option<f64>> = rows.iter().map(|row| row.order).collect();
    // Neither to nor across a run that is not stable.
    for (index, expected) in [Some(1.0), None, None, Some(2.0), None, None].into_iter().enumerate() {
        match (orders[index], expected) {
            (Some(order), Some(expected)) => assert!((order - expected).abs() < 1e-12),
            (order, expected) => assert_eq!(order, expected, "row {index}"),
        }
    }
}

#[test]
fn a_coupling_that_adds_energy_is_not_plainly_stable() {
    assert_eq!(Status::Stable.with_energy(0.05), (Status::Stable, String::new()));
    let (status, reason) = Status::Stable.with_energy(0.134);
    assert_eq!(status, Status::Limit);
    assert_eq!(reason, "the coupling added 13.4 % of the work that crossed the contact");
    let (status, reason) = Status::Stable.with_energy(-0.2);
    assert_eq!(status, Status::Limit);
    assert!(reason.contains("took 20.0 %"), "{reason}");
    // A worse status stays, and so does its reason.
    assert_eq!(Status::Diverged.with_energy(3.0), (Status::Diverged, String::new()));
}
