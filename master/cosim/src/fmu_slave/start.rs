//! Variables of a role, found in the description of an FMU, and an instance started for the role.

use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality, ModelDescription, Variable};
use scene::ParameterValue;

use super::{CosimulationError, Role};
use crate::parameter::{Typed, typed};
use fmi2::instance::{self, FmuInstance};

/// Finds a variable by name among those with the right type and causality.
pub(super) fn find<'a>(
    description: &'a ModelDescription,
    name: &str,
    role: &'static str,
    fits: impl Fn(&Variable) -> bool,
) -> Result<&'a Variable, CosimulationError> {
    let candidates = || description.variables.iter().filter(|variable| fits(variable));
    candidates().find(|variable| variable.name == name).ok_or_else(|| {
        let near = candidates()
            .map(|variable| (strsim::jaro_winkler(&variable.name, name), &variable.name))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        CosimulationError::NoVariable {
            fmu: description.model_name.clone(),
            role,
            variable: name.to_owned(),
            nearest: match near {
                Some((likeness, name)) if likeness > 0.7 => format!(", did you mean \"{name}\"?"),
                _ => String::new(),
            },
        }
    })
}

/// Value references of real inputs or outputs.
pub(super) fn references(
    description: &ModelDescription,
    names: &[String],
    causality: Causality,
) -> Result<Vec<u32>, CosimulationError> {
    let role = if causality == Causality::Input {
        "real input"
    } else {
        "real output"
    };
    let fits = |variable: &Variable| {
        variable.base_type() == BaseType::Real
            && (variable.causality == causality
                || (causality == Causality::Output && variable.causality == Causality::Local))
    };
    names
        .iter()
        .map(|name| find(description, name, role, fits).map(|variable| variable.value_reference))
        .collect()
}

/// Refuses a role whose variables or parameters do not exist or have other types; nothing is executed.
///
/// # Errors
/// [`CosimulationError::NoVariable`], [`CosimulationError::WrongType`].
pub fn check_names(description: &ModelDescription, role: &Role) -> Result<(), CosimulationError> {
    references(description, &role.inputs, Causality::Input)?;
    references(description, &role.outputs, Causality::Output)?;
    for (name, value) in &role.parameters {
        parameter(description, name, value)?;
    }
    Ok(())
}

/// Reference and value of a parameter.
fn parameter(
    description: &ModelDescription,
    name: &str,
    value: &ParameterValue,
) -> Result<(u32, Typed), CosimulationError> {
    let fits = |variable: &Variable| {
        matches!(
            variable.causality,
            Causality::Parameter | Causality::Input | Causality::Local
        )
    };
    let variable = find(description, name, "parameter", fits)?;
    let wrong = |expected| {
        let (fmu, variable) = (description.model_name.clone(), name.to_owned());
        CosimulationError::WrongType {
            fmu,
            variable,
            value: value.clone(),
            expected,
        }
    };
    let value = typed(description, variable, value).map_err(wrong)?;
    Ok((variable.value_reference, value))
}

/// Sets a parameter of any type.
fn set_parameter(
    instance: &mut dyn FmuInstance,
    description: &ModelDescription,
    name: &str,
    value: &ParameterValue,
) -> Result<(), CosimulationError> {
    let (reference, value) = parameter(description, name, value)?;
    let reference = [reference];
    match value {
        Typed::Real(value) => instance.set_real(&reference, &[value])?,
        Typed::Integer(value) => instance.set_integer(&reference, &[value])?,
        Typed::Boolean(value) => instance.set_boolean(&reference, &[value])?,
        Typed::String(text) => instance.set_string(&reference, &[&text])?,
    }
    Ok(())
}

/// An instance at t = 0; `stop` is the stop time that it is told, s.
pub(super) fn initialised(
    fmu: &Fmu,
    role: &Role,
    inputs: &[u32],
    stop: Option<f64>,
) -> Result<Box<dyn FmuInstance>, CosimulationError> {
    let mut instance = instance::instantiate(fmu, &role.name, role.logging, role.isolation.as_ref())?;
    for (name, value) in &role.parameters {
        set_parameter(&mut *instance, fmu.description(), name, value)?;
    }
    instance.setup_experiment(0.0, stop, None)?;
    instance.enter_initialization_mode()?;
    if !role.initial.is_empty() {
        instance.set_real(inputs, &role.initial)?;
    }
    instance.exit_initialization_mode()?;
    Ok(instance)
}
