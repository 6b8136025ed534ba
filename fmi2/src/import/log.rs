//! Messages of an FMU.

use crate::abi::{Status, fmi2ComponentEnvironment, fmi2Status, fmi2String};
use crate::model_description::{BaseType, ModelDescription};
use crate::visible;
use std::collections::{BTreeMap, VecDeque};
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Most messages that are kept until they are fetched.
const KEPT: usize = 1000;

/// Message of an instance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogMessage {
    /// Status given by the FMU; an unknown integer counts as an error.
    pub status: Status,
    /// Category of the FMU's own list; may be empty.
    pub category: String,
    /// Text in one line; references to variables are replaced by their names.
    pub text: String,
}

/// Receiver of each message at once, on the thread of its origin.
pub type Listener = Box<dyn Fn(&LogMessage) + Send + Sync>;

/// Target of `componentEnvironment`. The C logger calls the first member.
#[repr(C)]
pub(super) struct Environment {
    line: unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String),
    messages: Mutex<VecDeque<LogMessage>>,
    /// Messages so far.
    count: AtomicU64,
    /// Names of the variables by the letter of their type and their reference.
    names: BTreeMap<(char, u32), String>,
    listener: Option<Listener>,
}

impl Environment {
    pub(super) fn new(description: &ModelDescription, listener: Option<Listener>) -> Self {
        let mut names = BTreeMap::new();
        for variable in &description.variables {
            let letter = match variable.base_type() {
                BaseType::Real => 'r',
                BaseType::Integer => 'i',
                BaseType::Boolean => 'b',
                BaseType::String => 's',
            };
            names
                .entry((letter, variable.value_reference))
                .or_insert_with(|| variable.name.clone());
        }
        Self {
            line,
            messages: Mutex::default(),
            count: AtomicU64::new(0),
            names,
            listener,
        }
    }

    /// Number of messages so far.
    pub(super) fn mark(&self) -> u64 {
        self.count.load(Ordering::Relaxed)
    }

    /// The last messages after `mark`, at most five.
    pub(super) fn since(&self, mark: u64) -> Vec<String> {
        let messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        let new = usize::try_from(self.mark().saturating_sub(mark)).unwrap_or(usize::MAX);
        let first = messages.len().saturating_sub(new.min(5));
        messages.range(first..).map(|message| message.text.clone()).collect()
    }

    pub(super) fn take(&self) -> Vec<LogMessage> {
        self.messages
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .drain(..)
            .collect()
    }

    pub(super) fn push(&self, message: LogMessage) {
        if let Some(listener) = &self.listener {
            listener(&message);
        }
        let mut messages = self.messages.lock().unwrap_or_else(PoisonError::into_inner);
        if messages.len() == KEPT {
            messages.pop_front();
        }
        messages.push_back(message);
        self.count.fetch_add(1, Ordering::Relaxed);
    }

    /// `#r12#` becomes the name of the variable, `##` becomes `#`, line breaks become blanks, and other control
    /// characters are shown as escapes.
    fn readable(&self, text: &str) -> String {
        let mut out = String::with_capacity(text.len());
        let mut rest = text.trim_end();
        while let Some(at) = rest.find('#') {
            out.push_str(&rest[..at]);
            rest = &rest[at + 1..];
            let reference = rest.split_once('#').and_then(|(inside, after)| {
                let mut letters = inside.chars();
                let letter = letters.next()?;
                let name = self.names.get(&(letter, letters.as_str().parse().ok()?))?;
                Some((name, after))
            });
            match reference {
                Some((name, after)) => {
                    out.push_str(name);
                    rest = after;
                }
                None => {
                    out.push('#');
                    rest = rest.strip_prefix('#').unwrap_or(rest);
                }
            }
        }
        out.push_str(rest);
        visible(&out.replace(['\n', '\r', '\t'], " ")).into_owned()
    }
}

/// Takes one formatted message; called by the C logger, from any thread.
unsafe extern "C" fn line(
    environment: fmi2ComponentEnvironment,
    _instance: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    text: fmi2String,
) {
    let text_of = |pointer: fmi2String| {
        if pointer.is_null() {
            return String::new();
        }
        // SAFETY: not null; the FMU or the C logger passes a NUL-terminated text that lives during the call.
        unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
    };
    // a panic must not reach the FMU, and there is nobody to report it to
    let _ = catch_unwind(AssertUnwindSafe(|| {
        // SAFETY: the C logger was given this pointer by us; it points to the environment, which outlives the
        // instance. Members that change are behind a lock or atomic.
        let Some(environment) = (unsafe { environment.cast::<Environment>().as_ref() }) else {
            return;
        };
        environment.push(LogMessage {
            status: Status::try_from(status).unwrap_or(Status::Error),
            category: visible(&text_of(category)).into_owned(),
            text: environment.readable(&text_of(text)),
        });
    }));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_description::Variable;

    #[test]
    fn references_become_names_and_doubled_hashes_single_ones() {
        let variables = vec![
            Variable::input("force", "N", 0.0, "Force"),
            Variable::output("x", "m", "Position"),
        ];
        let environment = Environment::new(&ModelDescription::of_slave("Test", variables), None);
        assert_eq!(
            environment.readable("#r1# is ##1 of #r9# and #i1#\nend"),
            "x is #1 of #r9# and #i1# end"
        );
        assert_eq!(environment.readable("50 #"), "50 #");
        assert_eq!(environment.readable("\u{1b}[2J\u{7}"), "\\u{1b}[2J\\u{7}");
    }
}
