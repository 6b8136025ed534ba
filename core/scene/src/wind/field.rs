//! The wind of a scene as a field.
use super::{GustExtent, Wind, WindSpectrum, WindTurbulence};
use crate::{Line, Scene, WireKind};
use dynamics::{Gust, GustProfile, Polar, Turbulence, TurbulenceOptions, TurbulenceSpectrum, WindRecord};

impl Wind {
    /// Velocity of the mean wind over the ground, m/s: `−speed (cos yaw, sin yaw, 0)`.
    #[must_use]
    pub fn mean_velocity(&self) -> [f64; 3] {
        let (sine, cosine) = self.yaw_deg.to_radians().sin_cos();
        [-self.speed * cosine, -self.speed * sine, 0.0]
    }
}

impl super::WirePolar {
    /// Coefficients by angle of attack.
    #[must_use]
    pub fn polar(&self) -> Polar {
        let angles = self.angles_deg.iter().map(|angle| angle.to_radians()).collect();
        Polar::table(angles, self.drag.clone(), self.lift.clone())
    }
}

impl super::WindOnWires {
    /// Drag and lift of a wire by angle of attack; none for one with a drag coefficient alone.
    #[must_use]
    pub fn polar(&self, wire: WireKind) -> Option<&super::WirePolar> {
        match wire {
            WireKind::Contact => self.contact_wire_polar.as_ref(),
            WireKind::Messenger => self.messenger_wire_polar.as_ref(),
            WireKind::Stitch => None,
        }
    }
}

impl Scene {
    /// Diameter of a wire in the wind, ice included, m; none where the scene has none, or no wind on wires.
    #[must_use]
    pub fn diameter_in_wind(&self, wire: WireKind) -> Option<f64> {
        let wires = self.wind.as_ref()?.wires.as_ref()?;
        let (line, _) = self.modelled_line()?;
        let own = match wire {
            WireKind::Contact => wires.contact_wire_diameter,
            WireKind::Messenger => wires.messenger_wire_diameter,
            WireKind::Stitch => wires.stitch_wire_diameter,
        };
        let bare = own.or_else(|| line.diameter(wire)).or_else(|| {
            let as_messenger = (wire == WireKind::Stitch).then_some(WireKind::Messenger)?;
            wires.messenger_wire_diameter.or_else(|| line.diameter(as_messenger))
        })?;
        let ice = line.change.as_ref().and_then(|change| change.ice);
        Some(bare + ice.map_or(0.0, |ice| 2.0 * ice.thickness(wire)))
    }

    /// Angles of attack of the mean wind, and of the wind at the peak of a gust, on a wire along the track, degrees.
    pub(crate) fn angles_of_the_wind(&self) -> Vec<f64> {
        let Some(wind) = &self.wind else { return Vec::new() };
        let [_, y, z] = wind.mean_velocity();
        let peak = wind.gust.map(|gust| [y + gust.velocity[1], z + gust.velocity[2]]);
        let winds = [Some([y, z]), peak].into_iter().flatten();
        let across = winds.filter(|[y, z]| y.hypot(*z) > 1e-9);
        across.map(|[y, z]| z.atan2(y.abs()).to_degrees()).collect()
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
