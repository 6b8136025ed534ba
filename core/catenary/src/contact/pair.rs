//! A strip against a wire, as a contribution of forces.
use super::{ContactGeometry, PenaltyContact};
use crate::{Curve, CurveColumns};
use dynamics::{Columns, Force, Frame, Marker, Motion, Power, Updates, Weights};
use nalgebra::Vector3;
use std::sync::Arc;

/// Which tangent the contact hands to Newton's method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactTangent {
    /// `k g_q g_qᵀ` with the direction predicted for the step: one solution per step, exact up to the curvature terms.
    RankOne,
    /// All terms at the present iterate, for quadratic convergence.
    Exact,
}

/// The contact at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Closest points.
    pub geometry: ContactGeometry,
    /// Contact force, N, ≥ 0.
    pub force: f64,
    /// `∂F/∂δ`, N/m.
    pub stiffness: f64,
    /// `∂F/∂δ̇`, N·s/m.
    pub damping: f64,
}

impl ContactState {
    /// Force on the strip, N, world frame.
    #[must_use]
    pub fn force_on_strip(&self) -> Vector3<f64> {
        -self.force * self.geometry.normal
    }

    /// Whether wire and strip touch.
    #[must_use]
    pub fn closed(&self) -> bool {
        self.force > 0.0
    }
}

/// One strip on one wire.
pub struct ContactPair {
    law: PenaltyContact,
    /// Stiffness of the scene, N/m; that of `law` is lower while the line settles.
    stiffness: f64,
    curve: Arc<dyn Curve>,
    strip: Box<dyn Marker>,
    width: f64,
    tangent: ContactTangent,
    /// Parameter found at the last predicted motion: every search of a step starts here.
    s: f64,
    /// Counts the predicted directions, see [`Updates::rank_one`].
    version: u64,
    direction: Vec<(usize, f64)>,
    active: Option<f64>,
}

/// Change of the contact per unit of one local coordinate.
#[derive(Clone, Copy, Debug, Default)]
struct Variation {
    s: f64,
    eta: f64,
    axis: Vector3<f64>,
    normal: Vector3<f64>,
    gap: f64,
    gap_rate: f64,
}

impl ContactPair {
    /// A strip of `width` m, seen through its marker (second axis along the strip), on a wire.
    #[must_use]
    pub fn new(
        law: PenaltyContact,
        curve: Arc<dyn Curve>,
        strip: Box<dyn Marker>,
        width: f64,
        tangent: ContactTangent,
    ) -> Self {
        Self {
            stiffness: law.stiffness,
            law,
            curve,
            strip,
            width,
            tangent,
            s: 0.0,
            version: 0,
            direction: Vec::new(),
            active: None,
        }
    }

    /// Lowers the stiffness to `limit` (N/m) where it is above; returns whether it was.
    pub fn limit_stiffness(&mut self, limit: f64) -> bool {
        self.law.stiffness = self.stiffness.min(limit);
        self.stiffness > limit
    }

    /// Puts another marker in place of the strip's, made of it.
    pub fn replace_strip(&mut self, other: impl FnOnce(Box<dyn Marker>) -> Box<dyn Marker>) {
        let nowhere: Box<dyn Marker> = Box::new(super::PrescribedStrip { first: 0 });
        self.strip = other(std::mem::replace(&mut self.strip, nowhere));
    }

    /// The strip's marker.
    #[must_use]
    pub fn strip(&self, motion: &Motion<'_>) -> Frame {
        self.strip.frame(motion)
    }

    /// Finds the contact for a motion; `None` where the strip is beyond the ends of the wire.
    ///
    /// A contact beside the strip (further than half its width from its middle) has a gap but no force.
    #[must_use]
    pub fn state(&self, motion: &Motion<'_>) -> Option<ContactState> {
        let frame = self.strip.frame(motion);
        let geometry = ContactGeometry::search(&*self.curve, &frame, self.s, motion.q, motion.v)?;
        let (delta, rate) = (-geometry.gap, -geometry.gap_rate);
        let beside = geometry.eta.abs() > 0.5 * self.width;
        let (force, (stiffness, damping)) = if beside {
            (0.0, (0.0, 0.0))
        } else {
            (self.law.normal_force(delta, rate), self.law.derivatives(delta, rate))
        };
        Some(ContactState {
            geometry,
            force,
            stiffness,
            damping,
        })
    }

    /// Derivative of force, normal and position of the contact with respect to a unit motion of the strip with the wire held:
    /// translation `translation`, rotation `rotation`, velocity `velocity` (m/s per unit).
    #[must_use]
    pub fn sensitivity(
        &self,
        contact: &ContactState,
        motion: &Motion<'_>,
        [translation, rotation, velocity]: [Vector3<f64>; 3],
    ) -> Sensitivity {
        let frame = self.strip.frame(motion);
        let mut variation = vary(&contact.geometry, &frame, None, Some((translation, rotation)));
        variation.gap_rate -= contact.geometry.normal.dot(&velocity);
        let force = -contact.stiffness * variation.gap - contact.damping * variation.gap_rate;
        let wire = &contact.geometry.wire;
        Sensitivity {
            force,
            force_on_strip: -force * contact.geometry.normal - contact.force * variation.normal,
            gap: variation.gap,
            position: variation.s * wire.r_s,
            velocity: variation.s * wire.velocity_s,
        }
    }

    /// Rates of the contact along the present motion; that of a damping force leaves out the accelerations.
    #[must_use]
    pub fn rates(&self, contact: &ContactState, motion: &Motion<'_>) -> Sensitivity {
        let frame = self.strip.frame(motion);
        let wire = &contact.geometry.wire;
        let rate = vary(
            &contact.geometry,
            &frame,
            Some((wire.velocity, wire.velocity_s)),
            Some((frame.velocity, frame.angular_velocity)),
        );
        let force = -contact.stiffness * rate.gap;
        Sensitivity {
            force,
            force_on_strip: -force * contact.geometry.normal - contact.force * rate.normal,
            gap: rate.gap,
            position: wire.velocity + rate.s * wire.r_s,
            velocity: rate.s * wire.velocity_s,
        }
    }

    /// `∂g/∂q`: the direction of the generalised contact force, as (index, value).
    fn gap_gradient(&self, geometry: &ContactGeometry, motion: &Motion<'_>, out: &mut Vec<(usize, f64)>) {
        let mut wire = CurveColumns::default();
        self.curve.columns(geometry.s, &mut wire);
        let mut strip = Columns::default();
        self.strip.columns(motion, &mut strip);
        let lever = geometry.eta * geometry.axis;
        out.clear();
        out.extend(
            wire.as_slice()
                .iter()
                .map(|column| (column.index, column.n.dot(&geometry.normal))),
        );
        out.extend(strip.as_slice().iter().map(|column| {
            let at_contact = column.translation + column.rotation.cross(&lever);
            (column.index, -at_contact.dot(&geometry.normal))
        }));
    }

    /// The whole tangent on the coordinates of wire and strip; columns of the strip are taken as constant (exact for masses;
    /// for rigid bodies the turn of the lever arms is left out).
    fn exact_tangent(&self, contact: &ContactState, motion: &Motion<'_>, weights: Weights) -> (Vec<usize>, Vec<f64>) {
        let geometry = &contact.geometry;
        let frame = self.strip.frame(motion);
        let mut wire = CurveColumns::default();
        self.curve.columns(geometry.s, &mut wire);
        let mut strip = Columns::default();
        self.strip.columns(motion, &mut strip);
        let (wire, strip) = (wire.as_slice(), strip.as_slice());
        let lever = geometry.eta * geometry.axis;
        let n = geometry.normal;
        let indices: Vec<usize> = (wire.iter().map(|c| c.index))
            .chain(strip.iter().map(|c| c.index))
            .collect();
        let size = indices.len();
        let mut matrix = vec![0.0; size * size];
        for j in 0..size {
            let (variation, velocity) = if j < wire.len() {
                let c = &wire[j];
                (vary(geometry, &frame, Some((c.n, c.n_s)), None), c.n)
            } else {
                let c = &strip[j - wire.len()];
                let velocity = c.translation + c.rotation.cross(&lever);
                (
                    vary(geometry, &frame, None, Some((c.translation, c.rotation))),
                    -velocity,
                )
            };
            let force = -contact.stiffness * variation.gap - contact.damping * variation.gap_rate;
            let force_by_rate = -contact.damping * n.dot(&velocity);
            let change = weights.q * force + weights.v * force_by_rate;
            for (i, c) in wire.iter().enumerate() {
                let turned = variation.normal.dot(&c.n) + variation.s * n.dot(&c.n_s);
                matrix[i * size + j] = -(change * n.dot(&c.n) + weights.q * contact.force * turned);
            }
            let lever_change = variation.eta * geometry.axis + geometry.eta * variation.axis;
            for (i, c) in strip.iter().enumerate() {
                let at_contact = c.translation + c.rotation.cross(&lever);
                let turned = variation.normal.dot(&at_contact) + n.dot(&c.rotation.cross(&lever_change));
                matrix[(wire.len() + i) * size + j] = change * n.dot(&at_contact) + weights.q * contact.force * turned;
            }
        }
        (indices, matrix)
    }
}

/// What [`ContactPair::sensitivity`] returns, each per unit of the strip's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// Of the contact force, N.
    pub force: f64,
    /// Of the force on the strip, N.
    pub force_on_strip: Vector3<f64>,
    /// Of the gap, m.
    pub gap: f64,
    /// Of the contact's position on the wire, m.
    pub position: Vector3<f64>,
    /// Of the velocity of the wire there, m/s.
    pub velocity: Vector3<f64>,
}

/// First variation of the contact [Thesis, Eq. (11)–(16), for the normal of this module]: `wire` is the change of `r` and `r_s`
/// at fixed `s`, `strip` the translation and rotation of the strip.
fn vary(
    g: &ContactGeometry,
    strip: &Frame,
    wire: Option<(Vector3<f64>, Vector3<f64>)>,
    moved: Option<(Vector3<f64>, Vector3<f64>)>,
) -> Variation {
    let (r, r_s) = wire.unwrap_or_default();
    let (p, theta) = moved.unwrap_or_default();
    let e = g.axis;
    let axis = theta.cross(&e);
    let w = g.wire.r - strip.position;
    let d = w - g.eta * e;
    let apart = r - p;
    let d_change = apart - e * e.dot(&apart) - g.eta * axis - e * axis.dot(&w);
    let s = -(d_change.dot(&g.wire.r_s) + d.dot(&r_s)) / g.slope;
    let apart = apart + s * g.wire.r_s;
    let eta = axis.dot(&w) + e.dot(&apart);
    let normal = if g.normal_length > 0.0 {
        let cross = (r_s + s * g.wire.r_ss).cross(&e) + g.wire.r_s.cross(&axis);
        (cross - g.normal * g.normal.dot(&cross)) / g.normal_length
    } else {
        Vector3::zeros()
    };
    let lever = g.eta * e;
    let relative = g.wire.velocity - strip.velocity - strip.angular_velocity.cross(&lever);
    let turning = strip.angular_velocity.cross(&(eta * e + g.eta * axis));
    Variation {
        s,
        eta,
        axis,
        normal,
        gap: g.normal.dot(&(r - p)) - g.eta * g.normal.dot(&axis),
        gap_rate: normal.dot(&relative) + g.normal.dot(&(s * g.wire.velocity_s - turning)),
    }
}

impl Force for ContactPair {
    fn begin_step(&mut self, motion: &Motion<'_>) {
        self.active = None;
        if let Some(contact) = self.state(motion) {
            self.s = contact.geometry.s;
            let mut direction = std::mem::take(&mut self.direction);
            self.gap_gradient(&contact.geometry, motion, &mut direction);
            self.direction = direction;
            self.version += 1;
        }
    }

    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let Some(contact) = self.state(motion) else {
            self.active = None;
            return;
        };
        self.active = Some(contact.force);
        if !contact.closed() {
            return;
        }
        let geometry = &contact.geometry;
        let mut wire = CurveColumns::default();
        self.curve.columns(geometry.s, &mut wire);
        let on_wire = contact.force * geometry.normal;
        for column in wire.as_slice() {
            force[column.index] += column.n.dot(&on_wire);
        }
        let mut strip = Columns::default();
        self.strip.columns(motion, &mut strip);
        strip.add_force(&-on_wire, &(geometry.eta * geometry.axis), force);
    }

    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        match self.tangent {
            ContactTangent::RankOne => {
                if self.active.is_some_and(|force| force > 0.0) {
                    let coefficient = weights.q * self.law.stiffness + weights.v * self.law.damping;
                    updates.rank_one(0, self.version, coefficient, self.direction.iter().copied());
                }
            }
            ContactTangent::Exact => {
                if let Some(contact) = self.state(motion).filter(ContactState::closed) {
                    let (indices, matrix) = self.exact_tangent(&contact, motion, weights);
                    updates.dense(0, &indices, &matrix);
                }
            }
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.state(motion)
            .filter(ContactState::closed)
            .map_or(0.0, |contact| self.law.energy(-contact.geometry.gap))
    }

    /// The strip's prescribed motion, along the track for one, presses on the wire's slope; the damper heats.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let Some(contact) = self.state(motion).filter(ContactState::closed) else {
            return Some(Power::default());
        };
        let geometry = &contact.geometry;
        let lever = geometry.eta * geometry.axis;
        let frame = self.strip.frame(motion);
        let mut strip = Columns::default();
        self.strip.columns(motion, &mut strip);
        let total = frame.velocity + frame.angular_velocity.cross(&lever);
        let free = |column: &dynamics::Column| {
            motion.v[column.index] * (column.translation + column.rotation.cross(&lever)).dot(&geometry.normal)
        };
        let prescribed = geometry.normal.dot(&total) - strip.as_slice().iter().map(free).sum::<f64>();
        let elastic = self.law.stiffness * (-geometry.gap).max(0.0);
        Some(Power {
            driven: contact.force * prescribed,
            dissipated: (elastic - contact.force) * geometry.gap_rate,
        })
    }

    fn save(&self, out: &mut Vec<f64>) {
        out.push(self.s);
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        if let Some(&s) = values.next() {
            self.s = s;
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
