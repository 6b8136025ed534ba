//! `master completions`.

use clap::CommandFactory as _;
use clap_complete::Shell;

use super::{CommandError, nothing_to_write, print};
use crate::cli::{Arguments, Common};

/// Prints the script that completes commands and options in `shell`.
///
/// # Errors
/// See [`CommandError`].
pub fn completions(shell: Shell, common: &Common) -> Result<(), CommandError> {
    nothing_to_write("master completions", common)?;
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "master", &mut script);
    print(&String::from_utf8_lossy(&script))
}
