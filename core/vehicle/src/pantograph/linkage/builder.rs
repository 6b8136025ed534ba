//! From the scene's mechanism to bodies, joints and forces.
use crate::VehicleError;
use crate::multibody::{Anchor, AxialSpring, BodyMarker, DeadForce, Joint, Pair, Pose, RigidBody};
use crate::pantograph::BaseMount;
use dynamics::Layout;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use scene::{JointKind, Linkage as Entry};

/// The scene's mechanism on the way to its parts.
pub(super) struct Builder<'a> {
    entry: &'a Entry,
    mount: BaseMount,
    /// Origin of the frame of the base, in coordinates of the mechanism, m.
    origin: Vector3<f64>,
    pub orientations: Vec<UnitQuaternion<f64>>,
    pub bodies: Vec<RigidBody>,
}

impl<'a> Builder<'a> {
    /// Builder for a base `lateral` (m) beside the middle of the track.
    pub fn new(
        entry: &'a Entry,
        (mount, lateral): (BaseMount, f64),
        gravity: f64,
        name: &str,
        layout: &mut Layout,
    ) -> Self {
        let origin = Vector3::new(entry.base[0], entry.base[1] - lateral, 0.0);
        let mut orientations = Vec::new();
        let mut bodies = Vec::new();
        for body in &entry.bodies {
            let rows = body.rotation();
            let matrix = Matrix3::from_fn(|row, column| rows[row][column]);
            let orientation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
            bodies.push(RigidBody {
                pose: Pose::new(
                    Vector3::from(body.position) - origin,
                    orientation,
                    &format!("{name}, {}", body.name),
                    layout,
                ),
                mass: body.mass,
                inertia: body.inertia.into(),
                gravity,
            });
            orientations.push(orientation);
        }
        Self {
            entry,
            mount,
            origin,
            orientations,
            bodies,
        }
    }

    /// Point given in the mechanism's coordinates, in the frame of the base.
    fn point(&self, point: &[f64; 3]) -> Vector3<f64> {
        Vector3::from(*point) - self.origin
    }

    pub fn number(&self, key: &'static str, name: &str) -> Result<usize, VehicleError> {
        let number = self.entry.bodies.iter().position(|body| body.name == name);
        number.ok_or_else(|| VehicleError::UnknownBody {
            key,
            name: name.to_owned(),
        })
    }

    fn marker(&self, number: usize, point: &Vector3<f64>, axes: &Matrix3<f64>) -> BodyMarker {
        BodyMarker::at(self.bodies[number].pose, &self.orientations[number], point, axes)
    }

    fn anchor(&self, key: &'static str, name: &str, joint: &scene::Joint) -> Result<Anchor, VehicleError> {
        let point = self.point(&joint.point);
        let axes = match joint.kind {
            JointKind::Spherical => Matrix3::identity(),
            JointKind::Revolute { axis } | JointKind::Prismatic { axis } => frame_about(&axis.into()),
        };
        if name == Entry::BASE {
            return Ok(self.mount.anchor(point, axes));
        }
        Ok(Anchor::Body(self.marker(self.number(key, name)?, &point, &axes)))
    }

    pub fn joints(&self) -> Result<Vec<Joint>, VehicleError> {
        let build = |joint: &scene::Joint| {
            let first = self.anchor("joints.first", &joint.first, joint)?;
            let second = self.anchor("joints.second", &joint.second, joint)?;
            Ok(match joint.kind {
                JointKind::Revolute { .. } => Joint::revolute(first, second),
                JointKind::Spherical => Joint::spherical(first, second),
                JointKind::Prismatic { .. } => Joint::prismatic(first, second),
            })
        };
        self.entry.joints.iter().map(build).collect()
    }

    /// The spring acts on the strip's body as the second anchor, so that a positive preload lifts along the axis.
    pub fn suspension(&self) -> Result<AxialSpring, VehicleError> {
        let name = &self.entry.strip.body;
        let guides = |joint: &&scene::Joint| {
            matches!(joint.kind, JointKind::Prismatic { .. }) && (&joint.first == name || &joint.second == name)
        };
        let found: Vec<_> = self.entry.joints.iter().filter(guides).collect();
        let [joint] = found[..] else {
            return Err(VehicleError::NoSuspension {
                name: name.clone(),
                count: found.len(),
            });
        };
        let guide = if &joint.second == name {
            &joint.first
        } else {
            &joint.second
        };
        Ok(AxialSpring {
            pair: Pair {
                first: self.anchor("joints.first", guide, joint)?,
                second: self.anchor("strip.body", name, joint)?,
            },
            stiffness: self.entry.collector_suspension.stiffness,
            damping: self.entry.collector_suspension.damping,
            preload: 0.0,
        })
    }

    pub fn uplift(&self) -> Result<DeadForce, VehicleError> {
        let uplift = &self.entry.uplift;
        let number = self.number("uplift.body", &uplift.body)?;
        let joins = |joint: &&scene::Joint| {
            let ends = [&joint.first, &joint.second];
            ends.contains(&&uplift.body) && ends.iter().any(|end| *end == Entry::BASE)
        };
        let joint = self
            .entry
            .joints
            .iter()
            .find(joins)
            .ok_or_else(|| VehicleError::NoBaseJoint {
                name: uplift.body.clone(),
            })?;
        let foot = self.point(&joint.point);
        let along = self.bodies[number].pose.reference - foot;
        let point = foot + along.normalize() * uplift.distance;
        Ok(DeadForce {
            marker: self.marker(number, &point, &Matrix3::identity()),
            force: Vector3::new(0.0, 0.0, uplift.force),
        })
    }

    /// Point of the head that is `ahead` (m) of the middle of the strip.
    pub fn strip(&self, ahead: f64) -> Result<BodyMarker, VehicleError> {
        let number = self.number("strip.body", &self.entry.strip.body)?;
        let along = self.orientations[number].inverse() * Vector3::x();
        Ok(BodyMarker {
            pose: self.bodies[number].pose,
            offset: Vector3::from(self.entry.strip.offset) + along * ahead,
            axes: Matrix3::identity(),
        })
    }
}

/// Orthonormal axes (columns) whose third one points along `axis`.
fn frame_about(axis: &Vector3<f64>) -> Matrix3<f64> {
    let third = axis.normalize();
    // Reference direction far from the axis, so that the cross product is well conditioned.
    let helper = if third.x.abs() < 0.7 {
        Vector3::x()
    } else {
        Vector3::y()
    };
    let second = third.cross(&helper).normalize();
    Matrix3::from_columns(&[second.cross(&third), second, third])
}
