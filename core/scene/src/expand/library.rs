//! `from`: a table takes its keys from another file.

use std::path::Path;

use super::file_of;
use crate::csv::{Wrong, wrong};
use crate::files::Files;
use crate::overrides::replaced_by;
use crate::tree::{Node, Table, Value, parse};

/// Files that may take keys from each other in a row.
const DEEPEST: usize = 4;

/// Takes the keys of a library file into the table with this path; keys that are there win.
pub(super) fn take(table: &mut Table, path: &str, files: &Files, found: &mut Vec<Wrong>) {
    take_within(table, path, (Path::new(""), 1), files, found);
}

/// As [`take`], for a table of a file in `folder` that is itself number `depth` in a row.
fn take_within(table: &mut Table, path: &str, (folder, depth): (&Path, usize), files: &Files, found: &mut Vec<Wrong>) {
    let Some((at, file)) = file_of(table, path, "from", found) else {
        return;
    };
    let key = format!("{path}.from");
    if depth > DEEPEST {
        let expected = format!("must be left out: at most {DEEPEST} files may take keys from each other in a row");
        return found.push(wrong(at, key, format!("{file:?}"), expected));
    }
    let file = beside(folder, &file);
    let (text, number) = match files.open(&file) {
        Ok(opened) => opened,
        Err(reason) => return found.push(wrong(at, key, format!("{file:?}"), reason)),
    };
    let mut library = match parse(&text) {
        Ok(library) => library,
        Err((at, what)) => return found.push((at.moved_to(number), String::new(), what)),
    };
    library.move_to(number);
    let folder = Path::new(&file).parent().unwrap_or(Path::new(""));
    take_within(&mut library, path, (folder, depth + 1), files, found);
    move_paths(&mut library, folder);
    merge(table, library, path);
}

/// The path of a file that one in `folder` names.
fn beside(folder: &Path, file: &str) -> String {
    if folder.as_os_str().is_empty() {
        return file.to_owned();
    }
    folder.join(file).to_string_lossy().into_owned()
}

/// Makes paths in a library, which are relative to it, relative to the scene.
fn move_paths(library: &mut Table, folder: &Path) {
    for key in ["fmu", "table"] {
        if let Some(Value::String(file)) = library.node_mut(key).map(|node| &mut node.value) {
            *file = beside(folder, file);
        }
    }
    if let Some(droppers) = library.table_mut("droppers") {
        move_paths(droppers, folder);
    }
}

/// Rows of which those of a library stand behind those of the table: the first that fits holds.
const ROWS: (&str, &str) = ("assessment", "limit");

/// Adds keys of a library that the table neither has nor replaces by others.
fn merge(table: &mut Table, library: Table, path: &str) {
    let own: Vec<String> = table.entries.iter().map(|(key, _)| key.clone()).collect();
    for (key, node) in library.entries {
        if let (ROWS, Value::List(more), Some(Value::List(rows))) = (
            (path, key.as_str()),
            &node.value,
            table.node_mut(&key).map(|node| &mut node.value),
        ) {
            rows.extend(more.iter().cloned());
            continue;
        }
        let inner = match node.value {
            Value::Table(inner) if table.table_mut(&key).is_some() => inner,
            value => {
                let replaced = |own: &String| replaced_by(path, own).contains(&key.as_str());
                if !own.contains(&key) && !own.iter().any(replaced) {
                    let at = node.at;
                    table.push(&key, Node { at, value });
                }
                continue;
            }
        };
        if let Some(table) = table.table_mut(&key) {
            merge(table, inner, &format!("{path}.{key}"));
        }
    }
}
