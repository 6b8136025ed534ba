//! Tables as pages, and pieces that several pages have.

use std::io::Write;
use std::path::Path;

use super::{Exporter, Table};
use crate::engine::table::{RunRow, STATUS_RULE, Status, milliseconds, significant};
use results::ResultsError;
use results::report::{escape, head_cells};

/// One file that needs no network.
#[derive(Clone, Copy, Debug)]
pub struct Html;

impl Exporter for Html {
    fn export(&self, table: &impl Table, out: &mut dyn Write, path: &Path) -> Result<(), ResultsError> {
        let page = table.sections().finish();
        out.write_all(page.as_bytes()).map_err(results::io(path, "write"))
    }
}

/// A table that scrolls sideways on narrow screens; `head` and `body` are HTML.
pub(crate) fn scrolled(head: &str, body: &str) -> String {
    format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>\n")
}

/// Column of a table on a page: heading, unit, class of its cells (`n` for numbers), and the cell of an entry as HTML.
pub(crate) type PageColumn<T> = (&'static str, &'static str, &'static str, fn(&T) -> String);

/// Headings of columns.
pub(crate) fn heads<T>(columns: &[PageColumn<T>]) -> String {
    head_cells(columns.iter().map(|&(name, unit, class, _)| (name, unit, class == "n")))
}

/// Cells of an entry.
pub(crate) fn cells<T>(columns: &[PageColumn<T>], entry: &T) -> String {
    let cell = |(_, _, class, cell): &PageColumn<T>| match *class {
        "" => format!("<td>{}</td>", cell(entry)),
        class => format!("<td class=\"{class}\">{}</td>", cell(entry)),
    };
    columns.iter().map(cell).collect()
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

/// Number of rows with each status, in words.
pub(crate) fn status_counts(rows: &[RunRow]) -> String {
    let count = |status: Status| {
        let count = rows.iter().filter(|row| row.status == Some(status)).count();
        (count > 0).then(|| format!("{count} {}", status.name()))
    };
    let counts: Vec<String> = Status::ALL.into_iter().filter_map(count).collect();
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

/// Three significant digits, or nothing.
pub(crate) fn number(value: Option<f64>) -> String {
    significant(value).unwrap_or_default()
}

/// So many decimals, or nothing.
pub(crate) fn fixed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:.digits$}"))
}

/// A count, or nothing.
pub(crate) fn count(value: Option<u64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// A step in ms, or nothing.
pub(crate) fn step(value: Option<f64>) -> String {
    value.map_or_else(String::new, |step| milliseconds(Some(step)))
}
