//! The scene that all cases are made of.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use scene::{Files, Scene, SceneError, SceneFile};

use simulation::identity::{by_content, digest};

/// Text of a scene with the keys that are set for all cases, and the files beside it.
pub struct Base {
    /// Name of the scene in results.
    pub name: String,
    /// The scene file as it was named.
    pub origin: String,
    /// Folder that paths in the scene are relative to.
    pub folder: PathBuf,
    /// Keys set for all cases, `key=value`.
    pub overrides: Vec<String>,
    text: String,
    /// Texts of the files beside the scene, each read once.
    files: Mutex<BTreeMap<String, Result<String, String>>>,
}

impl Base {
    /// The scene `text`, `origin` in messages.
    #[must_use]
    pub fn new(name: &str, origin: &str, folder: &Path, text: String, overrides: Vec<String>) -> Self {
        Self {
            name: name.to_owned(),
            origin: origin.to_owned(),
            folder: folder.to_owned(),
            overrides,
            text,
            files: Mutex::default(),
        }
    }

    /// The same scene with texts of files beside it, which are then not read.
    #[must_use]
    pub fn with_files(self, files: BTreeMap<String, String>) -> Self {
        let files = files.into_iter().map(|(path, text)| (path, Ok(text))).collect();
        Self {
            files: Mutex::new(files),
            ..self
        }
    }

    /// Texts of the files beside the scene that were read so far, for the same scene in another place.
    #[must_use]
    pub fn files(&self) -> BTreeMap<String, String> {
        let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let read = files
            .iter()
            .filter_map(|(path, text)| Some((path, text.as_ref().ok()?)));
        read.map(|(path, text)| (path.clone(), text.clone())).collect()
    }

    fn file(&self, path: &str) -> Result<String, String> {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let read =
            || std::fs::read_to_string(self.folder.join(path)).map_err(|error| format!("cannot be read: {error}"));
        files.entry(path.to_owned()).or_insert_with(read).clone()
    }

    fn all_overrides(&self, more: &[String]) -> Vec<String> {
        self.overrides.iter().chain(more).cloned().collect()
    }

    /// The scene with further keys set, the same as that of `master run --set`.
    ///
    /// # Errors
    /// Every problem found.
    pub fn scene(&self, more: &[String]) -> Result<Scene, SceneError> {
        let files = Files::new(|path| self.file(path));
        system::load_with(&self.text, &self.origin, &self.all_overrides(more), &files)
    }

    /// The scene with further keys set as it is read: values may contradict each other still, and no mesh is chosen.
    ///
    /// # Errors
    /// Keys that are unknown, missing, of the wrong type or out of range.
    pub fn read(&self, more: &[String]) -> Result<Scene, SceneError> {
        let files = Files::new(|path| self.file(path));
        SceneFile::read(&self.text, &self.origin, &self.all_overrides(more), &files).map(|file| file.scene)
    }

    /// Ranges of numbers that the scene gives.
    ///
    /// # Errors
    /// Keys that are unknown, missing, of the wrong type or out of range.
    pub fn ranges(&self) -> Result<Vec<scene::Range>, SceneError> {
        let files = Files::new(|path| self.file(path));
        SceneFile::read(&self.text, &self.origin, &self.overrides, &files).map(|file| file.ranges)
    }

    /// Hash of the scene and of every file that it names; `scene` is the scene as read, without further keys.
    #[must_use]
    pub fn hash(&self, scene: &Scene) -> String {
        let files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        let resolved = by_content(scene, &self.folder).to_toml();
        let mut parts = vec![self.text.clone(), self.overrides.join("\n"), resolved];
        for (path, text) in files.iter() {
            parts.extend([path.clone(), text.clone().unwrap_or_default()]);
        }
        digest(&parts.iter().map(String::as_bytes).collect::<Vec<_>>())
    }
}

/// Numbers of a scene by the paths of their keys, for expressions.
pub struct Numbers(toml::Table);

impl Numbers {
    /// Numbers of this scene, defaults included.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        Self(scene.to_toml().parse().unwrap_or_default())
    }

    /// The number under a key such as `catenary.span_length` or `pantograph[1].masses[2]`.
    #[must_use]
    pub fn get(&self, path: &str) -> Option<f64> {
        let mut steps = path.split(['.', '[']).filter(|step| !step.is_empty());
        let mut value = self.0.get(steps.next()?)?;
        for step in steps {
            value = match (value, step.strip_suffix(']')) {
                (toml::Value::Array(list), Some(number)) => list.get(number.parse::<usize>().ok()?.checked_sub(1)?)?,
                (toml::Value::Array(list), None) => list.get(step.parse::<usize>().ok()?)?,
                (toml::Value::Table(table), None) => table.get(step)?,
                _ => return None,
            };
        }
        match value {
            toml::Value::Integer(number) => Some(*number as f64),
            toml::Value::Float(number) => Some(*number),
            _ => None,
        }
    }
}

impl Numbers {
    /// `, did you mean …?` where a number of the scene has a key that ends in this name, or one much like it.
    #[must_use]
    pub fn meant(&self, name: &str) -> String {
        let mut paths = Vec::new();
        collect(&toml::Value::Table(self.0.clone()), String::new(), &mut paths);
        let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
        let near = |path: &String| {
            let whole = strsim::normalized_levenshtein(path, name);
            whole.max(strsim::normalized_levenshtein(&last(path), &last(name)))
        };
        let best = paths.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
        let best = best.filter(|path| near(path) > ALIKE);
        best.map_or_else(String::new, |path| format!(", did you mean {path}?"))
    }
}

/// Likeness of two names from which on one may be meant by the other, –.
const ALIKE: f64 = 0.7;

/// Paths of all numbers below a value.
fn collect(value: &toml::Value, path: String, paths: &mut Vec<String>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                let dot = if path.is_empty() { "" } else { "." };
                collect(value, format!("{path}{dot}{key}"), paths);
            }
        }
        toml::Value::Array(list) => {
            for (index, value) in list.iter().enumerate() {
                collect(value, format!("{path}[{}]", index + 1), paths);
            }
        }
        toml::Value::Integer(_) | toml::Value::Float(_) => paths.push(path),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");

    #[test]
    fn numbers_of_a_scene_are_found_by_their_keys() {
        let base = Base::new(
            "a",
            "a.toml",
            Path::new(""),
            EN_300.to_owned(),
            vec!["catenary.spans=7".to_owned()],
        );
        let numbers = Numbers::of(&base.read(&[]).unwrap());
        assert_eq!(numbers.get("catenary.spans"), Some(7.0));
        assert_eq!(numbers.get("pantograph[1].masses[2]"), Some(15.0));
        assert_eq!(numbers.get("pantograph.0.static_force"), Some(120.0));
        for path in ["catenary.mesh.element", "no.key", "pantograph[2].masses", ""] {
            assert_eq!(numbers.get(path), None, "{path}");
        }
    }

    #[test]
    fn the_hash_is_that_of_the_content() {
        let hash = |text: &str, set: &[&str]| {
            let set = set.iter().map(|set| (*set).to_owned()).collect();
            let base = Base::new("a", "a.toml", Path::new(""), text.to_owned(), set);
            base.hash(&base.read(&[]).unwrap())
        };
        assert_eq!(hash(EN_300, &[]), hash(EN_300, &[]));
        assert_ne!(hash(EN_300, &[]), hash(EN_300, &["run.speed_kmh=280"]));
        assert_ne!(hash(EN_300, &[]), hash(&EN_300.replace("120.0 ", "121.0 "), &[]));
    }
}
