use super::axial::nominal_stretch;
use super::shape::{bending_matrix, mass_matrix, tension_matrix};
use super::*;
use nalgebra::{Matrix4, Rotation3, Vector3, Vector4};

const LENGTH: f64 = 1.3;
const LAWS: [(AxialLaw, BendingLaw); 6] = [
    (AxialLaw::Mean, BendingLaw::Constant),
    (AxialLaw::Full, BendingLaw::Constant),
    (AxialLaw::Engineering, BendingLaw::Constant),
    (AxialLaw::Mean, BendingLaw::Exact),
    (AxialLaw::Full, BendingLaw::Exact),
    (AxialLaw::Engineering, BendingLaw::Exact),
];

/// Stiffnesses of the same order, so that an error in either law shows.
fn cable(laws: (AxialLaw, BendingLaw)) -> Cable {
    Cable {
        section: CableSection::new(2.0e3, 1.5e3, 300.0, laws),
        length: LENGTH,
    }
}

fn bent() -> Coordinates {
    Coordinates::from_columns(&[
        Vector3::new(0.2, -0.1, 0.3),
        Vector3::new(0.9, 0.35, -0.3),
        Vector3::new(1.35, 0.25, 0.1),
        Vector3::new(1.05, -0.2, 0.4),
    ])
}

fn straight() -> Coordinates {
    Coordinates::from_columns(&[Vector3::zeros(), Vector3::x(), Vector3::x() * LENGTH, Vector3::x()])
}

#[test]
fn the_force_is_the_gradient_of_the_strain_energy() {
    for laws in LAWS {
        let (cable, e) = (cable(laws), bent());
        let force = cable.force(&e);
        for i in 0..12 {
            let h = 1e-5; // rounding 1e-16 U/h against truncation h²: both below 1e-9 of the force
            let (mut plus, mut minus) = (e, e);
            plus[i] += h;
            minus[i] -= h;
            let difference = (cable.energy(&plus) - cable.energy(&minus)) / (2.0 * h);
            assert!(
                (difference - force[i]).abs() < 1e-6 * force.amax(),
                "{laws:?}, coordinate {i}: {difference} against {}",
                force[i]
            );
        }
    }
}

#[test]
fn the_tangent_is_the_symmetric_jacobian_of_the_force() {
    for laws in LAWS {
        let (cable, e) = (cable(laws), bent());
        let tangent = cable.tangent(&e);
        assert!((tangent - tangent.transpose()).amax() < 1e-12 * tangent.amax());
        for i in 0..12 {
            let h = 1e-5;
            let (mut plus, mut minus) = (e, e);
            plus[i] += h;
            minus[i] -= h;
            let difference = (cable.force(&plus) - cable.force(&minus)) / (2.0 * h);
            for j in 0..12 {
                let error = (difference[j] - tangent[(j, i)]).abs();
                assert!(error < 1e-6 * tangent.amax(), "{laws:?}, entry {j}, {i}: {error}");
            }
        }
    }
}

#[test]
fn a_rigid_motion_changes_no_energy_and_turns_the_force() {
    let rotation = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let shift = Vector3::new(3.0, -2.0, 7.0);
    let e = bent();
    let mut moved = rotation.matrix() * e;
    for i in [0, 2] {
        let mut column = moved.column_mut(i);
        column += shift;
    }
    for laws in LAWS {
        let cable = cable(laws);
        let energy = cable.energy(&e);
        assert!((cable.energy(&moved) - energy).abs() < 1e-12 * energy);
        let turned = rotation.matrix() * cable.force(&e);
        assert!((cable.force(&moved) - turned).amax() < 1e-12 * turned.amax());
    }
}

#[test]
fn the_straight_element_carries_the_nominal_tension() {
    for laws in LAWS {
        let cable = cable(laws);
        let force = cable.force(&straight());
        // rounding of EA (λ² − 1): 1e-16 EA
        assert!((force[(0, 2)] - 300.0).abs() < 1e-11, "{laws:?}: {}", force[(0, 2)]);
        assert!((force[(0, 0)] + 300.0).abs() < 1e-11);
        assert!((cable.tension(&straight()) - 300.0).abs() < 1e-11);
    }
}

#[test]
fn the_unstressed_element_has_no_energy_and_no_force() {
    for laws in LAWS {
        let cable = cable(laws);
        let unstressed = straight() / nominal_stretch(laws.0, 300.0, 2.0e3);
        assert!(cable.energy(&unstressed) < 1e-20);
        assert!(cable.force(&unstressed).amax() < 1e-11);
    }
}

#[test]
fn the_laws_agree_for_a_slightly_sagging_element() {
    // A parabola with 1 % slope: the exact curvature also pulls along the wire, with EI κ² = 0.35 N of 300 N.
    let slope = 0.01;
    let e = Coordinates::from_columns(&[
        Vector3::zeros(),
        Vector3::new(1.0, 0.0, -slope),
        Vector3::x() * LENGTH,
        Vector3::new(1.0, 0.0, slope),
    ]);
    let reference = cable(LAWS[0]).force(&e);
    for laws in &LAWS[1..] {
        let difference = (cable(*laws).force(&e) - reference).amax();
        assert!(
            difference < 2e-3 * reference.amax(),
            "{laws:?}: {difference} of {}",
            reference.amax()
        );
    }
}

#[test]
fn a_circular_arc_has_the_exact_curvature() {
    // An arc of angle θ on cubic polynomials: curvature is right to θ⁴ at the Gauss points.
    let angle: f64 = 0.2;
    let radius = LENGTH / angle;
    let e = Coordinates::from_columns(&[
        Vector3::zeros(),
        Vector3::x(),
        Vector3::new(radius * angle.sin(), 0.0, radius * (1.0 - angle.cos())),
        Vector3::new(angle.cos(), 0.0, angle.sin()),
    ]);
    let expected = 0.5 * 1.5e3 * LENGTH / (radius * radius);
    let cable = Cable {
        section: CableSection::new(1e-9, 1.5e3, 0.0, (AxialLaw::Mean, BendingLaw::Exact)),
        length: LENGTH,
    };
    assert!((cable.energy(&e) / expected - 1.0).abs() < 1e-4);
}

#[test]
fn the_nominal_stretch_solves_its_equation() {
    for (tension, stiffness) in [(0.0, 1e7), (2e4, 1.7e7), (5e3, 1e3)] {
        let stretch = nominal_stretch(AxialLaw::Mean, tension, stiffness);
        let carried: f64 = stiffness * 0.5 * (stretch * stretch - 1.0) * stretch;
        assert!((carried - tension).abs() < 1e-15 * stiffness + 1e-12 * tension);
    }
}

#[test]
fn shape_functions_are_exact_at_the_nodes_and_interpolate_cubics() {
    let start = ShapeFunctions::at(0.0, LENGTH);
    assert_eq!(start.s, Vector4::new(1.0, 0.0, 0.0, 0.0));
    assert_eq!(start.s_x, Vector4::new(0.0, 1.0, 0.0, 0.0));
    let end = ShapeFunctions::at(1.0, LENGTH);
    assert_eq!(end.s, Vector4::new(0.0, 0.0, 1.0, 0.0));
    assert_eq!(end.s_x, Vector4::new(0.0, 0.0, 0.0, 1.0));
    // x³ − x at xi = 0.3
    let f = |x: f64| x * x * x - x;
    let f_x = |x: f64| 3.0 * x * x - 1.0;
    let e = Vector4::new(f(0.0), f_x(0.0), f(LENGTH), f_x(LENGTH));
    let (at, x) = (ShapeFunctions::at(0.3, LENGTH), 0.3 * LENGTH);
    assert!((at.s.dot(&e) - f(x)).abs() < 1e-14);
    assert!((at.s_x.dot(&e) - f_x(x)).abs() < 1e-14);
    assert!((at.s_xx.dot(&e) - 6.0 * x).abs() < 1e-13);
}

#[test]
fn the_constant_matrices_are_the_integrals_of_the_shape_functions() {
    let mut sums = [Matrix4::zeros(); 3];
    for (xi, weight) in FIVE_POINTS {
        let at = ShapeFunctions::at(xi, LENGTH);
        for (sum, s) in sums.iter_mut().zip([at.s, at.s_x, at.s_xx]) {
            *sum += s * s.transpose() * (weight * LENGTH);
        }
    }
    let closed = [mass_matrix(LENGTH), tension_matrix(LENGTH), bending_matrix(LENGTH)];
    for (sum, closed) in sums.iter().zip(closed) {
        assert!((sum - closed).amax() < 1e-13 * closed.amax());
    }
}
