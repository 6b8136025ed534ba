//! A point of a line in its modes under a strip.
use super::curve::Place;
use super::modes::Modes;
use crate::{CurveColumns, WireCurve};
use dynamics::modal::StepFactors;
use dynamics::modal::kernels::{self, Passing};
use pulp::Arch;
use std::sync::Arc;

/// Modes at a place of the wire: `φₖ` and `∂φₖ/∂s`.
#[derive(Default)]
struct Shapes {
    /// Parameter on the wire, m; not a number where none is known.
    s: f64,
    at: Vec<f32>,
    slope: Vec<f32>,
}

/// A point under a strip.
pub(super) struct ContactPoint {
    pub coordinate: usize,
    wire: Arc<dyn WireCurve>,
    /// Zeros, one for each coordinate of the wire.
    rest: Arc<[f64]>,
    place: Place,
    /// Columns of the wire at the point.
    pub columns: CurveColumns,
    /// True for a strip under the wire.
    pub on: bool,
    /// Parameter on the wire at the end of the last step and in the present one, m.
    pub s: [f64; 2],
    /// Place along the track, m.
    pub x: f64,
    /// Modes at the ends of the present step.
    shapes: [Shapes; 2],
    /// Amplitudes at the end of the step and their rates by a unit force there, with the move of the point.
    pub by_force: [Vec<f32>; 2],
    /// Amplitudes at the end of the step by a unit force there that does not move: those that it feels of others.
    pub fixed: Vec<f32>,
}

impl ContactPoint {
    /// A point of `wire` with its coordinate.
    pub fn new(coordinate: usize, wire: Arc<dyn WireCurve>, rest: Arc<[f64]>, place: Place) -> Self {
        Self {
            coordinate,
            wire,
            rest,
            place,
            x: f64::NAN,
            columns: CurveColumns::default(),
            on: false,
            s: [f64::NAN; 2],
            shapes: Default::default(),
            by_force: Default::default(),
            fixed: Vec::new(),
        }
    }

    /// Makes room for `count` modes.
    pub fn take_room(&mut self, count: usize) {
        for shapes in &mut self.shapes {
            (shapes.s, shapes.at, shapes.slope) = (f64::NAN, vec![0.0; count], vec![0.0; count]);
        }
        self.by_force = [vec![0.0; count], vec![0.0; count]];
        self.fixed = vec![0.0; count];
    }

    /// `φₖ` of all modes at the end of the step.
    pub fn shape(&self) -> &[f32] {
        &self.shapes[1].at
    }

    /// `∂φₖ/∂s` there.
    pub fn slope(&self) -> &[f32] {
        &self.shapes[1].slope
    }

    /// Way along the wire in the step, m; not a number where the strip was not under the wire at both ends.
    pub fn moved(&self) -> f64 {
        self.s[1] - self.s[0]
    }

    /// Goes to the place that the contact expects at the end of the step.
    pub fn expect(&mut self, modes: (Arch, &Modes)) {
        let s = self.place.get();
        self.on = s.is_finite();
        self.s[1] = s;
        self.shapes.swap(0, 1);
        let before = self.s[0];
        if before.is_finite() && self.shapes[0].s.to_bits() != before.to_bits() {
            self.find(0, before, modes);
        }
        self.find(1, s, modes);
        if self.on {
            self.x = self.wire.point(s, &self.rest, &self.rest).r.x;
        }
    }

    /// Modes at `s`, of the begin (0) or the end (1) of the step.
    fn find(&mut self, end: usize, s: f64, (arch, modes): (Arch, &Modes)) {
        self.columns.clear();
        if s.is_finite() {
            self.wire.columns(s, &mut self.columns);
        }
        let mut rows = [([0.0; 2], &[][..]); CurveColumns::CAPACITY];
        let mut count = 0;
        for column in self.columns.as_slice() {
            if let Some(row) = modes.at(column.index) {
                rows[count] = ([column.n.z, column.n_s.z].map(|weight| weight as f32), row);
                count += 1;
            }
        }
        let shapes = &mut self.shapes[end];
        shapes.s = s;
        kernels::shape(arch, &rows[..count], &mut shapes.at, &mut shapes.slope);
    }

    /// Answers of all modes to the force at a point under a strip, in a step; its begin with `force` N joins the motion
    /// without a force at the end, `free`.
    pub fn answer(&mut self, (arch, factors): (Arch, &StepFactors), force: f64, free: [&mut [f32]; 2]) {
        let (moved, h) = (self.moved(), factors.h);
        let [before, now] = &self.shapes;
        // A point that comes to the wire in the step, or a step to rest, is without a move.
        let (before, along, per_step) = if moved.is_finite() && h > 0.0 {
            (before, moved / (h * h), 1.0 / (h * h))
        } else {
            (now, 0.0, 0.0)
        };
        kernels::products(arch, &now.at, &factors.q1, &mut self.fixed);
        let passing = Passing {
            shapes: [&before.at, &before.slope, &now.at, &now.slope],
            rates: [along, per_step].map(|rate| rate as f32),
            force: force as f32,
        };
        let [q, v] = &mut self.by_force;
        kernels::pass(arch, factors, passing, [q, v], free);
    }
}
