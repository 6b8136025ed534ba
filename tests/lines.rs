//! Lines of the shipped scenes for the tests of statics and motion.
use catenary::{LineOptions, StaticLine};
use scene::Catenary;

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
