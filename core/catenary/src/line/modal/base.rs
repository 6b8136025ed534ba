//! A line in its modes before strips run under it.
use super::creep::Creeping;
use super::modes::Modes;
use super::slack::Answers;
use crate::{Line, LinearLine, StaticsError, WireCurve};
use dynamics::Layout;
use std::sync::Arc;

/// Choices that a base follows from, besides the static state.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct Wish {
    pub(super) flat: bool,
    /// Highest mode where forces of droppers have attachment modes, and where they have none, Hz.
    pub(super) highest: [f64; 2],
    /// Dampers along wires, which modes have and wires do not, are taken back.
    pub(super) stretching: bool,
    /// Damping of wires in proportion to their stiffness, s.
    pub(super) beta: f64,
    /// Droppers are rods that creep.
    pub(super) creeping: bool,
    /// Largest damper that forces from step to step can take back where attachment modes swing, N·s/m.
    pub(super) bearable: f64,
    /// Length of a step, s.
    pub(super) h: f64,
}

/// Parts that all runs over one line have in common.
pub(crate) struct Base {
    pub(super) modes: Arc<Modes>,
    pub(super) contact_wires: Vec<Arc<dyn WireCurve>>,
    /// Positions of wires, supports and droppers, in the coordinates of the linearised line.
    pub(super) shape: Line,
    /// Number of those coordinates.
    pub(super) coordinates: usize,
    /// Droppers creep.
    pub(super) creeping: Option<Creeping>,
    /// Answers to forces at the end of a step, and at rest.
    pub(super) answers: [Arc<Answers>; 2],
}

impl Base {
    /// A linear line in its modes; the coordinates of `linear` are those of `own`.
    ///
    /// # Errors
    /// See [`StaticsError::Modes`].
    pub(super) fn of((mut linear, own): (LinearLine, &Layout), wish: Wish) -> Result<Self, StaticsError> {
        let modes = Modes::of(&mut linear, own, wish)?;
        let shape = linear.shape().cloned().ok_or(StaticsError::Modes {
            reason: "the line has no shape".to_owned(),
        })?;
        let contact_wires = (0..linear.contact_wires()).map(|wire| linear.contact_curve(wire));
        let mut answers = [Answers::new(&modes, wish.h), Answers::at_rest(&modes)];
        let creeping = Creeping::of(&modes, &mut answers[0]);
        let answers = answers.map(Arc::new);
        Ok(Self {
            creeping,
            answers,
            modes,
            contact_wires: contact_wires.collect(),
            shape,
            coordinates: own.coordinates(),
        })
    }
}
