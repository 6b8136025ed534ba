//! Rigid bodies and points fixed in them.
use dynamics::rotation::skew;
use dynamics::{Blocks, Column, Columns, Force, Frame, Layout, Marker, Motion, Weights};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Indices of the coordinates of a rigid body: three displacements of the centre of mass from the reference position,
/// three rotations.
///
/// Velocities are the velocity of the centre of mass and the angular velocity in the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// First of the three displacements.
    pub translation: usize,
    /// First of the three rotations.
    pub rotation: usize,
    /// Index of the orientation in [`Motion::rotation`].
    pub orientation: usize,
    /// Centre of mass with all displacements zero, m.
    pub reference: Vector3<f64>,
}

impl Pose {
    /// Adds the six coordinates of a body to a layout.
    pub fn new(reference: Vector3<f64>, orientation: UnitQuaternion<f64>, name: &str, layout: &mut Layout) -> Self {
        let translation = layout.add_coordinates(3, format!("{name}, translation"));
        let (rotation, orientation) = layout.add_rotation(orientation, format!("{name}, rotation"));
        Self {
            translation,
            rotation,
            orientation,
            reference,
        }
    }

    /// Position of the centre of mass, m.
    #[must_use]
    pub fn position(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.reference + vector(motion.q, self.translation)
    }

    /// Body to world.
    #[must_use]
    pub fn axes(&self, motion: &Motion<'_>) -> Matrix3<f64> {
        motion.rotation[self.orientation].to_rotation_matrix().into_inner()
    }

    /// Velocity of the centre of mass, m/s.
    #[must_use]
    pub fn velocity(&self, motion: &Motion<'_>) -> Vector3<f64> {
        vector(motion.v, self.translation)
    }

    /// Angular velocity in the body frame, rad/s.
    #[must_use]
    pub fn angular_velocity(&self, motion: &Motion<'_>) -> Vector3<f64> {
        vector(motion.v, self.rotation)
    }
}

/// The three entries of `values` from `first` on.
fn vector(values: &[f64], first: usize) -> Vector3<f64> {
    Vector3::new(values[first], values[first + 1], values[first + 2])
}

/// A rigid body: inertia, weight and gyroscopic moment.
///
/// ```text
/// m r̈ = F − m g e_z,    I ω̇ + ω × I ω = M          (principal axes, body frame)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    /// Coordinates of the body.
    pub pose: Pose,
    /// kg.
    pub mass: f64,
    /// Principal moments of inertia about the centre of mass, kg·m².
    pub inertia: Vector3<f64>,
    /// Gravitational acceleration, downward, m/s².
    pub gravity: f64,
}

impl RigidBody {
    /// Kinetic energy in the frame of the base, J.
    #[must_use]
    pub fn kinetic_energy(&self, motion: &Motion<'_>) -> f64 {
        let omega_b = self.pose.angular_velocity(motion);
        0.5 * self.mass * self.pose.velocity(motion).norm_squared()
            + 0.5 * omega_b.dot(&self.inertia.component_mul(&omega_b))
    }
}

impl Force for RigidBody {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        force[self.pose.translation + 2] -= self.mass * self.gravity;
        let omega_b = self.pose.angular_velocity(motion);
        let gyroscopic = omega_b.cross(&self.inertia.component_mul(&omega_b));
        for axis in 0..3 {
            force[self.pose.rotation + axis] -= gyroscopic[axis];
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let omega_b = self.pose.angular_velocity(motion);
        // ∂(ω × Iω)/∂ω
        let damping =
            skew(&omega_b) * Matrix3::from_diagonal(&self.inertia) - skew(&self.inertia.component_mul(&omega_b));
        let block = (damping * weights.v).transpose(); // nalgebra stores by columns
        let indices = [0, 1, 2].map(|axis| self.pose.rotation + axis);
        blocks.add(&indices, &indices, block.as_slice());
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for axis in 0..3 {
            let (translation, rotation) = (self.pose.translation + axis, self.pose.rotation + axis);
            blocks.add(&[translation], &[translation], &[self.mass]);
            blocks.add(&[rotation], &[rotation], &[self.inertia[axis]]);
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.mass * self.gravity * self.pose.position(motion).z
    }
}

/// A point and axes fixed in a rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMarker {
    /// The body.
    pub pose: Pose,
    /// The point relative to the centre of mass, body axes, m.
    pub offset: Vector3<f64>,
    /// The marker's axes as columns, body axes.
    pub axes: Matrix3<f64>,
}

impl BodyMarker {
    /// Marker that is at `point` (m) with the axes `axes` (columns) when the body is in the reference position with the
    /// given orientation.
    #[must_use]
    pub fn at(pose: Pose, orientation: &UnitQuaternion<f64>, point: &Vector3<f64>, axes: &Matrix3<f64>) -> Self {
        let to_body = orientation.to_rotation_matrix().transpose();
        Self {
            pose,
            offset: to_body * (point - pose.reference),
            axes: to_body.matrix() * axes,
        }
    }
}

/// A body at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyNow {
    /// Centre of mass, m.
    position: Vector3<f64>,
    /// Body to world.
    axes: Matrix3<f64>,
    /// Velocity of the centre of mass, m/s.
    velocity: Vector3<f64>,
    /// World axes, rad/s.
    angular_velocity: Vector3<f64>,
}

impl Pose {
    /// The body now.
    pub(crate) fn now(&self, motion: &Motion<'_>) -> BodyNow {
        let axes = self.axes(motion);
        BodyNow {
            position: self.position(motion),
            axes,
            velocity: self.velocity(motion),
            angular_velocity: axes * self.angular_velocity(motion),
        }
    }
}

/// A marker at one instant; only what is asked for is evaluated.
pub(crate) enum Grip<'a> {
    /// No coordinate moves the marker.
    Fixed(Frame),
    /// The marker of a body.
    Body {
        marker: &'a BodyMarker,
        now: &'a BodyNow,
        /// The point from the centre of mass, world axes, m.
        offset: Vector3<f64>,
    },
}

impl Grip<'_> {
    /// Position, m.
    #[inline]
    pub fn position(&self) -> Vector3<f64> {
        match self {
            Self::Fixed(frame) => frame.position,
            Self::Body { now, offset, .. } => now.position + offset,
        }
    }

    /// Position from the centre of mass, world axes, m; zero without body.
    #[inline]
    pub fn lever(&self) -> Vector3<f64> {
        match self {
            Self::Fixed(_) => Vector3::zeros(),
            Self::Body { offset, .. } => *offset,
        }
    }

    /// Axes of the marker as columns.
    #[inline]
    pub fn axes(&self) -> Matrix3<f64> {
        match self {
            Self::Fixed(frame) => frame.axes,
            Self::Body { marker, now, .. } => now.axes * marker.axes,
        }
    }

    /// Velocity of the point, m/s.
    #[inline]
    pub fn velocity(&self) -> Vector3<f64> {
        match self {
            Self::Fixed(frame) => frame.velocity,
            Self::Body { now, offset, .. } => now.velocity + now.angular_velocity.cross(offset),
        }
    }

    /// Angular velocity, rad/s.
    #[inline]
    pub fn angular_velocity(&self) -> Vector3<f64> {
        match self {
            Self::Fixed(frame) => frame.angular_velocity,
            Self::Body { now, .. } => now.angular_velocity,
        }
    }

    fn frame(&self) -> Frame {
        Frame {
            position: self.position(),
            axes: self.axes(),
            velocity: self.velocity(),
            angular_velocity: self.angular_velocity(),
        }
    }
}

impl BodyMarker {
    /// Position (m) and axes; `see` is given the columns.
    #[inline]
    pub(crate) fn columns_of(&self, motion: &Motion<'_>, see: &mut impl FnMut(Column)) -> (Vector3<f64>, Matrix3<f64>) {
        let axes = self.pose.axes(motion);
        let offset = axes * self.offset;
        for axis in 0..3 {
            see(Column {
                index: self.pose.translation + axis,
                translation: Vector3::ith(axis, 1.0),
                rotation: Vector3::zeros(),
            });
        }
        for axis in 0..3 {
            let rotation = axes.column(axis).into_owned();
            see(Column {
                index: self.pose.rotation + axis,
                translation: rotation.cross(&offset),
                rotation,
            });
        }
        (self.pose.position(motion) + offset, axes * self.axes)
    }

    /// The marker of the body as it is now.
    #[inline]
    pub(crate) fn grip<'a>(&'a self, now: &'a BodyNow) -> Grip<'a> {
        Grip::Body {
            marker: self,
            now,
            offset: now.axes * self.offset,
        }
    }
}

/// Force (N) and moment about the centre of mass (N·m) on a body, world axes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wrench {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// Adds the generalised force to `out`.
    pub fn add_to(&self, pose: &Pose, now: &BodyNow, out: &mut [f64]) {
        for axis in 0..3 {
            out[pose.translation + axis] += self.force[axis];
            out[pose.rotation + axis] += now.axes.column(axis).dot(&self.moment);
        }
    }
}

impl std::ops::AddAssign for Wrench {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}

impl Marker for BodyMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        self.grip(&self.pose.now(motion)).frame()
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        self.columns_of(motion, &mut |column| {
            columns.push(column.index, column.translation, column.rotation);
        });
    }
}
