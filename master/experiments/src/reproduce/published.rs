//! Published figures of the thesis: data in `published.toml`.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::engine::entries;

/// A printed number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "String")]
pub struct Figure {
    /// Its value.
    pub value: f64,
    /// Decimals that are printed.
    decimals: usize,
}

impl From<String> for Figure {
    fn from(printed: String) -> Self {
        let decimals = printed.split('.').nth(1).map_or(0, str::len);
        let value = printed.parse().expect("a printed number");
        Self { value, decimals }
    }
}

impl Figure {
    /// As it is printed.
    pub(super) fn printed(&self) -> String {
        format!("{:.*}", self.decimals, self.value)
    }
}

/// One of the published cases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of the scene that computes it.
    pub scene: String,
    /// Title.
    pub title: String,
    /// Mean contact force, N, positive in compression: the thesis prints the force on the pan-head as negative.
    pub mean: Figure,
    /// Standard deviation, N.
    pub std: Figure,
    /// Place in the thesis.
    pub source: String,
}

/// The published cases; the first is the one that the others are changes of.
pub static CASES: LazyLock<Vec<Case>> = LazyLock::new(|| entries(include_str!("published.toml")));
