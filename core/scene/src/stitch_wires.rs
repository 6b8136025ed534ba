//! `[catenary.stitch_wires]`: wires below the messenger wire about the supports.

use crate::Wire;
use crate::keys::{Entry, Keys, Number, Sentences};

/// `[catenary.stitch_wires]`: a wire below the messenger wire about every inner support, clamped to it at both ends,
/// from which the droppers between its clamps hang.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StitchWires {
    /// Distance between the clamps along the track, m; half of it on either side of the support.
    pub length: f64,
    /// Mass of the clamp at each end, kg.
    pub clamp_mass: f64,
    /// Section, tension and strength.
    pub wire: Wire,
}

impl Entry for StitchWires {
    const SENTENCES: Sentences = &[
        (
            "length",
            "Distance between the clamps of a stitch wire along the track, half of it on either side of the support; \
             the droppers between them hang from the stitch wire.",
        ),
        ("clamp_mass", "Mass of the clamp at each end of a stitch wire."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            length: keys.number("length", was.map(|stitch| stitch.length), Number::positive("m")),
            clamp_mass: keys.number(
                "clamp_mass",
                was.map(|stitch| stitch.clamp_mass),
                Number::not_negative("kg").default(0.0),
            ),
            wire: keys.part(was.map(|stitch| &stitch.wire)),
        }
    }
}
