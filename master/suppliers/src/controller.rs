//! Supplied FMU as the rule of a controlled drive.

use component::exchange::instrument;
use control::{Asked, Reading, Rule, Samples};
use dynamics::OutsideError;
use fmi2::import::Fmu;
use scene::{Scene, Supplied};

use super::driven::{Driven, Setting, fixed_step, nearest_multiple, pieces, request, role};
use super::probe::{Probe, probe};
use super::quantity::{Side, WiredValue, input};
use super::wiring::Wiring;
use super::{SupplierError, told_duration};
use cosim::fmu_slave::check_names;
use cosim::slave::SlaveError;

/// Sample that has been answered.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Answer {
    number: i64,
    shown: [f64; instrument::COUNT],
    /// N.
    command: f64,
}

/// A sample that lies before others that the FMU has already been asked for.
#[derive(Debug, thiserror::Error)]
#[error(
    "sample {number} is asked for after sample {last}, and it cannot go back to a saved state: \
     control.sample_time must be a multiple of coupling.macro_step"
)]
struct Past {
    number: i64,
    last: i64,
}

/// A controller FMU: asked once per sample.
///
/// Sample `k` at `t = k T` gives it what the instruments show and has it step from `t` to `t + T`; its output then is
/// the command of sample `k`. A sample that is repeated with the same readings, as in a macro step that is repeated,
/// has the same answer without a call; with other readings the FMU goes back to its saved state.
pub struct SuppliedController {
    driven: Driven,
    inputs: Vec<WiredValue>,
    samples: Samples,
    /// Time between two samples, s.
    sample_time: f64,
    last: Option<Answer>,
    /// Answer before the saved state.
    kept: Option<Answer>,
    /// True where the FMU has a saved state.
    saved: bool,
    /// Samples answered since the state was saved.
    answered: usize,
    /// True where the FMU goes back as soon as it has to.
    returning: bool,
    can_return: bool,
    /// Samples asked for since the start, number and readings of each, where they are kept.
    history: Option<Vec<f64>>,
    probe: Probe,
}

/// Numbers of a sample in a history.
const PER_SAMPLE: usize = 1 + instrument::COUNT;

/// A state that lies before samples that have been answered, of an FMU that does not go back.
#[derive(Debug, thiserror::Error)]
#[error(
    "it cannot go back to an earlier state (canGetAndSetFMUstate is false, or did not work in its trial): a simulation \
     made anew begins at the start"
)]
struct NoReturn;

impl SuppliedController {
    /// Wires, tries, instantiates and initialises the FMU of controller `index` (from 0); what `entry` leaves open is
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
        let wiring = Wiring::resolve(description, entry, Side::Controller, 1)?;
        let pantograph = scene.controllers[index].pantograph;
        let control = scene.pantographs.get(pantograph).and_then(|own| own.control.as_ref());
        let sample_time = control.map_or(scene.coupling.macro_step, |control| control.sample_time);
        if let Some(unit) = fixed_step(description).filter(|unit| pieces(*unit, sample_time).is_none()) {
            return Err(SupplierError::Sample {
                pantograph: pantograph + 1,
                sample_time,
                unit,
                nearest: nearest_multiple(unit, sample_time),
            });
        }
        let setting = Setting {
            name: format!("controller {}", index + 1),
            entry,
            initial: Vec::new(),
            parameters: Vec::new(),
            // The last sample looks beyond the end.
            duration: told_duration(scene) + sample_time,
            logging,
        };
        check_names(description, &role(&wiring, &setting))?;
        let probe = probe(fmu, &request(&wiring, sample_time, &setting));
        let inputs = wiring.inputs.iter().map(|wire| input(Side::Controller, &wire.name));
        let inputs = inputs.collect();
        let driven = Driven::start(fmu, wiring, &setting, &probe)?;
        Ok(Self {
            can_return: driven.abilities(sample_time).rollback,
            driven,
            inputs,
            samples: Samples::every(sample_time),
            sample_time,
            last: None,
            kept: None,
            saved: false,
            answered: 0,
            returning: false,
            history: None,
            probe,
        })
    }

    /// Wires of the FMU.
    #[must_use]
    pub fn wiring(&self) -> &Wiring {
        self.driven.wiring()
    }

    /// Notes for the user on how the FMU is run.
    #[must_use]
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks: Vec<String> = self.probe.remarks().collect();
        remarks.extend(self.driven.remarks().iter().cloned());
        if let Some(unit) = self.driven.unit() {
            remarks.push(format!("it takes steps of {unit} s only"));
        }
        remarks
    }

    /// Times of its samples.
    #[must_use]
    pub fn samples(&self) -> Samples {
        self.samples
    }

    /// True where it goes back to samples that it has answered.
    #[must_use]
    pub fn can_return(&self) -> bool {
        self.can_return
    }

    /// Command of sample `number`, N, from what the instruments show, in the order of [`instrument`].
    ///
    /// # Errors
    /// Error reported by the FMU, and a sample that it cannot go back to.
    pub fn command(&mut self, number: i64, shown: &[f64; instrument::COUNT]) -> Result<f64, SlaveError> {
        let t = self.samples.time(number);
        if let Some(command) = self.known(number, shown) {
            self.returning = false;
            return Ok(command);
        }
        self.go_back()?;
        if let Some(command) = self.known(number, shown) {
            return Ok(command);
        }
        if let Some(last) = self.last.filter(|last| last.number >= number) {
            let last = last.number;
            return Err(SlaveError::Call {
                slave: self.driven.name().to_owned(),
                action: "go back to a sample",
                source: Box::new(Past { number, last }),
            });
        }
        if let Some(asked) = &mut self.history {
            asked.push(number as f64);
            asked.extend_from_slice(shown);
        }
        let inputs = &self.inputs;
        self.driven.set(0, |wire| match inputs[wire] {
            WiredValue::Entry(entry, sign) => sign * shown[entry],
            WiredValue::Time => t,
            _ => 0.0,
        });
        self.driven.do_step(t, self.sample_time)?;
        let mut command = 0.0;
        self.driven.read(|_, value| command = value)?;
        self.last = Some(Answer {
            number,
            shown: *shown,
            command,
        });
        self.answered += 1;
        Ok(command)
    }

    /// Keeps what is asked from here on, so that it can go back to any state since: its state at the start is saved
    /// where it can be, and the questions are put again.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn keep_history(&mut self) -> Result<(), SlaveError> {
        if self.can_return {
            self.driven.save()?;
        }
        self.history = Some(Vec::new());
        Ok(())
    }

    /// Goes to the state after the questions `asked`.
    fn repeat(&mut self, asked: &[f64]) -> Result<(), OutsideError> {
        let history = self.history.as_deref().unwrap_or_default();
        let mut from = history.len();
        if !asked.starts_with(history) {
            if !self.can_return {
                return Err(OutsideError::new(NoReturn));
            }
            self.driven.restore().map_err(OutsideError::new)?;
            (self.last, self.answered, from) = (None, 0, 0);
            self.history = Some(Vec::new());
        }
        for question in asked[from..].chunks_exact(PER_SAMPLE) {
            let mut shown = [0.0; instrument::COUNT];
            shown.copy_from_slice(&question[1..]);
            SuppliedController::command(self, question[0] as i64, &shown).map_err(OutsideError::new)?;
        }
        Ok(())
    }

    /// The answer to the last sample, where it is the same again.
    fn known(&self, number: i64, shown: &[f64; instrument::COUNT]) -> Option<f64> {
        let same = self.last.filter(|last| last.number == number && last.shown == *shown);
        same.map(|last| last.command)
    }

    /// Goes back where that was put off.
    fn go_back(&mut self) -> Result<(), SlaveError> {
        if self.returning && self.can_return {
            self.driven.restore()?;
            (self.last, self.answered) = (self.kept, 0);
        }
        self.returning = false;
        Ok(())
    }

    /// Keeps the present state.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn save(&mut self) -> Result<(), SlaveError> {
        self.go_back()?;
        if self.can_return && (self.answered > 0 || !self.saved) {
            self.driven.save()?;
            self.saved = true;
        }
        (self.kept, self.answered) = (self.last, 0);
        Ok(())
    }

    /// Goes back to the kept state, or puts it off until a sample comes out otherwise.
    ///
    /// # Errors
    /// Error reported by the FMU.
    pub fn restore(&mut self) -> Result<(), SlaveError> {
        self.returning = self.answered > 0;
        if self.answered > 1 {
            self.go_back()?;
        }
        Ok(())
    }
}

impl Rule for SuppliedController {
    fn command(&mut self, number: i64, shown: &Reading, desired: f64) -> Result<f64, OutsideError> {
        let shown = vehicle::instruments(shown, desired);
        SuppliedController::command(self, number, &shown).map_err(OutsideError::new)
    }

    fn asked(&self) -> Asked {
        Asked(self.history.clone().unwrap_or_default())
    }

    fn ask_again(&mut self, asked: &Asked) -> Result<(), OutsideError> {
        self.repeat(&asked.0)
    }
}
