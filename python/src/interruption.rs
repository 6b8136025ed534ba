//! Work without the lock of the interpreter, which Ctrl-C ends in order.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// Interval in which the interpreter is asked for signals.
const LOOK: Duration = Duration::from_millis(50);

/// A flag that is set when its guard goes, by return or by panic.
#[derive(Default)]
struct Ended {
    flag: Mutex<bool>,
    set: Condvar,
}

struct Guard<'a>(&'a Ended);

impl Drop for Guard<'_> {
    fn drop(&mut self) {
        *self.0.flag.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.0.set.notify_all();
    }
}

impl Ended {
    /// Waits for the flag for one interval; `true` where it is set.
    fn wait(&self) -> bool {
        let flag = self.flag.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.set.wait_timeout_while(flag, LOOK, |ended| !*ended);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

/// Does `work` on a thread of its own, with the lock of the interpreter released. A signal whose handler raises, such
/// as Ctrl-C, sets the flag that `work` is given, and is raised when `work` has ended.
///
/// # Errors
/// Exceptions of handlers of signals.
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let (stop, ended) = (AtomicBool::new(false), Ended::default());
    let (stop, ended) = (&stop, &ended);
    thread::scope(|scope| {
        let worker = scope.spawn(move || {
            let _guard = Guard(ended);
            work(stop)
        });
        let mut signals = Ok(());
        while !py.detach(|| ended.wait()) {
            if signals.is_ok() {
                signals = py.check_signals();
                stop.store(signals.is_err(), Ordering::Relaxed);
            }
        }
        let made = worker.join();
        signals?;
        made.or_else(|panic| std::panic::resume_unwind(panic))
    })
}
