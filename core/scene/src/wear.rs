//! `[wear]`: current of the pantographs, and wear of contact wire and collector strips.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::write::{shown_entries, shown_number};
use crate::{Line, Scene};

/// `[wear]`: electrical state of the contacts, and the law by which wire and strips wear.
#[derive(Clone, Debug, PartialEq)]
pub struct Wear {
    /// Current of each pantograph, A; one entry holds for all.
    pub current: Vec<f64>,
    /// Contact resistance that does not depend on the force, Ω.
    pub film_resistance: f64,
    /// Part of the contact resistance that falls with the force, at `reference_force`, Ω.
    pub constriction_resistance: f64,
    /// Exponent of the force in it, –.
    pub constriction_exponent: f64,
    /// Voltage of an arc that has no length, V.
    pub arc_voltage: f64,
    /// Voltage of an arc by its length, V/m.
    pub arc_gradient: f64,
    /// Contact force that exponents refer to, N.
    pub reference_force: f64,
    /// Current that exponents refer to, A.
    pub reference_current: f64,
    /// Length of a contact along the wire, m.
    pub contact_length: f64,
    /// Longest cell of the worn profile, m.
    pub grid: f64,
    /// Places that the wear of a passage is applied to.
    pub applied: WearApplied,
    /// Largest change of the unevenness of the profile before the line is simulated again, m.
    pub depth_step: f64,
    /// The contact wire.
    pub wire: WireWear,
    /// Collector strips; their wear is not computed without.
    pub strip: Option<StripWear>,
}

/// `[wear.wire]`.
#[derive(Clone, Debug, PartialEq)]
pub struct WireWear {
    /// Diameter of the unworn round wire, m.
    pub diameter: f64,
    /// Worn depth at the beginning, m.
    pub worn_depth: f64,
    /// Share of the section that may be lost, %.
    pub limit_percent: f64,
    /// Law of its wear.
    pub law: WearLaw,
}

/// `[wear.strip]`.
#[derive(Clone, Debug, PartialEq)]
pub struct StripWear {
    /// Size of one strip along the track, m.
    pub breadth: f64,
    /// Height that may be worn, m.
    pub limit_height: f64,
    /// Law of its wear.
    pub law: WearLaw,
}

/// Coefficients of the law of one partner. [Bucca & Collina 2009]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WearLaw {
    /// `k1`, –.
    pub mechanical_coefficient: f64,
    /// `α`, –.
    pub current_exponent: f64,
    /// `β`, –.
    pub force_exponent: f64,
    /// `k2`, –.
    pub joule_coefficient: f64,
    /// `k3`, –.
    pub arc_coefficient: f64,
    /// `H`, Pa.
    pub hardness: f64,
    /// `H_m`, heat that melts, or of carbon takes away, a mass, J/kg.
    pub melting_heat: f64,
    /// `ρ`, kg/m³.
    pub density: f64,
}

choice! {
    /// `wear.applied`.
    pub enum WearApplied {
        /// The mean of the evaluated spans, in every span of the line.
        Span = "span",
        /// Wear of the place itself; the mean of the evaluated places elsewhere.
        Place = "place",
    }
    unavailable: []
}

/// Largest diameter of a contact wire, m: a value beyond is a slip of the unit.
const THICKEST_WIRE: f64 = 0.05;

impl Entry for Wear {
    const SENTENCES: Sentences = &[
        (
            "current",
            "Current of the pantographs, one number for all or one for each; held during arcs.",
        ),
        (
            "film_resistance",
            "Contact resistance of each strip that does not depend on the force.",
        ),
        (
            "constriction_resistance",
            "Contact resistance of each strip at `reference_force` that falls with the force.",
        ),
        (
            "constriction_exponent",
            "Exponent of the force in it: 0.5 for plastic, 0.33 for elastic contact spots.",
        ),
        (
            "arc_voltage",
            "Voltage of an arc that has no length; also the largest drop of a closed contact.",
        ),
        (
            "arc_gradient",
            "Voltage of an arc by its length, the gap between wire and strip.",
        ),
        ("reference_force", "Contact force that the exponents refer to."),
        ("reference_current", "Current that the exponent refers to."),
        (
            "contact_length",
            "Length of a contact along the wire, over which a worn profile is averaged.",
        ),
        ("grid", "Longest cell of the worn profile along the wire."),
        (
            "applied",
            "Places that the wear of a passage is applied to: the mean of the evaluated spans in every span, or the \
             wear of the place itself and its mean beyond the evaluated places.",
        ),
        (
            "depth_step",
            "Largest change of the unevenness of the profile before `master wear` simulates the line again.",
        ),
        ("wire", "The contact wire."),
        (
            "strip",
            "Collector strips; their wear is not computed without this table.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let mut number = |name, value: fn(&Self) -> f64, range| keys.number(name, was.map(value), range);
        let film_resistance = number(
            "film_resistance",
            |wear| wear.film_resistance,
            Number::not_negative("Ω").default(0.0),
        );
        let constriction_resistance = number(
            "constriction_resistance",
            |wear| wear.constriction_resistance,
            Number::positive("Ω"),
        );
        let constriction_exponent = number(
            "constriction_exponent",
            |wear| wear.constriction_exponent,
            Number::between(0.0, 1.0).default(0.5),
        );
        let arc_voltage = number("arc_voltage", |wear| wear.arc_voltage, Number::positive("V"));
        let arc_gradient = number(
            "arc_gradient",
            |wear| wear.arc_gradient,
            Number::not_negative("V/m").default(0.0),
        );
        let reference_force = number("reference_force", |wear| wear.reference_force, Number::positive("N"));
        let reference_current = number(
            "reference_current",
            |wear| wear.reference_current,
            Number::positive("A"),
        );
        let contact_length = number(
            "contact_length",
            |wear| wear.contact_length,
            Number::between_in("m", 1e-3, 1.0),
        );
        let grid = number(
            "grid",
            |wear| wear.grid,
            Number::between_in("m", 0.01, 1.0).default(0.1),
        );
        let depth_step = number(
            "depth_step",
            |wear| wear.depth_step,
            Number::positive("m").default(2e-5),
        );
        Self {
            current: keys.one_or_more(
                "current",
                was.map(|wear| wear.current.as_slice()),
                Number::not_negative("A"),
            ),
            film_resistance,
            constriction_resistance,
            constriction_exponent,
            arc_voltage,
            arc_gradient,
            reference_force,
            reference_current,
            contact_length,
            grid,
            applied: keys.word("applied", was.map(|wear| wear.applied), Some(WearApplied::Span)),
            depth_step,
            wire: keys.table("wire", was.map(|wear| &wear.wire)),
            strip: keys.optional_table("strip", was.map(|wear| wear.strip.as_ref())),
        }
    }
}

impl Entry for WireWear {
    const SENTENCES: Sentences = &[
        ("diameter", "Diameter of the unworn round wire."),
        ("worn_depth", "Depth that is worn already, even along the line."),
        (
            "limit_percent",
            "Share of the section that may be lost before the wire is replaced.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            diameter: keys.number(
                "diameter",
                was.map(|wire| wire.diameter),
                Number::positive("m").at_most(THICKEST_WIRE),
            ),
            worn_depth: keys.number(
                "worn_depth",
                was.map(|wire| wire.worn_depth),
                Number::not_negative("m").default(0.0),
            ),
            limit_percent: keys.number(
                "limit_percent",
                was.map(|wire| wire.limit_percent),
                Number::between_in("%", 1.0, 50.0),
            ),
            law: keys.part(was.map(|wire| &wire.law)),
        }
    }
}

impl Entry for StripWear {
    const SENTENCES: Sentences = &[
        ("breadth", "Size of one strip along the track."),
        ("limit_height", "Height that may be worn before the strip is replaced."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            breadth: keys.number(
                "breadth",
                was.map(|strip| strip.breadth),
                Number::between_in("m", 1e-3, 0.5),
            ),
            limit_height: keys.number(
                "limit_height",
                was.map(|strip| strip.limit_height),
                Number::between_in("m", 1e-4, 0.2),
            ),
            law: keys.part(was.map(|strip| &strip.law)),
        }
    }
}

impl Entry for WearLaw {
    const SENTENCES: Sentences = &[
        ("mechanical_coefficient", "Coefficient of the mechanical wear, k1."),
        (
            "current_exponent",
            "Exponent by which a current reduces the mechanical wear, α.",
        ),
        ("force_exponent", "Exponent of the force beyond proportion, β."),
        (
            "joule_coefficient",
            "Coefficient of the wear by the heat of the contact, k2.",
        ),
        ("arc_coefficient", "Coefficient of the wear by arcs, k3."),
        ("hardness", "Hardness of the material."),
        (
            "melting_heat",
            "Heat that melts a mass of the material, or burns it off a strip of carbon.",
        ),
        ("density", "Density of the material."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let mut number = |name, value: fn(&Self) -> f64, range| keys.number(name, was.map(value), range);
        let share = || Number::not_negative("");
        Self {
            mechanical_coefficient: number("mechanical_coefficient", |law| law.mechanical_coefficient, share()),
            current_exponent: number("current_exponent", |law| law.current_exponent, share()),
            force_exponent: number("force_exponent", |law| law.force_exponent, share()),
            joule_coefficient: number("joule_coefficient", |law| law.joule_coefficient, share()),
            arc_coefficient: number("arc_coefficient", |law| law.arc_coefficient, share()),
            hardness: number("hardness", |law| law.hardness, Number::between_in("Pa", 1e6, 1e12)),
            melting_heat: number(
                "melting_heat",
                |law| law.melting_heat,
                Number::between_in("J/kg", 1e4, 1e9),
            ),
            density: number("density", |law| law.density, Number::between_in("kg/m³", 100.0, 3e4)),
        }
    }
}

impl Wear {
    /// Current of pantograph `index` (from 0), A.
    #[must_use]
    pub fn current_of(&self, index: usize) -> f64 {
        let one = self.current.first().copied().unwrap_or_default();
        self.current.get(index).copied().unwrap_or(one)
    }
}

impl Scene {
    /// Checks wear against pantographs and line.
    pub(crate) fn check_wear(&self, found: &mut Found) {
        let Some(wear) = &self.wear else { return };
        let (currents, heads) = (wear.current.len(), self.pantographs.len());
        if currents != 1 && currents != heads {
            let expected = format!("must be one number, or {heads}, one for each pantograph");
            refuse(found, "wear.current", shown_entries(currents), expected);
        }
        let wire = &wear.wire;
        if wire.diameter > THICKEST_WIRE {
            let expected = format!("must be at most {THICKEST_WIRE} m, beyond any contact wire");
            refuse(found, "wear.wire.diameter", shown_number(wire.diameter, "m"), expected);
        } else if wire.worn_depth >= 0.5 * wire.diameter {
            let expected = format!(
                "must be less than {} m, half of wear.wire.diameter",
                0.5 * wire.diameter
            );
            refuse(
                found,
                "wear.wire.worn_depth",
                shown_number(wire.worn_depth, "m"),
                expected,
            );
        }
        let Line::Modelled(line) = &self.catenary else { return };
        let one = match line.tension_lengths.as_slice() {
            [one] => one.span_lengths.windows(2).all(|pair| pair[0] == pair[1]),
            _ => false,
        };
        if wear.applied == WearApplied::Span && !one {
            let expected = "must be \"place\" on a line of several tension lengths or of spans of several lengths, \
                            which have no span in common";
            refuse(found, "wear.applied", "\"span\"", expected);
        }
    }
}
