//! Contact of one strip with one of several contact wires, as outputs.
use super::{Subsystem, input_direction};
use crate::ContactPair;
use dynamics::Motion;
use nalgebra::Vector3;

/// Contact quantities of a strip and one wire at the communication point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactOfWire {
    /// Contact force, N.
    pub force: f64,
    /// Place on the wire, m; the middle of a strip that the wire does not reach over.
    pub position: Vector3<f64>,
    /// Gap, positive when open, m.
    pub gap: f64,
    /// True if wire and strip touch.
    pub closed: bool,
}

impl Subsystem {
    /// Pair of a strip and a contact wire; pairs are counted through the wires of all strips, from 0.
    fn pair(&mut self, part: usize) -> (&ContactPair, Motion<'_>) {
        let wires = self.contact_wires();
        let (model, motion) = self.simulator.parts();
        (&model.contacts_of(part / wires)[part % wires], motion)
    }

    /// Contact of a pair of strip and contact wire, counted as in [`Subsystem::pair`].
    pub(crate) fn contact_of_wire(&mut self, part: usize) -> ContactOfWire {
        let beyond = self.middle_of(part / self.contact_wires());
        let (pair, motion) = self.pair(part);
        let contact = pair.state(&motion);
        ContactOfWire {
            force: contact.map_or(0.0, |contact| contact.force),
            position: contact.map_or(beyond, |contact| contact.position()),
            gap: contact.map_or(f64::MAX, |contact| contact.gap()),
            closed: contact.is_some_and(|contact| contact.closed()),
        }
    }

    /// Derivative of the contact of a pair with respect to input `input` of its strip, states frozen.
    pub(crate) fn sensitivity_of_wire(&mut self, part: usize, input: usize) -> Option<crate::Sensitivity> {
        let (pair, motion) = self.pair(part);
        let contact = pair.state(&motion)?;
        Some(pair.sensitivity(&contact, &motion, input_direction(input)))
    }

    /// Rates of the contact of a pair along the present motion, per second.
    pub(crate) fn rates_of_wire(&mut self, part: usize) -> Option<crate::Sensitivity> {
        let (pair, motion) = self.pair(part);
        let contact = pair.state(&motion)?;
        Some(pair.rates(&contact, &motion))
    }
}
