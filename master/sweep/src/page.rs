//! `sweep.html`: curves for one varied key, maps for two, parallel coordinates for more; best and worst cases with the
//! command that computes the full report.

mod plots;

use std::collections::BTreeMap;

use experiments::engine::table::Status;
use results::report::{Page as Html, cell, escape, head_cells, lined};

use crate::plan::{Case, Plan};
use crate::record::Record;
use crate::run::Summary;
use crate::values::{Value, shown};

/// File of the page.
pub const PAGE: &str = "sweep.html";

/// Most rows that plots draw; of more, every second, third, … case is drawn.
const DRAWN: u64 = 20_000;

/// Best and worst cases listed.
const LISTED: usize = 5;

/// Reasons listed.
const REASONS: usize = 20;

/// Figures drawn: name, unit.
const FIGURES: [(&str, &str); 6] = [
    ("σ", "N"),
    ("mean", "N"),
    ("minimum", "N"),
    ("maximum", "N"),
    ("loss of contact", "%"),
    ("uplift", "m"),
];

/// One row as plots need it.
#[derive(Clone, Debug)]
struct Drawn {
    case: u64,
    pantograph: usize,
    /// Varied, then derived values.
    keys: Vec<Value>,
    /// In the order of [`FIGURES`].
    figures: [Option<f64>; FIGURES.len()],
}

/// A varied or derived key.
#[derive(Clone, Debug)]
struct Key {
    name: String,
    /// Unit of a key of the scene; empty where there is none.
    unit: String,
    is_number: bool,
}

impl Key {
    /// Name and unit for an axis.
    fn label(&self) -> String {
        in_unit(&self.name, &self.unit)
    }
}

/// A name with its unit in brackets, where there is one.
fn in_unit(name: &str, unit: &str) -> String {
    match unit {
        "" | "–" => name.to_owned(),
        _ => format!("{name} [{unit}]"),
    }
}

/// A number as a reader of the page needs it; the tables have all digits.
fn readable(value: &Value) -> String {
    value
        .number()
        .map_or_else(|| value.shown(), |number| shown(rounded(number)))
}

/// Six significant digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

/// A page that is given row by row.
pub struct Page {
    keys: Vec<Key>,
    varied: usize,
    /// Rows between two drawn cases.
    every: u64,
    drawn: Vec<Drawn>,
    /// Standard deviation, number of the pantograph and case: the smallest ones, the largest ones.
    best: Vec<(f64, usize, Case)>,
    worst: Vec<(f64, usize, Case)>,
    /// Reasons with the number of cases and the first of them.
    reasons: BTreeMap<(Status, String), (u64, Case)>,
}

impl Page {
    /// An empty page for so many rows.
    #[must_use]
    pub fn new(plan: &Plan, rows: u64) -> Self {
        let known = scene::described_keys();
        let unit = |name: &str| {
            let path = scene::without_entries(name);
            let of_scene = known.iter().find(|key| key.path() == path);
            of_scene.map_or_else(String::new, |key| key.unit.clone())
        };
        let key = |(name, is_number): (&str, bool)| Key {
            name: name.to_owned(),
            unit: unit(name),
            is_number,
        };
        Self {
            keys: plan.columns().map(key).collect(),
            varied: plan.varied_count(),
            every: rows.div_ceil(DRAWN).max(1),
            drawn: Vec::new(),
            best: Vec::new(),
            worst: Vec::new(),
            reasons: BTreeMap::new(),
        }
    }

    /// Adds the row of a pantograph (from 0).
    pub fn take(&mut self, case: &Case, record: &Record, index: usize) {
        let figures = &record.pantographs[index];
        if record.status != Status::Stable && index == 0 {
            // Numbers in a reason would make each one a reason of its own; a page lists a few.
            let known = self.reasons.len() < 10 * REASONS;
            let key = (record.status, record.reason.clone());
            if let Some((count, _)) = self.reasons.get_mut(&key) {
                *count += 1;
            } else if known {
                self.reasons.insert(key, (1, case.clone()));
            }
        }
        if let Some(std) = figures.std {
            let entry = |list: &mut Vec<(f64, usize, Case)>, before: fn(f64, f64) -> bool| {
                let at = list
                    .iter()
                    .position(|(other, ..)| before(std, *other))
                    .unwrap_or(list.len());
                if at < LISTED {
                    list.insert(at, (std, index + 1, case.clone()));
                    list.truncate(LISTED);
                }
            };
            entry(&mut self.best, |new, old| new < old);
            entry(&mut self.worst, |new, old| new > old);
        }
        if (case.number - 1).is_multiple_of(self.every) {
            let derived = case.derived.iter().map(|value| Value::Number(*value));
            self.drawn.push(Drawn {
                case: case.number,
                pantograph: index + 1,
                keys: case.values.iter().cloned().chain(derived).collect(),
                figures: [
                    figures.std,
                    figures.mean,
                    figures.min,
                    figures.max,
                    figures.loss,
                    record.uplift,
                ],
            });
        }
    }

    /// The page as HTML; `command` computes the full report of a case.
    #[must_use]
    pub fn finish(self, summary: &Summary, command: &dyn Fn(&Case) -> String) -> String {
        let mut html = Html::new(&format!("Sweep of {}", summary.scene));
        html.lead(&self.lead(summary));
        for (heading, body) in plots::sections(&self) {
            html.section(&heading, &body);
        }
        html.section("Smallest and largest standard deviation", &self.extremes(command));
        html.section("Cases without figures", &self.failures(command));
        html.section("Cost", &cost(summary));
        html.finish()
    }

    fn lead(&self, summary: &Summary) -> String {
        let mut lead = format!(
            "<p><b>{}</b> · {}</p>\n",
            escape(&summary.text()),
            escape(&summary.mode)
        );
        if !summary.complete {
            let said = "Incomplete: the same command makes the cases that are missing.";
            lead.push_str(&format!("<p class=\"warning\">{said}</p>\n"));
        }
        let keys: Vec<String> = self.keys[..self.varied].iter().map(|key| escape(&key.name)).collect();
        lead.push_str(&format!("<p>Varied: {}.</p>\n", keys.join(", ")));
        if self.every > 1 {
            lead.push_str(&format!(
                "<p>Plots draw one case of {}; tables hold all.</p>\n",
                self.every
            ));
        }
        lead
    }

    /// Best and worst cases, each linked to its command.
    fn extremes(&self, command: &dyn Fn(&Case) -> String) -> String {
        if self.best.is_empty() {
            return String::new();
        }
        let heads: String = self
            .keys
            .iter()
            .map(|key| head_cells([(&*escape(&key.name), &*escape(&key.unit), true)]))
            .collect();
        let row = |(std, pantograph, case): &(f64, usize, Case)| {
            let derived = case.derived.iter().map(|value| Value::Number(*value));
            let keys = case.values.iter().cloned().chain(derived);
            let keys: String = keys.map(|key| cell("n", &escape(&readable(&key)))).collect();
            let link = format!("<a href=\"#case-{0}\">{0}</a>", case.number);
            let pantograph = cell("n", &pantograph.to_string());
            cell("n", &link) + &pantograph + &keys + &cell("n", &format!("{std:.2}"))
        };
        let first = head_cells([("case", "", true), ("pantograph", "", true)]);
        let head = first + &heads + &head_cells([("σ", "N", true)]);
        let table = |list: &[(f64, usize, Case)], heading: &str| {
            format!("<h3>{heading}</h3>\n{}", lined(&head, list.iter().map(row)))
        };
        let mut html = table(&self.best, "Smallest") + &table(&self.worst, "Largest");
        html.push_str(
            "<h3>Full reports</h3>\n<p class=\"caption\">Each command, given in the folder where the sweep was \
             begun, computes the report that its link opens.</p>\n",
        );
        let mut cases: Vec<&Case> = self.best.iter().chain(&self.worst).map(|(.., case)| case).collect();
        cases.sort_by_key(|case| case.number);
        cases.dedup_by_key(|case| case.number);
        for case in cases {
            html.push_str(&format!(
                "<p id=\"case-{0}\"><a href=\"case-{0}/report.html\">case {0}</a>: <code>{1}</code></p>\n",
                case.number,
                escape(&command(case))
            ));
        }
        html
    }

    /// Reasons of cases that have no figures, the most frequent first.
    fn failures(&self, command: &dyn Fn(&Case) -> String) -> String {
        let mut reasons: Vec<_> = self.reasons.iter().collect();
        reasons.sort_by_key(|(_, (count, case))| (std::cmp::Reverse(*count), case.number));
        if reasons.is_empty() {
            return String::new();
        }
        let row = |((status, reason), (count, case)): (&(Status, String), &(u64, Case))| {
            cell("n", &count.to_string())
                + &cell("c", status.name())
                + &cell("", &escape(reason))
                + &cell("n", &case.number.to_string())
                + &cell("", &format!("<code>{}</code>", escape(&command(case))))
        };
        let head = head_cells([
            ("cases", "", true),
            ("status", "", false),
            ("reason", "", false),
            ("first case", "", true),
            ("command", "", false),
        ]);
        lined(&head, reasons.into_iter().take(REASONS).map(row))
    }
}

fn cost(summary: &Summary) -> String {
    let each = |sum: f64| sum / summary.finished.max(1) as f64;
    format!(
        "<p>Wall time, summed over threads: {:.1} s in time loops ({:.4} s per case), {:.1} s in statics and loading \
         ({:.4} s per case); each case in sweep-times.csv.</p>\n",
        summary.wall_s,
        each(summary.wall_s),
        summary.setup_s,
        each(summary.setup_s)
    )
}
