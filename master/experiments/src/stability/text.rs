//! The table on the terminal.

use super::judge::{Line, StabilityTable};
use crate::engine::export::status_word;
use crate::engine::table::Status;
use results::report::aligned;
use results::report::format::{significant, wrapped};
use simulation::Mode;

impl Line {
    /// Way of running the case, in the head of a column.
    pub(super) fn way(&self) -> String {
        let (mode, algorithm) = self.row.method();
        match mode {
            mode if mode == Mode::Monolithic.name() => "one system".to_owned(),
            mode if mode == Mode::Cosimulation.name() => format!("{algorithm}, FMUs"),
            _ => algorithm.to_owned(),
        }
    }
}

/// The ways of running a case, in the order of the columns.
pub(super) fn ways(table: &StabilityTable) -> Vec<String> {
    let mut ways = Vec::new();
    for way in table.lines.iter().map(Line::way) {
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    ways
}

/// Lines of one case, which follow one another.
pub(super) fn by_case(table: &StabilityTable) -> impl Iterator<Item = &[Line]> {
    table.lines.chunk_by(|a, b| a.case == b.case)
}

/// Number of runs with each status, in words.
pub(super) fn counts(table: &StabilityTable) -> String {
    let of = |status: &Status| {
        table
            .lines
            .iter()
            .filter(|line| line.row.status == Some(*status))
            .count()
    };
    let counts = Status::ALL
        .iter()
        .map(|status| format!("{} {}", of(status), status.name()));
    counts.collect::<Vec<_>>().join(", ")
}

/// The table of the hard cases.
pub(super) fn text(table: &StabilityTable) -> String {
    let ways = ways(table);
    let head = ways.iter().map(|way| way.replace("interface_jacobian", "jacobian"));
    let mut rows: Vec<Vec<String>> = vec![std::iter::once(String::new()).chain(head).collect()];
    rows.extend(by_case(table).map(|lines| {
        let status = |way: &String| {
            let line = lines.iter().find(|line| line.way() == *way);
            line.map_or("", |line| status_word(line.row.status)).to_owned()
        };
        std::iter::once(lines[0].case.clone())
            .chain(ways.iter().map(status))
            .collect()
    }));
    let mut text = format!("{} runs: {}\n\n{}\n", table.lines.len(), counts(table), aligned(&rows));
    for line in table.lines.iter().filter(|line| line.row.trouble().is_some()) {
        let boundary = match line.figures.boundary.as_str() {
            "" => String::new(),
            boundary => format!("; {boundary}"),
        };
        let added = significant(line.figures.energy_growth);
        let added = added.map_or_else(String::new, |growth| format!(" ({growth} W)"));
        let (case, way, reason) = (&line.case, line.way(), &line.row.reason);
        text.push_str(&wrapped(&format!("{case}, {way}: {reason}{added}{boundary}")));
    }
    text
}
