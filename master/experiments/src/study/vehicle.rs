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

use scene::{Irregularities, Scene, Spectrum, Track, Vehicle};

use crate::engine::table::AUTO;
use simulation::base_motion::base_motion;

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
        reduced(&text, vehicle)?;
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
        let detailed = reduced(&unreduced(&detailed), "vehicle")?;
        let motion = base_motion(detailed, micro_step).map_err(|error| error.to_string())?;
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

/// The scene of a text with those reductions that change nothing.
fn reduced(text: &str, name: &str) -> Result<Scene, String> {
    system::load(text, name, &[format!("model.reduce={AUTO}")]).map_err(|error| error.to_string())
}

/// The scene as text, its reductions left to be chosen.
fn unreduced(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.model.reductions = Vec::new();
    scene.to_toml()
}

#[cfg(test)]
mod tests;
