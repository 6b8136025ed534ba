//! Choices that a scene leaves open.

use scene::{MeshChoice, Open, Scene, What, shown_number};

use super::accuracy;
use super::corrections::choose_corrections;
use super::division::{Search, mesh_for};
use super::error_model::expected_error;

/// Chooses what a scene leaves open of its mesh and to `run.accuracy_percent`; does nothing where all is given or the
/// line is a supplied one.
///
/// # Errors
/// The key and why no mesh can be chosen.
pub fn resolve(scene: &mut Scene) -> Result<(), (String, What)> {
    let mut wish = scene.run.accuracy.filter(|wish| wish.open != Open::default());
    let Some(choice) = scene.mesh_mut().map(|mesh| mesh.choice) else {
        let because = "no rule knows the errors of a line that is a supplied FMU".to_owned();
        return match wish {
            Some(_) => Err(("run.accuracy_percent".to_owned(), What::LeaveOut { because })),
            None => Ok(()),
        };
    };
    match choice {
        MeshChoice::Given => {}
        MeshChoice::Corrections => choose_corrections(scene),
        MeshChoice::Error { .. } if wish.is_some_and(|wish| wish.open.mesh) => {}
        MeshChoice::Error {
            percent,
            choose_micro_step,
            choose_macro_step,
        } => {
            let search = Search {
                percent,
                error: &|scene| Ok(expected_error(scene)?.total()),
                mesh_is_given: false,
                micro_step_is_given: !choose_micro_step,
                macro_step_follows: choose_macro_step,
            };
            let (chosen, _) = mesh_for(scene, &search).map_err(|expected| {
                let value = shown_number(percent, "%");
                let key = "catenary.mesh.error_percent".to_owned();
                (key, What::Refused { value, expected })
            })?;
            search.apply(chosen, scene);
            if let Some(wish) = &mut wish {
                wish.open.micro_step = false;
                wish.open.macro_step = false;
            }
        }
    }
    if let Some(wish) = wish {
        accuracy::choose(scene, wish)?;
    }
    if let Some(mesh) = scene.mesh_mut() {
        mesh.choice = MeshChoice::Given;
    }
    Ok(())
}
