//! Whole numbers, flags and strings.

use std::ops::RangeInclusive;

use super::Keys;
use crate::error::What;
use crate::tree::{Node, Value};
use crate::write::shown;

impl Keys<'_> {
    /// A whole number within a range.
    pub(crate) fn count(
        &mut self,
        name: &str,
        was: Option<usize>,
        range: RangeInclusive<usize>,
        default: Option<usize>,
    ) -> usize {
        if let Some(value) = was {
            self.push(name, Value::Integer(value as i64));
            return value;
        }
        if self.record(name, "", described(&range), default.map(|value| value.to_string())) {
            return default.unwrap_or(*range.start());
        }
        match self.node(name).cloned() {
            Some(node) => self.checked_count(self.key(name), &node, &range),
            None => default.unwrap_or_else(|| {
                self.missing(name, described(&range));
                *range.start()
            }),
        }
    }

    /// A whole number found at `node`, whose full path is `key`.
    fn checked_count(&mut self, key: String, node: &Node, range: &RangeInclusive<usize>) -> usize {
        let found = match node.value {
            Value::Integer(found) => usize::try_from(found).ok(),
            _ => None,
        };
        if let Some(found) = found.filter(|found| range.contains(found)) {
            return found;
        }
        let what = match &node.value {
            Value::Integer(_) | Value::Float(_) => What::Refused {
                value: shown(&node.value),
                expected: format!("must be {}", described(range)),
            },
            other => What::WrongType {
                value: shown(other),
                expected: described(range),
            },
        };
        self.problem(node.at, key, what);
        *range.start()
    }

    /// A list of two whole numbers.
    pub(crate) fn pair_of_counts(
        &mut self,
        name: &str,
        was: Option<[usize; 2]>,
        range: RangeInclusive<usize>,
    ) -> [usize; 2] {
        let expected = "a list of 2 whole numbers";
        if let Some(pair) = was {
            self.push(
                name,
                Value::List(pair.iter().map(|value| Value::Integer(*value as i64).into()).collect()),
            );
            return pair;
        }
        if self.record(name, "", format!("list of 2, each {}", described(&range)), None) {
            return [*range.start(); 2];
        }
        match self.node(name).cloned() {
            Some(Node {
                value: Value::List(list),
                ..
            }) if list.len() == 2 => [0, 1].map(|i| self.checked_count(self.entry_key(name, i), &list[i], &range)),
            Some(node) => {
                self.wrong_type(name, &node.value, expected.to_string());
                [*range.start(); 2]
            }
            None => {
                self.missing(name, expected);
                [*range.start(); 2]
            }
        }
    }

    /// True or false.
    pub(crate) fn flag(&mut self, name: &str, was: Option<bool>, default: bool) -> bool {
        if let Some(flag) = was {
            self.push(name, Value::Boolean(flag));
            return flag;
        }
        if self.record(name, "", "true or false", Some(default.to_string())) {
            return default;
        }
        match self.node(name).cloned() {
            Some(Node {
                value: Value::Boolean(flag),
                ..
            }) => flag,
            Some(node) => {
                self.wrong_type(name, &node.value, "true or false".to_string());
                default
            }
            None => default,
        }
    }

    /// A list of true and false; `None` where it is left out.
    pub(crate) fn optional_flags(&mut self, name: &str, was: Option<&[bool]>) -> Option<Vec<bool>> {
        let flag = |value: &Value| match value {
            Value::Boolean(flag) => Some(*flag),
            _ => None,
        };
        let texts = ("list of true and false", "a list of true and false");
        self.optional_list(name, was, texts, |flag| Value::Boolean(*flag), flag)
    }

    /// A list of plain values, which `of` gives from a value of the file where it is one; `None` where it is left out.
    /// `range` describes it, `expected` stands in messages.
    fn optional_list<T: Clone>(
        &mut self,
        name: &str,
        was: Option<&[T]>,
        (range, expected): (&str, &str),
        to: impl Fn(&T) -> Value,
        of: impl Fn(&Value) -> Option<T>,
    ) -> Option<Vec<T>> {
        if let Some(values) = was {
            self.push(name, Value::List(values.iter().map(|value| to(value).into()).collect()));
            return Some(values.to_vec());
        }
        self.may_be_left_out(name);
        if self.record(name, "", range, None) {
            return None;
        }
        let node = self.node(name).cloned()?;
        let values = match &node.value {
            Value::List(list) => list.iter().map(|entry| of(&entry.value)).collect(),
            _ => None,
        };
        if values.is_none() {
            self.wrong_type(name, &node.value, expected.to_owned());
        }
        values
    }

    /// A string that is not empty.
    pub(crate) fn text(&mut self, name: &str, was: Option<&str>, expected: &str) -> String {
        if let Some(text) = was {
            self.push(name, Value::String(text.to_string()));
            return text.to_string();
        }
        if self.record(name, "", "text", None) {
            return String::new();
        }
        match self.node(name).cloned() {
            Some(Node {
                value: Value::String(text),
                ..
            }) => {
                if text.is_empty() {
                    self.refuse(name, format!("must be {expected}, not empty"));
                }
                text
            }
            Some(node) => {
                self.wrong_type(name, &node.value, expected.to_string());
                String::new()
            }
            None => {
                self.missing(name, expected);
                String::new()
            }
        }
    }

    /// A list of strings, none of them empty; an empty list where it is left out.
    pub(crate) fn optional_texts(&mut self, name: &str, was: Option<&[String]>, expected: &str) -> Vec<String> {
        let text = |value: &Value| match value {
            Value::String(text) if !text.is_empty() => Some(text.clone()),
            _ => None,
        };
        let was = was.filter(|texts| !texts.is_empty());
        let texts = self.optional_list(
            name,
            was,
            ("list of texts", expected),
            |text| Value::String(text.clone()),
            text,
        );
        texts.unwrap_or_default()
    }

    /// A string that may be left out.
    pub(crate) fn optional_text(&mut self, name: &str, was: Option<Option<&str>>, expected: &str) -> Option<String> {
        self.has(name, was.flatten().is_some())
            .then(|| self.text(name, was.flatten(), expected))
    }
}

fn described(range: &RangeInclusive<usize>) -> String {
    format!("a whole number from {} to {}", range.start(), range.end())
}
