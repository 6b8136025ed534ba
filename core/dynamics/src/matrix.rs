//! The iteration matrix of a system: assembled into a pattern that is analysed once, factored part by part.
use crate::constraint::RowSink;
use crate::factor::{Shape, SparseFactor};
use crate::{Blocks, Force, JacobianRows, Motion, SparseMatrix, System, Weights};

/// Unknowns that no contribution couples are factored separately: a line and a pantograph are two such parts, since contact
/// enters as a low-rank term.
struct Part {
    /// Unknowns of the part: coordinates first, then multipliers (numbered after all coordinates).
    unknowns: Vec<usize>,
    /// Where its values start in the common array.
    first_value: usize,
    values: usize,
    factors: SparseFactor,
    right_side: Vec<f64>,
}

/// Parts up to this size are factored by LU whatever they are: it costs nothing there.
const SMALL: usize = 64;

/// `[w_m M + w_q K + w_v D, s g_qᵀ; s g_q, 0]`, without the rows and columns of fixed coordinates.
pub(crate) struct IterationMatrix {
    coordinates: usize,
    /// Trace of the mass matrix, kg.
    mass_trace: f64,
    /// Mass matrix, all rows, of the contributions that do not multiply theirs themselves.
    pub multiplied_mass: SparseMatrix,
    mass_entries: Vec<(u32, f64)>,
    tangent_places: Vec<u32>,
    /// Two places per Jacobian entry: in `g_q` and in its transpose.
    jacobian_places: Vec<u32>,
    values: Vec<f64>,
    parts: Vec<Part>,
}

/// The factored matrix is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Singular {
    /// An unknown that has no stiffness, or one of those that depend on each other.
    pub unknown: usize,
}

impl IterationMatrix {
    /// Analyses the pattern of a system at a motion.
    pub fn analyse(system: &mut dyn System, motion: &Motion<'_>) -> Self {
        let coordinates = system.layout().coordinates();
        let size = coordinates + system.layout().constraints();
        let mut fixed = vec![false; size];
        for &index in system.layout().fixed() {
            fixed[index] = true;
        }
        let mass = mass_matrix(system);
        let multiplied_mass = selected_mass_matrix(system, |force| !force.multiplies_mass());
        let mut tangent = Vec::new();
        let mut blocks = Blocks::record(&mut tangent);
        system.forces(&mut |force| force.add_tangent(motion, Weights { q: 1.0, v: 1.0 }, &mut blocks));
        let mut jacobian = Vec::new();
        visit_jacobian(system, motion, &mut |row, columns, _| {
            for &column in columns {
                jacobian.push(((coordinates + row) as u32, column as u32));
                jacobian.push((column as u32, (coordinates + row) as u32));
            }
        });
        let mass_places: Vec<(u32, u32, f64)> = (0..coordinates)
            .flat_map(|row| {
                mass.row(row)
                    .map(move |(column, value)| (row as u32, column as u32, value))
            })
            .collect();

        let kept = |row: u32, column: u32| !fixed[row as usize] && !fixed[column as usize];
        let mut links = Links::new(size);
        let entries = || {
            mass_places
                .iter()
                .map(|&(row, column, _)| (row, column))
                .chain(tangent.iter().copied())
                .chain(jacobian.iter().copied())
                .filter(|&(row, column)| kept(row, column))
        };
        for (row, column) in entries() {
            links.join(row as usize, column as usize);
        }
        // Every free unknown has a diagonal entry, so that the pattern is structurally regular.
        let diagonal = (0..size as u32).filter(|&i| !fixed[i as usize]).map(|i| (i, i));
        let mut all: Vec<(u32, u32)> = entries().chain(diagonal).collect();
        all.sort_by_key(|&(row, column)| (links.root(column as usize), column, row));
        all.dedup();

        let mut parts = Vec::new();
        let mut start = 0;
        while start < all.len() {
            let root = links.root(all[start].1 as usize);
            let end = start + all[start..].partition_point(|&(_, column)| links.root(column as usize) <= root);
            parts.push(Part::new(&all[start..end], start, (coordinates, size)));
            start = end;
        }
        let place = |row: u32, column: u32| {
            if !kept(row, column) {
                return Blocks::skipped();
            }
            let key = (links.root(column as usize), column, row);
            all.binary_search_by_key(&key, |&(row, column)| (links.root(column as usize), column, row))
                .expect("every entry was put into the pattern") as u32
        };
        Self {
            coordinates,
            mass_entries: mass_places
                .iter()
                .map(|&(row, column, value)| (place(row, column), value))
                .filter(|&(place, _)| place != Blocks::skipped())
                .collect(),
            tangent_places: tangent.iter().map(|&(row, column)| place(row, column)).collect(),
            jacobian_places: jacobian.iter().map(|&(row, column)| place(row, column)).collect(),
            values: vec![0.0; all.len()],
            mass_trace: mass_places
                .iter()
                .filter(|(row, column, _)| row == column)
                .map(|entry| entry.2)
                .sum(),
            multiplied_mass,
            parts,
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
        for &(place, value) in &self.mass_entries {
            self.values[place as usize] += mass_weight * value;
        }
        let mut blocks = Blocks::add_to(&self.tangent_places, &mut self.values);
        system.forces(&mut |force| force.add_tangent(motion, weights, &mut blocks));
        debug_assert_eq!(
            blocks.entries(),
            self.tangent_places.len(),
            "a contribution changed its pattern"
        );
        let mut cursor = 0;
        let (values, places) = (&mut self.values, &self.jacobian_places);
        visit_jacobian(system, motion, &mut |_, _, entries| {
            for &entry in entries {
                for _ in 0..2 {
                    if places[cursor] != Blocks::skipped() {
                        values[places[cursor] as usize] += scale * entry;
                    }
                    cursor += 1;
                }
            }
        });
        for part in &mut self.parts {
            part.factor(&self.values)?;
        }
        Ok(())
    }

    /// Solves in place; `right_side` has one entry per coordinate and multiplier, those of fixed coordinates become zero.
    pub fn solve(&mut self, right_side: &[f64], solution: &mut [f64]) {
        solution.fill(0.0);
        for part in &mut self.parts {
            part.solve(right_side, solution);
        }
    }

    /// Typical mass per coordinate, kg; scales constraint rows.
    pub fn mean_mass(&self) -> f64 {
        (self.mass_trace / self.coordinates.max(1) as f64).max(f64::MIN_POSITIVE)
    }
}

impl Part {
    fn new(entries: &[(u32, u32)], first_value: usize, (coordinates, size): (usize, usize)) -> Self {
        let mut unknowns: Vec<usize> = entries.iter().map(|&(_, column)| column as usize).collect();
        unknowns.dedup();
        let mut local = vec![usize::MAX; size];
        for (i, &unknown) in unknowns.iter().enumerate() {
            local[unknown] = i;
        }
        let mut starts = vec![0; unknowns.len() + 1];
        for &(_, column) in entries {
            starts[local[column as usize] + 1] += 1;
        }
        for i in 0..unknowns.len() {
            starts[i + 1] += starts[i];
        }
        // Multipliers make a matrix indefinite, turning bodies make it unsymmetric; structures are neither.
        let bare = unknowns.iter().all(|&unknown| unknown < coordinates);
        let shape = if bare && unknowns.len() > SMALL {
            Shape::Definite
        } else {
            Shape::General
        };
        let rows = entries.iter().map(|&(row, _)| local[row as usize]).collect();
        Self {
            factors: SparseFactor::analyse(unknowns.len(), starts, rows, shape),
            right_side: vec![0.0; unknowns.len()],
            first_value,
            values: entries.len(),
            unknowns,
        }
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        if !self
            .factors
            .factor(&values[self.first_value..self.first_value + self.values])
        {
            return Err(Singular {
                unknown: self.unknowns[0],
            });
        }
        // faer divides by a zero pivot without complaint: a right side without symmetry shows it.
        for (i, value) in self.right_side.iter_mut().enumerate() {
            *value = 1.0 + 0.1 * ((i * 7 % 11) as f64);
        }
        self.factors.solve(&mut self.right_side);
        let worst = (0..self.unknowns.len())
            .max_by(|&i, &j| {
                let size = |k: usize| {
                    let value = self.right_side[k].abs();
                    if value.is_nan() { f64::INFINITY } else { value }
                };
                size(i).total_cmp(&size(j))
            })
            .unwrap_or(0);
        if self.right_side.iter().all(|value| value.is_finite()) {
            Ok(())
        } else {
            Err(Singular {
                unknown: self.unknowns[worst],
            })
        }
    }

    fn solve(&mut self, right_side: &[f64], solution: &mut [f64]) {
        for (value, &unknown) in self.right_side.iter_mut().zip(&self.unknowns) {
            *value = right_side[unknown];
        }
        self.factors.solve(&mut self.right_side);
        for (value, &unknown) in self.right_side.iter().zip(&self.unknowns) {
            solution[unknown] = *value;
        }
    }
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

/// The constant mass matrix of a system, with all rows.
pub(crate) fn mass_matrix(system: &mut dyn System) -> SparseMatrix {
    selected_mass_matrix(system, |_| true)
}

/// The mass matrix of the contributions that are `selected`.
fn selected_mass_matrix(system: &mut dyn System, selected: impl Fn(&dyn Force) -> bool) -> SparseMatrix {
    let mut add_to = |blocks: &mut Blocks<'_>| {
        system.forces(&mut |force| {
            if selected(force) {
                force.add_mass(blocks);
            }
        });
    };
    let mut places = Vec::new();
    add_to(&mut Blocks::record(&mut places));
    let order: Vec<u32> = (0..places.len() as u32).collect();
    let mut values = vec![0.0; places.len()];
    add_to(&mut Blocks::add_to(&order, &mut values));
    let entries = places
        .iter()
        .zip(&values)
        .map(|(&(row, column), &value)| (row, column, value));
    SparseMatrix::from_entries(system.layout().coordinates(), entries.collect())
}

/// Union of coupled unknowns; the root of a set is its smallest member.
struct Links {
    parent: Vec<usize>,
}

impl Links {
    fn new(size: usize) -> Self {
        Self {
            parent: (0..size).collect(),
        }
    }

    fn root(&self, mut i: usize) -> usize {
        while self.parent[i] != i {
            i = self.parent[i];
        }
        i
    }

    fn join(&mut self, i: usize, j: usize) {
        let (i, j) = (self.root(i), self.root(j));
        let (low, high) = (i.min(j), i.max(j));
        self.parent[high] = low;
    }
}
