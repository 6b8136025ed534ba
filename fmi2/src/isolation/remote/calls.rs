//! The calls of an instance in a child as requests.

use std::net::Shutdown;

use crate::import::{LogMessage, StepOutcome};

use super::Remote;
use crate::instance::{FmuInstance, InstanceError, SavedState};
use crate::isolation::GRACE;
use crate::isolation::frame::{Malformed, Reader};
use crate::isolation::protocol::Code;

/// As many reals as were asked for.
fn reals(reader: &mut Reader<'_>, values: &mut [f64]) -> Result<(), Malformed> {
    if reader.length(8)? != values.len() {
        return Err(Malformed);
    }
    for value in values {
        *value = reader.f64()?;
    }
    Ok(())
}

/// As many whole numbers as were asked for.
fn integers<T>(reader: &mut Reader<'_>, values: &mut [T], of: impl Fn(i32) -> T) -> Result<(), Malformed> {
    if reader.length(4)? != values.len() {
        return Err(Malformed);
    }
    for value in values {
        *value = of(reader.i32()?);
    }
    Ok(())
}

impl FmuInstance for Remote {
    fn name(&self) -> &str {
        &self.name
    }

    fn setup_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<(), InstanceError> {
        let request = self.request(Code::SetupExperiment);
        request.f64(start);
        for value in [stop, tolerance] {
            request.u8(u8::from(value.is_some()));
            request.f64(value.unwrap_or(0.0));
        }
        self.time = Some(start);
        self.ask_for("fmi2SetupExperiment", |_| Ok(()))
    }

    fn enter_initialization_mode(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::EnterInitializationMode, "fmi2EnterInitializationMode")
    }

    fn exit_initialization_mode(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::ExitInitializationMode, "fmi2ExitInitializationMode")
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::Terminate, "fmi2Terminate")
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::Reset, "fmi2Reset")
    }

    fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetReal);
        request.u32s(references);
        request.f64s(values);
        self.put_off("fmi2SetReal")
    }

    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetInteger);
        request.u32s(references);
        request.i32s(values);
        self.put_off("fmi2SetInteger")
    }

    fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetBoolean);
        request.u32s(references);
        request.length(values.len());
        for value in values {
            request.i32(i32::from(*value));
        }
        self.put_off("fmi2SetBoolean")
    }

    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetString);
        request.u32s(references);
        for value in values {
            request.text(value);
        }
        self.put_off("fmi2SetString")
    }

    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), InstanceError> {
        if self.fresh && self.count == 0 && references == self.read_after_step {
            values.copy_from_slice(&self.fetched);
            return Ok(());
        }
        self.request(Code::GetReal).u32s(references);
        self.ask_for("fmi2GetReal", |reader| reals(reader, values))
    }

    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), InstanceError> {
        self.request(Code::GetInteger).u32s(references);
        self.ask_for("fmi2GetInteger", |reader| integers(reader, values, |value| value))
    }

    fn get_boolean(&mut self, references: &[u32], values: &mut [bool]) -> Result<(), InstanceError> {
        self.request(Code::GetBoolean).u32s(references);
        self.ask_for("fmi2GetBoolean", |reader| integers(reader, values, |value| value != 0))
    }

    fn get_string(&mut self, references: &[u32]) -> Result<Vec<String>, InstanceError> {
        self.request(Code::GetString).u32s(references);
        self.ask_for("fmi2GetString", |reader| {
            let count = reader.length(4)?;
            (0..count).map(|_| Ok(reader.text()?.to_owned())).collect()
        })
    }

    fn set_real_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), InstanceError> {
        let request = self.request(Code::SetRealInputDerivatives);
        request.u32s(references);
        request.i32s(orders);
        request.f64s(values);
        self.put_off("fmi2SetRealInputDerivatives")
    }

    fn get_real_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), InstanceError> {
        let request = self.request(Code::GetRealOutputDerivatives);
        request.u32s(references);
        request.i32s(orders);
        self.ask_for("fmi2GetRealOutputDerivatives", |reader| reals(reader, values))
    }

    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        derivatives: &mut [f64],
    ) -> Result<(), InstanceError> {
        let request = self.request(Code::DirectionalDerivative);
        request.u32s(unknowns);
        request.u32s(knowns);
        request.f64s(seed);
        self.ask_for("fmi2GetDirectionalDerivative", |reader| reals(reader, derivatives))
    }

    fn do_step(&mut self, time: f64, step: f64) -> Result<StepOutcome, InstanceError> {
        self.time = Some(time);
        let request = self.request(Code::DoStep);
        request.f64(time);
        request.f64(step);
        // taken out, so that the request can be written
        let references = std::mem::take(&mut self.read_after_step);
        if !references.is_empty() {
            self.request(Code::GetReal).u32s(&references);
        }
        self.read_after_step = references;
        let mut fetched = std::mem::take(&mut self.fetched);
        let outcome = self.ask_for("fmi2DoStep", |reader| {
            let done = reader.u8()? != 0;
            if done && !fetched.is_empty() {
                reals(reader, &mut fetched)?;
            }
            Ok(done)
        });
        self.fetched = fetched;
        if outcome? {
            self.fresh = !self.fetched.is_empty();
            self.time = Some(time + step);
            Ok(StepOutcome::Ok)
        } else {
            Ok(StepOutcome::Discard)
        }
    }

    fn last_successful_time(&mut self) -> Result<Option<f64>, InstanceError> {
        self.request(Code::LastSuccessfulTime);
        self.ask_for("fmi2GetRealStatus", |reader| {
            let known = reader.u8()? != 0;
            let time = reader.f64()?;
            Ok(known.then_some(time))
        })
    }

    fn wants_to_terminate(&mut self) -> Result<bool, InstanceError> {
        self.request(Code::WantsToTerminate);
        self.ask_for("fmi2GetBooleanStatus", |reader| Ok(reader.u8()? != 0))
    }

    fn save_state(&mut self) -> Result<SavedState, InstanceError> {
        self.request(Code::SaveState);
        self.ask_for("fmi2GetFMUstate", |reader| Ok(SavedState(reader.u32()?)))
    }

    fn save_state_again(&mut self, state: SavedState) -> Result<(), InstanceError> {
        let fresh = self.fresh;
        self.about(state, Code::SaveStateAgain, "fmi2GetFMUstate")?;
        self.fresh = fresh;
        Ok(())
    }

    fn restore_state(&mut self, state: SavedState) -> Result<(), InstanceError> {
        self.about(state, Code::RestoreState, "fmi2SetFMUstate")
    }

    fn free_state(&mut self, state: SavedState) -> Result<(), InstanceError> {
        self.about(state, Code::FreeState, "fmi2FreeFMUstate")
    }

    fn serialize_state(&mut self, state: SavedState) -> Result<Vec<u8>, InstanceError> {
        self.request(Code::SerializeState).u32(state.0);
        self.ask_for("fmi2SerializeFMUstate", |reader| Ok(reader.bytes()?.to_vec()))
    }

    fn deserialize_state(&mut self, bytes: &[u8]) -> Result<SavedState, InstanceError> {
        self.request(Code::DeserializeState).bytes(bytes);
        self.ask_for("fmi2DeSerializeFMUstate", |reader| Ok(SavedState(reader.u32()?)))
    }

    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetDebugLogging);
        request.u8(u8::from(on));
        request.length(categories.len());
        for category in categories {
            request.text(category);
        }
        self.ask_for("fmi2SetDebugLogging", |_| Ok(()))
    }

    fn take_log(&mut self) -> Vec<LogMessage> {
        self.heard = 0;
        self.log.drain(..).collect()
    }

    fn will_read(&mut self, references: &[u32]) {
        self.read_after_step = references.to_vec();
        self.fetched = vec![0.0; references.len()];
        self.fresh = false;
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        if !self.ended {
            // the child frees the instance in order when nothing more can come
            let _ = self.stream.shutdown(Shutdown::Write);
            let status = self.process.end(self.isolation.time_limit.saturating_add(GRACE));
            if !status.is_some_and(|status| status.success()) {
                eprintln!(
                    "{}: it failed at its end, in fmi2Terminate or fmi2FreeInstance",
                    self.name
                );
            }
        }
    }
}
