//! `strips` and `pitch` of a lumped pantograph: a head with several strips.

use crate::check::{Found, refuse};
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::write::shown_number;

/// Longest distance of a strip from the middle of the head, m: a value beyond is a slip of the unit.
const HALF_HEAD: f64 = 2.0;

/// `[[pantograph.strips]]`: a collector strip of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadStrip {
    /// Place along the track from the middle of the head, m, positive ahead.
    pub x: f64,
    /// Mass and spring under the strip; none for a strip that is fixed to the head.
    pub spring: Option<StripSpring>,
}

/// Own suspension of a strip on the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StripSpring {
    /// Mass of the strip, kg, positive.
    pub mass: f64,
    /// Spring between strip and head, N/m, positive.
    pub stiffness: f64,
    /// Damper between strip and head, N·s/m, not negative.
    pub damping: f64,
}

/// `pantograph.pitch`: rotation of a head with strips fixed to it about its lateral axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadPitch {
    /// Moment of inertia about the lateral axis through the middle of the head, kg·m², positive.
    pub inertia: f64,
    /// Rotational spring between head and what carries it, N·m/rad, not negative.
    pub stiffness: f64,
    /// Rotational damper, N·m·s/rad, not negative.
    pub damping: f64,
}

impl HeadStrip {
    /// A strip at `x` m that is fixed to the head.
    #[must_use]
    pub fn fixed(x: f64) -> Self {
        Self { x, spring: None }
    }
}

impl Entry for HeadStrip {
    const SENTENCES: Sentences = &[
        (
            "x",
            "Place of the strip along the track from the middle of the head, positive ahead.",
        ),
        (
            "mass",
            "Mass of a strip on a spring of its own; left out with `stiffness` for a strip that is fixed to the head.",
        ),
        ("stiffness", "Spring between the strip and the head."),
        (
            "damping",
            "Damper between the strip and the head; 0 where left out beside a spring.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let spring = was.map(|strip| strip.spring);
        let own = |of: fn(&StripSpring) -> f64| spring.map(|spring| spring.as_ref().map(of));
        let x = keys.number("x", was.map(|strip| strip.x), Number::any("m"));
        let mass = keys.optional_number("mass", own(|spring| spring.mass), Number::positive("kg"));
        let stiffness = keys.optional_number("stiffness", own(|spring| spring.stiffness), Number::positive("N/m"));
        let damping = keys.optional_number("damping", own(|spring| spring.damping), Number::not_negative("N s/m"));
        let spring = match (mass, stiffness) {
            (Some(mass), Some(stiffness)) => Some(StripSpring {
                mass,
                stiffness,
                damping: damping.unwrap_or(0.0),
            }),
            (Some(_), None) => {
                keys.refuse(
                    "mass",
                    "must have stiffness (N/m) beside it, the spring that carries the strip",
                );
                None
            }
            (None, Some(_)) => {
                keys.refuse(
                    "stiffness",
                    "must have mass (kg) beside it, that of the strip on the spring",
                );
                None
            }
            (None, None) => {
                if damping.is_some() {
                    let expected = "must be left out, or mass (kg) and stiffness (N/m) of the strip be given";
                    keys.refuse("damping", expected);
                }
                None
            }
        };
        Self { x, spring }
    }
}

impl Entry for HeadPitch {
    const SENTENCES: Sentences = &[
        (
            "inertia",
            "Moment of inertia of the head about the lateral axis through its middle.",
        ),
        ("stiffness", "Rotational spring between the head and what carries it."),
        ("damping", "Rotational damper."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            inertia: keys.number("inertia", was.map(|pitch| pitch.inertia), Number::positive("kg m²")),
            stiffness: keys.number(
                "stiffness",
                was.map(|pitch| pitch.stiffness),
                Number::not_negative("N m/rad"),
            ),
            damping: keys.number(
                "damping",
                was.map(|pitch| pitch.damping),
                Number::not_negative("N m s/rad").default(0.0),
            ),
        }
    }
}

/// Refuses strips that one head cannot carry; `path` is that of the pantograph.
pub(crate) fn check(strips: &[HeadStrip], pitch: Option<&HeadPitch>, path: &str, found: &mut Found) {
    for (i, strip) in strips.iter().enumerate() {
        let key = format!("{path}.strips[{}].x", i + 1);
        if strip.x.abs() > HALF_HEAD {
            let expected = format!("must be within ±{HALF_HEAD} m of the middle of the head, in m");
            refuse(found, key, shown_number(strip.x, "m"), expected);
        } else if let Some(other) = strips[..i].iter().position(|other| other.x == strip.x) {
            let expected = format!(
                "must differ from strips[{}].x: two strips are not in one place",
                other + 1
            );
            refuse(found, key, shown_number(strip.x, "m"), expected);
        }
    }
    let sprung = strips.iter().filter(|strip| strip.spring.is_some()).count();
    if sprung > 0 && sprung < strips.len() {
        let fixed = strips.iter().position(|strip| strip.spring.is_none()).unwrap_or(0);
        let expected = "must be given: the other strips of the head are on springs of their own (or leave out mass, \
                        stiffness and damping of all)";
        refuse(
            found,
            format!("{path}.strips[{}].mass", fixed + 1),
            "left out",
            expected,
        );
    }
    if pitch.is_none() {
        return;
    }
    if sprung > 0 {
        let expected = "must be left out: strips on springs of their own follow the wire one by one";
        refuse(found, format!("{path}.pitch"), "{ … }", expected);
    } else if strips.len() < 2 {
        let expected = "must be left out, or strips have two or more places: one strip exerts no moment on the head";
        refuse(found, format!("{path}.pitch"), "{ … }", expected);
    }
}
