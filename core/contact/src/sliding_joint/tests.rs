use super::*;
use nalgebra::{Matrix3, Rotation3, Vector3};
use wire::{NodeMap, WireGeometry};

/// Coordinates of the wire: three nodes in space.
const WIRE: usize = 18;
/// Speed at which the strip's travel along the track is prescribed, m/s.
const TRAVEL: f64 = 55.0;

/// A strip on three free coordinates behind those of the wire, which also travels along the track, turned by a fixed
/// roll angle.
struct Loose;

impl Marker for Loose {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let at = Vector3::new(4.2 + TRAVEL * motion.t, 0.05, 0.004);
        Frame {
            position: at + Vector3::from_column_slice(&motion.q[WIRE..]),
            axes: Rotation3::from_axis_angle(&Vector3::x_axis(), 0.04).into_inner(),
            velocity: Vector3::from_column_slice(&motion.v[WIRE..]) + TRAVEL * Vector3::x(),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        for (i, axis) in Matrix3::identity().column_iter().enumerate() {
            columns.push(WIRE + i, axis.into(), Vector3::zeros());
        }
    }
}

/// Joint on two elements of 5 m along x, staggered sideways.
fn joint() -> SlidingJoint {
    let direction = Vector3::new(1.0, 0.03, 0.0).normalize();
    let geometry = WireGeometry::straight(Vector3::zeros(), direction, &[5.0, 5.0], |node| {
        NodeMap::spatial(6 * node)
    });
    SlidingJoint::new(Arc::new(geometry), Box::new(Loose), 0, ContactTangent::Exact)
}

/// A bent wire and a strip some millimetres off it.
fn bent() -> (Vec<f64>, Vec<f64>) {
    let q = (0..WIRE + 3).map(|i| 5e-3 * ((i * i * 7 % 13) as f64 / 13.0 - 0.5));
    let v = (0..WIRE + 3).map(|i| 0.3 * ((i * i * 5 % 11) as f64 / 11.0 - 0.5));
    (q.collect(), v.collect())
}

fn motion<'a>(t: f64, q: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion {
        t,
        q,
        v,
        rotation: &[],
        u: &[],
    }
}

fn residual(joint: &SlidingJoint, t: f64, q: &[f64]) -> f64 {
    let mut g = [0.0];
    joint.residual(&motion(t, q, &vec![0.0; q.len()]), &mut g);
    g[0]
}

/// `g_q`, dense.
fn row(joint: &SlidingJoint, q: &[f64]) -> Vec<f64> {
    let mut dense = vec![0.0; q.len()];
    let v = vec![0.0; q.len()];
    joint.jacobian(
        &motion(0.0, q, &v),
        &mut JacobianRows::new(&mut |_, columns, values| {
            columns
                .iter()
                .zip(values)
                .for_each(|(&column, value)| dense[column] += value);
        }),
    );
    dense
}

#[test]
fn the_jacobian_is_the_derivative_of_the_residual_also_off_the_constraint() {
    let (q, _) = bent();
    let joint = joint();
    assert!(residual(&joint, 0.0, &q).abs() > 1e-4, "off the constraint");
    let exact = row(&joint, &q);
    for i in 0..q.len() {
        let h = 1e-6;
        let moved = |shift: f64| {
            let mut q = q.clone();
            q[i] += shift;
            residual(&joint, 0.0, &q)
        };
        let slope = (moved(h) - moved(-h)) / (2.0 * h);
        // Central difference: rounding 1e-16 m over 2e-6 m, third derivatives times h².
        assert!(
            (slope - exact[i]).abs() < 1e-9,
            "coordinate {i}: {slope} against {}",
            exact[i]
        );
    }
    // The strip's travel meets the slope of the wire, which makes the strip rise.
    assert!(exact[WIRE].abs() > 1e-4, "{exact:?}");
}

#[test]
fn the_rate_of_the_residual_is_that_of_the_coordinates_and_of_the_prescribed_travel() {
    let (q, v) = bent();
    let joint = joint();
    let h = 1e-6;
    let at = |t: f64| {
        let q: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + t * v).collect();
        residual(&joint, t, &q)
    };
    let rate = (at(h) - at(-h)) / (2.0 * h);
    let mut found = [0.0];
    joint.add_rate(&motion(0.0, &q, &v), &mut found);
    // Central difference: rounding 1e-16 m over 2e-6 s, third derivatives at 55 m/s times h².
    assert!((rate - found[0]).abs() < 1e-8, "{rate}: {found:?}");
    let free: f64 = row(&joint, &q).iter().zip(&v).map(|(g, v)| g * v).sum();
    let explicit = rate - free;
    assert!(explicit.abs() > 0.01, "the wire slopes: {explicit} m/s");
}

#[test]
fn the_border_has_the_derivatives_of_the_residual_and_of_its_rate() {
    let (q, v) = bent();
    let mut joint = joint();
    let at = motion(0.0, &q, &v);
    let geometry = joint.geometry(&at).expect("on the wire");
    joint.turn(&geometry, &at);
    let (mut direction, mut of_rate) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    for &(index, g, rate) in &joint.direction {
        direction[index] += g;
        of_rate[index] += rate;
    }
    assert_eq!(direction, row(&joint, &q));
    let size = of_rate.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
    assert!(size > 10.0, "{size} 1/s: the strip passes along the wire's slopes");
    for i in 0..q.len() {
        let h = 1e-6;
        let moved = |shift: f64| {
            let mut q = q.clone();
            q[i] += shift;
            let mut rate = [0.0];
            joint.add_rate(&motion(0.0, &q, &v), &mut rate);
            rate[0]
        };
        let slope = (moved(h) - moved(-h)) / (2.0 * h);
        // Central difference: rounding 1e-14 m/s over 2e-6 m; the search ends within 1e-11 m.
        assert!(
            (slope - of_rate[i]).abs() < 1e-6 * size,
            "coordinate {i}: {slope} against {}",
            of_rate[i]
        );
    }
}

#[test]
fn the_tangent_is_the_derivative_of_the_generalised_force_of_the_multiplier() {
    let (q, v) = bent();
    let joint = joint();
    let lambda = 120.0;
    let motion = motion(0.0, &q, &v);
    let geometry = joint.geometry(&motion).expect("on the wire");
    let sides = joint.sides(&geometry, &motion);
    let (indices, matrix) = sides.tangent(&joint.strip.frame(&motion), lambda, 1.0, |_, _| 0.0);
    let size = matrix.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
    assert!(size > 1.0, "{size} N/m");
    for (j, &column) in indices.iter().enumerate() {
        let h = 1e-6;
        let force = |shift: f64| {
            let mut q = q.clone();
            q[column] += shift;
            row(&joint, &q)
        };
        let (plus, minus) = (force(h), force(-h));
        for (i, &index) in indices.iter().enumerate() {
            let slope = lambda * (plus[index] - minus[index]) / (2.0 * h);
            let found = matrix[i * indices.len() + j];
            // Central difference: rounding 1e-16 λ over 2e-6 m; the search ends within 1e-11 m.
            assert!(
                (slope - found).abs() < 1e-5 * size,
                "({index}, {column}): {slope} against {found} N/m"
            );
        }
    }
}

#[test]
fn position_and_direction_do_not_jump_at_an_element_border() {
    let (mut q, _) = bent();
    let joint = joint();
    let border = 5.0 / (1.0_f64 + 0.03 * 0.03).sqrt();
    let mut at = |x: f64| {
        q[WIRE] = x - 4.2;
        (residual(&joint, 0.0, &q), row(&joint, &q))
    };
    let h = 1e-7;
    let (before, after) = (at(border - h), at(border + h));
    // Slopes of the wire of some 1e-3 over 2e-7 m; curvatures of some 1e-3 1/m over the same.
    assert!((before.0 - after.0).abs() < 1e-8, "{} {}", before.0, after.0);
    let turned = before.1.iter().zip(&after.1).map(|(a, b)| (a - b).abs());
    assert!(turned.fold(0.0, f64::max) < 1e-6, "shape functions times 2e-7 m");
}

#[test]
fn the_multiplier_is_the_force_of_either_sign_and_beyond_the_wire_there_is_none() {
    let (mut q, v) = bent();
    let joint = joint();
    for lambda in [110.0, -15.0] {
        let state = joint.state(&motion(0.0, &q, &v), &[lambda]).expect("on the wire");
        assert_eq!(state.force, lambda);
        assert_eq!(state.closed(), lambda > 0.0);
        // Compression pushes the strip down.
        assert!((state.force_on_strip() + lambda * state.geometry.normal).norm() < 1e-12);
    }
    q[WIRE] = 20.0;
    assert!(joint.state(&motion(0.0, &q, &v), &[1.0]).is_none());
    assert!(residual(&joint, 0.0, &q).is_nan());
}
