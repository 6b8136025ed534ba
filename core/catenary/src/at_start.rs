//! What a time step knows at its beginning of what presses or pulls one way only: a contact, a dropper.

/// `max(0, k δ + φ d δ̇)`, N: the force of a spring `k` (N/m) and a damper `d` (N·s/m) that act one way only, the damper for the `part`
/// `φ` of a step, see [`AtStart`].
#[inline]
pub(crate) fn one_way_force((k, d): (f64, f64), part: f64, delta: f64, rate: f64) -> f64 {
    (k * delta + part * d * rate).max(0.0)
}

/// What a time step knows at its beginning of a spring and a damper that act one way only, where `δ > 0`: how long in it the damper
/// acts. `δ` is the penetration of a contact or the elongation of a dropper; closed is what is under force.
///
/// A damper that acts wherever `δ > 0` jumps from 0 to `d δ̇` where it closes. An implicit step looks for an end at which
/// inertia and force agree, `S (δ − δ*) + F(δ) = 0`, with `δ*` where the step would end without the force. With
/// `0 < S δ* < d δ̇` it finds none: what ends open has to move on to `δ* > 0`, and what ends closed is thrown back. So in a step
/// that closes the damper acts with the part of the step in which it is closed, by a straight course from
/// `δ₀ < 0` at its beginning to `δ` at its end (derived here):
///
/// ```text
/// φ = δ/(δ − δ₀)    δ > 0 > δ₀
/// φ = 1              δ₀ ≥ 0
/// φ = 0              otherwise
/// ```
///
/// `F = max(0, k δ + φ d δ̇)` is then continuous in `δ` and `δ̇`. It never falls with `δ` in a step, along which
/// `δ̇ = A + c δ`, `c > 0`: `F = δ max(0, G)`, `G = k + d δ̇/(δ − δ₀)`, and where `δ̇ ≤ 0` `G` rises, elsewhere both `δ` and `φ δ̇` do. So
/// there is one end of the step. In a step that begins closed `k δ + d δ̇` rises throughout, and is not cut at `δ = 0`, where it need
/// not be zero; a force across a gap is then one of at most `d δ̇`, of what opened and comes back within the step.
/// `φ` is also continuous in `δ₀` while `δ > 0`: runs that differ by rounding, or by what a coupling leaves, stay together.
///
/// What it costs: the trapezoid takes `½ φ h` of the damper in the step that closes and `½ (φ + 1) h` in the next, in place of `φ h`
/// and `h`: half a step of `d δ̇` per closing, whenever in a step that is. Elsewhere nothing changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AtStart {
    /// Nothing: no step has ended yet, or there is no step. The damper acts wherever `δ > 0`.
    Unknown,
    /// `δ₀` in m, negative for what is open.
    At(f64),
}

impl AtStart {
    /// A strip that is beside the wire or beyond its ends: wherever it comes from, the damper leaves out the step in which it comes.
    pub const APART: Self = Self::At(-f64::MAX);

    /// `φ` (–) and `∂φ/∂δ` (1/m) for `δ` in m.
    #[must_use]
    pub fn closed_part(self, delta: f64) -> (f64, f64) {
        match self {
            Self::At(start) if start >= 0.0 => (1.0, 0.0),
            _ if delta <= 0.0 => (0.0, 0.0),
            Self::Unknown => (1.0, 0.0),
            Self::At(start) => {
                let way = delta - start;
                let part = delta / way;
                (part, (1.0 - part) / way)
            }
        }
    }

    /// Whether it is known to be open.
    pub(crate) fn is_open(self) -> bool {
        matches!(self, Self::At(start) if start < 0.0)
    }

    /// Appends it to what a contribution saves.
    pub(crate) fn save(self, out: &mut Vec<f64>) {
        match self {
            Self::Unknown => out.extend([0.0, 0.0]),
            Self::At(start) => out.extend([1.0, start]),
        }
    }

    /// Takes back what [`AtStart::save`] appended.
    pub(crate) fn restored(values: &mut std::slice::Iter<'_, f64>) -> Self {
        let mut next = || {
            *values
                .next()
                .expect("a saved contact holds two numbers for each beginning")
        };
        match (next(), next()) {
            (0.0, _) => Self::Unknown,
            (_, start) => Self::At(start),
        }
    }
}
