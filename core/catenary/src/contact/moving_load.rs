//! A force that moves along a wire whose inertia is corrected for the time step.
use super::ContactGeometry;
use super::state::slide;
use crate::{Curve, CurveColumns};
use dynamics::Frame;

/// What the correction of a wire's inertia for the time step `h` asks of forces that move along the wire.
///
/// In steps of `h` the integrator has for `d²/dt²` the operator `D² (1 − ε D²)`, `ε = κ h²`, `D` the time derivative, to this order. The
/// corrected mass `M − ε K` makes of the equation of a wire under the nodal forces `φ`, with what is of the order of `ε²` left out,
///
/// ```text
/// (M − ε K) D² (1 − ε D²) q + K q = (1 − ε D²) (M D² q + K q) = φ
/// ```
///
/// which is that of the wire where `φ` too is what `1 − ε D²` makes of the true nodal forces, as in the method of Numerov. At a node
/// that the strip runs past, the force changes fast, however slowly that of the contact does: a contact force of 20 Hz that moves at
/// two thirds of the speed of the waves sends out waves of 60 Hz. So the nodal forces of a contact force `F` at `s` are
///
/// ```text
/// N(s) F − κ (N(s + ṡh) (F + Ḟh) − 2 N(s) F + N(s − ṡh) (F − Ḟh))
/// ```
///
/// whose second part has no resultant. It is found once per step, with `F` continued in a straight line through the ends of the last
/// two: what that changes is of the order of `h⁴`, and the tangent stays as it is. (Derived here; proved by a moving force on a string.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadCorrection {
    /// `h`, s.
    pub step: f64,
    /// `κ`, –; 1/6 of the trapezoidal rule.
    pub share: f64,
}

/// The force at the end of a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reached {
    /// s; before all times where no step has ended.
    t: f64,
    /// N.
    force: f64,
}

impl Reached {
    const NOTHING: Self = Self {
        t: f64::NEG_INFINITY,
        force: 0.0,
    };
}

/// What a contact adds to the forces on its wire.
#[derive(Clone, Debug)]
pub(super) struct MovingLoad {
    /// At the ends of the last two steps, the later one first.
    reached: [Reached; 2],
    /// In the present step: coordinate and N.
    terms: Vec<(usize, f64)>,
}

impl MovingLoad {
    pub const NONE: Self = Self {
        reached: [Reached::NOTHING; 2],
        terms: Vec::new(),
    };

    /// Forgets what was.
    pub fn clear(&mut self) {
        self.reached = [Reached::NOTHING; 2];
        self.rest();
    }

    /// Force (N) and rate (N/s) at the time `t` s by those of the last steps.
    fn continued(&self, t: f64) -> (f64, f64) {
        let [last, before] = self.reached;
        if last.force == 0.0 {
            return (0.0, 0.0);
        }
        let between = last.t - before.t;
        let rate = if between > 0.0 && between.is_finite() {
            (last.force - before.force) / between
        } else {
            0.0
        };
        (last.force + rate * (t - last.t), rate)
    }

    /// Nothing is added in the present step.
    pub fn rest(&mut self) {
        self.terms.clear();
    }

    /// Finds what is added in the step that ends at `t` s, as predicted.
    pub fn begin_step(&mut self, geometry: &ContactGeometry, curve: &dyn Curve, strip: &Frame, t: f64) {
        self.rest();
        let Some(LoadCorrection { step, share }) = curve.load_correction() else {
            return;
        };
        let (force, rate) = self.continued(t);
        let way = slide(geometry, strip) * step;
        let places = [-1.0, 0.0, 1.0].map(|steps| geometry.s + steps * way);
        if force <= 0.0 || places.iter().any(|s| !(0.0..=curve.length()).contains(s)) {
            return;
        }
        let change = rate * step;
        let forces = [force - change, -2.0 * force, force + change];
        for (s, force) in places.into_iter().zip(forces) {
            let mut columns = CurveColumns::default();
            curve.columns(s, &mut columns);
            let columns = columns.as_slice().iter();
            self.terms
                .extend(columns.map(|column| (column.index, -share * force * column.n.dot(&geometry.normal))));
        }
    }

    /// Adds it.
    pub fn add_to(&self, force: &mut [f64]) {
        for &(index, term) in &self.terms {
            force[index] += term;
        }
    }

    /// Its power in the motion with the velocities `v`, W.
    pub fn power(&self, v: &[f64]) -> f64 {
        self.terms.iter().map(|&(index, term)| term * v[index]).sum()
    }

    /// Takes note of the `force` (N) at the end of a step, `t` s.
    pub fn end_step(&mut self, t: f64, force: f64) {
        self.reached = [Reached { t, force }, self.reached[0]];
    }

    pub fn save(&self, out: &mut Vec<f64>) {
        out.extend(self.reached.iter().flat_map(|reached| [reached.t, reached.force]));
    }

    pub fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut next = || {
            *values
                .next()
                .expect("a saved contact holds two numbers for each of two steps")
        };
        self.reached = [(); 2].map(|()| Reached {
            t: next(),
            force: next(),
        });
        self.terms.clear();
    }
}
