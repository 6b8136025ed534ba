//! Reference models: cases with their ranges.

use std::collections::BTreeMap;
use std::path::PathBuf;

use results::Summary;
use serde::{Deserialize, Serialize};

use crate::measured::MeasuredFiles;

/// Reasons that keep a validation from its end.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// A file that is no reference model.
    #[error("{file}: {what}")]
    Model {
        /// File as named.
        file: String,
        /// The fault, and what would be right.
        what: String,
    },
    /// A case that cannot be run.
    #[error("case \"{case}\" ({mode})")]
    Run {
        /// Name of the case.
        case: String,
        /// Mode.
        mode: &'static str,
        /// Reason.
        #[source]
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A case that does not fit its scene, or a measured series that cannot be used.
    #[error("case \"{case}\": {what}")]
    Case {
        /// Name of the case.
        case: String,
        /// The fault, and what would be right.
        what: String,
    },
    /// A run that was ended.
    #[error("ended before case \"{case}\" was complete: {reason}")]
    Ended {
        /// Name of the case.
        case: String,
        /// Reason.
        reason: String,
    },
}

impl ValidationError {
    /// `true` where the file or a scene is wrong.
    #[must_use]
    pub const fn is_input(&self) -> bool {
        !matches!(self, Self::Ended { .. })
    }
}

/// A figure that has a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// Mean of the filtered force, N.
    Mean,
    /// Its standard deviation, N.
    Std,
    /// `mean + 3 std`, N.
    StatisticalMax,
    /// `mean − 3 std`, N.
    StatisticalMin,
    /// Its maximum, N.
    Max,
    /// Its minimum, N.
    Min,
    /// Largest uplift at an evaluated support, mm.
    UpliftMm,
    /// Loss of contact, %.
    LossPercent,
    /// Vertical amplitude of the strip, mm.
    AmplitudeMm,
}

impl Figure {
    /// Its value in a run, for pantograph `pantograph` (from 1).
    #[must_use]
    pub fn of(self, summary: &Summary, pantograph: usize) -> Option<f64> {
        let found = summary.pantographs.get(pantograph.checked_sub(1)?)?;
        let force = found.contact_force.filtered;
        match self {
            Self::Mean => Some(force?.mean),
            Self::Std => Some(force?.std),
            Self::StatisticalMax => Some(force?.statistical_max),
            Self::StatisticalMin => Some(force?.statistical_min),
            Self::Max => Some(force?.max),
            Self::Min => Some(force?.min),
            Self::UpliftMm => summary.uplift.max_at_support.map(|uplift| 1e3 * uplift),
            Self::LossPercent => found.contact_force.loss_of_contact_percent,
            Self::AmplitudeMm => found.strip.vertical_amplitude.map(|amplitude| 1e3 * amplitude),
        }
    }

    /// Its name, for reading.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean contact force",
            Self::Std => "standard deviation",
            Self::StatisticalMax => "statistical maximum",
            Self::StatisticalMin => "statistical minimum",
            Self::Max => "maximum",
            Self::Min => "minimum",
            Self::UpliftMm => "uplift at support",
            Self::LossPercent => "loss of contact",
            Self::AmplitudeMm => "amplitude of the strip",
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::UpliftMm | Self::AmplitudeMm => "mm",
            Self::LossPercent => "%",
            _ => "N",
        }
    }
}

/// A scene with the ranges of its figures.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name.
    pub name: String,
    /// Scene file, relative to the file of the model.
    pub scene: PathBuf,
    /// Pantograph whose figures have the ranges, from 1.
    #[serde(default = "first")]
    pub pantograph: usize,
    /// Least and largest value of each figure, in its unit.
    #[serde(default)]
    pub ranges: BTreeMap<Figure, (f64, f64)>,
    /// Figures that are recorded without a range, because none is known.
    #[serde(default)]
    pub figures: Vec<Figure>,
    /// Measured series that the run is compared with.
    pub measured: Option<MeasuredFiles>,
}

const fn first() -> usize {
    1
}

/// A reference model of a standard.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceModel {
    /// Standard and edition.
    pub standard: String,
    /// Source of the ranges.
    pub source: String,
    /// Cases.
    #[serde(rename = "case")]
    pub cases: Vec<Case>,
}

impl ReferenceModel {
    /// Reads the text of a file, `file` in messages.
    ///
    /// # Errors
    /// [`ValidationError::Model`] for text that is none, unknown figures, empty and inverted ranges.
    pub fn read(text: &str, file: &str) -> Result<Self, ValidationError> {
        let wrong = |what: String| ValidationError::Model {
            file: file.to_owned(),
            what,
        };
        let model: Self = toml::from_str(text).map_err(|error| wrong(error.to_string()))?;
        if model.cases.is_empty() {
            return Err(wrong(
                "case: must be at least one, [[case]] with name, scene and ranges".to_owned(),
            ));
        }
        for case in &model.cases {
            let name = &case.name;
            if case.ranges.is_empty() && case.figures.is_empty() && case.measured.is_none() {
                return Err(wrong(format!(
                    "case \"{name}\": must have ranges, such as std = [26.0, 31.0], figures without a range, such as \
                     figures = [\"mean\", \"std\"], or a measured series"
                )));
            }
            if let Some(complaint) = case.measured.as_ref().and_then(MeasuredFiles::complaint) {
                return Err(wrong(format!("case \"{name}\": {complaint}")));
            }
            if let Some(twice) = case.figures.iter().find(|figure| case.ranges.contains_key(figure)) {
                return Err(wrong(format!(
                    "case \"{name}\": figures: {} has a range already, and must be left out here",
                    twice.name()
                )));
            }
            if case.pantograph == 0 {
                return Err(wrong(format!(
                    "case \"{name}\": pantograph = 0: must be counted from 1"
                )));
            }
            for (figure, (low, high)) in &case.ranges {
                if !(low <= high && low.is_finite() && high.is_finite()) {
                    let (figure, unit) = (figure.name(), figure.unit());
                    let what = format!("case \"{name}\": {figure} = [{low}, {high}] {unit}: must be [low, high]");
                    return Err(wrong(what));
                }
            }
        }
        Ok(model)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EN: &str = include_str!("../../../standards/en50318-2002.toml");
    const RANGES: &str = include_str!("../../../tests/data/en50318/en50318_2002_ranges.csv");

    #[test]
    fn the_shipped_ranges_are_those_of_the_reference_data() {
        let model = ReferenceModel::read(EN, "en50318-2002.toml").unwrap();
        let mut compared = 0;
        for row in RANGES.lines().skip(1) {
            let cells: Vec<&str> = row.split(',').collect();
            let case = model.cases.iter().find(|case| case.name.starts_with(cells[1])).unwrap();
            let figure = match cells[2] {
                "mean contact force" => Figure::Mean,
                "standard deviation" => Figure::Std,
                "statistical maximum" => Figure::StatisticalMax,
                "statistical minimum" => Figure::StatisticalMin,
                "actual maximum" => Figure::Max,
                "actual minimum" => Figure::Min,
                "max uplift at support" => Figure::UpliftMm,
                "loss of contact" => Figure::LossPercent,
                other => panic!("{other}"),
            };
            let expected = (cells[4].parse().unwrap(), cells[5].parse().unwrap());
            assert_eq!(case.ranges[&figure], expected, "{row}");
            compared += 1;
        }
        assert_eq!(
            compared,
            model.cases.iter().map(|case| case.ranges.len()).sum::<usize>()
        );
    }

    #[test]
    fn a_file_that_is_no_model_is_refused_with_what_would_be_right() {
        for (from, to, part) in [
            ("std = [26.0, 31.0]", "std = [31.0, 26.0]", "must be [low, high]"),
            ("std = [26.0, 31.0]", "sdt = [26.0, 31.0]", "sdt"),
            (
                "name = \"250 km/h\"",
                "name = \"250 km/h\"\npantograph = 0",
                "counted from 1",
            ),
            ("standard =", "standart =", "standart"),
            (
                "[case.ranges]",
                "figures = [\"std\"]\n[case.ranges]",
                "has a range already",
            ),
        ] {
            let text = EN.replacen(from, to, 1);
            let said = ReferenceModel::read(&text, "own.toml").unwrap_err().to_string();
            assert!(said.starts_with("own.toml: ") && said.contains(part), "{said}");
        }
        let none = ReferenceModel::read("standard = \"a\"\nsource = \"b\"\ncase = []\n", "own.toml").unwrap_err();
        assert!(none.to_string().contains("at least one"), "{none}");
    }
}
