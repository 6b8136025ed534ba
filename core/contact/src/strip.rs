//! A collector strip whose motion is prescribed by inputs.
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::{Rotation3, Vector3};

/// Inputs per strip: x, y, z (m), vx, vy, vz (m/s), roll (rad).
pub const STRIP_INPUTS: usize = 7;

/// Number of values that define a strip's motion: its inputs, and the roll rate (rad/s), the derivative of the roll
/// input in time.
pub const STRIP_VALUES: usize = STRIP_INPUTS + 1;

/// A strip that follows the values `u[first..first + 8]` among the inputs of the system.
///
/// The second axis of its frame is along the strip: lateral, turned by the roll angle about x.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrescribedStrip {
    /// Index of the strip's first value.
    pub first: usize,
}

impl Marker for PrescribedStrip {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let u = &motion.u[self.first..self.first + STRIP_VALUES];
        Frame {
            position: Vector3::new(u[0], u[1], u[2]),
            axes: Rotation3::from_axis_angle(&Vector3::x_axis(), u[6]).into_inner(),
            velocity: Vector3::new(u[3], u[4], u[5]),
            angular_velocity: Vector3::x() * u[7],
        }
    }

    fn columns(&self, _motion: &Motion<'_>, _columns: &mut Columns) {}
}
