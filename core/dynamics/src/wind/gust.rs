//! Discrete gusts.
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// A gust of the shape `(1 − cos)/2`, zero outside: the discrete gust of airworthiness and of wind-turbine rules
/// (IEC 61400-1, 6.3.2.2, without its dip).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gust {
    /// Velocity that it adds at its peak, world axes, m/s.
    pub peak: Vector3<f64>,
    /// Course of the gust in time or along the track.
    pub profile: GustProfile,
}

/// Axis along which a gust rises and falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GustProfile {
    /// Everywhere at once.
    InTime {
        /// s.
        start: f64,
        /// Length in time, s, positive.
        duration: f64,
    },
    /// Standing over a stretch of the track, that a train runs through (the way EN 14067-6 lets a train meet its gust).
    InPlace {
        /// x where it begins, m.
        start: f64,
        /// m, positive.
        length: f64,
    },
}

impl Gust {
    /// Velocity that it adds at time `t` (s) over `x` (m), m/s.
    #[must_use]
    pub fn velocity(&self, t: f64, x: f64) -> Vector3<f64> {
        let share = match self.profile {
            GustProfile::InTime { start, duration } => (t - start) / duration,
            GustProfile::InPlace { start, length } => (x - start) / length,
        };
        if share > 0.0 && share < 1.0 {
            self.peak * (0.5 * (1.0 - (TAU * share).cos()))
        } else {
            Vector3::zeros()
        }
    }

    pub(super) fn is_the_same_everywhere(&self) -> bool {
        matches!(self.profile, GustProfile::InTime { .. })
    }
}
