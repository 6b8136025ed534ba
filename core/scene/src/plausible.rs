//! Values that no line has: most often a slip in the unit or a forgotten entry.
//!
//! A value that cannot be meant is refused; one that a real line merely does not have is questioned and runs.

use crate::check::{Found, entry_of, refuse};
use crate::write::shown_number;
use crate::{Scene, Section, Wire};

/// Highest contact wire, m: above any road crossing or double-stack clearance, and below a height typed in cm.
pub(crate) const HIGHEST_WIRE: f64 = 20.0;
/// Heights that contact wires have, m.
const USUAL_HEIGHTS: std::ops::RangeInclusive<f64> = 3.0..=9.0;
/// Least tension, N: below that of any wire, and above a tension typed in kN.
pub(crate) const LEAST_TENSION: f64 = 100.0;
/// Longest part of a span without a dropper that is not questioned, m; lines have one every 4 to 12 m.
const LONGEST_GAP: f64 = 15.0;

impl Section<'_> {
    /// Refuses heights that were typed in another unit.
    pub(crate) fn check_units(&self, path: &str, found: &mut Found) {
        let heights = &self.contact_wire_height;
        for (i, &height) in heights.iter().enumerate() {
            if height <= HIGHEST_WIRE {
                continue;
            }
            let meant = [("mm", 1e-3), ("cm", 1e-2)].into_iter().find_map(|(unit, factor)| {
                let meters = (1e6 * height * factor).round() / 1e6;
                USUAL_HEIGHTS
                    .contains(&meters)
                    .then(|| format!("; {height} {unit} are {meters} m"))
            });
            let expected = format!(
                "must be at most {HIGHEST_WIRE} m above the top of rail{}",
                meant.unwrap_or_default()
            );
            let key = entry_of(&format!("{path}.contact_wire_height"), heights, i);
            refuse(found, key, shown_number(height, "m"), expected);
        }
    }
}

impl Wire {
    /// Refuses a tension that was typed in kN.
    pub(crate) fn check_unit_of_tension(&self, path: &str, found: &mut Found) {
        let tension = self.tension;
        if tension < LEAST_TENSION {
            let meant = if tension >= 1.0 {
                format!("; {tension} kN are {} N", 1e3 * tension)
            } else {
                String::new()
            };
            let expected = format!("must be at least {LEAST_TENSION} N for a wire to hang straight{meant}");
            refuse(found, format!("{path}.tension"), shown_number(tension, "N"), expected);
        }
    }
}

impl Scene {
    /// Questions about values that are possible but that no real line has, each with key, value, unit and the likely
    /// intention; empty for a scene without any.
    #[must_use]
    pub fn questions(&self) -> Vec<String> {
        let Some((line, _)) = self.modelled_line() else {
            return Vec::new();
        };
        let mut asked = Vec::new();
        if line.messenger_wire.is_none() {
            return asked;
        }
        let first = line.first();
        let stretches = (0..first.spans()).flat_map(|span| {
            let mut start = 0.0;
            first.intervals_of(span).map(move |length| {
                let from = start;
                start += length;
                (length, from, span)
            })
        });
        if let Some((length, from, span)) = stretches.reduce(|a, b| if b.0 > a.0 { b } else { a })
            && length > LONGEST_GAP
        {
            let short = |value: f64| (1e3 * value).round() / 1e3;
            asked.push(format!(
                "catenary.droppers.positions = {:?} m: {} m of span {}, from {} m to {} m, are without a dropper, and \
                 lines have one \
                 every 4 to 12 m; is a position missing?",
                first.droppers_of(span),
                short(length),
                span + 1,
                short(from),
                short(from + length),
            ));
        }
        asked
    }
}
