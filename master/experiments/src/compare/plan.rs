//! Runs of a comparison.

use crate::engine::Variant;
use crate::engine::table::{AUTO, Keys};
use simulation::Mode;

/// Macro steps of a comparison when nothing is said, s.
pub const MACRO_STEPS: [f64; 7] = [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2];

/// A group of macro steps below the scene's micro step spans less than this factor.
const SPAN: f64 = 5.0;

/// Macro steps that are compared at the same micro step, so that one reference serves them all.
#[derive(Clone, Debug, PartialEq)]
pub struct StepGroup {
    /// Micro step, s; no longer than any of the macro steps.
    pub micro_step: f64,
    /// Macro steps, s, rising.
    pub macro_steps: Vec<f64>,
}

/// Puts macro steps (s) into groups for a scene with a given micro step (s); the coarsest group comes first.
///
/// The macro steps from half the scene's micro step on share one micro step, that of the scene or the smallest of them.
/// Shorter ones would make all runs as dear as their own: they are taken in groups that span less than a factor of
/// five, each at its smallest.
pub(super) fn groups(macro_steps: &[f64], scene_micro_step: f64) -> Vec<StepGroup> {
    let mut steps = macro_steps.to_vec();
    steps.sort_by(f64::total_cmp);
    steps.dedup();
    let shorter = steps.partition_point(|step| *step < 0.5 * scene_micro_step * (1.0 - 1e-9));
    let coarse = steps.split_off(shorter);
    let mut groups = Vec::new();
    if let Some(&smallest) = coarse.first() {
        groups.push(StepGroup {
            micro_step: smallest.min(scene_micro_step),
            macro_steps: coarse,
        });
    }
    let mut fine: Vec<StepGroup> = Vec::new();
    for step in steps {
        match fine.last_mut() {
            Some(group) if step < SPAN * group.micro_step * (1.0 - 1e-9) => group.macro_steps.push(step),
            _ => fine.push(StepGroup {
                micro_step: step,
                macro_steps: vec![step],
            }),
        }
    }
    groups.extend(fine.into_iter().rev());
    groups
}

/// One run of the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedRun {
    /// Variant of the scene.
    pub variant: Variant,
    /// StepGroup, from 0.
    pub group: usize,
    /// Expected cost, in steps of the line.
    pub weight: f64,
    /// Rank among the runs that the others of the group can be compared with; the first one that ends is taken.
    pub reference: Option<u8>,
}

const ITERATED: &str = scene::Algorithm::Iterated.name();

/// Names of all algorithms, the automatic choice first.
#[must_use]
pub fn algorithms() -> Vec<&'static str> {
    let named = scene::Algorithm::ALL.iter().map(|algorithm| algorithm.name());
    std::iter::once(AUTO)
        .chain(named.filter(|name| *name != AUTO))
        .collect()
}

/// All runs in the order in which they are made: the coarsest group first, in it the monolithic run, then the macro
/// steps from the longest to the shortest.
///
/// The FMUs' subsystems without FMI are run with the automatic choice at the macro steps of the coarsest group only:
/// they compute the same as the FMUs, which is checked there.
pub(super) fn plan(groups: &[StepGroup], duration: f64, keys: &Keys) -> Vec<ComparedRun> {
    let mut runs = Vec::new();
    for (index, group) in groups.iter().enumerate() {
        let smallest = group.macro_steps[0];
        let steps = duration / group.micro_step;
        let run = |mode: Mode, algorithm: &str, macro_step: f64, reference: Option<u8>| ComparedRun {
            variant: Variant {
                mode,
                algorithm: algorithm.to_owned(),
                overrides: keys.overrides(algorithm, macro_step, group.micro_step),
            },
            group: index,
            // Repeated steps cost about three passes.
            weight: steps * if algorithm == ITERATED { 3.0 } else { 1.0 },
            reference,
        };
        // Where a pantograph has no equations: the finest repeated coupling, else the finest there is.
        let rank = |algorithm: &str, macro_step: f64| match algorithm {
            ITERATED if macro_step == smallest => Some(1),
            AUTO if macro_step == smallest => Some(2),
            _ => None,
        };
        runs.push(run(Mode::Monolithic, "", smallest, Some(0)));
        for &macro_step in group.macro_steps.iter().rev() {
            for algorithm in algorithms() {
                let rank = rank(algorithm, macro_step);
                runs.push(run(Mode::Cosimulation, algorithm, macro_step, rank));
            }
            if index == 0 {
                runs.push(run(Mode::Inprocess, AUTO, macro_step, None));
            }
        }
    }
    runs
}
