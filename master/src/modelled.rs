//! What a scene models, what it leaves out and why, and what its results are worth.

use scene::{Initialise, PantographModel, Reduction, Start};

use crate::results::{Model, Part};
use crate::simulation::Prepared;
use crate::standstill::{self, Standstill};

impl Prepared {
    /// What is modelled, and what is not, with reasons.
    #[must_use]
    pub fn model(&self) -> Model {
        let scene = &self.scene;
        let topology = self.statics.as_ref().map(|statics| statics.line().topology());
        let mut coordinates = self.statics.as_ref().map_or(0, catenary::StaticLine::coordinates);
        let mut constraints = 0;
        let mut kinds = Vec::new();
        for (index, pantograph) in scene.pantographs.iter().enumerate() {
            kinds.push(match &pantograph.model {
                PantographModel::Lumped(lumped) => {
                    coordinates += lumped.masses.len();
                    format!("lumped, {} masses", lumped.masses.len())
                }
                PantographModel::Linkage(linkage) => {
                    let mut layout = dynamics::Layout::new();
                    let placement = vehicle::placement(scene, index);
                    if let Ok(model) = vehicle::PantographModel::new(&pantograph.model, placement, "", &mut layout) {
                        coordinates += model.coordinates();
                        constraints += model.constraint_count();
                    }
                    format!("linkage of {} bodies", linkage.bodies.len())
                }
                PantographModel::ThirdParty(entry) => format!("FMU {}", entry.fmu),
            });
        }
        let elements = topology.map_or(0, |topology| topology.elements());
        let line = match (&scene.catenary, topology) {
            (scene::Line::ThirdParty(entry), _) => format!("FMU {}", entry.fmu),
            (_, topology) => format!(
                "{elements} cable elements in two wires, {} spans; {}; {}",
                topology.map_or(0, |topology| topology.supports().len() - 1),
                dimension(scene),
                motion(scene)
            ),
        };
        let part = |part: &str, modelled: bool, reason: String| Part {
            part: part.to_owned(),
            modelled,
            reason,
        };
        let absent = |name: &str, table: &str| part(name, false, format!("scene has no [{table}]"));
        Model {
            coordinates,
            constraints,
            elements,
            reductions: scene
                .model
                .reductions
                .iter()
                .map(|reduction| reduction.name().to_owned())
                .collect(),
            parts: vec![
                part("catenary", true, line),
                part("pantograph", true, kinds.join("; ")),
                part(
                    "vehicle",
                    false,
                    "scene has no [vehicle]: the base moves on a straight line".to_owned(),
                ),
                absent("wheel_rail", "vehicle"),
                absent("track", "track"),
                absent("wind_pantograph", "wind"),
                absent("wind_wires", "wind"),
            ],
        }
    }

    /// Remarks on what the results are worth.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let (Some((catenary, _)), Some(statics)) = (self.scene.modelled_line(), &self.statics) {
            let x = statics.line().topology().x();
            let longest = x.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
            notes.extend(mesh_note(
                longest,
                catenary.contact_wire.wave_speed(),
                self.scene.run.speed,
                self.scene.run.low_pass_hz,
            ));
        }
        for (index, pantograph) in self.scene.pantographs.iter().enumerate() {
            if let (PantographModel::ThirdParty(_), Some(start)) = (&pantograph.model, pantograph.start) {
                notes.push(format!(
                    "pantograph {}: somebody else's FMU; the work on its strip and with it the energy residual is an estimate; {}",
                    index + 1,
                    third_party_start(self.scene.run.initialise, self.standstill, start)
                ));
            }
        }
        if let scene::Line::ThirdParty(_) = self.scene.catenary {
            notes.push(format!(
                "line: somebody else's FMU; its work and with it the energy residual is an estimate where it does not offer it{}",
                self.standstill.map_or_else(String::new, |found| format!("; {}", at_rest(found, true)))
            ));
        }
        for other in &self.others {
            for remark in &other.remarks {
                notes.push(format!("{} ({}): {remark}", other.name, file_name(&other.fmu)));
            }
        }
        notes
    }
}

/// The last part of a path.
fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// How a phase at rest went.
fn at_rest(found: Standstill, in_contact: bool) -> String {
    let Standstill {
        duration,
        steps,
        change,
    } = found;
    let rest = if change < standstill::REST && in_contact {
        "came to rest"
    } else {
        "did not come to rest"
    };
    format!(
        "it {rest} in {duration:.1} s ({steps} steps) at standstill before t = 0, a change of {change:.2e} N/s being left; its \
         clock is ahead by that time"
    )
}

/// Which coordinates the line has, and why.
fn dimension(scene: &scene::Scene) -> String {
    if scene.is_planar() {
        return "planar: nothing pushes it sideways, so leaving out the lateral coordinates changes nothing".to_owned();
    }
    let reason = scene.pushed_sideways();
    format!(
        "spatial: {}",
        reason.unwrap_or_else(|| "asked for by model.reduce".to_owned())
    )
}

/// Which law of motion the line has, and what is known of its distance from the line as it is.
///
/// Distances are rms differences of the 20 Hz force from runs of the same scene with the nonlinear line, on one mesh and step, in
/// percent of its standard deviation.
fn motion(scene: &scene::Scene) -> String {
    if scene.model.has(Reduction::Flat) {
        "flat, asked for by model.reduce: straight wires that move up and down, for comparison with two-dimensional programs; the sag \
         of the messenger wire is left out, which moves the force of EN 50318 lines by 2 % of its standard deviation with wire ends of \
         constant tension and by 10 to 19 % with fixed ones, that of the thesis by 22 %"
            .to_owned()
    } else if scene.model.has(Reduction::Linearised) {
        "linearised about the static state, asked for by model.reduce: constant stiffness, unilateral droppers and contact; that moves \
         the force of EN 50318 lines by 0.5 to 1.4 % of its standard deviation, that of the thesis by 4 %, on other lines only a run \
         without it tells"
            .to_owned()
    } else {
        "nonlinear: how far the line linearised about its static state would be from it is known from a run of both only, so that \
         model.reduce = \"auto\" does not choose it"
            .to_owned()
    }
}

/// How somebody else's pantograph comes to its start.
fn third_party_start(initialise: Initialise, standstill: Option<Standstill>, start: Start) -> String {
    let Start { height, force } = start;
    match (initialise, standstill) {
        (Initialise::AsGiven, _) => format!("it starts at {height:.4} m as initialised"),
        (Initialise::Equilibrium, None) => {
            format!("initialised at {height:.4} m, it comes to rest at standstill before a run")
        }
        (Initialise::Equilibrium, Some(found)) => {
            format!("at {height:.4} m and {force:.2} N {}", at_rest(found, force > 0.0))
        }
    }
}

/// Elements per wave for an error of the filtered force of about one percent of its standard deviation, from convergence
/// studies of tensioned beams with cubic elements: 0.8 m for 1.9 m.
pub(crate) const FINE: f64 = 0.42;

/// What a mesh with elements up to `longest` m can resolve: a force of frequency `f` that moves with `v` sends waves of length
/// `(c − v)/f` ahead, which is where a mesh fails first.
fn mesh_note(longest: f64, c: f64, v: f64, f: f64) -> Option<String> {
    let wave = (c - v) / f;
    if wave <= 0.0 {
        return Some(format!(
            "the train is faster than the waves of the contact wire ({v:.1} m/s, {c:.1} m/s): no mesh resolves the waves ahead of it"
        ));
    }
    let ratio = longest / wave;
    let waves = format!(
        "elements up to {longest:.2} m for waves of {wave:.2} m that a {f} Hz force sends ahead of the pantograph"
    );
    if ratio > 1.0 {
        Some(format!(
            "this mesh is far from converged: {waves}; the filtered force may be wrong by more than its own standard deviation"
        ))
    } else if ratio > FINE {
        Some(format!(
            "this mesh is not converged: {waves}; the filtered force is wrong by several percent of its standard deviation"
        ))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_judged_by_the_waves_ahead_of_the_pantograph() {
        // 9 elements per span of 56.25 m at 200 km/h: waves of 3.4 m.
        assert!(
            mesh_note(6.25, 124.5, 55.56, 20.0)
                .unwrap()
                .contains("far from converged")
        );
        assert!(mesh_note(1.08, 121.7, 83.33, 20.0).unwrap().contains("several percent"));
        assert_eq!(mesh_note(0.7, 121.7, 69.44, 20.0), None);
        assert!(
            mesh_note(0.7, 100.0, 120.0, 20.0)
                .unwrap()
                .contains("faster than the waves")
        );
    }
}
