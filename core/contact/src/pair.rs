//! A strip against a wire, as a contribution of forces.
use super::moving_load::MovingLoad;
use super::sides::Sides;
use super::state::{ContactState, Sensitivity, Variation, vary};
use super::{ContactGeometry, OnWire, PenaltyContact};
use dynamics::unilateral::{UnilateralStart, UnilateralStep};
use dynamics::{Columns, Force, Frame, LowRank, Marker, MonotoneCubic, Motion, Power, StepHistory, Updates, Weights};
use nalgebra::Vector3;
use std::sync::Arc;
use wire::{CurveColumns, WireCurve};

/// Tangent that the contact hands to Newton's method. In a step that closes the contact, the chord to the closing is
/// the lower bound of both, so that no correction opens the contact again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactTangent {
    /// `k g_q g_qᵀ` with the direction predicted for the step: one solution per step, exact up to the curvature terms.
    RankOne,
    /// All terms at the present iterate, for quadratic convergence.
    Exact,
}

/// One strip on one wire.
pub struct ContactPair {
    law: PenaltyContact,
    /// Stiffness of the scene, N/m; `law` has a lower one while the line settles.
    stiffness: f64,
    curve: Arc<dyn WireCurve>,
    strip: Box<dyn Marker>,
    width: f64,
    /// Top of a head with horns over the distance from its middle.
    top: Option<Box<MonotoneCubic>>,
    /// True while a wire that has passed the end of a horn is below it: under the head, and not on it.
    slipped: bool,
    tangent: ContactTangent,
    /// Last parameter on the wire, from which the next search starts.
    s: f64,
    /// Share of the penetration that the contact spring has at the step's prediction, see [`ContactState`].
    share: f64,
    /// Counts the predicted directions, see [`Updates::rank_one`].
    version: u64,
    direction: Vec<(usize, f64)>,
    active: Option<f64>,
    /// Branch of the law at the last evaluation of the force, see [`UnilateralStep::branch`].
    branch: Option<u8>,
    /// The present step, or the one that has just ended, to which the force at its end belongs.
    step: UnilateralStep,
    /// Closure with which the next step begins.
    reached: UnilateralStart,
    /// Within a step, the closure at the last evaluation of the force: the next step begins with it if the present one
    /// ends there.
    found: Option<UnilateralStart>,
    in_step: bool,
    load: MovingLoad,
}

impl ContactPair {
    /// A strip of `width` m, seen through its marker (second axis along the strip), on a wire.
    #[must_use]
    pub fn new(
        law: PenaltyContact,
        curve: Arc<dyn WireCurve>,
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
            top: None,
            slipped: false,
            tangent,
            s: 0.0,
            share: 1.0,
            version: 0,
            direction: Vec::new(),
            active: None,
            branch: None,
            step: UnilateralStep::NONE,
            reached: UnilateralStart::Unknown,
            found: None,
            in_step: false,
            load: MovingLoad::NONE,
        }
    }

    /// The same strip on a head with horns, whose top is at the height `top` above the strip over the distance from its
    /// middle; `None` is a head that ends with its strip.
    #[must_use]
    pub fn with_horns(self, top: Option<MonotoneCubic>) -> Self {
        Self {
            top: top.map(Box::new),
            ..self
        }
    }

    /// Limits the stiffness to `limit` (N/m) for statics; true if the limit lowers it. Forgets the beginning of the
    /// step.
    pub fn limit_stiffness(&mut self, limit: f64) -> bool {
        self.reached = UnilateralStart::Unknown;
        self.slipped = false;
        self.load.forget();
        self.law.stiffness = self.stiffness.min(limit);
        self.stiffness > limit
    }

    /// True if the contact has a damper.
    #[must_use]
    pub fn is_damped(&self) -> bool {
        self.law.damping > 0.0
    }

    /// Replaces the strip's marker by another one made from it.
    pub fn replace_strip(&mut self, other: impl FnOnce(Box<dyn Marker>) -> Box<dyn Marker>) {
        let nowhere: Box<dyn Marker> = Box::new(super::PrescribedStrip { first: 0 });
        self.strip = other(std::mem::replace(&mut self.strip, nowhere));
    }

    /// Finds the contact for a motion; `None` for a strip beyond the ends of the wire.
    ///
    /// A contact beside the strip (further than half its width, or the end of its horn, from its middle) has a gap but
    /// no force.
    #[must_use]
    pub fn state(&self, motion: &Motion<'_>) -> Option<ContactState> {
        self.state_under(&self.strip.frame(motion), motion)
    }

    /// [`ContactPair::state`] for a strip known to be at `frame`.
    fn state_under(&self, frame: &Frame, motion: &Motion<'_>) -> Option<ContactState> {
        let (curve, q, v) = (&*self.curve, motion.q, motion.v);
        let geometry = match &self.top {
            None => ContactGeometry::search(curve, frame, self.s, q, v),
            Some(top) => ContactGeometry::search_on(top, curve, frame, self.s, (q, v)),
        }?;
        let beside = self.is_beside(&geometry);
        let compliance = self.curve.compliance(geometry.s);
        Some(ContactState::new(
            (&self.law, self.step),
            geometry,
            frame,
            compliance,
            beside,
        ))
    }

    /// Closure of a step that begins with this contact.
    fn start_with(&self, contact: &ContactState) -> UnilateralStart {
        if self.is_beside(&contact.geometry) {
            UnilateralStart::APART
        } else {
            UnilateralStart::Known(self.step.ahead(-contact.geometry.gap, -contact.geometry.gap_rate))
        }
    }

    /// Finds the contact, and records the values that the rest of the step needs.
    fn find(&mut self, motion: &Motion<'_>) -> Option<ContactState> {
        let contact = self.state(motion);
        self.s = contact.as_ref().map_or(self.s, |contact| contact.geometry.s);
        self.active = contact.as_ref().map(|contact| contact.force);
        self.branch = contact.as_ref().map(|contact| contact.branch);
        self.found = self.in_step.then(|| match &contact {
            Some(contact) => self.start_with(contact),
            None => UnilateralStart::APART,
        });
        contact
    }

    /// True if the wire passes the strip further than half its width, or the end of its horn, from its middle.
    fn is_beside(&self, geometry: &ContactGeometry) -> bool {
        let half = (self.top.as_ref()).map_or(0.5 * self.width, |top| top.range()[1]);
        self.slipped || geometry.place.abs() > half
    }

    /// Takes in whether the wire is below the end of a horn beside the head; a wire that comes back there is under the
    /// head until it has been above its top again.
    fn follow_end_of_horn(&mut self, motion: &Motion<'_>) {
        if self.top.is_none() {
            return;
        }
        let was = std::mem::take(&mut self.slipped);
        if let Some(contact) = self.state(motion) {
            let beside = was || self.is_beside(&contact.geometry);
            self.slipped = beside && contact.geometry.gap < 0.0;
        }
    }

    /// Derivative of force, normal and position of the contact with respect to a unit motion of the strip with the wire
    /// held: translation `translation`, rotation `rotation`, velocity `velocity` (m/s per unit).
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
        let slide = contact.geometry.tangent().dot(&velocity);
        contact.change(&variation, (slide, self.bend(contact)), [Vector3::zeros(); 2])
    }

    /// `g_ss` at the contact, 1/(m N).
    fn bend(&self, contact: &ContactState) -> f64 {
        /// Half the distance of the two points of the difference, m: far below the bending length, far above rounding.
        const APART: f64 = 1e-4;
        if contact.compliance.slope == 0.0 {
            return 0.0;
        }
        let slope = |s: f64| self.curve.compliance(s).slope;
        let s = contact.geometry.s;
        (slope(s + APART) - slope(s - APART)) / (2.0 * APART)
    }

    /// Rates of the contact along the present motion; the rate of a damping force leaves out the accelerations.
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
        let rate = Variation { gap_rate: 0.0, ..rate };
        let lasting = contact.lasting();
        lasting.change(&rate, (0.0, self.bend(contact)), [wire.velocity, Vector3::zeros()])
    }

    fn sides<'a>(&self, geometry: &'a ContactGeometry, motion: &Motion<'_>) -> Sides<'a> {
        Sides::new(geometry, &*self.curve, &*self.strip, motion)
    }

    /// The whole tangent on the coordinates of wire and strip.
    fn exact_tangent(&self, contact: &ContactState, motion: &Motion<'_>, weights: Weights) -> (Vec<usize>, Vec<f64>) {
        let frame = self.strip.frame(motion);
        let change = |variation: &Variation, rate: f64| {
            weights.q * contact.force_change(variation, 0.0) + weights.v * (-contact.damping * rate)
        };
        self.sides(&contact.geometry, motion)
            .tangent(&frame, contact.force, weights.q, change)
    }
}

impl OnWire for ContactPair {
    fn strip(&self, motion: &Motion<'_>) -> Frame {
        self.strip.frame(motion)
    }

    fn set_curve(&mut self, curve: Arc<dyn WireCurve>) {
        self.curve = curve;
        self.load.clear_terms();
    }
}

impl Force for ContactPair {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        if self.in_step {
            self.load.add_to(force);
        }
        let Some(contact) = self.find(motion).filter(ContactState::closed) else {
            return;
        };
        let geometry = &contact.geometry;
        let mut wire = CurveColumns::default();
        self.curve.columns(geometry.s, &mut wire);
        let on_wire = -contact.force_on_strip();
        for column in wire.as_slice() {
            force[column.index] += column.n.dot(&on_wire);
        }
        let mut strip = Columns::default();
        self.strip.columns(motion, &mut strip);
        strip.add_force(&-on_wire, &geometry.lever(), force);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        match self.state(motion) {
            Some(contact) if !self.is_beside(&contact.geometry) => {
                contact.share() * self.law.energy(-contact.geometry.gap)
            }
            _ => 0.0,
        }
    }

    /// Power of the contact: the strip's prescribed motion, mostly along the track, presses on the wire's slope and
    /// drives the correction of the moving force; the damper heats.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let Some(contact) = self.state(motion) else {
            return Some(Power::default());
        };
        let frame = self.strip.frame(motion);
        let prescribed = self.sides(&contact.geometry, motion).prescribed(&frame, motion);
        Some(Power {
            driven: -contact.force_on_strip().dot(&prescribed) + self.load.power(motion.v),
            dissipated: contact.dissipation(),
        })
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for ContactPair {
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        match self.tangent {
            ContactTangent::RankOne => {
                if self.active.is_some_and(|force| force > 0.0) {
                    let closing = self.step.began_open().then(|| self.state(motion)).flatten();
                    let (q, v) = match closing.map(|contact| contact.with_chord(weights)) {
                        Some(contact) => (contact.stiffness, contact.damping),
                        None => self.law.yielding(self.share),
                    };
                    let coefficient = weights.q * q + weights.v * v;
                    updates.rank_one(0, self.version, coefficient, self.direction.iter().copied());
                }
            }
            ContactTangent::Exact => {
                if let Some(contact) = self.state(motion).filter(ContactState::closed) {
                    let (indices, matrix) = self.exact_tangent(&contact.with_chord(weights), motion, weights);
                    updates.dense(0, &indices, &matrix);
                }
            }
        }
    }
}

impl StepHistory for ContactPair {
    fn begin_step(&mut self, motion: &Motion<'_>, h: f64) {
        self.active = None;
        self.found = None;
        self.in_step = true;
        self.step = UnilateralStep::new(self.reached, 0.5 * h);
        let frame = self.strip.frame(motion);
        self.s = self.curve.expect(Some((&frame, self.s))).unwrap_or(self.s);
        let found = self.state_under(&frame, motion);
        if found.is_none() {
            self.curve.expect(None);
        }
        if let Some(contact) = found {
            self.s = contact.geometry.s;
            self.share = contact.share();
            let sides = Sides::new(&contact.geometry, &*self.curve, &*self.strip, motion);
            self.direction.clear();
            self.direction.extend(sides.gap_gradient());
            self.version += 1;
            self.load.begin_step(&contact.geometry, &*self.curve, &frame, motion.t);
        } else {
            self.load.clear_terms();
        }
    }

    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        let before = self.branch;
        self.find(motion);
        self.branch == before
    }

    fn end_step(&mut self, motion: &Motion<'_>) {
        let (force, reached) = match self.found.take() {
            Some(found) => (self.active, found),
            None => {
                let contact = self.state(motion);
                let reached = contact
                    .as_ref()
                    .map_or(UnilateralStart::APART, |contact| self.start_with(contact));
                (contact.map(|contact| contact.force), reached)
            }
        };
        self.load.end_step(motion.t, force.unwrap_or(0.0));
        self.reached = reached;
        self.in_step = false;
        self.follow_end_of_horn(motion);
    }

    fn save(&self, out: &mut Vec<f64>) {
        out.push(self.s);
        out.push(self.step.half);
        self.step.start.save(out);
        self.reached.save(out);
        self.load.save(out);
        if self.top.is_some() {
            out.push(f64::from(u8::from(self.slipped)));
        }
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        if let (Some(&s), Some(&half)) = (values.next(), values.next()) {
            self.s = s;
            self.step = UnilateralStep::new(UnilateralStart::restored(values), half);
            self.reached = UnilateralStart::restored(values);
            self.load.restore(values);
            if self.top.is_some() {
                self.slipped = values.next().is_some_and(|&slipped| slipped != 0.0);
            }
            (self.found, self.in_step) = (None, false);
        }
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;

#[cfg(test)]
#[path = "tests/horns.rs"]
mod horns;
