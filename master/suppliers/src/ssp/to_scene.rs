//! A line and pantographs as a scene.

use std::fmt::Write as _;

use scene::{Evaluate, Line, Offset, Pantograph, PantographModel, ParameterValue, Scene, Supplied};

use super::SspError;
use super::document::{Description, Own};
use super::foreign::Foreign;
use super::unpacked::Unpacked;

impl Foreign {
    /// The scene of an export with this line and these pantographs instead of its own.
    pub fn in_place_of(
        self,
        own: &Own,
        description: &Description,
        unpacked: Unpacked<'_>,
        origin: &str,
        overrides: &[String],
    ) -> Result<Scene, SspError> {
        let text = unpacked.content(&own.scene, 1)?;
        let mut scene = system::load(&String::from_utf8_lossy(&text), origin, &[])?;
        let (from, to) = scene.evaluation_time(0);
        if let Some(stop) = description.experiment.stop {
            scene.run.duration = stop;
        }
        scene.run.evaluate = Evaluate::Time {
            from: from.min(scene.run.duration),
            to: to.min(scene.run.duration),
        };
        scene.catenary = Line::Supplied(self.line);
        scene.contact = None;
        let first = self.pantographs[0].0;
        if let Some(x) = first {
            scene.run.start_x = x;
        }
        if let Some(speed) = self.speed {
            scene.run.speed = speed;
        }
        scene.pantographs = self
            .pantographs
            .into_iter()
            .map(|(x, side)| Pantograph {
                offset_x: x.zip(first).map_or(0.0, |(x, first)| x - first),
                model: PantographModel::Supplied(side),
                start: None,
                strip_starts: Vec::new(),
                control: None,
            })
            .collect();
        scene.run.initialise = scene::Initialise::AsGiven;
        Ok(system::load(&scene.to_toml(), origin, overrides)?)
    }

    /// The scene as far as the system says it; what is missing is for the command line.
    pub fn to_toml(&self, description: &Description) -> String {
        let mut out = String::new();
        let title = description.system.description.as_ref().unwrap_or(&description.name);
        let _ = writeln!(out, "title = {}", quoted(title.lines().next().unwrap_or_default()));
        out.push_str("\n[run]\n");
        if let Some(stop) = description.experiment.stop {
            let _ = writeln!(out, "duration = {:?}", stop);
            let _ = writeln!(out, "evaluate = {{ time = [0.0, {:?}] }}", stop);
        }
        if let Some(speed) = self.speed {
            let _ = writeln!(out, "speed_kmh = {:?}", speed * 3.6);
        }
        let first = self.pantographs[0].0;
        if let Some(x) = first {
            let _ = writeln!(out, "start_x = {x:?}");
        }
        out.push_str("initialise = \"as_given\"\n\n[catenary]\n");
        supplied(&mut out, &self.line);
        for (x, side) in &self.pantographs {
            out.push_str("\n[[pantograph]]\n");
            if let (Some(x), Some(first)) = (x, first) {
                let _ = writeln!(out, "offset_x = {:?}", x - first);
            }
            supplied(&mut out, side);
        }
        out
    }
}

/// A text as TOML.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// The keys of `[catenary]` or `[[pantograph]]` with an FMU.
fn supplied(out: &mut String, side: &Supplied) {
    let _ = writeln!(out, "fmu = {}", quoted(&side.fmu));
    let parameters: Vec<String> = side
        .parameters
        .iter()
        .map(|(name, value)| {
            let value = match value {
                ParameterValue::Number(number) => format!("{number:?}"),
                ParameterValue::Boolean(flag) => flag.to_string(),
                ParameterValue::String(text) => quoted(text),
            };
            format!("{} = {value}", quoted(name))
        })
        .collect();
    if !parameters.is_empty() {
        let _ = writeln!(out, "parameters = {{ {} }}", parameters.join(", "));
    }
    for (table, map) in [("inputs", &side.inputs), ("outputs", &side.outputs)] {
        let entries: Vec<String> = map
            .iter()
            .map(|(name, connection)| {
                let offset = match connection.offset {
                    Offset::Value(value) => value,
                    Offset::Align => 0.0,
                };
                format!(
                    "{} = {{ variable = {}, factor = {:?}, offset = {offset:?} }}",
                    quoted(name),
                    quoted(&connection.variable),
                    connection.factor.unwrap_or(1.0)
                )
            })
            .collect();
        let _ = writeln!(out, "{table} = {{ {} }}", entries.join(", "));
    }
}
