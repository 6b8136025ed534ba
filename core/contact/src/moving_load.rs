//! A force that moves along a wire whose inertia is corrected for the time step.
use super::ContactGeometry;
use super::state::slide;
use dynamics::Frame;
use dynamics::unilateral::next_of;
use wire::{CurveColumns, LoadCorrection, WireCurve};

/// Fraction of the time step of the correction: the rate between two forces closer than this is lost in rounding.
const APART: f64 = 1e-3;

/// The force at the end of a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reached {
    /// Time, s; minus infinity before the first step has ended.
    t: f64,
    /// Contact force, N.
    force: f64,
}

impl Reached {
    const NOTHING: Self = Self {
        t: f64::NEG_INFINITY,
        force: 0.0,
    };
}

/// Correction that a contact adds to the forces on its wire.
#[derive(Clone, Debug)]
pub(super) struct MovingLoad {
    /// Forces at the ends of the last two steps, the later one first; of two closer than [`APART`] the first one is
    /// dropped.
    reached: [Reached; 2],
    /// `h` of the correction, s.
    step: f64,
    /// Terms of the present step: coordinate and N.
    terms: Vec<(usize, f64)>,
}

impl MovingLoad {
    pub const NONE: Self = Self {
        reached: [Reached::NOTHING; 2],
        step: 0.0,
        terms: Vec::new(),
    };

    /// Forgets the forces of earlier steps.
    pub fn forget(&mut self) {
        self.reached = [Reached::NOTHING; 2];
        self.clear_terms();
    }

    /// Force (N) and rate (N/s) at the time `t` s, continued from the last steps.
    fn continued(&self, t: f64) -> (f64, f64) {
        let [last, before] = self.reached;
        if last.force == 0.0 {
            return (0.0, 0.0);
        }
        let between = last.t - before.t;
        // No rate across a closing, where a straight line predicts nothing.
        let rate = if before.force > 0.0 && between > 0.0 {
            (last.force - before.force) / between
        } else {
            0.0
        };
        (last.force + rate * (t - last.t), rate)
    }

    /// Clears the terms of the present step.
    pub fn clear_terms(&mut self) {
        self.terms.clear();
    }

    /// Finds the terms of the step that ends at `t` s, as predicted.
    pub fn begin_step(&mut self, geometry: &ContactGeometry, curve: &dyn WireCurve, strip: &Frame, t: f64) {
        self.clear_terms();
        let Some(LoadCorrection { step, kappa }) = curve.load_correction() else {
            return;
        };
        self.step = step;
        let (force, rate) = self.continued(t);
        let way = slide(geometry, strip) * step;
        let places = [-1.0, 0.0, 1.0].map(|steps| geometry.s + steps * way);
        if force <= 0.0 || places.iter().any(|s| !(0.0..=curve.length()).contains(s)) {
            return;
        }
        let change = rate * step;
        let forces = [force - change, -2.0 * force, force + change];
        let mut columns = CurveColumns::default();
        for (s, force) in places.into_iter().zip(forces) {
            columns.clear();
            curve.columns(s, &mut columns);
            let columns = columns.as_slice().iter();
            self.terms
                .extend(columns.map(|column| (column.index, -kappa * force * column.n.dot(&geometry.normal))));
        }
    }

    /// Adds the terms of the present step.
    pub fn add_to(&self, force: &mut [f64]) {
        for &(index, term) in &self.terms {
            force[index] += term;
        }
    }

    /// Power of the terms in the motion with the velocities `v`, W.
    pub fn power(&self, v: &[f64]) -> f64 {
        self.terms.iter().map(|&(index, term)| term * v[index]).sum()
    }

    /// Records the `force` (N) at the end of a step, `t` s.
    pub fn end_step(&mut self, t: f64, force: f64) {
        let [last, before] = self.reached;
        let close = t - last.t < APART * self.step && last.t - before.t < 2.0 * self.step;
        self.reached = [Reached { t, force }, if close { before } else { last }];
    }

    pub fn save(&self, out: &mut Vec<f64>) {
        out.extend(self.reached.iter().flat_map(|reached| [reached.t, reached.force]));
    }

    pub fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut next = || next_of(values);
        self.reached = [(); 2].map(|()| Reached {
            t: next(),
            force: next(),
        });
        self.terms.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CorrectedWire;
    use nalgebra::{Matrix3, Vector3};
    use std::sync::Arc;
    use wire::{NodeMap, WireGeometry};

    const STEP: f64 = 1e-3;
    const KAPPA: f64 = 0.17;
    const LENGTH: f64 = 2.0;
    const SPEED: f64 = 70.0;

    /// Three planar elements on the x axis, four coordinates per node: x, z and their slopes.
    fn wire() -> CorrectedWire {
        let lengths = [LENGTH; 3];
        let geometry = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &lengths, |node| {
            NodeMap::planar(4 * node)
        });
        CorrectedWire {
            geometry: Arc::new(geometry),
            compliance: None,
            surface: None,
            load: Some(LoadCorrection {
                step: STEP,
                kappa: KAPPA,
            }),
        }
    }

    /// Correction for a strip at `x` m.
    fn added(load: &mut MovingLoad, x: f64, t: f64) -> Vec<f64> {
        let (q, curve) = ([0.0; 16], wire());
        let strip = Frame {
            position: Vector3::new(x, 0.0, 1e-3),
            axes: Matrix3::identity(),
            velocity: Vector3::x() * SPEED,
            angular_velocity: Vector3::zeros(),
        };
        match ContactGeometry::search(&curve, &strip, x, &q, &q) {
            Some(geometry) => load.begin_step(&geometry, &curve, &strip, t),
            None => load.clear_terms(),
        }
        let mut force = vec![0.0; 16];
        load.add_to(&mut force);
        force
    }

    fn after(forces: [f64; 2]) -> MovingLoad {
        let mut load = MovingLoad::NONE;
        load.end_step(0.0, forces[0]);
        load.end_step(STEP, forces[1]);
        load
    }

    #[test]
    fn a_steady_force_within_an_element_is_corrected_by_the_second_derivative_of_the_shape_functions() {
        let (x, xi) = (LENGTH + 0.7, 0.35);
        let force = added(&mut after([100.0, 100.0]), x, 2.0 * STEP);
        let factor = -KAPPA * STEP * STEP * SPEED * SPEED * 100.0 / (LENGTH * LENGTH);
        let second = [
            12.0 * xi - 6.0,
            LENGTH * (6.0 * xi - 4.0),
            6.0 - 12.0 * xi,
            LENGTH * (6.0 * xi - 2.0),
        ];
        let curve = wire();
        let mut columns = CurveColumns::default();
        curve.columns(x, &mut columns);
        // The vertical coordinates of the element: height and slope of either node.
        let vertical = columns.as_slice().iter().filter(|column| column.n.z != 0.0);
        let indices: Vec<usize> = vertical.map(|column| column.index).collect();
        assert_eq!(indices.len(), 4);
        for (&index, second) in indices.iter().zip(second) {
            assert!(
                (force[index] - factor * second).abs() < 1e-12,
                "{index}: {}",
                force[index]
            );
        }
        let others = (0..16).filter(|index| !indices.contains(index));
        assert!(others.map(|index| force[index]).all(|force| force == 0.0));
    }

    #[test]
    fn it_has_no_resultant_and_a_growing_force_is_carried_on_across_an_element_border() {
        let mut load = after([80.0, 90.0]);
        let force = added(&mut load, LENGTH + 0.02, 2.0 * STEP);
        let curve = wire();
        // A rigid motion upwards: heights one, slopes none.
        let mut lift = [0.0; 16];
        let z = |node: usize| curve.geometry.nodes()[node].map.position(2).unwrap();
        (0..4).for_each(|node| lift[z(node)] = 1.0);
        let resultant: f64 = force.iter().zip(lift).map(|(force, lift)| force * lift).sum();
        assert!(
            resultant.abs() < 1e-12 && force.iter().any(|force| force.abs() > 1e-3),
            "{resultant}"
        );
        let square: f64 = force.iter().map(|force| force * force).sum();
        assert!((load.power(&force) / square - 1.0).abs() < 1e-12);
        let steady = added(&mut after([100.0, 100.0]), LENGTH + 0.02, 2.0 * STEP);
        // F = 100 N and Ḟ = 10 N/ms: the moment about the strip is −κ 2 (ṡ h) (Ḟ h).
        let tilt: Vec<f64> = (0..16)
            .map(|index| {
                (0..4)
                    .find(|&node| z(node) == index)
                    .map_or(0.0, |node| LENGTH * node as f64)
            })
            .collect();
        let slope = |node: usize| curve.geometry.nodes()[node].map.slope(2).unwrap();
        let moment = |force: &[f64]| -> f64 {
            let of_heights: f64 = force.iter().zip(&tilt).map(|(force, tilt)| force * tilt).sum();
            of_heights + (0..4).map(|node| force[slope(node)]).sum::<f64>()
        };
        assert!(moment(&steady).abs() < 1e-12);
        let expected = -KAPPA * 2.0 * SPEED * STEP * 10.0;
        assert!(
            (moment(&force) - expected).abs() < 1e-9,
            "{} {expected}",
            moment(&force)
        );
    }

    #[test]
    fn nothing_is_added_without_a_force_before_or_at_the_ends_of_the_wire() {
        let t = 2.0 * STEP;
        let nothing = vec![0.0; 16];
        assert_eq!(added(&mut MovingLoad::NONE.clone(), 3.0, t), nothing);
        assert_eq!(added(&mut after([100.0, 0.0]), 3.0, t), nothing);
        assert_eq!(added(&mut after([100.0, 100.0]), 0.01, t), nothing);
        assert_eq!(added(&mut after([100.0, 100.0]), 3.0 * LENGTH - 0.01, t), nothing);
        let mut load = after([100.0, 100.0]);
        load.forget();
        assert_eq!(added(&mut load, 3.0, t), nothing);
        // In the step after a closing the force is taken as steady.
        assert_eq!(
            added(&mut after([0.0, 50.0]), 3.0, t),
            added(&mut after([50.0, 50.0]), 3.0, t)
        );
    }

    #[test]
    fn a_restored_load_goes_on_as_the_saved_one() {
        let mut load = after([80.0, 90.0]);
        let mut saved = Vec::new();
        load.save(&mut saved);
        let mut other = after([1.0, 2.0]);
        other.restore(&mut saved.iter());
        assert_eq!(added(&mut load, 3.3, 2.0 * STEP), added(&mut other, 3.3, 2.0 * STEP));
    }
}
