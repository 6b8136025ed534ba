//! The tangent of the elements.
use super::{BLOCK, Block, ElementGroup, GroupLanes, Sweep, TangentGroup, Transpose};
use ancf::{CableSection, EvenMatrix};
use dynamics::simd::{GROUP, Lanes};
use dynamics::{Blocks, Motion, Weights};
use pulp::{Arch, Simd, WithSimd};

impl<const D: usize> Sweep<D> {
    /// Adds dense blocks of `N = 4 D` rows, one per element; see [`super::Batch::add_tangent`].
    pub fn add_tangent<const N: usize>(
        &mut self,
        motion: &Motion<'_>,
        weights: (Weights, f64),
        blocks: &mut Blocks<'_>,
    ) -> bool {
        debug_assert_eq!(N, 4 * D);
        if !self.cable.is_beam() || self.places.runs().is_none() {
            return false;
        }
        Arch::new().dispatch(AddTangent::<D, N> {
            sweep: self,
            q: motion.q,
            weights,
            blocks,
        });
        true
    }
}

/// The sweep, compiled once for each kind of vector registers.
struct AddTangent<'a, 'b, const D: usize, const N: usize> {
    sweep: &'a mut Sweep<D>,
    q: &'a [f64],
    /// Weights of the tangent, and that of the mass.
    weights: (Weights, f64),
    blocks: &'a mut Blocks<'b>,
}

/// The parts of the tangents of a group: `A ⊗ I + h gᵀ`.
struct Parts<const D: usize> {
    /// `A`
    matrix: EvenMatrix<[f64; GROUP]>,
    /// `g`, four nodal vectors.
    gradient: [[[f64; GROUP]; D]; 4],
    /// `h = w κ g`
    rate: [[[f64; GROUP]; D]; 4],
}

impl<const D: usize, const N: usize> WithSimd for AddTangent<'_, '_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Sweep {
            cable,
            elements,
            groups,
            tangents,
            places,
            block,
            ..
        } = self.sweep;
        let zeros = [[[0.0; GROUP]; D]; 4];
        let mut parts = Parts {
            matrix: EvenMatrix([[0.0; GROUP]; 6]),
            gradient: zeros,
            rate: zeros,
        };
        let mut values = [[0.0; N]; N];
        let transpose = Transpose::new(simd);
        for number in 0..elements.div_ceil(BLOCK) {
            let first = number * BLOCK;
            let count = BLOCK.min(*elements - first);
            let arrays = (&mut block.rows, &mut block.q);
            places.gather(transpose, (first, first + count), self.q, arrays);
            for place in 0..count.div_ceil(GROUP) {
                let group = number * (BLOCK / GROUP) + place;
                for part in 0..Lanes::<S>::PARTS {
                    let lanes = GroupLanes { simd, place, part };
                    lanes.tangents(
                        cable,
                        self.weights,
                        (&groups[group], &tangents[group]),
                        block,
                        &mut parts,
                    );
                }
                for lane in 0..GROUP.min(count - place * GROUP) {
                    let element = group * GROUP + lane;
                    let starts = places
                        .runs()
                        .map_or([0; 2], |starts| [starts[element], starts[element + 1]]);
                    let index: [usize; N] = std::array::from_fn(|i| starts[i / (N / 2)] as usize + i % (N / 2));
                    parts.expand(lane, &mut values);
                    self.blocks.add(&index, &index, values.as_flattened());
                }
            }
        }
    }
}

impl<S: Simd> GroupLanes<S> {
    /// Evaluates the parts of the tangents.
    #[inline(always)]
    fn tangents<const D: usize>(
        self,
        cable: &CableSection,
        (weights, mass_weight): (Weights, f64),
        (group, constant): (&ElementGroup<D>, &TangentGroup),
        block: &Block<D>,
        parts: &mut Parts<D>,
    ) {
        let (length, [reference, change]) = self.slopes(group, block);
        let slopes = reference.and(&change);
        let Some(beam) = cable.beam_tangent(length, &slopes) else {
            return;
        };
        let (tension, bending) = (self.matrix(&constant.tension), self.matrix(&constant.bending));
        let (damping, mass) = (self.matrix(&group.damping), self.matrix(&group.mass));
        for i in 0..6 {
            let stiffness = (tension.0[i] * beam.tension + bending.0[i]) * weights.q;
            let sum = stiffness + damping.0[i] * weights.v + mass.0[i] * mass_weight;
            sum.store(&mut parts.matrix.0[i], self.part);
        }
        for (vector, (gradient, rate)) in beam.gradient.iter().zip(parts.gradient.iter_mut().zip(&mut parts.rate)) {
            for axis in 0..D {
                vector.0[axis].store(&mut gradient[axis], self.part);
                let h = vector.0[axis] * beam.rate * weights.q;
                h.store(&mut rate[axis], self.part);
            }
        }
    }
}

impl<const D: usize> Parts<D> {
    /// The dense tangent of one element, row by row.
    #[inline(always)]
    fn expand<const N: usize>(&self, lane: usize, values: &mut [[f64; N]; N]) {
        let matrix = EvenMatrix(self.matrix.0.map(|entries| entries[lane])).entries();
        let mut gradient = [0.0; N];
        for (value, entries) in gradient.iter_mut().zip(self.gradient.as_flattened()) {
            *value = entries[lane];
        }
        for (i, row) in values.iter_mut().enumerate() {
            let h = self.rate[i / D][i % D][lane];
            for (value, g) in row.iter_mut().zip(&gradient) {
                *value = h * g;
            }
            for (j, entry) in matrix[i / D].iter().enumerate() {
                row[j * D + i % D] += entry;
            }
        }
    }
}
