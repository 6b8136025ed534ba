//! What this program's names in `inputs` and `outputs` stand for.

use component::exchange::{contact, load, strip};

/// Which side of the coupling an FMU is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// `[[pantograph]]`.
    Pantograph,
    /// `[catenary]`.
    Line,
}

/// Where a value goes to or comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// Entry of the flat slice of this side, times a sign.
    Entry(usize, f64),
    /// Entry of a line's outputs that belongs to a support, by its number (from 1).
    Uplift(usize),
    /// Time of the run, s.
    Time,
    /// Position of a pantograph along the track where no output says it, m.
    X,
    /// Accepted, and used by nothing.
    Unused,
}

/// Strip (from 0) and name behind the dot: `strip[2].vz` → (1, `vz`).
fn indexed<'a>(name: &'a str, table: &str) -> Option<(usize, &'a str)> {
    let (index, rest) = name.strip_prefix(table)?.strip_prefix('[')?.split_once("].")?;
    Some((index.parse::<usize>().ok()?.checked_sub(1)?, rest))
}

/// Place of an input.
pub(super) fn input(side: Side, name: &str) -> Place {
    match (side, name) {
        (_, "time") => Place::Time,
        (Side::Pantograph, "force") => Place::Entry(load::FZ, -1.0),
        (Side::Pantograph, "force_x") => Place::Entry(load::FX, 1.0),
        (Side::Pantograph, "force_y") => Place::Entry(load::FX + 1, 1.0),
        (Side::Pantograph, "force_z") => Place::Entry(load::FZ, 1.0),
        (Side::Pantograph, _) => Place::X,
        (Side::Line, name) => indexed(name, "strip")
            .and_then(|(i, name)| {
                let entry = strip::NAMES[..strip::MOTION].iter().position(|known| *known == name)?;
                Some(Place::Entry(i * strip::MOTION + entry, 1.0))
            })
            .unwrap_or(Place::Unused),
    }
}

/// Place of an output.
pub(super) fn output(side: Side, name: &str) -> Place {
    match side {
        Side::Pantograph => {
            let ours = match name {
                "height" => "z",
                "velocity" => "vz",
                other => other,
            };
            strip::NAMES[..strip::MOTION]
                .iter()
                .position(|known| *known == ours)
                .map_or(Place::Unused, |entry| Place::Entry(entry, 1.0))
        }
        Side::Line => {
            if let Some((k, "uplift")) = indexed(name, "support") {
                return Place::Uplift(k + 1);
            }
            let Some((i, name)) = indexed(name, "contact") else {
                return Place::Unused;
            };
            // The mean of the force is that of its vertical component on a level strip.
            let (name, sign) = if name == "mean_force" {
                ("mean_fz", -1.0)
            } else {
                (name, 1.0)
            };
            contact::NAMES
                .iter()
                .position(|known| *known == name)
                .map_or(Place::Unused, |entry| Place::Entry(i * contact::COUNT + entry, sign))
        }
    }
}

/// Strip (from 0) that a name of a line's wiring belongs to.
pub(super) fn strip_of(name: &str) -> Option<usize> {
    indexed(name, "strip")
        .or_else(|| indexed(name, "contact"))
        .map(|(i, _)| i)
}

/// SI unit of a quantity; `None` where it has none.
#[must_use]
pub fn unit(side: Side, name: &str) -> Option<&'static str> {
    let last = name.split_once("].").map_or(name, |(_, rest)| rest);
    Some(match (side, last) {
        (_, "time") => "s",
        (_, "roll") => "rad",
        (_, "roll_rate") => "rad/s",
        (_, "work") => "J",
        (_, "closed") => return None,
        (_, "velocity" | "vx" | "vy" | "vz" | "wire.vz") => "m/s",
        (_, name) if name.starts_with('f') || name.starts_with("mean_") || name.starts_with("sample[") => "N",
        _ => "m",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_find_their_place_and_unit() {
        assert_eq!(input(Side::Pantograph, "force"), Place::Entry(load::FZ, -1.0));
        assert_eq!(output(Side::Pantograph, "velocity"), Place::Entry(strip::VZ, 1.0));
        assert_eq!(output(Side::Pantograph, "roll_rate"), Place::Unused);
        let second = strip::MOTION + strip::VZ;
        assert_eq!(input(Side::Line, "strip[2].vz"), Place::Entry(second, 1.0));
        let mean = contact::COUNT + contact::MEAN_FZ;
        assert_eq!(output(Side::Line, "contact[2].mean_force"), Place::Entry(mean, -1.0));
        assert_eq!(output(Side::Line, "support[7].uplift"), Place::Uplift(7));
        assert_eq!(output(Side::Line, "contact[1].closed"), Place::Unused);
        assert_eq!(strip_of("contact[3].wire.z"), Some(2));
        for (side, name, expected) in [
            (Side::Pantograph, "force_x", "N"),
            (Side::Pantograph, "height", "m"),
            (Side::Pantograph, "x", "m"),
            (Side::Pantograph, "roll_rate", "rad/s"),
            (Side::Line, "contact[1].wire.vz", "m/s"),
            (Side::Line, "contact[1].wire.z", "m"),
            (Side::Line, "contact[1].mean_fz", "N"),
            (Side::Line, "contact[1].sample[3]", "N"),
            (Side::Line, "strip[1].vx", "m/s"),
            (Side::Line, "support[4].uplift", "m"),
        ] {
            assert_eq!(unit(side, name), Some(expected), "{name}");
        }
    }
}
