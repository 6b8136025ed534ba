//! The C interface of FMI 2.0 for co-simulation: types, status codes and function pointers.
//!
//! All types that cross the boundary are plain C types. Enumerations arrive as `int` and are converted with `TryFrom`,
//! because an unknown value in a Rust `enum` would be undefined behaviour.
#![allow(non_camel_case_types)] // the names of the standard's headers

use std::ffi::{c_char, c_int, c_uint, c_void};

/// Opaque pointer to an instance.
pub type fmi2Component = *mut c_void;
/// Opaque pointer of the importer, handed back to the logger.
pub type fmi2ComponentEnvironment = *mut c_void;
/// Opaque pointer to a saved state.
pub type fmi2FMUstate = *mut c_void;
/// Handle of a variable of one base type.
pub type fmi2ValueReference = c_uint;
/// C `double`.
pub type fmi2Real = f64;
/// C `int`; also the base type of enumerations.
pub type fmi2Integer = c_int;
/// C `int`, not `bool`: anything but 0 is true.
pub type fmi2Boolean = c_int;
/// C `char`.
pub type fmi2Char = c_char;
/// NUL-terminated UTF-8.
pub type fmi2String = *const c_char;
/// Byte of a serialised state.
pub type fmi2Byte = c_char;
/// A [`Status`] as `int`.
pub type fmi2Status = c_int;
/// An [`InstanceKind`] as `int`.
pub type fmi2Type = c_int;
/// A [`StatusKind`] as `int`.
pub type fmi2StatusKind = c_int;

/// `fmi2True`.
pub const TRUE: fmi2Boolean = 1;
/// `fmi2False`.
pub const FALSE: fmi2Boolean = 0;

/// An `int` that is no member of the enumeration it was passed for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{value} is not a value of {enumeration}")]
pub struct UnknownValue {
    /// Name of the C enumeration.
    pub enumeration: &'static str,
    /// Passed value.
    pub value: c_int,
}

macro_rules! c_enum {
    ($(#[$doc:meta])* $name:ident as $c:literal { $($(#[$vdoc:meta])* $variant:ident = $value:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[repr(i32)]
        pub enum $name { $($(#[$vdoc])* $variant = $value,)* }

        impl TryFrom<c_int> for $name {
            type Error = UnknownValue;

            fn try_from(value: c_int) -> Result<Self, UnknownValue> {
                match value {
                    $($value => Ok(Self::$variant),)*
                    _ => Err(UnknownValue { enumeration: $c, value }),
                }
            }
        }
    };
}

c_enum! {
    /// Result of a call [FMI 2.0, 2.1.3].
    Status as "fmi2Status" {
        /// Done.
        Ok = 0,
        /// Done, with a message that deserves attention.
        Warning = 1,
        /// Only part of the step was computed; a smaller one may succeed.
        Discard = 2,
        /// The instance cannot be used until it is restored, reset or freed.
        Error = 3,
        /// No instance of the FMU may be called again.
        Fatal = 4,
        /// An asynchronous step is under way.
        Pending = 5,
    }
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "fmi2{self:?}")
    }
}

c_enum! {
    /// Purpose of an instance.
    InstanceKind as "fmi2Type" {
        /// Right-hand side only, integrated by the importer.
        ModelExchange = 0,
        /// Integrates itself.
        CoSimulation = 1,
    }
}

c_enum! {
    /// Subject of the status functions.
    StatusKind as "fmi2StatusKind" {
        /// Status of an asynchronous step.
        DoStepStatus = 0,
        /// Text about a pending step.
        PendingStatus = 1,
        /// End of the last completed step, s.
        LastSuccessfulTime = 2,
        /// Wish of the instance to end the simulation.
        Terminated = 3,
    }
}

/// `void logger(environment, instanceName, status, category, message, ...)`; `message` is a `printf` format.
pub type fmi2CallbackLogger =
    unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
/// `void* allocateMemory(nobj, size)`.
pub type fmi2CallbackAllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
/// `void freeMemory(obj)`.
pub type fmi2CallbackFreeMemory = unsafe extern "C" fn(*mut c_void);
/// `void stepFinished(environment, status)`.
pub type fmi2StepFinished = unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2Status);

/// Functions that the importer offers; each may be null.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct fmi2CallbackFunctions {
    /// Receiver of messages.
    pub logger: Option<fmi2CallbackLogger>,
    /// `calloc`.
    pub allocate_memory: Option<fmi2CallbackAllocateMemory>,
    /// `free`.
    pub free_memory: Option<fmi2CallbackFreeMemory>,
    /// End of an asynchronous step.
    pub step_finished: Option<fmi2StepFinished>,
    /// Passed to the logger.
    pub component_environment: fmi2ComponentEnvironment,
}

/// No functions at all.
impl Default for fmi2CallbackFunctions {
    fn default() -> Self {
        Self {
            logger: None,
            allocate_memory: None,
            free_memory: None,
            step_finished: None,
            component_environment: std::ptr::null_mut(),
        }
    }
}

/// `fmi2GetTypesPlatform`, `fmi2GetVersion`.
pub type TextFn = unsafe extern "C" fn() -> fmi2String;
/// `fmi2SetDebugLogging`.
pub type SetDebugLoggingFn = unsafe extern "C" fn(fmi2Component, fmi2Boolean, usize, *const fmi2String) -> fmi2Status;
/// `fmi2Instantiate`.
pub type InstantiateFn = unsafe extern "C" fn(
    fmi2String,
    fmi2Type,
    fmi2String,
    fmi2String,
    *const fmi2CallbackFunctions,
    fmi2Boolean,
    fmi2Boolean,
) -> fmi2Component;
/// `fmi2FreeInstance`.
pub type FreeInstanceFn = unsafe extern "C" fn(fmi2Component);
/// `fmi2SetupExperiment`.
pub type SetupExperimentFn =
    unsafe extern "C" fn(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real) -> fmi2Status;
/// The calls without further arguments: initialisation mode, terminate, reset, cancel.
pub type PlainFn = unsafe extern "C" fn(fmi2Component) -> fmi2Status;
/// `fmi2GetReal`, `fmi2GetInteger`, `fmi2GetBoolean`, `fmi2GetString`.
pub type GetFn<T> = unsafe extern "C" fn(fmi2Component, *const fmi2ValueReference, usize, *mut T) -> fmi2Status;
/// `fmi2SetReal`, `fmi2SetInteger`, `fmi2SetBoolean`, `fmi2SetString`.
pub type SetFn<T> = unsafe extern "C" fn(fmi2Component, *const fmi2ValueReference, usize, *const T) -> fmi2Status;
/// `fmi2GetFMUstate`, `fmi2FreeFMUstate`.
pub type StatePointerFn = unsafe extern "C" fn(fmi2Component, *mut fmi2FMUstate) -> fmi2Status;
/// `fmi2SetFMUstate`.
pub type SetStateFn = unsafe extern "C" fn(fmi2Component, fmi2FMUstate) -> fmi2Status;
/// `fmi2SerializedFMUstateSize`.
pub type StateSizeFn = unsafe extern "C" fn(fmi2Component, fmi2FMUstate, *mut usize) -> fmi2Status;
/// `fmi2SerializeFMUstate`.
pub type SerializeStateFn = unsafe extern "C" fn(fmi2Component, fmi2FMUstate, *mut fmi2Byte, usize) -> fmi2Status;
/// `fmi2DeSerializeFMUstate`.
pub type DeserializeStateFn =
    unsafe extern "C" fn(fmi2Component, *const fmi2Byte, usize, *mut fmi2FMUstate) -> fmi2Status;
/// `fmi2GetDirectionalDerivative`.
pub type DirectionalDerivativeFn = unsafe extern "C" fn(
    fmi2Component,
    *const fmi2ValueReference,
    usize,
    *const fmi2ValueReference,
    usize,
    *const fmi2Real,
    *mut fmi2Real,
) -> fmi2Status;
/// `fmi2SetRealInputDerivatives`.
pub type SetInputDerivativesFn = unsafe extern "C" fn(
    fmi2Component,
    *const fmi2ValueReference,
    usize,
    *const fmi2Integer,
    *const fmi2Real,
) -> fmi2Status;
/// `fmi2GetRealOutputDerivatives`.
pub type OutputDerivativesFn = unsafe extern "C" fn(
    fmi2Component,
    *const fmi2ValueReference,
    usize,
    *const fmi2Integer,
    *mut fmi2Real,
) -> fmi2Status;
/// `fmi2DoStep`.
pub type DoStepFn = unsafe extern "C" fn(fmi2Component, fmi2Real, fmi2Real, fmi2Boolean) -> fmi2Status;
/// `fmi2GetStatus`, `fmi2GetRealStatus`, `fmi2GetIntegerStatus`, `fmi2GetBooleanStatus`, `fmi2GetStringStatus`.
pub type StatusFn<T> = unsafe extern "C" fn(fmi2Component, fmi2StatusKind, *mut T) -> fmi2Status;
