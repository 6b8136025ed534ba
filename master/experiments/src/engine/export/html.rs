//! Tables as pages, and pieces that several pages have.

use super::{Exporter, Table};
use crate::engine::table::{RunRow, STATUS_RULE, Status};
use results::ResultsError;
use results::report::format::milliseconds;
use results::report::{Page, PageColumn, cell, cells, escape, head_cells, lined};

/// One file that needs no network.
#[derive(Clone, Copy, Debug)]
pub struct Html;

impl Exporter for Html {
    fn string(&self, table: &impl Table) -> Result<String, ResultsError> {
        Ok(table.sections().finish())
    }
}

/// Lines of runs, what is to be said of each under the pointer.
pub(crate) fn run_lines<'a, T: 'a>(
    columns: &[PageColumn<T>],
    entries: impl IntoIterator<Item = &'a T>,
    row: fn(&T) -> &RunRow,
) -> String {
    let line = |entry: &T| {
        let cells = cells(columns, entry);
        format!("<tr title=\"{}\">{cells}</tr>\n", escape(&row(entry).reason))
    };
    entries.into_iter().map(line).collect()
}

/// Reasons of runs, behind a heading that opens them: of each the runs in words, in cells of a class, and the reason;
/// nothing where there is none.
pub(crate) fn reasons(heading: &str, class: &str, said: Vec<(String, &str)>) -> String {
    if said.is_empty() {
        return String::new();
    }
    let line = |(runs, reason): (String, &str)| cell(class, &escape(&runs)) + &cell("remark", &escape(reason));
    let head = head_cells([("runs", "", class == "n"), ("reason", "", false)]);
    let table = lined(&head, said.into_iter().map(line));
    format!("<details><summary>{heading}</summary>{table}</details>\n")
}

/// A table with a column for each macro step (s); a line is the cell of its name, and the HTML of the others.
pub(crate) fn over_steps(
    heading: &str,
    steps: &[f64],
    lines: impl IntoIterator<Item = (String, Vec<String>)>,
) -> String {
    let step = |step: &f64| format!("<th class=\"n\">{} ms</th>", milliseconds(Some(*step)));
    let steps: String = steps.iter().map(step).collect();
    let line = |(name, html): (String, Vec<String>)| {
        let cells: String = html.iter().map(|html| cell("n", html)).collect();
        name + &cells
    };
    lined(&format!("<th>{heading}</th>{steps}"), lines.into_iter().map(line))
}

/// An empty page on one scene, which has a title or else its name.
pub(crate) fn scene_page(subject: &str, scene: &str, title: &str) -> Page {
    let title = if title.is_empty() { scene } else { title };
    Page::new(&format!("{subject}: {title}"))
}

/// First lines of a page on one scene: its name, the number of runs by status, `more`, its source, a warning where runs
/// are missing with `remedy` behind it.
pub(crate) fn scene_lead(scene: &str, source: &str, table: &impl Table, more: &str, remedy: &str) -> String {
    let rows = table.sheet().rows;
    let (name, counts) = (escape(scene), status_counts(rows.iter(), 1));
    let mut html = format!("<p><b>{name}</b> · {} runs: {counts}</p>\n{more}", rows.len());
    if !source.is_empty() {
        html.push_str(&format!("<p class=\"soft\">{}</p>\n", escape(source)));
    }
    html + &incomplete(table, remedy)
}

/// The rule of the status with its words in bold.
pub(crate) fn status_rule() -> String {
    let bold = |text: String, word: &str| text.replace(&format!("{word}:"), &format!("<b>{word}</b>:"));
    ["limit", "diverged", "refused", "stable"]
        .into_iter()
        .fold(escape(STATUS_RULE), bold)
}

/// The word of a status, `not run` where there is none.
pub(crate) fn status_word(status: Option<Status>) -> &'static str {
    status.map_or("not run", Status::name)
}

/// Word of a status in its colour.
pub(crate) fn status_span(status: Option<Status>) -> String {
    let class = match status {
        Some(Status::Stable) => "good",
        Some(_) => "bad",
        None => return status_word(status).to_owned(),
    };
    format!("<span class=\"{class}\">{}</span>", status_word(status))
}

/// Number of rows with each status that `least` rows have, in words.
pub(crate) fn status_counts<'a>(rows: impl Iterator<Item = &'a RunRow> + Clone, least: usize) -> String {
    let count = |status: &Status| {
        let count = rows.clone().filter(|row| row.status == Some(*status)).count();
        (count >= least).then(|| format!("{count} {}", status.name()))
    };
    let counts: Vec<String> = Status::ALL.iter().filter_map(count).collect();
    counts.join(", ")
}

/// A warning where runs are missing; `more` follows it.
pub(crate) fn incomplete(table: &impl Table, more: &str) -> String {
    if table.is_complete() {
        return String::new();
    }
    let (made, all) = table.made();
    format!("<p class=\"warning\">Incomplete: {made} of {all} runs were made.{more}</p>\n")
}
