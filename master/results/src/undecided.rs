//! Records that say nothing about a limit: a verdict on them would be one on chance, on the filter or on a broken
//! model.
//!
//! ```text
//! ε[σ] = 1/(2 √(B T))      relative standard error of σ of noise of band B over the time T  [Bendat & Piersol, 8.2]
//! ```
//!
//! Source: `[Bendat & Piersol]` J. S. Bendat, A. G. Piersol, Random Data: Analysis and Measurement Procedures, 4th
//! edition, Wiley, 2010.

use crate::standards::Limit;
use crate::{Evaluation, Record};

/// Fewest periods of the filter's cut-off frequency in the evaluated time, –: below, σ is uncertain by a sixth and
/// more, and the ends of the filtered record are a large part of it.
const PERIODS: f64 = 10.0;

/// Fewest samples in a period of the cut-off frequency, –: with fewer, motion of a few times this frequency, which the
/// force has plenty of, comes back into the band.
const SAMPLES: f64 = 5.0;

/// Largest depth of a strip in a wire, m: more than any strip is thick.
const DEPTH: f64 = 0.05;

/// Rounding of quotients of decimal numbers, –.
const ROUNDING: f64 = 1e-9;

/// Limits of the setting, which hold or fail whatever was recorded.
const OF_THE_SETTING: [&str; 3] = ["speed_ratio", "band", "sampling_rate"];

/// Takes back the verdict on every limit that the record says nothing about, and gives the reasons, one for each
/// pantograph that has any.
pub(crate) fn take_back(limits: &mut [Limit], evaluation: &Evaluation, record: &Record) -> Vec<String> {
    let count = record.pantographs.len();
    let reasons: Vec<Vec<String>> = (0..count).map(|index| reasons(evaluation, record, index)).collect();
    for limit in limits.iter_mut().filter(|limit| limit.pass.is_some()) {
        if OF_THE_SETTING.contains(&limit.quantity.as_str()) {
            continue;
        }
        // A limit of the line is that of all pantographs together.
        let of = match limit.pantograph {
            Some(number) => reasons.get(number - 1).and_then(|reasons| reasons.first()),
            None => reasons.iter().flatten().next(),
        };
        if let Some(reason) = of {
            limit.pass = None;
            limit.reason = format!("not decided: {reason}");
        }
    }
    let noted = reasons.iter().enumerate().filter(|(_, reasons)| !reasons.is_empty());
    noted
        .map(|(index, reasons)| format!("pantograph {}: no limit is decided: {}", index + 1, reasons.join("; ")))
        .collect()
}

/// Reasons why the record of pantograph `index` (from 0) says nothing.
fn reasons(evaluation: &Evaluation, record: &Record, index: usize) -> Vec<String> {
    let (cutoff, step) = (evaluation.low_pass_hz, evaluation.output_step);
    let range = evaluation.samples(&record.time, index);
    let mut reasons = Vec::new();
    let evaluated = step * range.len().saturating_sub(1) as f64;
    let needed = PERIODS / cutoff;
    if evaluated < needed * (1.0 - ROUNDING) {
        reasons.push(format!(
            "{evaluated} s are evaluated, {:.1} periods of run.low_pass_hz = {cutoff} Hz; {PERIODS} are \
             needed, {needed} s",
            evaluated * cutoff
        ));
    }
    let coarsest = 1.0 / (SAMPLES * cutoff);
    if step > coarsest * (1.0 + ROUNDING) {
        reasons.push(format!(
            "run.output_step = {step} s is too coarse for run.low_pass_hz = {cutoff} Hz: faster motion comes back into \
             the band; {coarsest} s are needed, {SAMPLES} samples in a period"
        ));
    }
    let gaps = record.pantographs[index].gap.get(range).unwrap_or_default();
    let depth = -gaps.iter().copied().fold(f64::INFINITY, f64::min);
    if depth > DEPTH && depth.is_finite() {
        reasons.push(format!(
            "the strip is up to {depth:.3} m inside the contact wire, more than {DEPTH} m: contact.stiffness is too \
             small to hold it"
        ));
    }
    reasons
}
