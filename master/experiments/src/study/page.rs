//! `study.html`.

use super::options::Sweep;
use super::outcome::{Entry, Study};
use super::pareto::{TARGETS, speed};
use super::run_spec::Class;
use super::text::known;
use super::{CSV, plots};
use crate::engine::Table as _;
use crate::engine::export::{
    PageColumn, cells, count, fixed, grouped, heads, incomplete, number, scrolled, status_counts, status_rule,
    status_span, step,
};
use crate::engine::run::SETTLE;
use crate::engine::table::{RunRow, Status, milliseconds};
use results::report::{Page, escape, head_cells, remarks};

/// The page of a study.
#[must_use]
pub fn page(study: &Study) -> Page {
    let title = if study.title.is_empty() {
        &study.scene
    } else {
        &study.title
    };
    let mut page = Page::new(&format!("Speed against error: {title}"));
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
    let mut html = format!("<p><b>{}</b> · {} runs", escape(&study.scene), study.rows.len());
    html.push_str(&format!(": {}</p>\n", status_counts(&study.sheet().rows)));
    html.push_str(&format!("<p>Machine: {}</p>\n", escape(&study.machine.name())));
    if !study.source.is_empty() {
        html.push_str(&format!("<p class=\"soft\">{}</p>\n", escape(&study.source)));
    }
    html.push_str(&incomplete(study, " The same command goes on from here."));
    html.push_str(&remarks(&study.notes));
    html
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
    let head: String = TARGETS
        .iter()
        .map(|target| format!("<th>for {target} %</th>"))
        .collect();
    let mut classes: Vec<&str> = study.recommendations.iter().map(|found| found.class.as_str()).collect();
    classes.dedup();
    let mut body = String::new();
    for class in classes {
        body.push_str(&format!("<tr><td class=\"s\">{}</td>", escape(class)));
        for target in TARGETS {
            let found = study
                .recommendations
                .iter()
                .find(|found| found.class == class && found.target_percent == target);
            let cell = match found.and_then(|found| Some((found, found.row?))) {
                Some((found, index)) => {
                    let entry = &study.rows[index];
                    let row = &entry.row;
                    let factor = row.real_time_factor.unwrap_or(f64::NAN);
                    let caveat = if found.caveat.is_empty() {
                        String::new()
                    } else {
                        format!("<br><span class=\"bad\">{}</span>", escape(&found.caveat))
                    };
                    format!(
                        "<b>{}</b><br>{}<br><span class=\"soft\">{} % of σ</span>{caveat}",
                        speed(factor),
                        breakable(&study.advice(entry)),
                        number(row.filtered_error)
                    )
                }
                None => "<span class=\"soft\">not reached</span>".to_owned(),
            };
            body.push_str(&format!("<td class=\"remark\">{cell}</td>"));
        }
        body.push_str("</tr>\n");
    }
    format!(
        "{}<p class=\"caption\">The cheapest stable run whose filtered contact force is right to the percentage of its \
         standard deviation σ, rms over the evaluation range, against the reference of its own model; what is known of \
         that is said where it is less than the percentage.</p>\n",
        scrolled(&format!("<th></th>{head}"), &body)
    )
}

fn references(study: &Study) -> String {
    let mut html = String::new();
    for reference in &study.references {
        if reference.row.is_some() {
            html.push_str(&format!(
                "<h3>{}</h3><p>σ {} N, {}.</p>\n",
                breakable(&reference.name),
                number(reference.std),
                escape(&known(reference))
            ));
        }
        let mut body = String::new();
        for found in &reference.refinements {
            for (level, micro_step) in found.micro_step_s.iter().enumerate() {
                let elements = found.elements_per_span[level].map_or_else(String::new, |count| count.to_string());
                body.push_str(&format!(
                    "<tr><td>{}</td><td class=\"n\">{elements}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
                     <td class=\"n\">{}</td></tr>\n",
                    found.discretisation.name(),
                    milliseconds(Some(*micro_step)),
                    found.std[level].map_or_else(String::new, |std| format!("{std:.3}")),
                    number(found.difference_percent[level]),
                ));
            }
            if !found.ended.is_empty() {
                body.push_str(&format!(
                    "<tr><td>{}</td><td colspan=\"4\" class=\"soft\">ended: {}</td></tr>\n",
                    found.discretisation.name(),
                    escape(&found.ended)
                ));
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
        html.push_str(&scrolled(&head, &body));
    }
    html
}

fn orders(study: &Study) -> String {
    if study.orders.is_empty() {
        return String::new();
    }
    let mut body = String::new();
    for found in &study.orders {
        let size = |size: f64| {
            if found.sweep == "mesh" {
                format!("{size}")
            } else {
                milliseconds(Some(size))
            }
        };
        let sizes: Vec<String> = found.sizes.iter().map(|value| size(*value)).collect();
        body.push_str(&format!(
            "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{}</td></tr>\n",
            found.sweep.replace('_', " "),
            escape(&found.of),
            sizes.join(" → "),
            number(Some(found.differences[0])),
            number(Some(found.differences[1])),
            found
                .order
                .map_or_else(|| "none".to_owned(), |order| format!("{order:.1}")),
        ));
    }
    let head = head_cells([
        ("refined", "", false),
        ("the same", "", false),
        ("elements per span or ms", "", true),
        ("first difference", "% of σ", true),
        ("second", "% of σ", true),
        ("order", "", true),
    ]);
    format!(
        "{}<p class=\"caption\">From the differences of three successive runs; no reference takes part, so that \
         neither the other discretisation nor the reference's own error spoils it. None: the differences do not \
         fall.</p>\n",
        scrolled(&head, &body)
    )
}

/// Columns of a table of runs.
type Columns = [PageColumn<Entry>];

const COLUMNS: &Columns = &[
    (
        "",
        "",
        "",
        |entry| {
            if entry.pareto { "★".to_owned() } else { String::new() }
        },
    ),
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
    match row.macro_step {
        None => "one system".to_owned(),
        Some(step) => {
            let degree = row
                .extrapolation
                .map_or_else(String::new, |degree| format!(" ({degree})"));
            format!("{}{degree} {}", escape(&row.algorithm), milliseconds(Some(step)))
        }
    }
}

fn table<'a>(rows: impl Iterator<Item = &'a Entry>, columns: &Columns) -> String {
    let row = |entry: &Entry| {
        let cells = cells(columns, entry);
        format!("<tr title=\"{}\">{cells}</tr>\n", escape(&entry.row.reason))
    };
    let body: String = rows.map(row).collect();
    if body.is_empty() {
        return String::new();
    }
    scrolled(&heads(columns), &body)
}

/// The rows of a sweep, and why those that did not run did not.
fn part(study: &Study, sweep: Sweep) -> String {
    let html = table(study.of(sweep), COLUMNS);
    let ended = study.of(sweep).map(|entry| &entry.row);
    let ended = ended.filter(|row| row.status.is_some_and(|status| status != Status::Stable));
    let reasons = grouped(ended.map(|row| {
        let name = if sweep == Sweep::Reductions {
            row.reduction.clone()
        } else {
            study.label(row)
        };
        (&row.reason, name)
    }));
    let said: String = reasons
        .iter()
        .map(|(reason, names)| format!("<li>{}: {}</li>", escape(&names.join("; ")), escape(reason)))
        .collect();
    if said.is_empty() {
        html
    } else {
        format!("{html}<ul class=\"soft\">{said}</ul>\n")
    }
}

/// Effect and cost of each model of the vehicle.
fn vehicles(study: &Study) -> String {
    const VEHICLES: &Columns = &[
        ("track", "", "", |entry| {
            breakable(entry.vehicle_variant.map_or("", |name| name.track))
        }),
        ("vehicle", "", "", |entry| {
            breakable(entry.vehicle_variant.map_or("", |name| name.vehicle))
        }),
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
        ("why", "", "", |entry| match entry.row.status {
            Some(Status::Stable) | None => String::new(),
            Some(_) => escape(&entry.row.reason),
        }),
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
        ("why", "", "", |entry| match entry.row.status {
            Some(Status::Stable) | None => String::new(),
            Some(_) => escape(&entry.row.reason),
        }),
    ];
    let table = table(study.of(Sweep::Spans), GROWTH);
    if table.is_empty() {
        table
    } else {
        format!("{}{table}", plots::growth(study))
    }
}

fn all(study: &Study) -> String {
    let mut html = table(study.rows.iter(), COLUMNS);
    let reasons = study.rows.iter().map(|entry| &entry.row.reason);
    let reasons = grouped(reasons.filter(|reason| !reason.is_empty()).map(|reason| (reason, ())));
    if !reasons.is_empty() {
        let said: String = reasons
            .iter()
            .map(|(reason, runs)| {
                format!(
                    "<tr><td class=\"n\">{}</td><td class=\"remark\">{}</td></tr>\n",
                    runs.len(),
                    escape(reason)
                )
            })
            .collect();
        html.push_str(&format!(
            "<details><summary>What is to be said of runs</summary>{}</details>\n",
            scrolled("<th class=\"n\">runs</th><th>reason</th>", &said)
        ));
    }
    html.push_str(&format!(
        "<p class=\"caption\">★ on the front of its class. All columns, the work of the solvers among them, are in \
         {CSV}.</p>\n"
    ));
    html
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
