//! Expressions of keys: derived values and constraints.
//!
//! A key is written as for `--set`: `0.95 * line_length / (run.speed_kmh / 3.6)`. Comparisons give 1 or 0, and not a
//! number where one side is no finite number; `&&` and `||` then go by the other side where that decides. Parsing and
//! evaluation are those of the crate exmex, with operators of this module; a sign binds tighter than `^`.

use exmex::{BinOp, Express, FlatEx, MakeOperators, MatchLiteral, Operator, literal_matcher_from_pattern, ops_factory};

literal_matcher_from_pattern!(Numbers, r"^([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?");

/// A binary operator; higher ranks bind tighter.
fn binary(name: &'static str, prio: i64, apply: fn(f64, f64) -> f64) -> Operator<'static, f64> {
    let is_commutative = false;
    Operator::make_bin(
        name,
        BinOp {
            apply,
            prio,
            is_commutative,
        },
    )
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// A comparison of finite numbers; not a number where one is not finite.
fn compared(a: f64, b: f64, holds: bool) -> f64 {
    if a.is_finite() && b.is_finite() {
        truth(holds)
    } else {
        f64::NAN
    }
}

/// Two truths joined: `deciding` where one side has this truth, else not a number where one side is none.
fn joined(a: f64, b: f64, deciding: bool) -> f64 {
    let decides = |side: f64| !side.is_nan() && (side != 0.0) == deciding;
    match decides(a) || decides(b) {
        true => truth(deciding),
        false if a.is_nan() || b.is_nan() => f64::NAN,
        false => truth(!deciding),
    }
}

ops_factory!(
    Operators,
    f64,
    binary("||", 0, |a, b| joined(a, b, true)),
    binary("&&", 1, |a, b| joined(a, b, false)),
    binary("==", 2, |a, b| compared(a, b, a == b)),
    binary("!=", 2, |a, b| compared(a, b, a != b)),
    binary("<", 2, |a, b| compared(a, b, a < b)),
    binary("<=", 2, |a, b| compared(a, b, a <= b)),
    binary(">", 2, |a, b| compared(a, b, a > b)),
    binary(">=", 2, |a, b| compared(a, b, a >= b)),
    Operator::make_bin_unary(
        "+",
        BinOp {
            apply: |a, b| a + b,
            prio: 3,
            is_commutative: true
        },
        |a| a
    ),
    Operator::make_bin_unary(
        "-",
        BinOp {
            apply: |a, b| a - b,
            prio: 4,
            is_commutative: false
        },
        |a: f64| -a
    ),
    Operator::make_bin(
        "*",
        BinOp {
            apply: |a, b| a * b,
            prio: 5,
            is_commutative: true
        }
    ),
    binary("/", 6, |a, b| a / b),
    binary("%", 6, |a, b| a % b),
    binary("^", 7, f64::powf),
    binary("min", 8, f64::min),
    binary("max", 8, f64::max),
    Operator::make_unary("not", |a: f64| if a.is_nan() { a } else { truth(a == 0.0) }),
    Operator::make_unary("abs", f64::abs),
    Operator::make_unary("sqrt", f64::sqrt),
    Operator::make_unary("exp", f64::exp),
    Operator::make_unary("ln", f64::ln),
    Operator::make_unary("log10", f64::log10),
    Operator::make_unary("sin", f64::sin),
    Operator::make_unary("cos", f64::cos),
    Operator::make_unary("tan", f64::tan),
    Operator::make_unary("floor", f64::floor),
    Operator::make_unary("ceil", f64::ceil),
    Operator::make_unary("round", f64::round),
    Operator::make_constant("pi", std::f64::consts::PI)
);

/// Words of expressions that are no keys.
const WORDS: [&str; 15] = [
    "min", "max", "not", "abs", "sqrt", "exp", "ln", "log10", "sin", "cos", "tan", "floor", "ceil", "round", "pi",
];

/// An expression of named numbers.
#[derive(Clone, Debug)]
pub struct Expression {
    /// As typed.
    pub text: String,
    /// Names in it, each once, in the order of their first appearance.
    pub names: Vec<String>,
    tree: FlatEx<f64, Operators, Numbers>,
}

impl Expression {
    /// Parses an expression.
    ///
    /// # Errors
    /// The mistake, and what an expression may have.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = |what: &str| {
            let words = WORDS.join(", ");
            format!(
                "{what}; must be an expression of keys and numbers with + - * / % ^ < <= > >= == != && || ( ) and \
                 {words}"
            )
        };
        let (renamed, names) = renamed(text);
        if renamed.trim().is_empty() {
            return Err(wrong("is empty"));
        }
        let tree = FlatEx::parse(&renamed).map_err(|error| wrong(&error.to_string()))?;
        let expression = Self {
            text: text.to_owned(),
            names,
            tree,
        };
        // Operators without operands are found by the first evaluation only.
        expression
            .value(&vec![1.0; expression.names.len()])
            .map_err(|error| wrong(&error))?;
        Ok(expression)
    }

    /// The value for these values of [`names`](Self::names).
    ///
    /// # Errors
    /// Reports of the crate.
    pub fn value(&self, values: &[f64]) -> Result<f64, String> {
        // The crate takes values in the order of spelling, which is that of the numbers in the new names.
        self.tree.eval(values).map_err(|error| error.to_string())
    }
}

/// `true` for one comparison, or several joined by `&&`, `||` and `not()`; the text is an expression.
#[must_use]
pub fn is_condition(text: &str) -> bool {
    let text = text.trim();
    if let Some(inner) = bracketed(text).or_else(|| text.strip_prefix("not").and_then(bracketed)) {
        return is_condition(inner);
    }
    for word in ["||", "&&"] {
        let parts = parts(text, |rest| rest.starts_with(word).then_some(word.len()));
        if parts.len() > 1 {
            return parts.into_iter().all(is_condition);
        }
    }
    let comparison = |rest: &str| {
        let words = ["==", "!=", "<=", ">=", "<", ">"];
        words
            .iter()
            .find(|word| rest.starts_with(**word))
            .map(|word| word.len())
    };
    parts(text, comparison).len() == 2
}

/// The text inside a pair of brackets around the whole of it.
fn bracketed(text: &str) -> Option<&str> {
    let text = text.trim();
    let inner = text.strip_prefix('(')?.strip_suffix(')')?;
    let mut depth = 0_i32;
    let is_one_pair = inner.chars().all(|c| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        depth >= 0
    });
    is_one_pair.then_some(inner)
}

/// Parts of a text between words outside brackets; `word` gives the length of a word at the beginning of a text.
fn parts(text: &str, word: impl Fn(&str) -> Option<usize>) -> Vec<&str> {
    let (mut parts, mut start, mut at, mut depth) = (Vec::new(), 0, 0, 0_i32);
    while let Some(c) = text[at..].chars().next() {
        depth += i32::from("([".contains(c)) - i32::from(")]".contains(c));
        match word(&text[at..]).filter(|_| depth == 0) {
            Some(length) => {
                parts.push(&text[start..at]);
                at += length;
                start = at;
            }
            None => at += c.len_utf8(),
        }
    }
    parts.push(&text[start..]);
    parts
}

/// The text with `v0000`, `v0001`, … in place of keys, and the keys.
fn renamed(text: &str) -> (String, Vec<String>) {
    let (mut out, mut names) = (String::new(), Vec::<String>::new());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = match first {
            c if c.is_ascii_digit() || c == '.' => Numbers::is_literal(rest).map_or(1, str::len),
            c if c.is_alphabetic() || c == '_' => key_end(rest),
            c => c.len_utf8(),
        };
        let (word, behind) = rest.split_at(end);
        rest = behind;
        if !(first.is_alphabetic() || first == '_') || WORDS.contains(&word) {
            out.push_str(word);
            continue;
        }
        let index = names.iter().position(|name| name == word).unwrap_or_else(|| {
            names.push(word.to_owned());
            names.len() - 1
        });
        out.push_str(&format!("v{index:04}"));
    }
    (out, names)
}

/// Length of the key path at the beginning of a text.
fn key_end(text: &str) -> usize {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let mut end = 0;
    loop {
        end += text[end..].find(|c| !word(c)).unwrap_or(text.len() - end);
        let rest = &text[end..];
        if rest.starts_with('[') {
            let Some(close) = rest.find(']') else { return end };
            end += close + 1;
            if text[end..].starts_with(['.', '[']) {
                end += usize::from(text[end..].starts_with('.'));
                continue;
            }
            return end;
        }
        match rest.strip_prefix('.') {
            Some(more) if more.starts_with(word) => end += 1,
            _ => return end,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, of: &[(&str, f64)]) -> f64 {
        let expression = Expression::parse(text).unwrap();
        let value = |name: &String| of.iter().find(|(known, _)| known == name).unwrap().1;
        let values: Vec<f64> = expression.names.iter().map(value).collect();
        expression.value(&values).unwrap()
    }

    #[test]
    fn keys_are_names_as_they_are_for_set() {
        let text = "0.5 * (run.speed_kmh / 3.6) + pantograph[2].offset_x - pantograph[1].masses[2] + x";
        let expression = Expression::parse(text).unwrap();
        let names = [
            "run.speed_kmh",
            "pantograph[2].offset_x",
            "pantograph[1].masses[2]",
            "x",
        ];
        assert_eq!(expression.names, names);
        assert_eq!(expression.value(&[36.0, 7.0, 2.0, 1.0]).unwrap(), 11.0);
        assert_eq!(value("b - a", &[("a", 1.0), ("b", 5.0)]), 4.0);
    }

    #[test]
    fn operators_bind_as_in_mathematics() {
        for (text, expected) in [
            ("2 + 3 * 4", 14.0),
            ("10 - 4 - 3", 3.0),
            ("10 - 4 + 3", 9.0),
            ("24 / 4 / 2", 3.0),
            ("24 / 4 * 2", 12.0),
            ("3 * 8 / 4", 6.0),
            ("2 * 3 ^ 2", 18.0),
            ("min(4, 3) * 2 + max(1, 2)", 8.0),
            ("1e-3 * 1E3 + .5 + 2.", 3.5),
            ("1 < 2 && 3 >= 3 + 0", 1.0),
            ("1 == 2 || not(2 != 3)", 0.0),
            ("1 + 1 < 3", 1.0),
            ("sqrt(16) - -1", 5.0),
            ("7 % 4", 3.0),
        ] {
            assert_eq!(value(text, &[]), expected, "{text}");
        }
        assert_eq!(value("cos(pi)", &[]), -1.0);
    }

    #[test]
    fn a_comparison_without_finite_numbers_is_neither_true_nor_false() {
        for text in [
            "1/0 > 3",
            "sqrt(-1) != 2",
            "not(1/0 > 3)",
            "1/0 > 3 && 1 < 2",
            "1/0 > 3 || 1 > 2",
        ] {
            assert!(value(text, &[]).is_nan(), "{text}");
        }
        // The other side decides, so that it may keep a comparison from where it makes no sense.
        assert_eq!(value("1 > 2 && sqrt(-1) > 0", &[]), 0.0);
        assert_eq!(value("1/0 > 3 || 1 < 2", &[]), 1.0);
    }

    #[test]
    fn a_condition_is_made_of_comparisons() {
        for text in [
            "a > 3",
            "(a.b[1] + 1) * 2 <= max(b, 3)",
            "not(a == 1 && b > 2)",
            "((a < 1) || not (b != 2)) && c >= 1",
            "(a > 1) + (b > 1) == 1",
        ] {
            assert!(is_condition(text) && Expression::parse(text).is_ok(), "{text}");
        }
        for text in [
            "a + 1",
            "1",
            "not(a)",
            "a > 1 && b",
            "1 < a < 3",
            "(a > 1) + 1",
            "max(a > 1, b)",
        ] {
            assert!(!is_condition(text) && Expression::parse(text).is_ok(), "{text}");
        }
    }

    #[test]
    fn what_is_no_expression_is_refused() {
        for text in ["", "1 +", "(1", "1 2", "a b", "* 2", "$"] {
            let said = Expression::parse(text).unwrap_err();
            assert!(said.contains("must be an expression of keys"), "{text}: {said}");
        }
    }
}
