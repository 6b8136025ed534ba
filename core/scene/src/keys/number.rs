//! Numbers, lists of numbers and vectors.

use super::Keys;
use crate::error::What;
use crate::tree::{Node, Value};
use crate::write::{shown, shown_entries, shown_number};

/// Unit, range and default of a number.
#[derive(Clone, Copy)]
pub(crate) struct Number {
    unit: &'static str,
    range: Range,
    default: Option<f64>,
    /// Bounds that are checked with a reason of their own, for the description.
    least: Option<f64>,
    most: Option<f64>,
}

#[derive(Clone, Copy)]
enum Range {
    Any,
    Positive,
    NotNegative,
    NotZero,
    Radius,
    Between(f64, f64),
}

/// Smallest radius of a track, m: below that of any tramway.
const LEAST_RADIUS: f64 = 10.0;

impl Number {
    const fn new(unit: &'static str, range: Range) -> Self {
        Self {
            unit,
            range,
            default: None,
            least: None,
            most: None,
        }
    }

    pub(crate) const fn any(unit: &'static str) -> Self {
        Self::new(unit, Range::Any)
    }

    pub(crate) const fn positive(unit: &'static str) -> Self {
        Self::new(unit, Range::Positive)
    }

    pub(crate) const fn not_negative(unit: &'static str) -> Self {
        Self::new(unit, Range::NotNegative)
    }

    pub(crate) const fn not_zero() -> Self {
        Self::new("", Range::NotZero)
    }

    /// A radius in m with the sign of a side; infinite for straight.
    pub(crate) const fn radius() -> Self {
        Self::new("m", Range::Radius)
    }

    pub(crate) const fn between(from: f64, to: f64) -> Self {
        Self::new("", Range::Between(from, to))
    }

    /// The same range in a unit.
    pub(crate) const fn between_in(unit: &'static str, from: f64, to: f64) -> Self {
        Self::new(unit, Range::Between(from, to))
    }

    /// A coordinate of a cross-section of a wheel or a rail, m: one in millimetres is no profile, and its samples would
    /// fill any memory.
    pub(crate) const fn of_cross_section() -> Self {
        Self::between_in("m", -0.5, 0.5)
    }

    pub(crate) const fn default(mut self, value: f64) -> Self {
        self.default = Some(value);
        self
    }

    /// Names a lower bound that is checked elsewhere.
    pub(crate) const fn at_least(mut self, bound: f64) -> Self {
        self.least = Some(bound);
        self
    }

    /// Names an upper bound that is checked elsewhere.
    pub(crate) const fn at_most(mut self, bound: f64) -> Self {
        self.most = Some(bound);
        self
    }

    /// The range in words of the reference.
    fn range(&self) -> String {
        let range = match (self.range, self.least) {
            (Range::Between(from, to), _) => format!("from {from} to {to}"),
            (_, Some(least)) => format!("≥ {least}"),
            (Range::Any, None) => "any number".to_owned(),
            (Range::Positive, None) => "> 0".to_owned(),
            (Range::NotNegative, None) => "≥ 0".to_owned(),
            (Range::NotZero, None) => "≠ 0".to_owned(),
            (Range::Radius, None) => "≥ 10 either way, or inf".to_owned(),
        };
        match self.most {
            Some(most) if matches!(self.range, Range::Any) => format!("≤ {most}"),
            Some(most) => format!("{range}, ≤ {most}"),
            None => range,
        }
    }

    fn default_shown(&self) -> Option<String> {
        self.default.map(|value| shown_number(value, ""))
    }

    /// `a positive number in km/h`, after "must be".
    fn described(&self) -> String {
        let unit = if self.unit.is_empty() {
            String::new()
        } else {
            format!(" in {}", self.unit)
        };
        match self.range {
            Range::Any => format!("a number{unit}"),
            Range::Positive => format!("a positive number{unit}"),
            Range::NotNegative => format!("a number{unit}, not negative"),
            Range::NotZero => format!("a number{unit}, not zero"),
            Range::Radius => format!("a radius{unit} with a sign, or inf"),
            Range::Between(from, to) => format!("a number{unit} from {from} to {to}"),
        }
    }

    /// Complaint about a value, if there is any.
    fn complaint(&self, value: f64) -> Option<String> {
        let (holds, expected) = match self.range {
            Range::Any => (true, "must be finite".to_string()),
            Range::Positive => (value > 0.0, "must be positive and finite".to_string()),
            Range::NotNegative => (value >= 0.0, "must be zero or positive, and finite".to_string()),
            Range::NotZero => (value != 0.0, "must be finite and not zero".to_string()),
            Range::Radius => {
                let holds = value.abs() >= LEAST_RADIUS;
                let expected = format!("must be {LEAST_RADIUS} m or more to the left, negative to the right, or inf");
                return (!holds).then_some(expected);
            }
            Range::Between(from, to) => (
                (from..=to).contains(&value),
                format!("must be from {from} to {}", shown_number(to, self.unit)),
            ),
        };
        (!(holds && value.is_finite())).then_some(expected)
    }
}

/// How many entries a list must have.
#[derive(Clone, Copy)]
pub(crate) enum Length {
    /// Checked elsewhere, against other keys.
    Any,
    /// At least one.
    NotEmpty,
    Exactly(usize),
}

impl Length {
    /// The number of entries in words of the reference.
    fn range(self) -> String {
        match self {
            Self::Any => "list".to_owned(),
            Self::NotEmpty => "list, at least one entry".to_owned(),
            Self::Exactly(0 | 1) => "list, as long as the first one".to_owned(),
            Self::Exactly(n) => format!("list of {n}"),
        }
    }

    fn described(self) -> String {
        match self {
            Self::Any => String::new(),
            Self::NotEmpty => ", at least one".to_string(),
            Self::Exactly(n) => format!(", {n} of them"),
        }
    }

    fn holds(self, n: usize) -> bool {
        match self {
            Self::Any => true,
            Self::NotEmpty => n > 0,
            Self::Exactly(expected) => n == expected,
        }
    }
}

impl Keys<'_> {
    /// A number.
    pub(crate) fn number(&mut self, name: &str, was: Option<f64>, number: Number) -> f64 {
        if let Some(value) = was {
            self.push(name, Value::Float(value));
            return value;
        }
        if self.record(name, number.unit, number.range(), number.default_shown()) {
            return number.default.unwrap_or(f64::NAN);
        }
        match self.node(name).cloned() {
            Some(node) => self.checked(self.key(name), &node, number),
            None => number.default.unwrap_or_else(|| {
                self.missing(name, number.described());
                f64::NAN
            }),
        }
    }

    /// A number that may be left out.
    pub(crate) fn optional_number(&mut self, name: &str, was: Option<Option<f64>>, number: Number) -> Option<f64> {
        self.has(name, was.flatten().is_some())
            .then(|| self.number(name, was.flatten(), number))
    }

    /// A number found at `node`, whose full path is `key`.
    fn checked(&mut self, key: String, node: &Node, number: Number) -> f64 {
        let found = match &node.value {
            Value::Float(found) => *found,
            Value::Integer(found) => *found as f64,
            other => {
                let what = What::WrongType {
                    value: shown(other),
                    expected: number.described(),
                };
                self.problem(node.at, key, what);
                return f64::NAN;
            }
        };
        if let Some(expected) = number.complaint(found) {
            let what = What::Refused {
                value: shown_number(found, number.unit),
                expected,
            };
            self.problem(node.at, key, what);
        }
        found
    }

    /// A list of numbers.
    pub(crate) fn numbers(&mut self, name: &str, was: Option<&[f64]>, number: Number, length: Length) -> Vec<f64> {
        let expected = || {
            let unit = if number.unit.is_empty() {
                String::new()
            } else {
                format!(" in {}", number.unit)
            };
            format!("a list of numbers{unit}{}", length.described())
        };
        if let Some(values) = was {
            self.push(
                name,
                Value::List(values.iter().map(|value| Value::Float(*value).into()).collect()),
            );
            return values.to_vec();
        }
        let range = format!("{}, each {}", length.range(), number.range());
        if self.record(name, number.unit, range, number.default_shown()) {
            return match length {
                Length::Exactly(n) => vec![f64::NAN; n],
                Length::Any | Length::NotEmpty => vec![f64::NAN],
            };
        }
        match self.node(name).cloned() {
            Some(Node {
                value: Value::List(list),
                ..
            }) => {
                if !length.holds(list.len()) {
                    self.refuse(
                        name,
                        format!("has {}, must be {}", shown_entries(list.len()), expected()),
                    );
                }
                list.iter()
                    .enumerate()
                    .map(|(i, node)| self.checked(self.entry_key(name, i), node, number))
                    .collect()
            }
            Some(node) => {
                self.wrong_type(name, &node.value, expected());
                Vec::new()
            }
            None => {
                self.missing(name, expected());
                Vec::new()
            }
        }
    }

    /// True where a list was typed.
    fn is_list(&mut self, name: &str) -> bool {
        self.node(name).is_some_and(|node| matches!(node.value, Value::List(_)))
    }

    /// One number for all of `n`, or a list of `n` numbers.
    pub(crate) fn number_or_numbers(&mut self, name: &str, was: Option<&[f64]>, number: Number, n: usize) -> Vec<f64> {
        let range = format!("one number, or one for each in a list, each {}", number.range());
        if was.is_none() && self.record(name, number.unit, range, number.default_shown()) {
            return vec![f64::NAN; n];
        }
        match was {
            Some([first, others @ ..]) if others.iter().all(|value| value == first) => {
                vec![self.number(name, Some(*first), number); n]
            }
            Some(values) => self.numbers(name, Some(values), number, Length::Exactly(n)),
            None if self.is_list(name) => self.numbers(name, None, number, Length::Exactly(n)),
            None => vec![self.number(name, None, number); n],
        }
    }

    /// One number, or a list of at least one.
    pub(crate) fn one_or_more(&mut self, name: &str, was: Option<&[f64]>, number: Number) -> Vec<f64> {
        let range = format!("one number or a list, each {}", number.range());
        if was.is_none() && self.record(name, number.unit, range, number.default_shown()) {
            return vec![f64::NAN];
        }
        match was {
            Some([value]) => vec![self.number(name, Some(*value), number)],
            Some(values) => self.numbers(name, Some(values), number, Length::NotEmpty),
            None if self.is_list(name) => self.numbers(name, None, number, Length::NotEmpty),
            None => vec![self.number(name, None, number)],
        }
    }

    /// One number that holds everywhere, or a list of `n`.
    pub(crate) fn one_or_each(&mut self, name: &str, was: Option<&[f64]>, number: Number, n: usize) -> Vec<f64> {
        let range = format!("one number, or one for each in a list, each {}", number.range());
        if was.is_none() && self.record(name, number.unit, range, number.default_shown()) {
            return vec![f64::NAN];
        }
        match was {
            Some([value]) => vec![self.number(name, Some(*value), number)],
            Some(values) => self.numbers(name, Some(values), number, Length::Any),
            None if self.is_list(name) => self.numbers(name, None, number, Length::Exactly(n)),
            None => vec![self.number(name, None, number)],
        }
    }

    /// As [`Keys::one_or_each`], where the key may be left out: an empty list.
    pub(crate) fn optional_one_or_each(
        &mut self,
        name: &str,
        was: Option<&[f64]>,
        number: Number,
        n: usize,
    ) -> Vec<f64> {
        if self.has(name, was.is_some_and(|list| !list.is_empty())) {
            self.one_or_each(name, was, number, n)
        } else {
            Vec::new()
        }
    }

    /// A list of at least one number, where the key may be left out: an empty list.
    pub(crate) fn optional_numbers(&mut self, name: &str, was: Option<&[f64]>, number: Number) -> Vec<f64> {
        if self.has(name, was.is_some_and(|list| !list.is_empty())) {
            self.numbers(name, was, number, Length::NotEmpty)
        } else {
            Vec::new()
        }
    }

    /// A list of numbers that holds everywhere, or a list of such lists; at least one number in each.
    pub(crate) fn list_or_lists(&mut self, name: &str, was: Option<&[Vec<f64>]>, number: Number) -> Vec<Vec<f64>> {
        if let Some([list]) = was {
            return vec![self.numbers(name, Some(list), number, Length::Any)];
        }
        if let Some(lists) = was {
            let list = |row: &Vec<f64>| Value::List(row.iter().map(|value| Value::Float(*value).into()).collect());
            self.push(name, Value::List(lists.iter().map(|row| list(row).into()).collect()));
            return lists.to_vec();
        }
        let nested = matches!(
            self.node(name),
            Some(Node { value: Value::List(list), .. })
                if list.first().is_some_and(|entry| matches!(entry.value, Value::List(_)))
        );
        if !nested {
            return vec![self.numbers(name, None, number, Length::NotEmpty)];
        }
        let Some(Node {
            value: Value::List(lists),
            ..
        }) = self.node(name).cloned()
        else {
            return Vec::new();
        };
        let mut found = Vec::with_capacity(lists.len());
        for (i, list) in lists.iter().enumerate() {
            let key = self.entry_key(name, i);
            match &list.value {
                Value::List(entries) => {
                    let numbers = entries.iter().enumerate();
                    let numbers = numbers.map(|(j, entry)| self.checked(format!("{key}[{}]", j + 1), entry, number));
                    found.push(numbers.collect());
                }
                other => {
                    let what = What::WrongType {
                        value: shown(other),
                        expected: format!("a list of numbers in {}", number.unit),
                    };
                    self.problem(list.at, key, what);
                }
            }
        }
        found
    }

    /// Rows of numbers, a list of lists; left out where there are none.
    pub(crate) fn optional_rows(&mut self, name: &str, was: Option<&[Vec<f64>]>) -> Vec<Vec<f64>> {
        if let Some(rows) = was {
            let list = |row: &Vec<f64>| Value::List(row.iter().map(|value| Value::Float(*value).into()).collect());
            if !rows.is_empty() {
                self.push(name, Value::List(rows.iter().map(|row| list(row).into()).collect()));
            }
            return rows.to_vec();
        }
        self.may_be_left_out(name);
        if self.record(name, "", "list of rows, each a list of numbers", None) {
            return Vec::new();
        }
        let Some(node) = self.node(name).cloned() else {
            return Vec::new();
        };
        let expected = "a list of rows, each a list of numbers".to_owned();
        let Value::List(rows) = &node.value else {
            self.wrong_type(name, &node.value, expected);
            return Vec::new();
        };
        let mut found = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            let key = self.entry_key(name, i);
            let Value::List(entries) = &row.value else {
                let value = shown(&row.value);
                self.problem(row.at, key, What::WrongType { value, expected });
                return Vec::new();
            };
            let numbers = entries
                .iter()
                .enumerate()
                .map(|(j, entry)| self.checked(format!("{key}[{}]", j + 1), entry, Number::any("")));
            found.push(numbers.collect());
        }
        found
    }

    /// A vector of three numbers.
    pub(crate) fn vector(&mut self, name: &str, was: Option<[f64; 3]>, number: Number) -> [f64; 3] {
        let values = self.numbers(
            name,
            was.as_ref().map(|values| values.as_slice()),
            number,
            Length::Exactly(3),
        );
        values.try_into().unwrap_or([f64::NAN; 3])
    }

    /// A list of two numbers.
    pub(crate) fn pair(&mut self, name: &str, was: Option<[f64; 2]>, number: Number) -> [f64; 2] {
        let values = self.numbers(
            name,
            was.as_ref().map(|values| values.as_slice()),
            number,
            Length::Exactly(2),
        );
        values.try_into().unwrap_or([f64::NAN; 2])
    }

    /// A list of points of N numbers, at least one.
    pub(crate) fn points<const N: usize>(
        &mut self,
        name: &str,
        was: Option<&[[f64; N]]>,
        number: Number,
    ) -> Vec<[f64; N]> {
        let expected = || format!("a list of points in {}, {N} numbers each, at least one", number.unit);
        let list = |values: &[f64]| Value::List(values.iter().map(|value| Value::Float(*value).into()).collect());
        if let Some(points) = was {
            let value = Value::List(points.iter().map(|point| list(point).into()).collect());
            self.push(name, value);
            return points.to_vec();
        }
        let range = format!("list of points, {N} numbers each, at least one");
        if self.record(name, number.unit, range, None) {
            return Vec::new();
        }
        let node = self.node(name).cloned();
        let entries = match &node {
            Some(Node {
                value: Value::List(entries),
                ..
            }) if !entries.is_empty() => entries,
            Some(node) => {
                self.wrong_type(name, &node.value, expected());
                return Vec::new();
            }
            None => {
                self.missing(name, expected());
                return Vec::new();
            }
        };
        let mut points = Vec::with_capacity(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            let key = self.entry_key(name, i);
            match &entry.value {
                Value::List(numbers) if numbers.len() == N => {
                    points.push(std::array::from_fn(|k| {
                        self.checked(format!("{key}[{}]", k + 1), &numbers[k], number)
                    }));
                }
                other => {
                    let what = What::WrongType {
                        value: shown(other),
                        expected: format!("a point in {}, {N} numbers", number.unit),
                    };
                    self.problem(entry.at, key, what);
                }
            }
        }
        points
    }
}
