//! Calls into FMUs that are under way: report when one of them crashes, hangs or ends the process.
//!
//! An FMU is native code in this process and can fall over a bad pointer, call `abort()` or `exit()`, or never return.
//! Such an end cannot be undone, but the FMU and the call can be named:
//!
//! - [`install`] takes over the signals of a crash (SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT) and the end by `exit()`
//!   while a call is under way. Faults outside calls go to their previous handlers.
//! - A time limit ([`Options::time_limit`](super::Options)) is watched by a thread, started with the first limit.
//!
//! A [`Report`] is made in either case, and the process ends with exit status 1; no destructor runs, so folders of
//! unpacked FMUs stay. `_exit()`, SIGKILL and a crash in a thread that outlives all calls cannot be noticed here: only
//! another process can, which sees how this one ended, see [`supervision`](crate::supervision).
//!
//! A call costs a few stores into memory of its own instance; no clock is read.

#[cfg(unix)]
mod crash;
mod note;
mod report;
mod watchdog;

#[cfg(unix)]
pub use crash::{end_of_copy, install};
/// Receiver of last words; crashes are not noticed on this system.
#[cfg(not(unix))]
pub fn install(report: Report) {
    report::direct(report);
}
pub(super) use note::Note;
pub use report::{Ending, Obituary, Report};
#[cfg(unix)]
pub(crate) use report::{say, supervised};

#[cfg(test)]
mod tests;
