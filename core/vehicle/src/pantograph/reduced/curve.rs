//! The one motion of a mechanism, tabulated.
use super::plane::Plane;
use crate::VehicleError;
use crate::error::Irreducible;
use nalgebra::DVector;

/// A quantity and its first and second derivative with respect to the coordinate of the motion.
pub(super) type Jet = [f64; 3];

/// Quantities along the motion of a mechanism: quintic Hermite polynomials between nodes at equal distances.
///
/// The polynomials keep value, first and second derivative of the nodes: all results are those of one smooth mechanism
/// that differs from the tabulated mechanism by the sixth power of the node distance.
#[derive(Clone, Debug)]
pub(super) struct MotionCurve<const N: usize> {
    /// Coordinate of the first node, √kg·m.
    first: f64,
    last: f64,
    inverse_step: f64,
    /// Polynomials of each interval between nodes.
    intervals: Vec<[Quintic; N]>,
}

impl<const N: usize> MotionCurve<N> {
    /// Motion through at least two `nodes`.
    pub fn new(first: f64, step: f64, nodes: &[[Jet; N]]) -> Self {
        let interval = |pair: &[[Jet; N]]| std::array::from_fn(|i| Quintic::new(pair[0][i], pair[1][i], step));
        Self {
            first,
            last: first + step * (nodes.len() - 1) as f64,
            inverse_step: 1.0 / step,
            intervals: nodes.windows(2).map(interval).collect(),
        }
    }

    /// Range of the coordinate.
    pub fn range(&self) -> (f64, f64) {
        (self.first, self.last)
    }

    /// All quantities at `sigma`; NaN outside the range.
    pub fn at(&self, sigma: f64) -> [Jet; N] {
        if !(self.first..=self.last).contains(&sigma) {
            return [[f64::NAN; 3]; N];
        }
        let place = (sigma - self.first) * self.inverse_step;
        let number = (place as usize).min(self.intervals.len() - 1);
        let x = place - number as f64;
        let interval = &self.intervals[number];
        std::array::from_fn(|i| interval[i].at(x, self.inverse_step))
    }
}

/// Coefficients of a polynomial of the fifth degree in `x = 0…1`.
#[derive(Clone, Copy, Debug)]
struct Quintic([f64; 6]);

impl Quintic {
    /// Polynomial from `a` at `x = 0` to `b` at `x = 1`, an interval of length `h`.
    fn new(a: Jet, b: Jet, h: f64) -> Self {
        let [a0, a1, a2] = [a[0], h * a[1], 0.5 * h * h * a[2]];
        let (d0, d1, d2) = (b[0] - a0 - a1 - a2, h * b[1] - a1 - 2.0 * a2, h * h * b[2] - 2.0 * a2);
        Self([
            a0,
            a1,
            a2,
            10.0 * d0 - 4.0 * d1 + 0.5 * d2,
            -15.0 * d0 + 7.0 * d1 - d2,
            6.0 * d0 - 3.0 * d1 + 0.5 * d2,
        ])
    }

    /// Value and derivatives with respect to the coordinate; `rate` is `dx/dσ`.
    fn at(&self, x: f64, rate: f64) -> Jet {
        let [c0, c1, c2, c3, c4, c5] = self.0;
        [
            c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5)))),
            (c1 + x * (2.0 * c2 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) * rate,
            (2.0 * c2 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))) * (rate * rate),
        ]
    }
}

/// One configuration of the motion with derivatives.
pub(super) struct Node {
    pub q: DVector<f64>,
    pub first: DVector<f64>,
    pub second: DVector<f64>,
}

/// Nodes of a motion through the reference position.
pub(super) struct Path {
    /// Coordinate of the first node, √kg·m; the reference position is at 0.
    pub first: f64,
    pub step: f64,
    pub nodes: Vec<Node>,
}

/// Turn of the fastest body between nodes in the reference position, rad: between nodes joints stay closed to 1e-12 m.
const TURN: f64 = 0.005;

/// Turn of any body from the reference position at which the table ends, rad.
const LONGEST_TURN: f64 = 1.2;

/// Change of a body's turn per node, relative to the largest turn per node, beyond which the mechanism counts as
/// singular.
const BEND: f64 = 0.1;

/// Nodes to either side.
const LONGEST: usize = 2000;

impl Path {
    /// Motion of `plane`, to both sides up to a singular position, [`LONGEST_TURN`], or the first node for which `ends`
    /// holds, in the direction of growing `rise`, a function of the tangent.
    ///
    /// # Errors
    /// [`VehicleError::NotReducible`].
    pub fn trace(
        plane: &Plane,
        rise: impl Fn(&DVector<f64>) -> f64,
        ends: impl Fn(&DVector<f64>) -> bool,
    ) -> Result<Self, VehicleError> {
        // Every joint is one point of the tabulated position, so that the joints are closed there.
        let q = plane.reference();
        let mut tangent = plane.start(&q).ok_or(Irreducible::SeveralMotions)?;
        if rise(&tangent) < 0.0 {
            tangent = -tangent;
        }
        let step = TURN / largest_turn(&tangent);
        if !step.is_finite() {
            return Err(Irreducible::NoTurn.into());
        }
        let side = |sign: f64| {
            let mut nodes: Vec<Node> = Vec::new();
            let (mut q, mut along) = (q.clone(), &tangent * sign);
            while nodes.len() < LONGEST {
                let next = plane.advance(&q, &along, step);
                let Some(next) = next.and_then(|q| plane.tangent(&q, &along).map(|along| (q, along))) else {
                    break;
                };
                (q, along) = next;
                let Some(node) = node(plane, &q, &(&along * sign)) else {
                    break;
                };
                let bend = largest_turn(&node.second) * step;
                if ends(&q) || largest_turn(&q) > LONGEST_TURN || bend > BEND * largest_turn(&node.first) {
                    break;
                }
                nodes.push(node);
            }
            nodes
        };
        let mut nodes: Vec<Node> = side(-1.0).into_iter().rev().collect();
        let before = nodes.len();
        let reference = node(plane, &q, &tangent);
        nodes.extend(reference);
        nodes.extend(side(1.0));
        if before == 0 || nodes.len() < before + 2 {
            return Err(Irreducible::Singular.into());
        }
        Ok(Self {
            first: -(before as f64) * step,
            step,
            nodes,
        })
    }
}

fn node(plane: &Plane, q: &DVector<f64>, first: &DVector<f64>) -> Option<Node> {
    Some(Node {
        q: q.clone(),
        first: first.clone(),
        second: plane.curvature(q, first)?,
    })
}

/// The largest of the angles among (x, z, φ) of all bodies.
fn largest_turn(q: &DVector<f64>) -> f64 {
    q.iter()
        .skip(2)
        .step_by(3)
        .fold(0.0, |worst: f64, turn| worst.max(turn.abs()))
}
