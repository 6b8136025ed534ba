//! Elevation and plan as one small SVG, for documents.

use std::fmt::Write as _;

use super::panel::{Scale, said};
use super::panels::colour;
use super::polyline::{corners, path};
use super::{LinePage, PageWireKind};
use crate::report::escape;

/// Width and height of the picture, and margins for numbers at its sides; units.
const SIZE: [i64; 2] = [2000, 760];
const LEFT: i64 = 110;
const RIGHT: i64 = 48;
/// Top and height of elevation and plan, units.
const ELEVATION: [i64; 2] = [50, 330];
const PLAN: [i64; 2] = [450, 250];

const STYLE: &str = "\
text{font:26px system-ui,sans-serif;fill:#5b6675}.n{text-anchor:end}.m{text-anchor:middle}\
path{fill:none;stroke-width:3;stroke-linejoin:round}.grid{stroke:#dde2e8;stroke-width:2}\
.mast{stroke:#c3cad3;stroke-width:2}.dropper{stroke:#8b95a3;stroke-width:2}\
.slack{stroke:#b3261e;stroke-width:5;stroke-dasharray:8 6}.strip{stroke:#8b95a3;stroke-dasharray:12 8}\
.contact{stroke-width:5}.mass{stroke:#b3261e;stroke-width:16;stroke-linecap:round}\
.t1{stroke:#1f5fa8}.t2{stroke:#c2570c}.t3{stroke:#1d7a46}.t4{stroke:#a0338a}.t5{stroke:#8a6d00}\
@media(prefers-color-scheme:dark){text{fill:#a3adba}.grid{stroke:#2c3643}.mast{stroke:#3d4957}\
.slack,.mass{stroke:#ff8a80}.t1{stroke:#6fb1ff}.t2{stroke:#ff9d57}.t3{stroke:#5fd08f}.t4{stroke:#e58ad3}\
.t5{stroke:#d9bd4a}}";

/// One of the two drawings.
struct Drawing<'a> {
    page: &'a LinePage,
    place: [i64; 2],
    scale: Scale,
    /// Coordinate of a point: 2 is the height, 1 the lateral position.
    axis: usize,
}

impl Drawing<'_> {
    fn x(&self, x: f64) -> f64 {
        let shown = self.page.shown;
        LEFT as f64 + (x - shown.from) / (shown.to - shown.from) * (SIZE[0] - LEFT - RIGHT) as f64
    }

    fn y(&self, value: f64) -> f64 {
        let [low, high] = self.scale.range;
        self.place[0] as f64 + (high - value) / (high - low) * self.place[1] as f64
    }

    fn at(&self, point: [f64; 3]) -> (f64, f64) {
        (self.x(point[0]), self.y(point[self.axis]))
    }

    /// Title, grid with numbers, masts.
    fn frame(&self, title: &str) -> String {
        let [top, height] = self.place;
        let mut svg = format!("<text x=\"8\" y=\"{}\">{title}</text>\n", top - 14);
        let ticks = self.scale.ticks(4.0);
        let step = ticks.windows(2).map(|pair| pair[1] - pair[0]).next().unwrap_or(1.0);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let mut grid = String::new();
        for tick in ticks {
            let y = self.y(tick).round();
            let _ = write!(grid, "M{LEFT} {y}H{}", SIZE[0] - RIGHT);
            let _ = writeln!(
                svg,
                "<text class=\"n\" x=\"{}\" y=\"{}\">{}</text>",
                LEFT - 14,
                y + 9.0,
                said(tick, digits)
            );
        }
        let masts = self.page.masts.iter().filter(|x| self.page.shown.contains(**x));
        let masts: String = masts
            .map(|x| format!("M{} {top}v{height}", self.x(*x).round()))
            .collect();
        let _ = writeln!(
            svg,
            "<path class=\"grid\" d=\"{grid}\"/>\n<path class=\"mast\" d=\"{masts}\"/>"
        );
        svg
    }

    fn wires(&self) -> String {
        let mut svg = String::new();
        for contact in [false, true] {
            for wire in &self.page.wires {
                if (wire.kind == PageWireKind::Contact) != contact {
                    continue;
                }
                let shown = wire.points.iter().filter(|point| self.page.shown.contains(point[0]));
                let data = path(&corners(shown.map(|point| self.at(*point)), 0.6));
                if !data.is_empty() {
                    let kind = if contact { "contact" } else { "carrying" };
                    let _ = writeln!(
                        svg,
                        "<path class=\"{kind} {}\" d=\"{data}\"/>",
                        colour(wire.tension_length)
                    );
                }
            }
        }
        svg
    }

    fn droppers(&self) -> String {
        let shown = self
            .page
            .droppers
            .iter()
            .filter(|dropper| self.page.shown.contains(dropper.bottom[0]));
        let (mut tight, mut slack) = (String::new(), String::new());
        for dropper in shown {
            let [a, b] = [dropper.top, dropper.bottom].map(|point| self.at(point));
            let into = if dropper.is_slack() { &mut slack } else { &mut tight };
            let _ = write!(into, "M{} {}L{} {}", a.0.round(), a.1.round(), b.0.round(), b.1.round());
        }
        format!("<path class=\"dropper\" d=\"{tight}\"/>\n<path class=\"slack\" d=\"{slack}\"/>\n")
    }
}

impl LinePage {
    /// Elevation and plan as one SVG, without scripts and fit for light and dark pages.
    #[must_use]
    pub fn picture(&self) -> String {
        let points = self.wires.iter().flat_map(|wire| &wire.points);
        let points = points.filter(|point| self.shown.contains(point[0]));
        let elevation = Drawing {
            page: self,
            place: ELEVATION,
            scale: Scale::of(points.clone().map(|point| point[2]), 0.5, 1.0, 0),
            axis: 2,
        };
        let strips = self.half_widths.iter().flat_map(|half| [-half, *half]);
        let plan = Drawing {
            page: self,
            place: PLAN,
            scale: Scale::of(points.map(|point| point[1]).chain(strips.clone()), 0.1, 1.0, 0),
            axis: 1,
        };
        let edges: String = strips
            .map(|y| format!("M{LEFT} {}H{}", plan.y(y).round(), SIZE[0] - RIGHT))
            .collect();
        let masses = self.masses.iter().filter(|mass| self.shown.contains(mass.at[0]));
        let masses: String = masses
            .map(|mass| elevation.at(mass.at))
            .map(|(x, y)| format!("M{} {}h0", x.round(), y.round()))
            .collect();
        let mut axis = String::new();
        let masts: Vec<f64> = self.masts.iter().copied().filter(|x| self.shown.contains(*x)).collect();
        // About a dozen numbers have room.
        for x in masts.iter().step_by(masts.len().div_ceil(12).max(1)) {
            let _ = writeln!(
                axis,
                "<text class=\"m\" x=\"{}\" y=\"{}\">{}</text>",
                plan.x(*x).round(),
                PLAN[0] + PLAN[1] + 34,
                said(*x, 0)
            );
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\">\n<title>{}</title>\n\
             <style>{STYLE}</style>\n{}{}{}<path class=\"mass\" d=\"{masses}\"/>\n{}\
             <path class=\"strip\" d=\"{edges}\"/>\n{}{axis}</svg>\n",
            SIZE[0],
            SIZE[1],
            escape(&self.title),
            elevation.frame("height above rail, m"),
            elevation.droppers(),
            elevation.wires(),
            plan.frame("left of the track centre, m; dashed: ends of the strip; below: m along the track"),
            plan.wires()
        )
    }
}
