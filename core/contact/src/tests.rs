use super::*;
use dynamics::State;
use dynamics::testing::{LawTrio, plain_layout};
use nalgebra::{Matrix3, Rotation3};
use wire::{Compliance, CurveColumns, CurvePoint, NodeMap, WireGeometry};

pub(super) const WIRE: usize = 18;

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

/// A wire that yields by `1 + sin s/2` µm/N beyond its coordinates.
struct Yielding(WireGeometry);

impl WireCurve for Yielding {
    fn length(&self) -> f64 {
        self.0.length()
    }

    fn point(&self, s: f64, q: &[f64], v: &[f64]) -> CurvePoint {
        self.0.point(s, q, v)
    }

    fn columns(&self, s: f64, columns: &mut CurveColumns) {
        self.0.columns(s, columns);
    }

    fn compliance(&self, s: f64) -> Compliance {
        Compliance {
            value: 4e-6 * (1.0 + 0.5 * s.sin()),
            slope: 2e-6 * s.cos(),
        }
    }
}

/// Two elements of 5 m along x, staggered sideways.
fn pair(roll: f64, damping: f64, tangent: ContactTangent) -> ContactPair {
    on_curve(roll, damping, tangent, |geometry| Arc::new(geometry))
}

/// Pair with a residual compliance.
fn yielding(roll: f64, damping: f64, tangent: ContactTangent) -> ContactPair {
    on_curve(roll, damping, tangent, |geometry| Arc::new(Yielding(geometry)))
}

/// Pair in a step that begins with a gap of 1 mm.
fn closing(mut pair: ContactPair) -> ContactPair {
    pair.step = UnilateralStep::new(UnilateralStart::Known(-1e-3), 1e-4);
    pair
}

fn on_curve(
    roll: f64,
    damping: f64,
    tangent: ContactTangent,
    curve: impl Fn(WireGeometry) -> Arc<dyn WireCurve>,
) -> ContactPair {
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
    ContactPair::new(law, curve(geometry), Box::new(strip), 1.2, tangent)
}

pub(super) fn bent() -> (Vec<f64>, Vec<f64>) {
    let q = (0..WIRE + 3)
        .map(|i| 1e-3 * ((i * i * 7 % 13) as f64 / 13.0 - 0.5))
        .collect();
    let mut v: Vec<f64> = (0..WIRE + 3)
        .map(|i| 0.02 * ((i * i * 5 % 11) as f64 / 11.0 - 0.5))
        .collect();
    v[WIRE] += 60.0;
    (q, v)
}

/// The force is what an energy of some 1e-1 J gives along each coordinate: its central difference rounds at 1e-10 of
/// the force.
pub(super) fn assert_energy(pair: &mut ContactPair, q: &[f64], tolerance: f64) {
    let trio = LawTrio {
        q_step: 1e-6,
        tolerance,
        ..LawTrio::default()
    };
    let mut state = State::at_rest(q.len(), 0, Vec::new());
    state.q.copy_from_slice(q);
    trio.assert_energy(pair, &plain_layout(q.len()), &state);
}

pub(super) fn motion<'a>(q: &'a [f64], v: &'a [f64]) -> Motion<'a> {
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
    // The force that drives the strip towards larger compliance acts at the wire; its lever arm, the penetration, is
    // left out.
    for (mut pair, tolerance) in [
        (pair(0.04, 0.0, ContactTangent::Exact), 1e-6),
        (yielding(0.04, 0.0, ContactTangent::Exact), 4e-6),
    ] {
        let exact = force(&mut pair, &q, &v);
        assert!(exact.iter().any(|value| value.abs() > 10.0), "the strip presses");
        assert_energy(&mut pair, &q, tolerance);
    }
}

#[test]
fn a_wire_that_yields_is_in_series_with_the_contact() {
    let (q, v) = bent();
    let stiff = pair(0.04, 0.0, ContactTangent::RankOne);
    let soft = yielding(0.04, 0.0, ContactTangent::RankOne);
    let [stiff, soft] = [&stiff, &soft].map(|pair| pair.state(&motion(&q, &v)).expect("on the wire"));
    let g = soft.compliance.value;
    assert!((soft.force * (1.0 / 5e4 + g) + soft.geometry.gap).abs() < 1e-12);
    assert!(soft.force < 0.9 * stiff.force);
    // The remaining gap is the contact's own.
    assert!((soft.force + 5e4 * soft.gap()).abs() < 1e-9 * soft.force);
    let raised = (soft.position() - soft.geometry.wire.r).dot(&soft.geometry.normal);
    assert!((raised - g * soft.force).abs() < 1e-15);
    assert_eq!(stiff.gap(), stiff.geometry.gap);
    assert_eq!(stiff.wire_velocity(), stiff.geometry.wire.velocity);
}

/// Force of a strip that oscillates with 20 Hz on a spring and damper in series with a spring, by its complex
/// stiffness.
#[test]
fn the_damper_of_the_contact_works_on_its_own_share_of_the_penetration() {
    let (k, d, g, omega) = (5e4, 100.0, 1e-6, 40.0 * std::f64::consts::PI);
    let share: f64 = 1.0 / (1.0 + k * g);
    let (stiffness, damping) = PenaltyContact {
        stiffness: k,
        damping: d,
    }
    .yielding(share);
    let z = nalgebra::Complex::new(k, omega * d);
    let exact = z / (z * g + 1.0);
    let ours = nalgebra::Complex::new(stiffness, omega * damping);
    let error = (ours - exact).norm() / exact.norm();
    assert!(error < 3.5e-3, "{error}");
    // The square of the damping adds to it.
    let z = nalgebra::Complex::new(k, 0.1 * omega * d);
    let exact = z / (z * g + 1.0);
    let ours = nalgebra::Complex::new(stiffness, 0.1 * omega * damping);
    assert!((ours - exact).norm() / exact.norm() < 0.011 * error);
}

#[test]
fn the_exact_tangent_is_the_jacobian_of_the_force() {
    let (q, v) = bent();
    // The tangent leaves out the change of the force that drives the strip along a yielding wire, and with damping the
    // second derivative of the compliance.
    for (mut pair, tolerance) in [
        (pair(0.04, 0.0, ContactTangent::Exact), 1e-6),
        (pair(0.04, 300.0, ContactTangent::Exact), 1e-6),
        (yielding(0.04, 0.0, ContactTangent::Exact), 1e-3),
        (yielding(0.04, 300.0, ContactTangent::Exact), 2e-3),
        (closing(pair(0.04, 300.0, ContactTangent::Exact)), 1e-6),
        (closing(yielding(0.04, 300.0, ContactTangent::Exact)), 2e-3),
    ] {
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
                    assert!(
                        error < tolerance * size.max(1.0),
                        "({i}, {j}) weights {weights:?}: {error} of {size}"
                    );
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
    for (damping, soft, closes) in [
        (200.0, false, false),
        (0.0, true, false),
        (200.0, true, false),
        (200.0, false, true),
        (200.0, true, true),
    ] {
        let mut pair = match soft {
            false => pair(0.04, damping, ContactTangent::RankOne),
            true => yielding(0.04, damping, ContactTangent::RankOne),
        };
        if closes {
            pair = closing(pair);
        }
        let contact = pair.state(&motion(&q, &v)).expect("on the wire");
        let h = 1e-7;
        // Second derivatives of the compliance are left out; they come with the damping, and along the track.
        let (force_tolerance, place_tolerance, velocity_tolerance) =
            if soft { (5e-4, 3e-5, 2e-2) } else { (1e-5, 1e-6, 1e-6) };
        for axis in 0..3 {
            let unit = Vector3::ith(axis, 1.0);
            let zero = Vector3::zeros();
            for (of_velocity, direction) in [(false, [unit, zero, zero]), (true, [zero, zero, unit])] {
                let found = pair.sensitivity(&contact, &motion(&q, &v), direction);
                let moved = |shift: f64| {
                    let (mut q, mut v) = (q.clone(), v.clone());
                    if of_velocity {
                        v[WIRE + axis] += shift;
                    } else {
                        q[WIRE + axis] += shift;
                    }
                    pair.state(&motion(&q, &v)).expect("on the wire")
                };
                let (plus, minus) = (moved(h), moved(-h));
                let quotient = |of: &dyn Fn(&ContactState) -> Vector3<f64>| (of(&plus) - of(&minus)) / (2.0 * h);
                let case =
                    format!("damping {damping}, soft {soft}, closes {closes}, axis {axis}, velocity {of_velocity}");
                let close = |what: &str, a: Vector3<f64>, b: Vector3<f64>, tolerance: f64| {
                    assert!((a - b).norm() < tolerance, "{what}, {case}: {a:?} {b:?}");
                };
                let force = quotient(&|state| state.force_on_strip());
                close("force", force, found.force_on_strip, force_tolerance * 5e4);
                let size = quotient(&|state| Vector3::x() * state.force);
                close("size", size, Vector3::x() * found.force, force_tolerance * 5e4);
                let place = quotient(&|state| state.position());
                close("position", place, found.position, place_tolerance);
                let gap = quotient(&|state| Vector3::x() * state.gap());
                close("gap", gap, Vector3::x() * found.gap, place_tolerance);
                let velocity = quotient(&|state| state.wire_velocity());
                close("velocity", velocity, found.velocity, velocity_tolerance);
            }
        }
    }
}

#[test]
fn the_contact_that_closes_in_a_step_is_damped_from_its_end_on() {
    const HALF: f64 = 5e-4;
    let (mut q, mut v) = bent();
    v[WIRE + 2] += 0.5;
    let closed = q[WIRE + 2];
    let mut pair = pair(0.04, 100.0, ContactTangent::RankOne);
    let instant = pair.state(&motion(&q, &v)).expect("on the wire");
    assert_eq!(instant.damping, 100.0, "no step, no beginning");
    q[WIRE + 2] = closed - 0.01;
    pair.end_step(&motion(&q, &v));
    let gap = pair.state(&motion(&q, &v)).expect("on the wire").gap();
    // Before the first step the present place is its start.
    q[WIRE + 2] = closed;
    pair.begin_step(&motion(&q, &v), 2.0 * HALF);
    let in_step = pair.state(&motion(&q, &v)).expect("on the wire");
    let (delta, rate) = (-in_step.geometry.gap, -in_step.geometry.gap_rate);
    let ahead = delta + HALF * rate;
    let part = ahead / (ahead + gap);
    let force = 5e4 * delta + part * 100.0 * rate;
    assert!(part > 0.1 && part < 0.9 && rate > 0.4, "{part} {rate}");
    assert!(
        (in_step.force - force).abs() < 1e-10,
        "rounding of 100 N: {} {force}",
        in_step.force
    );
    // The rest of the instant's force makes no heat; the spring has its energy.
    let heat = in_step.dissipation();
    assert!(
        (heat - part * 100.0 * rate * rate).abs() < 1e-10,
        "rounding of 10 W: {heat}"
    );
    // The end is reported as the step has found it, until the next one begins.
    pair.end_step(&motion(&q, &v));
    assert_eq!(pair.state(&motion(&q, &v)), Some(in_step));
    pair.begin_step(&motion(&q, &v), 2.0 * HALF);
    let next = pair.state(&motion(&q, &v)).expect("on the wire");
    assert_eq!((next.force, next.damping), (instant.force, 100.0));
    // A strip beside the wire has no gap that closes.
    let middle = std::mem::replace(&mut q[WIRE + 1], 0.9);
    pair.end_step(&motion(&q, &v));
    q[WIRE + 1] = middle;
    pair.begin_step(&motion(&q, &v), 2.0 * HALF);
    let came = pair.state(&motion(&q, &v)).expect("on the wire");
    assert!(
        (came.force - 5e4 * delta).abs() < 1e-10,
        "rounding of 100 N: {}",
        came.force
    );
}

#[test]
fn a_step_that_ends_unevaluated_ends_where_it_ends_or_asks_for_the_evaluation() {
    let (mut q, v) = bent();
    let closed = q[WIRE + 2];
    let end = |evaluated: bool, q: &[f64]| {
        let mut pair = pair(0.04, 100.0, ContactTangent::RankOne);
        let mut start = q.to_vec();
        start[WIRE + 2] = closed - 0.001;
        let mut force = vec![0.0; q.len()];
        pair.begin_step(&motion(&start, &v), 1e-3);
        pair.add_force(&motion(&start, &v), &mut force);
        let mut continues = pair.continues_to(&motion(q, &v));
        if evaluated {
            pair.add_force(&motion(q, &v), &mut force);
            continues = true;
        }
        pair.end_step(&motion(q, &v));
        let mut memory = Vec::new();
        pair.save(&mut memory);
        (continues, memory)
    };
    q[WIRE + 2] = closed - 0.0011;
    assert_eq!(end(false, &q), end(true, &q), "as far below the strip");
    q[WIRE + 2] = closed - 0.05;
    let far = end(false, &q);
    q[WIRE + 2] = closed + 0.05;
    let near = end(false, &q);
    assert!(far.0 != near.0, "one of them is on the other side of the wire");
    assert_ne!(far.1, near.1);
}
