//! A contact wire beside the strip: no contact force there, and no loss of contact that the line or the
//! pantograph could be blamed for.

use scene::{Catenary, PantographModel, Scene, Vehicle};
use vehicle::GivenMotion;

use crate::sliding_joint;
use results::Record;

/// Most times at which a given motion is looked at; a longer one is looked at less often.
const SAMPLES: f64 = 2e4;

/// Facts of a strip beside the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Beside {
    /// First time, s.
    from: f64,
    /// Last time, s.
    to: f64,
    /// Share of the samples from the first one to the last, –.
    share: f64,
    /// Largest distance of the wire from the middle of the strip, m.
    largest: f64,
    /// When that is, s.
    at: f64,
}

/// Stretch of the samples (time in s, distance of the wire from the middle of the strip in m) those further than `half`
/// m.
fn beside(samples: impl Iterator<Item = (f64, f64)>, half: f64) -> Option<Beside> {
    let mut found: Option<Beside> = None;
    let (mut away, mut all, mut all_to_last) = (0.0, 0.0, 0.0);
    for (time, aside) in samples {
        let distance = aside.abs();
        all += f64::from(u8::from(found.is_some()));
        if distance > half {
            let known = found.get_or_insert_with(|| {
                all = 1.0;
                Beside {
                    from: time,
                    to: time,
                    share: 1.0,
                    largest: 0.0,
                    at: time,
                }
            });
            away += 1.0;
            all_to_last = all;
            known.to = time;
            if distance > known.largest {
                (known.largest, known.at) = (distance, time);
            }
        }
    }
    found.map(|known| Beside {
        share: away / all_to_last,
        ..known
    })
}

/// Pantographs (from 0) with half the width of their strips, or half the length of a head with horns, m.
///
/// None where that counts for nothing: a strip that is held on the wire, a line or a pantograph that is supplied, whose
/// strip and wire are not known.
fn reaches(scene: &Scene) -> Vec<(usize, f64)> {
    if sliding_joint::holds(scene) || scene.modelled_line().is_none() {
        return Vec::new();
    }
    let strips = scene.pantographs.iter().enumerate();
    strips
        .filter_map(|(index, pantograph)| Some((index, pantograph.half_length()?)))
        .collect()
}

/// Notes of a run on wires beside strips.
#[must_use]
pub fn remarks(scene: &Scene, record: &Record) -> Vec<String> {
    let seen = reaches(scene).into_iter().filter_map(|(index, half)| {
        // Strips of a head see the same wire one after the other: the first that it passes is told of.
        let strips = record.pantographs.get(index)?.each_strip().iter();
        let found = strips.filter_map(|strip| {
            let aside = strip.aside.iter().copied();
            beside(record.time.iter().copied().zip(aside), half)
        });
        let found = found.min_by(|a, b| a.from.total_cmp(&b.from))?;
        Some(remark(scene, index, half, &found, "the wire passed"))
    });
    seen.collect()
}

/// Foreseen overrun under a given motion of the base, with the wire where it is at rest and the strip over the middle
/// of the base; to a lumped pantograph nothing, which feels the rise of its base alone.
#[must_use]
pub fn foreseen(scene: &Scene) -> Vec<String> {
    let (Some(Vehicle::RigidMotion(entry)), Some((line, _))) = (scene.vehicle.as_deref(), scene.modelled_line()) else {
        return Vec::new();
    };
    let motion = GivenMotion::new(entry);
    let step = scene.run.output_step.max(scene.run.duration / SAMPLES);
    let count = (scene.run.duration / step) as usize;
    let mechanisms = reaches(scene).into_iter().filter(|(index, _)| {
        let model = &scene.pantographs[*index].model;
        matches!(model, PantographModel::Linkage(_))
    });
    let seen = mechanisms.filter_map(|(index, half)| {
        let samples = (0..=count).map(|k| {
            let time = k as f64 * step;
            (time, aside(&motion, line, scene.head_x(index, time), time))
        });
        let found = beside(samples, half)?;
        Some(remark(
            scene,
            index,
            half,
            &found,
            "vehicle.motion is such that the wire passes",
        ))
    });
    seen.collect()
}

/// Distance of the wire at rest from the middle of a strip that a motion carries along, m, along the strip; `x` m is
/// where the strip is without the motion.
fn aside(motion: &GivenMotion, line: &Catenary, x: f64, time: f64) -> f64 {
    let ([ahead, aside, up], [_, lateral, upward]) = motion.above(line.chord_height(x), time);
    (line.lateral(x + ahead) - aside) * lateral - up * upward
}

fn remark(scene: &Scene, index: usize, half: f64, found: &Beside, what: &str) -> String {
    let spells = if found.share < 1.0 {
        format!(", {:.0} % of that time", 100.0 * found.share)
    } else {
        String::new()
    };
    let (beside, extent) = match scene.pantographs[index].horns() {
        Some(_) => ("its head, over the end of a horn (dewirement)", "length of the head"),
        None => ("its strip", "width of the strip"),
    };
    format!(
        "pantograph {}: {what} beside {beside}, where there is no contact force, from t = {:.3} s (x = {:.1} m) to \
         {:.3} s{spells}: up \
         to {:.3} m from the middle of the strip, at t = {:.3} s, and half the {extent} is {half} m",
        index + 1,
        found.from,
        scene.head_x(index, found.from),
        found.to,
        found.largest,
        found.at
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_last_time_and_the_largest_distance_are_found() {
        let samples = [(0.0, 0.1), (0.1, -0.6), (0.2, 0.2), (0.3, 0.9), (0.4, 0.7), (0.5, 0.0)];
        let found = beside(samples.into_iter(), 0.5).unwrap();
        let expected = Beside {
            from: 0.1,
            to: 0.4,
            share: 0.75,
            largest: 0.9,
            at: 0.3,
        };
        assert_eq!(found, expected);
        assert_eq!(beside(samples.into_iter(), 0.9), None);
    }

    /// The thesis' linkage on a base that is moved aside by this much, m.
    fn moved(motion: &str) -> Scene {
        let text = include_str!("../../../scenes/thesis-pantograph.toml");
        system::load(text, "scene.toml", &[moved_by(motion)]).unwrap()
    }

    fn moved_by(motion: &str) -> String {
        format!("vehicle={{ model = \"rigid_motion\", motion = {{ time = [0, 0.5, 1.5], {motion} }} }}")
    }

    #[test]
    fn a_motion_that_takes_the_strip_off_the_wire_is_foreseen() {
        let said = foreseen(&moved("y = [0, 3, 0]"));
        assert_eq!(said.len(), 1);
        // The spline through the samples, at rest at both ends, goes beyond the second one.
        assert!(
            said[0].contains("beside its strip")
                && said[0].contains("up to 3.306 m from the middle of the strip, at t = 0.643 s"),
            "{}",
            said[0]
        );
        assert!(said[0].ends_with("half the width of the strip is 0.8 m"), "{}", said[0]);
        assert_eq!(foreseen(&moved("y = [0, 0.7, 0]")), Vec::<String>::new());
        // A lumped pantograph does not follow.
        let text = include_str!("../../../scenes/thesis-lumped.toml");
        let lumped = system::load(text, "scene.toml", &[moved_by("y = [0, 3, 0]")]).unwrap();
        assert_eq!(foreseen(&lumped), Vec::<String>::new());
        // At the height of the wire a roll of 0.2 rad is a metre.
        assert_eq!(foreseen(&moved("roll = [0, 0.2, 0]")).len(), 1);
    }
}
