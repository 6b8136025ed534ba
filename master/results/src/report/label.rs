//! Names of runs that stand on one page: the scene, and what differs between the runs.

use std::collections::BTreeMap;
use std::ops::Deref;

use crate::RunBundle;

/// Most differing scene keys that a name spells out; more would hide the curves behind the legend.
const MOST_KEYS: usize = 3;

/// Keys that a name leaves out: said otherwise, free text, or resolved from other keys.
const UNSPOKEN: [&str; 4] = ["title", "source", "run.speed_kmh", "coupling.algorithm"];

/// A run with its name on the page.
pub(super) struct NamedRun<'a> {
    /// The name.
    pub label: String,
    /// The run.
    pub bundle: &'a RunBundle,
}

impl Deref for NamedRun<'_> {
    type Target = RunBundle;

    fn deref(&self) -> &RunBundle {
        self.bundle
    }
}

/// The runs with their names.
pub(super) fn named(runs: &[RunBundle]) -> Vec<NamedRun<'_>> {
    let named = |(bundle, label)| NamedRun { label, bundle };
    runs.iter().zip(labels(runs)).map(named).collect()
}

/// Names of runs on one page, one per run, no two of them equal.
///
/// A single run is named after scene and mode. Of several runs each is named after its scene and, in brackets, what
/// differs: mode, algorithm, speed, then keys of the resolved scene.
#[must_use]
pub fn labels(runs: &[RunBundle]) -> Vec<String> {
    let [_, _, ..] = runs else {
        return runs.iter().map(|run| run.summary.label()).collect();
    };
    let aspects: Vec<[String; 3]> = runs.iter().map(aspects).collect();
    let differs = |aspect: usize| aspects.iter().any(|own| own[aspect] != aspects[0][aspect]);
    let spoken: Vec<usize> = (0..3).filter(|aspect| differs(*aspect)).collect();
    let scenes: Vec<BTreeMap<String, String>> = runs.iter().map(|run| keys(&run.scene)).collect();
    let (shown, left_out) = differing(&scenes);
    let one_name = runs.iter().all(|run| run.summary.scene == runs[0].summary.scene);
    let labels = (0..runs.len()).map(|index| {
        let mut parts: Vec<String> = spoken.iter().map(|aspect| aspects[index][*aspect].clone()).collect();
        let value = |key: &String| scenes[index].get(key).map_or("left out", String::as_str);
        parts.extend(shown.iter().map(|key| format!("{key} = {}", value(key))));
        if left_out > 0 && one_name {
            parts.push(format!("{left_out} keys differ"));
        }
        let scene = &runs[index].summary.scene;
        if parts.is_empty() {
            scene.clone()
        } else {
            format!("{scene} ({})", parts.join(", "))
        }
    });
    let labels: Vec<String> = labels.collect();
    let numbered = labels.iter().enumerate().map(|(index, label)| {
        let equal = labels.iter().filter(|other| *other == label).count();
        if equal > 1 {
            format!("{label}, run {}", index + 1)
        } else {
            label.clone()
        }
    });
    numbered.collect()
}

/// Mode, algorithm and speed of a run.
fn aspects(run: &RunBundle) -> [String; 3] {
    let summary = &run.summary;
    let speed = (3.6e3 * summary.evaluation.speed).round() / 1e3;
    [
        summary.mode.clone(),
        summary.coupling.algorithm.clone(),
        format!("{speed} km/h"),
    ]
}

/// Keys whose values are not the same in all scenes, and the number of those left out: all or none, because a part of
/// them would be taken for the whole difference.
fn differing(scenes: &[BTreeMap<String, String>]) -> (Vec<String>, usize) {
    if scenes.iter().any(BTreeMap::is_empty) {
        return (Vec::new(), 0);
    }
    let all: std::collections::BTreeSet<&String> = scenes.iter().flat_map(BTreeMap::keys).collect();
    let differs = |key: &&&String| scenes.iter().any(|scene| scene.get(**key) != scenes[0].get(**key));
    let spoken = |key: &&&String| !UNSPOKEN.contains(&key.as_str()) && !key.contains("].start.");
    let found: Vec<String> = all
        .iter()
        .filter(spoken)
        .filter(differs)
        .map(|key| (**key).clone())
        .collect();
    if found.len() <= MOST_KEYS {
        (found, 0)
    } else {
        (Vec::new(), found.len())
    }
}

/// The keys of a scene as text with their values; nothing of a text that is no TOML.
fn keys(scene: &str) -> BTreeMap<String, String> {
    let mut keys = BTreeMap::new();
    if let Ok(table) = scene.parse::<toml::Table>() {
        for (key, value) in &table {
            flatten(key, value, &mut keys);
        }
    }
    keys
}

/// Adds `value` under `path`; entries of lists of tables count from 1.
fn flatten(path: &str, value: &toml::Value, keys: &mut BTreeMap<String, String>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                flatten(&format!("{path}.{key}"), value, keys);
            }
        }
        toml::Value::Array(entries) if entries.iter().any(toml::Value::is_table) => {
            for (index, entry) in entries.iter().enumerate() {
                flatten(&format!("{path}[{}]", index + 1), entry, keys);
            }
        }
        toml::Value::String(text) => {
            keys.insert(path.to_owned(), text.clone());
        }
        other => {
            keys.insert(path.to_owned(), other.to_string());
        }
    }
}
