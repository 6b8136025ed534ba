//! Reading: from the element tree to a checked [`ModelDescription`].

use super::xml::{self, Element};
use super::{
    BASE_UNITS, BaseUnit, Causality, CoSimulation, DefaultExperiment, DescriptionError, DisplayUnit, EnumerationItem,
    Initial, Kind, LogCategory, ModelDescription, RealAttributes, TypeDefinition, TypeShape, Unit, Variability,
    Variable,
};
use std::collections::BTreeMap;
use std::str::FromStr;

/// Most variables.
const MAX_VARIABLES: usize = 1_000_000;

type Result<T> = std::result::Result<T, DescriptionError>;

pub(super) fn read(bytes: &[u8]) -> Result<ModelDescription> {
    let root = xml::parse(bytes, xml::Annotations::Dropped)?;
    if root.name != "fmiModelDescription" {
        return Err(DescriptionError::WrongRoot {
            line: root.line,
            found: root.name,
        });
    }
    let version = root.required("fmiVersion")?;
    if version != "2.0" {
        return Err(DescriptionError::WrongVersion {
            found: version.to_owned(),
        });
    }
    let Some(co_simulation_element) = root.child("CoSimulation") else {
        let child = "CoSimulation (the FMU is for model exchange only)";
        return Err(DescriptionError::MissingElement {
            line: root.line,
            element: root.name,
            child,
        });
    };
    let units: Vec<Unit> = root
        .members("UnitDefinitions", "Unit")
        .map(unit)
        .collect::<Result<_>>()?;
    unique("unit", root.members("UnitDefinitions", "Unit"))?;
    let types: Vec<_> = root
        .members("TypeDefinitions", "SimpleType")
        .map(definition)
        .collect::<Result<_>>()?;
    unique("type", root.members("TypeDefinitions", "SimpleType"))?;
    for (shape, element) in types.iter().zip(root.members("TypeDefinitions", "SimpleType")) {
        if let TypeShape::Real(attributes) = &shape.shape {
            defined(attributes, &units, &format!("type \"{}\"", shape.name), element.line)?;
        }
    }
    let mut description = ModelDescription {
        model_name: root.required("modelName")?.to_owned(),
        guid: root.required("guid")?.to_owned(),
        description: text(&root, "description"),
        author: text(&root, "author"),
        version: text(&root, "version"),
        generation_tool: text(&root, "generationTool"),
        structured_names: root.attribute("variableNamingConvention") == Some("structured"),
        co_simulation: co_simulation(co_simulation_element)?,
        units,
        types,
        log_categories: root
            .members("LogCategories", "Category")
            .map(|element| {
                let name = element.required("name")?.to_owned();
                Ok(LogCategory {
                    name,
                    description: text(element, "description"),
                })
            })
            .collect::<Result<_>>()?,
        default_experiment: root.child("DefaultExperiment").map(experiment).transpose()?,
        variables: Vec::new(),
    };
    description.variables = variables(&root, &description)?;
    structure(&root, &mut description.variables)?;
    Ok(description)
}

fn text(element: &Element, name: &str) -> Option<String> {
    element.attribute(name).map(str::to_owned)
}

fn bad(element: &Element, owner: &str, attribute: &str, value: &str, expected: &'static str) -> DescriptionError {
    DescriptionError::BadValue {
        line: element.line,
        owner: owner.to_owned(),
        attribute: attribute.to_owned(),
        value: value.to_owned(),
        expected,
    }
}

/// The element as people call it: `variable "strip[1].z"` or `<CoSimulation>`.
fn owner(element: &Element) -> String {
    match (element.name.as_str(), element.attribute("name")) {
        ("ScalarVariable", Some(name)) => format!("variable \"{name}\""),
        ("SimpleType", Some(name)) => format!("type \"{name}\""),
        ("Unit", Some(name)) => format!("unit \"{name}\""),
        (name, _) => format!("<{name}>"),
    }
}

fn parsed<T: FromStr>(element: &Element, owner: &str, name: &str, expected: &'static str) -> Result<Option<T>> {
    let Some(value) = element.attribute(name) else {
        return Ok(None);
    };
    value
        .trim()
        .parse()
        .map(Some)
        .map_err(|_| bad(element, owner, name, value, expected))
}

fn number(element: &Element, owner: &str, name: &str) -> Result<Option<f64>> {
    let expected = "a finite number with a decimal point";
    let value: Option<f64> = parsed(element, owner, name, expected)?;
    match value {
        Some(value) if !value.is_finite() => Err(bad(
            element,
            owner,
            name,
            element.attribute(name).unwrap_or_default(),
            expected,
        )),
        _ => Ok(value),
    }
}

fn integer(element: &Element, owner: &str, name: &str) -> Result<Option<i32>> {
    parsed(element, owner, name, "a whole number of 32 bits")
}

fn boolean(element: &Element, owner: &str, name: &str) -> Result<Option<bool>> {
    match element.attribute(name) {
        None => Ok(None),
        Some("true" | "1") => Ok(Some(true)),
        Some("false" | "0") => Ok(Some(false)),
        Some(value) => Err(bad(element, owner, name, value, "true or false")),
    }
}

/// Names of sibling elements must differ.
fn unique<'a>(what: &'static str, elements: impl Iterator<Item = &'a Element>) -> Result<()> {
    let mut lines = BTreeMap::new();
    for element in elements {
        let name = element.required("name")?;
        if let Some(first) = lines.insert(name, element.line) {
            return Err(DescriptionError::Duplicate {
                line: element.line,
                what,
                name: name.to_owned(),
                first,
            });
        }
    }
    Ok(())
}

fn co_simulation(element: &Element) -> Result<CoSimulation> {
    let identifier = element.required("modelIdentifier")?;
    let valid = identifier.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && identifier.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !valid {
        let expected = "a C identifier: letters, digits and _";
        return Err(bad(element, "<CoSimulation>", "modelIdentifier", identifier, expected));
    }
    let flag = |name| Ok(boolean(element, "<CoSimulation>", name)?.unwrap_or(false));
    let order = parsed(
        element,
        "<CoSimulation>",
        "maxOutputDerivativeOrder",
        "a whole number ≥ 0",
    )?;
    Ok(CoSimulation {
        model_identifier: identifier.to_owned(),
        needs_execution_tool: flag("needsExecutionTool")?,
        can_handle_variable_communication_step_size: flag("canHandleVariableCommunicationStepSize")?,
        can_interpolate_inputs: flag("canInterpolateInputs")?,
        max_output_derivative_order: order.unwrap_or(0),
        can_run_asynchronously: flag("canRunAsynchronuously")?,
        can_be_instantiated_only_once_per_process: flag("canBeInstantiatedOnlyOncePerProcess")?,
        can_not_use_memory_management_functions: flag("canNotUseMemoryManagementFunctions")?,
        can_get_and_set_fmu_state: flag("canGetAndSetFMUstate")?,
        can_serialize_fmu_state: flag("canSerializeFMUstate")?,
        provides_directional_derivative: flag("providesDirectionalDerivative")?,
    })
}

fn experiment(element: &Element) -> Result<DefaultExperiment> {
    let value = |name| number(element, "<DefaultExperiment>", name);
    Ok(DefaultExperiment {
        start_time: value("startTime")?,
        stop_time: value("stopTime")?,
        tolerance: value("tolerance")?,
        step_size: value("stepSize")?,
    })
}

fn unit(element: &Element) -> Result<Unit> {
    let owner = owner(element);
    let name = element.required("name")?.to_owned();
    let factor = |e: &Element| Ok(number(e, &owner, "factor")?.unwrap_or(1.0));
    let offset = |e: &Element| Ok(number(e, &owner, "offset")?.unwrap_or(0.0));
    let mut unit = Unit {
        name,
        base: None,
        display_units: Vec::new(),
    };
    for child in &element.children {
        match child.name.as_str() {
            "BaseUnit" => {
                let mut base = BaseUnit {
                    factor: factor(child)?,
                    offset: offset(child)?,
                    ..BaseUnit::default()
                };
                for (exponent, name) in base.exponents.iter_mut().zip(BASE_UNITS) {
                    *exponent = integer(child, &owner, name)?.unwrap_or(0);
                }
                unit.base = Some(base);
            }
            "DisplayUnit" => unit.display_units.push(DisplayUnit {
                name: child.required("name")?.to_owned(),
                factor: factor(child)?,
                offset: offset(child)?,
            }),
            _ => {}
        }
    }
    Ok(unit)
}

fn real_attributes(element: &Element, owner: &str) -> Result<RealAttributes> {
    Ok(RealAttributes {
        quantity: text(element, "quantity"),
        unit: text(element, "unit"),
        display_unit: text(element, "displayUnit"),
        min: number(element, owner, "min")?,
        max: number(element, owner, "max")?,
        nominal: number(element, owner, "nominal")?,
    })
}

/// Refuses a unit or display unit without definition.
fn defined(attributes: &RealAttributes, units: &[Unit], owner: &str, line: usize) -> Result<()> {
    let undefined = |what, name: &str| DescriptionError::Undefined {
        line,
        owner: owner.to_owned(),
        what,
        name: name.to_owned(),
    };
    let Some(name) = &attributes.unit else {
        return Ok(());
    };
    let Some(unit) = units.iter().find(|unit| unit.name == *name) else {
        return Err(undefined("unit", name));
    };
    match &attributes.display_unit {
        Some(name) if !unit.display_units.iter().any(|display| display.name == *name) => {
            Err(undefined("display unit", name))
        }
        _ => Ok(()),
    }
}

/// The one child that gives the type.
fn typed(element: &Element) -> Result<&Element> {
    let known = ["Real", "Integer", "Boolean", "String", "Enumeration"];
    element
        .children
        .iter()
        .find(|child| known.contains(&child.name.as_str()))
        .ok_or_else(|| DescriptionError::MissingElement {
            line: element.line,
            element: owner(element).trim_matches(['<', '>']).to_owned(),
            child: "one of Real, Integer, Boolean, String, Enumeration",
        })
}

fn definition(element: &Element) -> Result<TypeDefinition> {
    let name = element.required("name")?.to_owned();
    let owner = owner(element);
    let child = typed(element)?;
    let shape = match child.name.as_str() {
        "Real" => TypeShape::Real(real_attributes(child, &owner)?),
        "Integer" => TypeShape::Integer {
            min: integer(child, &owner, "min")?,
            max: integer(child, &owner, "max")?,
        },
        "Boolean" => TypeShape::Boolean,
        "String" => TypeShape::String,
        _ => TypeShape::Enumeration(
            child
                .children
                .iter()
                .filter(|item| item.name == "Item")
                .map(|item| {
                    item.required("value")?;
                    let value = integer(item, &owner, "value")?.unwrap_or(0);
                    Ok(EnumerationItem {
                        name: item.required("name")?.to_owned(),
                        value,
                    })
                })
                .collect::<Result<_>>()?,
        ),
    };
    Ok(TypeDefinition {
        name,
        description: text(element, "description"),
        shape,
    })
}

fn variables(root: &Element, description: &ModelDescription) -> Result<Vec<Variable>> {
    let Some(list) = root.child("ModelVariables") else {
        let child = "ModelVariables";
        return Err(DescriptionError::MissingElement {
            line: root.line,
            element: root.name.clone(),
            child,
        });
    };
    let elements: Vec<_> = list
        .children
        .iter()
        .filter(|child| child.name == "ScalarVariable")
        .collect();
    if elements.len() > MAX_VARIABLES {
        return Err(DescriptionError::TooMany {
            line: list.line,
            limit: MAX_VARIABLES,
        });
    }
    unique("variable", elements.iter().copied())?;
    elements
        .iter()
        .map(|element| variable(element, elements.len(), description))
        .collect()
}

fn variable(element: &Element, count: usize, description: &ModelDescription) -> Result<Variable> {
    let owner = owner(element);
    element.required("valueReference")?;
    let value_reference: Option<u32> =
        parsed(element, &owner, "valueReference", "a whole number from 0 to 4294967295")?;
    let causality = match element.attribute("causality") {
        None | Some("local") => Causality::Local,
        Some("parameter") => Causality::Parameter,
        Some("calculatedParameter") => Causality::CalculatedParameter,
        Some("input") => Causality::Input,
        Some("output") => Causality::Output,
        Some("independent") => Causality::Independent,
        Some(value) => {
            let expected = "parameter, calculatedParameter, input, output, local or independent";
            return Err(bad(element, &owner, "causality", value, expected));
        }
    };
    let variability = match element.attribute("variability") {
        None | Some("continuous") => Variability::Continuous,
        Some("constant") => Variability::Constant,
        Some("fixed") => Variability::Fixed,
        Some("tunable") => Variability::Tunable,
        Some("discrete") => Variability::Discrete,
        Some(value) => {
            let expected = "constant, fixed, tunable, discrete or continuous";
            return Err(bad(element, &owner, "variability", value, expected));
        }
    };
    let initial = match element.attribute("initial") {
        None => Variable::default_initial(causality, variability),
        Some("exact") => Some(Initial::Exact),
        Some("approx") => Some(Initial::Approx),
        Some("calculated") => Some(Initial::Calculated),
        Some(value) => {
            return Err(bad(element, &owner, "initial", value, "exact, approx or calculated"));
        }
    };
    let child = typed(element)?;
    let declared_type = text(child, "declaredType");
    if let Some(name) = &declared_type
        && !description.types.iter().any(|definition| definition.name == *name)
    {
        return Err(DescriptionError::Undefined {
            line: child.line,
            owner,
            what: "type",
            name: name.clone(),
        });
    }
    let kind = match child.name.as_str() {
        "Real" => {
            let attributes = real_attributes(child, &owner)?;
            defined(&attributes, &description.units, &owner, child.line)?;
            Kind::Real {
                attributes,
                start: number(child, &owner, "start")?,
                derivative_of: match child.attribute("derivative") {
                    Some(value) => Some(index(child, &owner, "derivative", value, count)?),
                    None => None,
                },
            }
        }
        "Integer" => Kind::Integer {
            min: integer(child, &owner, "min")?,
            max: integer(child, &owner, "max")?,
            start: integer(child, &owner, "start")?,
        },
        "Boolean" => Kind::Boolean {
            start: boolean(child, &owner, "start")?,
        },
        "String" => Kind::String {
            start: text(child, "start"),
        },
        _ => Kind::Enumeration {
            start: integer(child, &owner, "start")?,
        },
    };
    Ok(Variable {
        name: element.required("name")?.to_owned(),
        value_reference: value_reference.unwrap_or(0),
        description: text(element, "description"),
        causality,
        variability,
        initial,
        declared_type,
        kind,
        dependencies: None,
        initial_dependencies: None,
    })
}

/// A position from 1, as the model structure counts, turned into one from 0.
fn index(element: &Element, owner: &str, attribute: &str, value: &str, count: usize) -> Result<usize> {
    match value.parse::<usize>() {
        Ok(index) if (1..=count).contains(&index) => Ok(index - 1),
        _ => Err(bad(
            element,
            owner,
            attribute,
            value,
            "the position of a variable, counted from 1",
        )),
    }
}

fn structure(root: &Element, variables: &mut [Variable]) -> Result<()> {
    let Some(structure) = root.child("ModelStructure") else {
        let child = "ModelStructure";
        return Err(DescriptionError::MissingElement {
            line: root.line,
            element: root.name.clone(),
            child,
        });
    };
    for (list, initial) in [("Outputs", false), ("InitialUnknowns", true)] {
        for unknown in structure.members(list, "Unknown") {
            let owner = format!("<Unknown> in <{list}>");
            let position = index(unknown, &owner, "index", unknown.required("index")?, variables.len())?;
            let dependencies = unknown
                .attribute("dependencies")
                .map(|list| {
                    list.split_ascii_whitespace()
                        .map(|value| index(unknown, &owner, "dependencies", value, variables.len()))
                        .collect::<Result<Vec<_>>>()
                })
                .transpose()?;
            if initial {
                variables[position].initial_dependencies = dependencies;
            } else {
                variables[position].dependencies = dependencies;
            }
        }
    }
    Ok(())
}
