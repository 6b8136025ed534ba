//! The force of the air on a wire, distributed along its elements.
use super::force::add_selected;
use super::geometry::WireGeometry;
use crate::ancf::ShapeFunctions;
use dynamics::{Blocks, CrossFlow, Force, Motion, Power, Weights, Wind};
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;
use std::sync::Arc;

/// Drag across a wire in the wind.
///
/// ```text
/// Q_i = ∫ s_i(x) f(W − ṙ, r,ₓ) dx       by three Gauss points per element, exact for polynomials of degree 5; f: [CrossFlow]
/// ```
///
/// The wind is taken where the wire is at rest, at the nodes, and between them on a straight line. It is evaluated once per instant
/// and kept, so that the iterations of a step do not ask for it again. Bending layers, centimetres long, carry no drag of their own.
#[derive(Clone, Debug)]
pub struct WireDrag {
    geometry: Arc<WireGeometry>,
    law: CrossFlow,
    wind: Arc<Wind>,
    everywhere: bool,
    /// The wind at the nodes at `time` (s), m/s.
    at_nodes: Vec<Vector3<f64>>,
    time: f64,
    /// First coordinate of each node, where they ascend from node to node.
    first: Option<Vec<usize>>,
    points: Vec<[Point; POINTS]>,
}

const POINTS: usize = 3;

/// Shape functions at a quadrature point.
#[derive(Clone, Copy, Debug)]
struct Point {
    xi: f64,
    shape: ShapeFunctions,
    /// Share of the element, m.
    weight: f64,
}

/// The air about a point of the wire.
struct Local {
    /// Relative to the wire, m/s.
    v_r: Vector3<f64>,
    /// Velocity of the wire, m/s.
    velocity: Vector3<f64>,
    /// `∂r/∂x`, –.
    r_x: Vector3<f64>,
}

impl WireDrag {
    /// The drag of `wind` on the wire along `geometry`.
    #[must_use]
    pub fn new(geometry: Arc<WireGeometry>, law: CrossFlow, wind: Arc<Wind>) -> Self {
        let root = 0.6_f64.sqrt();
        let gauss = [
            (0.5 - 0.5 * root, 5.0 / 18.0),
            (0.5, 8.0 / 18.0),
            (0.5 + 0.5 * root, 5.0 / 18.0),
        ];
        let points = geometry.lengths().iter().map(|&length| {
            gauss.map(|(xi, weight)| Point {
                xi,
                shape: ShapeFunctions::at(xi, length),
                weight: weight * length,
            })
        });
        let starts: Option<Vec<usize>> = geometry.nodes().iter().map(|node| node.map.indices().min()).collect();
        let consecutive = |(node, &first): (&super::WireNode, &usize)| {
            let count = node.map.indices().count();
            node.map.indices().all(|index| index < first + count)
        };
        let first = starts.filter(|starts| {
            starts.is_sorted_by(|a, b| a < b) && geometry.nodes().iter().zip(starts.iter()).all(consecutive)
        });
        Self {
            points: points.collect(),
            at_nodes: vec![Vector3::zeros(); geometry.nodes().len()],
            time: f64::NAN,
            everywhere: wind.is_the_same_everywhere(),
            first,
            geometry,
            law,
            wind,
        }
    }

    /// Takes the wind of the instant `t`, s.
    fn blow(&mut self, t: f64) {
        if self.time == t {
            return;
        }
        if self.everywhere {
            self.at_nodes.fill(self.wind.velocity(t, 0.0));
        } else {
            for (velocity, node) in self.at_nodes.iter_mut().zip(self.geometry.nodes()) {
                *velocity = self.wind.velocity(t, node.position.x);
            }
        }
        self.time = t;
    }

    /// Elements that have to do with a range of coordinates.
    fn elements_of(&self, range: &Range<usize>) -> Range<usize> {
        let count = self.points.len();
        let Some(first) = &self.first else { return 0..count };
        // Six coordinates per node at most.
        let start = first.partition_point(|&index| index + 6 <= range.start);
        let end = first.partition_point(|&index| index < range.end);
        if start >= end {
            return 0..0;
        }
        start.saturating_sub(1)..end.min(count)
    }

    /// Calls `visit` with the air about each quadrature point of an element; `wind` is that at both nodes.
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
        let nodes = self.geometry.nodes();
        for element in self.elements_of(&range) {
            let wind = [self.at_nodes[element], self.at_nodes[element + 1]];
            let mut sums = [Vector3::zeros(); 4];
            self.at_points(element, motion, wind, |point, local| {
                let drag = self.law.force(&local.v_r, &local.r_x) * point.weight;
                for (sum, s) in sums.iter_mut().zip(point.shape.s.iter()) {
                    *sum += drag * *s;
                }
            });
            for (node, [position, slope]) in [(element, [0, 1]), (element + 1, [2, 3])] {
                let map = &nodes[node].map;
                for axis in 0..3 {
                    if let Some(index) = map.position(axis) {
                        force[index] += sums[position][axis];
                    }
                    if let Some(index) = map.slope(axis) {
                        force[index] += sums[slope][axis];
                    }
                }
            }
        }
    }
}

impl Force for WireDrag {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.add(0..usize::MAX, motion, force);
    }

    /// It has no mass.
    fn multiplies_mass(&self) -> bool {
        true
    }

    fn evaluates_ranges(&self) -> bool {
        self.first.is_some()
    }

    fn add_dynamic_force_within(
        &mut self,
        range: Range<usize>,
        motion: &Motion<'_>,
        _v_dot: &[f64],
        force: &mut [f64],
    ) {
        self.add(range, motion, force);
    }

    /// That of the velocities. The force also turns with the wire's slope, by the drag itself per radian: beside the tension, some
    /// ten thousand times that, it is left out.
    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.blow(motion.t);
        let nodes = self.geometry.nodes();
        for element in 0..self.points.len() {
            let wind = [self.at_nodes[element], self.at_nodes[element + 1]];
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

    /// What the wind does to wires that stand still counts as brought in, the rest as lost to the air.
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
}

#[cfg(test)]
mod tests;
