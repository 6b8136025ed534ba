//! Tables, rules and parts of other files, written out as the plain keys of a line.
//!
//! ```text
//! catenary.from, pantograph[i].from    keys of a library file, those of the scene win
//! catenary.table                       one row per support and tension length
//! catenary.droppers.rule               positions by first distance and longest interval
//! catenary.droppers.pattern            positions by name
//! catenary.presag_ratio                presag as a share of each span
//! ```

use crate::csv::{Csv, Wrong};
use crate::error::What;
use crate::files::Files;
use crate::tree::{At, Node, Sources, Table, Value, parse};

/// Columns of a table of supports.
const COLUMNS: [&str; 16] = [
    "tension_length",
    "chainage_m",
    "span_length_m",
    "contact_wire_height_m",
    "contact_wire_height_mm",
    "encumbrance_m",
    "encumbrance_mm",
    "stagger_m",
    "stagger_mm",
    "messenger_stagger_m",
    "messenger_stagger_mm",
    "presag_m",
    "presag_mm",
    "curve_radius_m",
    "droppers",
    "remark",
];

/// Columns with one value per support, and the keys that they fill.
const PER_SUPPORT: [(&str, &str); 5] = [
    ("contact_wire_height", "contact_wire_height"),
    ("encumbrance", "encumbrance"),
    ("stagger", "stagger"),
    ("messenger_stagger", "messenger_stagger"),
    ("curve_radius", "curve_radius"),
];

/// Keys of a tension length, which a table fills.
const FILLED: [&str; 9] = [
    "spans",
    "span_length",
    "contact_wire_height",
    "encumbrance",
    "stagger",
    "messenger_stagger",
    "presag",
    "curve_radius",
    "tension_length",
];

/// Writes out everything that a scene leaves to tables, rules and library files.
pub(crate) fn expand(root: &mut Table, files: &Files) -> Vec<Wrong> {
    let mut found = Vec::new();
    if let Some(Value::List(pantographs)) = root.node_mut("pantograph").map(|node| &mut node.value) {
        for (index, pantograph) in pantographs.iter_mut().enumerate() {
            if let Value::Table(table) = &mut pantograph.value {
                take_from(table, &format!("pantograph[{}]", index + 1), files, &mut found);
            }
        }
    }
    let Some(Value::Table(line)) = root.node_mut("catenary").map(|node| &mut node.value) else {
        return found;
    };
    take_from(line, "catenary", files, &mut found);
    let patterns = patterns(line, &mut found);
    take_table(line, files, &patterns, &mut found);
    for_each_tension_length(line, |tension_length, path| {
        presag_of_ratio(tension_length, path, &mut found);
    });
    rule_of_droppers(line, &mut found);
    pattern_of_spans(line, &patterns, &mut found);
    found
}

/// Removes a key and returns its node.
fn take(table: &mut Table, key: &str) -> Option<Node> {
    let index = table.entries.iter().position(|(name, _)| name == key)?;
    Some(table.entries.remove(index).1)
}

fn refuse(
    found: &mut Vec<Wrong>,
    at: At,
    key: impl Into<String>,
    value: impl Into<String>,
    expected: impl Into<String>,
) {
    let (value, expected) = (value.into(), expected.into());
    found.push((at, key.into(), What::Refused { value, expected }));
}

/// Text of the file that `table.key` names.
fn text_of(
    table: &mut Table,
    (path, key): (&str, &str),
    files: &Files,
    found: &mut Vec<Wrong>,
) -> Option<(At, String, (String, u16))> {
    let node = take(table, key)?;
    let Value::String(file) = &node.value else {
        let (value, expected) = (crate::write::shown(&node.value), "the path of a file".to_owned());
        found.push((node.at, format!("{path}.{key}"), What::WrongType { value, expected }));
        return None;
    };
    match files.open(file) {
        Ok(opened) => Some((node.at, file.clone(), opened)),
        Err(reason) => {
            refuse(found, node.at, format!("{path}.{key}"), format!("{file:?}"), reason);
            None
        }
    }
}

/// Merges the keys of a library file into a table; keys that are there win.
fn take_from(table: &mut Table, path: &str, files: &Files, found: &mut Vec<Wrong>) {
    let Some((_, file, (text, number))) = text_of(table, (path, "from"), files, found) else {
        return;
    };
    let sources = Sources {
        origin: &file,
        overrides: &[],
        files,
    };
    match parse(&text, sources) {
        Ok(mut library) => {
            library.move_to(number);
            merge(table, library);
        }
        Err(problems) => found.extend(problems.into_iter().map(|problem| {
            let line = match &problem.place {
                crate::Place::Line(_, line) => *line,
                _ => 1,
            };
            let at = At::Other {
                file: number,
                line,
                column: None,
            };
            (at, problem.key, problem.what)
        })),
    }
}

fn merge(table: &mut Table, library: Table) {
    for (key, node) in library.entries {
        match (table.node_mut(&key).map(|node| &mut node.value), node.value) {
            (Some(Value::Table(own)), Value::Table(inner)) => merge(own, inner),
            (Some(_), _) => {}
            (None, value) => table.entries.push((key, Node { at: node.at, value })),
        }
    }
}

/// Named positions of droppers.
type Patterns = Vec<(String, Node)>;

/// `catenary.droppers.patterns`.
fn patterns(line: &mut Table, found: &mut Vec<Wrong>) -> Patterns {
    let Some(Value::Table(droppers)) = line.node_mut("droppers").map(|node| &mut node.value) else {
        return Vec::new();
    };
    let Some(node) = take(droppers, "patterns") else {
        return Vec::new();
    };
    match node.value {
        Value::Table(patterns) => patterns.entries,
        other => {
            let (value, expected) = (
                crate::write::shown(&other),
                "a table { name = [positions], … }".to_owned(),
            );
            let key = "catenary.droppers.patterns".to_owned();
            found.push((node.at, key, What::WrongType { value, expected }));
            Vec::new()
        }
    }
}

/// The positions of a name.
fn named(patterns: &Patterns, name: &str) -> Result<Node, What> {
    let known = patterns.iter().find(|(known, _)| known == name);
    known.map(|(_, node)| node.clone()).ok_or_else(|| What::UnknownWord {
        value: name.to_owned(),
        nearest: crate::keys::nearest(name, patterns.iter().map(|(name, _)| name.as_str())),
        allowed: patterns.iter().map(|(name, _)| name.clone()).collect(),
    })
}

/// `catenary.table`.
fn take_table(line: &mut Table, files: &Files, patterns: &Patterns, found: &mut Vec<Wrong>) {
    let Some((at, file, (text, number))) = text_of(line, ("catenary", "table"), files, found) else {
        return;
    };
    for key in FILLED {
        if let Some(node) = line.node(key) {
            let because = format!("catenary.table = {file:?} has it");
            found.push((node.at, format!("catenary.{key}"), What::LeaveOut { because }));
        }
    }
    let csv = match Csv::read(&text, number, files, &COLUMNS) {
        Ok(csv) => csv,
        Err(problems) => return found.extend(problems),
    };
    if csv.has("chainage_m") == csv.has("span_length_m") {
        let expected = "must have chainage_m or span_length_m, one of the two";
        return refuse(found, csv.at(0, None), "table", "columns", expected);
    }
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for row in 0..csv.rows() {
        let name = csv.cell(row, "tension_length").to_owned();
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, rows)) => rows.push(row),
            None => groups.push((name, vec![row])),
        }
    }
    let several = groups.len() > 1;
    let mut first_x = f64::INFINITY;
    let mut tables = Vec::new();
    for (_, rows) in &groups {
        let (table, start) = tension_length(&csv, rows, patterns, found);
        first_x = first_x.min(start);
        tables.push((table, start));
    }
    if several {
        let tables = tables.into_iter().map(|(mut table, start)| {
            table.entries.push((
                "start_x".to_owned(),
                Node {
                    at,
                    value: Value::Float(start - first_x),
                },
            ));
            Node {
                at,
                value: Value::Table(table),
            }
        });
        line.entries.push((
            "tension_length".to_owned(),
            Node {
                at,
                value: Value::List(tables.collect()),
            },
        ));
    } else if let Some((mut table, _)) = tables.pop() {
        if let Some(positions) = take(&mut table, "dropper_positions")
            && let Some(Value::Table(droppers)) = line.node_mut("droppers").map(|node| &mut node.value)
        {
            droppers.entries.push(("positions".to_owned(), positions));
        }
        line.entries.extend(table.entries);
    }
}

/// Keys of the tension length in these rows, and x of its first support.
fn tension_length(csv: &Csv, rows: &[usize], patterns: &Patterns, found: &mut Vec<Wrong>) -> (Table, f64) {
    let mut table = Table::default();
    let place = csv.at(rows[0], None);
    let mut push = |key: &str, value: Value| table.entries.push((key.to_owned(), Node { at: place, value }));
    let spans = rows.len() - 1;
    if spans == 0 {
        refuse(
            found,
            place,
            "tension_length",
            "1 row",
            "must have at least two rows, one for each support",
        );
        return (table, 0.0);
    }
    push("spans", Value::Integer(spans as i64));
    let (lengths, start) = span_lengths(csv, rows, found);
    push("span_length", Value::List(lengths));
    for (column, key) in PER_SUPPORT {
        if let Some((name, factor)) = column_of(csv, column, found) {
            let mut list = Vec::new();
            for &row in rows {
                match csv.number(row, &name, factor) {
                    Ok(Some(number)) => list.push(csv.node(row, &name, number)),
                    Ok(None) if column == "curve_radius" => list.push(csv.node(row, &name, f64::INFINITY)),
                    Ok(None) => empty(csv, row, &name, found),
                    Err(problem) => found.push(problem),
                }
            }
            push(key, Value::List(list));
        }
    }
    if let Some((name, factor)) = column_of(csv, "presag", found) {
        let mut list = Vec::new();
        for &row in &rows[..spans] {
            match csv.number(row, &name, factor) {
                Ok(Some(number)) => list.push(csv.node(row, &name, number)),
                Ok(None) => empty(csv, row, &name, found),
                Err(problem) => found.push(problem),
            }
        }
        last_is_empty(csv, rows[spans], &name, found);
        push("presag", Value::List(list));
    }
    if csv.has("droppers") {
        let mut lists = Vec::new();
        for &row in &rows[..spans] {
            lists.push(droppers_of(csv, row, patterns, found));
        }
        last_is_empty(csv, rows[spans], "droppers", found);
        push("dropper_positions", Value::List(lists));
    }
    (table, start)
}

fn empty(csv: &Csv, row: usize, name: &str, found: &mut Vec<Wrong>) {
    let expected = "a number in every row".to_owned();
    found.push((csv.at(row, Some(name)), name.to_owned(), What::Missing { expected }));
}

/// The last row of a tension length begins no span.
fn last_is_empty(csv: &Csv, row: usize, name: &str, found: &mut Vec<Wrong>) {
    let cell = csv.cell(row, name);
    if !cell.is_empty() {
        let expected = "must be empty in the last row of a tension length, at which no span begins";
        refuse(found, csv.at(row, Some(name)), name, format!("{cell:?}"), expected);
    }
}

/// The column of a quantity in m or mm and its factor.
fn column_of(csv: &Csv, quantity: &str, found: &mut Vec<Wrong>) -> Option<(String, f64)> {
    let (meters, millimeters) = (format!("{quantity}_m"), format!("{quantity}_mm"));
    if csv.has(&meters) && csv.has(&millimeters) {
        let because = format!("{meters} has it");
        found.push((csv.at(0, Some(&millimeters)), millimeters, What::LeaveOut { because }));
        return None;
    }
    if csv.has(&meters) {
        Some((meters, 1.0))
    } else {
        csv.has(&millimeters).then_some((millimeters, 1e-3))
    }
}

/// Lengths of the spans that begin at all but the last of these rows, m, and x of the first support.
fn span_lengths(csv: &Csv, rows: &[usize], found: &mut Vec<Wrong>) -> (Vec<Node>, f64) {
    let mut list = Vec::new();
    let (name, last) = ("span_length_m", rows.len() - 1);
    if csv.has(name) {
        for &row in &rows[..last] {
            match csv.number(row, name, 1.0) {
                Ok(Some(number)) => list.push(csv.node(row, name, number)),
                Ok(None) => empty(csv, row, name, found),
                Err(problem) => found.push(problem),
            }
        }
        last_is_empty(csv, rows[last], name, found);
        return (list, 0.0);
    }
    let name = "chainage_m";
    let mut before: Option<f64> = None;
    let mut start = 0.0;
    for &row in rows {
        let chainage = match csv.number(row, name, 1.0) {
            Ok(Some(number)) => number,
            Ok(None) => {
                empty(csv, row, name, found);
                continue;
            }
            Err(problem) => {
                found.push(problem);
                continue;
            }
        };
        match before {
            Some(before) if chainage <= before => {
                let expected = format!("must be greater than {before} m, that of the row before it");
                refuse(found, csv.at(row, Some(name)), name, format!("{chainage} m"), expected);
            }
            // A difference of decimals is a decimal.
            Some(before) => list.push(csv.node(row, name, ((chainage - before) * 1e6).round() / 1e6)),
            None => start = chainage,
        }
        before = Some(chainage);
    }
    (list, start)
}

/// Positions of the droppers of the span that begins at a row: a name, or numbers with spaces between.
fn droppers_of(csv: &Csv, row: usize, patterns: &Patterns, found: &mut Vec<Wrong>) -> Node {
    let at = csv.at(row, Some("droppers"));
    let cell = csv.cell(row, "droppers");
    let numbers: Option<Vec<f64>> = cell.split_whitespace().map(|number| number.parse().ok()).collect();
    if let Some(numbers) = numbers {
        let list = numbers.into_iter().map(|number| Node {
            at,
            value: Value::Float(number),
        });
        let value = Value::List(list.collect());
        return Node { at, value };
    }
    match named(patterns, cell) {
        Ok(node) => node,
        Err(what) => {
            found.push((at, "droppers".to_owned(), what));
            let value = Value::List(Vec::new());
            Node { at, value }
        }
    }
}

fn for_each_tension_length(line: &mut Table, mut visit: impl FnMut(&mut Table, &str)) {
    if let Some(Value::List(all)) = line.node_mut("tension_length").map(|node| &mut node.value) {
        for (index, entry) in all.iter_mut().enumerate() {
            if let Value::Table(table) = &mut entry.value {
                visit(table, &format!("catenary.tension_length[{}]", index + 1));
            }
        }
    } else {
        visit(line, "catenary");
    }
}

fn number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Float(number) => Some(number),
        Value::Integer(number) => Some(number as f64),
        _ => None,
    }
}

/// Length of each span of a table as written; none where keys are missing or wrong, which reading reports.
fn lengths_of(table: &Table) -> Option<Vec<f64>> {
    let spans = number(table.node("spans")?).filter(|spans| (1.0..=5000.0).contains(spans))? as usize;
    let node = table.node("span_length")?;
    match &node.value {
        Value::List(list) => list
            .iter()
            .map(number)
            .collect::<Option<Vec<f64>>>()
            .filter(|list| list.len() == spans),
        _ => Some(vec![number(node)?; spans]),
    }
}

/// `presag_ratio`.
fn presag_of_ratio(table: &mut Table, path: &str, found: &mut Vec<Wrong>) {
    let Some(lengths) = lengths_of(table) else { return };
    let Some(node) = take(table, "presag_ratio") else {
        return;
    };
    if let Some(other) = table.node("presag") {
        let because = format!("{path}.presag_ratio has it");
        return found.push((other.at, format!("{path}.presag"), What::LeaveOut { because }));
    }
    match number(&node).filter(|ratio| ratio.abs() <= 0.02) {
        Some(ratio) => {
            let list = lengths.iter().map(|length| Node {
                at: node.at,
                value: Value::Float(ratio * length),
            });
            let value = Value::List(list.collect());
            table.entries.push(("presag".to_owned(), Node { at: node.at, value }));
        }
        None => {
            let expected = "must be a share of each span, such as 0.001";
            refuse(
                found,
                node.at,
                format!("{path}.presag_ratio"),
                crate::write::shown(&node.value),
                expected,
            );
        }
    }
}

/// Positions by a rule: `first` m from both supports, and evenly between at intervals of at most `longest` m.
fn by_rule(length: f64, first: f64, longest: f64) -> Vec<f64> {
    let between = length - 2.0 * first;
    if between <= 0.0 {
        return vec![0.5 * length];
    }
    let intervals = (between / longest - 1e-9).ceil().max(1.0) as usize;
    let position = |i: usize| first + between * i as f64 / intervals as f64;
    (0..=intervals).map(|i| (position(i) * 1e6).round() / 1e6).collect()
}

/// `catenary.droppers.rule`.
fn rule_of_droppers(line: &mut Table, found: &mut Vec<Wrong>) {
    let key = "catenary.droppers.rule";
    let Some(Value::Table(droppers)) = line.node_mut("droppers").map(|node| &mut node.value) else {
        return;
    };
    let Some(node) = take(droppers, "rule") else { return };
    for other in ["positions", "pattern"] {
        if let Some(other_node) = droppers.node(other) {
            let because = format!("{key} has it");
            return found.push((
                other_node.at,
                format!("catenary.droppers.{other}"),
                What::LeaveOut { because },
            ));
        }
    }
    let Value::Table(rule) = &node.value else {
        let (value, expected) = (
            crate::write::shown(&node.value),
            "{ first = …, longest = … } in m".to_owned(),
        );
        return found.push((node.at, key.to_owned(), What::WrongType { value, expected }));
    };
    let mut part = |name: &str| {
        let value = rule
            .node(name)
            .and_then(number)
            .filter(|value| *value >= 0.1 && value.is_finite());
        if value.is_none() {
            let shown = rule
                .node(name)
                .map_or_else(|| "missing".to_owned(), |node| crate::write::shown(&node.value));
            refuse(
                found,
                node.at,
                format!("{key}.{name}"),
                shown,
                "must be a length of at least 0.1 m",
            );
        }
        value
    };
    let (Some(first), Some(longest)) = (part("first"), part("longest")) else {
        return;
    };
    if let Some((name, extra)) = rule
        .entries
        .iter()
        .find(|(name, _)| name != "first" && name != "longest")
    {
        let known = vec!["first".to_owned(), "longest".to_owned()];
        let nearest = crate::keys::nearest(name, known.iter().map(String::as_str));
        return found.push((extra.at, format!("{key}.{name}"), What::UnknownKey { nearest, known }));
    }
    let lists = |lengths: &[f64]| {
        let list = |length: &f64| {
            let positions = by_rule(*length, first, longest).into_iter();
            let positions = positions.map(|position| Node {
                at: node.at,
                value: Value::Float(position),
            });
            Node {
                at: node.at,
                value: Value::List(positions.collect()),
            }
        };
        let value = Value::List(lengths.iter().map(list).collect());
        Node { at: node.at, value }
    };
    let several = line.node("tension_length").is_some();
    let mut of_single = None;
    for_each_tension_length(line, |table, _| {
        if let Some(lengths) = lengths_of(table) {
            if several {
                if table.node("dropper_positions").is_none() {
                    table.entries.push(("dropper_positions".to_owned(), lists(&lengths)));
                }
            } else {
                of_single = Some(lists(&lengths));
            }
        }
    });
    if let Some(Value::Table(droppers)) = line.node_mut("droppers").map(|node| &mut node.value) {
        // Tension lengths have their own; the common list is not used.
        let positions = of_single.unwrap_or_else(|| lists(&[2.0 * first + longest]));
        droppers.entries.push(("positions".to_owned(), positions));
    }
}

/// `catenary.droppers.pattern`: one name for all spans, or one for each span.
fn pattern_of_spans(line: &mut Table, patterns: &Patterns, found: &mut Vec<Wrong>) {
    let key = "catenary.droppers.pattern";
    let Some(Value::Table(droppers)) = line.node_mut("droppers").map(|node| &mut node.value) else {
        return;
    };
    let Some(node) = take(droppers, "pattern") else { return };
    if let Some(other) = droppers.node("positions") {
        let because = format!("{key} has it");
        return found.push((
            other.at,
            "catenary.droppers.positions".to_owned(),
            What::LeaveOut { because },
        ));
    }
    let mut list = |node: &Node| match &node.value {
        Value::String(name) => match named(patterns, name) {
            Ok(positions) => Some(positions),
            Err(what) => {
                found.push((node.at, key.to_owned(), what));
                None
            }
        },
        other => {
            let (value, expected) = (crate::write::shown(other), "the name of a pattern".to_owned());
            found.push((node.at, key.to_owned(), What::WrongType { value, expected }));
            None
        }
    };
    let positions = match &node.value {
        Value::List(names) => {
            let lists: Vec<Node> = names.iter().filter_map(&mut list).collect();
            Some(Node {
                at: node.at,
                value: Value::List(lists),
            })
        }
        _ => list(&node),
    };
    if let Some(positions) = positions {
        droppers.entries.push(("positions".to_owned(), positions));
    }
}
