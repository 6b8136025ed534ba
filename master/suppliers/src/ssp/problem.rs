//! Problems with parts of a system structure, told with the element that has them.

use super::document::{ConnectorKind, End};
use fmi2::archive::ArchiveError;
use fmi2::model_description::BaseType;

/// Reason why the file behind a URI is not read.
#[derive(Debug, thiserror::Error)]
pub(super) enum FileProblem {
    #[error("source \"{uri}\": the decoded URI is not UTF-8")]
    Encoding { uri: String },
    #[error("source \"{uri}\": {problem}; expected a path inside the archive")]
    Outside { uri: String, problem: ArchiveError },
    #[error("source \"{uri}\": there is no such file in the archive")]
    Missing { uri: String },
    #[error("source \"{uri}\": {source}")]
    Unreadable { uri: String, source: std::io::Error },
}

/// Reason why an end of a connection leads to no real input or output.
#[derive(Debug, thiserror::Error)]
pub(super) enum EndProblem {
    #[error("there is no component \"{element}\", only \"{}\"", .known.join("\", \""))]
    NoComponent { element: String, known: Vec<String> },
    #[error("component \"{element}\" has no connector \"{connector}\"")]
    NoConnector { element: String, connector: String },
    #[error("the FMU of component \"{element}\" has no variable \"{variable}\"")]
    NoVariable { element: String, variable: String },
    #[error("{end} is a {}, only inputs and outputs are connected", .kind.name())]
    Unconnectable { end: End, kind: ConnectorKind },
    #[error("{end} is an {} in the system, but its variable in the FMU is none", .kind.name())]
    OtherCausality { end: End, kind: ConnectorKind },
    #[error("{end} is not real; only real signals are connected")]
    NotReal { end: End },
    #[error("the unit {unit} of {end} is not defined")]
    NoUnit { end: End, unit: String },
}

/// Reason why a value in one unit is no value in another.
#[derive(Debug, thiserror::Error)]
pub(super) enum UnitProblem {
    #[error(
        "the unit {from} cannot be converted to {to}, the dimensions differ: expected a unit of the dimension of {to}"
    )]
    Differ { from: String, to: String },
    #[error(
        "the unit {unit} is not known: expected {other}, a unit defined in <Units> with its BaseUnit, or one made of \
         SI symbols such as kN/m, N.s/mm, g or deg; a value in the unit of the variable may stand without a unit"
    )]
    Unknown { unit: String, other: String },
    #[error(
        "the unit {unit} is not one of SI and the variable has none, so that nothing says which unit the FMU takes: \
         expected the value as the FMU takes it, without a unit"
    )]
    NoTarget { unit: String },
}

/// Reason why a value does not fit the variable of a parameter.
#[derive(Debug, thiserror::Error)]
pub(super) enum ValueProblem {
    #[error(transparent)]
    Unit(#[from] UnitProblem),
    #[error("the item \"{name}\" is not defined in the FMU")]
    NoItem { name: String },
    #[error("the value must be of type {expected:?}, as the variable is")]
    OtherType { expected: BaseType },
}
