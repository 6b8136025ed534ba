//! `modelDescription.xml` of FMI 2.0 [FMI 2.0, 2.2]: one structure that is read from any FMU and written for ours.
//!
//! Reading tolerates a byte order mark, CRLF, comments, foreign attributes, vendor annotations and a DOCTYPE that
//! defines nothing; it never expands an entity of the file's own. Writing is deterministic: the same description
//! gives the same bytes.

mod read;
mod unit;
mod variable;
mod write;
pub mod xml;

pub use unit::{BASE_UNITS, BaseUnit, DisplayUnit, Unit};
pub use variable::{BaseType, Causality, Initial, Kind, RealAttributes, Variability, Variable};
pub use write::escaped;

use std::collections::BTreeSet;

/// The GUID of a description that has not been packaged.
pub const GUID_PLACEHOLDER: &str = "{00000000-0000-0000-0000-000000000000}";

/// Content of the `modelDescription.xml` of a co-simulation FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDescription {
    /// Free text.
    pub model_name: String,
    /// Compared as a string between file and binary.
    pub guid: String,
    /// Description for people, one line.
    pub description: Option<String>,
    /// Author of the model.
    pub author: Option<String>,
    /// Version of the model.
    pub version: Option<String>,
    /// Tool that wrote the file.
    pub generation_tool: Option<String>,
    /// True for names in the structured convention (`strip[1].z`).
    pub structured_names: bool,
    /// The co-simulation interface.
    pub co_simulation: CoSimulation,
    /// Units the variables refer to.
    pub units: Vec<Unit>,
    /// Types the variables refer to.
    pub types: Vec<TypeDefinition>,
    /// Categories that the logger may be asked for.
    pub log_categories: Vec<LogCategory>,
    /// Default experiment.
    pub default_experiment: Option<DefaultExperiment>,
    /// All variables; the position is the identity.
    pub variables: Vec<Variable>,
}

/// Attributes of `<CoSimulation>`; missing capabilities are false or 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CoSimulation {
    /// File name of the binary without its extension.
    pub model_identifier: String,
    /// The FMU needs another program at run time.
    pub needs_execution_tool: bool,
    /// Any step length is taken.
    pub can_handle_variable_communication_step_size: bool,
    /// `fmi2SetRealInputDerivatives` has an effect.
    pub can_interpolate_inputs: bool,
    /// Highest order of `fmi2GetRealOutputDerivatives`.
    pub max_output_derivative_order: u32,
    /// Steps may be asynchronous.
    pub can_run_asynchronously: bool,
    /// Only one instance per process.
    pub can_be_instantiated_only_once_per_process: bool,
    /// The FMU does not use the memory functions of the importer.
    pub can_not_use_memory_management_functions: bool,
    /// State can be saved and restored.
    pub can_get_and_set_fmu_state: bool,
    /// State can be turned into bytes.
    pub can_serialize_fmu_state: bool,
    /// `fmi2GetDirectionalDerivative` works.
    pub provides_directional_derivative: bool,
}

/// A named type.
#[derive(Clone, Debug, PartialEq)]
pub struct TypeDefinition {
    /// Name.
    pub name: String,
    /// Description for people.
    pub description: Option<String>,
    /// Attributes shared by the variables of this type.
    pub shape: TypeShape,
}

/// Attributes that a type definition fixes.
#[derive(Clone, Debug, PartialEq)]
pub enum TypeShape {
    /// Unit and bounds.
    Real(RealAttributes),
    /// Bounds.
    Integer {
        /// Smallest value.
        min: Option<i32>,
        /// Largest value.
        max: Option<i32>,
    },
    /// Boolean and text types have no attributes.
    Boolean,
    /// Boolean and text types have no attributes.
    String,
    /// Names of values.
    Enumeration(Vec<EnumerationItem>),
}

/// A named value of an enumeration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EnumerationItem {
    /// Name.
    pub name: String,
    /// Value that goes through the integer functions.
    pub value: i32,
}

/// A kind of log message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogCategory {
    /// Name.
    pub name: String,
    /// Description for people.
    pub description: Option<String>,
}

/// Suggested experiment; times in s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DefaultExperiment {
    /// Time, s.
    pub start_time: Option<f64>,
    /// Time, s.
    pub stop_time: Option<f64>,
    /// Relative tolerance, –.
    pub tolerance: Option<f64>,
    /// Preferred communication step, s.
    pub step_size: Option<f64>,
}

impl ModelDescription {
    /// The description of a model that runs on [`crate::slave`]: all capabilities of the runtime, structured names,
    /// its log categories, the units the variables name, and value references equal to the positions.
    #[must_use]
    pub fn of_slave(model_identifier: &str, variables: Vec<Variable>) -> Self {
        let mut description = Self {
            model_name: model_identifier.to_owned(),
            guid: GUID_PLACEHOLDER.to_owned(),
            description: None,
            author: None,
            version: None,
            generation_tool: None,
            structured_names: true,
            co_simulation: CoSimulation {
                model_identifier: model_identifier.to_owned(),
                can_handle_variable_communication_step_size: true,
                can_interpolate_inputs: true,
                max_output_derivative_order: 1,
                can_not_use_memory_management_functions: true,
                can_get_and_set_fmu_state: true,
                can_serialize_fmu_state: true,
                provides_directional_derivative: true,
                ..CoSimulation::default()
            },
            units: Vec::new(),
            types: Vec::new(),
            log_categories: crate::slave::log_categories(),
            default_experiment: None,
            variables,
        };
        let mut names = BTreeSet::new();
        for (position, variable) in description.variables.iter_mut().enumerate() {
            variable.value_reference = u32::try_from(position).expect("a table has fewer than 2³² variables");
            names.extend(variable.unit().map(str::to_owned));
        }
        description.units = names
            .into_iter()
            .map(|name| {
                let unknown = Unit {
                    name: name.clone(),
                    base: None,
                    display_units: Vec::new(),
                };
                Unit::from_name(&name).unwrap_or(unknown)
            })
            .collect();
        description
    }

    /// Reads a model description.
    ///
    /// # Errors
    ///
    /// A file that cannot be used; the error names element, variable and line.
    pub fn from_xml(bytes: &[u8]) -> Result<Self, DescriptionError> {
        read::read(bytes)
    }

    /// The model description as XML, in the order of the schema, one element per line.
    #[must_use]
    pub fn to_xml(&self) -> String {
        write::write(self)
    }

    /// Position of the variable of that name.
    #[must_use]
    pub fn position(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|variable| variable.name == name)
    }

    /// The variable of that name.
    #[must_use]
    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name)
    }

    /// Attributes of a real variable with what it inherits from its declared type.
    #[must_use]
    pub fn real_attributes(&self, variable: &Variable) -> Option<RealAttributes> {
        let Kind::Real { attributes, .. } = &variable.kind else {
            return None;
        };
        let inherited = variable
            .declared_type
            .as_deref()
            .and_then(|name| self.types.iter().find(|definition| definition.name == name))
            .and_then(|definition| match &definition.shape {
                TypeShape::Real(attributes) => Some(attributes.clone()),
                _ => None,
            })
            .unwrap_or_default();
        let own = attributes.clone();
        Some(RealAttributes {
            quantity: own.quantity.or(inherited.quantity),
            unit: own.unit.or(inherited.unit),
            display_unit: own.display_unit.or(inherited.display_unit),
            min: own.min.or(inherited.min),
            max: own.max.or(inherited.max),
            nominal: own.nominal.or(inherited.nominal),
        })
    }

    /// Definition of the unit of a real variable, inherited or own; `None` for a variable without unit.
    #[must_use]
    pub fn unit_of(&self, variable: &Variable) -> Option<&Unit> {
        let name = self.real_attributes(variable)?.unit?;
        self.units.iter().find(|unit| unit.name == name)
    }
}

/// Errors of model descriptions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DescriptionError {
    /// More bytes than are read.
    #[error("has {size} bytes, the limit is {limit}")]
    TooLarge {
        /// Bytes.
        size: usize,
        /// Bytes.
        limit: usize,
    },
    /// An empty file.
    #[error("is empty")]
    Empty,
    /// Bytes that are no text of the declared encoding.
    #[error("is not {encoding}: bad byte at offset {offset}")]
    Encoding {
        /// Name of the encoding.
        encoding: String,
        /// Byte offset.
        offset: usize,
    },
    /// A document that is not well-formed XML.
    #[error("line {line}: not well-formed XML: {problem}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Message of the parser.
        problem: String,
    },
    /// The document defines or uses entities of its own.
    #[error(
        "line {line}: entity {entity} is refused; only &amp; &lt; &gt; &quot; &apos; and character references are read"
    )]
    Entity {
        /// Line, from 1.
        line: usize,
        /// Text as written.
        entity: String,
    },
    /// Elements nested too deeply.
    #[error("line {line}: elements are nested more than {limit} deep")]
    TooDeep {
        /// Line, from 1.
        line: usize,
        /// Levels.
        limit: usize,
    },
    /// More variables than are read.
    #[error("line {line}: more than {limit} elements")]
    TooMany {
        /// Line, from 1.
        line: usize,
        /// Elements.
        limit: usize,
    },
    /// A text that is too long to be a name.
    #[error("line {line}: {attribute} of <{element}> has {length} bytes, the limit is {limit}")]
    TooLong {
        /// Line, from 1.
        line: usize,
        /// Name of the element.
        element: String,
        /// Name of the attribute.
        attribute: String,
        /// Bytes.
        length: usize,
        /// Bytes.
        limit: usize,
    },
    /// Another document.
    #[error("line {line}: the root element is <{found}>, expected <fmiModelDescription>")]
    WrongRoot {
        /// Line, from 1.
        line: usize,
        /// Name of the root.
        found: String,
    },
    /// Another version of the standard.
    #[error("fmiVersion is \"{found}\", expected \"2.0\"")]
    WrongVersion {
        /// Text as written.
        found: String,
    },
    /// An attribute that must be there.
    #[error("line {line}: <{element}> lacks the attribute {attribute}")]
    MissingAttribute {
        /// Line, from 1.
        line: usize,
        /// Name of the element.
        element: String,
        /// Name of the attribute.
        attribute: &'static str,
    },
    /// An element that must be there.
    #[error("line {line}: <{element}> lacks {child}")]
    MissingElement {
        /// Line, from 1.
        line: usize,
        /// Name of the element.
        element: String,
        /// Name of the missing child.
        child: &'static str,
    },
    /// A value of the wrong form.
    #[error("line {line}: {attribute} of {owner} is \"{value}\", expected {expected}")]
    BadValue {
        /// Line, from 1.
        line: usize,
        /// Element or variable.
        owner: String,
        /// Name of the attribute.
        attribute: String,
        /// Text as written.
        value: String,
        /// Expected form.
        expected: &'static str,
    },
    /// A name used twice.
    #[error("line {line}: the {what} name \"{name}\" is used twice, first at line {first}")]
    Duplicate {
        /// Line, from 1.
        line: usize,
        /// Variable, unit or type.
        what: &'static str,
        /// The name.
        name: String,
        /// Line of the first use.
        first: usize,
    },
    /// A reference to something that is not defined.
    #[error("line {line}: {owner} refers to the {what} \"{name}\", which is not defined")]
    Undefined {
        /// Line, from 1.
        line: usize,
        /// Variable or type.
        owner: String,
        /// Unit, display unit or type.
        what: &'static str,
        /// The name.
        name: String,
    },
}
