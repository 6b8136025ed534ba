//! The wind along the track: a velocity field `W(t, x)` that every body evaluates at its own place.
//!
//! ```text
//! W(t, x) = mean + Σ gusts + turbulence(t, x) + record(t, x)
//! ```
//!
//! The field depends on nothing but its own numbers, so that two programs that hold the same scene see the same wind,
//! bit for bit.
//!
//! | file | subject |
//! | --- | --- |
//! | `gust` | discrete gusts |
//! | `turbulence` | seeded turbulence, tabulated once |
//! | `spectrum` | spectra of atmospheric turbulence |
//! | `record` | wind given as numbers over time |
//! | `aerodynamic` | forces of the air on bodies and cylinders |
mod aerodynamic;
mod gust;
mod record;
mod spectrum;
mod turbulence;

pub use aerodynamic::{
    AerodynamicForce, AerodynamicLaw, AerodynamicLoad, CrossFlow, Flow, Polar, SectionFlow, SlenderFlow,
    galloping_speed,
};
pub use gust::{Gust, GustProfile};
pub use record::{WindRecord, WindRecordError};
pub use spectrum::TurbulenceSpectrum;
pub use turbulence::{Turbulence, TurbulenceOptions};

use nalgebra::Vector3;

/// A wind field in world axes, m/s: how the air moves over the ground.
#[derive(Clone, Debug, Default)]
pub struct Wind {
    /// Constant part, m/s.
    pub mean: Vector3<f64>,
    /// 1 − cos gusts.
    pub gusts: Vec<Gust>,
    /// Seeded turbulence.
    pub turbulence: Option<Turbulence>,
    /// A record given by the user, added to the rest.
    pub record: Option<WindRecord>,
}

impl Wind {
    /// Wind that is the same everywhere and always.
    #[must_use]
    pub fn uniform(mean: Vector3<f64>) -> Self {
        Self {
            mean,
            ..Self::default()
        }
    }

    /// Velocity of the air at time `t` (s) over `x` (m along the track), m/s.
    #[must_use]
    pub fn velocity(&self, t: f64, x: f64) -> Vector3<f64> {
        let mut velocity = self.mean;
        for gust in &self.gusts {
            velocity += gust.velocity(t, x);
        }
        if let Some(turbulence) = &self.turbulence {
            velocity += turbulence.velocity(t, x);
        }
        if let Some(record) = &self.record {
            velocity += record.velocity(t, x);
        }
        velocity
    }

    /// Returns `true` if the wind is at every instant the same all along the track.
    #[must_use]
    pub fn is_the_same_everywhere(&self) -> bool {
        self.turbulence.is_none()
            && self.gusts.iter().all(Gust::is_the_same_everywhere)
            && self.record.as_ref().is_none_or(WindRecord::is_the_same_everywhere)
    }
}

#[cfg(test)]
mod tests;
