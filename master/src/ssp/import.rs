//! An archive to a scene.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use fmi2::archive::{Limits, checked, extract};
use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality, Unit};
use scene::{Evaluate, Line, Offset, Pantograph, PantographModel, ParameterValue, Scene, ThirdParty};
use sha2::{Digest, Sha256};
use tempfile::TempDir;

use super::document::{Connector, Description, End, Kind, Linear, Own, Source, Type};
use super::parameters::{Unpacked, Values, convert, values};
use super::read;
use super::signals::{Tap, Wire, is_vertical, loads, motions};
use super::{STRUCTURE_FILE, SspError, write};
use crate::interface::contact;

/// Wall time that a step of an isolated FMU may take, s: the default of a scene.
const STEP_TIMEOUT: f64 = 60.0;

/// A scene made of an archive.
pub struct Imported {
    /// The scene; paths of FMUs are relative to [`Imported::base`].
    pub scene: Scene,
    /// Folder that they are relative to.
    pub base: PathBuf,
    /// What was read how, and what is not used.
    pub notes: Vec<String>,
    /// The unpacked archive, removed when this is dropped.
    pub folder: TempDir,
}

/// Reads an `.ssp`; `overrides` are those of the command line.
///
/// An archive of [`export`](super::export()) that nobody has changed gives the scene that it was made of. Any other one, of one
/// line and one or more pantographs, becomes a scene of somebody else's FMUs.
///
/// # Errors
/// See [`SspError`].
pub fn import(path: &Path, overrides: &[String]) -> Result<Imported, SspError> {
    let folder = extract(path, STRUCTURE_FILE, &Limits::default()).map_err(|problem| SspError::Archive {
        path: path.to_owned(),
        problem,
    })?;
    let unpacked = Unpacked {
        archive: path,
        folder: folder.path(),
    };
    let file = unpacked.structure();
    let bytes = content(unpacked, STRUCTURE_FILE, 1)?;
    let description = read::description(&bytes, file)?;
    let mut notes = Vec::new();
    if let Some(own) = &description.own {
        let text = content(unpacked, &own.scene, 1)?;
        let text = String::from_utf8_lossy(&text);
        let origin = format!("{}: {}", path.display(), own.scene);
        if digest(&description, unpacked)? == own.digest {
            let scene = Scene::from_toml(&text, &origin, overrides)?;
            let base = resource(folder.path(), &own.scene).ok();
            let base = base
                .as_deref()
                .and_then(Path::parent)
                .unwrap_or(folder.path())
                .to_owned();
            return Ok(Imported {
                scene,
                base,
                notes,
                folder,
            });
        }
        notes.push(
            "the system was changed since `master export`: its FMUs and parameters are used as they are now, with the run and \
             the coupling of the exported scene"
                .to_owned(),
        );
    }
    if let Some(start) = description.experiment.start.filter(|start| *start != 0.0) {
        return Err(SspError::Shape {
            path: path.to_owned(),
            problem: format!("startTime = {start} s of the default experiment: a run starts at t = 0"),
        });
    }
    let foreign = Foreign::of(&description, unpacked, &mut notes)?;
    let origin = format!("{} as a scene", path.display());
    let scene = match &description.own {
        Some(own) => foreign.in_place_of(own, &description, unpacked, &origin, overrides)?,
        None => Scene::from_toml(&foreign.to_toml(&description), &origin, overrides)?,
    };
    Ok(Imported {
        scene,
        base: folder.path().to_owned(),
        notes,
        folder,
    })
}

/// File of an unpacked archive that a relative URI leads to.
///
/// # Errors
/// What is wrong with it.
pub(super) fn resource(folder: &Path, uri: &str) -> Result<PathBuf, String> {
    let decoded = percent_encoding::percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("source \"{uri}\": the decoded URI is not UTF-8"))?;
    let name = decoded.strip_prefix("./").unwrap_or(&decoded);
    checked(name).map_err(|problem| format!("source \"{uri}\": {problem}; expected a path inside the archive"))?;
    let path = folder.join(name);
    if path.is_file() {
        return Ok(path);
    }
    Err(format!("source \"{uri}\": there is no such file in the archive"))
}

fn content(unpacked: Unpacked<'_>, uri: &str, line: usize) -> Result<Vec<u8>, SspError> {
    let file = unpacked.structure();
    let path = resource(unpacked.folder, uri).map_err(|problem| file.refuse(line, problem))?;
    std::fs::read(path).map_err(|error| file.refuse(line, format!("source \"{uri}\": {error}")))
}

/// SHA-256 of what a system means: its content without our annotation, its parameters, its FMUs.
pub(super) fn digest(description: &Description, unpacked: Unpacked<'_>) -> Result<String, SspError> {
    digest_of(description, |uri, line| content(unpacked, uri, line))
}

/// The same, of files that `content` knows.
pub(super) fn digest_of(
    description: &Description,
    content: impl Fn(&str, usize) -> Result<Vec<u8>, SspError>,
) -> Result<String, SspError> {
    let mut hash = Sha256::new();
    let mut piece = |bytes: &[u8]| {
        hash.update((bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    piece(write::meaning(description).as_bytes());
    let system = &description.system;
    for component in &system.components {
        piece(&content(&component.source, component.line)?);
    }
    let bindings = system.components.iter().flat_map(|component| &component.bindings);
    for binding in bindings.chain(&system.bindings) {
        match (&binding.values, &binding.mapping) {
            (Source::File(uri), None) => piece(&content(uri, binding.line)?),
            other => piece(format!("{other:?}").as_bytes()),
        }
    }
    let mut text = String::new();
    for byte in hash.finalize() {
        let _ = write!(text, "{byte:02x}");
    }
    Ok(text)
}

/// A component and what it is wired to.
struct Side {
    path: String,
    values: Values,
    inputs: BTreeMap<String, scene::Connection>,
    outputs: BTreeMap<String, scene::Connection>,
}

impl Side {
    fn third_party(self) -> ThirdParty {
        ThirdParty {
            fmu: self.path,
            isolate: false,
            step_timeout: STEP_TIMEOUT,
            environment: BTreeMap::new(),
            parameters: self.values,
            inputs: self.inputs,
            outputs: self.outputs,
        }
    }
}

/// A system as a line and pantographs.
struct Foreign {
    line: ThirdParty,
    /// With x of their strips at the start where it is known, m; the first one leads.
    pantographs: Vec<(Option<f64>, ThirdParty)>,
    /// m/s, where it is known.
    speed: Option<f64>,
}

/// A connection with its direction known: components by position.
struct Flow {
    from: usize,
    to: usize,
    source: Tap,
    target: Tap,
    map: Linear,
    line: usize,
}

impl Foreign {
    fn of(description: &Description, unpacked: Unpacked<'_>, notes: &mut Vec<String>) -> Result<Self, SspError> {
        let system = &description.system;
        let file = unpacked.structure();
        let (mut fmus, mut paths) = (Vec::new(), Vec::new());
        for component in &system.components {
            let refuse = |problem| file.refuse(component.line, format!("component \"{}\": {problem}", component.name));
            let path = resource(unpacked.folder, &component.source).map_err(refuse)?;
            fmus.push(Fmu::open(&path).map_err(|source| SspError::Fmu {
                path: unpacked.archive.to_owned(),
                component: component.name.clone(),
                source: Box::new(source),
            })?);
            let inside = path.strip_prefix(unpacked.folder).unwrap_or(&path);
            paths.push(inside.display().to_string());
        }
        let flows = flows(description, &fmus, unpacked, notes)?;
        let line = line_of(description, &flows, unpacked)?;
        let mut values = values(system, &fmus, unpacked, notes)?;

        let canonical = |name: &str, causality: Causality| {
            let variable = fmus[line].description().variable(name);
            variable.is_some_and(|variable| variable.causality == causality && variable.base_type() == BaseType::Real)
        };
        // Start values: set in the system, else those of the FMU.
        let number = |component: usize, name: &str| match values[component].get(name) {
            Some(ParameterValue::Number(number)) => Some(*number),
            _ => fmus[component]
                .description()
                .variable(name)
                .and_then(|variable| variable.real_start()),
        };
        let mut order: Vec<(Option<f64>, usize, Option<usize>)> = Vec::new();
        for index in (0..fmus.len()).filter(|index| *index != line) {
            // Strip of the line, where the line's names count them.
            let strip = flows.iter().filter(|flow| flow.from == index && flow.to == line);
            let strip = strip
                .filter_map(|flow| flow.target.structured("strip"))
                .map(|(i, _)| i)
                .next();
            let at_line = strip.and_then(|i| number(line, &format!("strip[{i}].start.x")));
            order.push((number(index, "start.x").or(at_line), index, strip));
        }
        let speed = order
            .iter()
            .filter_map(|(_, index, strip)| {
                let at_line = strip.and_then(|i| number(line, &format!("strip[{i}].speed")));
                number(*index, "speed").or(at_line)
            })
            .next();
        // The first one leads; those without a place stay in the order of the system.
        if order.iter().all(|(x, _, _)| x.is_some()) {
            order.sort_by(|a, b| b.0.unwrap_or(0.0).total_cmp(&a.0.unwrap_or(0.0)));
        }

        let mut line_side = Side {
            path: paths[line].clone(),
            values: std::mem::take(&mut values[line]),
            inputs: BTreeMap::new(),
            outputs: BTreeMap::new(),
        };
        let mut pantographs = Vec::new();
        for (rank, (x, index, strip_of_line)) in order.into_iter().enumerate() {
            let i = rank + 1;
            let mut side = Side {
                path: paths[index].clone(),
                values: std::mem::take(&mut values[index]),
                inputs: BTreeMap::new(),
                outputs: BTreeMap::new(),
            };
            let name = &system.components[index].name;
            let untold = |wires: &[Wire], k: usize| {
                let problem = format!(
                    "cannot tell what the connection between \"{}\" of the line and \"{}\" of \"{name}\" carries: expected \
                     names that say it, such as strip[1].z, strip[1].vz, contact[1].fz, or units",
                    wires[k].line.variable, wires[k].pantograph.variable
                );
                file.refuse(wires[k].at, problem)
            };
            let up: Vec<Wire> = flows
                .iter()
                .filter(|flow| flow.from == index)
                .map(|flow| flow.wire(&flow.target, &flow.source))
                .collect();
            let carried = motions(&up).map_err(|k| untold(&up, k))?;
            for (wire, motion) in up.iter().zip(&carried) {
                let ours = match *motion {
                    "z" => "height",
                    "vz" => "velocity",
                    other => other,
                };
                let si = wire.line.to_si();
                side.outputs
                    .insert(ours.to_owned(), connection(&wire.pantograph, wire.map.then(si)));
                let line_name = format!("strip[{i}].{motion}");
                line_side
                    .inputs
                    .insert(line_name.clone(), connection(&wire.line, si.inverse()));
                notes.push(format!("{name}.{} is {ours}, to {line_name}", wire.pantograph.variable));
            }
            let down: Vec<Wire> = flows
                .iter()
                .filter(|flow| flow.to == index)
                .map(|flow| flow.wire(&flow.source, &flow.target))
                .collect();
            let carried = loads(&down).map_err(|k| untold(&down, k))?;
            for (wire, load) in down.iter().zip(&carried) {
                let si = wire.line.to_si();
                let ours = match *load {
                    "force" => "force",
                    "fx" => "force_x",
                    "fy" => "force_y",
                    "fz" => "force_z",
                    "x" => "x",
                    "time" => "time",
                    _ => {
                        notes.push(format!(
                            "{name}.{} keeps its start value: a pantograph that is not modelled here is not given {load}",
                            wire.pantograph.variable
                        ));
                        continue;
                    }
                };
                side.inputs.insert(
                    ours.to_owned(),
                    connection(&wire.pantograph, si.inverse().then(wire.map)),
                );
                if *load != "time" {
                    line_side
                        .outputs
                        .insert(format!("contact[{i}].{load}"), connection(&wire.line, si));
                }
                notes.push(format!(
                    "{name}.{} is given contact[{i}].{load}",
                    wire.pantograph.variable
                ));
            }
            for (needed, there) in [
                (
                    "the height of its strip (to the line)",
                    side.outputs.contains_key("height"),
                ),
                (
                    "the contact force (from the line)",
                    side.inputs.contains_key("force") || side.inputs.contains_key("force_z"),
                ),
            ] {
                if !there {
                    let problem = format!("component \"{name}\": no connection carries {needed}");
                    return Err(file.refuse(system.components[index].line, problem));
                }
            }
            // A line with our names gives more than a system connects, and takes where the strip is.
            if let Some(of_line) = strip_of_line {
                for motion in ["x", "vx"] {
                    let own = format!("strip[{of_line}].{motion}");
                    if canonical(&own, Causality::Input) {
                        let entry = line_side.inputs.entry(format!("strip[{i}].{motion}"));
                        entry.or_insert_with(|| plain(&own, Linear::IDENTITY));
                    }
                }
                for name in contact::NAMES.into_iter().chain(["mean_force"]) {
                    let own = format!("contact[{of_line}].{name}");
                    if canonical(&own, Causality::Output) {
                        line_side
                            .outputs
                            .insert(format!("contact[{i}].{name}"), plain(&own, Linear::IDENTITY));
                    }
                }
            }
            pantographs.push((x, side.third_party()));
        }
        Ok(Self {
            line: line_side.third_party(),
            pantographs,
            speed,
        })
    }

    /// The scene of an export with this line and these pantographs instead of its own.
    fn in_place_of(
        self,
        own: &Own,
        description: &Description,
        unpacked: Unpacked<'_>,
        origin: &str,
        overrides: &[String],
    ) -> Result<Scene, SspError> {
        let text = content(unpacked, &own.scene, 1)?;
        let mut scene = Scene::from_toml(&String::from_utf8_lossy(&text), origin, &[])?;
        let (from, to) = scene.evaluation_time(0);
        if let Some(stop) = description.experiment.stop {
            scene.run.duration = stop;
        }
        scene.run.evaluate = Evaluate::Time {
            from: from.min(scene.run.duration),
            to: to.min(scene.run.duration),
        };
        scene.catenary = Line::ThirdParty(self.line);
        scene.contact = None;
        let first = self.pantographs[0].0;
        if let Some(x) = first {
            scene.run.start_x = x;
        }
        if let Some(speed) = self.speed {
            scene.run.speed = speed;
        }
        scene.pantographs = self
            .pantographs
            .into_iter()
            .map(|(x, side)| Pantograph {
                offset_x: x.zip(first).map_or(0.0, |(x, first)| x - first),
                model: PantographModel::ThirdParty(side),
                start: None,
            })
            .collect();
        scene.run.initialise = scene::Initialise::AsGiven;
        Ok(Scene::from_toml(&scene.to_toml(), origin, overrides)?)
    }

    /// The scene as far as the system says it; what is missing is for the command line.
    fn to_toml(&self, description: &Description) -> String {
        let mut out = String::new();
        let title = description.system.description.as_ref().unwrap_or(&description.name);
        let _ = writeln!(out, "title = {}", quoted(title.lines().next().unwrap_or_default()));
        out.push_str("\n[run]\n");
        if let Some(stop) = description.experiment.stop {
            let _ = writeln!(out, "duration = {:?}", stop);
            let _ = writeln!(out, "evaluate = {{ time = [0.0, {:?}] }}", stop);
        }
        if let Some(speed) = self.speed {
            let _ = writeln!(out, "speed_kmh = {:?}", speed * 3.6);
        }
        let first = self.pantographs[0].0;
        if let Some(x) = first {
            let _ = writeln!(out, "start_x = {x:?}");
        }
        out.push_str("initialise = \"as_given\"\n\n[catenary]\n");
        third_party(&mut out, &self.line);
        for (x, side) in &self.pantographs {
            out.push_str("\n[[pantograph]]\n");
            if let (Some(x), Some(first)) = (x, first) {
                let _ = writeln!(out, "offset_x = {:?}", x - first);
            }
            third_party(&mut out, side);
        }
        out
    }
}

impl Flow {
    fn wire(&self, line: &Tap, pantograph: &Tap) -> Wire {
        Wire {
            line: line.clone(),
            pantograph: pantograph.clone(),
            map: self.map,
            at: self.line,
        }
    }
}

/// A connection of a scene.
fn connection(tap: &Tap, map: Linear) -> scene::Connection {
    plain(&tap.variable, map)
}

fn plain(variable: &str, map: Linear) -> scene::Connection {
    scene::Connection {
        variable: variable.to_owned(),
        factor: Some(map.factor),
        offset: Offset::Value(map.offset),
    }
}

/// Connections between components, with their directions, units and types checked against the FMUs.
fn flows(
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
        let (a, kind_a, tap_a) = terminal(description, fmus, start).map_err(&refuse)?;
        let (b, kind_b, tap_b) = terminal(description, fmus, end).map_err(&refuse)?;
        let (from, to, source, target) = match (kind_a, kind_b) {
            (Kind::Output, Kind::Input) => (a, b, tap_a, tap_b),
            (Kind::Input, Kind::Output) => (b, a, tap_b, tap_a),
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
                convert((&from.name, Some(from)), (Some(&to.name), Some(to))).map_err(refuse)?
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
fn terminal(description: &Description, fmus: &[Fmu], end: &End) -> Result<(usize, Kind, Tap), String> {
    let components = &description.system.components;
    let element = end.element.as_deref().unwrap_or_default();
    let found = components.iter().position(|component| component.name == element);
    let Some(index) = found else {
        let names: Vec<&str> = components.iter().map(|component| component.name.as_str()).collect();
        return Err(format!(
            "there is no component \"{element}\", only \"{}\"",
            names.join("\", \"")
        ));
    };
    let connector: Option<&Connector> = components[index]
        .connectors
        .iter()
        .find(|connector| connector.name == end.connector);
    let Some(connector) = connector else {
        return Err(format!(
            "component \"{element}\" has no connector \"{}\"",
            end.connector
        ));
    };
    let model = fmus[index].description();
    let Some(variable) = model.variable(&connector.name) else {
        return Err(format!(
            "the FMU of component \"{element}\" has no variable \"{}\"",
            connector.name
        ));
    };
    let fits = match connector.kind {
        Kind::Input => variable.causality == Causality::Input,
        Kind::Output => variable.causality == Causality::Output,
        _ => {
            return Err(format!(
                "{end} is a {}, only inputs and outputs are connected",
                connector.kind.name()
            ));
        }
    };
    if !fits {
        return Err(format!(
            "{end} is an {} in the system, but its variable in the FMU is none",
            connector.kind.name()
        ));
    }
    let real = !matches!(connector.value, Some(Type::Other(_))) && variable.base_type() == BaseType::Real;
    if !real {
        return Err(format!("{end} is not real; only real signals are connected"));
    }
    let named = match &connector.value {
        Some(Type::Real { unit }) => unit.as_deref(),
        _ => None,
    };
    let unit: Option<Unit> = match named {
        Some(name) => {
            let own = description.units.iter().find(|unit| unit.name == name);
            let of_fmu = || model.unit_of(variable).filter(|unit| unit.name == name);
            Some(
                own.or_else(of_fmu)
                    .cloned()
                    .ok_or_else(|| format!("the unit {name} of {end} is not defined"))?,
            )
        }
        None => model.unit_of(variable).cloned(),
    };
    Ok((index, connector.kind, Tap::of(variable, unit)))
}

/// The component that is the line: every connection leads to it or from it, and it gives forces and takes heights.
fn line_of(description: &Description, flows: &[Flow], unpacked: Unpacked<'_>) -> Result<usize, SspError> {
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
            "no component is a line: expected one that is connected to all others, gives each a contact force [N] and takes \
             the height of its strip [m]; signals are told by their units and by names such as contact[1].fz and strip[1].z"
                .to_owned(),
        )),
        _ => {
            let names: Vec<&str> = lines.iter().map(|line| components[*line].name.as_str()).collect();
            Err(refuse(format!(
                "cannot tell which component is the line: \"{}\" all give a force and take a height; units of the connectors \
                 would say it",
                names.join("\", \"")
            )))
        }
    }
}

/// A text as TOML.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// The keys of `[catenary]` or `[[pantograph]]` with an FMU.
fn third_party(out: &mut String, side: &ThirdParty) {
    let _ = writeln!(out, "fmu = {}", quoted(&side.fmu));
    let parameters: Vec<String> = side
        .parameters
        .iter()
        .map(|(name, value)| {
            let value = match value {
                ParameterValue::Number(number) => format!("{number:?}"),
                ParameterValue::Boolean(flag) => flag.to_string(),
                ParameterValue::String(text) => quoted(text),
            };
            format!("{} = {value}", quoted(name))
        })
        .collect();
    if !parameters.is_empty() {
        let _ = writeln!(out, "parameters = {{ {} }}", parameters.join(", "));
    }
    for (table, map) in [("inputs", &side.inputs), ("outputs", &side.outputs)] {
        let entries: Vec<String> = map
            .iter()
            .map(|(name, connection)| {
                let offset = match connection.offset {
                    Offset::Value(value) => value,
                    Offset::Align => 0.0,
                };
                format!(
                    "{} = {{ variable = {}, factor = {:?}, offset = {offset:?} }}",
                    quoted(name),
                    quoted(&connection.variable),
                    connection.factor.unwrap_or(1.0)
                )
            })
            .collect();
        let _ = writeln!(out, "{table} = {{ {} }}", entries.join(", "));
    }
}
