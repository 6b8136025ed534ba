//! A scene to an archive.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use fmi2::archive::{Package, zipped};
use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality, Kind as VariableKind, ModelDescription, Unit, Variable};
use scene::{Line, Offset, PantographModel, Scene, Supplied};

use super::digest::digest_of;
use super::document::{
    Binding, Component, Connection, Connector, ConnectorKind, Description, End, Experiment, Linear, Own, Parameter,
    ParameterSet, Source, System, Type, Value,
};
use super::{STRUCTURE_FILE, SspError, write};
use component::exchange::{instrument, load, strip};

/// Note on the exchange for every tool.
const EXCHANGE: &str = "The line hands over the force on the strip at the communication point (fx, fy, fz): of what a \
    tool can hold over a step in which all components advance at once, this is the youngest, and adds the least \
    energy to the contact. A tool that steps the catenary first and hands its new outputs over to a pantograph that \
    has not stepped yet should connect the mean over the last step (mean_fx, mean_fy, mean_fz) instead: the impulse \
    is then the same on both sides. x runs along the track, y to the left, z up from the top of rail; SI units. Steps \
    of 1 ms or less are advised.";

/// Name of the resource with the resolved scene.
const SCENE: &str = "resources/scene.toml";

/// An archive made of a scene.
pub struct Exported {
    /// The bytes of the archive.
    pub archive: Vec<u8>,
    /// Limits of a plain tool: data that cannot be told or connected.
    pub notes: Vec<String>,
}

/// Variable of an FMU, and the map between its value and ours (`to ours` on outputs, `from ours` on inputs).
struct Tap {
    variable: String,
    map: Linear,
}

/// One component with its FMU.
struct Side {
    name: String,
    model: ModelDescription,
    /// By our names: for a line `fx`, `fy`, `fz`, `force`, `x`, `y` (outputs), for a pantograph those of a motion.
    outputs: BTreeMap<String, Tap>,
    /// For a line those of a motion, for a pantograph `fx`, …, `force`, `x`, `y`.
    inputs: BTreeMap<String, Tap>,
    /// Values other than the starts of the FMU.
    values: BTreeMap<String, scene::ParameterValue>,
    description: String,
}

/// Makes the archive of a resolved scene; `own` are the FMUs made of it and their file names, `base` is the folder that
/// paths of supplied FMUs are relative to, `aligned` the offset in m of each pantograph's height where the scene leaves
/// it open.
///
/// # Errors
/// An FMU that cannot be read, and whatever the archive writer reports; `path` is the archive, for messages.
pub fn export(
    scene: &Scene,
    name: &str,
    own: &[(String, Package)],
    base: &Path,
    aligned: &[Option<f64>],
    path: &Path,
) -> Result<Exported, SspError> {
    let archive_error = |problem| SspError::Archive {
        path: path.to_owned(),
        problem,
    };
    let fmu_error = |component: &str| {
        let component = component.to_owned();
        move |source| SspError::Fmu {
            path: path.to_owned(),
            component: component.clone(),
            source: Box::new(source),
        }
    };
    if let Some(index) = scene.pantographs.iter().position(scene::Pantograph::has_several_strips) {
        let problem = format!(
            "pantograph[{}].strips: must be one strip: an exported system connects one strip of each pantograph with \
             the line; master package writes the FMUs of heads with several, whose strip[i] and contact[i] are to be \
             connected by hand",
            index + 1
        );
        let path = path.to_owned();
        return Err(SspError::Shape { path, problem });
    }
    let (mut entries, mut notes) = (BTreeMap::new(), Vec::new());
    let mut scene = scene.clone();
    let take = |name: &str, side: Option<&mut Supplied>, entries: &mut BTreeMap<String, Vec<u8>>| {
        let file = format!("{name}.fmu");
        let target = format!("resources/{file}");
        let model = match side {
            None => {
                let package = own.iter().find(|(known, _)| *known == file);
                let (_, package) = package.expect("every side of the scene that is modelled here is packaged");
                let bytes = package.to_bytes(path).map_err(fmu_error(name))?;
                entries.insert(target, bytes);
                described(package, path).map_err(fmu_error(name))?
            }
            Some(side) => {
                let source = base.join(&side.fmu);
                let fmu = Fmu::open(&source).map_err(fmu_error(name))?;
                let bytes = std::fs::read(&source).map_err(|problem| {
                    let problem = fmi2::archive::ArchiveError::Unreadable { problem };
                    fmu_error(name)(fmi2::Error::Archive {
                        path: source.clone(),
                        problem,
                    })
                })?;
                entries.insert(target, bytes);
                side.fmu = file;
                fmu.description().clone()
            }
        };
        Ok::<ModelDescription, SspError>(model)
    };
    let strips = scene.pantographs.len();
    let line = match &mut scene.catenary {
        Line::Modelled(_) => Side::own_line(take("Catenary", None, &mut entries)?, strips),
        Line::Supplied(side) => {
            let model = take("Catenary", Some(side), &mut entries)?;
            Side::foreign_line(model, side)
        }
    };
    let mut pantographs = Vec::new();
    for (index, pantograph) in scene.pantographs.iter_mut().enumerate() {
        let name = cosim::package::pantograph_file(index).replace(".fmu", "");
        pantographs.push(match &mut pantograph.model {
            PantographModel::Supplied(side) => {
                let model = take(&name, Some(side), &mut entries)?;
                Side::foreign_pantograph(name, model, side, aligned.get(index).copied().flatten())
            }
            _ => Side::own_pantograph(take(&name, None, &mut entries)?, name),
        });
    }

    let mut controllers = Vec::new();
    for (index, controller) in scene.controllers.iter_mut().enumerate() {
        let name = numbered("Controller", index);
        let model = take(&name, Some(&mut controller.side), &mut entries)?;
        controllers.push((Side::controller(name, model, &controller.side), controller.pantograph));
    }

    let mut connections = connections(&line, &pantographs, &mut notes);
    for (controller, pantograph) in &controllers {
        connections.extend(commands(controller, &pantographs[*pantograph], &mut notes));
    }
    let controllers = controllers.iter().map(|(controller, _)| controller);
    let sides: Vec<&Side> = std::iter::once(&line).chain(&pantographs).chain(controllers).collect();
    let mut units = BTreeMap::new();
    let components = sides
        .iter()
        .map(|side| {
            let set = side.parameters();
            let mut component = side.component(&connections, &mut units);
            if !set.parameters.is_empty() {
                let uri = format!("resources/{}.ssv", side.name);
                entries.insert(uri.clone(), write::parameter_set(&set).into_bytes());
                component.bindings.push(Binding {
                    prefix: String::new(),
                    values: Source::File(uri),
                    mapping: None,
                    line: 0,
                });
            }
            component
        })
        .collect();
    entries.insert(SCENE.to_owned(), scene.to_toml().into_bytes());
    let coupling = &scene.coupling;
    let mut description = Description {
        name: name.to_owned(),
        description: Some(format!("{}. {EXCHANGE}", scene.title)),
        system: System {
            name: name.to_owned(),
            description: Some(scene.title.clone()),
            connectors: Vec::new(),
            components,
            connections,
            bindings: Vec::new(),
        },
        units: units.into_values().collect(),
        experiment: Experiment {
            start: Some(0.0),
            stop: Some(scene.run.duration),
        },
        own: None,
    };
    let digest = digest_of(&description, |uri, _| Ok(entries[uri].clone()))?;
    description.own = Some(Own {
        scene: SCENE.to_owned(),
        digest,
        coupling: vec![
            ("algorithm".to_owned(), coupling.algorithm.name().to_owned()),
            ("order".to_owned(), coupling.order.name().to_owned()),
            ("force".to_owned(), coupling.force.name().to_owned()),
            ("extrapolation".to_owned(), coupling.extrapolation.to_string()),
            ("macroStep".to_owned(), format!("{:?}", coupling.macro_step)),
        ],
    });
    entries.insert(STRUCTURE_FILE.to_owned(), write::description(&description).into_bytes());
    let archive = zipped(&entries).map_err(archive_error)?;
    Ok(Exported { archive, notes })
}

/// The description of an FMU that is packaged here.
fn described(package: &Package, path: &Path) -> Result<ModelDescription, fmi2::Error> {
    ModelDescription::from_xml(package.description.as_bytes()).map_err(|problem| fmi2::Error::Description {
        path: path.to_owned(),
        problem,
    })
}

fn identity(variable: String) -> Tap {
    Tap {
        variable,
        map: Linear::IDENTITY,
    }
}

fn tap(connection: &scene::Connection) -> Tap {
    let offset = match connection.offset {
        Offset::Value(value) => value,
        // Of a pantograph's height only, which is put in afterwards.
        Offset::Align => 0.0,
    };
    Tap {
        variable: connection.variable.clone(),
        map: Linear {
            // Written when the scene was prepared.
            factor: connection.factor.unwrap_or(1.0),
            offset,
        },
    }
}

impl Side {
    fn own_line(model: ModelDescription, strips: usize) -> Self {
        let (mut inputs, mut outputs) = (BTreeMap::new(), BTreeMap::new());
        for i in 1..=strips {
            for signal in &strip::SIGNALS[..strip::MOTION] {
                let name = signal.of(strip::GROUP, i);
                inputs.insert(name.clone(), identity(name));
            }
            for name in ["fx", "fy", "fz", "force", "x", "y"] {
                let name = format!("contact[{i}].{name}");
                outputs.insert(name.clone(), identity(name));
            }
        }
        Self {
            name: "Catenary".to_owned(),
            description: model.description.clone().unwrap_or_default(),
            model,
            inputs,
            outputs,
            values: BTreeMap::new(),
        }
    }

    fn foreign_line(model: ModelDescription, side: &Supplied) -> Self {
        let outputs: BTreeMap<String, Tap> = side
            .outputs
            .iter()
            .map(|(name, connection)| (name.clone(), tap(connection)))
            .collect();
        Self {
            name: "Catenary".to_owned(),
            description: side.fmu.clone(),
            model,
            inputs: side
                .inputs
                .iter()
                .map(|(name, connection)| (name.clone(), tap(connection)))
                .collect(),
            outputs,
            values: side.parameters.clone(),
        }
    }

    fn own_pantograph(model: ModelDescription, name: String) -> Self {
        let inputs = load::SIGNALS
            .iter()
            .map(|signal| (signal.name.to_owned(), identity(signal.of(load::GROUP, 1))));
        let outputs = strip::SIGNALS[..strip::MOTION]
            .iter()
            .map(|signal| (signal.name.to_owned(), identity(signal.of(strip::GROUP, 1))));
        Self {
            description: model.description.clone().unwrap_or_default(),
            inputs: inputs.collect(),
            outputs: outputs.collect(),
            values: BTreeMap::new(),
            name,
            model,
        }
    }

    fn foreign_pantograph(name: String, model: ModelDescription, side: &Supplied, aligned: Option<f64>) -> Self {
        let ours = |theirs: &str| {
            match theirs {
                "height" => "z",
                "velocity" => "vz",
                "force_x" => "fx",
                "force_y" => "fy",
                "force_z" => "fz",
                other => other,
            }
            .to_owned()
        };
        let taps = |map: &BTreeMap<String, scene::Connection>| {
            map.iter()
                .map(|(name, connection)| (ours(name), tap(connection)))
                .collect()
        };
        let mut outputs: BTreeMap<String, Tap> = taps(&side.outputs);
        if let (Some(height), Some(offset)) = (outputs.get_mut("z"), aligned) {
            height.map.offset = offset;
        }
        Self {
            name,
            description: model.description.clone().unwrap_or_default(),
            inputs: taps(&side.inputs),
            outputs,
            values: side.parameters.clone(),
            model,
        }
    }

    /// A controller FMU; `time` is left to the tool.
    fn controller(name: String, model: ModelDescription, side: &Supplied) -> Self {
        let taps = |map: &BTreeMap<String, scene::Connection>| {
            map.iter()
                .map(|(name, connection)| (name.clone(), tap(connection)))
                .collect()
        };
        Self {
            name,
            description: model.description.clone().unwrap_or_default(),
            inputs: taps(&side.inputs),
            outputs: taps(&side.outputs),
            values: side.parameters.clone(),
            model,
        }
    }

    /// The component with its connectors: inputs that are connected, and outputs that are or that people look at.
    fn component(&self, connections: &[Connection], units: &mut BTreeMap<String, Unit>) -> Component {
        let ends = connections
            .iter()
            .flat_map(|connection| [&connection.start, &connection.end]);
        let used: BTreeSet<&str> = ends
            .filter(|end| end.element.as_deref() == Some(&self.name))
            .map(|end| end.connector.as_str())
            .collect();
        let shown = |variable: &Variable| {
            let name = variable.name.as_str();
            let looked_at = [
                "force", "fx", "fy", "fz", "mean_fx", "mean_fy", "mean_fz", "gap", "work", "wire.z",
            ];
            variable.causality == Causality::Output
                && variable.base_type() == BaseType::Real
                && name.split_once("].").is_some_and(|(table, rest)| {
                    (table.starts_with("contact[") && looked_at.contains(&rest)) || table.starts_with("strip[")
                })
        };
        let mut connectors = Vec::new();
        for variable in &self.model.variables {
            if !(used.contains(variable.name.as_str()) || shown(variable)) {
                continue;
            }
            let unit = self.model.unit_of(variable);
            if let Some(unit) = unit {
                units.entry(unit.name.clone()).or_insert_with(|| bare(unit));
            }
            connectors.push(Connector {
                name: variable.name.clone(),
                kind: if variable.causality == Causality::Input {
                    ConnectorKind::Input
                } else {
                    ConnectorKind::Output
                },
                value: Some(Type::Real {
                    unit: unit.map(|unit| unit.name.clone()),
                }),
                line: 0,
            });
        }
        Component {
            name: self.name.clone(),
            description: Some(self.description.clone()).filter(|text| !text.is_empty()),
            source: format!("resources/{}.fmu", self.name),
            connectors,
            bindings: Vec::new(),
            line: 0,
        }
    }

    /// The parameters of the FMU with their values; of a supplied FMU those that the scene sets.
    fn parameters(&self) -> ParameterSet {
        let mut parameters = Vec::new();
        let mut units = BTreeMap::new();
        let own = self.values.is_empty() && self.model.variable("scene").is_some();
        for variable in &self.model.variables {
            let value = match (self.values.get(&variable.name), &variable.kind) {
                (Some(value), kind) => Value::of(
                    value,
                    matches!(kind, VariableKind::Integer { .. } | VariableKind::Enumeration { .. }),
                ),
                (None, VariableKind::Real { start: Some(start), .. })
                    if own && variable.causality == Causality::Parameter =>
                {
                    Value::Real {
                        value: *start,
                        unit: None,
                    }
                }
                _ => continue,
            };
            let unit = self.model.unit_of(variable);
            let value = match value {
                Value::Real { value, .. } => {
                    if let Some(unit) = unit {
                        units.entry(unit.name.clone()).or_insert_with(|| bare(unit));
                    }
                    Value::Real {
                        value,
                        unit: unit.map(|unit| unit.name.clone()),
                    }
                }
                value => value,
            };
            parameters.push(Parameter {
                name: variable.name.clone(),
                value,
                line: 0,
            });
        }
        ParameterSet {
            name: self.name.clone(),
            parameters,
            units: units.into_values().collect(),
        }
    }
}

/// A unit without those for display, which the format does not know.
fn bare(unit: &Unit) -> Unit {
    Unit {
        display_units: Vec::new(),
        ..unit.clone()
    }
}

/// Name of component `index` (from 0) of its kind.
fn numbered(kind: &str, index: usize) -> String {
    if index == 0 {
        kind.to_owned()
    } else {
        format!("{kind}{}", index + 1)
    }
}

/// Connection of two ends.
fn connection((from, to): ((&Side, &str), (&Side, &str)), map: Linear) -> Connection {
    let end = |(side, variable): (&Side, &str)| End {
        element: Some(side.name.clone()),
        connector: variable.to_owned(),
    };
    Connection {
        start: end(from),
        end: end(to),
        map,
        // The map holds everything.
        suppress_unit_conversion: map != Linear::IDENTITY,
        line: 0,
    }
}

/// Connections of a controller with the pantograph that it commands: readings of the instruments, and the command.
fn commands(controller: &Side, pantograph: &Side, notes: &mut Vec<String>) -> Vec<Connection> {
    let mut connections = Vec::new();
    for (name, to) in &controller.inputs {
        let Some(from) = super::super::quantity::instrument_of(name) else {
            notes.push(format!(
                "{}.{}: no signal of the system gives {name}, a plain tool leaves it at its start value",
                controller.name, to.variable
            ));
            continue;
        };
        connections.push(connection(((pantograph, from), (controller, &to.variable)), to.map));
    }
    for from in controller.outputs.values() {
        let ends = ((controller, from.variable.as_str()), (pantograph, instrument::COMMAND));
        connections.push(connection(ends, from.map));
    }
    notes.push(format!(
        "{}: a plain tool steps it with the others, so that its command waits for the next communication point, and \
         there for the next sample of {}; communication steps well below the sample time keep the delay of the run",
        controller.name, pantograph.name
    ));
    connections
}

/// Everything that can be connected between the line and each pantograph.
fn connections(line: &Side, pantographs: &[Side], notes: &mut Vec<String>) -> Vec<Connection> {
    let mut connections = Vec::new();
    let mut connect = |from: (&Side, &Tap), to: (&Side, &Tap)| {
        let ends = ((from.0, from.1.variable.as_str()), (to.0, to.1.variable.as_str()));
        connections.push(connection(ends, from.1.map.then(to.1.map)));
    };
    for (index, pantograph) in pantographs.iter().enumerate() {
        let i = index + 1;
        for signal in &strip::SIGNALS[..strip::MOTION] {
            let name = signal.name;
            let to = line.inputs.get(&signal.of(strip::GROUP, i));
            match (pantograph.outputs.get(name), to) {
                (Some(from), Some(to)) => connect((pantograph, from), (line, to)),
                (None, Some(to)) if name == "z" || (name == "x" && line.model.variable("scene").is_none()) => {
                    notes.push(format!("{}.{}: nothing in the system gives it", line.name, to.variable));
                }
                _ => {}
            }
        }
        for (name, to) in &pantograph.inputs {
            let source = line.outputs.get(&format!("contact[{i}].{name}"));
            match source {
                Some(from) => connect((line, from), (pantograph, to)),
                None => {
                    // A line that says its force in the other sign only.
                    let other = match name.as_str() {
                        "force" => line.outputs.get(&format!("contact[{i}].fz")),
                        "fz" => line.outputs.get(&format!("contact[{i}].force")),
                        _ => None,
                    };
                    match other {
                        Some(from) => {
                            let turned = Tap {
                                variable: from.variable.clone(),
                                map: from.map.then(Linear {
                                    factor: -1.0,
                                    offset: 0.0,
                                }),
                            };
                            connect((line, &turned), (pantograph, to));
                        }
                        None => notes.push(format!(
                            "{}.{}: no signal of the system gives {name}, a plain tool leaves it at its start value",
                            pantograph.name, to.variable
                        )),
                    }
                }
            }
        }
    }
    connections
}
