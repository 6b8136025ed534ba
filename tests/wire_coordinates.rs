//! Independence of integrator and contact from the choice of a wire's coordinates.
use catenary::{
    AxialLaw, BendingLaw, ContactPair, ContactTangent, Enrichment, NodeMap, PenaltyContact, PrescribedStrip, WireCurve,
    WireGeometry, WireSection,
};
use dynamics::{NewtonOptions, StaticOptions, solve_static};
use integration_tests::single_wire::{Material, SingleWire, trapezoid};
use nalgebra::Vector3;
use std::sync::Arc;

const LENGTH: f64 = 60.0;
const ELEMENTS: usize = 4;
const TENSION: f64 = 2e4;
const BENDING_STIFFNESS: f64 = 195.0;
const STIFFNESS: f64 = 5e4;

/// A pinned wire of four long elements with a strip below; one unknown for the bending layer at mid-span if `layer`.
fn wire(per_node: usize, layer: bool) -> SingleWire {
    let material = Material {
        section: WireSection {
            axial_stiffness: 1.7e7,
            bending_stiffness: BENDING_STIFFNESS,
            mass_per_length: 1.35,
            tension: TENSION,
        },
        laws: (AxialLaw::Mean, BendingLaw::Constant),
        gravity: 0.0,
    };
    let lengths = [LENGTH / ELEMENTS as f64; ELEMENTS];
    let mut geometry = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &lengths, |node| match per_node {
        4 => NodeMap::planar(4 * node),
        _ => NodeMap::spatial(6 * node),
    });
    let mut coordinates = per_node * (ELEMENTS + 1);
    if layer {
        geometry = geometry.with_enrichments(vec![Enrichment {
            node: ELEMENTS / 2,
            index: coordinates,
            direction: Vector3::z(),
            bending_length: (BENDING_STIFFNESS / TENSION).sqrt(),
            reference: 0.0,
        }]);
        coordinates += 1;
    }
    let mut wire = SingleWire::new(&material, geometry, coordinates)
        .pinned(0)
        .pinned(ELEMENTS);
    let law = PenaltyContact {
        stiffness: STIFFNESS,
        damping: 0.0,
    };
    let curve: Arc<dyn WireCurve> = wire.geometry().clone();
    let strip = Box::new(PrescribedStrip { first: 0 });
    wire.contact = Some(ContactPair::new(law, curve, strip, 1.2, ContactTangent::RankOne));
    wire
}

/// Contact force of a strip raised by 0.01 mm under mid-span, N.
fn static_force(per_node: usize, layer: bool) -> f64 {
    let mut wire = wire(per_node, layer);
    let u = [0.5 * LENGTH, 0.0, 1e-5, 0.0, 0.0, 0.0, 0.0, 0.0];
    let mut state = wire.layout.state_at_rest();
    let mut options = StaticOptions::default();
    options.newton.tolerance = 1e-7;
    solve_static(&mut wire, &mut state, &u, &options).expect("an equilibrium");
    let contact = wire.contact.as_ref().expect("set above");
    contact.state(&state.motion(&u)).expect("on the wire").force
}

#[test]
fn the_layer_gives_the_contact_the_exact_flexibility_of_the_wire() {
    // Contact spring and pinned tensioned beam in series: 1/k + (L/4T)(1 − tanh(KL/2)/(KL/2)), K = √(T/EI).
    let half = 0.5 * LENGTH * (TENSION / BENDING_STIFFNESS).sqrt();
    let flexibility = 1.0 / STIFFNESS + LENGTH / (4.0 * TENSION) * (1.0 - half.tanh() / half);
    let exact = 1e-5 / flexibility;
    for per_node in [4, 6] {
        let layered = static_force(per_node, true) / exact - 1.0;
        let plain = static_force(per_node, false) / exact - 1.0;
        assert!(
            layered.abs() < 1e-5,
            "{per_node} coordinates per node, with the layer: {layered}"
        );
        assert!(plain > 1e-3, "{per_node} coordinates per node, without: {plain}");
    }
}

/// Contact forces, N, of a strip that runs under the wire and over the enriched node, and the largest layer unknown.
fn run(per_node: usize, layer: bool) -> (Vec<f64>, f64) {
    let mut wire = wire(per_node, layer);
    let (h, speed, rate) = (1e-3, 50.0, 0.05);
    let strip = |t: f64| [25.0 + speed * t, 0.0, rate * t, speed, 0.0, rate, 0.0, 0.0];
    let mut state = wire.layout.state_at_rest();
    let mut integrator = trapezoid(NewtonOptions::default().tolerance);
    let (mut forces, mut layer_peak) = (Vec::new(), 0.0_f64);
    for step in 1..=200_u32 {
        let t = f64::from(step) * h;
        integrator
            .step(&mut wire, &mut state, &strip(t), t, h)
            .expect("the wire moves on");
        let contact = wire.contact.as_ref().expect("set above");
        forces.push(contact.state(&state.motion(&strip(t))).expect("on the wire").force);
        if layer {
            layer_peak = layer_peak.max(state.q[state.q.len() - 1].abs());
        }
    }
    (forces, layer_peak)
}

#[test]
fn a_planar_wire_with_a_layer_steps_under_a_strip_like_a_spatial_one() {
    let (planar, peak) = run(4, true);
    let (spatial, _) = run(6, true);
    let largest = planar.iter().fold(0.0_f64, |a, &b| a.max(b));
    assert!(largest > 10.0 && peak > 1e-4, "force {largest} N, layer {peak}");
    for (step, (a, b)) in planar.iter().zip(&spatial).enumerate() {
        // Newton's tolerance of 1e-6 N in either run.
        assert!((a - b).abs() < 1e-4, "step {}: {a} and {b} N", step + 1);
    }
    let (plain, _) = run(4, false);
    let change = planar
        .iter()
        .zip(&plain)
        .fold(0.0_f64, |c, (a, b)| c.max((a - b).abs()));
    assert!(
        change > 1e-2 * largest,
        "the layer changes the force by {change} N only"
    );
}
