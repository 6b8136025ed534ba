//! The trait of everything that adds algebraic constraints.
use crate::Motion;

/// A contribution of holonomic constraints `g(t, q) = 0`.
pub trait Constraint: Send {
    /// Number of equations.
    fn dimension(&self) -> usize;

    /// Writes the residuals `g` (m or –), one entry per equation.
    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]);

    /// Adds the Jacobian `g_q` with respect to the generalised velocities (`ġ = g_q v`) as dense blocks, in the same
    /// order and with the same indices in every call. Indices of a constraint that [`Constraint::moves`] may change
    /// from call to call.
    ///
    fn jacobian(&self, motion: &Motion<'_>, rows: &mut JacobianRows<'_>);

    /// Adds `(g_q)˙ v` to `g`, which together with `g_q v̇` is `g̈`, for [`crate::Formulation::Index1Baumgarte`].
    /// Returns `false`, with `g` unchanged, if the constraint does not know its second derivative: such a constraint
    /// stays one of positions.
    fn add_velocity_terms(&self, motion: &Motion<'_>, g: &mut [f64]) -> bool {
        let _ = (motion, g);
        false
    }

    /// Returns `true` if the Jacobian reaches other coordinates in the course of time, as that of a strip that slides
    /// along a wire; the answer never changes. Rows of such a constraint stay out of the factored matrix: a
    /// [`crate::Force`] brings them by [`crate::Updates::border`]. In time they hold by [`Constraint::add_rate`], see
    /// [`crate::GeneralizedAlpha`].
    fn moves(&self) -> bool {
        false
    }

    /// Adds `ġ = g_q v + g_t`, the rate of the residuals (m/s or 1/s), with `g_t` the effect of prescribed motion at
    /// held coordinates. Called only if the constraint [`Constraint::moves`].
    fn add_rate(&self, motion: &Motion<'_>, rates: &mut [f64]) {
        let _ = (motion, rates);
    }
}

/// Takes one block row: number of the equation, indices of the generalised velocities, values.
pub(crate) type RowSink<'a> = dyn FnMut(usize, &[usize], &[f64]) + 'a;

/// Sink of the blocks of the Jacobian of a [`Constraint`].
pub struct JacobianRows<'a> {
    sink: &'a mut RowSink<'a>,
}

impl<'a> JacobianRows<'a> {
    /// Blocks go to `sink(row, columns, values)`, one call per row.
    pub fn new(sink: &'a mut RowSink<'a>) -> Self {
        Self { sink }
    }

    /// Adds `values` (one per entry of `columns`) to equation `row`, counted within the constraint.
    pub fn add(&mut self, row: usize, columns: &[usize], values: &[f64]) {
        debug_assert_eq!(columns.len(), values.len());
        (self.sink)(row, columns, values);
    }
}
