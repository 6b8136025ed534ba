//! The elements of a wire in groups that fill vector registers: force, damping, weight and inertia in one sweep.
mod tangent;

use super::enrichment::Products;
use super::force::{Constants, element_matrix};
use super::geometry::WireGeometry;
use super::places::{BLOCK, NODES, NodeArrays, NodePlaces};
use super::rows::NodeRows;
use ancf::{CableSection, EvenMatrix, Length, Slopes};
use dynamics::simd::{Components, GROUP, Lanes, Space, Transpose};
use dynamics::{Blocks, Motion, Weights};
use nalgebra::Vector3;
use pulp::{Arch, Simd, WithSimd};
use std::ops::Range;

/// All elements of a wire, with two components where it does not move sideways.
#[derive(Clone, Debug)]
pub(super) enum Batch {
    Planar(Box<Sweep<2>>),
    Spatial(Box<Sweep<3>>),
}

impl Batch {
    pub fn new(geometry: &WireGeometry, constants: &Constants) -> Self {
        if geometry.moves_sideways() {
            Self::Spatial(Box::new(Sweep::new(geometry, [0, 1, 2], constants)))
        } else {
            Self::Planar(Box::new(Sweep::new(geometry, [0, 2], constants)))
        }
    }

    /// True if the coordinates ascend from node to node, so that a range of them is a part of the wire.
    pub fn ascends(&self) -> bool {
        match self {
            Self::Planar(sweep) => sweep.places.ascend(),
            Self::Spatial(sweep) => sweep.places.ascend(),
        }
    }

    /// Evaluates the strain to first order in the displacements from now on, without the force of the reference.
    pub fn linearise(&mut self) {
        match self {
            Self::Planar(sweep) => sweep.linear = true,
            Self::Spatial(sweep) => sweep.linear = true,
        }
    }

    /// Adds the force of all elements, with inertia if accelerations are given. Only the entries `within` need be
    /// right.
    pub fn add_force(&mut self, within: Range<usize>, motion: &Motion<'_>, v_dot: Option<&[f64]>, force: &mut [f64]) {
        self.add_force_on(Arch::new(), within, motion, v_dot, force);
    }

    /// Adds the tangent of all elements, with their mass weighted by the last weight, and returns true: for tensioned
    /// beams with coordinates in order. Returns false otherwise; the answer never changes.
    pub fn add_tangent(&mut self, motion: &Motion<'_>, weights: (Weights, f64), blocks: &mut Blocks<'_>) -> bool {
        match self {
            Self::Planar(sweep) => sweep.add_tangent::<8>(motion, weights, blocks),
            Self::Spatial(sweep) => sweep.add_tangent::<12>(motion, weights, blocks),
        }
    }

    /// [`Batch::add_force`] with the registers of `arch`.
    fn add_force_on(
        &mut self,
        arch: Arch,
        within: Range<usize>,
        motion: &Motion<'_>,
        v_dot: Option<&[f64]>,
        force: &mut [f64],
    ) {
        match self {
            Self::Planar(sweep) => sweep.add_force(arch, within, motion, v_dot, force),
            Self::Spatial(sweep) => sweep.add_force(arch, within, motion, v_dot, force),
        }
    }
}

/// Constants of a group of elements, at the boundary of a cache line: a vector loaded across two lines costs twice.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct ElementGroup<const D: usize> {
    length: Length<[f64; GROUP]>,
    reference: Slopes<[[f64; GROUP]; D]>,
    damping: EvenMatrix<[f64; GROUP]>,
    mass: EvenMatrix<[f64; GROUP]>,
}

/// Further constants that the tangents of a group need.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct TangentGroup {
    /// Matrix per unit tension.
    tension: EvenMatrix<[f64; GROUP]>,
    bending: EvenMatrix<[f64; GROUP]>,
}

/// Arrays of a block of elements.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Block<const D: usize> {
    q: NodeArrays<D>,
    v: NodeArrays<D>,
    v_dot: NodeArrays<D>,
    /// Forces of the elements on their first nodes.
    start: NodeArrays<D>,
    /// Forces of the elements on their second nodes, shifted by one to the place of the node.
    end: NodeArrays<D>,
    rows: NodeRows,
}

/// Elements in `D` components.
#[derive(Clone, Debug)]
pub(super) struct Sweep<const D: usize> {
    cable: CableSection,
    /// True for strain of first order, see [`Batch::linearise`].
    linear: bool,
    /// True if velocities matter.
    damped: bool,
    weight: f64,
    elements: usize,
    groups: Vec<ElementGroup<D>>,
    tangents: Vec<TangentGroup>,
    places: NodePlaces<D>,
    block: Block<D>,
}

impl<const D: usize> Sweep<D> {
    fn new(geometry: &WireGeometry, axes: [usize; D], constants: &Constants) -> Self {
        let lengths = geometry.lengths();
        let elements = lengths.len();
        // The last group repeats the last element; the results of the repetition are not used.
        let element = |group: usize, lane: usize| (GROUP * group + lane).min(elements - 1);
        let matrix = |group: usize, weights: &Products<f64>| {
            let matrices: [EvenMatrix; GROUP] = std::array::from_fn(|lane| {
                let length = lengths[element(group, lane)];
                EvenMatrix::new(&element_matrix(length, weights))
            });
            EvenMatrix(std::array::from_fn(|i| matrices.map(|matrix| matrix.0[i])))
        };
        let group = |group: usize| {
            let length = |lane: usize| lengths[element(group, lane)];
            let slopes: [Slopes; GROUP] = std::array::from_fn(|lane| {
                let element = element(group, lane);
                Slopes::new(geometry.strained_reference(element), Length::new(lengths[element]))
            });
            let vector =
                |of: fn(&Slopes) -> Vector3<f64>| axes.map(|axis| slopes.each_ref().map(|slopes| of(slopes)[axis]));
            ElementGroup {
                length: Length {
                    value: std::array::from_fn(length),
                    inverse: std::array::from_fn(|lane| 1.0 / length(lane)),
                },
                reference: Slopes {
                    chord: vector(|slopes| slopes.chord),
                    start: vector(|slopes| slopes.start),
                    end: vector(|slopes| slopes.end),
                },
                damping: matrix(group, &constants.damping),
                mass: matrix(group, &constants.mass),
            }
        };
        let tangent = |group: usize| TangentGroup {
            tension: matrix(
                group,
                &Products {
                    tension: 1.0,
                    ..Products::default()
                },
            ),
            bending: matrix(
                group,
                &Products {
                    tension: 0.0,
                    ..constants.stiffness
                },
            ),
        };
        let groups = elements.div_ceil(GROUP);
        let zeros = [[[0.0; NODES]; D]; 2];
        Self {
            cable: constants.cable,
            linear: false,
            damped: constants.damping != Products::default(),
            weight: constants.weight,
            elements,
            groups: (0..groups).map(group).collect(),
            tangents: (0..groups).map(tangent).collect(),
            places: NodePlaces::new(geometry.nodes(), axes),
            block: Block {
                q: zeros,
                v: zeros,
                v_dot: zeros,
                start: zeros,
                end: zeros,
                rows: NodeRows::ZERO,
            },
        }
    }

    /// Groups that touch a range of coordinates.
    fn groups_of(&self, within: &Range<usize>) -> Range<usize> {
        let nodes = self.places.nodes_of(within);
        if nodes.is_empty() {
            return 0..0;
        }
        // Element i lies between the nodes i and i + 1.
        let (first, end) = (nodes.start.saturating_sub(1), nodes.end.min(self.elements));
        first / GROUP..end.div_ceil(GROUP)
    }

    fn add_force(
        &mut self,
        arch: Arch,
        within: Range<usize>,
        motion: &Motion<'_>,
        v_dot: Option<&[f64]>,
        force: &mut [f64],
    ) {
        let groups = self.groups_of(&within);
        let values = [motion.q, motion.v, v_dot.unwrap_or_default()];
        match (v_dot.is_some(), self.damped) {
            (true, true) => self.sweep::<true, true>(arch, groups, values, force),
            (true, false) => self.sweep::<true, false>(arch, groups, values, force),
            (false, true) => self.sweep::<false, true>(arch, groups, values, force),
            (false, false) => self.sweep::<false, false>(arch, groups, values, force),
        }
    }

    fn sweep<const DYNAMIC: bool, const DAMPED: bool>(
        &mut self,
        arch: Arch,
        groups: Range<usize>,
        values: [&[f64]; 3],
        force: &mut [f64],
    ) {
        arch.dispatch(AddForce::<D, DYNAMIC, DAMPED> {
            sweep: self,
            groups,
            values,
            force,
        });
    }
}

/// The sweep, compiled once for each kind of vector registers.
struct AddForce<'a, const D: usize, const DYNAMIC: bool, const DAMPED: bool> {
    sweep: &'a mut Sweep<D>,
    groups: Range<usize>,
    /// `q`, `v`, and `v̇` if `DYNAMIC`; velocities matter if `DAMPED`.
    values: [&'a [f64]; 3],
    force: &'a mut [f64],
}

impl<const D: usize, const DYNAMIC: bool, const DAMPED: bool> WithSimd for AddForce<'_, D, DYNAMIC, DAMPED> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Sweep {
            cable,
            linear,
            weight,
            elements,
            groups,
            places,
            block,
            ..
        } = self.sweep;
        let [q, v, v_dot] = self.values;
        let start = self.groups.start * GROUP;
        let transpose = Transpose::new(simd);
        for (number, groups) in groups[self.groups].chunks(BLOCK / GROUP).enumerate() {
            let first = start + number * BLOCK;
            let count = BLOCK.min(*elements - first);
            let nodes = (first, first + count);
            places.gather(transpose, nodes, q, (&mut block.rows, &mut block.q));
            if DAMPED {
                places.gather(transpose, nodes, v, (&mut block.rows, &mut block.v));
            }
            if DYNAMIC {
                places.gather(transpose, nodes, v_dot, (&mut block.rows, &mut block.v_dot));
            }
            for (place, group) in groups.iter().enumerate() {
                for part in 0..Lanes::<S>::PARTS {
                    let lanes = GroupLanes { simd, place, part };
                    lanes.add_force::<D, DYNAMIC, DAMPED>((cable, *linear), *weight, group, block);
                }
            }
            // The lanes beyond the last element belong to none; the first node ends no element of this block.
            for array in block.start.as_flattened_mut() {
                array[count] = 0.0;
            }
            for array in block.end.as_flattened_mut() {
                array[0] = 0.0;
            }
            let forces = ([&block.start, &block.end], &mut block.rows);
            places.scatter(transpose, nodes, forces, self.force);
        }
    }
}

/// One register's worth of elements.
#[derive(Clone, Copy)]
struct GroupLanes<S> {
    simd: S,
    /// Group within its block.
    place: usize,
    /// Register within the group.
    part: usize,
}

/// Slopes of several elements side by side.
type LaneSlopes<S, const D: usize> = Slopes<Components<Lanes<S>, D>>;

impl<S: Simd> GroupLanes<S> {
    #[inline(always)]
    fn constant(self, values: &[f64; GROUP]) -> Lanes<S> {
        Lanes::load(self.simd, values, self.part)
    }

    /// `array::map` is avoided: a closure that is not inlined cannot use vector registers.
    #[inline(always)]
    fn constants<const N: usize>(self, values: &[[f64; GROUP]; N]) -> [Lanes<S>; N] {
        let mut lanes = [self.constant(&values[0]); N];
        for i in 1..N {
            lanes[i] = self.constant(&values[i]);
        }
        lanes
    }

    #[inline(always)]
    fn vector<const D: usize>(self, values: &[[f64; GROUP]; D]) -> Components<Lanes<S>, D> {
        Components(self.constants(values))
    }

    #[inline(always)]
    fn matrix(self, values: &EvenMatrix<[f64; GROUP]>) -> EvenMatrix<Lanes<S>> {
        EvenMatrix(self.constants(&values.0))
    }

    /// Values of the nodes `offset` places after the first ones of the elements.
    #[inline(always)]
    fn nodes<const D: usize>(self, values: &[[f64; NODES]; D], offset: usize) -> Components<Lanes<S>, D> {
        let first = self.place * GROUP + offset;
        let mut lanes = [Lanes::load(self.simd, &values[0][first..first + GROUP], self.part); D];
        for axis in 1..D {
            lanes[axis] = Lanes::load(self.simd, &values[axis][first..first + GROUP], self.part);
        }
        Components(lanes)
    }

    #[inline(always)]
    fn coordinates<const D: usize>(self, values: &NodeArrays<D>) -> [Components<Lanes<S>, D>; 4] {
        let [r, r_x] = values;
        [
            self.nodes(r, 0),
            self.nodes(r_x, 0),
            self.nodes(r, 1),
            self.nodes(r_x, 1),
        ]
    }

    #[inline(always)]
    fn store<const D: usize>(self, values: Components<Lanes<S>, D>, arrays: &mut [[f64; NODES]; D], offset: usize) {
        let first = self.place * GROUP + offset;
        for (axis, array) in arrays.iter_mut().enumerate() {
            values.0[axis].store(&mut array[first..first + GROUP], self.part);
        }
    }

    /// Length of the elements, slopes in the reference, and change of the slopes.
    #[inline(always)]
    fn slopes<const D: usize>(
        self,
        group: &ElementGroup<D>,
        block: &Block<D>,
    ) -> (Length<Lanes<S>>, [LaneSlopes<S, D>; 2]) {
        let length = Length {
            value: self.constant(&group.length.value),
            inverse: self.constant(&group.length.inverse),
        };
        let reference = Slopes {
            chord: self.vector(&group.reference.chord),
            start: self.vector(&group.reference.start),
            end: self.vector(&group.reference.end),
        };
        (length, [reference, Slopes::new(self.coordinates(&block.q), length)])
    }

    /// Evaluates the elements and writes their forces on the nodes into the block.
    #[inline(always)]
    fn add_force<const D: usize, const DYNAMIC: bool, const DAMPED: bool>(
        self,
        (cable, linear): (&CableSection, bool),
        weight: f64,
        group: &ElementGroup<D>,
        block: &mut Block<D>,
    ) {
        let (length, [reference, change]) = self.slopes(group, block);
        let strain = if linear {
            cable.slope_force_about(length, &reference, &change)
        } else {
            cable.slope_force(length, &reference.and(&change))
        };
        let mut sum = strain.on_nodes(length);
        let mut rest = None;
        if DAMPED {
            rest = Some(self.matrix(&group.damping).times(self.coordinates(&block.v)));
        }
        if DYNAMIC {
            let inertia = self.matrix(&group.mass).times(self.coordinates(&block.v_dot));
            rest = Some(match rest {
                Some(damping) => damping.and(inertia),
                None => inertia,
            });
        }
        if let Some(rest) = rest {
            sum = add(sum, rest.on_nodes());
        }
        let [mut f1, mut m1, mut f2, mut m2] = sum;
        // ∫ m g s dx
        let half = length.value * (0.5 * weight);
        let moment = length.value * length.value * (weight / 12.0);
        f1.0[D - 1] = f1.0[D - 1] + half;
        m1.0[D - 1] = m1.0[D - 1] + moment;
        f2.0[D - 1] = f2.0[D - 1] + half;
        m2.0[D - 1] = m2.0[D - 1] - moment;
        self.store(f1, &mut block.start[0], 0);
        self.store(m1, &mut block.start[1], 0);
        self.store(f2, &mut block.end[0], 1);
        self.store(m2, &mut block.end[1], 1);
    }
}

#[inline(always)]
fn add<V: Space>([a, b, c, d]: [V; 4], [e, f, g, h]: [V; 4]) -> [V; 4] {
    [a + e, b + f, c + g, d + h]
}

#[cfg(test)]
mod tests;
