//! Readings of the thesis' wind.
//!
//! [Thesis, 5.2] says "20 m/s at a yaw angle of 15 degrees" and neither what the angle is relative to nor from which
//! end of the train the wind comes. The scene takes the wind over the ground, from ahead; these are the others.

use std::f64::consts::PI;

use scene::{PantographModel, Scene};

use super::open::Value;

/// Speed of the train, m/s [Thesis, 5.1].
const TRAIN: f64 = 200.0 / 3.6;

/// Speed of the wind, m/s.
const WIND: f64 = 20.0;

/// Yaw angle, rad.
const YAW: f64 = 15.0 * PI / 180.0;

/// The reading of the scenes, in words.
pub(super) const OWN: &str = "over the ground, from ahead (the scene)";

/// Drag and lift of a pan-head that moves with the train [Thesis, Eq. (18)], N: what Figs. 11 and 12 show, with `ρ`, `C
/// A` and wind of the scene.
///
/// ```text
/// F = ½ ρ C A |v_wind − v_train|²
/// ```
///
/// `None` where no steady wind acts on the head, or by other coefficients than one of each.
pub(super) fn on_even_head(scene: &Scene) -> Option<[f64; 2]> {
    let wind = scene.wind.as_ref()?;
    if wind.gust.is_some() || wind.turbulence.is_some() || wind.record.len() > 1 {
        return None;
    }
    let PantographModel::Linkage(linkage) = &scene.pantographs.first()?.model else {
        return None;
    };
    let mut surfaces = wind.pantograph.as_ref()?.surfaces.iter();
    let head = surfaces.find(|surface| surface.body == linkage.strip.body)?;
    let ([drag], [lift], []) = (&head.drag[..], &head.lift[..], &head.markers[..]) else {
        return None;
    };
    let mut air = scene.wind_field()?.velocity(0.0, 0.0);
    air.x -= scene.run.speed;
    let pressure = 0.5 * wind.air_density * air.norm_squared();
    Some([drag, lift].map(|coefficient| coefficient * pressure))
}

/// The other readings, in words and by the keys that make them of the scene.
pub(super) fn readings() -> Vec<Value> {
    let (s, c) = YAW.sin_cos();
    let reading = |name: &str, keys: Vec<String>| {
        let name = name.to_owned();
        Value { name, keys }
    };
    let ground = |name, yaw: f64| reading(name, vec![format!("wind.yaw_deg={}", yaw.to_degrees())]);
    // The train meets the air at the yaw angle: WIND sin γ = tan YAW (TRAIN + WIND cos γ).
    let met = YAW + (TRAIN * s / WIND).asin();
    // Air that moves past the train like this, along from ahead, as wind over the ground.
    let past = |name, along: f64, across: f64| {
        let record = format!("wind.record=[[0, {:?}, {:?}, 0]]", TRAIN - along, -across);
        reading(name, vec!["wind.speed=0".to_owned(), record])
    };
    vec![
        ground("over the ground, from behind", PI - YAW),
        ground("over the ground, such that the train meets the air at 15 degrees", met),
        past("20 m/s in all past the train, from ahead", WIND * c, WIND * s),
        past("20 m/s in all past the train, knee leading", -WIND * c, WIND * s),
        reading("still air", vec!["wind.speed=0".to_owned()]),
    ]
}
