//! Numbers and remarks as tables and pages show them.

use std::fmt::Display;

/// Three significant digits, where there is a number.
pub fn significant(value: Option<f64>) -> Option<String> {
    let value = value.filter(|value| value.is_finite())?;
    Some(match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => {
            let digits = (2 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.1e}"),
    })
}

/// A value as text, or `–`.
pub fn or_dash(value: Option<impl ToString>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| value.to_string())
}

/// Three significant digits, or `–`.
pub fn short(value: Option<f64>) -> String {
    or_dash(significant(value))
}

/// A large number by its three leading digits, without a power of ten, or `–`.
pub fn round_count(value: Option<f64>) -> String {
    or_dash(value.filter(|value| value.is_finite()).map(|value| {
        let unit = 10.0_f64.powf((value.abs().max(1.0).log10().floor() - 2.0).max(0.0));
        format!("{}", (value / unit).round() * unit)
    }))
}

/// Milliseconds without rounding noise.
pub fn milliseconds(step: Option<f64>) -> String {
    or_dash(step.map(|step| (1e9 * step).round() / 1e6))
}

/// A number with its noun.
#[must_use]
pub fn counted<T: Display + PartialEq + From<u8>>(count: T, one: &str, many: &str) -> String {
    let noun = if count == T::from(1) { one } else { many };
    format!("{count} {noun}")
}

/// A number with its unit; alone where the unit is `–`, which reads as a minus behind a number.
pub fn in_unit(number: &str, unit: &str) -> String {
    match unit {
        "" | "–" => number.to_owned(),
        _ => format!("{number} {unit}"),
    }
}

/// So many decimals, or `–`.
pub fn decimals(value: Option<f64>, digits: usize) -> String {
    or_dash(value.map(|value| format!("{value:.digits$}")))
}

/// Three significant digits, or nothing.
pub fn number(value: Option<f64>) -> String {
    significant(value).unwrap_or_default()
}

/// So many decimals, or nothing.
pub fn fixed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(String::new, |value| format!("{value:.digits$}"))
}

/// A count, or nothing.
pub fn count(value: Option<u64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// A step in ms, or nothing.
pub fn step(value: Option<f64>) -> String {
    value.map_or_else(String::new, |step| milliseconds(Some(step)))
}

/// A remark in lines of at most 116 characters, indented.
pub fn wrapped(remark: &str) -> String {
    let (mut text, mut line) = (String::new(), String::from(" "));
    for word in remark.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > 116 {
            text.push_str(&line);
            text.push('\n');
            line = String::from("   ");
        }
        line.push(' ');
        line.push_str(word);
    }
    text.push_str(&line);
    text.push('\n');
    text
}
