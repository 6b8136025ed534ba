//! The static state of a line, and its static answers to forces.
//!
//! ```text
//! file                subject
//! form_finding        contact wire held at its heights; lengths follow
//! nodal_displacement  lengths given; shape follows
//! directors           a contact wire of beams, from one of cables
//! repeat              long lines, from short ones
//! report              figures of the static state, with the names of the result files
//! error               errors of statics
//! ```
mod directors;
mod error;
mod form_finding;
mod load;
mod nodal_displacement;
mod repeat;
mod report;

pub use error::StaticsError;
pub(crate) use repeat::Repeat;
pub use report::{DropperReport, ElasticityReport, StaticsReport, SupportReport, TensionReport};

use crate::line::Equilibrium;
use crate::line::window::{Cells, Source};
use crate::{
    CurveColumns, Enrichment, Line, LineOptions, NodeOfWire, PlannedWire, ResidualCompliance, Topology, WireCurve,
    WireGeometry, WireName, WiresInWind,
};
use dynamics::{Force, Layout, NewtonOptions, State, StaticOptions, System, solve_static};
use load::DeadLoad;
use nalgebra::Vector3;
use scene::Catenary;
use std::sync::{Arc, OnceLock};

/// Force under which elasticity is measured, N.
const ELASTICITY_FORCE: f64 = 100.0;

/// Options of a static solution with at most so many iterations.
fn options(max_iterations: usize) -> StaticOptions {
    StaticOptions {
        newton: NewtonOptions {
            // Rounding of elements of 1e7 N/m at 1e-16 m is a hundred times smaller.
            tolerance: 1e-7,
            max_iterations,
            ..NewtonOptions::default()
        },
        ..StaticOptions::default()
    }
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
    system: Standalone,
    /// Residual compliance of the contact wire under strips at rest.
    at_rest: Option<Arc<ResidualCompliance>>,
    /// Wind on the wires; the static state itself is without wind.
    wind: Option<WiresInWind>,
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
        let topology = Arc::new(Topology::new(catenary, options));
        let (mut equilibrium, mut iterations) = match catenary.statics {
            scene::Statics::FormFinding => form_finding::find_form(catenary, &topology)?,
            scene::Statics::NodalDisplacement => nodal_displacement::displace_ends(catenary, &topology)?,
        };
        if catenary.mesh.element == scene::Element::Beam {
            iterations += directors::turn_into_beam(catenary, &topology, &mut equilibrium)?;
        }
        let mut layout = Layout::new();
        let coordinates = topology.register(&mut layout);
        topology.fix_ends(&coordinates, catenary.wire_ends, &mut layout);
        let line = Line::new(catenary, &topology, &equilibrium, 0);
        let compliance = |speed: f64| {
            let wire = line.wire(WireName::ContactWire);
            ResidualCompliance::new(wire.geometry(), wire.section(), speed).map(Arc::new)
        };
        let at_rest = options.contact_compliance.and_then(|_| compliance(0.0));
        let moving = options.contact_compliance.and_then(compliance);
        let mut line = Self {
            system: Standalone {
                line: line.with_contact_compliance(moving),
                layout,
                load: DeadLoad::default(),
            },
            at_rest,
            wind: None,
            whole: catenary.clone(),
            repeat: Repeat::of_solved(&Source {
                catenary,
                topology: &topology,
                equilibrium: &equilibrium,
            }),
            cells: OnceLock::new(),
            catenary: catenary.clone(),
            topology,
            equilibrium,
            report: StaticsReport::default(),
        };
        line.report = line.found(iterations);
        line.check_strength()?;
        Ok(line)
    }

    /// Lets the wind act on the wires of the lines made from this static state, and on the answers to forces at t = 0.
    /// The static state itself, its report and the elasticity stay those without wind: all coordinates zero is the line
    /// at rest in still air.
    #[must_use]
    pub fn in_wind(mut self, wind: Option<WiresInWind>) -> Self {
        self.wind = wind;
        self
    }

    /// Report of the static state; for elasticity see [`StaticLine::elasticity`].
    #[must_use]
    pub fn report(&self) -> &StaticsReport {
        &self.report
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
        let line = line.with_contact_compliance(self.system.line.compliance().cloned());
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
        let highest = catenary.first().encumbrance.iter().copied().fold(0.0, f64::max);
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
        let mut system = self.system.clone();
        system.line = system.line.in_wind(self.wind.as_ref());
        let mut answer = self.answer(system, x, force, self.system.layout.state_at_rest())?;
        answer.height += force * self.residual(self.system.line.compliance(), x, &answer.state);
        Ok(answer)
    }

    fn solved_elasticity(&self, points: &[f64]) -> Result<Vec<ElasticityReport>, StaticsError> {
        let mut start = self.system.layout.state_at_rest();
        let rest = start.clone();
        let mut reports = Vec::with_capacity(points.len());
        for &x in points {
            let answer = self.answer(self.system.clone(), x, ELASTICITY_FORCE, start)?;
            let rise = answer.height - self.height(x, &rest.q);
            reports.push(ElasticityReport {
                x,
                elasticity: rise / ELASTICITY_FORCE + self.residual(self.at_rest.as_ref(), x, &answer.state),
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
        for span in first..=last {
            let (left, right) = (self.whole.support_x(span - 1), self.whole.support_x(span));
            points.extend([0.0, 0.25, 0.5, 0.75, 1.0].map(|xi| left + (right - left) * xi));
            points.extend(
                self.whole
                    .droppers
                    .of_span(span - 1)
                    .iter()
                    .map(|position| left + position),
            );
        }
        points.sort_by(f64::total_cmp);
        // A dropper at mid-span may differ from the quarter point by rounding.
        points.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        points
    }

    /// Residual compliance at `x` (m), m/N; 0 where the line has none.
    fn residual(&self, compliance: Option<&Arc<ResidualCompliance>>, x: f64, state: &State) -> f64 {
        compliance.map_or(0.0, |compliance| {
            compliance.at(self.system.line.contact_wire_s(x, &state.q)).value
        })
    }

    /// Height of the contact wire at `x` (m) for coordinates `q`, m.
    fn height(&self, x: f64, q: &[f64]) -> f64 {
        let s = self.system.line.contact_wire_s(x, q);
        let v = vec![0.0; q.len()];
        self.system.line.contact_curve().point(s, q, &v).r.z
    }

    fn answer(
        &self,
        mut system: Standalone,
        x: f64,
        force: f64,
        mut state: State,
    ) -> Result<StaticAnswer, StaticsError> {
        let curve: Arc<dyn WireCurve> = system.line.contact_curve();
        let options = StaticOptions::default();
        let mut s = system.line.contact_wire_s(x, &state.q);
        // The wire slides past x by fractions of a millimetre, so a few passes find the point.
        for _ in 0..10 {
            let mut columns = CurveColumns::default();
            curve.columns(s, &mut columns);
            system.load.entries = columns
                .as_slice()
                .iter()
                .map(|column| (column.index, force * column.n.z))
                .collect();
            solve_static(&mut system, &mut state, &[], &options)?;
            let next = system.line.contact_wire_s(x, &state.q);
            let moved = (next - s).abs();
            s = next;
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
        let at = |place: NodeOfWire, axis: usize| {
            let index = node(place).map.position(axis);
            index.expect("x and z exist in every node")
        };
        let x = |at: NodeOfWire| self.topology.wires()[at.wire].x[at.node];
        let droppers = self
            .topology
            .droppers()
            .iter()
            .enumerate()
            .map(|(index, place)| DropperReport {
                span: place.span,
                x: x(place.lower),
                length: line.droppers().as_slice()[index].unstressed_length,
                force: line.droppers().tension(index, &motion),
            });
        let last = self.topology.support_nodes().len() - 1;
        let supports = self.topology.support_nodes().iter().enumerate();
        let supports = supports.map(|(number, &[lower, upper])| {
            let (messenger_reaction, arm_force) = if number == 0 || number == last {
                (-force[at(upper, 2)], -force[at(lower, 2)])
            } else {
                (
                    line.supports().as_slice()[number - 1].reaction.z,
                    line.registration_arms().as_slice()[number - 1].reaction.z,
                )
            };
            SupportReport {
                x: x(lower),
                messenger_reaction,
                arm_force,
                contact_wire_z: node(lower).position.z,
            }
        });
        let horizontal = |name: WireName| {
            let mut wire = line.wire(name).clone();
            let mut own = vec![0.0; state.q.len()];
            wire.add_force(&motion, &mut own);
            let last = wire.geometry().nodes().last().and_then(|node| node.map.position(0));
            -own[last.expect("x exists in every node")]
        };
        StaticsReport {
            iterations,
            residual,
            droppers: droppers.collect(),
            supports: supports.collect(),
            elasticity: Vec::new(),
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
