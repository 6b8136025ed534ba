//! Checks of a wind against the rest of the scene.
use super::{Wind, WindOnPantograph, WindOnWires, WindTurbulence};
use crate::check::{Found, refuse};
use crate::error::What;
use crate::write::shown_number;
use crate::{Catenary, Line, PantographModel, Reduction, Scene, WireKind};

/// Most numbers that a field of turbulence is tabulated in, steps times places.
const LARGEST_TABLE: usize = 4_000_000;

impl Scene {
    /// Part of the wind that pushes the wires sideways; `None` where nothing does.
    pub(crate) fn wind_pushes_sideways(&self) -> Option<String> {
        let wind = self.wind.as_ref()?;
        wind.wires.as_ref()?;
        let mean = wind.mean_velocity();
        // A wind of ±180° misses the track's line by rounding.
        if mean[1].abs() > 1e-12 * wind.speed {
            return Some(format!("wind.yaw_deg = {} pushes the wires sideways", wind.yaw_deg));
        }
        let gust = wind.gust.is_some_and(|gust| gust.velocity[1] != 0.0);
        let parts = [
            (gust, "gust"),
            (wind.turbulence.is_some(), "turbulence"),
            (wind.file.is_some(), "file"),
            (!wind.record.is_empty(), "record"),
        ];
        let part = parts.iter().find(|(there, _)| *there);
        part.map(|(_, part)| format!("wind.{part} pushes the wires sideways"))
    }

    /// Checks a wind against the rest of the scene.
    pub(crate) fn check_wind(&self, found: &mut Found) {
        let Some(wind) = &self.wind else { return };
        if let Some(turbulence) = &wind.turbulence {
            self.check_turbulence(wind, turbulence, found);
        }
        if let (Some(file), false) = (&wind.file, wind.record.is_empty()) {
            let expected = "must be left out: wind.record is given";
            refuse(found, "wind.file", format!("{file:?}"), expected);
        }
        if !wind.record.is_empty()
            && let Err(error) = dynamics::WindRecord::from_rows(&wind.record)
        {
            let rows = format!("[{} rows]", wind.record.len());
            refuse(found, "wind.record", rows, error.to_string());
        }
        if wind.wires.is_some() && matches!(self.catenary, Line::Supplied(_)) {
            let expected = "must be left out: the line is a supplied FMU";
            refuse(found, "wind.wires", "{ … }", expected);
        }
        if let (Some(wires), Line::Modelled(line)) = (&wind.wires, &self.catenary) {
            self.check_wires_in_wind(wires, line, found);
        }
        if let Some(on_pantograph) = &wind.pantograph {
            self.check_wind_on_pantograph(on_pantograph, found);
        }
    }

    fn check_wires_in_wind(&self, wires: &WindOnWires, line: &Catenary, found: &mut Found) {
        let kinds = [
            (WireKind::Contact, "contact_wire", true),
            (WireKind::Messenger, "messenger_wire", line.messenger_wire.is_some()),
        ];
        for (kind, name, there) in kinds {
            if there && self.diameter_in_wind(kind).is_none() {
                let expected = format!("the diameter in m, here or as catenary.{name}.diameter");
                found.push((format!("wind.wires.{name}_diameter"), What::Missing { expected }));
            }
            let Some(polar) = wires.polar(kind) else { continue };
            let key = format!("wind.wires.{name}_polar");
            if !there {
                let because = "the line has no messenger_wire".to_owned();
                found.push((key, What::LeaveOut { because }));
                continue;
            }
            let (first, last) = (polar.angles_deg[0], polar.angles_deg[polar.angles_deg.len() - 1]);
            for angle in self.angles_of_the_wind() {
                if !(first..=last).contains(&angle) {
                    let expected = format!(
                        "must hold {angle:.1}°, the angle of attack of the wind: the table ends at {first}° and {last}°"
                    );
                    refuse(
                        found,
                        format!("{key}.angles_deg"),
                        format!("{:?}°", polar.angles_deg),
                        expected,
                    );
                    break;
                }
            }
        }
    }

    fn check_turbulence(&self, wind: &Wind, turbulence: &WindTurbulence, found: &mut Found) {
        if wind.speed <= 0.0 {
            let expected = "must be positive with wind.turbulence, which is measured by it";
            refuse(found, "wind.speed", shown_number(wind.speed, "m/s"), expected);
        }
        let period = turbulence.steps as f64 * turbulence.time_step;
        if period < self.run.duration {
            let steps = (self.run.duration / turbulence.time_step).ceil().min(1e9) as usize;
            refuse(
                found,
                "wind.turbulence.steps",
                turbulence.steps.to_string(),
                format!(
                    "must be at least {}: the field would repeat itself after {period} s, within run.duration = {} s",
                    steps.next_power_of_two(),
                    self.run.duration
                ),
            );
        }
        let places = self.wind_stations(turbulence);
        if turbulence.steps.saturating_mul(places) > LARGEST_TABLE {
            let expected = format!(
                "must be longer: wind.turbulence.steps = {} times {places} places along the line are more than \
                 {LARGEST_TABLE}",
                turbulence.steps
            );
            refuse(
                found,
                "wind.turbulence.spacing",
                shown_number(turbulence.spacing, "m"),
                expected,
            );
        }
    }

    fn check_wind_on_pantograph(&self, wind: &WindOnPantograph, found: &mut Found) {
        let count = self.pantographs.len();
        if !wind.uplift.is_empty() && wind.uplift.len() != 1 && wind.uplift.len() != count {
            let expected = format!("must be one number, or {count} of them, one per pantograph");
            refuse(
                found,
                "wind.pantograph.uplift",
                format!("{:?} N/(m/s)²", wind.uplift),
                expected,
            );
        }
        let mut modelled = false;
        for (index, pantograph) in self.pantographs.iter().enumerate() {
            match &pantograph.model {
                PantographModel::Supplied(_) => {}
                PantographModel::Lumped(_) => {
                    modelled = true;
                    if !wind.surfaces.is_empty() {
                        let expected = format!(
                            "must be left out, and uplift given: pantograph[{}] is lumped and has no bodies",
                            index + 1
                        );
                        refuse(found, "wind.pantograph.surfaces", "[…]", expected);
                    }
                }
                PantographModel::Linkage(linkage) => {
                    modelled = true;
                    for (i, surface) in wind.surfaces.iter().enumerate() {
                        if linkage.body(&surface.body).is_none() {
                            let names: Vec<String> =
                                linkage.bodies.iter().map(|body| format!("{:?}", body.name)).collect();
                            let key = format!("wind.pantograph.surfaces[{}].body", i + 1);
                            let expected = format!("no such body: must be one of {}", names.join(", "));
                            refuse(found, key, format!("{:?}", surface.body), expected);
                        }
                    }
                }
            }
        }
        if !modelled {
            let expected = "must be left out: every pantograph is a supplied FMU";
            refuse(found, "wind.pantograph", "{ … }", expected);
        }
    }

    /// Why a reduction cannot be had with the wind on the wires.
    pub(crate) fn wind_forbids(&self, reduction: Reduction) -> Option<String> {
        self.wind.as_ref()?.wires.as_ref()?;
        match reduction {
            Reduction::Window => Some(
                "wind.wires acts on every span, and those beyond the window are known without wind only".to_owned(),
            ),
            Reduction::Flat => Some("wind.wires acts on wires as they hang, which \"flat\" leaves out".to_owned()),
            Reduction::Modal => Some(
                "wind.wires drags every element by its own speed, which the modes of the line in still air do not have"
                    .to_owned(),
            ),
            _ => None,
        }
    }
}
