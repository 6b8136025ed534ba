//! Pareto front of error and cost, and recommendations for a given error.

use serde::Serialize;

use super::run_spec::Class;
use crate::engine::export::grouped;
use crate::engine::table::{RunRow, Status};

/// Errors that a recommendation is given for, % of the standard deviation.
pub const TARGETS: [f64; 3] = [3.0, 1.0, 0.3];

/// Real-time factor and filtered error of a row that can be on the front.
pub(super) fn point(row: &RunRow) -> Option<(f64, f64)> {
    let factor = row
        .real_time_factor
        .filter(|factor| factor.is_finite() && *factor > 0.0)?;
    let error = row.filtered_error.filter(|error| error.is_finite() && *error >= 0.0)?;
    (row.status == Some(Status::Stable)).then_some((factor, error))
}

/// Rows that no other row of their class beats: none is both cheaper and more accurate, or one of these and equal in
/// the other.
pub(super) fn pareto(rows: &[&RunRow]) -> Vec<bool> {
    let points: Vec<_> = rows
        .iter()
        .map(|row| Some((Class::of(&row.reduction), point(row)?)))
        .collect();
    let beaten = |at: usize| {
        let Some((class, (cost, error))) = points[at] else {
            return true;
        };
        points.iter().enumerate().any(|(other, point)| {
            let Some((its, (its_cost, its_error))) = *point else {
                return false;
            };
            let better = its_cost < cost || its_error < error;
            // Of two equal rows the first one stays.
            let equal_and_first = its_cost == cost && its_error == error && other < at;
            its == class && its_cost <= cost && its_error <= error && (better || equal_and_first)
        })
    };
    (0..rows.len()).map(|at| !beaten(at)).collect()
}

/// Recommendation for an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recommendation {
    /// Rows that were chosen from.
    pub class: String,
    /// Error asked for, % of the standard deviation.
    pub target_percent: f64,
    /// The cheapest row that is accurate enough; `None` where there is none.
    pub row: Option<usize>,
    /// Reason why the reference cannot vouch for that error; empty where it can.
    pub caveat: String,
    /// All of it in words.
    pub text: String,
}

/// For each class that has rows with errors, and each target, the cheapest row that reaches it; `name` names a row,
/// `caveat` says what the reference of a class leaves open of a target.
pub(super) fn recommendations(
    rows: &[&RunRow],
    name: impl Fn(usize) -> String,
    caveat: impl Fn(Class, f64) -> String,
) -> Vec<Recommendation> {
    let placed = rows.iter().enumerate();
    let placed = placed.filter_map(|(index, row)| Some((Class::of(&row.reduction), (index, point(row)?))));
    let mut classes = grouped(placed);
    classes.sort_by_key(|(class, _)| *class);
    let mut all = Vec::new();
    for (class, of_class) in classes {
        let errors = of_class.iter().map(|(_, (_, error))| *error);
        let best = errors.fold(f64::INFINITY, f64::min);
        for target in TARGETS {
            let enough = of_class.iter().filter(|(_, (_, error))| *error <= target);
            let chosen = enough.min_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
            let caveat = chosen.map_or_else(String::new, |_| caveat(class, target));
            let text = match chosen {
                Some((index, (factor, error))) => {
                    let but = if caveat.is_empty() { "" } else { "; " };
                    let (name, speed) = (name(*index), speed(*factor));
                    format!("for {target} % take {name}: {error:.2} %, {speed}{but}{caveat}")
                }
                None => {
                    let count = of_class.len();
                    format!("{target} % is not reached: {best:.2} % is the best of {count} runs")
                }
            };
            all.push(Recommendation {
                class: class.name(),
                target_percent: target,
                row: chosen.map(|(index, _)| *index),
                caveat,
                text,
            });
        }
    }
    all
}

/// A real-time factor in words.
pub(super) fn speed(factor: f64) -> String {
    if factor <= 1.0 {
        format!("{:.1} times faster than real time", 1.0 / factor)
    } else {
        format!("{factor:.1} times slower than real time")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(reduction: &str, factor: f64, error: f64) -> RunRow {
        RunRow {
            reduction: reduction.to_owned(),
            real_time_factor: Some(factor),
            filtered_error: Some(error),
            status: Some(Status::Stable),
            ..RunRow::default()
        }
    }

    #[test]
    fn the_front_is_what_nothing_of_the_same_class_beats() {
        let mut rows = vec![
            row("planar", 0.1, 5.0),
            row("planar", 0.2, 1.0),
            row("planar", 0.3, 1.0),  // dearer, no better
            row("planar", 0.2, 2.0),  // as dear, worse
            row("planar", 0.2, 1.0),  // the same again
            row("planar", 0.05, 9.0), // limit, below
            row("planar", 1.0, 0.1),
            row("planar+linearised", 0.01, 0.05), // another class
        ];
        rows[5].status = Some(Status::Limit);
        rows.push(RunRow {
            filtered_error: None,
            ..row("planar", 0.01, 0.0)
        });
        let rows: Vec<&RunRow> = rows.iter().collect();
        let expected = [true, true, false, false, false, false, true, true, false];
        assert_eq!(pareto(&rows), expected);
    }

    #[test]
    fn the_cheapest_row_that_is_accurate_enough_is_recommended() {
        let rows = [
            row("planar", 0.1, 2.9),
            row("planar", 0.5, 0.9),
            row("planar", 0.25, 0.8),
            row("planar+window", 0.02, 0.2),
        ];
        let rows: Vec<&RunRow> = rows.iter().collect();
        let unsure = |class: Class, target: f64| {
            let said = class.window && target < 1.0;
            if said { "not sure".to_owned() } else { String::new() }
        };
        let all = recommendations(&rows, |index| format!("row {index}"), unsure);
        let chosen: Vec<(&str, f64, Option<usize>)> = all
            .iter()
            .map(|found| (found.class.as_str(), found.target_percent, found.row))
            .collect();
        assert_eq!(
            chosen,
            [
                ("nonlinear, whole line", 3.0, Some(0)),
                ("nonlinear, whole line", 1.0, Some(2)),
                ("nonlinear, whole line", 0.3, None),
                ("nonlinear, window", 3.0, Some(3)),
                ("nonlinear, window", 1.0, Some(3)),
                ("nonlinear, window", 0.3, Some(3)),
            ]
        );
        assert!(all[1].text.contains("row 2: 0.80 %, 4.0 times faster than real time"));
        assert!(all[2].text.contains("0.80 % is the best of 3 runs"));
        assert!(all[5].text.ends_with("real time; not sure") && all[5].caveat == "not sure");
        assert!(all[..5].iter().all(|found| found.caveat.is_empty()));
    }
}
