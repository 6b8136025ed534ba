//! Tables of the page.

use super::LinePage;
use super::panel::said;
use crate::report::format::or_dash;
use crate::report::{escape, head_cells, verdict};
use crate::standards::gradient_limit;

/// Most rows of the table of droppers; more of them would make the page slow to open.
const MOST_DROPPERS: usize = 200;

/// Table with these columns: name, unit, true for numbers.
fn table(columns: &[(&str, &str, bool)], rows: &str) -> String {
    format!(
        "<div class=\"scroll\"><table class=\"figures\"><thead><tr>{}</tr></thead>\
         <tbody>\n{rows}</tbody></table></div>\n",
        head_cells(columns.iter().copied())
    )
}

/// Row of cells, aligned as the columns.
fn row(columns: &[(&str, &str, bool)], cells: impl IntoIterator<Item = String>) -> String {
    let cell = |((_, _, number), cell): (&(&str, &str, bool), String)| match number {
        true => format!("<td>{cell}</td>"),
        false => format!("<td class=\"w\">{cell}</td>"),
    };
    let cells: String = columns.iter().zip(cells).map(cell).collect();
    format!("<tr>{cells}</tr>\n")
}

/// Number with so many digits, or a dash.
fn optional(value: Option<f64>, digits: usize) -> String {
    or_dash(value.map(|value| said(value, digits)))
}

/// Limits, the verdict first.
pub(super) fn limits(page: &LinePage) -> String {
    if page.limits.is_empty() {
        return String::new();
    }
    let limits = verdict::by_urgency(&page.limits);
    let open: String = limits
        .iter()
        .filter(|limit| limit.pass.is_none())
        .map(|limit| {
            format!(
                "<li>{}: {}</li>",
                limit.quantity.replace('_', " "),
                escape(&limit.reason)
            )
        })
        .collect();
    let open = match open.is_empty() {
        true => String::new(),
        false => format!("<ul class=\"caption\">{open}</ul>\n"),
    };
    format!(
        "{}{open}<p class=\"caption\">Gradients are those of the chords between supports on which strips run. [R]: \
         remembered and not verified. The forces of a run have limits of their own.</p>\n",
        verdict::of_limits(&limits)
    )
}

/// Supports.
pub(super) fn supports(page: &LinePage) -> String {
    let (most, most_change) = gradient_limit(page.speed_kmh);
    let curved = page.supports.iter().any(|support| support.radius.is_some());
    let columns = [
        ("tension length", "", true),
        ("support", "", true),
        ("x", "m", true),
        ("height", "m", true),
        ("encumbrance", "m", true),
        ("stagger", "m", true),
        ("radius", "m", true),
        ("messenger force", "N", true),
        ("arm force", "N", true),
        ("lateral arm force", "N", true),
        ("gradient", "‰", true),
        ("change", "‰", true),
    ];
    let several = page.supports.iter().any(|support| support.tension_length > 1);
    let wanted = |number: usize| match number {
        0 => several,
        6 => curved,
        _ => true,
    };
    let kept = |cells: Vec<String>| {
        let cells = cells.into_iter().enumerate().filter(|(number, _)| wanted(*number));
        cells.map(|(_, cell)| cell).collect::<Vec<_>>()
    };
    let columns: Vec<_> = columns
        .into_iter()
        .enumerate()
        .filter(|(number, _)| wanted(*number))
        .map(|(_, c)| c)
        .collect();
    let graded = |value: Option<f64>, limit: f64| match value {
        Some(value) if value.abs() > limit + 1e-6 => {
            format!("<span class=\"badge bad\">{}</span>", said(1e3 * value, 2))
        }
        value => optional(value.map(|value| 1e3 * value), 2),
    };
    let shown = page.supports.iter().filter(|support| page.shown.contains(support.x));
    let rows: String = shown
        .map(|support| {
            let cells = vec![
                support.tension_length.to_string(),
                support.number.to_string(),
                said(support.x, 2),
                said(support.height, 3),
                optional(support.encumbrance, 3),
                said(support.stagger, 3),
                optional(support.radius, 0),
                said(support.messenger_reaction, 0),
                said(support.arm_force, 0),
                optional(support.arm_lateral, 0),
                graded(support.gradient, most),
                graded(support.change, most_change),
            ];
            row(&columns, kept(cells))
        })
        .collect();
    format!(
        "{}<p class=\"caption\">Forces act on the wires, upwards and to the left. Also in supports.csv.</p>\n",
        table(&columns, &rows)
    )
}

/// Droppers, those nearest to the middle of the evaluated spans where there are too many.
pub(super) fn droppers(page: &LinePage) -> String {
    if page.droppers.is_empty() {
        return "<p>The line has no droppers.</p>\n".to_owned();
    }
    let columns = [
        ("tension length", "", true),
        ("span", "", true),
        ("dropper", "", true),
        ("from the left support", "m", true),
        ("from", "", false),
        ("to", "", false),
        ("unstressed length", "m", true),
        ("force", "N", true),
    ];
    let several = page.supports.iter().any(|support| support.tension_length > 1);
    let columns = if several { &columns[..] } else { &columns[1..] };
    let middle = 0.5 * (page.evaluated.from + page.evaluated.to);
    let mut away: Vec<f64> = page
        .droppers
        .iter()
        .map(|dropper| (dropper.bottom[0] - middle).abs())
        .collect();
    away.sort_by(f64::total_cmp);
    let most = away.get(MOST_DROPPERS).copied().unwrap_or(f64::INFINITY);
    let near = page.droppers.iter().filter(|dropper| {
        let x = dropper.bottom[0];
        page.shown.contains(x) && (x - middle).abs() < most
    });
    let rows: Vec<String> = near
        .map(|dropper| {
            let force = match dropper.is_slack() {
                true => "<span class=\"badge bad\">slack</span>".to_owned(),
                false => said(dropper.force, 1),
            };
            let [from, to] = &dropper.wires;
            let cells = [
                dropper.tension_length.to_string(),
                dropper.span.to_string(),
                dropper.number.to_string(),
                said(dropper.position, 3),
                escape(from),
                escape(to),
                said(dropper.length, 4),
                force,
            ];
            row(columns, cells.into_iter().skip(usize::from(!several)))
        })
        .collect();
    let (count, all) = (rows.len(), page.droppers.len());
    let said = match count == all {
        true => format!("{all} droppers, also in droppers.csv"),
        false => format!("{count} of {all} droppers, those around the evaluated spans; all are in droppers.csv"),
    };
    format!(
        "<details><summary>{said}</summary>\n{}</details>\n",
        table(columns, &rows.concat())
    )
}

/// Tensions of the wires.
pub(super) fn tensions(page: &LinePage) -> String {
    let columns = [
        ("wire", "", false),
        ("tension of the scene", "N", true),
        ("least at rest", "N", true),
        ("largest at rest", "N", true),
    ];
    let rows: String = page
        .tensions
        .iter()
        .map(|wire| {
            let numbers = [wire.nominal, wire.least, wire.most].map(|force| said(force, 0));
            row(&columns, [escape(&wire.name)].into_iter().chain(numbers))
        })
        .collect();
    table(&columns, &rows) + "<p class=\"caption\">Tensions at rest are axial, over all elements.</p>\n"
}

/// Elasticity of the evaluated spans.
pub(super) fn spans(page: &LinePage) -> String {
    if page.spans.is_empty() {
        return String::new();
    }
    let columns = [
        ("span", "", true),
        ("length", "m", true),
        ("least", "mm/N", true),
        ("most", "mm/N", true),
        ("non-uniformity u", "%", true),
    ];
    let rows: String = page
        .spans
        .iter()
        .map(|span| {
            let cells = [
                span.number.to_string(),
                said(span.ends[1] - span.ends[0], 2),
                said(1e3 * span.least, 4),
                said(1e3 * span.most, 4),
                said(100.0 * span.non_uniformity, 1),
            ];
            row(&columns, cells)
        })
        .collect();
    table(&columns, &rows) + "<p class=\"caption\">u = (most − least)/(most + least) over the evaluated spans.</p>\n"
}

/// The model.
pub(super) fn model(page: &LinePage) -> String {
    let columns = [("part", "", false), ("modelled", "", false), ("why, or how", "", false)];
    let model = &page.model;
    let rows: String = model
        .parts
        .iter()
        .map(|part| {
            let modelled = if part.modelled { "yes" } else { "no" };
            row(
                &columns,
                [
                    escape(&part.part.replace('_', " ")),
                    modelled.to_owned(),
                    escape(&part.reason),
                ],
            )
        })
        .collect();
    let reductions = match model.reductions.is_empty() {
        true => "none".to_owned(),
        false => model.reductions.join(", "),
    };
    format!(
        "<p>{} coordinates, {} constraints, {} elements; reductions: {}</p>\n{}",
        model.coordinates,
        model.constraints,
        model.elements,
        escape(&reductions),
        table(&columns, &rows)
    )
}
