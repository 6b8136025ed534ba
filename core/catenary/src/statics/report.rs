//! Report of statics for people, tests and tools.
use serde::{Deserialize, Serialize};

/// Report of the static state.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StaticsReport {
    /// Newton iterations.
    pub iterations: usize,
    /// Largest generalised force left on a free coordinate of the whole line, N.
    #[serde(rename = "residual_N")]
    pub residual: f64,
    /// Droppers, span after span.
    pub droppers: Vec<DropperReport>,
    /// Supports from first to last; the first and the last are the ends of the wires.
    pub supports: Vec<SupportReport>,
    /// Elasticity, ordered by x.
    pub elasticity: Vec<ElasticityReport>,
    /// Horizontal tension at the last end.
    pub tension: TensionReport,
}

/// One dropper in the static state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DropperReport {
    /// Span, counted from 1.
    pub span: usize,
    /// Position along the track, m.
    pub x: f64,
    /// Unstressed length, m, as `droppers.lengths` of a scene.
    #[serde(rename = "length_m")]
    pub length: f64,
    /// Tension, N.
    #[serde(rename = "force_N")]
    pub force: f64,
}

/// One support in the static state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SupportReport {
    /// Position along the track, m.
    pub x: f64,
    /// Vertical force on the messenger wire, N, upwards.
    #[serde(rename = "messenger_reaction_N")]
    pub messenger_reaction: f64,
    /// Vertical force on the contact wire and the arm's own mass, N, upwards.
    #[serde(rename = "arm_force_N")]
    pub arm_force: f64,
    /// Height of the contact wire, m.
    #[serde(rename = "contact_wire_z_m")]
    pub contact_wire_z: f64,
}

/// Elasticity at one point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElasticityReport {
    /// Position along the track, m.
    pub x: f64,
    /// Rise of the contact wire under an upward force, per newton, m/N.
    #[serde(rename = "m_per_N")]
    pub elasticity: f64,
}

/// Tension of the wires.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TensionReport {
    /// N.
    #[serde(rename = "contact_wire_N")]
    pub contact_wire: f64,
    /// N.
    #[serde(rename = "messenger_wire_N")]
    pub messenger_wire: f64,
}
