//! Tables of numbers column by column, or the path of a file that holds them.

use super::{Keys, Length, Number};
use crate::error::What;

impl Keys<'_> {
    /// The path of a CSV file in place of the lists `columns`, where `file` is there.
    pub(crate) fn column_file(&mut self, was: Option<Option<&str>>, columns: &[&str]) -> Option<String> {
        if !self.has("file", was.flatten().is_some()) {
            return None;
        }
        let path = self.text("file", was.flatten(), "the path of a CSV file, relative to the scene");
        for name in columns {
            if self.has(name, false) {
                let because = "file is given, which has the lists as columns".to_owned();
                self.report(name, What::LeaveOut { because });
            }
        }
        (!self.describes()).then_some(path)
    }

    /// A list of `n` numbers that may be left out: all zero.
    pub(crate) fn column(&mut self, name: &str, was: Option<&[f64]>, unit: &'static str, n: usize) -> Vec<f64> {
        let written = was.is_some_and(|values| values.iter().any(|value| *value != 0.0));
        if self.has(name, written) {
            self.numbers(name, was, Number::any(unit).default(0.0), Length::Exactly(n))
        } else {
            vec![0.0; n]
        }
    }
}
