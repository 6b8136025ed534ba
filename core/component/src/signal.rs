//! Inputs and outputs by name.

/// Type of a signal's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A real number in this unit.
    Real(&'static str),
    /// A whole number.
    Integer,
    /// Yes or no.
    Boolean,
}

/// Direction of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Set from outside between steps.
    Input,
    /// Read from outside.
    Output,
    /// A switch that is set before the start.
    Setting,
}

/// One named signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Structured name, `strip[1].z`.
    pub name: String,
    /// See [`Role`].
    pub role: Role,
    /// See [`Kind`].
    pub kind: Kind,
    /// One sentence.
    pub description: String,
    /// Start value of an input or setting.
    pub start: f64,
    /// Positions of the inputs an output depends on without a step in between.
    pub feedthrough: Vec<usize>,
}

impl Signal {
    /// A real input.
    pub fn input(name: impl Into<String>, unit: &'static str, start: f64, description: impl Into<String>) -> Self {
        Self::new(name, Role::Input, Kind::Real(unit), start, description)
    }

    /// A real output.
    pub fn output(name: impl Into<String>, unit: &'static str, description: impl Into<String>) -> Self {
        Self::new(name, Role::Output, Kind::Real(unit), 0.0, description)
    }

    /// A signal of any kind.
    pub fn new(name: impl Into<String>, role: Role, kind: Kind, start: f64, description: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            role,
            kind,
            description: description.into(),
            start,
            feedthrough: Vec::new(),
        }
    }

    /// Declares the inputs on which an output depends directly.
    #[must_use]
    pub fn fed_by(mut self, inputs: &[usize]) -> Self {
        self.feedthrough = inputs.to_vec();
        self
    }
}
