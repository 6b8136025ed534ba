//! Coarse pictures of line and pantograph, for the animation of the report.

use component::{DropperLine, Frame};
use serde::{Deserialize, Serialize};

/// Pictures of the line seen from the side, in the order of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Animation {
    /// Pictures.
    pub frames: Vec<Frame>,
}

/// Rounds to 0.1 mm: a tenth of what a screen shows at the largest magnification.
fn rounded(v: f64) -> f64 {
    (v * 1e4).round() / 1e4
}

fn round(p: (f64, f64)) -> (f64, f64) {
    (rounded(p.0), rounded(p.1))
}

impl Animation {
    /// The same pictures with all points rounded to 0.1 mm, times to 0.1 ms and forces to 0.1 N,
    /// which keeps the file small.
    #[must_use]
    pub fn rounded(&self) -> Self {
        let line = |points: &[(f64, f64)]| points.iter().copied().map(round).collect::<Vec<_>>();
        let frames = self
            .frames
            .iter()
            .map(|frame| Frame {
                time: rounded(frame.time),
                contact_wire: line(&frame.contact_wire),
                messenger_wire: line(&frame.messenger_wire),
                further_wires: (frame.further_wires.iter())
                    .map(|(contact, wire)| (*contact, line(wire)))
                    .collect(),
                droppers: frame
                    .droppers
                    .iter()
                    .map(|d| DropperLine {
                        top: round(d.top),
                        bottom: round(d.bottom),
                        ..*d
                    })
                    .collect(),
                pantographs: frame
                    .pantographs
                    .iter()
                    .map(|lines| lines.iter().map(|l| line(l)).collect())
                    .collect(),
                forces: frame.forces.iter().map(|f| (f * 10.0).round() / 10.0).collect(),
                contacts: frame.contacts.iter().copied().map(rounded).collect(),
            })
            .collect();
        Self { frames }
    }
}
