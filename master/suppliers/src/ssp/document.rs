//! System structure description, parameter set and parameter mapping, as far as they are used here.

use scene::ParameterValue;

/// `ssd:SystemStructureDescription`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Description {
    pub name: String,
    pub description: Option<String>,
    pub system: System,
    pub units: Vec<Unit>,
    pub experiment: Experiment,
    pub own: Option<Own>,
}

/// `ssd:DefaultExperiment`, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Experiment {
    pub start: Option<f64>,
    pub stop: Option<f64>,
}

/// Content of our annotation.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Own {
    /// Resource with the resolved scene.
    pub scene: String,
    /// [`digest`](super::digest::digest) of the system that the scene stands for.
    pub digest: String,
    /// Settings of the coupling, for people: name and value.
    pub coupling: Vec<(String, String)>,
}

/// `ssd:System` with components only.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct System {
    pub name: String,
    pub description: Option<String>,
    pub connectors: Vec<Connector>,
    pub components: Vec<Component>,
    pub connections: Vec<Connection>,
    pub bindings: Vec<Binding>,
}

/// `ssd:Component`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Component {
    pub name: String,
    pub description: Option<String>,
    /// URI relative to the description.
    pub source: String,
    pub connectors: Vec<Connector>,
    pub bindings: Vec<Binding>,
    pub line: usize,
}

/// `ssd:Connector`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Connector {
    pub name: String,
    pub kind: ConnectorKind,
    pub value: Option<Type>,
    pub line: usize,
}

/// `kind` of a connector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ConnectorKind {
    Input,
    Output,
    Parameter,
    CalculatedParameter,
}

impl ConnectorKind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::Parameter => "parameter",
            Self::CalculatedParameter => "calculatedParameter",
        }
    }
}

/// Type of a connector.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Type {
    Real {
        unit: Option<String>,
    },
    /// Name.
    Other(String),
}

/// One end of a connection; without element a connector of the system.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct End {
    pub element: Option<String>,
    pub connector: String,
}

impl std::fmt::Display for End {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.element {
            Some(element) => write!(f, "{element}.{}", self.connector),
            None => write!(f, "{} (of the system)", self.connector),
        }
    }
}

/// `target = factor · source + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Linear {
    pub factor: f64,
    pub offset: f64,
}

impl Linear {
    pub const IDENTITY: Self = Self {
        factor: 1.0,
        offset: 0.0,
    };

    /// This map, then `next`.
    pub fn then(self, next: Self) -> Self {
        Self {
            factor: next.factor * self.factor,
            offset: next.factor * self.offset + next.offset,
        }
    }

    /// The way back; the factor is not zero.
    pub fn inverse(self) -> Self {
        Self {
            factor: 1.0 / self.factor,
            // Not −0.
            offset: if self.offset == 0.0 {
                0.0
            } else {
                -self.offset / self.factor
            },
        }
    }

    pub fn apply(self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

/// `ssd:Connection`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Connection {
    pub start: End,
    pub end: End,
    pub map: Linear,
    pub suppress_unit_conversion: bool,
    pub line: usize,
}

/// `ssd:ParameterBinding`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Binding {
    pub prefix: String,
    pub values: Source<ParameterSet>,
    pub mapping: Option<Source<Vec<MappingEntry>>>,
    pub line: usize,
}

/// Location of parameters or of their mapping.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source<T> {
    Inline(T),
    /// URI relative to the description.
    File(String),
    /// URI relative to the component's FMU.
    InComponent(String),
}

/// `ssv:ParameterSet`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ParameterSet {
    pub name: String,
    pub parameters: Vec<Parameter>,
    pub units: Vec<Unit>,
}

/// `ssv:Parameter`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameter {
    pub name: String,
    pub value: Value,
    pub line: usize,
}

/// Value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Real {
        value: f64,
        unit: Option<String>,
    },
    Integer(i32),
    Boolean(bool),
    String(String),
    /// Name of an item.
    Enumeration(String),
}

impl Value {
    /// Value of a scene; `integer` for an integer variable.
    pub fn of(value: &ParameterValue, integer: bool) -> Self {
        match value {
            ParameterValue::Number(number) if integer => Self::Integer(*number as i32),
            ParameterValue::Number(number) => Self::Real {
                value: *number,
                unit: None,
            },
            ParameterValue::Boolean(flag) => Self::Boolean(*flag),
            ParameterValue::String(text) => Self::String(text.clone()),
        }
    }
}

/// `ssm:MappingEntry`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MappingEntry {
    pub source: String,
    pub target: String,
    pub map: Linear,
    pub suppress_unit_conversion: bool,
}

/// `ssc:Unit`.
pub(super) type Unit = fmi2::model_description::Unit;
