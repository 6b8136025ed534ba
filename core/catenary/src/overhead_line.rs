//! What contact and coupling need of a line, whatever it is made of.
use crate::{Curve, DropperSample, Line, LinearLine};
use dynamics::{Force, Motion};
use std::sync::Arc;

/// A line as the strips' side sees it: the nonlinear [`Line`] in any of its dimensions, or a [`LinearLine`]. The line of
/// a scene is made by [`crate::scene_line`].
pub trait OverheadLine: Send {
    /// Visits every contribution, always in the same order.
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force));

    /// The contact wire as contact sees it.
    fn contact_curve(&self) -> Arc<dyn Curve>;

    /// Number of droppers that exert no force.
    fn slack_count(&self, motion: &Motion<'_>) -> usize;

    /// Potential energy, J.
    fn energy(&self, motion: &Motion<'_>) -> f64;

    /// Both ends and the tension of every dropper, for pictures.
    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample>;

    /// The wires, supports and droppers behind, where the line has them: for uplift and pictures.
    fn shape(&self) -> Option<&Line>;

    /// See [`OverheadLine::shape`].
    fn shape_mut(&mut self) -> Option<&mut Line>;
}

impl OverheadLine for Line {
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.forces(visit);
    }

    fn contact_curve(&self) -> Arc<dyn Curve> {
        self.contact_curve()
    }

    fn slack_count(&self, motion: &Motion<'_>) -> usize {
        self.slack_count(motion)
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.energy(motion)
    }

    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample> {
        self.dropper_samples(motion).collect()
    }

    fn shape(&self) -> Option<&Line> {
        Some(self)
    }

    fn shape_mut(&mut self) -> Option<&mut Line> {
        Some(self)
    }
}

impl OverheadLine for LinearLine {
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.forces(visit);
    }

    fn contact_curve(&self) -> Arc<dyn Curve> {
        self.contact_curve()
    }

    fn slack_count(&self, motion: &Motion<'_>) -> usize {
        self.droppers().slack_count(motion)
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.energy(motion)
    }

    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample> {
        self.dropper_samples(motion)
    }

    fn shape(&self) -> Option<&Line> {
        self.shape()
    }

    fn shape_mut(&mut self) -> Option<&mut Line> {
        self.shape_mut()
    }
}
