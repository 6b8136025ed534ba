//! `[contact]`: the law between contact wire and collector strip.

use crate::choice::choice;
use crate::keys::{Entry, Keys, Number, Sentences};

/// `[contact]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Kind of law.
    pub law: ContactLaw,
    /// `k`, N/m, positive; infinite under a sliding joint.
    pub stiffness: f64,
    /// `c`, N·s/m, not negative; zero under a sliding joint.
    pub damping: f64,
}

choice! {
    /// `contact.law`.
    pub enum ContactLaw {
        /// A unilateral spring and damper on the penetration.
        Penalty = "penalty",
        /// The strip is held on the wire.
        SlidingJoint = "sliding_joint",
    }
    unavailable: []
}

impl Contact {
    /// The penalty law: a spring of `stiffness` N/m and a damper of `damping` N·s/m on the penetration.
    #[must_use]
    pub fn penalty(stiffness: f64, damping: f64) -> Self {
        Self {
            law: ContactLaw::Penalty,
            stiffness,
            damping,
        }
    }

    /// A strip that is held on the wire.
    #[must_use]
    pub fn sliding_joint() -> Self {
        Self {
            law: ContactLaw::SlidingJoint,
            stiffness: f64::INFINITY,
            damping: 0.0,
        }
    }
}

/// The keys of the penalty law.
struct Penalty {
    stiffness: f64,
    damping: f64,
}

impl Entry for Penalty {
    const SENTENCES: Sentences = &[
        ("stiffness", "Contact stiffness; left out under a sliding joint."),
        ("damping", "Contact damping; left out under a sliding joint."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            stiffness: keys.number("stiffness", was.map(|law| law.stiffness), Number::positive("N/m")),
            damping: keys.number("damping", was.map(|law| law.damping), Number::not_negative("N s/m")),
        }
    }
}

impl Entry for Contact {
    const SENTENCES: Sentences = &[(
        "law",
        "Contact law: a unilateral spring and damper on the penetration, or a strip held on the wire.",
    )];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let law = keys.word("law", was.map(|contact| contact.law), None);
        let Penalty { stiffness, damping } = match law {
            ContactLaw::Penalty => {
                let was = was.map(|&Self { stiffness, damping, .. }| Penalty { stiffness, damping });
                keys.part(was.as_ref())
            }
            ContactLaw::SlidingJoint => {
                keys.leave_out::<Penalty>(
                    "contact.law is \"sliding_joint\", which holds the strip on the wire without a spring",
                );
                Penalty {
                    stiffness: f64::INFINITY,
                    damping: 0.0,
                }
            }
        };
        Self {
            law,
            stiffness,
            damping,
        }
    }
}
