//! Checks across keys: values that are valid alone but contradict each other or physics.

use crate::error::What;
use crate::write::{shown_entries, shown_key, shown_number};
use crate::{
    ContactLaw, Evaluate, Initialise, Line, Lumped, Offset, Pantograph, PantographModel, Scene, Supplied, Wire,
};

/// Problems found so far: the path of the key and what is wrong with it.
pub type Found = Vec<(String, What)>;

/// Room for rounding where a time or a place may lie on the edge of its range, in s and m.
pub(crate) const ROUNDING: f64 = 1e-9;
/// A run of more steps or rows than this is a mistake in a key.
const MAX_STEPS: f64 = 1e8;
/// Longest span, m: far beyond any real one, so that a single wire as good as endless can be tried, and short of a slip
/// in a power of ten.
pub(crate) const LONGEST_SPAN: f64 = 5000.0;
/// Least distance of a strip from the end of the line for its static balance, m: closer by, the wire has nothing to
/// yield with.
const END_OF_LINE: f64 = 0.01;

pub(crate) fn refuse(found: &mut Found, key: impl Into<String>, value: impl Into<String>, expected: impl Into<String>) {
    found.push((
        key.into(),
        What::Refused {
            value: value.into(),
            expected: expected.into(),
        },
    ));
}

/// Key of entry `index` (from 0) of a list; a list of one is written without brackets.
pub(crate) fn entry_of<T>(key: &str, list: &[T], index: usize) -> String {
    match list {
        [_] => key.to_owned(),
        _ => format!("{key}[{}]", index + 1),
    }
}

/// Refuses principal moments of inertia (kg m²) of which one is more than the other two together; equality is a flat
/// plate, `room` a share for what tables have beyond it.
pub(crate) fn check_inertia(found: &mut Found, path: &str, inertia: &[f64; 3], room: f64) {
    let &[xx, yy, zz] = inertia;
    for (largest, others) in [(xx, yy + zz), (yy, xx + zz), (zz, xx + yy)] {
        if largest > others * (1.0 + room) {
            let expected = format!(
                "{largest} kg m² is more than the other two together, {others} kg m², which no rigid body can have"
            );
            refuse(found, format!("{path}.inertia"), format!("{inertia:?} kg m²"), expected);
        }
    }
}

impl Scene {
    /// Everything that contradicts something else.
    ///
    /// `further` gives what is known beyond the values alone.
    pub(crate) fn contradictions(&self, further: &dyn Fn(&Self) -> Found) -> Found {
        let mut found = Found::new();
        match &self.catenary {
            Line::Modelled(catenary) => catenary.check(&mut found),
            Line::Supplied(side) => {
                side.check_alignment("catenary", None, &mut found);
                side.check_environment("catenary", &mut found);
            }
        }
        for (i, pantograph) in self.pantographs.iter().enumerate() {
            pantograph.check(&format!("pantograph[{}]", i + 1), &mut found);
        }
        self.check_order_of_strips(&mut found);
        self.check_heads(&mut found);
        self.check_joint(&mut found);
        self.check_steps(&mut found);
        self.solver.check(&mut found);
        self.check_vehicle(&mut found);
        self.check_reductions(&mut found);
        self.check_wind(&mut found);
        self.check_assessment(&mut found);
        self.check_measurement(&mut found);
        self.check_control(&mut found);
        self.check_controllers(&mut found);
        self.check_wear(&mut found);
        // What follows multiplies lengths, speeds and times, which must themselves be right.
        if found.is_empty() {
            self.check_speed(&mut found);
        }
        // Ways and times of the run follow from the speed.
        if found.is_empty() {
            found.extend(further(self));
            self.check_window(&mut found);
            self.check_strips_on_the_line(&mut found);
            self.check_evaluation(&mut found);
        }
        found
    }

    fn check_order_of_strips(&self, found: &mut Found) {
        for (i, behind) in self.pantographs.iter().enumerate().skip(1) {
            let ahead = self.pantographs[i - 1].offset_x;
            if behind.offset_x >= ahead {
                refuse(
                    found,
                    format!("pantograph[{}].offset_x", i + 1),
                    shown_number(behind.offset_x, "m"),
                    format!("must be less than {ahead} m, the offset of the pantograph before it: the first one leads"),
                );
            }
        }
    }

    /// A sliding joint needs the equations of both sides.
    fn check_joint(&self, found: &mut Found) {
        let joined = (self.contact.as_ref()).is_some_and(|contact| contact.law == ContactLaw::SlidingJoint);
        let wires = self.modelled_line().map_or(1, |(line, _)| line.contact_wires());
        if joined && wires > 1 {
            let expected =
                format!("must be \"penalty\" on a line of {wires} contact wires: a joint holds a strip on one");
            refuse(found, "contact.law", "\"sliding_joint\"", expected);
        }
        let horned = self
            .pantographs
            .iter()
            .position(|pantograph| pantograph.horns().is_some());
        if let Some(index) = horned.filter(|_| joined) {
            let expected = "must be left out under contact.law = \"sliding_joint\", which holds the strip on the wire \
                            wherever the wire goes";
            refuse(
                found,
                format!("pantograph[{}].strip.horns", index + 1),
                "{ … }",
                expected,
            );
        }
        let other = |pantograph: &Pantograph| matches!(pantograph.model, PantographModel::Supplied(_));
        if let Some(index) = self.pantographs.iter().position(other).filter(|_| joined) {
            let expected = format!(
                "must be \"penalty\" where pantograph[{}] is an FMU: line and pantograph are one system under a \
                 sliding joint, and an \
                 FMU gives no equations",
                index + 1
            );
            refuse(found, "contact.law", "\"sliding_joint\"", expected);
        }
    }

    fn check_steps(&self, found: &mut Found) {
        let duration = self.run.duration;
        let mut steps = vec![
            ("run.output_step", self.run.output_step),
            ("solver.micro_step", self.solver.micro_step),
        ];
        match self.coupling.step_control {
            None => steps.insert(1, ("coupling.macro_step", self.coupling.macro_step)),
            Some(control) => steps.extend([
                ("coupling.macro_step.min", control.min),
                ("coupling.macro_step.max", control.max),
            ]),
        }
        let longest = steps.iter().map(|(_, step)| *step).fold(0.0, f64::max);
        if duration / longest > MAX_STEPS {
            // No step goes with it: once is enough.
            let limit = shown_number(MAX_STEPS * longest, "s");
            let expected = format!(
                "must be at most {limit}: {MAX_STEPS:e} steps of {}",
                shown_number(longest, "s")
            );
            refuse(found, "run.duration", shown_number(duration, "s"), expected);
            steps.clear();
        }
        for (key, step) in steps {
            let shown_duration = shown_number(duration, "s");
            if step > duration {
                let expected = format!("must be at most run.duration = {shown_duration}");
                refuse(found, key, shown_number(step, "s"), expected);
            } else if duration / step > MAX_STEPS {
                let expected = format!(
                    "must be at least {}: run.duration = {shown_duration} in {MAX_STEPS:e} steps",
                    shown_number(duration / MAX_STEPS, "s")
                );
                refuse(found, key, shown_number(step, "s"), expected);
            }
        }
        let nyquist = 0.5 / self.run.output_step;
        if self.run.low_pass_hz >= nyquist {
            refuse(
                found,
                "run.low_pass_hz",
                shown_number(self.run.low_pass_hz, "Hz"),
                format!(
                    "must be below {nyquist} Hz, half the rate of run.output_step = {} s",
                    self.run.output_step
                ),
            );
        }
        let beyond = self.run.bands_hz.iter().find(|[_, to]| *to >= nyquist);
        if let Some([from, to]) = beyond.filter(|_| self.run.bands_hz != crate::run::BANDS) {
            let shown = format!("[{from}, {to}]");
            let expected = format!(
                "must be bands below {nyquist} Hz, half the rate of run.output_step = {} s",
                self.run.output_step
            );
            refuse(found, "run.bands_hz", shown, expected);
        }
    }

    fn check_speed(&self, found: &mut Found) {
        let Line::Modelled(catenary) = &self.catenary else {
            return;
        };
        let wave_speed = catenary.contact_wire.wave_speed();
        if self.run.speed >= wave_speed && !self.run.allow_supercritical {
            refuse(
                found,
                "run.speed_kmh",
                shown_number(crate::run::kmh(self.run.speed), "km/h"),
                format!(
                    "must be below {:.1} km/h: {} is not below the contact wire's wave speed √(tension / \
                     mass_per_length) \
                     = {wave_speed:.2} m/s; or set run.allow_supercritical = true",
                    crate::run::kmh(wave_speed),
                    shown_number((100.0 * self.run.speed).round() / 100.0, "m/s"),
                ),
            );
        }
    }

    /// Displacement (m) of a given motion and its time (s) at which strip `strip` (from 0, over all heads) is not on
    /// the line; between two samples it is no further off than at one of them, but for the overshoot of the curve
    /// through them.
    fn moved_off_the_line(&self, strip: usize, length: f64) -> Option<(f64, f64)> {
        let Some(crate::Vehicle::RigidMotion(motion)) = self.vehicle.as_deref() else {
            return None;
        };
        let duration = self.run.duration;
        let moved = motion.x.iter().copied().zip(motion.time.iter().copied());
        let within = moved.filter(|(_, time)| (0.0..=duration).contains(time));
        // From the last sample on it stays.
        let last = motion.x.last().zip(motion.time.last());
        let held = last.filter(|(_, time)| **time <= duration).map(|(&x, _)| (x, duration));
        within
            .chain(held)
            .find(|(x, time)| !(-ROUNDING..=length + ROUNDING).contains(&(self.strip_x(strip, *time) + x)))
    }

    fn check_strips_on_the_line(&self, found: &mut Found) {
        let Line::Modelled(catenary) = &self.catenary else {
            return;
        };
        let length = catenary.length();
        let aside = self.base_aside();
        for i in 0..self.strip_count() {
            let (start, end) = (self.strip_start_x(i), self.strip_x(i, self.run.duration));
            let (head, own) = self.head_of(i);
            let strip = self.strip_name(i);
            let at_rest = self.run.initialise == Initialise::Equilibrium;
            if at_rest && (-ROUNDING..END_OF_LINE - ROUNDING).contains(&start) {
                refuse(
                    found,
                    "run.start_x",
                    shown_number(self.run.start_x, "m"),
                    format!(
                        "{strip} starts at x = {start} m, must be {END_OF_LINE} m or more from the end of the line at \
                         0 m: at rest there, \
                         the wire has nothing to yield with; or run.initialise = \"as_given\""
                    ),
                );
            } else if start < -ROUNDING || start >= length {
                refuse(
                    found,
                    "run.start_x",
                    shown_number(self.run.start_x, "m"),
                    format!("{strip} starts at x = {start} m, must be on the line, before its end at {length} m"),
                );
            } else if end > length + ROUNDING {
                refuse(
                    found,
                    "run.duration",
                    shown_number(self.run.duration, "s"),
                    format!(
                        "must be at most {:.3} s: {strip} would leave the line, which ends at {length} m, for x = \
                         {end:.3} m",
                        (length - start) / self.run.speed
                    ),
                );
            } else if let Some((x, time)) = self.moved_off_the_line(i, length) {
                refuse(
                    found,
                    "vehicle.motion.x",
                    shown_number(x, "m"),
                    format!(
                        "takes {strip} off the line, which is from 0 to {length} m, at t = {time:.3} s: must keep it \
                         there"
                    ),
                );
            }
            // The strips of a head are of one width.
            let Some(half) = self.pantographs[head].half_length().filter(|_| own == 0) else {
                continue;
            };
            // Wires on their way to an anchor are above the strips and may be beside them.
            let outside = catenary.tension_lengths.iter().enumerate().flat_map(|(number, line)| {
                let staggers = (0..=line.spans()).map(move |support| (number, support, line.stagger_at(support)));
                staggers.filter(|(.., stagger)| (stagger - aside).abs() > half)
            });
            let outside = outside.filter(|(number, support, _)| catenary.is_in_reach(*number, *support));
            let outermost = outside.max_by(|a, b| (a.2 - aside).abs().total_cmp(&(b.2 - aside).abs()));
            if let Some((number, support, stagger)) = outermost {
                let k = support % catenary.tension_lengths[number].stagger.len();
                let middle = if aside == 0.0 {
                    String::new()
                } else {
                    format!(" of {aside} m, the y of vehicle.pantograph_base")
                };
                let reach = match self.pantographs[head].horns() {
                    Some(_) => "half the length of the head under",
                    None => "half the width of",
                };
                refuse(
                    found,
                    format!("{}.stagger[{}]", catenary.key_of(number), k + 1),
                    shown_number(stagger, "m"),
                    format!("must be within ±{half} m{middle}, {reach} {strip}"),
                );
            }
        }
    }

    fn check_evaluation(&self, found: &mut Found) {
        let duration = self.run.duration;
        match (self.run.evaluate, &self.catenary) {
            (Evaluate::Time { from, to }, _) => {
                if from >= to || to > duration + ROUNDING {
                    refuse(
                        found,
                        "run.evaluate.time",
                        format!("[{from}, {to}] s"),
                        format!("must be two times, the first one earlier, up to run.duration = {duration} s"),
                    );
                }
            }
            (Evaluate::Spans { first, last }, Line::Supplied(_)) => refuse(
                found,
                "run.evaluate.spans",
                format!("[{first}, {last}]"),
                "must be time = [from, to] instead: the spans of an FMU given as catenary are not known",
            ),
            (Evaluate::Spans { first, last }, Line::Modelled(catenary)) => {
                let value = format!("[{first}, {last}]");
                if first > last || last > catenary.spans() {
                    let expected = format!(
                        "must be two spans from 1 to {}, the first one not after the last",
                        catenary.spans()
                    );
                    refuse(found, "run.evaluate.spans", value, expected);
                    return;
                }
                for i in 0..self.pantographs.len() {
                    let (from, to) = self.evaluation_time(i);
                    if from < -ROUNDING || to > duration + ROUNDING {
                        let (x_from, x_to) = self.evaluation_x(i);
                        let expected = format!(
                            "must lie within the run: these spans reach from {x_from} m to {x_to} m, and the strip of \
                             pantograph[{}] \
                             runs from {:.3} m to {:.3} m",
                            i + 1,
                            self.head_start_x(i),
                            self.head_x(i, duration),
                        );
                        refuse(found, "run.evaluate.spans", value.clone(), expected);
                    }
                }
            }
        }
    }
}

impl Wire {
    pub(crate) fn check(&self, path: &str, found: &mut Found) {
        self.check_unit_of_tension(path, found);
        if let Some(breaking_force) = self.breaking_force
            && self.tension >= breaking_force
        {
            let expected = format!("must be below breaking_force = {breaking_force} N");
            refuse(
                found,
                format!("{path}.tension"),
                shown_number(self.tension, "N"),
                expected,
            );
        }
        if self.tension >= self.axial_stiffness {
            let expected = format!("must be far below axial_stiffness = {} N", self.axial_stiffness);
            refuse(
                found,
                format!("{path}.tension"),
                shown_number(self.tension, "N"),
                expected,
            );
        }
    }
}

impl Pantograph {
    fn check(&self, path: &str, found: &mut Found) {
        match &self.model {
            PantographModel::Lumped(lumped) => lumped.check(path, found),
            PantographModel::Linkage(linkage) => linkage.check(path, found),
            PantographModel::Supplied(side) => side.check(path, found),
        }
        if let (Some(horns), Some(width)) = (self.horns(), self.strip_width()) {
            horns.check(width, path, found);
        }
        self.check_strip_starts(path, found);
    }
}

impl Lumped {
    fn check(&self, path: &str, found: &mut Found) {
        let n = self.masses.len();
        for (name, entries) in [
            ("stiffnesses", self.stiffnesses.len()),
            ("dampings", self.dampings.len()),
            ("unilateral", self.unilateral.len()),
            ("friction", self.friction.len()),
        ] {
            if entries != n {
                let expected = format!("must have {n}, one per mass");
                refuse(found, format!("{path}.{name}"), shown_entries(entries), expected);
            }
        }
        for (i, stiffness) in self.stiffnesses.iter().enumerate().take(n.saturating_sub(1)) {
            if *stiffness == 0.0 {
                let expected =
                    "must be positive: only the last one, to the base, may be 0, or the mass above it would fall";
                refuse(
                    found,
                    format!("{path}.stiffnesses[{}]", i + 1),
                    shown_number(*stiffness, "N/m"),
                    expected,
                );
            }
        }
        crate::head::check(&self.strips, self.pitch.as_ref(), path, found);
    }
}

impl Supplied {
    fn check(&self, path: &str, found: &mut Found) {
        if !self.outputs.is_empty() && !self.outputs.contains_key("height") {
            let named: Vec<&str> = self.outputs.keys().map(String::as_str).collect();
            let expected = "must name height, the strip's height above the top of rail";
            refuse(found, format!("{path}.outputs"), named.join(", "), expected);
        }
        self.check_alignment(path, Some("height"), found);
        self.check_environment(path, found);
    }

    /// Checks of an FMU that commands a drive.
    pub(crate) fn check_controller(&self, path: &str, found: &mut Found) {
        self.check_alignment(path, None, found);
        self.check_environment(path, found);
    }

    /// Refuses an environment and a limit where there is no process to have them, and names that no variable can have.
    fn check_environment(&self, path: &str, found: &mut Found) {
        if let Some(bytes) = self.memory_limit.filter(|_| !self.isolate) {
            let expected = "must be left out, or isolate = true given: only a process of its own has a limit";
            refuse(
                found,
                format!("{path}.memory_limit"),
                shown_number(bytes, "B"),
                expected,
            );
        }
        for (name, value) in &self.environment {
            let key = format!("{path}.environment.{}", shown_key(name));
            if !self.isolate {
                let expected =
                    "must be left out, or isolate = true given: only a process of its own has an environment";
                refuse(found, key, format!("{value:?}"), expected);
            } else if name.is_empty() || name.contains(['=', '\0']) {
                let expected = "must have a name without = and NUL";
                refuse(found, key, format!("{value:?}"), expected);
            }
        }
    }

    /// Refuses `"align"` everywhere but on the output `aligned`.
    fn check_alignment(&self, path: &str, aligned: Option<&str>, found: &mut Found) {
        for (direction, connections) in [("inputs", &self.inputs), ("outputs", &self.outputs)] {
            for (name, connection) in connections {
                let allowed = direction == "outputs" && aligned == Some(name.as_str());
                if connection.offset == Offset::Align && !allowed {
                    let key = format!("{path}.{direction}.{}.offset", shown_key(name));
                    let expected = "must be a number: only a pantograph's output height can be aligned";
                    refuse(found, key, "\"align\"", expected);
                }
            }
        }
    }
}
