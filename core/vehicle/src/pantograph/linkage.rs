//! The linkage: a pantograph of rigid bodies and joints.
mod builder;
mod drive;
mod head;
mod statics;

use super::air::{Air, AirForces, AirMarker, points_of};
use super::base_mount::{BaseDisplacement, BaseMount};
use super::equilibrium::{Equilibrium, Offsets, Target};
use super::interface::Pantograph;
use crate::multibody::{Anchor, AxialSpring, BodyMarker, DeadForce, Joint, RigidBody};
use crate::rail_vehicle::{CurveInertia, Load};
use crate::{Base, Travel, Travelling, VehicleError};
use builder::Builder;
use control::Reading;
use drive::Drive;
#[cfg(test)]
use dynamics::State;
use dynamics::{AerodynamicLaw, Constraint, Layout, Marker, Motion, PartVisitor};
pub(crate) use head::Strips;
use head::mean;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use scene::Linkage as Entry;

/// Any tree or loop of rigid bodies on a base, a collector head on its suspension, and an uplift force.
///
/// In the frame of the base, the base's reference point has x = 0, the y of the pantograph's base on the vehicle (0
/// without vehicle), and the height above the top of rail. The tabulated position is the reference position: all
/// displacements zero, and an equilibrium. The preload of the collector suspension ensures the equilibrium: the preload
/// balances the head's weight and the contact force that the rest of the mechanism can bear.
#[derive(Clone, Debug)]
pub struct Linkage {
    entry: Entry,
    /// y of the base's reference point, m.
    lateral: f64,
    gravity: f64,
    offsets: Offsets,
    bodies: Vec<RigidBody>,
    joints: Vec<Joint>,
    suspension: AxialSpring,
    uplift: DeadForce,
    drive: Option<Drive>,
    /// Mean place of the strips.
    strip: BodyMarker,
    strips: Strips,
    /// Orientations of the bodies in the reference position.
    orientations: Vec<UnitQuaternion<f64>>,
    static_force: f64,
    /// Forces of the air; no part of the balance in the reference position.
    air: AirForces,
    /// Inertia on a base in a curve; no part of statics.
    inertia: Option<CurveInertia>,
}

impl Linkage {
    /// Builds the mechanism into `layout`; `name` begins the names of the coordinates. `gravity` in m/s².
    ///
    /// # Errors
    /// Names that do not fit together; [`VehicleError::NotBalanced`] if the tabulated position cannot be at rest.
    pub(crate) fn new(entry: &Entry, gravity: f64, name: &str, layout: &mut Layout) -> Result<Self, VehicleError> {
        Self::on(BaseMount::Fixed, entry, gravity, name, layout)
    }

    /// The same mechanism on another mount; the preload of the suspension is that of the reference position.
    ///
    /// # Errors
    /// See [`Linkage::new`].
    pub(crate) fn on(
        mount: BaseMount,
        entry: &Entry,
        gravity: f64,
        name: &str,
        layout: &mut Layout,
    ) -> Result<Self, VehicleError> {
        let lateral = mount.lateral();
        let mut linkage = Self::without_preload((mount, lateral), entry, gravity, name, layout)?;
        let mut local = linkage.local(BaseMount::Fixed)?;
        let balance = statics::balance(&mut local.0, &local.1)?;
        linkage.suspension.preload = balance.preload;
        linkage.static_force = balance.force;
        linkage.strips.pitch = balance.pitches;
        Ok(linkage)
    }

    /// The same mechanism alone in a layout, on this mount.
    pub(crate) fn local(&self, mount: BaseMount) -> Result<(Self, Layout), VehicleError> {
        let mut layout = Layout::new();
        let place = (mount, self.lateral);
        let mut linkage = Self::without_preload(place, &self.entry, self.gravity, "linkage", &mut layout)?;
        linkage.suspension.preload = self.suspension.preload;
        linkage.static_force = self.static_force;
        linkage.strips.pitch = self.strips.pitch;
        linkage.air.clone_from(&self.air);
        for force in linkage.air.as_mut_slice() {
            if let AirMarker::Body(marker) = &mut force.marker.marker {
                marker.pose.translation -= self.offsets.coordinate;
                marker.pose.rotation -= self.offsets.coordinate;
                marker.pose.orientation -= self.offsets.orientation;
            }
        }
        Ok((linkage, layout))
    }

    fn without_preload(
        (mount, lateral): (BaseMount, f64),
        entry: &Entry,
        gravity: f64,
        name: &str,
        layout: &mut Layout,
    ) -> Result<Self, VehicleError> {
        let offsets = Offsets {
            coordinate: layout.coordinates(),
            constraint: layout.constraints(),
            orientation: layout.rotations().len(),
        };
        let builder = Builder::new(entry, (mount, lateral), gravity, name, layout);
        let joints = builder.joints()?;
        layout.add_constraints(joints.iter().map(Constraint::dimension).sum());
        let strips = Strips::new(entry, &builder)?;
        Ok(Self {
            suspension: builder.suspension()?,
            uplift: builder.uplift()?,
            drive: None,
            strip: builder.strip(strips.mean)?,
            strips,
            orientations: builder.orientations,
            joints,
            bodies: builder.bodies,
            entry: entry.clone(),
            lateral,
            gravity,
            offsets,
            static_force: 0.0,
            air: AirForces::default(),
            inertia: None,
        })
    }

    /// State of rest at a target with the head inclined by `slope`, where it is free to pitch.
    fn at(&self, base: Option<BaseDisplacement>, target: Target, slope: f64) -> Result<Equilibrium, VehicleError> {
        let (mut linkage, layout) = self.local(base.map_or(BaseMount::Fixed, BaseMount::Displaced))?;
        let start = layout.state_at_rest();
        statics::solve(&mut linkage, start, self.static_force, (target, slope))
    }

    /// Adds the inertia forces of the curves that the base runs through.
    pub(crate) fn follow_curves(&mut self, travel: &Travel) {
        self.inertia = CurveInertia::new(travel, &self.bodies, &[]);
    }

    /// Points of a surface and their areas in m²; none for an unknown body.
    pub(super) fn points_of(&self, surface: &scene::WindSurface) -> Vec<(BodyMarker, f64)> {
        let Some(number) = self.entry.bodies.iter().position(|body| body.name == surface.body) else {
            return Vec::new();
        };
        let pose = self.bodies[number].pose;
        let points = points_of(surface, &self.orientations[number]).into_iter();
        points
            .map(|(offset, axes, area)| (BodyMarker { pose, offset, axes }, area))
            .collect()
    }

    /// The strip, or the mean place of several, in the frame of the base; its axes are those of the body.
    #[must_use]
    pub(crate) fn strip_marker(&self) -> BodyMarker {
        self.strip
    }

    /// The centre of mass of the body called `name`, in the frame of the base.
    #[must_use]
    pub fn body_marker(&self, name: &str) -> Option<BodyMarker> {
        let number = self.entry.bodies.iter().position(|body| body.name == name)?;
        Some(BodyMarker {
            pose: self.bodies[number].pose,
            offset: Vector3::zeros(),
            axes: Matrix3::identity(),
        })
    }

    /// The bodies, in the order of the scene.
    #[must_use]
    pub fn bodies(&self) -> &[RigidBody] {
        &self.bodies
    }

    /// The joints, in the order of the scene.
    #[must_use]
    pub(crate) fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The spring–damper under the collector head.
    #[must_use]
    pub(crate) fn suspension(&self) -> &AxialSpring {
        &self.suspension
    }

    /// Strips of the head.
    pub(crate) fn head(&self) -> &Strips {
        &self.strips
    }

    /// Mean place of the strips in the reference position, in the frame of the base, m.
    pub(crate) fn reference_strip_position(&self) -> Vector3<f64> {
        self.strip.pose.reference + self.orientation(self.strip_body()) * self.strip.offset
    }

    /// A constant vertical force (N, upward) in the mean place of the strips.
    pub(crate) fn vertical_force_on_strip(&self, force: f64) -> DeadForce {
        DeadForce {
            marker: self.strip,
            force: Vector3::new(0.0, 0.0, force),
        }
    }

    /// Number of the strip's body.
    pub(super) fn strip_body(&self) -> usize {
        self.strip.pose.orientation - self.offsets.orientation
    }

    /// Orientation of a body in the reference position.
    pub(super) fn orientation(&self, body: usize) -> UnitQuaternion<f64> {
        self.orientations[body]
    }

    /// Point where the raising force acts.
    pub(super) fn uplift_marker(&self) -> &BodyMarker {
        &self.uplift.marker
    }

    /// The state of the mechanism alone, from an equilibrium.
    #[cfg(test)]
    pub(crate) fn local_state(&self, equilibrium: &Equilibrium) -> State {
        let mut state = State::at_rest(
            self.coordinates(),
            self.constraint_count(),
            equilibrium.rotation.clone(),
        );
        equilibrium.write(Offsets::default(), &mut state);
        state
    }
}

impl Pantograph for Linkage {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        for body in &mut self.bodies {
            visit("pantograph", body);
        }
        visit("pantograph", &mut self.suspension);
        visit("pantograph", &mut self.uplift);
        if let Some(drive) = &mut self.drive {
            visit("pantograph", drive.force());
        }
        for air in self.air.as_mut_slice() {
            visit("wind_pantograph", air);
        }
        if let Some(inertia) = &mut self.inertia {
            visit("pantograph", inertia);
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        for joint in &mut self.joints {
            visit(joint);
        }
    }

    fn expose(&mut self, air: &Air, base: Base) {
        let mut forces = AirForces::default();
        if let Some(coefficient) = air.uplift {
            let law = AerodynamicLaw::Uplift { coefficient };
            forces.push(air.force(AirMarker::Body(self.strip), base, law), true);
        }
        for surface in &air.surfaces {
            for (marker, area) in self.points_of(surface) {
                let law = AerodynamicLaw::Polar(surface.polar(area));
                let on_head = marker.pose.orientation == self.strip.pose.orientation;
                forces.push(air.force(AirMarker::Body(marker), base, law), on_head);
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

    /// The force borne by a linkage has a maximum over the working range; on both sides of the maximum two heights
    /// share a force. The result is the height that Newton's method reaches from the tabulated position.
    fn equilibrium(&self, base: Option<BaseDisplacement>, target: Target) -> Result<Equilibrium, VehicleError> {
        self.at(base, target, 0.0)
    }

    /// Weights, uplift and contact force.
    fn loads(&self, equilibrium: &Equilibrium, _: Vector3<f64>) -> Result<Vec<Load>, VehicleError> {
        let (linkage, layout) = self.local(BaseMount::Fixed)?;
        let mut state = layout.state_at_rest();
        equilibrium.write(Offsets::default(), &mut state);
        let motion = state.motion(&[]);
        let mut loads: Vec<Load> = linkage
            .bodies
            .iter()
            .map(|body| Load {
                point: body.pose.position(&motion),
                force: -body.mass * body.gravity,
            })
            .collect();
        loads.push(Load {
            point: linkage.uplift.marker.frame(&motion).position,
            force: linkage.uplift.force.z,
        });
        let forces = linkage.strips.markers.iter().zip(&equilibrium.strip_forces);
        loads.extend(forces.map(|(strip, force)| Load {
            point: strip.frame(&motion).position,
            force: -force,
        }));
        Ok(loads)
    }

    fn offsets(&self) -> Offsets {
        self.offsets
    }

    fn strip_position(&self, equilibrium: &Equilibrium) -> Vector3<f64> {
        let pose = self.strip.pose;
        let first = pose.translation - self.offsets.coordinate;
        let rotation = equilibrium.rotation[pose.orientation - self.offsets.orientation];
        let mean = Vector3::from_column_slice(&equilibrium.q[first..first + 3]) + rotation * self.strip.offset;
        pose.reference + mean - Vector3::x() * self.strips.mean
    }

    fn strips(&self) -> usize {
        self.strips.markers.len()
    }

    fn rises(&self) -> Vec<Vec<f64>> {
        self.strips.rises()
    }

    fn equilibrium_under(&self, base: Option<BaseDisplacement>, heights: &[f64]) -> Result<Equilibrium, VehicleError> {
        self.at(base, Target::Height(mean(heights)), self.strips.slope(heights))
    }

    fn strip(&self, base: Base, strip: usize) -> Box<dyn Marker> {
        let marker = self.strips.markers[strip];
        Box::new(Travelling { marker, base })
    }

    /// The bodies as lines through their joints (and the strip).
    fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        let line = |body: &RigidBody| {
            let on_body = |anchor: &Anchor| match anchor {
                Anchor::Body(marker) if marker.pose == body.pose => Some(*marker),
                _ => None,
            };
            let joints = self.joints.iter().flat_map(Joint::anchors);
            let mut markers: Vec<_> = joints.filter_map(|anchor| on_body(&anchor)).collect();
            markers.extend(self.strips.markers.iter().filter(|strip| strip.pose == body.pose));
            // Bars are long along their first principal axis.
            markers.sort_by(|a, b| a.offset.x.total_cmp(&b.offset.x));
            markers.iter().map(|marker| marker.frame(motion).position).collect()
        };
        self.bodies.iter().map(line).collect()
    }

    fn base_z(&self) -> f64 {
        self.entry.base[2]
    }

    fn uplift_force(&self) -> f64 {
        self.uplift.force.z
    }

    fn set_uplift_force(&mut self, force: f64) -> bool {
        self.uplift.force.z = force;
        true
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
        self.reference_strip_position().z
    }

    fn coordinates(&self) -> usize {
        6 * self.bodies.len()
    }

    fn constraint_count(&self) -> usize {
        self.joints.iter().map(Constraint::dimension).sum()
    }

    fn linkage(&self) -> Option<&Linkage> {
        Some(self)
    }
}
