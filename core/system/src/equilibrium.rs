//! The state at t = 0: heights and forces at which both sides are at rest.

mod compliance;

use catenary::{CatenaryError, LineAtRest, StaticLine, StaticsError, StripStart};
use compliance::{Compliance, difference};
use dynamics::Layout;
use nalgebra::DMatrix;
use scene::{Initialise, PantographModel, Reduction, Scene, Start};
use std::ops::Range;
use vehicle::{Equilibrium, VehicleError};

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
    /// Strips of its head, over all heads.
    strips: Range<usize>,
    /// See [`vehicle::PantographModel::rises`].
    rises: Vec<Vec<f64>>,
    model: vehicle::PantographModel,
}

impl Side {
    fn new(scene: &Scene, index: usize) -> Result<Self, EquilibriumError> {
        let model = vehicle::PantographModel::of_scene(scene, index, &mut Layout::new());
        let model = model.map_err(|source| EquilibriumError::Pantograph {
            pantograph: index + 1,
            source,
        })?;
        Ok(Self {
            index,
            strips: scene.strips_of(index),
            rises: model.rises(),
            model,
        })
    }

    /// The pantograph at rest with its strips at these heights in m.
    fn at(&self, heights: &[f64]) -> Result<Equilibrium, EquilibriumError> {
        let found = self.model.equilibrium_at_heights(heights);
        found.map_err(|source| EquilibriumError::Pantograph {
            pantograph: self.index + 1,
            source,
        })
    }

    /// Heights of its strips among those of all, m.
    fn heights(&self, strips: &[StripStart]) -> Vec<f64> {
        strips[self.strips.clone()].iter().map(|strip| strip.height).collect()
    }

    /// Forces on the strips, N, along each of the motions that the head allows.
    fn along_rises<'a>(&'a self, forces: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let along = move |rise: &Vec<f64>| rise.iter().zip(forces).map(|(rise, force)| rise * force).sum();
        self.rises.iter().map(along)
    }
}

/// Height of the unloaded contact wire, or under an upward `force` in N, over the start of the head of pantograph
/// `index` (from 0), m.
///
/// # Errors
/// [`EquilibriumError::Wire`].
pub fn wire_height(scene: &Scene, statics: &StaticLine, index: usize, force: f64) -> Result<f64, EquilibriumError> {
    let x = scene.head_start_x(index);
    let height = statics.wire_height(x, force);
    height.map_err(|source| EquilibriumError::Wire {
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
        sides.push(Side::new(scene, index)?);
    }
    let mut line = LineAtRest::new(scene, statics)?;
    let mut strips: Vec<StripStart> = (0..scene.strip_count())
        .map(|strip| {
            let start = scene.strip_start(strip);
            StripStart::of(scene, strip, start.map_or(0.0, |start| start.height))
        })
        .collect();
    match scene.run.initialise {
        Initialise::Equilibrium => balance(scene, statics, &mut line, &sides, &mut strips)?,
        Initialise::AsGiven => {
            for side in &sides {
                for strip in &mut strips[side.strips.clone()] {
                    strip.height = side.model.reference_height();
                }
            }
            line.start(&strips)?;
        }
    }
    for side in &sides {
        let heights = side.heights(&strips);
        let of_line: Vec<f64> = side.strips.clone().map(|strip| line.force(strip)).collect();
        let force = match scene.run.initialise {
            Initialise::Equilibrium => side.at(&heights)?.force,
            Initialise::AsGiven => of_line.iter().sum(),
        };
        let height = heights.iter().sum::<f64>() / heights.len() as f64;
        if force < 0.0 {
            return Err(EquilibriumError::OutOfReach {
                pantograph: side.index + 1,
                height,
                force,
            });
        }
        let pantograph = &mut scene.pantographs[side.index];
        pantograph.start = Some(Start { height, force });
        if heights.len() > 1 {
            let starts = heights.into_iter().zip(of_line);
            pantograph.strip_starts = starts.map(|(height, force)| Start { height, force }).collect();
        }
    }
    Ok(())
}

/// Stiffness of line and pantograph against the motions that the head allows, N/m: the line gives way under all strips
/// of the head together as under one, and to a difference between them hardly more than the `contact` (N/m).
///
/// `heights` (m) are those of the strips, which press with `force` (N) in sum and have risen by `rise` m.
fn stiffness_of(
    side: &Side,
    heights: &[f64],
    force: f64,
    rise: f64,
    contact: f64,
) -> Result<DMatrix<f64>, EquilibriumError> {
    /// Rise of the difference, m: the pantograph is linear but for its stops.
    const STEP: f64 = 1e-4;
    let count = heights.len();
    if count == 1 {
        return Ok(DMatrix::from_element(1, 1, force / rise));
    }
    let together = force / rise / count as f64;
    let rises = &side.rises;
    let mut matrix = DMatrix::zeros(rises.len(), rises.len());
    let here = side.at(heights)?.strip_forces;
    for (column, by) in rises.iter().enumerate() {
        let moved: Vec<f64> = heights
            .iter()
            .zip(by)
            .map(|(height, rise)| height + STEP * rise)
            .collect();
        let there = side.at(&moved)?.strip_forces;
        let mean = by.iter().sum::<f64>() / count as f64;
        let forces: Vec<f64> = (0..count)
            .map(|strip| together * mean + contact * (by[strip] - mean) + (here[strip] - there[strip]) / STEP)
            .collect();
        for (row, force) in side.along_rises(&forces).enumerate() {
            matrix[(row, column)] = force;
        }
    }
    Ok(matrix)
}

/// Height of the contact wire under a `force` in N at which the search for the balance begins, m; `free` without one.
///
/// A linear line rises in proportion to the force, so that cases with forces of their own share one height.
fn first_height(
    scene: &Scene,
    statics: &StaticLine,
    index: usize,
    (free, force): (f64, f64),
) -> Result<f64, EquilibriumError> {
    /// Forces that share a height, N.
    const SHARED: f64 = 50.0;
    if !scene.model.has(Reduction::Modal) {
        return wire_height(scene, statics, index, force);
    }
    let most = (force / SHARED).ceil() * SHARED;
    Ok(free + (wire_height(scene, statics, index, most)? - free) * force / most)
}

/// Moves the strips of `sides` until the line presses on each as hard as its pantograph pushes; on a head with several
/// strips, along each of the motions that the head allows.
///
/// The first correction takes the line's own stiffness under each head, contact included; how heads in one span see
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
    let mut stiffnesses = Vec::with_capacity(sides.len());
    for side in sides {
        let free = wire_height(scene, statics, side.index, 0.0)?;
        let count = side.strips.len();
        let force = side.at(&vec![free; count])?.force;
        if force <= 0.0 {
            return Err(EquilibriumError::OutOfReach {
                pantograph: side.index + 1,
                height: free,
                force,
            });
        }
        let height = first_height(scene, statics, side.index, (free, force))? + force / (count as f64 * contact);
        for strip in &mut strips[side.strips.clone()] {
            strip.height = height;
        }
        let stiffness = stiffness_of(side, &vec![height; count], force, height - free, contact)?;
        stiffnesses.push(stiffness);
    }
    let (mut residual, mut worst) = (f64::INFINITY, 0);
    let mut compliance = Compliance::of_heads(&stiffnesses);
    let mut last: Option<(Vec<f64>, Vec<f64>)> = None;
    // Places along the motions of all heads, m; of a single strip its height.
    let mut rises: Vec<f64> = (sides.iter())
        .flat_map(|side| vec![strips[side.strips.start].height; side.rises.len()])
        .collect();
    for _ in 0..ITERATIONS {
        for side in sides.iter().filter(|side| side.strips.len() > 1) {
            // A mechanism may turn its head as it rises.
            let heights = side.at(&side.heights(strips))?.strip_heights;
            for (strip, height) in strips[side.strips.clone()].iter_mut().zip(heights) {
                strip.height = height;
            }
        }
        line.start(strips)?;
        residual = 0.0;
        let mut missing = Vec::with_capacity(rises.len());
        for side in sides {
            let pushed = side.at(&side.heights(strips))?.strip_forces;
            let forces: Vec<f64> = (side.strips.clone().zip(&pushed))
                .map(|(strip, pushed)| pushed - line.force(strip))
                .collect();
            for here in side.along_rises(&forces) {
                // Also a difference that is no number.
                if here.abs() > residual || here.is_nan() {
                    (residual, worst) = (here.abs(), side.index);
                }
                missing.push(here);
            }
        }
        if residual <= TOLERANCE {
            return Ok(());
        }
        if let Some((before, was)) = &last {
            compliance.learn(&difference(&rises, before), &difference(&missing, was));
        }
        let changes = compliance.times(&missing);
        last = Some((rises.clone(), missing));
        let mut first = 0;
        for side in sides {
            for (rise, change) in side.rises.iter().zip(&changes[first..]) {
                for (strip, rise) in strips[side.strips.clone()].iter_mut().zip(rise) {
                    strip.height += change * rise;
                }
            }
            first += side.rises.len();
        }
        for (rise, change) in rises.iter_mut().zip(&changes) {
            *rise += change;
        }
    }
    Err(EquilibriumError::NotConverged {
        start_x: scene.run.start_x,
        pantograph: worst + 1,
        x: scene.head_start_x(worst),
        residual,
        iterations: ITERATIONS,
    })
}
