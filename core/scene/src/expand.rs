//! Tables, rules and library files, written out as the plain keys of a line.
//!
//! | file | subject |
//! | --- | --- |
//! | `library` | `from`: keys of another file |
//! | `supports` | `catenary.table`: one row per support and tension length |
//! | `dropper_table` | `catenary.droppers.table`: one row per dropper |
//! | `rules` | `presag_ratio`, `droppers.rule`, `droppers.pattern` |

mod dropper_table;
mod library;
mod rules;
mod supports;

use crate::csv::{Csv, Known, Wrong, wrong};
use crate::error::What;
use crate::files::Files;
use crate::tree::{At, Node, Table, Value};
use crate::write::shown;

/// Keys that name a file to be read with the scene.
pub(crate) const FILE_KEYS: [&str; 2] = ["from", "table"];

/// Takes in library files and tables.
pub(crate) fn take_files(root: &mut Table, files: &Files) -> Vec<Wrong> {
    let mut found = Vec::new();
    if let Some(Value::List(pantographs)) = root.node_mut("pantograph").map(|node| &mut node.value) {
        for (index, pantograph) in pantographs.iter_mut().enumerate() {
            if let Value::Table(table) = &mut pantograph.value {
                library::take(table, &format!("pantograph[{}]", index + 1), files, &mut found);
            }
        }
    }
    if let Some(assessment) = root.table_mut("assessment") {
        library::take(assessment, "assessment", files, &mut found);
    }
    if let Some(line) = root.table_mut("catenary") {
        library::take(line, "catenary", files, &mut found);
        let names = supports::take(line, files, &mut found);
        dropper_table::take(line, &names, files, &mut found);
    }
    found
}

/// Writes out the rules of a line.
pub(crate) fn apply_rules(root: &mut Table) -> Vec<Wrong> {
    let mut found = Vec::new();
    if let Some(line) = root.table_mut("catenary") {
        rules::apply(line, &mut found);
    }
    found
}

fn leave_out(at: At, key: impl Into<String>, because: impl Into<String>) -> Wrong {
    let because = because.into();
    (at, key.into(), What::LeaveOut { because })
}

fn wrong_type(node: &Node, key: impl Into<String>, expected: &str) -> Wrong {
    let (value, expected) = (shown(&node.value), expected.to_owned());
    (node.at, key.into(), What::WrongType { value, expected })
}

/// Takes out the path of a file, with its place.
fn file_of(table: &mut Table, path: &str, key: &str, found: &mut Vec<Wrong>) -> Option<(At, String)> {
    let node = table.take(key)?;
    if let Value::String(file) = node.value {
        return Some((node.at, file));
    }
    found.push(wrong_type(&node, format!("{path}.{key}"), "the path of a file"));
    None
}

/// Reads the table of a path.
fn csv_of((at, file): (At, &str), key: &str, files: &Files, known: Known, found: &mut Vec<Wrong>) -> Option<Csv> {
    let read = match files.open(file) {
        Ok((text, number)) => Csv::read(&text, number, files, known),
        Err(reason) => Err(vec![wrong(at, key, format!("{file:?}"), reason)]),
    };
    read.map_err(|problems| found.extend(problems)).ok()
}

/// Tension lengths of a line: those under `tension_length`, or the line itself, each with its path.
fn tension_lengths(line: &mut Table) -> Vec<(String, &mut Table)> {
    if line.node("tension_length").is_none() {
        return vec![("catenary".to_owned(), line)];
    }
    let Some(Value::List(all)) = line.node_mut("tension_length").map(|node| &mut node.value) else {
        return Vec::new();
    };
    let tables = all.iter_mut().enumerate();
    let tables = tables.filter_map(|(index, node)| match &mut node.value {
        Value::Table(table) => Some((format!("catenary.tension_length[{}]", index + 1), table)),
        _ => None,
    });
    tables.collect()
}

/// Length of each span of a tension length as written, m; none where keys are missing or wrong, which reading reports.
fn lengths_of(table: &Table) -> Option<Vec<f64>> {
    let spans = match table.node("spans")?.value {
        Value::Integer(spans) => usize::try_from(spans).ok(),
        _ => None,
    };
    let spans = spans.filter(|spans| (1..=crate::MAX_SPANS).contains(spans))?;
    let node = table.node("span_length")?;
    let lengths = match &node.value {
        Value::List(list) => list.iter().map(Node::number).collect::<Option<Vec<f64>>>()?,
        _ => vec![node.number()?; spans],
    };
    let good = lengths
        .iter()
        .all(|length| *length > 0.0 && *length <= crate::check::LONGEST_SPAN);
    (good && lengths.len() == spans).then_some(lengths)
}

/// A list of equal entries as one of them, so that a table of a uniform line gives a uniform line.
fn same(at: At, mut list: Vec<Node>) -> Node {
    let first = list.first().map(|node| shown(&node.value));
    let alike = list.iter().all(|node| Some(shown(&node.value)) == first);
    if alike && !list.is_empty() {
        list.swap_remove(0)
    } else {
        Node::list(at, list)
    }
}
