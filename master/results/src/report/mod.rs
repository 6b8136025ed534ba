//! Output for people: the page of a run, the table at its end, the progress bar.
//!
//! | file | subject |
//! | --- | --- |
//! | `html` | a self-contained page |
//! | `rows` | tables of a page |
//! | `format` | numbers and remarks in tables |
//! | `pack` | data in the page |
//! | `label` | names of runs on one page |
//! | `line` | page, tables and picture of a line at rest |
//! | `verdict` | which limits fail, which hold, by how much |
//! | `sections` | text and tables of the page |
//! | `details` | tables by band, span and loss, of heights and uplift |
//! | `wear` | tables of current, arcs and wear |
//! | `plots` | plots of the page |
//! | `animation` | the player |
//! | `table` | the table on the terminal |
//! | `progress` | the progress bar |

mod animation;
mod details;
pub mod format;
mod html;
mod label;
mod line;
mod pack;
pub mod plots;
mod progress;
mod rows;
mod sections;
mod table;
#[cfg(test)]
mod tests;
mod verdict;
mod wear;

pub use html::{Library, Page, escape, figure_html, head_cells, remarks, remarks_of};
pub use label::labels;
pub use line::{
    LinePage, PageDropper, PageMass, PageRange, PageSpan, PageSupport, PageTension, PageWire, PageWireKind,
};
pub use progress::{Progress, Show};
pub use rows::{PageColumn, cell, cells, heads, lined, saved, scrolled, spanning};
pub use table::{
    TextColumn, aligned, grouped_table, heading, table, text_cells, text_table, verdict_class, verdict_word,
};
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
    let figures = plots::Figures::of(&runs);
    page.section("Contact force", &figures.force);
    page.section("By span", &details::stretches(&runs));
    page.section("As measured", &(details::measured(&runs) + &figures.measured));
    page.section("Losses of contact", &details::losses(&runs));
    page.section("Current and wear", &wear::section(&runs));
    page.section("Animation", &animation::section(&runs));
    page.section("Heights and uplift", &(figures.heights + &details::heights(&runs)));
    page.section("Wind on the collector head", &figures.wind);
    page.section("Drive of the pantograph", &figures.control);
    page.section("Frequencies", &(figures.distribution + &details::bands(&runs)));
    page.section("Droppers", &details::droppers(&runs));
    page.section("Limits", &sections::limits(&runs));
    page.section("What was modelled", &sections::model(&runs));
    page.section("Cost", &sections::cost(&runs));
    page.section("Scene", &sections::scene(&runs));
    page.finish()
}
