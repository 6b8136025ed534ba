//! Figures of one pantograph in detail: by band, by stretch of track, loss by loss, and the height of the wire.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{Evaluation, LineGeometry, StripRecord};
use crate::statistics::{
    Band, Filter, ForceStatistics, Loss, LossClass, Quantile, Stretch, bands, largest_slope, loss_classes, losses,
    peak_to_peak, quantiles, stretches,
};

/// Shares of the samples that quantiles of the force are given at, %.
pub(super) const QUANTILES: [f64; 7] = [1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0];

/// Figures of one pantograph over the evaluation range in detail; lists are empty where there is no force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Detail {
    /// Standard deviation of the raw force in the bands of `run.bands_hz`, N.
    #[serde(default)]
    pub bands: Vec<Band>,
    /// Quantiles of the filtered force, N.
    #[serde(default)]
    pub quantiles: Vec<Quantile>,
    /// Statistics of the force by the filter that was not asked for.
    #[serde(default)]
    pub other_filter: Option<OtherFilter>,
    /// Figures by span.
    #[serde(default)]
    pub spans: Vec<Stretch>,
    /// Figures by tension length, where there are several.
    #[serde(default)]
    pub tension_lengths: Vec<Stretch>,
    /// Losses of contact, each with its whole duration.
    #[serde(default)]
    pub losses: Vec<Loss>,
    /// Losses of contact by duration.
    #[serde(default)]
    pub loss_classes: Vec<LossClass>,
    /// Height of the contact wire where it is touched.
    #[serde(default)]
    pub contact_height: Option<ContactHeight>,
}

/// Statistics of the filtered force by the filter that was not asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OtherFilter {
    /// The filter.
    pub filter: Filter,
    /// Its statistics, N.
    pub filtered: ForceStatistics,
}

/// Height of the contact wire where it is touched, filtered like the force.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactHeight {
    /// Mean, m.
    pub mean_m: f64,
    /// Highest, m.
    pub max_m: f64,
    /// Lowest, m.
    pub min_m: f64,
    /// Highest less lowest, m.
    pub range_m: f64,
    /// Largest gradient along the track, without its sign, ‰.
    pub gradient_permille: Option<f64>,
}

impl Detail {
    /// Figures of `strip` over `range`; `filtered` is its force as the evaluation filters it, N, or empty.
    pub(super) fn of(
        (strip, filtered): (&StripRecord, &[f64]),
        range: &Range<usize>,
        evaluation: &Evaluation,
        (time, line): (&[f64], &LineGeometry),
    ) -> Self {
        let (Some(raw), false) = (strip.force.get(range.clone()), range.is_empty()) else {
            return Self::default();
        };
        let finite = [&strip.force, &strip.contact_x]
            .into_iter()
            .flatten()
            .all(|value| value.is_finite());
        if !finite || ForceStatistics::of(raw).is_none() {
            return Self::default();
        }
        let step = evaluation.output_step;
        let supports: Vec<(f64, f64)> = line.support_x.windows(2).map(|ends| (ends[0], ends[1])).collect();
        let by = |ends: &[(f64, f64)]| stretches(ends, &strip.contact_x, [filtered, &strip.force], range);
        Self {
            bands: bands(&strip.force, &evaluation.bands_hz, range, step),
            quantiles: filtered
                .get(range.clone())
                .map_or_else(Vec::new, |force| quantiles(force, &QUANTILES)),
            other_filter: other_filter(&strip.force, range, evaluation),
            spans: by(&supports),
            tension_lengths: by(&line.tension_lengths),
            losses: losses([time, &strip.force, &strip.contact_x], range, step, |x| line.span_at(x)),
            loss_classes: loss_classes(&strip.force, range, step),
            contact_height: contact_height(strip, range, evaluation),
        }
    }
}

fn other_filter(force: &[f64], range: &Range<usize>, evaluation: &Evaluation) -> Option<OtherFilter> {
    let filter = evaluation.filter.other();
    let filtered = evaluation.filtered_by(filter, force).ok()?;
    let filtered = ForceStatistics::of(filtered.get(range.clone())?)?;
    Some(OtherFilter { filter, filtered })
}

fn contact_height(strip: &StripRecord, range: &Range<usize>, evaluation: &Evaluation) -> Option<ContactHeight> {
    let height = evaluation.filtered(&strip.wire_z).ok()?;
    let (height, x) = (height.get(range.clone())?, strip.contact_x.get(range.clone())?);
    let statistics = ForceStatistics::of(height)?;
    Some(ContactHeight {
        mean_m: statistics.mean,
        max_m: statistics.max,
        min_m: statistics.min,
        range_m: peak_to_peak(height)?,
        gradient_permille: largest_slope(height, x).map(|slope| 1e3 * slope),
    })
}
