//! Built library of a shell; both shells run this test.

use std::path::Path;

/// Functions that every co-simulation slave must export [FMI 2.0, 2.1 and 4.2].
const FUNCTIONS: [&str; 8] = [
    "fmi2GetVersion",
    "fmi2Instantiate",
    "fmi2SetupExperiment",
    "fmi2EnterInitializationMode",
    "fmi2ExitInitializationMode",
    "fmi2DoStep",
    "fmi2GetReal",
    "fmi2Terminate",
];

#[test]
fn the_shared_library_beside_this_test_exports_the_functions_of_the_standard() {
    let test = std::env::current_exe().expect("the test is a file");
    let folder = test.parent().expect("the test is in a folder");
    let shell = env!("CARGO_PKG_NAME")
        .strip_prefix("fmu-")
        .expect("a shell of a component");
    let name = format!(
        "{}{shell}_fmu{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    let path = folder.join(&name);
    let path = if path.exists() {
        path
    } else {
        folder.join("..").join(Path::new(&name))
    };
    let library = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    for function in FUNCTIONS {
        let name = format!("{function}\0").into_bytes();
        assert!(library.windows(name.len()).any(|bytes| bytes == name), "{function}");
    }
}
