//! The table at the end of a run.

use super::format::{decimals, or_dash};
use super::verdict::{by_urgency, margin, reservations, sentence};
use crate::standards::{Certainty, Limit};
use crate::statistics::ForceStatistics;
use crate::{Accuracy, Cost, ErrorShare, Part, Summary};
use component::Share;

/// Shares of the time loop, the largest first.
pub(super) fn shares(cost: &Cost) -> String {
    let mut shares: Vec<&Share> = cost.shares.iter().collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    let shares = shares
        .iter()
        .map(|share| format!("{} {:.1} %", share.part, 100.0 * share.share));
    shares.collect::<Vec<_>>().join(", ")
}

/// Number of the `limit` in a unit that is easy to read: heights in mm.
pub(super) fn readable(limit: &Limit) -> (Option<f64>, Option<f64>, &str) {
    let (scale, unit) = limit.scale();
    (
        limit.value.map(|value| scale * value),
        limit.limit.map(|value| scale * value),
        unit,
    )
}

/// Name of a limited quantity, for reading.
pub(super) fn quantity_name(limit: &Limit) -> String {
    let name = match limit.quantity.as_str() {
        "mean" => "mean contact force",
        "mean_lower" => "mean contact force, lower",
        "min" => "minimum contact force",
        "free_uplift" => "space for the uplift",
        "speed_ratio" => "speed / wave speed",
        "band" => "band of the force",
        "sampling_rate" => "samples per second",
        "control_section" => "evaluated section",
        "std" => "standard deviation",
        "max" => "maximum contact force",
        "uplift" => "uplift at support",
        "vertical_amplitude" => "vertical amplitude of the strip",
        "arcing" => "arcing NQ",
        "gradient" => "gradient of the contact wire",
        "gradient_change" => "change of gradient",
        "lateral_deviation" => "contact wire in the wind",
        other => other,
    };
    limit
        .pantograph
        .map_or_else(|| name.to_owned(), |i| format!("{name}, pantograph {i}"))
}

/// Verdict of a `limit`, for reading.
pub(super) fn verdict(limit: &Limit) -> &'static str {
    match limit.pass {
        None if !limit.applicable => "not applicable",
        pass => verdict_word(pass),
    }
}

/// A verdict in a word.
#[must_use]
pub const fn verdict_word(pass: Option<bool>) -> &'static str {
    match pass {
        Some(true) => "pass",
        Some(false) => "FAIL",
        None => "not decided",
    }
}

/// Class of a verdict on a page.
#[must_use]
pub const fn verdict_class(pass: Option<bool>) -> &'static str {
    match pass {
        Some(true) => "good",
        Some(false) => "bad",
        None => "soft",
    }
}

/// Number that a `limit` sets, with the sign of the comparison.
pub(super) fn bounded(limit: &Limit) -> String {
    let (_, bound, _) = readable(limit);
    or_dash(bound.map(|bound| format!("{} {bound:.2}", limit.bound.sign())))
}

/// Meaning of the marks that `limits` have.
pub(super) fn marks(limits: &[Limit]) -> String {
    let all = [
        Certainty::Cited,
        Certainty::Remembered,
        Certainty::Standard,
        Certainty::Chosen,
    ];
    let used = all
        .into_iter()
        .filter(|mark| limits.iter().any(|limit| limit.certainty == *mark));
    let said = used.map(|mark| format!("{} {}", mark.mark(), mark.meaning()));
    said.collect::<Vec<_>>().join(", ")
}

/// Widest column of a table of text; a longer cell stands out of its column.
const WIDEST: usize = 200;

/// Lays out `rows` in columns: the first one flush left, all others flush right.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |j: usize| {
        rows.iter()
            .filter_map(|r| r.get(j))
            .map(|c| c.chars().count())
            .max()
            .map_or(0, |width| width.min(WIDEST))
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (j, cell) in row.iter().enumerate() {
            let w = widths[j];
            if j == 0 {
                line.push_str(&format!("  {cell:<w$}"));
            } else {
                line.push_str(&format!("  {cell:>w$}"));
            }
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// Column of a table of text: lines of its heading, cell of an entry.
pub type TextColumn<T, const N: usize> = ([&'static str; N], fn(&T) -> String);

/// Lines of the headings of columns.
pub fn heading<T, const N: usize>(columns: &[TextColumn<T, N>]) -> Vec<Vec<String>> {
    let line = |n: usize| columns.iter().map(|(lines, _)| lines[n].to_owned()).collect();
    (0..N).map(line).collect()
}

/// Cells of an entry.
pub fn text_cells<T, const N: usize>(columns: &[TextColumn<T, N>], entry: &T) -> Vec<String> {
    columns.iter().map(|(_, cell)| cell(entry)).collect()
}

/// A table of text, head and rows.
pub fn text_table<'a, T: 'a, const N: usize>(
    columns: &[TextColumn<T, N>],
    entries: impl IntoIterator<Item = &'a T>,
) -> Vec<Vec<String>> {
    let rows = entries.into_iter().map(|entry| text_cells(columns, entry));
    heading(columns).into_iter().chain(rows).collect()
}

/// A table of text whose rows stand in groups, each below its name.
pub fn grouped_table<'a, T: 'a, const N: usize>(
    columns: &[TextColumn<T, N>],
    groups: impl IntoIterator<Item = (String, Vec<&'a T>)>,
) -> Vec<Vec<String>> {
    let of_group = |(name, entries): (String, Vec<&'a T>)| {
        let rows = entries.into_iter().map(|entry| text_cells(columns, entry));
        std::iter::once(vec![format!("{name}:")])
            .chain(rows)
            .collect::<Vec<_>>()
    };
    let rows = groups.into_iter().flat_map(of_group);
    heading(columns).into_iter().chain(rows).collect()
}

fn row(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|c| (*c).to_owned()).collect()
}

/// Columns of the limits.
const LIMITS: &[TextColumn<Limit, 1>] = &[
    (["limit"], |limit| {
        format!("{}, {}", limit.standard, quantity_name(limit))
    }),
    (["value"], |limit| decimals(readable(limit).0, 2)),
    (["limit"], bounded),
    (["unit"], |limit| readable(limit).2.to_owned()),
    (["margin"], margin),
    ([""], |limit| verdict(limit).to_owned()),
    ([""], |limit| limit.certainty.mark().to_owned()),
];

/// The limits, failed ones first, then those with the least room; below the table each reason why one does not apply,
/// once.
fn limits(summary: &Summary) -> String {
    let limits = by_urgency(&summary.limits);
    let mut text = aligned(&text_table(LIMITS, &limits));
    text.push_str(&format!("  {}\n", marks(&limits)));
    let mut reasons: Vec<&str> = Vec::new();
    for limit in limits.iter().filter(|limit| !limit.applicable) {
        if !reasons.contains(&&*limit.reason) {
            reasons.push(&limit.reason);
            text.push_str(&format!("  not applicable: {}\n", limit.reason));
        }
    }
    text
}

/// Figures of the contact force.
fn figures(summary: &Summary) -> String {
    let mut rows = vec![row(&["contact force [N]", "mean", "std", "max", "min", "loss %"])];
    for (i, pantograph) in summary.pantographs.iter().enumerate() {
        let force = &pantograph.contact_force;
        let mut line = |name: &str, s: Option<ForceStatistics>, loss: Option<f64>| {
            let mut cells = vec![format!("pantograph {}, {name}", i + 1)];
            for figure in [s.map(|s| s.mean), s.map(|s| s.std), s.map(|s| s.max), s.map(|s| s.min)] {
                cells.push(decimals(figure, 2));
            }
            cells.push(loss.map_or_else(String::new, |l| format!("{l:.3}")));
            rows.push(cells);
        };
        let filtered = format!("{} Hz", summary.evaluation.low_pass_hz);
        line(&filtered, force.filtered, None);
        line("raw", force.raw, force.loss_of_contact_percent);
        if let Some(measured) = &pantograph.measured {
            line("as measured", Some(measured.filtered), None);
        }
        // Numbers of the strips are those of their head.
        for (number, strip) in (1..).zip(&pantograph.strips) {
            let filtered = format!("strip {number}, {filtered}");
            line(&filtered, strip.filtered, strip.loss_of_contact_percent);
        }
    }
    let mut text = aligned(&rows);
    for known in summary.uncertainty.iter().filter(|known| known.figure == "std") {
        text.push_str(&format!(
            "  pantograph {}: std −{:.2}/+{:.2} N by numbers that are not known for certain, most by {}\n",
            known.pantograph,
            known.below,
            known.above,
            known.largest.join(", ")
        ));
    }
    text
}

/// Parts modelled, each on a line, and those left out in one.
fn modelled(summary: &Summary) -> String {
    let model = &summary.model;
    let reductions = if model.reductions.is_empty() {
        "none".to_owned()
    } else {
        model.reductions.join(", ")
    };
    let mut text = format!(
        "  modelled: {} coordinates, {} constraints, {} elements; reductions: {reductions}\n",
        model.coordinates, model.constraints, model.elements
    );
    let name = |part: &Part| part.part.replace('_', " ");
    for part in model.parts.iter().filter(|part| part.modelled) {
        text.push_str(&format!("  {}: {}\n", name(part), part.reason));
    }
    let left_out: Vec<String> = model.parts.iter().filter(|part| !part.modelled).map(name).collect();
    if !left_out.is_empty() {
        text.push_str(&format!("  not modelled: {}\n", left_out.join(", ")));
    }
    let coupling = &summary.coupling;
    text.push_str(&format!(
        "  coupling {}, energy residual {} J\n",
        coupling.algorithm,
        or_dash(coupling.energy_residual.map(|residual| format!("{residual:.2e}"))),
    ));
    text.push_str(&expected_error(&summary.accuracy));
    text
}

/// Cause of an error in words, and its percent.
pub(super) fn cause(share: &ErrorShare) -> String {
    format!("{} {:.2}", share.cause.replace('_', " "), share.percent)
}

/// Expected error with its causes, where a rule is known.
fn expected_error(accuracy: &Accuracy) -> String {
    let causes: Vec<String> = (accuracy.shares.iter())
        .filter(|share| share.percent > 0.0)
        .map(cause)
        .collect();
    accuracy.expected_percent.map_or_else(String::new, |sum| {
        format!(
            "  expected error of the filtered force: {sum:.2} % of its standard deviation ({})\n",
            causes.join(", ")
        )
    })
}

/// Time, steps and iterations of the run.
fn cost(cost: &Cost) -> String {
    let mut text = format!(
        "  {:.2} s simulated in {:.2} s (real-time factor {}), {:.2} s for statics and loading\n",
        cost.simulated_s,
        cost.wall_s,
        decimals(cost.real_time_factor, 3),
        cost.setup_s,
    );
    text.push_str(&format!(
        "  {} macro steps, {} micro steps, {} Newton iterations, {} factorizations, {} rollbacks\n",
        cost.macro_steps, cost.micro_steps, cost.newton_iterations, cost.factorizations, cost.rollbacks,
    ));
    if !cost.shares.is_empty() {
        text.push_str(&format!("  time loop: {}\n", shares(cost)));
    }
    if let (Some(smallest), Some(largest), Some(mean)) = (
        cost.smallest_macro_step_s,
        cost.largest_macro_step_s,
        cost.mean_macro_step_s,
    ) && smallest < largest
    {
        text.push_str(&format!(
            "  macro steps from {:.3} to {:.3} ms, {:.3} ms in the mean, {} refused\n",
            1e3 * smallest,
            1e3 * largest,
            1e3 * mean,
            cost.refused_steps,
        ));
    }
    text
}

/// The table at the end of a run: verdict, figures, model, cost. Plain text, aligned, no colours.
#[must_use]
pub fn table(summary: &Summary) -> String {
    let mut text = format!("{}, {}", summary.scene, summary.mode);
    if !summary.title.is_empty() {
        text.push_str(&format!(": {}", summary.title));
    }
    text.push('\n');
    if !summary.complete {
        text.push_str(&format!("INCOMPLETE: {}\n", summary.incomplete_reason));
    }
    text.push_str(&format!("{}\n", sentence(&summary.limits)));
    for reservation in reservations(&summary.limits) {
        text.push_str(&format!("  {reservation}\n"));
    }
    text.push('\n');
    text.push_str(&limits(summary));
    let figures = figures(summary) + &super::wear::lines(summary);
    for part in [figures, modelled(summary), cost(&summary.cost)] {
        text.push('\n');
        text.push_str(&part);
    }
    for note in &summary.notes {
        text.push_str(&format!("  note: {note}\n"));
    }
    text
}
