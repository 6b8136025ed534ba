//! The iteration matrix of a system: assembled into a pattern that is analysed once, factored part by part.
use crate::capability::add_dynamic_tangent;
use crate::constraint::RowSink;
use crate::linear::block_tridiagonal::Precision;
use crate::linear::low_rank::PLACEHOLDER;
use crate::linear::part::{Part, Thresholds};
use crate::linear::pattern::Pattern;
use crate::{Blocks, Force, JacobianRows, Motion, SparseMatrix, System, Weights};

/// `[w_m M + w_q K + w_v D, s g_qᵀ; s g_q, 0]`, without the rows and columns of fixed coordinates.
pub(crate) struct IterationMatrix {
    coordinates: usize,
    /// Trace of the mass matrix, kg.
    mass_trace: f64,
    /// Mass matrix of the contributions that do not multiply their own, and the rows of it that are not empty.
    multiplied_mass: SparseMatrix,
    multiplied_rows: Vec<usize>,
    tangent_places: Vec<u32>,
    /// Two places per Jacobian entry: in `g_q` and in its transpose.
    jacobian_places: Vec<u32>,
    moving_rows: MovingRows,
    /// Equations of the constraints that move, and positions on the diagonal of their multipliers, which hold
    /// placeholders.
    pub moving: Vec<usize>,
    placeholders: Vec<u32>,
    values: Vec<f64>,
    /// First of `values` of each part, and their number.
    first_values: Vec<usize>,
    pub parts: Vec<Part>,
    pub places: UnknownLocations,
}

/// Treatment of the rows of constraints that move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MovingRows {
    /// The rows stand in the pattern as at the motion that is analysed: for a matrix that is used once.
    AsTheyAre,
    /// [`PLACEHOLDER`] stands for the rows: [`crate::Updates::border`] brings them.
    Placeholders,
}

/// Per unknown its part and its number there; none for a fixed coordinate.
pub(crate) struct UnknownLocations(Vec<Option<(u32, u32)>>);

impl UnknownLocations {
    /// Part of an unknown and its number there.
    pub fn of(&self, unknown: usize) -> Option<(usize, usize)> {
        self.0[unknown].map(|(part, local)| (part as usize, local as usize))
    }
}

/// The factored matrix is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Singular {
    /// An unknown that has no stiffness, or one of those that depend on each other.
    pub unknown: usize,
}

impl IterationMatrix {
    /// Analyses the pattern of a system at a motion.
    pub fn analyse(
        system: &mut dyn System,
        motion: &Motion<'_>,
        moving_rows: MovingRows,
        precision: Precision,
    ) -> Self {
        let coordinates = system.layout().coordinates();
        let size = coordinates + system.layout().constraints();
        let mut free = vec![true; size];
        for &index in system.layout().fixed() {
            free[index] = false;
        }
        let mut mass_trace = 0.0;
        let mut blocks = Blocks::trace(&mut mass_trace);
        system.forces(&mut |force| force.add_mass(&mut blocks));
        let multiplied_mass = selected_mass_matrix(system, |force| force.one_pass().is_none());
        let mut tangent = Vec::new();
        let mut blocks = Blocks::record(&mut tangent);
        system.forces(&mut |force| add_dynamic_tangent(force, motion, Weights { q: 1.0, v: 1.0 }, 1.0, &mut blocks));
        let mut jacobian = Vec::new();
        let moving = visit_still_jacobian(system, motion, moving_rows, &mut |row, columns, _| {
            for &column in columns {
                jacobian.push(((coordinates + row) as u32, column as u32));
                jacobian.push((column as u32, (coordinates + row) as u32));
            }
        });

        let kept = |row: u32, column: u32| free[row as usize] && free[column as usize];
        let entries = (tangent.iter().chain(&jacobian).copied()).filter(|&(row, column)| kept(row, column));
        let pattern = Pattern::new(&free, entries);
        let mut parts = Vec::with_capacity(pattern.sets.len());
        let mut first_values = vec![0];
        let mut places = vec![None; size];
        for unknowns in &pattern.sets {
            for (i, &unknown) in unknowns.iter().enumerate() {
                places[unknown] = Some((parts.len() as u32, i as u32));
            }
            let part = part(&pattern, unknowns, &places, (coordinates, precision));
            first_values.push(first_values[parts.len()] + part.entries());
            parts.push(part);
        }
        let mut finder = pattern.finder();
        let mut place = |row: u32, column: u32| {
            if kept(row, column) {
                finder.place(row, column)
            } else {
                Blocks::skipped()
            }
        };
        Self {
            coordinates,
            moving_rows,
            placeholders: (moving.iter())
                .map(|row| place((coordinates + row) as u32, (coordinates + row) as u32))
                .collect(),
            moving,
            tangent_places: tangent.iter().map(|&(row, column)| place(row, column)).collect(),
            jacobian_places: jacobian.iter().map(|&(row, column)| place(row, column)).collect(),
            values: vec![0.0; pattern.len()],
            mass_trace,
            multiplied_rows: (0..coordinates)
                .filter(|&row| multiplied_mass.row(row).next().is_some())
                .collect(),
            multiplied_mass,
            first_values,
            parts,
            places: UnknownLocations(places),
        }
    }

    /// Assembles and factors at a motion; `mass_weight` is the weight of `M`, `scale` that of the constraints.
    pub fn factor(
        &mut self,
        system: &mut dyn System,
        motion: &Motion<'_>,
        mass_weight: f64,
        weights: Weights,
        scale: f64,
    ) -> Result<(), Singular> {
        self.values.fill(0.0);
        let mut blocks = Blocks::add_to(&self.tangent_places, &mut self.values);
        system.forces(&mut |force| add_dynamic_tangent(force, motion, weights, mass_weight, &mut blocks));
        debug_assert_eq!(
            blocks.entries(),
            self.tangent_places.len(),
            "a contribution changed its pattern"
        );
        let mut cursor = 0;
        let (values, places) = (&mut self.values, &self.jacobian_places);
        visit_still_jacobian(system, motion, self.moving_rows, &mut |_, _, entries| {
            for &entry in entries {
                for _ in 0..2 {
                    if places[cursor] != Blocks::skipped() {
                        values[places[cursor] as usize] += scale * entry;
                    }
                    cursor += 1;
                }
            }
        });
        for &place in &self.placeholders {
            self.values[place as usize] = PLACEHOLDER;
        }
        for (part, range) in self.parts.iter_mut().zip(self.first_values.windows(2)) {
            part.factor(&self.values[range[0]..range[1]])
                .map_err(|unknown| Singular { unknown })?;
        }
        Ok(())
    }

    /// Subtracts `M v̇` of the contributions that do not multiply their own mass.
    pub fn subtract_inertia(&self, v_dot: &[f64], force: &mut [f64]) {
        for &row in &self.multiplied_rows {
            force[row] -= self.multiplied_mass.row_product(row, v_dot);
        }
    }

    /// Solves; `right_side` has one entry per coordinate and multiplier, those of fixed coordinates become zero.
    pub fn solve(&mut self, right_side: &[f64], solution: &mut [f64]) {
        solution.fill(0.0);
        for part in &mut self.parts {
            part.load(right_side, Thresholds::default());
            part.solve(Thresholds::default(), solution, &mut |_, _| ());
        }
    }

    /// Typical mass per coordinate, kg; scales constraint rows.
    pub fn mean_mass(&self) -> f64 {
        (self.mass_trace / self.coordinates.max(1) as f64).max(f64::MIN_POSITIVE)
    }
}

/// The part of one set of coupled unknowns; `places` holds their local numbers.
fn part(
    pattern: &Pattern,
    unknowns: &[usize],
    places: &[Option<(u32, u32)>],
    (coordinates, precision): (usize, Precision),
) -> Part {
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for &unknown in unknowns {
        let local = |&row: &u32| places[row as usize].map(|(_, local)| local as usize);
        rows.extend(pattern.column(unknown).iter().filter_map(local));
        starts.push(rows.len());
    }
    Part::new(unknowns.to_vec(), starts, rows, coordinates, precision)
}

/// Calls `sink(equation, columns, values)` for every block row of all constraints.
pub(crate) fn visit_jacobian(system: &mut dyn System, motion: &Motion<'_>, sink: &mut RowSink<'_>) {
    let mut first = 0;
    system.constraints(&mut |constraint| {
        let mut shifted = |row: usize, columns: &[usize], values: &[f64]| sink(first + row, columns, values);
        constraint.jacobian(motion, &mut JacobianRows::new(&mut shifted));
        first += constraint.dimension();
    });
}

/// [`visit_jacobian`] of the rows that are in the pattern; returns the equations of the others.
pub(crate) fn visit_still_jacobian(
    system: &mut dyn System,
    motion: &Motion<'_>,
    moving_rows: MovingRows,
    sink: &mut RowSink<'_>,
) -> Vec<usize> {
    let (mut first, mut moving) = (0, Vec::new());
    system.constraints(&mut |constraint| {
        let next = first + constraint.dimension();
        if moving_rows == MovingRows::Placeholders && constraint.moves() {
            moving.extend(first..next);
        } else {
            let mut shifted = |row: usize, columns: &[usize], values: &[f64]| sink(first + row, columns, values);
            constraint.jacobian(motion, &mut JacobianRows::new(&mut shifted));
        }
        first = next;
    });
    moving
}

/// The constant mass matrix of a system, with all rows.
pub(crate) fn mass_matrix(system: &mut dyn System) -> SparseMatrix {
    selected_mass_matrix(system, |_| true)
}

/// The mass matrix of the contributions that are `selected`.
fn selected_mass_matrix(system: &mut dyn System, selected: impl Fn(&mut dyn Force) -> bool) -> SparseMatrix {
    let entries = Blocks::collect(|blocks| {
        system.forces(&mut |force| {
            if selected(force) {
                force.add_mass(blocks);
            }
        });
    });
    SparseMatrix::from_entries(system.layout().coordinates(), entries)
}
