//! The static state of a line, and its static answers to forces.
//!
//! ```text
//! file                subject
//! form_finding        contact wire held at its heights; lengths follow
//! nodal_displacement  lengths given; shape follows
//! blow_off            the contact wire in a steady wind
//! change              temperature, ice and wrong droppers after the erection
//! directors           a contact wire of beams, from one of cables
//! repeat              long lines, from short ones
//! sideways            lateral forces at supports of a line whose wires do not move sideways
//! drawing             places of the parts at rest, for drawings
//! tensioned_ends      friction and stops of the tensioning devices
//! kept                results that follow from a static state, kept with it
//! report              figures of the static state, with the names of the result files
//! error               errors of statics
//! ```
mod blow_off;
mod change;
mod directors;
mod drawing;
mod error;
mod form_finding;
mod kept;
mod load;
mod nodal_displacement;
mod repeat;
mod report;
mod sideways;
mod tensioned_ends;

pub use blow_off::BlowOffReport;
pub use drawing::{DropperAtRest, WireAtRest};
pub use error::StaticsError;
use kept::Kept;
pub(crate) use repeat::Repeat;
pub use report::{
    DropperReport, ElasticityReport, EndReport, StaticsReport, SupportReport, TensionReport, gradients, non_uniformity,
};
use sideways::Sideways;

use crate::line::Equilibrium;
use crate::line::modal::{Base, Wish};
use crate::line::window::{Cells, Source};
use crate::{
    CurveColumns, DeadLoad, Enrichment, Line, LineOptions, NodeOfWire, PlannedWire, ResidualCompliance, Topology,
    WindOnLine, WireGeometry, WireName,
};
use dynamics::{Force, Layout, NewtonOptions, State, StaticOptions, StaticSolver, System};
use nalgebra::Vector3;
use scene::Catenary;
use std::sync::{Arc, OnceLock};

/// Force under which elasticity is measured, N.
const ELASTICITY_FORCE: f64 = 100.0;

/// Residual that ends a static solution, N: a hundred times the rounding of elements of 1e7 N/m at 1e-16 m.
const RESIDUAL: f64 = 1e-7;

/// Options of a static solution of the wires of a line with at most so many iterations.
///
/// The tension `T` moves the end of a wire of `n` elements, each of length `l`, by `n l T/EA`. Rounding of this
/// displacement times the stiffness `EA/l` of the last element is a force that no iteration takes away, as is rounding
/// of the strain times `EA`:
///
/// ```text
/// F = ε (n T + EA)
/// ```
fn options(max_iterations: usize, topology: &Topology) -> StaticOptions {
    let of_wire = |wire: &PlannedWire| {
        let scene::Wire {
            tension,
            axial_stiffness,
            ..
        } = wire.parameters;
        f64::EPSILON * (wire.last() as f64 * tension + axial_stiffness)
    };
    let rounding = topology.wires().iter().map(of_wire).fold(0.0, f64::max);
    StaticOptions {
        newton: NewtonOptions {
            // Two ends of an element.
            tolerance: RESIDUAL.max(2.0 * rounding),
            max_iterations,
            ..StaticOptions::modified().newton
        },
        ..StaticOptions::modified()
    }
}

/// Residual compliance of each contact wire of a line under strips that move with `speed` in m/s.
fn compliance_under(line: &Line, speed: f64) -> Vec<Option<Arc<ResidualCompliance>>> {
    let wires = (0..line.contact_wires()).map(|wire| line.contact_wire(wire));
    let found = wires.map(|wire| ResidualCompliance::new(wire.geometry(), wire.section(), speed));
    found.map(|found| found.map(Arc::new)).collect()
}

/// A line alone in its own layout, possibly under a dead load.
#[derive(Clone, Debug)]
struct Standalone {
    layout: Layout,
    line: Line,
    load: DeadLoad,
}

impl System for Standalone {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
        visit(&mut self.load);
    }
}

/// Lines in their modes and heights of the contact wire kept with a static state: some speeds, some pantographs.
const MODAL_LINES: usize = 4;
const HEIGHTS: usize = 16;

/// A line with known static state.
#[derive(Clone, Debug)]
pub struct StaticLine {
    catenary: Catenary,
    topology: Arc<Topology>,
    equilibrium: Equilibrium,
    /// The whole line, if a shorter one was solved in its place.
    whole: Catenary,
    repeat: Repeat,
    /// Spans reduced to modes, made on the first request.
    cells: OnceLock<Cells>,
    /// Lines in their modes made before.
    modal: Kept<Wish, Arc<Base>>,
    /// Heights of the contact wire, m, by place along the track, m, and force, N.
    heights: Kept<(f64, f64), f64>,
    system: Standalone,
    /// Wind on the wires; the static state itself is without wind.
    wind: Option<WindOnLine>,
    report: StaticsReport,
}

/// Answer of the line to a force.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticAnswer {
    /// Height of the contact wire where the force acts, m.
    pub height: f64,
    /// Displacements of the line, in the order of its coordinates; m, –.
    pub state: State,
}

impl StaticLine {
    /// Finds the static state of the line of a scene.
    ///
    /// # Errors
    /// See [`StaticsError`].
    pub fn solve(catenary: &Catenary, options: LineOptions) -> Result<Self, StaticsError> {
        let mut topology = Arc::new(Topology::new(catenary, options));
        let (mut equilibrium, mut iterations) = match catenary.statics {
            scene::Statics::FormFinding => form_finding::find_form(catenary, &topology)?,
            scene::Statics::NodalDisplacement => nodal_displacement::displace_ends(catenary, &topology)?,
        };
        if catenary.mesh.element == scene::Element::Beam {
            iterations += directors::turn_into_beam(catenary, &topology, &mut equilibrium)?;
        }
        let mut ends = Vec::new();
        let mut held = catenary.tensioning.is_some_and(|device| device.friction > 0.0);
        if let Some(change) = &catenary.change {
            let changed = change::change((catenary, &topology), &equilibrium, change)?;
            (topology, equilibrium) = (changed.topology, changed.equilibrium);
            iterations += changed.iterations;
            (ends, held) = (changed.ends, held || changed.held);
        }
        // Ends that friction or a stop holds stay where they are while pantographs pass.
        let catenary = &Catenary {
            wire_ends: if held {
                scene::WireEnds::Fixed
            } else {
                catenary.wire_ends
            },
            ..catenary.clone()
        };
        let mut layout = Layout::new();
        let coordinates = topology.register(&mut layout);
        topology.fix_ends(&coordinates, catenary.wire_ends, &mut layout);
        let line = Line::new(catenary, &topology, &equilibrium, 0);
        let compliance = (options.contact_compliance).map_or_else(Vec::new, |speed| compliance_under(&line, speed));
        let mut line = Self {
            system: Standalone {
                line: line.with_contact_compliance(compliance),
                layout,
                load: DeadLoad::default(),
            },
            wind: None,
            whole: catenary.clone(),
            repeat: Repeat::of_solved(&Source {
                catenary,
                topology: &topology,
                equilibrium: &equilibrium,
            }),
            cells: OnceLock::new(),
            modal: Kept::keeping(MODAL_LINES),
            heights: Kept::keeping(HEIGHTS),
            catenary: catenary.clone(),
            topology,
            equilibrium,
            report: StaticsReport::default(),
        };
        line.report = StaticsReport {
            ends,
            ..line.found(iterations)
        };
        line.check_strength()?;
        Ok(line)
    }

    /// Lets the wind act on the wires of the lines made from this static state, and on the answers to forces at t = 0.
    /// The static state itself, its report and the elasticity stay those without wind: all coordinates zero is the line
    /// at rest in still air.
    #[must_use]
    pub fn in_wind(mut self, wind: Option<WindOnLine>) -> Self {
        self.wind = wind;
        self
    }

    /// Report of the static state; for elasticity see [`StaticLine::elasticity`].
    #[must_use]
    pub fn report(&self) -> &StaticsReport {
        &self.report
    }

    /// True where friction or a stop of the tensioning devices holds the ends of the wires while pantographs pass.
    #[must_use]
    pub fn ends_are_held(&self) -> bool {
        self.catenary.wire_ends == scene::WireEnds::Fixed && self.catenary.tensioning.is_some()
    }

    /// The line of the scene that was solved: a long line of equal spans is solved as a short one.
    #[must_use]
    pub fn scene_line(&self) -> &Catenary {
        &self.catenary
    }

    /// The line in its own layout, coordinates numbered from 0.
    #[must_use]
    pub fn line(&self) -> &Line {
        &self.system.line
    }

    /// Solved line, to be cut into sections.
    pub(crate) fn source(&self) -> Source<'_> {
        Source {
            catenary: &self.catenary,
            topology: &self.topology,
            equilibrium: &self.equilibrium,
        }
    }

    /// The whole line, and the spans that were solved in place of all.
    pub(crate) fn whole(&self) -> (&Catenary, Repeat) {
        (&self.whole, self.repeat)
    }

    pub(crate) fn shared(&self) -> (&Arc<Topology>, &Equilibrium) {
        (&self.topology, &self.equilibrium)
    }

    /// Lines in their modes, shared by those made from this static state.
    pub(crate) fn modal(&self) -> &Kept<Wish, Arc<Base>> {
        &self.modal
    }

    /// Store of reduced spans, shared by the lines made from this static state.
    pub(crate) fn cells(&self) -> &OnceLock<Cells> {
        &self.cells
    }

    /// Number of coordinates, fixed ones included.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.system.layout.coordinates()
    }

    /// The line with its coordinates added to a shared layout; all zero is the static state.
    #[must_use]
    pub fn line_in(&self, layout: &mut Layout) -> Line {
        let first = layout.coordinates();
        let coordinates = self.topology.register(layout);
        self.topology.fix_ends(&coordinates, self.catenary.wire_ends, layout);
        self.corrected(Line::new(&self.catenary, &self.topology, &self.equilibrium, first))
            .in_wind(self.wind.as_ref())
    }

    /// Adds the residual compliance and the corrected mass of the options to a line.
    fn corrected(&self, line: Line) -> Line {
        let line = line.with_contact_compliance(self.system.line.compliance().to_vec());
        match self.topology.options().mass_correction {
            None => line,
            Some(correction) => line.with_mass_correction(correction),
        }
    }

    /// Straight level wires of the same nodes, at nominal tension and with slack droppers, in the coordinates of
    /// [`StaticLine::line_in`] numbered from `first`.
    pub(crate) fn straight_line(&self, first: usize) -> Line {
        let (catenary, equilibrium) = (&self.catenary, &self.equilibrium);
        let straight = |(planned, wire): (&PlannedWire, &WireGeometry)| {
            let lengths: Vec<f64> = planned.x.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let start = wire.nodes()[0].position;
            let map = |node: usize| wire.nodes()[node].map;
            let enrichments = wire.enrichments().iter().map(|enrichment| Enrichment {
                reference: 0.0,
                ..*enrichment
            });
            WireGeometry::straight(start, Vector3::x(), &lengths, map).with_enrichments(enrichments.collect())
        };
        let lines = catenary.tension_lengths.iter();
        let highest = lines.flat_map(|line| &line.encumbrance).copied().fold(0.0, f64::max);
        let straight = Equilibrium {
            wires: self
                .topology
                .wires()
                .iter()
                .zip(&equilibrium.wires)
                .map(straight)
                .collect(),
            dropper_lengths: vec![2.0 * highest; equilibrium.dropper_lengths.len()],
            ..equilibrium.clone()
        };
        self.corrected(Line::new(catenary, &self.topology, &straight, first))
    }

    fn solved_height_under(&self, x: f64, force: f64) -> Result<StaticAnswer, StaticsError> {
        let rest = self.system.layout.state_at_rest();
        // The static state itself.
        if force == 0.0 && self.wind.is_none() {
            return Ok(StaticAnswer {
                height: self.height(x, &rest.q),
                state: rest,
            });
        }
        let mut system = self.system.clone();
        system.line = system.line.in_wind(self.wind.as_ref());
        let mut solver = StaticSolver::new(&mut system, &rest.motion(&[]));
        let mut answer = self.answer((&mut system, &mut solver), x, force, rest)?;
        answer.height += force * self.residual(self.system.line.compliance(), x, &answer.state);
        Ok(answer)
    }

    fn solved_elasticity(&self, points: &[f64]) -> Result<Vec<ElasticityReport>, StaticsError> {
        let (mut system, rest) = (self.system.clone(), self.system.layout.state_at_rest());
        let mut solver = StaticSolver::new(&mut system, &rest.motion(&[]));
        let corrected = self.topology.options().contact_compliance;
        let compliance = corrected.map_or_else(Vec::new, |_| compliance_under(&self.system.line, 0.0));
        let mut start = rest.clone();
        let mut reports = Vec::with_capacity(points.len());
        for &x in points {
            let answer = self.answer((&mut system, &mut solver), x, ELASTICITY_FORCE, start)?;
            let rise = answer.height - self.height(x, &rest.q);
            reports.push(ElasticityReport {
                x,
                elasticity: rise / ELASTICITY_FORCE + self.residual(&compliance, x, &answer.state),
            });
            start = answer.state;
        }
        Ok(reports)
    }

    /// Default points of elasticity in spans `first` to `last` (from 1): supports, quarter points, mid-spans, droppers;
    /// m.
    #[must_use]
    pub fn elasticity_points(&self, first: usize, last: usize) -> Vec<f64> {
        let mut points = Vec::new();
        let droppers = self.whole.droppers_x();
        for span in first..=last {
            let (left, right) = (self.whole.support_x(span - 1), self.whole.support_x(span));
            points.extend([0.0, 0.25, 0.5, 0.75, 1.0].map(|xi| left + (right - left) * xi));
            let here = |x: &f64| (left..=right).contains(x);
            points.extend(droppers.iter().copied().filter(here));
        }
        points.sort_by(f64::total_cmp);
        // A dropper at mid-span may differ from the quarter point by rounding.
        points.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        points
    }

    /// Contact wires that share a force at `x` (m): those of the tension length that is lowest there.
    fn touched_at(&self, x: f64) -> Vec<usize> {
        let section = self.catenary.lowest_at(x);
        let contact_wires = self.topology.contact_wires().enumerate();
        let touched = contact_wires.filter(|&(_, wire)| self.topology.wires()[wire].section == section);
        touched.map(|(number, _)| number).collect()
    }

    /// Residual compliance under a force at `x` (m), m/N; 0 where the line has none.
    fn residual(&self, compliance: &[Option<Arc<ResidualCompliance>>], x: f64, state: &State) -> f64 {
        let touched = self.touched_at(x);
        let share = 1.0 / touched.len() as f64;
        let of_wire = |&wire: &usize| {
            let compliance = compliance.get(wire)?.as_ref()?;
            Some(compliance.at(self.system.line.contact_wire_s(wire, x, &state.q)).value)
        };
        touched
            .iter()
            .filter_map(of_wire)
            .map(|value| value * share * share)
            .sum()
    }

    /// Height of the contact wires at `x` (m) for coordinates `q`, m; the mean of a twin contact wire.
    fn height(&self, x: f64, q: &[f64]) -> f64 {
        let touched = self.touched_at(x);
        let v = vec![0.0; q.len()];
        let height = |&wire: &usize| {
            let s = self.system.line.contact_wire_s(wire, x, q);
            self.system.line.contact_curve(wire).point(s, q, &v).r.z
        };
        touched.iter().map(height).sum::<f64>() / touched.len() as f64
    }

    fn answer(
        &self,
        (system, solver): (&mut Standalone, &mut StaticSolver),
        x: f64,
        force: f64,
        mut state: State,
    ) -> Result<StaticAnswer, StaticsError> {
        let touched = self.touched_at(x);
        let share = force / touched.len() as f64;
        let options = StaticOptions::modified();
        let places = |line: &Line, q: &[f64]| -> Vec<f64> {
            touched.iter().map(|&wire| line.contact_wire_s(wire, x, q)).collect()
        };
        let mut at = places(&system.line, &state.q);
        // A wire slides past x by fractions of a millimetre, so a few passes find the point.
        for _ in 0..10 {
            system.load.entries.clear();
            for (&wire, &s) in touched.iter().zip(&at) {
                let mut columns = CurveColumns::default();
                system.line.contact_curve(wire).columns(s, &mut columns);
                let entries = columns.as_slice().iter();
                let entries = entries.map(|column| (column.index, share * column.n.z));
                system.load.entries.extend(entries);
            }
            solver.solve(system, &mut state, &[], &options)?;
            let next = places(&system.line, &state.q);
            let moved = at
                .iter()
                .zip(&next)
                .map(|(s, next)| (next - s).abs())
                .fold(0.0, f64::max);
            at = next;
            if moved < 1e-6 {
                break;
            }
        }
        Ok(StaticAnswer {
            height: self.height(x, &state.q),
            state,
        })
    }

    fn found(&mut self, iterations: usize) -> StaticsReport {
        let state = self.system.layout.state_at_rest();
        let motion = state.motion(&[]);
        let mut force = vec![0.0; state.q.len()];
        self.system.forces(&mut |part| part.add_force(&motion, &mut force));
        let fixed = self.system.layout.fixed();
        let free = (0..force.len()).filter(|index| !fixed.contains(index));
        let residual = free.map(|index| force[index].abs()).fold(0.0, f64::max);
        let line = &self.system.line;
        let node = |at: NodeOfWire| &line.wires()[at.wire].geometry().nodes()[at.node];
        // Coordinates that a planar line lacks carry no force.
        let at_end = |place: &NodeOfWire| {
            let map = &node(*place).map;
            Vector3::from_fn(|axis, _| map.position(axis).map_or(0.0, |index| -force[index]))
        };
        let droppers = self
            .topology
            .droppers()
            .iter()
            .enumerate()
            .map(|(index, place)| DropperReport {
                tension_length: place.section + 1,
                span: place.span,
                dropper: place.position + 1,
                hangs_from: self.topology.wires()[place.upper.wire].name,
                x: self.topology.x_of(place.lower),
                length: line.droppers().as_slice()[index].unstressed_length,
                force: line.droppers().tension(index, &motion),
            });
        let (mut held, mut arms) = (
            line.supports().as_slice().iter(),
            line.registration_arms().as_slice().iter(),
        );
        let leaning = self.topology.droppers().iter().enumerate().map(|(index, place)| {
            let [upper, lower] = [place.upper, place.lower].map(|at| node(at).position);
            line.droppers().tension(index, &motion) * (upper.y - lower.y) / (upper - lower).norm()
        });
        let sideways = Sideways::new(&self.catenary, &self.topology, leaning);
        let mut supports = Vec::new();
        for support in self.topology.support_places() {
            let (messenger, arm): (Vector3<f64>, Vector3<f64>) = if support.is_end {
                let arm = support.contact_wires.iter().map(at_end).sum();
                (support.messenger_wire.as_ref().map_or_else(Vector3::zeros, at_end), arm)
            } else {
                let arms = arms.by_ref().take(support.contact_wires.len());
                let held = held.by_ref().take(usize::from(support.messenger_wire.is_some()));
                (
                    held.map(|anchor| anchor.reaction).sum(),
                    arms.map(|anchor| anchor.reaction).sum(),
                )
            };
            let lateral = |of: &[NodeOfWire], found: f64| {
                if node(support.contact_wires[0]).map.position(1).is_some() {
                    return Some(found);
                }
                let sideways = sideways.as_ref()?;
                of.iter().map(|at| sideways.held(*at)).sum()
            };
            supports.push(SupportReport {
                tension_length: support.section + 1,
                x: support.x,
                messenger_reaction: messenger.z,
                arm_force: arm.z,
                messenger_lateral: lateral(support.messenger_wire.as_slice(), messenger.y),
                arm_lateral: lateral(&support.contact_wires, arm.y),
                contact_wire_z: node(support.contact_wires[0]).position.z,
            });
        }
        let horizontal = |name: WireName| {
            let planned = self.topology.wires().iter().position(|planned| planned.name == name);
            let Some(number) = planned else { return 0.0 };
            let mut wire = line.wires()[number].clone();
            let mut own = vec![0.0; state.q.len()];
            wire.add_force(&motion, &mut own);
            let last = wire.geometry().nodes().last().and_then(|node| node.map.position(0));
            -own[last.expect("x exists in every node")]
        };
        StaticsReport {
            iterations,
            residual,
            droppers: droppers.collect(),
            supports,
            elasticity: Vec::new(),
            ends: Vec::new(),
            tension: TensionReport {
                contact_wire: horizontal(WireName::ContactWire),
                messenger_wire: horizontal(WireName::MessengerWire),
            },
        }
    }

    /// Refuses a line with a wire that breaks under its own weight and tension.
    fn check_strength(&self) -> Result<(), StaticsError> {
        let rest = self.system.layout.state_at_rest();
        for (planned, wire) in self.topology.wires().iter().zip(self.line().wires()) {
            let Some(limit) = planned.parameters.breaking_force else {
                continue;
            };
            for element in 0..planned.last() {
                let tension = wire.tension(element, &rest.q);
                if tension > limit {
                    return Err(StaticsError::WireBreaks {
                        wire: planned.label.clone(),
                        tension,
                        x: planned.x[element],
                        limit,
                    });
                }
            }
        }
        Ok(())
    }
}
