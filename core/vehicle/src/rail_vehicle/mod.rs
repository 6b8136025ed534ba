//! The vehicle under the pantograph: rigid bodies, joints, bushings and wheels.
//!
//! Coordinates are those of the frame of the base, which travels at constant speed: an undisturbed vehicle is at rest.
//! The centre of mass of the body under the pantograph keeps a fixed position along the track in this frame: this
//! constraint drives the vehicle and does no work in the frame. [Thesis, section 3.1, Table 1] In a curve the frame
//! follows the track ([`Travel`]), so that a vehicle in a long arc is at rest, too, under the forces of
//! [`CurveInertia`].
//!
//! | file | subject |
//! | --- | --- |
//! | `builder` | from a scene's vehicle to bodies, bushings, joints and wheels |
//! | `statics` | the vehicle at rest under the loads of the pantograph |
//! | `wheel_spring`, `rolling_wheel` | the two contact models of a wheel |
//! | `spin` | spin of a wheelset about the axle |
//! | `curve_inertia` | inertia forces in a curve |
mod builder;
mod curve_inertia;
mod rolling_wheel;
mod spin;
mod statics;
#[cfg(test)]
mod tests;
mod wheel_spring;

use crate::multibody::{BodyMarker, Bushing, Bushings, Joint, RigidBody};
use crate::pantograph::Offsets;
use crate::travel::Travel;
pub(crate) use curve_inertia::CurveInertia;
use dynamics::{Constraint, Force, Frame, Marker, Motion, PartVisitor, State};
pub(crate) use rolling_wheel::RollingWheel;
pub(crate) use spin::Spin;
pub(crate) use statics::{Load, VehicleRest};
pub(crate) use wheel_spring::WheelSpring;

/// Contact model between a wheel and a rail.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "eight per vehicle")]
pub(crate) enum VehicleWheel {
    /// A linear spring.
    Spring(WheelSpring),
    /// Rolling contact.
    Rolling(RollingWheel),
}

impl VehicleWheel {
    /// Force of the rail on the wheel perpendicular to the plane of the rails, N.
    #[must_use]
    pub fn load(&self, motion: &Motion<'_>) -> f64 {
        match self {
            Self::Spring(wheel) => wheel.load(motion),
            Self::Rolling(wheel) => wheel.force(motion).z,
        }
    }

    /// Name of its part: rolling contact has its own.
    fn part(&self) -> &'static str {
        match self {
            Self::Spring(_) => "vehicle",
            Self::Rolling(_) => "wheel_rail",
        }
    }

    fn contribution(&mut self) -> &mut dyn Force {
        match self {
            Self::Spring(wheel) => wheel,
            Self::Rolling(wheel) => wheel,
        }
    }
}

/// A vehicle of rigid bodies on its wheels.
#[derive(Clone, Debug)]
pub struct Vehicle {
    offsets: Offsets,
    constraint_count: usize,
    names: Vec<String>,
    bodies: Vec<RigidBody>,
    /// Bushings, then bearings.
    bushings: Bushings,
    bearing_count: usize,
    joints: Vec<Joint>,
    /// Left and right wheel of each wheelset in turn.
    wheels: Vec<VehicleWheel>,
    /// Spins of the wheelsets of a rolling vehicle.
    spins: Vec<Spin>,
    pantograph_base: BodyMarker,
    fixed: usize,
    travel: Travel,
    /// Inertia on curved track.
    inertia: Option<CurveInertia>,
}

impl Vehicle {
    /// Travel of the frame of the coordinates.
    #[must_use]
    pub(crate) fn travel(&self) -> &Travel {
        &self.travel
    }

    /// Marker of the pantograph's base on the body under the pantograph.
    #[must_use]
    pub(crate) fn pantograph_base(&self) -> BodyMarker {
        self.pantograph_base
    }

    /// The bodies, in the order of the scene.
    #[must_use]
    pub fn bodies(&self) -> &[RigidBody] {
        &self.bodies
    }

    /// Name of each body.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Number of bushings, of bearings and of joints.
    #[must_use]
    pub fn counts(&self) -> [usize; 3] {
        [
            self.bushings.as_slice().len() - self.bearing_count,
            self.bearing_count,
            self.joints.len(),
        ]
    }

    /// Bushings, then bearings.
    #[must_use]
    pub fn bushings(&self) -> &[Bushing] {
        self.bushings.as_slice()
    }

    /// Number of generalised velocities that are free.
    #[must_use]
    pub(crate) fn coordinates(&self) -> usize {
        6 * self.bodies.len() + self.spins.len() - self.fixed
    }

    /// Number of constraint equations.
    #[must_use]
    pub(crate) fn constraint_count(&self) -> usize {
        self.constraint_count
    }

    /// Force of the rail on each wheel perpendicular to the plane of the rails, N: left and right wheel of each
    /// wheelset in turn.
    pub fn wheel_loads<'a>(&'a self, motion: &'a Motion<'_>) -> impl Iterator<Item = f64> + 'a {
        self.wheels.iter().map(|wheel| wheel.load(motion))
    }

    /// Force of the rail on one wheel, counted from 0, perpendicular to the plane of the rails, N; 0 if there is no
    /// such wheel.
    #[must_use]
    pub fn wheel_load(&self, wheel: usize, motion: &Motion<'_>) -> f64 {
        self.wheels.get(wheel).map_or(0.0, |wheel| wheel.load(motion))
    }

    /// Y/Q of one wheel, counted from 0; 0 if no lateral force is modelled.
    #[must_use]
    pub fn derailment_quotient(&self, wheel: usize, motion: &Motion<'_>) -> f64 {
        match self.wheels.get(wheel) {
            Some(VehicleWheel::Rolling(wheel)) => wheel.derailment_quotient(motion),
            _ => 0.0,
        }
    }

    /// Number of wheels.
    #[must_use]
    pub fn wheel_count(&self) -> usize {
        self.wheels.len()
    }

    /// Frame of the pantograph's base, in the frame of the base.
    #[must_use]
    pub fn base_frame(&self, motion: &Motion<'_>) -> Frame {
        self.pantograph_base.frame(motion)
    }

    /// Visits every force with the name of its part, in a fixed order.
    pub(crate) fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        for body in &mut self.bodies {
            visit("vehicle", body);
        }
        visit("vehicle", &mut self.bushings);
        for wheel in &mut self.wheels {
            visit(wheel.part(), wheel.contribution());
        }
        for spin in &mut self.spins {
            visit("vehicle", spin);
        }
        if let Some(inertia) = &mut self.inertia {
            visit("vehicle", inertia);
        }
    }

    /// Visits every force, in the order of [`Vehicle::parts`].
    pub(crate) fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.parts(&mut |_, force| visit(force));
    }

    /// Visits every joint in a fixed order.
    pub(crate) fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        for joint in &mut self.joints {
            visit(joint);
        }
    }

    /// Writes a state of rest into the vehicle's part of a state.
    pub(crate) fn set_rest(&self, rest: &VehicleRest, state: &mut State) {
        rest.equilibrium.write(self.offsets, state);
        for (spin, rate) in self.spins.iter().zip(&rest.spins) {
            state.v[spin.coordinate] = *rate;
        }
    }
}
