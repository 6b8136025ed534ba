//! The command line program.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    master::defect::guarded(master::cli::main)
}
