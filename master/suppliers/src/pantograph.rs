//! Supplied FMU as a pantograph.

use fmi2::import::Fmu;
use scene::{Offset, Scene, Supplied};

use super::driven::{Driven, Setting, start_value};
use super::probe::{Probe, probe};
use super::quantity::{Side, WiredValue, input, output};
use super::velocity::Rate;
use super::wiring::Wiring;
use super::{SupplierError, check_step, told_duration};
use component::Frame;
use component::exchange::{load, strip};
use cosim::slave::{Abilities, Slave, SlaveError};

/// Half the drawn length of a strip along the track, m.
const HALF_STRIP: f64 = 0.25;

/// Highest order of derivatives of the load.
const HIGHEST: usize = dynamics::MAX_ORDER;

/// State that changes from step to step.
#[derive(Clone, Copy, Debug)]
struct State {
    /// Time of the run, s.
    t: f64,
    motion: [f64; strip::OUTPUTS],
    /// Rates of x, y, z, where the FMU offers the position and not its rate.
    rates: [Option<Rate>; 3],
}

/// A pantograph FMU seen as a pantograph.
pub struct SuppliedPantograph {
    driven: Driven,
    inputs: Vec<WiredValue>,
    outputs: Vec<WiredValue>,
    start_x: f64,
    speed: f64,
    macro_step: f64,
    /// Load at the start of the step and its derivatives, N, N/s, …
    load: [[f64; 3]; HIGHEST + 1],
    degree: usize,
    state: State,
    kept: State,
    /// True while the pantograph stands at its start: x stays, and so does the clock.
    standing: bool,
    start_force: f64,
    probe: Probe,
}

impl SuppliedPantograph {
    /// Wires, tries, instantiates and initialises the FMU for pantograph `index` (from 0); what `entry` leaves open is
    /// written into it.
    ///
    /// # Errors
    /// A wiring that does not fit, and whatever the FMU reports.
    pub fn start(
        fmu: &Fmu,
        entry: &mut Supplied,
        scene: &Scene,
        index: usize,
        logging: bool,
    ) -> Result<Self, SupplierError> {
        let description = fmu.description();
        let wiring = Wiring::resolve(description, entry, Side::Pantograph, 1)?;
        let unit = super::driven::fixed_step(description);
        check_step(unit, scene.coupling.macro_step)?;
        let setting = Setting {
            name: format!("pantograph {}", index + 1),
            entry,
            initial: Vec::new(),
            parameters: Vec::new(),
            duration: told_duration(scene),
            logging,
        };
        // The names are checked before anything is tried.
        cosim::fmu_slave::check_names(description, &super::driven::role(&wiring, &setting))?;
        let request = super::driven::request(&wiring, scene.coupling.macro_step, &setting);
        let probe = probe(fmu, &request);
        if probe.effective_mass.is_some_and(|mass| mass < 0.0)
            && let Some(wire) = wiring
                .inputs
                .iter()
                .find(|wire| ["force", "force_z"].contains(&wire.name.as_str()))
        {
            return Err(SupplierError::Sign {
                name: wire.name.clone(),
                variable: wire.variable.clone(),
                force: 20.0,
                factor: -wire.factor,
            });
        }
        let start_force = wiring
            .inputs
            .iter()
            .find_map(|wire| {
                let WiredValue::Entry(load::FZ, sign) = input(Side::Pantograph, &wire.name) else {
                    return None;
                };
                Some(-sign * start_value(description, wire)?)
            })
            .unwrap_or(0.0);
        let places = |wires: &[super::Wire], place: fn(Side, &str) -> WiredValue| -> Vec<WiredValue> {
            wires.iter().map(|wire| place(Side::Pantograph, &wire.name)).collect()
        };
        let (inputs, outputs) = (places(&wiring.inputs, input), places(&wiring.outputs, output));
        let offered = |entry: usize| outputs.contains(&WiredValue::Entry(entry, 1.0));
        let rates = std::array::from_fn(|axis| {
            let mass = if axis == strip::Z { probe.effective_mass } else { None };
            (offered(strip::X + axis) && !offered(strip::VX + axis)).then(|| Rate::of_mass(mass))
        });
        let state = State {
            t: 0.0,
            motion: [0.0; strip::OUTPUTS],
            rates,
        };
        let mut pantograph = Self {
            driven: Driven::start(fmu, wiring, &setting, &probe)?,
            inputs,
            outputs,
            start_x: scene.head_start_x(index),
            speed: scene.run.speed,
            macro_step: scene.coupling.macro_step,
            load: [[0.0; 3]; HIGHEST + 1],
            degree: 0,
            state,
            kept: state,
            standing: false,
            start_force,
            probe,
        };
        pantograph
            .restart()
            .map_err(cosim::fmu_slave::CosimulationError::from)?;
        Ok(pantograph)
    }

    /// Height of the strip as the FMU stands, m.
    #[must_use]
    pub fn height(&self) -> f64 {
        self.state.motion[strip::Z]
    }

    /// Contact force at which the FMU starts, N: the start value of its force input, seen through the wiring; 0 where
    /// it has none.
    #[must_use]
    pub fn start_force(&self) -> f64 {
        self.start_force
    }

    /// Wires of the FMU.
    #[must_use]
    pub fn wiring(&self) -> &Wiring {
        self.driven.wiring()
    }

    /// Result of the trial of the FMU.
    #[must_use]
    pub fn probe(&self) -> &Probe {
        &self.probe
    }

    /// The only step it takes, s.
    #[must_use]
    pub fn unit(&self) -> Option<f64> {
        self.driven.unit()
    }

    /// Notes for the user on how the FMU is run.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks: Vec<String> = self
            .probe
            .remarks()
            .chain(self.driven.remarks().iter().cloned())
            .collect();
        if let Some(unit) = self.unit()
            && let Some(count) = super::driven::pieces(unit, self.macro_step)
        {
            remarks.push(match count {
                1 => format!("it takes steps of {unit} s only"),
                count => format!("it takes steps of {unit} s only, {count} of them per macro step"),
            });
        }
        if self.state.rates[strip::Z].is_some() {
            let from = match self.probe.effective_mass {
                Some(mass) if mass > 0.0 => format!(
                    "its last three heights and the change of the force on its effective mass, {mass:.2} kg; the \
                     error is of order 2 in the step, h²/3 times the rate of the other forces' acceleration"
                ),
                _ => "its last three heights; the error is of order 2 in the step, h²/3 times the third derivative of \
                the height"
                    .to_owned(),
            };
            remarks.push(format!("it offers no velocity: derived from {from}"));
        }
        remarks
    }

    /// Puts its height under a wire at `height` m: `offset = "align"`.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn align(&mut self, height: f64) -> Result<(), SlaveError> {
        self.shift(strip::Z, height - self.height());
        self.restart()
    }

    fn shift(&mut self, entry: usize, offset: f64) {
        for k in 0..self.outputs.len() {
            if self.outputs[k] == WiredValue::Entry(entry, 1.0) {
                self.driven.shift(k, offset);
            }
        }
    }

    /// Keeps it at its start while it steps; what its FMU says about x is not heard.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn stand(&mut self) -> Result<(), SlaveError> {
        self.standing = true;
        self.restart()
    }

    /// Ends a settling of `duration` s: the run's time is 0 now, and x counts from the start.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn depart(&mut self, duration: f64) -> Result<(), SlaveError> {
        self.standing = false;
        self.driven.ahead += duration;
        let velocity = self.state.motion[strip::VZ];
        self.restart()?;
        if self.state.rates[strip::Z].is_some() {
            self.state.motion[strip::VZ] = velocity;
        }
        // An FMU that says x itself has gone on meanwhile.
        self.shift(strip::X, self.start_x - self.state.motion[strip::X]);
        self.state.motion[strip::X] = self.start_x;
        self.state.motion[strip::WORK] = 0.0;
        Ok(())
    }

    /// The run's time, s; 0 before it.
    fn time(&self) -> f64 {
        if self.standing { 0.0 } else { self.state.t }
    }

    /// Position along the track where no output says it, m.
    fn x(&self) -> f64 {
        self.start_x + self.speed * self.time()
    }

    /// Reads the FMU where nothing is known of the past.
    fn restart(&mut self) -> Result<(), SlaveError> {
        self.state.t = 0.0;
        self.refresh(None)
    }

    /// Reads the FMU and fills in what it does not offer, after a step of so many s under a mean load.
    fn refresh(&mut self, step: Option<(f64, [f64; 3])>) -> Result<(), SlaveError> {
        let (x, standing) = (self.x(), self.standing);
        let speed = if standing { 0.0 } else { self.speed };
        let (outputs, motion) = (&self.outputs, &mut self.state.motion);
        motion[strip::X] = x;
        motion[strip::VX] = speed;
        self.driven.read(|k, value| {
            if let WiredValue::Entry(entry, _) = outputs[k]
                && !(standing && matches!(entry, strip::X | strip::VX))
            {
                motion[entry] = value;
            }
        })?;
        for axis in 0..3 {
            let Some(rate) = &mut self.state.rates[axis] else {
                continue;
            };
            let position = motion[strip::X + axis];
            motion[strip::VX + axis] = match step {
                Some((h, mean)) => rate.next(position, h, mean[axis]),
                None => {
                    rate.restart(position);
                    if axis == strip::X { speed } else { 0.0 }
                }
            };
        }
        Ok(())
    }

    /// Sets the load or one of its derivatives.
    fn set(&mut self, order: usize, values: &[f64]) {
        if order == 0 {
            self.load = [[0.0; 3]; HIGHEST + 1];
        }
        self.load[order].copy_from_slice(&values[..3]);
        self.degree = order;
        let (time, x) = (self.time(), self.x());
        let (inputs, speed, standing) = (&self.inputs, self.speed, self.standing);
        self.driven.set(order, |k| match (inputs[k], order) {
            (WiredValue::Entry(entry, sign), _) => sign * values[entry],
            (WiredValue::Time, 0) => time,
            (WiredValue::X, 0) => x,
            (WiredValue::Time, 1) if !standing => 1.0,
            (WiredValue::X, 1) if !standing => speed,
            _ => 0.0,
        });
    }
}

impl Slave for SuppliedPantograph {
    fn name(&self) -> &str {
        self.driven.name()
    }

    fn abilities(&self) -> Abilities {
        self.driven.abilities(self.macro_step)
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        self.set(0, values);
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        self.set(order, values);
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.driven.do_step(t, h)?;
        let start = self.state.motion;
        self.state.t = t + h;
        let mut mean = [0.0; 3];
        for (axis, mean) in mean.iter_mut().enumerate() {
            let mut power = 1.0;
            for order in 0..=self.degree {
                *mean += self.load[order][axis] * power;
                power *= h / (order + 2) as f64;
            }
        }
        self.refresh(Some((h, mean)))?;
        // Mean force times way: an estimate, exact for a force that is constant over the step.
        let motion = &mut self.state.motion;
        for axis in 0..3 {
            motion[strip::WORK] += mean[axis] * (motion[strip::X + axis] - start[strip::X + axis]);
        }
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        values.copy_from_slice(&self.state.motion);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept = self.state;
        self.driven.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.state = self.kept;
        self.driven.restore()
    }

    fn draw(&mut self, frame: &mut Frame) {
        let (x, z) = (self.state.motion[strip::X], self.state.motion[strip::Z]);
        frame
            .pantographs
            .push(vec![vec![(x - HALF_STRIP, z), (x + HALF_STRIP, z)]]);
    }
}

/// True where a scene asks for the height to be aligned with the wire.
#[must_use]
pub fn aligned(entry: &Supplied) -> bool {
    entry
        .outputs
        .get("height")
        .is_some_and(|height| height.offset == Offset::Align)
}
