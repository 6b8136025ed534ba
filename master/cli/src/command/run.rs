//! `master run`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use scene::Scene;

use super::{CommandError, SceneFile, interrupted, print, print_json, say};
use crate::cli::{Common, DEFAULT_SCENE};
use cosim::package;
use results::OutputDirectory;
use results::report::{self, Progress, Show};
use simulation::paths::{real, relative_to};
use simulation::{FmuSource, Mode, prepare};
use system::run::Watch;

/// Arguments of `master run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// Scene file, or an .ssp
    #[arg(default_value = DEFAULT_SCENE)]
    scene: PathBuf,
    /// How line and pantographs are put together
    #[arg(long, value_enum, default_value = "cosimulation")]
    mode: ModeArgument,
    /// Ends with exit status 3 where a limit of a standard fails; one that is not decided does not count
    #[arg(long)]
    fail_on_limits: bool,
    /// Writes no report.html
    #[arg(long)]
    no_report: bool,
    /// Writes no animation.json, and a report.html without the player
    #[arg(long)]
    no_animation: bool,
}

impl Default for RunArguments {
    fn default() -> Self {
        Self {
            scene: DEFAULT_SCENE.into(),
            mode: ModeArgument::default(),
            fail_on_limits: false,
            no_report: false,
            no_animation: false,
        }
    }
}

/// `--mode`.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(crate) enum ModeArgument {
    /// FMUs through their C interface
    #[default]
    Cosimulation,
    /// One system, one integrator
    Monolithic,
    /// The FMUs' subsystems without FMI
    Inprocess,
}

impl From<ModeArgument> for Mode {
    fn from(argument: ModeArgument) -> Self {
        match argument {
            ModeArgument::Cosimulation => Self::Cosimulation,
            ModeArgument::Monolithic => Self::Monolithic,
            ModeArgument::Inprocess => Self::Inprocess,
        }
    }
}

/// Runs a scene and writes its results.
///
/// # Errors
/// See [`CommandError`].
pub fn run(arguments: &RunArguments, common: &Common) -> Result<(), CommandError> {
    let (path, mode) = (arguments.scene.as_path(), Mode::from(arguments.mode));
    let file = SceneFile::read(path, common)?;
    let directory = file.output(common);
    let say = say(common);
    file.notes.iter().for_each(|note| say(note));
    let logging = common.verbose > 1;
    let default = Path::new("results").join(&file.name);
    let rank = [&directory, &default]
        .into_iter()
        .find_map(|folder| experiments::rank(folder, &file.scene, &file.base, mode));
    let identity = simulation::identity::identity(&file.scene, &file.base);
    let uncertainty = [&directory, &default]
        .into_iter()
        .find_map(|runs| ::sweep::sensitivity::uncertainty(&super::sensitivity::folder(runs), &identity));
    let prepared = prepare(file.scene, &file.name, &file.base, logging);
    let mut prepared = prepared.map_err(|error| CommandError::from(error).in_scene(path))?;
    prepared.pictures = !arguments.no_animation;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::simulated(&file.name, prepared.scene.run.duration, show);
    // Before there are results to keep, Ctrl-C ends the program at once.
    let watch = Watch::new(interrupted(common), &progress);
    let source = FmuSource {
        folder: package::folder(&file.name),
        logging,
    };
    let mut output = None;
    let finished = prepared.run(mode, &source, &watch, |scene| {
        let mut opened = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
        let holder = format!("`master run` of {}", path.display());
        let broken_off = opened.lock(&holder).map_err(CommandError::Directory)?;
        broken_off.iter().for_each(|note| say(note));
        if arguments.no_animation {
            opened = opened.without_animation();
        }
        let mut scene = scene.clone();
        if let Some(unpacked) = &file.unpacked {
            keep_fmus(&mut scene, unpacked.path(), &mut opened);
        }
        let text = relative_to(&scene, &directory).to_toml();
        opened.begin(&text).map_err(CommandError::Directory)?;
        output = Some((opened, text));
        Ok::<(), CommandError>(())
    });
    let mut finished = finished.map_err(|error| error.in_scene(path))?;
    finished.info.notes.extend(rank);
    finished.info.uncertainty = uncertainty.unwrap_or_default();
    progress.finish();
    let (output, text) = output.expect("a run that ended has begun");
    let reason = finished.info.incomplete_reason.clone();
    let bundle = output
        .finish(&finished.info, finished.record, &text)
        .map_err(CommandError::Results)?;
    if !arguments.no_report {
        let page = report::render(std::slice::from_ref(&bundle));
        output.write_report(&page).map_err(CommandError::Results)?;
    }
    if common.json {
        print_json(&bundle.summary)?;
    } else if !common.quiet {
        print(&format!(
            "{}results in {}\n",
            report::table(&bundle.summary),
            directory.display()
        ))?;
    }
    if finished.failure.is_some() {
        return Err(CommandError::Incomplete { directory, reason });
    }
    let failed = report::failed_limits(&bundle.summary);
    if arguments.fail_on_limits && !failed.is_empty() {
        return Err(CommandError::LimitsFailed { directory, failed });
    }
    Ok(())
}

/// Keeps the FMUs of an unpacked archive with the results, in the folder `fmu`, so that the `scene.toml` there can be
/// run again without the archive, and makes the scene refer to them.
fn keep_fmus(scene: &mut Scene, unpacked: &Path, output: &mut OutputDirectory) {
    let unpacked = real(unpacked);
    for side in scene.supplied_sides_mut() {
        let from = real(Path::new(&side.fmu));
        let Ok(inside) = from.strip_prefix(&unpacked) else {
            continue;
        };
        // The same tree as in the archive: no two files have one name.
        let name = Path::new("fmu").join(inside.strip_prefix("resources").unwrap_or(inside));
        side.fmu = output.path().join(&name).display().to_string();
        output.add(name, from);
    }
}
