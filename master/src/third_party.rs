//! Somebody else's pantograph: an FMU behind the scene's wiring.

use fmi2::import::Fmu;
use fmi2::model_description::ModelDescription;
use scene::{Connection, Offset, Scene, ThirdParty};

use crate::cosimulation::{CosimulationError, FmuSlave, Role};
use crate::interface::{load, strip};
use crate::isolation::Isolation;
use crate::results::Frame;
use crate::slave::{Abilities, Slave, SlaveError};
use crate::standstill;

/// FMI says whether input derivatives are followed, not to which order; the first is what tools agree on.
const INPUT_DERIVATIVES: usize = 1;

/// Half the drawn length of a strip along the track, m.
const HALF_STRIP: f64 = 0.25;

/// Names that connections go by when the scene leaves the wiring open, the likeliest first.
const GUESSES: [(&str, &[&str]); 4] = [
    ("force_z", &["contact[1].fz", "contact.fz"]),
    (
        "force",
        &[
            "force",
            "F",
            "F_c",
            "Fc",
            "f_c",
            "contact_force",
            "contactForce",
            "F_contact",
        ],
    ),
    ("height", &["strip[1].z", "z", "z1", "x1", "height", "y", "position"]),
    (
        "velocity",
        &["strip[1].vz", "v", "v1", "vz", "dz", "der(z)", "der(z1)", "velocity"],
    ),
];

/// What one of our quantities is in the FMU.
#[derive(Clone, Debug, PartialEq)]
struct Wire {
    quantity: Quantity,
    factor: f64,
    offset: f64,
}

/// Our quantities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    /// Contact force, −fz, N.
    Force,
    /// Component of the force on the strip, N.
    Load(usize),
    /// s.
    Time,
    /// Position along the track where no output says it, m.
    X,
    /// Entry of the motion.
    Motion(usize),
    /// Read for the scene's sake but used by nothing.
    Unused,
}

fn input(name: &str) -> Quantity {
    match name {
        "force" => Quantity::Force,
        "force_x" => Quantity::Load(0),
        "force_y" => Quantity::Load(1),
        "force_z" => Quantity::Load(2),
        "time" => Quantity::Time,
        _ => Quantity::X,
    }
}

fn output(name: &str) -> Quantity {
    Quantity::Motion(match name {
        "height" => strip::Z,
        "velocity" => strip::VZ,
        "x" => strip::X,
        "y" => strip::Y,
        "vx" => strip::VX,
        "vy" => strip::VY,
        "roll" => strip::ROLL,
        _ => return Quantity::Unused,
    })
}

/// A wiring guessed from the FMU's variable names: `(inputs, outputs)` as a scene would have them.
#[must_use]
pub fn guess(description: &ModelDescription) -> [Vec<(String, String)>; 2] {
    use fmi2::model_description::{BaseType, Causality};
    let named = |causality: Causality, key: &str| {
        let names = GUESSES
            .iter()
            .find(|(ours, _)| *ours == key)
            .map_or(&[][..], |(_, names)| names);
        let of_causality = || {
            description
                .variables
                .iter()
                .filter(|variable| variable.causality == causality && variable.base_type() == BaseType::Real)
        };
        names
            .iter()
            .find_map(|name| {
                let exact = of_causality().find(|variable| variable.name == *name);
                exact.or_else(|| of_causality().find(|variable| variable.name.eq_ignore_ascii_case(name)))
            })
            .map(|variable| (key.to_owned(), variable.name.clone()))
    };
    let inputs = named(Causality::Input, "force_z").or_else(|| named(Causality::Input, "force"));
    let outputs = ["height", "velocity"]
        .iter()
        .filter_map(|key| named(Causality::Output, key))
        .collect();
    [inputs.into_iter().collect(), outputs]
}

/// A pantograph FMU seen as a pantograph.
pub struct ThirdPartyPantograph {
    slave: FmuSlave,
    inputs: Vec<Wire>,
    outputs: Vec<Wire>,
    start_x: f64,
    speed: f64,
    has_velocity: bool,
    t: f64,
    /// Load at the start of the step and its first derivative, N and N/s.
    force: [f64; 3],
    rate: [f64; 3],
    motion: [f64; strip::OUTPUTS],
    kept: (f64, [f64; strip::OUTPUTS]),
    given: Vec<f64>,
    read: Vec<f64>,
    /// Length of the last step, s; 0 before the first.
    h: f64,
    /// Whether it stands at its start: x stays, and so does its clock.
    standing: bool,
    /// What the FMU's clock is ahead of the run's, s.
    ahead: f64,
}

impl ThirdPartyPantograph {
    /// Instantiates and initialises the FMU for pantograph `index` (from 0).
    ///
    /// # Errors
    /// A variable that does not exist, and whatever the FMU reports.
    pub fn start(
        fmu: &Fmu,
        entry: &ThirdParty,
        scene: &Scene,
        index: usize,
        logging: bool,
    ) -> Result<Self, CosimulationError> {
        let description = fmu.description();
        let connection = |(ours, variable): (String, String)| {
            (
                ours,
                Connection {
                    variable,
                    factor: 1.0,
                    offset: Offset::Value(0.0),
                },
            )
        };
        let [guessed_inputs, guessed_outputs] =
            guess(description).map(|pairs| pairs.into_iter().map(connection).collect());
        let inputs = if entry.inputs.is_empty() {
            &guessed_inputs
        } else {
            &entry.inputs
        };
        let outputs = if entry.outputs.is_empty() {
            &guessed_outputs
        } else {
            &entry.outputs
        };
        for (have, role, needed) in [
            (
                inputs.keys().any(|key| key.starts_with("force")),
                "real input for",
                "force",
            ),
            (outputs.contains_key("height"), "real output for", "height"),
        ] {
            if !have {
                return Err(CosimulationError::NoVariable {
                    fmu: description.model_name.clone(),
                    role,
                    variable: needed.to_owned(),
                    nearest: ": name it under pantograph.inputs or pantograph.outputs, see `master inspect`".to_owned(),
                });
            }
        }
        let role = Role {
            name: format!("pantograph {}", index + 1),
            inputs: inputs.values().map(|connection| connection.variable.clone()).collect(),
            outputs: outputs.values().map(|connection| connection.variable.clone()).collect(),
            parameters: entry
                .parameters
                .iter()
                .map(|(name, value)| (name.clone(), value.clone()))
                .collect(),
            duration: scene.run.duration + standstill::LONGEST,
            input_derivatives: INPUT_DERIVATIVES,
            logging,
            isolation: Isolation::of(entry),
        };
        let wire = |quantity: Quantity, connection: &Connection| Wire {
            quantity,
            factor: connection.factor,
            offset: match connection.offset {
                Offset::Value(value) => value,
                Offset::Align => 0.0,
            },
        };
        let inputs: Vec<Wire> = inputs
            .iter()
            .map(|(name, connection)| wire(input(name), connection))
            .collect();
        let outputs: Vec<Wire> = outputs
            .iter()
            .map(|(name, connection)| wire(output(name), connection))
            .collect();
        let slave = FmuSlave::start(fmu, role)?;
        let (given, read) = (vec![0.0; inputs.len()], vec![0.0; outputs.len()]);
        let has_velocity = outputs.iter().any(|wire| wire.quantity == Quantity::Motion(strip::VZ));
        let mut pantograph = Self {
            slave,
            inputs,
            outputs,
            start_x: scene.strip_start_x(index),
            speed: scene.run.speed,
            has_velocity,
            t: 0.0,
            force: [0.0; 3],
            rate: [0.0; 3],
            motion: [0.0; strip::OUTPUTS],
            kept: (0.0, [0.0; strip::OUTPUTS]),
            given,
            read,
            h: 0.0,
            standing: false,
            ahead: 0.0,
        };
        pantograph.refresh()?;
        Ok(pantograph)
    }

    /// Height of the strip as the FMU stands, m.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.motion[strip::Z]
    }

    /// Contact force at which the FMU starts, N: the start value of its force input, seen through the wiring; 0 where it has none.
    #[must_use]
    pub fn start_force(&self, fmu: &Fmu, entry: &ThirdParty) -> f64 {
        let description = fmu.description();
        let [guessed, _] = guess(description);
        let wired = entry
            .inputs
            .iter()
            .map(|(name, connection)| (name.as_str(), connection.variable.as_str()));
        let guessed = guessed
            .iter()
            .map(|(name, variable)| (name.as_str(), variable.as_str()));
        let names: Vec<(&str, &str)> = if entry.inputs.is_empty() {
            guessed.collect()
        } else {
            wired.collect()
        };
        for ((name, variable), wire) in names.into_iter().zip(&self.inputs) {
            let sign = match wire.quantity {
                Quantity::Force => 1.0,
                Quantity::Load(2) => -1.0,
                _ => continue,
            };
            debug_assert_eq!(input(name), wire.quantity);
            let found = description
                .variables
                .iter()
                .find(|candidate| candidate.name == variable);
            if let Some(start) = found.and_then(|variable| variable.real_start()) {
                return sign * (start - wire.offset) / wire.factor;
            }
        }
        0.0
    }

    /// Shifts all heights by `offset` m: `offset = "align"`.
    pub fn shift(&mut self, offset: f64) {
        for wire in &mut self.outputs {
            if wire.quantity == Quantity::Motion(strip::Z) {
                wire.offset += offset;
            }
        }
        self.motion[strip::Z] += offset;
    }

    /// Keeps it at its start while it steps; what its FMU says about x is not heard.
    ///
    /// # Errors
    /// What the FMU reports.
    pub fn stand(&mut self) -> Result<(), SlaveError> {
        self.standing = true;
        self.refresh()
    }

    /// Ends a standstill of `duration` s: the run's time is 0 now, and x counts from the start.
    ///
    /// # Errors
    /// What the FMU reports.
    pub fn depart(&mut self, duration: f64) -> Result<(), SlaveError> {
        self.standing = false;
        self.ahead = duration;
        (self.t, self.h) = (0.0, 0.0);
        self.refresh()?;
        // An FMU that says x itself has gone on meanwhile.
        let gone = self.motion[strip::X] - self.start_x;
        for wire in &mut self.outputs {
            if wire.quantity == Quantity::Motion(strip::X) {
                wire.offset -= gone;
            }
        }
        self.motion[strip::X] = self.start_x;
        self.motion[strip::WORK] = 0.0;
        Ok(())
    }

    /// The run's time, s; 0 before it.
    fn time(&self) -> f64 {
        if self.standing { 0.0 } else { self.t }
    }

    /// Position along the track where no output says it, m.
    fn x(&self) -> f64 {
        self.start_x + self.speed * self.time()
    }

    /// Reads the FMU and fills in what it does not offer.
    fn refresh(&mut self) -> Result<(), SlaveError> {
        self.slave.outputs(&mut self.read)?;
        let before = self.motion;
        self.motion[strip::X] = self.x();
        self.motion[strip::VX] = if self.standing { 0.0 } else { self.speed };
        for (wire, value) in self.outputs.iter().zip(&self.read) {
            if let Quantity::Motion(entry) = wire.quantity {
                if self.standing && matches!(entry, strip::X | strip::VX) {
                    continue;
                }
                self.motion[entry] = wire.factor * value + wire.offset;
            }
        }
        if !self.has_velocity && self.h > 0.0 {
            self.motion[strip::VZ] = (self.motion[strip::Z] - before[strip::Z]) / self.h;
        }
        Ok(())
    }
}

impl Slave for ThirdPartyPantograph {
    fn name(&self) -> &str {
        self.slave.name()
    }

    fn abilities(&self) -> Abilities {
        self.slave.abilities()
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.force.copy_from_slice(&values[..3]);
        self.rate = [0.0; 3];
        let (time, x) = (self.time(), self.x());
        for (wire, given) in self.inputs.iter().zip(&mut self.given) {
            let ours = match wire.quantity {
                Quantity::Force => -values[load::FZ],
                Quantity::Load(axis) => values[load::FX + axis],
                Quantity::Time => time,
                Quantity::X => x,
                Quantity::Motion(_) | Quantity::Unused => 0.0,
            };
            *given = wire.factor * ours + wire.offset;
        }
        self.slave.set_inputs(&self.given)
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        if order == 1 {
            self.rate.copy_from_slice(&values[..3]);
        }
        for (wire, given) in self.inputs.iter().zip(&mut self.given) {
            let ours = match wire.quantity {
                Quantity::Force => -values[load::FZ],
                Quantity::Load(axis) => values[load::FX + axis],
                Quantity::Time if order == 1 && !self.standing => 1.0,
                Quantity::X if order == 1 && !self.standing => self.speed,
                _ => 0.0,
            };
            *given = wire.factor * ours;
        }
        self.slave.set_input_derivatives(order, &self.given)
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.slave.do_step(t + self.ahead, h)?;
        let start = self.motion;
        self.t = t + h;
        self.h = h;
        self.refresh()?;
        // Mean force times way: an estimate, exact for a force that is constant over the step.
        for axis in 0..3 {
            let way = self.motion[strip::X + axis] - start[strip::X + axis];
            self.motion[strip::WORK] += (self.force[axis] + 0.5 * h * self.rate[axis]) * way;
        }
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.copy_from_slice(&self.motion);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = (self.t, self.motion);
        self.slave.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        (self.t, self.motion) = self.kept;
        self.slave.restore()
    }

    fn draw(&mut self, frame: &mut Frame) {
        let (x, z) = (self.motion[strip::X], self.motion[strip::Z]);
        frame
            .pantographs
            .push(vec![vec![(x - HALF_STRIP, z), (x + HALF_STRIP, z)]]);
    }
}
