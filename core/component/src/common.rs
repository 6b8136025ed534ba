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

/// Start of a scene's strip or head at `x` m where the scene leaves it open: on the wire without pressing.
fn resting(scene: &Scene, x: f64) -> Start {
    Start {
        height: scene.modelled_line().map_or(0.0, |(line, _)| line.chord_height(x)),
        force: 0.0,
    }
}

/// Start and speed of the pantograph that is alone in a scene: of its strip, or of its head with several strips.
#[must_use]
pub fn start_parameters() -> [Parameter; 4] {
    let start = move |scene: &Scene| {
        let open = || resting(scene, scene.head_start_x(0));
        scene.pantographs[0].start.unwrap_or_else(open)
    };
    of_start(
        "",
        start,
        |scene, start| scene.pantographs[0].set_start(start),
        |scene| scene.head_start_x(0),
        |scene, x| scene.pantographs[0].offset_x = x - scene.run.start_x,
    )
}

/// Start and speed of strip `strip` (from 0, over all heads); the strips of a head move along the track together.
#[must_use]
pub fn strip_start_parameters(strip: usize) -> [Parameter; 4] {
    let start = move |scene: &Scene| {
        let open = || resting(scene, scene.strip_start_x(strip));
        scene.strip_start(strip).unwrap_or_else(open)
    };
    of_start(
        &format!("strip[{}].", strip + 1),
        start,
        move |scene, changed| {
            let (otherwise, (pantograph, own)) = (start(scene), scene.head_of(strip));
            scene.pantographs[pantograph].set_strip_start(own, changed, otherwise);
        },
        move |scene| scene.strip_start_x(strip),
        move |scene, x| {
            let (pantograph, own) = scene.head_of(strip);
            let on_head = scene.pantographs[pantograph].strips()[own].x;
            scene.pantographs[pantograph].offset_x = x - scene.run.start_x - on_head;
        },
    )
}

/// Parameters at a start, whose names begin with `prefix`.
fn of_start(
    prefix: &str,
    start: impl Fn(&Scene) -> Start + Copy + Send + Sync + 'static,
    set_start: impl Fn(&mut Scene, Start) + Copy + Send + Sync + 'static,
    x: impl Fn(&Scene) -> f64 + Send + Sync + 'static,
    set_x: impl Fn(&mut Scene, f64) + Send + Sync + 'static,
) -> [Parameter; 4] {
    [
        Parameter::new(
            format!("{prefix}start.height"),
            "m",
            "Height of the strip above the top of rail at the start",
            move |scene| start(scene).height,
            move |scene, height| set_start(scene, Start { height, ..start(scene) }),
        ),
        Parameter::new(
            format!("{prefix}start.force"),
            "N",
            "Contact force at the start",
            move |scene| start(scene).force,
            move |scene, force| set_start(scene, Start { force, ..start(scene) }),
        ),
        Parameter::new(
            format!("{prefix}start.x"),
            "m",
            "Position of the strip along the track at the start",
            x,
            set_x,
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
    // Their commands come from outside of the pantograph.
    own.controllers.clear();
    if let Some(acts) = own.wind.as_mut().and_then(|wind| wind.pantograph.as_mut()) {
        // One uplift for all pantographs, or one for each.
        if let Some(&uplift) = acts.uplift.get(index) {
            acts.uplift = vec![uplift];
        }
    }
    own
}
