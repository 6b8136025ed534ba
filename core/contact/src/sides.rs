//! Generalised forces on wire and strip of a force along their common normal.
use super::ContactGeometry;
use super::state::{Variation, vary};
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::Vector3;
use wire::{CurveColumns, WireCurve};

/// Wire and strip at their contact.
pub(super) struct Sides<'a> {
    geometry: &'a ContactGeometry,
    wire: CurveColumns,
    strip: Columns,
    /// From the strip's marker to the contact, m.
    lever: Vector3<f64>,
}

impl<'a> Sides<'a> {
    pub fn new(geometry: &'a ContactGeometry, curve: &dyn WireCurve, strip: &dyn Marker, motion: &Motion<'_>) -> Self {
        let mut sides = Self {
            geometry,
            wire: CurveColumns::default(),
            strip: Columns::default(),
            lever: geometry.lever(),
        };
        curve.columns(geometry.s, &mut sides.wire);
        strip.columns(motion, &mut sides.strip);
        sides
    }

    /// `∂g/∂q` of the gap `g` as (index, value): exact at any gap, for the contact is where the distance is least.
    pub fn gap_gradient(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let n = self.geometry.normal;
        let of_wire = (self.wire.as_slice().iter()).map(move |c| (c.index, c.n.dot(&n)));
        let of_strip = self.strip.as_slice().iter().map(move |c| {
            let at_contact = c.translation + c.rotation.cross(&self.lever);
            (c.index, -at_contact.dot(&n))
        });
        of_wire.chain(of_strip)
    }

    /// Prescribed part of the velocity of the strip's point, m/s.
    pub fn prescribed(&self, frame: &Frame, motion: &Motion<'_>) -> Vector3<f64> {
        let total = frame.velocity + frame.angular_velocity.cross(&self.lever);
        let free = |c: &dynamics::Column| motion.v[c.index] * (c.translation + c.rotation.cross(&self.lever));
        total - self.strip.as_slice().iter().map(free).sum::<Vector3<f64>>()
    }

    /// `∂ġ/∂q` at held velocities of the rate of the gap, in the order of [`Sides::gap_gradient`], 1/s.
    ///
    /// Columns of the strip are taken as constant, see [`Sides::tangent`].
    pub fn gap_rate_gradient<'b>(&'b self, frame: &'b Frame) -> impl Iterator<Item = f64> + 'b {
        let of_wire =
            (self.wire.as_slice().iter()).map(move |c| vary(self.geometry, frame, Some((c.n, c.n_s)), None).gap_rate);
        let of_strip = (self.strip.as_slice().iter())
            .map(move |c| vary(self.geometry, frame, None, Some((c.translation, c.rotation))).gap_rate);
        of_wire.chain(of_strip)
    }

    /// `−∂Q/∂q`, dense on the coordinates of wire and strip, of a `force` (N) along the normal that presses wire and
    /// strip apart. `change` gives the weighted change of the force itself from the variation of the contact and the
    /// change of `n·(ṙ − ṗ)` per unit of velocity (–); `weight` is that of the turn of the direction.
    ///
    /// Columns of the strip are taken as constant: exact for masses; for rigid bodies the turn of the lever arms is
    /// left out.
    pub fn tangent(
        &self,
        frame: &Frame,
        force: f64,
        weight: f64,
        change: impl Fn(&Variation, f64) -> f64,
    ) -> (Vec<usize>, Vec<f64>) {
        let geometry = self.geometry;
        let (wire, strip) = (self.wire.as_slice(), self.strip.as_slice());
        let n = geometry.normal;
        let indices: Vec<usize> = (wire.iter().map(|c| c.index))
            .chain(strip.iter().map(|c| c.index))
            .collect();
        let size = indices.len();
        let mut matrix = vec![0.0; size * size];
        for j in 0..size {
            let (variation, velocity) = if j < wire.len() {
                let c = &wire[j];
                (vary(geometry, frame, Some((c.n, c.n_s)), None), c.n)
            } else {
                let c = &strip[j - wire.len()];
                let velocity = c.translation + c.rotation.cross(&self.lever);
                (
                    vary(geometry, frame, None, Some((c.translation, c.rotation))),
                    -velocity,
                )
            };
            let change = change(&variation, n.dot(&velocity));
            for (i, c) in wire.iter().enumerate() {
                let turned = variation.normal.dot(&c.n) + variation.s * n.dot(&c.n_s);
                matrix[i * size + j] = -(change * n.dot(&c.n) + weight * force * turned);
            }
            for (i, c) in strip.iter().enumerate() {
                let at_contact = c.translation + c.rotation.cross(&self.lever);
                let turned = variation.normal.dot(&at_contact) + n.dot(&c.rotation.cross(&variation.lever));
                matrix[(wire.len() + i) * size + j] = change * n.dot(&at_contact) + weight * force * turned;
            }
        }
        (indices, matrix)
    }
}
