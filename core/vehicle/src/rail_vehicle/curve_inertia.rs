//! Inertia forces in a frame that follows a curve.
use super::Spin;
use crate::multibody::{Pose, RigidBody};
use crate::travel::{Apparent, Travel};
use dynamics::rotation::skew;
use dynamics::{Blocks, Force, Motion, Power, Weights};
use nalgebra::{Matrix3, Matrix3x4, Vector3};

/// Terms that the frame of a vehicle adds to the equations of rigid bodies in a curve.
///
/// Newton's and Euler's equations in a frame with the acceleration `a` of the origin and the angular velocity `Ω`; the
/// weight leans with the frame [Shabana, Zaazaa & Sugiyama 2008, chapters 2 and 7; derived here for velocities relative
/// to the frame]:
///
/// ```text
/// F' = −m (a + Ω̇ × r + Ω × (Ω × r) + 2 Ω × ṙ) + m g (e_z − e_up)
/// M' = −I (u − ω × w) − ω × I w − w × I ω − w × I w,      w = AᵀΩ,  u = AᵀΩ̇,  A the body's axes in the frame
/// ```
///
/// `M'` is the difference between Euler's equations for the whole angular velocity `ω + w`, whose rate is `ω̇ + u − ω ×
/// w`, and the equations of a [`RigidBody`] for `ω` alone. The spin `Ω_s` of a wheelset adds the gyroscopic moments of
/// [`Spin`] for `w`, and the turning axle takes the spin along:
///
/// ```text
/// M'_x += I_y Ω_s w_z,   M'_z −= I_y Ω_s w_x,   M'_χ = −I_y (u − ω × w)_y
/// ```
#[derive(Clone, Debug)]
pub struct CurveInertia {
    travel: Travel,
    bodies: Vec<RigidBody>,
    spins: Vec<Spin>,
}

/// The angular velocities of a body.
struct Turning {
    /// Relative to the frame, body axes, rad/s.
    omega: Vector3<f64>,
    /// `w`, rad/s, and `u`, rad/s².
    carried: Vector3<f64>,
    carried_rate: Vector3<f64>,
}

impl Turning {
    fn new(pose: &Pose, apparent: &Apparent, motion: &Motion<'_>) -> Self {
        let to_body = pose.axes(motion).transpose();
        Self {
            omega: pose.angular_velocity(motion),
            carried: to_body * apparent.angular_velocity,
            carried_rate: to_body * apparent.angular_acceleration,
        }
    }

    /// `M'`.
    fn moment(&self, inertia: &Vector3<f64>) -> Vector3<f64> {
        let (omega, w) = (&self.omega, &self.carried);
        let times = |vector: &Vector3<f64>| inertia.component_mul(vector);
        -times(&self.rate()) - omega.cross(&times(w)) - w.cross(&times(omega)) - w.cross(&times(w))
    }

    /// Rate of `w` in the axes of the body, `u − ω × w`.
    fn rate(&self) -> Vector3<f64> {
        self.carried_rate - self.omega.cross(&self.carried)
    }

    /// Derivatives of `M'` by rotations of the body about its axes, and by ω.
    fn moment_rates(&self, inertia: &Vector3<f64>) -> [Matrix3<f64>; 2] {
        let (omega, w) = (skew(&self.omega), skew(&self.carried));
        let matrix = Matrix3::from_diagonal(inertia);
        let of = |vector: &Vector3<f64>| skew(&inertia.component_mul(vector));
        let (of_omega, of_w) = (of(&self.omega), of(&self.carried));
        let by_omega = -matrix * w + of_w - w * matrix;
        let by_w = matrix * omega - omega * matrix + of_omega - w * matrix + of_w;
        // A turn by δ changes w by w × δ, and u likewise.
        [by_w * w - matrix * skew(&self.carried_rate), by_omega]
    }
}

impl CurveInertia {
    /// Inertia of these bodies and spins of a vehicle or pantograph; `None` on straight track.
    #[must_use]
    pub fn new(travel: &Travel, bodies: &[RigidBody], spins: &[Spin]) -> Option<Self> {
        travel.alignment()?;
        Some(Self {
            travel: travel.clone(),
            bodies: bodies.to_vec(),
            spins: spins.to_vec(),
        })
    }

    fn force_on(body: &RigidBody, apparent: &Apparent, motion: &Motion<'_>) -> Vector3<f64> {
        let (position, velocity) = (body.pose.position(motion), body.pose.velocity(motion));
        (apparent.leaning_weight(body.gravity) - apparent.acceleration_of(&position, &velocity)) * body.mass
    }

    /// Moments on a wheelset about x and z, and about its axle on the spin.
    fn moments_on(spin: &Spin, turning: &Turning, motion: &Motion<'_>) -> [f64; 3] {
        let momentum = spin.inertia * spin.rate(motion);
        let w = &turning.carried;
        [momentum * w.z, -momentum * w.x, -spin.inertia * turning.rate().y]
    }
}

impl Force for CurveInertia {
    fn depends_on_inputs(&self) -> bool {
        false
    }

    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let Some(apparent) = self.travel.apparent(motion.t) else {
            return;
        };
        for body in &self.bodies {
            let along = Self::force_on(body, &apparent, motion);
            let about = Turning::new(&body.pose, &apparent, motion).moment(&body.inertia);
            for axis in 0..3 {
                force[body.pose.translation + axis] += along[axis];
                force[body.pose.rotation + axis] += about[axis];
            }
        }
        for spin in &self.spins {
            let turning = Turning::new(&spin.pose, &apparent, motion);
            let [roll, yaw, own] = Self::moments_on(spin, &turning, motion);
            force[spin.pose.rotation] += roll;
            force[spin.pose.rotation + 2] += yaw;
            force[spin.coordinate] += own;
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let Some(apparent) = self.travel.apparent(motion.t) else {
            return;
        };
        let (turn, turn_rate) = (skew(&apparent.angular_velocity), skew(&apparent.angular_acceleration));
        let along = (turn_rate + turn * turn) * weights.q + turn * (2.0 * weights.v);
        for body in &self.bodies {
            let [by_turn, by_omega] = Turning::new(&body.pose, &apparent, motion).moment_rates(&body.inertia);
            let about = -(by_turn * weights.q + by_omega * weights.v);
            for (first, block) in [(body.pose.translation, along * body.mass), (body.pose.rotation, about)] {
                let indices = [0, 1, 2].map(|axis| first + axis);
                blocks.add(&indices, &indices, block.transpose().as_slice()); // nalgebra stores by columns
            }
        }
        for spin in &self.spins {
            let turning = Turning::new(&spin.pose, &apparent, motion);
            let (omega, w) = (&turning.omega, &turning.carried);
            let (inertia, momentum) = (spin.inertia, spin.inertia * spin.rate(motion));
            let (of_w, of_u) = (skew(w), skew(&turning.carried_rate));
            let own = |axis: usize| of_u[(1, axis)] - omega.z * of_w[(0, axis)] + omega.x * of_w[(2, axis)];
            // Rows: roll, yaw, spin; columns: roll, pitch, yaw, spin.
            let mut block = Matrix3x4::zeros();
            for axis in 0..3 {
                block[(0, axis)] = -weights.q * momentum * of_w[(2, axis)];
                block[(1, axis)] = weights.q * momentum * of_w[(0, axis)];
                block[(2, axis)] = weights.q * inertia * own(axis);
            }
            block[(0, 3)] = -weights.v * inertia * w.z;
            block[(1, 3)] = weights.v * inertia * w.x;
            block[(2, 0)] += weights.v * inertia * w.z;
            block[(2, 2)] -= weights.v * inertia * w.x;
            let first = spin.pose.rotation;
            let rows = [first, first + 2, spin.coordinate];
            let columns = [first, first + 1, first + 2, spin.coordinate];
            blocks.add(&rows, &columns, block.transpose().as_slice());
        }
    }

    /// The travel of the frame brings in all of the power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let mut power = Power::default();
        let Some(apparent) = self.travel.apparent(motion.t) else {
            return Some(power);
        };
        for body in &self.bodies {
            let turning = Turning::new(&body.pose, &apparent, motion);
            power.driven += Self::force_on(body, &apparent, motion).dot(&body.pose.velocity(motion));
            power.driven += turning.moment(&body.inertia).dot(&turning.omega);
        }
        for spin in &self.spins {
            let turning = Turning::new(&spin.pose, &apparent, motion);
            let [roll, yaw, own] = Self::moments_on(spin, &turning, motion);
            power.driven += roll * turning.omega.x + yaw * turning.omega.z + own * motion.v[spin.coordinate];
        }
        Some(power)
    }
}
