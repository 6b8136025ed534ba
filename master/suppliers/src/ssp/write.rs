//! Documents to XML: elements in the order of the schema, attributes in a fixed order.

use std::fmt::Write as _;

use fmi2::model_description::{BASE_UNITS, escaped};

use super::document::{
    Binding, Component, Connection, Connector, Description, Linear, ParameterSet, Source, System, Type, Unit, Value,
};
use super::{ANNOTATION, NAMESPACES, OWN};

/// A document under construction.
#[derive(Default)]
struct Writer {
    text: String,
    depth: usize,
}

impl Writer {
    fn begin(&mut self, name: &str, attributes: &[(&str, Option<&str>)], end: &str) {
        let _ = write!(self.text, "{:1$}<{name}", "", 2 * self.depth);
        for (key, value) in attributes {
            if let Some(value) = value {
                let _ = write!(self.text, " {key}=\"{}\"", escaped(value));
            }
        }
        self.text.push_str(end);
    }

    fn empty(&mut self, name: &str, attributes: &[(&str, Option<&str>)]) {
        self.begin(name, attributes, "/>\n");
    }

    fn element(&mut self, name: &str, attributes: &[(&str, Option<&str>)], content: impl FnOnce(&mut Self)) {
        self.begin(name, attributes, ">\n");
        self.depth += 1;
        content(self);
        self.depth -= 1;
        let _ = writeln!(self.text, "{:1$}</{name}>", "", 2 * self.depth);
    }

    /// A list that the schema does not allow to be empty.
    fn list<T>(&mut self, name: &str, members: &[T], mut member: impl FnMut(&mut Self, &T)) {
        if !members.is_empty() {
            self.element(name, &[], |writer| members.iter().for_each(|item| member(writer, item)));
        }
    }
}

/// Shortest decimal form that reads back to the same bits.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn document(root: &str, prefixes: &[&str], more: &[(&str, Option<&str>)], content: impl FnOnce(&mut Writer)) -> String {
    let declared: Vec<(String, &str)> = NAMESPACES
        .iter()
        .filter(|(prefix, _)| prefixes.contains(prefix))
        .map(|(prefix, uri)| (format!("xmlns:{prefix}"), *uri))
        .collect();
    let mut attributes: Vec<(&str, Option<&str>)> =
        declared.iter().map(|(name, uri)| (name.as_str(), Some(*uri))).collect();
    attributes.push(("version", Some("1.0")));
    attributes.extend(more);
    let tool = format!("Pantoline master {}", env!("CARGO_PKG_VERSION"));
    attributes.push(("generationTool", Some(&tool)));
    let mut writer = Writer::default();
    writer.text.push_str("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    writer.element(root, &attributes, content);
    writer.text
}

/// `SystemStructure.ssd`.
pub(super) fn description(d: &Description) -> String {
    let attributes = [
        ("name", Some(d.name.as_str())),
        ("description", d.description.as_deref()),
    ];
    document(
        "ssd:SystemStructureDescription",
        &["ssd", "ssc"],
        &attributes,
        |writer| {
            system(writer, &d.system);
            writer.list("ssd:Units", &d.units, unit);
            let [start, stop] = [d.experiment.start, d.experiment.stop].map(|time| time.map(number));
            let times = [("startTime", start.as_deref()), ("stopTime", stop.as_deref())];
            writer.empty("ssd:DefaultExperiment", &times);
            if let Some(own) = &d.own {
                writer.element("ssd:Annotations", &[], |writer| {
                    writer.element("ssc:Annotation", &[("type", Some(ANNOTATION))], |writer| {
                        let attributes = [
                            ("xmlns", Some(OWN)),
                            ("scene", Some(own.scene.as_str())),
                            ("digest", Some(own.digest.as_str())),
                        ];
                        writer.element("CoSimulation", &attributes, |writer| {
                            let settings: Vec<(&str, Option<&str>)> = own
                                .coupling
                                .iter()
                                .map(|(key, value)| (key.as_str(), Some(value.as_str())))
                                .collect();
                            writer.empty("Coupling", &settings);
                        });
                    });
                });
            }
        },
    )
}

/// Meaning of a description, for comparing: all but names, tools and annotations.
pub(super) fn meaning(d: &Description) -> String {
    let mut writer = Writer::default();
    system(&mut writer, &d.system);
    writer.list("ssd:Units", &d.units, unit);
    let _ = write!(writer.text, "{:?}", d.experiment);
    writer.text
}

fn system(writer: &mut Writer, system: &System) {
    let attributes = [
        ("name", Some(system.name.as_str())),
        ("description", system.description.as_deref()),
    ];
    writer.element("ssd:System", &attributes, |writer| {
        writer.list("ssd:Connectors", &system.connectors, connector);
        writer.list("ssd:ParameterBindings", &system.bindings, binding);
        writer.list("ssd:Elements", &system.components, component);
        writer.list("ssd:Connections", &system.connections, connection);
    });
}

fn component(writer: &mut Writer, component: &Component) {
    let attributes = [
        ("name", Some(component.name.as_str())),
        ("description", component.description.as_deref()),
        ("type", Some("application/x-fmu-sharedlibrary")),
        ("source", Some(component.source.as_str())),
        ("implementation", Some("CoSimulation")),
    ];
    writer.element("ssd:Component", &attributes, |writer| {
        writer.list("ssd:Connectors", &component.connectors, connector);
        writer.list("ssd:ParameterBindings", &component.bindings, binding);
    });
}

fn connector(writer: &mut Writer, connector: &Connector) {
    let attributes = [
        ("name", Some(connector.name.as_str())),
        ("kind", Some(connector.kind.name())),
    ];
    let Some(value) = &connector.value else {
        return writer.empty("ssd:Connector", &attributes);
    };
    writer.element("ssd:Connector", &attributes, |writer| match value {
        Type::Real { unit } => writer.empty("ssc:Real", &[("unit", unit.as_deref())]),
        Type::Other(name) => writer.empty(&format!("ssc:{name}"), &[]),
    });
}

fn connection(writer: &mut Writer, connection: &Connection) {
    let attributes = [
        ("startElement", connection.start.element.as_deref()),
        ("startConnector", Some(connection.start.connector.as_str())),
        ("endElement", connection.end.element.as_deref()),
        ("endConnector", Some(connection.end.connector.as_str())),
        (
            "suppressUnitConversion",
            connection.suppress_unit_conversion.then_some("true"),
        ),
    ];
    if connection.map == Linear::IDENTITY {
        return writer.empty("ssd:Connection", &attributes);
    }
    writer.element("ssd:Connection", &attributes, |writer| {
        let (factor, offset) = (number(connection.map.factor), number(connection.map.offset));
        writer.empty(
            "ssc:LinearTransformation",
            &[("factor", Some(&factor)), ("offset", Some(&offset))],
        );
    });
}

/// Bindings are written to files only.
fn binding(writer: &mut Writer, binding: &Binding) {
    if let Source::File(source) = &binding.values {
        let prefix = Some(binding.prefix.as_str()).filter(|prefix| !prefix.is_empty());
        let attributes = [
            ("type", Some("application/x-ssp-parameter-set")),
            ("source", Some(source.as_str())),
            ("prefix", prefix),
        ];
        writer.empty("ssd:ParameterBinding", &attributes);
    }
}

fn unit(writer: &mut Writer, unit: &Unit) {
    let base = unit.base.unwrap_or_default();
    let mut attributes: Vec<(&str, String)> = BASE_UNITS
        .into_iter()
        .zip(base.exponents)
        .filter(|(_, exponent)| *exponent != 0)
        .map(|(name, exponent)| (name, exponent.to_string()))
        .collect();
    for (name, value, default) in [("factor", base.factor, 1.0), ("offset", base.offset, 0.0)] {
        if value != default {
            attributes.push((name, number(value)));
        }
    }
    let attributes: Vec<(&str, Option<&str>)> = attributes
        .iter()
        .map(|(name, value)| (*name, Some(value.as_str())))
        .collect();
    writer.element("ssc:Unit", &[("name", Some(unit.name.as_str()))], |writer| {
        writer.empty("ssc:BaseUnit", &attributes);
    });
}

/// A `.ssv` file.
pub(super) fn parameter_set(set: &ParameterSet) -> String {
    document(
        "ssv:ParameterSet",
        &["ssv", "ssc"],
        &[("name", Some(set.name.as_str()))],
        |writer| {
            writer.element("ssv:Parameters", &[], |writer| {
                for parameter in &set.parameters {
                    writer.element("ssv:Parameter", &[("name", Some(parameter.name.as_str()))], |writer| {
                        let (kind, value, unit) = match &parameter.value {
                            Value::Real { value, unit } => ("Real", number(*value), unit.as_deref()),
                            Value::Integer(value) => ("Integer", value.to_string(), None),
                            Value::Boolean(value) => ("Boolean", value.to_string(), None),
                            Value::String(value) => ("String", value.clone(), None),
                            Value::Enumeration(value) => ("Enumeration", value.clone(), None),
                        };
                        writer.empty(&format!("ssv:{kind}"), &[("value", Some(&value)), ("unit", unit)]);
                    });
                }
            });
            writer.list("ssv:Units", &set.units, unit);
        },
    )
}
