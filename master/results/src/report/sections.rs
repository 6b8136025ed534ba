//! The sections of the report that are text and tables.

use super::format::decimals;
use super::label::NamedRun;
use super::plots::colour;
use super::table::{bounded, cause, marks, quantity_name, readable, shares, verdict, verdict_class};
use super::{PageColumn, cell, cells, escape, heads, lined, remarks_of};
use crate::explain;
use crate::standards::Limit;
use crate::statistics::ForceStatistics;
use crate::{Accuracy, Part, RunBundle, Summary};

/// Title of the page.
pub(super) fn title(runs: &[RunBundle]) -> String {
    match runs {
        [] => "No run".to_owned(),
        [run] if run.summary.title.is_empty() => run.summary.scene.clone(),
        [run] => run.summary.title.clone(),
        runs => format!("{} runs compared", runs.len()),
    }
}

/// Lines below the title: scene, mode, speed, state of each run.
pub(super) fn lead(runs: &[NamedRun<'_>]) -> String {
    let mut html = String::new();
    for run in runs {
        let s = &run.summary;
        let state = if s.complete {
            "<span class=\"badge good\">complete</span>"
        } else {
            "<span class=\"badge bad\">incomplete</span>"
        };
        let title = if runs.len() > 1 && !s.title.is_empty() {
            format!(" · {}", escape(&s.title))
        } else {
            String::new()
        };
        let name = if runs.len() > 1 { &run.label } else { &s.scene };
        html.push_str(&format!(
            "<p><b>{}</b> · {}{title} · {:.0} km/h · {:.2} s simulated {state}</p>\n",
            escape(name),
            escape(&s.mode),
            3.6 * s.evaluation.speed,
            s.cost.simulated_s,
        ));
        if !s.complete {
            html.push_str(&format!(
                "<p class=\"warning\">The run did not reach its end: {}</p>\n",
                escape(&s.incomplete_reason)
            ));
        }
    }
    html
}

/// Remarks on what the figures are worth, run by run.
fn notes(runs: &[NamedRun<'_>]) -> String {
    let mut html = String::new();
    for run in runs {
        if runs.len() > 1 && !run.summary.notes.is_empty() {
            html.push_str(&format!("<h3>{}</h3>\n", escape(&run.label)));
        }
        html.push_str(&remarks_of(run.summary.notes.iter().map(|note| explained(note))));
    }
    html
}

/// A note as HTML, with what is known of its subject to unfold.
fn explained(note: &str) -> String {
    let text = escape(note);
    let subject = note.split(": ").next().unwrap_or(note);
    explain::named(subject).map_or(text.clone(), |word| {
        format!(
            "<details class=\"note\"><summary>{text}</summary>{} <span class=\"soft\">See {}.</span></details>",
            escape(word.meaning),
            escape(word.page)
        )
    })
}

/// Coloured square in front of a run's name, where several runs are shown.
fn swatch(runs: &[NamedRun<'_>], index: usize) -> String {
    if runs.len() < 2 {
        return String::new();
    }
    let colour = colour(index);
    format!("<span class=\"swatch\" style=\"background:{colour}\"></span>")
}

fn card(value: &str, unit: &str, name: &str) -> String {
    format!("<div class=\"card\"><b>{value} <small>{unit}</small></b><span>{name}</span></div>\n")
}

/// Tiles of each pantograph of a run, the first with those of the line.
fn tiles(s: &Summary) -> String {
    let several = s.pantographs.len() > 1;
    let uplift = s.uplift.max_at_support.map(|u| 1e3 * u);
    let mut html = String::new();
    for (index, pantograph) in s.pantographs.iter().enumerate() {
        let force = pantograph.contact_force.filtered;
        let std = force.map(|f| f.std);
        let loss = pantograph.contact_force.loss_of_contact_percent;
        let named = |figure: &str, name: &str| match s.uncertainty_of(index + 1, figure) {
            Some(known) => format!(
                "{name}<br>model −{:.1}/+{:.1}&nbsp;{}",
                known.below, known.above, known.unit
            ),
            None => name.to_owned(),
        };
        let mut cards = vec![
            card(
                &decimals(force.map(|f| f.mean), 1),
                "N",
                &named("mean", "mean contact force"),
            ),
            card(
                &decimals(std, 1),
                &deviation(s, std),
                &named("std", "standard deviation σ"),
            ),
            card(&decimals(force.map(|f| f.max), 1), "N", &named("max", "maximum")),
            card(&decimals(force.map(|f| f.min), 1), "N", &named("min", "minimum")),
            card(&decimals(loss, 2), "%", &named("loss", "loss of contact")),
        ];
        if index == 0 {
            cards.push(card(&decimals(uplift, 1), "mm", &named("uplift", "uplift at support")));
            cards.push(card(&decimals(s.cost.real_time_factor, 3), "", "real-time factor"));
        }
        if several {
            html.push_str(&format!("<h3>Pantograph {}</h3>\n", index + 1));
        }
        html.push_str(&format!("<div class=\"cards\">{}</div>\n", cards.concat()));
    }
    html
}

/// Unit of the standard deviation with its expected numerical error.
fn deviation(s: &Summary, std: Option<f64>) -> String {
    match s.accuracy.expected_percent.zip(std) {
        Some((percent, std)) => format!("N ± {:.1}", percent / 100.0 * std),
        None => "N".to_owned(),
    }
}

/// Key figures: tiles for one run, and a table for all.
pub(super) fn key_figures(runs: &[NamedRun<'_>]) -> String {
    let mut html = String::new();
    if let [run] = runs {
        html.push_str(&tiles(&run.summary));
    }
    html.push_str(
        "<div class=\"scroll\"><table><thead><tr><th>Contact force [N]</th><th class=\"n\">mean</th>\
         <th class=\"n\">σ</th><th class=\"n\">max</th><th class=\"n\">min</th>\
         <th class=\"n\">mean + 3σ</th><th class=\"n\">mean − 3σ</th><th class=\"n\">loss [%]</th>\
         <th class=\"n\">strip amplitude [mm]</th><th class=\"n\">uplift [mm]</th>\
         <th class=\"n\">RTF</th></tr></thead><tbody>\n",
    );
    let mut colour = 0;
    for run in runs {
        let s = &run.summary;
        for (i, pantograph) in s.pantographs.iter().enumerate() {
            let force = &pantograph.contact_force;
            let mut name = String::new();
            if runs.len() > 1 {
                name = format!("{}{}, ", swatch(runs, colour), escape(&run.label));
            }
            if s.pantographs.len() > 1 {
                name.push_str(&format!("pantograph {}, ", i + 1));
            }
            colour += 1;
            let cells = |f: Option<ForceStatistics>| {
                [
                    f.map(|f| f.mean),
                    f.map(|f| f.std),
                    f.map(|f| f.max),
                    f.map(|f| f.min),
                    f.map(|f| f.statistical_max),
                    f.map(|f| f.statistical_min),
                ]
                .map(|v| format!("<td class=\"n\">{}</td>", decimals(v, 2)))
                .concat()
            };
            let amplitude = pantograph.strip.vertical_amplitude.map(|a| 1e3 * a);
            html.push_str(&format!(
                "<tr><td class=\"s\">{name}filtered {} Hz</td>{}<td></td><td class=\"n\">{}</td>\
                 <td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                s.evaluation.low_pass_hz,
                cells(force.filtered),
                decimals(amplitude, 1),
                decimals(s.uplift.max_at_support.map(|u| 1e3 * u), 1),
                decimals(s.cost.real_time_factor, 3),
            ));
            html.push_str(&format!(
                "<tr><td class=\"s\">{name}raw</td>{}<td class=\"n\">{}</td><td></td><td></td><td></td></tr>\n",
                cells(force.raw),
                decimals(force.loss_of_contact_percent, 3),
            ));
            for (number_on_head, strip) in (1..).zip(&pantograph.strips) {
                html.push_str(&format!(
                    "<tr><td class=\"s\">{name}strip {number_on_head}, filtered {} Hz</td>{}<td class=\"n\">{}</td>\
                     <td></td><td></td><td></td></tr>\n",
                    s.evaluation.low_pass_hz,
                    cells(strip.filtered),
                    decimals(strip.loss_of_contact_percent, 3),
                ));
            }
        }
    }
    html.push_str("</tbody></table></div>\n");
    html.push_str(&ranges(runs));
    html.push_str(&uncertain(runs));
    html.push_str(&notes(runs));
    html
}

/// Sentence on the numbers that the figures depend on most.
fn uncertain(runs: &[NamedRun<'_>]) -> String {
    let [run] = runs else { return String::new() };
    let Some(known) = run.summary.uncertainty_of(1, "std") else {
        return String::new();
    };
    format!(
        "<p class=\"caption\">Model: changes within the ranges of numbers that are not known for certain, by a \
         sensitivity analysis of this scene. σ depends most on {}.</p>\n",
        escape(&known.largest.join(", "))
    )
}

/// Sentence on the time over which the figures were taken.
fn ranges(runs: &[NamedRun<'_>]) -> String {
    let mut texts: Vec<String> = Vec::new();
    for run in runs {
        for (from, to) in &run.summary.evaluation.time {
            let text = format!("{from:.3} s to {to:.3} s");
            if !texts.contains(&text) {
                texts.push(text);
            }
        }
    }
    if texts.is_empty() {
        return String::new();
    }
    format!(
        "<p class=\"caption\">Evaluated from {}. Uplift: largest rise at the supports of the \
         evaluated spans over the whole run. RTF: wall time of the time loop divided by simulated \
         time. ±: expected numerical error, by rule.</p>\n",
        texts.join(", ")
    )
}

/// Table of the limits: clause, applicability with its reason, verdict.
pub(super) fn limits(runs: &[NamedRun<'_>]) -> String {
    let mut html = String::from(
        "<div class=\"scroll\"><table><thead><tr><th>Standard</th><th>Quantity</th>\
         <th class=\"n\">value</th><th class=\"n\">limit</th><th></th><th>verdict</th><th></th>\
         <th>applies, or not</th><th>remark</th></tr></thead><tbody>\n",
    );
    for run in runs {
        if runs.len() > 1 {
            html.push_str(&format!("<tr><th colspan=\"9\">{}</th></tr>\n", escape(&run.label)));
        }
        let one = run.summary.pantographs.len() == 1;
        for limit in &run.summary.limits {
            let (value, _, unit) = readable(limit);
            let class = verdict_class(limit.pass);
            let mut shown = limit.clone();
            if one {
                shown.pantograph = None;
            }
            html.push_str(&format!(
                "<tr><td class=\"name\">{}<br><span class=\"soft\">{}</span></td><td class=\"name\">{}</td>\
                 <td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td>\
                 <td class=\"s\"><b class=\"{class}\">{}</b></td><td class=\"soft\">{}</td>\
                 <td class=\"soft remark\">{}</td><td class=\"soft remark\">{}</td></tr>\n",
                escape(&limit.standard),
                escape(&limit.clause),
                escape(&quantity_name(&shown)),
                decimals(value, 2),
                escape(&bounded(limit)),
                escape(unit),
                verdict(limit),
                limit.certainty.mark(),
                escape(&limit.reason),
                escape(&limit.remark),
            ));
        }
    }
    let all: Vec<Limit> = runs.iter().flat_map(|run| run.summary.limits.clone()).collect();
    html.push_str(&format!(
        "</tbody></table></div>\n<p class=\"caption\">{}. Editions are those whose figures could be read; those in \
         force stand in docs/theory/statistics.md. Figures of your copy are entered under [assessment].</p>\n",
        marks(&all)
    ));
    html
}

/// Parts modelled and left out, source of the scene, coupling of the sides.
pub(super) fn model(runs: &[NamedRun<'_>]) -> String {
    let mut html = String::new();
    for run in runs {
        let s = &run.summary;
        if runs.len() > 1 {
            html.push_str(&format!("<h3>{}</h3>\n", escape(&run.label)));
        }
        let reductions = if s.model.reductions.is_empty() {
            "none".to_owned()
        } else {
            escape(&s.model.reductions.join(", "))
        };
        let residual = s
            .coupling
            .energy_residual
            .map_or_else(String::new, |e| format!(", energy residual {e:.3e} J"));
        html.push_str(&format!(
            "<p>{} coordinates, {} constraints, {} elements; reductions: {reductions}.</p>\n\
             <p>Coupling: <b>{}</b>{residual}. <span class=\"soft\">{}</span></p>\n",
            s.model.coordinates,
            s.model.constraints,
            s.model.elements,
            escape(&s.coupling.algorithm),
            escape(&s.coupling.reason),
        ));
        let part = |part: &Part| {
            let (class, text) = if part.modelled { ("good", "yes") } else { ("soft", "no") };
            let name = escape(&part.part.replace('_', " "));
            cell("s", &name) + &cell(class, text) + &cell("remark", &escape(&part.reason))
        };
        let head = "<th>part</th><th>modelled</th><th>how, or why not</th>";
        html.push_str(&lined(head, s.model.parts.iter().map(part)));
        html.push_str(&accuracy(&s.accuracy));
        if !s.source.is_empty() {
            html.push_str(&format!(
                "<p class=\"caption\">Source of the scene: {}</p>\n",
                escape(&s.source)
            ));
        }
    }
    html
}

/// Expected error, cause by cause.
fn accuracy(accuracy: &Accuracy) -> String {
    let Some(sum) = accuracy.expected_percent else {
        return String::new();
    };
    let asked = (accuracy.asked_percent).map_or_else(String::new, |asked| format!(", {asked} % asked for"));
    let causes: Vec<String> = (accuracy.shares.iter()).map(|share| escape(&cause(share))).collect();
    let whole = (accuracy.cost_of_whole_line)
        .filter(|cost| *cost > 1.05)
        .map_or_else(String::new, |cost| {
            format!(" The nonlinear whole line on this mesh and step takes about {cost:.1} times as long.")
        });
    format!(
        "<p>Expected error of the filtered force: <b>{sum:.2} %</b> of its standard deviation{asked}. \
         <span class=\"soft\">By cause, in %: {}.{whole}</span></p>\n",
        causes.join(", ")
    )
}

/// Cost of the runs.
pub(super) fn cost(runs: &[NamedRun<'_>]) -> String {
    let columns: [PageColumn<NamedRun<'_>>; 11] = [
        ("run", "", "", |run| escape(&run.label)),
        ("time loop [s]", "", "n", |run| {
            format!("{:.3}", run.summary.cost.wall_s)
        }),
        ("setup [s]", "", "n", |run| format!("{:.3}", run.summary.cost.setup_s)),
        ("simulated [s]", "", "n", |run| {
            format!("{:.3}", run.summary.cost.simulated_s)
        }),
        ("RTF", "", "n", |run| decimals(run.summary.cost.real_time_factor, 3)),
        ("macro steps", "", "n", |run| run.summary.cost.macro_steps.to_string()),
        ("micro steps", "", "n", |run| run.summary.cost.micro_steps.to_string()),
        ("Newton iterations", "", "n", |run| {
            run.summary.cost.newton_iterations.to_string()
        }),
        ("factorizations", "", "n", |run| {
            run.summary.cost.factorizations.to_string()
        }),
        ("rollbacks", "", "n", |run| run.summary.cost.rollbacks.to_string()),
        ("time loop spent on", "", "", |run| escape(&shares(&run.summary.cost))),
    ];
    lined(&heads(&columns), runs.iter().map(|run| cells(&columns, run)))
}

/// The resolved scenes, folded.
pub(super) fn scene(runs: &[NamedRun<'_>]) -> String {
    runs.iter()
        .filter(|run| !run.scene.is_empty())
        .map(|run| {
            format!(
                "<details><summary>scene.toml of {}</summary><pre>{}</pre></details>\n",
                escape(&run.label),
                escape(&run.scene)
            )
        })
        .collect()
}
