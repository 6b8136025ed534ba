use super::enrichment::{End, Layer, LayerIntegrals, Products, quadrature};
use super::*;
use crate::{CurveColumns, WireCurve};
use ancf::{AxialLaw, BendingLaw, bending_matrix, mass_matrix, tension_matrix};
use dynamics::testing::{LawTrio, assert_energy, assert_mass, plain_layout};
use dynamics::{Columns, Force, Marker, Motion, OnePass, State, Weights, dense};
use nalgebra::{DVector, Vector3, Vector4};
use std::sync::Arc;

const SECTION: WireSection = WireSection {
    axial_stiffness: 1.7e7,
    bending_stiffness: 195.0,
    mass_per_length: 1.35,
    tension: 2.0e4,
};
const LAWS: (AxialLaw, BendingLaw) = (AxialLaw::Mean, BendingLaw::Constant);
const DAMPING: Rayleigh = Rayleigh { alpha: 0.3, beta: 2e-3 };

fn motion<'a>(q: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion {
        t: 0.0,
        q,
        v,
        rotation: &[],
        u: &[],
    }
}

/// Uneven elements in space, far from the origin, two layers on one element, one of them lateral.
fn spatial() -> (Wire, usize) {
    let lengths = [2.0, 3.0, 2.5];
    let geometry = WireGeometry::straight(
        Vector3::new(1000.0, 0.3, 5.3),
        Vector3::new(1.0, 0.02, 0.01).normalize(),
        &lengths,
        |node| NodeMap::spatial(6 * node),
    );
    let enrichment = |node: usize, index: usize, direction: Vector3<f64>| Enrichment {
        node,
        index,
        direction,
        bending_length: 0.5,
        reference: 0.01,
    };
    let geometry = geometry.with_enrichments(vec![
        enrichment(1, 24, Vector3::z()),
        enrichment(1, 25, Vector3::y()),
        enrichment(2, 26, Vector3::new(0.0, 0.6, 0.8)),
    ]);
    (Wire::new(SECTION, DAMPING, LAWS, 9.81, Arc::new(geometry)), 27)
}

/// The wire of `spatial` in the plane: four coordinates per node and one layer.
fn planar() -> (Wire, usize) {
    let geometry = WireGeometry::straight(Vector3::z() * 5.3, Vector3::x(), &[2.0, 3.0, 2.5], |node| {
        NodeMap::planar(4 * node)
    });
    let geometry = geometry.with_enrichments(vec![Enrichment {
        node: 2,
        index: 16,
        direction: Vector3::z(),
        bending_length: 0.2,
        reference: 0.0,
    }]);
    (Wire::new(SECTION, DAMPING, LAWS, 9.81, Arc::new(geometry)), 17)
}

fn wave(n: usize, amplitude: f64, phase: f64) -> Vec<f64> {
    (0..n).map(|i| amplitude * (1.7 * i as f64 + phase).sin()).collect()
}

/// A state of a wire that is bent and moves.
fn bent(n: usize) -> State {
    let mut state = State::at_rest(n, 0, Vec::new());
    (state.q, state.v) = (wave(n, 0.02, 0.4), wave(n, 0.5, 1.0));
    state
}

#[test]
fn the_force_at_rest_is_minus_the_gradient_of_the_energy() {
    for (mut wire, n) in [spatial(), planar()] {
        assert_energy(&mut wire, &plain_layout(n), &bent(n));
    }
}

#[test]
fn the_tangent_is_minus_the_jacobian_of_the_force() {
    let trio = LawTrio {
        q_step: 1e-6,
        v_step: 3e-4,
        tolerance: 1e-6,
    };
    for (mut wire, n) in [spatial(), planar()] {
        let state = bent(n);
        let weights = Weights { q: 1.0, v: 300.0 };
        let tangent = dense(n, &mut |blocks| wire.add_tangent(&state.motion(&[]), weights, blocks));
        let mass = dense(n, &mut |blocks| wire.add_mass(blocks));
        let both = dense(n, &mut |blocks| {
            wire.add_dynamic_tangent(&state.motion(&[]), weights, 2e5, blocks)
        });
        let sum = &tangent + mass * 2e5;
        assert!((&both - &sum).amax() < 1e-12 * sum.amax());
        trio.assert_tangent(&mut wire, &plain_layout(n), &state, &[]);
    }
}

#[test]
fn the_mass_is_symmetric_and_sums_to_the_total_mass() {
    for (wire, n) in [spatial(), planar()] {
        let mass = dense(n, &mut |blocks| wire.add_mass(blocks));
        assert_mass(&wire, n);
        for axis in 0..3 {
            let mut shift = DVector::zeros(n);
            for node in wire.geometry().nodes() {
                if let Some(index) = node.map.position(axis) {
                    shift[index] = 1.0;
                }
            }
            if shift.amax() > 0.0 {
                let total = shift.dot(&(&mass * &shift));
                assert!((total - 1.35 * 7.5).abs() < 1e-12);
            }
        }
        assert!(mass.cholesky().is_some());
    }
}

#[test]
fn damping_is_the_weighted_sum_of_mass_and_static_transverse_tangent() {
    for (mut wire, n) in [spatial(), planar()] {
        let zero = vec![0.0; n];
        let v = wave(n, 1.0, 0.2);
        let (mut still, mut moving) = (vec![0.0; n], vec![0.0; n]);
        wire.add_force(&motion(&zero, &zero), &mut still);
        wire.add_force(&motion(&zero, &v), &mut moving);
        let force = DVector::from_vec(still) - DVector::from_vec(moving);
        let mass = dense(n, &mut |blocks| wire.add_mass(blocks));
        let static_part = dense(n, &mut |blocks| wire.add_constant(&wire.constants.stiffness, blocks));
        let expected = (mass * DAMPING.alpha + static_part * DAMPING.beta) * DVector::from_vec(v);
        assert!((force - &expected).amax() < 1e-10 * expected.amax());
    }
}

#[test]
fn the_correction_takes_the_tension_matrix_off_the_inertia_only() {
    let (wire, n) = spatial();
    let h = 1e-3;
    let mass = dense(n, &mut |blocks| wire.add_mass(blocks));
    let tension = Products {
        mass: 0.0,
        tension: SECTION.tension,
        bending: 0.0,
    };
    let stiffness = dense(n, &mut |blocks| wire.add_constant(&tension, blocks));
    let mut corrected = wire.clone().with_mass_correction(h);
    let difference = dense(n, &mut |blocks| corrected.add_mass(blocks)) - mass + stiffness * (h * h / 6.0);
    assert!(difference.amax() < 1e-14);
    let (q, v) = (wave(n, 0.01, 0.0), wave(n, 1.0, 1.0));
    let (mut a, mut b) = (vec![0.0; n], vec![0.0; n]);
    wire.clone().add_force(&motion(&q, &v), &mut a);
    corrected.add_force(&motion(&q, &v), &mut b);
    assert_eq!(a, b);
}

/// Ends as of a wire under tensioning weights. The bound of scenes, 0.25, lies below it.
#[test]
fn the_corrected_mass_of_a_wire_with_free_ends_is_positive_up_to_a_quarter_of_a_waves_travelling_time() {
    let (length, elements) = (0.625, 40);
    let start = Vector3::new(0.0, 0.0, 5.3);
    let geometry = WireGeometry::straight(start, Vector3::x(), &vec![length; elements], |node| {
        NodeMap::spatial(6 * node)
    });
    let wire = Wire::new(SECTION, DAMPING, LAWS, 9.81, Arc::new(geometry));
    let least = |share: f64| {
        let h = share * length / (SECTION.tension / SECTION.mass_per_length).sqrt();
        let corrected = wire.clone().with_mass_correction(h);
        let mass = dense(6 * (elements + 1), &mut |blocks| corrected.add_mass(blocks));
        mass.symmetric_eigenvalues().min()
    };
    assert!(least(0.256) > 0.0);
    assert!(least(0.257) < 0.0);
}

#[test]
fn a_straight_wire_at_nominal_tension_feels_only_its_weight() {
    let (_, n) = spatial();
    let geometry = WireGeometry::straight(
        Vector3::new(1000.0, 0.0, 5.3),
        Vector3::new(0.8, 0.6, 0.0),
        &[2.0, 3.0, 2.5],
        |node| NodeMap::spatial(6 * node),
    );
    let mut wire = Wire::new(SECTION, DAMPING, LAWS, 9.81, Arc::new(geometry));
    let zero = vec![0.0; n];
    let mut force = vec![0.0; n];
    wire.add_force(&motion(&zero, &zero), &mut force);
    let vertical: f64 = (0..4).map(|node| force[6 * node + 2]).sum();
    assert!((vertical + 1.35 * 9.81 * 7.5).abs() < 1e-12);
    // Interior nodes: tension cancels to EA times the rounding of the reference (1e-13 m at x = 1000 m) over 2 m.
    let rounding = 1e-5;
    for node in 1..3 {
        assert!(force[6 * node].abs() < rounding && force[6 * node + 1].abs() < rounding);
    }
    assert!((force[18] + 0.8 * SECTION.tension).abs() < rounding);
    assert!((wire.tension(1, &zero) - SECTION.tension).abs() < rounding);
}

#[test]
fn a_new_reference_leaves_force_and_energy_of_strain_as_they_were() {
    let (mut wire, n) = spatial();
    let (q, rest) = (wave(n, 0.02, 0.4), vec![0.0; n]);
    let mut moved = wire.with_geometry(Arc::new(wire.geometry().with_reference(&q)));
    let (mut before, mut after) = (vec![0.0; n], vec![0.0; n]);
    wire.add_force(&motion(&q, &rest), &mut before);
    moved.add_force(&motion(&rest, &rest), &mut after);
    for (a, b) in before.iter().zip(&after) {
        assert!((a - b).abs() < 1e-5, "{a} against {b}"); // rounding at x = 1000 m, times EA/L
    }
    let (a, b) = (wire.strain_energy(&q), moved.strain_energy(&rest));
    assert!((a - b).abs() < 1e-9 * a);
    let (a, b) = (
        wire.geometry().point(3.3, &q, &rest),
        moved.geometry().point(3.3, &rest, &rest),
    );
    assert!((a.r - b.r).norm() < 1e-12);
}

#[test]
fn points_are_exact_at_nodes_and_columns_are_their_derivatives() {
    for (wire, n) in [spatial(), planar()] {
        let geometry = wire.geometry();
        let (q, v) = (wave(n, 0.02, 0.4), wave(n, 0.5, 1.0));
        for (i, node) in geometry.nodes().iter().enumerate() {
            let point = geometry.point(geometry.node_s(i), &q, &v);
            assert!((point.r - node.at(&q).0).norm() < 1e-12);
            assert!((point.r_s - node.at(&q).1).norm() < 1e-12);
        }
        for s in [0.0, 0.7, 1.9, 2.0, 4.4, 5.0, 6.1, 7.5] {
            let point = geometry.point(s, &q, &v);
            let base = geometry.point(s, &vec![0.0; n], &v);
            let mut columns = CurveColumns::default();
            geometry.columns(s, &mut columns);
            let (mut r, mut r_s, mut velocity, mut velocity_s) = (base.r, base.r_s, Vector3::zeros(), Vector3::zeros());
            for column in columns.as_slice() {
                r += column.n * q[column.index];
                r_s += column.n_s * q[column.index];
                velocity += column.n * v[column.index];
                velocity_s += column.n_s * v[column.index];
            }
            assert!(
                (r - point.r).norm() < 1e-12 && (r_s - point.r_s).norm() < 1e-12,
                "s = {s}"
            );
            assert!((velocity - point.velocity).norm() < 1e-12);
            assert!((velocity_s - point.velocity_s).norm() < 1e-12);
            if s > 0.0 && s < 7.0 && s != 2.0 && s != 5.0 {
                let h = 1e-5;
                let (a, b) = (geometry.point(s - h, &q, &v), geometry.point(s + h, &q, &v));
                assert!(((b.r - a.r) / (2.0 * h) - point.r_s).norm() < 1e-6);
                assert!(((b.r_s - a.r_s) / (2.0 * h) - point.r_ss).norm() < 1e-6);
                assert!(((b.velocity - a.velocity) / (2.0 * h) - point.velocity_s).norm() < 1e-6);
            }
        }
    }
}

/// The search among few elements finds what one among all does, on lines of any mesh.
#[test]
fn elements_are_found_among_any_others() {
    let even: Vec<f64> = (0..400).map(|node| 0.7 * f64::from(node)).collect();
    let graded: Vec<f64> = (0..400).map(|node| (0.01 * f64::from(node)).exp()).collect();
    for nodes in [even, graded, vec![0.0, 2.0], vec![-3.0, 1.0, 1.5, 90.0]] {
        let last = nodes.len() - 2;
        let between = nodes.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
        let beyond = [nodes[0] - 1e6, nodes[last + 1] + 1e6];
        for s in nodes.iter().copied().chain(between).chain(beyond) {
            let among_all = nodes[1..=last].iter().filter(|node| **node <= s).count();
            assert_eq!(element_between(&nodes, s), among_all, "{s}");
        }
    }
}

#[test]
fn the_border_belongs_to_the_element_that_starts_there() {
    let (wire, _) = spatial();
    let geometry = wire.geometry();
    assert_eq!(geometry.element_at(0.0), (0, 0.0));
    assert_eq!(geometry.element_at(2.0), (1, 0.0));
    assert_eq!(geometry.element_at(5.0), (2, 0.0));
    assert_eq!(geometry.element_at(7.5), (2, 2.5));
    assert_eq!(geometry.element_at(-0.5), (0, -0.5));
    assert_eq!(geometry.element_at(1.999_999).0, 0);
}

#[test]
fn a_point_at_a_node_moves_with_that_node_only() {
    for ((wire, n), count) in [(spatial(), 3), (planar(), 2)] {
        let (q, v) = (wave(n, 0.02, 0.4), wave(n, 0.5, 1.0));
        for node in 0..4 {
            let point = WirePoint::at_node(Arc::clone(wire.geometry()), node);
            let mut columns = Columns::default();
            point.columns(&motion(&q, &v), &mut columns);
            assert_eq!(columns.as_slice().len(), count, "node {node}");
            let frame = point.frame(&motion(&q, &v));
            let mut velocity = Vector3::zeros();
            for column in columns.as_slice() {
                velocity += column.translation * v[column.index];
                assert_eq!(column.rotation, Vector3::zeros());
            }
            assert!((velocity - frame.velocity).norm() < 1e-14);
        }
    }
}

#[test]
fn a_layer_in_an_even_field_has_its_closed_form_energy() {
    // ψ = E − H with EI E⁗ = T E″: ⟨E, H⟩ = ⟨E, E⟩ = T λ (1 − exp(−2 L/λ)), so ⟨ψ, ψ⟩ = ⟨H, H⟩ − ⟨E, E⟩ and
    // ⟨ψ, s⟩ = EI [E″ s′] − ⟨H, s⟩; integration by parts.
    for (length, layer) in [(6.0_f64, 0.1_f64), (1.0, 0.3), (0.5, 0.5)] {
        let (t, ei) = (1000.0, 1000.0 * layer * layer);
        let weights = Products {
            mass: 0.0,
            tension: t,
            bending: ei,
        };
        let k = tension_matrix(length) * t + bending_matrix(length) * ei;
        let far = (-length / layer).exp();
        let h = Vector4::new(layer, -1.0, layer * far, -far);
        let own = h.dot(&(k * h)) - t * layer * (1.0 - far * far);
        let coupling = Vector4::new(0.0, -ei / layer, 0.0, ei * far / layer) - k * h;
        let start = LayerIntegrals::new(End::Start, layer, length);
        assert!((start.own.weighted(&weights) / own - 1.0).abs() < 1e-9);
        assert!((start.shape.weighted(&weights) - coupling).amax() < 1e-9 * coupling.amax().max(t * layer));
        let finish = LayerIntegrals::new(End::Finish, layer, length);
        assert!((finish.own.weighted(&weights) / own - 1.0).abs() < 1e-9);
        assert!((finish.area / start.area - 1.0).abs() < 1e-9);
    }
}

#[test]
fn integrals_of_a_layer_in_closed_form_are_those_of_a_quadrature() {
    for end in [End::Start, End::Finish] {
        for (length, layer) in [(6.0_f64, 0.1_f64), (0.7, 0.1), (1.0, 0.3), (0.5, 0.5), (0.7, 0.0)] {
            let mut sum = LayerIntegrals::default();
            quadrature(layer, length, |at, w| {
                let Layer { psi, psi_x, psi_xx } = Layer::at(at, end, layer, length);
                sum.shape.mass += at.shape.s * (psi * w);
                sum.shape.tension += at.shape.s_x * (psi_x * w);
                sum.shape.bending += at.shape.s_xx * (psi_xx * w);
                sum.own.mass += psi * psi * w;
                sum.own.tension += psi_x * psi_x * w;
                sum.own.bending += psi_xx * psi_xx * w;
                sum.area += psi * w;
            });
            let found = LayerIntegrals::new(end, layer, length);
            let case = format!("{end:?}, {length} m, {layer} m");
            // Rounding is that of the interpolant, of which ψ is a small rest on a short element.
            let far = if layer > 0.0 { (-length / layer).exp() } else { 0.0 };
            let h = Vector4::new(layer, -1.0, layer * far, -far);
            let near = |a: f64, b: f64, size: f64| assert!((a - b).abs() < 1e-11 * size, "{case}: {a:e} {b:e}");
            for (found, sum, own, sum_own, matrix) in [
                (
                    found.shape.mass,
                    sum.shape.mass,
                    found.own.mass,
                    sum.own.mass,
                    mass_matrix(length),
                ),
                (
                    found.shape.tension,
                    sum.shape.tension,
                    found.own.tension,
                    sum.own.tension,
                    tension_matrix(length),
                ),
                (
                    found.shape.bending,
                    sum.shape.bending,
                    found.own.bending,
                    sum.own.bending,
                    bending_matrix(length),
                ),
            ] {
                let of_interpolant = matrix * h;
                (0..4).for_each(|i| near(found[i], sum[i], of_interpolant.amax()));
                near(own, sum_own, h.dot(&of_interpolant));
            }
            near(found.area, sum.area, length * (layer + length));
        }
    }
}

/// Deflection at the loaded node of a pinned beam of four elements under a mid-span force of 1 N, m.
fn mid_span_compliance(enriched: bool) -> f64 {
    let lengths = [15.0; 4];
    let mut geometry = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &lengths, |node| {
        NodeMap::planar(4 * node)
    });
    let n = if enriched { 21 } else { 20 };
    if enriched {
        geometry = geometry.with_enrichments(vec![Enrichment {
            node: 2,
            index: 20,
            direction: Vector3::z(),
            bending_length: (SECTION.bending_stiffness / SECTION.tension).sqrt(),
            reference: 0.0,
        }]);
    }
    let mut wire = Wire::new(SECTION, Rayleigh::default(), LAWS, 0.0, Arc::new(geometry));
    let zero = vec![0.0; n];
    let weights = Weights { q: 1.0, v: 0.0 };
    let mut k = dense(n, &mut |blocks| {
        wire.add_tangent(&motion(&zero, &zero), weights, blocks)
    });
    for fixed in [0, 1, 16, 17] {
        k.row_mut(fixed).fill(0.0);
        k.column_mut(fixed).fill(0.0);
        k[(fixed, fixed)] = 1.0;
    }
    let mut load = DVector::zeros(n);
    load[9] = 1.0;
    let q = k.lu().solve(&load).expect("a pinned wire is stable");
    wire.geometry().point(30.0, q.as_slice(), &zero).r.z
}

#[test]
fn with_its_layer_a_coarse_mesh_answers_a_point_force_exactly() {
    // Pinned tensioned beam, point force at mid-span: (P L/4T)(1 − tanh(kL/2)/(kL/2)), k = √(T/EI).
    let (l, t): (f64, f64) = (60.0, SECTION.tension);
    let half = 0.5 * l * (t / SECTION.bending_stiffness).sqrt();
    let exact = l / (4.0 * t) * (1.0 - half.tanh() / half);
    let plain = mid_span_compliance(false) / exact - 1.0;
    let layered = mid_span_compliance(true) / exact - 1.0;
    assert!(layered.abs() < 1e-6, "with the layer: {layered}");
    assert!(plain < -1e-3, "without it, elements of 15 m must be too stiff: {plain}");
}
