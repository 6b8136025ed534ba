//! Descriptions of the keys of a scene file, recorded from the calls that read them.

use super::{Entry, Keys, Side};

/// One sentence for each key, by its name.
pub(crate) type Sentences = &'static [(&'static str, &'static str)];

/// A key as it is read.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Described {
    pub(crate) name: String,
    pub(crate) unit: String,
    /// Values that the key may have.
    pub(crate) range: String,
    /// Value where it is left out.
    pub(crate) default: Default,
    /// Empty where the code that reads it has none.
    pub(crate) sentence: &'static str,
}

impl Described {
    /// Takes in the other way to write the same key.
    fn or(&mut self, other: Self) {
        if self.range != other.range {
            self.range = format!("{} or {}", self.range, other.range);
        }
        if self.unit.is_empty() {
            self.unit = other.unit;
        }
        if self.default == Default::Required {
            self.default = other.default;
        }
    }
}

/// Value that stands for a key that is left out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Default {
    /// Nothing: the scene is refused.
    Required,
    /// Nothing: what it describes is not there.
    None,
    /// A value.
    Value(String),
}

/// A table of the file with its keys, or those of one of its variants.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Section {
    /// Header or key of the table, as typed.
    pub(crate) title: String,
    pub(crate) keys: Vec<Described>,
}

/// The table whose keys are being described.
pub(crate) struct Describing<'a> {
    title: String,
    /// Keys that were asked for before they are read.
    optional: Vec<String>,
    sections: &'a mut Vec<Section>,
}

/// How a table is typed.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Form {
    Header,
    Inline,
    List,
    /// An inline table of inline tables under names of their own.
    Names,
}

/// Every table that `T` reads, in the order in which it is asked for.
pub(crate) fn describe<T: Entry>(title: &str) -> Vec<Section> {
    let mut sections = Vec::new();
    describe_table::<T>(String::new(), title.to_owned(), &mut sections);
    sections
}

fn describe_table<T: Entry>(path: String, title: String, sections: &mut Vec<Section>) -> T {
    let mut keys = Keys {
        path,
        known: Vec::new(),
        sentences: vec![T::SENTENCES],
        side: Side::Describe(Describing {
            title,
            optional: Vec::new(),
            sections,
        }),
    };
    T::entry(&mut keys, None)
}

impl Keys<'_> {
    /// True where keys are described instead of being read or written.
    pub(crate) fn describes(&self) -> bool {
        matches!(self.side, Side::Describe(_))
    }

    /// True in the table with this path.
    pub(crate) fn is_table(&self, path: &str) -> bool {
        self.path == path
    }

    pub(super) fn may_be_left_out(&mut self, name: &str) {
        if let Side::Describe(describing) = &mut self.side {
            describing.optional.push(name.to_owned());
        }
    }

    /// Keys that are there with another key or word only, which `condition` names.
    pub(crate) fn only<T>(&mut self, condition: &str, read: impl FnOnce(&mut Self) -> T) -> T {
        let Side::Describe(describing) = &mut self.side else {
            return read(self);
        };
        let title = describing.title.clone();
        describing.title = format!("{title} with {condition}");
        let value = read(self);
        if let Side::Describe(describing) = &mut self.side {
            describing.title = title;
        }
        value
    }

    /// Records a key; false where keys are read or written.
    pub(super) fn record(&mut self, name: &str, unit: &str, range: impl Into<String>, default: Option<String>) -> bool {
        let of = |sentences: &Sentences| sentences.iter().find(|(key, _)| *key == name).map(|(_, text)| *text);
        let sentence = self.sentences.iter().rev().find_map(of).unwrap_or("");
        let Side::Describe(describing) = &mut self.side else {
            return false;
        };
        let default = match default {
            Some(value) => Default::Value(value),
            None if describing.optional.iter().any(|optional| optional == name) => Default::None,
            None => Default::Required,
        };
        let key = Described {
            name: name.to_owned(),
            unit: unit.to_owned(),
            range: range.into(),
            default,
            sentence,
        };
        let title = &describing.title;
        let sections = &mut *describing.sections;
        let index = sections.iter().position(|section| section.title == *title);
        let index = index.unwrap_or_else(|| {
            sections.push(Section {
                title: title.clone(),
                keys: Vec::new(),
            });
            sections.len() - 1
        });
        let keys = &mut sections[index].keys;
        match keys.iter_mut().find(|other| other.name == key.name) {
            Some(other) => other.or(key),
            None => keys.push(key),
        }
        true
    }

    /// Records a table and its keys; `None` where keys are read or written.
    pub(super) fn record_table<T: Entry>(&mut self, name: &str, form: Form) -> Option<T> {
        let range = match form {
            Form::Header => "table",
            Form::Inline => "table `{ … }`",
            Form::List => "list of tables",
            Form::Names => "table `{ name = { … }, … }`",
        };
        if !self.record(name, "", range, None) {
            return None;
        }
        let path = self.key(name);
        let Side::Describe(describing) = &mut self.side else {
            return None;
        };
        let condition = describing
            .title
            .split_once(" with ")
            .map_or("", |(_, condition)| condition);
        let title = match form {
            Form::Header => format!("`[{path}]`"),
            // Models may differ in what they have under the same key.
            Form::Inline if !condition.is_empty() => format!("`{path} = {{ … }}` with {condition}"),
            Form::Inline => format!("`{path} = {{ … }}`"),
            Form::Names => format!("`{path} = {{ name = {{ … }}, … }}`"),
            Form::List => format!("`[[{path}]]`"),
        };
        Some(describe_table(path, title, describing.sections))
    }
}
