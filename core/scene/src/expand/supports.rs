//! `catenary.table`: one row per support and tension length.

use std::cmp::Ordering;

use super::{csv_of, file_of, leave_out, same};
use crate::csv::{Column, Csv, Known, Wrong, wrong};
use crate::error::What;
use crate::files::Files;
use crate::tree::{At, Node, Table, Value};
use crate::write::shown_number;

const KNOWN: Known = Known {
    lengths: &[
        "chainage",
        "span_length",
        "contact_wire_height",
        "encumbrance",
        "stagger",
        "messenger_stagger",
        "presag",
        "curve_radius",
    ],
    others: &["tension_length", "droppers", "remark"],
};

/// Lengths per support, whose columns have the names of the keys that they fill.
const PER_SUPPORT: [&str; 5] = [
    "contact_wire_height",
    "encumbrance",
    "stagger",
    "messenger_stagger",
    "curve_radius",
];

/// Keys of a tension length that the scene may have where the table has no such column.
const COMMON: [&str; 7] = [
    "contact_wire_height",
    "encumbrance",
    "stagger",
    "messenger_stagger",
    "presag",
    "presag_ratio",
    "curve_radius",
];

/// Keys that the rows themselves stand for.
const OF_ROWS: [&str; 3] = ["spans", "span_length", "tension_length"];

/// Cell of a span without droppers.
const NO_DROPPERS: &str = "none";

/// Keys of the droppers that a column of the table stands for.
const OF_DROPPERS: [&str; 4] = ["positions", "rule", "pattern", "table"];

const LAST_ROW: &str = "in the last row of a tension length, at which no span begins";

/// Rows of one tension length, by its name.
struct Group {
    name: String,
    rows: Vec<usize>,
}

/// Fills the keys of a line from its table; gives the names of the tension lengths, none without a table.
pub(super) fn take(line: &mut Table, files: &Files, found: &mut Vec<Wrong>) -> Vec<String> {
    let Some((at, file)) = file_of(line, "catenary", "table", found) else {
        return Vec::new();
    };
    let Some(csv) = csv_of((at, &file), "catenary.table", files, KNOWN, found) else {
        return Vec::new();
    };
    let before = found.len();
    let mut above = drop_filled(line, ("catenary", &filled_keys(&csv)), (at, &file), found);
    if let Some(droppers) = line.table_mut("droppers").filter(|_| csv.column("droppers").is_some()) {
        above.extend(drop_filled(
            droppers,
            ("catenary.droppers", &OF_DROPPERS),
            (at, &file),
            found,
        ));
    }
    let groups = groups(&csv, found);
    check_columns(line, &csv, groups.len(), found);
    if found.len() > before {
        return Vec::new();
    }
    let origin = origin_of(&csv);
    let tables = groups.iter().map(|group| {
        let mut table = tension_length(&csv, group, origin, found);
        let wins = |key: &str| match key {
            "dropper_positions" => above.iter().any(|key| OF_DROPPERS.contains(key)),
            "presag" => above.iter().any(|key| key.starts_with("presag")),
            key => above.contains(&key),
        };
        table.entries.retain(|(key, _)| !wins(key));
        table
    });
    let mut tables: Vec<Table> = tables.collect();
    if let [table] = tables.as_mut_slice() {
        table.take("start_x");
        if let Some(positions) = table.take("dropper_positions") {
            put_positions(line, positions);
        }
        line.entries.append(&mut table.entries);
    } else {
        let common: Vec<(&str, Node)> = COMMON.iter().filter_map(|key| Some((*key, line.take(key)?))).collect();
        let entries = groups.iter().zip(tables).map(|(group, mut table)| {
            for (key, node) in &common {
                table.push(key, node.clone());
            }
            let at = csv.at_row(group.rows[0]);
            let value = Value::Table(table);
            Node { at, value }
        });
        line.push("tension_length", Node::list(at, entries));
    }
    groups.into_iter().map(|group| group.name).collect()
}

/// Puts positions of droppers into the table that a line of one tension length has them in.
pub(super) fn put_positions(line: &mut Table, positions: Node) {
    if let Some(droppers) = line.table_mut("droppers") {
        droppers.push("positions", positions);
    }
}

/// Keys that the table fills.
fn filled_keys(csv: &Csv) -> Vec<&'static str> {
    let mut keys = OF_ROWS.to_vec();
    keys.extend(PER_SUPPORT.iter().filter(|key| csv.length(key).is_some()));
    if csv.length("presag").is_some() {
        keys.extend(["presag", "presag_ratio"]);
    }
    keys
}

/// Drops keys that a table replaces, because they come from a library beneath the file that names it, and refuses those
/// said beside it; gives those of a file above, which win over the table.
pub(super) fn drop_filled(
    table: &mut Table,
    (path, filled): (&str, &[&'static str]),
    (at, file): (At, &str),
    found: &mut Vec<Wrong>,
) -> Vec<&'static str> {
    let mut above = Vec::new();
    for key in filled {
        let Some(of_key) = table.node(key).map(|node| node.at) else {
            continue;
        };
        // Files are numbered from the scene on, a library after the file that takes keys from it.
        match of_key.file().cmp(&at.file()) {
            Ordering::Less if !OF_ROWS.contains(key) => above.push(*key),
            Ordering::Less | Ordering::Equal => {
                found.push(leave_out(
                    of_key,
                    format!("{path}.{key}"),
                    format!("the table {file:?} has it"),
                ));
            }
            Ordering::Greater => {
                table.take(key);
            }
        }
    }
    above
}

/// Tension lengths in the order of their first rows.
fn groups(csv: &Csv, found: &mut Vec<Wrong>) -> Vec<Group> {
    let column = csv.column("tension_length");
    let mut groups: Vec<Group> = Vec::new();
    for row in 0..csv.rows() {
        let name = column.map_or("1", |column| csv.cell(row, column));
        if let (Some(column), true) = (column, name.is_empty()) {
            found.push(csv.wrong(row, column, "the number or name of a tension length"));
        }
        match groups.iter_mut().find(|group| group.name == name) {
            Some(group) => group.rows.push(row),
            None => groups.push(Group {
                name: name.to_owned(),
                rows: vec![row],
            }),
        }
    }
    for group in groups.iter().filter(|group| group.rows.len() < 2) {
        let expected = format!(
            "must have at least two rows, one for each support of tension length {:?}",
            group.name
        );
        found.push(wrong(csv.at_row(group.rows[0]), "tension_length", "1 row", expected));
    }
    groups
}

/// Refuses a table without a column that must be there.
fn check_columns(line: &Table, csv: &Csv, tension_lengths: usize, found: &mut Vec<Wrong>) {
    let [chainage, span_length] = ["chainage", "span_length"].map(|name| csv.length(name));
    if chainage.is_some() == span_length.is_some() {
        let shown = if chainage.is_some() { "both" } else { "neither" };
        let expected = "must be chainage_m or span_length_m, one of the two";
        found.push(wrong(csv.header(), "columns", shown, expected));
    } else if span_length.is_some() && tension_lengths > 1 {
        let expected = format!(
            "must be chainage_m in place of span_length_m, so that {tension_lengths} tension lengths have places"
        );
        found.push(wrong(csv.header(), "columns", "span_length_m", expected));
    }
    for key in ["contact_wire_height", "encumbrance", "stagger", "presag"] {
        let is_said = |key: &str| line.node(key).is_some();
        let needed = match key {
            "encumbrance" => is_said("messenger_wire"),
            "presag" => !is_said("presag_ratio"),
            _ => true,
        };
        if needed && csv.length(key).is_none() && !is_said(key) {
            let expected = format!("a column of the table, or catenary.{key} a key of the scene");
            found.push((csv.header(), format!("{key}_m"), What::Missing { expected }));
        }
    }
}

/// Chainage at which the line begins, m; 0 where there is none.
fn origin_of(csv: &Csv) -> f64 {
    let column = csv.length("chainage");
    let chainages = column.into_iter().flat_map(|column| {
        let all = (0..csv.rows()).map(move |row| csv.metres(row, column));
        all.filter_map(Result::ok)
    });
    let least = chainages.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// Rounds to a whole micrometre: a difference of decimals is a decimal.
fn decimal(metres: f64) -> f64 {
    (1e6 * metres).round() / 1e6
}

/// Keys of one tension length.
fn tension_length(csv: &Csv, group: &Group, origin: f64, found: &mut Vec<Wrong>) -> Table {
    let mut table = Table::default();
    let place = csv.at_row(group.rows[0]);
    let Some((&last, spans)) = group.rows.split_last() else {
        return table;
    };
    let value = Value::Integer(i64::try_from(spans.len()).unwrap_or(i64::MAX));
    table.push("spans", Node { at: place, value });
    if let Some(column) = csv.length("chainage") {
        let (start, lengths) = along(csv, &group.rows, (column, origin), found);
        table.push("start_x", start);
        table.push("span_length", same(place, lengths));
    }
    for key in ["span_length", "presag"] {
        if let Some(column) = csv.length(key) {
            table.push(key, same(place, lengths_in(csv, spans, column, found)));
            found.extend(csv.must_be_empty(last, column, LAST_ROW));
        }
    }
    for key in PER_SUPPORT {
        let Some(column) = csv.length(key) else { continue };
        let node = match key {
            "curve_radius" => same(place, radii_in(csv, &group.rows, column, found)),
            "stagger" | "messenger_stagger" => match same(place, lengths_in(csv, &group.rows, column, found)) {
                one if one.number().is_some() => Node::list(one.at, [one]),
                list => list,
            },
            _ => same(place, lengths_in(csv, &group.rows, column, found)),
        };
        table.push(key, node);
    }
    if let Some(column) = csv.column("droppers") {
        let lists = spans.iter().map(|&row| droppers_in(csv, row, column, found)).collect();
        let list = match same(place, lists) {
            // A name holds for all spans; a list of one list would be read as one list per span.
            name if matches!(name.value, Value::String(_)) => Node::list(name.at, [name]),
            list => list,
        };
        table.push("dropper_positions", list);
        found.extend(csv.must_be_empty(last, column, LAST_ROW));
    }
    table
}

/// Lengths in a column, at their cells.
fn lengths_in(csv: &Csv, rows: &[usize], column: Column, found: &mut Vec<Wrong>) -> Vec<Node> {
    let mut list = Vec::with_capacity(rows.len());
    for &row in rows {
        match csv.metres(row, column) {
            Ok(metres) => list.push(csv.node(row, column, metres)),
            Err(problem) => found.push(problem),
        }
    }
    list
}

/// Radii of curves: an empty cell or `inf` is straight track.
fn radii_in(csv: &Csv, rows: &[usize], column: Column, found: &mut Vec<Wrong>) -> Vec<Node> {
    let mut list = Vec::with_capacity(rows.len());
    for &row in rows {
        if ["", "inf"].contains(&csv.cell(row, column)) {
            list.push(csv.node(row, column, f64::INFINITY));
        } else {
            list.extend(lengths_in(csv, &[row], column, found));
        }
    }
    list
}

/// Place of the first support behind `origin` (m), and lengths of the spans between chainages, m.
fn along(csv: &Csv, rows: &[usize], (column, origin): (Column, f64), found: &mut Vec<Wrong>) -> (Node, Vec<Node>) {
    let mut places: Vec<(usize, f64, f64)> = Vec::with_capacity(rows.len());
    for &row in rows {
        match csv.metres(row, column) {
            Ok(chainage) => {
                if let Some((before, _, reached)) = places.last()
                    && chainage <= *reached
                {
                    let expected = format!(
                        "must be greater than {reached} m in row {} of the same tension length: rows follow the travel",
                        csv.line(*before)
                    );
                    let value = shown_number(chainage, "m");
                    found.push(wrong(csv.at(row, column), csv.name(column), value, expected));
                }
                places.push((row, decimal(chainage - origin), chainage));
            }
            Err(problem) => found.push(problem),
        }
    }
    let start = places.first().map_or(0.0, |(_, x, _)| *x);
    let lengths = places
        .windows(2)
        .map(|ends| csv.node(ends[0].0, column, decimal(ends[1].1 - ends[0].1)));
    (csv.node(rows[0], column, start), lengths.collect())
}

/// Positions of the droppers of the span that begins at a row: numbers in m with spaces between, the name of a pattern,
/// or `none`.
fn droppers_in(csv: &Csv, row: usize, column: Column, found: &mut Vec<Wrong>) -> Node {
    let at = csv.at(row, column);
    let cell = csv.cell(row, column);
    let number = |text: &str| text.parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers: Option<Vec<f64>> = cell.split_whitespace().map(number).collect();
    match numbers {
        Some(numbers) if !numbers.is_empty() => {
            Node::list(at, numbers.into_iter().map(|number| csv.node(row, column, number)))
        }
        Some(_) => {
            found.push(csv.wrong(
                row,
                column,
                "positions in m with spaces between, the name of a pattern, or none",
            ));
            Node::list(at, [])
        }
        None if cell == NO_DROPPERS => Node::list(at, []),
        None => Node {
            at,
            value: Value::String(cell.to_owned()),
        },
    }
}
