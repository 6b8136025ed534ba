//! Why a scene was refused.

use std::fmt;

/// Every problem found in a scene, in the order of the file; never empty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", Lines(.problems))]
pub struct SceneError {
    /// One entry per line of the message.
    pub problems: Vec<Problem>,
}

/// One problem: where, what, and what would be right.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Place of the key in the file or the overrides.
    pub place: Place,
    /// Full path of the key, such as `catenary.contact_wire.tension` or `pantograph[1].masses[2]`; empty where the
    /// problem is not about one key.
    pub key: String,
    /// The problem.
    pub what: What,
}

/// Place of something that was typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A file as a whole.
    File(String),
    /// A line of a file, from 1.
    Line(String, usize),
    /// A cell of a table: file, line from 1, name of the column.
    Cell(String, usize, String),
    /// An override, as typed after `--set`, of a value of a file.
    Override(String, String),
}

/// Problem with a key.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// The text is not TOML, or an override is not `key.path=value`.
    Syntax {
        /// Message of the parser.
        message: String,
    },
    /// No such key or table.
    UnknownKey {
        /// The known key nearest in spelling, if one is near.
        nearest: Option<String>,
        /// All keys known there.
        known: Vec<String>,
    },
    /// A key or word that has another name now.
    Renamed {
        /// The old word, where the key's value is one; the key itself is renamed otherwise.
        value: Option<String>,
        /// The new word, or the full path of the new key.
        new: String,
    },
    /// A key or table that must be there is not.
    Missing {
        /// Value that the key must hold.
        expected: String,
    },
    /// A value of another type than expected.
    WrongType {
        /// The value as typed.
        value: String,
        /// Value that would be right.
        expected: String,
    },
    /// A word that is none of the allowed ones.
    UnknownWord {
        /// The word as typed.
        value: String,
        /// The allowed word nearest in spelling, if one is near.
        nearest: Option<String>,
        /// All allowed words.
        allowed: Vec<String>,
    },
    /// A key, table or word of the scene format that this version cannot do.
    NotAvailable {
        /// The word as typed, where the key's value is a word.
        value: Option<String>,
        /// The words that are available; empty where the key itself is not.
        available: Vec<String>,
    },
    /// A key or table that has no meaning beside another one.
    LeaveOut {
        /// Why.
        because: String,
    },
    /// A number, list or word that is impossible in itself or next to the others.
    Refused {
        /// The value with its unit.
        value: String,
        /// Value that would be right.
        expected: String,
    },
}

/// Most known keys that a message lists; no table of this program has more.
const MOST_SHOWN: usize = 25;

/// Most problems that a message lists: nobody reads on, and a list of any length may have one in each entry.
const MOST_PROBLEMS: usize = 50;

struct Lines<'a>(&'a [Problem]);

impl fmt::Display for Lines<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.0.iter().take(MOST_PROBLEMS).enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            problem.fmt(f)?;
        }
        match self.0.len().saturating_sub(MOST_PROBLEMS) {
            0 => Ok(()),
            more => write!(f, "\nand {more} more"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(file) => f.write_str(file),
            Self::Line(file, line) => write!(f, "{file}:{line}"),
            Self::Cell(file, line, column) => write!(f, "{file}, row {line}, column {column}"),
            Self::Override(file, text) => write!(f, "{file}: --set {text}"),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.place)?;
        let key = &self.key;
        match &self.what {
            What::Syntax { message } if key.is_empty() => f.write_str(message),
            What::Syntax { message } => write!(f, "{key}: {message}"),
            What::UnknownKey { nearest, known } => {
                write!(f, "{key}: unknown key{}", DidYouMean(nearest))?;
                match known.len() {
                    0 => f.write_str("; no key is known here"),
                    n if n <= MOST_SHOWN => write!(f, "; known keys here: {}", known.join(", ")),
                    n => {
                        let some = known[..MOST_SHOWN].join(", ");
                        write!(f, "; known keys here: {some} and {} more", n - MOST_SHOWN)
                    }
                }
            }
            What::Renamed { value: None, new } => write!(f, "{key}: renamed, use {new}"),
            What::Renamed {
                value: Some(value),
                new,
            } => write!(f, "{key} = \"{value}\": renamed, use \"{new}\""),
            What::Missing { expected } => write!(f, "{key} is missing: must be {expected}"),
            What::WrongType { value, expected } => write!(f, "{key} = {value}: must be {expected}"),
            What::UnknownWord {
                value,
                nearest,
                allowed,
            } => write!(
                f,
                "{key} = \"{value}\": unknown word{}; must be {}",
                DidYouMean(nearest),
                OneOf(allowed)
            ),
            What::NotAvailable {
                value: Some(value),
                available,
            } => {
                write!(f, "{key} = \"{value}\": not modelled yet by this version")?;
                if available.is_empty() {
                    Ok(())
                } else {
                    write!(f, "; must be {}", OneOf(available))
                }
            }
            What::NotAvailable { value: None, .. } => {
                write!(f, "{key}: known, but not modelled yet by this version: leave it out")
            }
            What::LeaveOut { because } => write!(f, "{key}: must be left out: {because}"),
            What::Refused { value, expected } => write!(f, "{key} = {value}: {expected}"),
        }
    }
}

/// `, did you mean "…"?` where there is something near.
struct DidYouMean<'a>(&'a Option<String>);

impl fmt::Display for DidYouMean<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(nearest) => write!(f, ", did you mean \"{nearest}\"?"),
            None => Ok(()),
        }
    }
}

/// `"a" or "b"`, `one of "a", "b", "c"`.
struct OneOf<'a>(&'a [String]);

impl fmt::Display for OneOf<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quoted: Vec<String> = self.0.iter().map(|word| format!("\"{word}\"")).collect();
        match quoted.as_slice() {
            [one] => f.write_str(one),
            [one, other] => write!(f, "{one} or {other}"),
            many => write!(f, "one of {}", many.join(", ")),
        }
    }
}
