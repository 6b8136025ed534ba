//! The table on the terminal.

use super::judge::{Line, StabilityTable};
use crate::engine::export::{status_word, wrapped};
use crate::engine::table::Status;
use crate::engine::table::significant;
use results::report::aligned;

/// The ways of running a case, in the order of the columns.
pub(super) fn ways(table: &StabilityTable) -> Vec<(String, String)> {
    let mut ways: Vec<(String, String)> = Vec::new();
    for line in &table.lines {
        let way = (line.row.mode.clone(), line.row.algorithm.clone());
        if !ways.contains(&way) {
            ways.push(way);
        }
    }
    ways
}

/// Lines of one case, which follow one another.
pub(super) fn by_case(table: &StabilityTable) -> Vec<&[Line]> {
    table.lines.chunk_by(|a, b| a.case == b.case).collect()
}

/// Name of a way in the head of a column.
pub(super) fn heading((mode, algorithm): &(String, String)) -> String {
    match (mode.as_str(), algorithm.as_str()) {
        ("monolithic", _) => "one system".to_owned(),
        ("cosimulation", algorithm) => format!("{algorithm}, FMUs"),
        (_, algorithm) => algorithm.to_owned(),
    }
}

/// The table of the hard cases.
#[must_use]
pub fn text(table: &StabilityTable) -> String {
    let counts: Vec<String> = Status::ALL
        .iter()
        .map(|status| format!("{} {}", table.count(*status), status.name()))
        .collect();
    let mut text = format!("{} runs: {}\n\n", table.lines.len(), counts.join(", "));
    let ways = ways(table);
    let mut rows = vec![
        std::iter::once(String::new())
            .chain(
                ways.iter()
                    .map(|way| heading(way).replace("interface_jacobian", "jacobian")),
            )
            .collect::<Vec<String>>(),
    ];
    for lines in by_case(table) {
        let mut cells = vec![lines[0].case.clone()];
        for way in &ways {
            let line = lines
                .iter()
                .find(|line| (&line.row.mode, &line.row.algorithm) == (&way.0, &way.1));
            cells.push(line.map_or_else(String::new, |line| status_word(line.row.status).to_owned()));
        }
        rows.push(cells);
    }
    text.push_str(&aligned(&rows));
    text.push('\n');
    for line in &table.lines {
        if matches!(
            line.row.status,
            Some(Status::Limit | Status::Diverged | Status::Refused)
        ) {
            let boundary = if line.figures.boundary.is_empty() {
                String::new()
            } else {
                format!("; {}", line.figures.boundary)
            };
            let added = line.figures.energy_growth.and_then(|growth| significant(Some(growth)));
            let added = added.map_or_else(String::new, |growth| format!(" ({growth} W)"));
            let way = heading(&(line.row.mode.clone(), line.row.algorithm.clone()));
            text.push_str(&wrapped(&format!(
                "{}, {way}: {}{added}{boundary}",
                line.case, line.row.reason
            )));
        }
    }
    text
}
