//! Meaning of this program's names in `inputs` and `outputs`: values and units, read from the table of signals.

use component::DeclaredSignal;
use component::exchange::{contact, instrument, load, strip, support};

/// Side of the coupling that an FMU takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// `[[pantograph]]`.
    Pantograph,
    /// `[catenary]`.
    Line,
    /// `[[controller]]`.
    Controller,
}

/// Value behind a name of this program in the wiring of an FMU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum WiredValue {
    /// Entry of the flat slice of this side, times a sign.
    Entry(usize, f64),
    /// Entry of a line's outputs that belongs to a support, by the support's number (from 1).
    Uplift(usize),
    /// Time of the run, s.
    Time,
    /// Position of a pantograph along the track where no output gives the position, m.
    X,
    /// Accepted, and used by nothing.
    Unused,
}

/// Name of this program in the wiring of an FMU: value and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Quantity {
    value: WiredValue,
    unit: Option<&'static str>,
}

impl Quantity {
    /// Value and unit of entry `index` of a table of signals; `sign` turns the entry into the value of this name.
    fn of(signals: &[DeclaredSignal], index: usize, sign: f64) -> Self {
        Self {
            value: WiredValue::Entry(index, sign),
            unit: signals[index].unit(),
        }
    }

    /// Accepted, and used by nothing.
    fn unused(unit: Option<&'static str>) -> Self {
        let value = WiredValue::Unused;
        Self { value, unit }
    }

    fn input(side: Side, name: &str) -> Option<Self> {
        Some(match (side, name) {
            (_, "time") => Self {
                value: WiredValue::Time,
                unit: Some("s"),
            },
            (Side::Pantograph, "force") => Self::of(&load::SIGNALS, load::FZ, -1.0),
            (Side::Pantograph, "force_x") => Self::of(&load::SIGNALS, load::FX, 1.0),
            (Side::Pantograph, "force_y") => Self::of(&load::SIGNALS, load::FY, 1.0),
            (Side::Pantograph, "force_z") => Self::of(&load::SIGNALS, load::FZ, 1.0),
            (Side::Pantograph, "x") => Self {
                value: WiredValue::X,
                unit: strip::SIGNALS[strip::X].unit(),
            },
            (Side::Controller, "force") => Self::of(&instrument::SIGNALS, instrument::FORCE, 1.0),
            (Side::Controller, "desired_force") => Self::of(&instrument::SIGNALS, instrument::DESIRED, 1.0),
            (Side::Controller, "velocity") => Self::of(&instrument::SIGNALS, instrument::VELOCITY, 1.0),
            (Side::Controller, "position") => Self::of(&instrument::SIGNALS, instrument::POSITION, 1.0),
            (Side::Controller, "head_height") => Self::of(&instrument::SIGNALS, instrument::HEAD_HEIGHT, 1.0),
            (Side::Controller, "head_velocity") => Self::of(&instrument::SIGNALS, instrument::HEAD_VELOCITY, 1.0),
            (Side::Controller, "head_acceleration") => {
                Self::of(&instrument::SIGNALS, instrument::HEAD_ACCELERATION, 1.0)
            }
            (Side::Pantograph | Side::Controller, _) => return None,
            (Side::Line, name) => {
                let (i, name) = indexed(name, strip::GROUP)?;
                let entry = found(&strip::SIGNALS[..strip::MOTION], name)?;
                Self {
                    value: WiredValue::Entry(i * strip::MOTION + entry, 1.0),
                    unit: strip::SIGNALS[entry].unit(),
                }
            }
        })
    }

    fn output(side: Side, name: &str) -> Option<Self> {
        let motion = &strip::SIGNALS[..strip::MOTION];
        Some(match (side, name) {
            (Side::Pantograph, "height") => Self::of(motion, strip::Z, 1.0),
            (Side::Pantograph, "velocity") => Self::of(motion, strip::VZ, 1.0),
            // A line takes the rate of the roll itself.
            (Side::Pantograph, "roll_rate") => Self::unused(Some("rad/s")),
            (Side::Pantograph, name) => Self::of(motion, found(motion, name)?, 1.0),
            (Side::Controller, "command") => Self {
                value: WiredValue::Entry(0, 1.0),
                unit: Some("N"),
            },
            (Side::Controller, _) => return None,
            (Side::Line, name) => {
                if let Some((k, name)) = indexed(name, support::GROUP) {
                    let entry = found(&support::SIGNALS, name)?;
                    return Some(Self {
                        value: WiredValue::Uplift(k + 1),
                        unit: support::SIGNALS[entry].unit(),
                    });
                }
                let (i, name) = indexed(name, contact::GROUP)?;
                let entry = found(&contact::SIGNALS, name)?;
                let unit = contact::SIGNALS[entry].unit();
                let first = i * contact::COUNT;
                let value = match entry {
                    // The mean of the force is that of its vertical component on a level strip.
                    contact::MEAN_FORCE => WiredValue::Entry(first + contact::MEAN_FZ, -1.0),
                    entry if entry < contact::COUNT => WiredValue::Entry(first + entry, 1.0),
                    _ => WiredValue::Unused,
                };
                Self { value, unit }
            }
        })
    }
}

/// Index of the signal of this name.
fn found(signals: &[DeclaredSignal], name: &str) -> Option<usize> {
    signals.iter().position(|signal| signal.name == name)
}

/// Strip (from 0) and name behind the dot: `strip[2].vz` → (1, `vz`).
fn indexed<'a>(name: &'a str, group: &str) -> Option<(usize, &'a str)> {
    let (index, rest) = name.strip_prefix(group)?.strip_prefix('[')?.split_once("].")?;
    Some((index.parse::<usize>().ok()?.checked_sub(1)?, rest))
}

/// Value of an input.
pub(super) fn input(side: Side, name: &str) -> WiredValue {
    Quantity::input(side, name).map_or(WiredValue::Unused, |quantity| quantity.value)
}

/// Value of an output.
pub(super) fn output(side: Side, name: &str) -> WiredValue {
    Quantity::output(side, name).map_or(WiredValue::Unused, |quantity| quantity.value)
}

/// Signal of the pantograph behind a name in the wiring of a controller; none for the time.
pub(super) fn instrument_of(name: &str) -> Option<&'static str> {
    match input(Side::Controller, name) {
        WiredValue::Entry(index, _) => instrument::SIGNALS.get(index).map(|signal| signal.name),
        _ => None,
    }
}

/// Strip (from 0) to which a name of a line's wiring belongs.
pub(super) fn strip_of(name: &str) -> Option<usize> {
    indexed(name, strip::GROUP)
        .or_else(|| indexed(name, contact::GROUP))
        .map(|(i, _)| i)
}

/// SI unit of a quantity; `None` for a Boolean, and for a name without meaning.
#[must_use]
pub fn unit(side: Side, name: &str) -> Option<&'static str> {
    Quantity::input(side, name)
        .or_else(|| Quantity::output(side, name))
        .and_then(|quantity| quantity.unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_find_their_place_and_unit() {
        assert_eq!(input(Side::Pantograph, "force"), WiredValue::Entry(load::FZ, -1.0));
        assert_eq!(output(Side::Pantograph, "velocity"), WiredValue::Entry(strip::VZ, 1.0));
        assert_eq!(output(Side::Pantograph, "roll_rate"), WiredValue::Unused);
        let second = strip::MOTION + strip::VZ;
        assert_eq!(input(Side::Line, "strip[2].vz"), WiredValue::Entry(second, 1.0));
        let mean = contact::COUNT + contact::MEAN_FZ;
        assert_eq!(
            output(Side::Line, "contact[2].mean_force"),
            WiredValue::Entry(mean, -1.0)
        );
        assert_eq!(output(Side::Line, "support[7].uplift"), WiredValue::Uplift(7));
        assert_eq!(output(Side::Line, "contact[1].closed"), WiredValue::Unused);
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
            (Side::Line, "contact[1].mean_force", "N"),
            (Side::Line, "contact[2].work", "J"),
            (Side::Line, "support[4].uplift", "m"),
            (Side::Line, "time", "s"),
            (Side::Controller, "force", "N"),
            (Side::Controller, "head_acceleration", "m/s2"),
            (Side::Controller, "command", "N"),
        ] {
            assert_eq!(unit(side, name), Some(expected), "{name}");
        }
        assert_eq!(unit(Side::Line, "contact[1].closed"), None);
        assert_eq!(unit(Side::Line, "fence[1].height"), None, "no unit is guessed");
    }
}
