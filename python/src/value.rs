//! Values of a scene as Python has them.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use toml::Value;

/// A value of TOML as one of Python.
///
/// # Errors
/// Exceptions of the interpreter.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    match value {
        Value::String(text) => text.into_bound_py_any(py),
        Value::Integer(number) => number.into_bound_py_any(py),
        Value::Float(number) => number.into_bound_py_any(py),
        Value::Boolean(flag) => flag.into_bound_py_any(py),
        Value::Datetime(datetime) => datetime.to_string().into_bound_py_any(py),
        Value::Array(entries) => {
            let list = PyList::empty(py);
            for entry in entries {
                list.append(to_python(py, entry)?)?;
            }
            Ok(list.into_any())
        }
        Value::Table(table) => {
            let dict = PyDict::new(py);
            for (key, entry) in table {
                dict.set_item(key, to_python(py, entry)?)?;
            }
            Ok(dict.into_any())
        }
    }
}

/// Outcome of a look for a key.
pub enum Found<'a> {
    /// The value.
    Value(&'a Value),
    /// No such key in a table.
    NoKey,
    /// No such entry in a list, or a path that goes on below a plain value.
    NoEntry,
}

/// Looks for a key such as `catenary.span_length`, `pantograph[1].masses[2]` or `pantograph.0.static_force`.
pub fn find<'a>(table: &'a Value, path: &str) -> Found<'a> {
    let mut value = table;
    for step in path.split(['.', '[']).map(str::trim).filter(|step| !step.is_empty()) {
        let next = match (value, step.strip_suffix(']')) {
            (Value::Table(table), None) => match table.get(step.trim_matches(['"', '\''])) {
                Some(next) => Some(next),
                None => return Found::NoKey,
            },
            (Value::Array(list), Some(number)) => {
                let index = number.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
                index.and_then(|index| list.get(index))
            }
            (Value::Array(list), None) => step.parse::<usize>().ok().and_then(|index| list.get(index)),
            _ => None,
        };
        match next {
            Some(next) => value = next,
            None => return Found::NoEntry,
        }
    }
    Found::Value(value)
}

/// Bytes of numbers, little end first.
pub fn bytes(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
