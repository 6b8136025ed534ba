//! Guard against panics: a panic that crosses `extern "C"` would end the host.

use super::library;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::{Mutex, Once, PoisonError};

thread_local! {
    /// Depth of guarded calls on this thread; without destructor, so that the library can be unloaded.
    static GUARDED: Cell<usize> = const { Cell::new(0) };
}

static HOOK: Once = Once::new();
/// Places of guarded panics by thread, until their guard fetches them.
static PLACES: Mutex<Vec<(usize, String)>> = Mutex::new(Vec::new());

/// Runs `body`; a panic becomes the text of its message with its place, and nothing is printed.
pub(super) fn guarded<T>(body: impl FnOnce() -> T) -> Result<T, String> {
    HOOK.call_once(|| {
        library::pin();
        let previous = take_hook();
        set_hook(Box::new(move |info| {
            if GUARDED.get() == 0 {
                previous(info);
                return;
            }
            let place = info.location().map(ToString::to_string).unwrap_or_default();
            PLACES
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .push((this_thread(), place));
        }));
    });
    GUARDED.set(GUARDED.get() + 1);
    let outcome = catch_unwind(AssertUnwindSafe(body));
    GUARDED.set(GUARDED.get() - 1);
    outcome.map_err(|payload| {
        let text = payload
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "panic without a message".to_owned());
        let mut places = PLACES.lock().unwrap_or_else(PoisonError::into_inner);
        let here = this_thread();
        let place = places
            .iter()
            .rposition(|(thread, _)| *thread == here)
            .map(|at| places.swap_remove(at).1);
        match place {
            Some(place) => format!("{text} ({place})"),
            None => text,
        }
    })
}

/// Differs between living threads. `thread::current` would register a destructor in this library with the thread.
fn this_thread() -> usize {
    GUARDED.with(|depth| std::ptr::from_ref(depth).addr())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_its_message_with_its_place() {
        let index = std::hint::black_box(7);
        let message = guarded(|| [1, 2, 3][index]).unwrap_err();
        assert!(
            message.starts_with("index out of bounds: the len is 3 but the index is 7 ("),
            "{message}"
        );
        assert!(message.contains("guard.rs:"), "{message}");
        assert_eq!(guarded(|| 5), Ok(5));
    }
}
