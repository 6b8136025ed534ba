use super::*;
use crate::wheel_rail::{Creepage, KalkerCoefficients};

const G: f64 = 82e9;
const NU: f64 = 0.28;

const FINE: CreepLaw = CreepLaw::Fastsim(Fastsim {
    strips: 200,
    cells: 200,
});
const COARSE: CreepLaw = CreepLaw::Fastsim(Fastsim { strips: 10, cells: 10 });

/// The ellipse of CONTACT's example `fastsim.inp`.
const PATCH: Patch = Patch {
    along: 8e-3,
    across: 4e-3,
    normal_force: 82e3,
};

fn model(law: CreepLaw) -> CreepModel {
    CreepModel {
        law,
        friction: 0.3,
        shear_modulus: G,
        coefficients: KalkerCoefficients::new(NU),
    }
}

fn creepage(longitudinal: f64, lateral: f64, spin: f64) -> Creepage {
    Creepage {
        longitudinal,
        lateral,
        spin,
    }
}

fn forces(law: CreepLaw, creepage: Creepage) -> [f64; 3] {
    model(law).force(&creepage, &PATCH)
}

#[test]
fn small_creepages_give_the_forces_of_kalkers_linear_theory() {
    let [c11, c22, c23] = KalkerCoefficients::new(NU)
        .at(PATCH.along, PATCH.across)
        .map(|value| value[0]);
    let area = PATCH.along * PATCH.across;
    let tiny = 1e-9;
    // FASTSIM: error of its grid, 1/200² and the strips' ends; the others: τ/3 of the saturation.
    for (law, tolerance) in [(CreepLaw::Saturated, 1e-5), (CreepLaw::Polach, 1e-5), (FINE, 3e-4)] {
        let x = forces(law, creepage(tiny, 0.0, 0.0));
        assert!(
            (x[0] / (-G * area * c11 * tiny) - 1.0).abs() < tolerance && x[1].abs() < 1e-9 * x[0].abs(),
            "{x:?}"
        );
        let y = forces(law, creepage(0.0, tiny, 0.0));
        assert!(
            (y[1] / (-G * area * c22 * tiny) - 1.0).abs() < tolerance,
            "{law:?} {y:?}"
        );
        let spin = forces(law, creepage(0.0, 0.0, 100.0 * tiny));
        let linear = -G * area.powf(1.5) * c23 * 100.0 * tiny;
        assert!(
            (spin[1] / linear - 1.0).abs() < 10.0 * tolerance,
            "{law:?} {spin:?} {linear}"
        );
    }
}

#[test]
fn large_creepages_reach_the_friction_limit_and_oppose_the_sliding() {
    let limit = 0.3 * PATCH.normal_force;
    for (law, tolerance) in [(CreepLaw::Saturated, 1e-12), (CreepLaw::Polach, 1e-3), (FINE, 1e-3)] {
        let [x, y, _] = forces(law, creepage(0.4, -0.3, 0.0));
        // Polach's arc tangent ends as 1/ε², FASTSIM's grid takes part of the edge.
        assert!((x.hypot(y) / limit - 1.0).abs() < tolerance, "{law:?} {x} {y}");
        // The saturated linear theory keeps the direction of the linear force, FASTSIM that of its tractions near the
        // edge.
        let across = (0.6 * x + 0.8 * y) / limit;
        let most = if law == CreepLaw::Polach { tolerance } else { 0.05 };
        assert!(x < 0.0 && y > 0.0 && across.abs() < most, "{law:?} {across}");
    }
}

#[test]
fn fastsim_never_exceeds_the_friction_limit() {
    for i in 0..200 {
        let phase = f64::from(i);
        let creep = creepage(
            3e-3 * (1.3 * phase).sin(),
            3e-3 * (0.7 * phase).cos(),
            2.0 * (0.31 * phase).sin(),
        );
        let [x, y, _] = forces(COARSE, creep);
        assert!(x.hypot(y) <= 0.3 * PATCH.normal_force * 1.006); // the coarse grid's integral of the bound
    }
}

/// CONTACT's example `fastsim`: ξ_y = −6.25e-4, φ = 0.625/m. [eve70a/CONTACT, examples/fastsim.ref_out, cases 1, 2 and
/// 5]
#[test]
fn fastsim_departs_from_the_exact_theory_as_published() {
    let exact = -14_940.0;
    // 40 and 200 strips there; its error is of first order: the limit is a quarter of the difference further.
    let simplified = -15_640.0 + 0.25 * (-15_640.0 + 15_050.0);
    // From the flexibilities printed there, L₁ = 8a/(3 C₁₁ G) and so on, in mm³/N.
    let (a, b, g) = (8.0, 4.0, 82e3);
    let c11 = 8.0 * a / (3.0 * 0.4937e-4 * g);
    let c22 = 8.0 * a / (3.0 * 0.5152e-4 * g);
    let c23 = std::f64::consts::PI * a * f64::sqrt(a / b) / (4.0 * 0.4090e-4 * g);
    let fine = Fastsim {
        strips: 200,
        cells: 200,
    };
    let inputs = super::law::Inputs {
        creepage: [0.0, -6.25e-4, 0.625],
        along: PATCH.along,
        across: PATCH.across,
        limit: 0.3 * PATCH.normal_force,
        coefficients: [c11, c22, c23],
        shear_modulus: G,
    };
    let [x, y, _] = fine.forces(&inputs);
    // The extrapolation's second order.
    assert!((y / simplified - 1.0).abs() < 3e-3, "{y}");
    // Strips that mirror each other: rounding.
    assert!(x.abs() < 1e-6, "{x}");
    // Less than the largest error with spin [Kalker 1990, section 2.2.3].
    assert!((y / exact - 1.0).abs() < 0.07, "{y}");
    // Interpolation of the coefficients.
    let [_, interpolated, _] = forces(FINE, creepage(0.0, -6.25e-4, 0.625));
    assert!((interpolated / y - 1.0).abs() < 0.02, "{interpolated}");
    println!("FASTSIM {y:.0} N, CONTACT {exact} N, FASTSIM of CONTACT {simplified} N");
}

#[test]
fn the_laws_agree_to_the_accuracy_of_the_simplified_theory() {
    let limit = 0.3 * PATCH.normal_force;
    for i in 1..=20 {
        for angle in [0.0, 0.7, 1.57] {
            let size = 2e-4 * f64::from(i);
            let creep = creepage(size * f64::cos(angle), size * f64::sin(angle), 0.0);
            let reference = forces(FINE, creep);
            for law in [CreepLaw::Saturated, CreepLaw::Polach, COARSE] {
                let other = forces(law, creep);
                let difference = (other[0] - reference[0]).hypot(other[1] - reference[1]) / limit;
                assert!(difference < 0.05, "{law:?} {size} {angle}: {difference}"); // the error without spin, of μN
            }
        }
    }
}

#[test]
fn slopes_are_the_derivatives_of_the_forces() {
    let cases = [
        (creepage(3e-4, -2e-4, 0.1), PATCH),
        (creepage(-1e-3, 2.2e-3, -0.6), PATCH),
        (creepage(2e-5, 1e-5, 0.03), Patch { across: 9e-3, ..PATCH }),
    ];
    for law in [CreepLaw::Saturated, CreepLaw::Polach, COARSE] {
        let model = model(law);
        for (creep, patch) in &cases {
            let moved = |input: usize, by: f64| {
                let (mut creep, mut patch) = (*creep, *patch);
                match input {
                    0 => creep.longitudinal += by,
                    1 => creep.lateral += by,
                    2 => creep.spin += by,
                    3 => patch.along += by,
                    4 => patch.across += by,
                    _ => patch.normal_force += by,
                }
                model.force(&creep, &patch)
            };
            let exact = model.slopes(creep, patch);
            for (input, h) in [1e-9, 1e-9, 1e-6, 1e-9, 1e-9, 1e-2].into_iter().enumerate() {
                let (plus, minus) = (moved(input, h), moved(input, -h));
                for row in 0..3 {
                    let difference = (plus[row] - minus[row]) / (2.0 * h);
                    let scale = exact[0][input].abs() + exact[1][input].abs();
                    let lever = if row == 2 { 1e-2 } else { 1.0 };
                    // h² and rounding / h; a cell of FASTSIM that changes to sliding within h.
                    assert!(
                        (difference - exact[row][input]).abs() < 1e-5 * scale * lever,
                        "{law:?} {input} {row}: {difference} {exact:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_force_is_the_same_with_and_without_its_derivatives() {
    use super::dual::{Dual, Number};
    for law in [CreepLaw::Frictionless, CreepLaw::Saturated, CreepLaw::Polach, COARSE] {
        for creep in [
            creepage(3e-4, -2e-4, 0.1),
            creepage(-1e-3, 2.2e-3, -0.6),
            creepage(0.0, 0.0, 0.0),
        ] {
            let with: [Dual; 3] = model(law).forces(&creep, &PATCH);
            assert_eq!(forces(law, creep), with.map(Number::value), "{law:?}");
        }
    }
}
