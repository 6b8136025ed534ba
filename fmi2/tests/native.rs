//! The entry points of the export runtime, called without a library in between, so that Miri can look at them:
//! `cargo +nightly miri test -p fmi2 --test native`, with `MIRIFLAGS=-Zmiri-disable-isolation`.
#![allow(unsafe_code)]

#[path = "../examples/oscillator/lib.rs"]
mod oscillator;

use fmi2::abi::{Status, fmi2CallbackFunctions, fmi2Component, fmi2FMUstate, fmi2String};
use fmi2::slave::entry::*;
use oscillator::{Oscillator, at};
use std::ffi::{CStr, CString, c_int};
use std::ptr::{null, null_mut};

const OK: c_int = Status::Ok as c_int;
const ERROR: c_int = Status::Error as c_int;

/// A folder `resources` with a GUID.
fn resources() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("guid.txt"), "{native}\n").unwrap();
    folder
}

fn made(resources: &tempfile::TempDir) -> fmi2Component {
    let callbacks = fmi2CallbackFunctions::default();
    let location = CString::new(resources.path().display().to_string()).unwrap();
    let (name, guid) = (c"native", c"{native}");
    // SAFETY: texts and callbacks live during the call.
    let component = unsafe {
        instantiate::<Oscillator>(
            name.as_ptr(),
            1,
            guid.as_ptr(),
            location.as_ptr(),
            &raw const callbacks,
            0,
            0,
        )
    };
    assert!(!component.is_null());
    component
}

/// An instance at its first communication point.
fn started(resources: &tempfile::TempDir) -> fmi2Component {
    let c = made(resources);
    // SAFETY: the component is alive.
    unsafe {
        assert_eq!(setup_experiment::<Oscillator>(c, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(enter_initialization_mode::<Oscillator>(c), OK);
        assert_eq!(exit_initialization_mode::<Oscillator>(c), OK);
    }
    c
}

fn real(c: fmi2Component, place: usize) -> f64 {
    let mut value = [f64::NAN];
    // SAFETY: the component is alive; one reference and one value.
    let status = unsafe { get_real::<Oscillator>(c, [place as u32].as_ptr(), 1, value.as_mut_ptr()) };
    assert_eq!(status, OK);
    value[0]
}

#[test]
fn a_run_with_states_that_are_saved_restored_and_serialised() {
    let resources = resources();
    let c = started(&resources);
    // SAFETY: the component is alive, lists have the length that is said, states are freed once.
    unsafe {
        let force = [at::FORCE as u32];
        assert_eq!(set_real::<Oscillator>(c, force.as_ptr(), 1, [3.0].as_ptr()), OK);
        assert_eq!(
            set_real_input_derivatives::<Oscillator>(c, force.as_ptr(), 1, [1].as_ptr(), [2.0].as_ptr()),
            OK
        );
        assert_eq!(do_step::<Oscillator>(c, 0.0, 1e-3, 1), OK);
        let mut state: fmi2FMUstate = null_mut();
        assert_eq!(get_fmu_state::<Oscillator>(c, &raw mut state), OK);
        assert_eq!(do_step::<Oscillator>(c, 1e-3, 1e-3, 1), OK);
        let ahead = real(c, at::X);
        // Into the same state, and back.
        let mut size = 0;
        assert_eq!(serialized_fmu_state_size::<Oscillator>(c, state, &raw mut size), OK);
        let mut bytes = vec![0_i8; size];
        assert_eq!(
            serialize_fmu_state::<Oscillator>(c, state, bytes.as_mut_ptr().cast(), size),
            OK
        );
        assert_eq!(set_fmu_state::<Oscillator>(c, state), OK);
        assert_eq!(do_step::<Oscillator>(c, 1e-3, 1e-3, 1), OK);
        assert_eq!(real(c, at::X), ahead);
        // In another instance, which outlives the first.
        let other = started(&resources);
        let mut read: fmi2FMUstate = null_mut();
        assert_eq!(
            deserialize_fmu_state::<Oscillator>(other, bytes.as_ptr().cast(), size, &raw mut read),
            OK
        );
        assert_eq!(free_fmu_state::<Oscillator>(c, &raw mut state), OK);
        assert!(state.is_null());
        free_instance::<Oscillator>(c);
        assert_eq!(set_fmu_state::<Oscillator>(other, read), OK);
        assert_eq!(do_step::<Oscillator>(other, 1e-3, 1e-3, 1), OK);
        assert_eq!(real(other, at::X), ahead);
        let mut derivative = [0.0];
        let (unknown, known) = ([at::A as u32], [at::FORCE as u32]);
        let pointer = derivative.as_mut_ptr();
        let status = get_directional_derivative::<Oscillator>(
            other,
            unknown.as_ptr(),
            1,
            known.as_ptr(),
            1,
            [1.0].as_ptr(),
            pointer,
        );
        assert_eq!((status, derivative), (OK, [0.5]));
        let mut time = 0.0;
        assert_eq!(get_real_status::<Oscillator>(other, 2, &raw mut time), OK);
        assert_eq!(terminate::<Oscillator>(other), OK);
        assert_eq!(free_fmu_state::<Oscillator>(other, &raw mut read), OK);
        free_instance::<Oscillator>(other);
        free_instance::<Oscillator>(null_mut());
    }
}

#[test]
fn texts_are_read_set_and_handed_out() {
    let resources = resources();
    let c = made(&resources);
    let label = [at::LABEL as u32];
    // SAFETY: the component is alive, lists have the length that is said, texts end with a NUL.
    unsafe {
        assert_eq!(
            set_string::<Oscillator>(c, label.as_ptr(), 1, [c"a text".as_ptr()].as_ptr()),
            OK
        );
        assert_eq!(setup_experiment::<Oscillator>(c, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(enter_initialization_mode::<Oscillator>(c), OK);
        let mut values: [fmi2String; 2] = [null(); 2];
        let twice = [label[0], label[0]];
        assert_eq!(get_string::<Oscillator>(c, twice.as_ptr(), 2, values.as_mut_ptr()), OK);
        assert!(values.iter().all(|value| CStr::from_ptr(*value) == c"a text"));
        assert_eq!(
            set_debug_logging::<Oscillator>(c, 1, 1, [c"logEvents".as_ptr()].as_ptr()),
            OK
        );
        assert_eq!(
            set_string::<Oscillator>(c, label.as_ptr(), 1, [c"\xff".as_ptr()].as_ptr()),
            ERROR
        );
        assert_eq!(reset::<Oscillator>(c), OK);
        free_instance::<Oscillator>(c);
    }
}

#[test]
fn null_pointers_and_counts_that_no_call_has_are_refused() {
    let resources = resources();
    let c = started(&resources);
    let one = [0_u32];
    // SAFETY: null pointers and counts are what is tested; the component is alive or null.
    unsafe {
        let mut value = [0.0];
        let pointer = value.as_mut_ptr();
        assert_eq!(get_real::<Oscillator>(null_mut(), one.as_ptr(), 1, pointer), ERROR);
        assert_eq!(get_real::<Oscillator>(c, null(), 1, pointer), ERROR);
        assert_eq!(get_real::<Oscillator>(c, one.as_ptr(), 1, null_mut()), ERROR);
        assert_eq!(get_real::<Oscillator>(c, one.as_ptr(), 1 << 40, pointer), ERROR);
        assert_eq!(get_real::<Oscillator>(c, [u32::MAX].as_ptr(), 1, pointer), ERROR);
        assert_eq!(get_real::<Oscillator>(c, null(), 0, null_mut()), OK);
        assert_eq!(set_fmu_state::<Oscillator>(c, null_mut()), ERROR);
        assert_eq!(deserialize_fmu_state::<Oscillator>(c, null(), 8, null_mut()), ERROR);
        free_instance::<Oscillator>(c);
    }
}
