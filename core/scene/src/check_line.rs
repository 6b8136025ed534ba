//! Checks of a line across its keys.

use crate::check::{Found, LONGEST_SPAN, ROUNDING, entry_of, refuse};
use crate::error::What;
use crate::write::{shown_entries, shown_number};
use crate::{Catenary, Element, Section, Statics};

/// Shortest distance of droppers and clamps from each other and from supports, m: less than their clamps need, and so
/// short that the elements between them are too stiff for the statics to close to their tolerance.
const SHORTEST_INTERVAL: f64 = 0.1;

fn missing(found: &mut Found, key: String, expected: &str) {
    let expected = expected.to_owned();
    found.push((key, What::Missing { expected }));
}

impl Catenary {
    /// Path of the keys of tension length `number` (from 0).
    pub(crate) fn key_of(&self, number: usize) -> String {
        match self.tension_lengths.len() {
            1 => "catenary".to_owned(),
            _ => format!("catenary.tension_length[{}]", number + 1),
        }
    }

    pub(crate) fn check(&self, found: &mut Found) {
        self.contact_wire.check("catenary.contact_wire", found);
        if let Some(wire) = &self.messenger_wire {
            wire.check("catenary.messenger_wire", found);
        }
        self.check_beam(found);
        self.check_stitch_wires(found);
        for (number, section) in self.sections().enumerate() {
            section.check(&self.key_of(number), found);
        }
        self.check_division(found);
        self.check_dropper_lengths(found);
        self.check_several(found);
        self.check_overlaps(found);
        self.check_changes(found);
        self.check_ice(found);
        self.check_tensioning(found);
    }

    fn check_several(&self, found: &mut Found) {
        let begins = self
            .tension_lengths
            .iter()
            .map(|line| line.start_x)
            .fold(f64::INFINITY, f64::min);
        if begins != 0.0 {
            let expected = "must be 0 for the tension length that the line begins with";
            let key = format!("{}.start_x", self.key_of(0));
            refuse(found, key, shown_number(begins, "m"), expected);
        }
        let several = self.contact_wires() > 1;
        if several && self.mesh.element == Element::Beam {
            let expected = "must be \"cable\" on a line with several contact wires";
            refuse(found, "catenary.mesh.element", "\"beam\"", expected);
        }
        let plain = self.tension_lengths.len() == 1 && self.stitch_wires.is_none() && self.messenger_wire.is_some();
        if !plain && self.statics == Statics::NodalDisplacement {
            let expected = "must be \"form_finding\" on a line with stitch wires, several tension lengths or a single \
                            wire: lengths are found for it and cannot be given";
            refuse(found, "catenary.statics", "\"nodal_displacement\"", expected);
        }
    }

    fn check_stitch_wires(&self, found: &mut Found) {
        let Some(stitch) = &self.stitch_wires else {
            return;
        };
        stitch.wire.check("catenary.stitch_wires", found);
        if stitch.wire.beam.is_some() {
            let expected = "must be left out: stitch wires are of cable elements";
            refuse(found, "catenary.stitch_wires.beam", "{ … }", expected);
        }
        match &self.messenger_wire {
            None => {
                let because = "there is no messenger_wire to clamp them to".to_owned();
                found.push(("catenary.stitch_wires".to_owned(), What::LeaveOut { because }));
            }
            Some(messenger) if stitch.wire.tension >= messenger.tension => {
                let expected = format!(
                    "must be below catenary.messenger_wire.tension = {} N, which it is taken off between the clamps",
                    messenger.tension
                );
                let value = shown_number(stitch.wire.tension, "N");
                refuse(found, "catenary.stitch_wires.tension", value, expected);
            }
            Some(_) => {}
        }
    }

    fn check_dropper_lengths(&self, found: &mut Found) {
        let Some(lengths) = &self.droppers.lengths else {
            return;
        };
        let key = "catenary.droppers.lengths";
        let shown = |lengths: &[Vec<f64>]| match lengths {
            [lengths] => format!("{lengths:?} m"),
            all => format!("{all:?} m"),
        };
        if self.statics == Statics::FormFinding {
            let expected = "must be left out with catenary.statics = \"form_finding\", which finds the lengths itself";
            refuse(found, key, shown(lengths), expected);
        } else if lengths.len() != self.droppers.positions.len() {
            let expected = format!(
                "has {} lists, must have {}, one per list of positions",
                lengths.len(),
                self.droppers.positions.len()
            );
            refuse(found, key, shown(lengths), expected);
        } else {
            for (i, (lengths, positions)) in lengths.iter().zip(&self.droppers.positions).enumerate() {
                if lengths.len() != positions.len() {
                    let expected = format!(
                        "has {}, must have {}, one per position",
                        shown_entries(lengths.len()),
                        positions.len()
                    );
                    let key = entry_of(key, &self.droppers.positions, i);
                    refuse(found, key, format!("{lengths:?} m"), expected);
                }
            }
        }
    }

    /// The contact wire has what its elements need and nothing else.
    fn check_beam(&self, found: &mut Found) {
        let (key, shown) = ("catenary.contact_wire.beam", |given: bool| {
            if given { "{ … }" } else { "left out" }.to_owned()
        });
        let given = self.contact_wire.beam.is_some();
        match self.mesh.element {
            Element::Cable if given => {
                let expected =
                    "must be left out with catenary.mesh.element = \"cable\", which neither shears nor twists";
                refuse(found, key, shown(given), expected);
            }
            Element::Beam if !given => {
                let expected = "must be given with catenary.mesh.element = \"beam\": { shear_stiffness = … N, \
                                torsional_stiffness = … N m², rotary_inertia = … kg m }";
                refuse(found, key, shown(given), expected);
            }
            Element::Cable | Element::Beam => {}
        }
        if self.mesh.element == Element::Beam && self.contact_wire.bending_stiffness == 0.0 {
            let expected =
                "must be greater than 0 with catenary.mesh.element = \"beam\": directors of a string have no hold";
            let key = "catenary.contact_wire.bending_stiffness";
            refuse(found, key, shown_number(0.0, "N m²"), expected);
        }
        if self.messenger_wire.is_some_and(|wire| wire.beam.is_some()) {
            let expected = "must be left out: the messenger wire is of cable elements";
            refuse(found, "catenary.messenger_wire.beam", shown(true), expected);
        }
    }
}

impl Section<'_> {
    fn check(&self, path: &str, found: &mut Found) {
        self.check_units(path, found);
        self.check_heights(path, found);
        if self.line.messenger_wire.is_some() && self.encumbrance.is_empty() {
            missing(found, format!("{path}.encumbrance"), "a positive number in m");
        } else if self.line.messenger_wire.is_none() && !self.encumbrance.is_empty() {
            let because = "a line without messenger_wire has none".to_owned();
            found.push((format!("{path}.encumbrance"), What::LeaveOut { because }));
        }
        let mut lengths = self.span_lengths.iter();
        if let Some(span) = lengths.position(|length| *length > LONGEST_SPAN) {
            let length = self.span_lengths[span];
            let expected = format!("must be at most {LONGEST_SPAN} m, each span");
            let key = format!("{path}.span_length");
            let alike = self.span_lengths.iter().all(|other| *other == length);
            let key = if alike { key } else { format!("{key}[{}]", span + 1) };
            refuse(found, key, shown_number(length, "m"), expected);
        }
        let (own, key) = if self.dropper_positions.is_empty() {
            (&self.line.droppers.positions, "catenary.droppers.positions".to_owned())
        } else {
            (&self.dropper_positions, format!("{path}.dropper_positions"))
        };
        if self.dropper_positions.is_empty() && self.line.droppers.is_none() && self.line.messenger_wire.is_some() {
            missing(
                found,
                key,
                "a list of numbers in m, at least one, or a rule, names or a table in place of it",
            );
            return;
        }
        let (lists, spans) = (own.len(), self.spans());
        if lists != 1 && lists != spans {
            let expected = format!("must be one list for all spans, or {spans}, one for each span");
            refuse(found, key, format!("{lists} lists"), expected);
            return;
        }
        for list in 0..lists {
            self.check_positions_of((&key, own), list, found);
        }
        self.check_stitch_wire(path, found);
    }

    /// The contact wire stays above the rails.
    fn check_heights(&self, path: &str, found: &mut Found) {
        for (i, &presag) in self.presag.iter().enumerate() {
            let spans = (i..self.spans()).step_by(self.presag.len());
            let heights = spans.map(|span| 0.5 * (self.height_at(span) + self.height_at(span + 1)));
            let lowest = heights.fold(f64::INFINITY, f64::min);
            if presag >= lowest {
                let expected = format!("must be less than contact_wire_height = {lowest} m");
                let key = entry_of(&format!("{path}.presag"), &self.presag, i);
                refuse(found, key, shown_number(presag, "m"), expected);
            }
        }
    }

    /// Droppers are inside their span, in order, and apart from each other and from the supports.
    fn check_positions_of(&self, (key, lists): (&str, &[Vec<f64>]), list: usize, found: &mut Found) {
        let spans = self.span_lengths.iter().skip(list).step_by(lists.len());
        let shortest = spans.copied().fold(f64::INFINITY, f64::min);
        let positions = &lists[list];
        for (i, &position) in positions.iter().enumerate() {
            let before = if i > 0 { positions[i - 1] } else { 0.0 };
            let expected = if position <= 0.0 || position >= shortest {
                format!("must be inside its span, between 0 and {shortest} m")
            } else if position <= before {
                format!("must be greater than the position before it, {before} m")
            } else if position - before < SHORTEST_INTERVAL - ROUNDING {
                let neighbour = if i > 0 { "position before it" } else { "support" };
                format!("must be at least {SHORTEST_INTERVAL} m from the {neighbour}, at {before} m")
            } else if shortest - position < SHORTEST_INTERVAL - ROUNDING {
                format!("must be at least {SHORTEST_INTERVAL} m from the support, at {shortest} m")
            } else {
                continue;
            };
            let key = format!("{}[{}]", entry_of(key, lists, list), i + 1);
            refuse(found, key, shown_number(position, "m"), expected);
        }
    }

    /// Stitch wires end inside their spans, apart from each other and from droppers.
    fn check_stitch_wire(&self, path: &str, found: &mut Found) {
        let Some(stitch) = &self.line.stitch_wires else {
            return;
        };
        for span in 0..self.spans() {
            let carried = [span, span + 1]
                .into_iter()
                .filter(|&support| self.stitch_wire_at(support).is_some());
            let needed = 0.5 * stitch.length * carried.count() as f64 + SHORTEST_INTERVAL;
            let length = self.span_lengths[span];
            if needed > length {
                let expected = format!(
                    "must be less: in span {} of {path} the halves of stitch wires need {needed} m of its {length} m",
                    span + 1
                );
                refuse(
                    found,
                    "catenary.stitch_wires.length",
                    shown_number(stitch.length, "m"),
                    expected,
                );
                return;
            }
            let of_stitch_wire: Vec<f64> = self.stitch_stations(span).iter().map(|(offset, _)| *offset).collect();
            for places in [self.messenger_attachments(span), of_stitch_wire] {
                let close = |pair: &&[f64]| pair[1] - pair[0] < SHORTEST_INTERVAL - ROUNDING;
                if let Some(pair) = places.windows(2).find(close) {
                    let expected = format!(
                        "must leave {SHORTEST_INTERVAL} m between a clamp and the droppers: in span {} of {path} two \
                         are {:.3} m apart",
                        span + 1,
                        pair[1] - pair[0]
                    );
                    let value = shown_number(stitch.length, "m");
                    refuse(found, "catenary.stitch_wires.length", value, expected);
                    return;
                }
            }
        }
    }
}
