//! Static states that several scenes have in common.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use catenary::{CatenaryError, StaticLine, StaticsInputs, static_line};
use scene::Scene;

/// A static state once it is found; whoever needs it meanwhile waits.
type Slot = Arc<OnceLock<Result<Arc<StaticLine>, CatenaryError>>>;

/// Static states of the last few lines, for scenes that differ in pantographs, forces or speeds.
///
/// A state that is taken from here is the one that would be found again, bit for bit: inputs are compared as a whole.
#[derive(Debug)]
pub struct StaticLines {
    /// Inputs with their states, the last one used behind the others.
    held: Mutex<Vec<(StaticsInputs, Slot)>>,
    most: usize,
}

impl StaticLines {
    /// Keeps as many states as this.
    #[must_use]
    pub fn keeping(most: usize) -> Self {
        Self {
            held: Mutex::default(),
            most,
        }
    }

    /// Keeps none.
    #[must_use]
    pub fn none() -> Self {
        Self::keeping(0)
    }

    /// The static state of a scene's line.
    ///
    /// # Errors
    /// See [`CatenaryError`].
    pub fn of(&self, scene: &Scene) -> Result<Arc<StaticLine>, CatenaryError> {
        if self.most == 0 {
            return static_line(scene).map(Arc::new);
        }
        let inputs = StaticsInputs::of(scene)?;
        if !inputs.can_be_shared() {
            return static_line(scene).map(Arc::new);
        }
        let slot = self.slot(inputs);
        slot.get_or_init(|| static_line(scene).map(Arc::new)).clone()
    }

    fn slot(&self, inputs: StaticsInputs) -> Slot {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        let slot = match held.iter().position(|(known, _)| *known == inputs) {
            Some(index) => held.remove(index).1,
            None => Slot::default(),
        };
        held.push((inputs, Arc::clone(&slot)));
        let excess = held.len().saturating_sub(self.most);
        held.drain(..excess);
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_share_a_line_as_long_as_it_is_the_same() {
        const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
        let lines = StaticLines::keeping(2);
        let line = |set: &str| {
            let overrides = [
                "catenary.spans=4",
                "run.evaluate={ spans = [2, 2] }",
                "run.duration=2.0",
                set,
            ];
            let scene = system::load(EN_300, "scene.toml", &overrides.map(str::to_owned)).unwrap();
            lines.of(&scene).unwrap()
        };
        let first = line("pantograph[1].static_force=100");
        assert!(Arc::ptr_eq(&first, &line("pantograph[1].masses=[6.0, 14.0]")));
        assert!(Arc::ptr_eq(&first, &line("contact.stiffness=4e4")));
        assert!(!Arc::ptr_eq(&first, &line("catenary.contact_wire.tension=21000")));
        // Two lines later the first one is forgotten.
        line("catenary.contact_wire.tension=22000");
        assert!(!Arc::ptr_eq(&first, &line("pantograph[1].static_force=100")));
    }
}
