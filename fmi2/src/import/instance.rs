//! Instance of an FMU.

use super::binary::{Binary, Functions};
use super::fmu::Shared;
use super::guard::Note;
use super::host::HostState;
use super::log::{Environment, Listener, LogMessage};
use crate::abi::{
    FALSE, InstanceKind, Status, TRUE, fmi2CallbackFunctions, fmi2Component, fmi2ComponentEnvironment, fmi2FMUstate,
    fmi2Status, fmi2String,
};
use crate::error::Log;
use crate::{Error, location};
use std::collections::BTreeSet;
use std::ffi::{CString, c_int, c_void};
use std::fmt;
use std::rc::Rc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

unsafe extern "C" {
    fn fmi2_import_logger(
        environment: fmi2ComponentEnvironment,
        instance: fmi2String,
        status: fmi2Status,
        category: fmi2String,
        message: fmi2String,
        ...
    );
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(pointer: *mut c_void);
}

/// GUIDs of FMUs that allow one instance and have one.
static ONLY_ONCE: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
static NUMBER: AtomicU64 = AtomicU64::new(1);

/// Calls that are still allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Condition {
    Usable,
    /// Initialised, to be terminated at the end.
    Running,
    /// After `fmi2Error`.
    Failed,
    Terminated,
}

/// An instance of an FMU. Functions return an error that names FMU, instance, function, status and the messages of
/// the FMU; the order of calls is that of the standard [FMI 2.0, 4.2.4] and is left to the FMU to check.
pub struct Instance {
    component: fmi2Component,
    name: String,
    condition: Condition,
    pub(super) states: Vec<fmi2FMUstate>,
    /// Number of the instance in this process.
    pub(super) number: u64,
    only_once: bool,
    /// The FMU keeps pointers to both, so neither moves; leaked if the instance may not be freed.
    callbacks: Rc<fmi2CallbackFunctions>,
    environment: Arc<Environment>,
    binary: Arc<Binary>,
    shared: Arc<Shared>,
    /// Note of the call under way, for observers.
    note: Noted,
}

/// Returns a note when dropped, after all its users.
struct Noted(&'static Note);

impl Drop for Noted {
    fn drop(&mut self) {
        self.0.release();
    }
}

// SAFETY: an instance may be used from different threads, one at a time [FMI 2.0, 2.1.1]; `&mut self` sees to that,
// and what is shared with callbacks from other threads is behind locks.
unsafe impl Send for Instance {}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Instance")
            .field("fmu", &self.shared.path)
            .field("name", &self.name)
            .field("condition", &self.condition)
            .finish_non_exhaustive()
    }
}

pub(super) fn c_text(what: &'static str, text: &str) -> Result<CString, Error> {
    CString::new(text).map_err(|_| Error::BadText {
        what,
        text: text.to_owned(),
    })
}

impl Instance {
    pub(super) fn new(
        shared: Arc<Shared>,
        binary: Arc<Binary>,
        note: &'static Note,
        (name, visible, logging): (&str, bool, bool),
        listener: Option<Listener>,
    ) -> Result<Self, Error> {
        let note = Noted(note);
        let description = &shared.description;
        let fmu = description.model_name.clone();
        if name.trim().is_empty() {
            return Err(Error::BadText {
                what: "instance name",
                text: name.to_owned(),
            });
        }
        if binary.is_fatal() {
            return Err(Error::AfterFatal {
                fmu,
                instance: name.to_owned(),
                function: "fmi2Instantiate",
            });
        }
        let only_once = description.co_simulation.can_be_instantiated_only_once_per_process;
        let resources = location::uri(&shared.folder().join("resources"));
        let (c_name, guid, resources) = (
            c_text("instance name", name)?,
            c_text("GUID", &description.guid)?,
            c_text("resource location", &resources)?,
        );
        if only_once
            && !ONLY_ONCE
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .insert(description.guid.clone())
        {
            return Err(Error::OnlyOnce {
                path: shared.path.clone(),
            });
        }
        let environment = Arc::new(Environment::new(description, listener));
        for warning in &binary.warnings {
            let category = String::new();
            environment.push(LogMessage {
                status: Status::Warning,
                category,
                text: warning.clone(),
            });
        }
        let callbacks = Rc::new(fmi2CallbackFunctions {
            logger: Some(fmi2_import_logger),
            allocate_memory: Some(calloc),
            free_memory: Some(free),
            step_finished: None,
            component_environment: Arc::as_ptr(&environment).cast_mut().cast(),
        });
        let mark = environment.mark();
        let host = HostState::remembered();
        // SAFETY: the arguments are what FMI 2.0, 2.1.5 asks for; texts live during the call, callbacks and
        // environment as long as the instance.
        let make = || unsafe {
            (binary.functions.instantiate)(
                c_name.as_ptr(),
                InstanceKind::CoSimulation as c_int,
                guid.as_ptr(),
                resources.as_ptr(),
                Rc::as_ptr(&callbacks),
                if visible { TRUE } else { FALSE },
                if logging { TRUE } else { FALSE },
            )
        };
        let component = note.0.during("fmi2Instantiate", make);
        drop(host);
        let instance = Self {
            component,
            name: name.to_owned(),
            condition: Condition::Usable,
            states: Vec::new(),
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            only_once,
            callbacks,
            environment,
            binary,
            shared,
            note,
        };
        if component.is_null() {
            let log = Log(instance.environment().since(mark));
            return Err(Error::Instantiate {
                fmu,
                instance: name.to_owned(),
                log,
            });
        }
        Ok(instance)
    }

    /// Name of the instance.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Messages since the last time, at most the last thousand.
    pub fn take_log(&mut self) -> Vec<LogMessage> {
        self.environment().take()
    }

    pub(super) fn environment(&self) -> &Environment {
        &self.environment
    }

    pub(super) fn functions(&self) -> Functions {
        self.binary.functions
    }

    pub(super) fn component(&self) -> fmi2Component {
        self.component
    }

    pub(super) fn note(&self) -> &'static Note {
        self.note.0
    }

    pub(super) fn mark_fatal(&self) {
        self.binary.set_fatal();
    }

    /// A restored state that was saved while running runs again.
    pub(super) fn mark_restored(&mut self) {
        if matches!(self.condition, Condition::Failed | Condition::Terminated) {
            self.condition = Condition::Running;
        }
    }

    fn names(&self) -> (String, String) {
        (self.shared.description.model_name.clone(), self.name.clone())
    }

    pub(super) fn optional<T>(&self, function: &'static str, found: Option<T>) -> Result<T, Error> {
        found.ok_or_else(|| {
            let (fmu, instance) = self.names();
            Error::Unsupported {
                fmu,
                instance,
                function,
            }
        })
    }

    /// Calls the FMU: `Ok` and `Warning` are fine, `Discard` and `Pending` are returned, all else is an error. An
    /// integer that is no status is fatal, because its meaning is unknown.
    pub(super) fn status_of(
        &mut self,
        function: &'static str,
        call: impl FnOnce(fmi2Component) -> fmi2Status,
    ) -> Result<Status, Error> {
        if self.binary.is_fatal() {
            let (fmu, instance) = self.names();
            return Err(Error::AfterFatal {
                fmu,
                instance,
                function,
            });
        }
        let mark = self.environment().mark();
        let component = self.component;
        let status = self.note.0.during(function, || call(component));
        let status = Status::try_from(status).unwrap_or(Status::Fatal);
        match status {
            Status::Ok | Status::Warning | Status::Discard | Status::Pending => return Ok(status),
            Status::Error => self.condition = Condition::Failed,
            Status::Fatal => self.mark_fatal(),
        }
        Err(self.failure(function, status, mark))
    }

    pub(super) fn failure(&self, function: &'static str, status: Status, mark: u64) -> Error {
        let (fmu, instance) = self.names();
        Error::Call {
            fmu,
            instance,
            function,
            status,
            log: Log(self.environment().since(mark)),
        }
    }

    /// A call for which only `Ok` and `Warning` are fine.
    pub(super) fn call(
        &mut self,
        function: &'static str,
        call: impl FnOnce(fmi2Component) -> fmi2Status,
    ) -> Result<(), Error> {
        let mark = self.environment().mark();
        match self.status_of(function, call)? {
            Status::Ok | Status::Warning => Ok(()),
            status => Err(self.failure(function, status, mark)),
        }
    }

    /// Chooses the logged categories; an empty list means all.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), Error> {
        let name = "fmi2SetDebugLogging";
        let function = self.optional(name, self.functions().set_debug_logging)?;
        let texts = categories
            .iter()
            .map(|text| c_text("log category", text))
            .collect::<Result<Vec<_>, _>>()?;
        let pointers: Vec<_> = texts.iter().map(|text| text.as_ptr()).collect();
        let on = if on { TRUE } else { FALSE };
        // SAFETY: the component is alive; the array has as many texts as is said.
        self.call(name, |component| unsafe {
            function(component, on, pointers.len(), pointers.as_ptr())
        })
    }

    /// Tells the plan: times in s, relative tolerance.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn setup_experiment(
        &mut self,
        start_time: f64,
        stop_time: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), Error> {
        let function = self.functions().setup_experiment;
        let defined = |value: Option<f64>| if value.is_some() { TRUE } else { FALSE };
        let (tolerance_defined, stop_defined) = (defined(tolerance), defined(stop_time));
        let (tolerance, stop) = (tolerance.unwrap_or(0.0), stop_time.unwrap_or(0.0));
        // SAFETY: the component is alive.
        self.call("fmi2SetupExperiment", |component| unsafe {
            function(component, tolerance_defined, tolerance, start_time, stop_defined, stop)
        })?;
        self.note.0.at(start_time);
        Ok(())
    }

    /// Begins the initialisation.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        let function = self.functions().enter_initialization_mode;
        let _host = HostState::remembered();
        // SAFETY: the component is alive.
        self.call("fmi2EnterInitializationMode", |component| unsafe {
            function(component)
        })
    }

    /// Ends the initialisation.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        let function = self.functions().exit_initialization_mode;
        let _host = HostState::remembered();
        // SAFETY: the component is alive.
        self.call("fmi2ExitInitializationMode", |component| unsafe { function(component) })?;
        self.condition = Condition::Running;
        Ok(())
    }

    /// Ends the simulation; values can still be read.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn terminate(&mut self) -> Result<(), Error> {
        let function = self.functions().terminate;
        // SAFETY: the component is alive.
        self.call("fmi2Terminate", |component| unsafe { function(component) })?;
        self.condition = Condition::Terminated;
        Ok(())
    }

    /// Returns to the state after instantiation, also after an error.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn reset(&mut self) -> Result<(), Error> {
        let function = self.functions().reset;
        // SAFETY: the component is alive.
        self.call("fmi2Reset", |component| unsafe { function(component) })?;
        self.condition = Condition::Usable;
        Ok(())
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if !self.component.is_null() && !self.binary.is_fatal() {
            self.free_states();
        }
        if !self.component.is_null() && self.condition == Condition::Running && !self.binary.is_fatal() {
            let (terminate, component) = (self.binary.functions.terminate, self.component);
            // SAFETY: the component is alive.
            let status = self.note.0.during("fmi2Terminate", || unsafe { terminate(component) });
            if status == Status::Fatal as c_int {
                self.mark_fatal();
            }
        }
        if self.binary.is_fatal() {
            // the FMU was not freed and may still use them
            std::mem::forget((Rc::clone(&self.callbacks), Arc::clone(&self.environment)));
        } else if !self.component.is_null() {
            let (free, component) = (self.binary.functions.free_instance, self.component);
            // SAFETY: the component is alive and not used again.
            self.note.0.during("fmi2FreeInstance", || unsafe { free(component) });
        }
        if self.only_once {
            let mut guids = ONLY_ONCE.lock().unwrap_or_else(PoisonError::into_inner);
            guids.remove(&self.shared.description.guid);
        }
    }
}
