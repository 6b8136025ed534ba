//! Pictures of line and pantographs.

use catenary::{OverheadLine, WireName};
use component::{DropperLine, Frame};
use dynamics::Motion;

/// Points that a drawn wire has at most: about two per metre of a screen's width.
const WIRE_POINTS: usize = 240;

/// Adds wires and droppers to a picture.
pub fn draw_wires(line: &dyn OverheadLine, motion: &Motion<'_>, frame: &mut Frame) {
    frame.further_wires.clear();
    for name in [WireName::ContactWire, WireName::MessengerWire, WireName::StitchWire] {
        let wires = line.polylines(name, motion.q, WIRE_POINTS);
        let mut points = wires.iter().map(|wire| wire.iter().map(|r| (r.x, r.z)).collect());
        match name {
            WireName::ContactWire => frame.contact_wire = points.next().unwrap_or_default(),
            WireName::MessengerWire => frame.messenger_wire = points.next().unwrap_or_default(),
            WireName::StitchWire => {}
        }
        let further = points.map(|wire| (name == WireName::ContactWire, wire));
        frame.further_wires.extend(further);
    }
    frame.droppers = line
        .dropper_samples(motion)
        .iter()
        .map(|dropper| DropperLine {
            top: (dropper.top.x, dropper.top.z),
            bottom: (dropper.bottom.x, dropper.bottom.z),
            slack: dropper.force <= 0.0,
        })
        .collect();
}

/// Adds a pantograph to a picture.
pub fn draw_outline(pantograph: &vehicle::PantographModel, motion: &Motion<'_>, frame: &mut Frame) {
    let outline = pantograph.outline(motion);
    frame.pantographs.push(
        outline
            .iter()
            .map(|line| line.iter().map(|r| (r.x, r.z)).collect())
            .collect(),
    );
}
