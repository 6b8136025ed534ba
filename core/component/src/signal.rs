//! Inputs and outputs by name.

/// Type of a signal's values, with the unit of a real number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalKind {
    /// A real number in this unit.
    Real(&'static str),
    /// A whole number.
    Integer,
    /// True or false.
    Boolean,
}

/// Direction of a signal, with the words of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Set from outside between steps.
    Input,
    /// Read from outside.
    Output,
    /// A switch that is set before the start.
    Parameter,
}

/// Name, unit and meaning of a signal, the same for every member of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DeclaredSignal {
    /// Name within the group: `wire.z` of `contact[1].wire.z`.
    pub name: &'static str,
    /// See [`SignalKind`].
    pub kind: SignalKind,
    /// One sentence; `{}` stands for the number of the member.
    pub description: &'static str,
}

impl DeclaredSignal {
    /// A real signal.
    #[must_use]
    pub const fn real(name: &'static str, unit: &'static str, description: &'static str) -> Self {
        Self {
            name,
            kind: SignalKind::Real(unit),
            description,
        }
    }

    /// Unit of a real signal.
    #[must_use]
    pub const fn unit(&self) -> Option<&'static str> {
        match self.kind {
            SignalKind::Real(unit) => Some(unit),
            _ => None,
        }
    }

    /// Full name in member `number` (from 1) of `group`: `contact[1].wire.z`.
    #[must_use]
    pub fn of(&self, group: &str, number: usize) -> String {
        format!("{group}[{number}].{}", self.name)
    }
}

/// One named signal of a component.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Structured name, `strip[1].z`.
    pub name: String,
    /// See [`Causality`].
    pub causality: Causality,
    /// See [`SignalKind`].
    pub kind: SignalKind,
    /// One sentence.
    pub description: String,
    /// Start value of an input or parameter; 0 for an output.
    pub start: f64,
    /// Positions of the inputs on which an output depends without a step in between.
    pub feedthrough: Vec<usize>,
}
