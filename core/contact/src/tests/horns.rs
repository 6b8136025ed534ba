//! A wire on the horns of a head.
use super::tests::{WIRE, assert_energy, bent, motion};
use super::*;
use nalgebra::{Matrix3, Rotation3};
use wire::{NodeMap, WireGeometry};

const STIFFNESS: f64 = 5e4;

/// A strip on three free coordinates behind those of the wire and a roll angle, from its place on.
struct Rolling(Vector3<f64>);

impl Marker for Rolling {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        Frame {
            position: self.0 + Vector3::from_column_slice(&motion.q[WIRE..WIRE + 3]),
            axes: Rotation3::from_axis_angle(&Vector3::x_axis(), motion.q[WIRE + 3]).into_inner(),
            velocity: Vector3::from_column_slice(&motion.v[WIRE..WIRE + 3]),
            angular_velocity: Vector3::x() * motion.v[WIRE + 3],
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        for (i, axis) in Matrix3::identity().column_iter().enumerate() {
            columns.push(WIRE + i, axis.into(), Vector3::zeros());
        }
        columns.push(WIRE + 3, Vector3::zeros(), Vector3::x());
    }
}

/// Head with a straight strip of 40 mm and long horns, so that the middle of the wire lies on one.
fn top() -> MonotoneCubic {
    scene::Horns {
        y: vec![0.06, 0.12, 0.2],
        z: vec![-0.004, -0.03, -0.09],
    }
    .top(0.04)
}

/// Strip under two elements of 5 m that lead sideways; `side` is that of the wire seen from the strip.
fn pair(side: f64, damping: f64, tangent: ContactTangent) -> ContactPair {
    let direction = Vector3::new(1.0, 0.03, 0.0).normalize();
    let geometry = WireGeometry::straight(Vector3::zeros(), direction, &[5.0, 5.0], |node| {
        NodeMap::spatial(6 * node)
    });
    let law = PenaltyContact {
        stiffness: STIFFNESS,
        damping,
    };
    let strip = Rolling(Vector3::new(4.2, 0.126 - side * 0.09, 0.018));
    ContactPair::new(law, Arc::new(geometry), Box::new(strip), 0.04, tangent).with_horns(Some(top()))
}

fn moving() -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut v) = bent();
    q.push(0.03);
    v.push(0.2);
    (q, v)
}

fn state(pair: &ContactPair, q: &[f64], v: &[f64]) -> ContactState {
    pair.state(&motion(q, v)).expect("on the wire")
}

fn force(pair: &mut ContactPair, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; q.len()];
    pair.add_force(&motion(q, v), &mut out);
    out
}

#[test]
fn on_a_straight_incline_the_force_is_that_of_statics_by_hand() {
    // One slope of 1 in 2 behind the first point: secants that agree leave the cubic straight.
    let incline = MonotoneCubic::new(vec![0.02, 0.04, 0.1, 0.2], vec![0.0, -0.01, -0.04, -0.09], Some(0.0));
    let (q, v) = (vec![0.0; WIRE + 4], vec![0.0; WIRE + 4]);
    let straight = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &[5.0, 5.0], |node| {
        NodeMap::spatial(6 * node)
    });
    for side in [1.0, -1.0] {
        let law = PenaltyContact {
            stiffness: STIFFNESS,
            damping: 0.0,
        };
        // The head is 2 mm too high where its top has fallen by (0.07 − 0.02)/2 = 25 mm.
        let strip = Rolling(Vector3::new(4.2, -side * 0.07, 0.027));
        let curve = Arc::new(straight.clone());
        let pair = ContactPair::new(law, curve, Box::new(strip), 0.04, ContactTangent::Exact);
        let contact = state(&pair.with_horns(Some(incline.clone())), &q, &v);
        let cosine = 2.0 / 5.0_f64.sqrt();
        let expected = STIFFNESS * 0.002 * cosine;
        assert!(
            (contact.force - expected).abs() < 1e-9 * expected,
            "{} {expected}",
            contact.force
        );
        // The wire slides down and outward; the head is pressed down and inward, half as much aside as down.
        let on_strip = contact.force_on_strip();
        assert!((on_strip.z + expected * cosine).abs() < 1e-9 * expected, "{on_strip}");
        assert!(
            (on_strip.y - 0.5 * side * on_strip.z).abs() < 1e-9 * expected,
            "{on_strip}"
        );
        assert!((contact.borne() + on_strip.z).abs() < 1e-12 * expected);
    }
}

#[test]
fn the_force_on_a_horn_is_the_gradient_of_the_energy_also_where_the_head_rolls() {
    let (q, v) = moving();
    for side in [1.0, -1.0] {
        let mut pair = pair(side, 0.0, ContactTangent::Exact);
        let contact = state(&pair, &q, &v);
        assert!(
            contact.force > 20.0 && contact.geometry.place.abs() > 0.05,
            "{contact:?}"
        );
        assert!(contact.geometry.normal.y * side > 0.2);
        let exact = force(&mut pair, &q, &v);
        assert!(exact[WIRE + 3].abs() > 1.0, "the force turns the head");
        assert_energy(&mut pair, &q, 1e-6);
    }
}

#[test]
fn the_exact_tangent_on_a_horn_is_the_jacobian_of_the_force() {
    let (q, v) = moving();
    for damping in [0.0, 300.0] {
        let mut pair = pair(1.0, damping, ContactTangent::Exact);
        for weights in [Weights { q: 1.0, v: 0.0 }, Weights { q: 0.0, v: 1.0 }] {
            let contact = state(&pair, &q, &v);
            let (indices, matrix) = pair.exact_tangent(&contact, &motion(&q, &v), weights);
            let size = matrix.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
            for (j, &index) in indices.iter().enumerate() {
                let moved = |shift: f64, pair: &mut ContactPair| {
                    let (mut q, mut v) = (q.clone(), v.clone());
                    q[index] += weights.q * shift;
                    v[index] += weights.v * shift;
                    force(pair, &q, &v)
                };
                let h = 1e-6;
                let (plus, minus) = (moved(h, &mut pair), moved(-h, &mut pair));
                for (i, &row) in indices.iter().enumerate() {
                    if row == WIRE + 3 && index == WIRE + 3 {
                        continue; // the turn of the lever arms of a rigid body is left out
                    }
                    let difference = -(plus[row] - minus[row]) / (2.0 * h);
                    let error = (difference - matrix[i * indices.len() + j]).abs();
                    assert!(
                        error < 2e-6 * size.max(1.0),
                        "({row}, {index}) {weights:?}: {error} of {size}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_sensitivity_on_a_horn_is_the_difference_quotient() {
    let (q, v) = moving();
    let pair = pair(-1.0, 200.0, ContactTangent::RankOne);
    let contact = state(&pair, &q, &v);
    let (unit, zero) = (Vector3::ith, Vector3::zeros());
    let ways = [
        (WIRE + 1, false, [unit(1, 1.0), zero, zero]),
        (WIRE + 2, false, [unit(2, 1.0), zero, zero]),
        (WIRE + 3, false, [zero, unit(0, 1.0), zero]),
        (WIRE + 1, true, [zero, zero, unit(1, 1.0)]),
        (WIRE + 2, true, [zero, zero, unit(2, 1.0)]),
    ];
    for (index, of_velocity, direction) in ways {
        let found = pair.sensitivity(&contact, &motion(&q, &v), direction);
        let h = 1e-7;
        let moved = |shift: f64| {
            let (mut q, mut v) = (q.clone(), v.clone());
            if of_velocity {
                v[index] += shift;
            } else {
                q[index] += shift;
            }
            state(&pair, &q, &v)
        };
        let (plus, minus) = (moved(h), moved(-h));
        let force = (plus.force_on_strip() - minus.force_on_strip()) / (2.0 * h);
        assert!(
            (force - found.force_on_strip).norm() < 1e-5 * STIFFNESS,
            "{index}: {force} {found:?}"
        );
        let place = (plus.position() - minus.position()) / (2.0 * h);
        assert!((place - found.position).norm() < 2e-6, "{index}: {place} {found:?}");
    }
}

#[test]
fn the_gap_rate_on_a_horn_is_the_rate_of_the_gap_along_the_path() {
    let (q, v) = moving();
    let pair = pair(1.0, 0.0, ContactTangent::RankOne);
    let h = 1e-6;
    let gap = |t: f64| {
        let q: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + t * v).collect();
        state(&pair, &q, &v).geometry.gap
    };
    let rate = (gap(h) - gap(-h)) / (2.0 * h);
    let exact = state(&pair, &q, &v).geometry.gap_rate;
    assert!(
        (rate - exact).abs() < 1e-6 * exact.abs().max(1.0),
        "{rate} against {exact}"
    );
}

/// Contact with the strip moved by `aside` m towards the wire's far side and up by `up` m.
fn moved(pair: &ContactPair, aside: f64, up: f64) -> ContactState {
    let (mut q, v) = (vec![0.0; WIRE + 4], vec![0.0; WIRE + 4]);
    (q[WIRE + 1], q[WIRE + 2]) = (-aside, up);
    state(pair, &q, &v)
}

#[test]
fn from_the_straight_part_onto_the_horn_nothing_jumps_and_the_straight_part_is_as_without_horns() {
    let horned = pair(1.0, 0.0, ContactTangent::RankOne);
    let plain = pair(1.0, 0.0, ContactTangent::RankOne).with_horns(None);
    let mut last: Option<ContactState> = None;
    let mut bends = [0, 0];
    for step in 0..2600 {
        // The wire from 30 mm on one side of the middle over the straight part to 100 mm on the other horn.
        let contact = moved(&horned, -0.12 + 5e-5 * f64::from(step), 0.01);
        if contact.geometry.place.abs() <= 0.02 {
            assert_eq!(contact, moved(&plain, -0.12 + 5e-5 * f64::from(step), 0.01));
            bends[0] += 1;
        } else {
            bends[1] += 1;
        }
        if let Some(last) = last {
            // Slope of 0.5 and force of 1.4 kN over a curvature of 10/m, in steps of 50 µm.
            let jump = (contact.force_on_strip() - last.force_on_strip()).norm();
            assert!(jump < 4.0, "{jump} N at {}", contact.geometry.place);
        }
        last = Some(contact);
    }
    assert!(bends[0] > 500 && bends[1] > 1500, "{bends:?}");
}

#[test]
fn a_wire_that_comes_from_outside_rises_up_the_horn_and_one_that_passes_its_end_is_lost() {
    let (v, mut q) = (vec![0.0; WIRE + 4], vec![0.0; WIRE + 4]);
    // Distance of the wire from the middle of the head, and height of the head.
    let mut at = |pair: &mut ContactPair, place: f64, up: f64| {
        (q[WIRE + 1], q[WIRE + 2]) = (0.09 - place, up);
        pair.begin_step(&motion(&q, &v), 1e-3);
        pair.end_step(&motion(&q, &v));
        state(pair, &q, &v)
    };
    let mut pair = pair(1.0, 0.0, ContactTangent::RankOne);
    // From above the end of the horn: no force beyond it, and one that grows from nothing on it.
    let mut last = 0.0;
    for step in 0..340 {
        let contact = at(&mut pair, 0.25 - 5e-4 * f64::from(step), 0.062);
        assert!((contact.force - last).abs() < 40.0, "{} after {last}", contact.force);
        last = contact.force;
    }
    assert!(last > 1000.0, "{last}");
    // Off the end under pressure: lost, and no force on the way back below the top.
    let on = at(&mut pair, 0.19, 0.074);
    assert!(on.closed() && !at(&mut pair, 0.201, 0.074).closed());
    let under = at(&mut pair, 0.15, 0.074);
    assert!(
        !under.closed() && under.geometry.gap < 0.0,
        "the wire is under the head"
    );
    let mut memory = Vec::new();
    pair.save(&mut memory);
    // Above the top again the wire finds the head again.
    assert!(!at(&mut pair, 0.15, 0.0).closed());
    assert!(at(&mut pair, 0.15, 0.074).closed());
    pair.restore(&mut memory.iter());
    assert!(!at(&mut pair, 0.15, 0.074).closed(), "a restored wire is where it was");
}
