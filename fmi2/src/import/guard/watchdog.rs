//! A thread that notices calls that do not return.

use super::note::{self, Note};
use super::report::{self, Ending};
use std::collections::BTreeMap;
use std::sync::Once;
use std::time::{Duration, Instant};

/// Longest time between two looks.
const LONGEST: Duration = Duration::from_millis(250);
/// Shortest time between two looks.
const SHORTEST: Duration = Duration::from_millis(5);
/// Looks per time limit, at least.
const LOOKS: u32 = 20;

/// Starts the thread, once per process.
pub(super) fn start() {
    static STARTED: Once = Once::new();
    STARTED.call_once(|| {
        let thread = std::thread::Builder::new().name("fmu time limit".to_owned());
        // without the thread nothing is watched, which is no reason to refuse an FMU
        let _ = thread.spawn(watch);
    });
}

/// Checks all notes repeatedly.
fn watch() {
    let mut seen = BTreeMap::new();
    let mut period = SHORTEST;
    let mut last = Instant::now();
    loop {
        std::thread::sleep(period);
        // a process that was stopped, or a machine that slept, has not kept the FMU waiting
        let passed = last.elapsed().min(2 * period);
        last = Instant::now();
        period = LONGEST;
        for note in note::all() {
            let Some(call) = note.call() else { continue };
            if call.limit.is_zero() {
                continue;
            }
            period = period.min(call.limit / LOOKS);
            let (turn, time) = seen
                .entry(std::ptr::from_ref::<Note>(note) as usize)
                .or_insert((call.turn, Duration::ZERO));
            if *turn != call.turn {
                (*turn, *time) = (call.turn, Duration::ZERO);
                continue;
            }
            *time += passed;
            if *time > call.limit {
                report::end(&call, Ending::TimeLimit);
            }
        }
        period = period.max(SHORTEST);
    }
}
