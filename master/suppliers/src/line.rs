//! Supplied FMU as a line.

use fmi2::import::Fmu;
use scene::{ParameterValue, Scene, Supplied};

use super::driven::{Driven, Setting, fixed_step, pieces, start_value};
use super::probe::{Probe, probe};
use super::quantity::{Side, WiredValue, input, output};
use super::wiring::Wiring;
use super::{SupplierError, check_step, told_duration};
use component::exchange::{contact, line_output_count, strip};
use cosim::fmu_slave::CosimulationError;
use cosim::slave::{Abilities, Slave, SlaveError};

/// A strip as the line is told of it before t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripAtStart {
    /// m.
    pub x: f64,
    /// m.
    pub height: f64,
    /// N.
    pub force: f64,
}

/// State that changes from step to step.
#[derive(Clone, Debug, Default)]
struct State {
    /// Time of the run, s.
    t: f64,
    /// Outputs in the order of the interface.
    values: Vec<f64>,
    /// Motion of the strips at the end of the last step, in the order of the interface.
    strips: Vec<f64>,
}

impl State {
    fn copy_from(&mut self, other: &Self) {
        self.t = other.t;
        self.values.clone_from(&other.values);
        self.strips.clone_from(&other.strips);
    }
}

/// A line FMU seen as a line.
///
/// Outputs that the FMU lacks are derived: the force from its vertical component or the other way round, means over a
/// step and samples inside it from the forces at both ends (trapezoid), the contact point from the strip, the work from
/// mean force and way.
pub struct SuppliedLine {
    driven: Driven,
    inputs: Vec<WiredValue>,
    /// Entry of the outputs and sign of each wire; `None` where nothing is used.
    outputs: Vec<Option<(usize, f64)>>,
    /// By entry of the outputs: whether the FMU offers it.
    offered: Vec<bool>,
    supports: Vec<usize>,
    start_x: Vec<f64>,
    speed: f64,
    macro_step: f64,
    /// Inputs and their derivatives at the start of the step.
    given: [Vec<f64>; dynamics::MAX_ORDER + 1],
    degree: usize,
    state: State,
    before: State,
    kept: State,
    standing: bool,
    probe: Probe,
}

/// Heights at which the FMU's strips start by itself, m; `None` where it does not say.
#[must_use]
pub fn own_heights(fmu: &Fmu, wiring: &Wiring, strips: usize) -> Vec<Option<f64>> {
    (1..=strips)
        .map(|i| {
            let name = format!("strip[{i}].z");
            let wire = wiring.inputs.iter().find(|wire| wire.name == name)?;
            start_value(fmu.description(), wire).filter(|height| *height > 0.0)
        })
        .collect()
}

/// Parameters of the FMU that say where strip `i` (from 0) starts, as ours have them, where the FMU has them and the
/// scene does not set them.
fn start_parameters(
    fmu: &Fmu,
    entry: &Supplied,
    scene: &Scene,
    i: usize,
    at: &StripAtStart,
) -> Vec<(String, ParameterValue)> {
    let values = [
        ("start.height", at.height),
        ("start.force", at.force),
        ("start.x", at.x),
        ("speed", scene.run.speed),
    ];
    values
        .into_iter()
        .map(|(name, value)| (format!("strip[{}].{name}", i + 1), value))
        .filter(|(name, _)| {
            let known = fmu.description().variable(name);
            known.is_some_and(|variable| variable.causality == fmi2::model_description::Causality::Parameter)
                && !entry.parameters.contains_key(name)
        })
        .map(|(name, value)| (name, ParameterValue::Number(value)))
        .collect()
}

impl SuppliedLine {
    /// Tries, instantiates and initialises the FMU under strips at `starts`.
    ///
    /// # Errors
    /// A macro step that it does not take, and whatever the FMU reports.
    pub fn start(
        fmu: &Fmu,
        entry: &Supplied,
        wiring: Wiring,
        scene: &Scene,
        starts: &[StripAtStart],
        logging: bool,
    ) -> Result<Self, SupplierError> {
        let strips = starts.len();
        check_step(fixed_step(fmu.description()), scene.coupling.macro_step)?;
        let inputs: Vec<WiredValue> = wiring.inputs.iter().map(|wire| input(Side::Line, &wire.name)).collect();
        let mut motions = vec![0.0; strips * strip::MOTION];
        for (i, at) in starts.iter().enumerate() {
            let motion = &mut motions[i * strip::MOTION..(i + 1) * strip::MOTION];
            motion[strip::X] = at.x;
            motion[strip::Z] = at.height;
            motion[strip::VX] = scene.run.speed;
        }
        let initial = wiring.inputs.iter().zip(&inputs).map(|(wire, place)| {
            let ours = match place {
                WiredValue::Entry(entry, sign) => sign * motions[*entry],
                _ => 0.0,
            };
            wire.factor * ours + wire.offset
        });
        let initial: Vec<f64> = initial.collect();
        let parameters: Vec<_> = starts
            .iter()
            .enumerate()
            .flat_map(|(i, at)| start_parameters(fmu, entry, scene, i, at))
            .collect();
        let setting = Setting {
            name: "line".to_owned(),
            entry,
            initial,
            parameters,
            duration: told_duration(scene),
            logging,
        };
        cosim::fmu_slave::check_names(fmu.description(), &super::driven::role(&wiring, &setting))?;
        let request = super::driven::request(&wiring, scene.coupling.macro_step, &setting);
        let probe = probe(fmu, &request);
        let mut supports: Vec<usize> = wiring
            .outputs
            .iter()
            .filter_map(|wire| match output(Side::Line, &wire.name) {
                WiredValue::Uplift(k) => Some(k),
                _ => None,
            })
            .collect();
        supports.sort_unstable();
        let count = line_output_count(strips, supports.len());
        let outputs: Vec<Option<(usize, f64)>> = wiring
            .outputs
            .iter()
            .map(|wire| match output(Side::Line, &wire.name) {
                WiredValue::Entry(entry, sign) => Some((entry, sign)),
                WiredValue::Uplift(k) => {
                    let place = supports.iter().position(|known| *known == k)?;
                    Some((strips * contact::COUNT + place, 1.0))
                }
                _ => None,
            })
            .collect();
        let mut offered = vec![false; count];
        for (entry, _) in outputs.iter().flatten() {
            offered[*entry] = true;
        }
        let state = State {
            t: 0.0,
            values: vec![0.0; count],
            strips: motions.clone(),
        };
        let mut line = Self {
            driven: Driven::start(fmu, wiring, &setting, &probe)?,
            inputs,
            outputs,
            offered,
            supports,
            start_x: starts.iter().map(|at| at.x).collect(),
            speed: scene.run.speed,
            macro_step: scene.coupling.macro_step,
            given: std::array::from_fn(|_| vec![0.0; strips * strip::MOTION]),
            degree: 0,
            before: state.clone(),
            kept: state.clone(),
            state,
            standing: false,
            probe,
        };
        line.given[0].copy_from_slice(&motions);
        line.refresh(None).map_err(CosimulationError::from)?;
        Ok(line)
    }

    /// Numbers (from 1) of the supports whose uplift it gives.
    #[must_use]
    pub fn supports(&self) -> &[usize] {
        &self.supports
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
            && let Some(count) = pieces(unit, self.macro_step)
        {
            remarks.push(format!("it takes steps of {unit} s only, {count} per macro step"));
        }
        if !self.offered[contact::MEAN_FZ] {
            remarks.push(
                "it offers no mean force: the mean over a step is that of the forces at both ends, with an error of \
                 order 2 in the step, and so is its work"
                    .to_owned(),
            );
        }
        if !self.can_stand() {
            remarks.push(
                "its strips' x is not an input: it cannot stand still before t = 0 and starts as initialised"
                    .to_owned(),
            );
        }
        remarks
    }

    /// True where the line can be kept under strips that do not travel; a line that moves the strips itself cannot.
    #[must_use]
    pub fn can_stand(&self) -> bool {
        (0..self.start_x.len()).all(|i| {
            self.inputs
                .contains(&WiredValue::Entry(i * strip::MOTION + strip::X, 1.0))
        })
    }

    /// Keeps the strips' places as they are.
    pub fn stand(&mut self) {
        self.standing = true;
    }

    /// Ends a settling of `duration` s: the run's time is 0 now.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn depart(&mut self, duration: f64) -> Result<(), SlaveError> {
        self.standing = false;
        self.driven.ahead += duration;
        self.state.t = 0.0;
        self.refresh(None)?;
        for i in 0..self.start_x.len() {
            let entry = i * contact::COUNT + contact::WORK;
            if !self.offered[entry] {
                self.state.values[entry] = 0.0;
            }
        }
        Ok(())
    }

    /// Reads the FMU and fills in what it does not offer, after a step of so many s.
    fn refresh(&mut self, step: Option<f64>) -> Result<(), SlaveError> {
        self.before.copy_from(&self.state);
        let (outputs, values) = (&self.outputs, &mut self.state.values);
        self.driven.read(|k, value| {
            if let Some((entry, sign)) = outputs[k] {
                values[entry] = sign * value;
            }
        })?;
        let time = if self.standing { 0.0 } else { self.state.t };
        for (i, start_x) in self.start_x.iter().enumerate() {
            let range = i * contact::COUNT..(i + 1) * contact::COUNT;
            let (now, before) = (
                &mut self.state.values[range.clone()],
                &self.before.values[range.clone()],
            );
            let offered = &self.offered[range];
            let strips = i * strip::MOTION..(i + 1) * strip::MOTION;
            let (strip, strip_before) = (
                &mut self.state.strips[strips.clone()],
                &self.before.strips[strips.clone()],
            );
            if let Some(h) = step {
                for (entry, value) in strip.iter_mut().enumerate() {
                    let (mut sum, mut power) = (0.0, 1.0);
                    for order in 0..=self.degree {
                        sum += self.given[order][strips.start + entry] * power;
                        power *= h / (order + 1) as f64;
                    }
                    *value = sum;
                }
            }
            strip[strip::X] = start_x + self.speed * time;
            derive(now, before, offered, strip, strip_before, step);
        }
        Ok(())
    }

    fn set(&mut self, order: usize, values: &[f64]) {
        if order == 0 {
            for given in &mut self.given[1..] {
                given.fill(0.0);
            }
        }
        self.given[order].copy_from_slice(values);
        self.degree = order;
        let (inputs, time, standing) = (
            &self.inputs,
            if self.standing { 0.0 } else { self.state.t },
            self.standing,
        );
        self.driven.set(order, |k| match (inputs[k], order) {
            (WiredValue::Entry(entry, sign), _) => sign * values[entry],
            (WiredValue::Time, 0) => time,
            (WiredValue::Time, 1) if !standing => 1.0,
            _ => 0.0,
        });
    }
}

/// Fills in what is not `offered` of one contact; `before` are its values a step ago.
fn derive(now: &mut [f64], before: &[f64], offered: &[bool], strip: &[f64], strip_before: &[f64], step: Option<f64>) {
    if !offered[contact::FZ] {
        now[contact::FZ] = -now[contact::FORCE];
    }
    if !offered[contact::FORCE] {
        now[contact::FORCE] = (-now[contact::FZ]).max(0.0);
    }
    for axis in 0..3 {
        let mean = contact::MEAN_FX + axis;
        if !offered[mean] {
            let end = now[contact::FX + axis];
            now[mean] = if step.is_some() {
                0.5 * (before[contact::FX + axis] + end)
            } else {
                end
            };
        }
    }
    for j in 1..=contact::SAMPLE_COUNT {
        let entry = contact::SAMPLES + j - 1;
        if !offered[entry] {
            let (from, to) = (before[contact::FORCE], now[contact::FORCE]);
            let part = j as f64 / contact::SAMPLE_COUNT as f64;
            now[entry] = if step.is_some() { from + part * (to - from) } else { to };
        }
    }
    if !offered[contact::X] {
        now[contact::X] = strip[strip::X];
    }
    if !offered[contact::Y] {
        now[contact::Y] = strip[strip::Y];
    }
    match (offered[contact::WIRE_Z], offered[contact::GAP]) {
        (false, true) => now[contact::WIRE_Z] = strip[strip::Z] + now[contact::GAP],
        (false, false) => {
            now[contact::WIRE_Z] = strip[strip::Z];
            now[contact::GAP] = 0.0;
        }
        (true, false) => now[contact::GAP] = now[contact::WIRE_Z] - strip[strip::Z],
        (true, true) => {}
    }
    if !offered[contact::WORK] && step.is_some() {
        // Mean force times way: an estimate.
        for axis in 0..3 {
            let way = strip[strip::X + axis] - strip_before[strip::X + axis];
            now[contact::WORK] -= now[contact::MEAN_FX + axis] * way;
        }
    }
}

impl Slave for SuppliedLine {
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
        self.state.t = t + h;
        self.refresh(Some(h))
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        // The phase before t = 0 asks for the contacts only.
        values.copy_from_slice(&self.state.values[..values.len()]);
        Ok(())
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.kept.copy_from(&self.state);
        self.driven.save()
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.state.copy_from(&self.kept);
        self.driven.restore()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_line_does_not_offer_follows_from_its_force() {
        let mut offered = vec![false; contact::COUNT];
        offered[contact::FORCE] = true;
        let (mut before, mut now) = (vec![0.0; contact::COUNT], vec![0.0; contact::COUNT]);
        (before[contact::FORCE], now[contact::FORCE]) = (100.0, 120.0);
        before[contact::FZ] = -100.0;
        let strip = |x: f64, z: f64| [x, 0.1, z, 0.0, 0.0, 0.0, 0.0];
        derive(
            &mut now,
            &before,
            &offered,
            &strip(5.0, 5.31),
            &strip(4.9, 5.30),
            Some(1e-3),
        );
        assert_eq!(now[contact::FZ], -120.0);
        assert_eq!(now[contact::MEAN_FZ], -110.0, "trapezoid");
        assert!((now[contact::SAMPLES + 4] - 110.0).abs() < 1e-12);
        assert!(
            (now[contact::WORK] - 110.0 * 0.01).abs() < 1e-12,
            "the strip lifts the line"
        );
        assert_eq!(
            (now[contact::X], now[contact::Y], now[contact::WIRE_Z]),
            (5.0, 0.1, 5.31)
        );
        // Of two that belong together, one is enough.
        offered[contact::FORCE] = false;
        offered[contact::FZ] = true;
        now[contact::FZ] = 3.0;
        derive(&mut now, &before, &offered, &strip(5.0, 5.31), &strip(4.9, 5.30), None);
        assert_eq!(now[contact::FORCE], 0.0, "a line does not pull");
    }
}
