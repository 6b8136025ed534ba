//! Model of a scene: parts, parts left out with the reason, worth of the results.

use std::sync::PoisonError;

use catenary::{WindowSize, WindowedLine};
use scene::{Initialise, Lumped, PantographModel, Reduction, Start};

use crate::Prepared;
use crate::{accuracy, controlled, mesh, rest_position, sliding_joint};
use results::{Model, Part};
use suppliers::settling::{self, Settling};

mod track;

impl Prepared {
    /// Parts modelled and left out, with reasons.
    #[must_use]
    pub fn model(&self) -> Model {
        let scene = &self.scene;
        let window = self.window();
        let mut coordinates = match (&self.statics, window) {
            (_, Some(window)) => window.coordinates,
            (Some(statics), None) => statics.coordinates(),
            (None, None) => 0,
        };
        // A joint is one equation per strip.
        let mut constraints = if sliding_joint::holds(scene) {
            scene.strip_count()
        } else {
            0
        };
        let (mut kinds, mut bases, mut steady) = (Vec::new(), Vec::new(), true);
        for (index, pantograph) in scene.pantographs.iter().enumerate() {
            let placement = vehicle::Placement::of_scene(scene, index);
            let mut layout = dynamics::Layout::new();
            if let Ok(model) = vehicle::PantographModel::new(&pantograph.model, placement, "", &mut layout) {
                coordinates += model.coordinates();
                constraints += model.constraint_count();
                bases.push(model.base().start_x);
                if let (Some(scene::Vehicle::Full(_)), Some(start)) = (scene.vehicle.as_deref(), pantograph.start) {
                    let rest = model.equilibrium_at_height(start.height);
                    steady &= rest.is_ok_and(|rest| rest.rolls_steadily());
                }
            }
            kinds.push(match &pantograph.model {
                PantographModel::Lumped(lumped) => format!("lumped, {} masses{}", lumped.masses.len(), head(lumped)),
                PantographModel::Linkage(linkage) => {
                    format!("linkage of {} bodies{}", linkage.bodies.len(), motions(scene))
                }
                PantographModel::Supplied(entry) => format!("FMU {}", entry.fmu),
            });
        }
        let statics = self.statics.as_deref();
        let elements = statics.map_or(0, catenary::StaticLine::elements);
        let elements = window.map_or(elements, |window| window.elements);
        let line = match &scene.catenary {
            scene::Line::Supplied(entry) => format!("FMU {}", entry.fmu),
            scene::Line::Modelled(line) => format!(
                "{elements} cable elements in {}, {} spans; mesh: {}; {}; {}{}",
                wires(line),
                statics.map_or(0, |_| line.spans()),
                mesh::described(scene),
                dimension(scene),
                motion(scene),
                window.map_or_else(String::new, |window| format!("; {}", around(scene, window)))
            ),
        };
        let mut parts = vec![
            part("catenary", true, line),
            part("pantograph", true, kinds.join("; ")),
            vehicle(scene),
            wheel_rail(scene, steady),
            track::track(scene, &bases),
            wind_part("wind_pantograph", wind_on_pantograph(scene)),
            wind_part("wind_wires", wind_on_wires(scene)),
        ];
        parts.extend(controlled::part(scene));
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
            parts,
        }
    }

    /// Size of the window of the line, where it has one.
    fn window(&self) -> Option<WindowSize> {
        let statics = self.statics.as_ref()?;
        let asked = self.scene.model.has(Reduction::Window);
        asked.then(|| WindowedLine::size(&self.scene, statics))
    }

    /// Remarks on what the results of internal steps of `step` s are worth.
    #[must_use]
    pub fn notes(&self, step: f64) -> Vec<String> {
        let mut notes = self.scene.questions();
        notes.extend(mesh::expected_error(&self.scene, step));
        notes.extend(accuracy::remark(&self.scene));
        notes.extend(rest_position::warnings(self));
        if self.statics.as_ref().is_some_and(|line| line.ends_are_held()) {
            notes.push(
                "catenary.tensioning: friction or a stop holds the ends of the wires where they are while \
                 pantographs pass"
                    .to_owned(),
            );
        }
        let (span, _) = crate::evaluated_spans(&self.scene);
        let mut controllers = self.controllers.lock().unwrap_or_else(PoisonError::into_inner);
        let statics = self.statics.as_deref();
        notes.extend(controlled::foreseen(&self.scene, statics, span, &mut controllers));
        for (index, pantograph) in self.scene.pantographs.iter().enumerate() {
            if let (PantographModel::Supplied(_), Some(start)) = (&pantograph.model, pantograph.start) {
                notes.push(format!(
                    "pantograph {}: supplied FMU; the work on its strip and with it the energy residual is an \
                     estimate; {}",
                    index + 1,
                    supplied_start(self.scene.run.initialise, self.settling, start)
                ));
            }
        }
        if let scene::Line::Supplied(_) = self.scene.catenary {
            notes.push(format!(
                "line: supplied FMU; its work and with it the energy residual is an estimate where it does \
                 not offer it{}",
                self.settling
                    .map_or_else(String::new, |found| format!("; {}", at_rest(found, true)))
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

fn part(part: &str, modelled: bool, reason: String) -> Part {
    Part {
        part: part.to_owned(),
        modelled,
        reason,
    }
}

/// Vehicle under the pantographs.
fn vehicle(scene: &scene::Scene) -> Part {
    let bodies = |train: &scene::Train| {
        let places = |lists: &mut dyn Iterator<Item = &Vec<[f64; 3]>>| -> usize { lists.map(Vec::len).sum() };
        format!(
            "{} bodies, {} bushings, {} bearings, {} revolute joints",
            train.body_count(),
            places(&mut train.bushings.iter().map(|entry| &entry.points)),
            places(&mut train.bearings.iter().map(|entry| &entry.points)),
            places(&mut train.joints.iter().map(|entry| &entry.points)),
        )
    };
    const SPEED: &str = "the carrying body keeps the speed of the run; each pantograph has a vehicle of its own";
    match scene.vehicle.as_deref() {
        None => part(
            "vehicle",
            false,
            "scene has no [vehicle]: the base moves on a straight line".to_owned(),
        ),
        Some(scene::Vehicle::RigidMotion(motion)) => part(
            "vehicle",
            true,
            format!(
                "the base moves as given by {} samples; of a lumped pantograph its rise alone is felt, and nothing \
                 acts back on it",
                motion.time.len()
            ),
        ),
        Some(scene::Vehicle::Vertical(train)) => part(
            "vehicle",
            true,
            format!(
                "vertical: {} in the plane along the track; lateral motion, roll and yaw are left out; {SPEED}",
                bodies(train)
            ),
        ),
        Some(scene::Vehicle::Full(train)) => {
            part("vehicle", true, format!("full: {} in space; {SPEED}", bodies(train)))
        }
    }
}

/// Contact of wheels and rails; `steady` where wheels start rolling steadily.
fn wheel_rail(scene: &scene::Scene, steady: bool) -> Part {
    match scene.vehicle.as_deref() {
        None => part("wheel_rail", false, "scene has no [vehicle]".to_owned()),
        Some(scene::Vehicle::RigidMotion(_)) => part(
            "wheel_rail",
            false,
            "the motion of the base is given: no wheel is modelled".to_owned(),
        ),
        Some(scene::Vehicle::Vertical(_)) => part(
            "wheel_rail",
            false,
            "vertical vehicle: linear springs in place of the contacts, no profiles and no creep forces".to_owned(),
        ),
        Some(scene::Vehicle::Full(_)) => {
            let start = if steady {
                ""
            } else {
                "; they do not roll steadily where they start, and begin from rest without creep forces: the first \
                 moments are those of \
                 a vehicle that settles"
            };
            part("wheel_rail", true, format!("wheels roll on rails{start}"))
        }
    }
}

/// A part that the wind may act on; without a reason it does not.
fn wind_part(name: &str, acts: Result<String, String>) -> Part {
    part(name, acts.is_ok(), acts.unwrap_or_else(|reason| reason))
}

/// How the wind blows.
fn blowing(wind: &scene::Wind) -> String {
    let parts = [
        (wind.gust.is_some(), "a gust"),
        (wind.turbulence.is_some(), "seeded turbulence"),
        (!wind.record.is_empty(), "a record"),
    ];
    let more: Vec<&str> = parts
        .iter()
        .filter(|(there, _)| *there)
        .map(|(_, part)| *part)
        .collect();
    let mean = format!("{} m/s from {}° of the direction of travel", wind.speed, wind.yaw_deg);
    if more.is_empty() {
        mean
    } else {
        format!("{mean} with {}", more.join(", "))
    }
}

/// Effect of the wind on pantographs, or the reason for none.
fn wind_on_pantograph(scene: &scene::Scene) -> Result<String, String> {
    let wind = scene.wind.as_ref().ok_or("scene has no [wind]")?;
    let acts = wind.pantograph.as_ref().ok_or("scene has no wind.pantograph")?;
    let mut how = if acts.surfaces.is_empty() {
        "uplift of the strip by the square of the air's speed along the track".to_owned()
    } else {
        let points: usize = acts.surfaces.iter().map(|surface| surface.markers.len().max(1)).sum();
        format!("drag and lift at {points} points of {} bodies", acts.surfaces.len())
    };
    let foreign = |pantograph: &scene::Pantograph| matches!(pantograph.model, PantographModel::Supplied(_));
    if scene.pantographs.iter().any(foreign) {
        how.push_str("; none on supplied FMUs");
    }
    Ok(format!("{how}; {}", blowing(wind)))
}

/// Effect of the wind on wires, or the reason for none.
fn wind_on_wires(scene: &scene::Scene) -> Result<String, String> {
    let wind = scene.wind.as_ref().ok_or("scene has no [wind]")?;
    let wires = wind.wires.as_ref().ok_or("scene has no wind.wires")?;
    let polar = |there: bool, name: &str| there.then(|| name.to_owned());
    let lifted = [
        polar(wires.contact_wire_polar.is_some(), "contact wire"),
        polar(wires.messenger_wire_polar.is_some(), "messenger wire"),
    ];
    let lifted: Vec<String> = lifted.into_iter().flatten().collect();
    let lift = match lifted.is_empty() {
        true => String::new(),
        false => format!(", with lift by angle of attack on the {}", lifted.join(" and ")),
    };
    let parts = match (wires.dropper_diameter.is_some(), wires.registration_arm_drag_area > 0.0) {
        (true, true) => "drag on droppers and registration arms",
        (true, false) => "drag on droppers, none on registration arms",
        (false, true) => "drag on registration arms, none on droppers",
        (false, false) => "none on droppers and registration arms",
    };
    Ok(format!(
        "drag across the wires, spread over their elements{lift}; {parts}; the run starts with the line at rest in the \
         wind of t = 0; {}",
        blowing(wind)
    ))
}

/// The last part of a path.
fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// How a phase at rest went.
fn at_rest(found: Settling, in_contact: bool) -> String {
    let Settling {
        duration,
        steps,
        change,
    } = found;
    let rest = if change < settling::REST && in_contact {
        "came to rest"
    } else {
        "did not come to rest"
    };
    format!(
        "it {rest} in {duration:.1} s ({steps} steps) while settling before t = 0, a change of {change:.2e} N/s \
         being left; its \
         clock is ahead by that time"
    )
}

/// Which coordinates the line has, and why.
fn dimension(scene: &scene::Scene) -> String {
    if scene.is_planar() {
        return match scene.leaves_its_plane() {
            None => {
                "planar: nothing pushes it sideways, so leaving out the lateral coordinates changes nothing".to_owned()
            }
            Some(reason) => format!(
                "planar, although {reason}: its wires do not move sideways; accuracy has the expected error of that"
            ),
        };
    }
    let is_beam = |(line, _): &(&scene::Catenary, _)| line.mesh.element == scene::Element::Beam;
    let beam = scene.modelled_line().filter(is_beam);
    let beam = beam.map(|_| "catenary.mesh.element = \"beam\" turns and shears in all directions".to_owned());
    let reason = scene.leaves_its_plane().or(beam);
    format!(
        "spatial: {}",
        reason.unwrap_or_else(|| "asked for by model.reduce".to_owned())
    )
}

/// How the motions of a linkage are counted, and why.
fn motions(scene: &scene::Scene) -> String {
    if scene.model.has(Reduction::Linkage) {
        return " in two coordinates, its one motion and the collector suspension: its joints hold the strip in the \
            plane along the \
                track, so leaving out all other motions changes nothing"
            .to_owned();
    }
    let reason = scene.linkage_not_reducible();
    format!(
        " with all their joints: {}",
        reason.unwrap_or_else(|| "asked for by model.reduce".to_owned())
    )
}

/// Keys that a reduction which changes something comes from.
fn wished(scene: &scene::Scene) -> &'static str {
    match scene.run.accuracy {
        Some(_) => "by model.reduce or chosen for run.accuracy_percent",
        None => "asked for by model.reduce",
    }
}

/// Which law of motion the line has, and what is known of its distance from the line as it is.
fn motion(scene: &scene::Scene) -> String {
    if scene.model.has(Reduction::Modal) {
        format!(
            "in its own modes, {}: linear about the static state and exact in time, with unilateral droppers and \
             contact; modes beyond the frequencies that matter answer as if at rest; how far the linear line is from \
             the nonlinear one only a run without it tells",
            wished(scene)
        )
    } else if scene.model.has(Reduction::Flat) {
        "flat, asked for by model.reduce: straight wires that move up and down, for comparison with two-dimensional \
         programs; without the sag of the messenger wire it is another line, whose measured distance is in the \
         documentation of reductions"
            .to_owned()
    } else if scene.model.has(Reduction::Linearised) {
        format!(
            "linearised about the static state, {}: constant stiffness, unilateral droppers and contact; its expected \
             distance from the nonlinear line is the share `linearised` of the accuracy",
            wished(scene)
        )
    } else {
        "nonlinear: how far the line linearised about its static state would be from it is known from a run of both \
         only, so that \
         model.reduce = \"auto\" does not choose it"
            .to_owned()
    }
}

/// Effects that a window leaves out, and their cost.
fn around(scene: &scene::Scene, window: WindowSize) -> String {
    let WindowSize { full, reduced, .. } = window;
    format!(
        "window, {}: {full} spans around the pantographs in full; up to {reduced} spans beyond linear, with their \
         droppers taut, reduced to supports and modes. Measured error of the filtered force on corrected meshes, in \
         percent of its standard deviation: 0.2 linearised and 0.3 nonlinear on the lines of EN 50318, 0.2 \
         linearised and 0.5 nonlinear on that of the thesis (0.5 on the thesis' own coarse mesh), on 10 and 20 \
         spans; nonlinear it grows with the time run (32 spans of EN 50318: 0.7 over 20 s, 1.4 in the last two): \
         only a run without the window tells what it is elsewhere. Echoes of ends further away than those spans are \
         left out (linearised, middle of 80 spans, 20 s: 0.9 on EN 50318, 3.7 on the thesis' line)",
        wished(scene)
    )
}

/// Start of a supplied pantograph in words.
/// The wires of a line in words.
fn wires(line: &scene::Catenary) -> String {
    let mut text = match (line.contact_wire_spacing, &line.messenger_wire) {
        (None, Some(_)) => "two wires".to_owned(),
        (Some(_), Some(_)) => "a twin contact wire and a messenger wire".to_owned(),
        (None, None) => "a single wire".to_owned(),
        (Some(_), None) => "a twin contact wire".to_owned(),
    };
    if line.stitch_wires.is_some() {
        text.push_str(" and stitch wires");
    }
    match line.tension_lengths.len() {
        1 => text,
        count => format!("{text}, {count} tension lengths"),
    }
}

/// Strips of a head with several, and how they move on it.
fn head(lumped: &Lumped) -> String {
    let motion = match (lumped.strips.as_slice(), &lumped.pitch) {
        ([], _) => return String::new(),
        ([first, ..], _) if first.spring.is_some() => "on springs of their own",
        (_, Some(_)) => "on a head that pitches",
        _ => "fixed to the head",
    };
    let count = lumped.strips.len();
    format!(", {count} strip{} {motion}", if count == 1 { "" } else { "s" })
}

fn supplied_start(initialise: Initialise, settling: Option<Settling>, start: Start) -> String {
    let Start { height, force } = start;
    match (initialise, settling) {
        (Initialise::AsGiven, _) => format!("it starts at {height:.4} m as initialised"),
        (Initialise::Equilibrium, None) => {
            format!("initialised at {height:.4} m, it settles before a run")
        }
        (Initialise::Equilibrium, Some(found)) => {
            format!("at {height:.4} m and {force:.2} N {}", at_rest(found, force > 0.0))
        }
    }
}
