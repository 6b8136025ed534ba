//! A line in its own modes: `modal` of `model.reduce`.
//!
//! A linearised line does not change from run to run, so that its modes serve them all. With every dropper taut,
//! forces `F` of the strips and `p ≥ 0` that keep the tension of slack droppers at zero,
//!
//! ```text
//! q̈ₖ + cₖ q̇ₖ + ωₖ² qₖ = Σᵢ φₖ(xᵢ) Fᵢ − Σⱼ dₖⱼ pⱼ,    cₖ = φₖᵀ D φₖ,    dₖⱼ = gⱼᵀ φₖ
//! ```
//!
//! is solved exactly for modal forces with a constant second derivative within a step, but for modes that turn too far
//! in a step: neither dispersion nor numerical damping is left. Forces of strips and of slack droppers go on from the
//! step before as parabolas ([`lacking`]). At the end of a step the deflection of the wire under the strips is linear
//! in the forces there, `w = w₀ + A F − C p`, so that contact and pantographs see a massless, yielding point under each
//! strip, and the integrator no coordinate of the line. Modes that are left out answer at once, by the residual
//! compliances `K⁻¹ − Σₖ φₖ φₖᵀ/ωₖ²` of strips and droppers; a strip that moves shakes them, so that they yield more to
//! it.
//!
//! Modes are damped one by one, `cₖ = α + β ωₖ²`, which gives springs of droppers and supports dampers of `β k` that
//! the line does not have, and wires such along them ([`stretch`]). Forces take those along wires back, and the others
//! near the strips; further away waves are damped too much.
//!
//! ```text
//! file       subject
//! base       a line in its modes before strips run under it
//! modes      the modes of a linearised line, and what the ones left out add
//! interface  the line as strips see it, as a contribution of forces
//! slack      droppers that may be slack at the end of a step
//! creep      droppers whose dampers hold wires together
//! lacking    forces that slack droppers lack, within steps
//! lane       amplitudes of one line, moved on together with those of others
//! pass       strips under the wire in one step, for all lines alike
//! curve      the contact wire under one strip
//! store      modes found before
//! stretch    lengths of wires that modes stretch
//! together   moves of lines with strips at the same places
//! ```
mod base;
mod creep;
mod curve;
mod interface;
mod lacking;
mod lane;
mod modes;
mod pass;
mod slack;
mod store;
mod stretch;
mod together;

use crate::line::Uplift;
use crate::{
    DropperSample, Line, LinearLine, NodeOfWire, OverheadLine, StaticLine, StaticsError, WireCurve, WireName, WireNode,
    mesh,
};
use curve::{ModalCurve, Place};
use dynamics::{Continuity, Layout, Motion, PartVisitor, State, StepHistory};
use interface::{Contact, Interface};
use lane::{Lane, Wires};
use nalgebra::Vector3;
use scene::{Catenary, Reduction, Scene, Wire, WireKind};
use std::f64::consts::TAU;
use std::sync::Arc;

pub(crate) use base::{Base, Wish};

/// Error of the filtered force, % of its standard deviation, by modes above the frequency of a strip, `f/√(1 − v/c)`: a
/// force of the filter's frequency `f` that moves with `v` sends waves of `f` at rest and of `f/(1 − v/c)` ahead, and
/// meshes err by the mean of both too. It falls with the third power of the highest mode. Fitted to the line of
/// EN 50318 at 120, 250 and 300 km/h, and within a third of the errors of single frequencies there; these are twice as
/// large where many droppers are slack.
const LEFT_OUT: f64 = 60.0;
/// Share of the error of the mesh that the modes left out may add: both are independent, so that their squares add up.
const SHARE: f64 = 0.7;

/// Error of the mesh up to which modes are counted by it, % of the standard deviation.
const MOST: f64 = 1.0;
/// The one that they are counted by on coarser meshes, where the line is still the linearised one: waves are too stiff
/// there, and the same waves have higher frequencies.
const COARSE: f64 = 0.65;

/// The factor [`LEFT_OUT`] where forces of droppers have attachment modes: fitted to the same lines, a stitched one and
/// one of twin wires, slack droppers or not.
const ATTACHED: f64 = 30.0;
/// [`COARSE`] there.
const COARSE_ATTACHED: f64 = 0.4;

/// Error of the filtered force by dampers along wires, % of its standard deviation, times `k/β` with the stiffness of
/// the droppers, N/(m s). Fitted to the line of EN 50318 at 250 km/h with droppers of 2e4 and 1e5 N/m. To take these
/// dampers back costs a tenth of a step: not worth it for errors that are larger by far.
const ALONG: f64 = 2e8;

/// A line in its own modes.
pub struct ModalLine {
    interface: Interface,
    curves: Vec<Arc<dyn WireCurve>>,
    contact_wires: usize,
    /// Coordinates of the linearised line.
    coordinates: usize,
    /// Positions of wires, supports and droppers, in the coordinates of the linearised line.
    shape: Line,
    uplift: Uplift,
}

impl ModalLine {
    /// The line of a scene in its modes; adds one coordinate per strip and contact wire to `layout`.
    ///
    /// # Errors
    /// See [`StaticsError::Modes`].
    pub fn new(scene: &Scene, statics: &StaticLine, layout: &mut Layout) -> Result<Self, StaticsError> {
        let line = scene.modelled_line().map(|(line, _)| line);
        let beta = line.map_or(0.0, |line| line.damping.beta);
        let error_of_mesh = mesh::expected_error(scene).map_or(f64::INFINITY, |error| error.total());
        let wish = Wish {
            flat: scene.model.has(Reduction::Flat),
            highest: highest(scene, error_of_mesh),
            stretching: line.is_some_and(|line| tells_stretching(line, error_of_mesh)),
            beta,
            creeping: line.is_some_and(creeps),
            bearable: line.map_or(0.0, |line| for_rate(line, MOST_ATTACHED)),
            h: scene.solver.micro_step,
        };
        let base = statics.modal().or_made(wish, || {
            let mut own = Layout::new();
            let linear = if wish.flat {
                LinearLine::flat(statics, &mut own)
            } else {
                let mut line = statics.line_in(&mut own);
                LinearLine::about(&mut line, &own)
            };
            Base::of((linear, &own), wish).map(Arc::new)
        })?;
        let slowest = line.map_or(f64::INFINITY, |line| {
            line.contact_wire.phase_speed(TAU * base.modes.highest)
        });
        Ok(Self::under(&base, slowest, scene.strip_count(), layout))
    }

    /// The line under `strips` strips; one coordinate per strip and contact wire joins `layout`. Waves of modes left
    /// out go along contact wires with the `slowest` phase speed or faster, m/s.
    fn under(base: &Base, slowest: f64, strips: usize, layout: &mut Layout) -> Self {
        let shape = base.shape.clone();
        let rest: Arc<[f64]> = vec![0.0; base.coordinates].into();
        let contact_wires = base.contact_wires.len();
        let first = layout.add_coordinates(strips * contact_wires, "deflection under strips");
        let (mut curves, mut points): (Vec<Arc<dyn WireCurve>>, Vec<_>) = (Vec::new(), Vec::new());
        let mut wires = Vec::new();
        for contact in 0..strips * contact_wires {
            let (place, coordinate) = (Place::default(), first + contact);
            let wire = Arc::clone(&base.contact_wires[contact % contact_wires]);
            wires.push(Arc::clone(&wire));
            points.push(Contact::new(coordinate, place.clone()));
            curves.push(Arc::new(ModalCurve {
                wire,
                rest: Arc::clone(&rest),
                coordinate,
                place,
            }));
        }
        let wires = Wires {
            curves: wires,
            rest,
            slowest,
        };
        let lane = Lane::new(Arc::clone(&base.modes), base.answers.to_vec(), wires);
        Self {
            interface: Interface::new(lane, points, base.creeping),
            curves,
            contact_wires,
            coordinates: base.coordinates,
            uplift: Uplift::counted_from(shape.topology(), |_| 0.0),
            shape,
        }
    }

    /// Coordinate of the height of a node in the linearised line.
    fn height(&self, at: NodeOfWire) -> Option<usize> {
        self.shape.wires()[at.wire].geometry().nodes()[at.node].map.position(2)
    }

    /// Rise of a node, m.
    fn rise(&self, at: NodeOfWire) -> f64 {
        let x = self.shape.topology().x_of(at);
        self.height(at)
            .map_or(0.0, |index| self.interface.deflection_of(index, x))
    }

    fn most_lifted(&self, mast: usize) -> Option<(f64, NodeOfWire)> {
        let topology = self.shape.topology();
        self.uplift.most_lifted(topology, mast, |at| self.rise(at))
    }
}

/// Largest damper of a dropper, as `κ` of [`for_rate`], that forces from step to step can stand for: a little below the
/// limit.
const MOST_DAMPED: f64 = 0.5;
/// The same with attachment modes, whose rates change much within a step.
const MOST_ATTACHED: f64 = 0.1;

/// True for droppers that creep: their dampers are too strong for forces from step to step.
fn creeps(line: &Catenary) -> bool {
    line.droppers.damping > line.damping.beta * line.droppers.stiffness + for_rate(line, MOST_DAMPED)
}

/// Damper `b = κ/a` between contact wire and the wire above, N·s/m.
///
/// Waves of both wires bear a damper `b` between them: a force that rises within a step leaves the rate
/// `a = ½ Σ 1/(2 √(T m))` per newton. With rates continued in a straight line, the force makes rates from step to step
/// follow `z³ − (1 − 2κ) z² + κ z − κ = 0`, whose roots lie within the unit circle below `κ = 1/√3` (*derived here*).
fn for_rate(line: &Catenary, kappa: f64) -> f64 {
    let compliance = |wire: &Wire| 1.0 / (2.0 * wire.mass_per_length * wire.wave_speed());
    let above = line.wire_kinds().filter(|(kind, _)| *kind != WireKind::Contact);
    let above = above.map(|(_, wire)| compliance(wire)).fold(0.0, f64::max);
    kappa / (0.5 * (compliance(&line.contact_wire) + above))
}

/// Error of the mesh that modes are chosen by, % of the standard deviation; `coarse` beyond [`MOST`].
fn counted(error_of_mesh: f64, coarse: f64) -> f64 {
    if error_of_mesh > MOST { coarse } else { error_of_mesh }
}

/// Highest frequency of the modes of a scene where forces of droppers have attachment modes, and where they have none,
/// Hz.
fn highest(scene: &Scene, error_of_mesh: f64) -> [f64; 2] {
    let slowest = scene
        .modelled_line()
        .map_or(f64::INFINITY, |(line, _)| line.slowest_wave());
    let of_strip = scene.run.low_pass_hz / (1.0 - scene.run.speed / slowest).max(0.05).sqrt();
    [[ATTACHED, COARSE_ATTACHED], [LEFT_OUT, COARSE]]
        .map(|[left_out, coarse]| of_strip * (left_out / (SHARE * counted(error_of_mesh, coarse))).cbrt())
}

/// True for a line in which dampers along wires would tell.
fn tells_stretching(line: &Catenary, error_of_mesh: f64) -> bool {
    ALONG * line.damping.beta / line.droppers.stiffness > counted(error_of_mesh, COARSE_ATTACHED) / 3.0
}

impl OverheadLine for ModalLine {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        visit("wires", &mut self.interface);
    }

    fn contact_wires(&self) -> usize {
        self.contact_wires
    }

    fn contact_curve(&self, (strip, wire): (usize, usize)) -> Arc<dyn WireCurve> {
        Arc::clone(&self.curves[strip * self.contact_wires + wire])
    }

    fn slack_count(&self, _: &Motion<'_>) -> usize {
        self.interface.slack_count()
    }

    fn elongations(&self) -> &[f64] {
        &[]
    }

    fn energy(&self, _: &Motion<'_>) -> f64 {
        self.interface.energy_of_modes()
    }

    fn dropper_samples(&self, _: &Motion<'_>) -> Vec<DropperSample> {
        let mut q = vec![0.0; self.coordinates];
        let droppers = self.shape.topology().droppers().iter();
        for at in droppers.flat_map(|place| [place.upper, place.lower]) {
            if let Some(index) = self.height(at) {
                q[index] = self.interface.drawn_deflection_of(index);
            }
        }
        let motion = Motion {
            t: 0.0,
            q: &q,
            v: &q,
            rotation: &[],
            u: &[],
        };
        let ends = self.shape.dropper_samples(&motion);
        ends.enumerate()
            .map(|(dropper, ends)| DropperSample {
                force: self.interface.tension(dropper),
                ..ends
            })
            .collect()
    }

    fn shape(&self) -> Option<&Line> {
        None
    }

    fn shape_mut(&mut self) -> Option<&mut Line> {
        None
    }

    fn support_count(&self) -> usize {
        self.shape.support_count()
    }

    fn set_uplift_reference(&mut self, _: &[f64]) {
        self.uplift = Uplift::counted_from(self.shape.topology(), |at| self.rise(at));
    }

    fn uplift(&self, support: usize, _: &[f64]) -> f64 {
        self.most_lifted(support).map_or(0.0, |(rise, _)| rise)
    }

    fn uplift_rate(&self, support: usize, _: &[f64], _: &[f64]) -> f64 {
        let index = self.most_lifted(support).and_then(|(_, at)| self.height(at));
        index.map_or(0.0, |index| self.interface.rate_of(index))
    }

    fn polylines(&self, name: WireName, _: &[f64], most: usize) -> Vec<Vec<Vector3<f64>>> {
        let deflection = |node: &WireNode| {
            node.map
                .position(2)
                .map_or(0.0, |index| self.interface.drawn_deflection_of(index))
        };
        let position = |node: &WireNode| node.position + deflection(node) * Vector3::z();
        self.shape.polylines_of(name, most, position)
    }

    fn follow(&mut self, _: (f64, f64), state: &mut State) -> Continuity {
        self.interface.follow(state);
        Continuity::Kept
    }

    fn settled(&self) -> Vec<f64> {
        let mut history = Vec::new();
        StepHistory::save(&self.interface, &mut history);
        history
    }

    fn continue_from(&mut self, settled: &[f64]) {
        StepHistory::restore(&mut self.interface, &mut settled.iter());
    }
}
