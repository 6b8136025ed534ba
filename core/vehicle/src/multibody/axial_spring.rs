//! Springs and dampers along a guided axis.
use super::measure::add_square;
use super::{Measure, Pair};
use dynamics::{Blocks, Force, Motion, Weights};

/// A spring–damper along the third axis of the first anchor, with a constant preload.
///
/// ```text
/// F = P − k s − c ṡ,    s = a · (r_B − r_A)
/// ```
///
/// `F` acts along `+a` on the second anchor and along `−a` on the first: a positive preload pushes them apart. The
/// potential is `½ k s² − P s`.
#[derive(Clone, Debug, PartialEq)]
pub struct AxialSpring {
    /// Anchors of the spring.
    pub pair: Pair,
    /// `k`, N/m.
    pub stiffness: f64,
    /// `c`, N·s/m.
    pub damping: f64,
    /// `P`, N: the force at `s = 0` at rest.
    pub preload: f64,
}

impl AxialSpring {
    const MEASURE: Measure = Measure::Along(2);

    /// `s`, m.
    #[must_use]
    pub fn elongation(&self, motion: &Motion<'_>) -> f64 {
        self.pair.view(motion).value(Self::MEASURE)
    }
}

impl Force for AxialSpring {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let view = self.pair.view(motion);
        let s_q = view.gradient(Self::MEASURE);
        let rate: f64 = view
            .indices()
            .iter()
            .zip(&s_q)
            .map(|(&index, s)| s * motion.v[index])
            .sum();
        let axial = self.preload - self.stiffness * view.value(Self::MEASURE) - self.damping * rate;
        for (&index, s) in view.indices().iter().zip(&s_q) {
            force[index] += axial * s;
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let view = self.pair.view(motion);
        let s_q = view.gradient(Self::MEASURE);
        let s_qq = view.hessian(Self::MEASURE);
        let mut v = s_q * 0.0;
        for (v, &index) in v.iter_mut().zip(view.indices()) {
            *v = motion.v[index];
        }
        let axial = self.preload - self.stiffness * view.value(Self::MEASURE) - self.damping * s_q.dot(&v);
        // ∂ṡ/∂q at constant v
        let rate_q = s_qq.transpose() * v;
        let stiffness = s_q * (s_q * self.stiffness + rate_q * self.damping).transpose() - s_qq * axial;
        let damping = s_q * s_q.transpose() * self.damping;
        add_square(blocks, view.indices(), &(stiffness * weights.q + damping * weights.v));
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let s = self.elongation(motion);
        0.5 * self.stiffness * s * s - self.preload * s
    }
}
