//! Connections between components with their directions known, and the component that is the line.

use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality, Unit};

use super::SspError;
use super::document::{ConnectorKind, Description, End, Linear, Type};
use super::parameters::convert;
use super::problem::EndProblem;
use super::signals::{Tap, Wire, is_vertical, loads, motions};
use super::unpacked::Unpacked;

/// A connection with its direction known: components by position.
pub(super) struct Flow {
    pub from: usize,
    pub to: usize,
    pub source: Tap,
    pub target: Tap,
    map: Linear,
    line: usize,
}

impl Flow {
    /// The same, seen from the line: which of its variables, and which one of the pantograph.
    pub fn wire(&self, line: &Tap, pantograph: &Tap) -> Wire {
        Wire {
            line: line.clone(),
            pantograph: pantograph.clone(),
            map: self.map,
            at: self.line,
        }
    }
}

/// Connections between components, with their directions, units and types checked against the FMUs.
pub(super) fn flows(
    description: &Description,
    fmus: &[Fmu],
    unpacked: Unpacked<'_>,
    notes: &mut Vec<String>,
) -> Result<Vec<Flow>, SspError> {
    let system = &description.system;
    let file = unpacked.structure();
    let mut flows: Vec<Flow> = Vec::new();
    for connection in &system.connections {
        let (start, end) = (&connection.start, &connection.end);
        let refuse = |problem: String| file.refuse(connection.line, format!("connection {start} – {end}: {problem}"));
        let lost = |problem: EndProblem| refuse(problem.to_string());
        if start.element.is_none() || end.element.is_none() {
            let connectors = &system.connectors;
            for side in [start, end].into_iter().filter(|side| side.element.is_none()) {
                if !connectors.iter().any(|connector| connector.name == side.connector) {
                    return Err(refuse(format!("the system has no connector \"{}\"", side.connector)));
                }
            }
            notes.push(format!("connection {start} – {end}: leads out of the system, not used"));
            continue;
        }
        let (a, kind_a, tap_a) = terminal(description, fmus, start).map_err(lost)?;
        let (b, kind_b, tap_b) = terminal(description, fmus, end).map_err(lost)?;
        let (from, to, source, target) = match (kind_a, kind_b) {
            (ConnectorKind::Output, ConnectorKind::Input) => (a, b, tap_a, tap_b),
            (ConnectorKind::Input, ConnectorKind::Output) => (b, a, tap_b, tap_a),
            _ => {
                let problem = format!(
                    "it joins an {} to an {}, expected an output and an input",
                    kind_a.name(),
                    kind_b.name()
                );
                return Err(refuse(problem));
            }
        };
        let target_variable = (to, &target.variable);
        if flows
            .iter()
            .any(|flow| (flow.to, &flow.target.variable) == target_variable)
        {
            return Err(refuse(format!("the input \"{}\" is connected twice", target.variable)));
        }
        let conversion = match (&source.unit, &target.unit) {
            (Some(from), Some(to)) if !connection.suppress_unit_conversion => {
                convert((&from.name, Some(from)), (&to.name, Some(to)))
                    .map_err(|problem| refuse(problem.to_string()))?
            }
            _ => Linear::IDENTITY,
        };
        flows.push(Flow {
            from,
            to,
            source,
            target,
            map: conversion.then(connection.map),
            line: connection.line,
        });
    }
    Ok(flows)
}

/// Component, kind and variable of one end of a connection.
fn terminal(description: &Description, fmus: &[Fmu], end: &End) -> Result<(usize, ConnectorKind, Tap), EndProblem> {
    let components = &description.system.components;
    let element = end.element.as_deref().unwrap_or_default();
    let found = components.iter().position(|component| component.name == element);
    let element = || element.to_owned();
    let index = found.ok_or_else(|| EndProblem::NoComponent {
        element: element(),
        known: components.iter().map(|component| component.name.clone()).collect(),
    })?;
    let mut connectors = components[index].connectors.iter();
    let connector = connectors.find(|connector| connector.name == end.connector);
    let connector = connector.ok_or_else(|| EndProblem::NoConnector {
        element: element(),
        connector: end.connector.clone(),
    })?;
    let model = fmus[index].description();
    let variable = model.variable(&connector.name);
    let variable = variable.ok_or_else(|| EndProblem::NoVariable {
        element: element(),
        variable: connector.name.clone(),
    })?;
    let (end, kind) = (|| end.clone(), connector.kind);
    let fits = match kind {
        ConnectorKind::Input => variable.causality == Causality::Input,
        ConnectorKind::Output => variable.causality == Causality::Output,
        _ => return Err(EndProblem::Unconnectable { end: end(), kind }),
    };
    if !fits {
        return Err(EndProblem::OtherCausality { end: end(), kind });
    }
    let real = !matches!(connector.value, Some(Type::Other(_))) && variable.base_type() == BaseType::Real;
    if !real {
        return Err(EndProblem::NotReal { end: end() });
    }
    let named = match &connector.value {
        Some(Type::Real { unit }) => unit.as_deref(),
        _ => None,
    };
    let unit: Option<Unit> = match named {
        Some(name) => {
            let own = description.units.iter().find(|unit| unit.name == name);
            let of_fmu = || model.unit_of(variable).filter(|unit| unit.name == name);
            Some(own.or_else(of_fmu).cloned().ok_or_else(|| EndProblem::NoUnit {
                end: end(),
                unit: name.to_owned(),
            })?)
        }
        None => model.unit_of(variable).cloned(),
    };
    Ok((index, connector.kind, Tap::of(variable, unit)))
}

/// The component that is the line: every connection leads to it or from it, and it gives forces and takes heights.
pub(super) fn line_of(description: &Description, flows: &[Flow], unpacked: Unpacked<'_>) -> Result<usize, SspError> {
    let components = &description.system.components;
    let refuse = |problem: String| SspError::Shape {
        path: unpacked.archive.to_owned(),
        problem,
    };
    if components.len() < 2 {
        let problem = format!(
            "the system has {} component(s), expected a line and at least one pantograph",
            components.len()
        );
        return Err(refuse(problem));
    }
    for (index, component) in components.iter().enumerate() {
        if !flows.iter().any(|flow| flow.from == index || flow.to == index) {
            let problem = format!("component \"{}\" is connected to no other one", component.name);
            return Err(unpacked.structure().refuse(component.line, problem));
        }
    }
    let is_line = |index: usize| {
        let of = |other: usize, up: bool| -> Vec<Wire> {
            let wires = flows.iter().filter(|flow| match up {
                true => flow.from == other && flow.to == index,
                false => flow.from == index && flow.to == other,
            });
            wires
                .map(|flow| match up {
                    true => flow.wire(&flow.target, &flow.source),
                    false => flow.wire(&flow.source, &flow.target),
                })
                .collect()
        };
        let star = flows.iter().all(|flow| flow.from == index || flow.to == index);
        star && (0..components.len()).filter(|other| *other != index).all(|other| {
            let vertical = |names: Result<Vec<&'static str>, usize>| {
                names.is_ok_and(|names| names.iter().any(|name| is_vertical(name)))
            };
            vertical(motions(&of(other, true))) && vertical(loads(&of(other, false)))
        })
    };
    let lines: Vec<usize> = (0..components.len()).filter(|index| is_line(*index)).collect();
    match lines[..] {
        [line] => Ok(line),
        [] => Err(refuse(
            "no component is a line: expected one that is connected to all others, gives each a contact force [N] and \
             takes the height of its strip [m]; signals are told by their units and by names such as contact[1].fz \
             and strip[1].z"
                .to_owned(),
        )),
        _ => {
            let names: Vec<&str> = lines.iter().map(|line| components[*line].name.as_str()).collect();
            Err(refuse(format!(
                "cannot tell which component is the line: \"{}\" all give a force and take a height; units of the \
                 connectors would say it",
                names.join("\", \"")
            )))
        }
    }
}
