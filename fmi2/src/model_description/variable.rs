//! Scalar variables: meaning, phases in which they may be set, dependencies.

/// Role of a variable [FMI 2.0, 2.2.7].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Causality {
    /// Set by the importer before the simulation.
    Parameter,
    /// Follows from parameters.
    CalculatedParameter,
    /// Set by the importer between steps.
    Input,
    /// Read by the importer between steps.
    Output,
    /// Any other variable that can be read.
    #[default]
    Local,
    /// Time.
    Independent,
}

/// Times at which a variable may change [FMI 2.0, 2.2.7].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variability {
    /// Never.
    Constant,
    /// Not after initialisation.
    Fixed,
    /// Between steps, by the importer.
    Tunable,
    /// At events.
    Discrete,
    /// At any time.
    #[default]
    Continuous,
}

/// Meaning of the start value [FMI 2.0, 2.2.7].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Initial {
    /// The variable begins with its start value.
    Exact,
    /// The start value is a first guess.
    Approx,
    /// The variable is calculated during initialisation.
    Calculated,
}

/// Base type of the values at the C interface; an enumeration goes through the integer functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseType {
    /// `fmi2Real`.
    Real,
    /// `fmi2Integer`.
    Integer,
    /// `fmi2Boolean`.
    Boolean,
    /// `fmi2String`.
    String,
}

/// Attributes of a real quantity, shared by variables and type definitions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RealAttributes {
    /// Physical quantity, such as "Force".
    pub quantity: Option<String>,
    /// Unit of the value at the interface.
    pub unit: Option<String>,
    /// Unit for people.
    pub display_unit: Option<String>,
    /// Smallest value, in `unit`.
    pub min: Option<f64>,
    /// Largest value, in `unit`.
    pub max: Option<f64>,
    /// Usual magnitude, in `unit`.
    pub nominal: Option<f64>,
}

/// Type of a variable with the attributes of that type.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A real number.
    Real {
        /// Unit and bounds; missing ones come from the declared type.
        attributes: RealAttributes,
        /// Start value, in the unit.
        start: Option<f64>,
        /// Position of the variable of which this is the time derivative.
        derivative_of: Option<usize>,
    },
    /// A whole number.
    Integer {
        /// Smallest value.
        min: Option<i32>,
        /// Largest value.
        max: Option<i32>,
        /// Start value.
        start: Option<i32>,
    },
    /// True or false.
    Boolean {
        /// Start value.
        start: Option<bool>,
    },
    /// Text.
    String {
        /// Start value.
        start: Option<String>,
    },
    /// Item of the declared type, as an integer.
    Enumeration {
        /// Start value.
        start: Option<i32>,
    },
}

/// Scalar variable. Its position in the list is its identity in a model description; `value_reference` goes through the
/// C interface and is unique per base type only.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Unique name.
    pub name: String,
    /// Handle at the C interface.
    pub value_reference: u32,
    /// Description for people.
    pub description: Option<String>,
    /// Role.
    pub causality: Causality,
    /// Times at which the variable may change.
    pub variability: Variability,
    /// Meaning of the start value; `None` for inputs and for the time.
    pub initial: Option<Initial>,
    /// Name of the type definition that the variable inherits from.
    pub declared_type: Option<String>,
    /// Type and start value.
    pub kind: Kind,
    /// Positions of the inputs that an output depends on at a communication point with the states held; `None` is
    /// "perhaps on all".
    pub dependencies: Option<Vec<usize>>,
    /// Positions of the inputs and parameters that a value found during initialisation depends on; `None` is "perhaps
    /// on all".
    pub initial_dependencies: Option<Vec<usize>>,
}

impl Variable {
    fn new(name: &str, description: &str, causality: Causality, kind: Kind) -> Self {
        let real = matches!(kind, Kind::Real { .. });
        let (variability, initial) = match causality {
            Causality::Parameter => (Variability::Fixed, Some(Initial::Exact)),
            Causality::CalculatedParameter => (Variability::Fixed, Some(Initial::Calculated)),
            Causality::Input | Causality::Independent if real => (Variability::Continuous, None),
            Causality::Input | Causality::Independent => (Variability::Discrete, None),
            _ if real => (Variability::Continuous, Some(Initial::Calculated)),
            _ => (Variability::Discrete, Some(Initial::Calculated)),
        };
        Self {
            name: name.to_owned(),
            value_reference: 0,
            description: Some(description.to_owned()),
            causality,
            variability,
            initial,
            declared_type: None,
            kind,
            dependencies: None,
            initial_dependencies: None,
        }
    }

    fn real(name: &str, unit: &str, start: Option<f64>, description: &str, causality: Causality) -> Self {
        let attributes = RealAttributes {
            unit: Some(unit.to_owned()),
            ..RealAttributes::default()
        };
        Self::new(
            name,
            description,
            causality,
            Kind::Real {
                attributes,
                start,
                derivative_of: None,
            },
        )
    }

    /// A continuous real input in `unit` that begins with `start`.
    #[must_use]
    pub fn input(name: &str, unit: &str, start: f64, description: &str) -> Self {
        Self::real(name, unit, Some(start), description, Causality::Input)
    }

    /// A continuous real output in `unit`, found during initialisation.
    #[must_use]
    pub fn output(name: &str, unit: &str, description: &str) -> Self {
        Self::real(name, unit, None, description, Causality::Output)
    }

    /// A real parameter in `unit` that does not change after initialisation.
    #[must_use]
    pub fn parameter(name: &str, unit: &str, start: f64, description: &str) -> Self {
        Self::real(name, unit, Some(start), description, Causality::Parameter)
    }

    /// A whole-number parameter that does not change after initialisation.
    #[must_use]
    pub fn integer_parameter(name: &str, start: i32, description: &str) -> Self {
        let kind = Kind::Integer {
            min: None,
            max: None,
            start: Some(start),
        };
        Self::new(name, description, Causality::Parameter, kind)
    }

    /// A yes-or-no parameter that does not change after initialisation.
    #[must_use]
    pub fn boolean_parameter(name: &str, start: bool, description: &str) -> Self {
        Self::new(
            name,
            description,
            Causality::Parameter,
            Kind::Boolean { start: Some(start) },
        )
    }

    /// A text parameter that does not change after initialisation.
    #[must_use]
    pub fn string_parameter(name: &str, start: &str, description: &str) -> Self {
        let kind = Kind::String {
            start: Some(start.to_owned()),
        };
        Self::new(name, description, Causality::Parameter, kind)
    }

    /// A discrete whole-number output.
    #[must_use]
    pub fn integer_output(name: &str, description: &str) -> Self {
        Self::new(
            name,
            description,
            Causality::Output,
            Kind::Integer {
                min: None,
                max: None,
                start: None,
            },
        )
    }

    /// A discrete yes-or-no output.
    #[must_use]
    pub fn boolean_output(name: &str, description: &str) -> Self {
        Self::new(name, description, Causality::Output, Kind::Boolean { start: None })
    }

    /// Makes a parameter changeable between steps.
    #[must_use]
    pub fn tunable(mut self) -> Self {
        self.variability = Variability::Tunable;
        self
    }

    /// Sets the usual magnitude of a real variable, in its unit.
    #[must_use]
    pub fn nominal(mut self, value: f64) -> Self {
        if let Kind::Real { attributes, .. } = &mut self.kind {
            attributes.nominal = Some(value);
        }
        self
    }

    /// Declares that an output depends on exactly these inputs at a communication point (positions in the table).
    #[must_use]
    pub fn depends_on(mut self, inputs: &[usize]) -> Self {
        self.dependencies = Some(sorted(inputs));
        self
    }

    /// Declares that an output depends on exactly these inputs and parameters at initialisation (positions in the
    /// table).
    #[must_use]
    pub fn initially_depends_on(mut self, knowns: &[usize]) -> Self {
        self.initial_dependencies = Some(sorted(knowns));
        self
    }

    /// Base type at the C interface.
    #[must_use]
    pub fn base_type(&self) -> BaseType {
        match self.kind {
            Kind::Real { .. } => BaseType::Real,
            Kind::Integer { .. } | Kind::Enumeration { .. } => BaseType::Integer,
            Kind::Boolean { .. } => BaseType::Boolean,
            Kind::String { .. } => BaseType::String,
        }
    }

    /// Unit written at the variable itself.
    #[must_use]
    pub fn unit(&self) -> Option<&str> {
        match &self.kind {
            Kind::Real { attributes, .. } => attributes.unit.as_deref(),
            _ => None,
        }
    }

    /// Start value of a real variable, in its unit.
    #[must_use]
    pub fn real_start(&self) -> Option<f64> {
        match self.kind {
            Kind::Real { start, .. } => start,
            _ => None,
        }
    }

    /// True if the variable is listed under `InitialUnknowns` [FMI 2.0, 2.2.8].
    #[must_use]
    pub fn is_initial_unknown(&self) -> bool {
        match self.causality {
            Causality::Output => {
                matches!(self.initial, Some(Initial::Approx | Initial::Calculated))
            }
            Causality::CalculatedParameter => true,
            _ => false,
        }
    }

    /// Default of `initial` [FMI 2.0, 2.2.7].
    #[must_use]
    pub fn default_initial(causality: Causality, variability: Variability) -> Option<Initial> {
        match (causality, variability) {
            (Causality::Input | Causality::Independent, _) => None,
            (Causality::Parameter, _) | (_, Variability::Constant) => Some(Initial::Exact),
            _ => Some(Initial::Calculated),
        }
    }
}

fn sorted(positions: &[usize]) -> Vec<usize> {
    let mut positions = positions.to_vec();
    positions.sort_unstable();
    positions.dedup();
    positions
}
