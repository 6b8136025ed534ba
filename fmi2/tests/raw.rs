//! The C interface itself: null pointers, null components, strange arguments, and what the library exports.

mod support;

use fmi2::abi::{
    FreeInstanceFn, GetFn, InstantiateFn, PlainFn, SetFn, SetStateFn, SetupExperimentFn, StatePointerFn, StateSizeFn,
    Status, StatusFn, TextFn, fmi2CallbackFunctions, fmi2Component, fmi2FMUstate, fmi2String,
};
use libloading::{Library, Symbol};
use std::ffi::{CStr, CString, c_int};
use std::ptr::{null, null_mut};

const ERROR: c_int = Status::Error as c_int;

struct Raw {
    example: support::Example,
    library: Library,
}

impl Raw {
    fn new() -> Self {
        let example = support::example();
        let file = example.fmu.folder().join(fmi2::archive::binary_entry("Oscillator"));
        // SAFETY: the library of the example has no initialisers of its own.
        let library = unsafe { Library::new(file) }.unwrap();
        Self { example, library }
    }

    fn function<T>(&self, name: &str) -> Symbol<'_, T> {
        // SAFETY: every caller names the type FMI 2.0 gives the function.
        unsafe { self.library.get(name) }.unwrap()
    }

    fn instantiate(
        &self,
        name: Option<&str>,
        kind: c_int,
        guid: Option<&str>,
        location: Option<&str>,
    ) -> fmi2Component {
        let callbacks = fmi2CallbackFunctions::default();
        let text = |text: Option<&str>| text.map(|text| CString::new(text).unwrap());
        let texts = [text(name), text(guid), text(location)];
        let pointer = |text: &Option<CString>| text.as_ref().map_or(null(), |text| text.as_ptr());
        let function = self.function::<InstantiateFn>("fmi2Instantiate");
        // SAFETY: texts and callbacks live during the call; all callbacks are null, which is allowed here.
        unsafe {
            function(
                pointer(&texts[0]),
                kind,
                pointer(&texts[1]),
                pointer(&texts[2]),
                &raw const callbacks,
                0,
                1,
            )
        }
    }

    fn guid(&self) -> &str {
        &self.example.fmu.description().guid
    }

    fn free(&self, component: fmi2Component) {
        // SAFETY: null or an instance that is not used again.
        unsafe { self.function::<FreeInstanceFn>("fmi2FreeInstance")(component) }
    }
}

#[test]
fn exactly_the_functions_of_the_standard_are_exported() {
    let nm = std::process::Command::new("nm")
        .args(["-D", "--defined-only"])
        .arg(support::library())
        .output()
        .unwrap();
    assert!(nm.status.success());
    let listing = String::from_utf8(nm.stdout).unwrap();
    let names: Vec<_> = listing
        .lines()
        .filter_map(|line| line.split_whitespace().last())
        .collect();
    assert!(names.iter().all(|name| name.starts_with("fmi2")), "{names:?}");
    assert_eq!(names.len(), 34);
}

#[test]
fn version_and_platform_are_known_before_any_instance() {
    let raw = Raw::new();
    for (name, expected) in [("fmi2GetVersion", c"2.0"), ("fmi2GetTypesPlatform", c"default")] {
        // SAFETY: may be called at any time and returns a static text.
        let text = unsafe { CStr::from_ptr(raw.function::<TextFn>(name)()) };
        assert_eq!(text, expected);
    }
}

#[test]
fn instantiation_needs_a_name_the_guid_and_the_right_kind() {
    let raw = Raw::new();
    let guid = Some(raw.guid());
    let resources = raw.example.fmu.folder().join("resources");
    let bare = resources.to_str();
    let cases = [
        (None, 1, guid, bare),
        (Some("  "), 1, guid, bare),
        (Some("a"), 0, guid, bare),
        (Some("a"), 7, guid, bare),
        (Some("a"), 1, None, bare),
        (Some("a"), 1, Some("{wrong}"), bare),
        (Some("a"), 1, guid, Some("file:///no/such/folder")),
    ];
    for (name, kind, guid, location) in cases {
        assert!(
            raw.instantiate(name, kind, guid, location).is_null(),
            "{name:?} {kind} {guid:?} {location:?}"
        );
    }
    let unencoded = format!("file:///{}/", resources.display()); // as some importers do, four slashes in all
    for location in [bare, Some(unencoded.as_str()), None, Some("")] {
        let component = raw.instantiate(Some("a/b c:ü"), 1, guid, location);
        assert!(!component.is_null(), "{location:?}");
        raw.free(component);
    }
    raw.free(null_mut());
}

#[test]
fn a_null_component_is_an_error_for_every_function() {
    let raw = Raw::new();
    let c = null_mut();
    for name in [
        "fmi2EnterInitializationMode",
        "fmi2ExitInitializationMode",
        "fmi2Terminate",
        "fmi2Reset",
        "fmi2CancelStep",
    ] {
        // SAFETY: a null component is what is tested.
        assert_eq!(unsafe { raw.function::<PlainFn>(name)(c) }, ERROR, "{name}");
    }
    // SAFETY: a null component is what is tested; nothing else is looked at.
    unsafe {
        assert_eq!(
            raw.function::<GetFn<f64>>("fmi2GetReal")(c, null(), 0, null_mut()),
            ERROR
        );
        assert_eq!(raw.function::<SetFn<f64>>("fmi2SetReal")(c, null(), 0, null()), ERROR);
        assert_eq!(
            raw.function::<SetFn<c_int>>("fmi2SetInteger")(c, null(), 0, null()),
            ERROR
        );
        assert_eq!(
            raw.function::<SetFn<c_int>>("fmi2SetBoolean")(c, null(), 0, null()),
            ERROR
        );
        assert_eq!(
            raw.function::<SetFn<fmi2String>>("fmi2SetString")(c, null(), 0, null()),
            ERROR
        );
        assert_eq!(
            raw.function::<SetupExperimentFn>("fmi2SetupExperiment")(c, 0, 0.0, 0.0, 0, 0.0),
            ERROR
        );
        assert_eq!(raw.function::<StatePointerFn>("fmi2GetFMUstate")(c, null_mut()), ERROR);
        assert_eq!(raw.function::<StatePointerFn>("fmi2FreeFMUstate")(c, null_mut()), ERROR);
        assert_eq!(raw.function::<SetStateFn>("fmi2SetFMUstate")(c, null_mut()), ERROR);
        assert_eq!(
            raw.function::<StateSizeFn>("fmi2SerializedFMUstateSize")(c, null_mut(), null_mut()),
            ERROR
        );
        assert_eq!(
            raw.function::<StatusFn<f64>>("fmi2GetRealStatus")(c, 2, null_mut()),
            ERROR
        );
    }
}

#[test]
fn a_count_that_no_call_has_is_refused_before_memory_is_taken_for_it() {
    let raw = Raw::new();
    let c = raw.instantiate(Some("a"), 1, Some(raw.guid()), None);
    // SAFETY: the component is alive.
    unsafe {
        let set_up = raw.function::<SetupExperimentFn>("fmi2SetupExperiment");
        assert_eq!(set_up(c, 0, 0.0, 0.0, 0, 0.0), 0);
        assert_eq!(raw.function::<PlainFn>("fmi2EnterInitializationMode")(c), 0);
    }
    let label = [support::at::LABEL as u32];
    let mut text: fmi2String = null();
    let number = [0_u32];
    let mut value = 0.0;
    for count in [1_usize << 25, 1 << 40, usize::MAX] {
        // SAFETY: the component is alive; a count that large is what is tested, nothing behind the pointers is read.
        unsafe {
            let get_string = raw.function::<GetFn<fmi2String>>("fmi2GetString");
            assert_eq!(get_string(c, label.as_ptr(), count, &raw mut text), ERROR);
            let get_real = raw.function::<GetFn<f64>>("fmi2GetReal");
            assert_eq!(get_real(c, number.as_ptr(), count, &raw mut value), ERROR);
        }
    }
    // As many good references and places for values as are said: nothing but the count tells that it is none.
    let count = (1 << 24) + 1;
    let (numbers, mut values) = (vec![0_u32; count], vec![0.0; count]);
    // SAFETY: the component is alive; both lists have the length that is said.
    unsafe {
        let get_real = raw.function::<GetFn<f64>>("fmi2GetReal");
        assert_eq!(get_real(c, numbers.as_ptr(), 1000, values.as_mut_ptr()), 0);
        assert_eq!(get_real(c, numbers.as_ptr(), count, values.as_mut_ptr()), ERROR);
    }
    // SAFETY: the component is alive and not used again.
    unsafe { raw.function::<FreeInstanceFn>("fmi2FreeInstance")(c) };
}

#[test]
fn null_pointers_are_fine_for_nothing_and_refused_for_something() {
    let raw = Raw::new();
    let c = raw.instantiate(Some("a"), 1, Some(raw.guid()), None);
    let (get, set) = (
        raw.function::<GetFn<f64>>("fmi2GetReal"),
        raw.function::<SetFn<f64>>("fmi2SetReal"),
    );
    let set_string = raw.function::<SetFn<fmi2String>>("fmi2SetString");
    let get_string = raw.function::<GetFn<fmi2String>>("fmi2GetString");
    let reset = raw.function::<PlainFn>("fmi2Reset");
    let free_state = raw.function::<StatePointerFn>("fmi2FreeFMUstate");
    let reference = [0_u32];
    let label = [support::at::LABEL as u32];
    let mut state: fmi2FMUstate = null_mut();
    // SAFETY: the component is alive; null pointers are what is tested, all others have the length that is said.
    unsafe {
        assert_eq!(set(c, null(), 0, null()), 0);
        assert_eq!(set_string(c, null(), 0, null()), 0);
        assert_eq!(set(c, reference.as_ptr(), 1, null()), ERROR);
        assert_eq!(reset(c), 0);
        assert_eq!(set(c, null(), 1, [1.0].as_ptr()), ERROR);
        assert_eq!(reset(c), 0);
        assert_eq!(set_string(c, label.as_ptr(), 1, [null()].as_ptr()), ERROR);
        assert_eq!(reset(c), 0);
        assert_eq!(set_string(c, label.as_ptr(), 1, [c"\xff".as_ptr()].as_ptr()), ERROR);
        assert_eq!(reset(c), 0);
        assert_eq!(free_state(c, null_mut()), 0);
        assert_eq!(free_state(c, &raw mut state), 0);
        assert_eq!(raw.function::<SetStateFn>("fmi2SetFMUstate")(c, null_mut()), ERROR);
        assert_eq!(reset(c), 0);
        assert_eq!(
            raw.function::<SetupExperimentFn>("fmi2SetupExperiment")(c, 0, 0.0, 0.0, 0, -1.0),
            0
        );
        assert_eq!(raw.function::<PlainFn>("fmi2EnterInitializationMode")(c), 0);
        assert_eq!(get(c, null(), 0, null_mut()), 0);
        assert_eq!(get(c, reference.as_ptr(), 1, null_mut()), ERROR);
        let mut text: fmi2String = null();
        assert_eq!(get_string(c, label.as_ptr(), 1, &raw mut text), 0);
        assert_eq!(CStr::from_ptr(text), c"oscillator");
        assert_eq!(raw.function::<PlainFn>("fmi2ExitInitializationMode")(c), 0);
        // the status functions
        let (mut number, mut integer) = (0.0, 7);
        let real_status = raw.function::<StatusFn<f64>>("fmi2GetRealStatus");
        assert_eq!(real_status(c, 2, &raw mut number), 0);
        assert_eq!(real_status(c, 0, &raw mut number), Status::Discard as c_int);
        assert_eq!(real_status(c, 99, &raw mut number), ERROR);
        assert_eq!(real_status(c, 2, null_mut()), ERROR);
        let status = raw.function::<StatusFn<c_int>>("fmi2GetStatus");
        assert_eq!((status(c, 0, &raw mut integer), integer), (0, 0));
        let integer_status = raw.function::<StatusFn<c_int>>("fmi2GetIntegerStatus");
        assert_eq!(integer_status(c, 0, &raw mut integer), Status::Discard as c_int);
        let string_status = raw.function::<StatusFn<fmi2String>>("fmi2GetStringStatus");
        assert_eq!(string_status(c, 1, &raw mut text), Status::Discard as c_int);
        assert_eq!(raw.function::<PlainFn>("fmi2CancelStep")(c), ERROR);
        assert_eq!(
            raw.function::<PlainFn>("fmi2Terminate")(c),
            0,
            "a refused query has no consequence"
        );
    }
    raw.free(c);
}

#[test]
fn a_state_in_memory_of_another_fmu_of_the_same_library_is_refused() {
    let raw = Raw::new();
    let other = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(raw.example.fmu.folder().join("resources")).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), other.path().join(file.file_name())).unwrap();
    }
    let guid = "{00000000-0000-0000-0000-000000000000}";
    std::fs::write(other.path().join("guid.txt"), guid).unwrap();
    let first = raw.instantiate(Some("first"), 1, Some(raw.guid()), None);
    let second = raw.instantiate(Some("second"), 1, Some(guid), other.path().to_str());
    assert!(!first.is_null() && !second.is_null());
    let (get, free) = (
        raw.function::<StatePointerFn>("fmi2GetFMUstate"),
        raw.function::<StatePointerFn>("fmi2FreeFMUstate"),
    );
    let set = raw.function::<SetStateFn>("fmi2SetFMUstate");
    let size_of = raw.function::<StateSizeFn>("fmi2SerializedFMUstateSize");
    let (mut state, mut size): (fmi2FMUstate, usize) = (null_mut(), 0);
    // SAFETY: both components are alive, the state is of the library that both are of.
    unsafe {
        assert_eq!(get(first, &raw mut state), 0);
        assert_eq!(set(first, state), 0);
        assert_eq!(set(second, state), ERROR);
        assert_eq!(raw.function::<PlainFn>("fmi2Reset")(second), 0);
        assert_eq!(get(second, &raw mut state), ERROR, "nor is its memory used again");
        assert_eq!(raw.function::<PlainFn>("fmi2Reset")(second), 0);
        assert_eq!(size_of(second, state, &raw mut size), ERROR);
        assert_eq!(size_of(first, state, &raw mut size), 0);
        assert_eq!(free(first, &raw mut state), 0);
    }
    raw.free(first);
    raw.free(second);
}
