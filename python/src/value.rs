//! Values of a scene as Python has them.

use ::scene::{KeyStep, key_steps};
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
    /// A text that is no path of a key.
    NoPath,
    /// No such key in a table.
    NoKey,
    /// No such entry in a list, or a path that goes on below a plain value.
    NoEntry,
}

/// Looks for a key such as `catenary.span_length`, `pantograph[1].masses[2]` or `pantograph.0.static_force`.
pub fn find<'a>(table: &'a Value, path: &str) -> Found<'a> {
    let Some(steps) = key_steps(path) else {
        return Found::NoPath;
    };
    let mut value = table;
    for step in steps {
        let next = match (value, step) {
            (Value::Table(table), KeyStep::Key(key)) => match table.get(&key) {
                Some(next) => Some(next),
                None => return Found::NoKey,
            },
            (Value::Array(list), KeyStep::Entry(number)) => number.checked_sub(1).and_then(|index| list.get(index)),
            (Value::Array(list), KeyStep::Key(digits)) => {
                digits.parse::<usize>().ok().and_then(|index| list.get(index))
            }
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
