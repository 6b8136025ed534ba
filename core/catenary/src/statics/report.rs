//! Report of statics for people, tests and tools.
use crate::WireName;
use serde::{Deserialize, Serialize};

/// Slopes of the chords between neighbouring supports of one tension length: to the next support, and the change at
/// this one; none where there is no chord.
#[must_use]
pub fn gradients(supports: &[SupportReport]) -> Vec<(Option<f64>, Option<f64>)> {
    let slope = |i: usize| {
        let (a, b) = (supports.get(i)?, supports.get(i + 1)?);
        (a.tension_length == b.tension_length).then(|| (b.contact_wire_z - a.contact_wire_z) / (b.x - a.x))
    };
    (0..supports.len())
        .map(|i| {
            let next = slope(i);
            let before = i.checked_sub(1).and_then(slope);
            (next, next.zip(before).map(|(next, before)| next - before))
        })
        .collect()
}

/// Non-uniformity of the elasticity, `u = (e_max − e_min)/(e_max + e_min)`, –, with the least and the largest
/// elasticity, m/N; none without points.
#[must_use]
pub fn non_uniformity(points: &[ElasticityReport]) -> Option<(f64, f64, f64)> {
    let values = points.iter().map(|point| point.elasticity);
    let least = values.clone().reduce(f64::min)?;
    let most = values.reduce(f64::max)?;
    Some(((most - least) / (most + least), least, most))
}

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
    /// Ends under tensioning devices after a change; empty without a change, or with fixed ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ends: Vec<EndReport>,
    /// Horizontal tension at the last end.
    pub tension: TensionReport,
}

/// One end of a wire under its tensioning device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EndReport {
    /// Tension length, counted from 1.
    pub tension_length: usize,
    /// The wire.
    pub wire: WireName,
    /// Position along the track at the erection, m.
    #[serde(rename = "x_m")]
    pub x: f64,
    /// Way of the end outward since the erection, m.
    #[serde(rename = "travel_m")]
    pub travel: f64,
    /// Way of the weights downward since the erection, m.
    #[serde(rename = "weights_travel_m")]
    pub weights: f64,
    /// Horizontal tension of the wire, N.
    #[serde(rename = "tension_N")]
    pub tension: f64,
    /// Holder of the end: "weights", "friction" or "stop".
    pub held_by: String,
}

/// One dropper in the static state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DropperReport {
    /// Tension length, counted from 1.
    pub tension_length: usize,
    /// Span of the tension length, counted from 1.
    pub span: usize,
    /// Number within the span, counted from 1.
    pub dropper: usize,
    /// Wire from which the dropper hangs.
    pub hangs_from: WireName,
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
    /// Tension length, counted from 1.
    pub tension_length: usize,
    /// Position along the track, m.
    pub x: f64,
    /// Vertical force on the messenger wire, N, upwards.
    #[serde(rename = "messenger_reaction_N")]
    pub messenger_reaction: f64,
    /// Vertical force on the contact wire and the arm's own mass, N, upwards.
    #[serde(rename = "arm_force_N")]
    pub arm_force: f64,
    /// Lateral force on the messenger wire, N, to the left; none of a planar line that nothing leads sideways.
    #[serde(rename = "messenger_lateral_N", default)]
    pub messenger_lateral: Option<f64>,
    /// Lateral force of the arm on the contact wire, N, to the left; none of a planar line that nothing leads sideways.
    #[serde(rename = "arm_lateral_N", default)]
    pub arm_lateral: Option<f64>,
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

#[cfg(test)]
mod tests {
    use super::*;

    fn support(tension_length: usize, x: f64, contact_wire_z: f64) -> SupportReport {
        SupportReport {
            tension_length,
            x,
            messenger_reaction: 0.0,
            arm_force: 0.0,
            messenger_lateral: None,
            arm_lateral: None,
            contact_wire_z,
        }
    }

    #[test]
    fn gradients_are_those_of_chords_within_a_tension_length() {
        let all = [
            support(1, 0.0, 5.3),
            support(1, 50.0, 5.4),
            support(1, 100.0, 5.4),
            support(2, 80.0, 5.3),
            support(2, 130.0, 5.25),
        ];
        let found = gradients(&all);
        let near = |a: Option<f64>, b: f64| (a.unwrap() - b).abs() < 1e-12;
        assert!(near(found[0].0, 0.002) && found[0].1.is_none());
        assert!(near(found[1].0, 0.0) && near(found[1].1, -0.002));
        assert_eq!(found[2], (None, None));
        assert!(near(found[3].0, -0.001) && found[3].1.is_none());
    }

    #[test]
    fn non_uniformity_is_half_the_spread_over_the_mean() {
        let point = |elasticity| ElasticityReport { x: 0.0, elasticity };
        let (u, least, most) = non_uniformity(&[point(4e-4), point(6e-4), point(5e-4)]).unwrap();
        assert!((u - 0.2).abs() < 1e-12 && (least, most) == (4e-4, 6e-4));
        assert!(non_uniformity(&[]).is_none());
    }
}
