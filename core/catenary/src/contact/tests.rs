use super::*;
use crate::{NodeMap, WireGeometry};
use nalgebra::{Matrix3, Rotation3};

const WIRE: usize = 18;

/// A strip on three free coordinates behind those of the wire, turned by a fixed roll angle.
struct Loose {
    roll: f64,
    at: Vector3<f64>,
}

impl Marker for Loose {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        Frame {
            position: self.at + Vector3::from_column_slice(&motion.q[WIRE..WIRE + 3]),
            axes: Rotation3::from_axis_angle(&Vector3::x_axis(), self.roll).into_inner(),
            velocity: Vector3::from_column_slice(&motion.v[WIRE..WIRE + 3]),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        for (i, axis) in Matrix3::identity().column_iter().enumerate() {
            columns.push(WIRE + i, axis.into(), Vector3::zeros());
        }
    }
}

/// Two elements of 5 m along x, staggered sideways.
fn pair(roll: f64, damping: f64, tangent: ContactTangent) -> ContactPair {
    let direction = Vector3::new(1.0, 0.03, 0.0).normalize();
    let geometry = WireGeometry::straight(Vector3::zeros(), direction, &[5.0, 5.0], |node| {
        NodeMap::spatial(6 * node)
    });
    let law = PenaltyContact {
        stiffness: 5e4,
        damping,
    };
    let strip = Loose {
        roll,
        at: Vector3::new(4.2, 0.05, 0.004),
    };
    ContactPair::new(law, Arc::new(geometry), Box::new(strip), 1.2, tangent)
}

fn bent() -> (Vec<f64>, Vec<f64>) {
    let q = (0..WIRE + 3)
        .map(|i| 1e-3 * ((i * i * 7 % 13) as f64 / 13.0 - 0.5))
        .collect();
    let mut v: Vec<f64> = (0..WIRE + 3)
        .map(|i| 0.02 * ((i * i * 5 % 11) as f64 / 11.0 - 0.5))
        .collect();
    v[WIRE] += 60.0;
    (q, v)
}

fn motion<'a>(q: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion {
        t: 0.0,
        q,
        v,
        rotation: &[],
        u: &[],
    }
}

fn force(pair: &mut ContactPair, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; q.len()];
    pair.add_force(&motion(q, v), &mut out);
    out
}

#[test]
fn the_generalised_force_is_the_negative_gradient_of_the_energy() {
    let (q, v) = bent();
    let mut pair = pair(0.04, 0.0, ContactTangent::Exact);
    let exact = force(&mut pair, &q, &v);
    assert!(exact.iter().any(|value| value.abs() > 10.0), "the strip presses");
    let size = exact.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
    for i in 0..q.len() {
        let h = 1e-6;
        let energy = |shift: f64| {
            let mut q = q.clone();
            q[i] += shift;
            pair.energy(&motion(&q, &v))
        };
        let slope = (energy(h) - energy(-h)) / (2.0 * h);
        // Central difference of an energy of some 1e-1 J: rounding 1e-10 relative to the force.
        assert!(
            (slope + exact[i]).abs() < 1e-6 * size,
            "coordinate {i}: {slope} against {}",
            exact[i]
        );
    }
}

#[test]
fn the_exact_tangent_is_the_jacobian_of_the_force() {
    let (q, v) = bent();
    for damping in [0.0, 300.0] {
        let mut pair = pair(0.04, damping, ContactTangent::Exact);
        for weights in [Weights { q: 1.0, v: 0.0 }, Weights { q: 0.0, v: 1.0 }] {
            let contact = pair.state(&motion(&q, &v)).expect("on the wire");
            let (indices, matrix) = pair.exact_tangent(&contact, &motion(&q, &v), weights);
            let size = matrix.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
            for (j, &index) in indices.iter().enumerate() {
                let h = 1e-6;
                let moved = |shift: f64, pair: &mut ContactPair| {
                    let (mut q, mut v) = (q.clone(), v.clone());
                    q[index] += weights.q * shift;
                    v[index] += weights.v * shift;
                    force(pair, &q, &v)
                };
                let (plus, minus) = (moved(h, &mut pair), moved(-h, &mut pair));
                for (i, &row) in indices.iter().enumerate() {
                    let difference = -(plus[row] - minus[row]) / (2.0 * h);
                    let error = (difference - matrix[i * indices.len() + j]).abs();
                    // Rounding of forces of 100 N over 2e-6: 1e-8 N/m; size 5e4 N/m.
                    assert!(error < 1e-6 * size.max(1.0), "({i}, {j}) weights {weights:?}: {error}");
                }
            }
        }
    }
}

#[test]
fn forces_on_wire_and_strip_cancel_and_have_no_part_along_strip_or_wire() {
    let (q, v) = bent();
    let mut pair = pair(0.04, 100.0, ContactTangent::RankOne);
    let all = force(&mut pair, &q, &v);
    let contact = pair.state(&motion(&q, &v)).expect("on the wire");
    let on_strip = Vector3::from_column_slice(&all[WIRE..]);
    // Sum over the position coordinates of all nodes: the shape functions of positions sum to one.
    let on_wire: Vector3<f64> = (0..3)
        .map(|node| Vector3::from_column_slice(&all[6 * node..6 * node + 3]))
        .sum();
    assert!((on_wire + on_strip).norm() < 1e-12 * contact.force);
    assert!(on_strip.dot(&contact.geometry.axis).abs() < 1e-12 * contact.force);
    assert!(on_strip.dot(&contact.geometry.wire.r_s).abs() < 1e-12 * contact.force);
    assert!(on_strip.z < 0.0);
    assert!((on_strip - contact.force_on_strip()).norm() < 1e-12 * contact.force);
}

#[test]
fn the_force_does_not_jump_across_an_element_border() {
    let (mut q, v) = bent();
    let pair = pair(0.0, 0.0, ContactTangent::RankOne);
    let force = |x: f64, q: &mut Vec<f64>| {
        q[WIRE] = x - 4.2;
        pair.state(&motion(q, &v)).expect("on the wire").force
    };
    let border = 5.0 / (1.0_f64 + 0.03 * 0.03).sqrt();
    let h = 1e-7;
    let (before, after) = (force(border - h, &mut q), force(border + h, &mut q));
    let slope = (after - force(border + 3.0 * h, &mut q)).abs();
    assert!(
        (after - before).abs() < 3.0 * slope + 1e-6,
        "{before} N before, {after} N after the border"
    );
}

#[test]
fn the_gap_rate_is_the_rate_of_the_gap_along_the_path() {
    let (q, v) = bent();
    let pair = pair(0.04, 0.0, ContactTangent::RankOne);
    let h = 1e-6;
    let gap = |t: f64| {
        let q: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + t * v).collect();
        pair.state(&motion(&q, &v)).expect("on the wire").geometry.gap
    };
    let rate = (gap(h) - gap(-h)) / (2.0 * h);
    let exact = pair.state(&motion(&q, &v)).expect("on the wire").geometry.gap_rate;
    assert!(
        (rate - exact).abs() < 1e-6 * exact.abs().max(1.0),
        "{rate} against {exact}"
    );
}

#[test]
fn contact_ends_when_the_strip_sinks_or_leaves_the_wire_or_the_wire_leaves_the_strip() {
    let (mut q, v) = bent();
    let pair = pair(0.0, 0.0, ContactTangent::RankOne);
    assert!(pair.state(&motion(&q, &v)).expect("on the wire").closed());
    q[WIRE + 2] -= 0.01;
    let open = pair.state(&motion(&q, &v)).expect("on the wire");
    assert!(!open.closed() && open.geometry.gap > 0.0);
    q[WIRE + 2] += 0.01;
    q[WIRE + 1] = 0.9;
    assert!(
        !pair.state(&motion(&q, &v)).expect("on the wire").closed(),
        "half the strip is 0.6 m"
    );
    q[WIRE] = 20.0;
    assert!(pair.state(&motion(&q, &v)).is_none());
}

#[test]
fn the_sensitivity_to_the_strip_is_the_difference_quotient() {
    let (q, v) = bent();
    let pair = pair(0.04, 200.0, ContactTangent::RankOne);
    let contact = pair.state(&motion(&q, &v)).expect("on the wire");
    let h = 1e-7;
    for axis in 0..3 {
        let unit = Vector3::ith(axis, 1.0);
        let by_position = pair.sensitivity(&contact, &motion(&q, &v), [unit, Vector3::zeros(), Vector3::zeros()]);
        let moved = |shift: f64| {
            let mut q = q.clone();
            q[WIRE + axis] += shift;
            pair.state(&motion(&q, &v)).expect("on the wire")
        };
        let (plus, minus) = (moved(h), moved(-h));
        let force = (plus.force_on_strip() - minus.force_on_strip()) / (2.0 * h);
        assert!(
            (force - by_position.force_on_strip).norm() < 1e-5 * 5e4,
            "force, axis {axis}"
        );
        let place = (plus.geometry.wire.r - minus.geometry.wire.r) / (2.0 * h);
        assert!((place - by_position.position).norm() < 1e-6, "position, axis {axis}");
        let by_velocity = pair.sensitivity(&contact, &motion(&q, &v), [Vector3::zeros(), Vector3::zeros(), unit]);
        let expected = contact.damping * contact.geometry.normal[axis];
        assert!((by_velocity.force - expected).abs() < 1e-12 * 200.0);
    }
}
