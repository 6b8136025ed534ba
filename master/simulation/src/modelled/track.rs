//! Model of the track in words.

use scene::{Irregularities, PantographModel, Scene, Track, Train, Vehicle};

use super::part;
use results::Part;

/// Rails of a scene in words, for pantographs whose bases start at these x (m).
pub(super) fn track(scene: &Scene, bases: &[f64]) -> Part {
    let Some(train) = scene.vehicle.as_deref().and_then(Vehicle::train) else {
        return part("track", false, "no wheel runs on it".to_owned());
    };
    let Some(track) = scene.track.as_deref() else {
        return part(
            "track",
            false,
            "scene has no [track]: straight, level and smooth".to_owned(),
        );
    };
    let mut reasons = curves(scene, train, track, bases);
    if reasons.is_empty() {
        reasons.push("straight and level".to_owned());
    }
    reasons.push(match &track.irregularities {
        Irregularities::None => "smooth".to_owned(),
        Irregularities::Spectrum(spectrum) => format!(
            "irregularities from spectra, seed {}, wavelengths {} to {} m",
            spectrum.seed, spectrum.wavelengths[0], spectrum.wavelengths[1]
        ),
        Irregularities::Points(points) => format!("irregularities from {} points", points.x.len()),
    });
    if !track.curves.is_empty() {
        reasons.extend(left_out(scene));
    }
    part("track", true, reasons.join("; "))
}

/// The curves, and what they ask of the vehicle.
fn curves(scene: &Scene, train: &Train, track: &Track, bases: &[f64]) -> Vec<String> {
    let (speed, gravity, distance) = (scene.run.speed, scene.gravity(), train.wheels.distance);
    let ahead = train.foremost_wheel().max(0.0) + speed * scene.run.duration;
    let farthest = bases.iter().copied().reduce(f64::max).map(|base| base + ahead);
    let described = |curve: &scene::Curve| {
        let [start, _, _, end] = curve.corners();
        if let Some(farthest) = farthest.filter(|farthest| start - 0.5 * curve.rounding > *farthest) {
            return format!(
                "{} curve from {start:.1} to {end:.1} m, which the run does not reach: its foremost wheel or base \
                 comes to {farthest:.1} m",
                curve.direction
            );
        }
        let outward = curve.uncompensated_acceleration(speed, gravity, distance);
        let (side, name) = if outward >= 0.0 {
            ("outward", "deficiency")
        } else {
            ("inward", "excess")
        };
        format!(
            "{} curve from {start:.1} to {end:.1} m, radius {} m, cant {:.0} mm, transitions {} m, at this speed \
             {:.2} m/s² {side} uncompensated \
             (cant {name} {:.0} mm)",
            curve.direction,
            curve.radius,
            1e3 * curve.cant,
            curve.transition,
            outward.abs(),
            1e3 * curve.cant_deficiency(speed, gravity, distance).abs(),
        )
    };
    track.curves.iter().map(described).collect()
}

/// Effects of curves on line, pantographs and wind, and the effects left out.
fn left_out(scene: &Scene) -> Vec<String> {
    let mut reasons = vec![
        "the line is computed along the developed middle of the track, heights and staggers measured from the plane \
         of the rails: left \
         out are the radial pull of its wires, the offset of its chords between supports from the arc, and the part \
         of its weight \
         that leans in a canted curve"
            .to_owned(),
    ];
    let models = || scene.pantographs.iter().map(|pantograph| &pantograph.model);
    if models().any(|model| matches!(model, PantographModel::Lumped(_))) {
        reasons.push(
            "of a lumped pantograph's base the rise alone is felt: its strip does not sway with the vehicle".to_owned(),
        );
    }
    if scene.wind.is_some() {
        reasons.push("the wind keeps its direction relative to the track".to_owned());
    }
    reasons
}
