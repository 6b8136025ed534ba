//! The force of the air on a wire, distributed along its elements.
use super::force::add_selected;
use super::geometry::WireGeometry;
use super::places::{BLOCK, NODES, NodeArrays, NodePlaces};
use super::rows::NodeRows;
use ancf::ShapeFunctions;
use dynamics::simd::{GROUP, Transpose};
use dynamics::{Blocks, ByRange, Force, Motion, OnePass, Power, SlenderFlow, Weights, Wind};
use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, WithSimd};
use std::ops::Range;
use std::sync::Arc;

/// Drag across a wire in the wind, and lift where its law has one.
///
/// ```text
/// Q_i = ∫ s_i(x) f(W − ṙ, r,ₓ) dx    by three Gauss points per element, exact up to degree 5; f: [SlenderFlow]
/// ```
///
/// The wind is evaluated at the rest positions of the nodes and interpolated linearly between them, once per instant:
/// the iterations of a step reuse it. Bending layers, centimetres long, carry no drag of their own.
#[derive(Clone, Debug)]
pub struct WireDrag {
    geometry: Arc<WireGeometry>,
    law: SlenderFlow,
    wind: Arc<Wind>,
    everywhere: bool,
    /// Wind at the nodes at `time` (s), m/s, component by component, padded for the last group.
    at_nodes: [Vec<f64>; 3],
    time: f64,
    places: NodePlaces<3>,
    points: Vec<[Point; POINTS]>,
    groups: Vec<DragGroup>,
    block: Box<Block>,
}

const POINTS: usize = 3;

/// Points and weights of Gauss's rule between 0 and 1: `(1 ∓ √0.6)/2`.
const GAUSS: [(f64, f64); POINTS] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Shape functions at a quadrature point.
#[derive(Clone, Copy, Debug)]
struct Point {
    xi: f64,
    shape: ShapeFunctions,
    /// Share of the element, m.
    weight: f64,
}

/// Constants of a group of elements side by side.
#[derive(Clone, Debug)]
struct DragGroup {
    /// Shape functions, and their derivatives, of each point.
    s: [[[f64; GROUP]; 4]; POINTS],
    s_x: [[[f64; GROUP]; 4]; POINTS],
    /// `∂r/∂x` of the reference at each point.
    r_x: [[[f64; GROUP]; 3]; POINTS],
    weight: [[f64; GROUP]; POINTS],
}

/// Arrays of a block of elements.
#[derive(Clone, Debug)]
struct Block {
    q: NodeArrays<3>,
    v: NodeArrays<3>,
    /// Forces of the elements on their first nodes, with negative sign.
    start: NodeArrays<3>,
    /// Forces of the elements on their second nodes, shifted by one to the place of the node.
    end: NodeArrays<3>,
    rows: NodeRows,
}

/// The air about a point of the wire.
struct Local {
    /// Velocity of the air relative to the wire, m/s.
    v_r: Vector3<f64>,
    /// Velocity of the wire, m/s.
    velocity: Vector3<f64>,
    /// `∂r/∂x`, –.
    r_x: Vector3<f64>,
}

impl WireDrag {
    /// Drag of `wind` on the wire along `geometry`.
    #[must_use]
    pub fn new(geometry: Arc<WireGeometry>, law: impl Into<SlenderFlow>, wind: Arc<Wind>) -> Self {
        let points = geometry.lengths().iter().map(|&length| {
            GAUSS.map(|(xi, weight)| Point {
                xi,
                shape: ShapeFunctions::at(xi, length),
                weight: weight * length,
            })
        });
        let points: Vec<[Point; POINTS]> = points.collect();
        let count = points.len();
        // The last group repeats the last element; the results of the repetition are not used.
        let group = |group: usize| {
            let element = |lane: usize| (GROUP * group + lane).min(count - 1);
            let of =
                |value: &dyn Fn(&Point) -> f64, k: usize| std::array::from_fn(|lane| value(&points[element(lane)][k]));
            let reference = |k: usize, axis: usize| {
                std::array::from_fn(|lane| {
                    let e = geometry.local_reference(element(lane));
                    let s_x = &points[element(lane)][k].shape.s_x;
                    (0..4).map(|i| e[i][axis] * s_x[i]).sum()
                })
            };
            DragGroup {
                s: std::array::from_fn(|k| std::array::from_fn(|i| of(&|point| point.shape.s[i], k))),
                s_x: std::array::from_fn(|k| std::array::from_fn(|i| of(&|point| point.shape.s_x[i], k))),
                r_x: std::array::from_fn(|k| std::array::from_fn(|axis| reference(k, axis))),
                weight: std::array::from_fn(|k| of(&|point| point.weight, k)),
            }
        };
        let groups = (0..count.div_ceil(GROUP)).map(group).collect();
        let zeros = [[[0.0; NODES]; 3]; 2];
        Self {
            groups,
            points,
            at_nodes: std::array::from_fn(|_| vec![0.0; geometry.nodes().len() + GROUP]),
            time: f64::NAN,
            everywhere: wind.is_the_same_everywhere(),
            places: NodePlaces::new(geometry.nodes(), [0, 1, 2]),
            block: Box::new(Block {
                q: zeros,
                v: zeros,
                start: zeros,
                end: zeros,
                rows: NodeRows::ZERO,
            }),
            geometry,
            law: law.into(),
            wind,
        }
    }

    /// Evaluates the wind at the instant `t`, s.
    fn blow(&mut self, t: f64) {
        if self.time == t {
            return;
        }
        let everywhere = self.everywhere.then(|| self.wind.velocity(t, 0.0));
        for (i, node) in self.geometry.nodes().iter().enumerate() {
            let velocity = everywhere.unwrap_or_else(|| self.wind.velocity(t, node.position.x));
            for (values, velocity) in self.at_nodes.iter_mut().zip(velocity.iter()) {
                values[i] = *velocity;
            }
        }
        self.time = t;
    }

    /// The wind at both nodes of an element, m/s.
    fn at_ends(&self, element: usize) -> [Vector3<f64>; 2] {
        [element, element + 1].map(|node| Vector3::from(std::array::from_fn(|axis| self.at_nodes[axis][node])))
    }

    /// Groups that touch a range of coordinates.
    fn groups_of(&self, range: &Range<usize>) -> Range<usize> {
        let nodes = self.places.nodes_of(range);
        if nodes.is_empty() {
            return 0..0;
        }
        // Element i lies between the nodes i and i + 1.
        let (first, end) = (nodes.start.saturating_sub(1), nodes.end.min(self.points.len()));
        first / GROUP..end.div_ceil(GROUP)
    }

    /// Calls `visit` with the air about each quadrature point of an element; `wind` holds that at both nodes.
    #[inline(always)]
    fn at_points(
        &self,
        element: usize,
        motion: &Motion<'_>,
        wind: [Vector3<f64>; 2],
        mut visit: impl FnMut(&Point, Local),
    ) {
        let nodes = self.geometry.nodes();
        let (a, b) = (&nodes[element], &nodes[element + 1]);
        let reference = self.geometry.local_reference(element);
        let ((r1, r1_x), (r2, r2_x)) = (a.map.gather(motion.q), b.map.gather(motion.q));
        let ((v1, v1_x), (v2, v2_x)) = (a.map.gather(motion.v), b.map.gather(motion.v));
        let e = [r1, reference[1] + r1_x, reference[2] + r2, reference[3] + r2_x];
        for point in &self.points[element] {
            let (s, s_x) = (&point.shape.s, &point.shape.s_x);
            let velocity = v1 * s[0] + v1_x * s[1] + v2 * s[2] + v2_x * s[3];
            let air = wind[0] * (1.0 - point.xi) + wind[1] * point.xi;
            let local = Local {
                v_r: air - velocity,
                velocity,
                r_x: e[0] * s_x[0] + e[1] * s_x[1] + e[2] * s_x[2] + e[3] * s_x[3],
            };
            visit(point, local);
        }
    }

    fn add(&mut self, range: Range<usize>, motion: &Motion<'_>, force: &mut [f64]) {
        self.blow(motion.t);
        let groups = self.groups_of(&range);
        Arch::new().dispatch(AddDrag {
            drag: self,
            groups,
            motion,
            force,
        });
    }
}

/// The sweep over the elements, compiled once for each kind of vector registers.
struct AddDrag<'a, 'b> {
    drag: &'a mut WireDrag,
    groups: Range<usize>,
    motion: &'a Motion<'b>,
    force: &'a mut [f64],
}

impl WithSimd for AddDrag<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        let transpose = Transpose::new(simd);
        let WireDrag {
            law,
            at_nodes,
            places,
            points,
            groups,
            block,
            ..
        } = self.drag;
        let start = self.groups.start * GROUP;
        for (number, groups) in groups[self.groups].chunks(BLOCK / GROUP).enumerate() {
            let first = start + number * BLOCK;
            let count = BLOCK.min(points.len() - first);
            let nodes = (first, first + count);
            places.gather(transpose, nodes, self.motion.q, (&mut block.rows, &mut block.q));
            places.gather(transpose, nodes, self.motion.v, (&mut block.rows, &mut block.v));
            for (place, group) in groups.iter().enumerate() {
                let wind = std::array::from_fn(|axis| &at_nodes[axis][first + place * GROUP..][..GROUP + 1]);
                add_group(law, group, place * GROUP, wind, block);
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

/// `GROUP` values from the place `first` on.
#[inline(always)]
fn lanes(values: &[f64], first: usize) -> [f64; GROUP] {
    let mut lanes = [0.0; GROUP];
    lanes.copy_from_slice(&values[first..first + GROUP]);
    lanes
}

/// Writes the drag on the elements of a group, whose first node is at the place `first` of the block.
#[inline(always)]
fn add_group(law: &SlenderFlow, group: &DragGroup, first: usize, wind: [&[f64]; 3], block: &mut Block) {
    let mut sums = [[[0.0; GROUP]; 3]; 4];
    for (k, (at, _)) in GAUSS.iter().enumerate() {
        let (s, s_x) = (&group.s[k], &group.s_x[k]);
        let (mut v_r, mut r_x) = ([[0.0; GROUP]; 3], group.r_x[k]);
        for axis in 0..3 {
            let nodes = |arrays: &NodeArrays<3>| {
                [
                    lanes(&arrays[0][axis], first),
                    lanes(&arrays[1][axis], first),
                    lanes(&arrays[0][axis], first + 1),
                    lanes(&arrays[1][axis], first + 1),
                ]
            };
            let (q, v) = (nodes(&block.q), nodes(&block.v));
            let ends = [lanes(wind[axis], 0), lanes(wind[axis], 1)];
            for i in 0..GROUP {
                let velocity = v[0][i] * s[0][i] + v[1][i] * s[1][i] + v[2][i] * s[2][i] + v[3][i] * s[3][i];
                v_r[axis][i] = ends[0][i] + (ends[1][i] - ends[0][i]) * at - velocity;
                r_x[axis][i] += q[0][i] * s_x[0][i] + q[1][i] * s_x[1][i] + q[2][i] * s_x[2][i] + q[3][i] * s_x[3][i];
            }
        }
        let drag = law.forces(&v_r, &r_x);
        for (sum, s) in sums.iter_mut().zip(s) {
            for (sum, drag) in sum.iter_mut().zip(&drag) {
                for i in 0..GROUP {
                    sum[i] += drag[i] * (s[i] * group.weight[k][i]);
                }
            }
        }
    }
    for (part, sums) in sums.iter().enumerate() {
        let (arrays, place) = if part < 2 {
            (&mut block.start, first)
        } else {
            (&mut block.end, first + 1)
        };
        for (array, sum) in arrays[part % 2].iter_mut().zip(sums) {
            // Scattering subtracts.
            for (value, sum) in array[place..place + GROUP].iter_mut().zip(sum) {
                *value = -sum;
            }
        }
    }
}

impl Force for WireDrag {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..usize::MAX, motion, force);
    }

    /// Tangent with respect to the velocities. The force also turns with the wire's slope, by the drag itself per
    /// radian: left out, because the tension is some ten thousand times larger.
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.blow(motion.t);
        let nodes = self.geometry.nodes();
        for element in 0..self.points.len() {
            let wind = self.at_ends(element);
            let mut matrices = [[Matrix3::zeros(); 4]; 4];
            self.at_points(element, motion, wind, |point, local| {
                let damping = self.law.by_velocity(&local.v_r, &local.r_x) * (weights.v * point.weight);
                for (row, s) in matrices.iter_mut().zip(point.shape.s.iter()) {
                    for (matrix, by) in row.iter_mut().zip(point.shape.s.iter()) {
                        *matrix += damping * (*s * *by);
                    }
                }
            });
            let (a, b) = (&nodes[element].map, &nodes[element + 1].map);
            let index: [Option<usize>; 12] = std::array::from_fn(|k| {
                let (map, axis) = (if k < 6 { a } else { b }, k % 3);
                if k % 6 < 3 { map.position(axis) } else { map.slope(axis) }
            });
            add_selected(blocks, &index, |row, column| {
                matrices[row / 3][column / 3][(row % 3, column % 3)]
            });
        }
    }

    /// Power of the wind: its work on wires that stand still counts as driven, the rest as dissipated in the air.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let mut power = Power::default();
        let wind = |node: usize| self.wind.velocity(motion.t, self.geometry.nodes()[node].position.x);
        for element in 0..self.points.len() {
            self.at_points(element, motion, [wind(element), wind(element + 1)], |point, local| {
                let standing = self.law.force(&(local.v_r + local.velocity), &local.r_x);
                let moving = self.law.force(&local.v_r, &local.r_x);
                power.driven += point.weight * standing.dot(&local.velocity);
                power.dissipated += point.weight * (standing - moving).dot(&local.velocity);
            });
        }
        Some(power)
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for WireDrag {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, _v_dot: &[f64], force: &mut [f64]) {
        self.add_force(motion, force);
    }

    fn by_range(&mut self) -> Option<&mut dyn ByRange> {
        if self.places.ascend() { Some(self) } else { None }
    }
}

impl ByRange for WireDrag {
    fn add_dynamic_force_within(
        &mut self,
        range: Range<usize>,
        motion: &Motion<'_>,
        _v_dot: &[f64],
        force: &mut [f64],
    ) {
        self.add(range, motion, force);
    }
}

#[cfg(test)]
mod tests;
