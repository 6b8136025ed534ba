//! Reading and setting variables.

use crate::abi::{
    Status, fmi2Boolean, fmi2Component, fmi2Integer, fmi2Real, fmi2Status, fmi2String, fmi2ValueReference,
};
use crate::model_description::{BaseType, Causality, Variable};
use crate::slave::instance::{Failure, Instance, Oddity, elements, elements_mut, enter, refuse};
use crate::slave::model::{Model, ModelError, ModelResult};
use crate::slave::phase::{Call, Phase};
use std::ffi::{CStr, CString};

/// Reads variables of one type; all references are checked before the first value is written.
unsafe fn get<M: Model, T>(
    component: fmi2Component,
    name: &str,
    base_type: BaseType,
    references: (*const fmi2ValueReference, usize),
    values: *mut T,
    read: impl Fn(&mut Instance<M>, usize) -> Result<T, Failure>,
) -> fmi2Status {
    let (references, count) = references;
    let body = |instance: &mut Instance<M>| {
        // SAFETY: arrays of the importer.
        let references = unsafe { elements(references, count, "value references") }?;
        // SAFETY: as above.
        let values = unsafe { elements_mut(values, count, "values") }?;
        for &reference in references {
            let (_, variable) = instance.variable(reference, base_type)?;
            let causality = variable.causality;
            if instance.progress.phase == Phase::Initialization && causality != Causality::Output {
                instance.mention(Oddity::AnyValueInInitialization);
            }
        }
        for (&reference, value) in references.iter().zip(values) {
            let (position, _) = instance.variable(reference, base_type)?;
            *value = read(instance, position)?;
        }
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::Get, name, body) }
}

/// Sets variables of one type; all references and values are checked before the first one is set.
unsafe fn set<M: Model, T: Copy>(
    component: fmi2Component,
    name: &str,
    base_type: BaseType,
    references: (*const fmi2ValueReference, usize),
    values: *const T,
    check: impl Fn(&Variable, T) -> Result<(), Failure>,
    write: impl Fn(&mut M, usize, T) -> ModelResult<()>,
) -> fmi2Status {
    let (references, count) = references;
    let body = |instance: &mut Instance<M>| {
        // SAFETY: arrays of the importer.
        let references = unsafe { elements(references, count, "value references") }?;
        // SAFETY: as above.
        let values = unsafe { elements(values, count, "values") }?;
        let phase = instance.progress.phase;
        let mut early_input = false;
        for (&reference, &value) in references.iter().zip(values) {
            let (_, variable) = instance.variable(reference, base_type)?;
            if !phase.allows_setting(variable) {
                return refuse(format!(
                    "{}, a {:?} {:?}, cannot be set {}",
                    variable.name,
                    variable.variability,
                    variable.causality,
                    phase.name()
                ));
            }
            early_input |= phase == Phase::Instantiated && variable.causality == Causality::Input;
            check(variable, value)?;
        }
        if early_input {
            instance.mention(Oddity::InputBeforeInitialization);
        }
        for (&reference, &value) in references.iter().zip(values) {
            let (position, _) = instance.variable(reference, base_type)?;
            write(&mut instance.model, position, value)?;
        }
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::Set, name, body) }
}

/// `fmi2GetReal`; a value that is not finite is an error.
pub unsafe fn get_real<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2Real,
) -> fmi2Status {
    let read = |instance: &mut Instance<M>, position: usize| {
        let value = instance.model.real(position)?;
        if !value.is_finite() {
            let (name, time) = (&instance.variables[position].name, instance.progress.time);
            return Err(ModelError::unusable(format!("{name} = {value} at t = {time} s: is not finite")).into());
        }
        Ok(value)
    };
    // SAFETY: the condition of this module.
    unsafe {
        get::<M, _>(
            component,
            "fmi2GetReal",
            BaseType::Real,
            (references, count),
            values,
            read,
        )
    }
}

/// `fmi2GetInteger`.
pub unsafe fn get_integer<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2Integer,
) -> fmi2Status {
    let read = |instance: &mut Instance<M>, position: usize| Ok(instance.model.integer(position)?);
    let references = (references, count);
    // SAFETY: the condition of this module.
    unsafe { get::<M, _>(component, "fmi2GetInteger", BaseType::Integer, references, values, read) }
}

/// `fmi2GetBoolean`: exactly 0 or 1.
pub unsafe fn get_boolean<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2Boolean,
) -> fmi2Status {
    let read = |instance: &mut Instance<M>, position: usize| Ok(fmi2Boolean::from(instance.model.boolean(position)?));
    let references = (references, count);
    // SAFETY: the condition of this module.
    unsafe { get::<M, _>(component, "fmi2GetBoolean", BaseType::Boolean, references, values, read) }
}

/// `fmi2GetString`: the texts live until the next call of this function on the instance.
pub unsafe fn get_string<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *mut fmi2String,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: arrays of the importer.
        let references = unsafe { elements(references, count, "value references") }?;
        // SAFETY: as above.
        let values = unsafe { elements_mut(values, count, "values") }?;
        let mut strings = Vec::with_capacity(count);
        for &reference in references {
            let (position, variable) = instance.variable(reference, BaseType::String)?;
            let name = variable.name.clone();
            let text = instance.model.string(position)?;
            let Ok(text) = CString::new(text) else {
                return refuse(format!("{name} holds a NUL character"));
            };
            strings.push(text);
        }
        instance.strings = strings;
        for (value, text) in values.iter_mut().zip(&instance.strings) {
            *value = text.as_ptr();
        }
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::Get, "fmi2GetString", body) }
}

/// `fmi2SetReal`; NaN and infinity are refused.
pub unsafe fn set_real<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2Real,
) -> fmi2Status {
    let (name, references) = ("fmi2SetReal", (references, count));
    // SAFETY: the condition of this module.
    unsafe { set::<M, _>(component, name, BaseType::Real, references, values, finite, M::set_real) }
}

/// Refuses NaN and infinity, naming the variable.
pub(super) fn finite(variable: &Variable, value: f64) -> Result<(), Failure> {
    if value.is_finite() {
        return Ok(());
    }
    let unit = variable.unit().unwrap_or_default();
    refuse(format!("{} = {value} {unit}: must be finite", variable.name))
}

/// `fmi2SetInteger`.
pub unsafe fn set_integer<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2Integer,
) -> fmi2Status {
    let (name, references) = ("fmi2SetInteger", (references, count));
    let any = |_: &Variable, _: fmi2Integer| Ok(());
    // SAFETY: the condition of this module.
    unsafe {
        set::<M, _>(
            component,
            name,
            BaseType::Integer,
            references,
            values,
            any,
            M::set_integer,
        )
    }
}

/// `fmi2SetBoolean`: anything but 0 is true.
pub unsafe fn set_boolean<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2Boolean,
) -> fmi2Status {
    let (name, references) = ("fmi2SetBoolean", (references, count));
    let any = |_: &Variable, _: fmi2Boolean| Ok(());
    let write = |model: &mut M, position: usize, value: fmi2Boolean| model.set_boolean(position, value != 0);
    // SAFETY: the condition of this module.
    unsafe { set::<M, _>(component, name, BaseType::Boolean, references, values, any, write) }
}

/// `fmi2SetString`; null and anything but UTF-8 are refused.
pub unsafe fn set_string<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    values: *const fmi2String,
) -> fmi2Status {
    let (name, references) = ("fmi2SetString", (references, count));
    let check = |variable: &Variable, value: fmi2String| {
        if value.is_null() {
            return refuse(format!("{}: the text is null", variable.name));
        }
        // SAFETY: a text of the importer, NUL-terminated, living during the call.
        match unsafe { CStr::from_ptr(value) }.to_str() {
            Ok(_) => Ok(()),
            Err(_) => refuse(format!("{}: the text is not UTF-8", variable.name)),
        }
    };
    let write = |model: &mut M, position: usize, value: fmi2String| {
        // SAFETY: checked above not to be null; else as there.
        model.set_string(position, &unsafe { CStr::from_ptr(value) }.to_string_lossy())
    };
    // SAFETY: the condition of this module.
    unsafe { set::<M, _>(component, name, BaseType::String, references, values, check, write) }
}
