//! Handlers of signals and of the end of the process.

use super::note;
use super::report::{self, Ending, Report};
use std::ffi::{c_int, c_void};
use std::mem::MaybeUninit;
use std::sync::{Once, OnceLock};

/// Signals of a crash.
const SIGNALS: [c_int; 5] = [libc::SIGSEGV, libc::SIGBUS, libc::SIGILL, libc::SIGFPE, libc::SIGABRT];

/// Previous handlers of the signals.
static BEFORE: OnceLock<[libc::sigaction; SIGNALS.len()]> = OnceLock::new();

/// Takes over the signals of a crash and the end of the process while calls into FMUs are under way; `report` gives the
/// receiver of last words. For programs, not for libraries, because the handlers are those of the whole process. Later
/// calls only change the receiver.
pub fn install(report: Report) {
    static INSTALLED: Once = Once::new();
    report::direct(report);
    report::own();
    INSTALLED.call_once(|| {
        // SAFETY: a sigaction of zeros is valid: the default action.
        let mut before: [libc::sigaction; SIGNALS.len()] = unsafe { std::mem::zeroed() };
        for (signal, before) in SIGNALS.into_iter().zip(&mut before) {
            // SAFETY: the pointers are valid; null asks only.
            unsafe { libc::sigaction(signal, std::ptr::null(), before) };
        }
        let _ = BEFORE.set(before);
        for signal in SIGNALS {
            // SAFETY: as above; the handler has the signature that SA_SIGINFO asks for and calls only what a handler
            // may. SA_ONSTACK: a stack that has overflowed cannot be used; threads of Rust's have another one for this.
            unsafe {
                let mut action = MaybeUninit::<libc::sigaction>::zeroed().assume_init();
                action.sa_sigaction = on_signal as extern "C" fn(_, _, _) as usize;
                action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
                libc::sigemptyset(&raw mut action.sa_mask);
                libc::sigaction(signal, &raw const action, std::ptr::null_mut());
            }
        }
        on_end();
    });
}

extern "C" fn on_signal(signal: c_int, info: *mut libc::siginfo_t, _context: *mut c_void) {
    if !report::is_copy()
        && let Some(call) = note::of_this_thread().or_else(note::of_any_thread)
    {
        report::end(&call, Ending::Signal(signal));
    }
    // Faults outside an FMU go to the previous handler: a fault occurs again when the handler returns, a sent signal is
    // sent again.
    let before = SIGNALS.iter().position(|known| *known == signal);
    let before = before.and_then(|place| BEFORE.get()?.get(place));
    // SAFETY: the kernel passes a valid siginfo; the action was read from the system; both functions may be called
    // here.
    unsafe {
        match before {
            Some(before) => libc::sigaction(signal, before, std::ptr::null_mut()),
            None => libc::sigaction(signal, &MaybeUninit::zeroed().assume_init(), std::ptr::null_mut()),
        };
        if info.is_null() || (*info).si_code <= 0 {
            libc::raise(signal);
        }
    }
}

#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn on_end() {
    unsafe extern "C" {
        fn on_exit(function: extern "C" fn(c_int, *mut c_void), argument: *mut c_void) -> c_int;
    }
    extern "C" fn ended(status: c_int, _argument: *mut c_void) {
        if !report::is_copy()
            && let Some(call) = note::of_this_thread()
        {
            report::end(&call, Ending::Exit(status));
        }
    }
    // SAFETY: the function lives as long as the program and needs no argument.
    unsafe { on_exit(ended, std::ptr::null_mut()) };
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn on_end() {
    extern "C" fn ended() {
        if !report::is_copy()
            && let Some(call) = note::of_this_thread()
        {
            report::end(&call, Ending::Exit(-1));
        }
    }
    // SAFETY: the function lives as long as the program.
    unsafe { libc::atexit(ended) };
}

/// Ends this process where it is a copy of the one that [`install`] was called in, made by an FMU's `fork()` and come
/// back from the FMU.
pub fn end_of_copy() {
    if report::is_copy() {
        // SAFETY: ends the copy without handlers, which belong to the process that it is a copy of.
        unsafe { libc::_exit(0) };
    }
}
