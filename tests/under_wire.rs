//! A pantograph under a wire that a test makes.
use dynamics::{Constraint, Force, Layout, System};
use vehicle::PantographModel;

/// A pantograph and what presses on its head.
pub struct UnderWire<W> {
    /// Coordinates of the pantograph.
    pub layout: Layout,
    /// The pantograph.
    pub model: PantographModel,
    /// The wire.
    pub wire: W,
}

impl<W: Force> System for UnderWire<W> {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.model.forces(visit);
        visit(&mut self.wire);
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.model.constraints(visit);
    }
}
