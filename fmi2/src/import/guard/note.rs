//! Notes of the activity of instances, readable at any time by any thread and by signal handlers.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU8, AtomicU64, AtomicUsize, Ordering, fence};
use std::time::Duration;

/// Bytes of a label that are kept.
const LABEL: usize = 240;

/// All notes ever made, the last one first; they are never freed but used again.
static FIRST: AtomicPtr<Note> = AtomicPtr::new(std::ptr::null_mut());

thread_local! {
    /// Note of the call that this thread is in, or null.
    static CURRENT: Cell<*const Note> = const { Cell::new(std::ptr::null()) };
}

/// Activity of one instance.
///
/// `turn` is odd while a call is under way; the other members of a call change only while `turn` is even, so that a
/// reader that finds the same odd number before and after has read a consistent call.
pub(in crate::import) struct Note {
    taken: AtomicBool,
    turn: AtomicU64,
    function: AtomicPtr<u8>,
    function_length: AtomicUsize,
    /// Bits of the time of the instance, s; NaN before it has one.
    time: AtomicU64,
    /// Longest wall time of a call, ms; 0 for no limit.
    limit: AtomicU64,
    label: [AtomicU8; LABEL],
    label_length: AtomicUsize,
    next: AtomicPtr<Note>,
}

/// A call under way, as read from its note.
#[derive(Clone, Copy)]
pub(super) struct Call {
    pub function: &'static str,
    /// Time of the instance, s; NaN before it has one.
    pub time: f64,
    pub limit: Duration,
    pub turn: u64,
    pub note: &'static Note,
}

impl Note {
    /// Note for a new instance; `label` is its name in reports.
    pub(in crate::import) fn taken(label: &str, limit: Option<Duration>) -> &'static Self {
        let free = all().find(|note| {
            let claim = note
                .taken
                .compare_exchange(false, true, Ordering::AcqRel, Ordering::Relaxed);
            claim.is_ok()
        });
        let note = free.unwrap_or_else(Self::published);
        let mut end = label.len().min(LABEL);
        while !label.is_char_boundary(end) {
            end -= 1;
        }
        for (place, byte) in note.label.iter().zip(&label.as_bytes()[..end]) {
            place.store(*byte, Ordering::Relaxed);
        }
        note.label_length.store(end, Ordering::Relaxed);
        note.time.store(f64::NAN.to_bits(), Ordering::Relaxed);
        let limit = limit.map_or(0, |limit| u64::try_from(limit.as_millis()).unwrap_or(u64::MAX).max(1));
        note.limit.store(limit, Ordering::Relaxed);
        if limit > 0 {
            super::watchdog::start();
        }
        note
    }

    /// A new note, taken, at the head of the list.
    fn published() -> &'static Self {
        let note = Box::leak(Box::new(Self {
            taken: AtomicBool::new(true),
            turn: AtomicU64::new(0),
            function: AtomicPtr::new(std::ptr::null_mut()),
            function_length: AtomicUsize::new(0),
            time: AtomicU64::new(0),
            limit: AtomicU64::new(0),
            label: [const { AtomicU8::new(0) }; LABEL],
            label_length: AtomicUsize::new(0),
            next: AtomicPtr::new(std::ptr::null_mut()),
        }));
        let mut head = FIRST.load(Ordering::Acquire);
        loop {
            note.next.store(head, Ordering::Relaxed);
            match FIRST.compare_exchange_weak(head, note, Ordering::AcqRel, Ordering::Acquire) {
                Ok(_) => return note,
                Err(newer) => head = newer,
            }
        }
    }

    /// Releases the note for the next instance.
    pub(in crate::import) fn release(&self) {
        self.taken.store(false, Ordering::Release);
    }

    /// Records the time of the instance, s.
    pub(in crate::import) fn at(&self, time: f64) {
        self.time.store(time.to_bits(), Ordering::Relaxed);
    }

    /// Makes a call of `function`.
    pub(in crate::import) fn during<T>(&'static self, function: &'static str, call: impl FnOnce() -> T) -> T {
        struct Under(&'static Note);
        impl Drop for Under {
            fn drop(&mut self) {
                CURRENT.set(std::ptr::null());
                let turn = self.0.turn.load(Ordering::Relaxed);
                self.0.turn.store(turn + 1, Ordering::Release);
            }
        }
        // the turn is seen to be even before anything else changes
        fence(Ordering::Release);
        self.function.store(function.as_ptr().cast_mut(), Ordering::Relaxed);
        self.function_length.store(function.len(), Ordering::Relaxed);
        let turn = self.turn.load(Ordering::Relaxed);
        self.turn.store(turn + 1, Ordering::Release);
        CURRENT.set(self);
        let _under = Under(self);
        call()
    }

    /// The call under way, if there is one.
    pub(super) fn call(&'static self) -> Option<Call> {
        let turn = self.turn.load(Ordering::Acquire);
        if turn.is_multiple_of(2) {
            return None;
        }
        let (pointer, length) = (
            self.function.load(Ordering::Acquire),
            self.function_length.load(Ordering::Acquire),
        );
        let time = f64::from_bits(self.time.load(Ordering::Acquire));
        let limit = Duration::from_millis(self.limit.load(Ordering::Acquire));
        if self.turn.load(Ordering::Acquire) != turn {
            return None;
        }
        // SAFETY: both are of one `&'static str`: they change only while the turn is even, and it was odd throughout.
        let function =
            unsafe { std::str::from_utf8_unchecked(std::slice::from_raw_parts(pointer.cast_const(), length)) };
        Some(Call {
            function,
            time,
            limit,
            turn,
            note: self,
        })
    }

    /// Copies the label, as far as it fits.
    pub(super) fn label(&self, into: &mut [u8]) -> usize {
        let length = self.label_length.load(Ordering::Relaxed).min(into.len());
        for (byte, place) in into.iter_mut().zip(&self.label).take(length) {
            *byte = place.load(Ordering::Relaxed);
        }
        length
    }
}

/// All notes.
pub(super) fn all() -> impl Iterator<Item = &'static Note> {
    // SAFETY: notes are published complete and never freed.
    let note = |pointer: *mut Note| unsafe { pointer.as_ref::<'static>() };
    let first = note(FIRST.load(Ordering::Acquire));
    std::iter::successors(first, move |previous| note(previous.next.load(Ordering::Acquire)))
}

/// Call that this thread is in.
#[cfg(unix)]
pub(super) fn of_this_thread() -> Option<Call> {
    // SAFETY: null or a note, which are never freed.
    unsafe { CURRENT.get().as_ref::<'static>() }.and_then(Note::call)
}

/// Any call under way in any thread.
#[cfg(unix)]
pub(super) fn of_any_thread() -> Option<Call> {
    all().find_map(Note::call)
}
