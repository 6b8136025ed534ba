//! EN 50119: extremes of the contact force, space for the uplift, speed against the speed of waves.

use scene::Electrification;

use super::{Bound, Conditions, Figures, Limit, Line, kmh, system_unknown};

const NAME: &str = "EN 50119";

/// Largest share of the speed of waves that a train may run at, –.  [EN 50119:2009, 5.2.4; Bane NOR, TRV:00599]
const MAX_SPEED_RATIO: f64 = 0.7;

/// Largest contact force, N.  `[EN 50119:2009, Table 4]`, remembered
///
/// | | up to 200 km/h | above |
/// | --- | --- | --- |
/// | AC | 300 | 350 |
/// | DC | 300 | 400 |
fn largest(system: Electrification, speed_kmh: f64) -> f64 {
    match (system.is_alternating(), speed_kmh > 200.0) {
        (_, false) => 300.0,
        (true, true) => 350.0,
        (false, true) => 400.0,
    }
}

/// Largest gradient of the contact wire against the track and largest change of it at a support, – and –, at a speed in
/// km/h.  `[EN 50119:2009, 5.10.3]`, remembered
#[must_use]
pub fn gradient_limit(speed_kmh: f64) -> (f64, f64) {
    const TABLE: [(f64, f64, f64); 7] = [
        (50.0, 40.0, 40.0),
        (60.0, 50.0, 100.0),
        (100.0, 167.0, 333.0),
        (120.0, 250.0, 500.0),
        (160.0, 300.0, 600.0),
        (200.0, 500.0, 1000.0),
        (250.0, 1000.0, 2000.0),
    ];
    let row = TABLE.iter().find(|(speed, ..)| speed_kmh <= speed + 1e-9);
    row.map_or((0.0, 0.0), |(_, gradient, change)| (1.0 / gradient, 1.0 / change))
}

/// Limits for one pantograph: in Table 4 the maximum goes with system and speed, the minimum is positive.
pub(super) fn of_pantograph(conditions: &Conditions, figures: &Figures) -> [Limit; 2] {
    let table = (NAME, "2009", "5.2.5.2, Table 4");
    let speed = conditions.speed_kmh();
    let max = Limit::new(table, "max", figures.force.map(|f| f.max), "N")
        .remembered()
        .remark("largest filtered force");
    let max = match conditions.line.electrification {
        // The same for all systems.
        None if speed <= 200.0 => max
            .bounded(Bound::AtMost, largest(Electrification::Ac25Kv, speed))
            .because("every system, up to 200 km/h"),
        None => max.not_applicable(system_unknown()),
        Some(system) => max
            .bounded(Bound::AtMost, largest(system, speed))
            .because(format!("{system}, {speed:.0} km/h")),
    };
    let min = Limit::new(table, "min", figures.force.map(|f| f.min), "N")
        .bounded(Bound::Above, 0.0)
        .remembered()
        .because("every system and speed")
        .remark("smallest filtered force");
    [max, min]
}

/// Limits for the line at rest: speed against the speed of waves, largest gradient of the contact wire and largest
/// change of it, – and –; none where no strip runs over two supports.
pub(super) fn at_rest(line: &Line, speed: f64, gradient: Option<f64>, change: Option<f64>) -> [Limit; 3] {
    let speed_kmh = kmh(speed);
    let (most, most_change) = gradient_limit(speed_kmh);
    // Heights are found to fractions of a micrometre.
    let per_mille = |value: f64| (1e6 * value.abs()).round() / 1e3;
    let limit = |quantity: &str, value: Option<f64>, most: f64| {
        Limit::new((NAME, "2009", "5.10.3"), quantity, value.map(per_mille), "‰")
            .bounded(Bound::AtMost, 1e3 * most)
            .remembered()
            .because(format!("{speed_kmh:.0} km/h"))
    };
    let gradient = limit("gradient", gradient, most).remark("chord between supports");
    let change = limit("gradient_change", change, most_change).remark("of the chords at a support");
    [waves(line, speed), gradient, change]
}

/// Limits for the line.
///
/// The space that a steady arm leaves for the rise of the contact wire has to be twice the simulated uplift `S₀`, one
/// and a half times where a stop limits it.  `[EN 50119:2009, 5.10.2; TSI ENE, 4.2.12]`, remembered
pub(super) fn of_line(conditions: &Conditions) -> [Limit; 2] {
    let line = &conditions.line;
    let factor = if line.uplift_stop { 1.5 } else { 2.0 };
    let space = Limit::new(
        (NAME, "2009", "5.10.2 (TSI ENE 4.2.12)"),
        "free_uplift",
        line.free_uplift,
        "m",
    )
    .remembered();
    // A wire that only sinks needs no space.
    let needed = conditions.uplift.map(|uplift| factor * uplift.max(0.0));
    let space = match line.free_uplift {
        None => {
            let needed = needed.map_or_else(String::new, |needed| {
                format!("; the uplift of this run needs {:.0} mm", 1e3 * needed)
            });
            space.not_applicable(format!(
                "the space at the steady arm is not given: set catenary.registration_arms.free_uplift (m){needed}"
            ))
        }
        Some(_) => space
            .bounded(Bound::AtLeast, needed)
            .because(if line.uplift_stop {
                "a stop limits the steady arm (catenary.registration_arms.uplift_stop)"
            } else {
                "no stop limits the steady arm"
            })
            .formula(format!("{factor} times the largest uplift of the run")),
    };
    [space, waves(line, conditions.speed)]
}

/// Limit of the running speed (m/s) by the speed of waves.
fn waves(line: &Line, speed: f64) -> Limit {
    let ratio = line.wave_speed.map(|waves| speed / waves);
    let waves = Limit::new((NAME, "2009", "5.2.4"), "speed_ratio", ratio, "–");
    match line.wave_speed {
        None => waves.not_applicable("the line is a supplied FMU: its wave speed is not known"),
        Some(waves_at) => waves
            .bounded(Bound::AtMost, MAX_SPEED_RATIO)
            .because("every system and speed")
            .remark(format!("waves of the contact wire run at {:.0} km/h", 3.6 * waves_at)),
    }
}
