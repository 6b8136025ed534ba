//! The one macro a shell needs.

/// Exports the 34 functions of FMI 2.0 for co-simulation for one [`Model`](crate::slave::Model). Call the macro once,
/// in a `cdylib` crate: every library has the same names.
#[macro_export]
macro_rules! export_fmu {
    ($model:ty) => {
        #[allow(unsafe_code, non_snake_case, clippy::missing_safety_doc)]
        const _: () = {
            use $crate::abi::*;
            $crate::__fmi2_entry_points! { $model;
                fmi2GetTypesPlatform = types_platform() -> fmi2String;
                fmi2GetVersion = version() -> fmi2String;
                fmi2SetDebugLogging = set_debug_logging(c: fmi2Component, on: fmi2Boolean, n: usize,
                    categories: *const fmi2String) -> fmi2Status;
                fmi2Instantiate = instantiate(name: fmi2String, kind: fmi2Type, guid: fmi2String,
                    location: fmi2String, callbacks: *const fmi2CallbackFunctions, visible: fmi2Boolean,
                    logging_on: fmi2Boolean) -> fmi2Component;
                fmi2FreeInstance = free_instance(c: fmi2Component);
                fmi2SetupExperiment = setup_experiment(c: fmi2Component, tolerance_defined: fmi2Boolean,
                    tolerance: fmi2Real, start: fmi2Real, stop_defined: fmi2Boolean, stop: fmi2Real) -> fmi2Status;
                fmi2EnterInitializationMode = enter_initialization_mode(c: fmi2Component) -> fmi2Status;
                fmi2ExitInitializationMode = exit_initialization_mode(c: fmi2Component) -> fmi2Status;
                fmi2Terminate = terminate(c: fmi2Component) -> fmi2Status;
                fmi2Reset = reset(c: fmi2Component) -> fmi2Status;
                fmi2GetReal = get_real(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *mut fmi2Real) -> fmi2Status;
                fmi2GetInteger = get_integer(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *mut fmi2Integer) -> fmi2Status;
                fmi2GetBoolean = get_boolean(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *mut fmi2Boolean) -> fmi2Status;
                fmi2GetString = get_string(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *mut fmi2String) -> fmi2Status;
                fmi2SetReal = set_real(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *const fmi2Real) -> fmi2Status;
                fmi2SetInteger = set_integer(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *const fmi2Integer) -> fmi2Status;
                fmi2SetBoolean = set_boolean(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *const fmi2Boolean) -> fmi2Status;
                fmi2SetString = set_string(c: fmi2Component, vr: *const fmi2ValueReference, n: usize,
                    values: *const fmi2String) -> fmi2Status;
                fmi2GetFMUstate = get_fmu_state(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status;
                fmi2SetFMUstate = set_fmu_state(c: fmi2Component, state: fmi2FMUstate) -> fmi2Status;
                fmi2FreeFMUstate = free_fmu_state(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status;
                fmi2SerializedFMUstateSize = serialized_fmu_state_size(c: fmi2Component, state: fmi2FMUstate,
                    size: *mut usize) -> fmi2Status;
                fmi2SerializeFMUstate = serialize_fmu_state(c: fmi2Component, state: fmi2FMUstate,
                    bytes: *mut fmi2Byte, size: usize) -> fmi2Status;
                fmi2DeSerializeFMUstate = deserialize_fmu_state(c: fmi2Component, bytes: *const fmi2Byte,
                    size: usize, state: *mut fmi2FMUstate) -> fmi2Status;
                fmi2GetDirectionalDerivative = get_directional_derivative(c: fmi2Component,
                    unknowns: *const fmi2ValueReference, n_unknowns: usize, knowns: *const fmi2ValueReference,
                    n_knowns: usize, seed: *const fmi2Real, derivatives: *mut fmi2Real) -> fmi2Status;
                fmi2SetRealInputDerivatives = set_real_input_derivatives(c: fmi2Component,
                    vr: *const fmi2ValueReference, n: usize, orders: *const fmi2Integer,
                    values: *const fmi2Real) -> fmi2Status;
                fmi2GetRealOutputDerivatives = get_real_output_derivatives(c: fmi2Component,
                    vr: *const fmi2ValueReference, n: usize, orders: *const fmi2Integer,
                    values: *mut fmi2Real) -> fmi2Status;
                fmi2DoStep = do_step(c: fmi2Component, time: fmi2Real, step: fmi2Real,
                    no_prior_state: fmi2Boolean) -> fmi2Status;
                fmi2CancelStep = cancel_step(c: fmi2Component) -> fmi2Status;
                fmi2GetStatus = get_status(c: fmi2Component, kind: fmi2StatusKind,
                    value: *mut fmi2Status) -> fmi2Status;
                fmi2GetRealStatus = get_real_status(c: fmi2Component, kind: fmi2StatusKind,
                    value: *mut fmi2Real) -> fmi2Status;
                fmi2GetIntegerStatus = get_integer_status(c: fmi2Component, kind: fmi2StatusKind,
                    value: *mut fmi2Integer) -> fmi2Status;
                fmi2GetBooleanStatus = get_boolean_status(c: fmi2Component, kind: fmi2StatusKind,
                    value: *mut fmi2Boolean) -> fmi2Status;
                fmi2GetStringStatus = get_string_status(c: fmi2Component, kind: fmi2StatusKind,
                    value: *mut fmi2String) -> fmi2Status;
            }
        };
    };
}

/// C function for each line of [`export_fmu!`].
#[doc(hidden)]
#[macro_export]
macro_rules! __fmi2_entry_points {
    ($model:ty; $($name:ident = $entry:ident($($argument:ident: $kind:ty),*) $(-> $result:ty)?;)*) => {
        $(
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name($($argument: $kind),*) $(-> $result)? {
                #[allow(unused_unsafe)] // two of them need none
                // SAFETY: the importer calls as FMI 2.0 says, which is the condition of the entry points.
                unsafe { $crate::slave::entry::$entry::<$model>($($argument),*) }
            }
        )*
    };
}
