//! Report of `master check` on a scene.

use std::fmt::Write as _;

use catenary::{BlowOffReport, StaticsReport};
use serde::Serialize;

use crate::{Other, Prepared, SetupError, evaluated_spans, line_of};
use crate::{check_page, horns, strip_overrun};
use results::Model;
use results::standards::{Limit, limits_at_rest};
use scene::{Catenary, Scene};
use system::galloping::{Criterion, criteria};

/// Statics, model and waves of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Result of the statics with the elasticity of the evaluated spans; none for a supplied line.
    pub statics: Option<StaticsReport>,
    /// The model.
    pub model: Model,
    /// Waves on the contact wire; nothing of a supplied line.
    pub waves: Option<Waves>,
    /// Contact wire in the mean wind, span by span; empty without wind on the wires.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub blow_off: Vec<BlowOffReport>,
    /// Wires that may gallop; empty without tables of drag and lift.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub galloping: Vec<Criterion>,
    /// Limits that the line at rest is held against; none for a supplied line.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<Limit>,
    /// Start of each pantograph.
    pub start: Vec<StartReport>,
    /// supplied FMUs.
    pub others: Vec<Other>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// Waves on the contact wire.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Waves {
    /// Transverse wave speed, m/s.
    #[serde(rename = "contact_wire_m_per_s")]
    pub contact_wire: f64,
    /// Running speed / wave speed, –.
    pub speed_ratio: f64,
}

/// State of a pantograph at t = 0.
#[derive(Clone, Debug, Serialize)]
pub struct StartReport {
    /// m.
    #[serde(rename = "x_m")]
    pub x: f64,
    /// m.
    #[serde(rename = "height_m")]
    pub height: f64,
    /// N.
    #[serde(rename = "force_N")]
    pub force: f64,
    /// Strips of a head with several; empty for one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub strips: Vec<StartReport>,
}

/// Starts of the strips of pantograph `index` (from 0), where its head has several.
fn strips_at_start(scene: &Scene, index: usize) -> Vec<StartReport> {
    if !scene.pantographs[index].has_several_strips() {
        return Vec::new();
    }
    let starts = scene.strips_of(index).filter_map(|strip| {
        let start = scene.strip_start(strip)?;
        Some(StartReport {
            x: scene.strip_start_x(strip),
            height: start.height,
            force: start.force,
            strips: Vec::new(),
        })
    });
    starts.collect()
}

/// Largest lateral position of the contact wire in the mean wind in the evaluated spans, m, with the width of the
/// narrowest strip, m; none without wind on the wires.
fn lateral_deviation(scene: &Scene, blow_off: &[BlowOffReport]) -> Option<(f64, Option<f64>)> {
    let (first, last) = evaluated_spans(scene);
    let spans = blow_off.iter().filter(|report| (first..=last).contains(&report.span));
    let largest = spans.map(|report| report.lateral.abs()).reduce(f64::max)?;
    let widths = scene.pantographs.iter().filter_map(scene::Pantograph::strip_width);
    Some((largest, widths.reduce(f64::min)))
}

/// Limits of the line at rest.
fn limits_of(scene: &Scene, line: &Catenary, statics: &StaticsReport, blow_off: &[BlowOffReport]) -> Vec<Limit> {
    let slopes = check_page::used_gradients(line, statics);
    let gradient = slopes.iter().filter_map(|(gradient, _)| *gradient).map(f64::abs);
    let change = slopes.iter().filter_map(|(_, change)| *change).map(f64::abs);
    let (gradient, change) = (gradient.reduce(f64::max), change.reduce(f64::max));
    limits_at_rest(
        &line_of(scene),
        (scene.run.speed, scene.pantographs.len()),
        (gradient, change),
        lateral_deviation(scene, blow_off),
        &scene.assessment,
    )
}

impl Report {
    /// Collects it.
    ///
    /// # Errors
    /// The elasticity cannot be solved.
    pub fn of(prepared: &Prepared) -> Result<Self, SetupError> {
        let scene = &prepared.scene;
        let (first, last) = evaluated_spans(scene);
        let statics = match &prepared.statics {
            None => None,
            Some(line) => {
                let mut statics = line.report().clone();
                let points = line.elasticity_points(first, last);
                statics.elasticity = line.elasticity(&points).map_err(catenary::CatenaryError::from)?;
                Some(statics)
            }
        };
        let waves = scene.modelled_line().map(|(catenary, _)| {
            let contact_wire = catenary.contact_wire.wave_speed();
            Waves {
                contact_wire,
                speed_ratio: scene.run.speed / contact_wire,
            }
        });
        let starts = scene.pantographs.iter().enumerate().filter_map(|(index, pantograph)| {
            let start = pantograph.start?;
            Some(StartReport {
                x: scene.head_start_x(index),
                height: start.height,
                force: start.force,
                strips: strips_at_start(scene, index),
            })
        });
        let blow_off = match &prepared.statics {
            Some(line) => line.blow_off().map_err(catenary::CatenaryError::from)?,
            None => Vec::new(),
        };
        let limits = match (&statics, scene.modelled_line()) {
            (Some(statics), Some((line, _))) => limits_of(scene, line, statics, &blow_off),
            _ => Vec::new(),
        };
        Ok(Self {
            limits,
            blow_off,
            galloping: criteria(scene),
            statics,
            model: prepared.model(),
            waves,
            start: starts.collect(),
            others: prepared.others.clone(),
            notes: (prepared.notes(prepared.scene.internal_step()).into_iter())
                .chain(strip_overrun::foreseen(scene))
                .chain(horns::foreseen(scene))
                .collect(),
        })
    }

    /// The report as text.
    #[must_use]
    pub fn text(&self, prepared: &Prepared) -> String {
        let mut text = String::new();
        // Writing into a String does not fail.
        let _ = self.write(prepared, &mut text);
        text
    }

    fn write(&self, prepared: &Prepared, out: &mut String) -> std::fmt::Result {
        let scene = &prepared.scene;
        writeln!(out, "{}: {}", prepared.name, scene.title)?;
        match &self.statics {
            Some(statics) => self.write_statics(statics, scene, out)?,
            None => writeln!(out, "\nstatics: none, the line is a supplied FMU")?,
        }
        writeln!(out, "\nstart")?;
        for (index, start) in self.start.iter().enumerate() {
            writeln!(
                out,
                "  pantograph {}: x = {:.3} m, height {:.6} m, force {:.3} N",
                index + 1,
                start.x,
                start.height,
                start.force
            )?;
            for (number, strip) in (1..).zip(&start.strips) {
                let StartReport { x, height, force, .. } = strip;
                writeln!(
                    out,
                    "    strip {number}: x = {x:.3} m, height {height:.6} m, force {force:.3} N"
                )?;
            }
        }
        let model = &self.model;
        writeln!(
            out,
            "\nmodelled: {} coordinates, {} constraints, {} elements, reductions: {}",
            model.coordinates,
            model.constraints,
            model.elements,
            if model.reductions.is_empty() {
                "none".to_owned()
            } else {
                model.reductions.join(", ")
            }
        )?;
        for part in &model.parts {
            writeln!(
                out,
                "  {} {:16} {}",
                if part.modelled { "+" } else { "-" },
                part.part,
                part.reason
            )?;
        }
        for other in &self.others {
            writeln!(out, "\n{}: {}", other.name, other.fmu)?;
            for wire in &other.wiring {
                writeln!(out, "  {wire}")?;
            }
        }
        for note in &self.notes {
            writeln!(out, "note: {note}")?;
        }
        Ok(())
    }

    /// The line in the mean wind.
    fn write_wind(&self, length: &dyn Fn(usize) -> String, head: &str, out: &mut String) -> std::fmt::Result {
        if !self.blow_off.is_empty() {
            writeln!(
                out,
                "\ncontact wire in the mean wind\n{head}  span        x [m]   lateral position [m]   displaced by [m]"
            )?;
        }
        for span in &self.blow_off {
            writeln!(
                out,
                "{}  {:4} {:12.3} {:22.4} {:18.4}",
                length(span.tension_length),
                span.span,
                span.x,
                span.lateral,
                span.displacement
            )?;
        }
        for line in crate::galloping::criteria_in_words(&self.galloping) {
            writeln!(out, "  galloping: {line}")?;
        }
        Ok(())
    }

    fn write_statics(&self, statics: &StaticsReport, scene: &Scene, out: &mut String) -> std::fmt::Result {
        let (first, last) = evaluated_spans(scene);
        writeln!(
            out,
            "\nstatics: {} iterations, residual {:.1e} N",
            statics.iterations, statics.residual
        )?;
        let tension = &statics.tension;
        let line = scene.modelled_line().map(|(line, _)| line);
        let messenger = match line.is_some_and(|line| line.messenger_wire.is_some()) {
            true => format!(", messenger wire {:.1} N", tension.messenger_wire),
            false => String::new(),
        };
        writeln!(out, "  tension: contact wire {:.1} N{messenger}", tension.contact_wire)?;
        if let Some(waves) = &self.waves {
            writeln!(
                out,
                "  waves: {:.1} m/s on the contact wire, the train runs at {:.2} of that",
                waves.contact_wire, waves.speed_ratio
            )?;
        }
        let several = line.is_some_and(|line| line.tension_lengths.len() > 1);
        let length = |number: usize| {
            if several {
                format!("  {number:14}")
            } else {
                String::new()
            }
        };
        let head = if several { "  tension length" } else { "" };
        let (from, to) = line.map_or((0.0, 0.0), |line| (line.support_x(first - 1), line.support_x(last)));
        let evaluated = statics
            .droppers
            .iter()
            .filter(|dropper| (from..=to).contains(&dropper.x));
        if !statics.droppers.is_empty() {
            writeln!(
                out,
                "\ndroppers of spans {first} to {last}\n{head}  span        x [m]   length [m]    force [N]"
            )?;
        }
        for dropper in evaluated {
            writeln!(
                out,
                "{}  {:4} {:12.3} {:12.6} {:12.3}",
                length(dropper.tension_length),
                dropper.span,
                dropper.x,
                dropper.length,
                dropper.force
            )?;
        }
        writeln!(
            out,
            "\nsupports\n{head}     x [m]   messenger [N]     arm [N]   contact wire z [m]"
        )?;
        for support in &statics.supports {
            writeln!(
                out,
                "{}{:10.3} {:15.3} {:11.3} {:20.6}",
                length(support.tension_length),
                support.x,
                support.messenger_reaction,
                support.arm_force,
                support.contact_wire_z
            )?;
        }
        if !statics.ends.is_empty() {
            writeln!(
                out,
                "\nends of the wires after the change\n{head}     x [m]   wire             travel [m]   weights [m]   \
                 tension [N]   held by"
            )?;
        }
        for end in &statics.ends {
            writeln!(
                out,
                "{}{:10.3}   {:14} {:12.4} {:13.4} {:13.1}   {}",
                length(end.tension_length),
                end.x,
                end.wire.kind().words(),
                end.travel,
                end.weights,
                end.tension,
                end.held_by
            )?;
        }
        self.write_wind(&length, head, out)?;
        writeln!(out, "\nelasticity under 100 N\n     x [m]   rise [mm/N]")?;
        for point in &statics.elasticity {
            writeln!(out, "{:10.3} {:13.4}", point.x, 1e3 * point.elasticity)?;
        }
        Ok(())
    }
}
