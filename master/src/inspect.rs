//! What `master inspect` says about an FMU.

use std::fmt::Write as _;
use std::path::Path;

use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality, Kind, ModelDescription, Variability, Variable};
use serde_json::{Value, json};

use crate::third_party::guess;

fn causality(variable: &Variable) -> &'static str {
    match variable.causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    }
}

fn variability(variable: &Variable) -> &'static str {
    match variable.variability {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

fn base_type(variable: &Variable) -> &'static str {
    match variable.base_type() {
        BaseType::Real => "Real",
        BaseType::Integer => "Integer",
        BaseType::Boolean => "Boolean",
        BaseType::String => "String",
    }
}

fn start(variable: &Variable) -> Value {
    match &variable.kind {
        Kind::Real { start, .. } => json!(start),
        Kind::Integer { start, .. } | Kind::Enumeration { start } => json!(start),
        Kind::Boolean { start } => json!(start),
        Kind::String { start } => json!(start),
    }
}

fn capabilities(description: &ModelDescription) -> [(&'static str, String); 8] {
    let c = &description.co_simulation;
    [
        (
            "canHandleVariableCommunicationStepSize",
            c.can_handle_variable_communication_step_size.to_string(),
        ),
        ("canInterpolateInputs", c.can_interpolate_inputs.to_string()),
        ("maxOutputDerivativeOrder", c.max_output_derivative_order.to_string()),
        ("canGetAndSetFMUstate", c.can_get_and_set_fmu_state.to_string()),
        ("canSerializeFMUstate", c.can_serialize_fmu_state.to_string()),
        (
            "providesDirectionalDerivative",
            c.provides_directional_derivative.to_string(),
        ),
        (
            "canBeInstantiatedOnlyOncePerProcess",
            c.can_be_instantiated_only_once_per_process.to_string(),
        ),
        ("needsExecutionTool", c.needs_execution_tool.to_string()),
    ]
}

/// The description as JSON.
#[must_use]
pub fn json(description: &ModelDescription) -> Value {
    let variables: Vec<Value> = description
        .variables
        .iter()
        .map(|variable| {
            json!({
                "name": variable.name,
                "value_reference": variable.value_reference,
                "causality": causality(variable),
                "variability": variability(variable),
                "type": base_type(variable),
                "unit": description.real_attributes(variable).and_then(|real| real.unit),
                "start": start(variable),
                "description": variable.description,
            })
        })
        .collect();
    let experiment = description.default_experiment.map(|experiment| {
        json!({
            "start_time": experiment.start_time,
            "stop_time": experiment.stop_time,
            "tolerance": experiment.tolerance,
            "step_size": experiment.step_size,
        })
    });
    let [inputs, outputs] = guess(description);
    let pairs = |pairs: Vec<(String, String)>| -> Value {
        pairs
            .into_iter()
            .map(|(ours, theirs)| (ours, Value::from(theirs)))
            .collect()
    };
    json!({
        "model_name": description.model_name,
        "guid": description.guid,
        "generation_tool": description.generation_tool,
        "capabilities": capabilities(description).into_iter().map(|(name, value)| (name.to_owned(), Value::from(value))).collect::<serde_json::Map<_, _>>(),
        "default_experiment": experiment,
        "variables": variables,
        "wiring": { "inputs": pairs(inputs), "outputs": pairs(outputs) },
    })
}

/// The description as text, with a `[[pantograph]]` table to paste.
#[must_use]
pub fn text(path: &Path, fmu: &Fmu) -> String {
    let mut text = String::new();
    // Writing into a String does not fail.
    let _ = write(path, fmu.description(), &mut text);
    text
}

fn write(path: &Path, description: &ModelDescription, out: &mut String) -> std::fmt::Result {
    writeln!(out, "{}: {}", path.display(), description.model_name)?;
    for (name, value) in [
        ("description", &description.description),
        ("author", &description.author),
        ("version", &description.version),
        ("made with", &description.generation_tool),
    ] {
        if let Some(value) = value {
            writeln!(out, "  {name}: {value}")?;
        }
    }
    writeln!(out, "  guid: {}", description.guid)?;
    if let Some(experiment) = description.default_experiment {
        let number = |value: Option<f64>| value.map_or_else(|| "not given".to_owned(), |value| format!("{value} s"));
        writeln!(
            out,
            "  default experiment: start {}, stop {}, step {}",
            number(experiment.start_time),
            number(experiment.stop_time),
            number(experiment.step_size)
        )?;
    }
    writeln!(out, "\ncapabilities")?;
    for (name, value) in capabilities(description) {
        writeln!(out, "  {name:37} {value}")?;
    }
    for (heading, wanted) in [
        ("inputs", Causality::Input),
        ("outputs", Causality::Output),
        ("parameters", Causality::Parameter),
        ("other variables", Causality::Local),
    ] {
        let chosen: Vec<&Variable> = description
            .variables
            .iter()
            .filter(|variable| {
                variable.causality == wanted
                    || (wanted == Causality::Local
                        && matches!(
                            variable.causality,
                            Causality::CalculatedParameter | Causality::Independent
                        ))
            })
            .collect();
        writeln!(out, "\n{heading}: {}", chosen.len())?;
        let width = chosen
            .iter()
            .map(|variable| variable.name.chars().count())
            .max()
            .unwrap_or(0);
        for variable in chosen {
            let unit = description
                .real_attributes(variable)
                .and_then(|real| real.unit)
                .unwrap_or_default();
            let start = match start(variable) {
                Value::Null => String::new(),
                value => format!("start {value}"),
            };
            let meaning = variable.description.as_deref().unwrap_or_default();
            let line = format!(
                "  {:width$}  {:7} {unit:6} {start:22} {meaning}",
                variable.name,
                base_type(variable)
            );
            writeln!(out, "{}", line.trim_end())?;
        }
    }
    wiring(path, description, out)
}

/// The wiring that would be guessed, as a table to paste.
fn wiring(path: &Path, description: &ModelDescription, out: &mut String) -> std::fmt::Result {
    let [inputs, outputs] = guess(description);
    if inputs.is_empty() && outputs.is_empty() {
        return writeln!(
            out,
            "\nwiring as a pantograph: no variable is recognised; name a force input and a height output in the scene"
        );
    }
    writeln!(
        out,
        "\nwiring as a pantograph, guessed from the names; check signs and units:\n"
    )?;
    writeln!(out, "[[pantograph]]\nfmu = {}", Value::from(path.display().to_string()))?;
    for (table, pairs, missing) in [
        ("inputs", inputs, "force = { variable = \"?\" }"),
        ("outputs", outputs, "height = { variable = \"?\" }"),
    ] {
        let entries: Vec<String> = pairs
            .into_iter()
            .map(|(ours, theirs)| format!("{ours} = {{ variable = {} }}", Value::from(theirs)))
            .collect();
        let entries = if entries.is_empty() {
            missing.to_owned()
        } else {
            entries.join(", ")
        };
        writeln!(out, "{table} = {{ {entries} }}")?;
    }
    Ok(())
}
