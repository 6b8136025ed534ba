//! Collects the outputs of both sides and samples them on the output grid.
//!
//! Between communication points forces follow the line's samples (piecewise linear), strips the cubic through both
//! heights and velocities, everything else a straight line.

use component::exchange::{contact, strip};
use component::{Frame, Observer, Point};

use crate::{Animation, LineGeometry, Record, StripRecord, SupportRecord, WindRecord};

/// Time between two pictures of the animation, s: 25 per second.
const FRAME_STEP: f64 = 0.04;

/// Pictures of a long run are fewer per second.
const MAX_FRAMES: f64 = 500.0;

/// Part of a step within which a time of the grid counts as its end.
const ROUNDING: f64 = 1e-6;

/// Turns communication points into a [`Record`].
#[derive(Clone, Debug)]
pub struct Recorder {
    output_step: f64,
    rows: usize,
    record: Record,
    frame_step: f64,
    frames: usize,
}

impl Recorder {
    /// Records `strips` pantographs with one strip each and the `supports` with these numbers (from 1) every
    /// `output_step` s from 0 to `duration` s.
    #[must_use]
    pub fn new(duration: f64, output_step: f64, strips: usize, supports: &[usize], line: LineGeometry) -> Self {
        let rows = (duration / output_step * (1.0 + f64::EPSILON) + ROUNDING).floor() as usize + 1;
        let column = || Vec::with_capacity(rows);
        let strip = || StripRecord {
            force: column(),
            contact_x: column(),
            contact_y: column(),
            wire_z: column(),
            strip_z: column(),
            strip_vz: column(),
            gap: column(),
            wind: None,
            control: None,
            aside: column(),
            strips: Vec::new(),
        };
        let record = Record {
            time: column(),
            pantographs: (0..strips).map(|_| strip()).collect(),
            supports: supports
                .iter()
                .map(|&number| SupportRecord {
                    number,
                    uplift: column(),
                })
                .collect(),
            line,
            animation: Animation { frames: Vec::new() },
        };
        Self {
            output_step,
            rows,
            record,
            frame_step: FRAME_STEP.max(duration / MAX_FRAMES),
            frames: 0,
        }
    }

    /// Recorder of values only.
    #[must_use]
    pub fn without_pictures(mut self) -> Self {
        self.frame_step = f64::INFINITY;
        // The picture at the start counts as taken.
        self.frames = 1;
        self
    }

    /// Records heads with these numbers of strips, in place of one strip on each.
    #[must_use]
    pub fn with_heads(mut self, strips: &[usize]) -> Self {
        for (pantograph, &strips) in self.record.pantographs.iter_mut().zip(strips) {
            if strips > 1 {
                pantograph.strips = (0..strips).map(|_| room(pantograph, self.rows)).collect();
            }
        }
        self
    }

    /// Records the wind on the heads of these pantographs (from 0) too.
    #[must_use]
    pub fn with_wind(mut self, pantographs: impl IntoIterator<Item = usize>) -> Self {
        let rows = self.rows;
        let wind = || WindRecord {
            drag: Vec::with_capacity(rows),
            lift: Vec::with_capacity(rows),
        };
        for index in pantographs {
            let pantograph = &mut self.record.pantographs[index];
            pantograph.wind = Some(wind());
            for strip in &mut pantograph.strips {
                strip.wind = Some(wind());
            }
        }
        self
    }

    /// Records the force of the drives of these pantographs (from 0) too.
    #[must_use]
    pub fn with_control(mut self, pantographs: impl IntoIterator<Item = usize>) -> Self {
        let rows = self.rows;
        for index in pantographs {
            self.record.pantographs[index].control = Some(Vec::with_capacity(rows));
        }
        self
    }

    /// The record.
    #[must_use]
    pub fn finish(self) -> Record {
        self.record
    }

    fn push(&mut self, time: f64, start: &Point, end: &Point, part: f64) {
        let linear = |a: f64, b: f64| if part == 1.0 { b } else { a + part * (b - a) };
        self.record.time.push(time);
        let push = |record: &mut StripRecord, i: usize| {
            let (from, to) = (start.contact(i), end.contact(i));
            let value = |index: usize| linear(from[index], to[index]);
            record.force.push(force_at(from, to, part));
            record.contact_x.push(value(contact::X));
            record.contact_y.push(value(contact::Y));
            record.wire_z.push(value(contact::WIRE_Z));
            record.gap.push(value(contact::GAP));
            let (z, vz) = strip_at(start.strip(i), end.strip(i), end.t - start.t, part);
            record.strip_z.push(z);
            record.strip_vz.push(vz);
            record.aside.push(linear(aside(start, i), aside(end, i)));
            if let Some(wind) = &mut record.wind {
                let value = |index: usize| linear(start.strip(i)[index], end.strip(i)[index]);
                wind.drag.push(value(strip::WIND_DRAG));
                wind.lift.push(value(strip::WIND_LIFT));
            }
        };
        let mut number = 0..;
        let mut first = 0;
        for pantograph in &mut self.record.pantographs {
            let strips = first..first + pantograph.strips.len().max(1);
            first = strips.end;
            if let Some(control) = &mut pantograph.control {
                let value = |i: usize| linear(start.strip(i)[strip::CONTROL], end.strip(i)[strip::CONTROL]);
                control.push(strips.map(value).sum());
            }
            if pantograph.strips.is_empty() {
                push(pantograph, number.next().unwrap_or_default());
                continue;
            }
            for (strip, i) in pantograph.strips.iter_mut().zip(&mut number) {
                push(strip, i);
            }
            pantograph.push_head();
        }
        let first = start.strip_count() * contact::COUNT;
        for (support, k) in self.record.supports.iter_mut().zip(first..) {
            support.uplift.push(linear(start.line[k], end.line[k]));
        }
    }
}

impl Observer for Recorder {
    fn start(&mut self, point: &Point) {
        self.push(0.0, point, point, 1.0);
    }

    fn step(&mut self, start: &Point, end: &Point) {
        let h = end.t - start.t;
        while self.record.time.len() < self.rows {
            let time = self.record.time.len() as f64 * self.output_step;
            if time > end.t + ROUNDING * h {
                break;
            }
            let part = (time - start.t) / h;
            self.push(time, start, end, if part > 1.0 - ROUNDING { 1.0 } else { part });
        }
    }

    fn wants_frame(&self, time: f64) -> bool {
        time >= (self.frames as f64 - ROUNDING) * self.frame_step
    }

    fn frame(&mut self, point: &Point, mut frame: Frame) {
        self.frames = (point.t / self.frame_step + ROUNDING).floor() as usize + 1;
        frame.time = point.t;
        let mut first = 0;
        for pantograph in &self.record.pantographs {
            let strips = first..first + pantograph.each_strip().len();
            first = strips.end;
            let force: f64 = strips.clone().map(|i| point.contact(i)[contact::FORCE]).sum();
            let place = strips.clone().map(|i| point.contact(i)[contact::X]);
            frame.forces.push(force);
            frame.contacts.push(place.sum::<f64>() / strips.len() as f64);
        }
        self.record.animation.frames.push(frame);
    }

    fn frames(&mut self) -> &mut [Frame] {
        &mut self.record.animation.frames
    }
}

/// An empty record like this one, with room for `rows` rows.
fn room(like: &StripRecord, rows: usize) -> StripRecord {
    let mut record = StripRecord {
        strips: Vec::new(),
        ..like.clone()
    };
    for series in record.columns_mut() {
        *series = Vec::with_capacity(rows);
    }
    record.aside = Vec::with_capacity(rows);
    record
}

/// Contact point of strip `i` along the strip from its middle, m.
fn aside(point: &Point, i: usize) -> f64 {
    let (strip, contact) = (point.strip(i), point.contact(i));
    let (sin, cos) = strip[strip::ROLL].sin_cos();
    (contact[contact::Y] - strip[strip::Y]) * cos + (contact[contact::WIRE_Z] - strip[strip::Z]) * sin
}

/// Contact force at `part` of the step: piecewise linear through the start force and the samples.
fn force_at(start: &[f64], end: &[f64], part: f64) -> f64 {
    if part == 1.0 {
        return end[contact::FORCE];
    }
    let position = part * contact::SAMPLE_COUNT as f64;
    let before = position.floor() as usize;
    let value = |j: usize| match j {
        0 => start[contact::FORCE],
        contact::SAMPLE_COUNT => end[contact::FORCE],
        j => end[contact::SAMPLES + j - 1],
    };
    let rest = position - before as f64;
    value(before) + rest * (value(before + 1) - value(before))
}

/// Height and vertical velocity of a strip at `part` of a step of `h` s: the cubic through both ends.
fn strip_at(start: &[f64], end: &[f64], h: f64, part: f64) -> (f64, f64) {
    if part == 1.0 {
        return (end[strip::Z], end[strip::VZ]);
    }
    let (z0, z1) = (start[strip::Z], end[strip::Z]);
    let (v0, v1) = (h * start[strip::VZ], h * end[strip::VZ]);
    let (d, p) = (z1 - z0, part);
    let z = z0 + p * (v0 + p * (3.0 * d - 2.0 * v0 - v1 + p * (v0 + v1 - 2.0 * d)));
    let vz = (v0 + p * (2.0 * (3.0 * d - 2.0 * v0 - v1) + 3.0 * p * (v0 + v1 - 2.0 * d))) / h;
    (z, vz)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One strip, one support: force 100 + 10 t, samples of it, z = t³, uplift = 2 t.
    fn point(t: f64, from: f64) -> Point {
        let force = |t: f64| 100.0 + 10.0 * t;
        let mut line = vec![0.0; contact::COUNT + 1];
        line[contact::FORCE] = force(t);
        for j in 1..=contact::SAMPLE_COUNT {
            line[contact::SAMPLES + j - 1] = force(from + (t - from) * j as f64 / 10.0);
        }
        line[contact::X] = 80.0 * t;
        line[contact::COUNT] = 2.0 * t;
        let mut strips = vec![0.0; strip::OUTPUTS];
        strips[strip::Z] = t * t * t;
        strips[strip::VZ] = 3.0 * t * t;
        strips[strip::WIND_DRAG] = 170.0 - 4.0 * t;
        strips[strip::WIND_LIFT] = 70.0 + 4.0 * t;
        Point { t, from, line, strips }
    }

    fn recorded(h: f64, steps: usize, duration: f64, output_step: f64) -> Record {
        let recorder = Recorder::new(duration, output_step, 1, &[3], LineGeometry::default());
        let mut recorder = recorder.with_wind([0]);
        recorder.start(&point(0.0, 0.0));
        for n in 0..steps {
            let (from, to) = (n as f64 * h, (n + 1) as f64 * h);
            recorder.step(&point(from, 0.0), &point(to, from));
        }
        recorder.finish()
    }

    #[test]
    fn steps_that_do_not_fit_the_grid_leave_no_row_out() {
        for h in [0.001, 0.0025, 0.0007, 0.02, 0.013] {
            let steps = (0.1_f64 / h - 1e-9).ceil() as usize;
            let record = recorded(h, steps, 0.1, 0.001);
            assert_eq!(record.time.len(), 101, "h = {h}");
            for (k, &t) in record.time.iter().enumerate() {
                assert_eq!(t, k as f64 * 0.001);
                let strip = &record.pantographs[0];
                assert!(
                    (strip.force[k] - (100.0 + 10.0 * t)).abs() < 1e-10,
                    "linear force, rounding"
                );
                assert!(
                    (strip.strip_z[k] - t * t * t).abs() < 1e-12,
                    "the cubic is its own interpolant"
                );
                assert!((strip.strip_vz[k] - 3.0 * t * t).abs() < 1e-11);
                assert!((strip.contact_x[k] - 80.0 * t).abs() < 1e-10);
                assert!((record.supports[0].uplift[k] - 2.0 * t).abs() < 1e-12);
                let wind = strip.wind.as_ref().unwrap();
                assert!((wind.drag[k] - (170.0 - 4.0 * t)).abs() < 1e-10);
                assert!((wind.lift[k] - (70.0 + 4.0 * t)).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn at_communication_points_the_values_are_taken_as_they_are() {
        let record = recorded(0.001, 100, 0.1, 0.001);
        assert_eq!(
            record.pantographs[0].force[37],
            point(37.0 * 0.001, 0.0).line[contact::FORCE]
        );
        assert_eq!(
            record.pantographs[0].strip_z[100],
            point(100.0 * 0.001, 0.0).strips[strip::Z]
        );
    }

    #[test]
    fn forces_follow_the_samples_and_not_the_chord() {
        let (start, mut end) = (point(0.0, 0.0), point(0.01, 0.0));
        end.line[contact::SAMPLES + 4] = 500.0;
        let mut recorder = Recorder::new(0.01, 0.0005, 1, &[], LineGeometry::default());
        recorder.start(&start);
        recorder.step(&start, &end);
        let record = recorder.finish();
        assert_eq!(record.time.len(), 21);
        assert!((record.pantographs[0].force[10] - 500.0).abs() < 1e-9);
        let before = end.line[contact::SAMPLES + 3];
        assert!((record.pantographs[0].force[9] - 0.5 * (500.0 + before)).abs() < 1e-9);
    }

    #[test]
    fn a_run_that_ends_early_keeps_its_rows() {
        let record = recorded(0.002, 10, 0.1, 0.001);
        assert_eq!(record.time.len(), 21);
        assert_eq!(record.pantographs[0].force.len(), 21);
    }

    #[test]
    fn pictures_come_every_forty_milliseconds() {
        let mut recorder = Recorder::new(1.0, 0.001, 1, &[], LineGeometry::default());
        for n in 0..=1000 {
            let t = f64::from(n) * 0.001;
            if recorder.wants_frame(t) {
                recorder.frame(&point(t, 0.0), Frame::default());
            }
        }
        let record = recorder.finish();
        assert_eq!(record.animation.frames.len(), 26);
        assert!((record.animation.frames[1].time - 0.04).abs() < 1e-12);
        assert_eq!(record.animation.frames[0].forces, [100.0]);
        assert!((record.animation.frames[1].contacts[0] - 80.0 * 0.04).abs() < 1e-12);
    }
}
