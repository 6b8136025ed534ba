//! Pictures of line and pantographs.

use catenary::{OverheadLine, WireName};
use component::{DropperLine, Frame};
use dynamics::Motion;

/// Points that a drawn wire has at most: about two per metre of a screen's width.
const WIRE_POINTS: usize = 240;

/// Adds wires and droppers to a picture.
pub fn draw_wires(line: &dyn OverheadLine, motion: &Motion<'_>, frame: &mut Frame) {
    let wire = |name: WireName| {
        let points = line.polyline(name, motion.q, WIRE_POINTS);
        points.iter().map(|r| (r.x, r.z)).collect()
    };
    frame.contact_wire = wire(WireName::ContactWire);
    frame.messenger_wire = wire(WireName::MessengerWire);
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
