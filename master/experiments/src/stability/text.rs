//! The table on the terminal.

use super::judge::{Line, StabilityTable};
use crate::engine::export::{grouped, status_counts, status_word};
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
    let ways = grouped(table.lines.iter().map(|line| (line.way(), ())));
    ways.into_iter().map(|(way, _)| way).collect()
}

/// Lines of one case, which follow one another.
pub(super) fn by_case(table: &StabilityTable) -> impl Iterator<Item = &[Line]> {
    table.lines.chunk_by(|a, b| a.case == b.case)
}

/// Number of runs, and of those with each status, in words.
pub(super) fn counts(table: &StabilityTable) -> String {
    let rows = table.lines.iter().map(|line| &line.row);
    format!("{} runs: {}", table.lines.len(), status_counts(rows, 0))
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
    let mut text = format!("{}\n\n{}\n", counts(table), aligned(&rows));
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
