//! `master sweep`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::run::ModeArgument;
use super::{CommandError, found, has_extension, interrupted, print, print_json, scene_text};
use crate::cli::Common;
use crate::cli::values::whole;
use ::sweep::design::Method;
use ::sweep::{Base, Options, Sweep, SweepError, Wishes, file};
use cosim::package;
use results::Machine;
use results::OutputDirectory;
use results::report::{Progress, Show};
use simulation::Mode;
use simulation::paths::scene_name;

/// Arguments of `master sweep`.
#[derive(Debug, Args)]
pub struct SweepArguments {
    /// Sweep as a TOML file, or a scene whose keys --vary names
    #[arg(value_name = "SWEEP.toml|SCENE")]
    file: PathBuf,
    /// Varies a key: a:b:step, v1,v2,…, or with --sample a:b, normal(mean,std), …; repeatable
    #[arg(long, value_name = "KEY=VALUES", allow_hyphen_values = true)]
    vary: Vec<String>,
    /// Sets a key, or a plain name, by an expression of keys; repeatable
    #[arg(long, value_name = "KEY=EXPRESSION", allow_hyphen_values = true)]
    derive: Vec<String>,
    /// Leaves out the cases for which an expression does not hold; repeatable
    #[arg(long = "where", value_name = "EXPRESSION", allow_hyphen_values = true)]
    constraints: Vec<String>,
    /// Samples instead of all combinations
    #[arg(long, value_name = "METHOD", value_parser = method)]
    sample: Option<Method>,
    /// Number of samples
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole)]
    count: Option<u64>,
    /// Seed of the samples [default: 1]
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = whole)]
    seed: Option<u64>,
    /// Keeps the filtered force of every case, as a list column of sweep.parquet
    #[arg(long)]
    series: bool,
    /// How line and pantographs are put together [default: monolithic]
    #[arg(long, value_enum)]
    mode: Option<ModeArgument>,
    /// Cases made side by side [default: number of cores]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
}

/// `latin`, `sobol` or `random`.
fn method(text: &str) -> Result<Method, String> {
    file::method(text)
}

impl From<SweepError> for CommandError {
    fn from(error: SweepError) -> Self {
        Self::Sweep(Box::new(error))
    }
}

/// Runs many cases of one scene into one table.
///
/// # Errors
/// See [`CommandError`].
pub fn sweep(arguments: &SweepArguments, common: &Common) -> Result<(), CommandError> {
    let path = found(&arguments.file);
    let text = text_of(&path, &arguments.file)?;
    let is_sweep = file::is_sweep(&text);
    let mut wishes = if is_sweep {
        Wishes::read(&text, &arguments.file.display().to_string())?
    } else {
        Wishes::default()
    };
    arguments.vary.iter().try_for_each(|text| wishes.vary(text))?;
    arguments.derive.iter().try_for_each(|text| wishes.derive(text))?;
    arguments.constraints.iter().for_each(|text| wishes.constrain(text));
    wishes.check_set(&common.overrides)?;
    wishes.method = arguments.sample.or(wishes.method);
    wishes.count = arguments.count.or(wishes.count);
    wishes.seed = arguments.seed.or(wishes.seed);
    wishes.series |= arguments.series;
    let mode = mode(arguments, &wishes)?;

    let (scene, shown) = scene_of(is_sweep, &wishes, &path, &arguments.file)?;
    let scene_text = if is_sweep { text_of(&scene, &shown)? } else { text };
    let name = scene_name(&scene);
    let overrides = wishes.set.iter().chain(&common.overrides).cloned().collect();
    let folder = scene.parent().unwrap_or(Path::new(""));
    let base = Base::new(&name, &shown.display().to_string(), folder, scene_text, overrides);
    let cores = Machine::this().cores;
    let options = Options {
        mode,
        jobs: arguments.jobs.map_or(cores, usize::from),
        series: wishes.series,
        logging: common.verbose > 1,
        fmus: package::folder(&format!("{name}-sweep")),
    };
    let sweep = Sweep::new(base, wishes.plan()?, options)?;
    if mode == Mode::Cosimulation {
        // The libraries are made before runs that need them stand side by side.
        package::Libraries::find()?;
    }
    let default = Path::new("results").join(if is_sweep { scene_name(&path) } else { name.clone() });
    let directory = common.out.clone().unwrap_or(default);
    OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&name, show);
    let summary = sweep.run(&directory, interrupted(common), &progress)?;
    progress.finish();
    if common.json {
        print_json(&summary)?;
    } else if !common.quiet {
        let files = "sweep.csv, sweep.parquet and sweep.html";
        print(&format!("{}\n{files} in {}\n", summary.text(), directory.display()))?;
    }
    if summary.complete {
        return Ok(());
    }
    let (finished, all) = (summary.finished, summary.cases);
    let reason = format!("{finished} of {all} cases are finished; the same command goes on from there");
    Err(CommandError::Incomplete { directory, reason })
}

/// Text of a file of TOML; a system is no scene whose keys could be varied from text.
pub(super) fn text_of(found: &Path, path: &Path) -> Result<String, CommandError> {
    if has_extension(found, "ssp") {
        let instead = ", made of a system by `master run`: the scene.toml beside its results";
        let path = path.to_owned();
        return Err(CommandError::NoSweepFile {
            path,
            is: "is a system",
            instead,
        });
    }
    scene_text(found, path)
}

/// Mode of the command line, or of the file, or one system.
fn mode(arguments: &SweepArguments, wishes: &Wishes) -> Result<Mode, CommandError> {
    if let Some(mode) = arguments.mode {
        return Ok(mode.into());
    }
    let Some(word) = &wishes.mode else {
        return Ok(Mode::Monolithic);
    };
    let mode = ModeArgument::from_str(word, false).map_err(|_| {
        let what = format!("\"{word}\": must be one of monolithic, inprocess, cosimulation");
        SweepError::Wish {
            place: format!("{}: mode", arguments.file.display()),
            what,
        }
    })?;
    Ok(mode.into())
}

/// Scene of a sweep, and the name that commands and messages give it.
fn scene_of(is_sweep: bool, wishes: &Wishes, found: &Path, file: &Path) -> Result<(PathBuf, PathBuf), CommandError> {
    if !is_sweep {
        return Ok((found.to_owned(), file.to_owned()));
    }
    let Some(scene) = &wishes.scene else {
        let what = "is missing: must be the scene that is varied, relative to this file, such as \"scene.toml\"";
        let place = format!("{}: scene", file.display());
        return Err(SweepError::Wish {
            place,
            what: what.to_owned(),
        }
        .into());
    };
    let beside = |path: &Path| path.parent().unwrap_or(Path::new("")).join(scene);
    Ok((beside(found), beside(file)))
}
