//! Parameters of any type, as a scene writes them.

use fmi2::model_description::{BaseType, Kind, ModelDescription, TypeShape, Variable};
use scene::ParameterValue;

/// A value as the C interface takes it.
#[derive(Clone, Debug, PartialEq)]
pub enum Typed {
    /// `fmi2SetReal`.
    Real(f64),
    /// `fmi2SetInteger`, also for an enumeration.
    Integer(i32),
    /// `fmi2SetBoolean`.
    Boolean(bool),
    /// `fmi2SetString`.
    String(String),
}

/// The value of `variable`: an enumeration by name or number, a Boolean also as 0 or 1.
///
/// # Errors
/// What the value should be.
pub fn typed(description: &ModelDescription, variable: &Variable, value: &ParameterValue) -> Result<Typed, String> {
    let whole = |number: f64| (number.fract() == 0.0 && number.abs() <= f64::from(i32::MAX)).then_some(number as i32);
    if matches!(variable.kind, Kind::Enumeration { .. }) {
        let items = variable
            .declared_type
            .as_deref()
            .and_then(|name| description.types.iter().find(|definition| definition.name == name))
            .and_then(|definition| match &definition.shape {
                TypeShape::Enumeration(items) => Some(items.as_slice()),
                _ => None,
            })
            .unwrap_or(&[]);
        let found = match value {
            ParameterValue::String(name) => items.iter().find(|item| item.name == *name).map(|item| item.value),
            // Values outside the items are not the FMU's to interpret; without items any number may be one.
            ParameterValue::Number(number) => {
                whole(*number).filter(|number| items.is_empty() || items.iter().any(|item| item.value == *number))
            }
            ParameterValue::Boolean(_) => None,
        };
        let names: Vec<String> = items
            .iter()
            .map(|item| format!("\"{}\" ({})", item.name, item.value))
            .collect();
        return found
            .map(Typed::Integer)
            .ok_or_else(|| format!("one of {}", names.join(", ")));
    }
    match (variable.base_type(), value) {
        (BaseType::Real, ParameterValue::Number(number)) => Ok(Typed::Real(*number)),
        (BaseType::Real, _) => Err("a number".to_owned()),
        (BaseType::Integer, ParameterValue::Number(number)) => whole(*number)
            .map(Typed::Integer)
            .ok_or_else(|| "a whole number".to_owned()),
        (BaseType::Integer, _) => Err("a whole number".to_owned()),
        (BaseType::Boolean, ParameterValue::Boolean(flag)) => Ok(Typed::Boolean(*flag)),
        (BaseType::Boolean, ParameterValue::Number(number)) if [0.0, 1.0].contains(number) => {
            Ok(Typed::Boolean(*number == 1.0))
        }
        (BaseType::Boolean, _) => Err("true or false".to_owned()),
        (BaseType::String, ParameterValue::String(text)) => Ok(Typed::String(text.clone())),
        (BaseType::String, _) => Err("a text".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use fmi2::model_description::{EnumerationItem, TypeDefinition};

    use super::*;

    #[test]
    fn enumerations_go_by_name_or_number_and_booleans_by_word_or_number() {
        let mut mode = Variable::integer_parameter("mode", 1, "");
        mode.kind = Kind::Enumeration { start: Some(1) };
        mode.declared_type = Some("Mode".to_owned());
        let flag = Variable::boolean_parameter("flag", false, "");
        let count = Variable::integer_parameter("n", 1, "");
        let mut description = ModelDescription::of_slave("X", vec![mode, flag, count]);
        let item = |name: &str, value| EnumerationItem {
            name: name.to_owned(),
            value,
        };
        description.types.push(TypeDefinition {
            name: "Mode".to_owned(),
            description: None,
            shape: TypeShape::Enumeration(vec![item("raised", 1), item("lowered", 3)]),
        });
        let set =
            |position: usize, value: ParameterValue| typed(&description, &description.variables[position], &value);
        let text = |text: &str| ParameterValue::String(text.to_owned());
        assert_eq!(set(0, text("lowered")), Ok(Typed::Integer(3)));
        assert_eq!(set(0, ParameterValue::Number(1.0)), Ok(Typed::Integer(1)));
        let refused = Err("one of \"raised\" (1), \"lowered\" (3)".to_owned());
        assert_eq!(set(0, ParameterValue::Number(2.0)), refused);
        assert_eq!(set(0, text("up")), refused);
        assert_eq!(set(1, ParameterValue::Number(1.0)), Ok(Typed::Boolean(true)));
        assert!(set(1, ParameterValue::Number(2.0)).is_err());
        assert!(set(2, ParameterValue::Number(2.5)).is_err());
    }
}
