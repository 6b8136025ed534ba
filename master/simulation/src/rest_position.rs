//! Warns where the rest position of a pantograph takes away a part of its static force.
//!
//! A spring between the pantograph and its base is unstretched at one height only. A strip that stands elsewhere
//! presses with the static force less the force of that spring.

use catenary::StaticLine;
use scene::{Lumped, PantographModel, Scene};

use crate::Prepared;
use system::equilibrium::wire_height;

/// Smallest share of the static force that is warned of, –: a line that gives way under the strip takes less.
const SHARE: f64 = 0.05;

/// Smallest distance between the start of a supplied strip and the wire that is warned of, m: sag and uplift are of
/// this size.
const OFF_WIRE: f64 = 0.05;

/// One warning per pantograph whose rest position changes its static force.
pub(crate) fn warnings(prepared: &Prepared) -> Vec<String> {
    let scene = &prepared.scene;
    let numbered = scene.pantographs.iter().enumerate();
    let warned = numbered.filter_map(|(index, pantograph)| match &pantograph.model {
        PantographModel::Lumped(lumped) => lumped_warning(scene, index, &lumped.at_speed(scene.run.speed)),
        PantographModel::Supplied(_) => {
            let stated = *prepared.stated_forces.get(index)?;
            if prepared.settling.is_some() {
                settled_warning(scene, index, stated)
            } else {
                unsettled_warning(scene, prepared.statics.as_ref()?, index, stated)
            }
        }
        PantographModel::Linkage(_) => None,
    });
    warned.collect()
}

/// True where `force` is so far from the static one (both N) that a user should know.
fn differs(force: f64, stated: f64) -> bool {
    stated > 0.0 && (force - stated).abs() > SHARE * stated
}

/// A lumped chain at its start height, with all its springs in series, those under strips as one:
///
/// ```text
/// F = F₀ − (h − h₀)/Σ 1/kᵢ,   F₀ = S / (1 + kₙ Σ 1/kᵢ, i < n)
/// ```
fn lumped_warning(scene: &Scene, index: usize, lumped: &Lumped) -> Option<String> {
    let (start, reference) = (scene.pantographs[index].start?, lumped.reference_height?);
    let (grounded, upper) = lumped.stiffnesses.split_last()?;
    if lumped.stiffnesses.contains(&0.0) {
        return None;
    }
    let strips = lumped.strip_stiffness();
    let above: f64 = upper.iter().chain(&strips).map(|stiffness| 1.0 / stiffness).sum();
    let compliance = above + 1.0 / grounded;
    let at_reference = lumped.static_force / (1.0 + grounded * above);
    let force = at_reference - (start.height - reference) / compliance;
    let fitting = start.height + (lumped.static_force - at_reference) * compliance;
    differs(force, lumped.static_force).then(|| {
        let key = format!("pantograph[{}]", index + 1);
        format!(
            "{key}.reference_height = {reference:.4} m: at the wire, {:.4} m, the pantograph presses with {force:.1} \
             N instead of \
             its static force of {:.1} N; set {key}.reference_height = {fitting:.4}, or leave the key out for the \
             height of the wire",
            start.height, lumped.static_force
        )
    })
}

/// A supplied pantograph that has come to rest under the wire.
fn settled_warning(scene: &Scene, index: usize, stated: f64) -> Option<String> {
    let start = scene.pantographs[index].start?;
    differs(start.force, stated).then(|| {
        let key = format!("pantograph[{}]", index + 1);
        format!(
            "{key}.fmu: at rest under the wire, {:.4} m, the FMU presses with {:.1} N instead of the {stated:.1} N \
             that its \
             force input starts with; {}",
            start.height,
            start.force,
            remedy(&key)
        )
    })
}

/// A supplied pantograph before it settles: its springs are not known, the distance from the wire is.
fn unsettled_warning(scene: &Scene, statics: &StaticLine, index: usize, stated: f64) -> Option<String> {
    let height = scene.pantographs[index].start?.height;
    let wire = wire_height(scene, statics, index, stated.max(0.0)).ok()?;
    (stated > 0.0 && (height - wire).abs() > OFF_WIRE).then(|| {
        let key = format!("pantograph[{}]", index + 1);
        format!(
            "{key}.fmu: the strip starts at {height:.4} m under {stated:.1} N, the wire is at {wire:.4} m: a spring \
             to the base \
             that is unstretched at the start costs static force at the wire; {}",
            remedy(&key)
        )
    })
}

fn remedy(key: &str) -> String {
    format!("set {key}.outputs.height.offset = \"align\", or the FMU's own rest height in {key}.parameters")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The warnings of the reference model with this key.
    fn of(key: &str) -> Vec<String> {
        of_keys(&[key])
    }

    fn of_keys(more: &[&str]) -> Vec<String> {
        let text = include_str!("../../../scenes/en50318-250.toml");
        let keys = [
            "catenary.spans=3",
            "run.evaluate={ time = [0.1, 0.4] }",
            "run.duration=0.4",
        ];
        let keys: Vec<String> = keys.iter().chain(more).map(|key| (*key).to_owned()).collect();
        let scene = system::load(text, "en50318-250.toml", &keys).unwrap();
        let prepared = crate::prepare(scene, "test", std::path::Path::new("."), false).unwrap();
        let warned = warnings(&prepared);
        assert!(warned.iter().all(|warning| prepared.notes(1e-3).contains(warning)));
        warned
    }

    #[test]
    fn a_chain_whose_spring_rests_below_the_wire_is_told_with_both_forces_and_the_fitting_height() {
        let [warning] = &of("pantograph[1].reference_height=5.0")[..] else {
            panic!("one warning");
        };
        for part in [
            "pantograph[1].reference_height = 5.0000 m",
            "instead of its static force of 120.0 N",
        ] {
            assert!(warning.contains(part), "{warning}");
        }
        let fitting = warning.split("set pantograph[1].reference_height = ").nth(1).unwrap();
        let fitting = fitting.split(',').next().unwrap();
        assert_eq!(of(&format!("pantograph[1].reference_height={fitting}")), [""; 0]);
    }

    #[test]
    fn a_chain_that_rests_at_the_wire_is_not_warned_of() {
        assert_eq!(of("run.speed_kmh=250"), [""; 0]);
    }

    #[test]
    fn the_height_that_fits_a_head_counts_the_springs_under_its_strips() {
        let strip = |x: f64| format!("{{ x = {x}, mass = 1.5, stiffness = 500 }}");
        let strips = format!("pantograph[1].strips=[{}, {}]", strip(0.3), strip(-0.3));
        let warned = |height: &str| of_keys(&[&strips, &format!("pantograph[1].reference_height={height}")]);
        let [warning] = &warned("5.0")[..] else {
            panic!("one warning");
        };
        let fitting = warning.split("set pantograph[1].reference_height = ").nth(1).unwrap();
        assert_eq!(warned(fitting.split(',').next().unwrap()), [""; 0]);
    }
}
