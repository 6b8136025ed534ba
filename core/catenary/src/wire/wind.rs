//! The wind of a scene on the wires.
use crate::{Wire, WireDrag, WireName};
use dynamics::{CrossFlow, Wind};
use scene::Scene;
use std::sync::Arc;

/// The wind on the wires, stitch wires as thick as the messenger wire. Droppers and registration arms, thin or short,
/// feel none.
#[derive(Clone, Debug)]
pub struct WiresInWind {
    wind: Arc<Wind>,
    contact_wire: CrossFlow,
    messenger_wire: CrossFlow,
}

impl WiresInWind {
    /// Wind on wires with these drag laws.
    #[must_use]
    pub fn new(wind: Arc<Wind>, contact_wire: CrossFlow, messenger_wire: CrossFlow) -> Self {
        Self {
            wind,
            contact_wire,
            messenger_wire,
        }
    }

    /// Wind of a scene on its wires; none for a scene without wind.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Option<Self> {
        let table = scene.wind.as_ref()?;
        let wires = table.wires?;
        let law = |diameter: f64| CrossFlow::new(table.air_density, wires.drag_coefficient, diameter);
        Some(Self::new(
            Arc::new(scene.wind_field()?),
            law(wires.contact_wire_diameter),
            law(wires.messenger_wire_diameter),
        ))
    }

    /// Drag on one of the wires.
    pub(crate) fn on(&self, name: WireName, wire: &Wire) -> WireDrag {
        let law = match name {
            WireName::ContactWire => self.contact_wire,
            WireName::MessengerWire | WireName::StitchWire => self.messenger_wire,
        };
        WireDrag::new(Arc::clone(wire.geometry()), law, Arc::clone(&self.wind))
    }
}
