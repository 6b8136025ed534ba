//! Page of a line at rest: elevation, plan, droppers, supports, elasticity, gradients.

use plotly::Scatter;
use plotly::common::{DashType, Line, Mode};

use super::plots::{COLOURS, axis, finished, layout, rounded};
use super::{Page, escape, head_cells, remarks};
use crate::Model;
use crate::standards::gradient_limit;

/// A line at rest, to be drawn and tabled.
#[derive(Clone, Debug, Default)]
pub struct LinePage {
    /// Title of the scene.
    pub title: String,
    /// Name of the scene.
    pub scene: String,
    /// Running speed, km/h.
    pub speed_kmh: f64,
    /// Wires.
    pub wires: Vec<PageWire>,
    /// Droppers.
    pub droppers: Vec<PageDropper>,
    /// Supports of each tension length in turn.
    pub supports: Vec<PageSupport>,
    /// Elasticity: place along the track in m, rise in m/N.
    pub elasticity: Vec<(f64, f64)>,
    /// Spans with elasticity.
    pub spans: Vec<PageSpan>,
    /// Half the width of the strips, m.
    pub half_widths: Vec<f64>,
    /// Tensions in words, with their values in N.
    pub tensions: Vec<(String, f64)>,
    /// The model.
    pub model: Model,
    /// Remarks.
    pub notes: Vec<String>,
}

/// A wire at rest.
#[derive(Clone, Debug)]
pub struct PageWire {
    /// Name of the wire.
    pub name: String,
    /// True for a wire that strips touch.
    pub contact: bool,
    /// Points along the wire, m.
    pub points: Vec<[f64; 3]>,
}

/// A dropper at rest.
#[derive(Clone, Debug)]
pub struct PageDropper {
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Span of the tension length, from 1.
    pub span: usize,
    /// Number within the span, from 1.
    pub number: usize,
    /// Distance from the left support, m.
    pub position: f64,
    /// Wire from which the dropper hangs.
    pub hangs_from: &'static str,
    /// Upper end, m.
    pub top: [f64; 3],
    /// Lower end, m.
    pub bottom: [f64; 3],
    /// Unstressed length, m.
    pub length: f64,
    /// Tension, N.
    pub force: f64,
}

/// A support of a tension length.
#[derive(Clone, Debug)]
pub struct PageSupport {
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Number within the tension length, from 1.
    pub number: usize,
    /// m.
    pub x: f64,
    /// Height of the contact wire, m.
    pub height: f64,
    /// Height of the messenger wire above it, m; none of a single wire.
    pub encumbrance: Option<f64>,
    /// Lateral position of the contact wire, m.
    pub stagger: f64,
    /// Force on the messenger wire, N, upwards.
    pub messenger_reaction: f64,
    /// Force on the contact wire, N, upwards.
    pub arm_force: f64,
    /// Slope of the chord to the next support, –; none at the last one, and where no strip is on the wire.
    pub gradient: Option<f64>,
    /// Change of that slope at this support, –.
    pub change: Option<f64>,
}

/// Elasticity of a span.
#[derive(Clone, Copy, Debug)]
pub struct PageSpan {
    /// Number, from 1.
    pub number: usize,
    /// Smallest rise, m/N.
    pub least: f64,
    /// Largest rise, m/N.
    pub most: f64,
    /// Non-uniformity, –.
    pub non_uniformity: f64,
}

impl LinePage {
    /// The page.
    #[must_use]
    pub fn render(&self) -> String {
        let mut page = Page::new(&self.title);
        page.lead(&format!(
            "<p><b>{}</b> · line at rest · {:.0} km/h</p>\n",
            escape(&self.scene),
            self.speed_kmh
        ));
        page.section("", &remarks(&self.notes));
        page.section("Elevation", &self.elevation());
        page.section("Plan", &self.plan());
        page.section("Supports", &self.supports_table());
        page.section("Droppers", &(self.dropper_forces() + &self.droppers_table()));
        page.section("Elasticity", &(self.elasticity_plot() + &self.spans_table()));
        page.section("Tensions", &self.tensions_table());
        page.section("What will be modelled", &self.model_table());
        page.finish()
    }

    /// Droppers for the workshop.
    #[must_use]
    pub fn droppers_csv(&self) -> String {
        let mut text = "tension_length,span,dropper,position_m,hangs_from,x_m,unstressed_length_m,force_N\n".to_owned();
        for dropper in &self.droppers {
            text.push_str(&format!(
                "{},{},{},{:.3},{},{:.3},{:.4},{:.1}\n",
                dropper.tension_length,
                dropper.span,
                dropper.number,
                dropper.position,
                dropper.hangs_from,
                dropper.bottom[0],
                dropper.length,
                dropper.force
            ));
        }
        text
    }

    /// Supports, as a table.
    #[must_use]
    pub fn supports_csv(&self) -> String {
        let optional = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.5}"));
        let mut text = "tension_length,support,x_m,contact_wire_height_m,encumbrance_m,stagger_m,\
                        messenger_reaction_N,arm_force_N,gradient,gradient_change\n"
            .to_owned();
        for support in &self.supports {
            text.push_str(&format!(
                "{},{},{:.3},{:.4},{},{:.3},{:.1},{:.1},{},{}\n",
                support.tension_length,
                support.number,
                support.x,
                support.height,
                optional(support.encumbrance),
                support.stagger,
                support.messenger_reaction,
                support.arm_force,
                optional(support.gradient),
                optional(support.change)
            ));
        }
        text
    }

    fn curve(wire: &PageWire, axis: usize, per: f64) -> Box<Scatter<f64, f64>> {
        let along = wire.points.iter().map(|point| point[0]).collect::<Vec<_>>();
        let across = wire.points.iter().map(|point| point[axis]).collect::<Vec<_>>();
        let (colour, width) = if wire.contact {
            (COLOURS[0], 2.0)
        } else {
            ("#5b6675", 1.4)
        };
        Scatter::new(rounded(&along, 1e2), rounded(&across, per))
            .mode(Mode::Lines)
            .name(&wire.name)
            .show_legend(false)
            .line(Line::new().color(colour).width(width))
    }

    /// Heights against the track, 30 m to a screen's width where one looks closely.
    fn elevation(&self) -> String {
        let mut traces: Vec<Box<Scatter<f64, f64>>> = Vec::new();
        // One curve for all droppers, broken between them.
        let (mut x, mut z) = (Vec::new(), Vec::new());
        for dropper in &self.droppers {
            x.extend([dropper.top[0], dropper.bottom[0], f64::NAN]);
            z.extend([dropper.top[2], dropper.bottom[2], f64::NAN]);
        }
        if !x.is_empty() {
            let droppers = Scatter::new(rounded(&x, 1e2), rounded(&z, 1e3))
                .mode(Mode::Lines)
                .name("droppers");
            traces.push(
                droppers
                    .line(Line::new().color("#8b95a3").width(1.0))
                    .show_legend(false),
            );
        }
        traces.extend(self.wires.iter().map(|wire| Self::curve(wire, 2, 1e3)));
        let x = self.supports.iter().map(|support| support.x).collect();
        let z = self.supports.iter().map(|support| support.height).collect();
        let supports = Scatter::new(x, z)
            .mode(Mode::Markers)
            .name("supports")
            .show_legend(false);
        traces.push(supports.marker(plotly::common::Marker::new().color(COLOURS[1]).size(6)));
        finished(
            traces,
            layout(axis("position along the track (m)"), axis("height above rail (m)")),
            "elevation",
            360,
        )
    }

    /// Lateral positions against the track.
    fn plan(&self) -> String {
        let mut traces: Vec<Box<Scatter<f64, f64>>> = self.wires.iter().map(|wire| Self::curve(wire, 1, 1e4)).collect();
        let ends = self
            .wires
            .iter()
            .flat_map(|wire| wire.points.first().into_iter().chain(wire.points.last()));
        let (from, to) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), point| {
            (from.min(point[0]), to.max(point[0]))
        });
        for &half in &self.half_widths {
            for side in [half, -half] {
                let edge = Scatter::new(vec![from, to], vec![side, side]).mode(Mode::Lines);
                let edge = edge.name("end of the strip").show_legend(false);
                traces.push(edge.line(Line::new().color(COLOURS[2]).width(1.0).dash(DashType::Dash)));
            }
        }
        finished(
            traces,
            layout(
                axis("position along the track (m)"),
                axis("left of the track centre (m)"),
            ),
            "plan",
            300,
        )
    }

    fn dropper_forces(&self) -> String {
        if self.droppers.is_empty() {
            return "<p>The line has no droppers.</p>\n".to_owned();
        }
        let x: Vec<f64> = self.droppers.iter().map(|dropper| dropper.bottom[0]).collect();
        let force: Vec<f64> = self.droppers.iter().map(|dropper| dropper.force).collect();
        let points = Scatter::new(rounded(&x, 1e2), rounded(&force, 1e2))
            .mode(Mode::Markers)
            .name("force");
        let points = points
            .marker(plotly::common::Marker::new().color(COLOURS[0]).size(5))
            .show_legend(false);
        finished(
            [points],
            layout(axis("position along the track (m)"), axis("force of the dropper (N)")),
            "dropper-forces",
            260,
        )
    }

    fn elasticity_plot(&self) -> String {
        if self.elasticity.is_empty() {
            return String::new();
        }
        let x: Vec<f64> = self.elasticity.iter().map(|(x, _)| *x).collect();
        let rise: Vec<f64> = self.elasticity.iter().map(|(_, rise)| 1e3 * rise).collect();
        let curve = Scatter::new(rounded(&x, 1e2), rounded(&rise, 1e4))
            .mode(Mode::LinesMarkers)
            .name("elasticity");
        let curve = curve.line(Line::new().color(COLOURS[0]).width(1.4)).show_legend(false);
        finished(
            [curve],
            layout(axis("position along the track (m)"), axis("rise under 100 N (mm/N)")),
            "elasticity",
            260,
        )
    }

    fn supports_table(&self) -> String {
        let (most, most_change) = gradient_limit(self.speed_kmh);
        let several = self.supports.iter().any(|support| support.tension_length > 1);
        let mut columns = vec![
            ("support", "", true),
            ("x", "m", true),
            ("height", "m", true),
            ("encumbrance", "m", true),
            ("stagger", "m", true),
            ("messenger force", "N", true),
            ("arm force", "N", true),
            ("gradient", "‰", true),
            ("change", "‰", true),
        ];
        if several {
            columns.insert(0, ("tension length", "", true));
        }
        let mut rows = String::new();
        let graded = |value: Option<f64>, limit: f64| match value {
            None => "–".to_owned(),
            Some(value) if value.abs() > limit + 1e-6 => {
                format!("<span class=\"badge bad\">{:.2}</span>", 1e3 * value)
            }
            Some(value) => format!("{:.2}", 1e3 * value),
        };
        for support in &self.supports {
            rows.push_str("<tr>");
            if several {
                rows.push_str(&format!("<td class=\"n\">{}</td>", support.tension_length));
            }
            let encumbrance = support
                .encumbrance
                .map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
            rows.push_str(&format!(
                "<td class=\"n\">{}</td><td class=\"n\">{:.2}</td><td class=\"n\">{:.3}</td><td class=\"n\">{}</td>\
                 <td class=\"n\">{:.3}</td><td class=\"n\">{:.0}</td><td class=\"n\">{:.0}</td>\
                 <td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                support.number,
                support.x,
                support.height,
                encumbrance,
                support.stagger,
                support.messenger_reaction,
                support.arm_force,
                graded(support.gradient, most),
                graded(support.change, most_change)
            ));
        }
        format!(
            "{}<p>Gradients are those of the chords between supports on which strips run. At {:.0} km/h EN 50119 \
             allows {:.2} ‰ and changes of {:.2} ‰ [R, remembered and not verified].</p>\n",
            table(&columns, &rows),
            self.speed_kmh,
            1e3 * most,
            1e3 * most_change
        )
    }

    fn droppers_table(&self) -> String {
        if self.droppers.is_empty() {
            return String::new();
        }
        let columns = [
            ("tension length", "", true),
            ("span", "", true),
            ("dropper", "", true),
            ("from the left support", "m", true),
            ("hangs from", "", false),
            ("unstressed length", "m", true),
            ("force", "N", true),
        ];
        let mut rows = String::new();
        for dropper in &self.droppers {
            rows.push_str(&format!(
                "<tr><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{:.3}</td>\
                 <td>{}</td><td class=\"n\">{:.4}</td><td class=\"n\">{:.1}</td></tr>\n",
                dropper.tension_length,
                dropper.span,
                dropper.number,
                dropper.position,
                dropper.hangs_from,
                dropper.length,
                dropper.force
            ));
        }
        let count = self.droppers.len();
        format!(
            "<details><summary>{count} droppers, also in droppers.csv</summary>\n{}</details>\n",
            table(&columns, &rows)
        )
    }

    fn spans_table(&self) -> String {
        let columns = [
            ("span", "", true),
            ("least", "mm/N", true),
            ("most", "mm/N", true),
            ("non-uniformity u", "%", true),
        ];
        let mut rows = String::new();
        for span in &self.spans {
            rows.push_str(&format!(
                "<tr><td class=\"n\">{}</td><td class=\"n\">{:.4}</td><td class=\"n\">{:.4}</td>\
                 <td class=\"n\">{:.1}</td></tr>\n",
                span.number,
                1e3 * span.least,
                1e3 * span.most,
                100.0 * span.non_uniformity
            ));
        }
        if rows.is_empty() {
            return String::new();
        }
        table(&columns, &rows) + "<p>u = (most − least)/(most + least) over the evaluated spans.</p>\n"
    }

    fn tensions_table(&self) -> String {
        let mut rows = String::new();
        for (name, tension) in &self.tensions {
            rows.push_str(&format!(
                "<tr><td>{}</td><td class=\"n\">{tension:.1}</td></tr>\n",
                escape(name)
            ));
        }
        table(
            &[("wire", "", false), ("horizontal tension at the last end", "N", true)],
            &rows,
        )
    }

    fn model_table(&self) -> String {
        let mut rows = String::new();
        for part in &self.model.parts {
            rows.push_str(&format!(
                "<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                escape(&part.part),
                if part.modelled { "yes" } else { "no" },
                escape(&part.reason)
            ));
        }
        table(
            &[("part", "", false), ("modelled", "", false), ("why, or how", "", false)],
            &rows,
        )
    }
}

fn table(columns: &[(&str, &str, bool)], rows: &str) -> String {
    format!(
        "<table><thead><tr>{}</tr></thead><tbody>\n{rows}</tbody></table>\n",
        head_cells(columns.iter().copied())
    )
}
