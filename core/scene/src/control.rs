//! `pantograph.control`: a drive of the pantograph that a controller commands while it runs.

use crate::check::{Found, refuse};
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::write::shown_number;
use crate::{Linkage, PantographModel, Scene};

/// `pantograph.control`: sampled controller, sensors and actuator of one pantograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Control {
    /// Rule of the commands.
    pub law: ControlLaw,
    /// Time between two samples, s.
    pub sample_time: f64,
    /// Desired contact force, N; `None` is the force at the start.
    pub force: Option<f64>,
    /// Drive that acts on the pantograph.
    pub actuator: Actuator,
    /// Instruments that the controller sees the pantograph through.
    pub sensors: Sensors,
}

/// `control.law`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ControlLaw {
    /// `"pid"`: from the difference between desired and measured contact force.
    Pid {
        /// Proportional gain, –.
        kp: f64,
        /// Integral gain, 1/s.
        ki: f64,
        /// Derivative gain, s.
        kd: f64,
        /// Time constant of the filter of the derivative, s.
        derivative_lag: f64,
    },
    /// `"lqr"`: linear-quadratic feedback of the state of the lumped pantograph.
    Lqr {
        /// Weight of the squared deviation of the contact force, –.
        force_weight: f64,
        /// Weight of the squared velocity of the driven mass, N²/(m/s)².
        velocity_weight: f64,
        /// Weight of the squared force of the actuator, –.
        effort_weight: f64,
        /// Stiffness of the contact wire that the gains are made for, N/m.
        wire_stiffness: f64,
    },
    /// `"skyhook"`: a damper between the driven point and the sky.
    Skyhook {
        /// N·s/m.
        damping: f64,
    },
    /// `"given"`: commands come from outside, from an FMU of `[[controller]]` or through the input `control.force`.
    Given,
}

/// `control.actuator`; by default a drive of the last mass without limits that follows its commands at once.
///
/// On a joint, every force of the drive is a moment in N·m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Actuator {
    /// Mass of a lumped pantograph that the force acts on, from 1; `None` is the last one. A linkage is driven where
    /// its raising force acts, or on a joint.
    pub mass: Option<usize>,
    /// Revolute joint of a linkage that a moment acts on in place of the force: [`crate::Joint::name`].
    pub joint: Option<String>,
    /// Largest command, N; `None` is no limit.
    pub limit: Option<f64>,
    /// Fastest change of the force, N/s; `None` is no limit.
    pub rate_limit: Option<f64>,
    /// Time constant of the force behind the command, s.
    pub lag: f64,
    /// Time from a command to its effect, s.
    pub delay: f64,
}

/// `control.sensors`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Time from a motion to the reading of it, s.
    pub delay: f64,
    /// Standard deviation of the noise of measured contact forces, N.
    pub force_noise: f64,
    /// Standard deviation of the noise of measured velocities, m/s.
    pub velocity_noise: f64,
    /// Standard deviation of the noise of measured positions, m.
    pub position_noise: f64,
    /// Standard deviation of the noise of measured accelerations, m/s².
    pub acceleration_noise: f64,
    /// Seed of the noise.
    pub seed: usize,
}

/// The words of `law`.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Pid,
    Lqr,
    Skyhook,
    Given,
}

const KINDS: [(&str, Kind); 4] = [
    ("pid", Kind::Pid),
    ("lqr", Kind::Lqr),
    ("skyhook", Kind::Skyhook),
    ("given", Kind::Given),
];

impl ControlLaw {
    fn kind(self) -> Kind {
        match self {
            Self::Pid { .. } => Kind::Pid,
            Self::Lqr { .. } => Kind::Lqr,
            Self::Skyhook { .. } => Kind::Skyhook,
            Self::Given => Kind::Given,
        }
    }

    /// Word of the law in the scene file.
    #[must_use]
    pub fn name(self) -> &'static str {
        let found = KINDS.iter().find(|(_, kind)| *kind == self.kind());
        found.map_or("", |(name, _)| name)
    }

    /// Keys of a law whose commands are forces, or moments on a joint.
    fn entry(kind: Kind, keys: &mut Keys, was: Option<Self>, on_joint: bool) -> Self {
        let of = |choose: fn(Self) -> Option<f64>| was.and_then(choose);
        match kind {
            Kind::Pid => {
                let mut gain = |name, was, unit| keys.number(name, was, Number::not_negative(unit).default(0.0));
                let [kp, ki, kd] = if on_joint {
                    ["m", "m/s", "m s"]
                } else {
                    ["–", "1/s", "s"]
                };
                Self::Pid {
                    kp: gain("kp", of(|law| law.pid(0)), kp),
                    ki: gain("ki", of(|law| law.pid(1)), ki),
                    kd: gain("kd", of(|law| law.pid(2)), kd),
                    derivative_lag: gain("derivative_lag", of(|law| law.pid(3)), "s"),
                }
            }
            Kind::Lqr => Self::Lqr {
                force_weight: keys.number(
                    "force_weight",
                    of(|law| law.lqr(0)),
                    Number::not_negative("–").default(1.0),
                ),
                velocity_weight: keys.number(
                    "velocity_weight",
                    of(|law| law.lqr(1)),
                    Number::not_negative("N²s²/m²").default(0.0),
                ),
                effort_weight: keys.number("effort_weight", of(|law| law.lqr(2)), Number::positive("–")),
                wire_stiffness: keys.number("wire_stiffness", of(|law| law.lqr(3)), Number::positive("N/m")),
            },
            Kind::Skyhook => {
                let damping = |law| match law {
                    Self::Skyhook { damping } => Some(damping),
                    _ => None,
                };
                let unit = if on_joint { "N m s/rad" } else { "N s/m" };
                Self::Skyhook {
                    damping: keys.number("damping", of(damping), Number::positive(unit)),
                }
            }
            Kind::Given => Self::Given,
        }
    }

    /// Number `index` of `"pid"`.
    fn pid(self, index: usize) -> Option<f64> {
        match self {
            Self::Pid {
                kp,
                ki,
                kd,
                derivative_lag,
            } => Some([kp, ki, kd, derivative_lag][index]),
            _ => None,
        }
    }

    /// Number `index` of `"lqr"`.
    fn lqr(self, index: usize) -> Option<f64> {
        match self {
            Self::Lqr {
                force_weight,
                velocity_weight,
                effort_weight,
                wire_stiffness,
            } => Some([force_weight, velocity_weight, effort_weight, wire_stiffness][index]),
            _ => None,
        }
    }
}

impl Entry for Control {
    const SENTENCES: Sentences = &[
        (
            "law",
            "Rule of the commands: PID on the contact force, linear-quadratic feedback of a lumped pantograph, a \
             damper to the sky, or commands given from outside, by a `[[controller]]` or by the program that steps.",
        ),
        ("sample_time", "Time between two samples of the controller."),
        (
            "force",
            "Desired contact force; that at the start where it is left out.",
        ),
        (
            "kp",
            "Proportional gain, force of the actuator per contact force; with `actuator.joint` a moment, and each gain \
             in m times its unit.",
        ),
        ("ki", "Integral gain."),
        ("kd", "Derivative gain."),
        ("derivative_lag", "Time constant of the filter of the derivative."),
        ("force_weight", "Weight of the squared deviation of the contact force."),
        ("velocity_weight", "Weight of the squared velocity of the driven mass."),
        ("effort_weight", "Weight of the squared force of the actuator."),
        (
            "wire_stiffness",
            "Stiffness of the contact wire that the gains are made for, that of the middle of a span say.",
        ),
        (
            "damping",
            "Damper between the driven point and the sky; with `actuator.joint` in the joint, N m s/rad.",
        ),
        ("actuator", "Drive that acts on the pantograph."),
        (
            "sensors",
            "Instruments that the controller sees the pantograph through.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let law = was.map(|control| control.law);
        let kind = keys.word_among("law", law.map(ControlLaw::kind), &KINDS, &[], None);
        let sample_time = keys.number(
            "sample_time",
            was.map(|control| control.sample_time),
            Number::positive("s"),
        );
        let force = keys.optional_number("force", was.map(|control| control.force), Number::positive("N"));
        let actuator = keys.optional_inline_table("actuator", was.map(|control| Some(&control.actuator)));
        let sensors = keys.optional_inline_table("sensors", was.map(|control| Some(&control.sensors)));
        let on_joint = actuator.as_ref().is_some_and(|actuator| actuator.joint.is_some());
        let law = if keys.describes() {
            for (name, kind) in KINDS {
                keys.only(&format!("`law = \"{name}\"`"), |keys| {
                    ControlLaw::entry(kind, keys, None, false)
                });
            }
            ControlLaw::Given
        } else {
            if kind.is_none() {
                keys.abandon();
            }
            kind.map_or(ControlLaw::Given, |kind| ControlLaw::entry(kind, keys, law, on_joint))
        };
        Self {
            law,
            sample_time,
            force,
            actuator: actuator.unwrap_or_default(),
            sensors: sensors.unwrap_or_default(),
        }
    }
}

impl Entry for Actuator {
    const SENTENCES: Sentences = &[
        (
            "mass",
            "Mass of a lumped pantograph that the force acts on, from 1; the last one where it is left out. A linkage \
             is driven where its raising force acts, or on a joint.",
        ),
        (
            "joint",
            "Revolute joint of a linkage that the drive turns in place of the force, named by its bodies as \
             `\"base-lower_arm\"`: commands are moments in N m, positive where they raise the strip.",
        ),
        ("limit", "Largest command, N m on a joint; none where it is left out."),
        (
            "rate_limit",
            "Fastest change of the force, N m/s of a moment on a joint; none where it is left out.",
        ),
        ("lag", "Time constant of the force behind the command."),
        ("delay", "Time from a command to its effect."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let mass = was.and_then(|actuator| actuator.mass);
        let joint = keys.optional_text(
            "joint",
            was.map(|actuator| actuator.joint.as_deref()),
            "the name of a joint, as \"base-lower_arm\"",
        );
        let [force, rate] = if joint.is_some() {
            ["N m", "N m/s"]
        } else {
            ["N", "N/s"]
        };
        let mut time = |name, was| keys.number(name, was, Number::not_negative("s").default(0.0));
        let lag = time("lag", was.map(|actuator| actuator.lag));
        let delay = time("delay", was.map(|actuator| actuator.delay));
        Self {
            mass: keys
                .has("mass", mass.is_some())
                .then(|| keys.count("mass", mass, 1..=1000, None)),
            joint,
            limit: keys.optional_number("limit", was.map(|actuator| actuator.limit), Number::positive(force)),
            rate_limit: keys.optional_number(
                "rate_limit",
                was.map(|actuator| actuator.rate_limit),
                Number::positive(rate),
            ),
            lag,
            delay,
        }
    }
}

impl Default for Sensors {
    /// Instruments without delay and noise.
    fn default() -> Self {
        Self {
            delay: 0.0,
            force_noise: 0.0,
            velocity_noise: 0.0,
            position_noise: 0.0,
            acceleration_noise: 0.0,
            seed: 1,
        }
    }
}

impl Entry for Sensors {
    const SENTENCES: Sentences = &[
        ("delay", "Time from a motion to the reading of it."),
        (
            "force_noise",
            "Standard deviation of the noise of measured contact forces.",
        ),
        (
            "velocity_noise",
            "Standard deviation of the noise of measured velocities; of a driven joint in rad/s.",
        ),
        (
            "position_noise",
            "Standard deviation of the noise of measured positions; of a driven joint in rad.",
        ),
        (
            "acceleration_noise",
            "Standard deviation of the noise of measured accelerations.",
        ),
        ("seed", "Seed of the noise."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let mut number = |name, was, unit| keys.number(name, was, Number::not_negative(unit).default(0.0));
        Self {
            delay: number("delay", was.map(|sensors| sensors.delay), "s"),
            force_noise: number("force_noise", was.map(|sensors| sensors.force_noise), "N"),
            velocity_noise: number("velocity_noise", was.map(|sensors| sensors.velocity_noise), "m/s"),
            position_noise: number("position_noise", was.map(|sensors| sensors.position_noise), "m"),
            acceleration_noise: number(
                "acceleration_noise",
                was.map(|sensors| sensors.acceleration_noise),
                "m/s²",
            ),
            seed: keys.count("seed", was.map(|sensors| sensors.seed), 0..=usize::MAX >> 1, Some(1)),
        }
    }
}

impl Scene {
    /// Checks controllers against the pantographs that they command, and against the steps of the run.
    pub(crate) fn check_control(&self, found: &mut Found) {
        for (index, pantograph) in self.pantographs.iter().enumerate() {
            let Some(control) = &pantograph.control else { continue };
            let path = format!("pantograph[{}].control", index + 1);
            match &pantograph.model {
                PantographModel::Lumped(lumped) => control.check_lumped(lumped, &path, found),
                PantographModel::Linkage(linkage) => {
                    control.check_linkage(linkage, &path, found);
                    if control.actuator.joint.is_some() && self.controller_of(index).is_some() {
                        let expected = "must be left out under a [[controller]], whose command is a force; moments \
                                        on a joint come from \"pid\", \"skyhook\", or through control.force";
                        let joint = control.actuator.joint.as_deref().unwrap_or_default();
                        refuse(found, format!("{path}.actuator.joint"), format!("{joint:?}"), expected);
                    }
                }
                PantographModel::Supplied(_) => {
                    let expected = "must be left out: fmu is given, which has a drive of its own or none";
                    refuse(found, &path, format!("law \"{}\"", control.law.name()), expected);
                }
            }
            control.check_times(self.solver.micro_step, &path, found);
        }
    }
}

impl Actuator {
    /// Unit of its commands.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        if self.joint.is_some() { "N m" } else { "N" }
    }
}

impl Control {
    /// Time from a motion to the effect of the command that it leads to, s.
    #[must_use]
    pub fn delay(&self) -> f64 {
        self.sensors.delay + self.actuator.delay
    }

    fn check_lumped(&self, lumped: &crate::Lumped, path: &str, found: &mut Found) {
        let masses = lumped.masses.len();
        if let Some(mass) = self.actuator.mass.filter(|&mass| mass > masses) {
            let expected = format!("must be at most {masses}, the number of masses");
            refuse(found, format!("{path}.actuator.mass"), mass.to_string(), expected);
        }
        if let Some(joint) = &self.actuator.joint {
            let expected = "must be left out with model = \"lumped\", which has no joints: mass names what is driven";
            refuse(found, format!("{path}.actuator.joint"), format!("{joint:?}"), expected);
        }
        if matches!(self.law, ControlLaw::Lqr { .. }) && !lumped.strips.is_empty() {
            let expected = "must be \"pid\", \"skyhook\" or \"given\" on a head with strips of its own: the gains of \
                            \"lqr\" are those of a plain chain of masses";
            refuse(found, format!("{path}.law"), "\"lqr\"", expected);
        }
    }

    fn check_linkage(&self, linkage: &Linkage, path: &str, found: &mut Found) {
        if let Some(joint) = &self.actuator.joint
            && linkage.revolute(joint).is_none()
        {
            let names: Vec<String> = linkage
                .revolutes()
                .map(|(_, joint)| format!("{:?}", joint.name()))
                .collect();
            let there = linkage.joints.iter().any(|other| other.name() == *joint);
            let problem = if there { "no revolute joint" } else { "no such joint" };
            let expected = format!("{problem}: must be one of {}", names.join(", "));
            refuse(found, format!("{path}.actuator.joint"), format!("{joint:?}"), expected);
        }
        if let Some(mass) = self.actuator.mass {
            let expected = "must be left out: a linkage is driven where its raising force acts, or on a joint";
            refuse(found, format!("{path}.actuator.mass"), mass.to_string(), expected);
        }
        if matches!(self.law, ControlLaw::Lqr { .. }) {
            let expected = "must be \"pid\", \"skyhook\" or \"given\" with model = \"linkage\": the gains of \"lqr\" \
                            are those of a lumped pantograph";
            refuse(found, format!("{path}.law"), "\"lqr\"", expected);
        }
    }

    fn check_times(&self, micro_step: f64, path: &str, found: &mut Found) {
        let sample = self.sample_time;
        if sample < micro_step * (1.0 - 1e-9) {
            let expected = format!("must be at least solver.micro_step = {micro_step} s: motion is known step by step");
            refuse(
                found,
                format!("{path}.sample_time"),
                shown_number(sample, "s"),
                expected,
            );
        }
        if self.delay() > sample * (1.0 + 1e-9) {
            let key = if self.actuator.delay >= self.sensors.delay {
                "actuator"
            } else {
                "sensors"
            };
            let value = self.sensors.delay.max(self.actuator.delay);
            let expected = format!(
                "must, with the delay of the other side, be at most sample_time = {sample} s: a command takes effect \
                 before the next one"
            );
            let key = format!("{path}.{key}.delay");
            refuse(found, key, shown_number(value, "s"), expected);
        }
        if self.law
            == (ControlLaw::Pid {
                kp: 0.0,
                ki: 0.0,
                kd: 0.0,
                derivative_lag: 0.0,
            })
        {
            let expected = "must be given with at least one of kp, ki and kd above 0, or control be left out";
            refuse(found, format!("{path}.law"), "\"pid\"", expected);
        }
    }
}
