//! Series of a head from those of its strips.

use component::exchange::{contact, strip};

use crate::StripRecord;
use crate::record::COLUMNS;

/// Name of the group of a head's series in the time series file.
const GROUP: &str = "head";

/// Names of the series of head `i` (from 1) in the order of the time series file.
pub(super) fn names(i: usize) -> [String; COLUMNS] {
    let contact = |index: usize| contact::SIGNALS[index].of(GROUP, i);
    let strip = |index: usize| strip::SIGNALS[index].of(GROUP, i);
    [
        contact(contact::FORCE),
        contact(contact::X),
        contact(contact::Y),
        contact(contact::WIRE_Z),
        strip(strip::Z),
        strip(strip::VZ),
        contact(contact::GAP),
    ]
}

impl StripRecord {
    /// Adds a row from the last rows of the strips of a head with several: the force is the sum, the contact point that
    /// of the resultant (without a force, of the strip with the smallest gap), the height the mean, the gap the
    /// smallest, the wind the sum.
    pub(super) fn push_head(&mut self) {
        let last = |series: &Vec<f64>| series.last().copied().unwrap_or_default();
        let strips = &self.strips;
        let count = strips.len() as f64;
        let force: f64 = strips.iter().map(|strip| last(&strip.force)).sum();
        let nearest = strips.iter().min_by(|a, b| last(&a.gap).total_cmp(&last(&b.gap)));
        let at = |of: fn(&Self) -> &Vec<f64>| {
            if force > 0.0 {
                let moments = strips.iter().map(|strip| last(&strip.force) * last(of(strip)));
                moments.sum::<f64>() / force
            } else {
                nearest.map_or(0.0, |strip| last(of(strip)))
            }
        };
        let mean = |of: fn(&Self) -> &Vec<f64>| strips.iter().map(|strip| last(of(strip))).sum::<f64>() / count;
        let row = [
            force,
            at(|strip| &strip.contact_x),
            at(|strip| &strip.contact_y),
            at(|strip| &strip.wire_z),
            mean(|strip| &strip.strip_z),
            mean(|strip| &strip.strip_vz),
            nearest.map_or(f64::MAX, |strip| last(&strip.gap)),
        ];
        if let Some(wind) = &mut self.wind {
            let sum = |of: fn(&crate::WindRecord) -> &Vec<f64>| {
                let winds = strips.iter().filter_map(|strip| strip.wind.as_ref());
                winds.map(|wind| last(of(wind))).sum()
            };
            wind.drag.push(sum(|wind| &wind.drag));
            wind.lift.push(sum(|wind| &wind.lift));
        }
        for (series, value) in self.columns_mut().into_iter().zip(row) {
            series.push(value);
        }
    }
}
