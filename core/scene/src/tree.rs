//! The file as parsed: values with the place where each was typed, and overrides applied to them.

use toml::de::{DeTable, DeValue};

use crate::error::{Place, Problem, SceneError, What};
use crate::files::Files;
use crate::write::{shown, shown_key};

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

    /// True where the key with a path such as `solver.micro_step` was typed, in tables alone.
    pub(crate) fn has(&self, path: &str) -> bool {
        let mut table = Some(self);
        path.split('.').all(|key| {
            let node = table.and_then(|table| table.node(key));
            table = node.and_then(|node| match &node.value {
                Value::Table(inner) => Some(inner),
                _ => None,
            });
            node.is_some()
        })
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

/// Applies in turn the overrides for which `chosen` holds.
pub(crate) fn override_with(
    root: &mut Table,
    overrides: &[String],
    chosen: impl Fn(&str) -> bool,
) -> Vec<(At, String, What)> {
    let all = overrides.iter().enumerate().filter(|(_, text)| chosen(text));
    all.filter_map(|(i, text)| {
        let (key, what) = apply(root, text, At::Override(i)).err()?;
        Some((At::Override(i), key, what))
    })
    .collect()
}

/// Last key of an override's path, where it has one.
pub(crate) fn last_key(text: &str) -> Option<String> {
    match steps(split(text)?.0)?.pop()? {
        Step::Key(key) => Some(key),
        Step::Entry(_) => None,
    }
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

fn value(parsed: &DeValue, place: &dyn Fn(usize) -> At) -> Value {
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

/// One step of an override's path.
#[derive(Debug, PartialEq)]
enum Step {
    /// A key; all digits mean an entry from 0 where the path has reached a list.
    Key(String),
    /// `[n]`, an entry of a list, from 1.
    Entry(usize),
}

/// Table, key whose override takes the place of others, and these others.
const REPLACED: [(&str, &str, &[&str]); 8] = [
    (
        "catenary.mesh",
        "elements_per_interval",
        &["element_length", "error_percent"],
    ),
    (
        "catenary.mesh",
        "element_length",
        &["elements_per_interval", "error_percent"],
    ),
    (
        "catenary.mesh",
        "error_percent",
        &["elements_per_interval", "element_length", "corrections"],
    ),
    ("catenary", "presag", &["presag_ratio"]),
    ("catenary", "presag_ratio", &["presag"]),
    ("catenary.droppers", "positions", &["rule", "pattern"]),
    ("catenary.droppers", "rule", &["positions", "pattern"]),
    ("catenary.droppers", "pattern", &["positions", "rule"]),
];

/// Keys whose place `key` of the table with this path takes where it is said later.
pub(crate) fn replaced_by(path: &str, key: &str) -> &'static [&'static str] {
    // Tension lengths have the keys of a line of one.
    let path = match path.strip_prefix("catenary.tension_length[") {
        Some(rest) if rest.ends_with(']') => "catenary",
        _ => path,
    };
    let mut all = REPLACED.iter();
    all.find(|(of, by, _)| (*of, *by) == (path, key))
        .map_or(&[], |(_, _, others)| others)
}

const FORM: &str = "an override must have the form key.path=value, such as run.speed_kmh=250, \
                    coupling.algorithm=jacobi or pantograph[1].static_force=100";

/// Sets one value; the error is the key and what is wrong with it.
fn apply(root: &mut Table, text: &str, at: At) -> Result<(), (String, What)> {
    let syntax = |message: &str| {
        (
            String::new(),
            What::Syntax {
                message: message.to_string(),
            },
        )
    };
    let (path, typed) = split(text).ok_or_else(|| syntax(FORM))?;
    let steps = steps(path).ok_or_else(|| syntax(FORM))?;
    let new = Node {
        at,
        value: typed_value(typed.trim(), at).map_err(|message| (path.trim().to_string(), What::Syntax { message }))?,
    };

    let mut walked = String::new();
    let mut steps = steps.into_iter().peekable();
    let Some(Step::Key(first)) = steps.next() else {
        return Err(syntax(FORM));
    };
    walked.push_str(&shown_key(&first));
    let mut last_is_new = root.node(&first).is_none();
    let mut node = entry(root, first, at);
    for step in steps {
        let refused = |value: &Value, expected: String| {
            (
                walked.clone(),
                What::Refused {
                    value: shown(value),
                    expected,
                },
            )
        };
        let is_new = std::mem::take(&mut last_is_new);
        node = match (&mut node.value, step) {
            // A list that the file does not have: reading it reports the key, with the known ones beside it.
            (Value::Table(_), Step::Entry(_)) if is_new => return Ok(()),
            (Value::Table(table), Step::Key(key)) => {
                drop_replaced(table, &walked, &key);
                walked.push('.');
                walked.push_str(&shown_key(&key));
                last_is_new = table.node(&key).is_none();
                entry(table, key, at)
            }
            (Value::List(list), step) => {
                let index = match &step {
                    Step::Entry(number) => number.checked_sub(1),
                    Step::Key(digits) => digits.parse().ok(),
                };
                let count = list.len();
                match index.filter(|index| *index < count) {
                    Some(index) => {
                        walked.push_str(&format!("[{}]", index + 1));
                        &mut list[index]
                    }
                    None => {
                        let expected = match step {
                            Step::Entry(number) => {
                                format!("has {count} entries, [1] to [{count}], and no [{number}]")
                            }
                            Step::Key(digits) if index.is_some() => {
                                format!("has {count} entries, [1] to [{count}], and no .{digits}")
                            }
                            Step::Key(key) => {
                                format!("has {count} entries; say which one, such as {walked}[1].{key}")
                            }
                        };
                        return Err((
                            walked.clone(),
                            What::Refused {
                                value: "list".into(),
                                expected,
                            },
                        ));
                    }
                }
            }
            (value, Step::Key(key)) => {
                return Err(refused(
                    value,
                    format!("is not a table, so there is no key {key} in it"),
                ));
            }
            (value, Step::Entry(number)) => {
                return Err(refused(
                    value,
                    format!("is not a list, so there is no entry [{number}] in it"),
                ));
            }
        };
    }
    *node = new;
    Ok(())
}

/// Takes out of the table with this path what an override of `key` takes the place of.
fn drop_replaced(table: &mut Table, path: &str, key: &str) {
    let others = replaced_by(path, key);
    table.entries.retain(|(name, _)| !others.contains(&name.as_str()));
}

/// The entry `key` of a table; an empty table where there is none yet.
fn entry(table: &mut Table, key: String, at: At) -> &mut Node {
    let index = table
        .entries
        .iter()
        .position(|(name, _)| *name == key)
        .unwrap_or_else(|| {
            table.entries.push((
                key,
                Node {
                    at,
                    value: Value::Table(Table::default()),
                },
            ));
            table.entries.len() - 1
        });
    &mut table.entries[index].1
}

/// Splits at the first `=` outside quotes.
fn split(text: &str) -> Option<(&str, &str)> {
    let mut quote = None;
    let at = text.char_indices().find_map(|(i, c)| {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '=') => return Some(i),
            _ => {}
        }
        None
    })?;
    Some((&text[..at], &text[at + 1..]))
}

/// Steps of a path such as `pantograph[1].parameters."static.force"`.
fn steps(path: &str) -> Option<Vec<Step>> {
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
            if key.is_empty() || key.contains(char::is_whitespace) {
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

/// The value of an override: a TOML value, or a bare word as a string.
fn typed_value(typed: &str, at: At) -> Result<Value, String> {
    match DeValue::parse(typed) {
        Ok(parsed) => Ok(value(parsed.get_ref(), &|_| at)),
        Err(_) if !typed.is_empty() && !typed.starts_with(['"', '\'', '[', '{']) => {
            Ok(Value::String(typed.to_string()))
        }
        Err(error) => Err(format!(
            "{typed:?} is not a TOML value: {}",
            error.message().trim().replace('\n', ", ")
        )),
    }
}
