//! A strip held on a wire, sliding along it.
use super::sides::Sides;
use super::{ContactGeometry, ContactState, ContactTangent, OnWire, PrescribedStrip};
use dynamics::{
    Columns, Constraint, Force, Frame, JacobianRows, LowRank, Marker, Motion, StepHistory, Updates, Weights,
};
use std::sync::Arc;
use wire::{CurveColumns, WireCurve};

/// The sliding joint between collector strip and contact wire [Thesis, section 4.2.1; Pappalardo et al. 2015]: one
/// holonomic equation, with the arc length `s` of the contact as non-generalised coordinate.
///
/// ```text
/// C_e(q, s) = 0                                  gives s(q)        [Thesis, Eq. (10), first row; Eq. (12)]
/// g(t, q) = −n · (r(s) − p) = 0                                    [Thesis, Eq. (10), third row]
/// g_q = −n · (r_q − p_q),    ġ = −n · (ṙ − ṗ)
/// ```
///
/// `p` is the point of the strip and `n` the common normal, see [`ContactGeometry`]. `s` is eliminated as in [Thesis,
/// Eq. (13)]: the distance is least at the contact, so that `r − p` is along `n`, the change of `s` drops out of `g_q`,
/// also off the constraint, and `ġ` is the rate between the points that touch. Written for the track, `g_q` says that
/// the strip is at the height of the wire at its `x`: a strip that moves on by `δx` rises by the slope of the wire. `s`
/// runs over the whole wire, so that no state is handed over at the border of two elements: `r` and `r_s` are
/// continuous there, and with them position and velocity of the strip. `r_ss` is not; the multiplier steps, see below.
///
/// The multiplier is the contact force, positive in compression, as that of [`super::PenaltyContact`]: `−g_qᵀ λ`
/// presses the wire along `n` and the strip against it. A negative multiplier pulls: the contact cannot be lost, and
/// the width of the strip plays no part.
///
/// *Sideways.* The thesis' second row holds the strip's marker to the wire along `n₁` too, so that its contact point
/// stays one point of the pan-head. With a stagger the wire would have to follow that point, or drag the strip along.
/// Here the strip is a line, as with the penalty law: its point `p + η e` follows the wire sideways, and only the
/// common normal carries a force. On a line without stagger, as the thesis', both are the same motion: nothing acts
/// along `n₁`.
///
/// *Curvature.* `g̈ = 0` asks for a relative acceleration of `v² κ` along `n`, `κ = n·r_ss/|r_s|²`. Cubic elements have
/// the same slope at a border but not the same curvature, so there the multiplier steps by
///
/// ```text
/// Δλ = −v² Δκ / (1/m + Y),    1/m + Y = g_q M⁻¹ g_qᵀ               derived here
/// ```
///
/// The multiplier falls where the wire bends up more. `m` is the effective mass of the strip and `Y` the wire's inverse
/// mass at the contact: `−m v² Δκ` for a strip much lighter than the wire around it. (`M v̇ + g_qᵀ λ = Q` and `g_q v̇ =
/// −(g_q)˙ v − (g_t)˙` hold on both sides; `Q`, `M` and `g_q` are continuous; with `g = −n·(r − p)` the right side of
/// the second steps by `v² Δκ`.)
///
/// *In time.* The integrator holds `ġ` rather than `g`: slopes are continuous, so that the impulse of a step is right
/// wherever in the step a border is passed. See [`dynamics::GeneralizedAlpha`] for the drift of `g` and the reported
/// multiplier.
pub struct SlidingJoint {
    curve: Arc<dyn WireCurve>,
    strip: Box<dyn Marker>,
    tangent: ContactTangent,
    /// Number of the joint's multiplier in the system.
    multiplier: usize,
    /// Parameter at the last predicted motion, from which every search of a step starts.
    s: f64,
    /// Counts the directions, see [`Updates::border`].
    version: u64,
    /// Index, `g_q` and `∂ġ/∂q` (1/s).
    direction: Vec<(usize, f64, f64)>,
}

impl SlidingJoint {
    /// A strip, seen through its marker (second axis along the strip), on a wire; `multiplier` is the number of the
    /// joint's equation in the system.
    #[must_use]
    pub fn new(curve: Arc<dyn WireCurve>, strip: Box<dyn Marker>, multiplier: usize, tangent: ContactTangent) -> Self {
        Self {
            curve,
            strip,
            tangent,
            multiplier,
            s: 0.0,
            version: 0,
            direction: Vec::new(),
        }
    }

    /// Replaces the strip's marker by another one made from it.
    pub fn replace_strip(&mut self, other: impl FnOnce(Box<dyn Marker>) -> Box<dyn Marker>) {
        let nowhere: Box<dyn Marker> = Box::new(PrescribedStrip { first: 0 });
        self.strip = other(std::mem::replace(&mut self.strip, nowhere));
    }

    /// Contact for a motion and the multipliers of its system; `None` for a strip beyond the ends of the wire.
    #[must_use]
    pub fn state(&self, motion: &Motion<'_>, lambda: &[f64]) -> Option<ContactState> {
        Some(ContactState::held(self.geometry(motion)?, lambda[self.multiplier]))
    }

    fn geometry(&self, motion: &Motion<'_>) -> Option<ContactGeometry> {
        let frame = self.strip.frame(motion);
        ContactGeometry::search(&*self.curve, &frame, self.s, motion.q, motion.v)
    }

    fn sides<'a>(&self, geometry: &'a ContactGeometry, motion: &Motion<'_>) -> Sides<'a> {
        Sides::new(geometry, &*self.curve, &*self.strip, motion)
    }

    /// Evaluates `g_q` and `∂ġ/∂q` at a motion for the border.
    fn turn(&mut self, geometry: &ContactGeometry, motion: &Motion<'_>) {
        let sides = Sides::new(geometry, &*self.curve, &*self.strip, motion);
        let frame = self.strip.frame(motion);
        let entries = sides.gap_gradient().zip(sides.gap_rate_gradient(&frame));
        self.direction.clear();
        self.direction
            .extend(entries.map(|((index, value), of_rate)| (index, -value, -of_rate)));
        self.version += 1;
    }
}

impl OnWire for SlidingJoint {
    fn strip(&self, motion: &Motion<'_>) -> Frame {
        self.strip.frame(motion)
    }

    fn set_curve(&mut self, curve: Arc<dyn WireCurve>) {
        self.curve = curve;
    }
}

impl Force for SlidingJoint {
    /// Adds nothing, because the multiplier is the force.
    fn add_force(&mut self, _motion: &Motion<'_>, _force: &mut [f64]) {}

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for SlidingJoint {
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        // With one direction for a step, the turn of the direction leaves an error of the order of `κ Δs Δq` in the
        // equation after a correction `Δq`.
        if self.tangent == ContactTangent::Exact
            && let Some(geometry) = self.geometry(motion)
        {
            self.turn(&geometry, motion);
            let frame = self.strip.frame(motion);
            let lambda = updates.multiplier(self.multiplier);
            let (indices, matrix) = self
                .sides(&geometry, motion)
                .tangent(&frame, lambda, weights.q, |_, _| 0.0);
            updates.dense(3, &indices, &matrix);
        }
        updates.border(0, self.version, self.multiplier, self.direction.iter().copied());
    }
}

impl StepHistory for SlidingJoint {
    fn begin_step(&mut self, motion: &Motion<'_>, _: f64) {
        if let Some(geometry) = self.geometry(motion) {
            self.s = geometry.s;
            self.turn(&geometry, motion);
        }
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

impl Constraint for SlidingJoint {
    fn dimension(&self) -> usize {
        1
    }

    /// Residual of the equation; NaN for a strip beyond the ends of the wire, where no step can end.
    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]) {
        g[0] = self.geometry(motion).map_or(f64::NAN, |geometry| -geometry.gap);
    }

    fn jacobian(&self, motion: &Motion<'_>, rows: &mut JacobianRows<'_>) {
        const MOST: usize = CurveColumns::CAPACITY + Columns::CAPACITY;
        let Some(geometry) = self.geometry(motion) else {
            return;
        };
        let (mut indices, mut values, mut count) = ([0; MOST], [0.0; MOST], 0);
        for (index, value) in self.sides(&geometry, motion).gap_gradient() {
            (indices[count], values[count]) = (index, -value);
            count += 1;
        }
        rows.add(0, &indices[..count], &values[..count]);
    }

    fn moves(&self) -> bool {
        true
    }

    fn add_rate(&self, motion: &Motion<'_>, rates: &mut [f64]) {
        rates[0] += self.geometry(motion).map_or(f64::NAN, |geometry| -geometry.gap_rate);
    }
}

#[cfg(test)]
mod tests;
