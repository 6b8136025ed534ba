//! XML to documents. Elements are known by namespace and name, whatever their prefix; what is foreign is passed over.

use std::path::Path;
use std::str::FromStr;

use fmi2::model_description::{BASE_UNITS, BaseUnit, xml};

use super::document::{
    Binding, Component, Connection, Connector, ConnectorKind, Description, End, Experiment, Linear, MappingEntry, Own,
    Parameter, ParameterSet, Source, System, Type, Unit, Value,
};
use super::{ANNOTATION, NAMESPACES, OWN, SspError};

type Result<T> = std::result::Result<T, SspError>;

/// A file of an archive, for messages.
#[derive(Clone, Copy)]
pub(super) struct File<'a> {
    pub archive: &'a Path,
    pub name: &'a str,
}

impl File<'_> {
    pub fn refuse(&self, line: usize, problem: impl std::fmt::Display) -> SspError {
        SspError::Element {
            path: self.archive.to_owned(),
            file: self.name.to_owned(),
            line,
            problem: problem.to_string(),
        }
    }

    fn parsed(&self, bytes: &[u8]) -> Result<xml::Element> {
        xml::parse(bytes, xml::Annotations::Kept).map_err(|problem| SspError::Xml {
            path: self.archive.to_owned(),
            file: self.name.to_owned(),
            problem: Box::new(problem),
        })
    }
}

/// Declarations of namespaces in force: prefix and URI, the innermost last.
type Scope<'a> = Vec<(&'a str, &'a str)>;

/// An element with its namespace.
struct Node<'a> {
    file: File<'a>,
    element: &'a xml::Element,
    scope: Scope<'a>,
}

impl<'a> Node<'a> {
    fn of(file: File<'a>, element: &'a xml::Element, outer: &[(&'a str, &'a str)]) -> Self {
        let mut scope = outer.to_vec();
        for (key, uri) in &element.attributes {
            if let Some(prefix) = key.strip_prefix("xmlns") {
                scope.push((prefix.trim_start_matches(':'), uri));
            }
        }
        Self { file, element, scope }
    }

    /// Prefix of the specification, or our own `own`, and the name.
    fn name(&self) -> (&'static str, &'a str) {
        let (prefix, name) = self.element.name.split_once(':').unwrap_or(("", &self.element.name));
        let uri = self
            .scope
            .iter()
            .rev()
            .find(|(known, _)| *known == prefix)
            .map(|(_, uri)| *uri);
        let known = uri.and_then(|uri| {
            let standard = NAMESPACES
                .iter()
                .find(|(_, known)| *known == uri)
                .map(|(prefix, _)| *prefix);
            standard.or((uri == OWN).then_some("own"))
        });
        (known.unwrap_or(""), name)
    }

    fn children(&self) -> impl Iterator<Item = Node<'a>> + '_ {
        let (file, element) = (self.file, self.element);
        element
            .children
            .iter()
            .map(move |child| Node::of(file, child, &self.scope))
    }

    fn child(&self, namespace: &str, name: &str) -> Option<Node<'a>> {
        self.children().find(|child| child.name() == (namespace, name))
    }

    /// Members of a list, such as `Connector` in `Connectors`.
    fn members(&self, namespace: &str, list: &str, name: &str) -> Vec<Node<'a>> {
        let Some(list) = self.child(namespace, list) else {
            return Vec::new();
        };
        list.children().filter(|child| child.name().1 == name).collect()
    }

    fn line(&self) -> usize {
        self.element.line
    }

    fn attribute(&self, name: &str) -> Option<&'a str> {
        self.element.attribute(name)
    }

    fn text(&self, name: &str) -> Option<String> {
        self.attribute(name).map(str::to_owned)
    }

    fn required(&self, name: &str) -> Result<&'a str> {
        self.attribute(name)
            .ok_or_else(|| self.refuse(format!("<{}> lacks the attribute {name}", self.element.name)))
    }

    fn refuse(&self, problem: impl std::fmt::Display) -> SspError {
        self.file.refuse(self.line(), problem)
    }

    fn parsed<T: FromStr>(&self, name: &str, expected: &str) -> Result<Option<T>> {
        let Some(value) = self.attribute(name) else {
            return Ok(None);
        };
        let parsed = value.trim().parse().map(Some);
        parsed.map_err(|_| self.bad(name, value, expected))
    }

    fn bad(&self, name: &str, value: &str, expected: &str) -> SspError {
        self.refuse(format!(
            "{name} of <{}> is \"{value}\", expected {expected}",
            self.element.name
        ))
    }

    fn number(&self, name: &str) -> Result<Option<f64>> {
        let expected = "a finite number";
        match self.parsed(name, expected)? {
            Some(value) if !f64::is_finite(value) => {
                Err(self.bad(name, self.attribute(name).unwrap_or_default(), expected))
            }
            value => Ok(value),
        }
    }

    fn flag(&self, name: &str) -> Result<bool> {
        match self.attribute(name) {
            None | Some("false" | "0") => Ok(false),
            Some("true" | "1") => Ok(true),
            Some(value) => Err(self.bad(name, value, "true or false")),
        }
    }

    /// Refuses a document that is something else, or of another version.
    fn expect(&self, namespace: &str, name: &str) -> Result<()> {
        if self.name() != (namespace, name) {
            let uri = NAMESPACES
                .iter()
                .find(|(prefix, _)| *prefix == namespace)
                .map_or("", |(_, uri)| uri);
            return Err(self.refuse(format!(
                "the element is <{}>, expected {namespace}:{name} of namespace {uri}",
                self.element.name
            )));
        }
        let version = self.required("version")?;
        // A minor version adds what may be passed over.
        if version != "1" && !version.starts_with("1.") {
            return Err(self.bad("version", version, "1.0"));
        }
        Ok(())
    }
}

/// Reads a `.ssd`.
pub(super) fn description(bytes: &[u8], file: File<'_>) -> Result<Description> {
    let root = file.parsed(bytes)?;
    let root = Node::of(file, &root, &[]);
    root.expect("ssd", "SystemStructureDescription")?;
    let system_node = root
        .child("ssd", "System")
        .ok_or_else(|| root.refuse("the description has no ssd:System"))?;
    let experiment = match root.child("ssd", "DefaultExperiment") {
        Some(node) => Experiment {
            start: node.number("startTime")?,
            stop: node.number("stopTime")?,
        },
        None => Experiment::default(),
    };
    Ok(Description {
        name: root.required("name")?.to_owned(),
        description: root.text("description"),
        system: system(&system_node)?,
        units: units(&root, "ssd")?,
        experiment,
        own: own(&root)?,
    })
}

/// Content of our annotation, where there is one.
fn own(root: &Node<'_>) -> Result<Option<Own>> {
    let annotations = root.members("ssd", "Annotations", "Annotation");
    let Some(annotation) = annotations
        .iter()
        .find(|node| node.attribute("type") == Some(ANNOTATION))
    else {
        return Ok(None);
    };
    let Some(content) = annotation.child("own", "CoSimulation") else {
        return Ok(None);
    };
    let coupling = content.child("own", "Coupling");
    let settings = coupling.map_or_else(Vec::new, |node| node.element.attributes.clone());
    Ok(Some(Own {
        scene: content.required("scene")?.to_owned(),
        digest: content.required("digest")?.to_owned(),
        coupling: settings,
    }))
}

fn units(node: &Node<'_>, namespace: &str) -> Result<Vec<Unit>> {
    let unit = |node: &Node<'_>| {
        let base = match node.child("ssc", "BaseUnit") {
            Some(base) => {
                let mut exponents = [0; 8];
                for (exponent, name) in exponents.iter_mut().zip(BASE_UNITS) {
                    *exponent = base.parsed(name, "a whole number")?.unwrap_or(0);
                }
                let factor = base.number("factor")?.unwrap_or(1.0);
                if factor == 0.0 {
                    return Err(base.bad("factor", "0", "a number other than 0"));
                }
                let offset = base.number("offset")?.unwrap_or(0.0);
                Some(BaseUnit {
                    exponents,
                    factor,
                    offset,
                })
            }
            None => None,
        };
        Ok(Unit {
            name: node.required("name")?.to_owned(),
            base,
            display_units: Vec::new(),
        })
    };
    node.members(namespace, "Units", "Unit").iter().map(unit).collect()
}

fn system(node: &Node<'_>) -> Result<System> {
    let name = node.required("name")?.to_owned();
    if let Some(dictionary) = node.child("ssd", "SignalDictionaries") {
        let problem = "signal dictionaries are not supported: connect the components directly";
        return Err(dictionary.refuse(format!("system \"{name}\": {problem}")));
    }
    let mut components = Vec::new();
    if let Some(elements) = node.child("ssd", "Elements") {
        for element in elements.children() {
            match element.name() {
                ("ssd", "Component") => components.push(component(&element)?),
                ("ssd", kind @ ("System" | "SignalDictionaryReference")) => {
                    let inner = element.attribute("name").unwrap_or_default();
                    let what = match kind {
                        "System" => "a nested system is not supported: move its components into the outer system",
                        _ => "signal dictionaries are not supported: connect the components directly",
                    };
                    return Err(element.refuse(format!("element \"{inner}\": {what}")));
                }
                _ => {}
            }
        }
    }
    for (index, component) in components.iter().enumerate() {
        if let Some(first) = components[..index].iter().find(|other| other.name == component.name) {
            let problem = format!(
                "the component name \"{}\" is used twice, first at line {}",
                component.name, first.line
            );
            return Err(node.file.refuse(component.line, problem));
        }
    }
    Ok(System {
        name,
        description: node.text("description"),
        connectors: connectors(node)?,
        components,
        connections: node
            .members("ssd", "Connections", "Connection")
            .iter()
            .map(connection)
            .collect::<Result<_>>()?,
        bindings: bindings(node)?,
    })
}

fn component(node: &Node<'_>) -> Result<Component> {
    let name = node.required("name")?.to_owned();
    let kind = node.attribute("type").unwrap_or("application/x-fmu-sharedlibrary");
    if kind != "application/x-fmu-sharedlibrary" {
        let problem = format!("component \"{name}\": the type {kind} is not supported, expected an FMU");
        return Err(node.refuse(problem));
    }
    if node.attribute("implementation") == Some("ModelExchange") {
        let problem =
            format!("component \"{name}\": implementation ModelExchange is not supported, expected CoSimulation");
        return Err(node.refuse(problem));
    }
    Ok(Component {
        description: node.text("description"),
        source: node.required("source")?.to_owned(),
        connectors: connectors(node)?,
        bindings: bindings(node)?,
        line: node.line(),
        name,
    })
}

fn connectors(node: &Node<'_>) -> Result<Vec<Connector>> {
    let connector = |node: &Node<'_>| {
        let kind = match node.required("kind")? {
            "input" => ConnectorKind::Input,
            "output" => ConnectorKind::Output,
            "parameter" => ConnectorKind::Parameter,
            "calculatedParameter" => ConnectorKind::CalculatedParameter,
            other => return Err(node.bad("kind", other, "input, output, parameter or calculatedParameter")),
        };
        let known = ["Real", "Integer", "Boolean", "String", "Enumeration", "Binary"];
        let value = node.children().find(|child| known.contains(&child.name().1));
        Ok(Connector {
            name: node.required("name")?.to_owned(),
            kind,
            value: value.map(|value| match value.name().1 {
                "Real" => Type::Real {
                    unit: value.text("unit"),
                },
                other => Type::Other(other.to_owned()),
            }),
            line: node.line(),
        })
    };
    node.members("ssd", "Connectors", "Connector")
        .iter()
        .map(connector)
        .collect()
}

/// The transformation of a connection or of a mapping entry.
fn transformation(node: &Node<'_>) -> Result<Linear> {
    for child in node.children() {
        match child.name().1 {
            "LinearTransformation" => {
                let factor = child.number("factor")?.unwrap_or(1.0);
                if factor == 0.0 {
                    return Err(child.bad("factor", "0", "a number other than 0"));
                }
                let offset = child.number("offset")?.unwrap_or(0.0);
                return Ok(Linear { factor, offset });
            }
            other if other.ends_with("MappingTransformation") => {
                return Err(child.refuse(format!(
                    "{other} is not supported: only real signals are connected, by a LinearTransformation"
                )));
            }
            _ => {}
        }
    }
    Ok(Linear::IDENTITY)
}

fn connection(node: &Node<'_>) -> Result<Connection> {
    let end = |element: &str, connector: &str| {
        Ok::<End, SspError>(End {
            element: node.text(element),
            connector: node.required(connector)?.to_owned(),
        })
    };
    Ok(Connection {
        start: end("startElement", "startConnector")?,
        end: end("endElement", "endConnector")?,
        map: transformation(node)?,
        suppress_unit_conversion: node.flag("suppressUnitConversion")?,
        line: node.line(),
    })
}

/// `source` and `sourceBase` of a binding or a mapping.
fn source<T>(node: &Node<'_>, uri: &str) -> Result<Source<T>> {
    match node.attribute("sourceBase") {
        None | Some("SSD") => Ok(Source::File(uri.to_owned())),
        Some("component") => Ok(Source::InComponent(uri.to_owned())),
        Some(other) => Err(node.bad("sourceBase", other, "SSD or component")),
    }
}

fn typed(node: &Node<'_>, expected: &str) -> Result<()> {
    match node.attribute("type") {
        Some(found) if found != expected => Err(node.bad("type", found, expected)),
        _ => Ok(()),
    }
}

fn bindings(node: &Node<'_>) -> Result<Vec<Binding>> {
    let binding = |node: &Node<'_>| {
        typed(node, "application/x-ssp-parameter-set")?;
        let values = match (node.attribute("source"), node.child("ssd", "ParameterValues")) {
            (Some(uri), _) => source(node, uri)?,
            (None, Some(values)) => {
                let set = values.child("ssv", "ParameterSet");
                let set = set.ok_or_else(|| values.refuse("ssd:ParameterValues has no ssv:ParameterSet"))?;
                Source::Inline(parameters(&set)?)
            }
            (None, None) => {
                return Err(node.refuse("a parameter binding needs either source or ssd:ParameterValues"));
            }
        };
        let mapping = match node.child("ssd", "ParameterMapping") {
            Some(mapping) => {
                typed(&mapping, "application/x-ssp-parameter-mapping")?;
                Some(
                    match (mapping.attribute("source"), mapping.child("ssm", "ParameterMapping")) {
                        (Some(uri), _) => source(&mapping, uri)?,
                        (None, Some(content)) => Source::Inline(entries(&content)?),
                        (None, None) => {
                            return Err(
                                mapping.refuse("a parameter mapping needs either source or ssm:ParameterMapping")
                            );
                        }
                    },
                )
            }
            None => None,
        };
        Ok(Binding {
            prefix: node.text("prefix").unwrap_or_default(),
            values,
            mapping,
            line: node.line(),
        })
    };
    node.members("ssd", "ParameterBindings", "ParameterBinding")
        .iter()
        .map(binding)
        .collect()
}

/// Reads a `.ssv`.
pub(super) fn parameter_set(bytes: &[u8], file: File<'_>) -> Result<ParameterSet> {
    let root = file.parsed(bytes)?;
    parameters(&Node::of(file, &root, &[]))
}

fn parameters(node: &Node<'_>) -> Result<ParameterSet> {
    node.expect("ssv", "ParameterSet")?;
    let parameter = |node: &Node<'_>| {
        let name = node.required("name")?.to_owned();
        let known = ["Real", "Integer", "Boolean", "String", "Enumeration", "Binary"];
        let child = node.children().find(|child| known.contains(&child.name().1));
        let child = child.ok_or_else(|| node.refuse(format!("parameter \"{name}\" has no value")))?;
        let text = child.required("value")?;
        let value = match child.name().1 {
            "Real" => Value::Real {
                value: child.number("value")?.unwrap_or_default(),
                unit: child.text("unit"),
            },
            "Integer" => Value::Integer(child.parsed("value", "a whole number of 32 bits")?.unwrap_or_default()),
            "Boolean" => Value::Boolean(child.flag("value")?),
            "String" => Value::String(text.to_owned()),
            "Enumeration" => Value::Enumeration(text.to_owned()),
            other => return Err(child.refuse(format!("parameter \"{name}\": the type {other} is not supported"))),
        };
        Ok(Parameter {
            name,
            value,
            line: node.line(),
        })
    };
    Ok(ParameterSet {
        name: node.text("name").unwrap_or_default(),
        parameters: node
            .members("ssv", "Parameters", "Parameter")
            .iter()
            .map(parameter)
            .collect::<Result<_>>()?,
        units: units(node, "ssv")?,
    })
}

/// Reads a `.ssm`.
pub(super) fn mapping(bytes: &[u8], file: File<'_>) -> Result<Vec<MappingEntry>> {
    let root = file.parsed(bytes)?;
    entries(&Node::of(file, &root, &[]))
}

fn entries(node: &Node<'_>) -> Result<Vec<MappingEntry>> {
    node.expect("ssm", "ParameterMapping")?;
    let entry = |node: Node<'_>| {
        Ok(MappingEntry {
            source: node.required("source")?.to_owned(),
            target: node.required("target")?.to_owned(),
            map: transformation(&node)?,
            suppress_unit_conversion: node.flag("suppressUnitConversion")?,
        })
    };
    node.children()
        .filter(|child| child.name() == ("ssm", "MappingEntry"))
        .map(entry)
        .collect()
}
