//! `[model]`: what is left out to be faster.

use crate::choice::choice;
use crate::keys::{Entry, Keys};

/// `[model]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// Reductions in use, without repetition; empty is the full model. `"auto"` is already resolved.
    pub reductions: Vec<Reduction>,
}

choice! {
    /// An entry of `model.reduce`.
    pub enum Reduction {
        /// No lateral coordinates.
        Planar = "planar",
        /// The line linearised about its static state.
        Linearised = "linearised",
        /// The line as straight wires with small slopes.
        Flat = "flat",
        /// Only the spans around the pantographs.
        Window = "window",
        /// The mechanism reduced to its one motion.
        Linkage = "linkage",
    }
    unavailable: ["planar", "linearised", "flat", "window", "linkage"]
}

impl Entry for Model {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            reductions: keys.words("reduce", was.map(|model| model.reductions.as_slice())),
        }
    }
}
