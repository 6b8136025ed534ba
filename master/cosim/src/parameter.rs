//! Parameters of any type, as a scene writes them.

use fmi2::model_description::{BaseType, EnumerationItem, Kind, ModelDescription, TypeShape, Variable};
use scene::ParameterValue;

/// A value as the C interface takes it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Typed {
    /// `fmi2SetReal`.
    Real(f64),
    /// `fmi2SetInteger`, also for an enumeration.
    Integer(i32),
    /// `fmi2SetBoolean`.
    Boolean(bool),
    /// `fmi2SetString`.
    String(String),
}

/// Value that a variable takes in place of a refused one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExpectedValue {
    /// Real variable.
    #[error("a number")]
    Number,
    /// Integer variable.
    #[error("a whole number")]
    WholeNumber,
    /// Boolean variable.
    #[error("true or false")]
    Boolean,
    /// String variable.
    #[error("a text")]
    Text,
    /// Enumeration.
    #[error("one of {}", listed(.0))]
    Item(Vec<EnumerationItem>),
}

fn listed(items: &[EnumerationItem]) -> String {
    let names = items.iter().map(|item| format!("\"{}\" ({})", item.name, item.value));
    names.collect::<Vec<_>>().join(", ")
}

/// The value of `variable`: an enumeration by name or number, a Boolean also as 0 or 1.
///
/// # Errors
/// [`ExpectedValue`] where the variable does not take the value.
pub(crate) fn typed(
    description: &ModelDescription,
    variable: &Variable,
    value: &ParameterValue,
) -> Result<Typed, ExpectedValue> {
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
        return found
            .map(Typed::Integer)
            .ok_or_else(|| ExpectedValue::Item(items.to_vec()));
    }
    match (variable.base_type(), value) {
        (BaseType::Real, ParameterValue::Number(number)) => Ok(Typed::Real(*number)),
        (BaseType::Real, _) => Err(ExpectedValue::Number),
        (BaseType::Integer, ParameterValue::Number(number)) => {
            whole(*number).map(Typed::Integer).ok_or(ExpectedValue::WholeNumber)
        }
        (BaseType::Integer, _) => Err(ExpectedValue::WholeNumber),
        (BaseType::Boolean, ParameterValue::Boolean(flag)) => Ok(Typed::Boolean(*flag)),
        (BaseType::Boolean, ParameterValue::Number(number)) if [0.0, 1.0].contains(number) => {
            Ok(Typed::Boolean(*number == 1.0))
        }
        (BaseType::Boolean, _) => Err(ExpectedValue::Boolean),
        (BaseType::String, ParameterValue::String(text)) => Ok(Typed::String(text.clone())),
        (BaseType::String, _) => Err(ExpectedValue::Text),
    }
}

#[cfg(test)]
mod tests {
    use fmi2::model_description::TypeDefinition;

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
        let refused = "one of \"raised\" (1), \"lowered\" (3)";
        assert_eq!(set(0, ParameterValue::Number(2.0)).unwrap_err().to_string(), refused);
        assert_eq!(set(0, text("up")).unwrap_err().to_string(), refused);
        assert_eq!(set(1, ParameterValue::Number(1.0)), Ok(Typed::Boolean(true)));
        assert!(set(1, ParameterValue::Number(2.0)).is_err());
        assert!(set(2, ParameterValue::Number(2.5)).is_err());
    }
}
