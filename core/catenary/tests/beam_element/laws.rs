//! Force, tangent and mass matrix are what they claim to be.
use catenary::{
    AxialLaw, Beam, BeamCoordinates, BeamInertia, BeamStiffness, BendingLaw, Cable, CableSection, beam_mass_matrix,
    beam_shape,
};
use nalgebra::{Rotation3, SMatrix, Vector3};

const LENGTH: f64 = 1.3;
const TENSION: f64 = 300.0;
const LAWS: [AxialLaw; 3] = [AxialLaw::Mean, AxialLaw::Full, AxialLaw::Engineering];

/// Stiffnesses of the same order, so that an error in any strain shows.
const STIFFNESS: BeamStiffness = BeamStiffness {
    axial: 2.0e3,
    shear: [1.1e3, 0.9e3],
    torsion: 700.0,
    bending: [1.5e3, 800.0],
    section: [2.1e3, 1.8e3, 1.3e3],
};

fn beam(law: AxialLaw) -> Beam {
    Beam::new(&STIFFNESS, (law, TENSION), LENGTH)
}

fn straight() -> BeamCoordinates {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    BeamCoordinates::from_columns(&[Vector3::zeros(), x, y, z, x * LENGTH, x, y, z])
}

/// Bent, twisted, sheared, with a strained cross-section.
fn strained() -> BeamCoordinates {
    let deviation = |row: usize, column: usize| 0.25 * (1.9 * row as f64 + 2.7 * column as f64 + 0.4).sin();
    straight() + BeamCoordinates::from_fn(deviation)
}

#[test]
fn the_force_of_a_beam_is_the_gradient_of_its_strain_energy() {
    for law in LAWS {
        let (beam, e) = (beam(law), strained());
        let force = beam.force(&e);
        for i in 0..24 {
            let h = 1e-5; // rounding 1e-16 U/h against truncation h²: both below 1e-9 of the force
            let (mut plus, mut minus) = (e, e);
            plus[i] += h;
            minus[i] -= h;
            let difference = (beam.energy(&plus) - beam.energy(&minus)) / (2.0 * h);
            let error = (difference - force[i]).abs();
            assert!(error < 1e-7 * force.amax(), "{law:?}, coordinate {i}: {error}");
        }
    }
}

#[test]
fn the_tangent_of_a_beam_is_the_symmetric_jacobian_of_its_force() {
    for law in LAWS {
        let (beam, e) = (beam(law), strained());
        let tangent = beam.tangent(&e);
        assert!((tangent - tangent.transpose()).amax() < 1e-14 * tangent.amax());
        for i in 0..24 {
            let h = 1e-5;
            let (mut plus, mut minus) = (e, e);
            plus[i] += h;
            minus[i] -= h;
            let difference = (beam.force(&plus) - beam.force(&minus)) / (2.0 * h);
            for j in 0..24 {
                let error = (difference[j] - tangent[(j, i)]).abs();
                assert!(error < 1e-7 * tangent.amax(), "{law:?}, entry {j}, {i}: {error}");
            }
        }
    }
}

fn moved(e: &BeamCoordinates) -> (Rotation3<f64>, BeamCoordinates) {
    let rotation = Rotation3::from_euler_angles(0.4, -1.1, 2.0);
    let mut moved = rotation.matrix() * e;
    for i in [0, 4] {
        let mut column = moved.column_mut(i);
        column += Vector3::new(3.0, -2.0, 7.0);
    }
    (rotation, moved)
}

#[test]
fn a_rigid_motion_of_a_beam_changes_no_energy_and_turns_the_force() {
    let e = strained();
    let (rotation, moved) = moved(&e);
    for law in LAWS {
        let beam = beam(law);
        let (energy, turned) = (beam.energy(&e), rotation.matrix() * beam.force(&e));
        assert!((beam.energy(&moved) - energy).abs() < 1e-13 * energy);
        assert!((beam.force(&moved) - turned).amax() < 1e-13 * turned.amax());
    }
}

#[test]
fn a_beam_moved_without_strain_has_no_energy_and_no_force() {
    let (_, moved) = moved(&straight());
    for law in LAWS {
        let beam = Beam::new(&STIFFNESS, (law, 0.0), LENGTH);
        // Rounding of the stiffest strain: 2e3 N · 1e-15.
        assert!(beam.energy(&moved) < 1e-24);
        assert!(beam.force(&moved).amax() < 1e-11);
    }
}

#[test]
fn the_straight_beam_carries_the_nominal_tension_and_nothing_else() {
    for law in LAWS {
        let beam = beam(law);
        let mut expected = BeamCoordinates::zeros();
        (expected[(0, 0)], expected[(0, 4)]) = (-TENSION, TENSION);
        // Rounding of EA (λ² − 1).
        assert!((beam.force(&straight()) - expected).amax() < 1e-11, "{law:?}");
        assert!((beam.tension(&straight()) - TENSION).abs() < 1e-11);
    }
}

#[test]
fn a_straight_beam_has_six_rigid_motions_and_no_other_motion_without_energy() {
    for law in [AxialLaw::Full, AxialLaw::Engineering] {
        let eigenvalues = Beam::new(&STIFFNESS, (law, 0.0), LENGTH)
            .tangent(&straight())
            .symmetric_eigenvalues();
        let zero = eigenvalues
            .iter()
            .filter(|value| value.abs() < 1e-12 * eigenvalues.amax());
        assert_eq!(zero.count(), 6, "{law:?}: {eigenvalues}");
        assert!(eigenvalues.iter().all(|value| *value > -1e-12 * eigenvalues.amax()));
    }
}

#[test]
fn a_beam_bent_without_shear_has_the_energy_of_the_cable() {
    // Deflections of 1e-4: what is left of the shear and of turned directors is of fourth order.
    let deflection = [0.3e-4, -1.1e-4, 0.8e-4, 0.9e-4];
    let mut e = straight();
    for (node, pair) in deflection.chunks(2).enumerate() {
        let (w, slope) = (pair[0], pair[1]);
        e[(1, 4 * node)] += w;
        e[(1, 4 * node + 1)] += slope;
        e[(0, 4 * node + 2)] -= slope;
    }
    let cable = Cable {
        section: CableSection::new(2.0e3, STIFFNESS.bending[1], 0.0, (AxialLaw::Mean, BendingLaw::Constant)),
        length: LENGTH,
    };
    let beam = Beam::new(&STIFFNESS, (AxialLaw::Mean, 0.0), LENGTH);
    let (energy, expected) = (beam.energy(&e), cable.energy(&Beam::axis(&e)));
    assert!(
        (energy / expected - 1.0).abs() < 1e-7,
        "{energy} J against {expected} J"
    );
}

#[test]
fn the_mass_matrix_of_a_beam_is_the_integral_of_its_shape_over_its_volume() {
    let inertia = BeamInertia {
        mass: 1.35,
        section: [0.02, 0.03],
    };
    // Points at ±y₀ and ±z₀ with the section's moments; Gauss points exact to degree seven along the axis.
    let points = [0.339_981_043_584_856_3, 0.861_136_311_594_052_6];
    let weights = [0.652_145_154_862_546_1, 0.347_854_845_137_453_9];
    let offsets = inertia.section.map(|moment: f64| (2.0 * moment / inertia.mass).sqrt());
    let mut sum = SMatrix::<f64, 8, 8>::zeros();
    for (point, weight) in points.iter().zip(weights) {
        for side in [-1.0, 1.0] {
            for offset in [
                [offsets[0], 0.0],
                [-offsets[0], 0.0],
                [0.0, offsets[1]],
                [0.0, -offsets[1]],
            ] {
                let s = beam_shape(0.5 + 0.5 * side * point, offset, LENGTH);
                sum += s * s.transpose() * (0.25 * 0.5 * weight * LENGTH * inertia.mass);
            }
        }
    }
    let matrix = beam_mass_matrix(&inertia, LENGTH);
    assert!((matrix - sum).amax() < 1e-14 * matrix.amax());
}

#[test]
fn a_beam_turned_rigidly_keeps_the_distances_of_its_points() {
    let (rotation, moved) = moved(&straight());
    let s = beam_shape(0.3, [0.01, -0.02], LENGTH);
    let expected = rotation * Vector3::new(0.3 * LENGTH, 0.01, -0.02) + Vector3::new(3.0, -2.0, 7.0);
    assert!((moved * s - expected).amax() < 1e-14 * 7.0);
}
