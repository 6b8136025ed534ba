//! Signals and parameters of a component as the variables of an FMU.
use component::{Causality, Component, Signal, SignalKind};
use fmi2::model_description::{DefaultExperiment, ModelDescription, Variable};
use scene::Scene;

/// Name of the text parameter with the path of another scene.
const SCENE_PARAMETER: &str = "scene";

/// Names and descriptions of the counts of the solver's work.
pub const WORK: [(&str, &str); 4] = [
    ("solver.micro_steps", "Internal time steps done so far"),
    ("solver.newton_iterations", "Newton iterations done so far"),
    (
        "solver.factorizations",
        "Factorisations of an iteration matrix done so far",
    ),
    (
        "solver.steps_above_tolerance",
        "Internal time steps so far that ended above solver.newton_tolerance, as solver.fixed_work fixes their \
         corrections",
    ),
];

/// The variables of a component for a scene: signals first, then parameters, the path of another scene, counts of work.
pub(crate) fn variables<C: Component>(scene: &Scene) -> Vec<Variable> {
    let signals = C::signals(scene);
    let mut variables: Vec<Variable> = signals.iter().map(variable).collect();
    variables.extend(
        C::parameters(scene)
            .iter()
            .map(|p| Variable::parameter(&p.name, p.unit, p.value(scene), &p.description)),
    );
    variables.push(Variable::string_parameter(
        SCENE_PARAMETER,
        "",
        "Absolute path of a scene that replaces the packaged one; it must have as many strips and supports",
    ));
    variables.extend(
        WORK.iter()
            .map(|(name, text)| Variable::integer_output(name, text).depends_on(&[])),
    );
    variables
}

fn variable(signal: &Signal) -> Variable {
    let (name, text) = (signal.name.as_str(), signal.description.as_str());
    match (signal.causality, signal.kind) {
        (Causality::Input, SignalKind::Real(unit)) => Variable::input(name, unit, signal.start, text),
        (Causality::Output, SignalKind::Real(unit)) => {
            Variable::output(name, unit, text).depends_on(&signal.feedthrough)
        }
        (Causality::Output, SignalKind::Integer) => {
            Variable::integer_output(name, text).depends_on(&signal.feedthrough)
        }
        (Causality::Output, SignalKind::Boolean) => {
            Variable::boolean_output(name, text).depends_on(&signal.feedthrough)
        }
        (Causality::Parameter, SignalKind::Boolean) => Variable::boolean_parameter(name, signal.start != 0.0, text),
        (causality, kind) => unreachable!("no component has a {kind:?} {causality:?}: {name}"),
    }
}

/// The model description of the FMU of a component for a scene, with a placeholder for the GUID.
#[must_use]
pub fn description<C: Component>(scene: &Scene) -> ModelDescription {
    let mut description = ModelDescription::of_slave(C::IDENTIFIER, variables::<C>(scene));
    description.description = Some(format!("{} {}", C::DESCRIPTION, scene.title));
    description.version = Some(env!("CARGO_PKG_VERSION").into());
    description.generation_tool = Some(format!("Pantoline master {}", env!("CARGO_PKG_VERSION")));
    description.default_experiment = Some(DefaultExperiment {
        start_time: Some(0.0),
        stop_time: Some(scene.run.duration),
        tolerance: None,
        step_size: Some(scene.coupling.macro_step),
    });
    description
}
