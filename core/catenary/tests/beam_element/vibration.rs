//! Natural frequencies against closed forms.
use super::chain::Chain;
use catenary::{AxialLaw, BeamInertia, BeamStiffness};
use std::f64::consts::{PI, TAU};

/// A thin round wire of unit mass per length.
const INERTIA: BeamInertia = BeamInertia {
    mass: 1.0,
    section: [1e-6, 1e-6],
};

/// `EI` 10 N·m², thin: EA = EI/1e-6 m².
const STIFFNESS: BeamStiffness = BeamStiffness {
    axial: 1e7,
    shear: [3.5e6, 3.5e6],
    torsion: 7.7,
    bending: [10.0, 10.0],
    section: [1e7, 1e7, 3.8e6],
};

fn assert_frequencies(found: &[f64], expected: &[f64]) {
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{found} Hz against {expected} Hz"
        );
    }
}

#[test]
fn a_cantilever_vibrates_in_bending_and_torsion_as_in_closed_form() {
    let length = 1.0_f64;
    let mut chain = Chain::clamped(&STIFFNESS, &INERTIA, (AxialLaw::Engineering, 0.0), length, 8);
    // cos β cosh β = −1; each bending mode in both directions.
    let bending = [1.875_104_069, 4.694_091_133, 7.854_757_438, 10.995_540_73]
        .map(|beta: f64| beta * beta * (STIFFNESS.bending[0] / INERTIA.mass).sqrt() / (TAU * length * length));
    let expected = [0, 0, 1, 1, 2, 2, 3, 3].map(|mode: usize| bending[mode]);
    assert_frequencies(&chain.frequencies(8), &expected);

    // Torsion alone: the axis held.
    for node in 1..=8 {
        (0..6).for_each(|coordinate| chain.hold(node, coordinate));
    }
    let speed = (STIFFNESS.torsion / (INERTIA.section[0] + INERTIA.section[1])).sqrt();
    assert_frequencies(&chain.frequencies(1), &[speed / (4.0 * length)]);
}

#[test]
fn tensioned_beams_vibrate_as_in_closed_form() {
    // T = 1000 N, m = 1 kg/m, EI = 10 N·m², L = 1 m.
    let (tension, length, elements) = (1000.0, 1.0, 8);
    for law in [AxialLaw::Mean, AxialLaw::Engineering] {
        let mut clamped = Chain::clamped(&STIFFNESS, &INERTIA, (law, tension), length, elements);
        (0..3)
            .chain(6..12)
            .for_each(|coordinate| clamped.hold(elements, coordinate));
        // Roots of the equation of the clamped tensioned beam, each in both directions.
        assert_frequencies(
            &clamped.frequencies(4),
            &[20.631_535, 20.631_535, 45.932_609, 45.932_609],
        );

        let mut pinned = Chain::clamped(&STIFFNESS, &INERTIA, (law, tension), length, elements);
        (6..12).for_each(|coordinate| pinned.release(coordinate));
        (0..3).for_each(|coordinate| pinned.hold(elements, coordinate));
        // The beam may not spin about its axis.
        pinned.hold(0, 8);
        let frequency = |n: f64| {
            let wave = n * PI / length;
            wave / TAU * ((tension + STIFFNESS.bending[0] * wave * wave) / INERTIA.mass).sqrt()
        };
        let expected = [1.0, 1.0, 2.0, 2.0, 3.0, 3.0].map(frequency);
        assert_frequencies(&pinned.frequencies(6), &expected);
    }
}
