//! Quantities that the thesis leaves open, and their plausible ranges: data in `open.toml`.

use std::sync::LazyLock;

use serde::Deserialize;

use super::plan::Mesh;
use crate::engine::entries;

/// A quantity that the thesis does not give, with values over its plausible range.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Open {
    /// Its name.
    pub quantity: String,
    /// Number of the published case that it is changed in.
    pub case: usize,
    /// The key of the scene that it is; empty where several change together.
    #[serde(default)]
    key: String,
    /// Unit of the key's values; empty where they have none.
    #[serde(default)]
    unit: String,
    /// Values of the key, as they are typed.
    #[serde(default)]
    values: Vec<String>,
    /// Keys that change together.
    #[serde(default)]
    together: Vec<Value>,
    /// Reason of these values.
    pub range: String,
    /// Reason why the converged mesh keeps the scene's own value; nothing where it does not.
    pub thesis_mesh_only: Option<String>,
}

/// One value of an open quantity.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Value {
    /// In words, with its unit.
    pub name: String,
    /// Keys as they are typed, `key=value`.
    pub keys: Vec<String>,
}

/// All of them. The scene's own value is computed by the case itself.
pub static OPEN: LazyLock<Vec<Open>> = LazyLock::new(|| entries(include_str!("open.toml")));

impl Open {
    /// Its values, one run for each.
    pub(super) fn values(&self) -> Vec<Value> {
        let value = |value: &String| Value {
            name: format!("{} {}", value.trim_matches('"'), self.unit)
                .trim_end()
                .to_owned(),
            keys: vec![format!("{}={value}", self.key)],
        };
        self.values
            .iter()
            .map(value)
            .chain(self.together.iter().cloned())
            .collect()
    }

    /// `true` where it is changed on this mesh.
    pub(super) fn is_on(&self, mesh: Mesh) -> bool {
        mesh == Mesh::ALL[0] || (mesh == Mesh::Corrected && self.thesis_mesh_only.is_none())
    }
}
