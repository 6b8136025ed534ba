//! Wires against closed forms. The formulas and the sources of the numbers are in `tests/data/analytic`.
use catenary::{AxialLaw, BendingLaw, NodeMap, WireGeometry, WireNode, WireSection};
use dynamics::{GeneralizedAlpha, State};
use integration_tests::single_wire::{Foundation, Load, Material, SingleWire, trapezoid};
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::sync::Arc;

const CASES: &str = include_str!("data/analytic/analytic_cases.csv");

/// Newton tolerance of the dynamic cases, N: above `EA` times the rounding of a strain, which is some 1e-8 N.
const ROUNDING: f64 = 1e-7;

/// The number of one line of the data file.
fn case(name: &str, parameters: &str, quantity: &str) -> f64 {
    let key = format!("{name},{parameters},{quantity},");
    let line = CASES.lines().find(|line| line.starts_with(&key));
    let value = line.and_then(|line| line[key.len()..].split(',').next());
    value
        .and_then(|value| value.parse().ok())
        .unwrap_or_else(|| panic!("no case {key}"))
}

fn wire(tension: f64, mass_per_length: f64, bending_stiffness: f64, gravity: f64) -> Material {
    Material {
        section: WireSection {
            axial_stiffness: 850.0 * tension,
            bending_stiffness,
            mass_per_length,
            tension,
        },
        laws: (AxialLaw::Mean, BendingLaw::Constant),
        gravity,
    }
}

fn assert_close(value: f64, expected: f64, relative: f64, what: &str) {
    assert!(
        (value - expected).abs() <= relative * expected.abs(),
        "{what}: {value} against {expected}"
    );
}

fn advance(system: &mut SingleWire, integrator: &mut GeneralizedAlpha, state: &mut State, steps: usize, h: f64) {
    let start = state.t;
    for step in 1..=steps {
        integrator
            .step(system, state, &[], start + step as f64 * h, h)
            .expect("the wire moves on");
    }
}

#[test]
fn a_pulse_travels_at_the_wave_speed() {
    for (tension, parameters) in [(2e4, "T=20000 m=1.35"), (2.2e4, "T=22000 m=1.35")] {
        let c = case("wave speed", parameters, "c");
        let mut wire = SingleWire::planar(&wire(tension, 1.35, 0.0, 0.0), 200.0, 400)
            .pinned(0)
            .pinned(400);
        let mut state = wire.layout.state_at_rest();
        let (center, width, height) = (50.0, 3.0, 1e-3);
        // A pulse that travels to the right: ẇ = −c w_s.
        wire.displace(&mut state, |s| {
            let x = (s - center) / width;
            let w = height * (-0.5 * x * x).exp();
            let (w_s, w_ss) = (-x / width * w, (x * x - 1.0) / (width * width) * w);
            [w, w_s, -c * w_s, -c * w_ss]
        });
        let mut integrator = trapezoid(ROUNDING);
        integrator
            .start_accelerations(&mut wire, &mut state, &[])
            .expect("consistent start");
        let h = 1e-3;
        advance(&mut wire, &mut integrator, &mut state, 800, h);
        let crest = (0..40_000)
            .map(|i| 5e-3 * f64::from(i))
            .max_by(|a, b| wire.point(*a, &state).r.z.total_cmp(&wire.point(*b, &state).r.z))
            .expect("there are points");
        assert_close((crest - center) / state.t, c, 1e-3, "wave speed");
        assert_close(wire.point(crest, &state).r.z, height, 0.01, "height of the crest");
    }
}

#[test]
fn pinned_and_clamped_wires_have_their_natural_frequencies() {
    let en = |length| (length, 2e4, 1.35, 195.0);
    let sharp = (1.0, 1000.0, 1.0, 10.0);
    let text = |(l, t, m, ei): (f64, f64, f64, f64)| format!("L={l} T={t} m={m} EI={ei}");
    // Elements are chosen so that the bending layer of 0.1 m is resolved where it counts.
    let pinned = [
        (en(60.0), 60, vec![1, 10, 20]),
        ((55.0, 2.2e4, 1.35, 195.0), 55, vec![1, 10, 20]),
        (en(6.5), 8, vec![1]),
        (sharp, 16, vec![1, 2, 3]),
    ];
    let clamped = [
        (en(60.0), 180, vec![1]),
        (en(6.5), 32, vec![1]),
        (sharp, 16, vec![1, 2]),
    ];
    for (name, list) in [
        ("pinned tensioned beam", &pinned[..]),
        ("clamped tensioned beam", &clamped[..]),
    ] {
        for (parameters, elements, modes) in list {
            let (length, tension, mass, bending) = *parameters;
            let mut system = SingleWire::planar(&wire(tension, mass, bending, 0.0), length, *elements);
            for node in [0, *elements] {
                system = system.pinned(node);
                if name.starts_with("clamped") {
                    system = system.guided(node);
                }
            }
            let state = system.layout.state_at_rest();
            let frequencies = system.frequencies(&state);
            for mode in modes {
                let quantity = format!("f{mode}");
                let expected = case(name, &text(*parameters), &quantity);
                assert_close(
                    frequencies[mode - 1],
                    expected,
                    3e-4,
                    &format!("{name}, {parameters:?}, {quantity}"),
                );
            }
        }
    }
}

/// A wire between supports at one height, its right end pulled by the constant horizontal force of its tension.
fn tensioned(material: &Material, length: f64, elements: usize) -> SingleWire {
    SingleWire::planar(material, length, elements)
        .pinned(0)
        .supported(elements)
        .loaded(length, Vector3::x() * material.section.tension)
}

#[test]
fn wires_sag_under_their_weight() {
    for (length, elements) in [(60.0, 180), (6.5, 32)] {
        let parameters = format!("L={length} T=20000 m=1.35 EI=195");
        for (name, clamped) in [("uniform sag pinned", false), ("uniform sag clamped", true)] {
            let mut system = tensioned(&wire(2e4, 1.35, 195.0, 9.81), length, elements);
            if clamped {
                system = system.guided(0).guided(elements);
            }
            let state = system.equilibrium();
            let sag = -system.point(0.5 * length, &state).r.z;
            assert_close(sag, case(name, &parameters, "mid sag"), 1e-3, name);
        }
        let mut system = tensioned(&wire(2e4, 1.35, 0.0, 9.81), length, elements);
        let state = system.equilibrium();
        let sag = -system.point(0.5 * length, &state).r.z;
        let expected = case("uniform sag string", &format!("L={length} T=20000 m=1.35"), "mid sag");
        assert_close(sag, expected, 1e-3, "uniform sag string");
    }
}

#[test]
fn a_point_force_at_mid_span_lifts_a_pinned_wire() {
    let name = "mid-span point compliance pinned";
    for (length, tension, bending, elements) in
        [(60.0, 2e4, 195.0, 240), (55.0, 2.2e4, 195.0, 220), (1.0, 1e3, 10.0, 16)]
    {
        let parameters = format!("L={length} T={tension} EI={bending}");
        let mut system =
            tensioned(&wire(tension, 1.0, bending, 0.0), length, elements).loaded(0.5 * length, Vector3::z());
        let state = system.equilibrium();
        let lift = system.point(0.5 * length, &state).r.z;
        assert_close(lift, case(name, &parameters, "w/P"), 1e-3, name);
    }
}

#[test]
fn a_hanging_cable_takes_the_catenary_shape() {
    // Elastic catenary between level supports, s the unstressed length from the lowest point, w the weight per s, H the
    // horizontal force (catenary with elastic elongation added):
    // x = H s/EA + (H/w) asinh(w s/H),  z = w s²/2EA + (H/w) (√(1 + (w s/H)²) − 1)
    let (span, length, mass, gravity): (f64, f64, f64, f64) = (50.0, 52.0, 1.35, 9.81);
    let w = mass * gravity;
    // The start is a parabola of the same span and length to second order.
    let elements = 40;
    let sag = (3.0 * span * (length - span) / 8.0).sqrt();
    let nodes = (0..=elements)
        .map(|i| {
            let xi = i as f64 / elements as f64;
            let slope = Vector3::new(1.0, 0.0, 4.0 * sag / span * (2.0 * xi - 1.0));
            WireNode {
                position: Vector3::new(span * xi, 0.0, -4.0 * sag * xi * (1.0 - xi)),
                slope: slope.normalize(),
                map: NodeMap::planar(4 * i),
            }
        })
        .collect();
    let geometry = WireGeometry::new(nodes, vec![length / elements as f64; elements], Vec::new());
    // A Hookean wire that stretches by thousandths, to the accuracy of its elements; and the law of lines, which is
    // Hookean for the small strains of a stiff wire.
    for (law, ea, tolerance) in [(AxialLaw::Engineering, 1e5, 1e-6), (AxialLaw::Mean, 1e7, 1e-4)] {
        let x = |h: f64, s: f64| h * s / ea + h / w * (w * s / h).asinh();
        let z = |h: f64, s: f64| w * s * s / (2.0 * ea) + h / w * ((1.0 + (w * s / h).powi(2)).sqrt() - 1.0);
        let (mut low, mut high) = (1.0, 1e5);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let side = if x(middle, 0.5 * length) < 0.5 * span {
                &mut low
            } else {
                &mut high
            };
            *side = middle;
        }
        let h = 0.5 * (low + high);
        let material = Material {
            section: WireSection {
                axial_stiffness: ea,
                bending_stiffness: 0.0,
                mass_per_length: mass,
                tension: 0.0,
            },
            laws: (law, BendingLaw::Constant),
            gravity,
        };
        let coordinates = 4 * (elements + 1);
        let mut cable = SingleWire::new(&material, geometry.clone(), coordinates)
            .pinned(0)
            .pinned(elements);
        let state = cable.equilibrium();
        for i in 0..=elements {
            let s = length * i as f64 / elements as f64;
            let (from_middle, r) = (s - 0.5 * length, cable.point(s, &state).r);
            let exact = Vector3::new(
                0.5 * span + x(h, from_middle),
                0.0,
                z(h, from_middle) - z(h, 0.5 * length),
            );
            assert!((r - exact).norm() < tolerance, "{law:?}, node {i}: {r} against {exact}");
        }
        let tension = cable.wire.tension(elements / 2, &state.q);
        assert_close(tension, h, 1e-3, "horizontal tension");
    }
}

#[test]
fn a_force_that_crosses_a_string_lifts_it_as_the_series_says() {
    let name = "moving load on string";
    let c = case("wave speed", "T=20000 m=1.35", "c");
    for (speed, text) in [
        (0.5 * c, "v/c=0.5"),
        (250.0 / 3.6, "v=250 km/h"),
        (300.0 / 3.6, "v=300 km/h"),
    ] {
        // 1 N for 100 N: the closed form is linear, and so is a wire that rises by a millimetre.
        let mut system = SingleWire::planar(&wire(2e4, 1.35, 0.0, 0.0), 60.0, 240)
            .pinned(0)
            .pinned(240);
        let geometry = Arc::clone(system.geometry());
        system.loads.push(Load {
            geometry,
            force: Vector3::z(),
            start: 0.0,
            speed,
        });
        let mut state = system.layout.state_at_rest();
        let mut integrator = trapezoid(ROUNDING);
        let h = 15.0 / speed / 300.0;
        for (steps, place) in [(600, "L/2"), (300, "3L/4")] {
            advance(&mut system, &mut integrator, &mut state, steps, h);
            let lift = 100.0 * system.point(system.loads[0].s(state.t), &state).r.z;
            let expected = case(
                name,
                &format!("L=60 T=20000 m=1.35 P=100 {text}"),
                &format!("w under load at {place}"),
            );
            assert_close(lift, expected, 5e-3, &format!("{name}, {text}, {place}"));
        }
    }
}

#[test]
fn a_steady_force_keeps_its_trough_on_an_elastic_foundation() {
    // w = P/(2√(k T (1 − a²))) exp(−|x − v t| √(k/T(1 − a²))) is set at the start and must travel on.
    let (tension, stiffness) = (2e4, 1e3);
    let c = case("wave speed", "T=20000 m=1.35", "c");
    for ratio in [0.0, 0.5, 0.7] {
        let expected = case(
            "moving load on Winkler string",
            &format!("k=1000 T=20000 P=100 v/c={ratio}"),
            "w under load",
        );
        let material = wire(tension, 1.35, 0.0, 0.0);
        let mut system = SingleWire::planar(&material, 100.0, 800).pinned(0).pinned(800);
        let geometry = Arc::clone(system.geometry());
        let (start, speed) = (30.0, ratio * c);
        system.foundation = Some(Foundation {
            geometry: Arc::clone(&geometry),
            stiffness,
        });
        system.loads.push(Load {
            geometry,
            force: Vector3::z(),
            start,
            speed,
        });
        let decay = (stiffness / (tension * (1.0 - ratio * ratio))).sqrt();
        let mut state = system.layout.state_at_rest();
        if ratio == 0.0 {
            system.settle(&mut state);
        } else {
            system.displace(&mut state, |s| {
                let (side, w) = (
                    (s - start).signum(),
                    0.01 * expected * (-(s - start).abs() * decay).exp(),
                );
                let side = if s == start { 0.0 } else { side };
                let w_s = -side * decay * w;
                [w, w_s, -speed * w_s, -speed * decay * decay * w]
            });
            let mut integrator = trapezoid(ROUNDING);
            integrator
                .start_accelerations(&mut system, &mut state, &[])
                .expect("consistent start");
            let h = 5e-4;
            let steps = (40.0 / speed / h).round() as usize;
            advance(&mut system, &mut integrator, &mut state, steps, h);
        }
        let lift = 100.0 * system.point(system.loads[0].s(state.t), &state).r.z;
        assert_close(lift, expected, 5e-3, &format!("v/c = {ratio}"));
    }
}

/// Start of the energy test: 50 mm at mid-span, as a displacement or as the velocity that leads to the same.
#[derive(Clone, Copy)]
enum Start {
    Displaced,
    Moving,
}

/// Largest change of the energy above equilibrium over 10 s, relative to its start.
fn energy_drift(start: Start, h: f64) -> f64 {
    let (length, elements) = (60.0, 60);
    let material = wire(2e4, 1.35, 195.0, 9.81);
    let mut system = SingleWire::planar(&material, length, elements)
        .pinned(0)
        .pinned(elements);
    let rest = system.equilibrium();
    let mass = system.mass();
    let floor = system.energy(&rest, &mass);
    let mut state = rest;
    let omega = 2.0 * PI * case("pinned tensioned beam", "L=60 T=20000 m=1.35 EI=195", "f1");
    system.displace(&mut state, |s| {
        let k = PI / length;
        let (w, w_s) = (0.05 * (k * s).sin(), 0.05 * k * (k * s).cos());
        match start {
            Start::Displaced => [w, w_s, 0.0, 0.0],
            Start::Moving => [0.0, 0.0, omega * w, omega * w_s],
        }
    });
    let mut integrator = trapezoid(ROUNDING);
    integrator
        .start_accelerations(&mut system, &mut state, &[])
        .expect("consistent start");
    let energy = system.energy(&state, &mass) - floor;
    assert!(energy > 1.0, "energy above equilibrium {energy} J");
    let (mut largest, count) = (0.0_f64, (10.0 / h).round() as usize);
    for step in 1..=count {
        integrator
            .step(&mut system, &mut state, &[], step as f64 * h, h)
            .expect("the wire swings on");
        if step % 5 == 0 {
            largest = largest.max((system.energy(&state, &mass) - floor - energy).abs() / energy);
        }
    }
    largest
}

#[test]
fn an_undamped_wire_in_its_first_mode_keeps_its_energy() {
    for start in [Start::Displaced, Start::Moving] {
        let drift = energy_drift(start, 1e-3);
        assert!(drift < 1e-4, "energy changes by {drift} of its start");
    }
}

#[test]
fn the_energy_error_falls_with_the_square_of_the_step() {
    // From the equilibrium with a velocity: a displaced wire also rings along its axis, at periods near the step.
    let order = (energy_drift(Start::Moving, 2e-3) / energy_drift(Start::Moving, 1e-3)).log2();
    assert!((1.9..2.1).contains(&order), "order {order}");
}
