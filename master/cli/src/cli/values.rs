//! Values of options, from text.

use experiments::engine::table::AUTO;
use experiments::study::Sweep;
use scene::{Division, MAX_SPANS, Reduction};

/// A whole number from one to `most`.
fn count(text: &str, most: usize) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(count) if (1..=most).contains(&count) => Ok(count),
        _ => Err(format!("must be a whole number from 1 to {most}")),
    }
}

/// A whole number from zero.
pub(crate) fn whole(text: &str) -> Result<u64, String> {
    let found = text.trim().parse();
    found.map_err(|_| format!("must be a whole number from 0 to {}", u64::MAX))
}

/// Elements of a dropper interval.
pub(crate) fn elements(text: &str) -> Result<usize, String> {
    count(text, Division::MOST)
}

/// Spans of a line.
pub(crate) fn spans(text: &str) -> Result<usize, String> {
    count(text, MAX_SPANS)
}

/// A set of reductions as typed.
pub(crate) fn reductions(text: &str) -> Result<String, String> {
    let known = || Reduction::ALL.iter().map(|reduction| reduction.name());
    let names: Vec<&str> = text.split('+').map(str::trim).collect();
    let alone = names.len() == 1 && ["none", AUTO].contains(&names[0]);
    let once = |(index, name): (usize, &&str)| known().any(|known| known == *name) && !names[..index].contains(name);
    if alone || names.iter().enumerate().all(once) {
        return Ok(names.join("+"));
    }
    let known: Vec<&str> = known().collect();
    Err(format!(
        "must be none, {AUTO}, or one or more of {} joined by +, each once",
        known.join(", ")
    ))
}

/// A sweep of a study by its name.
pub(crate) fn sweep(text: &str) -> Result<Sweep, String> {
    let found = Sweep::CHOICE.iter().find(|sweep| sweep.name() == text.trim());
    let names = || Sweep::CHOICE.iter().map(|sweep| sweep.name()).collect::<Vec<_>>();
    found
        .copied()
        .ok_or_else(|| format!("must be one of {}", names().join(", ")))
}

/// A number above zero.
pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("must be a number above 0".to_owned()),
    }
}

/// A spectral radius, –.
pub(crate) fn spectral_radius(text: &str) -> Result<f64, String> {
    match text.trim().parse() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("must be a number from 0 to 1".to_owned()),
    }
}

/// The values typed, or the default without any.
pub(crate) fn or<T: Clone>(typed: &[T], default: &[T]) -> Vec<T> {
    if typed.is_empty() { default } else { typed }.to_vec()
}

/// Reads a step as typed: a number in ms, or with a unit (`s`, `ms`, `us`, `µs`); s.
pub(crate) fn step(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let mut units = [("ms", "e-3"), ("us", "e-6"), ("µs", "e-6"), ("s", "")].into_iter();
    let found = units.find_map(|(unit, power)| Some((text.strip_suffix(unit)?.trim(), power)));
    let (number, power) = found.unwrap_or((text, "e-3"));
    // Read as one decimal number: 0.1 ms is the same as 1e-4 s, to the last bit.
    let step = match number.parse::<f64>() {
        Ok(plain) if number.contains(['e', 'E']) => plain * format!("1{power}").parse::<f64>().unwrap_or(f64::NAN),
        Ok(_) => format!("{number}{power}").parse::<f64>().unwrap_or(f64::NAN),
        Err(_) => f64::NAN,
    };
    if step > 0.0 && step.is_finite() {
        Ok(step)
    } else {
        Err("must be a positive number in ms, or with a unit: 0.5, 0.5ms, 500us, 5e-4s".to_owned())
    }
}
