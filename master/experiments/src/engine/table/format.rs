//! Numbers and names as tables and pages show them.

use std::borrow::Borrow;

/// Three significant digits, where there is a number.
pub(crate) fn significant(value: Option<f64>) -> Option<String> {
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
pub(crate) fn or_dash(value: Option<impl ToString>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| value.to_string())
}

/// Three significant digits, or `–`.
pub(crate) fn short(value: Option<f64>) -> String {
    or_dash(significant(value))
}

/// Milliseconds without rounding noise.
pub(crate) fn milliseconds(step: Option<f64>) -> String {
    or_dash(step.map(|step| (1e9 * step).round() / 1e6))
}

/// Names joined by `+`, or the word for none.
pub(crate) fn joined<S: Borrow<str>>(names: &[S], none: &str) -> String {
    if names.is_empty() {
        return none.to_owned();
    }
    names.join("+")
}
