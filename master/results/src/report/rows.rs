//! Tables of a page, from their columns.

use super::head_cells;

/// A table that scrolls sideways on narrow screens; `head` and `body` are HTML.
pub fn scrolled(head: &str, body: &str) -> String {
    format!("<div class=\"scroll\"><table><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>\n")
}

/// [`scrolled`], with lines that are the cells of a row each.
pub fn lined(head: &str, lines: impl IntoIterator<Item = String>) -> String {
    let row = |cells: String| format!("<tr>{cells}</tr>\n");
    scrolled(head, &lines.into_iter().map(row).collect::<String>())
}

/// [`lined`], with a button that saves the table as `name`.csv.
pub fn saved(name: &str, head: &str, lines: impl IntoIterator<Item = String>) -> String {
    lined(head, lines).replacen("<table>", &format!("<table data-csv=\"{name}\">"), 1)
}

/// A cell of HTML with its class, which may be empty; `c` is coloured by the word in it.
pub fn cell(class: &str, html: &str) -> String {
    match class {
        "" => format!("<td>{html}</td>"),
        "c" => format!("<td class=\"c {html}\">{html}</td>"),
        class => format!("<td class=\"{class}\">{html}</td>"),
    }
}

/// Column of a table on a page: heading, unit, class of its cells (`n` for numbers), and the cell of an entry as HTML.
pub type PageColumn<T> = (&'static str, &'static str, &'static str, fn(&T) -> String);

/// Headings of columns.
pub fn heads<T>(columns: &[PageColumn<T>]) -> String {
    head_cells(columns.iter().map(|&(name, unit, class, _)| (name, unit, class == "n")))
}

/// Cells of an entry.
pub fn cells<T>(columns: &[PageColumn<T>], entry: &T) -> String {
    columns
        .iter()
        .map(|(_, _, class, of)| cell(class, &of(entry)))
        .collect()
}

/// A heading over all columns.
pub fn spanning<T>(columns: &[PageColumn<T>], html: &str) -> String {
    format!("<tr><th colspan=\"{}\">{html}</th></tr>\n", columns.len())
}
