//! `[model]`: what is left out to be faster.

use crate::choice::choice;
use crate::keys::{Entry, Keys};

/// `[model]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// Reductions in use, without repetition; empty is the full model. `"auto"` is already resolved.
    pub reductions: Vec<Reduction>,
    /// Whether `reduce` is `"auto"` and still to be resolved; only while a scene is read.
    pub(crate) unresolved: bool,
}

impl Model {
    /// Whether a reduction is in use.
    #[must_use]
    pub fn has(&self, reduction: Reduction) -> bool {
        self.reductions.contains(&reduction)
    }
}

choice! {
    /// An entry of `model.reduce`.
    pub enum Reduction {
        /// No lateral coordinates of the line: exact where nothing pushes it sideways.
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
    unavailable: ["linearised", "flat", "window"]
}

impl Entry for Model {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let chosen = keys.words("reduce", was.map(|model| model.reductions.as_slice()));
        Self {
            unresolved: chosen.is_none(),
            reductions: chosen.unwrap_or_default(),
        }
    }
}
