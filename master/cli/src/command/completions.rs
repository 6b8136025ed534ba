//! `master completions`.

use clap::CommandFactory as _;
use clap_complete::Shell;

use super::{CommandError, print};
use crate::cli::Arguments;

/// Prints the script that completes commands and options in `shell`.
///
/// # Errors
/// [`CommandError::Output`].
pub fn completions(shell: Shell) -> Result<(), CommandError> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "master", &mut script);
    print(&String::from_utf8_lossy(&script))
}
