//! The spans far from the strips as one contribution.
use super::cell::Cell;
use dynamics::{Blocks, Force, Motion, Weights};
use pulp::Arch;
use std::ops::Range;
use std::sync::Arc;

/// A reduced span in the coordinates of the system.
pub(super) struct Member {
    pub cell: Arc<Cell>,
    /// Coordinates of its left, then of its right support.
    pub supports: Vec<usize>,
    /// Coordinates of its first modes, as many as are kept.
    pub modes: Range<usize>,
    /// Damping added to each mode, 1/s: the sponge.
    pub sponge: Vec<f64>,
}

/// Coordinates of both supports of a span, with and without lateral ones.
const SPATIAL: usize = 24;
const PLANAR: usize = 16;

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
        let modes: Vec<usize> = self.modes.clone().collect();
        scratch.clear();
        for row in 0..size {
            for mode in 0..self.modes.len() {
                let at = (row, mode);
                scratch.push(d * cell.damping_coupling[at] + m * cell.mass_coupling[at]);
            }
        }
        blocks.add(&self.supports, &modes, scratch);
        scratch.clear();
        for mode in 0..self.modes.len() {
            for row in 0..size {
                let at = (row, mode);
                scratch.push(d * cell.damping_coupling[at] + m * cell.mass_coupling[at]);
            }
        }
        blocks.add(&modes, &self.supports, scratch);
        for (i, &mode) in modes.iter().enumerate() {
            let damping = cell.mode_damping[i] + self.sponge[i];
            blocks.add(&[mode], &[mode], &[k * cell.squares[i] + d * damping + m]);
        }
    }

    /// Adds `−K q − D v`, and `−M v̇` where `v_dot` is given.
    fn add_force(&self, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        Arch::new().dispatch(
            #[inline(always)]
            || match self.supports.len() {
                PLANAR => self.add_force_of::<PLANAR>(motion, v_dot, force),
                _ => self.add_force_of::<SPATIAL>(motion, v_dot, force),
            },
        );
    }

    /// Whether a coordinate of the span is within `range`.
    fn is_within(&self, range: &Range<usize>) -> bool {
        let modes = self.modes.start < range.end && range.start < self.modes.end;
        modes || self.supports.iter().any(|index| range.contains(index))
    }

    #[inline(always)]
    fn add_force_of<const N: usize>(&self, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        let cell = &self.cell;
        let gather = |values: &[f64]| -> [f64; N] { std::array::from_fn(|i| values[self.supports[i]]) };
        let (q, v, a) = (gather(motion.q), gather(motion.v), v_dot.map_or([0.0; N], gather));
        let mut on_supports = [0.0; N];
        let columns = (cell.stiffness.as_slice().chunks_exact(N))
            .zip(cell.damping.as_slice().chunks_exact(N))
            .zip(cell.mass.as_slice().chunks_exact(N));
        for (column, ((k, d), m)) in columns.enumerate() {
            for i in 0..N {
                on_supports[i] += k[i] * q[column] + d[i] * v[column] + m[i] * a[column];
            }
        }
        let range = self.modes.clone();
        let (q_m, v_m) = (&motion.q[range.clone()], &motion.v[range.clone()]);
        let couplings = (cell.damping_coupling.as_slice().chunks_exact(N))
            .zip(cell.mass_coupling.as_slice().chunks_exact(N))
            .take(range.len());
        for (i, (d, m)) in couplings.enumerate() {
            let a_m = v_dot.map_or(0.0, |v_dot| v_dot[range.start + i]);
            let mut own = cell.squares[i] * q_m[i] + (cell.mode_damping[i] + self.sponge[i]) * v_m[i] + a_m;
            for j in 0..N {
                on_supports[j] += d[j] * v_m[i] + m[j] * a_m;
                own += d[j] * v[j] + m[j] * a[j];
            }
            force[range.start + i] -= own;
        }
        for (&index, value) in self.supports.iter().zip(on_supports) {
            force[index] -= value;
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
        let modes = self.modes.clone().zip(&cell.squares);
        energy
            + modes
                .map(|(mode, square)| 0.5 * square * motion.q[mode].powi(2))
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

impl FarField {
    /// What is within `range`, and more.
    fn add_within(&self, range: &Range<usize>, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        for member in self.members.iter().filter(|member| member.is_within(range)) {
            member.add_force(motion, v_dot, force);
        }
        for ground in self.grounds.iter().filter(|ground| range.contains(&ground.index)) {
            let (q, v) = (motion.q[ground.index], motion.v[ground.index]);
            let a = v_dot.map_or(0.0, |v_dot| v_dot[ground.index]);
            force[ground.index] -= ground.stiffness * q + ground.damping * v + ground.mass * a;
        }
        for &(index, load) in self.load.iter().filter(|(index, _)| range.contains(index)) {
            force[index] += load;
        }
    }
}

impl Force for FarField {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add_within(&(0..force.len()), motion, None, force);
    }

    fn multiplies_mass(&self) -> bool {
        true
    }

    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_within(&(0..force.len()), motion, Some(v_dot), force);
    }

    fn evaluates_ranges(&self) -> bool {
        true
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_within(&range, motion, Some(v_dot), force);
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
