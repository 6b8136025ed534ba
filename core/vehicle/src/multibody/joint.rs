//! Ideal joints between rigid bodies, or a body and the base.
use super::measure::add_square;
use super::{Anchor, Measure, Pair};
use dynamics::{Blocks, Constraint, JacobianRows, Motion};

/// Both points coincide.
const SPHERICAL: &[Measure] = &[Measure::Point(0), Measure::Point(1), Measure::Point(2)];

/// Both points coincide, and the third axes stay parallel: rotation about them is free.
const REVOLUTE: &[Measure] = &[
    Measure::Point(0),
    Measure::Point(1),
    Measure::Point(2),
    Measure::Direction(2, 0),
    Measure::Direction(2, 1),
];

/// All axes stay parallel, and the points stay on one third axis: translation along it is free.
const PRISMATIC: &[Measure] = &[
    Measure::Along(0),
    Measure::Along(1),
    Measure::Direction(0, 1),
    Measure::Direction(1, 2),
    Measure::Direction(2, 0),
];

/// Equations of a revolute joint about the vertical, in the plane along the track: both points coincide there, and the
/// bodies pitch together.
const UPRIGHT_IN_PLANE: &[Measure] = &[Measure::Point(0), Measure::Point(2), Measure::Direction(2, 0)];

/// Equations on the relative position of two anchors. [Haug 1989, chapter 9]
///
/// The equation for two perpendicular directions is their scalar product. The axis of a revolute or prismatic joint is
/// the third axis of both anchors, which coincide in the reference position.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    pair: Pair,
    equations: &'static [Measure],
}

impl Joint {
    /// Three equations: the points coincide (m).
    #[must_use]
    pub fn spherical(first: Anchor, second: Anchor) -> Self {
        Self {
            pair: Pair { first, second },
            equations: SPHERICAL,
        }
    }

    /// Five equations: the points coincide (m), the third axes are parallel (–).
    #[must_use]
    pub fn revolute(first: Anchor, second: Anchor) -> Self {
        Self {
            pair: Pair { first, second },
            equations: REVOLUTE,
        }
    }

    /// Three equations: those of [`Joint::revolute`] about the vertical for bodies that only move in the plane along
    /// the track. The third axes are vertical and the first ones along the track in the reference position.
    #[must_use]
    pub fn upright_in_plane(first: Anchor, second: Anchor) -> Self {
        Self {
            pair: Pair { first, second },
            equations: UPRIGHT_IN_PLANE,
        }
    }

    /// Five equations: the second point stays on the third axis of the first anchor (m), all axes are parallel (–).
    #[must_use]
    pub fn prismatic(first: Anchor, second: Anchor) -> Self {
        Self {
            pair: Pair { first, second },
            equations: PRISMATIC,
        }
    }

    /// Anchors of the joint.
    #[must_use]
    pub fn anchors(&self) -> [Anchor; 2] {
        [self.pair.first.clone(), self.pair.second.clone()]
    }

    /// Adds the geometric stiffness `∂(g_qᵀ λ)/∂q` under the multipliers `lambda` (one per equation), 12 × 12 or, with
    /// the base, 6 × 6.
    pub fn add_geometric_stiffness(&self, motion: &Motion<'_>, lambda: &[f64], blocks: &mut Blocks<'_>) {
        let view = self.pair.view(motion);
        let stiffness = self
            .equations
            .iter()
            .zip(lambda)
            .map(|(&measure, &multiplier)| view.hessian(measure) * multiplier)
            .sum();
        add_square(blocks, view.indices(), &stiffness);
    }
}

impl Constraint for Joint {
    fn dimension(&self) -> usize {
        self.equations.len()
    }

    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]) {
        self.pair.values(motion, self.equations, g);
    }

    fn jacobian(&self, motion: &Motion<'_>, rows: &mut JacobianRows<'_>) {
        let view = self.pair.view(motion);
        let indices = view.indices();
        for (row, &measure) in self.equations.iter().enumerate() {
            rows.add(row, indices, &view.gradient(measure).as_slice()[..indices.len()]);
        }
    }

    fn add_velocity_terms(&self, motion: &Motion<'_>, g: &mut [f64]) -> bool {
        let view = self.pair.view(motion);
        let indices = view.indices();
        for (g, &measure) in g.iter_mut().zip(self.equations) {
            let hessian = view.hessian(measure);
            for (k, &of_row) in indices.iter().enumerate() {
                for (l, &of_column) in indices.iter().enumerate() {
                    *g += motion.v[of_row] * hessian[(k, l)] * motion.v[of_column];
                }
            }
        }
        true
    }
}
