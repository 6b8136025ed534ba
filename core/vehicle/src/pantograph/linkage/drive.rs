//! Drive of a linkage.
use super::{Linkage, statics};
use crate::VehicleError;
use crate::multibody::{DriveForce, JointMoment};
use crate::pantograph::air::AirForces;
use crate::pantograph::base_mount::BaseMount;
use control::Reading;
use dynamics::{Force, Motion};
use nalgebra::DVector;

/// Least contact force per moment on a joint for which the joint raises the strip, 1/m.
const RAISES: f64 = 1e-3;

/// Drive where the raising force acts, or on a joint.
#[derive(Clone, Debug)]
pub(super) enum Drive {
    /// Vertical force.
    Force(DriveForce),
    /// Moment, positive where it raises the strip.
    Moment(JointMoment),
}

impl Drive {
    /// The drive as a force of the system.
    pub fn force(&mut self) -> &mut dyn Force {
        match self {
            Self::Force(force) => force,
            Self::Moment(moment) => moment,
        }
    }

    /// Reads place and velocity of what is driven.
    pub fn read(&self, motion: &Motion<'_>, reading: &mut Reading) {
        (reading.driven, reading.driven_place) = match self {
            Self::Force(force) => (force.velocity(motion), force.height(motion)),
            Self::Moment(moment) => (moment.rate(motion), moment.angle(motion)),
        };
    }
}

impl Linkage {
    /// Drive by the input `input`, where `actuator` has it.
    pub(super) fn drive(&self, actuator: &scene::Actuator, input: usize) -> Result<Drive, VehicleError> {
        Ok(match &actuator.joint {
            Some(joint) => Drive::Moment(self.moment_on(joint, input)?),
            None => Drive::Force(DriveForce::new(self.uplift.marker, input)),
        })
    }

    /// Moment on the revolute joint called `name` by the input `input`: positive where it raises the contact force in
    /// the reference position.
    ///
    /// # Errors
    /// No such joint, or one that does not raise the strip.
    pub(in crate::pantograph) fn moment_on(&self, name: &str, input: usize) -> Result<JointMoment, VehicleError> {
        let number = self.entry.revolute(name);
        let number = number.ok_or_else(|| VehicleError::UnknownJoint { name: name.to_owned() })?;
        let ratio = self.borne_by(number)?;
        if ratio.abs() < RAISES {
            return Err(VehicleError::RaisesNothing {
                name: name.to_owned(),
                ratio,
            });
        }
        Ok(JointMoment::new(self.joints[number].anchors(), ratio.signum(), input))
    }

    /// Contact force that a moment on joint `number` about its axis bears while nothing moves, per moment, 1/m.
    pub(in crate::pantograph) fn borne_by(&self, number: usize) -> Result<f64, VehicleError> {
        let (mut local, layout) = self.local(BaseMount::Fixed)?;
        local.air = AirForces::default();
        let mut unit = JointMoment::new(local.joints[number].anchors(), 1.0, 0);
        let mut load = DVector::zeros(layout.coordinates());
        unit.add_force(&layout.state_at_rest().motion(&[1.0]), load.as_mut_slice());
        statics::borne(&mut local, &layout, &load)
    }
}
