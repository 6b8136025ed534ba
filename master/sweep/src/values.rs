//! Values of one key: a list, a range, or a distribution.

use std::fmt;

use scene::Shape;
use statrs::distribution::{ContinuousCDF, Normal};

/// One value of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, in the unit of its key.
    Number(f64),
    /// Anything else, as it is typed behind `--set key=`.
    Word(String),
}

impl Value {
    /// The value as it is typed: a number where the text is one, else a word.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let text = text.trim();
        match number(text) {
            Some(number) => Self::Number(number),
            None => Self::Word(text.to_owned()),
        }
    }

    /// The number; nothing for a word.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Word(_) => None,
        }
    }

    /// Text behind `--set key=`; a whole number has no decimal point, so that keys that count take it too.
    #[must_use]
    pub fn typed(&self) -> String {
        match self {
            Self::Number(number) => shown(*number),
            Self::Word(word) => word.clone(),
        }
    }

    /// Text in a table: that of a word without its quotes.
    #[must_use]
    pub fn shown(&self) -> String {
        let typed = self.typed();
        let inner = typed.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        inner.unwrap_or(&typed).to_owned()
    }
}

/// The shortest text that reads back as this number.
#[must_use]
pub fn shown(number: f64) -> String {
    scene::shown_number(number, "")
}

/// A finite number as it is typed.
fn number(text: &str) -> Option<f64> {
    // What Rust reads beside numbers, such as `inf` and `nan`, is no value of a key.
    let begins = text
        .trim_start_matches(['+', '-'])
        .starts_with(|c: char| c.is_ascii_digit() || c == '.');
    text.parse().ok().filter(|number: &f64| begins && number.is_finite())
}

/// Distribution of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// Numbers by two numbers: bounds, mean and standard deviation, or median of the value and standard deviation of
    /// its natural logarithm, –.
    Of(Shape, [f64; 2]),
    /// One of these, each as likely as the others.
    Choice(Vec<Value>),
}

impl Distribution {
    /// The value below which a share `u` (inside 0 to 1) of all values lies.
    #[must_use]
    pub fn quantile(&self, u: f64) -> Value {
        let normal = || Normal::new(0.0, 1.0).map_or(0.0, |normal| normal.inverse_cdf(u));
        Value::Number(match self {
            Self::Of(Shape::Uniform, [from, to]) => from + u * (to - from),
            Self::Of(Shape::LogUniform, [from, to]) => (from.ln() + u * (to.ln() - from.ln())).exp().clamp(*from, *to),
            Self::Of(Shape::Normal, [mean, std]) => mean + std * normal(),
            Self::Of(Shape::LogNormal, [median, sigma]) => median * (sigma * normal()).exp(),
            Self::Choice(values) => {
                let index = (u * values.len() as f64) as usize;
                return values[index.min(values.len() - 1)].clone();
            }
        })
    }

    /// Shares of all values between which its numbers are varied: all where it has bounds, else from 5 % to 95 %;
    /// nothing for a choice.
    #[must_use]
    pub fn shares(&self) -> Option<[f64; 2]> {
        match self {
            Self::Of(Shape::Uniform | Shape::LogUniform, _) => Some([0.0, 1.0]),
            Self::Of(Shape::Normal | Shape::LogNormal, _) => Some([0.05, 0.95]),
            Self::Choice(_) => None,
        }
    }

    /// Bounds of a distribution that has some, else its values at [`Distribution::shares`].
    #[must_use]
    pub fn ends(&self) -> Option<[f64; 2]> {
        if let Self::Of(Shape::Uniform | Shape::LogUniform, bounds) = self {
            return Some(*bounds);
        }
        let [low, high] = self.shares()?.map(|share| self.quantile(share).number());
        Some([low?, high?])
    }

    /// Values that tell whether a key takes this distribution: bounds where there are any, else the median; all of a
    /// choice.
    #[must_use]
    pub fn tried(&self) -> Vec<Value> {
        match self {
            Self::Of(Shape::Uniform | Shape::LogUniform, ends) => ends.map(Value::Number).to_vec(),
            Self::Of(..) => vec![self.quantile(0.5)],
            Self::Choice(values) => values.clone(),
        }
    }

    /// A distribution by its name and numbers.
    ///
    /// # Errors
    /// Requirements that are not met.
    pub fn named(name: &str, arguments: &[Value]) -> Result<Self, String> {
        const NAMES: &str = "uniform(from, to), log_uniform(from, to), normal(mean, std), lognormal(median, sigma of \
                             the natural logarithm), choice(value, value, …)";
        let plain = |name: &str| name.trim().to_lowercase().replace(['_', '-'], "");
        let name = plain(name);
        if name == "choice" {
            return match arguments {
                [] => Err("must name at least one value".to_owned()),
                values => Ok(Self::Choice(values.to_vec())),
            };
        }
        let shape = Shape::ALL.iter().find(|shape| plain(shape.name()) == name);
        let shape = *shape.ok_or_else(|| format!("must be one of {NAMES}"))?;
        let [Value::Number(a), Value::Number(b)] = *arguments else {
            return Err(format!("must have two numbers, as in {NAMES}"));
        };
        Self::of(shape, [a, b])
    }

    /// A distribution by its two numbers.
    ///
    /// # Errors
    /// Requirements that are not met.
    pub fn of(shape: Shape, [a, b]: [f64; 2]) -> Result<Self, String> {
        let (holds, what) = match shape {
            Shape::Uniform | Shape::LogUniform if a >= b => (false, "must have a lower bound below the upper one"),
            Shape::Uniform => (true, ""),
            Shape::LogUniform => (a > 0.0, "must have bounds above 0"),
            Shape::Normal => (b > 0.0, "must have a standard deviation above 0"),
            Shape::LogNormal => (
                a > 0.0 && b > 0.0,
                "must have a median and a standard deviation above 0",
            ),
        };
        holds.then_some(Self::Of(shape, [a, b])).ok_or_else(|| what.to_owned())
    }
}

impl fmt::Display for Distribution {
    /// The distribution as it is typed.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Of(shape, [first, second]) => write!(f, "{shape}({}, {})", shown(*first), shown(*second)),
            Self::Choice(values) => {
                let values: Vec<String> = values.iter().map(Value::typed).collect();
                write!(f, "choice({})", values.join(", "))
            }
        }
    }
}

/// Values that a key takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// These, in this order.
    Listed(Vec<Value>),
    /// A distribution to be sampled.
    Distributed(Distribution),
}

/// Most values of one range.
const MOST: f64 = 1e7;

impl Values {
    /// Values as typed on the command line: `a:b:step`, `a:b` (uniform), `v1,v2,…` or `distribution(…)`.
    ///
    /// # Errors
    /// Requirements that are not met.
    pub fn typed(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let call = text.strip_suffix(')').and_then(|rest| rest.split_once('('));
        if let Some((name, arguments)) = call
            && name.chars().all(|c| c.is_ascii_alphabetic() || "_-".contains(c))
        {
            let arguments: Vec<Value> = items(arguments)?.into_iter().map(Value::of).collect();
            return Distribution::named(name, &arguments).map(Self::Distributed);
        }
        let parts: Vec<&str> = text.split(':').collect();
        let numbers: Option<Vec<f64>> = parts.iter().map(|part| number(part.trim())).collect();
        match (numbers.as_deref(), parts.len()) {
            (Some([from, to]), _) => Distribution::of(Shape::Uniform, [*from, *to]).map(Self::Distributed),
            (Some([from, to, step]), _) => range(*from, *to, *step).map(Self::Listed),
            (None, 2 | 3) if !text.contains(['"', '\'', '[', '{']) => {
                Err("must be a:b:step with three numbers, such as 200:320:10".to_owned())
            }
            _ => Self::listed(items(text)?.into_iter().map(Value::of).collect()),
        }
    }

    /// A list of values, each once.
    ///
    /// # Errors
    /// An empty list, a value twice.
    pub fn listed(values: Vec<Value>) -> Result<Self, String> {
        if values.is_empty() || values.iter().any(|value| value.typed().is_empty()) {
            return Err("must have at least one value, and none that is empty".to_owned());
        }
        let twice = values
            .iter()
            .enumerate()
            .find(|(index, value)| values[..*index].contains(value));
        match twice {
            Some((_, value)) => Err(format!("must have each value once, and has {} twice", value.typed())),
            None => Ok(Self::Listed(values)),
        }
    }

    /// Values to be tried before the first case.
    #[must_use]
    pub fn tried(&self) -> Vec<Value> {
        match self {
            Self::Listed(values) => values.clone(),
            Self::Distributed(distribution) => distribution.tried(),
        }
    }

    /// Least and largest of listed numbers; all values to be tried where they are no numbers.
    #[must_use]
    pub fn ends(&self) -> Vec<Value> {
        let tried = self.tried();
        let numbers: Option<Vec<f64>> = tried.iter().map(Value::number).collect();
        let Some(numbers) = numbers.filter(|numbers| !numbers.is_empty()) else {
            return tried;
        };
        let ends = [
            numbers.iter().copied().reduce(f64::min),
            numbers.iter().copied().reduce(f64::max),
        ];
        ends.into_iter().flatten().map(Value::Number).collect()
    }

    /// The listed value at a place, from 0; nothing behind the last one and for a distribution.
    #[must_use]
    pub fn listed_at(&self, index: u64) -> Option<Value> {
        match self {
            Self::Listed(values) => values.get(usize::try_from(index).ok()?).cloned(),
            Self::Distributed(_) => None,
        }
    }

    /// `true` where all values are numbers.
    #[must_use]
    pub fn are_numbers(&self) -> bool {
        let numbers = |values: &[Value]| values.iter().all(|value| value.number().is_some());
        match self {
            Self::Listed(values) => numbers(values),
            Self::Distributed(distribution) => numbers(&distribution.tried()),
        }
    }

    /// The value at a share `u` of all values.
    #[must_use]
    pub fn quantile(&self, u: f64) -> Value {
        match self {
            Self::Listed(values) => values[((u * values.len() as f64) as usize).min(values.len() - 1)].clone(),
            Self::Distributed(distribution) => distribution.quantile(u),
        }
    }
}

/// Numbers from `from` to `to`, both included where the step divides the range.
///
/// Each is rounded to twelve significant digits, so that decimal steps give decimal numbers.
///
/// # Errors
/// A step that does not lead from one to the other.
pub fn range(from: f64, to: f64, step: f64) -> Result<Vec<Value>, String> {
    /// Part of a step by which the last value may miss the end.
    const ROUNDING: f64 = 1e-9;
    let steps = (to - from) / step + ROUNDING;
    if step == 0.0 || !steps.is_finite() || steps < 0.0 {
        let way = if to < from { "below 0" } else { "above 0" };
        return Err(format!(
            "must have a step that leads from {} to {}: one {way}",
            shown(from),
            shown(to)
        ));
    }
    if steps >= MOST {
        return Err(format!("must have fewer than {MOST:.0} values"));
    }
    let rounded = |value: f64| format!("{value:.11e}").parse().unwrap_or(value);
    let values = (0..=steps as u64).map(|n| Value::Number(rounded(from + n as f64 * step)));
    Ok(values.collect())
}

/// Parts between commas that stand in no brackets and no quotes.
fn items(text: &str) -> Result<Vec<&str>, String> {
    let (mut parts, mut start, mut depth, mut quote) = (Vec::new(), 0, 0_i32, None);
    for (index, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (Some(_), _) => {}
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth -= 1,
            (None, ',') if depth == 0 => {
                parts.push(text[start..index].trim());
                start = index + 1;
            }
            _ => {}
        }
    }
    if depth != 0 || quote.is_some() {
        return Err("must close every bracket and every quote".to_owned());
    }
    parts.push(text[start..].trim());
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Vec<f64> {
        match Values::typed(text).unwrap() {
            Values::Listed(values) => values.iter().map(|value| value.number().unwrap()).collect(),
            Values::Distributed(_) => panic!("{text} is a distribution"),
        }
    }

    #[test]
    fn a_range_has_both_ends_and_decimal_numbers() {
        assert_eq!(numbers("200:320:10").len(), 13);
        assert_eq!(numbers("0.1:0.5:0.1"), [0.1, 0.2, 0.3, 0.4, 0.5]);
        assert_eq!(numbers("3:1:-1"), [3.0, 2.0, 1.0]);
        assert_eq!(numbers("0:1:0.4"), [0.0, 0.4, 0.8]);
        assert_eq!(numbers("1,2.5,-3e2"), [1.0, 2.5, -300.0]);
    }

    #[test]
    fn values_that_are_wrong_are_refused_with_what_would_be_right() {
        for (text, part) in [
            ("1:2:-1", "step that leads from 1 to 2: one above 0"),
            ("1:2:0", "step"),
            ("2:1", "lower bound below"),
            ("a:b:c", "a:b:step"),
            ("", "at least one value"),
            ("1,,2", "none that is empty"),
            ("1,2,1", "1 twice"),
            ("normal(1)", "two numbers"),
            ("normal(1,-2)", "standard deviation above 0"),
            ("log_uniform(0,2)", "above 0"),
            ("triangular(1,2)", "uniform(from, to)"),
            ("[1,2", "bracket"),
        ] {
            let said = Values::typed(text).unwrap_err();
            assert!(said.contains(part), "{text}: {said}");
        }
    }

    #[test]
    fn words_and_lists_are_values_too() {
        let Values::Listed(values) = Values::typed("[\"planar\", \"linearised\"], none").unwrap() else {
            panic!("not a list");
        };
        assert_eq!(values.len(), 2);
        assert_eq!(values[1].shown(), "none");
        assert_eq!(Value::of("12").typed(), "12");
        assert_eq!(Value::Word("\"jacobi\"".to_owned()).shown(), "jacobi");
    }

    #[test]
    fn quantiles_are_those_of_the_distributions() {
        let at = |text: &str, u: f64| match Values::typed(text).unwrap().quantile(u) {
            Value::Number(number) => number,
            Value::Word(word) => panic!("{word}"),
        };
        assert_eq!(at("uniform(10,20)", 0.25), 12.5);
        // Ten to the power of the middle of 0 and 2, by way of natural logarithms.
        assert!((at("log_uniform(1,100)", 0.5) - 10.0).abs() < 1e-12);
        // Standard normal quantile at 0.975: 1.959963984540054 (tables); the inverse is good to 1e-9.
        assert!((at("normal(100,10)", 0.975) - 119.599_639_845_400_54).abs() < 1e-7);
        assert!((at("lognormal(50,0.5)", 0.5) - 50.0).abs() < 1e-9);
        for text in [
            "uniform(1, 2)",
            "log_uniform(0.1, 2)",
            "normal(100, 10)",
            "lognormal(50, 0.5)",
            "choice(1, 2)",
        ] {
            let Ok(Values::Distributed(distribution)) = Values::typed(text) else {
                panic!("{text} is a distribution");
            };
            assert_eq!(distribution.to_string(), text);
            let ends = distribution.ends();
            match text {
                "choice(1, 2)" => assert_eq!(ends, None),
                // Standard normal quantile at 0.95: 1.6448536269514722 (tables).
                "normal(100, 10)" => {
                    let [low, high] = ends.unwrap();
                    assert!((low - 83.551_463_730_485_28).abs() < 1e-7 && (high - 116.448_536_269_514_72).abs() < 1e-7);
                }
                _ => assert!(ends.is_some_and(|[low, high]| low < high)),
            }
        }
        assert_eq!(at("choice(1,2,3,4)", 0.6), 3.0);
        assert_eq!(at("80:120", 0.5), 100.0);
    }
}
