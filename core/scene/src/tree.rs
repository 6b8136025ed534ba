//! The file as parsed: values with the place where each was typed.

use toml::de::{DeTable, DeValue};

use crate::error::{Place, Problem, SceneError, What};
use crate::files::Files;

/// Place of something that was typed; indices into the text and the overrides that a [`Sources`] holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum At {
    /// Nowhere in particular.
    File,
    /// Line, from 1.
    Line(usize),
    /// Override, from 0.
    Override(usize),
    /// Line (from 1) and column of another file, by its number in [`Files`].
    Other {
        /// Number of the file.
        file: u16,
        /// Line, from 1.
        line: usize,
        /// Column of a table, from 0.
        column: Option<u16>,
    },
}

impl At {
    /// A place in a text of its own as one of file `file`.
    pub(crate) fn moved_to(self, file: u16) -> Self {
        let (line, column) = match self {
            Self::Line(line) => (line, None),
            Self::File => (1, None),
            other => return other,
        };
        Self::Other { file, line, column }
    }

    /// Number of the file; none for the scene itself.
    pub(crate) fn file(self) -> Option<u16> {
        match self {
            Self::Other { file, .. } => Some(file),
            _ => None,
        }
    }
}

/// A value and where its key, or for an entry of a list itself, was typed.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) at: At,
    pub(crate) value: Value,
}

/// A TOML value.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    String(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Datetime(String),
    List(Vec<Node>),
    Table(Table),
}

/// A table; entries in the order of their keys' spelling when parsed, in the order of writing when written.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// True for a table that is written as `{ … }` instead of under a header of its own.
    pub(crate) inline: bool,
    pub(crate) entries: Vec<(String, Node)>,
}

impl Node {
    fn move_to(&mut self, file: u16) {
        self.at = self.at.moved_to(file);
        match &mut self.value {
            Value::List(list) => list.iter_mut().for_each(|node| node.move_to(file)),
            Value::Table(table) => table.move_to(file),
            _ => {}
        }
    }
}

impl Node {
    /// A list whose entries have places of their own.
    pub(crate) fn list(at: At, entries: impl IntoIterator<Item = Self>) -> Self {
        let value = Value::List(entries.into_iter().collect());
        Self { at, value }
    }

    /// A number; none for anything else.
    pub(crate) fn number(&self) -> Option<f64> {
        match self.value {
            Value::Float(number) => Some(number),
            Value::Integer(number) => Some(number as f64),
            _ => None,
        }
    }
}

impl From<Value> for Node {
    fn from(value: Value) -> Self {
        Self { at: At::File, value }
    }
}

impl Table {
    pub(crate) fn node_mut(&mut self, key: &str) -> Option<&mut Node> {
        self.entries
            .iter_mut()
            .find(|(name, _)| name == key)
            .map(|(_, node)| node)
    }

    /// Takes out a key.
    pub(crate) fn take(&mut self, key: &str) -> Option<Node> {
        let index = self.entries.iter().position(|(name, _)| name == key)?;
        Some(self.entries.remove(index).1)
    }

    /// The table under a key.
    pub(crate) fn table_mut(&mut self, key: &str) -> Option<&mut Table> {
        match &mut self.node_mut(key)?.value {
            Value::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Adds a key that is not there.
    pub(crate) fn push(&mut self, key: &str, node: Node) {
        self.entries.push((key.to_owned(), node));
    }

    /// Places of a text of its own become places of file `file`.
    pub(crate) fn move_to(&mut self, file: u16) {
        self.entries.iter_mut().for_each(|(_, node)| node.move_to(file));
    }

    pub(crate) fn node(&self, key: &str) -> Option<&Node> {
        self.entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// The node with a path such as `solver.micro_step`, in tables alone.
    pub(crate) fn node_at(&self, path: &str) -> Option<&Node> {
        let (above, key) = path.rsplit_once('.').unwrap_or(("", path));
        let mut tables = above.split('.').filter(|key| !key.is_empty());
        let table = tables.try_fold(self, |table, key| match &table.node(key)?.value {
            Value::Table(inner) => Some(inner),
            _ => None,
        });
        table?.node(key)
    }

    /// Takes the node with such a path out.
    pub(crate) fn take_at(&mut self, path: &str) -> Option<Node> {
        let (above, key) = path.rsplit_once('.').unwrap_or(("", path));
        let mut tables = above.split('.').filter(|key| !key.is_empty());
        tables.try_fold(self, |table, key| table.table_mut(key))?.take(key)
    }

    /// True where the key with such a path was typed.
    pub(crate) fn has(&self, path: &str) -> bool {
        self.node_at(path).is_some()
    }

    /// Place of the key with a path such as `pantograph[1].masses[2]`, or else of the nearest table above.
    pub(crate) fn place_of(&self, path: &str) -> At {
        let mut at = At::File;
        let mut table = Some(self);
        let mut list: Option<&[Node]> = None;
        for step in steps(path).unwrap_or_default() {
            let node = match step {
                Step::Key(key) => table.and_then(|table| table.node(&key)),
                Step::Entry(number) => list.and_then(|list| list.get(number.wrapping_sub(1))),
            };
            let Some(node) = node else { return at };
            at = node.at;
            table = if let Value::Table(inner) = &node.value {
                Some(inner)
            } else {
                None
            };
            list = if let Value::List(inner) = &node.value {
                Some(inner)
            } else {
                None
            };
        }
        at
    }
}

/// Sources of a scene: the names that messages give to places.
#[derive(Clone, Copy)]
pub(crate) struct Sources<'a> {
    pub(crate) origin: &'a str,
    pub(crate) overrides: &'a [String],
    pub(crate) files: &'a Files<'a>,
}

impl Sources<'_> {
    pub(crate) fn place(&self, at: At) -> Place {
        let file = self.origin.to_string();
        match at {
            At::File => Place::File(file),
            At::Line(line) => Place::Line(file, line),
            At::Override(i) => Place::Override(file, self.overrides[i].clone()),
            At::Other { file, line, column } => self.files.place(file, line, column),
        }
    }

    pub(crate) fn problem(&self, at: At, key: impl Into<String>, what: What) -> Problem {
        Problem {
            place: self.place(at),
            key: key.into(),
            what,
        }
    }
}

impl Sources<'_> {
    /// Everything that is wrong, in the order of its places.
    pub(crate) fn refuse(&self, mut wrong: Vec<(At, String, What)>) -> SceneError {
        wrong.sort_by_key(|(at, ..)| *at);
        let problems = wrong.into_iter().map(|(at, key, what)| self.problem(at, key, what));
        SceneError {
            problems: problems.collect(),
        }
    }
}

/// Parses `text`; the error is its place and what is wrong there.
pub(crate) fn parse(text: &str) -> Result<Table, (At, What)> {
    let lines = Lines::of(text);
    let parsed = DeTable::parse(text).map_err(|error| {
        let at = error.span().map_or(At::File, |span| At::Line(lines.line(span.start)));
        let message = format!("not valid TOML: {}", error.message().trim().replace('\n', ", "));
        (at, What::Syntax { message })
    })?;
    Ok(table(parsed.get_ref(), &|offset| At::Line(lines.line(offset))))
}

/// Offsets at which the lines of a text begin.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        let ends = text
            .bytes()
            .enumerate()
            .filter(|(_, byte)| *byte == b'\n')
            .map(|(i, _)| i + 1);
        Self(std::iter::once(0).chain(ends).collect())
    }

    /// Line of a byte offset, from 1.
    fn line(&self, offset: usize) -> usize {
        self.0.partition_point(|start| *start <= offset)
    }
}

fn table(parsed: &DeTable, place: &dyn Fn(usize) -> At) -> Table {
    let entries = parsed
        .iter()
        .map(|(key, entry)| {
            let node = Node {
                at: place(key.span().start),
                value: value(entry.get_ref(), place),
            };
            (key.get_ref().to_string(), node)
        })
        .collect();
    Table { inline: false, entries }
}

pub(crate) fn value(parsed: &DeValue, place: &dyn Fn(usize) -> At) -> Value {
    match parsed {
        DeValue::String(text) => Value::String(text.to_string()),
        DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(integer) => Value::Integer(integer),
            // Beyond i64: a number all the same.
            Err(_) => Value::Float(digits.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        DeValue::Float(digits) => Value::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Boolean(*flag),
        DeValue::Datetime(datetime) => Value::Datetime(datetime.to_string()),
        DeValue::Array(list) => Value::List(
            list.iter()
                .map(|entry| Node {
                    at: place(entry.span().start),
                    value: value(entry.get_ref(), place),
                })
                .collect(),
        ),
        DeValue::Table(inner) => Value::Table(table(inner, place)),
    }
}

/// One step of the path of a key.
#[derive(Debug, PartialEq)]
pub enum Step {
    /// A key; all digits mean an entry from 0 where the path has reached a list.
    Key(String),
    /// `[n]`, an entry of a list, from 1.
    Entry(usize),
}

/// Path of a key without the numbers of entries, as [`described_keys`](crate::described_keys) has it.
#[must_use]
pub fn without_entries(path: &str) -> String {
    let names = path.split('.').filter(|step| step.parse::<usize>().is_err());
    let names: Vec<&str> = names.map(|step| step.split('[').next().unwrap_or(step)).collect();
    names.join(".")
}

/// Steps of a path such as `pantograph[1].parameters."static.force"`; nothing for a text that is no path.
#[must_use]
pub fn steps(path: &str) -> Option<Vec<Step>> {
    let mut rest = path.trim();
    let mut steps = Vec::new();
    loop {
        if let Some(open) = rest.chars().next().filter(|c| matches!(c, '"' | '\'')) {
            let end = rest[1..].find(open)? + 1;
            steps.push(Step::Key(rest[1..end].to_string()));
            rest = &rest[end + 1..];
        } else {
            let end = rest.find(['.', '[']).unwrap_or(rest.len());
            let key = rest[..end].trim();
            if key.is_empty() || key.contains(|c: char| c.is_whitespace() || c == '=') {
                return None;
            }
            steps.push(Step::Key(key.to_string()));
            rest = &rest[end..];
        }
        while let Some(inner) = rest.strip_prefix('[') {
            let end = inner.find(']')?;
            steps.push(Step::Entry(inner[..end].trim().parse().ok()?));
            rest = &inner[end + 1..];
        }
        if rest.is_empty() {
            return Some(steps);
        }
        rest = rest.strip_prefix('.')?;
    }
}
