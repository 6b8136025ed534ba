//! Certainty of numbers: `{ value = 0.0125, low = 0.005, high = 0.03, mark = "chosen" }` in place of a number, or
//! `"key.path" = { low = 0.005, high = 0.03 }` under `[ranges]`; a distribution, `{ normal = [110, 5] }`, in place of
//! the two ends.

use crate::choice::choice;
use crate::error::What;
use crate::tree::{At, Node, Table, Value};
use crate::write::shown;

choice! {
    /// Origin of a number.
    pub enum Mark {
        /// Measured.
        Measured = "measured",
        /// Written in a standard.
        Standard = "standard",
        /// Read in a text.
        Cited = "cited",
        /// Chosen for the scene.
        Chosen = "chosen",
        /// Fitted to a result.
        Calibrated = "calibrated",
        /// Remembered, not verified.
        Remembered = "remembered",
    }
    unavailable: []
}

choice! {
    /// Distribution of a number that is not known for certain, by two numbers.
    pub enum Shape {
        /// Even between two bounds.
        Uniform = "uniform",
        /// Even in the logarithm between two bounds.
        LogUniform = "log_uniform",
        /// Normal: mean and standard deviation.
        Normal = "normal",
        /// Normal in the natural logarithm: median of the number and standard deviation of its logarithm.
        LogNormal = "lognormal",
    }
    unavailable: []
}

/// Range that a number of a scene may have.
#[derive(Clone, Debug, PartialEq)]
pub struct Range {
    /// Path of its key, such as `pantograph[1].masses[2]`.
    pub key: String,
    /// Least that it may be, in the unit of its key; its value where there is none.
    pub low: Option<f64>,
    /// Most that it may be, likewise.
    pub high: Option<f64>,
    /// Its distribution, in place of both; two numbers in the unit of its key, but for the second of
    /// [`Shape::LogNormal`].
    pub distribution: Option<(Shape, [f64; 2])>,
    /// Its origin.
    pub mark: Option<Mark>,
}

/// Keys of such a table.
const KEYS: [&str; 8] = [
    "value",
    "low",
    "high",
    Shape::Uniform.name(),
    Shape::LogUniform.name(),
    Shape::Normal.name(),
    Shape::LogNormal.name(),
    "mark",
];

/// Table of ranges by the paths of their keys.
const RANGES: &str = "ranges";

/// Takes the ranges out of a scene, so that each of these keys holds its value.
pub(crate) fn take_ranges(root: &mut Table) -> (Vec<Range>, Vec<Wrong>) {
    let mut taken = (Vec::new(), Vec::new());
    let of_table = root.take(RANGES);
    for (key, node) in &mut root.entries {
        take(node, key.clone(), &mut taken);
    }
    match of_table {
        Some(Node {
            value: Value::Table(table),
            ..
        }) => {
            for (key, node) in &table.entries {
                let found = match &node.value {
                    Value::Table(table) => range(table, key, &KEYS[1..]),
                    other => Err(wrong_type(node.at, format!("{RANGES}.\"{key}\""), other)),
                };
                match found {
                    Ok(range) => taken.0.push(range),
                    Err(wrong) => taken.1.push(wrong),
                }
            }
        }
        Some(node) => taken.1.push(wrong_type(node.at, RANGES.to_owned(), &node.value)),
        None => {}
    }
    taken
}

fn wrong_type(at: At, key: String, value: &Value) -> Wrong {
    let value = shown(value);
    let expected = "a range in the unit of the key, such as \"run.speed_kmh\" = { low = 240, high = 260 }".to_owned();
    (at, key, What::WrongType { value, expected })
}

/// Place, key and reason of a table that is no range.
type Wrong = (At, String, What);
type Taken = (Vec<Range>, Vec<Wrong>);

fn take(node: &mut Node, path: String, taken: &mut Taken) {
    match &mut node.value {
        Value::Table(table) if is_range(table) => match range(table, &path, &KEYS) {
            Ok(range) => {
                taken.0.push(range);
                if let Some(value) = table.take("value") {
                    node.value = value.value;
                }
            }
            Err(wrong) => taken.1.push(wrong),
        },
        Value::Table(table) => {
            for (key, node) in &mut table.entries {
                take(node, format!("{path}.{key}"), taken);
            }
        }
        Value::List(list) => {
            for (index, node) in list.iter_mut().enumerate() {
                take(node, format!("{path}[{}]", index + 1), taken);
            }
        }
        _ => {}
    }
}

/// True for a table of these keys alone that says more than a value.
fn is_range(table: &Table) -> bool {
    let has = |key: &str| table.node(key).is_some();
    let own = table.entries.iter().all(|(key, _)| KEYS.contains(&key.as_str()));
    own && has("value") && KEYS[1..].iter().any(|key| has(key))
}

/// The range of a table of these keys.
fn range(table: &Table, path: &str, keys: &[&str]) -> Result<Range, Wrong> {
    if let Some((key, node)) = table.entries.iter().find(|(key, _)| !keys.contains(&key.as_str())) {
        let known = keys.iter().map(|key| (*key).to_owned()).collect();
        let what = What::UnknownKey { nearest: None, known };
        return Err((node.at, format!("{path}.{key}"), what));
    }
    let number = |key: &str| match table.node(key) {
        None => Ok(None),
        Some(node) => match node.number().filter(|number| number.is_finite()) {
            Some(number) => Ok(Some(number)),
            None => {
                let value = shown(&node.value);
                let expected = "a number in the unit of the key".to_owned();
                Err((node.at, format!("{path}.{key}"), What::WrongType { value, expected }))
            }
        },
    };
    let (value, low, high) = (number("value")?, number("low")?, number("high")?);
    let beyond = |bound: Option<f64>, out: fn(f64, f64) -> bool| {
        let (value, bound) = (value.or(low)?, bound?);
        out(value, bound).then_some(bound)
    };
    if beyond(low, |value, low| value < low).is_some() || beyond(high, |value, high| value > high).is_some() {
        let at = table
            .node("value")
            .or(table.node("low"))
            .map_or(At::File, |node| node.at);
        let shown = |number: Option<f64>| number.map_or_else(|| "value".to_owned(), |number| number.to_string());
        let expected = format!("must lie within its range, {} to {}", shown(low), shown(high));
        let value = shown(value.or(low));
        return Err((at, format!("{path}.value"), What::Refused { value, expected }));
    }
    let distribution = distribution(table, path, low.or(high).is_some())?;
    let mark = match table.node("mark") {
        None => None,
        Some(node) => {
            let word = match &node.value {
                Value::String(word) => Mark::ALL.iter().find(|mark| mark.name() == word).copied(),
                _ => None,
            };
            let unknown = || {
                let allowed: Vec<String> = Mark::ALL.iter().map(|mark| mark.name().to_owned()).collect();
                let value = shown(&node.value);
                let what = What::UnknownWord {
                    value,
                    nearest: None,
                    allowed,
                };
                (node.at, format!("{path}.mark"), what)
            };
            Some(word.ok_or_else(unknown)?)
        }
    };
    Ok(Range {
        key: path.to_owned(),
        low,
        high,
        distribution,
        mark,
    })
}

/// The distribution of a table, which may have one, and none beside ends.
fn distribution(table: &Table, path: &str, has_ends: bool) -> Result<Option<(Shape, [f64; 2])>, Wrong> {
    let mut found = None;
    for shape in Shape::ALL {
        let Some(node) = table.node(shape.name()) else { continue };
        let key = format!("{path}.{}", shape.name());
        if has_ends || found.is_some() {
            let because = "a range has two ends or one distribution".to_owned();
            return Err((node.at, key, What::LeaveOut { because }));
        }
        let numbers: Vec<f64> = match &node.value {
            Value::List(list) => list
                .iter()
                .filter_map(Node::number)
                .filter(|number| number.is_finite())
                .collect(),
            _ => Vec::new(),
        };
        let [first, second] = numbers[..] else {
            let (value, expected) = (
                shown(&node.value),
                "two numbers, such as { normal = [110, 5] }".to_owned(),
            );
            return Err((node.at, key, What::WrongType { value, expected }));
        };
        found = Some((*shape, [first, second]));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Files, SceneFile};

    const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");

    fn read(from: &str, to: &str) -> Result<Vec<Range>, String> {
        // Without the ranges of the shipped scene.
        let shipped = |line: &&str| !line.contains("low =") && !line.starts_with("[ranges]");
        let plain: String = EN_300.lines().filter(shipped).map(|line| format!("{line}\n")).collect();
        let text = plain.replacen(from, to, 1);
        assert_ne!(text, plain, "{from}");
        let files = Files::none();
        let file = SceneFile::read(&text, "a.toml", &[], &files).map_err(|error| error.to_string())?;
        let shipped = SceneFile::read(EN_300, "a.toml", &[], &files).unwrap();
        assert_eq!(file.scene, shipped.scene);
        Ok(file.ranges)
    }

    #[test]
    fn a_number_with_its_range_is_the_number() {
        let found = read(
            "alpha = 0.0125",
            "alpha = { value = 0.0125, low = 0.005, high = 0.03, mark = \"chosen\" }",
        );
        let expected = Range {
            key: "catenary.damping.alpha".to_owned(),
            low: Some(0.005),
            high: Some(0.03),
            distribution: None,
            mark: Some(Mark::Chosen),
        };
        assert_eq!(found.unwrap(), [expected]);
        let found = read("masses = [7.2,", "masses = [{ value = 7.2, low = 6.5 },").unwrap();
        assert_eq!(
            (found[0].key.as_str(), found[0].low, found[0].high),
            ("pantograph[1].masses[1]", Some(6.5), None)
        );
        let found = read("masses = [7.2,", "masses = [{ value = 7.2, normal = [7.2, 0.3] },").unwrap();
        assert_eq!(found[0].distribution, Some((Shape::Normal, [7.2, 0.3])));
        assert_eq!((found[0].low, found[0].high), (None, None));
        let table = "[ranges]\n\"contact.stiffness\" = { low = 4e4, high = 6e4, mark = \"standard\" }\n\n[catenary]\n";
        let found = read("[catenary]\n", table).unwrap();
        assert_eq!((found[0].key.as_str(), found[0].high), ("contact.stiffness", Some(6e4)));
    }

    #[test]
    fn a_range_that_is_none_is_refused_with_its_key() {
        for (table, parts) in [
            (
                "{ value = 0.0125, low = 0.02 }",
                &["catenary.damping.alpha.value", "0.02 to value"][..],
            ),
            (
                "{ value = 0.0125, low = \"a\" }",
                &["catenary.damping.alpha.low", "a number"],
            ),
            (
                "{ value = 0.0125, mark = \"guessed\" }",
                &["catenary.damping.alpha.mark", "remembered"],
            ),
            ("{ value = 0.0125, hihg = 1.0 }", &["catenary.damping.alpha"]),
            (
                "{ value = 0.0125, normal = 0.001 }",
                &["catenary.damping.alpha.normal", "two numbers"],
            ),
            (
                "{ value = 0.0125, low = 0.01, uniform = [0.01, 0.02] }",
                &["catenary.damping.alpha.uniform", "two ends or one distribution"],
            ),
        ] {
            let said = read("alpha = 0.0125", &format!("alpha = {table}")).unwrap_err();
            for part in parts {
                assert!(said.contains(part), "{table}: {said}");
            }
        }
        let ranges = |line: &str| read("[catenary]\n", &format!("[ranges]\n{line}\n\n[catenary]\n")).unwrap_err();
        for (line, part) in [
            ("\"a.b\" = 3.0", "a range in the unit"),
            ("\"a.b\" = { low = 3.0, value = 4.0 }", "value"),
            ("\"a.b\" = { low = 3.0, high = 2.0 }", "3 to 2"),
        ] {
            assert!(ranges(line).contains(part), "{line}: {}", ranges(line));
        }
    }
}
