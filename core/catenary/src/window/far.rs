//! The spans far from the strips as one contribution.
use super::cell::{Cell, GROUP, Pair};
use dynamics::{Blocks, Force, Motion, Weights};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;
use std::sync::Arc;

/// A reduced span in the coordinates of the system.
pub(super) struct Member {
    pub cell: Arc<Cell>,
    /// Coordinates of its left, then of its right support.
    pub supports: Vec<usize>,
    /// Coordinates of its first modes, as many as are kept.
    pub modes: Range<usize>,
    /// Stiffness (1/s²) and damping (1/s) of the modes, that of the sponge included.
    own: Vec<Pair>,
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
    /// Static forces of what was cut off, N, of the first coordinates.
    pub load: Vec<f64>,
}

impl Member {
    /// A span with damping `sponge` (1/s) added to its modes.
    pub fn new(cell: Arc<Cell>, supports: Vec<usize>, modes: Range<usize>, sponge: &[f64]) -> Self {
        let value = |of: &dyn Fn(usize) -> f64, i: usize| if i < modes.len() { of(i) } else { 0.0 };
        let own = (0..modes.len().div_ceil(GROUP)).map(|group| {
            let lanes = |of: &dyn Fn(usize) -> f64| std::array::from_fn(|lane| value(of, GROUP * group + lane));
            Pair([
                lanes(&|i| cell.squares[i]),
                lanes(&|i| cell.mode_damping[i] + sponge[i]),
            ])
        });
        Self {
            own: own.collect(),
            cell,
            supports,
            modes,
        }
    }

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
            let [squares, damping] = self.own[i / GROUP].0.map(|lanes| lanes[i % GROUP]);
            blocks.add(&[mode], &[mode], &[k * squares + d * damping + m]);
        }
    }

    /// Adds `−K q − D v`, and `−M v̇` where `v_dot` is given.
    fn add_force(&self, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        match self.supports.len() {
            PLANAR => self.add_force_of::<PLANAR>(motion, v_dot, force),
            _ => self.add_force_of::<SPATIAL>(motion, v_dot, force),
        }
    }

    /// Whether a coordinate of the span is within `range`.
    fn is_within(&self, range: &Range<usize>) -> bool {
        let modes = self.modes.start < range.end && range.start < self.modes.end;
        modes || self.supports.iter().any(|index| range.contains(index))
    }

    fn add_force_of<const N: usize>(&self, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        let gather = |values: &[f64]| -> [f64; N] { std::array::from_fn(|i| values[self.supports[i]]) };
        let mut on_supports = [0.0; N];
        Arch::new().dispatch(AddForce::<N> {
            member: self,
            supports: [gather(motion.q), gather(motion.v), v_dot.map_or([0.0; N], gather)],
            modes: [motion.q, motion.v, v_dot.unwrap_or_default()],
            on_supports: &mut on_supports,
            force,
        });
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

/// The force of a span with `N` coordinates at its supports.
struct AddForce<'a, const N: usize> {
    member: &'a Member,
    /// `q`, `v` and `v̇` of the supports.
    supports: [[f64; N]; 3],
    /// `q`, `v` and `v̇` of everything; no `v̇` stands for zeros.
    modes: [&'a [f64]; 3],
    on_supports: &'a mut [f64; N],
    force: &'a mut [f64],
}

impl<const N: usize> WithSimd for AddForce<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let cell = &self.member.cell;
        let [q, v, a] = self.supports;
        let columns = (cell.stiffness.as_slice().chunks_exact(N))
            .zip(cell.damping.as_slice().chunks_exact(N))
            .zip(cell.mass.as_slice().chunks_exact(N));
        // Three chains of additions in place of one.
        let mut sums = [[0.0; N]; 3];
        for (column, ((k, d), m)) in columns.enumerate() {
            for i in 0..N {
                sums[0][i] += k[i] * q[column];
                sums[1][i] += d[i] * v[column];
                sums[2][i] += m[i] * a[column];
            }
        }
        let zero = simd.splat_f64s(0.0);
        let mut by_modes = [zero; N];
        let groups = self.member.own.len();
        for part in 0..GROUP / S::F64_LANES {
            let mut group = 0;
            while group + ABREAST <= groups {
                self.add_modes::<S, ABREAST>(simd, (group, part), &mut by_modes);
                group += ABREAST;
            }
            for group in group..groups {
                self.add_modes::<S, 1>(simd, (group, part), &mut by_modes);
            }
        }
        for i in 0..N {
            self.on_supports[i] = sums[0][i] + sums[1][i] + sums[2][i] + simd.reduce_sum_f64s(by_modes[i]);
        }
    }
}

/// Groups of modes that are evaluated together: each sum waits for its last addition, several sums do not wait for each other.
const ABREAST: usize = 3;

impl<const N: usize> AddForce<'_, N> {
    /// Adds the forces of `W` groups of modes, from group `first` on, of each the register `part`; `on_supports` takes in what
    /// they do at the supports.
    #[inline(always)]
    fn add_modes<S: Simd, const W: usize>(
        &mut self,
        simd: S,
        (first, part): (usize, usize),
        on_supports: &mut [S::f64s; N],
    ) {
        let Member { cell, modes, own, .. } = self.member;
        let zero = simd.splat_f64s(0.0);
        let lanes = |values: &[f64; GROUP]| S::as_simd_f64s(values).0[part];
        let range = |w: usize| {
            let start = modes.start + (first + w) * GROUP + part * S::F64_LANES;
            start.min(modes.end)..modes.end.min(start + S::F64_LANES)
        };
        let (mut v_m, mut a_m) = ([zero; W], [zero; W]);
        let (mut by_damping, mut by_mass) = ([zero; W], [zero; W]);
        for w in 0..W {
            let of_modes = |values: &[f64]| simd.partial_load_f64s(values.get(range(w)).unwrap_or_default());
            let [q, v, a] = self.modes;
            let (q, v, a) = (of_modes(q), of_modes(v), of_modes(a));
            let Pair([square, damping]) = &own[first + w];
            (v_m[w], a_m[w]) = (v, a);
            by_damping[w] = simd.mul_add_e_f64s(lanes(square), q, simd.mul_f64s(lanes(damping), v));
            by_mass[w] = a;
        }
        let [_, v_s, a_s] = &self.supports;
        let couplings: [&[Pair]; W] = std::array::from_fn(|w| &cell.couplings[(first + w) * N..(first + w + 1) * N]);
        for i in 0..N {
            let (v, a) = (simd.splat_f64s(v_s[i]), simd.splat_f64s(a_s[i]));
            let mut sum = on_supports[i];
            for w in 0..W {
                let Pair([d, m]) = &couplings[w][i];
                let (d, m) = (lanes(d), lanes(m));
                by_damping[w] = simd.mul_add_e_f64s(d, v, by_damping[w]);
                by_mass[w] = simd.mul_add_e_f64s(m, a, by_mass[w]);
                sum = simd.mul_add_e_f64s(d, v_m[w], simd.mul_add_e_f64s(m, a_m[w], sum));
            }
            on_supports[i] = sum;
        }
        for w in 0..W {
            let force = &mut self.force[range(w)];
            let sum = simd.add_f64s(by_damping[w], by_mass[w]);
            simd.partial_store_f64s(force, simd.sub_f64s(simd.partial_load_f64s(force), sum));
        }
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
        let end = range.end.min(self.load.len());
        let range = range.start.min(end)..end;
        for (force, load) in force[range.clone()].iter_mut().zip(&self.load[range]) {
            *force += load;
        }
    }
}

impl Force for FarField {
    fn part(&self) -> Option<&'static str> {
        Some("wires")
    }

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
        let load: f64 = self.load.iter().zip(motion.q).map(|(load, q)| load * q).sum();
        members + grounds - load
    }
}
