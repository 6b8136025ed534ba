//! The linkage reduced to the two motions that joints leave free: the one motion of the mechanism and the collector
//! suspension.
mod curve;
mod drive;
mod force;
mod one_motion;
mod plane;
mod point;
mod table;

use super::air::{Air, AirForces, AirMarker, add_at_rest};
use super::base_mount::BaseDisplacement;
use super::equilibrium::{Equilibrium, Offsets, Target};
use super::interface::Pantograph;
use super::linkage::Linkage;
use crate::error::Irreducible;
use crate::multibody::BodyMarker;
use crate::{Base, Travelling, VehicleError};
use control::Reading;
use curve::{MotionCurve, Node, Path};
use drive::ReducedDrive;
use dynamics::{AerodynamicLaw, Layout, Marker, Motion, PartVisitor};
use nalgebra::{DVector, Matrix3, UnitQuaternion, Vector2, Vector3};
pub(crate) use one_motion::ReducedStrip;
use one_motion::{OneMotion, StripBodyPosition};
use plane::Turn;
use point::PointPath;
pub(crate) use point::ReducedPoint;
use scene::Linkage as Entry;
use std::sync::Arc;
use table::Table;

/// Mechanism of a [`Linkage`] in two coordinates: `σ` of the one motion, and the rise `ζ` of the strip's body.
///
/// All bodies but the strip's follow `σ`, the arc length of their motion weighed by their inertias, so that their
/// kinetic energy is `½ σ̇²`. The body that guides the collector suspension is turned by `φ(σ)`, and `(X, Z)(σ)` is the
/// point of that body under the centre of mass of the strip's body with an unstretched suspension. With the
/// suspension's axis at `ψ = ψ₀ + φ` from the vertical the strip's body is at
///
/// ```text
/// x = X + τ (ζ − Z),   z = ζ,   angle φ,      τ = tan ψ,   s = (ζ − Z)/cos ψ
/// T = ½ σ̇² + ½ m (ẋ² + ζ̇²),   U = V(σ) + m g ζ + ½ k s² − P s                                        derived here
/// ```
///
/// `½ σ̇²` includes the turning of the strip's body, `V` weights and uplift of the others. The reduction is exact as
/// long as the mechanism cannot leave the plane ([`scene::Linkage::motions_beyond_one`]): the joints bear lateral
/// forces and rolling moments.
#[derive(Clone, Debug)]
pub(crate) struct ReducedLinkage {
    motion: Arc<OneMotion>,
    offsets: Offsets,
    stiffness: f64,
    damping: f64,
    preload: f64,
    static_force: f64,
    uplift_force: f64,
    base_z: f64,
    /// `(σ, ζ)` of the mass matrix used in the iteration matrix.
    start: [f64; 2],
    /// Mechanism alone in a layout, and the paths of the bodies: for drawings.
    full: Linkage,
    bodies: Vec<Arc<MotionCurve<3>>>,
    /// Forces of the air; no part of the balance in the reference position.
    air: AirForces,
    drive: Option<ReducedDrive>,
}

impl ReducedLinkage {
    /// Reduces the mechanism of a scene and builds it into `layout`; `name` begins the names of the coordinates.
    /// `gravity` in m/s².
    ///
    /// # Errors
    /// See [`Linkage::new`]; [`VehicleError::NotReducible`].
    pub(crate) fn new(entry: &Entry, gravity: f64, name: &str, layout: &mut Layout) -> Result<Self, VehicleError> {
        if let Some(reason) = entry.motions_beyond_one() {
            return Err(Irreducible::Motions(reason).into());
        }
        let full = Linkage::new(entry, gravity, name, &mut Layout::new())?;
        let head = full.strip_body();
        let table = Table::new(entry, &full, head, gravity)?;
        // A strip as low as the base lies on the roof.
        let ends = |q: &DVector<f64>| table.strip_point_height(q) < entry.base[2];
        let path = Path::trace(&table.plane, |tangent| table.rise(tangent), ends)?;
        let nodes: Vec<_> = path.nodes.iter().map(|node| table.jets(node)).collect();
        let curve = MotionCurve::new(path.first, path.step, &nodes);
        let bodies = (0..table.plane.references.len()).map(|body| {
            let jets = |node: &Node| {
                std::array::from_fn(|axis| {
                    let i = 3 * body + axis;
                    [node.q[i], node.first[i], node.second[i]]
                })
            };
            let nodes: Vec<_> = path.nodes.iter().map(jets).collect();
            MotionCurve::new(path.first, path.step, &nodes)
        });
        let body = &full.bodies()[head];
        let orientation = full.orientation(head);
        let motion = OneMotion {
            curve,
            tilt: Turn::by(table.tilt),
            mass: body.mass,
            weight: body.mass * gravity,
            reference_z: body.pose.reference.z,
            strip: orientation * full.strip_marker().offset,
            y: body.pose.reference.y,
            axes: orientation.to_rotation_matrix().into_inner(),
        };
        let first = layout.add_coordinates(1, format!("{name}, motion of the linkage"));
        layout.add_coordinates(1, format!("{name}, {}", entry.strip.body));
        let mut reduced = Self {
            motion: Arc::new(motion),
            offsets: Offsets {
                coordinate: first,
                constraint: layout.constraints(),
                orientation: layout.rotations().len(),
            },
            stiffness: entry.collector_suspension.stiffness,
            damping: entry.collector_suspension.damping,
            preload: 0.0,
            static_force: 0.0,
            uplift_force: entry.uplift.force,
            base_z: entry.base[2],
            start: [0.0; 2],
            bodies: bodies.map(Arc::new).collect(),
            air: AirForces::default(),
            drive: None,
            full,
        };
        reduced.balance();
        Ok(reduced)
    }

    /// Generalised forces of the air at rest at t = 0.
    fn air_at_rest(&self, [sigma, rise]: [f64; 2]) -> [f64; 2] {
        if self.air.as_slice().is_empty() {
            return [0.0; 2];
        }
        let i = self.offsets.coordinate;
        let mut q = vec![0.0; i + 2];
        let mut force = q.clone();
        (q[i], q[i + 1]) = (sigma, rise);
        add_at_rest(self.air.clone().as_mut_slice(), &q, &mut force);
        [force[i], force[i + 1]]
    }

    /// Preload and contact force under which the reference position is at rest.
    fn balance(&mut self) {
        let place = self.motion.place(0.0, 0.0);
        let [along_sigma, along_zeta] = place.s_q;
        // −V' + P s_σ − f z_σ = 0 and −m g + P s_ζ − f = 0
        let ratio = along_sigma / along_zeta;
        let [_, strip, _] = place.strip_height();
        self.static_force = (place.potential[1] - self.motion.weight * ratio) / (ratio - strip);
        self.preload = (self.motion.weight + self.static_force) / along_zeta;
    }

    /// Strip `strip` (from 0) of several in the frame of the base.
    fn strip_point(&self, strip: usize) -> ReducedPoint {
        let head = self.full.strip_body();
        let orientation = self.full.orientation(head);
        ReducedPoint {
            path: PointPath::StripBody(Arc::clone(&self.motion)),
            coordinate: self.offsets.coordinate,
            arm: orientation * self.full.head().markers[strip].offset,
            y: self.motion.y,
            axes: self.motion.axes,
        }
    }

    /// A point of a body of the mechanism in the frame of the base.
    fn point_of(&self, marker: &BodyMarker) -> ReducedPoint {
        // Alone in a layout, the mechanism counts orientations from 0, like bodies.
        let (number, head) = (marker.pose.orientation, self.full.strip_body());
        let orientation = self.full.orientation(number);
        ReducedPoint {
            path: if number == head {
                PointPath::StripBody(Arc::clone(&self.motion))
            } else {
                PointPath::Follower(Arc::clone(&self.bodies[number - usize::from(number > head)]))
            },
            coordinate: self.offsets.coordinate,
            arm: orientation * marker.offset,
            y: marker.pose.reference.y,
            axes: orientation.to_rotation_matrix() * marker.axes,
        }
    }

    /// The strip, or the mean place of several, in the frame of the base.
    #[must_use]
    pub(crate) fn strip_marker(&self) -> ReducedStrip {
        ReducedStrip {
            motion: Arc::clone(&self.motion),
            coordinate: self.offsets.coordinate,
        }
    }

    /// Preload of the collector suspension, N.
    #[must_use]
    #[cfg(test)]
    pub(crate) fn preload(&self) -> f64 {
        self.preload
    }

    pub(super) fn strip_at(&self, [sigma, rise]: [f64; 2]) -> Vector3<f64> {
        let place = self.motion.place(sigma, rise);
        Vector3::new(
            place.x + place.arm.x,
            self.motion.y + self.motion.strip.y,
            place.zeta + place.arm.y,
        )
    }

    /// Kinetic energy in the frame of the base, J.
    #[must_use]
    #[cfg(test)]
    pub(crate) fn kinetic_energy(&self, motion: &Motion<'_>) -> f64 {
        let i = self.offsets.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        let (v, [m11, m12, _, m22]) = ([motion.v[i], motion.v[i + 1]], place.mass(self.motion.mass));
        0.5 * (m11 * v[0] * v[0] + 2.0 * m12 * v[0] * v[1] + m22 * v[1] * v[1])
    }

    /// Same configuration in the coordinates of the full mechanism: displacements (three rotations unused) and
    /// orientations.
    #[must_use]
    pub(crate) fn configuration(&self, motion: &Motion<'_>) -> (Vec<f64>, Vec<UnitQuaternion<f64>>) {
        let i = self.offsets.coordinate;
        let (sigma, rise) = (motion.q[i], motion.q[i + 1]);
        let place = self.motion.place(sigma, rise);
        let head = self.full.strip_body();
        let mut q = vec![0.0; self.full.coordinates()];
        let mut rotation = Vec::new();
        let mut followers = self.bodies.iter();
        for (number, body) in self.full.bodies().iter().enumerate() {
            let reference = body.pose.reference;
            let [x, z, phi] = if number == head {
                [place.x, place.zeta, place.phi[0]]
            } else {
                followers
                    .next()
                    .map_or([f64::NAN; 3], |curve| curve.at(sigma).map(|jet| jet[0]))
            };
            q[body.pose.translation] = x - reference.x;
            q[body.pose.translation + 2] = z - reference.z;
            rotation.push(UnitQuaternion::from_axis_angle(&Vector3::y_axis(), phi) * self.full.orientation(number));
        }
        (q, rotation)
    }

    /// Generalised forces without velocities.
    fn rest_force(&self, place: &StripBodyPosition) -> [f64; 2] {
        let axial = self.preload - self.stiffness * place.s;
        [
            axial * place.s_q[0] - place.potential[1],
            axial * place.s_q[1] - self.motion.weight,
        ]
    }

    /// Negative derivative of the generalised forces, row by row.
    fn stiffness(&self, place: &StripBodyPosition) -> [f64; 4] {
        let axial = self.preload - self.stiffness * place.s;
        let [s_1, s_2] = place.s_q;
        let coupling = self.stiffness * s_1 * s_2 - axial * place.s_sigma_zeta;
        [
            self.stiffness * s_1 * s_1 - axial * place.s_sigma_sigma + place.potential[2],
            coupling,
            coupling,
            self.stiffness * s_2 * s_2,
        ]
    }
}

impl Pantograph for ReducedLinkage {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        visit("pantograph", self);
        if let Some(drive) = &mut self.drive {
            visit("pantograph", drive);
        }
        for air in self.air.as_mut_slice() {
            visit("wind_pantograph", air);
        }
    }

    fn expose(&mut self, air: &Air, base: Base) {
        let mut forces = AirForces::default();
        if let Some(coefficient) = air.uplift {
            let law = AerodynamicLaw::Uplift { coefficient };
            forces.push(air.force(AirMarker::Strip(self.strip_marker()), base, law), true);
        }
        let head = self.full.strip_body();
        for surface in &air.surfaces {
            for (marker, area) in self.full.points_of(surface) {
                let point = self.point_of(&marker);
                let law = AerodynamicLaw::Polar(surface.polar(area));
                let on_head = marker.pose.orientation == head;
                forces.push(air.force(AirMarker::Reduced(point), base, law), on_head);
            }
        }
        self.air = forces;
    }

    fn air(&self) -> &AirForces {
        &self.air
    }

    fn air_mut(&mut self) -> &mut AirForces {
        &mut self.air
    }

    /// Newton's method from the reference position on
    ///
    /// ```text
    /// Q_σ − f z_σ = 0,   Q_ζ − f = 0,   z = h  or  f given
    /// ```
    fn equilibrium(&self, base: Option<BaseDisplacement>, target: Target) -> Result<Equilibrium, VehicleError> {
        /// Accepted residual relative to the largest force, and in m.
        const TOLERANCE: f64 = 1e-12;
        const ITERATIONS: usize = 60;
        /// Longest turn of the suspension's guide in an iteration, rad.
        const LONGEST_TURN: f64 = 0.1;
        if base.is_some() {
            return Err(Irreducible::BaseMoves.into());
        }
        let mut q = [0.0; 2];
        let mut force = match target {
            Target::Force(force) => force,
            Target::Height(_) => self.static_force,
        };
        let (mut residual, mut tolerance) = (f64::INFINITY, 0.0);
        for _ in 0..ITERATIONS {
            let place = self.motion.place(q[0], q[1]);
            let [height, z_1, z_2] = place.strip_height();
            let [along_sigma, along_zeta] = self.rest_force(&place);
            let (missing, [by_zeta, by_force]) = match target {
                Target::Force(target) => (target - force, [0.0, 1.0]),
                Target::Height(target) => (target - height, [1.0, 0.0]),
            };
            // The air's own stiffness, far below that of the suspension, is left out of the matrix.
            let air = self.air_at_rest(q);
            let right = Vector3::new(along_sigma + air[0] - force * z_1, along_zeta + air[1] - force, missing);
            let scale = place.potential[1].abs().max(self.motion.weight).max(force.abs());
            tolerance = TOLERANCE * scale;
            residual = right.x.abs().max(right.y.abs()).max(right.z.abs() * scale);
            if residual <= tolerance {
                return Ok(Equilibrium {
                    height: match target {
                        Target::Height(target) => target,
                        Target::Force(_) => height,
                    },
                    force,
                    strip_forces: self.full.head().forces(force, 0.0),
                    strip_heights: self.full.head().heights(height, place.turn.of(Vector2::x()).y),
                    q: q.to_vec(),
                    rotation: Vec::new(),
                    lambda: Vec::new(),
                    vehicle: None,
                });
            }
            let [k11, k12, _, k22] = self.stiffness(&place);
            let matrix = Matrix3::new(
                k11 + force * z_2,
                k12,
                z_1,
                k12,
                k22,
                1.0,
                by_zeta * z_1,
                by_zeta,
                by_force,
            );
            let Some(change) = matrix.lu().solve(&right) else { break };
            if !change.iter().all(|entry| entry.is_finite()) {
                break;
            }
            let turn = (change.x * place.phi[1]).abs();
            let reach = self.motion.curve.range().1 - self.motion.curve.range().0;
            let share = (0.05 * reach / change.x.abs()).min(LONGEST_TURN / turn).min(1.0);
            q[0] += share * change.x;
            q[1] += share * change.y;
            force += change.z;
        }
        Err(VehicleError::NotConverged {
            target: target.to_string(),
            iterations: ITERATIONS,
            residual,
            tolerance,
        })
    }

    /// Sets the start of the motion: the solver factors the mass matrix of this configuration.
    fn start_at(&mut self, equilibrium: &Equilibrium) {
        self.start = [equilibrium.q[0], equilibrium.q[1]];
    }

    fn offsets(&self) -> Offsets {
        self.offsets
    }

    fn strip_position(&self, equilibrium: &Equilibrium) -> Vector3<f64> {
        self.strip_at([equilibrium.q[0], equilibrium.q[1]]) - Vector3::x() * self.full.head().mean
    }

    fn strips(&self) -> usize {
        self.full.head().markers.len()
    }

    fn rises(&self) -> Vec<Vec<f64>> {
        self.full.head().rises()
    }

    fn equilibrium_under(&self, base: Option<BaseDisplacement>, heights: &[f64]) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(base, Target::Height(heights.iter().sum::<f64>() / heights.len() as f64))
    }

    fn strip(&self, base: Base, strip: usize) -> Box<dyn Marker> {
        if self.strips() > 1 {
            let marker = self.strip_point(strip);
            return Box::new(Travelling { marker, base });
        }
        let marker = self.strip_marker();
        Box::new(Travelling { marker, base })
    }

    fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        let (q, rotation) = self.configuration(motion);
        let motion = Motion {
            t: motion.t,
            v: &q,
            q: &q,
            rotation: &rotation,
            u: &[],
        };
        self.full.outline(&motion)
    }

    fn base_z(&self) -> f64 {
        self.base_z
    }

    fn uplift_force(&self) -> f64 {
        self.uplift_force
    }

    fn drive_by(&mut self, actuator: &scene::Actuator, input: usize) -> Result<(), VehicleError> {
        self.drive = Some(self.drive(actuator, input)?);
        Ok(())
    }

    fn read(&self, motion: &Motion<'_>, reading: &mut Reading) {
        if let Some(drive) = &self.drive {
            drive.read(motion, reading);
        }
    }

    fn static_force(&self) -> f64 {
        self.static_force
    }

    fn reference_height(&self) -> f64 {
        self.strip_at([0.0; 2]).z
    }

    fn coordinates(&self) -> usize {
        2
    }
}
