//! EN 50317: how the contact force is measured, and so evaluated here.

use super::{Bound, Conditions, Figures, Limit};

const NAME: &str = "EN 50317";
/// Upper end of the band of the contact force, Hz.
const BAND: f64 = 20.0;
/// Fewest samples per second, Hz; remembered, as is the other measure, a sample every 0.40 m.
const SAMPLING: f64 = 200.0;

/// The section that statistics are of.
pub(super) fn control_section(figures: &Figures) -> Limit {
    Limit::new(
        (NAME, "2012, clause not verified"),
        "control_section",
        Some(figures.section),
        "m",
    )
    .bounded(Bound::AtLeast, None)
    .remembered()
    .because(
        "a shortest length is not known here; a measured section is kilometres long, a simulated one is run.evaluate",
    )
    .remark("mean, standard deviation and extremes are those of this section as one")
}

/// Band and sampling.
pub(super) fn of_evaluation(conditions: &Conditions) -> [Limit; 2] {
    let band = Limit::new(
        (NAME, "2012, clause not verified"),
        "band",
        Some(conditions.low_pass_hz),
        "Hz",
    )
    .bounded(Bound::Equal, BAND)
    .because("limits of the force are for this band; run.low_pass_hz is the end of it")
    .remark(conditions.filter.text());
    let rate = Limit::new(
        (NAME, "2012, clause not verified"),
        "sampling_rate",
        Some(1.0 / conditions.output_step),
        "Hz",
    )
    .bounded(Bound::AtLeast, SAMPLING)
    .remembered()
    .because("run.output_step")
    .remark(format!(
        "a sample every {:.0} mm of track",
        1e3 * conditions.speed * conditions.output_step
    ));
    [band, rate]
}
