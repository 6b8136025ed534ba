//! Writing: element order of the schema, attributes in a fixed order, one element per line.

use super::{
    BASE_UNITS, Causality, DisplayUnit, Initial, Kind, ModelDescription, RealAttributes, TypeShape, Unit, Variability,
    Variable,
};
use std::fmt::Write as _;

/// Start tag under construction.
struct Tag {
    text: String,
}

impl Tag {
    fn new(depth: usize, name: &str) -> Self {
        Self {
            text: format!("{:1$}<{name}", "", 2 * depth),
        }
    }

    fn attribute(mut self, name: &str, value: &str) -> Self {
        let _ = write!(self.text, " {name}=\"{}\"", escaped(value));
        self
    }

    fn optional(self, name: &str, value: Option<&str>) -> Self {
        match value {
            Some(value) => self.attribute(name, value),
            None => self,
        }
    }

    /// Shortest decimal form that reads back to the same bits.
    fn number(self, name: &str, value: Option<f64>) -> Self {
        self.optional(name, value.map(|value| format!("{value:?}")).as_deref())
    }

    fn integer(self, name: &str, value: Option<i32>) -> Self {
        self.optional(name, value.map(|value| value.to_string()).as_deref())
    }

    /// Writes the flag only if it differs from the default of the schema.
    fn flag(self, name: &str, value: bool) -> Self {
        if value { self.attribute(name, "true") } else { self }
    }

    fn open(self, out: &mut String) {
        out.push_str(&self.text);
        out.push_str(">\n");
    }

    fn close(self, out: &mut String) {
        out.push_str(&self.text);
        out.push_str("/>\n");
    }
}

/// `text` as the value of an XML attribute.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\r' | '\t' => {
                let _ = write!(out, "&#{};", c as u32);
            }
            _ => out.push(c),
        }
    }
    out
}

pub(super) fn write(d: &ModelDescription) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    Tag::new(0, "fmiModelDescription")
        .attribute("fmiVersion", "2.0")
        .attribute("modelName", &d.model_name)
        .attribute("guid", &d.guid)
        .optional("description", d.description.as_deref())
        .optional("author", d.author.as_deref())
        .optional("version", d.version.as_deref())
        .optional("generationTool", d.generation_tool.as_deref())
        .optional("variableNamingConvention", d.structured_names.then_some("structured"))
        .open(&mut out);
    co_simulation(d, &mut out);
    if !d.units.is_empty() {
        Tag::new(1, "UnitDefinitions").open(&mut out);
        d.units.iter().for_each(|definition| unit(definition, &mut out));
        out.push_str("  </UnitDefinitions>\n");
    }
    if !d.types.is_empty() {
        types(d, &mut out);
    }
    if !d.log_categories.is_empty() {
        Tag::new(1, "LogCategories").open(&mut out);
        for category in &d.log_categories {
            Tag::new(2, "Category")
                .attribute("name", &category.name)
                .optional("description", category.description.as_deref())
                .close(&mut out);
        }
        out.push_str("  </LogCategories>\n");
    }
    if let Some(experiment) = d.default_experiment {
        Tag::new(1, "DefaultExperiment")
            .number("startTime", experiment.start_time)
            .number("stopTime", experiment.stop_time)
            .number("tolerance", experiment.tolerance)
            .number("stepSize", experiment.step_size)
            .close(&mut out);
    }
    Tag::new(1, "ModelVariables").open(&mut out);
    for (position, v) in d.variables.iter().enumerate() {
        let _ = writeln!(out, "    <!-- {} -->", position + 1);
        variable(v, &mut out);
    }
    out.push_str("  </ModelVariables>\n");
    structure(d, &mut out);
    out.push_str("</fmiModelDescription>\n");
    out
}

fn co_simulation(d: &ModelDescription, out: &mut String) {
    let c = &d.co_simulation;
    let order = c.max_output_derivative_order;
    Tag::new(1, "CoSimulation")
        .attribute("modelIdentifier", &c.model_identifier)
        .flag("needsExecutionTool", c.needs_execution_tool)
        .flag(
            "canHandleVariableCommunicationStepSize",
            c.can_handle_variable_communication_step_size,
        )
        .flag("canInterpolateInputs", c.can_interpolate_inputs)
        .optional(
            "maxOutputDerivativeOrder",
            (order > 0).then(|| order.to_string()).as_deref(),
        )
        .flag("canRunAsynchronuously", c.can_run_asynchronously) // spelling of the schema
        .flag(
            "canBeInstantiatedOnlyOncePerProcess",
            c.can_be_instantiated_only_once_per_process,
        )
        .flag(
            "canNotUseMemoryManagementFunctions",
            c.can_not_use_memory_management_functions,
        )
        .flag("canGetAndSetFMUstate", c.can_get_and_set_fmu_state)
        .flag("canSerializeFMUstate", c.can_serialize_fmu_state)
        .flag("providesDirectionalDerivative", c.provides_directional_derivative)
        .close(out);
}

fn unit(unit: &Unit, out: &mut String) {
    Tag::new(2, "Unit").attribute("name", &unit.name).open(out);
    if let Some(base) = &unit.base {
        let mut tag = Tag::new(3, "BaseUnit");
        for (name, exponent) in BASE_UNITS.iter().zip(base.exponents) {
            tag = tag.integer(name, (exponent != 0).then_some(exponent));
        }
        tag.number("factor", (base.factor != 1.0).then_some(base.factor))
            .number("offset", (base.offset != 0.0).then_some(base.offset))
            .close(out);
    }
    for DisplayUnit { name, factor, offset } in &unit.display_units {
        Tag::new(3, "DisplayUnit")
            .attribute("name", name)
            .number("factor", (*factor != 1.0).then_some(*factor))
            .number("offset", (*offset != 0.0).then_some(*offset))
            .close(out);
    }
    out.push_str("    </Unit>\n");
}

fn types(d: &ModelDescription, out: &mut String) {
    Tag::new(1, "TypeDefinitions").open(out);
    for definition in &d.types {
        Tag::new(2, "SimpleType")
            .attribute("name", &definition.name)
            .optional("description", definition.description.as_deref())
            .open(out);
        match &definition.shape {
            TypeShape::Real(attributes) => real_attributes(Tag::new(3, "Real"), attributes).close(out),
            TypeShape::Integer { min, max } => {
                Tag::new(3, "Integer")
                    .integer("min", *min)
                    .integer("max", *max)
                    .close(out);
            }
            TypeShape::Boolean => Tag::new(3, "Boolean").close(out),
            TypeShape::String => Tag::new(3, "String").close(out),
            TypeShape::Enumeration(items) => {
                Tag::new(3, "Enumeration").open(out);
                for item in items {
                    Tag::new(4, "Item")
                        .attribute("name", &item.name)
                        .integer("value", Some(item.value))
                        .close(out);
                }
                out.push_str("      </Enumeration>\n");
            }
        }
        out.push_str("    </SimpleType>\n");
    }
    out.push_str("  </TypeDefinitions>\n");
}

fn real_attributes(tag: Tag, attributes: &RealAttributes) -> Tag {
    tag.optional("quantity", attributes.quantity.as_deref())
        .optional("unit", attributes.unit.as_deref())
        .optional("displayUnit", attributes.display_unit.as_deref())
        .number("min", attributes.min)
        .number("max", attributes.max)
        .number("nominal", attributes.nominal)
}

fn variable(v: &Variable, out: &mut String) {
    let initial = v
        .initial
        .filter(|_| !matches!(v.causality, Causality::Input | Causality::Independent));
    Tag::new(2, "ScalarVariable")
        .attribute("name", &v.name)
        .attribute("valueReference", &v.value_reference.to_string())
        .optional("description", v.description.as_deref())
        .attribute("causality", causality_name(v.causality))
        .attribute("variability", variability_name(v.variability))
        .optional("initial", initial.map(initial_name))
        .open(out);
    let declared = v.declared_type.as_deref();
    match &v.kind {
        Kind::Real {
            attributes,
            start,
            derivative_of,
        } => {
            real_attributes(Tag::new(3, "Real").optional("declaredType", declared), attributes)
                .number("start", *start)
                .optional("derivative", derivative_of.map(|of| (of + 1).to_string()).as_deref())
                .close(out);
        }
        Kind::Integer { min, max, start } => Tag::new(3, "Integer")
            .optional("declaredType", declared)
            .integer("min", *min)
            .integer("max", *max)
            .integer("start", *start)
            .close(out),
        Kind::Boolean { start } => Tag::new(3, "Boolean")
            .optional("declaredType", declared)
            .optional("start", start.map(|start| if start { "true" } else { "false" }))
            .close(out),
        Kind::String { start } => Tag::new(3, "String")
            .optional("declaredType", declared)
            .optional("start", start.as_deref())
            .close(out),
        Kind::Enumeration { start } => Tag::new(3, "Enumeration")
            .optional("declaredType", declared)
            .integer("start", *start)
            .close(out),
    }
    out.push_str("    </ScalarVariable>\n");
}

/// `Outputs` and `InitialUnknowns` follow from the variables; indices are positions from 1.
fn structure(d: &ModelDescription, out: &mut String) {
    Tag::new(1, "ModelStructure").open(out);
    let mut list = |name: &str, keep: &dyn Fn(&Variable) -> bool, initial: bool| {
        let mut members = d.variables.iter().enumerate().filter(|(_, v)| keep(v)).peekable();
        if members.peek().is_none() {
            return;
        }
        Tag::new(2, name).open(out);
        for (position, v) in members {
            let dependencies = if initial {
                &v.initial_dependencies
            } else {
                &v.dependencies
            };
            let dependencies = dependencies.as_ref().map(|positions| {
                let indices: Vec<String> = positions.iter().map(|p| (p + 1).to_string()).collect();
                indices.join(" ")
            });
            Tag::new(3, "Unknown")
                .attribute("index", &(position + 1).to_string())
                .optional("dependencies", dependencies.as_deref())
                .close(out);
        }
        let _ = writeln!(out, "    </{name}>");
    };
    list("Outputs", &|v| v.causality == Causality::Output, false);
    list("InitialUnknowns", &Variable::is_initial_unknown, true);
    out.push_str("  </ModelStructure>\n");
}

fn causality_name(causality: Causality) -> &'static str {
    match causality {
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Local => "local",
        Causality::Independent => "independent",
    }
}

fn variability_name(variability: Variability) -> &'static str {
    match variability {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

fn initial_name(initial: Initial) -> &'static str {
    match initial {
        Initial::Exact => "exact",
        Initial::Approx => "approx",
        Initial::Calculated => "calculated",
    }
}
