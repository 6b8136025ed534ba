//! State of the host process around an FMU, and the system that an archive declares.
use super::{EN, IDENTIFIERS, KULKARNI, run, started};
use fmi2::archive::binary_entry;
use fmi2::model_description::Causality;
use integration_tests::fmus::{Packaged, read, reals};
use std::path::PathBuf;
use std::process::Command;

fn library(packaged: &Packaged, identifier: &str) -> (fmi2::import::Fmu, PathBuf) {
    let fmu = packaged.open(identifier);
    let path = fmu.folder().join(binary_entry(identifier));
    (fmu, path)
}

/// Symbols that a library takes from others, without their versions.
fn taken(path: &PathBuf) -> Vec<String> {
    let nm = Command::new("nm")
        .args(["-D", "--undefined-only"])
        .arg(path)
        .output()
        .unwrap();
    assert!(nm.status.success(), "{}", String::from_utf8_lossy(&nm.stderr));
    let listing = String::from_utf8(nm.stdout).unwrap();
    let names = listing.lines().filter_map(|line| line.split_whitespace().last());
    names
        .map(|name| name.split('@').next().unwrap_or(name).to_owned())
        .collect()
}

/// A host in German writes 0,5: these functions of C would follow it, or change it for the host.
const OF_THE_LOCALE: [&str; 22] = [
    "setlocale",
    "newlocale",
    "uselocale",
    "localeconv",
    "nl_langinfo",
    "strtod",
    "strtof",
    "strtold",
    "atof",
    "printf",
    "fprintf",
    "sprintf",
    "snprintf",
    "vprintf",
    "vfprintf",
    "vsprintf",
    "vsnprintf",
    "scanf",
    "sscanf",
    "fscanf",
    "strftime",
    "strcoll",
];

/// Functions that would change the host's process.
const OF_THE_PROCESS: [&str; 8] = [
    "setenv",
    "putenv",
    "unsetenv",
    "exit",
    "sigaction",
    "fesetround",
    "fesetenv",
    "feenableexcept",
];

#[test]
fn no_function_is_used_that_follows_or_changes_the_hosts_locale() {
    for identifier in IDENTIFIERS {
        let names = taken(&library(&KULKARNI, identifier).1);
        assert!(names.iter().any(|name| name == "malloc"), "{names:?}");
        for forbidden in OF_THE_LOCALE.iter().chain(&OF_THE_PROCESS) {
            assert!(
                !names.iter().any(|name| name == forbidden),
                "{identifier} takes {forbidden}"
            );
        }
    }
}

/// Runs `body` while the processor takes denormal numbers for 0 and makes none (MXCSR: FTZ, DAZ).
#[cfg(target_arch = "x86_64")]
fn without_denormals<T>(body: impl FnOnce() -> T) -> T {
    let (mut before, mut after) = (0_u32, 0_u32);
    let set = |value: &u32| {
        // SAFETY: loads the control register of this thread from a living integer; only FTZ and DAZ differ.
        unsafe { std::arch::asm!("ldmxcsr [{}]", in(reg) value, options(nostack, readonly)) };
    };
    let store = |value: &mut u32| {
        // SAFETY: stores the control register of this thread to a living integer.
        unsafe { std::arch::asm!("stmxcsr [{}]", in(reg) value, options(nostack)) };
    };
    store(&mut before);
    set(&(before | 0x8040));
    let result = body();
    store(&mut after);
    set(&before);
    assert_eq!(after & 0x8040, 0x8040, "what the host has set stays set");
    result
}

#[test]
#[cfg(target_arch = "x86_64")]
fn denormal_numbers_that_a_host_switches_off_change_nothing() {
    for packaged in [&EN, &KULKARNI] {
        for identifier in IDENTIFIERS {
            let (fmu, _) = library(packaged, identifier);
            let trajectory = || {
                let mut instance = started(&fmu, "host");
                run(&fmu, &mut instance, 0, 40);
                read(&mut instance, &reals(&fmu, Causality::Output))
            };
            let (usual, flushed) = (trajectory(), without_denormals(trajectory));
            for (a, b) in usual.iter().zip(&flushed) {
                assert!((a - b).abs() <= 1e-9 * a.abs().max(1e-3), "{identifier}: {a} {b}");
            }
        }
    }
}

#[test]
fn an_archive_says_which_c_library_its_binary_needs() {
    for identifier in IDENTIFIERS {
        let (fmu, path) = library(&KULKARNI, identifier);
        let text = std::fs::read_to_string(fmu.folder().join("documentation/externalDependencies.txt")).unwrap();
        let objdump = Command::new("objdump").arg("-p").arg(&path).output().unwrap();
        let listing = String::from_utf8(objdump.stdout).unwrap();
        let needed = listing.lines().filter_map(|line| line.trim().strip_prefix("NEEDED"));
        let needed: Vec<&str> = needed.map(str::trim).collect();
        assert!(!needed.is_empty());
        for name in needed {
            assert!(text.contains(&format!("    {name}\n")), "{name} is not in:\n{text}");
        }
        let versions = listing.lines().filter_map(|line| line.split("GLIBC_2.").nth(1));
        let newest = versions
            .filter_map(|rest| rest.trim().split('.').next()?.parse::<u32>().ok())
            .max();
        let newest = format!("the GNU C library 2.{} or later", newest.unwrap());
        assert!(text.contains(&newest), "{newest}:\n{text}");
        let licences = std::fs::read_to_string(fmu.folder().join("documentation/licenses/license.txt")).unwrap();
        assert!(
            licences.contains("MIT License") && licences.contains("faer "),
            "{identifier}"
        );
    }
}
