//! The verdict that opens page and table: which limits fail, which hold, and by how much.

use super::format::{counted, decimals, in_unit};
use super::label::NamedRun;
use super::table::{quantity_name, readable};
use super::{cell, escape, head_cells, lined, table};
use crate::Summary;
use crate::standards::{Certainty, Limit};

/// Limits in the order in which they are read: failed, held with the least room first, not decided, not
/// applicable.
pub(super) fn by_urgency(limits: &[Limit]) -> Vec<Limit> {
    let mut limits = limits.to_vec();
    let rank = |limit: &Limit| match (limit.pass, limit.applicable) {
        (Some(false), _) => 0,
        (Some(true), _) => 1,
        (None, true) => 2,
        (None, false) => 3,
    };
    let room = |limit: &Limit| share(limit).unwrap_or(f64::INFINITY);
    limits.sort_by(|a, b| rank(a).cmp(&rank(b)).then(room(a).total_cmp(&room(b))));
    limits
}

/// Room of the value by the limit, –; nothing for a limit of zero.
fn share(limit: &Limit) -> Option<f64> {
    let bound = limit.limit.filter(|bound| *bound != 0.0)?;
    Some(limit.room()? / bound.abs())
}

/// Margin of a decided `limit` for reading: in percent of the limit, or in its unit where the limit is zero.
pub(super) fn margin(limit: &Limit) -> String {
    if limit.pass.is_none() {
        return String::new();
    }
    let (scale, unit) = limit.scale();
    match (share(limit), limit.room()) {
        (Some(share), _) => format!("{:+.1} %", 100.0 * share),
        (None, Some(room)) => in_unit(&format!("{:+.2}", scale * room), unit),
        (None, None) => "–".to_owned(),
    }
    .replace('-', "−")
}

/// The verdict in one sentence.
pub(super) fn sentence(limits: &[Limit]) -> String {
    let count = |wanted: &dyn Fn(&Limit) -> bool| limits.iter().filter(|limit| wanted(limit)).count();
    let failed = count(&|limit| limit.pass == Some(false));
    let held = count(&|limit| limit.pass == Some(true));
    let open = count(&|limit| limit.pass.is_none() && limit.applicable);
    let other = count(&|limit| limit.pass.is_none() && !limit.applicable);
    let mut parts = match (failed, held) {
        (0, 0) => vec!["no limit is decided".to_owned()],
        (0, held) => vec![format!("no limit fails, {}", counted(held, "holds", "hold"))],
        (failed, held) => vec![
            counted(failed, "limit fails", "limits fail"),
            counted(held, "holds", "hold"),
        ],
    };
    if open > 0 {
        parts.push(counted(open, "is not decided", "are not decided"));
    }
    if other > 0 {
        parts.push(counted(other, "does not apply", "do not apply"));
    }
    format!("Verdict: {}", parts.join(", "))
}

/// Reservations about the verdict, a sentence each: limits that are closer than the computation is certain, and
/// figures that could not be verified.
pub(super) fn reservations(limits: &[Limit]) -> Vec<String> {
    let named = |limits: Vec<&Limit>| {
        let mut names: Vec<String> = Vec::new();
        for limit in limits {
            let mut of_all = limit.clone();
            of_all.pantograph = None;
            let name = format!("{} {}", limit.standard, quantity_name(&of_all));
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.join(", ")
    };
    let decided = || limits.iter().filter(|limit| limit.pass.is_some());
    let close: Vec<&Limit> = decided().filter(|limit| limit.is_close()).collect();
    // Rows of the user's own are for the user to answer for.
    let known = |certainty| -> Vec<&Limit> {
        let own = |limit: &&Limit| limit.certainty == certainty && limit.source.is_none();
        decided().filter(own).collect()
    };
    let (remembered, chosen) = (known(Certainty::Remembered), known(Certainty::Chosen));
    let mut said = Vec::new();
    if !close.is_empty() {
        said.push(format!(
            "Within the numerical uncertainty of the run, so that a finer one may turn the verdict: {}",
            named(close)
        ));
    }
    if !remembered.is_empty() {
        said.push(format!(
            "Figures of these limits are remembered, not verified against the standard: {}. Enter those of your copy \
             under [assessment]",
            named(remembered)
        ));
    }
    if !chosen.is_empty() {
        said.push(format!(
            "Chosen by this program, as no figure of the standard is known: {}",
            named(chosen)
        ));
    }
    said
}

/// The failed limits in words, for messages: `EN 50367 standard deviation 37.30 N (< 31.89)`.
#[must_use]
pub fn failed_limits(summary: &Summary) -> Vec<String> {
    let failed = by_urgency(&summary.limits)
        .into_iter()
        .filter(|limit| limit.pass == Some(false));
    let said = failed.map(|limit| {
        let (value, _, unit) = readable(&limit);
        format!(
            "{} {} {} ({})",
            limit.standard,
            quantity_name(&limit),
            in_unit(&decimals(value, 2), unit),
            table::bounded(&limit)
        )
    });
    said.collect()
}

/// Clause, reason and remedy of a limit that fails, below its name.
fn why(limit: &Limit) -> String {
    let said = [&limit.clause, &limit.reason, &limit.remark].into_iter();
    let mut parts: Vec<String> = said.filter(|text| !text.is_empty()).map(|text| escape(text)).collect();
    if let Some(remedy) = limit.remedy() {
        parts.push(format!("remedy: {remedy}"));
    }
    format!("<br><span class=\"soft\">{}</span>", parts.join("; "))
}

/// Lines of the verdict: those that fail, or those that hold.
fn lines(limits: &[Limit], pass: bool) -> impl Iterator<Item = String> {
    let (class, word) = if pass { ("good", "holds") } else { ("bad", "FAILS") };
    let limits = limits.iter().filter(move |limit| limit.pass == Some(pass));
    limits.map(move |limit| {
        let (value, _, unit) = readable(limit);
        let (name, mark) = (escape(&quantity_name(limit)), limit.certainty.mark());
        let standard = escape(&limit.standard);
        let mut why = if pass { String::new() } else { why(limit) };
        if let (true, Some(tolerance)) = (limit.is_close(), limit.tolerance) {
            let (scale, unit) = limit.scale();
            why.push_str(&format!(
                "<br><span class=\"soft\">numerical uncertainty ± {}</span>",
                escape(&in_unit(&decimals(Some(scale * tolerance), 2), unit))
            ));
        }
        if let (true, Some(source)) = (pass, &limit.source) {
            why.push_str(&format!(
                "<br><span class=\"soft\">limit from {}</span>",
                escape(source)
            ));
        }
        cell("s", &format!("<b class=\"{class}\">{word}</b>"))
            + &cell(
                "",
                &format!("{name} <span class=\"soft\">{standard} {mark}</span>{why}"),
            )
            + &cell("n", &escape(&in_unit(&decimals(value, 2), unit)))
            + &cell("n", &escape(&table::bounded(limit)))
            + &cell(&format!("n {class}"), &margin(limit))
    })
}

/// Limits with the least room that are shown where none fails.
const NEAREST: usize = 3;

/// Verdict on `limits` in one sentence, and a table of those that are decided.
pub(super) fn of_limits(limits: &[Limit]) -> String {
    let any = |pass: bool| limits.iter().any(|limit| limit.pass == Some(pass));
    let class = match (any(false), any(true)) {
        (true, _) => "bad",
        (false, true) => "good",
        (false, false) => "soft",
    };
    let sentence = sentence(limits);
    let mut html = format!("<p class=\"verdict {class}\">{}</p>\n", escape(&sentence));
    for reservation in reservations(limits) {
        html.push_str(&format!("<p class=\"reservation\">{}.</p>\n", escape(&reservation)));
    }
    if any(true) || any(false) {
        let columns = [("limit", false), ("value", true), ("limit", true), ("margin", true)];
        let head = head_cells(columns.map(|(name, is_number)| (name, "", is_number)));
        let head = format!("<th></th>{head}");
        // What fails stands first and alone; where nothing does, those with the least room.
        let (failing, holding): (Vec<String>, Vec<String>) =
            (lines(limits, false).collect(), lines(limits, true).collect());
        let shown = if failing.is_empty() {
            holding.len().min(NEAREST)
        } else {
            0
        };
        html.push_str(&lined(
            &head,
            failing.into_iter().chain(holding[..shown].iter().cloned()),
        ));
        let folded = holding.len() - shown;
        if folded > 0 {
            let more = if shown > 0 { "more " } else { "" };
            html.push_str(&format!(
                "<details><summary>{}</summary>{}</details>\n",
                counted(folded, &format!("{more}limit holds"), &format!("{more}limits hold")),
                lined(&head, holding[shown..].iter().cloned())
            ));
        }
    }
    html
}

/// The section that opens the page.
pub(super) fn section(runs: &[NamedRun<'_>]) -> String {
    let mut html = String::new();
    for run in runs {
        if runs.len() > 1 {
            html.push_str(&format!("<h3>{}</h3>\n", escape(&run.label)));
        }
        let mut limits = by_urgency(&run.summary.limits);
        if run.summary.pantographs.len() == 1 {
            limits.iter_mut().for_each(|limit| limit.pantograph = None);
        }
        html.push_str(&of_limits(&limits));
    }
    if !html.is_empty() {
        html.push_str(
            "<p class=\"caption\">Margin: room left, in percent of the limit, negative where the limit fails. \
             Clauses, reasons \
             and limits without a verdict: section Limits.</p>\n",
        );
    }
    html
}
