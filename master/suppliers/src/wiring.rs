//! From the connections of a scene, or guessed ones, to linear maps between our values and an FMU's.

use std::collections::BTreeMap;

use fmi2::model_description::ModelDescription;
use scene::{Connection, Offset, Supplied};

use super::guess::guess;
use super::quantity::{Side, strip_of, unit};
use super::units::Declared;

/// A connection with everything that was left open filled in.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Wire {
    /// This program's name.
    pub name: String,
    /// The FMU's.
    pub variable: String,
    /// `FMU value = factor · ours + offset` on inputs, `ours = factor · FMU value + offset` on outputs.
    pub factor: f64,
    /// See [`Wire::factor`].
    pub offset: f64,
    /// The map and where it comes from, for people.
    pub text: String,
}

/// Reason why an FMU does not fit its table in the scene.
#[derive(Debug, thiserror::Error)]
pub enum WiringError {
    /// The units are of different dimensions, or a factor contradicts them.
    #[error("{variable} is wired to {name} [{ours}]: {problem}")]
    Unit {
        /// `inputs` or `outputs`.
        table: &'static str,
        /// This program's name.
        name: String,
        /// The FMU's, with its unit in brackets.
        variable: String,
        /// Our unit.
        ours: &'static str,
        /// Problem and remedy.
        problem: String,
    },
    /// A quantity that cannot do without.
    #[error(
        "{fmu}: nothing is wired to {needed}, and no variable is recognised for it: name it under {table}, see \
         `master inspect`"
    )]
    Missing {
        /// Name of the model.
        fmu: String,
        /// This program's name.
        needed: String,
        /// `inputs` or `outputs`.
        table: &'static str,
    },
    /// A strip that the scene does not have.
    #[error("{name}: the scene has {strips} strip(s)")]
    NoStrip {
        /// `inputs` or `outputs`.
        table: &'static str,
        /// This program's name.
        name: String,
        /// Strips of the scene.
        strips: usize,
    },
}

impl WiringError {
    /// The key of the FMU's table that it speaks of.
    #[must_use]
    pub fn key(&self) -> String {
        match self {
            Self::Unit { table, name, .. } => format!("{table}.{name}"),
            Self::NoStrip { table, name, .. } => format!("{table}.\"{name}\""),
            Self::Missing { table, .. } => (*table).to_owned(),
        }
    }
}

/// Inputs and outputs of an FMU, wired.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Wiring {
    /// Side of the FMU.
    pub side: Side,
    /// Inputs of the FMU.
    pub inputs: Vec<Wire>,
    /// Outputs of the FMU.
    pub outputs: Vec<Wire>,
}

impl Wiring {
    /// The wiring of `entry`, guessed where it is left open; both are written into `entry`, factors included. `strips`
    /// is the number of strips of the scene.
    ///
    /// # Errors
    /// [`WiringError`].
    pub fn resolve(
        description: &ModelDescription,
        entry: &mut Supplied,
        side: Side,
        strips: usize,
    ) -> Result<Self, WiringError> {
        let guessed = guess(description, side);
        let connections = |guesses: Vec<super::guess::Guess>| -> BTreeMap<String, Connection> {
            let connection = |guess: super::guess::Guess| {
                let variable = guess.variable;
                let open = Connection {
                    variable,
                    factor: None,
                    offset: Offset::Value(0.0),
                };
                (guess.name, open)
            };
            let fits = |guess: &super::guess::Guess| strip_of(&guess.name).is_none_or(|i| i < strips);
            guesses.into_iter().filter(fits).map(connection).collect()
        };
        let [inputs, outputs] = guessed;
        if entry.inputs.is_empty() {
            entry.inputs = connections(inputs);
        }
        if entry.outputs.is_empty() {
            entry.outputs = connections(outputs);
        }
        for (table, map) in [("inputs", &entry.inputs), ("outputs", &entry.outputs)] {
            if let Some(name) = map.keys().find(|name| strip_of(name).is_some_and(|i| i >= strips)) {
                let name = name.clone();
                return Err(WiringError::NoStrip { table, name, strips });
            }
        }
        needed(description, entry, side, strips)?;
        let wires = |map: &mut BTreeMap<String, Connection>, table| {
            map.iter_mut()
                .map(|(name, connection)| wire(description, side, table, name, connection))
                .collect::<Result<Vec<_>, _>>()
        };
        Ok(Self {
            side,
            inputs: wires(&mut entry.inputs, "inputs")?,
            outputs: wires(&mut entry.outputs, "outputs")?,
        })
    }

    /// One line per wire.
    pub fn lines(&self) -> impl Iterator<Item = &str> {
        self.inputs.iter().chain(&self.outputs).map(|wire| wire.text.as_str())
    }
}

/// Refuses a wiring without what a coupling cannot do without.
fn needed(description: &ModelDescription, entry: &Supplied, side: Side, strips: usize) -> Result<(), WiringError> {
    let missing = |needed: String, table| WiringError::Missing {
        fmu: description.model_name.clone(),
        needed,
        table,
    };
    match side {
        Side::Pantograph => {
            let vertical = ["force", "force_z"];
            if !vertical.iter().any(|name| entry.inputs.contains_key(*name)) {
                return Err(missing("force".to_owned(), "inputs"));
            }
            if !entry.outputs.contains_key("height") {
                return Err(missing("height".to_owned(), "outputs"));
            }
        }
        Side::Controller => {
            if entry.inputs.keys().all(|name| name == "time") {
                return Err(missing("force, as measured".to_owned(), "inputs"));
            }
            if !entry.outputs.contains_key("command") {
                return Err(missing(
                    "command, the force that the drive is to exert".to_owned(),
                    "outputs",
                ));
            }
        }
        Side::Line => {
            for i in 1..=strips {
                if !entry.inputs.contains_key(&format!("strip[{i}].z")) {
                    return Err(missing(format!("strip[{i}].z"), "inputs"));
                }
                let names = ["force", "fz"].map(|name| format!("contact[{i}].{name}"));
                if !names.iter().any(|name| entry.outputs.contains_key(name)) {
                    return Err(missing(format!("contact[{i}].force or contact[{i}].fz"), "outputs"));
                }
            }
        }
    }
    Ok(())
}

/// The linear map of one connection; its factor is written into it.
fn wire(
    description: &ModelDescription,
    side: Side,
    table: &'static str,
    name: &str,
    connection: &mut Connection,
) -> Result<Wire, WiringError> {
    let ours = unit(side, name);
    let variable = description.variable(&connection.variable);
    let declared = variable.map_or(Declared::Nothing, |variable| Declared::of(description, variable));
    // (a, b) of our value = a · FMU value + b
    let converted = ours.and_then(|ours| declared.to_si(ours));
    let is_input = table == "inputs";
    let by_units = converted.map(|(a, b)| if is_input { (1.0 / a, -b / a) } else { (a, b) });
    let refused = |problem: String| WiringError::Unit {
        table,
        name: name.to_owned(),
        variable: format!("{}{}", connection.variable, declared.shown()),
        ours: ours.unwrap_or("1"),
        problem,
    };
    let contradicts = matches!(declared, Declared::Unit(..)) && ours.is_some() && converted.is_none();
    let (factor, extra, origin) = match (connection.factor, by_units) {
        (None, _) if contradicts => {
            return Err(refused(
                "these are different quantities; wire another variable, or give a factor that turns one into the other"
                    .to_owned(),
            ));
        }
        (None, Some((1.0, 0.0))) => (1.0, 0.0, "the same unit".to_owned()),
        (None, Some((factor, offset))) => (factor, offset, "converted from the units".to_owned()),
        (None, None) => match &declared {
            Declared::Name(unknown) => (1.0, 0.0, format!("unit \"{unknown}\" is not defined: taken as ours")),
            _ => (1.0, 0.0, "no unit declared: taken as ours".to_owned()),
        },
        (Some(factor), _) if contradicts && factor.abs() == 1.0 => {
            return Err(refused(format!(
                "these are different quantities, and factor = {factor} turns neither into the other; wire another \
                 variable"
            )));
        }
        (Some(factor), Some((scale, _))) if factor.abs() == 1.0 && (scale.abs() - 1.0).abs() > 1e-12 => {
            return Err(refused(format!(
                "factor = {factor} contradicts the units: must be {}, or left out to convert by the units",
                scale.copysign(factor)
            )));
        }
        (Some(factor), Some((scale, _))) if (factor.abs() / scale.abs() - 1.0).abs() > 1e-9 => (
            factor,
            0.0,
            format!("factor of the scene; the units alone would make it {scale}"),
        ),
        (Some(factor), _) if contradicts => (
            factor,
            0.0,
            "factor of the scene; the units are of different kind".to_owned(),
        ),
        (Some(factor), _) => (factor, 0.0, "factor of the scene".to_owned()),
    };
    let (offset, shown) = match connection.offset {
        Offset::Value(value) => {
            connection.offset = Offset::Value(value + extra);
            (value + extra, value + extra)
        }
        Offset::Align => (0.0, 0.0),
    };
    connection.factor = Some(factor);
    let ours = ours.map_or_else(String::new, |unit| format!(" [{unit}]"));
    let theirs = format!("{}{}", connection.variable, declared.shown());
    let ours = format!("{name}{ours}");
    let (left, right) = if is_input { (theirs, ours) } else { (ours, theirs) };
    let offset_text = match connection.offset {
        Offset::Align => " + the offset that puts it under the wire".to_owned(),
        Offset::Value(_) if shown == 0.0 => String::new(),
        Offset::Value(_) => format!(" + {shown}"),
    };
    let factor_text = if factor == 1.0 {
        String::new()
    } else {
        format!("{factor} × ")
    };
    let unused = match name {
        "roll_rate" => "; not used: the line takes the rate of roll itself",
        name if name.ends_with(".closed") => "; not used: it follows from the force",
        _ => "",
    };
    Ok(Wire {
        name: name.to_owned(),
        variable: connection.variable.clone(),
        factor,
        offset,
        text: format!("{left} = {factor_text}{right}{offset_text}  ({origin}{unused})"),
    })
}
