//! The wind of a scene as a field.
use super::{GustExtent, Wind, WindSpectrum, WindTurbulence};
use crate::{Line, Scene};
use dynamics::{Gust, GustProfile, Polar, Turbulence, TurbulenceOptions, TurbulenceSpectrum, WindRecord};

impl Wind {
    /// Velocity of the mean wind over the ground, m/s: `−speed (cos yaw, sin yaw, 0)`.
    #[must_use]
    pub fn mean_velocity(&self) -> [f64; 3] {
        let (sine, cosine) = self.yaw_deg.to_radians().sin_cos();
        [-self.speed * cosine, -self.speed * sine, 0.0]
    }
}

impl super::WindSurface {
    /// Coefficients times `area` (m²) by angle of attack.
    #[must_use]
    pub fn polar(&self, area: f64) -> Polar {
        let angles = if self.angles_deg.is_empty() {
            vec![0.0]
        } else {
            self.angles_deg.iter().map(|angle| angle.to_radians()).collect()
        };
        let scaled = |values: &[f64]| values.iter().map(|value| value * area).collect();
        Polar::table(angles, scaled(&self.drag), scaled(&self.lift))
    }
}

impl Scene {
    /// The wind over the track, where the scene has one. It depends on `[wind]` alone; how far along the track it is
    /// tabulated depends on the line.
    #[must_use]
    pub fn wind_field(&self) -> Option<dynamics::Wind> {
        let wind = self.wind.as_ref()?;
        let gusts = wind.gust.iter().map(|gust| Gust {
            peak: gust.velocity.into(),
            profile: match gust.extent {
                GustExtent::Time { start, duration } => GustProfile::InTime { start, duration },
                GustExtent::Place { start_x, length } => GustProfile::InPlace { start: start_x, length },
            },
        });
        Some(dynamics::Wind {
            mean: wind.mean_velocity().into(),
            gusts: gusts.collect(),
            turbulence: wind
                .turbulence
                .as_ref()
                .map(|turbulence| self.turbulence(wind, turbulence)),
            // Rows that are none were refused when the scene was read.
            record: WindRecord::from_rows(&wind.record).ok(),
        })
    }

    fn turbulence(&self, wind: &Wind, turbulence: &WindTurbulence) -> Turbulence {
        let [x, y, _] = wind.mean_velocity();
        let (along, across) = (
            [x / wind.speed, y / wind.speed, 0.0],
            [-y / wind.speed, x / wind.speed, 0.0],
        );
        Turbulence::new(&TurbulenceOptions {
            spectrum: match turbulence.spectrum {
                WindSpectrum::VonKarman => TurbulenceSpectrum::VonKarman,
                WindSpectrum::Kaimal => TurbulenceSpectrum::Kaimal,
            },
            speed: wind.speed,
            axes: [along, across, [0.0, 0.0, 1.0]].into(),
            deviations: turbulence.intensities.map(|intensity| intensity * wind.speed),
            length_scales: turbulence.length_scales,
            coherence_decays: turbulence.coherence_decays,
            seed: turbulence.seed as u64,
            time_step: turbulence.time_step,
            steps: turbulence.steps,
            start: 0.0,
            spacing: turbulence.spacing,
            stations: self.wind_stations(turbulence),
        })
    }

    /// Places along the line, or along the run where the line is a supplied one.
    pub(crate) fn wind_stations(&self, turbulence: &WindTurbulence) -> usize {
        let length = match &self.catenary {
            Line::Modelled(catenary) => catenary.length(),
            Line::Supplied(_) => self.head_x(0, self.run.duration),
        };
        // One more on each side of the last interval: the interpolation takes four neighbours.
        (length / turbulence.spacing).ceil().clamp(0.0, 1e9) as usize + 2
    }
}
