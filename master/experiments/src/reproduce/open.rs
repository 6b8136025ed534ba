//! What the thesis leaves open, and the range each such quantity plausibly has.

use super::plan::Mesh;

/// A quantity that the thesis does not give, with values over its plausible range.
pub struct Open {
    /// What it is called.
    pub quantity: &'static str,
    /// Number of the published case that it is changed in.
    pub case: usize,
    /// Its values.
    pub values: Values,
    /// Why these.
    pub range: &'static str,
    /// Why it is not changed on the converged mesh; nothing where it is.
    pub thesis_mesh_only: Option<&'static str>,
}

/// Values of an open quantity.
pub enum Values {
    /// Of one key of the scene.
    Of {
        /// The key.
        key: &'static str,
        /// Its unit.
        unit: &'static str,
        /// As they are typed.
        values: &'static [&'static str],
    },
    /// Keys that change together, as they are typed, and what that is called.
    Together(&'static [(&'static str, &'static [&'static str])]),
}

/// One value of an open quantity.
pub struct Value {
    /// In words, with its unit.
    pub name: String,
    /// Keys as they are typed, `key=value`.
    pub keys: Vec<String>,
}

impl Open {
    /// Its values, one run for each.
    #[must_use]
    pub fn values(&self) -> Vec<Value> {
        match &self.values {
            Values::Of { key, unit, values } => {
                let value = |value: &&str| Value {
                    name: format!("{} {unit}", value.trim_matches('"')).trim_end().to_owned(),
                    keys: vec![format!("{key}={value}")],
                };
                values.iter().map(value).collect()
            }
            Values::Together(all) => {
                let value = |(name, keys): &(&str, &[&str])| Value {
                    name: (*name).to_owned(),
                    keys: keys.iter().map(ToString::to_string).collect(),
                };
                all.iter().map(value).collect()
            }
        }
    }

    /// Whether it is changed on this mesh.
    #[must_use]
    pub fn is_on(&self, mesh: Mesh) -> bool {
        mesh == Mesh::ALL[0] || (mesh == Mesh::Corrected && self.thesis_mesh_only.is_none())
    }
}
