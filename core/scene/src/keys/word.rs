//! Words.

use super::Keys;
use crate::choice::Choice;
use crate::error::What;
use crate::renames;
use crate::tree::{Node, Value};
use crate::write::shown;

impl Keys<'_> {
    /// One of a few words.
    pub(crate) fn word<T: Choice>(&mut self, name: &str, was: Option<T>, default: Option<T>) -> T {
        let found = self.word_among(name, was, T::NAMES, T::UNAVAILABLE, default);
        found.unwrap_or(T::NAMES[0].1)
    }

    /// One of a few words, which may be left out.
    pub(crate) fn optional_word<T: Choice>(&mut self, name: &str, was: Option<Option<T>>) -> Option<T> {
        self.has(name, was.flatten().is_some())
            .then(|| self.word(name, was.flatten(), None))
    }

    /// One of the words in `names`; `None` where the word is missing or wrong, which is then reported.
    pub(crate) fn word_among<T: Copy + PartialEq>(
        &mut self,
        name: &str,
        was: Option<T>,
        names: &[(&'static str, T)],
        unavailable: &[&'static str],
        default: Option<T>,
    ) -> Option<T> {
        let available =
            |names: &[(&'static str, T)]| -> Vec<&'static str> { names.iter().map(|(word, _)| *word).collect() };
        if let Some(value) = was {
            if let Some((word, _)) = names.iter().find(|(_, meaning)| *meaning == value) {
                self.push(name, Value::String((*word).to_string()));
            }
            return was;
        }
        let shown = default.and_then(|value| names.iter().find(|(_, meaning)| *meaning == value));
        let shown = shown.map(|(word, _)| format!("\"{word}\""));
        if self.record(name, "", quoted(&available(names)), shown) {
            return default.or_else(|| names.first().map(|(_, meaning)| *meaning));
        }
        match self.node(name).cloned() {
            Some(Node {
                value: Value::String(typed),
                ..
            }) => {
                let found = names
                    .iter()
                    .find(|(word, _)| *word == typed)
                    .map(|(_, meaning)| *meaning);
                if found.is_none() {
                    let what = match renames::new_word(&self.key(name), &typed) {
                        Some(new) => What::Renamed {
                            value: Some(typed),
                            new: new.to_owned(),
                        },
                        None => wrong_word(&typed, &available(names), unavailable),
                    };
                    self.report(name, what);
                }
                found
            }
            Some(node) => {
                self.wrong_type(name, &node.value, quoted(&available(names)));
                None
            }
            None => {
                if default.is_none() {
                    self.missing(name, quoted(&available(names)));
                }
                default
            }
        }
    }

    /// `"none"` (the empty list), one word, several joined by `+`, or a list of words, without repetition; `None` where
    /// the key is `"auto"` or left out.
    pub(crate) fn words<T: Choice>(&mut self, name: &str, was: Option<&[T]>) -> Option<Vec<T>> {
        let word_of = |value: &T| {
            T::NAMES
                .iter()
                .find(|(_, meaning)| meaning == value)
                .map_or("", |(word, _)| *word)
        };
        if let Some(values) = was {
            let list = values
                .iter()
                .map(|value| Value::String(word_of(value).to_string()).into())
                .collect();
            self.push(
                name,
                if values.is_empty() {
                    Value::String("none".into())
                } else {
                    Value::List(list)
                },
            );
            return Some(values.to_vec());
        }
        let available: Vec<&'static str> = T::NAMES
            .iter()
            .map(|(word, _)| *word)
            .filter(|word| !T::UNAVAILABLE.contains(word))
            .collect();
        let expected = if available.is_empty() {
            "\"auto\", \"none\" or an empty list".to_string()
        } else {
            format!("\"auto\", \"none\", or one or a list of {}", available.join(", "))
        };
        if self.record(name, "", expected.clone(), Some("\"auto\"".to_owned())) {
            return None;
        }
        let meaning_of = |typed: &str| {
            let found = T::NAMES
                .iter()
                .find(|(word, _)| *word == typed && available.contains(word));
            found.map(|(_, meaning)| *meaning)
        };
        let mut found = Vec::new();
        match self.node(name).cloned().map(|node| node.value) {
            None => return None,
            Some(Value::String(word)) if word == "auto" => return None,
            Some(Value::String(word)) if word == "none" => {}
            Some(Value::String(typed)) => {
                let joined = typed.contains('+');
                for part in typed.split('+').map(str::trim) {
                    match meaning_of(part) {
                        Some(meaning) if found.contains(&meaning) => self.report(name, twice(part)),
                        Some(meaning) => found.push(meaning),
                        None if joined => self.report(name, wrong_word(part, &available, T::UNAVAILABLE)),
                        None => {
                            let known = ["auto", "none"].into_iter().chain(available.iter().copied());
                            let known: Vec<&'static str> = known.collect();
                            self.report(name, wrong_word(part, &known, T::UNAVAILABLE));
                        }
                    }
                }
            }
            Some(Value::List(list)) => {
                for (i, node) in list.iter().enumerate() {
                    let key = self.entry_key(name, i);
                    let Value::String(typed) = &node.value else {
                        let expected = "a word in quotes".to_string();
                        let what = What::WrongType {
                            value: shown(&node.value),
                            expected,
                        };
                        self.problem(node.at, key, what);
                        continue;
                    };
                    match meaning_of(typed) {
                        Some(meaning) if found.contains(&meaning) => self.problem(node.at, key, twice(typed)),
                        Some(meaning) => found.push(meaning),
                        None => self.problem(node.at, key, wrong_word(typed, &available, T::UNAVAILABLE)),
                    }
                }
            }
            Some(other) => self.wrong_type(name, &other, expected),
        }
        Some(found)
    }
}

fn quoted(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    if quoted.len() == 1 {
        quoted[0].clone()
    } else {
        format!("one of {}", quoted.join(", "))
    }
}

/// A word that a list names again; the list itself may be long.
fn twice(word: &str) -> What {
    What::Refused {
        value: format!("\"{word}\""),
        expected: format!("must name \"{word}\" once"),
    }
}

fn wrong_word(typed: &str, available: &[&'static str], unavailable: &[&'static str]) -> What {
    let owned = |words: &[&str]| words.iter().map(|word| (*word).to_string()).collect();
    if unavailable.contains(&typed) {
        return What::NotAvailable {
            value: Some(typed.to_string()),
            available: owned(available),
        };
    }
    let nearest = nearest(typed, available.iter().chain(unavailable).copied());
    What::UnknownWord {
        value: typed.to_string(),
        nearest,
        allowed: owned(available),
    }
}

/// Jaro-Winkler similarity from which a candidate may be meant; most unrelated names of the format stay below.
const NEAR: f64 = 0.7;
/// Largest share of the longer name's letters that may be wrong: names that merely begin alike differ in more.
const MOST_WRONG: f64 = 0.4;

/// True where so few letters differ that one name may be the other misspelt, or where one is the beginning of the
/// other.
fn may_be_meant(typed: &str, candidate: &str) -> bool {
    let longer = typed.chars().count().max(candidate.chars().count());
    let wrong = strsim::damerau_levenshtein(typed, candidate);
    wrong as f64 <= MOST_WRONG * longer as f64 || typed.starts_with(candidate) || candidate.starts_with(typed)
}

/// The candidate nearest in spelling, where one is near at all.
#[must_use]
pub fn nearest<'a>(typed: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    candidates
        .filter(|candidate| may_be_meant(typed, candidate))
        .map(|candidate| (strsim::jaro_winkler(typed, candidate), candidate))
        .filter(|(similarity, _)| *similarity >= NEAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.to_string())
}
