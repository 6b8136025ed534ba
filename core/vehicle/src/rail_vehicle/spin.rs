//! The spin of a wheelset about its axle.
use crate::multibody::{BodyMarker, Pose};
use dynamics::{Blocks, Columns, Force, Frame, Marker, Motion, Weights};
use nalgebra::{Matrix3, Vector3};

/// Terms that a wheelset's spin adds to the rigid body of the axle, which follows all motions but the spin.
///
/// A wheelset is a body of revolution, so that the inertia is constant in axes that do not spin. The pitch of these
/// axes about the axle is held; the spin is `Ω = Ω₀ + χ̇` with a separate coordinate χ:
///
/// ```text
/// I_y χ̈ = M_y,    M_x += I_y Ω ω_z,    M_z −= I_y Ω ω_x           (Euler's equations in those axes, derived here)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// Pose of the axle.
    pub pose: Pose,
    /// χ.
    pub coordinate: usize,
    /// `Ω₀`, rad/s.
    pub rolling: f64,
    /// `I_y`, kg·m².
    pub inertia: f64,
}

impl Spin {
    /// `Ω`, rad/s.
    #[must_use]
    pub fn rate(&self, motion: &Motion<'_>) -> f64 {
        self.rolling + motion.v[self.coordinate]
    }
}

impl Force for Spin {
    fn depends_on_inputs(&self) -> bool {
        false
    }

    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let omega_b = self.pose.angular_velocity(motion);
        let momentum = self.inertia * self.rate(motion);
        force[self.pose.rotation] += momentum * omega_b.z;
        force[self.pose.rotation + 2] -= momentum * omega_b.x;
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let omega_b = self.pose.angular_velocity(motion) * (self.inertia * weights.v);
        let momentum = self.inertia * self.rate(motion) * weights.v;
        let (roll, yaw) = (self.pose.rotation, self.pose.rotation + 2);
        let values = [0.0, -momentum, -omega_b.z, momentum, 0.0, omega_b.x];
        blocks.add(&[roll, yaw], &[roll, yaw, self.coordinate], &values);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        blocks.add(&[self.coordinate], &[self.coordinate], &[self.inertia]);
    }
}

/// Middle of a wheelset, with the part of the spin that is a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelsetMarker {
    axle: BodyMarker,
    coordinate: usize,
}

impl WheelsetMarker {
    /// Marker of an axle and χ.
    #[must_use]
    pub fn new(pose: Pose, coordinate: usize) -> Self {
        Self {
            axle: BodyMarker {
                pose,
                offset: Vector3::zeros(),
                axes: Matrix3::identity(),
            },
            coordinate,
        }
    }
}

impl Marker for WheelsetMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let frame = self.axle.frame(motion);
        let spin = frame.axes.column(1) * motion.v[self.coordinate];
        Frame {
            angular_velocity: frame.angular_velocity + spin,
            ..frame
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        let (_, axes) = self.axle.columns_of(motion, &mut |column| {
            columns.push(column.index, column.translation, column.rotation);
        });
        let axle = axes.column(1).into_owned();
        columns.push(self.coordinate, Vector3::zeros(), axle);
    }
}
