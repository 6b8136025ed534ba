//! Lines of the shipped scenes for the tests of statics and motion.
use crate::fmus::tree;
use catenary::{LineOptions, StaticLine};
use scene::{Catenary, Files, Scene};
use std::fs;

/// The reference model of EN 50318 at 300 km/h.
pub const EN: &str = include_str!("../scenes/en50318-300.toml");
/// The line of the thesis.
pub const THESIS: &str = include_str!("../scenes/thesis-pantograph.toml");

/// The line of a scene with other values.
///
/// # Panics
/// When the scene is refused.
#[must_use]
pub fn scene_line(text: &str, overrides: &[&str]) -> Catenary {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let scene = system::load(text, "scene.toml", &overrides).unwrap();
    scene.modelled_line().unwrap().0.clone()
}

/// A shipped scene with the files beside it, and with other values.
///
/// # Panics
/// When the scene is refused.
#[must_use]
pub fn shipped_scene(name: &str, overrides: &[&str]) -> Scene {
    let folder = tree().join("scenes");
    let text = fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let files = Files::new(|path| fs::read_to_string(folder.join(path)).map_err(|error| error.to_string()));
    system::load_with(&text, name, &overrides, &files).unwrap()
}

/// The static state of a line.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn solve(catenary: &Catenary) -> StaticLine {
    StaticLine::solve(catenary, LineOptions::default()).unwrap()
}

/// The reference model with few spans; the evaluated range of the scene is not used here.
#[must_use]
pub fn short_line(spans: usize) -> Catenary {
    let mut catenary = scene_line(EN, &[]);
    catenary.tension_lengths[0].span_lengths.truncate(spans);
    catenary
}
