//! Measured series beside the computed ones: statistics, bands, spectra and agreement.
//!
//! A series is a CSV file with the columns `time_s` or `x_m`, evenly spaced, and `force_N` or `uplift_m`. Forces are
//! filtered as the scene filters its own. Agreement is the relative difference of figures, as EN 50318 asks for it; the
//! bound of the standard deviation is remembered, not verified.

use std::path::{Path, PathBuf};

use results::report::plots::{axis, colour, decades, density, figure, layout};
use results::statistics::{ForceStatistics, Spectrum, bands, power_spectral_density};
use results::{Evaluation, Record as Series, Summary};
use serde::{Deserialize, Serialize};

/// Largest difference of the standard deviation, %.  `[EN 50318]`, remembered
const STD_PERCENT: f64 = 20.0;

/// Bands that deviations are compared in, Hz.
const BANDS: [[f64; 2]; 2] = [[0.0, 5.0], [5.0, 20.0]];

/// Highest frequency of the spectra, Hz.
const HIGHEST: f64 = 50.0;

/// Share of a step that two neighbouring places may be off, –.
const UNEVEN: f64 = 0.01;

/// Files of measured series, and bounds of agreement.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredFiles {
    /// Source of the measurement.
    pub source: String,
    /// CSV of the contact force, relative to the file of the model.
    pub force: Option<PathBuf>,
    /// CSV of the uplift at a support.
    pub uplift: Option<PathBuf>,
    /// Number of that support, from 1.
    pub support: Option<usize>,
    /// Largest relative differences, %: `mean`, `std`, `max`, `min`, `std_0_5_hz`,
    /// `std_5_20_hz`, `uplift`; `std = 20` where it is left out.
    #[serde(default)]
    pub agreement_percent: std::collections::BTreeMap<Quantity, f64>,
}

/// A compared figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Mean of the filtered force, N.
    Mean,
    /// Its standard deviation, N.
    Std,
    /// Its maximum, N.
    Max,
    /// Its minimum, N.
    Min,
    /// Deviation from 0 to 5 Hz, N.
    #[serde(rename = "std_0_5_hz")]
    StdBelow5Hz,
    /// Deviation from 5 to 20 Hz, N.
    #[serde(rename = "std_5_20_hz")]
    Std5To20Hz,
    /// Largest uplift at the support, mm.
    Uplift,
}

impl Quantity {
    /// Name, for reading.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean contact force",
            Self::Std => "standard deviation",
            Self::Max => "maximum",
            Self::Min => "minimum",
            Self::StdBelow5Hz => "deviation, 0 to 5 Hz",
            Self::Std5To20Hz => "deviation, 5 to 20 Hz",
            Self::Uplift => "uplift at support",
        }
    }

    /// Unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        if matches!(self, Self::Uplift) { "mm" } else { "N" }
    }
}

/// A figure measured and computed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// The figure.
    pub quantity: Quantity,
    /// Unit.
    pub unit: &'static str,
    /// Measured value.
    pub measured: f64,
    /// Computed value.
    pub computed: f64,
    /// Computed less measured, % of the measured one; absent where that is zero.
    pub difference_percent: Option<f64>,
    /// Largest difference, %; absent where none is known.
    pub bound_percent: Option<f64>,
    /// True for a bound that is remembered and not verified.
    pub remembered: bool,
    /// True where the difference is within the bound; absent without one.
    pub pass: Option<bool>,
}

/// A measurement beside a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Source of the measurement.
    pub source: String,
    /// Figures.
    pub figures: Vec<Compared>,
    /// Spectra of measured and computed force, N²/Hz.
    #[serde(skip)]
    spectra: Vec<(&'static str, Spectrum)>,
}

/// A series and the time between two of its samples, s.
struct Sampled {
    values: Vec<f64>,
    step: f64,
}

impl MeasuredFiles {
    /// Complaint about the keys, if there is any.
    pub(crate) fn complaint(&self) -> Option<String> {
        if self.force.is_none() && self.uplift.is_none() {
            return Some("measured: must name force = \"FILE.csv\", uplift = \"FILE.csv\", or both".to_owned());
        }
        if self.uplift.is_some() && self.support.is_none() {
            return Some("measured.support: must be the number of the support that uplift was measured at".to_owned());
        }
        if self.support.is_some() && self.uplift.is_none() {
            return Some("measured.uplift: must be the file of the uplift at measured.support".to_owned());
        }
        let series = |quantity: &Quantity| match quantity {
            Quantity::Uplift => ("uplift", self.uplift.is_some()),
            _ => ("force", self.force.is_some()),
        };
        let mut bounds = self.agreement_percent.keys();
        if let Some(quantity) = bounds.find(|quantity| !series(quantity).1) {
            let (name, key) = (quantity.name(), series(quantity).0);
            return Some(format!(
                "measured.agreement_percent: {name} has a bound but no series: must name measured.{key}"
            ));
        }
        let wrong = self
            .agreement_percent
            .iter()
            .find(|(_, percent)| !(**percent > 0.0 && percent.is_finite()));
        wrong.map(|(quantity, percent)| {
            let name = quantity.name();
            format!("measured.agreement_percent: {name} = {percent}: must be positive, in %")
        })
    }

    /// The measurement beside a run of pantograph `index` (from 0); files are relative to `folder`.
    ///
    /// # Errors
    /// A file that cannot be read or used, with its row and what would be right.
    pub(crate) fn beside(
        &self,
        folder: &Path,
        (summary, series): (&Summary, &Series),
        index: usize,
    ) -> Result<Measured, String> {
        let evaluation = &summary.evaluation;
        let mut pairs = Vec::new();
        let mut spectra = Vec::new();
        if let Some(file) = &self.force {
            let measured = read(folder, file, "force_N", evaluation)?;
            let computed = Sampled {
                values: series
                    .pantographs
                    .get(index)
                    .map(|head| head.force.clone())
                    .unwrap_or_default(),
                step: evaluation.output_step,
            };
            let range = evaluation.samples(&series.time, index);
            let whole = 0..measured.values.len();
            let name = file.display();
            let of_file = figures(&measured, whole, evaluation).map_err(|reason| format!("{name}: {reason}"))?;
            let of_run = figures(&computed, range.clone(), evaluation)?;
            pairs.extend(
                of_file
                    .into_iter()
                    .zip(of_run)
                    .map(|((quantity, a), (_, b))| (quantity, a, b)),
            );
            for (name, values, step) in [
                ("measured", &measured.values[..], measured.step),
                (
                    "computed",
                    computed.values.get(range).unwrap_or_default(),
                    computed.step,
                ),
            ] {
                if let Some(spectrum) = power_spectral_density(values, step) {
                    spectra.push((name, spectrum));
                }
            }
        }
        if let (Some(file), Some(number)) = (&self.uplift, self.support) {
            let measured = read(folder, file, "uplift_m", evaluation)?;
            let support = summary.uplift.supports.iter().find(|support| support.number == number);
            let computed = support.and_then(|support| support.max_m).ok_or_else(|| {
                let known = summary.uplift.supports.iter().map(|support| support.number.to_string());
                let known = known.collect::<Vec<_>>().join(", ");
                format!("measured.support = {number}: must be a support of the evaluated spans: {known}")
            })?;
            let highest = measured.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            pairs.push((Quantity::Uplift, 1e3 * highest, 1e3 * computed));
        }
        let figures = pairs.into_iter().map(|(quantity, measured, computed)| {
            let entered = self.agreement_percent.get(&quantity).copied();
            let remembered = entered.is_none() && quantity == Quantity::Std;
            let bound_percent = entered.or(remembered.then_some(STD_PERCENT));
            let difference_percent = (measured != 0.0).then(|| 100.0 * (computed - measured) / measured.abs());
            Compared {
                quantity,
                unit: quantity.unit(),
                measured,
                computed,
                difference_percent,
                bound_percent,
                remembered,
                pass: (bound_percent.zip(difference_percent)).map(|(bound, difference)| difference.abs() <= bound),
            }
        });
        Ok(Measured {
            source: self.source.clone(),
            figures: figures.collect(),
            spectra,
        })
    }
}

impl Measured {
    /// Spectra as a figure with this number in its id.
    pub(crate) fn figure(&self, number: usize) -> String {
        let traces = self.spectra.iter().enumerate();
        let traces = traces.map(|(index, (name, spectrum))| density(spectrum, HIGHEST, name, colour(index)));
        let axes = layout(axis("frequency [Hz]"), decades("density [N²/Hz]"));
        figure(
            traces.collect(),
            axes,
            (&format!("plot-spectra-{number}"), 320),
            "Power spectral density of the raw force, Hann window. Phases of single passages differ, levels can be \
             compared.",
        )
    }
}

/// Figures of a force over a range of its samples.
fn figures(
    force: &Sampled,
    range: std::ops::Range<usize>,
    evaluation: &Evaluation,
) -> Result<Vec<(Quantity, f64)>, String> {
    let filter = evaluation.filter.design(evaluation.low_pass_hz, force.step);
    let filtered = filter
        .and_then(|filter| filter.filter(&force.values))
        .map_err(|error| error.to_string())?;
    let statistics = filtered.get(range.clone()).and_then(ForceStatistics::of);
    let statistics = statistics.ok_or("holds no force to compare")?;
    let bands = bands(&force.values, &BANDS, &range, force.step);
    let bands = [Quantity::StdBelow5Hz, Quantity::Std5To20Hz].into_iter().zip(bands);
    let bands = bands.filter_map(|(quantity, band)| Some((quantity, band.std?)));
    let whole = [
        (Quantity::Mean, statistics.mean),
        (Quantity::Std, statistics.std),
        (Quantity::Max, statistics.max),
        (Quantity::Min, statistics.min),
    ];
    Ok(whole.into_iter().chain(bands).collect())
}

/// Reads a column of a CSV file beside `time_s` or `x_m`.
fn read(folder: &Path, file: &Path, column: &str, evaluation: &Evaluation) -> Result<Sampled, String> {
    let name = file.display();
    let failed = |error: csv::Error| format!("{name}: {error}");
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_path(folder.join(file))
        .map_err(failed)?;
    let header: Vec<String> = reader.headers().map_err(failed)?.iter().map(str::to_owned).collect();
    if header.is_empty() {
        return Err(format!("{name}: is empty: must begin with the names of its columns"));
    }
    let place = |wanted: &str| header.iter().position(|name| *name == wanted);
    let value = place(column).ok_or_else(|| {
        format!(
            "{name}: has no column {column}: must have time_s or x_m, and {column}; found {}",
            header.join(", ")
        )
    })?;
    let (along, speed) = match (place("time_s"), place("x_m")) {
        (Some(time), _) => (time, 1.0),
        (None, Some(x)) => (x, evaluation.speed),
        (None, None) => {
            return Err(format!(
                "{name}: has no column time_s or x_m; found {}",
                header.join(", ")
            ));
        }
    };
    let (mut places, mut values) = (Vec::new(), Vec::new());
    for row in reader.records() {
        let row = row.map_err(failed)?;
        let line = row.position().map_or(0, csv::Position::line);
        let number_in = |index: usize| {
            let cell = row.get(index).unwrap_or_default();
            let parsed = cell.parse::<f64>().ok().filter(|value| value.is_finite());
            parsed.ok_or_else(|| format!("{name}:{line}: {} = {cell:?}: must be a finite number", header[index]))
        };
        places.push(number_in(along)? / speed);
        values.push(number_in(value)?);
    }
    if values.len() < 2 {
        return Err(format!("{name}: must have two rows at least"));
    }
    let step = (places[places.len() - 1] - places[0]) / (places.len() - 1) as f64;
    let even = |pair: &[f64]| (pair[1] - pair[0] - step).abs() <= UNEVEN * step;
    if let Some(index) = places
        .windows(2)
        .position(|pair| !even(pair))
        .filter(|_| step > 0.0)
        .or((step <= 0.0).then_some(0))
    {
        return Err(format!(
            "{name}: row {} of {}: {} must rise in even steps, {} in the mean; resample the series",
            index + 2,
            places.len(),
            header[along],
            step * speed
        ));
    }
    Ok(Sampled { values, step })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn evaluation() -> Evaluation {
        Evaluation {
            low_pass_hz: 20.0,
            output_step: 1e-3,
            speed: 50.0,
            ..Evaluation::default()
        }
    }

    /// Rows of `100 + 20 √2 sin(2π 3 t) + 10 √2 sin(2π 12 t)` N over 10 s, by time or by place.
    fn rows(along: &str, speed: f64) -> String {
        let force = |t: f64| {
            let wave = |hz: f64| 2.0_f64.sqrt() * (TAU * hz * t).sin();
            100.0 + 20.0 * wave(3.0) + 10.0 * wave(12.0)
        };
        let row = |index: usize| {
            let t = 0.002 * index as f64;
            format!("{},{}\n", 10.0 + speed * t, force(t))
        };
        format!(
            "# a comment\n{along},force_N\n{}",
            (0..=5000).map(row).collect::<String>()
        )
    }

    fn read_text(text: &str) -> Result<Sampled, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("force.csv"), text).unwrap();
        read(folder.path(), Path::new("force.csv"), "force_N", &evaluation())
    }

    #[test]
    fn figures_of_a_series_are_those_of_its_closed_form_by_time_and_by_place() {
        for (along, speed) in [("time_s", 1.0), ("x_m", 50.0)] {
            let series = read_text(&rows(along, speed)).unwrap();
            assert!((series.step - 0.002).abs() < 1e-12);
            let found = figures(&series, 500..4500, &evaluation()).unwrap();
            let of = |wanted: Quantity| found.iter().find(|(quantity, _)| *quantity == wanted).unwrap().1;
            assert!((of(Quantity::Mean) - 100.0).abs() < 1e-3);
            // Orthogonal over whole periods: √(20² + 10²); filters of order 4 both ways at 12 of 20 Hz.
            let left = 1.0 / (1.0 + (12.0_f64 / 20.0).powi(8));
            let expected = 20.0_f64.hypot(10.0 * left);
            assert!(
                (of(Quantity::Std) / expected - 1.0).abs() < 2e-3,
                "{}",
                of(Quantity::Std)
            );
            let slow = 20.0 / (1.0 + (3.0_f64 / 5.0).powi(8));
            assert!(
                (of(Quantity::StdBelow5Hz) / slow - 1.0).abs() < 5e-3,
                "{}",
                of(Quantity::StdBelow5Hz)
            );
            assert!((of(Quantity::Std5To20Hz) / (10.0 * left) - 1.0).abs() < 0.02);
        }
    }

    #[test]
    fn a_series_that_cannot_be_used_is_refused_with_row_and_column() {
        let good = rows("time_s", 1.0);
        for (text, parts) in [
            (
                good.replacen("force_N", "force", 1),
                vec!["force.csv", "no column force_N", "time_s"],
            ),
            (good.replacen("time_s", "t", 1), vec!["no column time_s or x_m"]),
            (
                good.replacen("10.004,", "10.009,", 1),
                vec!["row 3 of 5001", "even steps"],
            ),
            (
                good.replacen("10.002,", "10.002,a", 1),
                vec!["force.csv:4", "force_N", "finite number"],
            ),
            (String::new(), vec!["is empty"]),
            ("time_s,force_N\n1,2\n".to_owned(), vec!["two rows"]),
            ("time_s,force_N\n2,2\n1,2\n".to_owned(), vec!["even steps"]),
        ] {
            let message = read_text(&text).err().unwrap();
            for part in parts {
                assert!(message.contains(part), "no {part:?} in {message}");
            }
        }
        let none = MeasuredFiles::default();
        assert!(none.complaint().unwrap().contains("force ="));
        let uplift = MeasuredFiles {
            uplift: Some("u.csv".into()),
            ..MeasuredFiles::default()
        };
        assert!(uplift.complaint().unwrap().contains("measured.support"));
        let bound = MeasuredFiles {
            force: Some("f.csv".into()),
            agreement_percent: [(Quantity::Uplift, 10.0)].into(),
            ..MeasuredFiles::default()
        };
        assert!(
            bound.complaint().unwrap().contains("measured.uplift"),
            "{:?}",
            bound.complaint()
        );
    }
}
