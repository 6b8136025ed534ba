//! Changes of an erected line, all unstressed lengths kept.
use super::nodal_displacement::settle;
use super::tensioned_ends::{TensionedEnd, TensionedEnds};
use super::{EndReport, Standalone, StaticsError};
use crate::line::Equilibrium;
use crate::{DropperPlace, Line, Topology, WireGeometry};
use dynamics::Layout;
use scene::{Catenary, Change, DropperChange};
use std::sync::Arc;

/// A line after its changes.
pub(super) struct Changed {
    pub topology: Arc<Topology>,
    pub equilibrium: Equilibrium,
    /// Newton iterations.
    pub iterations: usize,
    /// Ends under tensioning devices; empty where the ends are fixed.
    pub ends: Vec<EndReport>,
    /// True where friction or a stop holds an end, which then stays where it is while pantographs pass.
    pub held: bool,
}

/// Rounds in which ends begin to slide, come to a stop or leave it.
const MOST_ROUNDS: usize = 12;

/// Warms and loads the erected line `equilibrium`, changes its droppers, and lets it come to rest.
///
/// ```text
/// L₀′ = L₀ (1 + α Δθ)        every unstressed length, α thermal expansion, Δθ temperature above that of the erection
/// ```
///
/// Between fixed ends the tension of a straight wire changes by `−EA α Δθ`; under tensioning weights the ends travel by
/// `α Δθ L`. Ice adds to mass and weight of the wires. The line goes through the temperatures in turn, each an
/// equilibrium, because friction of the devices keeps what came before.
pub(super) fn change(
    (catenary, topology): (&Catenary, &Arc<Topology>),
    erected: &Equilibrium,
    change: &Change,
) -> Result<Changed, StaticsError> {
    let of = |place: &DropperPlace| {
        let here = |at: &&DropperChange| {
            at.tension_length == place.section + 1 && at.span == place.span && at.dropper == place.position + 1
        };
        change.droppers.iter().find(here)
    };
    let missing = |place: &DropperPlace| of(place).is_some_and(|change| change.missing);
    let iced = |wire: &crate::PlannedWire| scene::Wire {
        mass_per_length: wire.parameters.mass_per_length + catenary.ice_on(wire.name.kind()),
        ..wire.parameters
    };
    let changed = Arc::new(topology.with_droppers(|place| !missing(place)).with_parameters(iced));
    let mut ends = TensionedEnds::of(catenary, &changed, erected);
    let mut now = erected.clone();
    let mut iterations = 0;
    for &temperature in &change.temperature {
        let growth = 1.0 + change.thermal_expansion * temperature;
        let droppers = topology.droppers().iter().zip(&erected.dropper_lengths);
        let droppers = droppers.filter(|(place, _)| !missing(place));
        now.dropper_lengths = droppers
            .map(|(place, length)| length * growth + of(place).map_or(0.0, |change| change.longer_by))
            .collect();
        let lengths = |wire: &WireGeometry| wire.lengths().iter().map(|length| length * growth).collect();
        let wires = now.wires.iter().zip(&erected.wires);
        now.wires = wires
            .map(|(wire, erected)| wire.with_lengths(lengths(erected)))
            .collect();
        ends.hold();
        for round in 0.. {
            let (equilibrium, more) = rest((catenary, &changed), &now, &mut ends)?;
            iterations += more;
            now = equilibrium;
            if !ends.go_on() {
                break;
            }
            if round == MOST_ROUNDS {
                return Err(StaticsError::EndsDoNotSettle { temperature });
            }
            now.wires = ends.at_stops(&now.wires);
        }
    }
    Ok(Changed {
        topology: changed,
        equilibrium: now,
        iterations,
        held: ends.are_held(),
        ends: ends.reports(),
    })
}

/// Equilibrium with the ends as they are held and pulled, and the number of Newton iterations; tells the ends where
/// they came to and their tension.
fn rest(
    (catenary, topology): (&Catenary, &Arc<Topology>),
    start: &Equilibrium,
    ends: &mut TensionedEnds,
) -> Result<(Equilibrium, usize), StaticsError> {
    let mut layout = Layout::new();
    let coordinates = topology.register(&mut layout);
    topology.fix_ends(&coordinates, catenary.wire_ends, &mut layout);
    ends.fix(&mut layout);
    let line = |equilibrium: &Equilibrium| {
        let mut line = Line::new(catenary, topology, equilibrium, 0);
        for TensionedEnd { index, force, .. } in ends.sliding() {
            line.pull_end(index, force);
        }
        line
    };
    let system = Standalone {
        line: line(start),
        layout,
        load: Default::default(),
    };
    let state = system.layout.state_at_rest();
    let (equilibrium, iterations) = settle(topology, start, system, state.clone(), &line)?;
    ends.see(&line(&equilibrium), &state);
    Ok((equilibrium, iterations))
}
