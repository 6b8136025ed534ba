//! Published examples of ANCF cable elements; the data and their sources are in `tests/data/ancf`.
use catenary::{AxialLaw, BendingLaw, WireSection};
use dynamics::{StaticOptions, solve_static};
use integration_tests::single_wire::{Material, SingleWire, numbers, trapezoid};
use nalgebra::Vector3;

const CANTILEVER: &str = include_str!("data/ancf/ancf_cantilever_convergence.csv");
const PENDULUM: &str = include_str!("data/ancf/ancf_pendulum_reference.csv");
const ELASTICA: &str = include_str!("data/ancf/elastica_cantilever.csv");

/// The published element: engineering strain at five points, exact curvature at three.
const PUBLISHED: (AxialLaw, BendingLaw) = (AxialLaw::Engineering, BendingLaw::Exact);

/// Tip displacement (x, z) of a cantilever under a dead force downwards at its tip, raised in `steps`.
fn tip(material: &Material, length: f64, force: f64, elements: usize, steps: usize) -> (f64, f64) {
    let mut wire = SingleWire::planar(material, length, elements).clamped(0);
    let mut state = wire.layout.state_at_rest();
    wire = wire.loaded(length, Vector3::zeros());
    for step in 1..=steps {
        wire.loads[0].force.z = -force * step as f64 / steps as f64;
        let mut options = StaticOptions::default();
        options.newton.tolerance = 1e-9 * force + 1e-14 * material.section.axial_stiffness;
        solve_static(&mut wire, &mut state, &[], &options).expect("a cantilever has an equilibrium");
    }
    let r = wire.point(length, &state).r;
    (r.x - length, r.z)
}

fn large_deflection(elements: usize) -> (f64, f64) {
    let (length, ei) = (2.0, 1.725e6);
    let material = Material {
        section: WireSection {
            axial_stiffness: 2.07e9,
            bending_stiffness: ei,
            mass_per_length: 1.0,
            tension: 0.0,
        },
        laws: PUBLISHED,
        gravity: 0.0,
    };
    tip(&material, length, 3.0 * ei / (length * length), elements, 10)
}

#[test]
fn cantilever_tip_displacements_are_those_published_for_each_mesh() {
    for row in numbers(CANTILEVER, 3) {
        let (elements, x, z) = (row[0] as usize, row[1], row[2]);
        if elements > 64 {
            continue;
        }
        let (tip_x, tip_z) = large_deflection(elements);
        // Printed to 1e-11 m; the two programs differ by their Newton tolerances.
        assert!(
            (tip_x - x).abs() < 1e-8 && (tip_z - z).abs() < 1e-8,
            "{elements} elements: {tip_x}, {tip_z} m against {x}, {z} m"
        );
    }
}

#[test]
fn cantilever_converges_to_the_geometrically_exact_rod() {
    // The extensible rod's boundary-value solution, last line of the data file.
    let (exact_x, exact_z) = (-0.508_537_304_325_9, -1.207_239_854_549_8);
    let (tip_x, tip_z) = large_deflection(64);
    assert!(
        (tip_x - exact_x).abs() < 1e-6 && (tip_z - exact_z).abs() < 1e-6,
        "{tip_x}, {tip_z}"
    );
}

#[test]
fn pendulum_swings_as_published() {
    let length = 1.0;
    let material = Material {
        section: WireSection {
            axial_stiffness: 40.0,
            bending_stiffness: 7.957_747e-5,
            mass_per_length: 0.008,
            tension: 0.0,
        },
        laws: PUBLISHED,
        gravity: 9.81,
    };
    // The source's axes (x, y up, z) are (x, z, −y) here.
    let mut wire = SingleWire::spatial(&material, length, 32).pinned(0);
    let mut state = wire.layout.state_at_rest();
    let geometry = wire.geometry().clone();
    for (i, node) in geometry.nodes().iter().enumerate() {
        state.v[node.map.position(1).expect("spatial")] = 4.0 * geometry.node_s(i);
        state.v[node.map.slope(1).expect("spatial")] = 4.0;
    }
    let mut integrator = trapezoid(1e-9);
    integrator
        .start_accelerations(&mut wire, &mut state, &[])
        .expect("consistent start");
    let h = 1e-4;
    let mut step = 0_u32;
    for row in numbers(PENDULUM, 8) {
        while f64::from(step) * h < row[0] - 0.5 * h {
            step += 1;
            integrator
                .step(&mut wire, &mut state, &[], f64::from(step) * h, h)
                .expect("the pendulum swings on");
        }
        for (s, expected) in [(0.5 * length, &row[1..4]), (length, &row[4..7])] {
            let r = wire.point(s, &state).r;
            let error = (r - Vector3::new(expected[0], -expected[2], expected[1])).norm();

            assert!(error < 2e-4, "t = {} s, s = {s} m: {error} m", row[0]);
        }
    }
}

/// A quasi-inextensible cantilever (EA = 1e7 EI/L²) with the laws that lines use; load `alpha` = P L²/EI.
fn elastica(alpha: f64, elements: usize) -> (f64, f64) {
    let material = Material {
        section: WireSection {
            axial_stiffness: 1e7,
            bending_stiffness: 1.0,
            mass_per_length: 1.0,
            tension: 0.0,
        },
        laws: (AxialLaw::Mean, BendingLaw::Constant),
        gravity: 0.0,
    };
    tip(&material, 1.0, alpha, elements, 10)
}

#[test]
fn elastica_tip_displacements_are_those_of_the_elliptic_integrals() {
    let rows = numbers(ELASTICA, 4);
    assert_eq!(rows.len(), 12);
    for row in rows {
        let (alpha, deflection, shortening) = (row[0], row[2], row[3]);
        let (x, z) = elastica(alpha, 32);
        // 32 elements: 3e-6 at the largest load, of which half is the elongation left.
        assert!(
            (x + shortening).abs() < 5e-6 && (z + deflection).abs() < 5e-6,
            "P L²/EI = {alpha}: {x}, {z}"
        );
    }
}

#[test]
fn elastica_error_falls_with_the_fourth_power_of_the_element_length() {
    let fine = elastica(2.0, 64);
    let error = |elements: usize| {
        let coarse = elastica(2.0, elements);
        (coarse.0 - fine.0).hypot(coarse.1 - fine.1)
    };
    let order = (error(8) / error(16)).log2();
    assert!((3.8..4.6).contains(&order), "order {order}");
}
