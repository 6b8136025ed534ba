//! Saved states of an instance.

use super::instance::Instance;
use crate::Error;
use crate::abi::Status;

/// Largest serialised state that is taken, bytes.
const MAX_BYTES: usize = 1 << 30;

/// A saved state of one instance; freed by [`Instance::free_state`] or with the instance.
#[derive(Debug, PartialEq, Eq)]
pub struct StateHandle {
    slot: usize,
    /// Number of the instance.
    owner: u64,
}

/// # Panics
///
/// All panic if the handle is of another instance.
impl Instance {
    fn slot(&self, handle: &StateHandle) -> usize {
        assert!(
            handle.owner == self.number && self.states.get(handle.slot).is_some_and(|state| !state.is_null()),
            "the saved state is not of the instance \"{}\"",
            self.name()
        );
        handle.slot
    }

    /// A free place for a state.
    fn free_slot(&mut self) -> usize {
        self.states.iter().position(|state| state.is_null()).unwrap_or_else(|| {
            self.states.push(std::ptr::null_mut());
            self.states.len() - 1
        })
    }

    /// Saves the present state.
    ///
    /// # Errors
    ///
    /// The FMU cannot, or refuses.
    pub fn save_state(&mut self) -> Result<StateHandle, Error> {
        let name = "fmi2GetFMUstate";
        let function = self.optional(name, self.functions().get_state)?;
        let slot = self.free_slot();
        let mut state = std::ptr::null_mut();
        // SAFETY: the component is alive and the pointer is null, so the FMU allocates.
        self.call(name, |component| unsafe { function(component, &raw mut state) })?;
        self.states[slot] = state;
        Ok(StateHandle {
            slot,
            owner: self.number,
        })
    }

    /// Saves the present state in place of an older one, whose memory the FMU uses again.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn save_state_again(&mut self, handle: &StateHandle) -> Result<(), Error> {
        let name = "fmi2GetFMUstate";
        let function = self.optional(name, self.functions().get_state)?;
        let slot = self.slot(handle);
        let mut state = self.states[slot];
        // SAFETY: the component is alive and the state was made by it and not freed.
        let result = self.call(name, |component| unsafe { function(component, &raw mut state) });
        self.states[slot] = state;
        result.map(|_| ())
    }

    /// Goes back to a saved state; also after an error.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn restore_state(&mut self, handle: &StateHandle) -> Result<(), Error> {
        let name = "fmi2SetFMUstate";
        let function = self.optional(name, self.functions().set_state)?;
        let state = self.states[self.slot(handle)];
        // SAFETY: the component is alive and the state was made by it and not freed.
        self.call(name, |component| unsafe { function(component, state) })?;
        self.mark_restored();
        Ok(())
    }

    /// Frees a saved state.
    ///
    /// # Errors
    ///
    /// The FMU refuses.
    pub fn free_state(&mut self, handle: StateHandle) -> Result<(), Error> {
        let name = "fmi2FreeFMUstate";
        let function = self.optional(name, self.functions().free_state)?;
        let slot = self.slot(&handle);
        let mut state = std::mem::replace(&mut self.states[slot], std::ptr::null_mut());
        // SAFETY: the component is alive; the state was made by it and is forgotten above.
        self.call(name, |component| unsafe { function(component, &raw mut state) })
            .map(|_| ())
    }

    /// A saved state as bytes.
    ///
    /// # Errors
    ///
    /// The FMU cannot, refuses, or wants to write more than a gibibyte.
    pub fn serialize_state(&mut self, handle: &StateHandle) -> Result<Vec<u8>, Error> {
        let name = "fmi2SerializedFMUstateSize";
        let size_of = self.optional(name, self.functions().state_size)?;
        let state = self.states[self.slot(handle)];
        let mut size = 0;
        // SAFETY: the component is alive and the state was made by it and not freed.
        self.call(name, |component| unsafe { size_of(component, state, &raw mut size) })?;
        if size > MAX_BYTES {
            return Err(Error::StateTooLarge {
                instance: self.name().to_owned(),
                size,
                limit: MAX_BYTES,
            });
        }
        let name = "fmi2SerializeFMUstate";
        let serialize = self.optional(name, self.functions().serialize_state)?;
        let mut bytes = vec![0_u8; size];
        // SAFETY: as above; the buffer has as many bytes as the FMU asked for.
        self.call(name, |component| unsafe {
            serialize(component, state, bytes.as_mut_ptr().cast(), size)
        })?;
        Ok(bytes)
    }

    /// A saved state from bytes; the present state does not change.
    ///
    /// # Errors
    ///
    /// The FMU cannot, or refuses the bytes.
    pub fn deserialize_state(&mut self, bytes: &[u8]) -> Result<StateHandle, Error> {
        let name = "fmi2DeSerializeFMUstate";
        let function = self.optional(name, self.functions().deserialize_state)?;
        let slot = self.free_slot();
        let mut state = std::ptr::null_mut();
        let call = |component| {
            // SAFETY: the component is alive, the bytes are as many as is said, the pointer is null.
            unsafe { function(component, bytes.as_ptr().cast(), bytes.len(), &raw mut state) }
        };
        self.call(name, call)?;
        self.states[slot] = state;
        Ok(StateHandle {
            slot,
            owner: self.number,
        })
    }

    /// Frees all states that are left; the instance is going away.
    pub(super) fn free_states(&mut self) {
        let Some(function) = self.functions().free_state else {
            return;
        };
        for mut state in std::mem::take(&mut self.states) {
            if state.is_null() {
                continue;
            }
            let component = self.component();
            // SAFETY: the component is alive; the state was made by it and is forgotten here.
            let free = || unsafe { function(component, &raw mut state) };
            let status = self.note().during("fmi2FreeFMUstate", free);
            if status == Status::Fatal as i32 {
                self.mark_fatal();
                return;
            }
        }
    }
}
