//! One declaration per key: what reads a table also writes it.
//!
//! An [`Entry`] names its keys once, by calling the methods of [`Keys`]. Each call is given the value to write,
//! or `None` when reading, and gives back the value written or read. Reading never stops at a problem: the
//! problem goes to the report, a placeholder comes back, and [`read`] lets no scene with problems out.

use crate::error::{SceneError, What};
use crate::renames;
use crate::tree::{At, Node, Sources, Table, Value};
use crate::write::{shown, shown_key};

mod columns;
mod describe;
mod number;
mod plain;
mod table;
mod word;

pub(crate) use describe::{Default, Described, Section, Sentences, describe};
pub(crate) use number::{Length, Number};
pub(crate) use table::placeholder;
pub use word::nearest;

/// A table of the scene.
pub(crate) trait Entry: Sized {
    /// One sentence for each key, by its name.
    const SENTENCES: Sentences;

    /// Names the keys; `was` is the value when writing, `None` when reading.
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self;
}

/// Reads a whole file.
pub(crate) fn read<T: Entry>(root: &Table, sources: Sources) -> Result<T, SceneError> {
    let mut report = Vec::new();
    let mut keys = Keys {
        path: String::new(),
        known: Vec::new(),
        sentences: vec![T::SENTENCES],
        side: Side::Read {
            table: root,
            at: At::File,
            report: &mut report,
        },
    };
    let value = T::entry(&mut keys, None);
    keys.finish();
    // A misspelt or renamed key is also a missing one: once is enough.
    if report
        .iter()
        .any(|(_, _, what)| matches!(what, What::UnknownKey { .. } | What::Renamed { value: None, .. }))
    {
        report.retain(|(_, _, what)| !matches!(what, What::Missing { .. }));
    }
    if report.is_empty() {
        Ok(value)
    } else {
        Err(sources.refuse(report))
    }
}

/// Writes a whole file.
pub(crate) fn write<T: Entry>(value: &T) -> Table {
    let mut keys = Keys {
        path: String::new(),
        known: Vec::new(),
        sentences: vec![T::SENTENCES],
        side: Side::Write(Table::default()),
    };
    T::entry(&mut keys, Some(value));
    keys.into_table()
}

/// Problems found so far: where, the full path of the key, and what is wrong with it.
type Report = Vec<(At, String, What)>;

/// The keys of one table, being read, written or described.
pub(crate) struct Keys<'a> {
    path: String,
    known: Vec<String>,
    /// Sentences of the keys, the latest last.
    sentences: Vec<Sentences>,
    side: Side<'a>,
}

enum Side<'a> {
    Read {
        table: &'a Table,
        at: At,
        report: &'a mut Report,
    },
    Write(Table),
    Describe(describe::Describing<'a>),
}

impl Keys<'_> {
    fn key(&self, name: &str) -> String {
        if self.path.is_empty() {
            shown_key(name)
        } else {
            format!("{}.{}", self.path, shown_key(name))
        }
    }

    /// The node of a key, which is known from now on; `None` when writing.
    fn node(&mut self, name: &str) -> Option<&Node> {
        self.known.push(name.to_string());
        match &self.side {
            Side::Read { table, .. } => table.node(name),
            Side::Write(_) | Side::Describe(_) => None,
        }
    }

    fn push(&mut self, name: &str, value: Value) {
        if let Side::Write(table) = &mut self.side {
            table.entries.push((name.to_string(), value.into()));
        }
    }

    /// Path of entry `index` (from 0) of the list `name`.
    fn entry_key(&self, name: &str, index: usize) -> String {
        format!("{}[{}]", self.key(name), index + 1)
    }

    /// Reports a problem with a key of this table, at its place or else at the table's.
    pub(crate) fn report(&mut self, name: &str, what: What) {
        let key = self.key(name);
        if let Side::Read { table, at, report } = &mut self.side {
            let at = table.node(name).map_or(*at, |node| node.at);
            report.push((at, key, what));
        }
    }

    fn missing(&mut self, name: &str, expected: impl Into<String>) {
        self.report(
            name,
            What::Missing {
                expected: expected.into(),
            },
        );
    }

    fn wrong_type(&mut self, name: &str, value: &Value, expected: String) {
        self.report(
            name,
            What::WrongType {
                value: shown(value),
                expected,
            },
        );
    }

    /// Reports an impossible value.
    pub(crate) fn refuse(&mut self, name: &str, expected: impl Into<String>) {
        let value = match &self.side {
            Side::Read { table, .. } => table.node(name).map_or_else(String::new, |node| shown(&node.value)),
            Side::Write(_) | Side::Describe(_) => return,
        };
        self.report(
            name,
            What::Refused {
                value,
                expected: expected.into(),
            },
        );
    }

    /// A key that is written out as others before the keys are read; `range` describes its value.
    pub(crate) fn written_out(&mut self, name: &str, unit: &'static str, range: &str) {
        if self.describes() {
            self.may_be_left_out(name);
            self.record(name, unit, range.to_owned(), None);
        } else if self.node(name).is_some() {
            self.refuse(name, "must stand in a file, or in an override of this key alone");
        }
    }

    /// True where the table that is read has no key at all.
    pub(crate) fn is_empty(&self) -> bool {
        matches!(&self.side, Side::Read { table, .. } if table.entries.is_empty())
    }

    /// Keys of `T` in this table itself.
    pub(crate) fn part<T: Entry>(&mut self, was: Option<&T>) -> T {
        self.with(T::SENTENCES, |keys| T::entry(keys, was))
    }

    /// Keys whose sentences are these.
    pub(crate) fn with<T>(&mut self, sentences: Sentences, read: impl FnOnce(&mut Self) -> T) -> T {
        self.sentences.push(sentences);
        let value = read(self);
        self.sentences.pop();
        value
    }

    /// True where a key is there; `writing` says so when writing. A key that is asked for in this way may be left out.
    pub(crate) fn has(&mut self, name: &str, writing: bool) -> bool {
        if self.describes() {
            self.may_be_left_out(name);
            return true;
        }
        self.node(name).is_some() || writing
    }

    /// True where a key is there and holds a table; always false when writing.
    pub(crate) fn holds_table(&mut self, name: &str) -> bool {
        matches!(
            self.node(name),
            Some(Node {
                value: Value::Table(_),
                ..
            })
        )
    }

    /// True where a key is there and holds a string; always false when writing.
    pub(crate) fn holds_text(&mut self, name: &str) -> bool {
        matches!(
            self.node(name),
            Some(Node {
                value: Value::String(_),
                ..
            })
        )
    }

    /// Refuses every key of `T` that is there and is not a key of this table already.
    pub(crate) fn leave_out<T: Entry>(&mut self, because: &str) {
        for name in table::keys_of::<T>() {
            if !self.known.contains(&name) && self.has(&name, false) {
                let because = because.to_string();
                self.report(&name, What::LeaveOut { because });
            }
        }
    }

    /// True where the key with this path below the table was typed.
    pub(crate) fn is_given(&self, path: &str) -> bool {
        matches!(&self.side, Side::Read { table, .. } if table.has(path))
    }

    /// Takes out a key with this path below the table that is already written.
    pub(crate) fn leave_unwritten(&mut self, path: &str) {
        if let Side::Write(all) = &mut self.side {
            all.take_at(path);
        }
    }

    /// Gives up on the keys of this table, so that none of them counts as unknown.
    pub(crate) fn abandon(&mut self) {
        if let Side::Read { table, .. } = &self.side {
            let names: Vec<String> = table.entries.iter().map(|(name, _)| name.clone()).collect();
            self.known.extend(names);
        }
    }

    fn problem(&mut self, at: At, key: String, what: What) {
        if let Side::Read { report, .. } = &mut self.side {
            report.push((at, key, what));
        }
    }

    /// Reports every key of the table that was not asked for.
    fn finish(&mut self) {
        let Side::Read { table, .. } = &self.side else {
            return;
        };
        let mut known = std::mem::take(&mut self.known);
        let mut seen = Vec::new();
        known.retain(|name| {
            let new = !seen.contains(name);
            seen.push(name.clone());
            new
        });
        let unknown: Vec<(String, At)> = table
            .entries
            .iter()
            .filter(|(name, _)| !known.contains(name))
            .map(|(name, node)| (name.clone(), node.at))
            .collect();
        for (name, at) in unknown {
            let key = self.key(&name);
            if let Some(new) = renames::new_key(&key) {
                let new = new.to_owned();
                self.problem(at, key, What::Renamed { value: None, new });
                continue;
            }
            let nearest = nearest(&name, known.iter().map(String::as_str));
            self.problem(
                at,
                key,
                What::UnknownKey {
                    nearest,
                    known: known.clone(),
                },
            );
        }
    }

    fn into_table(self) -> Table {
        match self.side {
            Side::Write(table) => table,
            Side::Read { .. } | Side::Describe(_) => Table::default(),
        }
    }
}
