//! How the thesis' wind can be read.
//!
//! [Thesis, 5.2] says "20 m/s at a yaw angle of 15 degrees" and neither what it is relative to nor from which end of the train it
//! comes. The scene takes it over the ground, from ahead; these are the others.

/// Speed of the train, m/s [Thesis, 5.1].
const TRAIN: f64 = 200.0 / 3.6;

/// Speed of the wind, m/s.
const WIND: f64 = 20.0;

/// Yaw angle, rad.
const YAW: f64 = 15.0 * std::f64::consts::PI / 180.0;

/// A reading and the keys that make it.
pub(super) fn readings() -> Vec<(&'static str, Vec<String>)> {
    let (s, c) = YAW.sin_cos();
    // The train meets the air at the yaw angle: WIND sin γ = tan YAW (TRAIN + WIND cos γ).
    let met = (YAW + (TRAIN * s / WIND).asin()).to_degrees();
    // Air that moves past the train like this, along from ahead, as wind over the ground.
    let past = |along: f64, across: f64| {
        let record = format!("wind.record=[[0, {:?}, {:?}, 0]]", TRAIN - along, -across);
        vec!["wind.speed=0".to_owned(), record]
    };
    vec![
        ("over the ground, from behind", vec!["wind.yaw_deg=165".to_owned()]),
        (
            "over the ground, such that the train meets the air at 15 degrees",
            vec![format!("wind.yaw_deg={met}")],
        ),
        ("20 m/s in all past the train, from ahead", past(WIND * c, WIND * s)),
        ("20 m/s in all past the train, knee leading", past(-WIND * c, WIND * s)),
        ("still air", vec!["wind.speed=0".to_owned()]),
    ]
}
