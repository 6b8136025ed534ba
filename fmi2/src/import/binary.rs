//! The shared library of an FMU and its functions.

use crate::Error;
use crate::abi::{
    DeserializeStateFn, DirectionalDerivativeFn, DoStepFn, FreeInstanceFn, GetFn, InstantiateFn, OutputDerivativesFn,
    PlainFn, SerializeStateFn, SetDebugLoggingFn, SetFn, SetInputDerivativesFn, SetStateFn, SetupExperimentFn,
    StatePointerFn, StateSizeFn, StatusFn, TextFn, fmi2Boolean, fmi2Integer, fmi2Real, fmi2Status, fmi2String,
};
use crate::archive;
use libloading::Library;
use std::ffi::CStr;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

macro_rules! functions {
    (needed { $($needed:ident: $needed_type:ty = $needed_name:literal,)* }
     optional { $($optional:ident: $optional_type:ty = $optional_name:literal,)* }) => {
        /// The functions of one library; valid as long as it is loaded.
        #[derive(Clone, Copy)]
        pub(super) struct Functions {
            $(pub $needed: $needed_type,)*
            $(pub $optional: Option<$optional_type>,)*
        }

        impl Functions {
            fn resolved(library: &Library, path: &Path) -> Result<Self, Error> {
                Ok(Self {
                    $($needed: {
                        // SAFETY: the type is the one FMI 2.0 gives the function of this name.
                        let symbol = unsafe { library.get::<$needed_type>($needed_name) };
                        match symbol {
                            Ok(function) => *function,
                            Err(_) => {
                                return Err(Error::MissingFunction { path: path.to_owned(), function: $needed_name });
                            }
                        }
                    },)*
                    // SAFETY: as above.
                    $($optional: unsafe { library.get::<$optional_type>($optional_name) }.ok().map(|f| *f),)*
                })
            }
        }
    };
}

functions! {
    needed {
        version: TextFn = "fmi2GetVersion",
        types_platform: TextFn = "fmi2GetTypesPlatform",
        instantiate: InstantiateFn = "fmi2Instantiate",
        free_instance: FreeInstanceFn = "fmi2FreeInstance",
        setup_experiment: SetupExperimentFn = "fmi2SetupExperiment",
        enter_initialization_mode: PlainFn = "fmi2EnterInitializationMode",
        exit_initialization_mode: PlainFn = "fmi2ExitInitializationMode",
        terminate: PlainFn = "fmi2Terminate",
        reset: PlainFn = "fmi2Reset",
        get_real: GetFn<fmi2Real> = "fmi2GetReal",
        get_integer: GetFn<fmi2Integer> = "fmi2GetInteger",
        get_boolean: GetFn<fmi2Boolean> = "fmi2GetBoolean",
        get_string: GetFn<fmi2String> = "fmi2GetString",
        set_real: SetFn<fmi2Real> = "fmi2SetReal",
        set_integer: SetFn<fmi2Integer> = "fmi2SetInteger",
        set_boolean: SetFn<fmi2Boolean> = "fmi2SetBoolean",
        set_string: SetFn<fmi2String> = "fmi2SetString",
        do_step: DoStepFn = "fmi2DoStep",
    }
    optional {
        set_debug_logging: SetDebugLoggingFn = "fmi2SetDebugLogging",
        get_state: StatePointerFn = "fmi2GetFMUstate",
        set_state: SetStateFn = "fmi2SetFMUstate",
        free_state: StatePointerFn = "fmi2FreeFMUstate",
        state_size: StateSizeFn = "fmi2SerializedFMUstateSize",
        serialize_state: SerializeStateFn = "fmi2SerializeFMUstate",
        deserialize_state: DeserializeStateFn = "fmi2DeSerializeFMUstate",
        directional_derivative: DirectionalDerivativeFn = "fmi2GetDirectionalDerivative",
        set_input_derivatives: SetInputDerivativesFn = "fmi2SetRealInputDerivatives",
        output_derivatives: OutputDerivativesFn = "fmi2GetRealOutputDerivatives",
        status: StatusFn<fmi2Status> = "fmi2GetStatus",
        real_status: StatusFn<fmi2Real> = "fmi2GetRealStatus",
        boolean_status: StatusFn<fmi2Boolean> = "fmi2GetBooleanStatus",
    }
}

/// A loaded library.
pub(super) struct Binary {
    pub functions: Functions,
    /// Harmless deviations from the standard.
    pub warnings: Vec<String>,
    /// Set after `fmi2Fatal`: nothing may be called any more.
    fatal: AtomicBool,
    library: Option<Library>,
}

impl Binary {
    /// Loads the binary for this platform from the unpacked FMU in `folder`; `path` is the archive, for messages.
    pub(super) fn loaded(path: &Path, folder: &Path, model_identifier: &str) -> Result<Self, Error> {
        let entry = archive::binary_entry(model_identifier);
        let file = folder.join(&entry);
        if !file.is_file() {
            let present = platforms(folder);
            return Err(Error::NoBinary {
                path: path.to_owned(),
                expected: entry,
                present,
            });
        }
        let library = opened(&file).map_err(|error| {
            let problem = std::error::Error::source(&error).map_or_else(|| error.to_string(), ToString::to_string);
            let hint = hint(&problem);
            Error::Load {
                path: path.to_owned(),
                problem,
                hint,
            }
        })?;
        let functions = Functions::resolved(&library, path)?;
        // SAFETY: may be called at any time and returns a static text, or null if it is badly broken.
        let (version, platform) = unsafe { (text((functions.version)()), text((functions.types_platform)())) };
        if !version.starts_with('2') {
            return Err(Error::WrongVersion {
                path: path.to_owned(),
                found: version,
            });
        }
        let mut warnings = Vec::new();
        for (what, found, expected) in [("version", version, "2.0"), ("types platform", platform, "default")] {
            if found != expected {
                warnings.push(format!("the binary says {what} \"{found}\", expected \"{expected}\""));
            }
        }
        Ok(Self {
            functions,
            warnings,
            fatal: AtomicBool::new(false),
            library: Some(library),
        })
    }

    pub(super) fn is_fatal(&self) -> bool {
        self.fatal.load(Ordering::Relaxed)
    }

    pub(super) fn set_fatal(&self) {
        self.fatal.store(true, Ordering::Relaxed);
    }
}

impl Drop for Binary {
    fn drop(&mut self) {
        if self.is_fatal() {
            // its destructors may not run either [FMI 2.0, 2.1.3]
            std::mem::forget(self.library.take());
        }
    }
}

/// Resolves all names at once and privately, because all FMUs export the same names.
#[cfg(unix)]
fn opened(file: &Path) -> Result<Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    // SAFETY: loading runs initialisers of the FMU, which is what the user asked for; nothing is assumed of them.
    unsafe { Library::open(Some(file), RTLD_NOW | RTLD_LOCAL) }.map(Into::into)
}

/// Loads with a search path that includes libraries beside the binary.
#[cfg(windows)]
fn opened(file: &Path) -> Result<Library, libloading::Error> {
    use libloading::os::windows::{LOAD_WITH_ALTERED_SEARCH_PATH, Library};
    // SAFETY: loading runs initialisers of the FMU, which is what the user asked for; nothing is assumed of them.
    unsafe { Library::load_with_flags(file, LOAD_WITH_ALTERED_SEARCH_PATH) }.map(Into::into)
}

/// Names of the folders in `binaries`.
fn platforms(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder.join("binaries"))
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
        .collect();
    names.sort();
    names
}

/// Advice on a message of the loader.
fn hint(problem: &str) -> &'static str {
    if problem.contains("undefined symbol: _Py") || problem.contains("undefined symbol: Py") {
        " (the FMU embeds Python and finds no interpreter in this process: run it in one of its own that has \
         LD_PRELOAD = \"libpython3….so\" in its environment)"
    } else if problem.contains("GLIBC_") {
        " (the binary was built on a newer system than this one)"
    } else if problem.contains("wrong ELF class") || problem.contains("invalid ELF header") {
        " (the file is no 64-bit library for this system)"
    } else if problem.contains("cannot open shared object file") {
        " (a library that the binary needs is not installed)"
    } else {
        ""
    }
}

/// # Safety
///
/// `pointer` is null or a NUL-terminated text.
unsafe fn text(pointer: fmi2String) -> String {
    if pointer.is_null() {
        return String::new();
    }
    // SAFETY: forwarded to the caller.
    unsafe { CStr::from_ptr(pointer) }.to_string_lossy().into_owned()
}
