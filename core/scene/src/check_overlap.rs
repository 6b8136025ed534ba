//! Checks of places where one tension length follows another.

use crate::check::{Found, ROUNDING, entry_of, refuse};
use crate::write::shown_number;
use crate::{Catenary, Section};

/// Largest difference in height over which a strip passes from one contact wire at rest to another, m: as far as
/// strips lift a wire.
pub(crate) const REACH: f64 = 0.1;

impl Catenary {
    /// Every place of the line has a wire, and a strip comes from each wire to the next.
    pub(crate) fn check_overlaps(&self, found: &mut Found) {
        let mut reach = 0.0_f64;
        let mut sections: Vec<(usize, Section<'_>)> = self.sections().enumerate().collect();
        sections.sort_by(|a, b| a.1.start_x.total_cmp(&b.1.start_x));
        for (number, section) in sections {
            let (start, end) = (section.start_x, section.end_x());
            if start > reach + ROUNDING {
                let expected = format!(
                    "must be at most {reach} m, where the tension length before it ends: strips need a wire everywhere"
                );
                let key = format!("{}.start_x", self.key_of(number));
                refuse(found, key, shown_number(start, "m"), expected);
                return;
            }
            self.check_end((number, section, 0), found);
            self.check_end((number, section, section.spans()), found);
            reach = reach.max(end);
        }
    }

    /// Refuses a contact wire that is out of reach below all others where its tension length begins or ends within the
    /// line, at its support `support` (from 0): a strip on it would lose it.
    fn check_end(&self, (number, section, support): (usize, Section<'_>, usize), found: &mut Found) {
        let x = section.support_x(support);
        let begins = support == 0;
        let others = self.sections().enumerate().filter(|(other, section)| {
            let (start, end) = (section.start_x, section.end_x());
            // Another that a strip comes from or goes on to.
            let passes = if begins {
                start < x - ROUNDING && end >= x - ROUNDING
            } else {
                start <= x + ROUNDING && end > x + ROUNDING
            };
            *other != number && passes
        });
        let next = others.map(|(other, section)| (other, section.chord_height(x)));
        let Some((other, height)) = next.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return;
        };
        let own = section.height_at(support);
        if height - own > REACH {
            let [what, lost] = if begins {
                ["begins", "a strip would come under it"]
            } else {
                ["ends", "a strip would lose its wire"]
            };
            let expected = format!(
                "must be at least {:.3} m where its tension length {what}, at x = {x} m: the contact wire of tension \
                 length {} is at {height:.3} m there, and {lost}; both must come to one height within the overlap",
                height - REACH,
                other + 1,
            );
            let heights = &section.contact_wire_height;
            let key = format!("{}.contact_wire_height", self.key_of(number));
            let key = entry_of(&key, heights, support % heights.len());
            refuse(found, key, shown_number(own, "m"), expected);
        }
    }

    /// True where the contact wire of tension length `number` at its support `support` (both from 0) is within reach of
    /// strips, which are on the lowest wire.
    pub(crate) fn is_in_reach(&self, number: usize, support: usize) -> bool {
        let section = self.section(number);
        let x = section.support_x(support);
        section.height_at(support) <= self.chord_height(x) + REACH
    }
}
