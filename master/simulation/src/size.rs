//! Memory and time that a line asks for by its size, before it is built.

use results::Machine;
use scene::{Element, Reduction, Scene};

use crate::SetupError;

/// Memory for each coordinate of a line that is built whole, bytes: state, band matrices of the statics and of a step.
const BYTES: f64 = 2200.0;
/// Elements that a core passes through in a second; three times fewer where they do not fit into its caches, and twice
/// as many where they do.
const ELEMENTS: f64 = 1e7;
/// Newton iterations of a step.
const ITERATIONS: f64 = 4.0;
/// Memory (bytes) and time (s) from which a line is told to be large.
const LARGE: [f64; 2] = [1e9, 60.0];

/// Size of a line that is built whole.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Size {
    spans: usize,
    elements: f64,
    coordinates: f64,
    /// Memory, bytes.
    bytes: f64,
    /// Time of a run on one core, s.
    seconds: f64,
}

impl Size {
    /// Size by the mesh; nothing for a line that is supplied, or of which a window is built.
    fn of(scene: &Scene) -> Option<Self> {
        let (line, _) = scene.modelled_line()?;
        // The static state of equal spans is that of a few, and the rest are never built.
        if scene.model.has(Reduction::Window) && line.is_uniform() {
            return None;
        }
        let spans = line.spans();
        let alike = if line.is_uniform() { spans } else { 1 };
        let elements = (alike * line.elements().map(|(_, _, count)| count).sum::<usize>()) as f64;
        let of_node = match line.mesh.element {
            Element::Beam => 12.0,
            _ if scene.is_planar() => 4.0,
            _ => 6.0,
        };
        let coordinates = of_node * elements;
        let whole = !scene.model.has(Reduction::Window) && !scene.model.has(Reduction::Modal);
        let steps = scene.run.duration / scene.solver.micro_step;
        let passes = if whole { steps * ITERATIONS * elements } else { 0.0 };
        Some(Self {
            spans,
            elements,
            coordinates,
            bytes: BYTES * coordinates,
            seconds: passes / ELEMENTS,
        })
    }
}

/// Remedy for a line that is too large.
const REMEDY: &str = "model.reduce = \"window\", which builds the spans around the pantographs, fewer spans, or longer \
                      elements";

/// Size of a large line in words, to be told before it is built; nothing for a line of usual size.
#[must_use]
pub fn notice(scene: &Scene) -> Option<String> {
    let size = Size::of(scene).filter(|size| size.bytes > LARGE[0] || size.seconds > LARGE[1])?;
    Some(format!(
        "catenary: {} spans are built whole, {:.0} elements in {:.0} coordinates: about {:.1} GB of memory, and some \
         {:.0} min for a run on one core; less with {REMEDY}",
        size.spans,
        size.elements,
        size.coordinates,
        size.bytes / 1e9,
        (size.seconds / 60.0).ceil(),
    ))
}

/// Refuses a line that does not fit into the memory that is free.
///
/// # Errors
/// [`SetupError::Memory`].
pub(crate) fn check(scene: &Scene) -> Result<(), SetupError> {
    fits(scene, Machine::free_memory())
}

fn fits(scene: &Scene, free: Option<f64>) -> Result<(), SetupError> {
    match Size::of(scene).zip(free) {
        Some((size, free)) if size.bytes > free => Err(SetupError::Memory {
            spans: size.spans,
            coordinates: size.coordinates,
            needed: size.bytes / 1e9,
            free: free / 1e9,
            remedy: REMEDY,
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");

    fn scene(overrides: &[&str]) -> Scene {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        system::load(EN_300, "en50318-300.toml", &overrides).unwrap()
    }

    #[test]
    fn a_size_is_that_of_the_line_that_is_built() {
        for overrides in [&["catenary.spans=20"][..], &["catenary.spans=30", "model.reduce=none"]] {
            let scene = scene(overrides);
            let size = Size::of(&scene).unwrap();
            let statics = catenary::static_line(&scene).unwrap();
            let mut layout = dynamics::Layout::new();
            let _line = statics.line_in(&mut layout);
            let built = layout.coordinates() as f64;
            assert!((size.coordinates / built - 1.0).abs() < 0.05, "{size:?} {built}");
            assert_eq!(notice(&scene), None);
        }
    }

    #[test]
    fn a_line_that_does_not_fit_is_refused_and_a_large_one_is_told() {
        let large = scene(&["catenary.spans=4000"]);
        let said = notice(&large).unwrap();
        assert!(said.contains("4000 spans") && said.contains("\"window\""), "{said}");
        let said = fits(&large, Some(1e9)).unwrap_err().to_string();
        for part in [
            "catenary.spans = 4000",
            "needs about 5.6 GB",
            "has 1.0 GB free",
            "must be",
        ] {
            assert!(said.contains(part), "{said}");
        }
        assert!(fits(&large, Some(1e10)).is_ok() && fits(&large, None).is_ok());
        let window = scene(&["catenary.spans=4000", "model.reduce=window"]);
        assert!(notice(&window).is_none() && fits(&window, Some(1e6)).is_ok());
    }
}
