//! A force linear in the motion, with its products arranged along wires.
use crate::NodeMap;
use dynamics::{Blocks, Force, Motion, SparseMatrix, Weights};
use std::ops::Range;

/// A force linear in coordinates, velocities and accelerations.
///
/// ```text
/// Q = Q₀ − K q − D v,    inertia M v̇
/// ```
#[derive(Clone, Debug)]
pub struct LinearForce {
    load: Vec<f64>,
    stiffness: SparseMatrix,
    damping: SparseMatrix,
    mass: SparseMatrix,
    rows: NodeRows,
    /// What of `K`, `D` and `M` is not in `rows`.
    rest: [FewRows; 3],
}

impl LinearForce {
    /// A force of given `Q₀` (N), `K` (N/m), `D` (N·s/m) and `M` (kg).
    #[must_use]
    pub fn new(load: Vec<f64>, stiffness: SparseMatrix, damping: SparseMatrix, mass: SparseMatrix) -> Self {
        let rest = [&stiffness, &damping, &mass].map(FewRows::of);
        Self {
            load,
            stiffness,
            damping,
            mass,
            rows: NodeRows::None,
            rest,
        }
    }

    /// The same force with its products arranged along chains of nodes, the wires: `K` couples each node with its neighbours in
    /// the chain, `D` and `M` do the same and hardly differ between components. Whatever does not fit is multiplied entry by
    /// entry, so that the chains are about speed only.
    ///
    /// The nodes of all chains have the same number of consecutive coordinates, else nothing is arranged.
    #[must_use]
    pub fn with_chains(mut self, chains: &[Vec<NodeMap>]) -> Self {
        let matrices = [&self.stiffness, &self.damping, &self.mass];
        if let Some((rows, rest)) = NodeBlocks::<4>::arrange(chains, matrices) {
            (self.rows, self.rest) = (NodeRows::Planar(rows), rest);
        } else if let Some((rows, rest)) = NodeBlocks::<6>::arrange(chains, matrices) {
            (self.rows, self.rest) = (NodeRows::Spatial(rows), rest);
        }
        self
    }

    /// `Q₀`, N.
    #[must_use]
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// `K`, N/m.
    #[must_use]
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// `D`, N·s/m.
    #[must_use]
    pub fn damping(&self) -> &SparseMatrix {
        &self.damping
    }

    /// `M`, kg.
    #[must_use]
    pub fn mass(&self) -> &SparseMatrix {
        &self.mass
    }

    fn add_rows(matrix: &SparseMatrix, weight: f64, blocks: &mut Blocks<'_>) {
        for row in 0..matrix.size() {
            for (column, value) in matrix.row(row) {
                blocks.add(&[row], &[column], &[weight * value]);
            }
        }
    }

    /// Adds `Q₀ − K q − D v − M a` to the rows in `range`, `a` being left out where there is none; rows beyond may get a part.
    fn add(&self, range: Range<usize>, motion: &Motion<'_>, a: Option<&[f64]>, force: &mut [f64]) {
        let range = range.start..range.end.min(self.load.len());
        for (force, load) in force[range.clone()].iter_mut().zip(&self.load[range.clone()]) {
            *force += load;
        }
        match &self.rows {
            NodeRows::None => {}
            NodeRows::Planar(rows) => rows.subtract(range.clone(), motion, a, force),
            NodeRows::Spatial(rows) => rows.subtract(range.clone(), motion, a, force),
        }
        let vectors = [Some(motion.q), Some(motion.v), a];
        for (rest, vector) in self.rest.iter().zip(vectors) {
            if let Some(vector) = vector {
                rest.subtract(range.clone(), vector, force);
            }
        }
    }
}

impl Force for LinearForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..force.len(), motion, None, force);
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        Self::add_rows(&self.stiffness, weights.q, blocks);
        Self::add_rows(&self.damping, weights.v, blocks);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        Self::add_rows(&self.mass, 1.0, blocks);
    }

    fn multiplies_mass(&self) -> bool {
        true
    }

    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add(0..force.len(), motion, Some(v_dot), force);
    }

    fn evaluates_ranges(&self) -> bool {
        true
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add(range, motion, Some(v_dot), force);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let work: f64 = self.load.iter().zip(motion.q).map(|(load, q)| load * q).sum();
        0.5 * self.stiffness.quadratic_form(motion.q) - work
    }
}

/// The rows of a matrix that have entries.
#[derive(Clone, Debug, Default)]
struct FewRows {
    rows: Vec<usize>,
    matrix: SparseMatrix,
}

impl FewRows {
    fn of(matrix: &SparseMatrix) -> Self {
        Self {
            rows: (0..matrix.size())
                .filter(|&row| matrix.row(row).next().is_some())
                .collect(),
            matrix: matrix.clone(),
        }
    }

    /// Subtracts the product with `x` from the rows in `range`.
    fn subtract(&self, range: Range<usize>, x: &[f64], y: &mut [f64]) {
        let first = self.rows.partition_point(|&row| row < range.start);
        for &row in self.rows[first..].iter().take_while(|&&row| row < range.end) {
            y[row] -= self
                .matrix
                .row(row)
                .map(|(column, value)| value * x[column])
                .sum::<f64>();
        }
    }
}

/// The products of all nodes, by the number of coordinates of each.
#[derive(Clone, Debug)]
enum NodeRows {
    None,
    Planar(NodeBlocks<4>),
    Spatial(NodeBlocks<6>),
}

/// The part of one component-wise matrix that couples a node with the one before it, itself, and the one after it; each
/// (position, position), (position, slope), (slope, position), (slope, slope).
type Coupling = [[f64; 4]; 3];

/// Rows of `B` coordinates per node, half of them positions, then as many slopes.
#[derive(Clone, Debug)]
struct NodeBlocks<const B: usize> {
    /// First coordinates of the node before, of the node, and of the node after, in the order of the second; a node at the end of
    /// its chain stands for its missing neighbour, with zeros.
    nodes: Vec<[u32; 3]>,
    /// The columns of the rows of `K`: `3 B` per node.
    stiffness: Vec<[f64; B]>,
    /// `D` and `M`.
    rates: Vec<[Coupling; 2]>,
}

impl<const B: usize> NodeBlocks<B> {
    /// Takes what it can of `K`, `D` and `M` along chains; returns what is left beside it.
    fn arrange(chains: &[Vec<NodeMap>], matrices: [&SparseMatrix; 3]) -> Option<(Self, [FewRows; 3])> {
        let mut nodes = Vec::new();
        for chain in chains {
            let starts = chain
                .iter()
                .map(first_of_consecutive::<B>)
                .collect::<Option<Vec<u32>>>()?;
            for (k, &start) in starts.iter().enumerate() {
                let before = if k == 0 { start } else { starts[k - 1] };
                nodes.push([before, start, *starts.get(k + 1).unwrap_or(&start)]);
            }
        }
        nodes.sort_unstable_by_key(|node| node[1]);
        let mut blocks = Self {
            stiffness: vec![[0.0; B]; nodes.len() * 3 * B],
            rates: vec![[Coupling::default(); 2]; nodes.len()],
            nodes,
        };
        let rest = [0, 1, 2].map(|which| blocks.take(which, matrices[which]));
        Some((blocks, rest))
    }

    /// Takes what it can of matrix `which` (0, 1, 2 for `K`, `D`, `M`).
    fn take(&mut self, which: usize, matrix: &SparseMatrix) -> FewRows {
        let mut left = Vec::new();
        let mut next = 0;
        for row in 0..matrix.size() {
            while next < self.nodes.len() && self.nodes[next][1] as usize + B <= row {
                next += 1;
            }
            let node = self.nodes.get(next).filter(|node| node[1] as usize <= row);
            for (column, value) in matrix.row(row) {
                let slot = node.and_then(|node| slot_of::<B>(node, column));
                let (Some(node), Some((neighbour, j))) = (node, slot) else {
                    left.push((row as u32, column as u32, value));
                    continue;
                };
                let i = row - node[1] as usize;
                if which == 0 {
                    self.stiffness[(3 * next + neighbour) * B + j][i] = value;
                } else if let Some(place) = component::<B>(i, j) {
                    // The last component serves for all; what the others have beyond it is left.
                    if i % (B / 2) == B / 2 - 1 {
                        self.rates[next][which - 1][neighbour][place] = value;
                    }
                } else {
                    left.push((row as u32, column as u32, value));
                }
            }
        }
        if which > 0 {
            self.leave_differences(which, matrix, &mut left);
        }
        FewRows::of(&SparseMatrix::from_entries(matrix.size(), left))
    }

    /// Leaves what matrix `which` has beyond the same coupling of all components.
    fn leave_differences(&self, which: usize, matrix: &SparseMatrix, left: &mut Vec<(u32, u32, f64)>) {
        for (node, rates) in self.nodes.iter().zip(&self.rates) {
            for i in 0..B {
                let row = node[1] as usize + i;
                let mut entries = [[0.0; B]; 3];
                for (column, value) in matrix.row(row) {
                    if let Some((neighbour, j)) = slot_of::<B>(node, column) {
                        entries[neighbour][j] = value;
                    }
                }
                for (neighbour, entries) in entries.iter().enumerate() {
                    for (j, entry) in entries.iter().enumerate() {
                        if let Some(place) = component::<B>(i, j) {
                            let difference = entry - rates[which - 1][neighbour][place];
                            if difference != 0.0 {
                                left.push((row as u32, node[neighbour] + j as u32, difference));
                            }
                        }
                    }
                }
            }
        }
    }

    /// Subtracts the products from the rows of all nodes that reach into `range`.
    fn subtract(&self, range: Range<usize>, motion: &Motion<'_>, a: Option<&[f64]>, force: &mut [f64]) {
        let first = self.nodes.partition_point(|node| node[1] as usize + B <= range.start);
        let last = self.nodes.partition_point(|node| (node[1] as usize) < range.end);
        let nodes = self.nodes[first..last].iter().zip(&self.rates[first..last]);
        for ((node, rates), columns) in nodes.zip(self.stiffness[first * 3 * B..].chunks_exact(3 * B)) {
            let mut sum = [0.0; B];
            for (neighbour, (&start, columns)) in node.iter().zip(columns.chunks_exact(B)).enumerate() {
                if let (Some(q), Some(v)) = (chunk::<B>(motion.q, start), chunk::<B>(motion.v, start)) {
                    for (column, q) in columns.iter().zip(q) {
                        for i in 0..B {
                            sum[i] += column[i] * q;
                        }
                    }
                    add_coupled(&rates[0][neighbour], v, &mut sum);
                }
                if let Some(a) = a.and_then(|a| chunk::<B>(a, start)) {
                    add_coupled(&rates[1][neighbour], a, &mut sum);
                }
            }
            let start = node[1] as usize;
            for (force, sum) in force[start..start + B].iter_mut().zip(sum) {
                *force -= sum;
            }
        }
    }
}

/// The first coordinate of a node whose coordinates are `B` consecutive ones, positions first.
fn first_of_consecutive<const B: usize>(map: &NodeMap) -> Option<u32> {
    let first = map.indices().next()?;
    let count = map.indices().count();
    let consecutive = map.indices().zip(first..).all(|(index, expected)| index == expected);
    let positions = (0..3).filter(|&axis| map.position(axis).is_some()).count();
    (count == B && 2 * positions == B && consecutive).then_some(first as u32)
}

/// Which neighbour of a node `column` belongs to, and its number there.
fn slot_of<const B: usize>(node: &[u32; 3], column: usize) -> Option<(usize, usize)> {
    // The node itself before those that it may stand for.
    [1, 0, 2].into_iter().find_map(|neighbour| {
        let j = column.checked_sub(node[neighbour] as usize)?;
        (j < B).then_some((neighbour, j))
    })
}

/// The place in a coupling of coordinates `i` and `j`, where they are of the same component.
fn component<const B: usize>(i: usize, j: usize) -> Option<usize> {
    let half = B / 2;
    (i % half == j % half).then_some(2 * (i / half) + j / half)
}

#[inline(always)]
fn chunk<const B: usize>(values: &[f64], start: u32) -> Option<&[f64; B]> {
    values.get(start as usize..)?.first_chunk()
}

/// Adds the product of a component-wise coupling with the coordinates of a node.
#[inline(always)]
fn add_coupled<const B: usize>([pp, ps, sp, ss]: &[f64; 4], x: &[f64; B], sum: &mut [f64; B]) {
    let half = B / 2;
    for c in 0..half {
        sum[c] += pp * x[c] + ps * x[half + c];
        sum[half + c] += sp * x[c] + ss * x[half + c];
    }
}

#[cfg(test)]
mod tests;
