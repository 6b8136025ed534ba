use super::*;
use crate::{Enrichment, NodeMap, Rayleigh, Wire, WireGeometry, WireNode, WireSection};
use ancf::{AxialLaw, BendingLaw, Cable, Coordinates};
use dynamics::{Blocks, ByRange, Force, OnePass};
use std::collections::BTreeMap;
use std::sync::Arc;

/// More than one block of elements, and a last group that is not full.
const ELEMENTS: usize = 2 * BLOCK + 13;
const LAWS: [(AxialLaw, BendingLaw); 4] = [
    (AxialLaw::Mean, BendingLaw::Constant),
    (AxialLaw::Full, BendingLaw::Constant),
    (AxialLaw::Engineering, BendingLaw::Exact),
    (AxialLaw::Mean, BendingLaw::Exact),
];

/// Numbers in -1…1 that repeat in every run.
fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    (0..n)
        .map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1 << 30) - 1.0
        })
        .collect()
}

/// A sagging, staggered wire of uneven elements; `map` gives the coordinates of a node.
fn curved(stagger: f64, map: impl Fn(usize) -> NodeMap) -> WireGeometry {
    let lengths: Vec<f64> = (0..ELEMENTS).map(|i| 0.7 + 0.1 * (i % 5) as f64).collect();
    let mut x = 100.0;
    let nodes = (0..=ELEMENTS).map(|i| {
        let node = WireNode {
            position: Vector3::new(x, stagger * (0.1 * x).sin(), 5.3 + 0.3 * (0.2 * x).cos()),
            slope: Vector3::new(0.999, 0.1 * stagger * (0.1 * x).cos(), -0.06 * (0.2 * x).sin()),
            map: map(i),
        };
        x += lengths.get(i).copied().unwrap_or(0.0);
        node
    });
    WireGeometry::new(nodes.collect(), lengths.clone(), Vec::new())
}

/// Wires of all kinds, each with the number of its coordinates.
fn wires() -> Vec<(&'static str, WireGeometry, usize)> {
    let planar = curved(0.0, |node| NodeMap::planar(8 * node + 2));
    let spatial = curved(0.2, |node| NodeMap::spatial(13 * node));
    let held = curved(0.2, |node| NodeMap::planar(4 * node));
    let fixed = curved(0.2, |node| {
        let index = [0, 1, 2, 3, 4, 5].map(|i| Some(7 * node + 5 - i).filter(|_| (node + i) % 6 > 0));
        NodeMap::new(index)
    });
    let layered = curved(0.2, |node| NodeMap::spatial(6 * node));
    let first = 6 * (ELEMENTS + 1);
    let layers = (0..30).map(|i| Enrichment {
        node: 4 * (i / 2) + i % 2 + i / 8,
        index: first + i,
        direction: [Vector3::z(), Vector3::new(0.0, 0.6, 0.8)][i % 2],
        bending_length: 0.2,
        reference: 0.01 * i as f64,
    });
    let layered = layered.with_enrichments(layers.collect());
    vec![
        ("planar", planar, 8 * ELEMENTS + 10),
        ("spatial", spatial, 13 * ELEMENTS + 10),
        ("staggered, without lateral coordinates", held, 4 * ELEMENTS + 4),
        ("reversed and fixed coordinates", fixed, 7 * ELEMENTS + 7),
        ("layers", layered, first + 30),
    ]
}

const DAMPING: Rayleigh = Rayleigh { alpha: 0.3, beta: 2e-3 };

fn wire(geometry: &WireGeometry, laws: (AxialLaw, BendingLaw)) -> Wire {
    wire_with(DAMPING, geometry, laws)
}

fn wire_with(damping: Rayleigh, geometry: &WireGeometry, laws: (AxialLaw, BendingLaw)) -> Wire {
    let section = WireSection {
        axial_stiffness: 1.7e7,
        bending_stiffness: 195.0,
        mass_per_length: 1.35,
        tension: 2.0e4,
    };
    Wire::new(section, damping, laws, 9.81, Arc::new(geometry.clone())).with_mass_correction(1e-3)
}

/// Subtracts the product of the matrix that `add` puts into blocks with `values`.
fn subtract(add: &dyn Fn(&mut Blocks<'_>), values: &[f64], force: &mut [f64]) {
    for (row, column, entry) in Blocks::collect(add) {
        force[row as usize] -= entry * values[column as usize];
    }
}

/// Element by element: the strain by [`Cable`], all that is linear by the matrices that enter the tangent.
fn force_by_elements(wire: &Wire, laws: (AxialLaw, BendingLaw), [q, v, v_dot]: [&[f64]; 3]) -> Vec<f64> {
    let (geometry, section) = (wire.geometry(), wire.section());
    let (nodes, constants) = (geometry.nodes(), &wire.constants);
    let mut force = vec![0.0; q.len()];
    let section = CableSection::new(
        section.axial_stiffness,
        section.bending_stiffness,
        section.tension,
        laws,
    );
    for (i, &length) in geometry.lengths().iter().enumerate() {
        let (r1, r1_x) = nodes[i].map.gather(q);
        let (r2, r2_x) = nodes[i + 1].map.gather(q);
        let reference = Coordinates::from_columns(&geometry.strained_reference(i));
        let cable = Cable { section, length };
        let mut e = cable.force(&(reference + Coordinates::from_columns(&[r1, r1_x, r2, r2_x])));
        let (half, moment) = (
            0.5 * constants.weight * length,
            constants.weight * length * length / 12.0,
        );
        for (column, part) in [half, moment, half, -moment].into_iter().enumerate() {
            e[(2, column)] += part;
        }
        for axis in 0..3 {
            let (a, b) = (&nodes[i].map, &nodes[i + 1].map);
            for (column, index) in [a.position(axis), a.slope(axis), b.position(axis), b.slope(axis)]
                .iter()
                .enumerate()
            {
                if let Some(index) = index {
                    force[*index] -= e[(axis, column)];
                }
            }
        }
    }
    subtract(&|blocks| wire.add_constant(&constants.damping, blocks), v, &mut force);
    subtract(&|blocks| wire.add_mass(blocks), v_dot, &mut force);
    // Layers are linear in the absolute coordinates.
    let mut absolute = q.to_vec();
    for node in nodes {
        for axis in 0..3 {
            if let (Some(position), Some(slope)) = (node.map.position(axis), node.map.slope(axis)) {
                absolute[position] += node.position[axis];
                absolute[slope] += node.slope[axis];
            }
        }
    }
    for enrichment in geometry.enrichments() {
        absolute[enrichment.index] += enrichment.reference;
    }
    subtract(
        &|blocks| wire.layers.add_blocks(geometry, &constants.stiffness, blocks),
        &absolute,
        &mut force,
    );
    for enrichment in geometry.enrichments() {
        let zero = vec![0.0; q.len()];
        let mut unit = zero.clone();
        unit[enrichment.index] = 1.0;
        force[enrichment.index] -= constants.weight * wire.layers.weight_lift(&unit);
    }
    force
}

#[test]
fn batches_give_the_force_of_element_by_element_on_every_kind_of_register() {
    for (name, geometry, n) in wires() {
        for (laws, damping) in LAWS
            .into_iter()
            .flat_map(|laws| [(laws, DAMPING), (laws, Rayleigh::default())])
        {
            let mut wire = wire_with(damping, &geometry, laws);
            let q: Vec<f64> = noise(n, 1).iter().map(|value| 0.02 * value).collect();
            let (v, v_dot) = (
                noise(n, 2),
                noise(n, 3).iter().map(|value| 30.0 * value).collect::<Vec<f64>>(),
            );
            let motion = Motion {
                t: 0.0,
                q: &q,
                v: &v,
                rotation: &[],
                u: &[],
            };
            let expected = force_by_elements(&wire, laws, [&q, &v, &v_dot]);
            let scale = expected.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let compare = |force: &[f64], what: &str| {
                for (i, (a, b)) in force.iter().zip(&expected).enumerate() {
                    assert!(
                        (a - b).abs() < 1e-13 * scale,
                        "{name}, {laws:?}, {what}, {i}: {a} against {b}"
                    );
                }
            };
            let mut force = vec![0.0; n];
            wire.add_dynamic_force(&motion, &v_dot, &mut force);
            compare(&force, "widest registers");
            let mut scalar = vec![0.0; n];
            wire.layers.add_force(0..n, &motion, Some(&v_dot), &mut scalar);
            wire.batch
                .add_force_on(Arch::Scalar, 0..n, &motion, Some(&v_dot), &mut scalar);
            compare(&scalar, "one number at a time");
            #[cfg(target_arch = "x86_64")]
            if let Some(arch) = pulp::x86::V3::try_new() {
                let mut four = vec![0.0; n];
                wire.layers.add_force(0..n, &motion, Some(&v_dot), &mut four);
                wire.batch
                    .add_force_on(Arch::V3(arch), 0..n, &motion, Some(&v_dot), &mut four);
                compare(&four, "registers of four");
            }
        }
    }
}

#[test]
fn the_force_without_accelerations_is_the_dynamic_one_at_rest() {
    for (name, geometry, n) in wires() {
        let (q, v) = (vec![1e-3; n], noise(n, 5));
        let motion = Motion {
            t: 0.0,
            q: &q,
            v: &v,
            rotation: &[],
            u: &[],
        };
        for damping in [DAMPING, Rayleigh::default()] {
            let mut wire = wire_with(damping, &geometry, LAWS[0]);
            let (mut without, mut with) = (vec![0.0; n], vec![0.0; n]);
            wire.add_force(&motion, &mut without);
            wire.add_dynamic_force(&motion, &vec![0.0; n], &mut with);
            assert_eq!(without, with, "{name}, {damping:?}");
        }
    }
}

#[test]
fn a_wire_that_does_not_move_sideways_has_two_components() {
    let kinds: Vec<bool> = wires()
        .iter()
        .map(|(_, geometry, _)| matches!(wire(geometry, LAWS[0]).batch, Batch::Planar(_)))
        .collect();
    assert_eq!(kinds, [true, false, true, false, false]);
}

#[test]
fn a_range_of_coordinates_has_the_force_of_the_whole_evaluation() {
    for (name, geometry, n) in wires() {
        let mut wire = wire(&geometry, LAWS[0]);
        assert_eq!(
            wire.by_range().is_some(),
            ["planar", "spatial", "staggered, without lateral coordinates", "layers"].contains(&name),
            "{name}"
        );
        let q: Vec<f64> = noise(n, 1).iter().map(|value| 0.02 * value).collect();
        let (v, v_dot) = (noise(n, 2), noise(n, 3));
        let motion = Motion {
            t: 0.0,
            q: &q,
            v: &v,
            rotation: &[],
            u: &[],
        };
        let mut whole = vec![0.0; n];
        wire.add_dynamic_force(&motion, &v_dot, &mut whole);
        let scale = whole.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        for range in [
            0..1,
            0..n,
            n - 1..n,
            n - 31..n,
            n / 2..n / 2 + 1,
            n / 3..n / 2,
            400..531,
            7..7,
        ] {
            let mut part = vec![0.0; n];
            wire.add_dynamic_force_within(range.clone(), &motion, &v_dot, &mut part);
            for i in range.clone() {
                let error = (part[i] - whole[i]).abs();
                assert!(
                    error < 1e-14 * scale,
                    "{name}, {range:?}: {} against {} at {i}",
                    part[i],
                    whole[i]
                );
            }
        }
    }
}

/// Rows, columns and values of the blocks that `add` writes, summed.
fn entries(add: &dyn Fn(&mut Blocks<'_>)) -> BTreeMap<(u32, u32), f64> {
    let mut sums = BTreeMap::new();
    for (row, column, value) in Blocks::collect(add) {
        *sums.entry((row, column)).or_insert(0.0) += value;
    }
    sums
}

#[test]
fn batches_give_the_tangent_of_element_by_element() {
    for (name, geometry, n) in wires() {
        for laws in LAWS {
            let mut wire = wire(&geometry, laws);
            let (q, v) = (
                noise(n, 1).iter().map(|value| 0.02 * value).collect::<Vec<f64>>(),
                vec![0.0; n],
            );
            let motion = Motion {
                t: 0.0,
                q: &q,
                v: &v,
                rotation: &[],
                u: &[],
            };
            let weights = Weights { q: 0.9, v: 700.0 };
            let mass_weight = 3e5;
            let mut blocks = Vec::new();
            let mut batch = wire.batch.clone();
            let batched = batch.add_tangent(&motion, (weights, mass_weight), &mut Blocks::record(&mut blocks));
            assert_eq!(
                batched,
                laws == LAWS[0] && wire.by_range().is_some(),
                "{name}, {laws:?}"
            );
            if !batched {
                continue;
            }
            let of_batches = entries(&|blocks| {
                wire.batch.clone().add_tangent(&motion, (weights, mass_weight), blocks);
            });
            let rates = wire.constants.rates(weights.v, mass_weight);
            let expected = entries(&|blocks| wire.add_tangents_of_elements(&motion, weights.q, &rates, blocks));
            let scale = expected
                .values()
                .fold(0.0_f64, |largest, value| largest.max(value.abs()));
            assert_eq!(of_batches.len(), expected.len());
            for (place, value) in &expected {
                let error = (of_batches[place] - value).abs();
                assert!(
                    error < 1e-13 * scale,
                    "{name}, {laws:?}, {place:?}: {} against {value}",
                    of_batches[place]
                );
            }
        }
    }
}

fn moving<'a>(q: &'a [f64], v: &'a [f64]) -> Motion<'a> {
    Motion {
        t: 0.0,
        q,
        v,
        rotation: &[],
        u: &[],
    }
}

#[test]
fn a_linearised_wire_has_the_tangent_of_its_reference_everywhere() {
    for (name, geometry, n) in wires() {
        for laws in LAWS {
            let plain = wire(&geometry, laws);
            let Some(mut linear) = plain.linearised() else {
                assert!(laws != (AxialLaw::Mean, BendingLaw::Constant));
                continue;
            };
            let zero = vec![0.0; n];
            let (q, v, v_dot) = (noise(n, 1), noise(n, 2), noise(n, 3));
            let (mut expected, mut force) = (vec![0.0; n], vec![0.0; n]);
            linear.add_force(&moving(&zero, &zero), &mut expected);
            linear.add_dynamic_force(&moving(&q, &v), &v_dot, &mut force);
            let tangent = |q: f64, v: f64| {
                let (plain, zero) = (plain.clone(), zero.clone());
                move |blocks: &mut Blocks<'_>| {
                    plain
                        .clone()
                        .add_tangent(&moving(&zero, &zero), Weights { q, v }, blocks)
                }
            };
            subtract(&tangent(1.0, 0.0), &q, &mut expected);
            subtract(&tangent(0.0, 1.0), &v, &mut expected);
            subtract(&|blocks| plain.add_mass(blocks), &v_dot, &mut expected);
            let scale = expected.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            for (i, (a, b)) in force.iter().zip(&expected).enumerate() {
                assert!((a - b).abs() < 1e-12 * scale, "{name}, {laws:?}, {i}: {a} against {b}");
            }
            // The force is the gradient of the energy, a quadratic one: no truncation error.
            let energy = |size: f64| {
                let there: Vec<f64> = q.iter().map(|q| size * q).collect();
                linear.energy(&moving(&there, &zero))
            };
            let slope = (energy(1.0) - energy(-1.0)) / 2.0;
            let mut at_rest = vec![0.0; n];
            linear.clone().add_force(&moving(&zero, &zero), &mut at_rest);
            let work: f64 = at_rest.iter().zip(&q).map(|(f, q)| f * q).sum();
            assert!(
                (slope + work).abs() < 1e-9 * energy(1.0).abs(),
                "{name}: {slope} {work}"
            );
        }
    }
}
