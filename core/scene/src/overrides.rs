//! Overrides of single keys, in the form `key.path=value`.

use toml::de::DeValue;

use crate::error::What;
use crate::tree::{At, Node, Step, Table, Value, steps, value};
use crate::write::{shown, shown_entries, shown_key};

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
                        let entries = shown_entries(count);
                        let all = match count {
                            0 => String::new(),
                            1 => ", [1],".to_owned(),
                            _ => format!(", [1] to [{count}],"),
                        };
                        let expected = match step {
                            Step::Entry(number) => format!("has {entries}{all} and no [{number}]"),
                            Step::Key(digits) if index.is_some() => format!("has {entries}{all} and no .{digits}"),
                            Step::Key(key) => format!("has {entries}; say which one, such as {walked}[1].{key}"),
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
