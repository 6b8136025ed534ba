//! The thesis' mechanism in plane trigonometry, written without the production code.
use super::GRAVITY;

/// The four-bar A–K–C–B of the thesis in plane trigonometry: everything as a function of the lower arm's angle.
pub(super) struct FourBar {
    /// Positions (x, z) of the centres of mass of lower arm, upper arm, lower link, upper link, plunger, pan-head base
    /// point P.
    pub points: [[f64; 2]; 5],
    /// Angles of lower arm, upper arm, lower link, upper link, plunger, rad.
    pub angles: [f64; 5],
    /// Point of the lower arm at `distance` from its base.
    pub uplift: [f64; 2],
}

type Plane = [f64; 2];

fn add(a: Plane, b: Plane) -> Plane {
    [a[0] + b[0], a[1] + b[1]]
}

fn sub(a: Plane, b: Plane) -> Plane {
    [a[0] - b[0], a[1] - b[1]]
}

fn turn(a: Plane, angle: f64) -> Plane {
    let (s, c) = angle.sin_cos();
    [c * a[0] - s * a[1], s * a[0] + c * a[1]]
}

fn angle(a: Plane) -> f64 {
    a[1].atan2(a[0])
}

fn norm(a: Plane) -> f64 {
    a[0].hypot(a[1])
}

/// The apex over the bar from `a` to `b` with legs `ra`, `rb`, on the side where the reference apex is.
fn apex(a: Plane, b: Plane, ra: f64, rb: f64, side: f64) -> Plane {
    let d = norm(sub(b, a));
    let cosine = (ra * ra + d * d - rb * rb) / (2.0 * ra * d);
    let direction = angle(sub(b, a)) + side * cosine.acos();
    add(a, turn([ra, 0.0], direction))
}

impl FourBar {
    const A: Plane = [0.0, 3.425];
    const B: Plane = [11.51280844 - 11.95005378, 3.425];

    /// `theta` is the rotation of the lower arm from the tabulated position, counter-clockwise in the x–z plane.
    pub fn at(theta: f64, distance: f64) -> Self {
        let shift = |x: f64, z: f64| [x - 11.95005378, z];
        let (k0, c0, p0) = (
            shift(10.58842934, 4.26522551),
            shift(10.41592908, 4.21380902),
            shift(12.5, 4.835),
        );
        let (q0, u0) = (shift(10.67175216, 4.21380902), shift(12.5, 4.785));
        let com0 = [
            shift(11.26924156, 3.84511275),
            shift(11.45796454, 4.52440451),
            shift(10.96436876, 3.81940451),
            shift(11.58587608, 4.49940451),
        ];
        let with_arm = |p: Plane| add(Self::A, turn(sub(p, Self::A), theta));
        let (k, q) = (with_arm(k0), with_arm(q0));
        let side = |a: Plane, b: Plane, p: Plane| {
            let (ab, ap) = (sub(b, a), sub(p, a));
            (ab[0] * ap[1] - ab[1] * ap[0]).signum()
        };
        let c = apex(
            k,
            Self::B,
            norm(sub(c0, k0)),
            norm(sub(c0, Self::B)),
            side(k0, Self::B, c0),
        );
        let upper = angle(sub(c, k)) - angle(sub(c0, k0));
        let with_upper = |p: Plane| add(k, turn(sub(p, k0), upper));
        let p = with_upper(p0);
        let u = apex(p, q, norm(sub(u0, p0)), norm(sub(u0, q0)), side(p0, q0, u0));
        let lower_link = angle(sub(c, Self::B)) - angle(sub(c0, Self::B));
        let upper_link = angle(sub(u, q)) - angle(sub(u0, q0));
        let plunger = angle(sub(u, p)) - angle(sub(u0, p0));
        let arm = sub(com0[0], Self::A);
        let uplift = with_arm(add(
            Self::A,
            [arm[0] / norm(arm) * distance, arm[1] / norm(arm) * distance],
        ));
        Self {
            points: [
                with_arm(com0[0]),
                with_upper(com0[1]),
                add(Self::B, turn(sub(com0[2], Self::B), lower_link)),
                add(q, turn(sub(com0[3], q0), upper_link)),
                p,
            ],
            angles: [theta, upper, lower_link, upper_link, plunger],
            uplift,
        }
    }

    /// Derivative of a quantity with respect to the angle of the lower arm.
    pub fn slope(theta: f64, quantity: impl Fn(&Self) -> f64) -> f64 {
        let h = 1e-5;
        (quantity(&Self::at(theta + h, 0.9557)) - quantity(&Self::at(theta - h, 0.9557))) / (2.0 * h)
    }

    /// Potential energy of weights and uplift without the head, J.
    pub fn potential(&self, uplift: f64) -> f64 {
        let masses = [32.18, 15.60, 3.10, 1.15, 1.51];
        let weights: f64 = masses.iter().zip(&self.points).map(|(m, p)| GRAVITY * m * p[1]).sum();
        weights - uplift * self.uplift[1]
    }
}
