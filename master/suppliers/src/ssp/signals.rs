//! Quantity carried by a connection between a line and a pantograph.
//!
//! The names of our own FMUs say it on either end. Else the unit tells heights from velocities and forces, and among
//! several of one kind the words in the names decide.

use fmi2::model_description::{Unit, Variable};

use super::document::Linear;

/// One end of a wire.
#[derive(Clone, Debug)]
pub(super) struct Tap {
    pub variable: String,
    /// As the connector or the FMU has it.
    pub unit: Option<Unit>,
    pub start: Option<f64>,
}

impl Tap {
    pub fn of(variable: &Variable, unit: Option<Unit>) -> Self {
        Self {
            variable: variable.name.clone(),
            unit,
            start: variable.real_start(),
        }
    }

    /// Last part of the name, in small letters.
    fn word(&self) -> String {
        let name = self.variable.trim_matches('\'').to_lowercase();
        name.rsplit(['.', '/']).next().unwrap_or_default().to_owned()
    }

    /// Name behind `strip[i].` or `contact[i].`, and i.
    pub fn structured(&self, table: &str) -> Option<(usize, &str)> {
        let (index, rest) = self.variable.strip_prefix(table)?.strip_prefix('[')?.split_once("].")?;
        Some((index.parse().ok()?, rest))
    }

    /// `SI = factor · value + offset`.
    pub fn to_si(&self) -> Linear {
        let base = self.unit.as_ref().and_then(|unit| unit.base);
        base.map_or(Linear::IDENTITY, |base| Linear {
            factor: base.factor,
            offset: base.offset,
        })
    }

    fn dimension(&self) -> Option<Dimension> {
        let exponents = self.unit.as_ref()?.base?.exponents;
        Some(match exponents[..3] {
            [0, 1, 0] => Dimension::Length,
            [0, 1, -1] => Dimension::Velocity,
            [1, 1, -2] => Dimension::Force,
            [0, 0, 1] => Dimension::Time,
            [0, 0, 0] if exponents[7] == 1 => Dimension::Angle,
            [0, 0, 0] => return None,
            _ => Dimension::Other,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Dimension {
    Length,
    Velocity,
    Force,
    Time,
    Angle,
    Other,
}

/// A connection between line and pantograph.
#[derive(Clone, Debug)]
pub(super) struct Wire {
    pub line: Tap,
    pub pantograph: Tap,
    /// From the source's value to the target's.
    pub map: Linear,
    pub at: usize,
}

impl Wire {
    fn dimension(&self) -> Option<Dimension> {
        self.line.dimension().or(self.pantograph.dimension())
    }

    fn says(&self, words: &[&str]) -> bool {
        [&self.line, &self.pantograph]
            .into_iter()
            .any(|tap| words.contains(&tap.word().as_str()))
    }
}

/// Words of the motion of a strip, the vertical direction first.
const MOTIONS: [(&str, Dimension, &[&str]); 7] = [
    (
        "z",
        Dimension::Length,
        &["z", "height", "hoehe", "höhe", "z_strip", "z_head", "zs"],
    ),
    (
        "vz",
        Dimension::Velocity,
        &["vz", "v", "velocity", "dz", "zd", "zdot", "z_dot", "der(z)"],
    ),
    ("x", Dimension::Length, &["x", "x_strip", "position_x", "pos_x"]),
    (
        "y",
        Dimension::Length,
        &["y", "lateral", "y_strip", "position_y", "pos_y"],
    ),
    ("vx", Dimension::Velocity, &["vx", "velocity_x", "der(x)"]),
    ("vy", Dimension::Velocity, &["vy", "velocity_y", "der(y)"]),
    ("roll", Dimension::Angle, &["roll", "phi", "angle"]),
];

/// Quantity of each wire from a pantograph to the line, by the names of [`strip`](component::exchange::strip).
///
/// # Errors
/// The wire that cannot be told.
pub(super) fn motions(wires: &[Wire]) -> Result<Vec<&'static str>, usize> {
    let known = |tap: &Tap| {
        let (_, name) = tap.structured("strip")?;
        MOTIONS
            .iter()
            .find(|(known, _, _)| *known == name)
            .map(|(known, _, _)| *known)
    };
    let mut names: Vec<Option<&str>> = wires
        .iter()
        .map(|wire| known(&wire.line).or_else(|| known(&wire.pantograph)))
        .collect();
    let dimension = |wire: &Wire| {
        let by_word = || {
            MOTIONS
                .iter()
                .find(|(_, _, words)| wire.says(words))
                .map(|(_, dimension, _)| *dimension)
        };
        wire.dimension().or_else(by_word)
    };
    for (vertical, wanted) in [("z", Dimension::Length), ("vz", Dimension::Velocity)] {
        let open: Vec<usize> = (0..wires.len())
            .filter(|&k| names[k].is_none() && dimension(&wires[k]) == Some(wanted))
            .collect();
        if let [only] = open[..]
            && !names.contains(&Some(vertical))
        {
            names[only] = Some(vertical);
        }
    }
    if wires.len() == 1 && names[0].is_none() && dimension(&wires[0]).is_none() {
        names[0] = Some("z");
    }
    for (k, wire) in wires.iter().enumerate() {
        if names[k].is_none() {
            let fits = |(name, wanted, words): &&(&'static str, Dimension, &[&str])| {
                dimension(wire) == Some(*wanted) && wire.says(words) && !names.contains(&Some(name))
            };
            names[k] = MOTIONS.iter().find(fits).map(|(name, _, _)| *name);
        }
    }
    told(&names)
}

/// Every wire must carry something, and no two the same.
fn told(names: &[Option<&'static str>]) -> Result<Vec<&'static str>, usize> {
    for (k, name) in names.iter().enumerate() {
        if name.is_none() || names[..k].contains(name) {
            return Err(k);
        }
    }
    Ok(names.iter().flatten().copied().collect())
}

/// Words of what a line does to a pantograph.
const LOADS: [(&str, Dimension, &[&str]); 7] = [
    ("fz", Dimension::Force, &["fz", "f_z", "force_z"]),
    ("fx", Dimension::Force, &["fx", "f_x", "force_x"]),
    ("fy", Dimension::Force, &["fy", "f_y", "force_y"]),
    (
        "force",
        Dimension::Force,
        &["force", "f", "f_c", "fc", "contact_force", "contactforce", "f_contact"],
    ),
    ("y", Dimension::Length, &["y", "lateral"]),
    ("x", Dimension::Length, &["x"]),
    ("time", Dimension::Time, &["time", "t"]),
];

/// Outputs of a line that say a force, with what they are the mean of.
const MEANS: [(&str, &str); 4] = [
    ("mean_fx", "fx"),
    ("mean_fy", "fy"),
    ("mean_fz", "fz"),
    ("mean_force", "force"),
];

/// Quantity of each wire from the line to a pantograph on the line's side: `force` is positive in compression, `fx`,
/// `fy`, `fz` act on the strip.
///
/// # Errors
/// The wire that cannot be told.
pub(super) fn loads(wires: &[Wire]) -> Result<Vec<&'static str>, usize> {
    let of_line = |tap: &Tap| {
        let (_, name) = tap.structured("contact")?;
        let name = MEANS
            .iter()
            .find(|(mean, _)| *mean == name)
            .map_or(name, |(_, name)| name);
        LOADS
            .iter()
            .find(|(known, _, _)| *known == name)
            .map(|(known, _, _)| *known)
    };
    // What the pantograph calls fz is the line's fz, or with another sign its contact force.
    let of_pantograph = |wire: &Wire| match of_line(&wire.pantograph)? {
        "fz" if wire.map.factor < 0.0 => Some("force"),
        "force" if wire.map.factor < 0.0 => Some("fz"),
        name => Some(name),
    };
    let mut names: Vec<Option<&str>> = wires
        .iter()
        .map(|wire| of_line(&wire.line).or_else(|| of_pantograph(wire)))
        .collect();
    let dimension = |wire: &Wire| {
        let by_word = || {
            LOADS
                .iter()
                .find(|(_, _, words)| wire.says(words))
                .map(|(_, dimension, _)| *dimension)
        };
        wire.dimension().or_else(by_word)
    };
    let open: Vec<usize> = (0..wires.len())
        .filter(|&k| names[k].is_none() && matches!(dimension(&wires[k]), Some(Dimension::Force) | None))
        .collect();
    if let [only] = open[..]
        && !names.iter().any(|name| matches!(name, Some("fz" | "force")))
    {
        names[only] = Some(vertical(&wires[only]));
    }
    for (k, wire) in wires.iter().enumerate() {
        if names[k].is_none() {
            let fits = |(name, wanted, words): &&(&'static str, Dimension, &[&str])| {
                dimension(wire) == Some(*wanted)
                    && words.contains(&wire.line.word().as_str())
                    && !names.contains(&Some(name))
            };
            names[k] = LOADS.iter().find(fits).map(|(name, _, _)| *name);
        }
    }
    told(&names)
}

/// Name of the one force of a line, contact force or force on the strip: by its name, then by the sign of the
/// value it starts with; pressing counts as positive where nothing is known.
fn vertical(wire: &Wire) -> &'static str {
    if LOADS[0].2.contains(&wire.line.word().as_str()) {
        return "fz";
    }
    if LOADS[3].2.contains(&wire.line.word().as_str()) {
        return "force";
    }
    let seen = wire.pantograph.start.map(|start| wire.map.inverse().apply(start));
    match wire.line.start.or(seen) {
        Some(start) if start < 0.0 => "fz",
        _ => "force",
    }
}

/// True for one of the two connections that every coupling needs, by its direction.
pub(super) fn is_vertical(name: &str) -> bool {
    matches!(name, "z" | "fz" | "force")
}
