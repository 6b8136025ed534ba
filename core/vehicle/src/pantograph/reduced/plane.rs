//! Mechanism of bodies that move in the plane of the track's middle.
//!
//! ```text
//! qᵢ = (x, z, φ) of body i,   φ about +y from its reference position,    R(φ) (x, z) = (x c + z s, −x s + z c)
//! g(q) = 0,   one equation less than coordinates:   q = q(σ) with q_σᵀ M q_σ = 1
//! ```
use nalgebra::{DMatrix, DVector, Matrix3, Vector2};

/// End of a joint: a body with a point (m, from the centre of mass, axes of the reference position), or a point of the
/// base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    Base(Vector2<f64>),
    Body(usize, Vector2<f64>),
}

/// Point fixed to a body, and the first and second derivative in the direction of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Derivatives {
    pub value: Vector2<f64>,
    pub first: Vector2<f64>,
    pub second: Vector2<f64>,
}

/// A turn about +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    pub sine: f64,
    pub cosine: f64,
}

impl Turn {
    /// Turn by `φ`, rad.
    pub fn by(phi: f64) -> Self {
        let (sine, cosine) = phi.sin_cos();
        Self { sine, cosine }
    }

    /// Product of both turns.
    pub fn and(self, other: Self) -> Self {
        Self {
            sine: self.sine * other.cosine + self.cosine * other.sine,
            cosine: self.cosine * other.cosine - self.sine * other.sine,
        }
    }

    /// Image of `r`, along x and z.
    pub fn of(self, r: Vector2<f64>) -> Vector2<f64> {
        Vector2::new(r.x * self.cosine + r.y * self.sine, r.y * self.cosine - r.x * self.sine)
    }

    /// Rotation matrix in space.
    pub fn matrix(self) -> Matrix3<f64> {
        let Self { sine: s, cosine: c } = self;
        Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c)
    }
}

/// `r` turned by `φ` about +y.
pub(super) fn turned(r: Vector2<f64>, phi: f64) -> Vector2<f64> {
    Turn::by(phi).of(r)
}

/// `dR(φ)r/dφ` for the turned `r`.
pub(super) fn quarter(r: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(r.y, -r.x)
}

/// Equations of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PlaneJoint {
    /// Both points coincide.
    Pin(End, End),
    /// The second point stays on the first end's axis (unit vector), and both turn alike.
    Guide(End, End, Vector2<f64>),
}

/// Bodies and joints in the plane; the joints hold all motions but one.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    /// (x, z) of the centres of mass in the reference position, m.
    pub references: Vec<Vector2<f64>>,
    /// kg and kg·m², of each body.
    pub inertias: Vec<(f64, f64)>,
    pub joints: Vec<PlaneJoint>,
}

impl Plane {
    /// The reference position.
    pub fn reference(&self) -> DVector<f64> {
        DVector::from_iterator(
            3 * self.references.len(),
            self.references.iter().flat_map(|r| [r.x, r.y, 0.0]),
        )
    }

    /// The point of an end, and its derivatives along a motion with the tangent `first` and the curvature `second` (of
    /// `q`).
    pub fn point(end: End, q: &DVector<f64>, first: &DVector<f64>, second: &DVector<f64>) -> Derivatives {
        match end {
            End::Base(value) => Derivatives {
                value,
                first: Vector2::zeros(),
                second: Vector2::zeros(),
            },
            End::Body(body, offset) => {
                let i = 3 * body;
                let of = |v: &DVector<f64>| Vector2::new(v[i], v[i + 1]);
                let arm = turned(offset, q[i + 2]);
                Derivatives {
                    value: of(q) + arm,
                    first: of(first) + quarter(arm) * first[i + 2],
                    second: of(second) + quarter(arm) * second[i + 2] - arm * (first[i + 2] * first[i + 2]),
                }
            }
        }
    }

    fn angle(end: End, v: &DVector<f64>) -> f64 {
        match end {
            End::Base(_) => 0.0,
            End::Body(body, _) => v[3 * body + 2],
        }
    }

    /// `g`, its derivative along `first`, and its second derivative along a motion with `first` and `second`.
    fn equations(&self, q: &DVector<f64>, first: &DVector<f64>, second: &DVector<f64>) -> [DVector<f64>; 3] {
        let mut out = [(); 3].map(|()| DVector::zeros(2 * self.joints.len()));
        let mut put = |row: usize, value: f64, first: f64, second: f64| {
            for (out, value) in out.iter_mut().zip([value, first, second]) {
                out[row] = value;
            }
        };
        for (joint, row) in self.joints.iter().zip((0..).step_by(2)) {
            let (PlaneJoint::Pin(a, b) | PlaneJoint::Guide(a, b, _)) = *joint;
            let (of_a, of_b) = (Self::point(a, q, first, second), Self::point(b, q, first, second));
            let apart = Derivatives {
                value: of_b.value - of_a.value,
                first: of_b.first - of_a.first,
                second: of_b.second - of_a.second,
            };
            match *joint {
                PlaneJoint::Pin(..) => {
                    for axis in 0..2 {
                        put(row + axis, apart.value[axis], apart.first[axis], apart.second[axis]);
                    }
                }
                PlaneJoint::Guide(_, _, along) => {
                    let (turn, rate, change) = (Self::angle(a, q), Self::angle(a, first), Self::angle(a, second));
                    let across = quarter(turned(along, turn));
                    let across_first = quarter(across) * rate;
                    let across_second = quarter(across) * change - across * (rate * rate);
                    put(
                        row,
                        across.dot(&apart.value),
                        across_first.dot(&apart.value) + across.dot(&apart.first),
                        across_second.dot(&apart.value)
                            + 2.0 * across_first.dot(&apart.first)
                            + across.dot(&apart.second),
                    );
                    put(
                        row + 1,
                        Self::angle(b, q) - turn,
                        Self::angle(b, first) - rate,
                        Self::angle(b, second) - change,
                    );
                }
            }
        }
        out
    }

    /// `[g_q; metricᵀ]` with `metric = M · along`.
    fn bordered(&self, q: &DVector<f64>, along: &DVector<f64>) -> DMatrix<f64> {
        let border = 2 * self.joints.len();
        let mut matrix = DMatrix::zeros(border + 1, q.len());
        // Part of a point of an end in a row that measures along `direction`; the other end has the other sign.
        let mut point = |row: usize, end: End, direction: Vector2<f64>| {
            if let End::Body(body, offset) = end {
                let arm = turned(offset, q[3 * body + 2]);
                matrix[(row, 3 * body)] += direction.x;
                matrix[(row, 3 * body + 1)] += direction.y;
                matrix[(row, 3 * body + 2)] += direction.dot(&quarter(arm));
            }
        };
        for (joint, row) in self.joints.iter().zip((0..).step_by(2)) {
            match *joint {
                PlaneJoint::Pin(a, b) => {
                    for axis in 0..2 {
                        point(row + axis, a, -Vector2::ith(axis, 1.0));
                        point(row + axis, b, Vector2::ith(axis, 1.0));
                    }
                }
                PlaneJoint::Guide(a, b, along) => {
                    let across = quarter(turned(along, Self::angle(a, q)));
                    point(row, a, -across);
                    point(row, b, across);
                }
            }
        }
        let none = DVector::zeros(q.len());
        for (joint, row) in self.joints.iter().zip((0..).step_by(2)) {
            if let PlaneJoint::Guide(a, b, along) = *joint {
                if let End::Body(body, _) = a {
                    let apart = Self::point(b, q, &none, &none).value - Self::point(a, q, &none, &none).value;
                    matrix[(row, 3 * body + 2)] -= turned(along, q[3 * body + 2]).dot(&apart);
                    matrix[(row + 1, 3 * body + 2)] -= 1.0;
                }
                if let End::Body(body, _) = b {
                    matrix[(row + 1, 3 * body + 2)] += 1.0;
                }
            }
        }
        matrix.row_mut(border).copy_from(&self.metric(along).transpose());
        matrix
    }

    /// `M v`.
    fn metric(&self, v: &DVector<f64>) -> DVector<f64> {
        let mut product = v.clone();
        for (body, &(mass, inertia)) in self.inertias.iter().enumerate() {
            product[3 * body] *= mass;
            product[3 * body + 1] *= mass;
            product[3 * body + 2] *= inertia;
        }
        product
    }

    /// Right side of the bordered system: `g` and the border.
    fn right_side(g: DVector<f64>, border: f64) -> DVector<f64> {
        let rows = g.len();
        let mut right = g.resize_vertically(rows + 1, 0.0);
        right[rows] = border;
        right
    }

    /// Motion that the joints leave free in the reference position, of unit length in the metric; `None` if there is
    /// more than one.
    pub fn start(&self, q: &DVector<f64>) -> Option<DVector<f64>> {
        /// Smallest singular value that counts as held by a joint, relative to the largest.
        const HELD: f64 = 1e-9;
        let n = q.len();
        let none = DVector::zeros(n);
        let mut matrix = self.bordered(q, &none);
        // Rates weighed by the inertias, so that singular values do not depend on the size of the mechanism.
        let weights: Vec<f64> = self
            .inertias
            .iter()
            .flat_map(|&(mass, inertia)| [mass, mass, inertia])
            .map(f64::sqrt)
            .collect();
        for (mut column, weight) in matrix.column_iter_mut().zip(&weights) {
            column /= *weight;
        }
        let gram = (matrix.transpose() * matrix).symmetric_eigen();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| gram.eigenvalues[a].total_cmp(&gram.eigenvalues[b]));
        let largest = gram.eigenvalues[order[n - 1]];
        if n > 1 && gram.eigenvalues[order[1]] < HELD * HELD * largest {
            return None;
        }
        let mut along = gram.eigenvectors.column(order[0]).into_owned();
        for (entry, weight) in along.iter_mut().zip(&weights) {
            *entry /= *weight;
        }
        self.tangent(q, &along)
    }

    /// Unit tangent that continues in the direction of `along`.
    pub fn tangent(&self, q: &DVector<f64>, along: &DVector<f64>) -> Option<DVector<f64>> {
        let right = Self::right_side(DVector::zeros(2 * self.joints.len()), 1.0);
        let tangent = self.bordered(q, along).lu().solve(&right)?;
        let length = tangent.dot(&self.metric(&tangent)).sqrt();
        (length.is_finite() && length > 0.0).then(|| tangent / length)
    }

    /// `q_σσ` of the curve with the unit tangent `first`.
    pub fn curvature(&self, q: &DVector<f64>, first: &DVector<f64>) -> Option<DVector<f64>> {
        let [_, _, g] = self.equations(q, first, &DVector::zeros(q.len()));
        self.bordered(q, first).lu().solve(&Self::right_side(-g, 0.0))
    }

    /// Nearest configuration with closed joints; `None` if there is none.
    pub fn closed(&self, mut q: DVector<f64>, along: &DVector<f64>) -> Option<DVector<f64>> {
        /// Rounding of metres.
        const CLOSED: f64 = 1e-14;
        let none = DVector::zeros(q.len());
        let mut last = f64::INFINITY;
        for _ in 0..20 {
            let [g, ..] = self.equations(&q, &none, &none);
            let gap = g.amax();
            if gap <= CLOSED || (gap < 1e-12 && gap >= 0.5 * last) {
                return Some(q);
            }
            last = gap;
            q += self.bordered(&q, along).lu().solve(&Self::right_side(-g, 0.0))?;
        }
        None
    }

    /// Point of the motion `step` (√kg·m) further on, by the classical Runge–Kutta scheme and a projection.
    pub fn advance(&self, q: &DVector<f64>, tangent: &DVector<f64>, step: f64) -> Option<DVector<f64>> {
        let k1 = tangent.clone();
        let k2 = self.tangent(&(q + &k1 * (0.5 * step)), &k1)?;
        let k3 = self.tangent(&(q + &k2 * (0.5 * step)), &k2)?;
        let k4 = self.tangent(&(q + &k3 * step), &k3)?;
        let moved = q + (k1 + (k2 + k3) * 2.0 + &k4) * (step / 6.0);
        self.closed(moved, &k4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar on the base, a block that slides on it, and a link from the base to the block.
    fn slider() -> Plane {
        let v = Vector2::new;
        let on = |body, x, z| End::Body(body, v(x, z));
        Plane {
            references: vec![v(0.5, 0.1), v(0.8, 0.3), v(0.9, -0.2)],
            inertias: vec![(2.0, 0.3), (1.0, 0.1), (0.5, 0.05)],
            joints: vec![
                PlaneJoint::Pin(End::Base(v(0.1, 0.0)), on(0, -0.4, -0.1)),
                PlaneJoint::Guide(on(0, 0.3, 0.2), on(1, 0.0, 0.0), v(0.8, 0.6)),
                PlaneJoint::Pin(on(1, 0.1, -0.1), on(2, 0.0, 0.4)),
                PlaneJoint::Pin(on(2, 0.1, -0.3), End::Base(v(1.0, -0.5))),
            ],
        }
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_equations() {
        let plane = slider();
        let none = DVector::zeros(9);
        let q = DVector::from_fn(9, |i, _| 0.3 * (1.7 * i as f64).sin());
        let jacobian = plane.bordered(&q, &none);
        for column in 0..9 {
            let mut unit = none.clone();
            unit[column] = 1.0;
            let [_, first, _] = plane.equations(&q, &unit, &none);
            assert!((first - jacobian.view((0, column), (8, 1))).amax() < 1e-15);
            let h = 1e-5;
            let g = |sign: f64| plane.equations(&(&q + &unit * (sign * h)), &none, &none);
            let difference = (&g(1.0)[0] - &g(-1.0)[0]) / (2.0 * h);
            assert!((difference - jacobian.view((0, column), (8, 1))).amax() < 1e-9); // h²
        }
    }

    #[test]
    fn second_derivatives_are_those_of_the_equations_along_a_motion() {
        let plane = slider();
        let entry = |phase: f64| DVector::from_fn(9, |i, _| (1.3 * i as f64 + phase).sin());
        let (q, first, second) = (entry(0.1) * 0.3, entry(0.7), entry(1.9));
        let h = 1e-3;
        let none = DVector::zeros(9);
        let at = |t: f64| plane.equations(&(&q + &first * t + &second * (0.5 * t * t)), &none, &none)[0].clone();
        let [value, _, exact] = plane.equations(&q, &first, &second);
        let difference = (at(h) - value * 2.0 + at(-h)) / (h * h);
        assert!((difference - &exact).amax() < 1e-5 * exact.amax()); // h²
    }

    #[test]
    fn a_motion_keeps_joints_closed_and_has_unit_length() {
        let plane = slider();
        let q = plane.reference();
        let open = plane.equations(&q, &DVector::zeros(9), &DVector::zeros(9))[0].amax();
        assert!(open < 1e-15, "{open}");
        let mut along = plane.start(&q).unwrap();
        let mut at = q;
        for _ in 0..20 {
            at = plane.advance(&at, &along, 0.01).unwrap();
            along = plane.tangent(&at, &along).unwrap();
            let [g, rate, _] = plane.equations(&at, &along, &DVector::zeros(9));
            assert!(g.amax() < 1e-13 && rate.amax() < 1e-13);
            assert!((along.dot(&plane.metric(&along)) - 1.0).abs() < 1e-12);
        }
        // Against a central difference of the tangent over 2e-4.
        let h = 1e-4;
        let side = |step: f64| {
            let q = plane.advance(&at, &(&along * step.signum()), step.abs()).unwrap();
            plane.tangent(&q, &along).unwrap()
        };
        let difference = (side(h) - side(-h)) / (2.0 * h);
        let curvature = plane.curvature(&at, &along).unwrap();
        assert!((difference - &curvature).amax() < 1e-5 * curvature.amax());
    }
}
