//! A system of supplied FMUs as a line and pantographs: role and wiring of each component.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, Causality};
use scene::{Offset, ParameterValue, Supplied};

use super::SspError;
use super::document::{Component, Description, Linear};
use super::flows::{Flow, flows, line_of};
use super::parameters::values;
use super::read::File;
use super::signals::{Tap, Wire, loads, motions};
use super::unpacked::Unpacked;
use component::exchange::contact;

/// A system as a line and pantographs.
pub(super) struct Foreign {
    pub line: Supplied,
    /// With x of their strips at the start where it is known, m; the first one leads.
    pub pantographs: Vec<(Option<f64>, Supplied)>,
    /// m/s, where it is known.
    pub speed: Option<f64>,
}

impl Foreign {
    /// Tells the components apart and wires them; what was guessed is told to `notes`.
    pub fn of(description: &Description, unpacked: Unpacked<'_>, notes: &mut Vec<String>) -> Result<Self, SspError> {
        let system = &description.system;
        let file = unpacked.structure();
        let (mut fmus, mut sides) = (Vec::new(), Vec::new());
        let mut opened: BTreeMap<_, Fmu> = BTreeMap::new();
        for component in &system.components {
            let refuse = |problem| file.refuse(component.line, format!("component \"{}\": {problem}", component.name));
            let path = unpacked.file(&component.source).map_err(refuse)?;
            // Many components may be of one FMU, which is unpacked once.
            let fmu = match opened.entry(path.clone()) {
                Entry::Occupied(known) => known.get().clone(),
                Entry::Vacant(place) => place
                    .insert(Fmu::open(&path).map_err(|source| SspError::Fmu {
                        path: unpacked.archive.to_owned(),
                        component: component.name.clone(),
                        source: Box::new(source),
                    })?)
                    .clone(),
            };
            fmus.push(fmu);
            let inside = path.strip_prefix(unpacked.folder).unwrap_or(&path);
            sides.push(Supplied::unwired(inside.display().to_string()));
        }
        let flows = flows(description, &fmus, unpacked, notes)?;
        let line = line_of(description, &flows, unpacked)?;
        for (side, values) in sides.iter_mut().zip(values(description, &fmus, unpacked, notes)?) {
            side.parameters = values;
        }
        let (places, speed) = places(&fmus, &sides, &flows, line);
        let mut line_side = std::mem::replace(&mut sides[line], Supplied::unwired(""));
        let mut pantographs = Vec::new();
        for (rank, place) in places.into_iter().enumerate() {
            let side = std::mem::replace(&mut sides[place.component], Supplied::unwired(""));
            let mut pair = Pair {
                file,
                component: &system.components[place.component],
                i: rank + 1,
                line: &mut line_side,
                pantograph: side,
            };
            let up = flows.iter().filter(|flow| flow.from == place.component);
            pair.take_motion(
                &up.map(|flow| flow.wire(&flow.target, &flow.source))
                    .collect::<Vec<Wire>>(),
                notes,
            )?;
            let down = flows.iter().filter(|flow| flow.to == place.component);
            pair.give_loads(
                &down
                    .map(|flow| flow.wire(&flow.source, &flow.target))
                    .collect::<Vec<Wire>>(),
                notes,
            )?;
            pair.check()?;
            if let Some(strip) = place.strip {
                pair.add_own_names(&fmus[line], strip);
            }
            pantographs.push((place.x, pair.pantograph));
        }
        Ok(Self {
            line: line_side,
            pantographs,
            speed,
        })
    }
}

/// Position of a pantograph.
struct PantographPlace {
    /// x of its strip at the start, m.
    x: Option<f64>,
    component: usize,
    /// Strip on the line, where the line's names count them.
    strip: Option<usize>,
}

/// The pantographs, the first one leads where all places are known, and their speed in m/s.
fn places(fmus: &[Fmu], sides: &[Supplied], flows: &[Flow], line: usize) -> (Vec<PantographPlace>, Option<f64>) {
    // Start values: set in the system, else those of the FMU.
    let number = |component: usize, name: &str| match sides[component].parameters.get(name) {
        Some(ParameterValue::Number(number)) => Some(*number),
        _ => {
            let variable = fmus[component].description().variable(name);
            variable.and_then(|variable| variable.real_start())
        }
    };
    let of_pantograph = |place: &PantographPlace, own: &str, of_line: &str| {
        let at_line = |strip: usize| number(line, &format!("strip[{strip}].{of_line}"));
        number(place.component, own).or_else(|| place.strip.and_then(at_line))
    };
    let mut places: Vec<PantographPlace> = (0..fmus.len())
        .filter(|component| *component != line)
        .map(|component| {
            let mut up = flows.iter().filter(|flow| flow.from == component && flow.to == line);
            let strip = up.find_map(|flow| Some(flow.target.structured("strip")?.0));
            let place = PantographPlace {
                x: None,
                component,
                strip,
            };
            let x = of_pantograph(&place, "start.x", "start.x");
            PantographPlace { x, ..place }
        })
        .collect();
    let speed = places.iter().find_map(|place| of_pantograph(place, "speed", "speed"));
    // Those without a place stay in the order of the system.
    if places.iter().all(|place| place.x.is_some()) {
        places.sort_by(|a, b| b.x.unwrap_or(0.0).total_cmp(&a.x.unwrap_or(0.0)));
    }
    (places, speed)
}

/// A pantograph under the line.
struct Pair<'a> {
    file: File<'a>,
    component: &'a Component,
    /// Number of the pantograph, from 1.
    i: usize,
    line: &'a mut Supplied,
    pantograph: Supplied,
}

impl Pair<'_> {
    fn untold(&self, wire: &Wire) -> SspError {
        let problem = format!(
            "cannot tell what the connection between \"{}\" of the line and \"{}\" of \"{}\" carries: expected names \
             that say it, such as strip[1].z, strip[1].vz, contact[1].fz, or units",
            wire.line.variable, wire.pantograph.variable, self.component.name
        );
        self.file.refuse(wire.at, problem)
    }

    /// Wires from the pantograph to the line.
    fn take_motion(&mut self, wires: &[Wire], notes: &mut Vec<String>) -> Result<(), SspError> {
        let carried = motions(wires).map_err(|k| self.untold(&wires[k]))?;
        for (wire, motion) in wires.iter().zip(&carried) {
            let ours = match *motion {
                "z" => "height",
                "vz" => "velocity",
                other => other,
            };
            let si = wire.line.to_si();
            let output = connection(&wire.pantograph, wire.map.then(si));
            self.pantograph.outputs.insert(ours.to_owned(), output);
            let of_line = format!("strip[{}].{motion}", self.i);
            self.line
                .inputs
                .insert(of_line.clone(), connection(&wire.line, si.inverse()));
            let name = &self.component.name;
            notes.push(format!("{name}.{} is {ours}, to {of_line}", wire.pantograph.variable));
        }
        Ok(())
    }

    /// Wires from the line to the pantograph.
    fn give_loads(&mut self, wires: &[Wire], notes: &mut Vec<String>) -> Result<(), SspError> {
        let (i, name) = (self.i, &self.component.name);
        let carried = loads(wires).map_err(|k| self.untold(&wires[k]))?;
        for (wire, load) in wires.iter().zip(&carried) {
            let variable = &wire.pantograph.variable;
            let ours = match *load {
                "force" => "force",
                "fx" => "force_x",
                "fy" => "force_y",
                "fz" => "force_z",
                "x" => "x",
                "time" => "time",
                _ => {
                    notes.push(format!(
                        "{name}.{variable} keeps its start value: a pantograph that is not modelled here is not given \
                         {load}"
                    ));
                    continue;
                }
            };
            let si = wire.line.to_si();
            let input = connection(&wire.pantograph, si.inverse().then(wire.map));
            self.pantograph.inputs.insert(ours.to_owned(), input);
            if *load != "time" {
                let of_line = format!("contact[{i}].{load}");
                self.line.outputs.insert(of_line, connection(&wire.line, si));
            }
            notes.push(format!("{name}.{variable} is given contact[{i}].{load}"));
        }
        Ok(())
    }

    /// That there are a height and a force.
    fn check(&self) -> Result<(), SspError> {
        let (inputs, outputs) = (&self.pantograph.inputs, &self.pantograph.outputs);
        let missing = if !outputs.contains_key("height") {
            "the height of its strip (to the line)"
        } else if !inputs.contains_key("force") && !inputs.contains_key("force_z") {
            "the contact force (from the line)"
        } else {
            return Ok(());
        };
        let problem = format!("component \"{}\": no connection carries {missing}", self.component.name);
        Err(self.file.refuse(self.component.line, problem))
    }

    /// A line with our names gives more than a system connects, and takes where the strip is.
    fn add_own_names(&mut self, line: &Fmu, strip: usize) {
        let is_there = |name: &str, causality: Causality| {
            let variable = line.description().variable(name);
            variable.is_some_and(|variable| variable.causality == causality && variable.base_type() == BaseType::Real)
        };
        let i = self.i;
        for motion in ["x", "vx"] {
            let own = format!("strip[{strip}].{motion}");
            if is_there(&own, Causality::Input) {
                let entry = self.line.inputs.entry(format!("strip[{i}].{motion}"));
                entry.or_insert_with(|| plain(&own, Linear::IDENTITY));
            }
        }
        for signal in &contact::SIGNALS[..=contact::MEAN_FORCE] {
            let own = signal.of(contact::GROUP, strip);
            if is_there(&own, Causality::Output) {
                let output = plain(&own, Linear::IDENTITY);
                self.line.outputs.insert(signal.of(contact::GROUP, i), output);
            }
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
