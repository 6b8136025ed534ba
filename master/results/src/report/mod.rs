//! Output for people: the page of a run, the table at its end, the progress bar.
//!
//! | file | subject |
//! | --- | --- |
//! | `html` | a self-contained page |
//! | `rows` | tables of a page |
//! | `label` | names of runs on one page |
//! | `line` | page, tables and picture of a line at rest |
//! | `verdict` | which limits fail, which hold, by how much |
//! | `sections` | text and tables of the page |
//! | `plots` | plots of the page |
//! | `animation` | the player |
//! | `table` | the table on the terminal |
//! | `progress` | the progress bar |

mod animation;
mod html;
mod label;
mod line;
pub mod plots;
mod progress;
mod rows;
mod sections;
mod table;
#[cfg(test)]
mod tests;
mod verdict;

pub use html::{Page, escape, head_cells, plot_html, remarks};
pub use label::labels;
pub use line::{
    LinePage, PageDropper, PageMass, PageRange, PageSpan, PageSupport, PageTension, PageWire, PageWireKind,
};
pub use progress::{Progress, Show};
pub use rows::{PageColumn, cell, cells, heads, lined, scrolled, spanning};
pub use table::{TextColumn, aligned, heading, number as decimals, table, text_cells, text_table};
pub use verdict::failed_limits;

use crate::RunBundle;

/// Renders the runs as one self-contained page; several runs are overlaid.
///
/// The page loads nothing: plotly.js, style and data are inside.
#[must_use]
pub fn render(runs: &[RunBundle]) -> String {
    let mut page = Page::new(&sections::title(runs));
    let runs = label::named(runs);
    page.lead(&sections::lead(&runs));
    page.section("Verdict", &verdict::section(&runs));
    page.section("Key figures", &sections::key_figures(&runs));
    page.section("Animation", &animation::section(&runs));
    for (heading, body) in plots::sections(&runs) {
        page.section(heading, &body);
    }
    page.section("Limits", &sections::limits(&runs));
    page.section("What was modelled", &sections::model(&runs));
    page.section("Cost", &sections::cost(&runs));
    page.section("Scene", &sections::scene(&runs));
    page.finish()
}
