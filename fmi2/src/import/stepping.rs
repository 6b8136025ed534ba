//! Steps of an instance.

use super::instance::Instance;
use crate::Error;
use crate::abi::{FALSE, Status, StatusKind, fmi2Status};
use std::ffi::c_int;
use std::time::{Duration, Instant};

/// Longest wall time for a step that is pending although asynchronous steps were not requested.
const PENDING_LIMIT: Duration = Duration::from_secs(60);

/// Outcome of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepOutcome {
    /// The instance is at the end of the step.
    Ok,
    /// Only part of the step was computed: restore a saved state and try a smaller one.
    Discard,
}

impl Instance {
    /// Goes from `time` to `time + step`, s. The FMU is told that the importer may come back to this point.
    ///
    /// # Errors
    ///
    /// The FMU refuses, or stays pending.
    pub fn do_step(&mut self, time: f64, step: f64) -> Result<StepOutcome, Error> {
        let name = "fmi2DoStep";
        let function = self.functions().do_step;
        let mark = self.environment().mark();
        self.note().at(time);
        // SAFETY: the component is alive.
        let call = |component| unsafe { function(component, time, step, FALSE) };
        let mut status = self.status_of(name, call)?;
        if status == Status::Pending {
            status = self.awaited()?;
        }
        match status {
            Status::Ok | Status::Warning => {
                self.note().at(time + step);
                Ok(StepOutcome::Ok)
            }
            Status::Discard => Ok(StepOutcome::Discard),
            status => Err(self.failure(name, status, mark)),
        }
    }

    /// Waits for a step that the FMU runs asynchronously although this was not requested.
    fn awaited(&mut self) -> Result<Status, Error> {
        let name = "fmi2GetStatus";
        let function = self.optional(name, self.functions().status)?;
        let begin = Instant::now();
        loop {
            let mut value = Status::Pending as fmi2Status;
            // SAFETY: the component is alive.
            self.call(name, |component| unsafe {
                function(component, StatusKind::DoStepStatus as c_int, &raw mut value)
            })?;
            // judges the value as if the step itself had returned it
            let status = self.status_of("fmi2DoStep", |_| value)?;
            if status != Status::Pending || begin.elapsed() > PENDING_LIMIT {
                return Ok(status);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Time up to which the last step was computed, s; `None` if the FMU cannot tell.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn last_successful_time(&mut self) -> Result<Option<f64>, Error> {
        let Some(function) = self.functions().real_status else {
            return Ok(None);
        };
        let mut value = 0.0;
        // SAFETY: the component is alive.
        let status = self.status_of("fmi2GetRealStatus", |component| unsafe {
            function(component, StatusKind::LastSuccessfulTime as c_int, &raw mut value)
        })?;
        Ok(matches!(status, Status::Ok | Status::Warning).then_some(value))
    }

    /// True if the FMU wants to end the simulation; `false` if the FMU cannot tell.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn wants_to_terminate(&mut self) -> Result<bool, Error> {
        let Some(function) = self.functions().boolean_status else {
            return Ok(false);
        };
        let mut value = FALSE;
        // SAFETY: the component is alive.
        let status = self.status_of("fmi2GetBooleanStatus", |component| unsafe {
            function(component, StatusKind::Terminated as c_int, &raw mut value)
        })?;
        Ok(matches!(status, Status::Ok | Status::Warning) && value != FALSE)
    }
}
