//! Changes of an erected line, masses and the running surface: `[catenary.change]`, `[[catenary.point_mass]]`,
//! `[catenary.surface]`.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Length, Number, Sentences};
use crate::write::shown_number;
use crate::{Catenary, Ice, Statics};

/// `[catenary.change]`: what happens to the erected line, all unstressed lengths kept; the line runs in the equilibrium
/// that follows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Temperatures above that of the erection that the line went through in turn, K; the line runs at the last one.
    pub temperature: Vec<f64>,
    /// Linear thermal expansion of the wires, 1/K.
    pub thermal_expansion: f64,
    /// Ice on each wire, kg/m.
    pub ice_per_length: f64,
    /// `[catenary.change.ice]`: ice by its thickness, in place of that.
    pub ice: Option<Ice>,
    /// Droppers that are not as they were found or given.
    pub droppers: Vec<DropperChange>,
}

/// `[[catenary.change.dropper]]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropperChange {
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Span of the tension length, from 1.
    pub span: usize,
    /// Number within the span, from 1.
    pub dropper: usize,
    /// True for a dropper that is broken or was left out.
    pub missing: bool,
    /// Excess of the unstressed length, m; negative for a dropper that is too short.
    pub longer_by: f64,
}

/// `[[catenary.point_mass]]`: a section insulator, splice or feeder clamp on a wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// The wire.
    pub wire: MassOn,
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Place along the track, m.
    pub x: f64,
    /// kg; of a twin contact wire on each wire.
    pub mass: f64,
}

choice! {
    /// `catenary.point_mass.wire`.
    pub enum MassOn {
        /// The contact wire.
        ContactWire = "contact_wire",
        /// The messenger wire.
        MessengerWire = "messenger_wire",
    }
    unavailable: []
}

/// `[catenary.surface]`: height of the running surface of the contact wires against an even one, from wear, kinks and
/// clamps.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Places along the track, m, ascending.
    pub x: Vec<f64>,
    /// Height of the surface above the even one there, m; worn places are positive, the strip rises into them.
    pub height: Vec<f64>,
}

impl Catenary {
    pub(crate) fn check_changes(&self, found: &mut Found) {
        for (index, point) in self.point_masses.iter().enumerate() {
            let path = format!("catenary.point_mass[{}]", index + 1);
            let Some(line) = self.numbered(point.tension_length, &path, found) else {
                continue;
            };
            let (start, end) = (line.support_x(0), line.support_x(line.spans()));
            if point.x <= start || point.x >= end {
                let expected = format!("must be inside its tension length, between {start} and {end} m");
                refuse(found, format!("{path}.x"), shown_number(point.x, "m"), expected);
            }
            if point.wire == MassOn::MessengerWire && self.messenger_wire.is_none() {
                let expected = "must be \"contact_wire\": the line has no messenger_wire";
                refuse(found, format!("{path}.wire"), "\"messenger_wire\"", expected);
            }
        }
        let Some(change) = &self.change else { return };
        if self.statics == Statics::NodalDisplacement {
            let because = "catenary.statics = \"nodal_displacement\" gives the changed lengths themselves".to_owned();
            found.push(("catenary.change".to_owned(), What::LeaveOut { because }));
        }
        for (index, dropper) in change.droppers.iter().enumerate() {
            let path = format!("catenary.change.dropper[{}]", index + 1);
            if self.numbered(dropper.tension_length, &path, found).is_none() {
                continue;
            }
            let section = self.section(dropper.tension_length - 1);
            if dropper.span > section.spans() {
                let expected = format!("must be from 1 to {}, the spans of its tension length", section.spans());
                refuse(found, format!("{path}.span"), dropper.span.to_string(), expected);
                continue;
            }
            let count = section.droppers_of(dropper.span - 1).len();
            if dropper.dropper > count {
                let expected = format!("must be from 1 to {count}, the droppers of span {}", dropper.span);
                refuse(found, format!("{path}.dropper"), dropper.dropper.to_string(), expected);
            }
            if dropper.missing && dropper.longer_by != 0.0 {
                let because = "missing = true leaves nothing to be longer".to_owned();
                found.push((format!("{path}.longer_by"), What::LeaveOut { because }));
            }
            if !dropper.missing && dropper.longer_by == 0.0 {
                let expected = "missing = true, or longer_by in m".to_owned();
                found.push((path, What::Missing { expected }));
            }
        }
    }

    /// The tension length of a number (from 1), which is refused where there is none.
    fn numbered(&self, number: usize, path: &str, found: &mut Found) -> Option<&crate::TensionLength> {
        let line = self.tension_lengths.get(number - 1);
        if line.is_none() {
            let expected = format!("must be from 1 to {}", self.tension_lengths.len());
            refuse(found, format!("{path}.tension_length"), number.to_string(), expected);
        }
        line
    }
}

/// Copper [EN 50149].
const EXPANSION: f64 = 1.7e-5;
/// Most entries that a number of a span or dropper may name.
const MOST: usize = 5000;

impl Entry for Change {
    const SENTENCES: Sentences = &[
        (
            "temperature",
            "Temperature above that of the erection, or those that the line went through in turn, the last one that of \
             the run: with friction of the tensioning devices the way there matters.",
        ),
        ("thermal_expansion", "Linear thermal expansion of the wires."),
        ("ice_per_length", "Ice on each wire."),
        ("ice", "Ice by its thickness, in place of `ice_per_length`."),
        ("dropper", "Droppers that are missing, too long or too short."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            temperature: keys.one_or_more(
                "temperature",
                was.map(|change| change.temperature.as_slice()),
                Number::any("K").default(0.0),
            ),
            thermal_expansion: keys.number(
                "thermal_expansion",
                was.map(|change| change.thermal_expansion),
                Number::not_negative("1/K").default(EXPANSION),
            ),
            ice_per_length: keys.number(
                "ice_per_length",
                was.map(|change| change.ice_per_length),
                Number::not_negative("kg/m").default(0.0),
            ),
            ice: keys.optional_inline_table("ice", was.map(|change| change.ice.as_ref())),
            droppers: keys.any_tables("dropper", was.map(|change| change.droppers.as_slice())),
        }
    }
}

impl Entry for DropperChange {
    const SENTENCES: Sentences = &[
        ("tension_length", "Tension length, from 1."),
        ("span", "Span of the tension length, from 1."),
        ("dropper", "Number within the span, from 1."),
        ("missing", "True for a dropper that is broken or was left out."),
        (
            "longer_by",
            "Excess of the unstressed length; negative for a dropper that is too short.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            tension_length: keys.count(
                "tension_length",
                was.map(|dropper| dropper.tension_length),
                1..=MOST,
                Some(1),
            ),
            span: keys.count("span", was.map(|dropper| dropper.span), 1..=MOST, None),
            dropper: keys.count("dropper", was.map(|dropper| dropper.dropper), 1..=MOST, None),
            missing: keys.flag("missing", was.map(|dropper| dropper.missing), false),
            longer_by: keys.number(
                "longer_by",
                was.map(|dropper| dropper.longer_by),
                Number::any("m").default(0.0),
            ),
        }
    }
}

impl Entry for PointMass {
    const SENTENCES: Sentences = &[
        ("wire", "Wire that carries the mass."),
        ("tension_length", "Tension length, from 1."),
        ("x", "Place along the track."),
        ("mass", "Mass; of a twin contact wire on each wire."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            wire: keys.word("wire", was.map(|point| point.wire), Some(MassOn::ContactWire)),
            tension_length: keys.count(
                "tension_length",
                was.map(|point| point.tension_length),
                1..=MOST,
                Some(1),
            ),
            x: keys.number("x", was.map(|point| point.x), Number::any("m")),
            mass: keys.number("mass", was.map(|point| point.mass), Number::positive("kg")),
        }
    }
}

impl Entry for Surface {
    const SENTENCES: Sentences = &[
        (
            "x",
            "Places along the track, ascending; between them the surface is a smooth curve.",
        ),
        (
            "height",
            "Height of the running surface of the contact wires above an even one there; positive where it is worn.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let x = keys.numbers(
            "x",
            was.map(|surface| surface.x.as_slice()),
            Number::any("m"),
            Length::NotEmpty,
        );
        if x.windows(2).any(|pair| pair[0] >= pair[1]) {
            keys.refuse("x", "must ascend");
        }
        let height = keys.numbers(
            "height",
            was.map(|surface| surface.height.as_slice()),
            Number::any("m"),
            Length::Exactly(x.len()),
        );
        Self { x, height }
    }
}
