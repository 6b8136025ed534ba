//! End of a run.

use super::row::RunRow;
use crate::engine::words;
use results::curve::Errors;

/// Error of the filtered force above which a run has nothing to do with its reference, % of the reference's standard
/// deviation.
pub const RUNAWAY: f64 = 100.0;

/// Error of the raw force above which the coupling rings, % of the reference's standard deviation (filtered).
pub const RAW_ERROR: f64 = 100.0;

/// Loss of contact beyond twice the reference's that counts as a bounce of the coupling's own making, % of the
/// evaluation time.
pub const LOSS: f64 = 0.1;

/// Energy that the coupling added or took beyond which the force is partly the coupling's own, % of the work that
/// crossed the contact.
pub const ENERGY: f64 = 10.0;

/// The bounds in words, for help and pages.
pub const STATUS_RULE: &str = "diverged: the run did not reach its end, or its filtered force is wrong by more than \
    100 % of the reference's standard deviation (rms). limit: it loses contact for more than twice the reference's \
    time and 0.1 %, or its raw force is wrong by more than 100 %, or the coupling added or took more than 10 % of the \
    work that crossed the contact. refused: it cannot begin, the reason says why. stable: everything else";

words! {
    /// End of a run, the best first.
    pub enum Status {
        /// Nothing to report.
        Stable = "stable",
        /// Done, but the coupling rings or bounces.
        Limit = "limit",
        /// Not done, or nothing like the reference.
        Diverged = "diverged",
        /// Cannot begin.
        Refused = "refused",
    }
}

impl Status {
    /// Decides on a run that has begun.
    ///
    /// `complete` is whether it reached its end, `errors` and `reference` are what it is compared with; a reference
    /// itself has none. Returns the status, and the reason where it is not stable.
    #[must_use]
    pub fn of(row: &RunRow, complete: bool, errors: Option<&Errors>, reference: Option<&RunRow>) -> (Self, String) {
        if !complete {
            return (Self::Diverged, String::new());
        }
        if ![row.mean, row.std]
            .into_iter()
            .all(|value| value.is_some_and(f64::is_finite))
        {
            return (Self::Diverged, "the contact force is not finite".to_owned());
        }
        let Some(errors) = errors else {
            return (Self::Stable, String::new());
        };
        let above = |error: Option<f64>, bound: f64| error.is_none_or(|error| error.is_nan() || error > bound);
        let wrong =
            |what: &str, by: f64| format!("the {what} force is wrong by more than {by} % of the standard deviation");
        if above(errors.filtered, RUNAWAY) {
            return (Self::Diverged, wrong("filtered", RUNAWAY));
        }
        let [loss, expected] = [Some(row), reference].map(|row| row.and_then(|row| row.loss).unwrap_or(0.0));
        if loss > 2.0 * expected + LOSS {
            let reason = format!("contact is lost for {loss:.2} % of the time, in the reference for {expected:.2} %");
            return (Self::Limit, reason);
        }
        if above(errors.raw, RAW_ERROR) {
            return (Self::Limit, wrong("raw", RAW_ERROR));
        }
        (Self::Stable, String::new())
    }

    /// The status with regard to the energy that the coupling added, `share` of the work that crossed the contact (–),
    /// and the reason where that changes it.
    #[must_use]
    pub fn with_energy(self, share: f64) -> (Self, String) {
        let percent = 100.0 * share;
        if self != Self::Stable || percent.abs() <= ENERGY {
            return (self, String::new());
        }
        let verb = if share > 0.0 { "added" } else { "took" };
        let percent = percent.abs();
        let reason = format!("the coupling {verb} {percent:.1} % of the work that crossed the contact");
        (Self::Limit, reason)
    }
}
