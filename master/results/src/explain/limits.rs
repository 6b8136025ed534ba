//! Limits of standards in words: clause, figure and certainty over systems and speeds.

use scene::{Assessment, Electrification};
use serde::Serialize;

use crate::report::format::in_unit;
use crate::standards::{self, Certainty, Conditions, Figures, Limit, Line};
use crate::statistics::{Filter, ForceStatistics};

/// Speeds on both sides of every bound of a limit, km/h.
const SPEEDS: [f64; 15] = [
    50.0, 51.0, 60.0, 61.0, 100.0, 101.0, 120.0, 121.0, 160.0, 161.0, 200.0, 201.0, 249.0, 250.0, 251.0,
];

/// A limit as a standard sets it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitText {
    /// Name of the standard.
    pub standard: String,
    /// Limited quantity, as in `summary.json`.
    pub quantity: String,
    /// Edition, clause or table.
    pub clause: String,
    /// Source of a limit that the user has entered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Cases in which it has a figure.
    pub figures: Vec<LimitFigure>,
    /// Practice where it fails.
    pub remedy: Option<&'static str>,
}

/// Figure of a limit for a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LimitFigure {
    /// Systems and speeds.
    pub case: String,
    /// Bound and figure or formula.
    pub limit: String,
    /// Certainty.
    pub certainty: Certainty,
}

impl LimitText {
    /// True for the name of the standard, of the quantity, or both.
    pub(super) fn is_called(&self, typed: &str) -> bool {
        let typed = typed.to_lowercase();
        let (standard, quantity) = (self.standard.to_lowercase(), self.quantity.to_lowercase());
        typed == standard || typed == quantity || typed == format!("{standard} {quantity}")
    }

    /// As text.
    pub(super) fn text(&self) -> String {
        let mut text = format!("{}, {}: {}\n", self.standard, self.clause, self.quantity);
        for figure in &self.figures {
            text.push_str(&format!(
                "  {:<34} {} {}\n",
                figure.case,
                figure.limit,
                figure.certainty.mark()
            ));
        }
        if let Some(source) = &self.source {
            text.push_str(&format!("  entered from: {source}\n"));
        }
        if self.figures.is_empty() {
            text.push_str("  no figure is known here\n");
        }
        if let Some(remedy) = self.remedy {
            text.push_str(&format!("  remedy: {remedy}\n"));
        }
        text
    }
}

/// Limits that a run of usual figures is held against, of a system at a speed.
fn of_run((system, speed_kmh, pantographs): (Electrification, f64, usize), assessment: &Assessment) -> Vec<Limit> {
    let line = Line {
        electrification: Some(system),
        wave_speed: Some(120.0),
        free_uplift: Some(0.15),
        uplift_stop: false,
    };
    let conditions = Conditions {
        line,
        speed: speed_kmh / 3.6,
        low_pass_hz: 20.0,
        filter: Filter::ZeroPhase,
        output_step: 1e-3,
        uplift: Some(0.05),
    };
    let figures = Figures {
        force: ForceStatistics::of(&[90.0, 110.0]),
        vertical_amplitude: Some(0.05),
        loss_of_contact: Some(0.0),
        arcing: Some(0.0),
        section: 120.0,
        longest_span: Some(60.0),
    };
    let at_rest = standards::limits_at_rest(
        &line,
        (conditions.speed, pantographs),
        (Some(1e-3), Some(1e-3)),
        Some((0.3, Some(1.6))),
        assessment,
    );
    let mut all = standards::limits(&conditions, &vec![figures; pantographs], assessment);
    all.retain(|limit| limit.pantograph.unwrap_or(1) == 1);
    // The ratio of speeds is among both.
    let more = at_rest.into_iter().filter(|limit| {
        let same = |other: &Limit| other.standard == limit.standard && other.quantity == limit.quantity;
        !all.iter().any(same)
    });
    let more: Vec<Limit> = more.collect();
    all.extend(more);
    all
}

/// Bound and figure of a limit, or its formula.
fn figure(limit: &Limit) -> Option<String> {
    let value = limit.limit.filter(|_| limit.applicable)?;
    let sign = limit.bound.sign();
    let (scale, unit) = limit.scale();
    Some(match limit.formula.as_str() {
        "" if unit == "mm" => format!("{sign} {:.0} mm", scale * value),
        "" => {
            let value = (1e4 * scale * value).round() / 1e4;
            format!("{sign} {}", in_unit(&value.to_string(), unit))
        }
        formula => format!("{sign} {formula}"),
    })
}

/// Speeds on both sides of every bound, km/h.
fn speeds(assessment: &Assessment) -> Vec<f64> {
    let rows = assessment.limits.iter();
    let own = rows.flat_map(|row| [Some(row.above_kmh).filter(|speed| *speed > 0.0), row.up_to_kmh]);
    let own = own.flatten().flat_map(|bound| [bound, bound + 1.0]);
    let mut speeds: Vec<f64> = SPEEDS.into_iter().chain(own).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    speeds
}

/// A figure, its certainty, and the systems and speeds (km/h) that it holds for.
type FigureCases = (String, Certainty, Vec<(Electrification, f64)>);

/// Every limit that is known, with its figures over systems and speeds.
#[must_use]
pub fn limits(assessment: &Assessment) -> Vec<LimitText> {
    let mut all: Vec<LimitText> = Vec::new();
    // Cases of each limit in turn.
    let mut cases: Vec<Vec<FigureCases>> = Vec::new();
    let speeds = speeds(assessment);
    // Numbers of pantographs at which another row may hold.
    let fewest = assessment.limits.iter().filter_map(|row| Some(row.pantographs?[0]));
    let mut counts: Vec<usize> = std::iter::once(1).chain(fewest).collect();
    counts.sort_unstable();
    counts.dedup();
    for &speed in &speeds {
        for system in Electrification::ALL {
            for limit in counts
                .iter()
                .flat_map(|count| of_run((*system, speed, *count), assessment))
            {
                let known =
                    (all.iter()).position(|text| text.standard == limit.standard && text.quantity == limit.quantity);
                let index = known.unwrap_or_else(|| {
                    all.push(LimitText {
                        standard: limit.standard.clone(),
                        quantity: limit.quantity.clone(),
                        clause: limit.clause.clone(),
                        source: limit.source.clone(),
                        figures: Vec::new(),
                        remedy: limit.remedy(),
                    });
                    cases.push(Vec::new());
                    all.len() - 1
                });
                let Some(figure) = figure(&limit) else { continue };
                let same = |(other, certainty, _): &&mut FigureCases| *other == figure && *certainty == limit.certainty;
                match cases[index].iter_mut().find(same) {
                    Some((_, _, of)) if of.last() == Some(&(*system, speed)) => {}
                    Some((_, _, of)) => of.push((*system, speed)),
                    None => cases[index].push((figure, limit.certainty, vec![(*system, speed)])),
                }
            }
        }
    }
    for (text, cases) in all.iter_mut().zip(cases) {
        text.figures = cases
            .into_iter()
            .map(|(limit, certainty, of)| LimitFigure {
                case: case(&of, &speeds),
                limit,
                certainty,
            })
            .collect();
    }
    all
}

/// Systems and speeds of a figure in words.
fn case(of: &[(Electrification, f64)], all: &[f64]) -> String {
    if of.len() == all.len() * Electrification::ALL.len() {
        return "every system and speed".to_owned();
    }
    let mut systems: Vec<&str> = Vec::new();
    for (system, _) in of {
        if !systems.contains(&system.name()) {
            systems.push(system.name());
        }
    }
    let systems = match systems.len() == Electrification::ALL.len() {
        true => "every system".to_owned(),
        false => systems.join(", "),
    };
    let (low, high) = of.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), (_, speed)| {
        (low.min(*speed), high.max(*speed))
    });
    let first = all.first().is_some_and(|speed| *speed == low);
    let last = all.last().is_some_and(|speed| *speed == high);
    let speeds = match (first, last) {
        (true, true) => "every speed".to_owned(),
        (true, false) => format!("up to {high:.0} km/h"),
        (false, true) => format!("from {low:.0} km/h"),
        (false, false) => format!("{low:.0} to {high:.0} km/h"),
    };
    format!("{systems}, {speeds}")
}
