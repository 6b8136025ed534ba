//! The spans far from the strips as one contribution.
use super::cell::Cell;
use super::part::{GROUP, Grouped, Part};
use dynamics::{Blocks, ByRange, Force, Motion, OnePass, Weights};
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;
use std::sync::Arc;

/// A part of a reduced span in the coordinates of the system.
pub(super) struct Member {
    part: Arc<Part>,
    /// Coordinates of its interface, see [`Part`].
    pub interface: Vec<usize>,
    /// Coordinates of the modes that are kept.
    pub modes: Range<usize>,
    /// Stiffness (1/s²) and damping (1/s) of the modes, the sponge included.
    own: Vec<Grouped<2>>,
    /// `q`, `v` and `v̇` of the interface, row by row, padded with zeros, and the force there.
    at_interface: Vec<[f64; 4]>,
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

/// Reduced spans, the supports between them, the ends of the modelled line, and the static forces at the cuts.
#[derive(Default)]
pub(super) struct FarField {
    pub members: Vec<Member>,
    pub grounds: Vec<Ground>,
    /// Static forces of the cut-off parts on the first coordinates, N.
    pub load: Vec<f64>,
}

impl Member {
    /// The parts of a span, with damping `sponge` (1/s) added to its modes.
    pub fn of_span(cell: &Cell, interface: &[usize], modes: Range<usize>, sponge: f64) -> impl Iterator<Item = Self> {
        cell.parts(modes).map(move |(part, modes)| {
            let rows = part.rows.iter().map(|&row| interface[row]);
            Self::new(Arc::clone(part), rows.collect(), modes, sponge)
        })
    }

    fn new(part: Arc<Part>, interface: Vec<usize>, modes: Range<usize>, sponge: f64) -> Self {
        let own = (0..modes.len()).step_by(GROUP).map(|first| {
            Grouped::new(first, |kind, i| match kind {
                _ if i >= modes.len() => 0.0,
                0 => part.squares[i],
                _ => part.mode_damping[i] + sponge,
            })
        });
        Self {
            own: own.collect(),
            at_interface: vec![[0.0; 4]; part.stiffness.nrows()],
            part,
            interface,
            modes,
        }
    }

    fn add_constant(&self, blocks: &mut Blocks<'_>, scratch: &mut Vec<f64>, [k, d, m]: [f64; 3]) {
        let part = &self.part;
        let size = self.interface.len();
        scratch.clear();
        // The matrices are symmetric and stored column by column.
        for row in 0..size {
            for column in 0..size {
                let at = (column, row);
                scratch.push(k * part.stiffness[at] + d * part.damping[at] + m * part.mass[at]);
            }
        }
        blocks.add(&self.interface, &self.interface, scratch);
        for (i, mode) in self.modes.clone().enumerate() {
            let couplings = part
                .damping_coupling
                .column(i)
                .into_iter()
                .zip(part.mass_coupling.column(i));
            scratch.clear();
            scratch.extend(
                couplings
                    .take(size)
                    .map(|(of_damping, of_mass)| d * of_damping + m * of_mass),
            );
            blocks.add(&self.interface, &[mode], scratch);
            blocks.add(&[mode], &self.interface, scratch);
            let [squares, damping] = self.own[i / GROUP].0.map(|lanes| lanes[i % GROUP]);
            blocks.add(&[mode], &[mode], &[k * squares + d * damping + m]);
        }
    }

    /// Adds `−K q − D v`, and `−M v̇` if `v_dot` is given.
    fn add_force(&mut self, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        // Rows in batches that fit the registers.
        let rows = self.at_interface.len();
        match rows {
            _ if rows.is_multiple_of(24) => self.add_force_of::<24>(motion, v_dot, force),
            _ if rows.is_multiple_of(16) => self.add_force_of::<16>(motion, v_dot, force),
            _ => self.add_force_of::<GROUP>(motion, v_dot, force),
        }
    }

    /// True if a coordinate of the span is within `range`.
    fn is_within(&self, range: &Range<usize>) -> bool {
        let modes = self.modes.start < range.end && range.start < self.modes.end;
        modes || self.interface.iter().any(|index| range.contains(index))
    }

    fn add_force_of<const N: usize>(&mut self, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        let v_dot = v_dot.unwrap_or_default();
        for (value, &index) in self.at_interface.iter_mut().zip(&self.interface) {
            let a = v_dot.get(index).copied().unwrap_or(0.0);
            *value = [motion.q[index], motion.v[index], a, 0.0];
        }
        Arch::new().dispatch(AddForce::<N> {
            part: &self.part,
            range: self.modes.clone(),
            own: &self.own,
            at_interface: &mut self.at_interface,
            modes: [motion.q, motion.v, v_dot],
            force,
        });
        for (&index, [.., value]) in self.interface.iter().zip(&self.at_interface) {
            force[index] -= value;
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let part = &self.part;
        let mut energy = 0.0;
        for (column, &from) in self.interface.iter().enumerate() {
            for (row, &to) in self.interface.iter().enumerate() {
                energy += 0.5 * part.stiffness[(row, column)] * motion.q[from] * motion.q[to];
            }
        }
        let modes = self.modes.clone().zip(&part.squares);
        energy
            + modes
                .map(|(mode, square)| 0.5 * square * motion.q[mode].powi(2))
                .sum::<f64>()
    }
}

/// The force of a span, `N` rows of its interface at a time.
struct AddForce<'a, const N: usize> {
    part: &'a Part,
    /// Coordinates of the modes.
    range: Range<usize>,
    own: &'a [Grouped<2>],
    at_interface: &'a mut [[f64; 4]],
    /// `q`, `v` and `v̇` of the whole system; no `v̇` stands for zeros.
    modes: [&'a [f64]; 3],
    force: &'a mut [f64],
}

impl<const N: usize> WithSimd for AddForce<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        for first in (0..self.at_interface.len()).step_by(S::F64_LANES) {
            self.set_dense(simd, first);
        }
        for first in (0..self.at_interface.len()).step_by(N) {
            let zero = simd.splat_f64s(0.0);
            let mut by_modes = [zero; N];
            let groups = self.own.len();
            for part in 0..GROUP / S::F64_LANES {
                let mut group = 0;
                while group + ABREAST <= groups {
                    self.add_modes::<S, ABREAST>(simd, (group, part), first, &mut by_modes);
                    group += ABREAST;
                }
                for group in group..groups {
                    self.add_modes::<S, 1>(simd, (group, part), first, &mut by_modes);
                }
            }
            for (value, by_modes) in self.at_interface[first..first + N].iter_mut().zip(by_modes) {
                value[3] += simd.reduce_sum_f64s(by_modes);
            }
        }
    }
}

/// Number of groups of modes that are evaluated together: each sum waits for its last addition, several sums do not
/// wait for each other.
const ABREAST: usize = 3;

impl<const N: usize> AddForce<'_, N> {
    /// Sets the force at as many rows of the interface as a register holds, from `first` on, to the interface's own
    /// force there.
    #[inline(always)]
    fn set_dense<S: Simd>(&mut self, simd: S, first: usize) {
        let rows = self.at_interface.len();
        let (group, part) = (first / GROUP, first % GROUP / S::F64_LANES);
        // Three chains of additions in place of one.
        let mut sums = [simd.splat_f64s(0.0); 3];
        let columns = &self.part.dense[group * rows..(group + 1) * rows];
        for (Grouped(matrices), [q, v, a, _]) in columns.iter().zip(&*self.at_interface) {
            for (sum, (matrix, value)) in sums.iter_mut().zip(matrices.iter().zip([q, v, a])) {
                *sum = simd.mul_add_e_f64s(S::as_simd_f64s(matrix).0[part], simd.splat_f64s(*value), *sum);
            }
        }
        let mut force = [0.0; GROUP];
        simd.partial_store_f64s(
            &mut force[..S::F64_LANES],
            simd.add_f64s(simd.add_f64s(sums[0], sums[1]), sums[2]),
        );
        for (value, force) in self.at_interface[first..].iter_mut().zip(&force[..S::F64_LANES]) {
            value[3] = *force;
        }
    }

    /// Adds the forces of `W` groups of modes from group `group` on, one register `part` of each: with the first rows
    /// all forces on modes alone, and with each row those between modes and the rows from `first` on; `on_interface`
    /// collects the forces on these rows.
    #[inline(always)]
    fn add_modes<S: Simd, const W: usize>(
        &mut self,
        simd: S,
        (group, part): (usize, usize),
        first: usize,
        on_interface: &mut [S::f64s; N],
    ) {
        let zero = simd.splat_f64s(0.0);
        let lanes = |values: &[f64; GROUP]| S::as_simd_f64s(values).0[part];
        let modes = &self.range;
        let range = |w: usize| {
            let start = modes.start + (group + w) * GROUP + part * S::F64_LANES;
            start.min(modes.end)..modes.end.min(start + S::F64_LANES)
        };
        let (mut v_m, mut a_m) = ([zero; W], [zero; W]);
        let (mut by_damping, mut by_mass) = ([zero; W], [zero; W]);
        for w in 0..W {
            let of_modes = |values: &[f64]| simd.partial_load_f64s(values.get(range(w)).unwrap_or_default());
            let [q, v, a] = self.modes;
            (v_m[w], a_m[w]) = (of_modes(v), of_modes(a));
            if first == 0 {
                let Grouped([square, damping]) = &self.own[group + w];
                by_damping[w] = simd.mul_add_e_f64s(lanes(square), of_modes(q), simd.mul_f64s(lanes(damping), v_m[w]));
                by_mass[w] = a_m[w];
            }
        }
        let rows = self.at_interface.len();
        let couplings: [&[Grouped<2>]; W] = std::array::from_fn(|w| {
            let start = (group + w) * rows + first;
            &self.part.couplings[start..start + N]
        });
        for i in 0..N {
            let [_, v, a, _] = self.at_interface[first + i];
            let (v, a) = (simd.splat_f64s(v), simd.splat_f64s(a));
            let mut sum = on_interface[i];
            for w in 0..W {
                let Grouped([d, m]) = &couplings[w][i];
                let (d, m) = (lanes(d), lanes(m));
                by_damping[w] = simd.mul_add_e_f64s(d, v, by_damping[w]);
                by_mass[w] = simd.mul_add_e_f64s(m, a, by_mass[w]);
                sum = simd.mul_add_e_f64s(d, v_m[w], simd.mul_add_e_f64s(m, a_m[w], sum));
            }
            on_interface[i] = sum;
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
    /// Adds at least the forces within `range`.
    fn add_within(&mut self, range: &Range<usize>, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        for member in self.members.iter_mut().filter(|member| member.is_within(range)) {
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
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add_within(&(0..force.len()), motion, None, force);
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

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for FarField {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_within(&(0..force.len()), motion, Some(v_dot), force);
    }

    fn add_dynamic_tangent(
        &mut self,
        _motion: &Motion<'_>,
        weights: Weights,
        mass_weight: f64,
        blocks: &mut Blocks<'_>,
    ) {
        self.add_constant(blocks, [weights.q, weights.v, mass_weight]);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        Some(self)
    }
}

impl ByRange for FarField {
    fn is_linear(&self) -> bool {
        true
    }

    fn add_dynamic_force_within(&mut self, range: Range<usize>, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_within(&range, motion, Some(v_dot), force);
    }
}
