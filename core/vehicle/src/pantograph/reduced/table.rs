//! Tabulated quantities of a linkage, from the scene entry.
use super::curve::{Jet, Node};
use super::plane::{End, Plane, PlaneJoint};
use crate::VehicleError;
use crate::error::Irreducible;
use crate::pantograph::Linkage;
use nalgebra::{DVector, Vector2};
use scene::{JointKind, Linkage as Entry};

/// Mechanism without the strip's body, and the tabulated quantities.
pub(super) struct Table {
    pub plane: Plane,
    gravity: f64,
    masses: Vec<f64>,
    /// Centre of mass of the strip's body as a point of its guide, and the number of the guide.
    strip_point: End,
    guide: usize,
    pub tilt: f64,
    uplift: (f64, End),
}

impl Table {
    pub fn new(entry: &Entry, full: &Linkage, head: usize, gravity: f64) -> Result<Self, VehicleError> {
        let base = Vector2::new(entry.base[0], 0.0);
        let in_plane = |point: &[f64; 3]| Vector2::new(point[0], point[2]) - base;
        // Numbers without the strip's body.
        let number = |name: &str| {
            let number = entry.bodies.iter().position(|body| body.name == name)?;
            Some(if number > head { number - 1 } else { number })
        };
        let others = || entry.bodies.iter().filter(|body| body.name != entry.strip.body);
        let references: Vec<_> = others().map(|body| in_plane(&body.position)).collect();
        let end = |name: &str, point: &[f64; 3]| match number(name) {
            None => End::Base(in_plane(point)),
            Some(body) => End::Body(body, in_plane(point) - references[body]),
        };
        let mut guide = None;
        let mut joints = Vec::new();
        for joint in &entry.joints {
            if joint.first == entry.strip.body || joint.second == entry.strip.body {
                let other = if joint.first == entry.strip.body {
                    &joint.second
                } else {
                    &joint.first
                };
                if let JointKind::Prismatic { axis } = joint.kind {
                    guide = number(other).map(|body| (body, axis));
                }
                continue;
            }
            let ends = (end(&joint.first, &joint.point), end(&joint.second, &joint.point));
            joints.push(match joint.kind {
                JointKind::Prismatic { axis } => {
                    PlaneJoint::Guide(ends.0, ends.1, Vector2::new(axis[0], axis[2]).normalize())
                }
                _ => PlaneJoint::Pin(ends.0, ends.1),
            });
        }
        let Some((guide, axis)) = guide else {
            return Err(Irreducible::NoGuide {
                name: entry.strip.body.clone(),
            }
            .into());
        };
        let upright = axis[2].signum();
        let inertia = |body: &scene::Body| {
            let rows = body.rotation();
            (0..3).map(|k| rows[1][k] * rows[1][k] * body.inertia[k]).sum::<f64>()
        };
        let mut inertias: Vec<_> = others().map(|body| (body.mass, inertia(body))).collect();
        inertias[guide].1 += inertia(&entry.bodies[head]);
        let uplift = entry
            .uplift_point()
            .map(|point| (entry.uplift.force, end(&entry.uplift.body, &point)));
        let Some(uplift) = uplift else {
            return Err(VehicleError::NoBaseJoint {
                name: entry.uplift.body.clone(),
            });
        };
        Ok(Self {
            gravity,
            masses: others().map(|body| body.mass).collect(),
            strip_point: End::Body(
                guide,
                Vector2::new(
                    full.bodies()[head].pose.reference.x,
                    full.bodies()[head].pose.reference.z,
                ) - references[guide],
            ),
            guide,
            tilt: (upright * axis[0]).atan2(upright * axis[2]),
            uplift,
            plane: Plane {
                references,
                inertias,
                joints,
            },
        })
    }

    /// Rise of the collector suspension in the reference position along a tangent.
    pub fn rise(&self, tangent: &DVector<f64>) -> f64 {
        let none = DVector::zeros(tangent.len());
        let along = Plane::point(self.strip_point, &self.plane.reference(), tangent, &none);
        along.first.y
    }

    /// Height of the unstretched suspension, m.
    pub fn strip_point_height(&self, q: &DVector<f64>) -> f64 {
        let none = DVector::zeros(q.len());
        Plane::point(self.strip_point, q, &none, &none).value.y
    }

    /// `X`, `Z`, `φ`, `V` at a node.
    pub fn jets(&self, node: &Node) -> [Jet; 4] {
        let point = |end: End| Plane::point(end, &node.q, &node.first, &node.second);
        let of = |i: usize| [node.q[i], node.first[i], node.second[i]];
        let strip_point = point(self.strip_point);
        let axis = |k: usize| [strip_point.value[k], strip_point.first[k], strip_point.second[k]];
        let lifted = point(self.uplift.1);
        let mut potential = [lifted.value.y, lifted.first.y, lifted.second.y].map(|z| -self.uplift.0 * z);
        for (body, mass) in self.masses.iter().enumerate() {
            for (sum, z) in potential.iter_mut().zip(of(3 * body + 1)) {
                *sum += mass * self.gravity * z;
            }
        }
        [axis(0), axis(1), of(3 * self.guide + 2), potential]
    }
}
