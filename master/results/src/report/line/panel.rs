//! One panel over the track.

use std::fmt::Write as _;

use super::polyline::{corners, path};
use super::{LinePage, PageRange};
use crate::report::escape;

/// Units of a drawing per metre along the track.
const PER_METRE: f64 = 100.0;

/// Scale of a panel: values go up, the units of the drawing are whole numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Least and largest value.
    pub range: [f64; 2],
    /// Units of the drawing per unit of the value.
    pub per: f64,
    /// Digits of a value for reading.
    pub digits: usize,
}

impl Scale {
    /// Scale that shows all `values`, and a tenth of their range beyond; at least `least` is shown.
    pub fn of(values: impl IntoIterator<Item = f64>, least: f64, per: f64, digits: usize) -> Self {
        let (low, high) = values
            .into_iter()
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let more = (0.5 * (least - (high - low))).max(0.1 * (high - low));
        Self {
            range: [low - more, high + more],
            per,
            digits,
        }
    }

    /// The same scale with zero on it.
    pub fn with_zero(self) -> Self {
        Self {
            range: [self.range[0].min(0.0), self.range[1]],
            ..self
        }
    }

    /// The same scale with `share` of its range more at the top.
    pub fn with_room_above(self, share: f64) -> Self {
        let [low, high] = self.range;
        Self {
            range: [low, high + share * (high - low)],
            ..self
        }
    }

    fn height(&self) -> i64 {
        ((self.range[1] - self.range[0]) * self.per).round().max(1.0) as i64
    }

    /// Whole unit of a value, downwards from the top.
    fn y(&self, value: f64) -> f64 {
        (self.range[1] - value) * self.per
    }

    /// Share of the height at which a value stands, from the top, %.
    fn percent(&self, value: f64) -> f64 {
        100.0 * (self.range[1] - value) / (self.range[1] - self.range[0])
    }

    /// Values of grid lines: about `count` multiples of 1, 2 or 5 and a power of ten.
    pub fn ticks(&self, count: f64) -> Vec<f64> {
        let wanted = (self.range[1] - self.range[0]) / count;
        let power = 10_f64.powf(wanted.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|digit| digit * power)
            .into_iter()
            .find(|step| *step >= wanted);
        let step = step.unwrap_or(10.0 * power);
        let (from, to) = (
            (self.range[0] / step).ceil() as i64,
            (self.range[1] / step).floor() as i64,
        );
        (from..=to).map(|number| number as f64 * step).collect()
    }
}

/// A value for reading, with the sign of minus of print.
pub(super) fn said(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().any(|byte| byte.is_ascii_digit() && byte != b'0') => format!("−{rest}"),
        Some(rest) => rest.to_owned(),
        None => text,
    }
}

/// A panel that is being drawn.
pub(super) struct Panel {
    id: &'static str,
    title: &'static str,
    unit: &'static str,
    height: u32,
    range: PageRange,
    scale: Scale,
    shapes: String,
    labels: String,
}

impl Panel {
    /// An empty panel of `height` (CSS pixels) with masts and evaluated spans.
    pub fn new(page: &LinePage, [id, title, unit]: [&'static str; 3], height: u32, scale: Scale) -> Self {
        let mut panel = Self {
            id,
            title,
            unit,
            height,
            range: page.shown,
            scale,
            shapes: String::new(),
            labels: String::new(),
        };
        let high = scale.height();
        let [from, to] = [page.evaluated.from, page.evaluated.to].map(|x| panel.x(x).round());
        let _ = writeln!(
            panel.shapes,
            "<path class=\"evaluated\" d=\"M{from} 0H{to}V{high}H{from}z\"/>"
        );
        let width = panel.x(page.shown.to).round();
        let grid: String = scale
            .ticks(f64::from(height) / 44.0)
            .iter()
            .map(|tick| format!("M0 {}H{width}", scale.y(*tick).round()))
            .collect();
        let _ = writeln!(panel.shapes, "<path class=\"grid\" d=\"{grid}\"/>");
        let masts = page.masts.iter().filter(|x| page.shown.contains(**x));
        let masts: String = masts.map(|x| format!("M{} 0V{high}", panel.x(*x).round())).collect();
        let _ = writeln!(panel.shapes, "<path class=\"mast\" d=\"{masts}\"/>");
        panel
    }

    fn x(&self, x: f64) -> f64 {
        (x - self.range.from) * PER_METRE
    }

    /// Curve through `points` (m, value), within `tolerance` (units of the drawing) of them, in so many pieces; a
    /// named one is read under the pointer.
    pub fn curve<'a>(
        &mut self,
        class: &str,
        name: &str,
        tolerance: f64,
        pieces: impl IntoIterator<Item = &'a [(f64, f64)]>,
    ) {
        let (scale, range) = (self.scale, self.range);
        let mut data = String::new();
        for piece in pieces {
            let shown = piece.iter().filter(|(x, _)| range.contains(*x));
            let units = shown.map(|(x, value)| (self.x(*x), scale.y(*value)));
            data.push_str(&path(&corners(units, tolerance)));
        }
        self.shape(class, name, &data);
    }

    /// Straight lines between two places each (m, value).
    pub fn lines(&mut self, class: &str, lines: impl IntoIterator<Item = [(f64, f64); 2]>) {
        let mut data = String::new();
        for [a, b] in lines {
            if self.range.contains(a.0) && self.range.contains(b.0) {
                let [(x, y), (to_x, to_y)] = [a, b].map(|(x, value)| (self.x(x).round(), self.scale.y(value).round()));
                let _ = match x == to_x {
                    true => write!(data, "M{x} {y}V{to_y}"),
                    false => write!(data, "M{x} {y}L{to_x} {to_y}"),
                };
            }
        }
        self.shape(class, "", &data);
    }

    /// Bars from zero to each place (m, value); read under the pointer by this name.
    pub fn bars(&mut self, class: &str, name: &str, places: impl IntoIterator<Item = (f64, f64)>) {
        let zero = self.scale.y(0.0).round();
        let mut data = String::new();
        for (x, value) in places.into_iter().filter(|(x, _)| self.range.contains(*x)) {
            let _ = write!(data, "M{} {zero}V{}", self.x(x).round(), self.scale.y(value).round());
        }
        self.shape(class, name, &data);
    }

    /// Dots at places (m, value).
    pub fn dots(&mut self, class: &str, places: impl IntoIterator<Item = (f64, f64)>) {
        let mut data = String::new();
        for (x, value) in places.into_iter().filter(|(x, _)| self.range.contains(*x)) {
            let _ = write!(data, "M{} {}h0", self.x(x).round(), self.scale.y(value).round());
        }
        self.shape(class, "", &data);
    }

    fn shape(&mut self, class: &str, name: &str, data: &str) {
        if data.is_empty() {
            return;
        }
        let name = match name {
            "" => String::new(),
            name => format!(" data-name=\"{}\"", escape(name)),
        };
        let _ = writeln!(self.shapes, "<path class=\"{class}\"{name} d=\"{data}\"/>");
    }

    /// Text at a place (m, value); of texts that would overlap the page shows the first.
    pub fn label(&mut self, class: &str, (x, value): (f64, f64), text: &str) {
        if self.range.contains(x) {
            let left = 100.0 * (x - self.range.from) / (self.range.to - self.range.from);
            let top = self.scale.percent(value);
            let _ = writeln!(
                self.labels,
                "<span class=\"{class}\" style=\"left:{left:.2}%;top:{top:.1}%\">{}</span>",
                escape(text)
            );
        }
    }

    /// The panel as HTML.
    pub fn finish(self) -> String {
        let scale = self.scale;
        let ticks = scale.ticks(f64::from(self.height) / 44.0);
        let step = ticks.windows(2).map(|pair| pair[1] - pair[0]).next().unwrap_or(1.0);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let ticks: String = ticks
            .iter()
            .map(|tick| {
                format!(
                    "<span style=\"top:{:.1}%\">{}</span>",
                    scale.percent(*tick),
                    said(*tick, digits)
                )
            })
            .collect();
        let width = self.x(self.range.to).round();
        format!(
            "<figure class=\"panel\" id=\"panel-{}\" data-top=\"{}\" data-per=\"{}\" data-digits=\"{}\">\n\
             <figcaption><b>{}</b> <span>{}</span> <output></output></figcaption>\n\
             <div class=\"box\" style=\"height:{}px\">\n<div class=\"ticks\">{ticks}</div>\n\
             <svg viewBox=\"0 0 {width} {}\" preserveAspectRatio=\"none\" role=\"img\" \
             aria-label=\"{}, {}\">\n{}</svg>\n\
             <div class=\"labels\">\n{}</div>\n</div>\n</figure>\n",
            self.id,
            scale.range[1],
            scale.per,
            scale.digits,
            self.title,
            self.unit,
            self.height,
            scale.height(),
            self.title,
            self.unit,
            self.shapes,
            self.labels
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_lines_are_round_and_few() {
        let ticks = |low: f64, high: f64| {
            Scale {
                range: [low, high],
                per: 1.0,
                digits: 0,
            }
            .ticks(4.0)
        };
        assert_eq!(ticks(-0.3, 0.33), [-0.2, 0.0, 0.2]);
        assert_eq!(ticks(0.0, 200.0), [0.0, 50.0, 100.0, 150.0, 200.0]);
    }

    #[test]
    fn a_value_that_rounds_to_zero_has_no_sign() {
        assert_eq!([said(-0.001, 2), said(-1.5, 1)], ["0.00", "−1.5"]);
    }
}
