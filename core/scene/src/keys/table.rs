//! Tables inside a table.

use std::collections::BTreeMap;

use super::describe::Form;
use super::{Entry, Keys, Report, Side, nearest};
use crate::error::What;
use crate::tree::{At, Node, Table, Value};
use crate::write::{shown, shown_key};

impl Keys<'_> {
    /// A table.
    pub(crate) fn table<T: Entry>(&mut self, name: &str, was: Option<&T>) -> T {
        self.any_table(name, was, false)
    }

    /// A table written in one line, `{ … }`.
    pub(crate) fn inline_table<T: Entry>(&mut self, name: &str, was: Option<&T>) -> T {
        self.any_table(name, was, true)
    }

    /// An inline table that may be left out.
    pub(crate) fn optional_inline_table<T: Entry>(&mut self, name: &str, was: Option<Option<&T>>) -> Option<T> {
        self.has(name, was.flatten().is_some())
            .then(|| self.any_table(name, was.flatten(), true))
    }

    /// A table that may be left out.
    pub(crate) fn optional_table<T: Entry>(&mut self, name: &str, was: Option<Option<&T>>) -> Option<T> {
        self.has(name, was.flatten().is_some())
            .then(|| self.any_table(name, was.flatten(), false))
    }

    /// A table that may be left out altogether, as if it were there and empty.
    pub(crate) fn table_or_empty<T: Entry>(&mut self, name: &str, was: Option<&T>) -> T {
        let present = self.has(name, was.is_some());
        if present {
            self.any_table(name, was, false)
        } else {
            placeholder()
        }
    }

    fn any_table<T: Entry>(&mut self, name: &str, was: Option<&T>, inline: bool) -> T {
        if was.is_some() {
            let (value, table) = written(was, inline);
            self.push(name, Value::Table(table));
            return value;
        }
        let form = if inline { Form::Inline } else { Form::Header };
        if let Some(value) = self.record_table(name, form) {
            return value;
        }
        self.known.push(name.to_string());
        let path = self.key(name);
        if let Side::Read { table, report, .. } = &mut self.side
            && let Some(Node {
                at,
                value: Value::Table(inner),
            }) = table.node(name)
        {
            return read_table(inner, *at, path, report);
        }
        match self.node(name).cloned() {
            Some(node) => self.wrong_type(name, &node.value, "a table".to_string()),
            None => self.missing(name, "a table"),
        }
        placeholder()
    }

    /// An array of tables, at least one.
    pub(crate) fn tables<T: Entry>(&mut self, name: &str, was: Option<&[T]>) -> Vec<T> {
        let expected = format!("at least one table under the header [[{}]]", self.key(name));
        self.tables_expecting(name, was, expected)
    }

    /// An array of tables that may be left out.
    pub(crate) fn any_tables<T: Entry>(&mut self, name: &str, was: Option<&[T]>) -> Vec<T> {
        let there = self.has(name, was.is_some_and(|values| !values.is_empty()));
        if there { self.tables(name, was) } else { Vec::new() }
    }

    /// As [`Keys::tables`], where one table may stand there without a list.
    pub(crate) fn table_or_tables<T: Entry>(&mut self, name: &str, was: Option<&[T]>) -> Vec<T> {
        let path = self.key(name);
        let expected = format!("a table under the header [{path}], or several under [[{path}]]");
        self.tables_expecting(name, was, expected)
    }

    fn tables_expecting<T: Entry>(&mut self, name: &str, was: Option<&[T]>, expected: String) -> Vec<T> {
        if let Some(values) = was {
            let mut list = Vec::new();
            let copies = values
                .iter()
                .map(|value| {
                    let (copy, table) = written(Some(value), false);
                    list.push(Value::Table(table).into());
                    copy
                })
                .collect();
            self.push(name, Value::List(list));
            return copies;
        }
        if let Some(value) = self.record_table(name, Form::List) {
            return vec![value];
        }
        self.known.push(name.to_string());
        let path = self.key(name);
        let mut values = Vec::new();
        let mut wrong = None;
        if let Side::Read { table, report, .. } = &mut self.side {
            match table.node(name) {
                Some(Node {
                    value: Value::List(list),
                    ..
                }) if !list.is_empty() => {
                    for (i, node) in list.iter().enumerate() {
                        match &node.value {
                            Value::Table(inner) => {
                                values.push(read_table(inner, node.at, format!("{path}[{}]", i + 1), report));
                            }
                            other => wrong = Some(other.clone()),
                        }
                    }
                }
                Some(node) => wrong = Some(node.value.clone()),
                None => report.push((
                    At::File,
                    path,
                    What::Missing {
                        expected: expected.clone(),
                    },
                )),
            }
        }
        if let Some(value) = wrong {
            self.wrong_type(name, &value, expected);
        }
        values
    }

    /// A table whose keys are names of a supplied FMU; absent is empty. `known` lists the names that are allowed, or is
    /// empty where all are.
    pub(crate) fn map<T: Entry>(
        &mut self,
        name: &str,
        was: Option<&BTreeMap<String, T>>,
        known: &[String],
    ) -> BTreeMap<String, T> {
        if let Some(values) = was {
            let mut table = Table {
                inline: true,
                entries: Vec::new(),
            };
            let copies = values
                .iter()
                .map(|(key, value)| {
                    let (copy, inner) = written(Some(value), true);
                    table.entries.push((key.clone(), Value::Table(inner).into()));
                    (key.clone(), copy)
                })
                .collect();
            self.push(name, Value::Table(table));
            return copies;
        }
        self.may_be_left_out(name);
        if self.record_table::<T>(name, Form::Names).is_some() {
            return BTreeMap::new();
        }
        self.each(name, |keys, key, node, values| {
            if !known.is_empty() && !known.contains(key) {
                let path = format!("{}.{}", keys.key(name), shown_key(key));
                let nearest = nearest(key, known.iter().map(String::as_str));
                keys.problem(
                    node.at,
                    path,
                    What::UnknownKey {
                        nearest,
                        known: known.to_vec(),
                    },
                );
                return;
            }
            let path = format!("{}.{}", keys.key(name), shown_key(key));
            match (&node.value, &mut keys.side) {
                (Value::Table(inner), Side::Read { report, .. }) => {
                    values.insert(key.clone(), read_table(inner, node.at, path, report));
                }
                (other, _) => {
                    let what = What::WrongType {
                        value: shown(other),
                        expected: "a table such as { variable = \"…\" }".into(),
                    };
                    keys.problem(node.at, path, what);
                }
            }
        })
    }

    /// A table of plain values whose keys are names of a supplied FMU; absent is empty.
    pub(crate) fn plain_map<T: Clone>(
        &mut self,
        name: &str,
        was: Option<&BTreeMap<String, T>>,
        to: impl Fn(&T) -> Value,
        from: impl Fn(&Value) -> Result<T, String>,
    ) -> BTreeMap<String, T> {
        if let Some(values) = was {
            let entries = values
                .iter()
                .map(|(key, value)| (key.clone(), to(value).into()))
                .collect();
            self.push(name, Value::Table(Table { inline: true, entries }));
            return values.clone();
        }
        self.may_be_left_out(name);
        if self.record(name, "", "table `{ name = value, … }`", None) {
            return BTreeMap::new();
        }
        self.each(name, |keys, key, node, values| match from(&node.value) {
            Ok(value) => {
                values.insert(key.clone(), value);
            }
            Err(expected) => {
                let path = format!("{}.{}", keys.key(name), shown_key(key));
                keys.problem(
                    node.at,
                    path,
                    What::WrongType {
                        value: shown(&node.value),
                        expected,
                    },
                );
            }
        })
    }

    /// Calls `read` for every entry of the table `name`.
    fn each<T>(
        &mut self,
        name: &str,
        mut read: impl FnMut(&mut Self, &String, &Node, &mut BTreeMap<String, T>),
    ) -> BTreeMap<String, T> {
        let mut values = BTreeMap::new();
        match self.node(name).cloned() {
            None => {}
            Some(Node {
                value: Value::Table(table),
                ..
            }) => {
                for (key, node) in &table.entries {
                    read(self, key, node, &mut values);
                }
            }
            Some(node) => self.wrong_type(name, &node.value, "a table".to_string()),
        }
        values
    }
}

fn read_table<T: Entry>(table: &Table, at: At, path: String, report: &mut Report) -> T {
    let mut keys = Keys {
        path,
        known: Vec::new(),
        sentences: vec![T::SENTENCES],
        side: Side::Read { table, at, report },
    };
    let value = T::entry(&mut keys, None);
    keys.finish();
    value
}

fn written<T: Entry>(was: Option<&T>, inline: bool) -> (T, Table) {
    let table = Table {
        inline,
        entries: Vec::new(),
    };
    let mut keys = Keys {
        path: String::new(),
        known: Vec::new(),
        sentences: vec![T::SENTENCES],
        side: Side::Write(table),
    };
    let value = T::entry(&mut keys, was);
    (value, keys.into_table())
}

/// Value that an empty table is read as; its problems are not reported.
pub(crate) fn placeholder<T: Entry>() -> T {
    read_table(&Table::default(), At::File, String::new(), &mut Vec::new())
}

/// The names of the keys that `T` asks for in an empty table.
pub(super) fn keys_of<T: Entry>() -> Vec<String> {
    let (table, mut report) = (Table::default(), Report::new());
    let side = Side::Read {
        table: &table,
        at: At::File,
        report: &mut report,
    };
    let mut keys = Keys {
        path: String::new(),
        known: Vec::new(),
        sentences: vec![T::SENTENCES],
        side,
    };
    T::entry(&mut keys, None);
    keys.known
}
