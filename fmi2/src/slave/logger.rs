//! Messages to the importer [FMI 2.0, 2.1.5].

use crate::abi::{Status, fmi2CallbackFunctions, fmi2CallbackLogger, fmi2ComponentEnvironment};
use crate::model_description::LogCategory;
use std::ffi::{CStr, CString};

/// Longest message, bytes: importers have buffers of 1024 bytes and more.
const MAX_MESSAGE: usize = 1000;

/// Category of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Category {
    /// The importer did something unusual that is accepted.
    Event,
    /// Done, but worth a look.
    Warning,
    /// A step that may be tried again.
    Discard,
    /// A call that failed; always passed on.
    Error,
}

/// Category with its name and description in the model description.
const CATEGORIES: [(Category, &CStr, &str); 4] = [
    (Category::Event, c"logEvents", "Unusual calls that are accepted"),
    (Category::Warning, c"logStatusWarning", "Warnings"),
    (
        Category::Discard,
        c"logStatusDiscard",
        "Steps that may be tried again with a smaller step size",
    ),
    (Category::Error, c"logStatusError", "Errors; always logged"),
];

/// The log categories of every model on this runtime, as the model description lists them.
#[must_use]
pub fn log_categories() -> Vec<LogCategory> {
    CATEGORIES
        .iter()
        .map(|(_, name, description)| LogCategory {
            name: name.to_string_lossy().into_owned(),
            description: Some((*description).to_owned()),
        })
        .collect()
}

impl Category {
    pub(super) fn from_name(name: &str) -> Option<Self> {
        CATEGORIES
            .iter()
            .find(|(_, known, _)| known.to_bytes() == name.as_bytes())
            .map(|entry| entry.0)
    }

    fn c_name(self) -> &'static CStr {
        CATEGORIES
            .iter()
            .find(|(category, ..)| *category == self)
            .map_or(c"logStatusError", |entry| entry.1)
    }

    fn status(self) -> Status {
        match self {
            Self::Event => Status::Ok,
            Self::Warning => Status::Warning,
            Self::Discard => Status::Discard,
            Self::Error => Status::Error,
        }
    }
}

/// The importer's logger with its requested categories.
#[derive(Debug)]
pub(super) struct Logger {
    function: Option<fmi2CallbackLogger>,
    environment: fmi2ComponentEnvironment,
    instance_name: CString,
    /// True if messages other than errors are passed on.
    on: bool,
    /// Requested categories; empty for all.
    categories: Vec<Category>,
}

impl Logger {
    pub(super) fn new(callbacks: &fmi2CallbackFunctions, instance_name: CString, on: bool) -> Self {
        Self {
            function: callbacks.logger,
            environment: callbacks.component_environment,
            instance_name,
            on,
            categories: Vec::new(),
        }
    }

    pub(super) fn select(&mut self, on: bool, categories: Vec<Category>) {
        self.on = on;
        self.categories = categories;
    }

    pub(super) fn wants(&self, category: Category) -> bool {
        let selected = self.categories.is_empty() || self.categories.contains(&category);
        category == Category::Error || self.on && selected
    }

    /// Passes `text` on if its category is requested.
    pub(super) fn log(&self, category: Category, text: &str) {
        let Some(function) = self.function.filter(|_| self.wants(category)) else {
            return;
        };
        let text = escaped(text);
        // SAFETY: `function` is the importer's logger, valid until `fmi2FreeInstance` [FMI 2.0, 2.1.5]; all
        // strings are NUL-terminated and live during the call, and the format takes exactly one string.
        unsafe {
            function(
                self.environment,
                self.instance_name.as_ptr(),
                category.status() as i32,
                category.c_name().as_ptr(),
                c"%s".as_ptr(),
                text.as_ptr(),
            );
        }
    }
}

/// Line of at most [`MAX_MESSAGE`] bytes in which `#` is doubled, because `#r12#` names a variable.
fn escaped(text: &str) -> CString {
    let mut line = String::with_capacity(text.len().min(MAX_MESSAGE));
    for c in text.trim_end().chars() {
        let length = if c == '#' { 2 } else { c.len_utf8() };
        if line.len() + length > MAX_MESSAGE {
            break;
        }
        match c {
            '#' => line.push_str("##"),
            c if c.is_control() => line.push(' '),
            c => line.push(c),
        }
    }
    CString::new(line).unwrap_or_default() // control characters, NUL among them, are gone
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_one_short_line_with_doubled_hashes() {
        assert_eq!(escaped("a#b\nc\0d\n").to_bytes(), b"a##b c d");
        assert_eq!(escaped(&"#".repeat(600)).to_bytes().len(), MAX_MESSAGE);
        assert_eq!(escaped(&"ü".repeat(600)).to_bytes().len(), MAX_MESSAGE);
    }
}
