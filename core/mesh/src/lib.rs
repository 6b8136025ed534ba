//! The mesh of a line, its steps and reductions: what a scene leaves to be chosen, and what error they make.
//!
//! | file | subject |
//! | --- | --- |
//! | `division` | elements and micro step for an error |
//! | `corrections` | which corrections a line can have |
//! | `error_model` | the expected error of mesh and time step |
//! | `error_shares` | expected errors of all causes |
//! | `resolve` | all choices that a scene leaves open |
//! | `accuracy` | mesh, steps, tolerance and reductions for one sum of errors |

#![forbid(unsafe_code)]

mod accuracy;
mod corrections;
mod division;
mod error_model;
mod error_shares;
mod resolve;

pub use accuracy::cost_of_whole_line;
pub use corrections::{CorrectedSteps, contradictions, corrected_steps, corrections_left_out, impossible_corrections};
pub use division::{evenly_divided, resolving_elements};
pub use error_model::{MeshError, error_goes_by_waves, expected_error, expected_error_at};
pub use error_shares::{ErrorShare, error_shares, sum};
pub use resolve::resolve;

use scene::{Files, Scene, SceneError, SceneFile, What};

/// Reads a scene from the text of a file with overrides, see [`Scene::from_toml`], chooses what it leaves open of its
/// mesh, and checks it.
///
/// # Errors
/// Every problem found; see [`Scene::from_toml`], [`resolve()`] and [`contradictions`].
pub fn load(text: &str, origin: &str, overrides: &[String]) -> Result<Scene, SceneError> {
    load_with(text, origin, overrides, &Files::none())
}

/// As [`load`], where the scene takes tables and parts from files beside it.
///
/// # Errors
/// As [`load`]; in the files with file, line and column.
pub fn load_with(text: &str, origin: &str, overrides: &[String], files: &Files<'_>) -> Result<Scene, SceneError> {
    let mut file = SceneFile::read(text, origin, overrides, files)?;
    if let Err((key, what)) = resolve(&mut file.scene) {
        let problem = match what {
            What::Refused { value, expected } if !file.says(&key) => {
                let expected = format!(
                    "a table with elements_per_interval or element_length, as none can be chosen for the default \
                     error_percent = {value}: {expected}"
                );
                ("catenary.mesh".to_owned(), What::Missing { expected })
            }
            what => (key, what),
        };
        file.refuse(vec![problem])?;
    }
    file.check(&contradictions)?;
    Ok(file.scene)
}

/// Checks a scene that was built or changed, its corrections included; `origin` is its name in messages.
///
/// # Errors
/// Every contradiction found.
pub fn check(scene: &Scene, origin: &str) -> Result<(), SceneError> {
    scene.check_with(origin, &contradictions)
}
