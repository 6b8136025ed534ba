//! Report of `master inspect` on an FMU: description, abilities found by trial, and guessed wiring.

use std::fmt::Write as _;
use std::path::Path;

use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality, Kind, ModelDescription, Variability, Variable};
use serde_json::{Value, json};

use crate::{Guess, Probe, Request, Side, Wire, Wiring, WiringError, guess, isolation, probe, side, unit};

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

/// Step that is tried where the FMU suggests none, s.
const STEP: f64 = 1e-3;

/// Simulated time that a trial is told where the FMU suggests none, s.
const DURATION: f64 = 10.0;

/// Longest time that one thing tried may take, s.
const PATIENCE: f64 = 10.0;

/// An FMU as a side of the coupling.
pub struct Inspection {
    /// Side that the FMU seems to be.
    pub side: Option<Side>,
    /// The guessed wiring of that side, or of a pantograph.
    pub guesses: [Vec<Guess>; 2],
    /// Wiring with units, or the reason against it.
    pub wiring: Result<Wiring, WiringError>,
    /// Trial of the FMU; nothing without wiring.
    pub probe: Option<Probe>,
}

impl Inspection {
    /// Looks at an FMU and tries it, in another process.
    #[must_use]
    pub fn of(fmu: &Fmu) -> Self {
        let description = fmu.description();
        let side = side(description);
        let guesses = guess(description, side.unwrap_or(Side::Pantograph));
        let strips = guesses[0]
            .iter()
            .filter(|guess| guess.name.ends_with("].z"))
            .count()
            .max(1);
        let mut entry = scene::Supplied {
            step_timeout: PATIENCE,
            ..scene::Supplied::unwired("")
        };
        let wiring = Wiring::resolve(description, &mut entry, side.unwrap_or(Side::Pantograph), strips);
        let experiment = description.default_experiment.unwrap_or_default();
        let probe = wiring.as_ref().ok().map(|wiring| {
            let request = Request {
                wiring: wiring.clone(),
                step: experiment.step_size.filter(|step| *step > 0.0).unwrap_or(STEP),
                duration: experiment.stop_time.filter(|stop| *stop > 0.0).unwrap_or(DURATION),
                parameters: Vec::new(),
                initial: Vec::new(),
                isolation: isolation(&entry),
            };
            probe(fmu, &request)
        });
        Self {
            side,
            guesses,
            wiring,
            probe,
        }
    }

    /// True where a force on the strip moves it the wrong way.
    fn is_turned(&self) -> bool {
        let mass = self.probe.as_ref().and_then(|probe| probe.effective_mass);
        mass.is_some_and(|mass| mass < 0.0)
    }

    /// A table of a scene with this FMU.
    #[must_use]
    pub fn toml(&self, path: &Path) -> Option<String> {
        let wiring = self.wiring.as_ref().ok()?;
        let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let fmu = Value::from(absolute.display().to_string());
        let turned = self.is_turned();
        let start = self.probe.as_ref().and_then(|probe| probe.start_height);
        let connection = |wire: &Wire| {
            let mut text = format!("{{ variable = {}", Value::from(wire.variable.as_str()));
            let force = wire.name == "force" || wire.name == "force_z";
            if force && turned {
                text.push_str(&format!(", factor = {:?}", -wire.factor));
            }
            if wire.name == "height" && start.is_some() {
                text.push_str(", offset = \"align\"");
            }
            text.push_str(" }");
            text
        };
        let crashed = self.probe.as_ref().and_then(|probe| probe.failure.as_ref());
        let warning = crashed.map_or_else(String::new, |failure| format!("# {}\n", failure.replace('\n', " ")));
        let mut text = warning;
        match wiring.side {
            Side::Pantograph => {
                let inline = |wires: &[Wire]| {
                    let entries: Vec<String> = wires
                        .iter()
                        .map(|wire| format!("{} = {}", wire.name, connection(wire)))
                        .collect();
                    entries.join(", ")
                };
                text.push_str(&format!(
                    "[[pantograph]]\nfmu = {fmu}\ninputs = {{ {} }}\noutputs = {{ {} }}\n",
                    inline(&wiring.inputs),
                    inline(&wiring.outputs)
                ));
            }
            Side::Controller => {
                text.push_str(&format!("[[controller]]\nfmu = {fmu}\npantograph = 1\n"));
                for (table, wires) in [("inputs", &wiring.inputs), ("outputs", &wiring.outputs)] {
                    let entries: Vec<String> = wires
                        .iter()
                        .map(|wire| format!("{} = {}", wire.name, connection(wire)))
                        .collect();
                    text.push_str(&format!("{table} = {{ {} }}\n", entries.join(", ")));
                }
            }
            Side::Line => {
                text.push_str(&format!("[catenary]\nfmu = {fmu}\n"));
                for (table, wires) in [("inputs", &wiring.inputs), ("outputs", &wiring.outputs)] {
                    text.push_str(&format!("\n[catenary.{table}]\n"));
                    for wire in wires {
                        let name = Value::from(wire.name.as_str());
                        text.push_str(&format!("{name} = {}\n", connection(wire)));
                    }
                }
            }
        }
        Some(text)
    }
}

/// The description and what was found as JSON.
#[must_use]
pub fn json(path: &Path, description: &ModelDescription, inspection: &Inspection) -> Value {
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
                "dependencies": dependencies(description, variable),
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
    let [inputs, outputs] = &inspection.guesses;
    let pairs = |guesses: &[Guess]| -> Value {
        let pair = |guess: &Guess| (guess.name.clone(), Value::from(guess.variable.as_str()));
        guesses.iter().map(pair).collect()
    };
    let guesses: Vec<&Guess> = inputs.iter().chain(outputs).collect();
    let capabilities = capabilities(description).into_iter();
    let capabilities: Value = capabilities
        .map(|(name, value)| (name.to_owned(), Value::from(value)))
        .collect();
    json!({
        "model_name": description.model_name,
        "guid": description.guid,
        "generation_tool": description.generation_tool,
        "capabilities": capabilities,
        "default_experiment": experiment,
        "variables": variables,
        "side": inspection.side,
        "wiring": { "inputs": pairs(inputs), "outputs": pairs(outputs) },
        "guesses": guesses,
        "maps": inspection.wiring.as_ref().map_or_else(
            |refusal| json!({ "refused": refusal.to_string() }),
            |wiring| wiring.lines().map(Value::from).collect(),
        ),
        "probe": inspection.probe,
        "toml": inspection.toml(path),
    })
}

/// Names of what an output depends on; `None` where the FMU does not say.
fn dependencies<'a>(description: &'a ModelDescription, variable: &Variable) -> Option<Vec<&'a str>> {
    let positions = variable.dependencies.as_ref()?;
    Some(
        positions
            .iter()
            .filter_map(|position| Some(description.variables.get(*position)?.name.as_str()))
            .collect(),
    )
}

/// The description and what was found as text, with a table to paste.
#[must_use]
pub fn text(path: &Path, fmu: &Fmu, inspection: &Inspection) -> String {
    let mut text = String::new();
    // Writing into a String does not fail.
    let _ = write(path, fmu.description(), inspection, &mut text);
    text
}

fn write(path: &Path, description: &ModelDescription, inspection: &Inspection, out: &mut String) -> std::fmt::Result {
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
    tried(inspection, out)?;
    wiring(path, inspection, out)
}

/// Trials, claim by claim.
fn tried(inspection: &Inspection, out: &mut String) -> std::fmt::Result {
    let Some(probe) = &inspection.probe else {
        return writeln!(out, "\ntried: nothing, as there is no wiring to drive it by");
    };
    writeln!(out, "\ntried, in processes of its own")?;
    writeln!(out, "  {:39} {:8} {:14} how", "", "claimed", "found")?;
    for finding in &probe.findings {
        writeln!(
            out,
            "  {:39} {:8} {:14} {}",
            finding.subject, finding.claimed, finding.found, finding.how
        )?;
    }
    if let Some(failure) = &probe.failure {
        writeln!(out, "  {failure}")?;
    }
    Ok(())
}

/// The wiring that would be guessed, as a table to paste.
fn wiring(path: &Path, inspection: &Inspection, out: &mut String) -> std::fmt::Result {
    let seen_as = match inspection.side {
        Some(Side::Line) => "a line",
        Some(Side::Controller) => "a controller",
        _ => "a pantograph",
    };
    let [inputs, outputs] = &inspection.guesses;
    writeln!(out, "\nwiring as {seen_as}")?;
    for guess in inputs.iter().chain(outputs) {
        writeln!(out, "  {} is {}: by {}", guess.name, guess.variable, guess.because)?;
    }
    match (&inspection.wiring, inspection.toml(path)) {
        (Ok(wiring), Some(toml)) => {
            for line in wiring.lines() {
                writeln!(out, "  {line}")?;
            }
            if inspection.is_turned() {
                writeln!(out, "  more force pushes the strip up: its sign is turned below")?;
            }
            if toml.contains("align") {
                writeln!(
                    out,
                    "  the strip starts at its own height, not at that of a wire: the table below puts it under the \
                        wire, so that no rest \
                     position costs static force"
                )?;
            }
            writeln!(out, "\n{toml}")
        }
        (Err(refusal), _) => {
            writeln!(out, "  {refusal}")?;
            let needed = match inspection.side {
                Some(Side::Line) => ["strip[1].z", "contact[1].force"],
                Some(Side::Controller) => ["force", "command"],
                _ => ["force", "height"],
            };
            let side = inspection.side.unwrap_or(Side::Pantograph);
            let units = needed.map(|name| format!("{name} [{}]", unit(side, name).unwrap_or("1")));
            writeln!(out, "  a scene must name the variables of {}", units.join(" and "))
        }
        (Ok(_), None) => Ok(()),
    }
}
