//! A strip on all contact wires together.
use super::{ContactState, Sensitivity};
use nalgebra::Vector3;

/// Sum of the contacts of one strip with all contact wires.
///
/// The place of the sum is that of the resultant: the mean of the places of the contacts, weighted with their forces,
/// so that the sum has the moment of its parts about the strip's middle. Without a force the place is that of the wire
/// with the smallest gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactTotal {
    /// Sum of the contact forces, N.
    pub force: f64,
    /// Sum of the forces on the strip, N.
    pub on_strip: Vector3<f64>,
    /// Place on the wires, m.
    pub position: Vector3<f64>,
    /// Vertical velocity of the wires there, m/s.
    pub wire_vz: f64,
    /// Smallest gap, m.
    pub gap: f64,
    /// True if any wire touches the strip.
    pub closed: bool,
}

impl ContactTotal {
    /// Sum of the contacts with those wires that reach over the strip; `None` where none does.
    pub fn of(states: impl Iterator<Item = ContactState>) -> Option<Self> {
        states.map(|state| Self::single(&state)).reduce(|a, b| a.and(&b))
    }

    fn single(contact: &ContactState) -> Self {
        Self {
            force: contact.force,
            on_strip: contact.force_on_strip(),
            position: contact.position(),
            wire_vz: contact.wire_velocity().z,
            gap: contact.gap(),
            closed: contact.closed(),
        }
    }

    fn and(&self, other: &Self) -> Self {
        let force = self.force + other.force;
        let place = if force > 0.0 {
            other.force / force
        } else {
            f64::from(u8::from(other.gap < self.gap))
        };
        // Exact at both ends, so that a wire without force changes nothing.
        let mean = |a: f64, b: f64| if place == 0.0 { a } else { a + (b - a) * place };
        Self {
            force,
            on_strip: self.on_strip + other.on_strip,
            position: self.position.zip_map(&other.position, mean),
            wire_vz: mean(self.wire_vz, other.wire_vz),
            gap: self.gap.min(other.gap),
            closed: self.closed || other.closed,
        }
    }

    /// Change of the sum from the changes of its parts.
    pub fn change(parts: impl Iterator<Item = (ContactState, Sensitivity)> + Clone) -> Option<Sensitivity> {
        let total = Self::of(parts.clone().map(|(state, _)| state))?;
        let nearest = parts.clone().min_by(|a, b| a.0.gap().total_cmp(&b.0.gap()))?;
        let mut sum = Sensitivity {
            force: 0.0,
            force_on_strip: Vector3::zeros(),
            gap: nearest.1.gap,
            position: Vector3::zeros(),
            velocity: Vector3::zeros(),
        };
        for (state, change) in parts {
            sum.force += change.force;
            sum.force_on_strip += change.force_on_strip;
            if total.force > 0.0 {
                let share = state.force / total.force;
                let gained = change.force / total.force;
                sum.position += share * change.position + gained * (state.position() - total.position);
                let ahead = state.wire_velocity() - Vector3::z() * total.wire_vz;
                sum.velocity += share * change.velocity + gained * ahead;
            }
        }
        // Without a force, the place is that of the nearest wire.
        if total.force <= 0.0 {
            (sum.position, sum.velocity) = (nearest.1.position, nearest.1.velocity);
        }
        Some(sum)
    }
}
