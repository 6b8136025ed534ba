//! Any kind of pantograph, from its scene entry.
use crate::multibody::AppliedForce;
use crate::pantograph::{BaseMount, Equilibrium, Linkage, Lumped, ReducedLinkage, Target};
use crate::rail_vehicle::{Load, Vehicle};
use crate::{Air, Base, BaseMotion, Displaced, Travelling, VehicleError};
use dynamics::{Constraint, Force, Frame, Layout, Marker, Motion, State};
use nalgebra::Vector3;
use scene::PantographModel as Entry;
use std::sync::Arc;

/// Where and how fast a pantograph travels, and on what.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// x of its strip at t = 0, m.
    pub start_x: f64,
    /// m/s.
    pub speed: f64,
    /// Gravitational acceleration, m/s²; a lumped pantograph's static force already contains its weight.
    pub gravity: f64,
    /// Whether a linkage is reduced to its one motion (`model.reduce`).
    pub one_motion: bool,
    /// `[vehicle]`; none is a base on a straight line.
    pub vehicle: Option<Arc<scene::Vehicle>>,
    /// `[track]`; none is smooth.
    pub track: Option<Arc<scene::Track>>,
    /// Simulated time, s: the track is made up to where it ends.
    pub duration: f64,
}

/// Change of the base's place in one iteration of the common equilibrium that counts as none, m or –: rounding at 10 m.
const STILL: f64 = 1e-13;

/// The base hardly gives way, so that each iteration gains three digits.
const ITERATIONS: usize = 30;

/// A pantograph on its base.
#[derive(Clone, Debug)]
pub struct PantographModel {
    kind: Kind,
    base_motion: BaseMotion,
    /// The vehicle alone in a layout, for statics.
    alone: Option<Box<(Vehicle, Layout)>>,
    placement: Placement,
    base: Base,
}

#[derive(Clone, Debug)]
enum Kind {
    Lumped(Box<Lumped>),
    Linkage(Box<Linkage>),
    Reduced(Box<ReducedLinkage>),
}

impl PantographModel {
    /// Builds the pantograph into `layout`; `name` ("pantograph 1") begins the names of its coordinates.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub fn new(entry: &Entry, placement: Placement, name: &str, layout: &mut Layout) -> Result<Self, VehicleError> {
        let reference_x = match entry {
            Entry::Linkage(entry) => {
                Linkage::new(entry, placement.gravity, name, &mut Layout::new())?
                    .reference_strip_position()
                    .x
            }
            Entry::Lumped(_) | Entry::Supplied(_) => 0.0,
        };
        let base = Base {
            start_x: placement.start_x - reference_x,
            speed: placement.speed,
        };
        let under = format!("{name}, vehicle");
        let base_motion = BaseMotion::new(&placement, base, &under, layout)?;
        let alone = base_motion.vehicle().map(|_| -> Result<_, VehicleError> {
            let mut alone = Layout::new();
            match BaseMotion::new(&placement, base, &under, &mut alone)? {
                BaseMotion::Vehicle(vehicle) => Ok(Some(Box::new((*vehicle, alone)))),
                BaseMotion::Straight | BaseMotion::Given(_) => Ok(None),
            }
        });
        let alone = alone.transpose()?.flatten();
        let mount = base_motion.mount();
        let kind = match entry {
            Entry::Lumped(entry) => {
                let mut lumped = Lumped::new(entry, name, layout)?;
                lumped.mount_on(&mount, base_motion.base_point(lumped.reference_height()));
                if let Some(vehicle) = base_motion.vehicle() {
                    lumped.follow_curves(vehicle.travel(), placement.gravity);
                }
                Kind::Lumped(Box::new(lumped))
            }
            Entry::Linkage(_) if placement.one_motion && !matches!(mount, BaseMount::Still) => {
                return Err(VehicleError::NotReducible {
                    reason: "its base moves".to_owned(),
                });
            }
            Entry::Linkage(entry) if placement.one_motion => {
                Kind::Reduced(Box::new(ReducedLinkage::new(entry, placement.gravity, name, layout)?))
            }
            Entry::Linkage(entry) => {
                let mut linkage = Linkage::on(mount, entry, placement.gravity, name, layout)?;
                if let Some(vehicle) = base_motion.vehicle() {
                    linkage.follow_curves(vehicle.travel());
                }
                Kind::Linkage(Box::new(linkage))
            }
            Entry::Supplied(entry) => {
                return Err(VehicleError::Supplied { fmu: entry.fmu.clone() });
            }
        };
        Ok(Self {
            kind,
            base_motion,
            alone,
            placement,
            base,
        })
    }

    /// Lets the air act on the pantograph, or nothing.
    pub fn expose_to(&mut self, air: Option<&Air>) {
        let Some(air) = air else { return };
        let base = self.base;
        match &mut self.kind {
            Kind::Lumped(lumped) => lumped.expose(air, base),
            Kind::Linkage(linkage) => linkage.expose(air, base),
            Kind::Reduced(linkage) => linkage.expose(air, base),
        }
    }

    /// Visits every force in a fixed order.
    pub fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.vehicle_forces(visit);
        self.pantograph_forces(visit);
    }

    /// Visits the forces of what carries the pantograph: the first of [`PantographModel::forces`].
    pub fn vehicle_forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        if let BaseMotion::Vehicle(vehicle) = &mut self.base_motion {
            vehicle.forces(visit);
        }
    }

    /// Visits the forces of the pantograph alone: the others of [`PantographModel::forces`].
    pub fn pantograph_forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        match &mut self.kind {
            Kind::Lumped(lumped) => lumped.forces(visit),
            Kind::Linkage(linkage) => linkage.forces(visit),
            Kind::Reduced(linkage) => {
                visit(linkage.as_mut());
                for air in linkage.air_mut() {
                    visit(air);
                }
            }
        }
    }

    /// Visits every constraint in a fixed order.
    pub fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.vehicle_constraints(visit);
        self.pantograph_constraints(visit);
    }

    /// Visits the joints of what carries the pantograph: the first of [`PantographModel::constraints`].
    pub fn vehicle_constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        if let BaseMotion::Vehicle(vehicle) = &mut self.base_motion {
            vehicle.constraints(visit);
        }
    }

    /// Visits the joints of the pantograph alone: the others of [`PantographModel::constraints`].
    pub fn pantograph_constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        match &mut self.kind {
            Kind::Lumped(_) | Kind::Reduced(_) => {}
            Kind::Linkage(linkage) => linkage.constraints(visit),
        }
    }

    /// The state of rest under a contact force (N, positive in compression).
    ///
    /// # Errors
    /// Where there is none: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_force(&self, force: f64) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(Target::Force(force))
    }

    /// The state of rest with the strip at `height` (m above the top of rail).
    ///
    /// This is the well-posed direction: a pantograph's force hardly depends on its height.
    ///
    /// # Errors
    /// Where there is none: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(Target::Height(height))
    }

    /// Rest on whatever carries the pantograph.
    fn equilibrium(&self, target: Target) -> Result<Equilibrium, VehicleError> {
        let reference = self.base_motion.base_point(self.base_z());
        match (&self.base_motion, &self.alone) {
            (BaseMotion::Given(_), _) => {
                let initial = Motion {
                    t: 0.0,
                    q: &[],
                    v: &[],
                    rotation: &[],
                    u: &[],
                };
                let frame = self.base_motion.mount().frame(reference, &initial);
                self.equilibrium_on(reference, frame, target)
            }
            (BaseMotion::Vehicle(_), Some(alone)) => {
                let (mut vehicle, layout) = (alone.0.clone(), &alone.1);
                let mut state = layout.state_at_rest();
                let mut frame = vehicle.base_frame(&state.motion(&[]));
                let mut change = f64::INFINITY;
                for _ in 0..ITERATIONS {
                    let mut equilibrium = self.equilibrium_on(reference, frame, target)?;
                    let loads = self.loads(&equilibrium, frame)?;
                    let rest = vehicle.rest(layout, &mut state, &loads)?;
                    change = (rest.base.position - frame.position)
                        .amax()
                        .max((rest.base.axes - frame.axes).amax());
                    frame = rest.base;
                    if change <= STILL {
                        equilibrium.vehicle = Some(Box::new(rest));
                        return Ok(equilibrium);
                    }
                }
                Err(VehicleError::Restless {
                    change,
                    iterations: ITERATIONS,
                })
            }
            _ => match (&self.kind, target) {
                (Kind::Lumped(lumped), Target::Force(force)) => lumped.equilibrium_at_force(force),
                (Kind::Lumped(lumped), Target::Height(height)) => lumped.equilibrium_at_height(height),
                (Kind::Linkage(linkage), Target::Force(force)) => linkage.equilibrium_at_force(force),
                (Kind::Linkage(linkage), Target::Height(height)) => linkage.equilibrium_at_height(height),
                (Kind::Reduced(linkage), Target::Force(force)) => linkage.equilibrium_at_force(force),
                (Kind::Reduced(linkage), Target::Height(height)) => linkage.equilibrium_at_height(height),
            },
        }
    }

    /// Rest on a base whose point `reference` (m, reference position) is at `frame`.
    fn equilibrium_on(
        &self,
        reference: Vector3<f64>,
        frame: Frame,
        target: Target,
    ) -> Result<Equilibrium, VehicleError> {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.equilibrium_risen(frame.position.z - reference.z, target),
            Kind::Linkage(linkage) => linkage.equilibrium(BaseMount::Displaced { reference, frame }, target),
            Kind::Reduced(_) => Err(VehicleError::NotReducible {
                reason: "its base moves".to_owned(),
            }),
        }
    }

    /// What the vehicle bears of a pantograph at rest. A lumped one presses on its base with the contact force alone:
    /// its weight is taken as part of what it stands on.
    fn loads(&self, equilibrium: &Equilibrium, base: Frame) -> Result<Vec<Load>, VehicleError> {
        match &self.kind {
            Kind::Linkage(linkage) => linkage.loads(equilibrium),
            Kind::Lumped(_) | Kind::Reduced(_) => Ok(vec![Load {
                point: base.position,
                force: -equilibrium.force,
            }]),
        }
    }

    /// Writes `equilibrium` into the pantograph's part of `state`, and puts the base where the strip is at the start x
    /// at t = 0. Markers taken before this call keep the old base.
    pub fn set_initial(&mut self, equilibrium: &Equilibrium, state: &mut State) {
        let (offsets, strip_x) = match &mut self.kind {
            Kind::Lumped(lumped) => (lumped.offsets(), 0.0),
            Kind::Linkage(linkage) => (linkage.offsets(), linkage.strip_position(equilibrium).x),
            Kind::Reduced(linkage) => {
                linkage.start_at(equilibrium);
                (linkage.offsets(), linkage.strip_position(equilibrium).x)
            }
        };
        equilibrium.write(offsets, state);
        self.base_motion.set_rest(equilibrium.vehicle.as_deref(), state);
        self.base.start_x = self.placement.start_x - strip_x;
        let base = self.base;
        let air = match &mut self.kind {
            Kind::Lumped(lumped) => lumped.air_mut(),
            Kind::Linkage(linkage) => linkage.air_mut(),
            Kind::Reduced(linkage) => linkage.air_mut(),
        };
        for force in air {
            force.marker.base = base;
        }
    }

    /// The middle of the strip in the world; the second axis runs along the strip.
    #[must_use]
    pub fn strip(&self) -> Box<dyn Marker> {
        match &self.kind {
            Kind::Lumped(lumped) => Box::new(Travelling {
                marker: lumped.strip(),
                base: self.base,
            }),
            Kind::Linkage(linkage) => Box::new(Travelling {
                marker: linkage.strip(),
                base: self.base,
            }),
            Kind::Reduced(linkage) => Box::new(Travelling {
                marker: linkage.strip(),
                base: self.base,
            }),
        }
    }

    /// The contact force on the strip as inputs `u[first..first + 4]`, see [`AppliedForce`].
    #[must_use]
    pub fn applied_force(&self, first: usize) -> AppliedForce {
        AppliedForce {
            marker: self.strip(),
            first,
        }
    }

    /// Lines that draw the pantograph in the world, m: the bodies of a linkage, the strip of a lumped one from the
    /// side.
    #[must_use]
    pub fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        /// Half the drawn length of a collector head along the track, m.
        const HALF_HEAD: f64 = 0.25;
        let travelled = self.base.position(motion.t);
        let mut lines = match &self.kind {
            Kind::Lumped(lumped) => {
                let middle = lumped.strip().frame(motion).position;
                vec![
                    [-HALF_HEAD, HALF_HEAD]
                        .map(|x| middle + Vector3::new(x, 0.0, 0.0))
                        .to_vec(),
                ]
            }
            Kind::Linkage(linkage) => linkage.outline(motion),
            Kind::Reduced(linkage) => linkage.outline(motion),
        };
        for point in lines.iter_mut().flatten() {
            *point += travelled;
        }
        lines
    }

    /// The mechanism in two coordinates, where it is reduced to them.
    #[must_use]
    pub fn reduced_linkage(&self) -> Option<&ReducedLinkage> {
        match &self.kind {
            Kind::Reduced(linkage) => Some(linkage),
            Kind::Lumped(_) | Kind::Linkage(_) => None,
        }
    }

    /// The base.
    #[must_use]
    pub fn base(&self) -> Base {
        self.base
    }

    /// The mechanism, where it is one with all its bodies.
    #[must_use]
    pub fn linkage(&self) -> Option<&Linkage> {
        match &self.kind {
            Kind::Lumped(_) | Kind::Reduced(_) => None,
            Kind::Linkage(linkage) => Some(linkage),
        }
    }

    /// What carries it.
    #[must_use]
    pub fn base_motion(&self) -> &BaseMotion {
        &self.base_motion
    }

    /// The point of the base in the world: position, velocity, axes.
    #[must_use]
    pub fn base_frame(&self, motion: &Motion<'_>) -> Frame {
        let (_, frame) = self.base_point_and_frame(motion);
        Frame {
            position: frame.position + self.base.position(motion.t),
            velocity: frame.velocity + self.base.velocity(),
            ..frame
        }
    }

    /// The motion of the base beside the travel, as one that could be given to it.
    #[must_use]
    pub fn base_displaced(&self, motion: &Motion<'_>) -> Displaced {
        let (point, frame) = self.base_point_and_frame(motion);
        // A given motion carries a base in the middle of the track.
        Displaced::to(&frame, &Vector3::new(point.x, 0.0, point.z))
    }

    /// The point of the base in the reference position (m), and where it is, in the frame of the base.
    fn base_point_and_frame(&self, motion: &Motion<'_>) -> (Vector3<f64>, Frame) {
        let point = self.base_motion.base_point(self.base_z());
        (point, self.base_motion.mount().frame(point, motion))
    }

    /// Height of the base above the top of rail in the reference position, m. A lumped chain has no extent: its base is
    /// at the reference height.
    #[must_use]
    pub fn base_z(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.reference_height(),
            Kind::Linkage(linkage) => linkage.base_z(),
            Kind::Reduced(linkage) => linkage.base_z(),
        }
    }

    /// The force that raises the pantograph, N: the static force of a lumped one, the force on the lower arm of a
    /// linkage.
    #[must_use]
    pub fn uplift_force(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.static_force(),
            Kind::Linkage(linkage) => linkage.uplift_force(),
            Kind::Reduced(linkage) => linkage.uplift_force(),
        }
    }

    /// Contact force at rest in the reference position, N.
    #[must_use]
    pub fn static_force(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.reference_force(),
            Kind::Linkage(linkage) => linkage.static_force(),
            Kind::Reduced(linkage) => linkage.static_force(),
        }
    }

    /// Height of the strip in the reference position, m above the top of rail.
    #[must_use]
    pub fn reference_height(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.reference_height(),
            Kind::Linkage(linkage) => linkage.reference_height(),
            Kind::Reduced(linkage) => linkage.reference_height(),
        }
    }

    /// Drag and lift of the air on the body that carries the strip, N: along the air that meets it, and across it,
    /// positive upward; 0 where nothing exposes it.
    #[must_use]
    pub fn wind_on_head(&self, motion: &Motion<'_>) -> [f64; 2] {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.air().on_head(motion),
            Kind::Linkage(linkage) => linkage.air().on_head(motion),
            Kind::Reduced(linkage) => linkage.air().on_head(motion),
        }
    }

    /// Number of generalised velocities.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        let own = match &self.kind {
            Kind::Lumped(lumped) => lumped.coordinates(),
            Kind::Linkage(linkage) => linkage.coordinates(),
            Kind::Reduced(_) => 2,
        };
        own + self.base_motion.size()[0]
    }

    /// Number of constraint equations.
    #[must_use]
    pub fn constraint_count(&self) -> usize {
        let own = match &self.kind {
            Kind::Lumped(_) | Kind::Reduced(_) => 0,
            Kind::Linkage(linkage) => linkage.constraint_count(),
        };
        own + self.base_motion.size()[1]
    }
}
