//! The spans far from the strips as one contribution.
use super::cell::Cell;
use dynamics::{Blocks, Force, Motion, Weights};
use std::sync::Arc;

/// A reduced span in the coordinates of the system.
pub(super) struct Member {
    pub cell: Arc<Cell>,
    /// Coordinates of its left, then of its right support.
    pub supports: Vec<usize>,
    /// Coordinates of its first modes, as many as are kept.
    pub modes: Vec<usize>,
    /// Damping added to each mode, 1/s: the sponge.
    pub sponge: Vec<f64>,
}

/// Spring, damper and mass between one coordinate and the ground.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ground {
    pub index: usize,
    /// N/m.
    pub stiffness: f64,
    /// N·s/m.
    pub damping: f64,
    /// kg.
    pub mass: f64,
}

/// Reduced spans, the supports between them, the ends of what is modelled, and the static forces at the cuts.
#[derive(Default)]
pub(super) struct FarField {
    pub members: Vec<Member>,
    pub grounds: Vec<Ground>,
    /// Static forces of what was cut off, N.
    pub load: Vec<(usize, f64)>,
}

impl Member {
    fn add_constant(&self, blocks: &mut Blocks<'_>, scratch: &mut Vec<f64>, [k, d, m]: [f64; 3]) {
        let cell = &self.cell;
        let size = self.supports.len();
        scratch.clear();
        for row in 0..size {
            for column in 0..size {
                let at = (row, column);
                scratch.push(k * cell.stiffness[at] + d * cell.damping[at] + m * cell.mass[at]);
            }
        }
        blocks.add(&self.supports, &self.supports, scratch);
        scratch.clear();
        for row in 0..size {
            for mode in 0..self.modes.len() {
                let at = (row, mode);
                scratch.push(d * cell.damping_coupling[at] + m * cell.mass_coupling[at]);
            }
        }
        blocks.add(&self.supports, &self.modes, scratch);
        scratch.clear();
        for mode in 0..self.modes.len() {
            for row in 0..size {
                let at = (row, mode);
                scratch.push(d * cell.damping_coupling[at] + m * cell.mass_coupling[at]);
            }
        }
        blocks.add(&self.modes, &self.supports, scratch);
        for (i, &mode) in self.modes.iter().enumerate() {
            let damping = cell.mode_damping[i] + self.sponge[i];
            blocks.add(&[mode], &[mode], &[k * cell.squares[i] + d * damping + m]);
        }
    }

    fn add_force(&self, motion: &Motion<'_>, force: &mut [f64]) {
        let cell = &self.cell;
        let size = self.supports.len();
        for (column, &from) in self.supports.iter().enumerate() {
            let (q, v) = (motion.q[from], motion.v[from]);
            let (k, d) = (cell.stiffness.column(column), cell.damping.column(column));
            for row in 0..size {
                force[self.supports[row]] -= k[row] * q + d[row] * v;
            }
        }
        for (i, &mode) in self.modes.iter().enumerate() {
            let (q, v) = (motion.q[mode], motion.v[mode]);
            let coupling = cell.damping_coupling.column(i);
            let mut own = cell.squares[i] * q + (cell.mode_damping[i] + self.sponge[i]) * v;
            for (row, &support) in self.supports.iter().enumerate() {
                force[support] -= coupling[row] * v;
                own += coupling[row] * motion.v[support];
            }
            force[mode] -= own;
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let cell = &self.cell;
        let mut energy = 0.0;
        for (column, &from) in self.supports.iter().enumerate() {
            for (row, &to) in self.supports.iter().enumerate() {
                energy += 0.5 * cell.stiffness[(row, column)] * motion.q[from] * motion.q[to];
            }
        }
        let modes = self.modes.iter().zip(&cell.squares);
        energy
            + modes
                .map(|(&mode, square)| 0.5 * square * motion.q[mode].powi(2))
                .sum::<f64>()
    }
}

impl FarField {
    fn add_constant(&self, blocks: &mut Blocks<'_>, weights: [f64; 3]) {
        let mut scratch = Vec::new();
        for member in &self.members {
            member.add_constant(blocks, &mut scratch, weights);
        }
        let [k, d, m] = weights;
        for ground in &self.grounds {
            let value = k * ground.stiffness + d * ground.damping + m * ground.mass;
            blocks.add(&[ground.index], &[ground.index], &[value]);
        }
    }
}

impl Force for FarField {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for member in &self.members {
            member.add_force(motion, force);
        }
        for ground in &self.grounds {
            let (q, v) = (motion.q[ground.index], motion.v[ground.index]);
            force[ground.index] -= ground.stiffness * q + ground.damping * v;
        }
        for &(index, load) in &self.load {
            force[index] += load;
        }
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.add_constant(blocks, [weights.q, weights.v, 0.0]);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        self.add_constant(blocks, [0.0, 0.0, 1.0]);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let members: f64 = self.members.iter().map(|member| member.energy(motion)).sum();
        let grounds = self.grounds.iter();
        let grounds: f64 = grounds
            .map(|ground| 0.5 * ground.stiffness * motion.q[ground.index].powi(2))
            .sum();
        let load: f64 = self.load.iter().map(|&(index, load)| load * motion.q[index]).sum();
        members + grounds - load
    }
}
