//! Runs of prepared scenes, as the tests of slaves and of FMUs of others make them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use master::command::CommandError;
use results::report::{Progress, Show};
use scene::Scene;
use simulation::{Finished, FmuSource, Mode, Prepared};
use system::run::Watch;

/// Runs to the end, with packages in `folder`; `good` sees the scene as it is run.
///
/// # Errors
/// Reason that keeps the run from beginning.
pub fn finished(
    prepared: Prepared,
    folder: &Path,
    mode: Mode,
    good: impl FnOnce(&Scene),
) -> Result<Finished, CommandError> {
    let progress = Progress::simulated("", 1.0, Show::Never);
    let never = AtomicBool::new(false);
    let watch = Watch::new(&never, &progress);
    let source = FmuSource {
        folder: folder.join("packaged"),
        logging: false,
    };
    prepared.run(mode, &source, &watch, |scene| {
        good(scene);
        Ok(())
    })
}
