//! Instantiate, set up, initialise, end.

use crate::abi::{
    InstanceKind, Status, fmi2Boolean, fmi2CallbackFunctions, fmi2Component, fmi2Real, fmi2Status, fmi2String, fmi2Type,
};
use crate::slave::guard::guarded;
use crate::slave::instance::{Failure, Instance, Oddity, Progress, elements, enter, refuse};
use crate::slave::logger::{Category, Logger};
use crate::slave::model::{Experiment, Model, ModelError};
use crate::slave::phase::{Call, Phase};
use crate::slave::resources;
use std::ffi::{CStr, CString};

/// `fmi2GetTypesPlatform`.
#[must_use]
pub fn types_platform<M: Model>() -> fmi2String {
    c"default".as_ptr()
}

/// `fmi2GetVersion`.
#[must_use]
pub fn version<M: Model>() -> fmi2String {
    c"2.0".as_ptr()
}

/// A text of the importer; null is `None`.
unsafe fn text<'a>(pointer: fmi2String) -> Option<std::borrow::Cow<'a, str>> {
    // SAFETY: a text of the importer is NUL-terminated and lives during the call.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) }.to_string_lossy())
}

/// `fmi2Instantiate`; null on failure, with a message to the logger.
pub unsafe fn instantiate<M: Model>(
    instance_name: fmi2String,
    fmu_type: fmi2Type,
    guid: fmi2String,
    resource_location: fmi2String,
    callbacks: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    logging_on: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: null or a valid struct of the importer; the logger keeps a copy of what it needs.
    let Some(callbacks) = (unsafe { callbacks.as_ref() }) else {
        return std::ptr::null_mut();
    };
    // SAFETY: texts of the importer.
    let (name, guid, location) = unsafe { (text(instance_name), text(guid), text(resource_location)) };
    let c_name = CString::new(name.as_deref().unwrap_or_default()).unwrap_or_default();
    let logger = Logger::new(callbacks, c_name, logging_on != 0);
    let made = guarded(|| -> Result<(M, String), ModelError> {
        if name.is_none_or(|name| name.trim().is_empty()) {
            return Err(ModelError::unusable("the instance name is missing or blank"));
        }
        match InstanceKind::try_from(fmu_type) {
            Ok(InstanceKind::CoSimulation) => {}
            Ok(InstanceKind::ModelExchange) => {
                return Err(ModelError::unusable(
                    "model exchange is not supported, only co-simulation",
                ));
            }
            Err(unknown) => return Err(ModelError::unusable(unknown)),
        }
        let folder = resources::resolved(location.as_deref())?;
        let own_guid = M::guid(folder.as_deref())?;
        match guid {
            Some(guid) if guid == own_guid => {}
            Some(guid) => {
                let message = format!("the GUID {guid} is not that of this FMU, {own_guid}");
                return Err(ModelError::unusable(message));
            }
            None => return Err(ModelError::unusable("the GUID is missing")),
        }
        Ok((M::instantiate(folder.as_deref())?, own_guid))
    });
    let instance = match made {
        Ok(Ok((model, guid))) => guarded(|| Instance::new(model, guid, logger)).ok(),
        Ok(Err(error)) => {
            logger.log(Category::Error, &format!("fmi2Instantiate: {error}"));
            None
        }
        Err(message) => {
            logger.log(Category::Error, &format!("fmi2Instantiate panicked: {message}"));
            None
        }
    };
    instance.map_or(std::ptr::null_mut(), |instance| {
        Box::into_raw(Box::new(instance)).cast()
    })
}

/// `fmi2FreeInstance`; null is ignored.
pub unsafe fn free_instance<M: Model>(component: fmi2Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: made by `Box::into_raw` in `instantiate` and not freed yet.
    let instance = unsafe { Box::from_raw(component.cast::<Instance<M>>()) };
    // a panic while dropping has nowhere to be reported: the logger is going away too
    let _ = guarded(move || drop(instance));
}

/// `fmi2SetDebugLogging`; an unknown category is a warning.
pub unsafe fn set_debug_logging<M: Model>(
    component: fmi2Component,
    logging_on: fmi2Boolean,
    n_categories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: the importer's array.
        let names = unsafe { elements(categories, n_categories, "categories") }?;
        let mut selected = Vec::new();
        let mut unknown = Vec::new();
        for &name in names {
            // SAFETY: texts of the importer.
            let name = unsafe { text(name) }.unwrap_or_default();
            match Category::from_name(&name) {
                Some(category) => selected.push(category),
                None => unknown.push(name.into_owned()),
            }
        }
        if names.is_empty() || !selected.is_empty() || logging_on == 0 {
            instance.logger.select(logging_on != 0, selected);
        }
        if unknown.is_empty() {
            return Ok(Status::Ok);
        }
        let message = format!("fmi2SetDebugLogging: there is no log category {}", unknown.join(", "));
        instance.logger.log(Category::Warning, &message);
        Ok(Status::Warning)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::SetDebugLogging, "fmi2SetDebugLogging", body) }
}

/// `fmi2SetupExperiment`.
pub unsafe fn setup_experiment<M: Model>(
    component: fmi2Component,
    tolerance_defined: fmi2Boolean,
    tolerance: fmi2Real,
    start_time: fmi2Real,
    stop_time_defined: fmi2Boolean,
    stop_time: fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        let experiment = Experiment {
            start_time,
            stop_time: (stop_time_defined != 0).then_some(stop_time),
            tolerance: (tolerance_defined != 0).then_some(tolerance),
        };
        if !start_time.is_finite() {
            return refuse(format!("start time = {start_time} s: must be finite"));
        }
        if let Some(stop) = experiment
            .stop_time
            .filter(|stop| !stop.is_finite() || *stop < start_time)
        {
            return refuse(format!(
                "stop time = {stop} s: must be finite and not before the start time, {start_time} s"
            ));
        }
        if let Some(tolerance) = experiment.tolerance.filter(|value| !value.is_finite() || *value < 0.0) {
            return refuse(format!("tolerance = {tolerance}: must be finite and not negative"));
        }
        instance.model.setup_experiment(experiment)?;
        instance.progress.experiment = experiment;
        instance.progress.time = start_time;
        instance.experiment_set = true;
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::SetupExperiment, "fmi2SetupExperiment", body) }
}

/// `fmi2EnterInitializationMode`.
pub unsafe fn enter_initialization_mode<M: Model>(component: fmi2Component) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        if !instance.experiment_set {
            instance.mention(Oddity::NoExperiment);
        }
        instance.model.enter_initialization()?;
        instance.progress.phase = Phase::Initialization;
        Ok(Status::Ok)
    };
    let name = "fmi2EnterInitializationMode";
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::EnterInitializationMode, name, body) }
}

/// `fmi2ExitInitializationMode`.
pub unsafe fn exit_initialization_mode<M: Model>(component: fmi2Component) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        instance.model.exit_initialization()?;
        instance.progress.phase = Phase::Step;
        Ok(Status::Ok)
    };
    let name = "fmi2ExitInitializationMode";
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::ExitInitializationMode, name, body) }
}

/// `fmi2Terminate`.
pub unsafe fn terminate<M: Model>(component: fmi2Component) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        instance.model.terminate();
        instance.progress.phase = Phase::Terminated;
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::Terminate, "fmi2Terminate", body) }
}

/// `fmi2Reset`: as after instantiation; the choice of log categories stays.
pub unsafe fn reset<M: Model>(component: fmi2Component) -> fmi2Status {
    let body = |instance: &mut Instance<M>| -> Result<Status, Failure> {
        instance.model.reset()?;
        instance.progress = Progress::new();
        instance.experiment_set = false;
        instance.strings.clear();
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::Reset, "fmi2Reset", body) }
}
