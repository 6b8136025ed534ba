//! The shared library that contains this code.

use std::path::PathBuf;

/// Path of the library as loaded; that of the program if statically linked.
#[cfg(all(any(target_os = "linux", target_os = "macos"), not(miri)))]
pub(super) fn path() -> Option<PathBuf> {
    use std::ffi::{CStr, OsStr, c_char, c_int, c_void};
    use std::os::unix::ffi::OsStrExt;

    /// `Dl_info` of `<dlfcn.h>`.
    #[repr(C)]
    struct DlInfo {
        file_name: *const c_char,
        file_base: *mut c_void,
        symbol_name: *const c_char,
        symbol_address: *mut c_void,
    }
    unsafe extern "C" {
        fn dladdr(address: *const c_void, info: *mut DlInfo) -> c_int;
    }
    let mut info = DlInfo {
        file_name: std::ptr::null(),
        file_base: std::ptr::null_mut(),
        symbol_name: std::ptr::null(),
        symbol_address: std::ptr::null_mut(),
    };
    let here = path as *const c_void;
    // SAFETY: `info` is a valid `Dl_info`; any address may be asked for.
    if unsafe { dladdr(here, &raw mut info) } == 0 || info.file_name.is_null() {
        return None;
    }
    // SAFETY: `dladdr` succeeded, so the name is a NUL-terminated string owned by the loader.
    let name = unsafe { CStr::from_ptr(info.file_name) };
    Some(PathBuf::from(OsStr::from_bytes(name.to_bytes())))
}

#[cfg(any(miri, not(any(target_os = "linux", target_os = "macos"))))]
pub(super) fn path() -> Option<PathBuf> {
    None
}

/// Keeps the library in memory until the process ends, whatever the importer does. Otherwise a thread of the importer
/// that outlives `dlclose` may crash at its end: the standard library registers a destructor per thread
/// (`pthread_key_create`) that lies in this library.
pub(super) fn pin() {
    #[cfg(any(target_os = "linux", target_os = "macos"))]
    if let Some(path) = path() {
        use libloading::os::unix::{Library, RTLD_LAZY, RTLD_LOCAL};
        // SAFETY: the library of this path is loaded already, so no initialiser runs; it is only counted once more.
        let library = unsafe { Library::open(Some(path), RTLD_LAZY | RTLD_LOCAL) };
        std::mem::forget(library);
    }
}
