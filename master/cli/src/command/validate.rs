//! `master validate`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::{CommandError, found, interrupted, nothing_to_set, print, print_json, scene_text};
use crate::cli::Common;
use cosim::package;
use results::OutputDirectory;
use results::report::{Progress, Show};
use validation::{JSON, PAGE, ReferenceModel, Surroundings, ValidationError, record};

/// Reference models that come with the program, by their names.
const KNOWN: [(&str, &str); 2] = [
    ("EN50318-2002", "standards/en50318-2002.toml"),
    ("EN50318-2018", "standards/en50318-2018.toml"),
];

/// Arguments of `master validate`.
#[derive(Debug, Args)]
pub struct ValidateArguments {
    /// EN50318-2002, EN50318-2018, or a file of cases with their ranges and measured series
    #[arg(value_name = "EN50318-2002|EN50318-2018|FILE", default_value = KNOWN[0].0)]
    model: String,
}

impl From<ValidationError> for CommandError {
    fn from(error: ValidationError) -> Self {
        Self::Validation(Box::new(error))
    }
}

/// Runs a reference model in every mode and writes the record.
///
/// # Errors
/// See [`CommandError`].
pub fn validate(arguments: &ValidateArguments, common: &Common) -> Result<(), CommandError> {
    nothing_to_set("master validate", common)?;
    let typed = arguments.model.as_str();
    let known = KNOWN.iter().find(|(name, _)| name.eq_ignore_ascii_case(typed));
    let named = known.map_or_else(|| PathBuf::from(typed), |(_, path)| PathBuf::from(path));
    let path = found(&named);
    let text = scene_text(&path, &named)?;
    let model = ReferenceModel::read(&text, &named.display().to_string())?;
    // The libraries are made before runs that need them.
    package::Libraries::find()?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let directory = common
        .out
        .clone()
        .unwrap_or_else(|| Path::new("results").join(format!("validation-{name}")));
    let output = OutputDirectory::open(&directory).map_err(CommandError::Directory)?;
    let show = if common.quiet { Show::Never } else { Show::OnTerminal };
    let progress = Progress::share(&name, show);
    let around = Surroundings {
        folder: path.parent().unwrap_or(Path::new("")),
        fmus: package::folder(&format!("validation-{name}")),
        interrupted: interrupted(common),
        progress: &progress,
        date: chrono::Utc::now().format("%Y-%m-%d %H:%M UTC").to_string(),
    };
    let found = record(&model, &text, &around)?;
    progress.finish();
    output.write_json(JSON, &found).map_err(CommandError::Results)?;
    output.write_page(PAGE, &found.page()).map_err(CommandError::Results)?;
    if common.json {
        print_json(&found)?;
    } else if !common.quiet {
        print(&format!(
            "{}\n{JSON} and {PAGE} in {}\n",
            found.text(),
            directory.display()
        ))?;
    }
    if found.pass != Some(false) {
        return Ok(());
    }
    let failed = found.cases.iter().map(validation::Run::failed).sum();
    Err(CommandError::NotValid {
        standard: found.standard.clone(),
        failed,
        directory,
    })
}
