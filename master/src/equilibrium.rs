//! The state at t = 0: heights and forces at which both sides are at rest.

use catenary::{CatenaryError, StaticLine, StaticsError, StripStart};
use dynamics::Layout;
use scene::{Initialise, PantographModel, Scene, Start};
use vehicle::VehicleError;

/// Difference between what line and pantograph exert at the start that counts as balance, N.
const TOLERANCE: f64 = 1e-6;

/// The correction contracts by a hundred and more each time, by three where two strips share a span.
const ITERATIONS: usize = 60;

/// Why there is no state to start from.
#[derive(Debug, thiserror::Error)]
pub enum EquilibriumError {
    /// The line cannot be solved under its strips.
    #[error("the start under the strips")]
    Line(#[from] CatenaryError),
    /// The wire over a strip cannot be found.
    #[error("the wire over the start of pantograph {pantograph}, x = {x} m")]
    Wire {
        /// From 1.
        pantograph: usize,
        /// m.
        x: f64,
        /// Reason.
        #[source]
        source: StaticsError,
    },
    /// A pantograph has no equilibrium there.
    #[error("pantograph[{pantograph}]")]
    Pantograph {
        /// From 1.
        pantograph: usize,
        /// Reason.
        #[source]
        source: VehicleError,
    },
    /// The wire is too high.
    #[error(
        "pantograph[{pantograph}]: at the height of the wire over its start, {height:.4} m, it exerts {force:.3} N: it must \
         push up there"
    )]
    OutOfReach {
        /// From 1.
        pantograph: usize,
        /// m.
        height: f64,
        /// N.
        force: f64,
    },
    /// The correction does not settle.
    #[error(
        "run.start_x = {start_x} m: no balance between the line and pantograph {pantograph}, whose strip starts at x = {x} m: \
         {residual:.3e} N remain after {iterations} iterations, tolerance {TOLERANCE:.0e} N; must be further inside the line, half \
         a span or more from its ends"
    )]
    NotConverged {
        /// Key of the scene, m.
        start_x: f64,
        /// From 1, the one with the largest difference.
        pantograph: usize,
        /// Of its strip, m.
        x: f64,
        /// Largest difference of forces, N.
        residual: f64,
        /// Iterations done.
        iterations: usize,
    },
}

/// One pantograph alone.
struct Side {
    index: usize,
    x: f64,
    model: vehicle::PantographModel,
}

impl Side {
    /// Contact force at rest at `height` in m, N.
    fn force(&self, height: f64) -> Result<f64, EquilibriumError> {
        let found = self.model.equilibrium_at_height(height);
        found
            .map(|equilibrium| equilibrium.force)
            .map_err(|source| self.refused(source))
    }

    fn refused(&self, source: VehicleError) -> EquilibriumError {
        EquilibriumError::Pantograph {
            pantograph: self.index + 1,
            source,
        }
    }
}

/// Height of the unloaded contact wire, or under an upward `force` in N, over the start of pantograph `index`, m.
///
/// # Errors
/// [`EquilibriumError::Wire`].
pub fn wire_height(scene: &Scene, statics: &StaticLine, index: usize, force: f64) -> Result<f64, EquilibriumError> {
    let x = scene.strip_start_x(index);
    let answer = statics.wire_height_under(x, force);
    answer
        .map(|answer| answer.height)
        .map_err(|source| EquilibriumError::Wire {
            pantograph: index + 1,
            x,
            source,
        })
}

/// Writes into the scene what a start needs and the file leaves open: `reference_height` of lumped pantographs and
/// `pantograph.start` of all pantographs modelled here.
///
/// What the scene already says is kept, so that a resolved scene resolves to itself.
///
/// # Errors
/// See [`EquilibriumError`].
pub fn resolve(scene: &mut Scene, statics: &StaticLine) -> Result<(), EquilibriumError> {
    for index in 0..scene.pantographs.len() {
        let PantographModel::Lumped(lumped) = &scene.pantographs[index].model else {
            continue;
        };
        if lumped.reference_height.is_none() {
            let height = wire_height(scene, statics, index, 0.0)?;
            if let PantographModel::Lumped(lumped) = &mut scene.pantographs[index].model {
                lumped.reference_height = Some(height);
            }
        }
    }
    let missing = |pantograph: &scene::Pantograph| {
        pantograph.start.is_none() && !matches!(pantograph.model, PantographModel::ThirdParty(_))
    };
    if !scene.pantographs.iter().any(missing) {
        return Ok(());
    }
    let mut sides = Vec::new();
    for index in (0..scene.pantographs.len()).filter(|&index| missing(&scene.pantographs[index])) {
        let placement = vehicle::placement(scene, index);
        let name = format!("pantograph {}", index + 1);
        let entry = &scene.pantographs[index].model;
        let model = vehicle::PantographModel::new(entry, placement, &name, &mut Layout::new());
        let model = model.map_err(|source| EquilibriumError::Pantograph {
            pantograph: index + 1,
            source,
        })?;
        sides.push(Side {
            index,
            x: scene.strip_start_x(index),
            model,
        });
    }
    let mut line = catenary::Subsystem::new(scene, statics)?;
    let mut strips: Vec<StripStart> = (0..scene.pantographs.len())
        .map(|index| StripStart {
            x: scene.strip_start_x(index),
            y: 0.0,
            height: scene.pantographs[index].start.map_or(0.0, |start| start.height),
            speed: scene.run.speed,
        })
        .collect();
    match scene.run.initialise {
        Initialise::Equilibrium => balance(scene, statics, &mut line, &sides, &mut strips)?,
        Initialise::AsGiven => {
            for side in &sides {
                strips[side.index].height = side.model.reference_height();
            }
            line.start(&strips)?;
        }
    }
    for side in &sides {
        let force = match scene.run.initialise {
            Initialise::Equilibrium => side.force(strips[side.index].height)?,
            Initialise::AsGiven => line.contact(side.index).force,
        };
        if force < 0.0 {
            let height = strips[side.index].height;
            return Err(EquilibriumError::OutOfReach {
                pantograph: side.index + 1,
                height,
                force,
            });
        }
        scene.pantographs[side.index].start = Some(Start {
            height: strips[side.index].height,
            force,
        });
    }
    Ok(())
}

/// Moves the strips of `sides` until the line presses on each as hard as its pantograph pushes.
///
/// Each correction takes the line's own stiffness under one strip, contact included; strips far apart do not see each
/// other, so it is nearly Newton's method.
fn balance(
    scene: &Scene,
    statics: &StaticLine,
    line: &mut catenary::Subsystem,
    sides: &[Side],
    strips: &mut [StripStart],
) -> Result<(), EquilibriumError> {
    let contact = scene
        .contact
        .as_ref()
        .map_or(f64::INFINITY, |contact| contact.stiffness);
    let mut stiffness = Vec::with_capacity(sides.len());
    for side in sides {
        let free = wire_height(scene, statics, side.index, 0.0)?;
        let force = side.force(free)?;
        if force <= 0.0 {
            return Err(EquilibriumError::OutOfReach {
                pantograph: side.index + 1,
                height: free,
                force,
            });
        }
        let height = wire_height(scene, statics, side.index, force)? + force / contact;
        strips[side.index].height = height;
        stiffness.push(force / (height - free));
        debug_assert_eq!(side.x, strips[side.index].x);
    }
    let (mut residual, mut worst) = (f64::INFINITY, 0);
    let mut last: Vec<Option<(f64, f64)>> = vec![None; sides.len()];
    for _ in 0..ITERATIONS {
        line.start(strips)?;
        residual = 0.0;
        let mut moves = Vec::with_capacity(sides.len());
        for (k, side) in sides.iter().enumerate() {
            let height = strips[side.index].height;
            let missing = side.force(height)? - line.contact(side.index).force;
            // Also a difference that is no number.
            if missing.abs() > residual || missing.is_nan() {
                (residual, worst) = (missing.abs(), side.index);
            }
            // A secant of the last two heights where they tell more than rounding; else the stiffness of one strip alone.
            let slope = match last[k] {
                Some((before, was)) if sides.len() == 1 && (height - before).abs() > 1e-9 => {
                    (was - missing) / (height - before)
                }
                _ => stiffness[k],
            };
            last[k] = Some((height, missing));
            moves.push(
                missing
                    / if slope > 0.1 * stiffness[k] {
                        slope
                    } else {
                        stiffness[k]
                    },
            );
        }
        if residual <= TOLERANCE {
            return Ok(());
        }
        for (side, change) in sides.iter().zip(moves) {
            strips[side.index].height += change;
        }
    }
    Err(EquilibriumError::NotConverged {
        start_x: scene.run.start_x,
        pantograph: worst + 1,
        x: scene.strip_start_x(worst),
        residual,
        iterations: ITERATIONS,
    })
}
