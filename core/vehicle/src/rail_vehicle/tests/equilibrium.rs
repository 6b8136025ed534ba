//! Forces and positions of a vehicle in an arc, and the demands of equilibrium on them.
use super::*;
use dynamics::Simulator;
use nalgebra::Vector3;

/// Distance of the nominal contact points of the thesis' wheelsets, m.
pub(super) const DISTANCE: f64 = 1.5;

/// Mass, kg.
pub(super) const MASS: f64 = 43_052.0;
/// Radius of the wheels, m.
pub(super) const RADIUS: f64 = 0.457_048_8;

/// Forces of the rails on a vehicle in an arc as a whole.
pub(super) struct Equilibrium {
    /// Uncompensated acceleration, m/s², to the outside.
    pub outward: f64,
    /// Acceleration across the plane of the rails from weight and curve, m/s².
    pub upward: f64,
    /// N, to the left.
    pub lateral: f64,
    /// N, up.
    pub load: f64,
    /// About the middle of the track and the direction of travel, N m.
    pub moment: f64,
}

impl Equilibrium {
    pub fn of(simulator: &mut Simulator<Alone>, curve: &scene::Curve, speed: f64) -> Self {
        let (mass, centre) = centre(simulator);
        let shift = centre - track_under(simulator);
        let outward = curve.uncompensated_acceleration(speed, 9.81, DISTANCE);
        let (sine, cosine) = curve.cant_angle(DISTANCE).sin_cos();
        let upward = 9.81 * cosine + speed * speed / curve.radius * sine;
        // The spins of the axles are turned about the vertical: I v/r · v/R each.
        let gyroscopic = 4.0 * 191.0 * speed * speed / (RADIUS * curve.radius) * cosine;
        Self {
            outward,
            upward,
            lateral: mass * outward,
            load: mass * upward,
            moment: -mass * (outward * shift.z - upward * shift.y) - gyroscopic,
        }
    }

    pub fn assert(&self, simulator: &mut Simulator<Alone>) {
        let forces = wheel_forces(simulator);
        let lateral: f64 = forces.iter().map(|force| force.y).sum();
        let load: f64 = forces.iter().map(|force| force.z).sum();
        let moment = moment_about_the_track(simulator);
        // Eight bolster springs hold car body and bolsters in the frames sideways, which roll a little.
        let body = 24_170.0 + 2.0 * 1107.0;
        let (alone, motion) = simulator.parts();
        let springs = &alone.vehicle.bushings()[..8];
        let mean = |value: &dyn Fn(&Bushing) -> f64| springs.iter().map(value).sum::<f64>() / 8.0;
        let yielded = mean(&|spring| spring.load(&motion).displacement.y);
        let roll = mean(&|spring| spring.pair.first.frame(&motion).axes[(2, 1)]);
        let sprung = body * (-self.outward - self.upward * roll) / (8.0 * 80e3);
        println!(
            "{:.3} m/s2: lateral {lateral:.1} N of {:.1}, load {load:.1} of {:.1}, moment {moment:.1} N m of {:.1}, \
             bolster springs \
             {:.2} mm of {:.2}, {forces:.0?}",
            self.outward,
            self.lateral,
            self.load,
            self.moment,
            1e3 * yielded,
            1e3 * sprung
        );
        let weight = MASS * 9.81;
        // 1e-4 of the weight: remaining motions from the transition, and forces along rails that are not parallel.
        assert!((lateral - self.lateral).abs() < 1e-4 * weight, "{lateral}");
        assert!((load - self.load).abs() < 1e-4 * weight, "{load}");
        assert!((moment - self.moment).abs() < 1e-4 * weight, "{moment} {}", self.moment); // by 1 m
        // The bolsters turn with the car body against the frames; the force that is left over moves the springs as
        // well.
        let bound = 0.02 * sprung.abs() + (lateral - self.lateral).abs() / (8.0 * 80e3);
        assert!((yielded - sprung).abs() < bound, "{yielded} {sprung}");
    }
}

/// Forces of the rails on the wheels, N, along the track, to the left, and up; left and right wheel of each axle in
/// turn.
pub(super) fn wheel_forces(simulator: &mut Simulator<Alone>) -> Vec<Vector3<f64>> {
    let (alone, motion) = simulator.parts();
    (alone.vehicle.wheels.iter())
        .map(|wheel| match wheel {
            VehicleWheel::Rolling(wheel) => wheel.force(&motion),
            VehicleWheel::Spring(_) => Vector3::zeros(),
        })
        .collect()
}

/// Mass (kg) and centre of mass (m) of the vehicle in its frame.
pub(super) fn centre(simulator: &mut Simulator<Alone>) -> (f64, Vector3<f64>) {
    let (alone, motion) = simulator.parts();
    let mass: f64 = alone.vehicle.bodies.iter().map(|body| body.mass).sum();
    let moment: Vector3<f64> = (alone.vehicle.bodies.iter())
        .map(|body| body.pose.position(&motion) * body.mass)
        .sum();
    (mass, moment / mass)
}

/// Position of the track under the vehicle, in its frame, m: the mean over the axles. A vehicle is straight, the track
/// is not.
pub(super) fn track_under(simulator: &mut Simulator<Alone>) -> Vector3<f64> {
    let (alone, motion) = simulator.parts();
    let travel = alone.vehicle.travel();
    let origin = travel.place(motion.t);
    let spins = &alone.vehicle.spins;
    let place = |spin: &Spin| {
        let along = spin.pose.reference.x;
        let middle = travel.alignment().unwrap().seen_from(origin + along, origin).position;
        middle - Vector3::new(origin, 0.0, 0.0)
    };
    spins.iter().map(place).sum::<Vector3<f64>>() / spins.len() as f64
}

/// Moment of the wheel forces on each axle about its middle, N m: about the direction of travel and about the vertical.
pub(super) fn moments_on_axles(simulator: &mut Simulator<Alone>) -> Vec<[f64; 2]> {
    let (alone, motion) = simulator.parts();
    let mut force = vec![0.0; motion.q.len()];
    for wheel in &mut alone.vehicle.wheels {
        wheel.contribution().add_force(&motion, &mut force);
    }
    let spins = alone.vehicle.spins.iter();
    spins
        .map(|spin| [0, 2].map(|axis| force[spin.pose.rotation + axis]))
        .collect()
}

/// Moment of all wheel forces about the middle of the track under each axle, about the direction of travel, N m.
pub(super) fn moment_about_the_track(simulator: &mut Simulator<Alone>) -> f64 {
    let moments = moments_on_axles(simulator);
    let axles = axles_beside_the_track(simulator);
    let forces = wheel_forces(simulator);
    (axles.iter().zip(moments).zip(forces.chunks(2)))
        .map(|((axle, moment), forces)| {
            let force = forces[0] + forces[1];
            moment[0] + axle.y * force.z - axle.z * force.y
        })
        .sum()
}

/// Middles of the axles in the axes of the track under them, m.
pub(super) fn axles_beside_the_track(simulator: &mut Simulator<Alone>) -> Vec<Vector3<f64>> {
    let (alone, motion) = simulator.parts();
    let travel = alone.vehicle.travel();
    let origin = travel.place(motion.t);
    let beside = |spin: &Spin| {
        let middle = spin.pose.position(&motion);
        let track = travel.alignment().unwrap().seen_from(origin + middle.x, origin);
        track.axes.transpose() * (middle + Vector3::new(origin, 0.0, 0.0) - track.position)
    };
    alone.vehicle.spins.iter().map(beside).collect()
}

/// Places of the contacts of the left and the right wheel of each axle beside the middle of the track, m to the left:
/// the lever arms of the wheel forces, whose contacts are a wheel's radius below the axle.
pub(super) fn contacts_beside_the_track(simulator: &mut Simulator<Alone>) -> Vec<[f64; 2]> {
    let forces = wheel_forces(simulator);
    let axles = axles_beside_the_track(simulator);
    let (alone, motion) = simulator.parts();
    let mut place = |wheel: usize| {
        let mut generalised = vec![0.0; motion.q.len()];
        alone.vehicle.wheels[wheel]
            .contribution()
            .add_force(&motion, &mut generalised);
        let moment = generalised[alone.vehicle.spins[wheel / 2].pose.rotation];
        axles[wheel / 2].y + (moment - RADIUS * forces[wheel].y) / forces[wheel].z
    };
    (0..axles.len())
        .map(|axle| [2 * axle, 2 * axle + 1].map(&mut place))
        .collect()
}
