//! A pantograph on its base.
use crate::base_motion::BaseMotion;
use crate::multibody::AppliedForce;
use crate::pantograph::{self, BaseDisplacement, Equilibrium, Linkage, Pantograph, Target};
use crate::rail_vehicle::Vehicle;
use crate::{Air, Base, Displaced, VehicleError};
use control::{Channel, Controller, Reading};
use dynamics::{Columns, Constraint, Force, Frame, Layout, Marker, Motion, PartVisitor, State};
use nalgebra::Vector3;
use scene::{PantographModel as Entry, Scene};
use std::sync::Arc;

mod linearised;

/// Inputs for the wind on a pantograph in x, y, z, m/s.
pub const WIND_INPUTS: usize = 3;

/// Start, speed and surroundings of a pantograph's travel.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// x of the strip, or of the middle of a head with several, at t = 0, m.
    pub start_x: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Gravitational acceleration, m/s²; the static force of a lumped pantograph already contains the weight.
    pub gravity: f64,
    /// True to reduce a linkage to its one motion (`model.reduce`).
    pub one_motion: bool,
    /// `[vehicle]`; none is a base on a straight line.
    pub vehicle: Option<Arc<scene::Vehicle>>,
    /// `[track]`; none is smooth.
    pub track: Option<Arc<scene::Track>>,
    /// Simulated time, s: the track is made up to the end of the run.
    pub duration: f64,
}

impl Placement {
    /// Placement of pantograph `index` (from 0) of a scene.
    #[must_use]
    pub fn of_scene(scene: &Scene, index: usize) -> Self {
        Self {
            start_x: scene.head_start_x(index),
            speed: scene.run.speed,
            gravity: scene.gravity(),
            one_motion: scene.model.has(scene::Reduction::Linkage),
            vehicle: scene.vehicle.clone(),
            track: scene.track.clone(),
            duration: scene.run.duration,
        }
    }
}

/// Change of the base in one iteration of the common equilibrium that counts as none, m or –: rounding at 10 m.
const STILL: f64 = 1e-13;

/// Largest number of iterations of the common equilibrium: the base hardly gives way, so that each gains three digits.
const ITERATIONS: usize = 30;

/// Acceleration of a marker from the accelerations of the coordinates, m/s², without the centripetal acceleration of a
/// turning body.
pub(crate) fn marker_acceleration(marker: &dyn Marker, motion: &Motion<'_>, v_dot: &[f64]) -> Vector3<f64> {
    let mut columns = Columns::default();
    marker.columns(motion, &mut columns);
    let columns = columns.as_slice().iter();
    columns.map(|column| column.translation * v_dot[column.index]).sum()
}

/// A pantograph on its base.
#[derive(Debug)]
pub struct PantographModel {
    pantograph: Box<dyn Pantograph>,
    base_motion: BaseMotion,
    /// The vehicle alone in a layout, for statics.
    alone: Option<Box<(Vehicle, Layout)>>,
    placement: Placement,
    base: Base,
    /// Input that drives it.
    drive: Option<usize>,
    /// True where the drive is a moment on a joint.
    drives_joint: bool,
    /// Strips that the instruments of its controller see; none without commands from outside.
    seen: Seen,
}

/// Strips that instruments see.
#[derive(Default)]
struct Seen(Vec<Box<dyn Marker>>);

impl std::fmt::Debug for Seen {
    fn fmt(&self, text: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(text, "{} strips", self.0.len())
    }
}

impl PantographModel {
    /// Builds the pantograph into `layout`; `name` ("pantograph 1") begins the names of the coordinates.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub fn new(entry: &Entry, placement: Placement, name: &str, layout: &mut Layout) -> Result<Self, VehicleError> {
        let base = Base {
            start_x: placement.start_x - pantograph::reference_x(entry, placement.gravity, name)?,
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
        let pantograph = pantograph::build(entry, &placement, &base_motion, name, layout)?;
        Ok(Self {
            pantograph,
            base_motion,
            alone,
            placement,
            base,
            drive: None,
            drives_joint: false,
            seen: Seen::default(),
        })
    }

    /// Pantograph `index` (from 0) of a scene, built into `layout` and exposed to the scene's air.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub fn of_scene(scene: &Scene, index: usize, layout: &mut Layout) -> Result<Self, VehicleError> {
        Self::placed(scene, index, Placement::of_scene(scene, index), layout)
    }

    fn placed(scene: &Scene, index: usize, placement: Placement, layout: &mut Layout) -> Result<Self, VehicleError> {
        let entry = &scene.pantographs[index].model;
        let name = format!("pantograph {}", index + 1);
        let mut model = Self::new(entry, placement, &name, layout)?;
        model.expose_to(Air::of_scene(scene, index).as_ref());
        Ok(model)
    }

    /// Pantograph `index` (from 0) of a scene as [`PantographModel::of_scene`], and the state of rest in which a run
    /// starts: with its strips at the start heights of the scene, or at the reference height. Markers taken from the
    /// model belong to the start.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub fn started(scene: &Scene, index: usize, layout: &mut Layout) -> Result<(Self, Equilibrium), VehicleError> {
        Self::started_on(scene, index, Placement::of_scene(scene, index), layout)
    }

    /// The same with another placement.
    fn started_on(
        scene: &Scene,
        index: usize,
        placement: Placement,
        layout: &mut Layout,
    ) -> Result<(Self, Equilibrium), VehicleError> {
        let mut model = Self::placed(scene, index, placement, layout)?;
        let start = |strip: usize| {
            let start = scene.pantographs[index].strip_start(strip);
            start.map_or_else(|| model.reference_height(), |start| start.height)
        };
        let heights: Vec<f64> = (0..model.strips()).map(start).collect();
        let rest = model.equilibrium_at_heights(&heights)?;
        model.start_at(&rest);
        Ok((model, rest))
    }

    /// Exposes the pantograph to the air, if there is any.
    pub fn expose_to(&mut self, air: Option<&Air>) {
        if let Some(air) = air {
            self.pantograph.expose(air, self.base);
        }
    }

    /// Adds the inputs `u[first..first + WIND_INPUTS]` to the wind on the pantograph, m/s.
    pub fn add_wind_input(&mut self, first: usize) {
        self.pantograph.air_mut().add_input(first);
    }

    /// Visits every force in a fixed order.
    pub fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.parts(&mut |_, force| visit(force));
    }

    /// Visits every force with the name of its part, in a fixed order: the vehicle first, then the pantograph.
    pub fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        if let BaseMotion::Vehicle(vehicle) = &mut self.base_motion {
            vehicle.parts(visit);
        }
        self.pantograph.parts(visit);
    }

    /// Visits every constraint in a fixed order.
    pub fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.vehicle_constraints(visit);
        self.pantograph_constraints(visit);
    }

    /// Visits the joints of the vehicle: the first of [`PantographModel::constraints`].
    pub fn vehicle_constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        if let BaseMotion::Vehicle(vehicle) = &mut self.base_motion {
            vehicle.constraints(visit);
        }
    }

    /// Visits the joints of the pantograph alone: the others of [`PantographModel::constraints`].
    pub fn pantograph_constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.pantograph.constraints(visit);
    }

    /// State of rest under a contact force (N, positive in compression).
    ///
    /// # Errors
    /// Without such a state: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_force(&self, force: f64) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(&|base| self.pantograph.equilibrium(base, Target::Force(force)))
    }

    /// State of rest with the strip at `height` (m above the top of rail).
    ///
    /// The height as target is the well-posed direction: a pantograph's force hardly depends on the height.
    ///
    /// # Errors
    /// Without such a state: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(&|base| self.pantograph.equilibrium(base, Target::Height(height)))
    }

    /// State of rest with the strips at these heights (m above the top of rail, one per strip), as far as the head
    /// allows them, see [`PantographModel::rises`].
    ///
    /// # Errors
    /// Without such a state: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_heights(&self, heights: &[f64]) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(&|base| self.pantograph.equilibrium_under(base, heights))
    }

    /// Number of strips.
    #[must_use]
    pub fn strips(&self) -> usize {
        self.pantograph.strips()
    }

    /// Changes of the strips' heights (m, one per strip) that the head allows beside each other, one row for each: of
    /// one strip its rise, of a head that pitches its rise and its turn by 1 rad.
    #[must_use]
    pub fn rises(&self) -> Vec<Vec<f64>> {
        self.pantograph.rises()
    }

    /// True where contact forces on the strips (N, one per strip) hold the pantograph in `rest`, but for differences of
    /// `room` N.
    #[must_use]
    pub fn is_balanced(&self, rest: &Equilibrium, forces: &[f64], room: f64) -> bool {
        let strips = || forces.iter().zip(&rest.strip_forces);
        let missing = |rise: &Vec<f64>| {
            strips()
                .zip(rise)
                .map(|((force, held), rise)| rise * (force - held))
                .sum()
        };
        self.rises()
            .iter()
            .map(missing)
            .all(|missing: f64| missing.abs() <= room)
    }

    /// State of rest of the pantograph, by `solve` over its base, and the vehicle, if there is one.
    fn equilibrium(
        &self,
        solve: &dyn Fn(Option<BaseDisplacement>) -> Result<Equilibrium, VehicleError>,
    ) -> Result<Equilibrium, VehicleError> {
        let reference = self.base_motion.base_point(self.base_z());
        let displaced = |frame| Some(BaseDisplacement { reference, frame });
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
                solve(displaced(frame))
            }
            (BaseMotion::Vehicle(_), Some(alone)) => {
                let (mut vehicle, layout) = (alone.0.clone(), &alone.1);
                let mut state = layout.state_at_rest();
                let mut frame = vehicle.base_frame(&state.motion(&[]));
                let mut change = f64::INFINITY;
                for _ in 0..ITERATIONS {
                    let mut equilibrium = solve(displaced(frame))?;
                    let loads = self.pantograph.loads(&equilibrium, frame.position)?;
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
            _ => solve(None),
        }
    }

    /// Begins a motion at `equilibrium`: puts the base where the strip is at the start x at t = 0. Markers taken before
    /// this call keep the old base.
    fn start_at(&mut self, equilibrium: &Equilibrium) {
        self.pantograph.start_at(equilibrium);
        self.base.start_x = self.placement.start_x - self.pantograph.strip_position(equilibrium).x;
        self.pantograph.air_mut().travel_with(self.base);
    }

    /// Writes `equilibrium` into the part of `state` of pantograph and vehicle, and puts the base where the strip is at
    /// the start x at t = 0. Markers taken before this call keep the old base.
    pub fn set_initial(&mut self, equilibrium: &Equilibrium, state: &mut State) {
        self.start_at(equilibrium);
        equilibrium.write(self.pantograph.offsets(), state);
        self.base_motion.set_rest(equilibrium.vehicle.as_deref(), state);
    }

    /// Middle of the strip, the first of several, in the world; the second axis runs along the strip.
    #[must_use]
    pub fn strip(&self) -> Box<dyn Marker> {
        self.strip_at(0)
    }

    /// Middle of strip `strip` (from 0) in the world; the second axis runs along the strip.
    #[must_use]
    pub fn strip_at(&self, strip: usize) -> Box<dyn Marker> {
        self.pantograph.strip(self.base, strip)
    }

    /// Contact force on the strip, the first of several, as inputs `u[first..first + 4]`, see [`AppliedForce`].
    #[must_use]
    pub fn applied_force(&self, first: usize) -> AppliedForce {
        self.applied_force_at(0, first)
    }

    /// Contact force on strip `strip` (from 0) as inputs `u[first..first + 4]`, see [`AppliedForce`].
    #[must_use]
    pub fn applied_force_at(&self, strip: usize, first: usize) -> AppliedForce {
        AppliedForce {
            marker: self.strip_at(strip),
            first,
            top: None,
        }
    }

    /// Lines that draw the pantograph in the world, m: the bodies of a linkage, the strip of a lumped one from the
    /// side.
    #[must_use]
    pub fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        let travelled = self.base.position(motion.t);
        let mut lines = self.pantograph.outline(motion);
        for point in lines.iter_mut().flatten() {
            *point += travelled;
        }
        lines
    }

    /// Travel of the base.
    #[must_use]
    pub fn base(&self) -> Base {
        self.base
    }

    /// The mechanism with all its bodies, if the pantograph is one.
    #[must_use]
    pub fn linkage(&self) -> Option<&Linkage> {
        self.pantograph.linkage()
    }

    /// Vehicle under the pantograph, if modelled.
    #[must_use]
    pub fn vehicle(&self) -> Option<&Vehicle> {
        self.base_motion.vehicle()
    }

    /// Frame of the base in the world: position, velocity, axes.
    #[must_use]
    pub fn base_frame(&self, motion: &Motion<'_>) -> Frame {
        let (_, frame) = self.base_point_and_frame(motion);
        Frame {
            position: frame.position + self.base.position(motion.t),
            velocity: frame.velocity + self.base.velocity(),
            ..frame
        }
    }

    /// Motion of the base beside the travel, as a displacement for a [`GivenMotion`](crate::GivenMotion).
    #[must_use]
    pub fn base_displaced(&self, motion: &Motion<'_>) -> Displaced {
        let (point, frame) = self.base_point_and_frame(motion);
        // A base with a given motion is in the middle of the track.
        Displaced::to(&frame, &Vector3::new(point.x, 0.0, point.z))
    }

    /// Point of the base in the reference position (m), and the frame now, both in the frame of the base.
    fn base_point_and_frame(&self, motion: &Motion<'_>) -> (Vector3<f64>, Frame) {
        let point = self.base_motion.base_point(self.base_z());
        (point, self.base_motion.mount().frame(point, motion))
    }

    /// Height of the base above the top of rail in the reference position, m; the reference height for a lumped chain,
    /// which has no extent.
    #[must_use]
    pub fn base_z(&self) -> f64 {
        self.pantograph.base_z()
    }

    /// Force that raises the pantograph, N: the static force of a lumped one, the force on the lower arm of a linkage.
    #[must_use]
    pub fn uplift_force(&self) -> f64 {
        self.pantograph.uplift_force()
    }

    /// Sets the force that raises the pantograph, N, from now on; `false` for a model in which it is part of what was
    /// prepared before the start.
    pub fn set_uplift_force(&mut self, force: f64) -> bool {
        self.pantograph.set_uplift_force(force)
    }

    /// Controller of pantograph `index` (from 0) of a scene, if there is one, whose force is the input `input` of the
    /// pantograph from now on; `start` is the contact force at the start, N.
    ///
    /// # Errors
    /// See [`VehicleError`]: no such drive, no gains.
    pub fn controlled(
        &mut self,
        scene: &Scene,
        index: usize,
        start: f64,
        input: usize,
    ) -> Result<Option<Channel>, VehicleError> {
        let pantograph = &scene.pantographs[index];
        let Some(control) = &pantograph.control else {
            return Ok(None);
        };
        let lumped = match &pantograph.model {
            Entry::Lumped(lumped) => Some(lumped),
            _ => None,
        };
        self.pantograph.drive_by(&control.actuator, input)?;
        self.drive = Some(input);
        self.drives_joint = control.actuator.joint.is_some();
        let controller = Controller::new(control, lumped, self.static_force(), start)?;
        if controller.takes_commands() {
            self.seen = Seen((0..self.strips()).map(|strip| self.strip_at(strip)).collect());
        }
        Ok(Some(Channel { controller, input }))
    }

    /// Reads the motion of the pantograph for its controller; `v_dot` are the accelerations of the coordinates.
    pub fn read(&self, motion: &Motion<'_>, v_dot: &[f64], reading: &mut Reading) {
        self.pantograph.read(motion, reading);
        let [mut height, mut velocity, mut acceleration] = [0.0; 3];
        for strip in &self.seen.0 {
            let frame = strip.frame(motion);
            height += frame.position.z;
            velocity += frame.velocity.z;
            acceleration += marker_acceleration(&**strip, motion, v_dot).z;
        }
        let strips = self.seen.0.len().max(1) as f64;
        reading.head_height = height / strips;
        reading.head_velocity = velocity / strips;
        reading.head_acceleration = acceleration / strips;
    }

    /// True where the controlled drive is a moment on a joint.
    #[must_use]
    pub fn drives_joint(&self) -> bool {
        self.drives_joint
    }

    /// Force of the controlled drive, N, or its moment on a joint, N·m; 0 without one.
    #[must_use]
    pub fn drive_force(&self, motion: &Motion<'_>) -> f64 {
        self.drive.map_or(0.0, |input| motion.u[input])
    }

    /// Contact force at rest in the reference position, N.
    #[must_use]
    pub fn static_force(&self) -> f64 {
        self.pantograph.static_force()
    }

    /// Height of the strip in the reference position, m above the top of rail.
    #[must_use]
    pub fn reference_height(&self) -> f64 {
        self.pantograph.reference_height()
    }

    /// Drag and lift of the air on the body of the strip, N: along the relative air flow, and across, positive upward;
    /// 0 without exposure.
    #[must_use]
    pub fn wind_on_head(&self, motion: &Motion<'_>) -> [f64; 2] {
        self.pantograph.air().on_head(motion)
    }

    /// Number of generalised velocities.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.pantograph.coordinates() + self.base_motion.size()[0]
    }

    /// Number of constraint equations.
    #[must_use]
    pub fn constraint_count(&self) -> usize {
        self.pantograph.constraint_count() + self.base_motion.size()[1]
    }
}
