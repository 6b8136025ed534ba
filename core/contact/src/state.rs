//! The contact at one instant and its derivatives.
use super::{ContactGeometry, PenaltyContact};
use dynamics::unilateral::UnilateralStep;
use dynamics::{Frame, Weights};
use nalgebra::Vector3;
use wire::Compliance;

/// The contact at one instant.
///
/// A residual compliance `g(s)` of the curve, see [`super::ResidualCompliance`], is in series with the contact: of the
/// penetration `δ` of the curve described by the coordinates the contact has the share `p = c δ`, and the wire yields
/// by `g F`,
///
/// ```text
/// c = 1/(1 + k g),    F = k p + c φ d ṗ,    ṗ = c δ̇ + c_s ṡ δ,    never negative
/// ```
///
/// `ṗ` is the rate along the path of the strip, `ṡ` its rate on the wire, `φ` the part of the step in which the contact
/// is closed, see [`UnilateralStep`]. The series of spring and damper with `g` is exact but for terms `(k g) (d ṗ/(k
/// p))²` of `F`, which are negligible at the frequencies of contact forces. The contact moves along a wire that yields
/// more at one place than at another; the strip is therefore pushed towards larger compliance by `½ g_s F²`, and the
/// force is the gradient of the energy `½ k c δ²`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactState {
    /// Closest points of the strip and the curve described by the coordinates.
    pub geometry: ContactGeometry,
    /// Residual compliance of the curve there.
    pub compliance: Compliance,
    /// Contact force, N, positive in compression; negative only at a [`super::SlidingJoint`].
    pub force: f64,
    /// `∂F/∂δ`, N/m.
    pub stiffness: f64,
    /// `∂F/∂δ̇`, N·s/m.
    pub damping: f64,
    /// `∂F/∂s`, N/m.
    by_place: f64,
    /// `∂F/∂ṡ`, N·s/m.
    by_slide: f64,
    /// `c`, –.
    share: f64,
    /// `∂c/∂s`, 1/m.
    share_s: f64,
    /// `Ḟ` of the contact spring, N/s.
    spring_rate: f64,
    /// `ṡ`, m/s.
    slide: f64,
    /// `k`, N/m; zero where the contact is open.
    spring: f64,
    /// `k p`, N, also where the damper takes all of it; zero at a gap.
    elastic: f64,
    /// The step that ends here.
    step: UnilateralStep,
    /// Share of `∂φ/∂δ⁺` in `∂F/∂δ⁺`, N/m.
    closing: f64,
    /// Branch of the law, see [`UnilateralStep::branch`].
    pub(super) branch: u8,
}

/// Derivatives returned by [`super::ContactPair::sensitivity`], each per unit of the strip's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// Change of the contact force, N.
    pub force: f64,
    /// Change of the force on the strip, N.
    pub force_on_strip: Vector3<f64>,
    /// Change of the gap, m.
    pub gap: f64,
    /// Change of the contact's position on the wire, m.
    pub position: Vector3<f64>,
    /// Change of the velocity of the wire at the contact, m/s.
    pub velocity: Vector3<f64>,
}

/// Change of the contact per unit of one local coordinate.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Variation {
    pub s: f64,
    /// Change of the way from the strip's marker to the contact.
    pub lever: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub gap: f64,
    pub gap_rate: f64,
}

impl ContactState {
    /// The contact under `law` at the end of a `step`; a contact `beside` the strip carries no force.
    pub(super) fn new(
        (law, step): (&PenaltyContact, UnilateralStep),
        geometry: ContactGeometry,
        strip: &Frame,
        compliance: Compliance,
        beside: bool,
    ) -> Self {
        let (delta, delta_rate) = (-geometry.gap, -geometry.gap_rate);
        let k = law.stiffness;
        let share = 1.0 / (1.0 + k * compliance.value);
        let share_s = -k * compliance.slope * share * share;
        let slide = if compliance.slope == 0.0 || beside {
            0.0
        } else {
            slide(&geometry, strip)
        };
        let (p, p_rate) = (share * delta, share * delta_rate + share_s * slide * delta);
        let ahead = step.ahead(delta, delta_rate);
        let (closed_part, by_ahead) = step.closed_part(ahead, p_rate);
        let d = closed_part * law.damping;
        let series = PenaltyContact {
            stiffness: k,
            damping: share * law.damping,
        };
        let mut state = Self {
            geometry,
            compliance,
            force: 0.0,
            stiffness: 0.0,
            damping: 0.0,
            by_place: 0.0,
            by_slide: 0.0,
            share,
            share_s,
            spring_rate: 0.0,
            slide,
            spring: 0.0,
            elastic: if beside { 0.0 } else { (k * p).max(0.0) },
            step,
            closing: 0.0,
            branch: 0,
        };
        let force = series.normal_force(closed_part, p, p_rate);
        if force > 0.0 && !beside {
            state.force = force;
            state.closing = by_ahead * law.damping * share * p_rate;
            state.stiffness = k * share + share * d * share_s * slide + state.closing;
            state.damping = share * share * d + step.half * state.closing;
            // The second derivative of the share is left out: its term contains the damping and is equally small.
            state.by_place = k * share_s * delta + d * (share_s * p_rate + share * share_s * delta_rate);
            state.by_slide = share * d * share_s * delta;
            state.spring_rate = k * p_rate;
            state.spring = k;
        }
        state.branch = step.branch(ahead, p_rate, state.force);
        state
    }

    /// A strip that is held on the curve by a `force` (N) of any sign.
    pub(super) fn held(geometry: ContactGeometry, force: f64) -> Self {
        Self {
            geometry,
            compliance: Compliance::default(),
            force,
            stiffness: 0.0,
            damping: 0.0,
            by_place: 0.0,
            by_slide: 0.0,
            share: 1.0,
            share_s: 0.0,
            spring_rate: 0.0,
            slide: 0.0,
            spring: 0.0,
            elastic: 0.0,
            step: UnilateralStep::NONE,
            closing: 0.0,
            branch: 0,
        }
    }

    /// Force on the strip, N, world frame.
    #[must_use]
    pub fn force_on_strip(&self) -> Vector3<f64> {
        let normal = -self.force * self.geometry.normal;
        if self.compliance.slope == 0.0 {
            return normal;
        }
        normal + self.drive() * self.geometry.tangent()
    }

    /// Part of the contact force that a strip bears at rest, N: all of it, on a horn its vertical part.
    #[must_use]
    pub fn borne(&self) -> f64 {
        if self.geometry.foot == Vector3::zeros() {
            self.force
        } else {
            -self.force_on_strip().z
        }
    }

    /// `½ g_s F²`, N.
    fn drive(&self) -> f64 {
        0.5 * self.compliance.slope * self.force * self.force
    }

    /// Power that the damper turns into heat, W: power into the contact that its spring does not store, in the normal
    /// direction and along the wire. A spring that relaxes faster than the damper lets it press gives all of its energy
    /// to the damper.
    #[must_use]
    pub fn dissipation(&self) -> f64 {
        let along = 0.5 * self.compliance.slope * (self.force * self.force - self.elastic * self.elastic);
        (self.elastic - self.force) * self.geometry.gap_rate - along * self.slide
    }

    /// Raises the slopes in a step that closes: the chord to the closing is the lower bound of their weighted sum, so
    /// that corrections stay on the closed side. The force bends upwards from the closing, except in a step that began
    /// moving apart.
    pub(super) fn with_chord(self, weights: Weights) -> Self {
        let rate = -self.geometry.gap_rate;
        let ahead = self.step.ahead(-self.geometry.gap, rate);
        if !self.step.closes(ahead, rate) {
            return self;
        }
        let chord = self.step.chord(self.force, ahead, weights) - weights.v * self.damping;
        Self {
            stiffness: self.stiffness.max(chord / weights.q),
            ..self
        }
    }

    /// Removes the slope of `φ`: steps to come do not close the contact again.
    pub(super) fn lasting(self) -> Self {
        Self {
            stiffness: self.stiffness - self.closing,
            damping: self.damping - self.step.half * self.closing,
            ..self
        }
    }

    /// True if wire and strip press on each other.
    #[must_use]
    pub fn closed(&self) -> bool {
        self.force > 0.0
    }

    /// Share of the penetration that the contact spring has, –; 1 without residual compliance.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Position of the contact on the wire, m: that of the coordinates plus the wire's yielding.
    #[must_use]
    pub fn position(&self) -> Vector3<f64> {
        self.geometry.wire.r + self.yielded() * self.geometry.normal
    }

    /// Gap, m, positive when open; the wire's yielding included.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.geometry.gap + self.yielded()
    }

    /// `g F`, m.
    fn yielded(&self) -> f64 {
        self.compliance.value * self.force
    }

    /// Velocity of the wire's material at the contact, m/s.
    ///
    /// The force moves a point `x` by `g(x, x_c) F`; at the contact the rate of this at a fixed point of the wire is `g
    /// Ḟ + ½ g_s ṡ F`, for `g(x, y)` is symmetric. `Ḟ` is that of the contact spring.
    #[must_use]
    pub fn wire_velocity(&self) -> Vector3<f64> {
        let Compliance { value, slope } = self.compliance;
        let rate = value * self.spring_rate + 0.5 * slope * self.slide * self.force;
        self.geometry.wire.velocity + rate * self.geometry.normal
    }

    /// Change of the force; `slide` is the change of `ṡ`, m/s.
    pub(super) fn force_change(&self, variation: &Variation, slide: f64) -> f64 {
        -self.stiffness * variation.gap - self.damping * variation.gap_rate
            + self.by_place * variation.s
            + self.by_slide * slide
    }

    /// Change of all outputs; `slide` is the change of `ṡ` (m/s), `bend` is `g_ss` (1/(m N)), `wire` the change of the
    /// place and the velocity of the wire's material (m, m/s).
    pub(super) fn change(
        &self,
        variation: &Variation,
        (slide, bend): (f64, f64),
        wire: [Vector3<f64>; 2],
    ) -> Sensitivity {
        let Compliance { value, slope } = self.compliance;
        let normal = self.geometry.normal;
        let force = self.force_change(variation, slide);
        let yielded = value * force + slope * variation.s * self.force;
        let drive = slope * self.force * force + 0.5 * bend * variation.s * self.force * self.force;
        let at = &self.geometry.wire;
        let (k, share) = (self.spring, self.share);
        let share_ss = k * share * share * (2.0 * k * slope * slope * share - bend);
        let spring_rate = self.spring
            * (self.share * -variation.gap_rate
                + self.share_s
                    * (variation.s * -self.geometry.gap_rate - self.slide * variation.gap - slide * self.geometry.gap)
                - share_ss * variation.s * self.slide * self.geometry.gap);
        let rate = value * spring_rate
            + slope * (variation.s * self.spring_rate + 0.5 * slide * self.force + 0.5 * self.slide * force)
            + 0.5 * bend * variation.s * self.slide * self.force;
        Sensitivity {
            force,
            force_on_strip: -force * normal - self.force * variation.normal + drive * self.geometry.tangent(),
            gap: variation.gap + yielded,
            position: wire[0] + variation.s * at.r_s + yielded * normal + self.yielded() * variation.normal,
            velocity: wire[1] + variation.s * at.velocity_s + rate * normal,
        }
    }
}

/// `ṡ`: speed of the contact along the wire, m/s.
pub(super) fn slide(geometry: &ContactGeometry, strip: &Frame) -> f64 {
    let wire = (geometry.wire.velocity, geometry.wire.velocity_s);
    let moved = (strip.velocity, strip.angular_velocity);
    vary(geometry, strip, Some(wire), Some(moved)).s
}

/// First variation of the contact [Thesis, Eq. (11)–(16), for the normal of this module]: `wire` is the change of `r`
/// and `r_s` at fixed `s`, `strip` the translation and rotation of the strip.
pub(super) fn vary(
    g: &ContactGeometry,
    strip: &Frame,
    wire: Option<(Vector3<f64>, Vector3<f64>)>,
    moved: Option<(Vector3<f64>, Vector3<f64>)>,
) -> Variation {
    let (r, r_s) = wire.unwrap_or_default();
    let (p, theta) = moved.unwrap_or_default();
    let e = g.axis;
    let axis = theta.cross(&e);
    let foot = theta.cross(&g.foot);
    let w = g.wire.r - (strip.position + g.foot);
    let d = w - g.eta * e;
    let apart = r - (p + foot);
    let d_change = apart - e * (g.gain * e.dot(&apart)) - g.eta * axis - e * (g.gain * axis.dot(&w));
    let s = -(d_change.dot(&g.wire.r_s) + d.dot(&r_s)) / g.slope;
    let apart = apart + s * g.wire.r_s;
    let way = g.gain * (axis.dot(&w) + e.dot(&apart));
    let lever = way * e + g.eta * axis + foot;
    let normal = if g.normal_length > 0.0 {
        let turn = axis + way * g.bend;
        let cross = (r_s + s * g.wire.r_ss).cross(&e) + g.wire.r_s.cross(&turn);
        (cross - g.normal * g.normal.dot(&cross)) / g.normal_length
    } else {
        Vector3::zeros()
    };
    let relative = g.wire.velocity - strip.velocity - strip.angular_velocity.cross(&g.lever());
    let turning = strip.angular_velocity.cross(&lever);
    Variation {
        s,
        lever,
        normal,
        gap: g.normal.dot(&(r - (p + foot))) - g.eta * g.normal.dot(&axis),
        gap_rate: normal.dot(&relative) + g.normal.dot(&(s * g.wire.velocity_s - turning)),
    }
}
