//! Below the importer: null pointers and strange arguments.
use super::{IDENTIFIERS, KULKARNI};
use fmi2::abi::{
    FALSE, GetFn, PlainFn, SetFn, SetStateFn, SetupExperimentFn, StatePointerFn, Status, fmi2CallbackFunctions,
    fmi2Component,
};
use fmi2::model_description::Causality;
use integration_tests::fmus::reals;
use integration_tests::raw::{Identity, Raw};
use std::ptr::{null, null_mut};

fn open(identifier: &str) -> Raw {
    Raw::new(KULKARNI.open(identifier))
}

fn instantiate(raw: &Raw, name: Option<&str>, kind: i32, guid: Option<&str>, location: Option<&str>) -> fmi2Component {
    let identity = Identity {
        name,
        kind,
        guid,
        location,
        logging: FALSE,
    };
    raw.instantiate(identity, &fmi2CallbackFunctions::default())
}

#[test]
fn instances_are_refused_without_name_guid_kind_or_resources() {
    for identifier in IDENTIFIERS {
        let raw = open(identifier);
        let text = raw.fmu.description().guid.as_str();
        let guid = Some(text);
        let resources = raw.fmu.folder().join("resources").display().to_string();
        let bare = Some(resources.as_str());
        for (name, kind, guid, location) in [
            (None, 1, guid, bare),
            (Some(" "), 1, guid, bare),
            (Some("a"), 0, guid, bare),
            (Some("a"), 1, None, bare),
            (Some("a"), 1, Some("{wrong}"), bare),
            (Some("a"), 1, Some(&text[1..37]), bare),
            (Some("a"), 1, guid, Some("file:///no/such/folder")),
        ] {
            assert!(
                instantiate(&raw, name, kind, guid, location).is_null(),
                "{name:?} {kind} {guid:?} {location:?}"
            );
        }
        // As other importers pass it: four slashes and not encoded, nothing at all.
        let unencoded = format!("file:///{resources}");
        for location in [bare, Some(unencoded.as_str()), None] {
            let component = instantiate(&raw, Some("a/b c:ü"), 1, guid, location);
            assert!(!component.is_null(), "{identifier}: {location:?}");
            // SAFETY: not used again.
            unsafe { raw.free(component) };
        }
        // SAFETY: null.
        unsafe { raw.free(null_mut()) };
    }
}

#[test]
fn null_pointers_are_errors_and_leave_the_host_alive() {
    const OK: i32 = Status::Ok as i32;
    const ERROR: i32 = Status::Error as i32;
    for identifier in IDENTIFIERS {
        let raw = open(identifier);
        let description = raw.fmu.description();
        let component = instantiate(&raw, Some("null"), 1, Some(&description.guid), None);
        assert!(!component.is_null());
        let input = [reals(&raw.fmu, Causality::Input)[0]];
        // SAFETY: the types are those of the standard; null pointers are what is tested, and the instance lives until
        // it is freed.
        unsafe {
            let set = raw.function::<SetFn<f64>>("fmi2SetReal");
            let get = raw.function::<GetFn<f64>>("fmi2GetReal");
            let plain = |name: &str| raw.function::<PlainFn>(name)(component);
            for name in [
                "fmi2EnterInitializationMode",
                "fmi2ExitInitializationMode",
                "fmi2Terminate",
                "fmi2Reset",
            ] {
                assert_eq!(
                    raw.function::<PlainFn>(name)(null_mut()),
                    ERROR,
                    "{identifier}: {name}(NULL)"
                );
            }
            assert_eq!(
                raw.function::<SetupExperimentFn>("fmi2SetupExperiment")(component, 0, 0.0, 0.0, 0, 0.01),
                OK
            );
            assert_eq!(plain("fmi2EnterInitializationMode"), OK);
            assert_eq!(plain("fmi2ExitInitializationMode"), OK);
            assert_eq!(set(component, null(), 0, null()), OK, "nothing to set");
            assert_eq!(get(component, null(), 0, null_mut()), OK, "nothing to get");
            assert_eq!(get(component, null(), 1, [0.0].as_mut_ptr()), ERROR);
            assert_eq!(get(component, input.as_ptr(), 1, null_mut()), ERROR);
            let save = raw.function::<StatePointerFn>("fmi2GetFMUstate");
            assert_eq!(save(component, null_mut()), ERROR);
            let mut state = null_mut();
            assert_eq!(save(component, &raw mut state), OK);
            assert_eq!(set(component, input.as_ptr(), 1, null()), ERROR);
            assert_eq!(set(component, null(), 1, [0.0].as_ptr()), ERROR, "after an error");
            let restore = raw.function::<SetStateFn>("fmi2SetFMUstate");
            assert_eq!(restore(component, null_mut()), ERROR);
            assert_eq!(restore(component, state), OK, "a saved state helps");
            let forget = raw.function::<StatePointerFn>("fmi2FreeFMUstate");
            assert_eq!(forget(component, &raw mut state), OK);
            assert!(state.is_null());
            assert_eq!(forget(component, &raw mut state), OK, "null again");
            assert_eq!(get(component, input.as_ptr(), 1, [0.0].as_mut_ptr()), OK);
        }
        // SAFETY: not used again.
        unsafe { raw.free(component) };
    }
}
