//! `strip.horns`: the bent ends of a pantograph head beyond its straight strip.

use dynamics::MonotoneCubic;

use crate::check::{Found, refuse};
use crate::keys::{Entry, Keys, Length, Number, Sentences};
use crate::write::{shown_entries, shown_number};

/// `horns` of a strip: points of the top of the head beyond the straight part, the same to both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Horns {
    /// Distances from the middle of the head, m, ascending beyond half the width of the strip; the last one is half the
    /// length of the head.
    pub y: Vec<f64>,
    /// Heights above the straight part, m, one per distance, falling from 0 on, ever steeper.
    pub z: Vec<f64>,
}

impl Horns {
    /// Height of the top of the head above its straight part of `width` m over the distance from its middle, m.
    #[must_use]
    pub fn top(&self, width: f64) -> MonotoneCubic {
        let y = [&[0.5 * width], &self.y[..]].concat();
        let z = [&[0.0], &self.z[..]].concat();
        MonotoneCubic::new(y, z, Some(0.0))
    }

    /// Half the length of the head, m.
    #[must_use]
    pub fn half_length(&self) -> f64 {
        self.y.last().copied().unwrap_or(0.0)
    }

    /// Refuses points that are no horn beside a strip of `width` m; `path` is that of the pantograph.
    pub(crate) fn check(&self, width: f64, path: &str, found: &mut Found) {
        let key = |axis: &str, i: usize| format!("{path}.strip.horns.{axis}[{}]", i + 1);
        if self.z.len() != self.y.len() {
            let expected = format!("must be {}, one for each entry of y", self.y.len());
            let value = shown_entries(self.z.len());
            refuse(found, format!("{path}.strip.horns.z"), value, expected);
            return;
        }
        let (mut y0, mut z0, mut before) = (0.5 * width, 0.0, 0.0);
        for (i, (&y, &z)) in self.y.iter().zip(&self.z).enumerate() {
            let slope = (z - z0) / (y - y0);
            if y <= y0 {
                let expected = format!("must be more than {y0} m, the place before it, or else half the strip's width");
                refuse(found, key("y", i), shown_number(y, "m"), expected);
                return;
            }
            if z >= z0 {
                let expected = format!("must be below {z0} m: the head falls from its straight part on, whose z is 0");
                refuse(found, key("z", i), shown_number(z, "m"), expected);
            } else if slope > before + ROUNDING {
                let expected = format!(
                    "must be at most {} m: the horn is to fall ever steeper, or a wire could hang in the hollow",
                    z0 + before * (y - y0)
                );
                refuse(found, key("z", i), shown_number(z, "m"), expected);
            }
            (y0, z0, before) = (y, z, slope);
        }
    }
}

/// Difference of slopes that is rounding, –.
const ROUNDING: f64 = 1e-9;

impl Entry for Horns {
    const SENTENCES: Sentences = &[
        (
            "y",
            "Distances of points of the horn from the middle of the head, ascending beyond half the width of the \
             strip; the last one is half the length of the head.",
        ),
        (
            "z",
            "Heights of these points above the straight strip, negative, falling ever steeper.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let y = was.map(|horns| horns.y.as_slice());
        let z = was.map(|horns| horns.z.as_slice());
        Self {
            y: keys.numbers("y", y, Number::positive("m"), Length::NotEmpty),
            z: keys.numbers("z", z, Number::any("m"), Length::NotEmpty),
        }
    }
}
