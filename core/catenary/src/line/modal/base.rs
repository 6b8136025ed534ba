//! A line in its modes before strips run under it.
use super::modes::Modes;
use crate::{Line, LinearLine, StaticsError, WireCurve};
use dynamics::Layout;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Bases kept with a static state; the oldest go first.
const KEPT: usize = 4;

/// Choices that a base follows from, besides the static state.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Wish {
    pub flat: bool,
    /// Highest mode, Hz.
    pub highest: f64,
    /// Damping of wires in proportion to their stiffness, s.
    pub beta: f64,
}

/// Parts that all runs over one line have in common.
pub(super) struct Base {
    pub modes: Arc<Modes>,
    pub contact_wires: Vec<Arc<dyn WireCurve>>,
    /// Positions of wires, supports and droppers, in the coordinates of the linearised line.
    pub shape: Line,
    /// Number of those coordinates.
    pub coordinates: usize,
}

impl Base {
    /// A linear line in its modes; the coordinates of `linear` are those of `own`.
    ///
    /// # Errors
    /// See [`StaticsError::Modes`].
    pub fn of((mut linear, own): (LinearLine, &Layout), wish: Wish) -> Result<Self, StaticsError> {
        let modes = Modes::of(&mut linear, own, [wish.highest, wish.beta])?;
        let shape = linear.shape().cloned().ok_or(StaticsError::Modes {
            reason: "the line has no shape".to_owned(),
        })?;
        let contact_wires = (0..linear.contact_wires()).map(|wire| linear.contact_curve(wire));
        Ok(Self {
            modes,
            contact_wires: contact_wires.collect(),
            shape,
            coordinates: own.coordinates(),
        })
    }
}

/// Bases made before from one static state, for cases of a sweep; a copy of the state begins without.
#[derive(Default)]
pub(crate) struct KeptBases(Mutex<Vec<(Wish, Arc<Base>)>>);

impl KeptBases {
    /// The base of a wish, made by `make` where it is not kept.
    pub(super) fn or_made(
        &self,
        wish: Wish,
        make: impl FnOnce() -> Result<Base, StaticsError>,
    ) -> Result<Arc<Base>, StaticsError> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, base)) = kept().iter().find(|(other, _)| *other == wish) {
            return Ok(Arc::clone(base));
        }
        let base = Arc::new(make()?);
        let mut kept = kept();
        kept.insert(0, (wish, Arc::clone(&base)));
        kept.truncate(KEPT);
        Ok(base)
    }
}

impl Clone for KeptBases {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for KeptBases {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KeptBases").finish_non_exhaustive()
    }
}
