//! Variants of the vehicle below the pantograph: each model, on the scene's track and on one with irregularities.
//!
//! | model | made from the scene by |
//! | --- | --- |
//! | none | leaving out `[vehicle]` and `[track]`: the base moves on a straight line |
//! | rigid_motion | the motion of the base on the most detailed model, under the constant contact force of the start |
//! | vertical, full | naming the model, where the scene has what it needs |
//!
//! The most detailed model that the scene has what it needs for is what the others are judged by, each on its own
//! track, with the same mesh and steps and with those reductions that change nothing.

use std::sync::Arc;

use component::Component;
use scene::{GivenMotion, Irregularities, Scene, Spectrum, Track, Vehicle};
use vehicle::{Displaced, Subsystem};

use component::of_pantograph;
use simulation::prepare;

/// A vehicle and a track other than the scene's, and the scene with them.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleVariant {
    /// Name.
    pub name: VehicleVariantName,
    /// The scene with it.
    pub text: Arc<str>,
}

/// A vehicle and a track by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct VehicleVariantName {
    /// `none`, or the word of `vehicle.model`.
    pub vehicle: &'static str,
    /// `scene`, or what was put in its place.
    pub track: &'static str,
}

/// No vehicle.
const NONE: &str = "none";

/// The scene's own track.
pub const OWN: &str = "scene";

/// The track with irregularities that a scene on smooth track is also studied on.
const IRREGULAR: &str = "ore_b176_low";

/// Irregularities of a good main line: the spectra of ORE B176 at their lower level [ORE B176 RP1, Utrecht 1989; as
/// given by Claus & Schiehlen, Modeling and simulation of railway bogie structural vibrations, Vehicle System Dynamics
/// 29 Suppl. (1998) 538–552]. Seed, band and fade are chosen.
const LOW_LEVEL: Spectrum = Spectrum {
    seed: 1,
    wavelengths: [3.0, 80.0],
    vertical_roughness: 4.032e-7,
    lateral_roughness: 2.119e-7,
    corners: [0.0206, 0.8246, 0.4380],
    fade: 20.0,
};

/// Samples of a given motion per period of the shortest irregularities, and of the filter's band: a cubic spline
/// follows that to some 1e-4 of its amplitude.
const SAMPLES: f64 = 11.0;

/// Samples by which a given motion goes on after the run: it ends at rest, which that many before is not felt any more.
const TAIL: f64 = 10.0;

/// Name of what the scene's pantographs stand on.
pub(super) fn own_name(scene: &Scene) -> VehicleVariantName {
    VehicleVariantName {
        vehicle: scene.vehicle.as_deref().map_or(NONE, Vehicle::name),
        track: OWN,
    }
}

/// All that a scene is studied on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VehicleVariants {
    /// The one that judges the others first on each track.
    pub all: Vec<VehicleVariant>,
    /// Variants that are left out though they could be expected, with the reason.
    pub left_out: Vec<String>,
}

/// All that a scene is studied on; nothing where it has no vehicle. `micro_step` (s) is that of the run that gives a
/// motion of the base.
pub(super) fn vehicle_variants(scene: &Scene, micro_step: f64) -> VehicleVariants {
    let mut found = VehicleVariants::default();
    let Some(vehicle) = scene.vehicle.as_deref() else {
        return found;
    };
    on_track(scene, vehicle, OWN, micro_step, &mut found);
    if let (Some(_), Some(track)) = (vehicle.train(), scene.track.as_deref())
        && track.irregularities == Irregularities::None
    {
        let mut rough = scene.clone();
        rough.track = Some(Arc::new(Track {
            irregularities: Irregularities::Spectrum(LOW_LEVEL),
            ..track.clone()
        }));
        on_track(&rough, vehicle, IRREGULAR, micro_step, &mut found);
    }
    found
}

/// Variants on one track.
fn on_track(scene: &Scene, own: &Vehicle, track: &'static str, micro_step: f64, found: &mut VehicleVariants) {
    let mut add = |vehicle: &'static str, scene: &Scene| -> Result<(), String> {
        let text = unreduced(scene);
        system::load(&text, vehicle, &["model.reduce=auto".to_owned()]).map_err(|error| error.to_string())?;
        let name = VehicleVariantName { vehicle, track };
        let text = text.into();
        found.all.push(VehicleVariant { name, text });
        Ok(())
    };
    let with = |vehicle: Vehicle| {
        let mut other = scene.clone();
        other.vehicle = Some(Arc::new(vehicle));
        other
    };
    let mut most_detailed = None;
    match own.train() {
        Some(train) => {
            for vehicle in [Vehicle::Full(train.clone()), Vehicle::Vertical(train.clone())] {
                let other = with(vehicle);
                // One that lacks what the scene does not say is none of this scene.
                if add(other.vehicle.as_deref().map_or(NONE, Vehicle::name), &other).is_ok() {
                    most_detailed.get_or_insert(other);
                }
            }
        }
        // It is the scene, which was read.
        None => _ = add(own.name(), scene),
    }
    let given = most_detailed.map(|detailed| {
        let motion = base_motion(&detailed, micro_step)?;
        let mut given = with(Vehicle::RigidMotion(motion));
        given.track = None;
        add("rigid_motion", &given)
    });
    let mut bare = scene.clone();
    (bare.vehicle, bare.track) = (None, None);
    let bare = add(NONE, &bare);
    for (name, outcome) in [("rigid_motion", given.unwrap_or(Ok(()))), (NONE, bare)] {
        if let Err(reason) = outcome {
            (found.left_out).push(format!("vehicle {name}, track {track}, is left out: {reason}"));
        }
    }
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

/// The scene as text, its reductions left to be chosen.
fn unreduced(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.model.reductions = Vec::new();
    scene.to_toml()
}

/// Motion of the base on a vehicle that runs over its track under the constant contact force of the start.
///
/// # Errors
/// Several pantographs, each with its own motion, or a run that does not come to its end.
fn base_motion(scene: &Scene, micro_step: f64) -> Result<GivenMotion, String> {
    let [_] = scene.pantographs.as_slice() else {
        let count = scene.pantographs.len();
        return Err(format!(
            "each of {count} pantographs has a motion of the base of its own"
        ));
    };
    let text = unreduced(scene);
    let read = system::load(&text, "vehicle", &["model.reduce=auto".to_owned()]);
    let scene = read.map_err(|error| error.to_string())?;
    let vehicle = scene.vehicle.as_deref();
    let straight = vehicle.is_none_or(|vehicle| vehicle.leaves_the_plane(scene.track.as_deref()).is_none());
    let prepared = prepare(scene, "vehicle", std::path::Path::new(""), false).map_err(|error| error.to_string())?;
    let mut own = of_pantograph(&prepared.scene, 0);
    let sample = sample(&own, micro_step);
    own.solver.micro_step = micro_step;
    own.run.duration += TAIL * sample;
    let mut pantograph = Subsystem::build(&own).map_err(|error| error.to_string())?;
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
            pantograph
                .do_step(time, sample)
                .map_err(|failure| format!("the run that gives its motion ends at {time:.3} s: {}", failure.reason))?;
        }
    }
    Ok(motion)
}

#[cfg(test)]
mod tests;
