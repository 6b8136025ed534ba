//! State of the process that an FMU may change and must not.

use std::ffi::{CStr, CString};
use std::path::PathBuf;

/// Restores the working directory, the locale and the floating-point mode when dropped.
pub(super) struct HostState {
    directory: Option<PathBuf>,
    /// Locale; Rust needs none, but other FMUs format and parse by it.
    locale: Option<CString>,
    #[cfg(target_arch = "x86_64")]
    mxcsr: u32,
}

impl HostState {
    pub(super) fn remembered() -> Self {
        Self {
            directory: std::env::current_dir().ok(),
            locale: locale(),
            #[cfg(target_arch = "x86_64")]
            mxcsr: mxcsr(),
        }
    }
}

impl Drop for HostState {
    fn drop(&mut self) {
        if let Some(directory) = &self.directory
            && std::env::current_dir().ok().as_ref() != Some(directory)
        {
            // the old directory may be gone; then there is nothing to go back to
            let _ = std::env::set_current_dir(directory);
        }
        if let Some(before) = &self.locale
            && locale().as_ref() != Some(before)
        {
            // SAFETY: a NUL-terminated text, which setlocale returned itself.
            unsafe { libc::setlocale(libc::LC_ALL, before.as_ptr()) };
        }
        #[cfg(target_arch = "x86_64")]
        set_mxcsr(self.mxcsr);
    }
}

/// The locale of C.
fn locale() -> Option<CString> {
    // SAFETY: null only asks; the answer is a text that lives until the next call, or null.
    unsafe {
        let name = libc::setlocale(libc::LC_ALL, std::ptr::null());
        (!name.is_null()).then(|| CStr::from_ptr(name).to_owned())
    }
}

/// Rounding mode, masks and flush-to-zero of SSE.
#[cfg(target_arch = "x86_64")]
fn mxcsr() -> u32 {
    let mut value = 0_u32;
    // SAFETY: every x86-64 processor has SSE; the instruction writes 4 bytes to a valid address.
    unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack, preserves_flags)) };
    value
}

#[cfg(target_arch = "x86_64")]
fn set_mxcsr(value: u32) {
    // status flags are not a mode
    let mode = (mxcsr() & 0x3f) | (value & !0x3f);
    if mode != mxcsr() {
        // SAFETY: as above, reading; the value was read from the register before, so no reserved bit is set.
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const mode, options(nostack, preserves_flags)) };
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn flush_to_zero_is_undone() {
        let before = mxcsr() & !0x3f;
        let remembered = HostState::remembered();
        set_mxcsr(before | 0x8040);
        assert_eq!(mxcsr() & 0x8040, 0x8040);
        drop(remembered);
        assert_eq!(mxcsr() & !0x3f, before);
    }
}
