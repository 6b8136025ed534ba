//! Coarse pictures of line and pantographs, seen from the side.

use serde::{Deserialize, Serialize};

/// One picture; points are (x, z) in m.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Time, s.
    pub time: f64,
    /// Points along the first contact wire.
    pub contact_wire: Vec<(f64, f64)>,
    /// Points along the first messenger wire; empty without one.
    pub messenger_wire: Vec<(f64, f64)>,
    /// Points along each further wire, with true for a contact wire; nothing in files of earlier versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further_wires: Vec<(bool, Vec<(f64, f64)>)>,
    /// Droppers.
    pub droppers: Vec<DropperLine>,
    /// Polylines of each pantograph: `pantographs[i]` is a list of polylines, the collector strip
    /// first.
    pub pantographs: Vec<Vec<Vec<(f64, f64)>>>,
    /// Contact force of each pantograph at this time, N.
    pub forces: Vec<f64>,
    /// Position of each contact along the track at this time, m; nothing in files of earlier versions.
    #[serde(default)]
    pub contacts: Vec<f64>,
}

/// A dropper between the wires. In files: `[x_top, z_top, x_bottom, z_bottom, slack]`, slack 0 or 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "(f64, f64, f64, f64, u8)", into = "(f64, f64, f64, f64, u8)")]
pub struct DropperLine {
    /// End at the messenger wire (x, z), m.
    pub top: (f64, f64),
    /// End at the contact wire (x, z), m.
    pub bottom: (f64, f64),
    /// True for a dropper without force.
    pub slack: bool,
}

impl From<(f64, f64, f64, f64, u8)> for DropperLine {
    fn from((x0, z0, x1, z1, slack): (f64, f64, f64, f64, u8)) -> Self {
        Self {
            top: (x0, z0),
            bottom: (x1, z1),
            slack: slack != 0,
        }
    }
}

impl From<DropperLine> for (f64, f64, f64, f64, u8) {
    fn from(d: DropperLine) -> Self {
        (d.top.0, d.top.1, d.bottom.0, d.bottom.1, u8::from(d.slack))
    }
}
