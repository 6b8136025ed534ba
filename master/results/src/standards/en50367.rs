//! EN 50367 and the table of the TSI that goes with it: mean force, spread, maximum, uplift, amplitude, arcing.

use scene::Electrification::{self, Ac15Kv, Ac25Kv, Dc1_5Kv, Dc3Kv};

use super::{Bound, Certainty, Conditions, Figures, Limit, SHORTEST_ARC, system_unknown};

const NAME: &str = "EN 50367";
/// The clauses of the edition that the thesis quotes are not given there.
const QUOTED: (&str, &str, &str) = (NAME, "2006", "as quoted in [Thesis, 4.2.3]");
const TSI: (&str, &str, &str) = ("TSI ENE", "2014", "4.2.12, Table 4.2.12");

/// Largest contact force, N.  [Thesis, 4.2.3]
const MAX_FORCE: f64 = 350.0;
/// Largest ratio of standard deviation and mean force, –.  [Thesis, 4.2.3]
const MAX_STD_RATIO: f64 = 0.3;
/// Largest uplift at a support, m.  [Thesis, 4.2.3]
const MAX_UPLIFT: f64 = 0.120;
/// Largest vertical amplitude of the strip, m.  [Thesis, 4.2.3]
const MAX_AMPLITUDE: f64 = 0.080;
/// Largest percentage of arcing, %.  [Thesis, 4.2.3]
const MAX_ARCING: f64 = 0.2;

/// `F = a v² + b`, v in km/h.
struct Curve {
    /// N·h²/km².
    a: f64,
    /// N.
    b: f64,
    certainty: Certainty,
}

impl Curve {
    fn at(&self, speed_kmh: f64) -> f64 {
        self.a * speed_kmh * speed_kmh + self.b
    }

    fn text(&self) -> String {
        format!("{} v² + {} N", self.a, self.b)
    }
}

/// Largest mean force.  `[EN 50367:2012, Table 6]`
///
/// | system | up to 200 km/h | above |
/// | --- | --- | --- |
/// | AC | 0.00047 v² + 90, in design programs for Norwegian lines | 0.00097 v² + 70, `[Thesis, 4.2.3]`, `[OCS]` |
/// | DC 3 kV | 0.00097 v² + 110, `[OCS]` | the same, remembered |
/// | DC 1.5 kV | 0.00097 v² + 140, `[OCS]` | 0.00228 v² + 90, remembered |
///
/// The AC branches meet: 108.8 N at 200 km/h.
fn upper(system: Electrification, speed_kmh: f64) -> Curve {
    use Certainty::{Cited, Remembered};
    let fast = speed_kmh > 200.0;
    let (a, b, certainty) = match (system, fast) {
        (Ac25Kv | Ac15Kv, false) => (0.00047, 90.0, Cited),
        (Ac25Kv | Ac15Kv, true) => (0.00097, 70.0, Cited),
        (Dc3Kv, false) => (0.00097, 110.0, Cited),
        (Dc3Kv, true) => (0.00097, 110.0, Remembered),
        (Dc1_5Kv, false) => (0.00097, 140.0, Cited),
        (Dc1_5Kv, true) => (0.00228, 90.0, Remembered),
    };
    Curve { a, b, certainty }
}

/// Smallest mean force.  `[EN 50367:2012, Table 6]`, remembered throughout
fn lower(system: Electrification) -> Curve {
    let (a, b) = match system {
        Ac25Kv | Ac15Kv => (0.00047, 60.0),
        Dc3Kv => (0.00096, 90.0),
        Dc1_5Kv => (0.00112, 70.0),
    };
    Curve {
        a,
        b,
        certainty: Certainty::Remembered,
    }
}

/// Largest percentage of arcing.  `[TSI ENE, Table 4.2.12]`, remembered
///
/// | | v ≥ 250 km/h | 160 < v < 250 | v ≤ 160 |
/// | --- | --- | --- | --- |
/// | AC | 0.2 | 0.1 | 0.1 |
/// | DC | 0.2 | 0.2 | 0.1 |
fn arcing(system: Electrification, speed_kmh: f64) -> f64 {
    if speed_kmh >= 250.0 || (speed_kmh > 160.0 && !system.is_alternating()) {
        0.2
    } else {
        0.1
    }
}

/// Largest lateral deviation of the contact wire in the wind for the heads of these lengths, m.
/// `[TSI ENE, 4.2.9.2]`, remembered
const LATERAL_DEVIATION: [(f64, f64); 2] = [(1.6, 0.40), (1.95, 0.55)];

/// Limit of the `largest` lateral position of the contact wire in the wind, m, for a strip of this width, m: heads of
/// another length than those of the standard have half of the width, where the wire leaves the strip.
pub(super) fn lateral_deviation(largest: f64, width: Option<f64>) -> Limit {
    let clause = ("TSI ENE", "2014", "4.2.9.2");
    let limit = Limit::new(clause, "lateral_deviation", Some(largest), "m").remark("in the mean wind, at rest");
    let Some(width) = width else {
        return limit.not_applicable("the width of the strips of supplied FMUs is not known");
    };
    let known = LATERAL_DEVIATION
        .iter()
        .find(|(length, _)| (length - width).abs() < 1e-3);
    match known {
        Some((length, most)) => limit
            .bounded(Bound::AtMost, *most)
            .remembered()
            .because(format!("head of {} mm", 1e3 * length)),
        None => limit
            .bounded(Bound::AtMost, 0.5 * width)
            .chosen()
            .because(format!("half of the width of the strip, {width} m")),
    }
}

/// Limits for one pantograph.
pub(super) fn of_pantograph(conditions: &Conditions, figures: &Figures) -> Vec<Limit> {
    let force = figures.force;
    let std = Limit::new(QUOTED, "std", force.map(|f| f.std), "N")
        .bounded(Bound::Below, force.map(|f| MAX_STD_RATIO * f.mean))
        .because("every system and speed (also TSI ENE, Table 4.2.12)")
        .formula("0.3 of the mean force of the run");
    let max = Limit::new(QUOTED, "max", force.map(|f| f.max), "N");
    let max = match conditions.line.electrification {
        None => max.not_applicable(system_unknown()),
        Some(system) if system.is_alternating() => max.bounded(Bound::Below, MAX_FORCE).because("an AC line"),
        Some(_) => max.not_applicable("quoted for an AC line; EN 50119 has the maximum for DC"),
    };
    let amplitude = Limit::new(QUOTED, "vertical_amplitude", figures.vertical_amplitude, "m")
        .bounded(Bound::AtMost, MAX_AMPLITUDE)
        .because("quoted without a range of speeds")
        .remark("of the collector strip, which the contact point follows, over the evaluation range");
    let mut limits = mean(conditions, figures).to_vec();
    limits.extend([std, max, amplitude]);
    limits.extend(all_arcing(conditions, figures));
    limits
}

fn mean(conditions: &Conditions, figures: &Figures) -> [Limit; 2] {
    let speed = conditions.speed_kmh();
    let value = figures.force.map(|f| f.mean);
    let table = (NAME, "2012", "Table 6 (TSI ENE 4.2.11)");
    let curves = conditions
        .line
        .electrification
        .map(|system| (system, [upper(system, speed), lower(system)]));
    let branch = if speed > 200.0 {
        "above 200 km/h"
    } else {
        "up to 200 km/h"
    };
    [("mean", Bound::AtMost, 0), ("mean_lower", Bound::AtLeast, 1)].map(|(quantity, bound, side)| {
        let limit = Limit::new(table, quantity, value, "N");
        match &curves {
            None => limit.not_applicable(system_unknown()),
            Some((system, curves)) => {
                let curve = &curves[side];
                let mut limit = limit
                    .bounded(bound, curve.at(speed))
                    .because(format!("{system}, {branch}"))
                    .formula(curve.text())
                    .remark(format!("{} at v = {speed:.1} km/h", curve.text()));
                limit.certainty = curve.certainty;
                limit
            }
        }
    })
}

/// The percentage of arcing `NQ = Σ t_arc / t_total`  [EN 50317], from losses of contact: there is no electrical model,
/// so every loss that lasts long enough counts as an arc.
fn all_arcing(conditions: &Conditions, figures: &Figures) -> [Limit; 2] {
    let what = figures.loss_of_contact.map_or_else(
        || "no contact force".to_owned(),
        |percent| {
            format!(
                "no electrical model: losses of contact of {:.0} ms and longer count as arcs; contact was lost for \
                 {percent:.3} % of \
                 the time in all",
                1e3 * SHORTEST_ARC
            )
        },
    );
    let quoted = Limit::new(QUOTED, "arcing", figures.arcing, "%")
        .bounded(Bound::AtMost, MAX_ARCING)
        .because("quoted without system and speed")
        .remark(what.clone());
    let tsi = Limit::new(TSI, "arcing", figures.arcing, "%").remembered().remark(what);
    let speed = conditions.speed_kmh();
    let tsi = match conditions.line.electrification {
        // The same for all systems at both ends of the table.
        None if speed >= 250.0 => tsi
            .bounded(Bound::AtMost, arcing(Ac25Kv, speed))
            .because("every system, from 250 km/h"),
        None if speed <= 160.0 => tsi
            .bounded(Bound::AtMost, arcing(Ac25Kv, speed))
            .because("every system, up to 160 km/h"),
        None => tsi.not_applicable(system_unknown()),
        Some(system) => tsi
            .bounded(Bound::AtMost, arcing(system, speed))
            .because(format!("{system}, {speed:.0} km/h")),
    };
    [quoted, tsi]
}

/// Limit of the uplift at the supports.
pub(super) fn uplift(conditions: &Conditions) -> Limit {
    Limit::new(QUOTED, "uplift", conditions.uplift, "m")
        .bounded(Bound::AtMost, MAX_UPLIFT)
        .because("quoted without a range of speeds")
        .remark("at the supports of the evaluated spans, whole run")
}
