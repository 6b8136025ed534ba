//! Unilateral law: a spring and a damper that only push (a contact) or only pull (a dropper), over a time step.
use crate::Weights;
use crate::simd::Number;

/// `max(0, k δ + φ d δ̇)`, N: force of a unilateral spring `k` (N/m) and damper `d` (N·s/m). `part` is `φ`, the
/// fraction of the time step in which the damper acts, see [`UnilateralStep`].
#[inline(always)]
pub fn unilateral_force<N: Number>((k, d): (f64, f64), part: N, delta: N, rate: N) -> N {
    (delta * k + part * d * rate).at_least(0.0)
}

/// Closure `δ⁺₀` with which a time step begins, see [`UnilateralStep`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UnilateralStart {
    /// No step has ended yet, or there is no step. The damper acts wherever `δ > 0`.
    Unknown,
    /// `δ⁺₀` in m; negative for an open contact or a slack dropper.
    Known(f64),
}

impl UnilateralStart {
    /// A strip beside the wire or beyond its ends. The damper leaves out the step in which the strip arrives, from
    /// wherever the strip comes.
    pub const APART: Self = Self::Known(-f64::MAX);

    /// Appends the closure to the values that a contribution saves.
    pub fn save(self, out: &mut Vec<f64>) {
        match self {
            Self::Unknown => out.extend([0.0, 0.0]),
            Self::Known(start) => out.extend([1.0, start]),
        }
    }

    /// Reads the two values that [`UnilateralStart::save`] appended.
    pub fn restored(values: &mut std::slice::Iter<'_, f64>) -> Self {
        let mut next = || next_of(values);
        match (next(), next()) {
            (0.0, _) => Self::Unknown,
            (_, start) => Self::Known(start),
        }
    }
}

/// Next value of a saved history; one that is too short, as no own one is, goes on without a number, which the next
/// step refuses.
pub fn next_of(values: &mut std::slice::Iter<'_, f64>) -> f64 {
    values.next().copied().unwrap_or(f64::NAN)
}

/// Appends half of the present step, s, and the closures `δ⁺₀` of all members, m, to the values that a contribution
/// saves.
pub fn save_step(half: f64, start_closure: &[f64], out: &mut Vec<f64>) {
    out.push(half);
    out.extend_from_slice(start_closure);
}

/// Reads the values that [`save_step`] appended.
pub fn restore_step(half: &mut f64, start_closure: &mut [f64], values: &mut std::slice::Iter<'_, f64>) {
    for value in std::iter::once(half).chain(start_closure) {
        *value = next_of(values);
    }
}

/// Unilateral spring and damper over a time step of `h`: the fraction `φ` of the step in which the damper acts.
///
/// The closure `δ` is the penetration of a contact or the elongation of a dropper; a member under force is called
/// closed.
///
/// A damper that acts wherever `δ > 0` jumps from 0 to `d δ̇` at closing. An implicit step solves `S (δ − δ*) + F(δ) =
/// 0`, with `δ*` the end of the step without the force. With `0 < S δ* < d δ̇` there is no solution: an open end has to
/// move on to `δ* > 0`, and a closed end is thrown back.
///
/// The trapezoidal rule takes the force at the end of a step for half of that step and half of the next one, a time `h`
/// around that end. The damper acts for the part of this time in which the member is closed. Along straight lines a
/// member is closed where `δ⁺ = δ + ½ h δ̇`, half a step ahead, is above zero, from `δ⁺₀` at the beginning of the step
/// to `δ⁺` at its end (derived here):
///
/// ```text
/// φ = δ⁺/(δ⁺ − δ⁺₀)     δ⁺ > 0 > δ⁺₀, δ̇ > 0
/// φ = 0                 δ⁺₀ < 0, δ⁺ ≤ 0, δ̇ > 0
/// φ = 1                 otherwise
/// ```
///
/// The impulse of a closing and the place where the closing stops are thus neither late nor early in the mean, whenever
/// within a step the closing comes. A strong damper stops a mass at once, and `φ` by `δ` in place of `δ⁺` would stop
/// the mass too late, by `|½ − τ| h δ̇` for a closing at the fraction `τ` of a step: droppers of long relaxation time
/// keep that distance for many steps, and it would be most of the time step's error. A damper stronger than `2 μ/h`,
/// `μ` the mass that it stops, makes the trapezoidal rule throw the mass back.
///
/// `F = max(0, k δ + φ d δ̇)` is continuous in `δ` and `δ̇` and never falls with `δ` along a step, where `δ̇ = A + c δ`
/// with `c > 0` and so `δ⁺` too rise with `δ`: `φ δ̇` does not fall where `δ̇ > 0`, and `φ = 1` elsewhere. A step
/// therefore has exactly one end. In a step that begins closed `k δ + d δ̇` is not cut at `δ⁺ = 0`, where the sum need
/// not be zero; a member that opens and comes back within the step then carries a force across a gap of at most `d δ̇`.
/// `φ` is also continuous in `δ⁺₀` while `δ⁺ > 0`: runs that differ by rounding or by a coupling's tolerance stay
/// together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnilateralStep {
    /// Closure at the beginning of the step.
    pub start: UnilateralStart,
    /// `½ h`, s; zero where there is no step.
    pub half: f64,
}

/// Cases of a step by its beginning, and by `δ⁺` and `δ̇` at its end.
#[derive(Clone, Copy)]
enum UnilateralCase {
    /// The step began closed.
    Closed,
    /// `δ̇ ≤ 0`
    Parting,
    /// `δ⁺ ≤ 0`
    Apart,
    /// The member closes, or the beginning of the step is unknown.
    Closing,
}

impl UnilateralStep {
    /// No step.
    pub const NONE: Self = Self {
        start: UnilateralStart::Unknown,
        half: 0.0,
    };

    /// A step that begins with `start`, of twice `half` s.
    #[must_use]
    #[inline]
    pub fn new(start: UnilateralStart, half: f64) -> Self {
        Self { start, half }
    }

    /// `δ⁺`, m, of `delta` in m that changes with `rate` in m/s.
    #[must_use]
    #[inline]
    pub fn ahead(self, delta: f64, rate: f64) -> f64 {
        delta + self.half * rate
    }

    /// `φ` (–) and `∂φ/∂δ⁺` (1/m) for `δ⁺` in m and `δ̇` in m/s.
    #[must_use]
    #[inline]
    pub fn closed_part(self, ahead: f64, rate: f64) -> (f64, f64) {
        match (self.case(ahead, rate), self.start) {
            (UnilateralCase::Closed | UnilateralCase::Parting, _)
            | (UnilateralCase::Closing, UnilateralStart::Unknown) => (1.0, 0.0),
            (UnilateralCase::Apart, _) => (0.0, 0.0),
            (UnilateralCase::Closing, UnilateralStart::Known(start)) => {
                let way = ahead - start;
                let part = ahead / way;
                (part, (1.0 - part) / way)
            }
        }
    }

    /// The case of [`UnilateralStep::closed_part`].
    fn case(self, ahead: f64, rate: f64) -> UnilateralCase {
        match self.start {
            UnilateralStart::Known(start) if start >= 0.0 => UnilateralCase::Closed,
            _ if rate <= 0.0 => UnilateralCase::Parting,
            _ if ahead <= 0.0 => UnilateralCase::Apart,
            _ => UnilateralCase::Closing,
        }
    }

    /// Number of the branch of the law: the case of [`UnilateralStep::closed_part`] and whether there is a `force` (N).
    /// Between two motions on the same branch the force is smooth.
    #[inline]
    pub fn branch(self, ahead: f64, rate: f64, force: f64) -> u8 {
        2 * self.case(ahead, rate) as u8 + u8::from(force > 0.0)
    }

    /// True for a step known to have begun open.
    #[inline]
    pub fn began_open(self) -> bool {
        matches!(self.start, UnilateralStart::Known(start) if start < 0.0)
    }

    /// True for a step that began open and ends closed, with `ahead` and `rate` at its end.
    #[inline]
    pub fn closes(self, ahead: f64, rate: f64) -> bool {
        self.began_open() && ahead > 0.0 && rate > 0.0
    }

    /// Slope of `force` in N by the chord to the closing, weighted as tangents are, N/m: lower bound of the tangent in
    /// a step that closes, so that no correction opens the member again.
    #[inline]
    pub fn chord(self, force: f64, ahead: f64, weights: Weights) -> f64 {
        (weights.q + self.half * weights.v) * force / ahead
    }
}
