//! Solution of a mode over a step: exact, or implicit where it would turn too far.
use super::Aligned;
use nalgebra::{Matrix2, Matrix2x4, RowVector2, SMatrix, Vector2};
use std::f64::consts::PI;
use std::ops::Range;

/// Largest angle by which a mode turns in a step that is solved exactly, rad. Beyond half a turn a force that rises
/// within the step makes a mode overshoot: forces that follow from its motion, as that of a slack dropper, would swing.
pub const LARGEST_TURN: f64 = 1.1 * PI;
/// `γ` of Newmark's rule beyond: damps what the step cannot follow, and keeps the inertia of what it can. Chosen by
/// lines with droppers of 1e5 to 1e7 N/m in steps of 1 and 2.5 ms.
const GAMMA: f64 = 0.7;

/// Factors of a step of `h` s for all modes, each a vector over the modes:
///
/// ```text
/// q₁ − q₀ = qq q₀ + qv v₀ + q0 r₀ + q1 r₁ − qb s
/// v₁ − v₀ = vq q₀ + vv v₀ + v0 r₀ + v1 r₁ − vb s
/// ```
///
/// with the modal force `r₀ + (r₁ − r₀) τ/h − ½ τ (h − τ) s` at `τ` in the step, `s` its second derivative. A step of
/// 0 s leads to the state at rest under `r₁`. Changes over a step keep their digits in single precision: a slow mode
/// changes by a millionth of itself. Modes that turn by more than 1.1 π in a step follow Newmark's rule,
/// which knows the forces at the ends of the step only.
#[derive(Clone, Debug)]
pub struct StepFactors {
    /// Length of the step, s.
    pub h: f64,
    /// Change of `q` by `q₀`, –.
    pub qq: Aligned,
    /// Change of `q` by `v₀`, s.
    pub qv: Aligned,
    /// Change of `q` by `r₀`, s².
    pub q0: Aligned,
    /// Change of `q` by `r₁`, s².
    pub q1: Aligned,
    /// Change of `v` by `q₀`, 1/s.
    pub vq: Aligned,
    /// Change of `v` by `v₀`, –.
    pub vv: Aligned,
    /// Change of `v` by `r₀`, s.
    pub v0: Aligned,
    /// Change of `v` by `r₁`, s.
    pub v1: Aligned,
    /// Change of `q` by `−s`, s⁴.
    pub qb: Aligned,
    /// Change of `v` by `−s`, s³.
    pub vb: Aligned,
}

/// Factors of some modes.
#[derive(Clone, Copy)]
pub struct Factors<'a> {
    pub(super) qq: &'a [f32],
    pub(super) qv: &'a [f32],
    pub(super) q0: &'a [f32],
    pub(super) q1: &'a [f32],
    pub(super) vq: &'a [f32],
    pub(super) vv: &'a [f32],
    pub(super) v0: &'a [f32],
    pub(super) v1: &'a [f32],
    pub(super) qb: &'a [f32],
    pub(super) vb: &'a [f32],
}

impl StepFactors {
    /// Factors of the modes `range`.
    #[must_use]
    #[inline]
    pub fn of(&self, range: Range<usize>) -> Factors<'_> {
        Factors {
            qq: &self.qq[range.clone()],
            qv: &self.qv[range.clone()],
            q0: &self.q0[range.clone()],
            q1: &self.q1[range.clone()],
            vq: &self.vq[range.clone()],
            vv: &self.vv[range.clone()],
            v0: &self.v0[range.clone()],
            v1: &self.v1[range.clone()],
            qb: &self.qb[range.clone()],
            vb: &self.vb[range],
        }
    }

    /// Factors of modes with these `ωₖ²` (1/s²) and `cₖ` (1/s).
    #[must_use]
    pub fn new(stiffness: &[f64], damping: &[f64], h: f64) -> Self {
        let zeros = || Aligned::zeros(stiffness.len());
        let mut factors = Self {
            h,
            qq: zeros(),
            qv: zeros(),
            q0: zeros(),
            q1: zeros(),
            vq: zeros(),
            vv: zeros(),
            v0: zeros(),
            v1: zeros(),
            qb: zeros(),
            vb: zeros(),
        };
        for (mode, (&stiffness, &damping)) in stiffness.iter().zip(damping).enumerate() {
            let [q, v] = if h == 0.0 {
                [[0.0, 0.0, 0.0, 1.0 / stiffness, 0.0], [0.0; 5]]
            } else if stiffness.sqrt() * h > LARGEST_TURN {
                newmark(stiffness, damping, h)
            } else {
                over(stiffness, damping, h)
            };
            let rows = [
                (&mut factors.qq, q[0] - 1.0),
                (&mut factors.qv, q[1]),
                (&mut factors.q0, q[2]),
                (&mut factors.q1, q[3]),
                (&mut factors.vq, v[0]),
                (&mut factors.vv, v[1] - 1.0),
                (&mut factors.v0, v[2]),
                (&mut factors.v1, v[3]),
                (&mut factors.qb, q[4]),
                (&mut factors.vb, v[4]),
            ];
            for (row, factor) in rows {
                row[mode] = factor as f32;
            }
        }
        factors
    }
}

/// Matrix of `(q, v, r, ṙ, r̈)`.
type Rates = SMatrix<f64, 5, 5>;

/// Both rows of one mode: the exponential of `h` times the matrix of `(q, v, r, ṙ, r̈)`.
fn over(stiffness: f64, damping: f64, h: f64) -> [[f64; 5]; 2] {
    // Rates per step: v and ṙ in units of a step, r̈ in those of its square.
    let mut rate = Rates::zeros();
    (rate[(0, 1)], rate[(2, 3)], rate[(3, 4)]) = (1.0, 1.0, 1.0);
    (rate[(1, 0)], rate[(1, 1)], rate[(1, 2)]) = (-stiffness * h * h, -damping * h, h * h);
    let e = exponential(&rate);
    let row = |i: usize, unit: f64| {
        [
            e[(i, 0)] * unit,
            e[(i, 1)] * h * unit,
            (e[(i, 2)] - e[(i, 3)]) * unit,
            e[(i, 3)] * unit,
            (0.5 * e[(i, 3)] - e[(i, 4)]) * h * h * unit,
        ]
    };
    [row(0, 1.0), row(1, 1.0 / h)]
}

/// See [`over`], by the rule of Newmark (1959) with the `β` that damps most, `(γ + ½)²/4`: the answer to a force at
/// the end of the step rises to that at rest and never beyond.
fn newmark(stiffness: f64, damping: f64, h: f64) -> [[f64; 5]; 2] {
    let beta = 0.25 * (GAMMA + 0.5).powi(2);
    // Accelerations at the begin and at the end, each as its share in `q₁` and in `v₁`.
    let before = Vector2::new((0.5 - beta) * h * h, (1.0 - GAMMA) * h);
    let now = Vector2::new(beta * h * h, GAMMA * h);
    let own = RowVector2::new(stiffness, damping);
    // end (q₁, v₁) = begin (q₀, v₀, r₀, r₁).
    let end = Matrix2::identity() + now * own;
    let motion = Matrix2::new(1.0, h, 0.0, 1.0) - before * own;
    let begin = Matrix2x4::from_columns(&[motion.column(0), motion.column(1), before.column(0), now.column(0)]);
    let rows = end.try_inverse().expect("its determinant is above one") * begin;
    [0, 1].map(|row| std::array::from_fn(|k| if k < 4 { rows[(row, k)] } else { 0.0 }))
}

/// `exp(A)` by scaling and squaring of the series.
fn exponential(a: &Rates) -> Rates {
    /// Terms that leave the rounding error of a matrix with a norm of a half.
    const TERMS: usize = 14;
    let norm = a.abs().column_sum().max();
    let halvings = if norm > 0.5 {
        (2.0 * norm).log2().ceil() as i32
    } else {
        0
    };
    let a = a / 2.0_f64.powi(halvings);
    let mut sum = Rates::identity();
    for term in (1..=TERMS).rev() {
        sum = Rates::identity() + a * sum / term as f64;
    }
    for _ in 0..halvings {
        sum *= sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_follows_the_closed_form_of_an_oscillator() {
        let (omega, damping, h) = (40.0_f64, 6.0, 0.03);
        let [q, v] = over(omega * omega, damping, h);
        let half = 0.5 * damping;
        let turn = (omega * omega - half * half).sqrt();
        let decay = (-half * h).exp();
        let (cos, sin) = ((turn * h).cos(), (turn * h).sin());
        assert!((q[0] - decay * (cos + half / turn * sin)).abs() < 1e-14);
        assert!((q[1] - decay * sin / turn).abs() < 1e-14);
        assert!((v[0] + decay * omega * omega / turn * sin).abs() < 1e-12);
        assert!((v[1] - decay * (cos - half / turn * sin)).abs() < 1e-14);
        // Under a constant force, from rest.
        let constant = (1.0 - decay * (cos + half / turn * sin)) / (omega * omega);
        assert!((q[2] + q[3] - constant).abs() < 1e-16);
        assert!((v[2] + v[3] - decay * sin / turn).abs() < 1e-14);
        // Under a force that rises with the square of time, from rest, with no damping.
        let [q, v] = over(omega * omega, 0.0, h);
        let (cos, sin) = ((omega * h).cos(), (omega * h).sin());
        let end = 0.5 * h * h;
        let quadratic = (end - (1.0 - cos) / (omega * omega)) / (omega * omega);
        assert!((q[3] * end - q[4] - quadratic).abs() < 1e-17);
        assert!((v[3] * end - v[4] - (h - sin / omega) / (omega * omega)).abs() < 1e-15);
        // A rate whose exponential is beyond all series.
        let [stiff, _] = over(1e10, 1e6, h);
        assert!((stiff[2] + stiff[3] - 1e-10).abs() < 1e-15 && stiff[0].abs() < 1e-9);
    }

    #[test]
    fn a_mode_that_turns_too_far_never_overshoots_and_comes_to_rest() {
        for turn in [1.2 * PI, 3.0 * PI, 100.0 * PI] {
            let (stiffness, h) = (1.0e6, turn / 1.0e3);
            let [q, v] = newmark(stiffness, 0.0, h);
            // A force that rises in the step, against that at rest: exactly it would be up to a fifth more.
            let answer = q[3] * stiffness;
            assert!(answer > 0.7 && answer <= 1.0, "{turn}: {answer}");
            // Rest under a constant force stays.
            assert!((q[0] / stiffness + q[2] + q[3] - 1.0 / stiffness).abs() < 1e-15);
            assert!((v[0] / stiffness + v[2] + v[3]).abs() < 1e-12);
            let mut motion = [1.0, 0.0];
            for _ in 0..200 {
                motion = [q, v].map(|row| row[0] * motion[0] + row[1] * motion[1]);
            }
            assert!(motion[0].abs() < 1e-2, "{turn}: {motion:?}");
        }
    }

    #[test]
    fn the_implicit_rule_is_of_first_order() {
        // Free motion of an oscillator through a sixth of a turn.
        let (omega, time) = (40.0_f64, 0.026);
        let error = |steps: u32| {
            let [q, v] = newmark(omega * omega, 0.0, time / f64::from(steps));
            let mut motion = [1.0, 0.0];
            for _ in 0..steps {
                motion = [q, v].map(|row| row[0] * motion[0] + row[1] * motion[1]);
            }
            (motion[0] - (omega * time).cos()).abs()
        };
        let ratio = error(64) / error(128);
        assert!((ratio - 2.0).abs() < 0.2, "{ratio}");
    }

    #[test]
    fn two_steps_are_one_of_twice_the_length() {
        let (stiffness, damping) = (900.0, 1.5);
        let [q, v] = over(stiffness, damping, 0.01);
        let [whole, _] = over(stiffness, damping, 0.02);
        let step = |[x, y]: [f64; 2], r: [f64; 2]| {
            let row = |row: [f64; 5]| row[0] * x + row[1] * y + row[2] * r[0] + row[3] * r[1];
            [row(q), row(v)]
        };
        let twice = step(step([0.3, -2.0], [5.0, 7.0]), [7.0, 9.0]);
        let once = whole[0] * 0.3 + whole[1] * -2.0 + whole[2] * 5.0 + whole[3] * 9.0;
        assert!((twice[0] - once).abs() < 1e-14);
    }
}
