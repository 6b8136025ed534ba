//! Contact point of wheel and rail: Newton's method on the four surface parameters.
use super::surface::{SurfacePoint, axes_without_spin};
use super::{ProfilePoint, Rail, Wheel};
use nalgebra::{Matrix3, Matrix4, Vector2, Vector3, Vector4};

/// The surface parameters of a contact: arc length and profile parameter of the rail (m), angle (rad) and profile
/// parameter (m) of the wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceParameters {
    /// s, m.
    pub s: f64,
    /// σ of the rail's profile, m.
    pub rail: f64,
    /// φ, rad: from straight down, forward.
    pub angle: f64,
    /// σ of the wheel's profile, m.
    pub wheel: f64,
}

impl SurfaceParameters {
    fn add(&mut self, change: &Vector4<f64>) {
        self.s += change[0];
        self.rail += change[1];
        self.angle += change[2];
        self.wheel += change[3];
    }
}

/// Wheel and rail at the point of smallest distance or largest overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPoint {
    /// Parameters of the point on both surfaces.
    pub parameters: SurfaceParameters,
    /// Arm from the middle of the wheelset to the point of the wheel, world axes, m.
    pub lever: Vector3<f64>,
    /// Normal of the rail, out of the rail, world axes, unit length.
    pub normal: Vector3<f64>,
    /// Direction of the rail, unit length.
    pub longitudinal: Vector3<f64>,
    /// Overlap along the normal, m; negative for separated surfaces.
    pub penetration: f64,
    /// Relative curvature along and across the rail, 1/m; positive for surfaces that part from each other.
    pub curvature: Vector2<f64>,
    /// Tangents of wheel and rail: first derivatives by the parameters of each.
    wheel: [Vector3<f64>; 2],
    rail: [Vector3<f64>; 2],
    /// Derivatives of the normal and of the direction of the rail by s and σ of the rail.
    normal_rates: [Vector3<f64>; 2],
    longitudinal_rates: [Vector3<f64>; 2],
    /// Derivatives of the curvature: along by σ of the wheel; across by σ of the rail and by that of the wheel.
    curvature_rates: [f64; 3],
    /// Inverse of the Jacobian, less than 10⁻⁹ m from this point.
    inverse: Matrix4<f64>,
}

/// Change of a contact point with a motion of the wheelset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactChange {
    pub lever: Vector3<f64>,
    pub normal: Vector3<f64>,
    pub longitudinal: Vector3<f64>,
    pub curvature: Vector2<f64>,
}

/// A wheel over a rail, at one position of the wheelset.
pub(crate) struct Pairing<'a> {
    pub wheel: &'a Wheel,
    pub rail: &'a Rail,
    /// Viewpoint of both, see [`super::RailLine::frame`], m.
    pub from: f64,
    /// Middle of the wheelset, m.
    pub middle: Vector3<f64>,
    /// See [`axes_without_spin`].
    pub axes: Matrix3<f64>,
}

/// Largest number of corrections of one Newton solution.
const MAX_ITERATIONS: usize = 30;

/// Correction that is rounding, m.
const SETTLED: f64 = 1e-14;

/// Longest correction along a profile, m: less than the radius of the tightest part of a profile.
const LONGEST: f64 = 2e-3;

impl<'a> Pairing<'a> {
    pub fn new(wheel: &'a Wheel, (rail, from): (&'a Rail, f64), middle: Vector3<f64>, axis: &Vector3<f64>) -> Self {
        Self {
            wheel,
            rail,
            from,
            middle,
            axes: axes_without_spin(axis),
        }
    }

    /// Contact point from a start nearby; `None` if Newton's method does not converge.
    ///
    /// ```text
    /// t₁ʳ·(rʷ − rʳ) = 0,  t₂ʳ·(rʷ − rʳ) = 0,  t₁ʷ·nʳ = 0,  t₂ʷ·nʳ = 0              [Thesis, Eq. (4)]
    /// ∂C/∂s Δs = −C                                                                  [Thesis, Eq. (5)]
    /// ```
    pub fn solve(&self, start: &SurfaceParameters) -> Option<ContactPoint> {
        let mut parameters = *start;
        for _ in 0..MAX_ITERATIONS {
            let view = self.view(&parameters);
            let inverse = view.jacobian.try_inverse()?;
            let full = -(inverse * view.residual);
            let longest = full[1].abs().max(full[3].abs()).max(0.1 * full[2].abs());
            let change = if longest > LONGEST {
                full * (LONGEST / longest)
            } else {
                full
            };
            if !change.norm().is_finite() {
                return None;
            }
            // Newton's iterations of a time step hardly move a wheelset against the rail.
            if longest < SETTLED {
                return Some(self.point(parameters, &view, inverse));
            }
            parameters.add(&change);
            // Quadratic convergence: the error after a correction of 10⁻⁹ m is below rounding.
            if longest < 1e-9 {
                return Some(self.point(parameters, &self.view(&parameters), inverse));
            }
        }
        None
    }

    fn view(&self, at: &SurfaceParameters) -> View {
        let profiles = [self.rail.profile.at(at.rail), self.wheel.profile.at(at.wheel)];
        let rail = self.rail.at(at.s, &profiles[0], self.from);
        let wheel = self.wheel.at(&self.axes, at.angle, &profiles[1]);
        let [r_s, r_a] = rail.first;
        let [r_ss, r_sa, r_aa] = rail.second;
        let [w_p, w_b] = wheel.first;
        let [w_pp, w_pb, w_bb] = wheel.second;
        let d = self.middle + wheel.position - rail.position;
        let sign = self.rail.side.sign();
        let upward = r_s.cross(&r_a) * sign;
        let length = upward.norm();
        let normal = upward / length;
        let across = |vector: Vector3<f64>| (vector - normal * normal.dot(&vector)) / length;
        let normal_rates = [
            across((r_ss.cross(&r_a) + r_s.cross(&r_sa)) * sign),
            across((r_sa.cross(&r_a) + r_s.cross(&r_aa)) * sign),
        ];
        let [n_s, n_a] = normal_rates;
        View {
            residual: Vector4::new(r_s.dot(&d), r_a.dot(&d), w_p.dot(&normal), w_b.dot(&normal)),
            jacobian: Matrix4::new(
                r_ss.dot(&d) - r_s.dot(&r_s),
                r_sa.dot(&d) - r_s.dot(&r_a),
                r_s.dot(&w_p),
                r_s.dot(&w_b),
                r_sa.dot(&d) - r_a.dot(&r_s),
                r_aa.dot(&d) - r_a.dot(&r_a),
                r_a.dot(&w_p),
                r_a.dot(&w_b),
                w_p.dot(&n_s),
                w_p.dot(&n_a),
                w_pp.dot(&normal),
                w_pb.dot(&normal),
                w_b.dot(&n_s),
                w_b.dot(&n_a),
                w_pb.dot(&normal),
                w_bb.dot(&normal),
            ),
            penetration: -normal.dot(&d),
            normal,
            normal_rates,
            wheel,
            rail,
            profiles,
        }
    }

    fn point(&self, parameters: SurfaceParameters, view: &View, inverse: Matrix4<f64>) -> ContactPoint {
        let [r_s, _] = view.rail.first;
        let [r_ss, r_sa, _] = view.rail.second;
        let speed = r_s.norm();
        let longitudinal = r_s / speed;
        let across = |vector: Vector3<f64>| (vector - longitudinal * longitudinal.dot(&vector)) / speed;

        let [of_rail, profile] = &view.profiles;
        let radius = self.wheel.radius - profile.position.y;
        let length = profile.first.norm();
        let cosine = profile.first.x / length;
        let cosine_rate = profile.second.x / length - cosine * profile.first.dot(&profile.second) / (length * length);
        let [of_wheel, wheel_rate] = profile.curvature();
        let [of_rail, rail_rate] = of_rail.curvature();
        ContactPoint {
            parameters,
            lever: view.wheel.position,
            normal: view.normal,
            longitudinal,
            penetration: view.penetration,
            // A circle of the wheel bends by cos γ / R within its normal section (Meusnier).
            curvature: Vector2::new(
                cosine / radius - r_ss.dot(&view.normal) / (speed * speed),
                of_wheel - of_rail,
            ),
            wheel: view.wheel.first,
            rail: view.rail.first,
            normal_rates: view.normal_rates,
            longitudinal_rates: [across(r_ss), across(r_sa)],
            curvature_rates: [
                cosine_rate / radius + cosine * profile.first.y / (radius * radius),
                -rail_rate,
                wheel_rate,
            ],
            inverse,
        }
    }
}

/// Residual of [Thesis, Eq. (4)] and its Jacobian by (s, σ of the rail, φ, σ of the wheel).
struct View {
    residual: Vector4<f64>,
    jacobian: Matrix4<f64>,
    penetration: f64,
    normal: Vector3<f64>,
    normal_rates: [Vector3<f64>; 2],
    wheel: SurfacePoint,
    rail: SurfacePoint,
    /// Points of the profiles of rail and wheel.
    profiles: [ProfilePoint; 2],
}

impl ContactPoint {
    /// Left direction in the common tangent plane, unit length.
    #[must_use]
    pub fn lateral(&self) -> Vector3<f64> {
        self.normal.cross(&self.longitudinal)
    }

    /// Change with a displacement of the middle of the wheelset (m) and a rotation of the wheelset (rad, world axes).
    ///
    /// The surface parameters follow by the implicit function theorem: the equations of contact stay fulfilled.
    pub(crate) fn change(&self, displacement: &Vector3<f64>, rotation: &Vector3<f64>) -> ContactChange {
        let carried = displacement + rotation.cross(&self.lever);
        let ([r_s, r_a], [w_p, w_b]) = (self.rail, self.wheel);
        let right = Vector4::new(
            r_s.dot(&carried),
            r_a.dot(&carried),
            self.normal.dot(&rotation.cross(&w_p)),
            self.normal.dot(&rotation.cross(&w_b)),
        );
        let moved = -(self.inverse * right);
        let [along, by_rail, by_wheel] = self.curvature_rates;
        ContactChange {
            lever: rotation.cross(&self.lever) + w_p * moved[2] + w_b * moved[3],
            normal: self.normal_rates[0] * moved[0] + self.normal_rates[1] * moved[1],
            longitudinal: self.longitudinal_rates[0] * moved[0] + self.longitudinal_rates[1] * moved[1],
            curvature: Vector2::new(along * moved[3], by_rail * moved[1] + by_wheel * moved[3]),
        }
    }
}
