//! `[catenary.change.ice]`: ice about the wires.
use crate::check::Found;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::{Catenary, WireKind};
use std::f64::consts::PI;

/// Glaze, the densest ice [ISO 12494], kg/m³.
const GLAZE: f64 = 900.0;
/// Soft rime, and ice without air [ISO 12494], kg/m³.
const LIGHTEST: f64 = 50.0;
const SOLID: f64 = 917.0;
/// Thickest ice, m.
const THICKEST: f64 = 0.2;

/// Ice of the same thickness all around a wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ice {
    /// Density, kg/m³.
    pub density: f64,
    /// Radial thickness on the contact wire, m.
    pub contact_wire: f64,
    /// Radial thickness on the messenger wire, m.
    pub messenger_wire: f64,
    /// Radial thickness on the stitch wires, m.
    pub stitch_wires: f64,
}

impl Ice {
    /// Radial thickness on a wire, m.
    #[must_use]
    pub fn thickness(&self, wire: WireKind) -> f64 {
        match wire {
            WireKind::Contact => self.contact_wire,
            WireKind::Messenger => self.messenger_wire,
            WireKind::Stitch => self.stitch_wires,
        }
    }

    /// Mass per length on a wire of this diameter (m), kg/m.
    ///
    /// ```text
    /// m = π ρ t (d + t)
    /// ```
    #[must_use]
    pub fn mass_per_length(&self, wire: WireKind, diameter: f64) -> f64 {
        let thickness = self.thickness(wire);
        PI * self.density * thickness * (diameter + thickness)
    }
}

impl Catenary {
    /// Mass of the ice on a wire, kg/m.
    #[must_use]
    pub fn ice_on(&self, wire: WireKind) -> f64 {
        let Some(change) = &self.change else { return 0.0 };
        let about = |ice: Ice| ice.mass_per_length(wire, self.diameter(wire).unwrap_or_default());
        change.ice_per_length + change.ice.map_or(0.0, about)
    }

    /// Diameter of a wire without ice, m; none where the scene has none.
    #[must_use]
    pub fn diameter(&self, wire: WireKind) -> Option<f64> {
        let found = match wire {
            WireKind::Contact => Some(&self.contact_wire),
            WireKind::Messenger => self.messenger_wire.as_ref(),
            WireKind::Stitch => self.stitch_wires.as_ref().map(|stitch| &stitch.wire),
        };
        found?.diameter
    }

    /// Ice needs the diameters of the wires that bear it.
    pub(crate) fn check_ice(&self, found: &mut Found) {
        let Some(change) = &self.change else { return };
        let Some(ice) = change.ice else { return };
        if change.ice_per_length > 0.0 {
            let because = "catenary.change.ice is given, whose mass it would count again".to_owned();
            found.push(("catenary.change.ice_per_length".to_owned(), What::LeaveOut { because }));
        }
        let wires = [
            (WireKind::Contact, "contact_wire", true),
            (WireKind::Messenger, "messenger_wire", self.messenger_wire.is_some()),
            (WireKind::Stitch, "stitch_wires", self.stitch_wires.is_some()),
        ];
        for (wire, name, there) in wires {
            if there && ice.thickness(wire) > 0.0 && self.diameter(wire).is_none() {
                let expected = format!("the diameter in m of the wire that bears catenary.change.ice.{name}");
                found.push((format!("catenary.{name}.diameter"), What::Missing { expected }));
            }
        }
    }
}

impl Entry for Ice {
    const SENTENCES: Sentences = &[
        (
            "thickness",
            "Radial thickness on the wires that have none of their own here.",
        ),
        ("density", "Density of the ice; glaze by default."),
        (
            "contact_wire",
            "Radial thickness on the contact wire, in place of `thickness`.",
        ),
        (
            "messenger_wire",
            "Radial thickness on the messenger wire, in place of `thickness`.",
        ),
        (
            "stitch_wires",
            "Radial thickness on the stitch wires, in place of `thickness`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let thickness = Number::between_in("m", 0.0, THICKEST);
        // Written out wire by wire.
        let all = keys.optional_number("thickness", was.map(|_| None), thickness);
        let mut of = |name: &str, was: Option<f64>| match (all, was) {
            (Some(all), None) => keys.number(name, was, thickness.default(all)),
            _ => keys.number(name, was, thickness),
        };
        Self {
            contact_wire: of("contact_wire", was.map(|ice| ice.contact_wire)),
            messenger_wire: of("messenger_wire", was.map(|ice| ice.messenger_wire)),
            stitch_wires: of("stitch_wires", was.map(|ice| ice.stitch_wires)),
            density: keys.number(
                "density",
                was.map(|ice| ice.density),
                Number::between_in("kg/m³", LIGHTEST, SOLID).default(GLAZE),
            ),
        }
    }
}
