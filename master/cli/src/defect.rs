//! Defects of the program itself, told in words.

use std::panic::{PanicHookInfo, UnwindSafe, catch_unwind, set_hook, take_hook};
use std::process::ExitCode;

use crate::command::complain;

/// Runs `program`. A panic is told with what a report of it needs, and ends with exit status 1; files that were
/// complete before stay as they are.
pub fn guarded(program: impl FnOnce() -> ExitCode + UnwindSafe) -> ExitCode {
    let usual = take_hook();
    set_hook(Box::new(move |info| {
        complain(&told(info));
        if std::env::var_os("RUST_BACKTRACE").is_some_and(|wish| wish != "0") {
            usual(info);
        }
    }));
    catch_unwind(program).unwrap_or_else(|_| fmi2::supervision::ended(1))
}

/// Message of a panic, with what a report of it needs.
fn told(info: &PanicHookInfo<'_>) -> String {
    let place = info.location().map(ToString::to_string);
    report(info.payload_as_str(), place.as_deref())
}

/// Message with the place, the version and the command.
fn report(message: Option<&str>, place: Option<&str>) -> String {
    let message = message.unwrap_or("no message");
    let place = place.map_or_else(String::new, |place| format!(" ({place})"));
    // Arguments may be paths that are no text.
    let arguments: Vec<String> = std::env::args_os()
        .map(|word| word.to_string_lossy().into_owned())
        .collect();
    format!(
        "error: a defect of this program, not of the input: {message}{place}\n  Pantoline {}, {}-{}: {}\n  Please \
         report it with this text and the scene. RUST_BACKTRACE=1 shows more.",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        arguments.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_exit_status_1_and_everything_else_stays() {
        let code = |code: ExitCode| format!("{code:?}");
        assert_eq!(code(guarded(|| ExitCode::from(3))), code(ExitCode::from(3)));
        assert_eq!(code(guarded(|| panic!("seen"))), code(ExitCode::from(1)));
        // The usual hook for the tests that follow.
        let _ = take_hook();
        let said = report(Some("index out of bounds"), Some("core/x.rs:1:2"));
        for part in [
            "index out of bounds (core/x.rs:1:2)",
            env!("CARGO_PKG_VERSION"),
            "Please report",
        ] {
            assert!(said.contains(part), "{said}");
        }
    }
}
