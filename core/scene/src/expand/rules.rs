//! Rules of a line: presag as a share of the span, droppers by distances or by names.

use super::{leave_out, lengths_of, same, tension_lengths, wrong_type};
use crate::csv::{Wrong, wrong};
use crate::error::What;
use crate::keys::nearest;
use crate::tree::{At, Node, Table, Value};
use crate::write::{shown, shown_number};

/// Largest share of a span that the presag is, either way.
const LARGEST_RATIO: f64 = 0.02;
/// Shortest distance that a rule may have, m: what droppers need at least between each other.
const SHORTEST: f64 = 0.1;
/// Most droppers that a rule makes: far more than a line of the most spans has.
const MOST: f64 = 1e5;
const DROPPERS: &str = "catenary.droppers";

/// Writes out the rules of a line.
pub(super) fn apply(line: &mut Table, found: &mut Vec<Wrong>) {
    let patterns = patterns(line, found);
    for (path, table) in tension_lengths(line) {
        presag_of_ratio(table, &path, found);
        name_positions(table, "dropper_positions", &path, &patterns, found);
        let lengths = lengths_of(table);
        pattern(
            table,
            ("dropper_pattern", "dropper_positions"),
            (&path, lengths),
            &patterns,
            found,
        );
    }
    let single = line.node("tension_length").is_none();
    let lengths = if single { lengths_of(line) } else { None };
    if let Some(droppers) = line.table_mut("droppers") {
        name_positions(droppers, "positions", DROPPERS, &patterns, found);
        if !single
            && let Some(node) = droppers.node("pattern")
            && matches!(node.value, Value::List(_))
        {
            let expected = "must be one name for all spans: give each tension length its own dropper_pattern";
            found.push(wrong(
                node.at,
                format!("{DROPPERS}.pattern"),
                shown(&node.value),
                expected,
            ));
            droppers.take("pattern");
        }
        pattern(
            droppers,
            ("pattern", "positions"),
            (DROPPERS, lengths),
            &patterns,
            found,
        );
    }
    rule(line, found);
}

/// `presag_ratio`.
fn presag_of_ratio(table: &mut Table, path: &str, found: &mut Vec<Wrong>) {
    let Some(node) = table.take("presag_ratio") else {
        return;
    };
    let key = format!("{path}.presag_ratio");
    if let Some(other) = table.take("presag") {
        return found.push(leave_out(other.at, format!("{path}.presag"), format!("{key} has it")));
    }
    let at = node.at;
    match node.number().filter(|ratio| ratio.abs() <= LARGEST_RATIO) {
        Some(ratio) => {
            // Without lengths any presag will do: the scene is refused for them.
            let lengths = lengths_of(table).unwrap_or_else(|| vec![0.0]);
            let list = lengths.iter().map(|length| Value::Float(ratio * length));
            let list = list.map(|value| Node { at, value }).collect();
            table.push("presag", same(at, list));
        }
        None => {
            let expected = format!("must be a share of each span within ±{LARGEST_RATIO}, such as 0.001");
            found.push(wrong(at, key, shown(&node.value), expected));
        }
    }
}

/// Named positions of droppers.
type Patterns = Vec<(String, Vec<Node>)>;

/// Takes out `droppers.patterns`.
fn patterns(line: &mut Table, found: &mut Vec<Wrong>) -> Patterns {
    let Some(node) = line
        .table_mut("droppers")
        .and_then(|droppers| droppers.take("patterns"))
    else {
        return Vec::new();
    };
    let key = format!("{DROPPERS}.patterns");
    let Value::Table(all) = node.value else {
        found.push(wrong_type(&node, key, "a table { name = [positions in m], … }"));
        return Vec::new();
    };
    let mut patterns = Patterns::new();
    for (name, node) in all.entries {
        let key = format!("{key}.{}", crate::write::shown_key(&name));
        if name == "none" || name.parse::<f64>().is_ok() {
            let expected = "must have a name that is no number and not none, which tables read otherwise";
            found.push(wrong(node.at, key, shown(&node.value), expected));
            continue;
        }
        match node.value {
            Value::List(list) => {
                for (i, entry) in list.iter().enumerate() {
                    if !entry.number().is_some_and(f64::is_finite) {
                        found.push(wrong_type(entry, format!("{key}[{}]", i + 1), "a number in m"));
                    }
                }
                patterns.push((name, list));
            }
            _ => found.push(wrong_type(&node, key, "a list of numbers in m")),
        }
    }
    patterns
}

/// Positions of a name, at the place of the name.
fn named(patterns: &Patterns, name: &str, at: At) -> Result<Node, What> {
    if let Some((_, list)) = patterns.iter().find(|(known, _)| known == name) {
        let list = list.iter().cloned().map(|node| Node { at, ..node });
        return Ok(Node::list(at, list));
    }
    if patterns.is_empty() {
        let (value, expected) = (
            format!("{name:?}"),
            "must be positions in m with spaces between: no catenary.droppers.patterns has names".to_owned(),
        );
        return Err(What::Refused { value, expected });
    }
    Err(What::UnknownWord {
        value: name.to_owned(),
        nearest: nearest(name, patterns.iter().map(|(name, _)| name.as_str())),
        allowed: patterns.iter().map(|(name, _)| name.clone()).collect(),
    })
}

/// Replaces names that a table left among positions.
fn name_positions(table: &mut Table, key: &str, path: &str, patterns: &Patterns, found: &mut Vec<Wrong>) {
    let Some(Value::List(list)) = table.node_mut(key).map(|node| &mut node.value) else {
        return;
    };
    for node in list.iter_mut().filter(|node| node.at.file().is_some()) {
        if let Value::String(name) = &node.value {
            match named(patterns, name, node.at) {
                Ok(positions) => *node = positions,
                Err(what) => found.push((node.at, format!("{path}.{key}"), what)),
            }
        }
    }
    // One list for all spans is written without a list around it.
    if let [only] = list.as_slice()
        && matches!(only.value, Value::List(_))
        && let Some(only) = list.pop()
        && let Some(node) = table.node_mut(key)
    {
        *node = only;
    }
}

/// Positions by one name for all spans, or by one name for each.
fn pattern(
    table: &mut Table,
    (key, filled): (&str, &str),
    (path, lengths): (&str, Option<Vec<f64>>),
    patterns: &Patterns,
    found: &mut Vec<Wrong>,
) {
    let Some(node) = table.take(key) else { return };
    let key = format!("{path}.{key}");
    if let Some(other) = table.take(filled) {
        return found.push(leave_out(other.at, format!("{path}.{filled}"), format!("{key} has it")));
    }
    let spans = lengths.map(|lengths| lengths.len());
    let of_name = |key: &str, node: &Node, found: &mut Vec<Wrong>| {
        let Value::String(name) = &node.value else {
            found.push(wrong_type(node, key, "the name of a pattern"));
            return None;
        };
        let positions = named(patterns, name, node.at);
        positions
            .map_err(|what| found.push((node.at, key.to_owned(), what)))
            .ok()
    };
    let positions = match &node.value {
        Value::List(names) => {
            if let Some(spans) = spans.filter(|spans| *spans != names.len()) {
                let expected = format!(
                    "has {} names, must have {spans}, one for each span, or be one name for all; none is repeated",
                    names.len()
                );
                return found.push(wrong(node.at, key, shown(&node.value), expected));
            }
            let names = names.iter().enumerate();
            let lists = names.filter_map(|(i, node)| of_name(&format!("{key}[{}]", i + 1), node, found));
            Some(same(node.at, lists.collect()))
        }
        _ => of_name(&key, &node, found),
    };
    if let Some(positions) = positions {
        table.push(filled, positions);
    }
}

/// Distances of a rule, m.
struct Rule {
    at: At,
    first: f64,
    longest: f64,
}

impl Rule {
    fn read(node: &Node, key: &str, found: &mut Vec<Wrong>) -> Option<Self> {
        let Value::Table(rule) = &node.value else {
            found.push(wrong_type(node, key, "{ first = …, longest = … } in m"));
            return None;
        };
        let known = ["first", "longest"];
        for (name, extra) in rule.entries.iter().filter(|(name, _)| !known.contains(&name.as_str())) {
            let (nearest, known) = (nearest(name, known.into_iter()), known.map(str::to_owned).to_vec());
            found.push((extra.at, format!("{key}.{name}"), What::UnknownKey { nearest, known }));
        }
        let distances = known.map(|name| {
            let (key, expected) = (format!("{key}.{name}"), format!("a length of at least {SHORTEST} m"));
            let Some(node) = rule.node(name) else {
                found.push((node.at, key, What::Missing { expected }));
                return None;
            };
            let good = |metres: &f64| *metres >= SHORTEST && metres.is_finite();
            let distance = node.number().filter(good);
            if distance.is_none() {
                found.push(wrong(node.at, key, shown(&node.value), format!("must be {expected}")));
            }
            distance
        });
        let [Some(first), Some(longest)] = distances else {
            return None;
        };
        let at = node.at;
        Some(Self { at, first, longest })
    }

    /// Positions in each span of these lengths (m).
    fn positions(&self, lengths: &[f64]) -> Node {
        let list = |length: &f64| {
            let between = length - 2.0 * self.first;
            let intervals = (between / self.longest - 1e-9).ceil().max(1.0);
            let at = self.at;
            let position = move |i: f64| {
                // Micrometres, so that the written positions are short.
                let position = (1e6 * (self.first + between * i / intervals)).round() / 1e6;
                let value = Value::Float(position);
                Node { at, value }
            };
            let middle = between < SHORTEST;
            let number = if middle { 0.0 } else { intervals };
            Node::list(at, (0..=number as usize).map(move |i| position(i as f64)))
        };
        same(self.at, lengths.iter().map(list).collect())
    }
}

/// `droppers.rule`, for every tension length without positions of its own.
fn rule(line: &mut Table, found: &mut Vec<Wrong>) {
    let key = format!("{DROPPERS}.rule");
    let Some(droppers) = line.table_mut("droppers") else {
        return;
    };
    let Some(node) = droppers.take("rule") else { return };
    for other in ["positions", "pattern"] {
        if let Some(other_node) = droppers.node(other) {
            return found.push(leave_out(
                other_node.at,
                format!("{DROPPERS}.{other}"),
                format!("{key} has it"),
            ));
        }
    }
    let Some(rule) = Rule::read(&node, &key, found) else {
        return;
    };
    let single = line.node("tension_length").is_none();
    let mut positions = None;
    for (path, table) in tension_lengths(line) {
        let Some(lengths) = lengths_of(table).filter(|_| table.node("dropper_positions").is_none()) else {
            continue;
        };
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let mut refuse = |name: &str, length: f64, expected: String| {
            let key = format!("{key}.{name}");
            found.push(wrong(rule.at, key, shown_number(length, "m"), expected));
        };
        if 2.0 * rule.first > shortest {
            let expected = format!(
                "must be at most {} m, half of the shortest span of {path}",
                0.5 * shortest
            );
            return refuse("first", rule.first, expected);
        }
        let total: f64 = lengths.iter().sum();
        if total / rule.longest > MOST {
            let expected = format!(
                "must be at least {} m: these are more than {MOST} droppers",
                total / MOST
            );
            return refuse("longest", rule.longest, expected);
        }
        let list = rule.positions(&lengths);
        if single {
            positions = Some(list);
        } else {
            table.push("dropper_positions", list);
        }
    }
    if let (Some(positions), Some(droppers)) = (positions, line.table_mut("droppers")) {
        droppers.push("positions", positions);
    }
}
