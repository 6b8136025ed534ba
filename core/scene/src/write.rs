//! TOML text of a table, and values as messages show them.

use crate::tree::{Node, Table, Value};

/// The text of a whole file: each table under a bare header, keys before sub-tables.
pub(crate) fn file(root: &Table) -> String {
    let mut text = String::new();
    body(&mut text, "", root);
    text
}

fn body(text: &mut String, path: &str, table: &Table) {
    for (key, node) in &table.entries {
        if !has_header(&node.value) {
            text.push_str(&format!("{} = {}\n", shown_key(key), shown(&node.value)));
        }
    }
    for (key, node) in &table.entries {
        let path = if path.is_empty() {
            shown_key(key)
        } else {
            format!("{path}.{}", shown_key(key))
        };
        match &node.value {
            Value::Table(inner) if has_header(&node.value) => {
                text.push_str(&format!("\n[{path}]\n"));
                body(text, &path, inner);
            }
            Value::List(list) if has_header(&node.value) => {
                for entry in list {
                    if let Value::Table(inner) = &entry.value {
                        text.push_str(&format!("\n[[{path}]]\n"));
                        body(text, &path, inner);
                    }
                }
            }
            _ => {}
        }
    }
}

/// True for a value that is written under a header of its own.
fn has_header(value: &Value) -> bool {
    match value {
        Value::Table(table) => !table.inline,
        Value::List(list) => {
            matches!(list.first(), Some(Node { value: Value::Table(table), .. }) if !table.inline)
        }
        _ => false,
    }
}

/// A value on one line, as TOML; a number is the shortest text that gives the same bits again.
pub(crate) fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => toml::Value::String(text.clone()).to_string(),
        Value::Integer(integer) => integer.to_string(),
        Value::Float(number) if number.is_nan() => "nan".to_string(),
        Value::Float(number) => format!("{number:?}"),
        Value::Boolean(flag) => flag.to_string(),
        Value::Datetime(datetime) => datetime.clone(),
        Value::List(list) => {
            let entries: Vec<String> = list.iter().map(|entry| shown(&entry.value)).collect();
            format!("[{}]", entries.join(", "))
        }
        Value::Table(table) if table.entries.is_empty() => "{}".to_string(),
        Value::Table(table) => {
            let entries: Vec<String> = table
                .entries
                .iter()
                .map(|(key, node)| format!("{} = {}", shown_key(key), shown(&node.value)))
                .collect();
            format!("{{ {} }}", entries.join(", "))
        }
    }
}

/// A key as TOML, quoted where it must be.
pub(crate) fn shown_key(key: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !key.is_empty() && key.chars().all(bare) {
        key.to_string()
    } else {
        toml::Value::String(key.to_string()).to_string()
    }
}

/// A number of entries in a message: `1 entry`, `3 entries`.
pub(crate) fn shown_entries(count: usize) -> String {
    if count == 1 {
        "1 entry".to_owned()
    } else {
        format!("{count} entries")
    }
}

/// A number in a message: `-250 km/h`, `1e300 s`.
#[must_use]
pub fn shown_number(number: f64, unit: &str) -> String {
    let size = number.abs();
    let number = if number.is_finite() && size != 0.0 && !(1e-6..1e16).contains(&size) {
        format!("{number:e}")
    } else {
        format!("{number}")
    };
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}
