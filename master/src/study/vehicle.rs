//! What the pantograph stands on: each model of the vehicle, on the scene's track and on one with irregularities.
//!
//! | model | made from the scene by |
//! | --- | --- |
//! | none | leaving out `[vehicle]` and `[track]`: the base moves on a straight line |
//! | rigid_motion | the motion of the base on the most detailed model below, without its pitch, under the constant contact force of the start |
//! | vertical, full | naming the model, where the scene has what it needs |
//!
//! The most detailed model that the scene has what it needs for is what the others are judged by, each on its own track, with the same
//! mesh and steps and with those reductions that change nothing.

use std::sync::Arc;

use component::Component;
use scene::{GivenMotion, Irregularities, Scene, Spectrum, Track, Vehicle};
use vehicle::Subsystem;

use crate::inprocess::of_pantograph;
use crate::simulation::prepare;

/// A vehicle and a track other than the scene's, and the scene with them.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// What it is called.
    pub name: StandingName,
    /// The scene with it.
    pub text: Arc<str>,
}

/// A vehicle and a track by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct StandingName {
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

/// Irregularities of a good main line: the spectra of ORE B176 at their lower level [ORE B176 RP1, Utrecht 1989; as given by Claus &
/// Schiehlen, Modeling and simulation of railway bogie structural vibrations, Vehicle System Dynamics 29 Suppl. (1998) 538–552]. Seed,
/// band and fade are chosen.
const LOW_LEVEL: Spectrum = Spectrum {
    seed: 1,
    wavelengths: [3.0, 80.0],
    vertical_roughness: 4.032e-7,
    lateral_roughness: 2.119e-7,
    corners: [0.0206, 0.8246, 0.4380],
    fade: 20.0,
};

/// Time between two samples of a given motion, s: eleven per period of the shortest irregularities at 200 km/h, which a cubic spline
/// follows to some 1e-4 of their amplitude.
const SAMPLE: f64 = 5e-3;

/// Time that a given motion goes on after the run, s: it ends at rest, which ten samples before is not felt any more.
const TAIL: f64 = 10.0 * SAMPLE;

/// Name of what the scene's pantographs stand on.
#[must_use]
pub fn own_name(scene: &Scene) -> StandingName {
    StandingName {
        vehicle: scene.vehicle.as_deref().map_or(NONE, Vehicle::name),
        track: OWN,
    }
}

/// All that a scene is studied on, the one that judges the others first on each track; none where it has no vehicle. `micro_step` (s) is
/// that of the run that gives a motion of the base.
#[must_use]
pub fn standings(scene: &Scene, micro_step: f64) -> Vec<Standing> {
    let Some(vehicle) = scene.vehicle.as_deref() else {
        return Vec::new();
    };
    let mut found = on_track(scene, vehicle, OWN, micro_step);
    if let (Some(_), Some(track)) = (vehicle.train(), scene.track.as_deref())
        && track.irregularities == Irregularities::None
    {
        let mut rough = scene.clone();
        rough.track = Some(Arc::new(Track {
            irregularities: Irregularities::Spectrum(LOW_LEVEL),
            ..track.clone()
        }));
        found.extend(on_track(&rough, vehicle, IRREGULAR, micro_step));
    }
    found
}

/// What belongs to one track.
fn on_track(scene: &Scene, own: &Vehicle, track: &'static str, micro_step: f64) -> Vec<Standing> {
    let mut standings = Vec::new();
    let mut add = |vehicle: &'static str, scene: &Scene| -> bool {
        let text = unreduced(scene);
        let taken = Scene::from_toml(&text, vehicle, &["model.reduce=auto".to_owned()]).is_ok();
        if taken {
            let name = StandingName { vehicle, track };
            let text = text.into();
            standings.push(Standing { name, text });
        }
        taken
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
                if add(other.vehicle.as_deref().map_or(NONE, Vehicle::name), &other) {
                    most_detailed.get_or_insert(other);
                }
            }
        }
        None => _ = add(own.name(), scene),
    }
    if let Some(motion) = most_detailed.and_then(|detailed| base_motion(&detailed, micro_step)) {
        let mut given = with(Vehicle::RigidMotion(motion));
        given.track = None;
        add("rigid_motion", &given);
    }
    let mut bare = scene.clone();
    (bare.vehicle, bare.track) = (None, None);
    add(NONE, &bare);
    standings
}

/// The scene as text, its reductions left to be chosen.
fn unreduced(scene: &Scene) -> String {
    let mut scene = scene.clone();
    scene.model.reductions = Vec::new();
    scene.to_toml()
}

/// How the base moves on a vehicle that runs over its track under the constant contact force of the start; nothing where there are
/// several pantographs, each with a motion of its own.
fn base_motion(scene: &Scene, micro_step: f64) -> Option<GivenMotion> {
    let [_] = scene.pantographs.as_slice() else {
        return None;
    };
    let text = unreduced(scene);
    let scene = Scene::from_toml(&text, "vehicle", &["model.reduce=auto".to_owned()]).ok()?;
    let straight = scene
        .vehicle
        .as_deref()?
        .leaves_the_plane(scene.track.as_deref())
        .is_none();
    let mut own = of_pantograph(
        &prepare(scene, "vehicle", std::path::Path::new(""), false).ok()?.scene,
        0,
    );
    own.solver.micro_step = micro_step;
    own.run.duration += TAIL;
    let mut pantograph = Subsystem::build(&own).ok()?;
    let height = pantograph.pantograph().0.base_z();
    let mut motion = GivenMotion::default();
    let steps = (own.run.duration / SAMPLE).ceil() as usize;
    for step in 0..=steps {
        let time = step as f64 * SAMPLE;
        let (position, roll) = (pantograph.base().position, pantograph.base_roll());
        motion.time.push(time);
        if straight {
            // Rounding would be a lateral motion to the line.
            motion.y.push(0.0);
            motion.z.push(position.z - height);
            motion.roll.push(0.0);
        } else {
            // The roll is about the direction of travel at the top of rail, below the base.
            motion.y.push(position.y + roll.sin() * height);
            motion.z.push(position.z - roll.cos() * height);
            motion.roll.push(roll);
        }
        pantograph.do_step(time, SAMPLE).ok()?;
    }
    Some(motion)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The scene of the thesis on a short line.
    fn thesis(overrides: &[&str]) -> Scene {
        let text = include_str!("../../../scenes/thesis.toml");
        let mut keys = vec![
            "catenary.spans=6",
            "run.duration=2.0",
            "run.evaluate={ time = [0.5, 2.0] }",
        ];
        keys.extend(overrides);
        let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
        Scene::from_toml(text, "thesis.toml", &keys).unwrap()
    }

    fn names(standings: &[Standing]) -> Vec<(&'static str, &'static str)> {
        let name = |standing: &Standing| (standing.name.track, standing.name.vehicle);
        standings.iter().map(name).collect()
    }

    #[test]
    fn a_scene_is_studied_on_every_vehicle_that_it_has_what_it_needs_for() {
        let all = ["full", "vertical", "rigid_motion", NONE];
        let both = [OWN, IRREGULAR]
            .into_iter()
            .flat_map(|track| all.map(|vehicle| (track, vehicle)));
        assert_eq!(names(&standings(&thesis(&[]), 2e-3)), both.collect::<Vec<_>>());
        // A track of its own is the only one.
        let rough = thesis(&[
            "track.irregularities={ model = \"points\", x = [90.0, 110.0, 130.0], z_left = [0.0, 1e-3, 0.0] }",
        ]);
        assert_eq!(names(&standings(&rough, 2e-3)), all.map(|vehicle| (OWN, vehicle)));
        let mut bumpy = thesis(&[]);
        bumpy.track = None;
        bumpy.vehicle = Some(Arc::new(Vehicle::RigidMotion(GivenMotion {
            time: vec![0.0, 1.0],
            y: vec![0.0; 2],
            z: vec![0.0, 1e-3],
            roll: vec![0.0; 2],
            file: None,
        })));
        assert_eq!(names(&standings(&bumpy, 2e-3)), [(OWN, "rigid_motion"), (OWN, NONE)]);
        let (mut bare, mut plain) = (thesis(&[]), thesis(&[]));
        (bare.vehicle, bare.track) = (None, None);
        assert!(standings(&bare, 2e-3).is_empty());
        // Without a profile no wheel can roll.
        let Some(Vehicle::Full(mut train)) = plain.vehicle.as_deref().cloned() else {
            panic!("a full vehicle");
        };
        train.wheels.profile = None;
        plain.vehicle = Some(Arc::new(Vehicle::Vertical(train)));
        assert_eq!(
            names(&standings(&plain, 2e-3))[..2],
            [(OWN, "vertical"), (OWN, "rigid_motion")]
        );
    }

    #[test]
    fn a_given_motion_is_that_of_the_base_on_the_vehicle_it_stands_for() {
        let all = standings(&thesis(&[]), 1e-3);
        let scene = |track: &str, vehicle: &str| {
            let standing = all
                .iter()
                .find(|found| found.name.track == track && found.name.vehicle == vehicle);
            let keys = ["model.reduce=auto".to_owned(), "solver.micro_step=0.001".to_owned()];
            let scene = Scene::from_toml(&standing.unwrap().text, vehicle, &keys).unwrap();
            prepare(scene, vehicle, std::path::Path::new(""), false).unwrap().scene
        };
        let Some(Vehicle::RigidMotion(smooth)) = scene(OWN, "rigid_motion").vehicle.as_deref().cloned() else {
            panic!("a given motion");
        };
        // Nothing moves on smooth track; the line is planar and stays so.
        let [low, high] = [f64::min, f64::max].map(|of| smooth.z.iter().copied().reduce(of).unwrap());
        assert!(high - low < 1e-9, "{low} {high}");
        assert!(smooth.y.iter().chain(&smooth.roll).all(|value| *value == 0.0));
        let [mut full, mut given] = ["full", "rigid_motion"]
            .map(|vehicle| Subsystem::build(&of_pantograph(&scene(IRREGULAR, vehicle), 0)).unwrap());
        let (mut farthest, mut travel) = (0.0_f64, [0.0_f64; 3]);
        let start = full.base().position;
        for step in 0..2000 {
            let time = f64::from(step) * 1e-3;
            for side in [&mut full, &mut given] {
                side.do_step(time, 1e-3).unwrap();
            }
            let (expected, found) = (full.base().position, given.base().position);
            farthest = farthest.max((expected - found).yz().amax());
            farthest = farthest.max((full.base_roll() - given.base_roll()).abs());
            let moved = expected - start;
            travel = [
                travel[0].max(moved.y.abs()),
                travel[1].max(moved.z.abs()),
                travel[2].max(full.base_roll().abs()),
            ];
        }
        assert!(travel.iter().all(|moved| *moved > 2e-4), "{travel:?}");
        // Between samples the spline is off by some 1e-4 of the shortest waves; the end of the record is where it comes to rest.
        assert!(farthest < 2e-6, "{farthest} m of {travel:?}");
    }
}
