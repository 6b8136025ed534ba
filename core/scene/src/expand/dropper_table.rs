//! `catenary.droppers.table`: one row per dropper.

use super::supports::{drop_filled, put_positions};
use super::{csv_of, file_of, leave_out, lengths_of, same, tension_lengths};
use crate::csv::{Column, Csv, Known, Wrong, wrong};
use crate::error::What;
use crate::files::Files;
use crate::tree::{Node, Table};

const KNOWN: Known = Known {
    lengths: &["position"],
    others: &["tension_length", "span", "remark"],
};

const KEY: &str = "catenary.droppers.table";

/// Fills the positions of droppers from their table; `names` are those of the tension lengths, or none where they have
/// numbers.
pub(super) fn take(line: &mut Table, names: &[String], files: &Files, found: &mut Vec<Wrong>) {
    let Some(droppers) = line.table_mut("droppers") else {
        return;
    };
    let Some((at, file)) = file_of(droppers, "catenary.droppers", "table", found) else {
        return;
    };
    let filled = ["positions", "rule", "pattern"];
    if !drop_filled(droppers, ("catenary.droppers", &filled), (at, &file), found).is_empty() {
        return;
    }
    let spans: Vec<Option<usize>> = tension_lengths(line)
        .iter()
        .map(|(_, table)| Some(lengths_of(table)?.len()))
        .collect();
    let Some(spans) = spans.into_iter().collect::<Option<Vec<usize>>>() else {
        // Reading refuses the spans.
        return;
    };
    for (path, table) in tension_lengths(line) {
        if let Some(node) = table.node("dropper_positions") {
            found.push(leave_out(
                node.at,
                format!("{path}.dropper_positions"),
                format!("the table {file:?} has it"),
            ));
        }
    }
    let Some(csv) = csv_of((at, &file), KEY, files, KNOWN, found) else {
        return;
    };
    let numbers: Vec<String> = (1..=spans.len()).map(|number| number.to_string()).collect();
    let names = if names.is_empty() { &numbers } else { names };
    let before = found.len();
    let mut lists = positions(&csv, names, &spans, found);
    if found.len() > before {
        return;
    }
    if line.node("tension_length").is_none() {
        if let Some(list) = lists.pop() {
            put_positions(line, same(csv.header(), list));
        }
    } else {
        for ((_, table), list) in tension_lengths(line).into_iter().zip(lists) {
            table.push("dropper_positions", same(csv.header(), list));
        }
    }
}

/// Lists of positions, one for each span of each tension length.
fn positions(csv: &Csv, names: &[String], spans: &[usize], found: &mut Vec<Wrong>) -> Vec<Vec<Node>> {
    let (Some(span), Some(position)) = (csv.column("span"), csv.length("position")) else {
        for (name, there) in [("span", csv.column("span")), ("position_m", csv.length("position"))] {
            if there.is_none() {
                let expected = "a column of the table".to_owned();
                found.push((csv.header(), name.to_owned(), What::Missing { expected }));
            }
        }
        return Vec::new();
    };
    let column = csv.column("tension_length");
    if column.is_none() && names.len() > 1 {
        let expected = "a column of the table where there are several tension lengths".to_owned();
        found.push((csv.header(), "tension_length".to_owned(), What::Missing { expected }));
        return Vec::new();
    }
    // A span has no list before its first row.
    let mut lists: Vec<Vec<Option<Vec<Node>>>> = spans.iter().map(|spans| vec![None; *spans]).collect();
    for row in 0..csv.rows() {
        let number = match column {
            None => Ok(0),
            Some(column) => tension_length_in(csv, row, column, names),
        };
        let index = number.and_then(|number| Ok((number, span_in(csv, row, span, spans[number])?)));
        let (number, index) = match index {
            Ok(index) => index,
            Err(problem) => {
                found.push(problem);
                continue;
            }
        };
        let list = &mut lists[number][index];
        if csv.cell(row, position).is_empty() {
            // No droppers: the only row of its span.
            if list.replace(Vec::new()).is_some() {
                found.push(csv.wrong(row, position, "a position, as the span has another row"));
            }
            continue;
        }
        match (csv.metres(row, position), list) {
            (Ok(_), Some(list)) if list.is_empty() => {
                let expected = "must be left out: a row before says that this span has no droppers";
                found.push(wrong(
                    csv.at(row, position),
                    csv.name(position),
                    csv.cell(row, position),
                    expected,
                ));
            }
            (Ok(metres), list) => list.get_or_insert_default().push(csv.node(row, position, metres)),
            (Err(problem), _) => found.push(problem),
        }
    }
    for (number, lists) in lists.iter().enumerate() {
        if let Some(index) = lists.iter().position(Option::is_none) {
            let expected = format!(
                "a row for span {} of tension length {}, with an empty position where it has no droppers",
                index + 1,
                names[number]
            );
            found.push((csv.header(), "span".to_owned(), What::Missing { expected }));
        }
    }
    let nodes = |list: Option<Vec<Node>>| {
        let list = list.unwrap_or_default();
        let at = list.first().map_or(csv.header(), |node| node.at);
        Node::list(at, list)
    };
    lists
        .into_iter()
        .map(|lists| lists.into_iter().map(nodes).collect())
        .collect()
}

fn tension_length_in(csv: &Csv, row: usize, column: Column, names: &[String]) -> Result<usize, Wrong> {
    let cell = csv.cell(row, column);
    let number = names.iter().position(|name| name == cell);
    number.ok_or_else(|| csv.wrong(row, column, format!("one of the tension lengths {}", names.join(", "))))
}

fn span_in(csv: &Csv, row: usize, column: Column, spans: usize) -> Result<usize, Wrong> {
    let number = csv.cell(row, column).parse::<usize>().ok();
    let number = number.filter(|number| (1..=spans).contains(number));
    number
        .map(|number| number - 1)
        .ok_or_else(|| csv.wrong(row, column, format!("a whole number from 1 to {spans}")))
}
