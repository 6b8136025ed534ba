//! `sensitivity.html`: effects of each parameter as bars, and the table.

use results::report::format::or_dash;
use results::report::{Library, Page, PageColumn, cells, escape, figure_html, heads, plots, saved};
use serde_json::json;

use super::{Effect, FigureEffects, Sensitivity};
use crate::values::shown;

/// Most parameters that a figure shows, the largest effects first.
const DRAWN: usize = 20;

/// Height of a bar and of what stands around them, CSS pixels.
const BAR: u32 = 26;
const AROUND: u32 = 96;

fn change(change: Option<f64>) -> String {
    or_dash(change.map(|change| format!("{change:+.3}").replace('-', "−")))
}

fn slope(slope: Option<f64>) -> String {
    or_dash(slope.map(|slope| format!("{slope:.3e}").replace('-', "−")))
}

/// Columns of the table.
const COLUMNS: [PageColumn<Effect>; 8] = [
    ("parameter", "", "name", |effect| escape(&effect.key)),
    ("origin", "", "", |effect| effect.mark.unwrap_or_default().to_owned()),
    ("value", "", "n", |effect| shown(effect.value)),
    ("from", "", "n", |effect| shown(effect.low)),
    ("to", "", "n", |effect| shown(effect.high)),
    ("change at from", "", "n", |effect| change(effect.at_low)),
    ("change at to", "", "n", |effect| change(effect.at_high)),
    ("slopes", "", "n", |effect| {
        format!("{}, {}", slope(effect.slopes[0]), slope(effect.slopes[1]))
    }),
];

/// Bars of the changes of a figure.
fn bars(figure: &FigureEffects, id: &str) -> String {
    // The first of the list stands at the bottom of the axis.
    let drawn: Vec<&Effect> = figure.effects.iter().take(DRAWN).rev().collect();
    let keys: Vec<&str> = drawn.iter().map(|effect| effect.key.as_str()).collect();
    let trace = |name: &str, colour: &str, of: fn(&Effect) -> Option<f64>| {
        json!({
            "type": "bar",
            "orientation": "h",
            "name": name,
            "y": keys,
            "x": drawn.iter().map(|effect| of(effect)).collect::<Vec<_>>(),
            "marker": { "color": colour },
        })
    };
    let axis = format!("change of {} [{}]", figure.figure, figure.unit);
    let figure_of = json!({
        "data": [
            trace("at the least value", plots::COLOURS[0], |effect| effect.at_low),
            trace("at the largest value", plots::COLOURS[1], |effect| effect.at_high),
        ],
        "layout": {
            "barmode": "overlay",
            "xaxis": { "title": { "text": axis }, "zeroline": true },
            "yaxis": { "automargin": true },
            "margin": { "l": 20, "r": 16, "t": 30, "b": 50 },
            "font": { "family": "system-ui, sans-serif", "size": 13 },
            "legend": { "orientation": "h", "y": 1.02, "yanchor": "bottom" },
        },
        "config": { "responsive": true, "displaylogo": false, "displayModeBar": false },
    });
    let name = format!("change of {} with each parameter", figure.figure);
    let height = AROUND + BAR * drawn.len() as u32;
    figure_html(&figure_of.to_string(), (id, &name), height, Library::Curves)
}

impl Sensitivity {
    /// The page.
    #[must_use]
    pub fn page(&self) -> String {
        let mut page = Page::new(&format!("Sensitivity of {}", self.scene));
        let known = self.figures.iter().filter_map(|figure| Some((figure, figure.value?)));
        let lines = known.clone().map(|(figure, value)| {
            format!(
                "<tr><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{value:.2}</td><td class=\"n\">−{:.2}</td>\
                 <td class=\"n\">+{:.2}</td><td>{}</td></tr>\n",
                figure.pantograph, figure.figure, figure.below, figure.above, figure.unit
            )
        });
        page.lead(&format!(
            "<p><b>{}</b> · {} · {} runs, one parameter at a time</p>\n",
            escape(&self.scene),
            escape(&self.mode),
            self.runs
        ));
        page.section(
            "Figures",
            &format!(
                "<div class=\"scroll\"><table data-csv=\"figures\"><thead><tr><th class=\"n\">pantograph</th>\
                 <th>figure</th><th class=\"n\">value</th><th class=\"n\">below</th><th class=\"n\">above</th>\
                 <th>unit</th></tr></thead>\n\
                 <tbody>{}</tbody></table></div>\n<p class=\"caption\">Below and above: changes that all parameters \
                 make together, added by squares as for independent parameters and small changes.</p>\n",
                lines.collect::<String>()
            ),
        );
        for (number, (figure, _)) in known.enumerate() {
            // What no parameter changes needs no picture.
            if figure.effects.iter().all(|effect| effect.spread() == 0.0) {
                continue;
            }
            let heading = match self.figures.iter().any(|figure| figure.pantograph > 1) {
                true => format!("{}, pantograph {}", figure.figure, figure.pantograph),
                false => figure.figure.to_owned(),
            };
            let lines = figure.effects.iter().map(|effect| cells(&COLUMNS, effect));
            let table = saved(&format!("effects-{}", number + 1), &heads(&COLUMNS), lines);
            page.section(&heading, &(bars(figure, &format!("effects-{}", number + 1)) + &table));
        }
        if !self.failed.is_empty() {
            let items: String = self
                .failed
                .iter()
                .map(|failed| format!("<li>{}</li>", escape(failed)))
                .collect();
            page.section("Runs without figures", &format!("<ul>{items}</ul>"));
        }
        page.finish()
    }
}
