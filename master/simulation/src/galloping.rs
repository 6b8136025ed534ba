//! Galloping of a scene's line at several speeds of the wind.
use std::fmt::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};

use scene::{Reduction, Scene};
use serde::Serialize;
use system::galloping::{Criterion, GallopingError, Motion, Trial, criteria};

use crate::SetupError;

/// Shares of the smallest critical speed that are tried where no speeds are asked for.
const ABOUT_CRITICAL: [f64; 4] = [0.9, 1.1, 1.3, 1.6];

/// Winds and start of the motion.
#[derive(Clone, Debug)]
pub struct Galloping {
    /// Speeds of the wind, m/s; empty: some about the critical one, or that of the scene.
    pub speeds: Vec<f64>,
    /// Amplitude at the start, m.
    pub amplitude: f64,
    /// Simulated time, s.
    pub duration: f64,
}

/// Criteria and motions.
#[derive(Clone, Debug, Serialize)]
pub struct GallopingReport {
    /// Name of the scene.
    pub scene: String,
    /// Wires with a table of drag and lift.
    pub criteria: Vec<Criterion>,
    /// Motions in the wind, in the order of the speeds.
    pub motions: Vec<Motion>,
    /// Remarks.
    pub notes: Vec<String>,
}

impl Galloping {
    /// Integrates the line alone at each speed; ends early where `interrupted` is set.
    ///
    /// # Errors
    /// See [`SetupError`].
    pub fn run(&self, scene: &Scene, name: &str, interrupted: &AtomicBool) -> Result<GallopingReport, SetupError> {
        if scene.wind.as_ref().is_none_or(|wind| wind.wires.is_none()) {
            return Err(GallopingError::NoWind.into());
        }
        let mut scene = scene.clone();
        // Of the reductions the plane alone has the motion of the air with every element.
        scene
            .model
            .reductions
            .retain(|reduction| *reduction == Reduction::Planar);
        let criteria = criteria(&scene);
        let statics = catenary::static_line(&scene)?;
        let mut motions = Vec::new();
        for speed in self.speeds_for(&scene, &criteria) {
            if interrupted.load(Ordering::Relaxed) {
                break;
            }
            let trial = Trial {
                speed,
                amplitude: self.amplitude,
                duration: self.duration,
            };
            motions.push(trial.run(&scene, &statics)?);
        }
        let mut notes = Vec::new();
        if criteria.is_empty() {
            notes.push(
                "no wire has a table of drag and lift (wind.wires.contact_wire_polar, messenger_wire_polar): round \
                 wires do not gallop"
                    .to_owned(),
            );
        }
        for motion in motions.iter().filter(|motion| motion.beyond_table) {
            notes.push(format!(
                "at {} m/s angles of attack from {:.0}° to {:.0}° are beyond a table, whose ends were held: a table \
                 with these angles is needed",
                motion.speed, motion.angles[0], motion.angles[1]
            ));
        }
        Ok(GallopingReport {
            scene: name.to_owned(),
            criteria,
            motions,
            notes,
        })
    }

    fn speeds_for(&self, scene: &Scene, criteria: &[Criterion]) -> Vec<f64> {
        if !self.speeds.is_empty() {
            return self.speeds.clone();
        }
        let critical = criteria
            .iter()
            .filter_map(|criterion| criterion.of_all_directions.or(criterion.critical_speed));
        match critical.reduce(f64::min) {
            Some(critical) => ABOUT_CRITICAL.iter().map(|share| share * critical).collect(),
            None => scene.wind.iter().map(|wind| wind.speed).collect(),
        }
    }
}

/// A speed in m/s, or that there is none.
fn speed(found: Option<f64>) -> String {
    found.map_or_else(|| "never".to_owned(), |speed| format!("{speed:.2} m/s"))
}

/// Lines of text about criteria.
pub(crate) fn criteria_in_words(criteria: &[Criterion]) -> impl Iterator<Item = String> + '_ {
    criteria.iter().map(|criterion| {
        format!(
            "{}: C_D + dC_L/dα = {:.3} at the angle of the mean wind; a span of {:.3} Hz and {:.2} % damping gallops \
             vertically from {}, in any direction from {}",
            criterion.wire.kind().words(),
            criterion.slope,
            criterion.frequency,
            100.0 * criterion.damping_ratio,
            speed(criterion.critical_speed),
            speed(criterion.of_all_directions),
        )
    })
}

impl GallopingReport {
    /// The report as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}: galloping of the line without pantographs\n\n", self.scene);
        for line in criteria_in_words(&self.criteria) {
            let _ = writeln!(text, "{line}");
        }
        let _ = writeln!(
            text,
            "\n{:>12}{:>14}{:>16}{:>16}{:>14}  {:<12}{:>20}",
            "wind [m/s]", "growth [1/s]", "vertical [m]", "lateral [m]", "[Hz]", "motion", "angles [°]"
        );
        for motion in &self.motions {
            let angles = match motion.angles {
                [low, high] if low <= high => format!("{low:.1} to {high:.1}"),
                _ => String::new(),
            };
            let _ = writeln!(
                text,
                "{:>12.3}{:>14.5}{:>16.5}{:>16.5}{:>14.4}  {:<12}{:>20}",
                motion.speed,
                motion.growth,
                motion.amplitude,
                motion.lateral_amplitude,
                motion.frequency,
                motion.ends.words(),
                angles
            );
        }
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        text
    }

    /// The motions as a table of comma-separated values.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = "speed_m_per_s,growth_per_s,amplitude_m,lateral_amplitude_m,frequency_hz,motion\n".to_owned();
        for motion in &self.motions {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{}",
                motion.speed,
                motion.growth,
                motion.amplitude,
                motion.lateral_amplitude,
                motion.frequency,
                motion.ends.words()
            );
        }
        text
    }
}
