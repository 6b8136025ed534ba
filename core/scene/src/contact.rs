//! `[contact]`: the law between contact wire and collector strip.

use crate::choice::choice;
use crate::keys::{Entry, Keys, Number};

/// `[contact]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Kind of law.
    pub law: ContactLaw,
    /// `k`, N/m, positive.
    pub stiffness: f64,
    /// `c`, N·s/m, not negative.
    pub damping: f64,
}

choice! {
    /// `contact.law`.
    pub enum ContactLaw {
        /// A unilateral spring and damper on the penetration.
        Penalty = "penalty",
    }
    unavailable: ["sliding_joint"]
}

impl Entry for Contact {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            law: keys.word("law", was.map(|contact| contact.law), None),
            stiffness: keys.number(
                "stiffness",
                was.map(|contact| contact.stiffness),
                Number::positive("N/m"),
            ),
            damping: keys.number(
                "damping",
                was.map(|contact| contact.damping),
                Number::not_negative("N s/m"),
            ),
        }
    }
}
