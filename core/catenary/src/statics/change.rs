//! Changes of an erected line, all unstressed lengths kept.
use super::nodal_displacement::settle;
use super::{Standalone, StaticsError};
use crate::line::Equilibrium;
use crate::{DropperPlace, Line, Topology, WireGeometry};
use dynamics::Layout;
use scene::{Catenary, Change, DropperChange};
use std::sync::Arc;

/// Warms and loads the erected line `equilibrium`, changes its droppers, and lets it come to rest.
///
/// ```text
/// L₀′ = L₀ (1 + α Δθ)        every unstressed length, α thermal expansion, Δθ temperature above that of the erection
/// ```
///
/// Between fixed ends the tension of a straight wire changes by `−EA α Δθ`; under tensioning weights the ends travel by
/// `α Δθ L`. Ice adds to mass and weight of the wires.
///
/// Returns the changed line, its equilibrium and the number of Newton iterations.
pub(super) fn change(
    (catenary, topology): (&Catenary, &Arc<Topology>),
    erected: &Equilibrium,
    change: &Change,
) -> Result<(Arc<Topology>, Equilibrium, usize), StaticsError> {
    let of = |place: &DropperPlace| {
        let here = |at: &&DropperChange| {
            at.tension_length == place.section + 1 && at.span == place.span && at.dropper == place.position + 1
        };
        change.droppers.iter().find(here)
    };
    let missing = |place: &DropperPlace| of(place).is_some_and(|change| change.missing);
    let growth = 1.0 + change.thermal_expansion * change.temperature;
    let iced = |wire: &scene::Wire| scene::Wire {
        mass_per_length: wire.mass_per_length + change.ice_per_length,
        ..*wire
    };
    let changed = Arc::new(topology.with_droppers(|place| !missing(place)).with_parameters(iced));
    let droppers = topology.droppers().iter().zip(&erected.dropper_lengths);
    let droppers = droppers.filter(|(place, _)| !missing(place));
    let droppers = droppers.map(|(place, length)| length * growth + of(place).map_or(0.0, |change| change.longer_by));
    let lengths = |wire: &WireGeometry| wire.lengths().iter().map(|length| length * growth).collect();
    let start = Equilibrium {
        wires: erected
            .wires
            .iter()
            .map(|wire| wire.with_lengths(lengths(wire)))
            .collect(),
        dropper_lengths: droppers.collect(),
        ..erected.clone()
    };
    let mut layout = Layout::new();
    let coordinates = changed.register(&mut layout);
    changed.fix_ends(&coordinates, catenary.wire_ends, &mut layout);
    let system = Standalone {
        line: Line::new(catenary, &changed, &start, 0),
        layout,
        load: Default::default(),
    };
    let state = system.layout.state_at_rest();
    let (equilibrium, iterations) = settle((catenary, &changed), &start, system, state)?;
    Ok((changed, equilibrium, iterations))
}
