//! Which keys of a scene are to be looked at where its statics find no answer.

use catenary::{CatenaryError, StaticsError};
use scene::{PantographModel, Scene};

use crate::SetupError;
use system::equilibrium::EquilibriumError;

/// A key of a scene that the statics hang on.
struct Suspect {
    key: String,
    value: f64,
    unit: &'static str,
    /// Values that lines and pantographs have.
    usual: (f64, f64),
}

impl Suspect {
    fn new(key: impl Into<String>, value: f64, unit: &'static str, usual: (f64, f64)) -> Self {
        let key = key.into();
        Self {
            key,
            value,
            unit,
            usual,
        }
    }

    fn is_unusual(&self) -> bool {
        let (least, most) = self.usual;
        !(least..=most).contains(&self.value)
    }

    /// `key = value unit`.
    fn shown(&self) -> String {
        format!("{} = {} {}", self.key, short(self.value), self.unit)
    }
}

/// A number with few digits.
fn short(value: f64) -> String {
    if (1e-3..1e6).contains(&value.abs()) || value == 0.0 {
        format!("{}", (1e6 * value).round() / 1e6)
    } else {
        format!("{value:e}")
    }
}

/// The keys that the rest of line and pantographs hangs on most; none of a supplied line.
fn statics_hints(scene: &Scene) -> Vec<Suspect> {
    let Some((line, contact)) = scene.modelled_line() else {
        return Vec::new();
    };
    let of = |key: &str, value, unit, usual| Suspect::new(format!("catenary.{key}"), value, unit, usual);
    let largest = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let geometry = line.first();
    let (tension, mass) = ((3e3, 5e4), (0.2, 3.0));
    let mut all = vec![
        of("span_length", largest(&geometry.span_lengths), "m", (20.0, 100.0)),
        of("presag", largest(&geometry.presag), "m", (-0.2, 0.2)),
        of("contact_wire.tension", line.contact_wire.tension, "N", tension),
        of(
            "contact_wire.mass_per_length",
            line.contact_wire.mass_per_length,
            "kg/m",
            mass,
        ),
        of("droppers.stiffness", line.droppers.stiffness, "N/m", (1e3, 1e8)),
    ];
    if let Some(wire) = &line.messenger_wire {
        all.push(of("encumbrance", largest(&geometry.encumbrance), "m", (0.3, 3.0)));
        all.push(of("messenger_wire.tension", wire.tension, "N", tension));
        all.push(of("messenger_wire.mass_per_length", wire.mass_per_length, "kg/m", mass));
    }
    // A sliding joint has no spring.
    if contact.stiffness.is_finite() {
        all.push(Suspect::new("contact.stiffness", contact.stiffness, "N/m", (1e3, 1e8)));
    }
    for (index, pantograph) in scene.pantographs.iter().enumerate() {
        let (key, force, most) = match &pantograph.model {
            PantographModel::Lumped(lumped) => ("static_force", lumped.static_force, 500.0),
            PantographModel::Linkage(linkage) => ("uplift.force", linkage.uplift.force, 5e3),
            PantographModel::Supplied(_) => continue,
        };
        let key = format!("pantograph[{}].{key}", index + 1);
        all.push(Suspect::new(key, force, "N", (0.0, most)));
    }
    all
}

/// Those that are unusual, or else all of them, in words; empty where there is none.
fn named(scene: &Scene) -> String {
    let all = statics_hints(scene);
    let unusual: Vec<String> = (all.iter())
        .filter(|suspect| suspect.is_unusual())
        .map(|suspect| {
            let (least, most) = suspect.usual;
            let range = format!("{} to {} {}", short(least), short(most), suspect.unit);
            format!("{}: unusual, {range} are usual", suspect.shown())
        })
        .collect();
    if unusual.is_empty() {
        let all: Vec<String> = all.iter().map(Suspect::shown).collect();
        return format!("look first at {} and catenary.droppers.positions", all.join(", "));
    }
    unusual.join("; ")
}

/// True where an error says only that equations did not come to rest, without a value in the way.
fn is_mute(error: &SetupError) -> bool {
    let of_statics = |error: &StaticsError| {
        matches!(
            error,
            StaticsError::NoEquilibrium(_) | StaticsError::FormNotFound { .. }
        )
    };
    let of_line = |error: &CatenaryError| match error {
        CatenaryError::Statics(error) => of_statics(error),
        error => matches!(error, CatenaryError::Settling(_)),
    };
    match error {
        SetupError::Line(error) => of_line(error),
        SetupError::Equilibrium(EquilibriumError::Line(error)) => of_line(error),
        SetupError::Equilibrium(EquilibriumError::Wire { source, .. }) => of_statics(source),
        SetupError::Equilibrium(EquilibriumError::NotConverged { .. }) => true,
        _ => false,
    }
}

/// An error of the statics of a scene with the keys that may be to blame, where it names none itself.
#[must_use]
pub fn with_suspects(error: SetupError, scene: &Scene) -> SetupError {
    if !is_mute(&error) || scene.modelled_line().is_none() {
        return error;
    }
    SetupError::NoStatics {
        statics_hints: named(scene),
        source: Box::new(error),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use cosim::chain;

    use crate::prepare;

    /// Hint for the standard's scene on three spans with this key.
    fn said(key: &str) -> String {
        let text = include_str!("../../../scenes/en50318-300.toml");
        let keys = [
            "catenary.spans=3",
            "run.duration=1",
            "run.evaluate={ time = [0, 1] }",
            key,
        ];
        let scene = system::load(text, "scene.toml", &keys.map(str::to_owned)).unwrap();
        let refused = prepare(scene, "scene", Path::new("."), false).err().unwrap();
        assert!(refused.is_input());
        chain(&refused)
    }

    #[test]
    fn statics_without_an_answer_name_the_key_that_is_unusual() {
        for (key, name) in [
            (
                "catenary.droppers.stiffness=1e12",
                "catenary.droppers.stiffness = 1e12 N/m: unusual, 1000 to 1e8 N/m are usual: ",
            ),
            (
                "pantograph[1].static_force=1000",
                "pantograph[1].static_force = 1000 N: unusual, 0 to 500 N are usual: ",
            ),
        ] {
            let said = said(key);
            assert!(
                said.starts_with(name) && said.contains("no equilibrium at t = 0"),
                "{said}"
            );
        }
    }

    #[test]
    fn where_nothing_is_unusual_all_of_them_are_named() {
        let text = include_str!("../../../scenes/thesis-pantograph.toml");
        let scene = system::load(text, "scene.toml", &[]).unwrap();
        let named = named(&scene);
        assert!(
            named.starts_with("look first at catenary.span_length = 56.25 m, ")
                && named.contains("pantograph[1].uplift.force = "),
            "{named}"
        );
    }
}
