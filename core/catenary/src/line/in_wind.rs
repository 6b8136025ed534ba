//! The wind of a scene on a line.
use super::parts_in_wind::{DropperInWind, PartsInWind};
use crate::{Line, WireDrag, WireName};
use dynamics::{CrossFlow, PartVisitor, SectionFlow, SlenderFlow, Wind};
use scene::{Scene, WireKind};
use std::sync::Arc;

/// The wind on wires, droppers and registration arms.
#[derive(Clone, Debug)]
pub struct WindOnLine {
    wind: Arc<Wind>,
    contact_wire: SlenderFlow,
    messenger_wire: SlenderFlow,
    stitch_wires: SlenderFlow,
    /// None where droppers feel no wind.
    droppers: Option<CrossFlow>,
    /// `½ ρ C_D A` of a registration arm, N s²/m².
    arms: f64,
}

impl WindOnLine {
    /// Wind of a scene on its line; none for a scene without wind on wires.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Option<Self> {
        let table = scene.wind.as_ref()?;
        let wires = table.wires.as_ref()?;
        let density = table.air_density;
        let round = |diameter: f64| CrossFlow::new(density, wires.drag_coefficient, diameter);
        // A line without messenger wire has none of the other diameters.
        let law = |wire: WireKind| -> SlenderFlow {
            let diameter = scene.diameter_in_wind(wire).unwrap_or_default();
            match wires.polar(wire) {
                Some(polar) => SectionFlow::new(density, diameter, polar.polar()).into(),
                None => round(diameter).into(),
            }
        };
        Some(Self {
            wind: Arc::new(scene.wind_field()?),
            contact_wire: law(WireKind::Contact),
            messenger_wire: law(WireKind::Messenger),
            stitch_wires: law(WireKind::Stitch),
            droppers: wires.dropper_diameter.map(round),
            arms: 0.5 * density * wires.registration_arm_drag_area,
        })
    }

    /// The mean wind alone.
    #[must_use]
    pub fn steady(&self) -> Self {
        Self {
            wind: Arc::new(Wind::uniform(self.wind.mean)),
            ..self.clone()
        }
    }

    /// Forces of the air on a line.
    pub(crate) fn on(&self, line: &Line) -> AirOnLine {
        let wires = line.topology().wires().iter().zip(line.wires());
        let drag = wires.map(|(planned, wire)| {
            let law = match planned.name {
                WireName::ContactWire => &self.contact_wire,
                WireName::MessengerWire => &self.messenger_wire,
                WireName::StitchWire => &self.stitch_wires,
            };
            WireDrag::new(Arc::clone(wire.geometry()), law.clone(), Arc::clone(&self.wind))
        });
        let droppers = line.droppers().as_slice().iter().filter_map(|dropper| {
            Some(DropperInWind {
                ends: [dropper.lower, dropper.upper],
                flow: self.droppers?,
            })
        });
        let arms = line.registration_arms().as_slice().iter().map(|arm| arm.node);
        let arms = arms.filter(|_| self.arms > 0.0);
        AirOnLine {
            wires: drag.collect(),
            parts: PartsInWind::new(Arc::clone(&self.wind), droppers.collect(), (arms.collect(), self.arms)),
        }
    }
}

/// Forces of the air on the parts of one line; none without wind.
#[derive(Clone, Debug, Default)]
pub(crate) struct AirOnLine {
    wires: Vec<WireDrag>,
    parts: PartsInWind,
}

impl AirOnLine {
    /// Visits every contribution.
    pub fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        for drag in &mut self.wires {
            visit("wind_wires", drag);
        }
        if !self.parts.is_empty() {
            visit("wind_wires", &mut self.parts);
        }
    }
}
