//! `[catenary.tensioning]`: devices that keep the tension of the wires.
use crate::check::Found;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::{Catenary, WireEnds};

/// Tensioning devices at both ends of every tension length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tensioning {
    /// Friction as a share of the tension: a device moves where the tension is away from that of its weights by more.
    pub friction: f64,
    /// Way of the weights by that of the end of the wire.
    pub ratio: f64,
    /// Way of the weights from their place at the erection to the stop on either side, m; none without stops.
    pub travel: Option<f64>,
}

impl Tensioning {
    /// Way of the end of a wire to a stop, m; infinite without stops.
    #[must_use]
    pub fn way(&self) -> f64 {
        self.travel.map_or(f64::INFINITY, |travel| travel / self.ratio)
    }
}

impl Catenary {
    pub(crate) fn check_tensioning(&self, found: &mut Found) {
        if self.tensioning.is_some() && self.wire_ends == WireEnds::Fixed {
            let because = "catenary.wire_ends = \"fixed\" has no tensioning devices".to_owned();
            found.push(("catenary.tensioning".to_owned(), What::LeaveOut { because }));
        }
    }
}

impl Entry for Tensioning {
    const SENTENCES: Sentences = &[
        (
            "friction",
            "Friction of the device as a share of the tension: the end of a wire moves where its tension differs from \
             that of the weights by more.",
        ),
        ("ratio", "Way of the weights by that of the end of the wire."),
        (
            "travel",
            "Way of the weights from their place at the erection to the stop on either side; left out, there are none.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            friction: keys.number(
                "friction",
                was.map(|device| device.friction),
                Number::between(0.0, 0.5).default(0.0),
            ),
            ratio: keys.number(
                "ratio",
                was.map(|device| device.ratio),
                Number::between(0.5, 10.0).default(1.0),
            ),
            travel: keys.optional_number("travel", was.map(|device| device.travel), Number::positive("m")),
        }
    }
}
