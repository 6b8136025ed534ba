//! Elements and micro step for an error that is asked for.

use scene::{Catenary, Division, Scene};

use super::corrections::choose_corrections;

/// Micro steps that the rule chooses from where the macro step is controlled, s, and its longest and shortest where it
/// is fixed: those between 1 and 2 ms are what the mass correction of even elements takes, 2.5 ms are for lines in
/// their modes.
const STEPS: [f64; 13] = [
    2.5e-3, 2e-3, 1.6e-3, 1.4e-3, 1.25e-3, 1.1e-3, 1e-3, 8e-4, 6.5e-4, 5e-4, 2e-4, 1e-4, 5e-5,
];
/// Parts of a macro step above which those next to the list are enough: they differ from it by less than a twentieth.
const MOST_PARTS: f64 = 1000.0;
/// Most elements in an interval that the rule chooses.
const MOST_ELEMENTS: usize = 100;

/// Element length per wave ahead of the pantograph at which a plain mesh comes down to a few percent: 0.8 m for 1.9 m,
/// from convergence studies of tensioned beams with cubic elements. A study of a mesh begins there; the
/// worth of its results is measured, and the rule of [`expected_error`](crate::expected_error) is not asked.
const FINE: f64 = 0.42;

/// Elements and micro step for an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    division: Division,
    micro_step: f64,
}

/// A search for a mesh: its aim, and what is given.
pub(crate) struct Search<'a> {
    /// Largest error, %.
    pub(crate) percent: f64,
    /// Expected error of a scene, %; `Err` says for what no rule is known.
    pub(crate) error: &'a dyn Fn(&Scene) -> Result<f64, String>,
    /// True where elements and corrections are given.
    pub(crate) mesh_is_given: bool,
    /// True where the micro step is given.
    pub(crate) micro_step_is_given: bool,
    /// True where every micro step is a macro step of its own.
    pub(crate) macro_step_follows: bool,
}

impl Search<'_> {
    /// Writes a choice into a scene, but for what is given, and the corrections that it can have.
    pub(crate) fn apply(&self, choice: Choice, scene: &mut Scene) {
        scene.solver.micro_step = choice.micro_step;
        if self.macro_step_follows {
            scene.coupling.macro_step = choice.micro_step;
        }
        if !self.mesh_is_given {
            if let Some(mesh) = scene.mesh_mut() {
                mesh.division = choice.division;
            }
            choose_corrections(scene);
        }
    }
}

/// Elements per dropper interval, a power of two, that are short enough for the waves ahead of the pantograph.
#[must_use]
pub fn resolving_elements(scene: &Scene) -> usize {
    let Some((line, _)) = scene.modelled_line() else {
        return 1;
    };
    let wave = (line.contact_wire.wave_speed() - scene.run.speed) / scene.run.low_pass_hz;
    let wanted = line.longest_interval() / (FINE * wave);
    if !(wanted.is_finite() && wanted > 0.0) {
        return 8;
    }
    // A tenth of an octave too long is no reason for twice as many.
    2_usize.pow((wanted.log2() - 0.1).ceil().clamp(0.0, 6.0) as u32)
}

/// The division with the fewest elements that are no longer than those of `count` in the longest interval, but for a
/// tenth of a millimetre: as many in each interval where all need as many.
#[must_use]
pub fn evenly_divided(catenary: &Catenary, count: usize) -> Division {
    // A limit with few digits is one that can be typed.
    let longest = catenary.longest_interval() / count as f64;
    let even = Division::UpTo((1e4 * longest - 1e-6).ceil() / 1e4);
    if catenary.intervals().all(|(_, length)| even.elements(length) == count) {
        Division::PerInterval(count)
    } else {
        even
    }
}

/// The cheapest mesh and step of those that the rule knows whose error is small enough, with their cost: elements of a
/// span per second of internal steps, 1/s. `Err` says why there are none.
pub(crate) fn mesh_for(scene: &Scene, search: &Search<'_>) -> Result<(Choice, f64), String> {
    let no_rule =
        |of: String| format!("no rule is known for {of}; give elements_per_interval or element_length instead");
    let line = scene.modelled_line().ok_or("a line that is a supplied FMU");
    let (catenary, _) = line.map_err(|of| no_rule(of.to_owned()))?;
    (search.error)(scene).map_err(no_rule)?;
    // The longest element makes the error: what is shorter costs for nothing.
    let divisions: Vec<Division> = match search.mesh_is_given {
        true => vec![catenary.mesh.division],
        false => (1..=MOST_ELEMENTS)
            .map(|count| evenly_divided(catenary, count))
            .collect(),
    };
    let steps = if search.micro_step_is_given {
        vec![scene.solver.micro_step]
    } else if search.macro_step_follows {
        STEPS.to_vec()
    } else {
        steps_to_choose_from(scene)
    };
    let mut best: Option<(Choice, f64)> = None;
    let mut least = f64::INFINITY;
    let mut trial = scene.clone();
    for division in divisions {
        let elements = catenary.elements_per_span(division) as f64;
        // More elements cost more at the same step.
        if best.is_some_and(|(_, least_cost)| elements / steps[0] > least_cost * (1.0 + 1e-9)) {
            break;
        }
        let with = |micro_step: f64| Choice { division, micro_step };
        let mut expected = |step: f64| {
            search.apply(with(step), &mut trial);
            (search.error)(&trial).map_err(no_rule)
        };
        let smallest = expected(steps[steps.len() - 1])?;
        least = least.min(smallest);
        if smallest > search.percent {
            continue;
        }
        for &step in &steps {
            let cost = elements / step;
            // Of two that cost the same, the longer step.
            if best.is_some_and(|(_, least_cost)| cost > least_cost * (1.0 + 1e-9)) {
                break;
            }
            if expected(step)? <= search.percent {
                best = Some((with(step), cost));
                break;
            }
        }
    }
    best.ok_or_else(|| {
        let with = if search.micro_step_is_given {
            format!(" with solver.micro_step = {} ms", 1e3 * scene.solver.micro_step)
        } else {
            String::new()
        };
        format!(
            "must be at least {least:.2} %{with}: no mesh of up to {MOST_ELEMENTS} elements between droppers \
                 comes below"
        )
    })
}

/// Micro steps that the rule chooses from, s, the longest first: what a fixed macro step is evenly divided into, of
/// long ones what is next to the list, or the list.
fn steps_to_choose_from(scene: &Scene) -> Vec<f64> {
    let (longest, shortest) = (STEPS[0], STEPS[STEPS.len() - 1]);
    if let Some(control) = scene.coupling.step_control {
        let taken: Vec<f64> = STEPS.into_iter().filter(|step| *step <= control.max).collect();
        return if taken.is_empty() { vec![control.max] } else { taken };
    }
    // A rest of rounding is no part, and a part that is one of the list is written as that.
    let macro_step = scene.coupling.macro_step;
    let parts = |step: f64| (macro_step / step - 1e-9).ceil().max(1.0);
    if parts(shortest) > MOST_PARTS {
        return STEPS.map(|step| macro_step / parts(step)).to_vec();
    }
    let fewest = parts(longest);
    let most = (macro_step / shortest + 1e-9).floor().max(fewest);
    let listed = |part: f64| STEPS.into_iter().find(|step| (step / part - 1.0).abs() < 1e-9);
    (fewest as u64..=most as u64)
        .map(|parts| macro_step / parts as f64)
        .map(|part| listed(part).unwrap_or(part))
        .collect()
}
