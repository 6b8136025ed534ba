//! EN 50317: how the contact force is measured, and so evaluated here.

use super::{Bound, Conditions, Figures, Limit};

/// The clauses are not known here.
const QUOTED: (&str, &str, &str) = ("EN 50317", "2012", "clause not verified");
/// Room for rounding of times and places, –.
const ROUNDING: f64 = 1e-6;
/// Upper end of the band of the contact force, Hz.
const BAND: f64 = 20.0;
/// Fewest samples per second, Hz; remembered, as is the other measure, a sample every 0.40 m.
const SAMPLING: f64 = 200.0;

/// The section that statistics are of. A measured one is kilometres long; no shortest length could be read anywhere, so
/// that the rule is chosen here: the force repeats from span to span, and a part of a span is not representative.
pub(super) fn control_section(figures: &Figures) -> Limit {
    const CHOSEN: (&str, &str, &str) = ("EN 50317", "2012", "no figure known");
    let section = Limit::new(CHOSEN, "control_section", Some(figures.section), "m").chosen();
    let Some(span) = figures.longest_span else {
        return section.not_applicable("the spans of a supplied line are not known");
    };
    let least = (1.0 - ROUNDING) * span;
    // A rule of this program decides nothing against a run.
    if figures.section < least {
        return section.because(format!("not decided: less than a span of {span:.0} m is evaluated"));
    }
    section
        .bounded(Bound::AtLeast, least)
        .because("chosen here: the longest span that is evaluated, at least once")
        .formula(
            "the longest span that is evaluated; a measured section is kilometres long: enter the length of your \
             edition under [assessment]",
        )
}

/// Band and sampling.
pub(super) fn of_evaluation(conditions: &Conditions) -> [Limit; 2] {
    let band = Limit::new(QUOTED, "band", Some(conditions.low_pass_hz), "Hz")
        .bounded(Bound::Equal, BAND)
        .because("limits of the force are for this band; run.low_pass_hz is the end of it")
        .remark(conditions.filter.text());
    let rate = Limit::new(QUOTED, "sampling_rate", Some(1.0 / conditions.output_step), "Hz")
        .bounded(Bound::AtLeast, SAMPLING)
        .remembered()
        .because("run.output_step")
        .remark(format!(
            "a sample every {:.0} mm of track",
            1e3 * conditions.speed * conditions.output_step
        ));
    [band, rate]
}
