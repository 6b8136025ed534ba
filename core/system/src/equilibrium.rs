//! The state at t = 0: heights and forces at which both sides are at rest.

use catenary::{CatenaryError, LineAtRest, StaticLine, StaticsError, StripStart};
use dynamics::Layout;
use scene::{Initialise, PantographModel, Scene, Start};
use vehicle::VehicleError;

/// Difference between what line and pantograph exert at the start that counts as balance, N.
const TOLERANCE: f64 = 1e-6;

/// The correction contracts by a hundred and more each time, by three where two strips share a span.
const ITERATIONS: usize = 60;

/// Reason why there is no state to start from.
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
        "pantograph[{pantograph}]: at the height of the wire over its start, {height:.4} m, it exerts {force:.3} N: \
         it must push up there"
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
        "run.start_x = {start_x} m: no balance between the line and pantograph {pantograph}, whose strip starts at x \
         = {x} m: {residual:.3e} N remain after {iterations} iterations, tolerance {TOLERANCE:.0e} N"
    )]
    NotConverged {
        /// Key of the scene, m.
        start_x: f64,
        /// From 1, the one with the largest difference.
        pantograph: usize,
        /// Height of its strip, m.
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
/// Values that the scene already gives are kept, so that a resolved scene resolves to itself.
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
        pantograph.start.is_none() && !matches!(pantograph.model, PantographModel::Supplied(_))
    };
    if !scene.pantographs.iter().any(missing) {
        return Ok(());
    }
    let mut sides = Vec::new();
    for index in (0..scene.pantographs.len()).filter(|&index| missing(&scene.pantographs[index])) {
        let model = vehicle::PantographModel::of_scene(scene, index, &mut Layout::new());
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
    let mut line = LineAtRest::new(scene, statics)?;
    let mut strips: Vec<StripStart> = (0..scene.pantographs.len())
        .map(|index| {
            let start = scene.pantographs[index].start;
            StripStart::of(scene, index, start.map_or(0.0, |start| start.height))
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
            Initialise::AsGiven => line.force(side.index),
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

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Rise of the strips per newton that is missing, m/N, by Broyden's method [Broyden, Math. Comp. 19 (1965)]; with
/// one strip a secant.
struct Compliance {
    rows: Vec<Vec<f64>>,
}

impl Compliance {
    /// Equilibrium of strips that do not see each other, on these stiffnesses (N/m).
    fn diagonal(stiffness: &[f64]) -> Self {
        let row = |i: usize| {
            (0..stiffness.len())
                .map(|j| if i == j { 1.0 / stiffness[i] } else { 0.0 })
                .collect()
        };
        Self {
            rows: (0..stiffness.len()).map(row).collect(),
        }
    }

    fn times(&self, forces: &[f64]) -> Vec<f64> {
        let product = |row: &Vec<f64>| row.iter().zip(forces).map(|(a, b)| a * b).sum();
        self.rows.iter().map(product).collect()
    }

    /// Takes in that a rise (m) has changed the missing forces by `change` (N), where that tells more than rounding and
    /// more than a contact that has just closed.
    fn learn(&mut self, rise: &[f64], change: &[f64]) {
        let square: f64 = rise.iter().map(|s| s * s).sum();
        let expected = self.times(change);
        let along: f64 = rise.iter().zip(&expected).map(|(s, y)| s * y).sum();
        if square < 1e-18 || along > -0.1 * square {
            return;
        }
        let left: Vec<f64> = (0..rise.len())
            .map(|j| rise.iter().zip(&self.rows).map(|(s, row)| s * row[j]).sum())
            .collect();
        for (row, (s, y)) in self.rows.iter_mut().zip(rise.iter().zip(&expected)) {
            for (entry, left) in row.iter_mut().zip(&left) {
                *entry -= (s + y) * left / along;
            }
        }
    }
}

/// Moves the strips of `sides` until the line presses on each as hard as its pantograph pushes.
///
/// The first correction takes the line's own stiffness under each strip, contact included; how strips in one span see
/// each other is learnt from the corrections.
fn balance(
    scene: &Scene,
    statics: &StaticLine,
    line: &mut LineAtRest,
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
    let mut compliance = Compliance::diagonal(&stiffness);
    let mut last: Option<(Vec<f64>, Vec<f64>)> = None;
    for _ in 0..ITERATIONS {
        line.start(strips)?;
        residual = 0.0;
        let heights: Vec<f64> = sides.iter().map(|side| strips[side.index].height).collect();
        let mut missing = Vec::with_capacity(sides.len());
        for (side, height) in sides.iter().zip(&heights) {
            let here = side.force(*height)? - line.force(side.index);
            // Also a difference that is no number.
            if here.abs() > residual || here.is_nan() {
                (residual, worst) = (here.abs(), side.index);
            }
            missing.push(here);
        }
        if residual <= TOLERANCE {
            return Ok(());
        }
        if let Some((before, was)) = &last {
            compliance.learn(&difference(&heights, before), &difference(&missing, was));
        }
        for (side, change) in sides.iter().zip(compliance.times(&missing)) {
            strips[side.index].height += change;
        }
        last = Some((heights, missing));
    }
    Err(EquilibriumError::NotConverged {
        start_x: scene.run.start_x,
        pantograph: worst + 1,
        x: scene.strip_start_x(worst),
        residual,
        iterations: ITERATIONS,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_that_see_each_other_come_to_rest_by_what_is_learnt() {
        // Missing forces b − K x of two springs that are coupled as strongly as two strips in one span.
        let (stiffness, b) = ([[2000.0, 1700.0], [1700.0, 2100.0]], [110.0, 120.0]);
        let missing = |x: &[f64]| -> Vec<f64> {
            (0..2)
                .map(|i| b[i] - stiffness[i][0] * x[0] - stiffness[i][1] * x[1])
                .collect()
        };
        let mut compliance = Compliance::diagonal(&[2000.0, 2100.0]);
        let mut x = vec![0.0, 0.0];
        let mut last = missing(&x);
        let mut steps = 0;
        while last.iter().any(|force| force.abs() > 1e-9) {
            let rise = compliance.times(&last);
            x = x.iter().zip(&rise).map(|(x, s)| x + s).collect();
            let now = missing(&x);
            compliance.learn(&rise, &difference(&now, &last));
            last = now;
            steps += 1;
            assert!(steps <= 8, "{last:?}");
        }
    }

    #[test]
    fn one_strip_is_a_secant() {
        let mut compliance = Compliance::diagonal(&[1000.0]);
        compliance.learn(&[0.01], &[-20.0]);
        assert!((compliance.times(&[4.0])[0] - 0.002).abs() < 1e-15);
    }
}
