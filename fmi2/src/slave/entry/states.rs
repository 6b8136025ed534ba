//! Saving, restoring and serialising states.

use crate::abi::{Status, fmi2Byte, fmi2Component, fmi2FMUstate, fmi2Status};
use crate::slave::instance::{Failure, Instance, elements, elements_mut, enter, refuse};
use crate::slave::model::Model;
use crate::slave::phase::Call;
use crate::slave::saved::{self, Saved};

/// The saved state behind a pointer; one of another FMU made of the same library is refused by its GUID, as serialised
/// states are.
///
/// # Safety
///
/// `state` is null or was made by `get_fmu_state` or `deserialize_fmu_state` of the same library and not freed.
unsafe fn behind<'a, M: Model>(state: fmi2FMUstate, guid: &str) -> Result<&'a mut Saved<M>, Failure> {
    // SAFETY: forwarded to the caller.
    match unsafe { state.cast::<Saved<M>>().as_mut() } {
        Some(saved) if saved.guid == guid => Ok(saved),
        Some(saved) => refuse(format!("the state is of the FMU {}, this one is {guid}", saved.guid)),
        None => refuse("the state is null"),
    }
}

/// `fmi2GetFMUstate`: a state that is passed in is used again.
pub unsafe fn get_fmu_state<M: Model>(component: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: null or the importer's variable.
        let Some(state) = (unsafe { state.as_mut() }) else {
            return refuse("the pointer to the state is null");
        };
        let (progress, experiment_set) = (instance.progress, instance.experiment_set);
        if state.is_null() {
            let model = instance.model.save();
            *state = Box::into_raw(Box::new(Saved::<M> {
                guid: instance.guid.clone(),
                progress,
                experiment_set,
                model,
            }))
            .cast();
        } else {
            // SAFETY: not null, so a state of this library.
            let saved = unsafe { behind::<M>(*state, &instance.guid) }?;
            instance.model.save_into(&mut saved.model);
            saved.progress = progress;
            saved.experiment_set = experiment_set;
        }
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::GetFmuState, "fmi2GetFMUstate", body) }
}

/// `fmi2SetFMUstate`: any number of times, in any phase.
pub unsafe fn set_fmu_state<M: Model>(component: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: null or a state of this library.
        let saved = unsafe { behind::<M>(state, &instance.guid) }?;
        instance.model.restore(&saved.model)?;
        instance.progress = saved.progress;
        instance.experiment_set = saved.experiment_set;
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::SetFmuState, "fmi2SetFMUstate", body) }
}

/// `fmi2FreeFMUstate`: null is ignored, the pointer is null afterwards.
pub unsafe fn free_fmu_state<M: Model>(component: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    let body = |_: &mut Instance<M>| {
        // SAFETY: null or the importer's variable.
        if let Some(state) = unsafe { state.as_mut() }
            && !state.is_null()
        {
            // SAFETY: made by `Box::into_raw` here and not freed yet; the pointer is cleared at once.
            drop(unsafe { Box::from_raw(std::mem::take(&mut *state).cast::<Saved<M>>()) });
        }
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::OtherState, "fmi2FreeFMUstate", body) }
}

/// `fmi2SerializedFMUstateSize`.
pub unsafe fn serialized_fmu_state_size<M: Model>(
    component: fmi2Component,
    state: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: null or a state of this library.
        let saved = unsafe { behind::<M>(state, &instance.guid) }?;
        // SAFETY: null or the importer's variable.
        let Some(size) = (unsafe { size.as_mut() }) else {
            return refuse("the pointer to the size is null");
        };
        *size = saved::serialize(saved)?.len();
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::OtherState, "fmi2SerializedFMUstateSize", body) }
}

/// `fmi2SerializeFMUstate`.
pub unsafe fn serialize_fmu_state<M: Model>(
    component: fmi2Component,
    state: fmi2FMUstate,
    bytes: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: null or a state of this library.
        let saved = unsafe { behind::<M>(state, &instance.guid) }?;
        let content = saved::serialize(saved)?;
        if size < content.len() {
            return refuse(format!("the state takes {} bytes, room is for {size}", content.len()));
        }
        // SAFETY: the importer's buffer; its bytes are taken as `u8`, which has the same layout.
        let buffer = unsafe { elements_mut(bytes.cast::<u8>(), size, "bytes") }?;
        buffer[..content.len()].copy_from_slice(&content);
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::OtherState, "fmi2SerializeFMUstate", body) }
}

/// `fmi2DeSerializeFMUstate`: always a new state.
pub unsafe fn deserialize_fmu_state<M: Model>(
    component: fmi2Component,
    bytes: *const fmi2Byte,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: the importer's buffer; its bytes are taken as `u8`, which has the same layout.
        let content = unsafe { elements(bytes.cast::<u8>(), size, "bytes") }?;
        // SAFETY: null or the importer's variable.
        let Some(state) = (unsafe { state.as_mut() }) else {
            return refuse("the pointer to the state is null");
        };
        let saved = saved::deserialize::<M>(content, &instance.guid)?;
        *state = Box::into_raw(Box::new(saved)).cast();
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::OtherState, "fmi2DeSerializeFMUstate", body) }
}
