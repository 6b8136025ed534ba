//! How the thesis' wind can be read.
//!
//! [Thesis, 5.2] says "20 m/s at a yaw angle of 15 degrees" and neither what it is relative to nor from which end of the train it
//! comes. The scene takes it over the ground, from ahead; these are the others.

use std::f64::consts::PI;

/// Speed of the train, m/s [Thesis, 5.1].
const TRAIN: f64 = 200.0 / 3.6;

/// Speed of the wind, m/s.
const WIND: f64 = 20.0;

/// Yaw angle, rad.
const YAW: f64 = 15.0 * PI / 180.0;

/// A reading.
pub(super) struct Reading {
    /// In words.
    pub name: &'static str,
    /// The keys that make it of the scene.
    pub keys: Vec<String>,
    /// Velocity of the air relative to the train, along the track and across it, m/s.
    pub air: [f64; 2],
}

/// The reading of the scenes: over the ground, from ahead.
pub(super) fn own() -> Reading {
    Reading {
        name: "over the ground, from ahead (the scene)",
        keys: Vec::new(),
        air: over_ground(YAW),
    }
}

/// The air relative to the train of a wind over the ground that comes from `yaw` (rad), m/s.
fn over_ground(yaw: f64) -> [f64; 2] {
    [-TRAIN - WIND * yaw.cos(), -WIND * yaw.sin()]
}

/// Drag and lift of the pan-head of [Thesis, Table 5] in air of 1.225 kg/m³ that moves past it with `air` (m/s) [Thesis, Eq. (18)], N:
/// what Figs. 11 and 12 show, of a pan-head that moves with the train.
pub(super) fn on_even_head([along, across]: [f64; 2]) -> [f64; 2] {
    const DENSITY: f64 = 1.225;
    const DRAG: f64 = 0.05;
    const LIFT: f64 = 0.02;
    [DRAG, LIFT].map(|coefficient| 0.5 * DENSITY * coefficient * (along * along + across * across))
}

/// The other readings.
pub(super) fn readings() -> Vec<Reading> {
    let (s, c) = YAW.sin_cos();
    let ground = |name, yaw: f64| Reading {
        name,
        keys: vec![format!("wind.yaw_deg={}", yaw.to_degrees())],
        air: over_ground(yaw),
    };
    // The train meets the air at the yaw angle: WIND sin γ = tan YAW (TRAIN + WIND cos γ).
    let met = YAW + (TRAIN * s / WIND).asin();
    // Air that moves past the train like this, along from ahead, as wind over the ground.
    let past = |name, along: f64, across: f64| {
        let record = format!("wind.record=[[0, {:?}, {:?}, 0]]", TRAIN - along, -across);
        Reading {
            name,
            keys: vec!["wind.speed=0".to_owned(), record],
            air: [-along, -across],
        }
    };
    vec![
        ground("over the ground, from behind", PI - YAW),
        ground("over the ground, such that the train meets the air at 15 degrees", met),
        past("20 m/s in all past the train, from ahead", WIND * c, WIND * s),
        past("20 m/s in all past the train, knee leading", -WIND * c, WIND * s),
        Reading {
            name: "still air",
            keys: vec!["wind.speed=0".to_owned()],
            air: [-TRAIN, 0.0],
        },
    ]
}
