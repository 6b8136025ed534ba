//! Controllers of pantographs in words: what they do, how stable they are, what their drives did.

use std::fmt::Write as _;

use catenary::StaticLine;
use control::{FEWEST_SAMPLES, LinearParts, NoGains, SampledLoop};
use cosim::chain;
use dynamics::OutsideError;
use results::statistics::ForceStatistics;
use results::{Evaluation, Part, Record};
use scene::{Control, ControlLaw, Lumped, PantographModel, Scene};
use suppliers::SuppliedController;

/// Part of the limit from which on a drive is at it.
const AT_LIMIT: f64 = 0.999;

/// Part of the time at its limit from which on a drive does not follow its controller.
const MOSTLY: f64 = 0.5;

/// Desired contact force of a trial at least, N.
const LEAST_FORCE: f64 = 1.0;

/// Delays beyond those of the scene, in samples, below which a loop is close to instability.
const CLOSE: f64 = 1.0;

/// Every controlled pantograph (from 0) with its controller.
fn all(scene: &Scene) -> impl Iterator<Item = (usize, &Control)> {
    let pantographs = scene.pantographs.iter().enumerate();
    pantographs.filter_map(|(index, pantograph)| Some((index, pantograph.control.as_ref()?)))
}

/// The controllers as a part of the model; none where nothing is controlled.
pub(crate) fn part(scene: &Scene) -> Option<Part> {
    let described: Vec<String> = all(scene)
        .map(|(index, control)| format!("pantograph {}: {}", index + 1, described(scene, index, control)))
        .collect();
    (!described.is_empty()).then(|| Part {
        part: "control".to_owned(),
        modelled: true,
        reason: described.join("; "),
    })
}

fn described(scene: &Scene, index: usize, control: &Control) -> String {
    let rule = match control.law {
        ControlLaw::Pid { .. } => "PID on the contact force".to_owned(),
        ControlLaw::Lqr { .. } => "linear-quadratic regulator".to_owned(),
        ControlLaw::Skyhook { .. } => "skyhook damper".to_owned(),
        ControlLaw::Given => match scene.controller_of(index) {
            Some((_, controller)) => format!("commands from FMU {}", controller.side.fmu),
            None => "commands from outside".to_owned(),
        },
    };
    let actuator = &control.actuator;
    let place = match (actuator.mass, &actuator.joint) {
        (Some(mass), _) => format!(" on mass {mass}"),
        (_, Some(joint)) => format!(" on joint {joint}"),
        (None, None) => String::new(),
    };
    let mut text = format!("{rule} every {} ms; drive{place}", 1e3 * control.sample_time);
    let delay = control.delay();
    // Writing into a String does not fail.
    for (name, value) in [("lag", actuator.lag), ("delay", delay)] {
        if value > 0.0 {
            let _ = write!(text, ", {name} {} ms", 1e3 * value);
        }
    }
    for (value, per) in [(actuator.limit, ""), (actuator.rate_limit, "/s")] {
        if let Some(value) = value {
            let _ = write!(text, ", at most {value} {}{per}", actuator.unit());
        }
    }
    text
}

/// Remarks on the stability of the loops by linear theory: the pantograph without friction and stops, a linkage about
/// its start on a base that stands still, on a wire of the static stiffness at the first support and in the middle of
/// the evaluated span `span` (from 1).
///
/// The rule of a controller FMU is found by trials, where the FMU is in `controllers`, one place for each pantograph: a
/// run has taken it.
pub(crate) fn foreseen(
    scene: &Scene,
    statics: Option<&StaticLine>,
    span: usize,
    controllers: &mut [Option<SuppliedController>],
) -> Vec<String> {
    // Found once, for the loops that linear theory can say something on.
    let mut known = None;
    let mut stiffnesses = || *known.get_or_insert_with(|| static_stiffnesses(scene, statics, span));
    let remarks = all(scene).filter_map(|(index, control)| {
        let plant = || match &scene.pantographs[index].model {
            PantographModel::Lumped(lumped) => Ok(Plant::Chain(lumped)),
            PantographModel::Linkage(_) => vehicle::PantographModel::linearised(scene, index)
                .map(|parts| parts.map_or(Plant::Unknown, Plant::Linear))
                .map_err(|error| chain(&error)),
            PantographModel::Supplied(_) => Ok(Plant::Unknown),
        };
        if let Some((number, _)) = scene.controller_of(index) {
            let controller = controllers.get_mut(index).and_then(Option::as_mut);
            let tried = controller.and_then(|controller| Some((controller, plant().ok()?)));
            let Some((controller, plant)) = tried else {
                return Some(not_foreseen(index, number, control));
            };
            return Some(match tried_rule(scene, index, &plant, stiffnesses()?, controller) {
                Ok(Some([margin, stiffness])) => asked_in_words((index, number), control, margin, stiffness),
                Ok(None) => not_foreseen(index, number, control),
                Err(error) => format!("{}; its trial: {}", not_foreseen(index, number, control), chain(&error)),
            });
        }
        if control.law == ControlLaw::Given {
            return None;
        }
        match plant() {
            Ok(plant) => remark(index, control, &plant, &mut stiffnesses),
            Err(reason) => Some(format!(
                "pantograph[{}].control: the delay that the loop bears is not told, for linear theory needs a linkage \
                 of one motion: {reason}",
                index + 1
            )),
        }
    });
    remarks.collect()
}

/// A pantograph for linear theory.
enum Plant<'a> {
    /// Chain of masses.
    Chain(&'a Lumped),
    /// Linkage about its start.
    Linear(LinearParts),
    /// Nothing to control.
    Unknown,
}

impl Plant<'_> {
    /// Loop on a wire of `stiffness` N/m.
    fn in_loop(&self, control: &Control, stiffness: f64) -> Result<SampledLoop, NoGains> {
        match self {
            Self::Chain(lumped) => SampledLoop::new(control, lumped, stiffness),
            Self::Linear(parts) => SampledLoop::of(control, parts, stiffness),
            Self::Unknown => Err(NoGains),
        }
    }
}

/// Least and largest static stiffness of the line at a support and in the middle of a span, N/m. The support is the
/// left one, but for the first span, whose left end may be held.
fn static_stiffnesses(scene: &Scene, statics: Option<&StaticLine>, span: usize) -> Option<[f64; 2]> {
    let (catenary, _) = scene.modelled_line()?;
    let (left, right) = (catenary.support_x(span - 1), catenary.support_x(span));
    let support = if span == 1 { right } else { left };
    let elasticity = statics?.elasticity(&[support, 0.5 * (left + right)]).ok()?;
    let stiffnesses = elasticity.iter().map(|point| 1.0 / point.elasticity);
    Some(
        stiffnesses.fold([f64::INFINITY, 0.0], |[least, most]: [f64; 2], stiffness| {
            [least.min(stiffness), most.max(stiffness)]
        }),
    )
}

/// Remark on a loop whose rule is that of an FMU, and is not tried.
fn not_foreseen(index: usize, number: usize, control: &Control) -> String {
    format!(
        "pantograph[{0}].control: linear theory does not know the rule of controller[{1}], so that the delay that its \
         loop bears is not told here: master check tries it where the run has {FEWEST_SAMPLES} samples or more, on a \
         lumped pantograph or a linkage of one motion, and runs with a longer pantograph[{0}].control.sensors.delay \
         find where the force of the drive runs away; it has {2:.1} ms",
        index + 1,
        number + 1,
        1e3 * control.delay()
    )
}

/// Delay that a loop with a controller FMU bears on the softer and the stiffer wire, s, the smaller one first with its
/// stiffness; none where the run is too short for a trial.
fn tried_rule(
    scene: &Scene,
    index: usize,
    plant: &Plant<'_>,
    stiffnesses: [f64; 2],
    controller: &mut SuppliedController,
) -> Result<Option<[f64; 2]>, OutsideError> {
    let pantograph = &scene.pantographs[index];
    let Some(control) = &pantograph.control else {
        return Ok(None);
    };
    let start = pantograph.start.map(|start| start.force);
    let desired = control.force.or(start).unwrap_or_default().max(LEAST_FORCE);
    let samples = (scene.run.duration / control.sample_time).floor() as usize;
    controller.keep_history().map_err(OutsideError::new)?;
    let mut least = [f64::INFINITY, stiffnesses[0]];
    for stiffness in stiffnesses {
        let of_loop = plant.in_loop(control, stiffness).map_err(OutsideError::new)?;
        match of_loop.delay_margin_of(controller, desired, samples)? {
            Some(margin) if margin < least[0] => least = [margin, stiffness],
            Some(_) => {}
            None => return Ok(None),
        }
    }
    Ok(Some(least))
}

/// Remark on the margin that trials of a controller FMU have found, s, least on a wire of `stiffness` N/m.
fn asked_in_words((index, number): (usize, usize), control: &Control, margin: f64, stiffness: f64) -> String {
    let (path, controller) = (
        format!("pantograph[{}].control", index + 1),
        format!("controller[{}]", number + 1),
    );
    let tried = format!("tried on the linear pantograph, the loop with {controller}");
    let delay = 1e3 * control.delay();
    if margin.is_infinite() {
        return format!("{path}: {tried} is stable with delays of up to eight samples; it has {delay:.1} ms");
    }
    if margin <= control.delay() {
        return format!(
            "{path}: {tried} is unstable on a wire of {stiffness:.0} N/m, the static stiffness of the line, from a \
             delay of {:.1} ms on, and it has {delay:.1} ms; smaller gains, shorter delays or a shorter sample_time \
             make it stable",
            1e3 * margin
        );
    }
    format!(
        "{path}: {tried} is stable up to a delay of {:.1} ms on a wire of {stiffness:.0} N/m, the static stiffness of \
         the line without its inertia; it has {delay:.1} ms",
        1e3 * margin
    )
}

fn remark(
    index: usize,
    control: &Control,
    plant: &Plant<'_>,
    stiffnesses: &mut dyn FnMut() -> Option<[f64; 2]>,
) -> Option<String> {
    let stiffnesses = stiffnesses()?;
    let margins = stiffnesses.map(|stiffness| {
        let found = plant.in_loop(control, stiffness).ok();
        found.map(|found| (found.spectral_radius(), found.delay_margin(), stiffness))
    });
    let worst = margins.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let least = margins.into_iter().flatten().map(|(_, margin, _)| margin);
    let least = least.fold(f64::INFINITY, f64::min);
    let delay = control.delay();
    let path = format!("pantograph[{}].control", index + 1);
    let (radius, _, stiffness) = worst;
    if radius >= 1.0 {
        return Some(format!(
            "{path}: the loop is unstable by linear theory on a wire of {stiffness:.0} N/m, the static stiffness of \
             the line: a motion grows by {:.1} % from sample to sample; smaller gains, shorter delays or a shorter \
             sample_time make it stable",
            100.0 * (radius - 1.0)
        ));
    }
    let margin = if least.is_finite() {
        format!("up to a delay of {:.1} ms", 1e3 * least)
    } else {
        "whatever the delay".to_owned()
    };
    let close = if least - delay < CLOSE * control.sample_time {
        ", closer than one sample"
    } else {
        ""
    };
    Some(format!(
        "{path}: the loop is stable by linear theory on wires of {:.0} to {:.0} N/m, the static stiffness of the line \
         without its inertia, {margin}; it has {:.1} ms{close}",
        stiffnesses[0],
        stiffnesses[1],
        1e3 * delay
    ))
}

/// Remarks on what the drives did in the evaluated time.
pub(crate) fn remarks(scene: &Scene, evaluation: &Evaluation, record: &Record) -> Vec<String> {
    let drives = all(scene).filter_map(|(index, control)| {
        let pantograph = record.pantographs.get(index)?;
        let samples = evaluation.samples(&record.time, index);
        let forces = pantograph.control.as_ref()?.get(samples.clone())?;
        let drive = ForceStatistics::of(forces)?;
        let contact = ForceStatistics::of(pantograph.force.get(samples)?)?;
        let rms = drive.mean.hypot(drive.std);
        let largest = drive.max.abs().max(drive.min.abs());
        let at_limit = control.actuator.limit.map_or(0.0, |limit| {
            let at = forces.iter().filter(|force| force.abs() >= AT_LIMIT * limit);
            at.count() as f64 / forces.len() as f64
        });
        // A moment has no measure in the contact force.
        let unit = control.actuator.unit();
        let exceeds = rms > contact.mean && control.actuator.joint.is_none();
        let away = if exceeds || at_limit > MOSTLY {
            "; the loop of controller, pantograph and line has run away: it needs smaller gains, shorter delays or a \
             shorter sample_time"
        } else {
            ""
        };
        let bound = if at_limit > 0.0 {
            format!("; at its limit {:.1} % of the time", 100.0 * at_limit)
        } else {
            String::new()
        };
        Some(format!(
            "pantograph {}: force of the controlled drive {rms:.1} {unit} rms, at most {largest:.1} \
             {unit}{bound}{away}",
            index + 1
        ))
    });
    drives.collect()
}
