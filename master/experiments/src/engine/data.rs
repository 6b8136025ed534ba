//! Data files of experiments, parts of the program.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;

/// Entries of a file that is one list.
pub(crate) fn entries<T: DeserializeOwned>(text: &str) -> Vec<T> {
    let file: BTreeMap<String, Vec<T>> = toml::from_str(text).expect("part of the program, and tests read it");
    file.into_values().flatten().collect()
}
