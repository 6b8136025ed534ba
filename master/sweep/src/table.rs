//! Table of a sweep: one row per case and pantograph.

use std::io::Write;

use crate::plan::{Case, Plan};
use crate::record::Record;
use crate::values::{Value, shown};

/// Columns that every table has; varied and derived keys stand behind the first two.
pub const FIXED_COLUMNS: [&str; 18] = [
    "case",
    "pantograph",
    "status",
    "reason",
    "mean_N",
    "std_N",
    "min_N",
    "max_N",
    "loss_percent",
    "uplift_m",
    "limits_failed",
    "failed_limits",
    "coordinates",
    "macro_steps",
    "micro_steps",
    "newton_iterations",
    "factorizations",
    "rollbacks",
];

/// Fixed columns before the keys.
const LEADING: usize = 2;

/// Columns of the filtered force, in Parquet alone: samples, time of the first one and between two, s.
pub const SERIES_COLUMNS: [&str; 3] = ["filtered_N", "filtered_from_s", "filtered_step_s"];

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// Whole number.
    Count,
    /// Number.
    Number,
    /// Text.
    Text,
}

/// Entry of a table; nothing where a column has no meaning for its row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Whole number.
    Count(Option<u64>),
    /// Number.
    Number(Option<f64>),
    /// Text.
    Text(Option<String>),
}

impl Cell {
    /// Text of the cell; empty for nothing.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Count(value) => value.map_or_else(String::new, |value| value.to_string()),
            Self::Number(value) => value.map_or_else(String::new, shown),
            Self::Text(value) => value.clone().unwrap_or_default(),
        }
    }
}

/// Names and types of the columns of a plan's table, in order.
#[must_use]
pub fn columns(plan: &Plan) -> Vec<(String, CellKind)> {
    let fixed = |name: &&str| {
        let kind = match *name {
            "status" | "reason" | "failed_limits" => CellKind::Text,
            name if name.contains("_N") || ["loss_percent", "uplift_m"].contains(&name) => CellKind::Number,
            _ => CellKind::Count,
        };
        ((*name).to_owned(), kind)
    };
    let keys = plan.columns().map(|(name, is_number)| {
        let kind = if is_number { CellKind::Number } else { CellKind::Text };
        (name.to_owned(), kind)
    });
    let (leading, others) = FIXED_COLUMNS.split_at(LEADING);
    leading
        .iter()
        .map(fixed)
        .chain(keys)
        .chain(others.iter().map(fixed))
        .collect()
}

/// Rows of a finished case.
#[must_use]
pub fn rows(plan: &Plan, case: &Case, record: &Record) -> Vec<Vec<Cell>> {
    let numbers: Vec<bool> = plan.columns().map(|(_, is_number)| is_number).collect();
    let key = |(value, is_number): (&Value, &bool)| match value {
        Value::Number(number) if *is_number => Cell::Number(Some(*number)),
        value => Cell::Text(Some(value.shown())),
    };
    let keys: Vec<Cell> = case.values.iter().zip(&numbers).map(key).collect();
    let derived = case
        .derived
        .iter()
        .map(|value| Cell::Number(Some(*value).filter(|value| value.is_finite())));
    let keys: Vec<Cell> = keys.into_iter().chain(derived).collect();
    let counts = record.counts;
    let rows = record.pantographs.iter().enumerate().map(|(index, figures)| {
        let known = figures.mean.is_some();
        let mut row = vec![Cell::Count(Some(record.case)), Cell::Count(Some(index as u64 + 1))];
        row.extend(keys.iter().cloned());
        row.push(Cell::Text(Some(record.status.name().to_owned())));
        row.push(Cell::Text(
            Some(record.reason.clone()).filter(|reason| !reason.is_empty()),
        ));
        let forces = [figures.mean, figures.std, figures.min, figures.max];
        row.extend(
            forces
                .into_iter()
                .chain([figures.loss, record.uplift])
                .map(Cell::Number),
        );
        row.push(Cell::Count(known.then_some(figures.failed.len() as u64)));
        row.push(Cell::Text(
            Some(figures.failed.join("; ")).filter(|failed| !failed.is_empty()),
        ));
        row.extend(
            [
                counts.map(|counts| counts.coordinates),
                counts.map(|counts| counts.macro_steps),
                counts.map(|counts| counts.micro_steps),
                counts.map(|counts| counts.newton_iterations),
                counts.map(|counts| counts.factorizations),
                counts.map(|counts| counts.rollbacks),
            ]
            .map(Cell::Count),
        );
        row
    });
    rows.collect()
}

/// Writes rows as CSV.
pub struct CsvTable<W: Write>(csv::Writer<W>);

impl<W: Write> CsvTable<W> {
    /// A table that begins with the names of the plan's columns.
    ///
    /// # Errors
    /// Reports of `out`.
    pub fn new(plan: &Plan, out: W) -> Result<Self, csv::Error> {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(columns(plan).iter().map(|(name, _)| name))?;
        Ok(Self(writer))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Reports of `out`.
    pub fn row(&mut self, row: &[Cell]) -> Result<(), csv::Error> {
        self.0.write_record(row.iter().map(Cell::text))
    }

    /// Ends the table.
    ///
    /// # Errors
    /// Reports of `out`.
    pub fn finish(mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}
