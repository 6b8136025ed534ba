//! Motion of a pantograph's base on a vehicle, as a scene without that vehicle takes it.

use std::path::Path;

use component::{Component, of_pantograph};
use scene::{GivenMotion, Irregularities, Scene};
use vehicle::{Displaced, Subsystem, VehicleError};

use crate::{SetupError, prepare};

/// Samples of a given motion per period of the shortest irregularities, and of the filter's band: a cubic spline
/// follows that to some 1e-4 of its amplitude.
const SAMPLES: f64 = 11.0;

/// Samples by which a given motion goes on after the run: it ends at rest, which that many before is not felt any more.
const TAIL: f64 = 10.0;

/// Why a vehicle gives no motion.
#[derive(Debug, thiserror::Error)]
pub enum BaseMotionError {
    /// The scene has no start.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The vehicle cannot be built.
    #[error(transparent)]
    Vehicle(#[from] VehicleError),
    /// A scene takes one motion only.
    #[error("each of {count} pantographs has a motion of the base of its own")]
    Several {
        /// Number of pantographs.
        count: usize,
    },
    /// The run does not come to its end.
    #[error("the run that gives its motion ends at {time:.3} s: {reason}")]
    Ended {
        /// Last time that was reached, s.
        time: f64,
        /// Reason of the end.
        reason: String,
    },
}

/// Time between two samples of a given motion, s: micro steps as long as they resolve the irregularities at the speed
/// of the run, and the band of the filter; one micro step where they do not.
fn sample(scene: &Scene, micro_step: f64) -> f64 {
    let shortest = match scene.track.as_deref().map(|track| &track.irregularities) {
        Some(Irregularities::Spectrum(spectrum)) => spectrum.wavelengths[0],
        // Two points make the shortest wave.
        Some(Irregularities::Points(points)) => {
            let distances = points.x.windows(2).map(|pair| pair[1] - pair[0]);
            2.0 * distances.fold(f64::INFINITY, f64::min)
        }
        Some(Irregularities::None) | None => f64::INFINITY,
    };
    let period = (shortest / scene.run.speed).min(1.0 / scene.run.low_pass_hz);
    // Rounding of a period that is a whole number of steps.
    let steps = (period / SAMPLES / micro_step + 1e-9).floor();
    micro_step * steps.max(1.0)
}

/// Motion of the base on a vehicle that runs over its track under the constant contact force of the start; `micro_step`
/// (s) is that of the run.
///
/// # Errors
/// See [`BaseMotionError`].
pub fn base_motion(scene: Scene, micro_step: f64) -> Result<GivenMotion, BaseMotionError> {
    let count = scene.pantographs.len();
    if count != 1 {
        return Err(BaseMotionError::Several { count });
    }
    let vehicle = scene.vehicle.as_deref();
    let straight = vehicle.is_none_or(|vehicle| vehicle.leaves_the_plane(scene.track.as_deref()).is_none());
    let prepared = prepare(scene, "vehicle", Path::new(""), false)?;
    let mut own = of_pantograph(&prepared.scene, 0);
    let sample = sample(&own, micro_step);
    own.solver.micro_step = micro_step;
    own.run.duration += TAIL * sample;
    let mut pantograph = Subsystem::build(&own)?;
    let mut motion = GivenMotion::default();
    let steps = (own.run.duration / sample).ceil() as usize;
    for step in 0..=steps {
        let time = step as f64 * sample;
        let Displaced {
            displacement: [x, y, z],
            angles: [roll, pitch, yaw],
        } = pantograph.base_displaced();
        // Rounding would be a lateral motion to the line.
        let aside = |value: f64| if straight { 0.0 } else { value };
        motion.time.push(time);
        motion.x.push(x);
        motion.y.push(aside(y));
        motion.z.push(z);
        motion.roll.push(aside(roll));
        motion.pitch.push(pitch);
        motion.yaw.push(aside(yaw));
        if step < steps {
            let made = pantograph.do_step(time, sample);
            made.map_err(|failure| BaseMotionError::Ended {
                time,
                reason: failure.reason,
            })?;
        }
    }
    Ok(motion)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scene of the thesis on a short line.
    fn thesis(overrides: &[&str]) -> Scene {
        let text = include_str!("../../../scenes/thesis-own-mesh.toml");
        let mut keys = vec![
            "catenary.spans=6",
            "run.duration=2.0",
            "run.evaluate={ time = [0.5, 2.0] }",
        ];
        keys.extend(overrides);
        let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
        system::load(text, "thesis-own-mesh.toml", &keys).unwrap()
    }

    #[test]
    fn samples_follow_the_irregularities_at_any_speed() {
        let step = 1e-4;
        let of = |speed: &str, irregularities: &str| {
            let scene = thesis(&[
                "run.duration=0.5",
                "run.evaluate={ time = [0.1, 0.5] }",
                speed,
                irregularities,
            ]);
            let found = sample(&scene, step);
            let steps = found / step;
            assert!((steps - steps.round()).abs() < 1e-9, "{steps}");
            (found, scene.run.speed)
        };
        let spectrum = "track.irregularities={ model = \"spectrum\", seed = 1, wavelengths = [3.0, 80.0], \
            vertical_roughness = 4.032e-7, lateral_roughness = 2.119e-7, corners = [0.0206, 0.8246, 0.4380], \
            fade = 20.0 }";
        let points =
            "track.irregularities={ model = \"points\", x = [90.0, 110.0, 110.25], z_left = [0.0, 1e-3, 0.0] }";
        for speed in ["run.speed_kmh=40.0", "run.speed_kmh=200.0", "run.speed_kmh=300.0"] {
            for (irregularities, shortest) in [(spectrum, 3.0), (points, 0.5)] {
                let (found, speed) = of(speed, irregularities);
                let period = (shortest / speed).min(1.0 / 20.0);
                // As many as are wanted, and not more than a micro step makes of that.
                assert!(
                    period / found >= SAMPLES && period / (found + step) < SAMPLES,
                    "{found} s, {speed} m/s"
                );
            }
        }
        // Smooth: the band of the filter.
        assert_eq!(
            (of("run.speed_kmh=200.0", "track.irregularities=none").0 / step).round(),
            45.0
        );
        let coarse = thesis(&[points]);
        assert_eq!(sample(&coarse, 2e-3), 2e-3);
    }
}
