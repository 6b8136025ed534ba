//! `study.html`.

use super::options::Sweep;
use super::outcome::{Entry, Order, Study};
use super::pareto::{Recommendation, TARGETS, speed};
use super::run_spec::Class;
use super::text::known;
use super::{CSV, plots};
use crate::engine::export::{grouped, reasons, run_lines, scene_lead, scene_page, status_rule, status_span};
use crate::engine::table::RunRow;
use results::report::format::{count, fixed, milliseconds, number, step};
use results::report::{Page, PageColumn, cell, cells, escape, head_cells, heads, lined, remarks, scrolled};
use simulation::SETTLE;

/// The page of a study.
pub(super) fn page(study: &Study) -> Page {
    let mut page = scene_page("Speed against error", &study.scene, &study.title);
    page.lead(&lead(study));
    page.section("What to take", &recommended(study));
    page.section("Error against cost", &plots::precision(study));
    page.section("References", &references(study));
    page.section("Mesh", &plots::mesh(study));
    page.section("Micro step", &plots::micro_step(study));
    page.section("Observed orders", &orders(study));
    page.section("Coupling", &plots::coupling(study));
    page.section("Reductions", &part(study, Sweep::Reductions));
    page.section("What the pantograph stands on", &vehicles(study));
    page.section("Spectral radius", &part(study, Sweep::RhoInf));
    page.section("Length of the line", &growth(study));
    page.section("All runs", &all(study));
    page.section("How to read this", &legend(study));
    page
}

fn lead(study: &Study) -> String {
    let machine = format!("<p>Machine: {}</p>\n", escape(&study.machine.name()));
    let remedy = " The same command goes on from here.";
    scene_lead(&study.scene, &study.source, study, &machine, remedy) + &remarks(&study.notes)
}

/// Text whose long names may be broken at their joints.
fn breakable(text: &str) -> String {
    escape(text).replace('+', "+<wbr>").replace('_', "_<wbr>")
}

/// One line per class, one column per target.
fn recommended(study: &Study) -> String {
    if study.recommendations.is_empty() {
        return String::new();
    }
    let said = |found: &Recommendation| {
        let Some(index) = found.row else {
            return cell("remark", "<span class=\"soft\">not reached</span>");
        };
        let entry = &study.rows[index];
        let caveat = match found.caveat.as_str() {
            "" => String::new(),
            caveat => format!("<br><span class=\"bad\">{}</span>", escape(caveat)),
        };
        let said = format!(
            "<b>{}</b><br>{}<br><span class=\"soft\">{} % of σ</span>{caveat}",
            speed(entry.row.real_time_factor.unwrap_or(f64::NAN)),
            breakable(&study.advice(entry)),
            number(entry.row.filtered_error)
        );
        cell("remark", &said)
    };
    // Each class has a recommendation for every target, in their order.
    let classes = study.recommendations.chunk_by(|a, b| a.class == b.class);
    let line = |found: &[Recommendation]| {
        let targets: String = found.iter().map(said).collect();
        cell("s", &escape(&found[0].class)) + &targets
    };
    let head: String = TARGETS.map(|target| format!("<th>for {target} %</th>")).concat();
    format!(
        "{}<p class=\"caption\">The cheapest stable run whose filtered contact force is right to the percentage of its \
         standard deviation σ, rms over the evaluation range, against the reference of its own model; what is known of \
         that is said where it is less than the percentage.</p>\n",
        lined(&format!("<th></th>{head}"), classes.map(line))
    )
}

fn references(study: &Study) -> String {
    let mut html = String::new();
    for reference in &study.references {
        if reference.row.is_some() {
            let (name, std, known) = (breakable(&reference.name), number(reference.std), known(reference));
            html.push_str(&format!("<h3>{name}</h3><p>σ {std} N, {}.</p>\n", escape(&known)));
        }
        let mut lines = Vec::new();
        for found in &reference.refinements {
            let mesh = cell("", found.discretisation.name());
            for (level, micro_step) in found.micro_step_s.iter().enumerate() {
                let cells = [
                    count(found.elements_per_span[level]),
                    step(Some(*micro_step)),
                    fixed(found.std[level], 3),
                    number(found.difference_percent[level]),
                ];
                lines.push(mesh.clone() + &cells.map(|text| cell("n", &text)).concat());
            }
            if !found.ended.is_empty() {
                let ended = escape(&found.ended);
                lines.push(format!("{mesh}<td colspan=\"4\" class=\"soft\">ended: {ended}</td>"));
            }
        }
        let mesh = format!("{} line, mesh", reference.family.name());
        let head = head_cells([
            (&*mesh, "", false),
            ("elements", "per span", true),
            ("micro step", "ms", true),
            ("σ", "N", true),
            ("from the level before", "% of σ", true),
        ]);
        html.push_str(&lined(&head, lines));
    }
    html
}

fn orders(study: &Study) -> String {
    const ORDERS: &[PageColumn<Order>] = &[
        ("refined", "", "", |found| found.sweep.replace('_', " ")),
        ("the same", "", "", |found| escape(&found.of)),
        ("elements per span or ms", "", "n", |found| {
            let sizes = found.sizes.map(|size| match found.sweep {
                "mesh" => format!("{size}"),
                _ => milliseconds(Some(size)),
            });
            sizes.join(" → ")
        }),
        ("first difference", "% of σ", "n", |found| {
            number(Some(found.differences[0]))
        }),
        ("second", "% of σ", "n", |found| number(Some(found.differences[1]))),
        ("order", "", "n", |found| {
            let order = found.order.map(|order| format!("{order:.1}"));
            order.unwrap_or_else(|| "none".to_owned())
        }),
    ];
    if study.orders.is_empty() {
        return String::new();
    }
    format!(
        "{}<p class=\"caption\">From the differences of three successive runs; no reference takes part, so that \
         neither the other discretisation nor the reference's own error spoils it. None: the differences do not \
         fall.</p>\n",
        lined(&heads(ORDERS), study.orders.iter().map(|found| cells(ORDERS, found)))
    )
}

/// Columns of a table of runs.
type Columns = [PageColumn<Entry>];

const COLUMNS: &Columns = &[
    ("", "", "", |entry| if entry.pareto { "★" } else { "" }.to_owned()),
    ("elements", "per span", "n", |entry| count(entry.row.elements_per_span)),
    ("mesh", "", "", |entry| breakable(&entry.row.mesh)),
    ("micro", "ms", "n", |entry| step(entry.row.micro_step)),
    ("coupling", "macro step ms", "", |entry| exchange(&entry.row)),
    ("ρ∞", "", "n", |entry| format!("{}", entry.rho_inf)),
    ("Newton", "N", "n", |entry| format!("{}", entry.newton_tolerance)),
    ("reductions", "", "", |entry| breakable(&entry.row.reduction)),
    ("status", "", "", |entry| status_span(entry.row.status)),
    ("error", "% of σ", "n", |entry| number(entry.row.filtered_error)),
    ("raw error", "% of σ", "n", |entry| number(entry.row.raw_error)),
    ("σ error", "%", "n", |entry| number(entry.row.std_error)),
    ("from nonlinear", "% of σ", "n", |entry| {
        number(entry.distance_from_nonlinear_percent)
    }),
    ("σ", "N", "n", |entry| fixed(entry.row.std, 3)),
    ("real-time factor", "", "n", |entry| number(entry.row.real_time_factor)),
    ("wall", "s", "n", |entry| number(entry.row.wall)),
    ("coordinates", "", "n", |entry| count(entry.row.coordinates)),
];

fn exchange(row: &RunRow) -> String {
    let Some(macro_step) = row.macro_step else {
        return "one system".to_owned();
    };
    let degree = row
        .extrapolation
        .map_or_else(String::new, |degree| format!(" ({degree})"));
    format!("{}{degree} {}", escape(&row.algorithm), milliseconds(Some(macro_step)))
}

/// Reason of a run that is not stable.
fn why(entry: &Entry) -> String {
    entry
        .row
        .trouble()
        .map_or_else(String::new, |_| escape(&entry.row.reason))
}

fn table<'a>(rows: impl Iterator<Item = &'a Entry>, columns: &Columns) -> String {
    let body = run_lines(columns, rows, |entry| &entry.row);
    if body.is_empty() {
        return String::new();
    }
    scrolled(&heads(columns), &body)
}

/// The rows of a sweep, and why those that did not run did not.
fn part(study: &Study, sweep: Sweep) -> String {
    let html = table(study.of(sweep), COLUMNS);
    let ended = study.of(sweep).map(|entry| &entry.row);
    let named = |row: &RunRow| match sweep {
        Sweep::Reductions => row.reduction.clone(),
        _ => study.label(row),
    };
    let said = grouped(ended.filter_map(|row| row.trouble().map(|_| (&row.reason, named(row)))));
    let said = said.iter();
    let said: String = said
        .map(|(reason, names)| format!("<li>{}: {}</li>", escape(&names.join("; ")), escape(reason)))
        .collect();
    if said.is_empty() {
        return html;
    }
    format!("{html}<ul class=\"soft\">{said}</ul>\n")
}

/// Effect and cost of each model of the vehicle.
fn vehicles(study: &Study) -> String {
    const VEHICLES: &Columns = &[
        ("track", "", "", |entry| breakable(entry.stands_on().track)),
        ("vehicle", "", "", |entry| breakable(entry.stands_on().vehicle)),
        ("status", "", "", |entry| status_span(entry.row.status)),
        ("difference", "% of σ", "n", |entry| {
            number(vehicle_error(entry, entry.row.filtered_error))
        }),
        ("of σ", "%", "n", |entry| {
            number(vehicle_error(entry, entry.row.std_error))
        }),
        ("mean", "N", "n", |entry| fixed(entry.row.mean, 3)),
        ("σ", "N", "n", |entry| fixed(entry.row.std, 3)),
        ("real-time factor", "", "n", |entry| number(entry.row.real_time_factor)),
        ("wall", "s", "n", |entry| number(entry.row.wall)),
        ("coordinates", "", "n", |entry| count(entry.row.coordinates)),
        ("reductions", "", "", |entry| breakable(&entry.row.reduction)),
        ("why", "", "", why),
    ];
    let table = table(study.of(Sweep::Vehicle), VEHICLES);
    if table.is_empty() {
        return table;
    }
    format!(
        "{table}<p class=\"caption\">One mesh and one micro step, with those reductions that change nothing. \
         Differences are rms of the filtered force, in percent of the standard deviation on the most detailed model of \
         the same track, which is the first. none: the base moves on a straight line. rigid_motion: it moves as on \
         that model under a constant contact force, and feels nothing of the pantograph. A curve is felt on full \
         alone: on rigid_motion and none the pantograph feels no centrifugal force there, nor the lean of its weight, \
         and vertical has no curves. Track ore_b176_low: irregularities of the lower level of ORE B176.</p>\n"
    )
}

/// An error of a row, where it is one against another vehicle.
pub(super) fn vehicle_error(entry: &Entry, error: Option<f64>) -> Option<f64> {
    error.filter(|_| entry.sweep == Sweep::Vehicle.name())
}

fn growth(study: &Study) -> String {
    const GROWTH: &Columns = &[
        ("spans", "", "n", |entry| count(entry.spans)),
        ("line", "", "", |entry| Class::of(&entry.row.reduction).name()),
        ("status", "", "", |entry| status_span(entry.row.status)),
        ("coordinates", "", "n", |entry| count(entry.row.coordinates)),
        ("time loop", "s per simulated s", "n", |entry| {
            number(entry.row.real_time_factor)
        }),
        ("memory of the time loop", "MB", "n", |entry| {
            number(entry.working_memory_bytes.map(|bytes| bytes as f64 / 1e6))
        }),
        ("statics and loading", "s", "n", |entry| number(entry.setup_s)),
        ("why", "", "", why),
    ];
    let table = table(study.of(Sweep::Spans), GROWTH);
    if table.is_empty() {
        table
    } else {
        format!("{}{table}", plots::growth(study))
    }
}

fn all(study: &Study) -> String {
    let said = study.rows.iter().map(|entry| entry.row.reason.as_str());
    let said = grouped(said.filter(|reason| !reason.is_empty()).map(|reason| (reason, ())));
    let said = said.into_iter().map(|(reason, runs)| (runs.len().to_string(), reason));
    format!(
        "{}{}<p class=\"caption\">★ on the front of its class. All columns, the work of the solvers among them, are in \
         {CSV}.</p>\n",
        table(study.rows.iter(), COLUMNS),
        reasons("What is to be said of runs", "n", said.collect())
    )
}

fn legend(study: &Study) -> String {
    format!(
        "<p>Errors are pointwise: rms of the difference of the filtered forces at equal positions over the evaluation \
         range, in percent of the standard deviation σ of the reference's filtered force. A reference is refined, \
         elements doubled and micro step halved, until two successive levels agree; their difference is what is not \
         known of it. The nonlinear line is refined with two meshes, which confirm each other; the one whose last \
         levels are closer is the reference. Linearised and flat lines are judged by their own references, and their \
         distance from the nonlinear line is stated.</p>\n\
         <p>Runs end {SETTLE} periods of the low-pass filter's cut-off behind the evaluation range: {:.2} s. Errors \
         were computed on all cores at once, wall times one run at a time afterwards: time loop only, median of the \
         repeats. Runs of references that are too fine to be chosen are not timed again.</p>\n<p>{}.</p>\n",
        study.simulated_s,
        status_rule()
    )
}
