//! Force and tangent of a wire of 360 elements, as many as both wires of the thesis line have.
mod floor;

use catenary::{AxialLaw, BendingLaw, NodeMap, Rayleigh, Wire, WireGeometry, WireSection};
use criterion::{Criterion, criterion_group, criterion_main};
use dynamics::{Blocks, Force, Motion, OnePass, Weights};
use floor::{Floors, measure, settings};
use nalgebra::Vector3;
use std::hint::black_box;
use std::sync::Arc;

const ELEMENTS: usize = 360;

fn wire(laws: (AxialLaw, BendingLaw), planar: bool) -> Wire {
    let geometry = WireGeometry::straight(Vector3::z(), Vector3::x(), &[1.0; ELEMENTS], |node| {
        if planar {
            NodeMap::planar(4 * node)
        } else {
            NodeMap::spatial(6 * node)
        }
    });
    let section = WireSection {
        axial_stiffness: 1.7e7,
        bending_stiffness: 195.0,
        mass_per_length: 1.35,
        tension: 2e4,
    };
    let damping = Rayleigh {
        alpha: 0.0125,
        beta: 1e-4,
    };
    Wire::new(section, damping, laws, 9.81, Arc::new(geometry))
}

fn element(criterion: &mut Criterion) {
    let floors = Floors::here();
    let default = (AxialLaw::Mean, BendingLaw::Constant);
    for (name, laws, planar) in [
        ("mean, constant", default, false),
        ("mean, constant, planar", default, true),
        ("full, constant", (AxialLaw::Full, BendingLaw::Constant), false),
        ("engineering, exact", (AxialLaw::Engineering, BendingLaw::Exact), false),
    ] {
        let mut wire = wire(laws, planar);
        let n = 6 * (ELEMENTS + 1);
        let wave = |size: f64, phase: f64| -> Vec<f64> { (0..n).map(|i| size * (i as f64 + phase).sin()).collect() };
        let (q, v, v_dot) = (wave(1e-3, 0.0), wave(1e-2, 1.0), wave(1.0, 2.0));
        let motion = Motion {
            t: 0.0,
            q: &q,
            v: &v,
            rotation: &[],
            u: &[],
        };
        let mut force = vec![0.0; n];
        let elements = ELEMENTS as f64;
        let mut floor = Some(elements * floors.force).filter(|_| laws == default);
        measure(criterion, &format!("force of 360 elements: {name}"), floor, || {
            wire.add_force(black_box(&motion), black_box(&mut force));
        });
        measure(
            criterion,
            &format!("force and inertia of 360 elements: {name}"),
            floor,
            || {
                wire.add_dynamic_force(black_box(&motion), black_box(&v_dot), black_box(&mut force));
            },
        );
        let mut places = Vec::new();
        let weights = Weights { q: 1.0, v: 1e3 };
        wire.add_tangent(&motion, weights, &mut Blocks::record(&mut places));
        let positions: Vec<u32> = (0..places.len() as u32).collect();
        let mut values = vec![0.0; places.len()];
        floor = Some(elements * floors.force_and_tangent).filter(|_| laws == default);
        measure(
            criterion,
            &format!("force and tangent of 360 elements: {name}"),
            floor,
            || {
                wire.add_force(black_box(&motion), black_box(&mut force));
                let mut blocks = Blocks::add_to(&positions, &mut values);
                wire.add_tangent(black_box(&motion), weights, &mut blocks);
            },
        );
    }
}

criterion_group! {
    name = benches;
    config = settings();
    targets = element
}
criterion_main!(benches);
