//! An FMU as plain C functions: for calls that no careful importer makes.
use fmi2::abi::{FreeInstanceFn, InstantiateFn, fmi2CallbackFunctions, fmi2Component};
use fmi2::archive::binary_entry;
use fmi2::import::Fmu;
use libloading::{Library, Symbol};
use std::ffi::CString;
use std::ptr::null;

/// An unpacked FMU and its library.
pub struct Raw {
    /// FMU as the importer has opened it.
    pub fmu: Fmu,
    library: Library,
}

/// Identification of an instance; `None` is a null pointer.
#[derive(Clone, Copy, Debug)]
pub struct Identity<'a> {
    /// `instanceName`.
    pub name: Option<&'a str>,
    /// `fmuType`: 1 is co-simulation.
    pub kind: i32,
    /// `fmuGUID`.
    pub guid: Option<&'a str>,
    /// `fmuResourceLocation`.
    pub location: Option<&'a str>,
    /// `loggingOn`.
    pub logging: i32,
}

impl Raw {
    /// Loads the library of one of our own FMUs, which have no initialisers.
    ///
    /// # Panics
    /// When the library cannot be loaded.
    #[must_use]
    pub fn new(fmu: Fmu) -> Self {
        let binary = binary_entry(&fmu.description().co_simulation.model_identifier);
        // SAFETY: our own libraries have no initialisers.
        let library = unsafe { Library::new(fmu.folder().join(binary)) }.unwrap();
        Self { fmu, library }
    }

    /// A function of the library.
    ///
    /// # Panics
    /// When the function is missing.
    ///
    /// # Safety
    /// `T` is the type that FMI 2.0 gives the function.
    #[must_use]
    pub unsafe fn function<T>(&self, name: &str) -> Symbol<'_, T> {
        // SAFETY: the condition of this function.
        unsafe { self.library.get(name) }.unwrap()
    }

    /// `fmi2Instantiate`.
    #[must_use]
    pub fn instantiate(&self, identity: Identity<'_>, callbacks: &fmi2CallbackFunctions) -> fmi2Component {
        let Identity {
            name,
            kind,
            guid,
            location,
            logging,
        } = identity;
        let texts = [name, guid, location].map(|text| text.map(|text| CString::new(text).unwrap()));
        let [name, guid, location] = [0, 1, 2].map(|k: usize| texts[k].as_ref().map_or(null(), |text| text.as_ptr()));
        // SAFETY: the type is that of the standard; texts live during the call, and what they point to is kept by
        // nobody.
        unsafe { self.function::<InstantiateFn>("fmi2Instantiate")(name, kind, guid, location, callbacks, 0, logging) }
    }

    /// `fmi2FreeInstance`.
    ///
    /// # Safety
    /// Null, or an instance that is not used again.
    pub unsafe fn free(&self, component: fmi2Component) {
        // SAFETY: the condition of this function.
        unsafe { self.function::<FreeInstanceFn>("fmi2FreeInstance")(component) }
    }
}
