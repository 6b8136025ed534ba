//! A line of which only the spans around the strips are modelled in full: `window` of `model.reduce`.
//!
//! ```text
//!   true end                                                                     true end, or absorbing
//!      |== cell == cell == cell ==|......... window .........|== cell == cell == ... ==|
//!                                  full spans, strips inside
//! ```
//!
//! The window is a line of a few spans cut out of the static state. The spans beyond its ends are linear and reduced to
//! their supports, the elongations of droppers with dampers, and modes ([`cell`]): the first ones along and across the
//! track and the lowest others. A reduced span is far cheaper than a full one, carries waves of the frequencies of
//! interest without reflection, and keeps the line's longitudinal elasticity and mass, which the contact force depends
//! on. Each reduced span has its halves of the bending layers at its supports. On short lines these cells reach the
//! true ends. Long lines have a fixed number of cells, with damping that grows with the distance and, at the last
//! support, dashpots `√(EA m)` matched to longitudinal waves [after Lysmer & Kuhlemeyer 1969].
//!
//! When the last strip comes to the next span, the window moves on by one: the entering span takes its motion from its
//! modes, and the leaving one hands its own over to modes, so that neither starts or stops abruptly. In the middle of a
//! line of equal spans the matrices stay the same ones, and moving is a copy.
//!
//! ```text
//! file         subject
//! places       coordinates of the spans of a section
//! plan         modelled spans and their reduction, for each position
//! cut          sections of the static state
//! modes        lowest modes of a span
//! elongations  coordinates for the dampers of droppers
//! end_layers   bending layers at the ends of a span
//! cell         a reduced span
//! part         that of one tension length
//! far          all reduced spans as one contribution
//! ends         supports, true ends and absorbing ends
//! overhead     the windowed line as an overhead line
//! curve        the contact wire of the window at its place
//! transfer     the state, moved with the window
//! ```
mod cell;
mod curve;
mod cut;
mod elongations;
mod end_layers;
mod ends;
mod far;
mod modes;
mod overhead;
mod part;
mod places;
mod plan;
mod transfer;

use crate::line::Equilibrium;
use crate::statics::Repeat;
use crate::support::HOLDING_STIFFNESS;
use crate::{
    Dimension, Line, LinearLine, NodeOfWire, OverheadLine, ResidualCompliance, StaticLine, StaticsError, Topology,
    Wire, WireName,
};
use cell::{Cell, SpanMatrices};

pub(crate) use cut::Source;
use dynamics::{Blocks, Continuity, Layout, Motion, SparseMatrix, Weights};
use elongations::Elongations;
use end_layers::EndLayers;
use ends::held_at_end;
use far::{FarField, Member};
use modes::{APART, Kept};
use places::SpanPlaces;
use plan::{Arrangement, ModeCounts, Plan};
use scene::{Catenary, Reduction, Scene};
use std::ops::Range;
use std::sync::Arc;

/// Full spans behind the span of the last strip, whose droppers still go slack.
const BEHIND: usize = 2;
/// Full spans ahead of the span of the first strip.
const AHEAD: usize = 1;
/// Reduced spans on either side of the window, at most: a tension length has 20 to 30 spans, so that its true ends are
/// reached.
const REACH: usize = 30;
/// Reduced spans nearest to the window that carry all waves of interest.
const NEAR: usize = 6;
/// Highest mode of a near span in units of the highest frequency that matters there: a force of the filter's frequency
/// `f` that moves with `v` sends waves of frequency `f/(1 − v/c)` ahead, and meets such waves from behind. Modes that
/// move along the track are counted apart.
const BAND: f64 = 1.0;
/// Highest mode of a span further away in units of the filter's frequency `f`: waves that come back from there are met
/// at `f/(1 + v/c)` or below, and a mode is carried right only well below the highest one. Larger values change the
/// contact force hardly more.
const FAR_BAND: f64 = 1.4;
/// Damping of the modes of a span `REACH` beyond the near ones, 1/s.
const SPONGE: f64 = 5.0;
/// Coordinates held at an end of a wire, at most.
const ENDS_HELD: usize = 3;
/// Largest difference in the static state between spans that are taken as equal, m.
pub(crate) const SAME: f64 = 1e-7;

/// The spans of a static state, reduced.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    /// Number of modes of each cell.
    modes: usize,
    /// Class of each span; spans of one class are equal.
    classes: Vec<usize>,
    /// The reduced span of each class.
    cells: Vec<Arc<Cell>>,
}

/// Size of a windowed line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowSize {
    /// Spans modelled in full.
    pub full: usize,
    /// Spans reduced to supports and modes, at most.
    pub reduced: usize,
    /// Elements of both wires in the window.
    pub elements: usize,
    /// Coordinates, held ones included.
    pub coordinates: usize,
}

/// Constants of the line, unchanged while the window moves.
struct Fixed {
    catenary: Catenary,
    topology: Arc<Topology>,
    equilibrium: Equilibrium,
    linearised: bool,
    plan: Plan,
    repeat: Repeat,
    cells: Cells,
    /// x of all supports, m.
    supports_x: Vec<f64>,
    /// Coordinate of the distance travelled, m; the coordinates of the window follow.
    position: usize,
    /// Coordinates of each support of the solved spans.
    at_supports: Vec<usize>,
    /// Elongations on the interface of each solved span.
    elongations: Vec<usize>,
    /// All coordinates of the line.
    coordinates: Range<usize>,
}

/// A line with a window around the strips modelled in full.
pub struct WindowedLine {
    fixed: Fixed,
    /// x of the window's left support at the start, m.
    origin: f64,
    arrangement: Arrangement,
    /// Positions of the coordinates of the window's spans.
    places: Arc<SpanPlaces>,
    inner: Box<dyn OverheadLine>,
    /// Number of each contact wire among those of the window; none beyond it.
    own_wires: Vec<Option<usize>>,
    /// Potential energy of `inner` in its static state, J; different for each place of the window.
    energy_at_rest: f64,
    far: FarField,
    held: Vec<usize>,
    uplift_reference: Vec<f64>,
    /// Residual compliance of the window's contact wires, with the patches of earlier windows.
    compliance: Vec<Option<Arc<ResidualCompliance>>>,
}

impl Fixed {
    fn source(&self) -> Source<'_> {
        Source {
            catenary: &self.catenary,
            topology: &self.topology,
            equilibrium: &self.equilibrium,
        }
    }

    fn source_of(&self, from: usize, count: usize) -> usize {
        self.repeat.source_of(from, count)
    }

    fn cell(&self, span: usize) -> &Arc<Cell> {
        &self.cells.cells[self.cells.classes[self.source_of(span, 1)]]
    }

    /// Key of everything that the matrices depend on.
    fn kind(&self, arrangement: &Arrangement) -> (usize, Vec<usize>, bool, bool, usize) {
        let source = self.source_of(arrangement.at, self.plan.window);
        let classes = arrangement
            .modelled
            .clone()
            .map(|span| self.cells.classes[self.source_of(span, 1)]);
        let left = arrangement.window.start - arrangement.modelled.start;
        (
            source,
            classes.collect(),
            arrangement.modelled.start == 0,
            arrangement.modelled.end == self.plan.spans,
            left,
        )
    }

    /// Arrangement with the window at `at`.
    fn arrangement(&self, at: usize) -> Arrangement {
        let mut arrangement = self.plan.arrangement(at);
        arrangement.trim(|support| self.at_support(support), |span| self.elongations_of(span));
        arrangement
    }

    /// Positions of the coordinates of the window of an arrangement.
    fn places(&self, arrangement: &Arrangement) -> SpanPlaces {
        let from = self.source_of(arrangement.at, self.plan.window);
        let first = self.plan.window_first();
        self.source().places(&(from..from + self.plan.window), first)
    }

    /// Solved support that stands for a support of the line.
    fn source_support(&self, support: usize) -> usize {
        match support.checked_sub(1) {
            Some(before) => self.source_of(before, 1) + 1,
            None => 0,
        }
    }

    /// Number of coordinates of a support.
    fn at_support(&self, support: usize) -> usize {
        self.at_supports[self.source_support(support)]
    }

    /// Number of elongations on the interface of a span.
    fn elongations_of(&self, span: usize) -> usize {
        self.elongations[self.source_of(span, 1)]
    }

    /// Number of each contact wire of the line among those of a section of the solved line; none for a wire that has
    /// no element there.
    fn own_wires(&self, spans: &Range<usize>) -> Vec<Option<usize>> {
        let mut count = 0;
        let numbers = self.topology.contact_wires().map(|wire| {
            let present = !self.topology.nodes_in(wire, spans).is_empty();
            count += usize::from(present);
            present.then(|| count - 1)
        });
        numbers.collect()
    }

    fn most_wires_at_a_mast(&self) -> usize {
        self.topology.masts().iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Nodes of the solved line at a support.
    fn nodes_at(&self, support: usize) -> impl Iterator<Item = NodeOfWire> + '_ {
        self.topology.nodes_at(self.source_support(support))
    }
}

impl Arrangement {
    /// Coordinates of a modelled support, with those of the window at `places`.
    fn support<'a>(&'a self, places: &'a SpanPlaces, support: usize) -> Option<impl Iterator<Item = usize> + 'a> {
        let (window, modelled) = (&self.window, &self.modelled);
        let (own, reduced) = if (window.start..=window.end).contains(&support) {
            (Some(&places.supports[support - window.start]), None)
        } else if (modelled.start..=modelled.end).contains(&support) {
            (None, self.supports[support - modelled.start].clone())
        } else {
            return None;
        };
        Some(own.into_iter().flatten().copied().chain(reduced.into_iter().flatten()))
    }
}

impl WindowedLine {
    /// Windowed line of a scene from a solved static state, with its coordinates added to `layout`: all zero is the
    /// static state with the window where the strips start.
    ///
    /// # Errors
    /// [`StaticsError::Unstable`] for a span without stable static state between its supports.
    pub fn new(scene: &Scene, statics: &StaticLine, layout: &mut Layout) -> Result<Self, StaticsError> {
        let first = layout.coordinates();
        let (plan, line) = plan_of(scene, statics, first);
        let (catenary, repeat) = statics.whole();
        let inner = plan.inner;
        let window_first = plan.window_first();
        let reduced = plan.coordinates() - inner;
        layout.add_coordinates(window_first - first, "supports behind the window");
        layout.add_coordinates(inner, "window of the line");
        layout.add_coordinates(first + reduced - window_first, "spans beyond the window");
        let position = layout.add_coordinates(1, "position of the window");
        let cells = cells(statics, &plan)?;
        let supports_x = catenary.supports_x();
        let (topology, equilibrium) = statics.shared();
        let fixed = Fixed {
            catenary: statics.source().catenary.clone(),
            topology: Arc::clone(topology),
            equilibrium: equilibrium.clone(),
            linearised: scene.model.has(Reduction::Linearised),
            repeat,
            cells,
            position,
            at_supports: at_supports(&statics.source()),
            elongations: elongations(&statics.source()),
            coordinates: first..layout.coordinates(),
            supports_x,
            plan,
        };
        let starts = (0..scene.strip_count()).map(|i| scene.strip_start_x(i));
        let rear = starts.fold(f64::INFINITY, f64::min);
        let arrangement = fixed.arrangement(fixed.plan.position(span_at(&fixed.supports_x, rear)));
        let mut line = Self {
            origin: fixed.supports_x[arrangement.at],
            uplift_reference: vec![0.0; fixed.supports_x.len() * fixed.most_wires_at_a_mast()],
            own_wires: Vec::new(),
            inner: Box::new(line),
            energy_at_rest: 0.0,
            far: FarField::default(),
            held: Vec::new(),
            compliance: Vec::new(),
            places: Arc::new(fixed.places(&arrangement)),
            arrangement,
            fixed,
        };
        line.build();
        layout.fix_within(line.fixed.coordinates.clone(), &line.held);
        Ok(line)
    }

    /// Size of the windowed line of a scene, without making the line.
    #[must_use]
    pub fn size(scene: &Scene, statics: &StaticLine) -> WindowSize {
        let (plan, line) = plan_of(scene, statics, 0);
        WindowSize {
            full: plan.window,
            reduced: (plan.spans - plan.window).min(2 * plan.reach),
            elements: line.topology().elements(),
            coordinates: plan.coordinates() + 1,
        }
    }

    /// Largest number of full spans in a window over the strips of a scene.
    #[must_use]
    pub fn most_spans(scene: &Scene, catenary: &Catenary) -> usize {
        BEHIND + AHEAD + 1 + scene.spans_between_strips(catenary) + catenary.first().stagger.len() - 1
    }

    /// Builds all contributions for the present arrangement.
    fn build(&mut self) {
        let fixed = &self.fixed;
        let (plan, arrangement) = (&fixed.plan, &self.arrangement);
        let first = plan.window_first();
        let from = fixed.source_of(arrangement.at, plan.window);
        let spans = from..from + plan.window;
        let (mut line, places) = fixed.source().cut_for_contact(spans, first, &mut self.compliance);
        let count = places.count;
        self.places = Arc::new(places);
        self.own_wires = fixed.own_wires(&(from..from + plan.window));
        self.inner = if fixed.linearised {
            let mut own = Layout::new();
            own.add_coordinates(first + count, "window");
            Box::new(LinearLine::about(&mut line, &own))
        } else {
            Box::new(line)
        };

        // Nothing moves at rest: the forces missing at the cuts are the negative of those of the cut parts.
        let mut rest = vec![0.0; first + count];
        let zeros = vec![0.0; first + count];
        let motion = Motion {
            t: 0.0,
            q: &zeros,
            v: &zeros,
            rotation: &[],
            u: &[],
        };
        self.inner.forces(&mut |part| part.add_force(&motion, &mut rest));
        self.energy_at_rest = self.inner.energy(&motion);
        let mut far = FarField {
            load: rest.iter().map(|force| -force).collect(),
            ..FarField::default()
        };

        for span in arrangement
            .modelled
            .clone()
            .filter(|span| !arrangement.window.contains(span))
        {
            let modes = arrangement.modes[span - arrangement.modelled.start].clone();
            let supports = [span, span + 1]
                .into_iter()
                .filter_map(|support| arrangement.support(&self.places, support));
            let elongations = arrangement.elongations[span - arrangement.modelled.start].clone();
            let interface: Vec<usize> = supports.flatten().chain(elongations).collect();
            let sponge = fixed.sponge(arrangement, span);
            far.members
                .extend(Member::of_span(fixed.cell(span), &interface, modes, sponge));
        }
        let mut used = vec![false; fixed.coordinates.len()];
        let window = first..first + count;
        for index in arrangement.reduced().chain(window) {
            used[index - fixed.coordinates.start] = true;
        }
        let unused = fixed.coordinates.clone().zip(used).filter(|(_, used)| !used);
        self.held = unused.map(|(index, _)| index).collect();
        for end in &self.places.ends {
            fixed.hold_inner_end(end, &mut far.grounds, &mut self.held);
        }
        for support in arrangement.modelled.start..=arrangement.modelled.end {
            let inside = arrangement.window.start < support && support < arrangement.window.end;
            if !inside {
                fixed.hold((arrangement, &self.places), support, &mut far.grounds, &mut self.held);
            }
        }
        self.far = far;
    }

    /// Goes to another arrangement, without moving the state.
    fn go_to(&mut self, next: Arrangement) -> Continuity {
        let same = self.fixed.kind(&next) == self.fixed.kind(&self.arrangement);
        self.arrangement = next;
        if same {
            return Continuity::Moved;
        }
        self.build();
        Continuity::Replaced
    }

    /// Indices of the vertical displacements of the contact wires that pass a support; none where it is not modelled.
    fn rises(&self, support: usize) -> impl Iterator<Item = usize> + '_ {
        let places = self.arrangement.support(&self.places, support);
        let per_node = coordinates_per_node(self.fixed.topology.options().dimension);
        let vertical = places
            .into_iter()
            .flatten()
            .skip(self.fixed.vertical())
            .step_by(per_node);
        let wires = self.fixed.topology.wires();
        let nodes = vertical.zip(self.fixed.nodes_at(support));
        let of_contact_wires = nodes.filter(|(_, at)| wires[at.wire].name == WireName::ContactWire);
        of_contact_wires.map(|(index, _)| index)
    }

    /// Largest rise of the contact wires at a support above the height in the reference state, m, and its index.
    fn most_lifted(&self, support: usize, q: &[f64]) -> Option<(f64, usize)> {
        let wires = self.fixed.most_wires_at_a_mast();
        let reference = &self.uplift_reference[wires * support..wires * (support + 1)];
        let rises = self.rises(support).zip(reference);
        let rises = rises.map(|(index, reference)| (q[index] - reference, index));
        rises.reduce(|a, b| if b.0 > a.0 { b } else { a })
    }

    /// x of the window's left support, m.
    fn start(&self) -> f64 {
        self.fixed.supports_x[self.arrangement.at]
    }

    /// Spans in a picture: all of a short line, the modelled ones of a long line.
    fn drawn(&self) -> Range<usize> {
        let most = 2 * REACH + self.fixed.plan.window;
        if self.fixed.plan.spans <= 2 * most {
            0..self.fixed.plan.spans
        } else {
            self.arrangement.modelled.clone()
        }
    }
}

/// Span at `x`, from 0; the first or last one beyond the line.
fn span_at(supports_x: &[f64], x: f64) -> usize {
    let right = supports_x.partition_point(|&support| support <= x);
    right.saturating_sub(1).min(supports_x.len() - 2)
}

/// Plan of a scene's window with coordinates from `first` on, and a window's line with coordinates from 0 on.
fn plan_of(scene: &Scene, statics: &StaticLine, first: usize) -> (Plan, Line) {
    let source = statics.source();
    let (catenary, repeat) = statics.whole();
    let stride = repeat.period.unwrap_or(1);
    let window = WindowedLine::most_spans(scene, catenary) + stride - catenary.first().stagger.len();
    let window = window.min(repeat.known);
    let (line, _) = source.cut(0..window, 0);
    // Different windows, one after another; those of a long line of equal spans are few.
    let mut sources: Vec<usize> = (0..=repeat.spans - window)
        .map(|at| repeat.source_of(at, window))
        .collect();
    sources.sort_unstable();
    sources.dedup();
    let inner = sources
        .iter()
        .map(|&from| source.places(&(from..from + window), 0).count)
        .max();
    let anchored = source.topology.wires().iter();
    let anchored = anchored.filter(|planned| planned.section == 0 && planned.name != WireName::StitchWire);
    let wires: Vec<&scene::Wire> = anchored.map(|planned| &planned.parameters).collect();
    let longest = catenary.all_span_lengths().fold(0.0, f64::max);
    let directions = if source.topology.options().dimension == Dimension::Planar {
        1
    } else {
        2
    };
    let elongations = elongations(&source);
    let of_span = |span: usize| source.places(&(span..span + 1), 0).inner[0].len() - elongations[span];
    let several = catenary.tension_lengths.len() > 1;
    let beside = if several {
        (0..repeat.spans)
            .map(|span| source.topology.tension_lengths_in(span))
            .collect()
    } else {
        Vec::new()
    };
    // Of the ends of wires three coordinates may be held.
    let held = if several { ENDS_HELD * wires.len() } else { 0 };
    let all = (0..repeat.known).map(|span| (of_span(span) - held) / beside.get(span).copied().unwrap_or(1));
    let all = all.min().unwrap_or(0);
    let stitch_wire = source.catenary.stitch_wires.as_ref();
    let stitch_wire = stitch_wire.map(|stitch| (&stitch.wire, stitch.length));
    let modes_up_to = |frequency: f64| -> usize {
        let lengths = wires.iter().map(|&wire| (wire, longest)).chain(stitch_wire);
        let per_wire = lengths.map(|(wire, length)| (2.0 * length * frequency / wire.wave_speed()).ceil() as usize);
        per_wire.sum::<usize>()
    };
    let kept = |frequency: f64| (modes_up_to(frequency) + directions * APART).min(all);
    let along = wires
        .iter()
        .map(|wire| (wire.axial_stiffness / wire.mass_per_length).sqrt());
    let second_longitudinal = along.fold(0.0, f64::max) / longest;
    let slower = wires.iter().map(|wire| wire.wave_speed()).fold(f64::INFINITY, f64::min);
    let shift = (1.0 - scene.run.speed / slower).max(1e-3);
    let far = kept(FAR_BAND * scene.run.low_pass_hz);
    let band = (BAND / shift).max(FAR_BAND) * scene.run.low_pass_hz;
    let plan = Plan {
        spans: repeat.spans,
        window,
        behind: BEHIND,
        stride,
        reach: REACH,
        near: NEAR,
        modes: ModeCounts {
            near: kept(band),
            far,
            searched: kept(band.max(1.2 * second_longitudinal)),
        },
        beside,
        at_support: at_supports(&source).into_iter().max().unwrap_or(0),
        elongations: elongations.into_iter().max().unwrap_or(0),
        inner: inner.unwrap_or(0),
        first,
    };
    (plan, line)
}

/// Number of coordinates of each support.
fn at_supports(source: &Source<'_>) -> Vec<usize> {
    let per_node = coordinates_per_node(source.topology.options().dimension);
    let supports = 0..=source.catenary.spans();
    supports
        .map(|support| source.topology.nodes_at(support).count() * per_node)
        .collect()
}

fn coordinates_per_node(dimension: Dimension) -> usize {
    match dimension {
        Dimension::Planar => 4,
        Dimension::Spatial => 6,
    }
}

/// Number of each span's droppers whose elongations are on the interface; droppers without dampers stretch with the
/// modes.
fn elongations(source: &Source<'_>) -> Vec<usize> {
    let mut counts = vec![0; source.catenary.spans()];
    if source.catenary.droppers.damping > 0.0 {
        for place in source.topology.droppers() {
            counts[source.topology.span_of(place)] += 1;
        }
    }
    counts
}

/// Reduced spans of a static state; made once for all lines from it.
fn cells(statics: &StaticLine, plan: &Plan) -> Result<Cells, StaticsError> {
    let modes = plan.modes.near;
    if let Some(known) = statics.cells().get().filter(|known| known.modes == modes) {
        return Ok(known.clone());
    }
    let source = statics.source();
    let elongations = elongations(&source);
    let (mut classes, mut examples, mut cells) = (Vec::new(), Vec::new(), Vec::new());
    for (span, &elongations) in elongations.iter().enumerate() {
        let known = examples
            .iter()
            .position(|&example| source.difference(example, span) <= SAME);
        if known.is_none() {
            let matrices = matrices(&source, span, elongations);
            let beside = plan.beside(span);
            let kept = Kept {
                count: modes,
                searched: plan.modes.searched,
                apart: APART,
            };
            let cell = Cell::new(matrices, beside, kept);
            let cell = cell.ok_or(StaticsError::Unstable { span: span + 1 })?;
            examples.push(span);
            cells.push(Arc::new(cell));
        }
        classes.push(known.unwrap_or(examples.len() - 1));
    }
    let made = Cells { modes, classes, cells };
    // Cells with other modes that are made later are not kept.
    let _ = statics.cells().set(made.clone());
    Ok(made)
}

fn matrices(source: &Source<'_>, span: usize, elongations: usize) -> SpanMatrices {
    let (mut line, places) = source.cut_with_end_layers(span..span + 1);
    let size = places.count;
    let zeros = vec![0.0; size];
    let motion = Motion {
        t: 0.0,
        q: &zeros,
        v: &zeros,
        rotation: &[],
        u: &[],
    };
    let mut tangent = |q: f64, v: f64| {
        Blocks::collect(|blocks| line.forces(&mut |part| part.add_tangent(&motion, Weights { q, v }, blocks)))
    };
    let (mut stiffness, damping) = (tangent(1.0, 0.0), tangent(0.0, 1.0));
    let mut held = Vec::new();
    for end in &places.ends {
        let (fixed, along) = held_at_end(end, source.catenary.wire_ends);
        held.extend(fixed);
        stiffness.extend(along.map(|index| (index as u32, index as u32, HOLDING_STIFFNESS)));
    }
    let mass = Blocks::collect(|blocks| line.forces(&mut |part| part.add_mass(blocks)));
    let matrix = |entries| SparseMatrix::from_entries(size, entries);
    let (mut stiffness, mut damping, mut mass) = (matrix(stiffness), matrix(damping), matrix(mass));
    let layers = EndLayers::eliminate(&places.layers.concat(), [&mut stiffness, &mut damping, &mut mass]);
    let wires = line.wires().iter().map(Wire::geometry);
    let mut axes = vec![None; size];
    for map in wires.flat_map(|wire| wire.nodes()).map(|node| node.map) {
        for axis in 0..3 {
            for index in [map.position(axis), map.slope(axis)].into_iter().flatten() {
                axes[index] = Some(axis);
            }
        }
    }
    SpanMatrices {
        places,
        axes,
        elongations: Elongations::new(line.droppers().gradients(&motion).take(elongations)),
        layers,
        held,
        stiffness,
        damping,
        mass,
    }
}
