//! Ends of the wires under tensioning weights.
use dynamics::{Blocks, Force, Motion, Weights};

/// End of a wire that slides along the track under a constant force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineEnd {
    /// Coordinate of the displacement along x.
    pub index: usize,
    /// Force on the wire along x, N; negative at the first end.
    pub force: f64,
}

/// The ends of both wires under constant horizontal tension.
///
/// ```text
/// F = F₀ − k u,    k = 10 N/m
/// ```
///
/// Between two tensioning weights, with supports that are free along the track, a line would have no position along the
/// track at all. The spring `k` fixes the position, as the friction of real tensioning devices does: a displacement of
/// 1 cm changes a tension of 20 kN by 0.1 N.
#[derive(Clone, Debug, Default)]
pub struct LineEnds {
    ends: Vec<LineEnd>,
}

/// `k`, N/m.
pub(crate) const HOLDING_STIFFNESS: f64 = 10.0;

impl LineEnds {
    /// Sliding ends; empty for fixed ends.
    #[must_use]
    pub fn new(ends: Vec<LineEnd>) -> Self {
        Self { ends }
    }

    /// Changes the force on the end with this coordinate, N.
    pub fn pull(&mut self, index: usize, force: f64) {
        let end = self.ends.iter_mut().find(|end| end.index == index);
        end.expect("the end slides").force = force;
    }
}

impl Force for LineEnds {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for end in &self.ends {
            force[end.index] += end.force - HOLDING_STIFFNESS * motion.q[end.index];
        }
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for end in &self.ends {
            blocks.add(&[end.index], &[end.index], &[weights.q * HOLDING_STIFFNESS]);
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.ends
            .iter()
            .map(|end| {
                let u = motion.q[end.index];
                0.5 * HOLDING_STIFFNESS * u * u - end.force * u
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::testing::{assert_law, plain_layout};

    #[test]
    fn force_is_the_gradient_of_the_energy_and_the_tangent_its_jacobian() {
        let mut ends = LineEnds::new(vec![LineEnd {
            index: 1,
            force: -2.0e4,
        }]);
        let layout = plain_layout(2);
        let mut state = layout.state_at_rest();
        state.q[1] = 0.3;
        assert_law(&mut ends, &layout, &state);
        let mut force = [0.0; 2];
        ends.add_force(&state.motion(&[]), &mut force);
        assert_eq!(force[0], 0.0);
        let mut tangent = [0.0];
        ends.add_tangent(
            &state.motion(&[]),
            Weights { q: 2.0, v: 1.0 },
            &mut Blocks::add_to(&[0], &mut tangent),
        );
        assert_eq!(tangent, [20.0]);
    }
}
