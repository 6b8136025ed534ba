//! Parameters shared by several components.
use crate::Parameter;
use scene::{Scene, Start};

/// Step and numerical damping of the time integration.
#[must_use]
pub fn solver_parameters() -> [Parameter; 2] {
    [
        Parameter::new(
            "solver.micro_step",
            "s",
            "Longest internal step",
            |scene| scene.solver.micro_step,
            |scene, value| scene.solver.micro_step = value,
        ),
        Parameter::new(
            "solver.rho_inf",
            "1",
            "Spectral radius of generalized-alpha at infinite frequency",
            |scene| scene.solver.rho_inf,
            |scene, value| scene.solver.rho_inf = value,
        ),
    ]
}

/// Start and speed of strip `strip` (from 0); `prefix` begins the names of those that belong to one strip.
#[must_use]
pub fn start_parameters(strip: usize, prefix: &str) -> [Parameter; 4] {
    let start = move |scene: &Scene| {
        let x = scene.strip_start_x(strip);
        let resting = scene.modelled_line().map_or(0.0, |(line, _)| line.chord_height(x));
        scene.pantographs[strip].start.unwrap_or(Start {
            height: resting,
            force: 0.0,
        })
    };
    [
        Parameter::new(
            format!("{prefix}start.height"),
            "m",
            "Height of the strip above the top of rail at the start",
            move |scene| start(scene).height,
            move |scene, height| {
                scene.pantographs[strip].start = Some(Start { height, ..start(scene) });
            },
        ),
        Parameter::new(
            format!("{prefix}start.force"),
            "N",
            "Contact force at the start",
            move |scene| start(scene).force,
            move |scene, force| {
                scene.pantographs[strip].start = Some(Start { force, ..start(scene) });
            },
        ),
        Parameter::new(
            format!("{prefix}start.x"),
            "m",
            "Position of the strip along the track at the start",
            move |scene| scene.strip_start_x(strip),
            move |scene, x| scene.pantographs[strip].offset_x = x - scene.run.start_x,
        ),
        Parameter::new(
            format!("{prefix}speed"),
            "m/s",
            "Speed along the track, the same for all strips",
            |scene| scene.run.speed,
            |scene, speed| scene.run.speed = speed,
        ),
    ]
}

/// Scene with pantograph `index` (from 0) alone, from which a pantograph component is built.
#[must_use]
pub fn of_pantograph(scene: &Scene, index: usize) -> Scene {
    let mut own = scene.clone();
    own.pantographs = vec![scene.pantographs[index].clone()];
    if let Some(acts) = own.wind.as_mut().and_then(|wind| wind.pantograph.as_mut()) {
        // One uplift for all pantographs, or one for each.
        if let Some(&uplift) = acts.uplift.get(index) {
            acts.uplift = vec![uplift];
        }
    }
    own
}
