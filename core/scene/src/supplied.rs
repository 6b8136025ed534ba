//! `fmu = "…"`: a subsystem modelled elsewhere and supplied as an FMU.

use std::collections::BTreeMap;

use crate::Strip;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::tree::Value;

/// Wall time that a call of an isolated FMU may take where a scene does not say it, s.
const STEP_TIMEOUT: f64 = 60.0;

/// Least memory that the process of an FMU may be given, bytes: that of the program itself.
const LEAST_MEMORY: f64 = 5e7;

/// An FMU with its wiring, in `[catenary]`, `[[pantograph]]` or `[[controller]]`.
///
/// Inputs and outputs are keyed by this program's names. A pantograph's inputs are `force`, `force_x`, `force_y`,
/// `force_z`, `time`, `x`, its outputs `height`, `velocity`, `x`, `y`, `vx`, `vy`, `roll`, `roll_rate` (accepted and
/// not read: a line takes the rate of `roll` itself). A line's are those of `Catenary.fmu`: `strip[i].…`,
/// `contact[i].…`, `support[k].uplift`, and `time` (`contact[i].closed` is accepted and not read: it follows from the
/// force). A controller's inputs are `force`, `desired_force`, `velocity` and `position` of the driven point,
/// `head_height`, `head_velocity`, `head_acceleration`, `time`, its output is `command`. Empty maps leave the wiring to
/// be guessed from the FMU's variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Supplied {
    /// Path of the archive, relative to the scene file.
    pub fmu: String,
    /// True where the FMU runs in a child process.
    pub isolate: bool,
    /// Wall time after which a call of the FMU is given up, s; 60 by default: no step of a working FMU takes that long.
    pub step_timeout: f64,
    /// Most memory of its child process, bytes; only where it is isolated.
    pub memory_limit: Option<f64>,
    /// Variables of the environment that its child process is started with; empty where it is not isolated.
    pub environment: BTreeMap<String, String>,
    /// Values set before initialisation, by the FMU's variable names.
    pub parameters: BTreeMap<String, ParameterValue>,
    /// Variables that the FMU is given, by this program's names.
    pub inputs: BTreeMap<String, Connection>,
    /// Variables read from the FMU, by this program's names.
    pub outputs: BTreeMap<String, Connection>,
    /// Collector strip of a pantograph; a wire is in reach of one without wherever it goes.
    pub strip: Option<Strip>,
}

/// The value of an FMU parameter as typed in the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    /// A real or integer variable, in the FMU's own unit.
    Number(f64),
    /// A Boolean variable.
    Boolean(bool),
    /// A string variable.
    String(String),
}

/// A variable of the FMU and the linear map between its value and ours.
///
/// ```text
/// our value = factor · FMU value + offset        on outputs
/// FMU value = factor · our value + offset        on inputs
/// ```
///
/// The FMU value is in the FMU's own unit, ours in SI. A factor that is left out converts between the two.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// Name in the FMU.
    pub variable: String,
    /// Units as the two sides' units demand, not zero; `None` where the scene leaves it to those units.
    pub factor: Option<f64>,
    /// 0 by default.
    pub offset: Offset,
}

/// `offset` of a connection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Offset {
    /// In the unit of the side that the map leads to.
    Value(f64),
    /// Chosen so that the FMU's start height is the static height of the wire over its strip under its start force;
    /// only on the output `height`.
    Align,
}

/// Sentence on the strip of a supplied pantograph.
const STRIP: Sentences = &[(
    "strip",
    "Collector strip, with horns, on which the line finds its wires; left out, a wire is in reach wherever it goes.",
)];

/// A pantograph's inputs and outputs, by this program's names.
pub(crate) const PANTOGRAPH: [&[&str]; 2] = [
    &["force", "force_x", "force_y", "force_z", "time", "x"],
    &["height", "velocity", "x", "y", "vx", "vy", "roll", "roll_rate"],
];

/// A controller's inputs and outputs, by this program's names.
pub const CONTROLLER: [&[&str]; 2] = [
    &[
        "force",
        "desired_force",
        "velocity",
        "position",
        "head_height",
        "head_velocity",
        "head_acceleration",
        "time",
    ],
    &["command"],
];

/// The names of a line's inputs and outputs, for as many strips and supports as a scene may have.
fn line_names() -> [Vec<String>; 2] {
    const MAX_STRIPS: usize = 16;
    const SAMPLES: usize = 10;
    let strips = ["x", "y", "z", "vx", "vy", "vz", "roll"];
    let contacts = [
        "force",
        "fx",
        "fy",
        "fz",
        "mean_force",
        "mean_fx",
        "mean_fy",
        "mean_fz",
        "work",
        "x",
        "y",
        "wire.z",
        "wire.vz",
        "gap",
        "closed",
    ];
    let inputs = std::iter::once("time".to_string())
        .chain((1..=MAX_STRIPS).flat_map(|i| strips.map(|name| format!("strip[{i}].{name}"))));
    let outputs = (1..=MAX_STRIPS)
        .flat_map(|i| {
            let samples = (1..=SAMPLES).map(move |j| format!("contact[{i}].sample[{j}]"));
            contacts
                .map(|name| format!("contact[{i}].{name}"))
                .into_iter()
                .chain(samples)
        })
        .chain((1..=crate::MAX_SPANS + 1).map(|k| format!("support[{k}].uplift")));
    [inputs.collect(), outputs.collect()]
}

impl Supplied {
    /// An FMU by the path of its archive, which nothing else is said about.
    #[must_use]
    pub fn unwired(fmu: impl Into<String>) -> Self {
        Self {
            fmu: fmu.into(),
            isolate: false,
            step_timeout: STEP_TIMEOUT,
            memory_limit: None,
            environment: BTreeMap::new(),
            parameters: BTreeMap::new(),
            inputs: BTreeMap::new(),
            outputs: BTreeMap::new(),
            strip: None,
        }
    }

    pub(crate) const SENTENCES: Sentences = &[
        ("fmu", "Path of the FMU, relative to the scene file."),
        ("isolate", "True runs the FMU in a process of its own."),
        ("step_timeout", "Wall time after which a call of the FMU is given up."),
        ("memory_limit", "Most memory of its process; with `isolate` only."),
        (
            "environment",
            "Environment variables of its process; with `isolate` only.",
        ),
        (
            "parameters",
            "Values set before initialisation, by the FMU's variable names.",
        ),
        (
            "inputs",
            "Variables that the FMU is given, by this program's names; left out, they are found by name.",
        ),
        (
            "outputs",
            "Variables that are read from the FMU, by this program's names; left out, they are found by name.",
        ),
    ];

    /// `[[pantograph]]` with `fmu`.
    pub(crate) fn pantograph(keys: &mut Keys, was: Option<&Self>) -> Self {
        let side = Self::wired(
            keys,
            was,
            &PANTOGRAPH.map(|names| names.iter().map(|name| (*name).to_string()).collect()),
        );
        let strip = keys.with(STRIP, |keys| {
            keys.optional_inline_table("strip", was.map(|side| side.strip.as_ref()))
        });
        Self { strip, ..side }
    }

    /// `[[controller]]`.
    pub(crate) fn controller(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self::wired(
            keys,
            was,
            &CONTROLLER.map(|names| names.iter().map(|name| (*name).to_string()).collect()),
        )
    }

    /// `[catenary]` with `fmu`.
    pub(crate) fn line(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self::wired(keys, was, &line_names())
    }

    fn wired(keys: &mut Keys, was: Option<&Self>, [inputs, outputs]: &[Vec<String>; 2]) -> Self {
        keys.with(Self::SENTENCES, |keys| Self {
            fmu: keys.text(
                "fmu",
                was.map(|side| side.fmu.as_str()),
                "the path of an FMU, relative to the scene file",
            ),
            isolate: keys.flag("isolate", was.map(|side| side.isolate), false),
            step_timeout: keys.number(
                "step_timeout",
                was.map(|side| side.step_timeout),
                Number::positive("s").default(STEP_TIMEOUT),
            ),
            memory_limit: keys.optional_number(
                "memory_limit",
                was.map(|side| side.memory_limit),
                Number::positive("B").at_least(LEAST_MEMORY),
            ),
            environment: keys.plain_map(
                "environment",
                was.map(|side| &side.environment),
                |text| Value::String(text.clone()),
                |value| match value {
                    Value::String(text) if !text.contains('\0') => Ok(text.clone()),
                    _ => Err("a string without NUL characters".to_string()),
                },
            ),
            parameters: keys.plain_map(
                "parameters",
                was.map(|side| &side.parameters),
                ParameterValue::to_toml,
                ParameterValue::from_toml,
            ),
            inputs: keys.map("inputs", was.map(|side| &side.inputs), inputs),
            outputs: keys.map("outputs", was.map(|side| &side.outputs), outputs),
            strip: None,
        })
    }
}

impl ParameterValue {
    fn to_toml(&self) -> Value {
        match self {
            Self::Number(number) => Value::Float(*number),
            Self::Boolean(flag) => Value::Boolean(*flag),
            Self::String(text) => Value::String(text.clone()),
        }
    }

    fn from_toml(value: &Value) -> Result<Self, String> {
        match value {
            Value::Float(number) if number.is_finite() => Ok(Self::Number(*number)),
            Value::Integer(number) => Ok(Self::Number(*number as f64)),
            Value::Boolean(flag) => Ok(Self::Boolean(*flag)),
            Value::String(text) => Ok(Self::String(text.clone())),
            _ => Err("a finite number, true, false or a string".to_string()),
        }
    }
}

impl Entry for Connection {
    const SENTENCES: Sentences = &[
        ("variable", "Name of the variable in the FMU."),
        (
            "factor",
            "Factor between the FMU's value and ours; left out, the units of both sides say it.",
        ),
        ("offset", "Offset after the factor."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let offset = was.map(|connection| connection.offset);
        Self {
            variable: keys.text(
                "variable",
                was.map(|connection| connection.variable.as_str()),
                "the name of a variable of the FMU",
            ),
            factor: keys.optional_number("factor", was.map(|connection| connection.factor), Number::not_zero()),
            offset: match offset {
                Some(Offset::Align) => align(keys, Some(Offset::Align)),
                Some(Offset::Value(value)) => Offset::Value(keys.number("offset", Some(value), Number::any(""))),
                None if keys.describes() => {
                    let sentences = if keys.is_table("pantograph.outputs") {
                        ALIGNED
                    } else {
                        &[]
                    };
                    keys.with(sentences, |keys| {
                        if !sentences.is_empty() {
                            align(keys, None);
                        }
                        Offset::Value(keys.number("offset", None, Number::any("").default(0.0)))
                    })
                }
                None if keys.holds_text("offset") => align(keys, None),
                None => Offset::Value(keys.number("offset", None, Number::any("").default(0.0))),
            },
        }
    }
}

/// Offset of the outputs of a pantograph.
const ALIGNED: Sentences = &[(
    "offset",
    "Offset after the factor; `\"align\"` on the output `height` puts the strip's start on the wire.",
)];

/// `offset = "align"`.
fn align(keys: &mut Keys, was: Option<Offset>) -> Offset {
    keys.word_among("offset", was, &[("align", Offset::Align)], &[], None)
        .unwrap_or(Offset::Align)
}
