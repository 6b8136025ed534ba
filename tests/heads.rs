//! Heads with several strips under rigid wires, against closed forms.
use catenary::{ContactPair, ContactTangent, CurveColumns, CurvePoint, PenaltyContact, WireCurve};
use dynamics::{Constraint, Force, Layout, NewtonOptions, Simulator, State, System};
use nalgebra::Vector3;
use scene::{HeadPitch, HeadStrip, Lumped, StripSpring};
use std::f64::consts::TAU;
use std::sync::Arc;
use vehicle::{PantographModel, Placement};

/// Height of a rigid wire with its first and second derivative along the track, at x in m.
type Profile = fn(f64) -> [f64; 3];

/// A wire that gives way to nothing.
struct RigidWire(Profile);

impl WireCurve for RigidWire {
    fn length(&self) -> f64 {
        1000.0
    }

    fn point(&self, s: f64, _: &[f64], _: &[f64]) -> CurvePoint {
        let [height, slope, bend] = (self.0)(s);
        CurvePoint {
            r: Vector3::new(s, 0.0, height),
            r_s: Vector3::new(1.0, 0.0, slope),
            r_ss: Vector3::new(0.0, 0.0, bend),
            velocity: Vector3::zeros(),
            velocity_s: Vector3::zeros(),
        }
    }

    fn columns(&self, _: f64, _: &mut CurveColumns) {}
}

/// A pantograph under a rigid wire, or under none.
struct UnderWire {
    layout: Layout,
    model: PantographModel,
    contacts: Vec<ContactPair>,
}

impl System for UnderWire {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.model.forces(visit);
        for contact in &mut self.contacts {
            visit(contact);
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.model.constraints(visit);
    }
}

/// Contact stiffness of EN 50318, N/m.
const CONTACT: f64 = 5e4;
/// m/s.
const SPEED: f64 = 70.0;
/// Height of level wires, m.
const LEVEL: f64 = 5.3;

/// Reference pantograph of EN 50318 with a head of these strips.
fn lumped(strips: &[HeadStrip]) -> Lumped {
    let mut lumped = Lumped::new(1.2, 120.0, &[7.2, 15.0], &[4200.0, 50.0], &[10.0, 90.0]);
    lumped.reference_height = Some(LEVEL);
    lumped.strips = strips.to_vec();
    lumped
}

fn fixed(places: &[f64]) -> Vec<HeadStrip> {
    places.iter().map(|&x| HeadStrip::fixed(x)).collect()
}

const SPRING: StripSpring = StripSpring {
    mass: 1.5,
    stiffness: 5000.0,
    damping: 0.0,
};

/// Strips on springs of their own.
fn sprung(places: &[f64]) -> Vec<HeadStrip> {
    let strip = |&x| HeadStrip {
        x,
        spring: Some(SPRING),
    };
    places.iter().map(strip).collect()
}

/// A pantograph with strips at rest at `height` m, without a wire.
fn free(entry: Lumped, height: f64) -> (UnderWire, State) {
    let mut layout = Layout::new();
    let placement = Placement {
        start_x: 100.0,
        speed: SPEED,
        gravity: 9.81,
        one_motion: false,
        vehicle: None,
        track: None,
        duration: 0.0,
    };
    let entry = scene::PantographModel::Lumped(entry);
    let mut model = PantographModel::new(&entry, placement, "pantograph", &mut layout).unwrap();
    let rest = model.equilibrium_at_heights(&vec![height; model.strips()]).unwrap();
    let mut state = layout.state_at_rest();
    model.set_initial(&rest, &mut state);
    let contacts = Vec::new();
    (
        UnderWire {
            layout,
            model,
            contacts,
        },
        state,
    )
}

/// The same under a rigid wire, at rest where the wire is level.
fn under(entry: Lumped, profile: Profile, stiffness: f64, rho_inf: f64) -> Simulator<UnderWire> {
    let (alone, _) = free(entry.clone(), LEVEL);
    let strips = alone.model.strips();
    let mut height = LEVEL;
    for _ in 0..5 {
        let rest = alone.model.equilibrium_at_heights(&vec![height; strips]).unwrap();
        height = LEVEL + rest.force / (strips as f64 * stiffness);
    }
    let (mut system, state) = free(entry, height);
    let law = PenaltyContact {
        stiffness,
        damping: 0.0,
    };
    let contact = |strip| {
        let wire = Arc::new(RigidWire(profile));
        ContactPair::new(law, wire, system.model.strip_at(strip), 1.2, ContactTangent::Exact)
    };
    system.contacts = (0..strips).map(contact).collect();
    let options = NewtonOptions {
        tolerance: 1e-9,
        ..NewtonOptions::default()
    };
    let mut simulator = Simulator::new(system, state, Vec::new(), 1e-3, rho_inf, options);
    simulator.start_accelerations().unwrap();
    simulator
}

/// Contact forces of the strips now, N.
fn forces(simulator: &mut Simulator<UnderWire>) -> Vec<f64> {
    let (system, motion) = simulator.parts();
    let force = |contact: &ContactPair| contact.state(&motion).map_or(0.0, |state| state.force);
    system.contacts.iter().map(force).collect()
}

/// Contact forces of the strips, N, at the end of each of `steps` ms.
fn history(simulator: &mut Simulator<UnderWire>, steps: usize) -> Vec<Vec<f64>> {
    let step = |n| {
        let t = 1e-3 * n as f64;
        simulator
            .advance(t, 1e-3, &mut |_, _| {}, &mut |_, _, _, _| {})
            .unwrap();
        forces(simulator)
    };
    (0..steps).map(step).collect()
}

fn level(_: f64) -> [f64; 3] {
    [LEVEL, 0.0, 0.0]
}

/// Wave length of a worn wire, m, and its amplitude, m.
const WAVE: (f64, f64) = (1.16, 2e-4);

/// `w(x) = a sin(2πx/λ)` below the level wire.
fn worn(x: f64) -> [f64; 3] {
    let (length, height) = WAVE;
    let k = TAU / length;
    let (sin, cos) = (k * x).sin_cos();
    [LEVEL + height * sin, height * k * cos, -height * k * k * sin]
}

const SLOPE: f64 = 0.002;

fn ramp(x: f64) -> [f64; 3] {
    [LEVEL + SLOPE * (x - 100.0), SLOPE, 0.0]
}

fn deviation(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (values.map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt()
}

#[test]
fn strips_of_one_head_share_its_force_evenly_on_a_level_wire() {
    // Springs under strips are one more spring above the grounded one.
    let springs = [1.0 / 4200.0, 1.0 / 4200.0 + 1.0 / (2.0 * SPRING.stiffness)];
    let heads = [lumped(&fixed(&[0.29, -0.29])), lumped(&sprung(&[0.29, -0.29]))];
    for (entry, above) in heads.into_iter().zip(springs) {
        let expected = 120.0 / (1.0 + 50.0 * above);
        let mut simulator = under(entry, level, CONTACT, 0.9);
        for forces in history(&mut simulator, 500) {
            // Rounding of heights of 5 m under 5e4 N/m.
            assert!((forces[0] - forces[1]).abs() < 1e-9, "{forces:?}");
            // 50 N/m on the millimetre by which the strips are in the wire.
            assert!((forces[0] + forces[1] - expected).abs() < 0.07, "{forces:?} {expected}");
        }
    }
}

#[test]
fn two_strips_in_one_place_are_one_strip_on_a_contact_of_twice_the_stiffness() {
    let two = history(&mut under(lumped(&fixed(&[0.0, 0.0])), worn, CONTACT, 0.9), 1000);
    let one = history(&mut under(lumped(&[]), worn, 2.0 * CONTACT, 0.9), 1000);
    assert!(
        deviation(one.iter().map(|forces| forces[0])) > 5.0,
        "the wire shakes the strip"
    );
    for (two, one) in two.iter().zip(&one) {
        // Tolerance of Newton's method, 1e-9 N, over a thousand steps.
        assert!((two.iter().sum::<f64>() - one[0]).abs() < 1e-6, "{two:?} {one:?}");
    }
}

#[test]
fn a_strip_on_a_spring_of_its_own_is_one_more_mass_of_the_chain() {
    let on_spring = history(&mut under(lumped(&sprung(&[0.0])), worn, CONTACT, 0.9), 1000);
    let mut chain = Lumped::new(
        1.2,
        120.0,
        &[1.5, 7.2, 15.0],
        &[5000.0, 4200.0, 50.0],
        &[0.0, 10.0, 90.0],
    );
    chain.reference_height = Some(LEVEL);
    let chain = history(&mut under(chain, worn, CONTACT, 0.9), 1000);
    for (spring, chain) in on_spring.iter().zip(&chain) {
        // Tolerance of Newton's method, 1e-9 N, over a thousand steps.
        assert!((spring[0] - chain[0]).abs() < 1e-6, "{spring:?} {chain:?}");
    }
}

/// On a ramp of slope `s` with strips `2a` apart, `2 k a² (−s − θ) = k_θ θ` (derived here).
#[test]
fn a_pitching_head_turns_into_a_ramp_as_far_as_its_spring_lets_it() {
    const HALF: f64 = 0.29;
    for stiffness in [0.0, 500.0, 8000.0] {
        let mut entry = lumped(&fixed(&[HALF, -HALF]));
        // Nothing holds the chain back on its way up but its dampers between masses.
        (entry.stiffnesses[1], entry.dampings[1]) = (0.0, 0.0);
        entry.dampings[0] = 150.0;
        entry.pitch = Some(HeadPitch {
            inertia: 0.4,
            stiffness,
            damping: 60.0,
        });
        let mut simulator = under(entry, ramp, CONTACT, 0.9);
        let forces = history(&mut simulator, 5000).pop().unwrap();
        let along = 2.0 * CONTACT * HALF * HALF;
        let angle = -SLOPE * along / (along + stiffness);
        let (system, motion) = simulator.parts();
        let [front, rear] = [0, 1].map(|strip| system.model.strip_at(strip).frame(&motion).position.z);
        let found = (rear - front) / (2.0 * HALF);
        // Motions that die out, and the square of the slope.
        assert!((found / angle - 1.0).abs() < 1e-4, "{stiffness}: {found}, {angle}");
        let difference = stiffness * angle / HALF;
        assert!(
            (forces[0] - forces[1] - difference).abs() < 1e-4 * 60.0,
            "{forces:?}, {difference}"
        );
        assert!((forces[0] + forces[1] - 120.0).abs() < 1e-3 * 120.0, "{forces:?}");
    }
}

/// A frame M on a spring K under two strips (m, k), free of the wire. Strips against each other swing at `√(k/m)`; the
/// other two frequencies solve `m M λ² − (m (K + 2k) + M k) λ + k K = 0` (by hand: eigenvalues of 2 × 2).
#[test]
fn strips_on_springs_swing_at_the_frequencies_of_the_free_head() {
    let entry = |strips: &[HeadStrip]| {
        let mut entry = Lumped::new(1.2, 120.0, &[7.2], &[4200.0], &[0.0]);
        entry.reference_height = Some(LEVEL);
        entry.strips = strips.to_vec();
        entry
    };
    let (mass, stiffness, frame, base) = (SPRING.mass, SPRING.stiffness, 7.2, 4200.0);
    let half = (mass * (base + 2.0 * stiffness) + frame * stiffness) / (2.0 * mass * frame);
    let root = (half * half - stiffness * base / (mass * frame)).sqrt();
    // Frequency squared, and the rise of the frame where the first strip rises by one.
    let together = |square: f64| (square, 1.0 - mass * square / stiffness);
    let modes = [
        ((stiffness / mass, 0.0), -1.0),
        (together(half - root), 1.0),
        (together(half + root), 1.0),
    ];
    const STEP: f64 = 2e-5;
    for ((square, of_frame), second) in modes {
        let (system, rest) = free(entry(&sprung(&[0.29, -0.29])), LEVEL);
        // The strips hang free: a force of rest holds them where they are.
        let held = system.model.equilibrium_at_heights(&[LEVEL; 2]).unwrap();
        let loads = [0, 1].map(|strip| system.model.applied_force_at(strip, 4 * strip));
        let mut u = vec![0.0; 8];
        (u[2], u[6]) = (-held.strip_forces[0], -held.strip_forces[1]);
        struct Held(UnderWire, [vehicle::AppliedForce; 2]);
        impl System for Held {
            fn layout(&self) -> &Layout {
                self.0.layout()
            }
            fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
                self.0.forces(visit);
                for load in &mut self.1 {
                    visit(load);
                }
            }
        }
        let mut state = rest.clone();
        let shape = [of_frame, 1.0, second];
        for (q, shape) in state.q.iter_mut().zip(shape) {
            *q += 1e-3 * shape;
        }
        let options = NewtonOptions {
            tolerance: 1e-11,
            ..NewtonOptions::default()
        };
        let mut simulator = Simulator::new(Held(system, loads), state, u, STEP, 1.0, options);
        simulator.start_accelerations().unwrap();
        let frequency = f64::sqrt(square);
        let period = TAU / frequency;
        let steps = (3.25 * period / STEP).round();
        let h = steps * STEP;
        simulator.advance(0.0, h, &mut |_, _| {}, &mut |_, _, _, _| {}).unwrap();
        // A quarter period on: the phase is off by (ωh)³/12 per step at most, 1e-5 here.
        for (index, shape) in shape.iter().enumerate() {
            let q = simulator.state().q[index] - rest.q[index];
            let expected = 1e-3 * shape * (frequency * h).cos();
            assert!((q - expected).abs() < 1e-4 * 1e-3, "ω = {frequency}: {q} {expected}");
        }
    }
}

#[test]
fn the_energy_of_pantograph_and_contacts_is_accounted_for() {
    let mut pitching = lumped(&fixed(&[0.29, -0.1]));
    pitching.pitch = Some(HeadPitch {
        inertia: 0.4,
        stiffness: 500.0,
        damping: 0.0,
    });
    for mut entry in [lumped(&fixed(&[0.3, -0.2])), pitching, lumped(&sprung(&[0.3, -0.2]))] {
        entry.dampings.fill(0.0);
        let mut simulator = under(entry, worn, CONTACT, 1.0);
        let mut balance = simulator.energy_balance();
        for n in 0..2000 {
            let t = 5e-4 * f64::from(n);
            simulator
                .advance(t, 5e-4, &mut |_, _| {}, &mut |_, _, _, _| {})
                .unwrap();
            simulator.balance(&mut balance, 5e-4);
        }
        // Second order in the step; the wire drives the strips back and forth with some joules.
        let (residual, exchanged) = (balance.worst_residual(), balance.exchanged());
        assert!(
            exchanged > 0.1 && residual < 2e-3 * exchanged,
            "{residual} J of {exchanged} J"
        );
    }
}

#[test]
fn strips_half_a_wave_apart_cancel_what_a_worn_wire_does_to_the_head() {
    let run = |spacing: f64| {
        let half = 0.5 * spacing;
        history(&mut under(lumped(&fixed(&[half, -half])), worn, CONTACT, 0.9), 2000)
    };
    let swing = |history: &[Vec<f64>]| {
        [
            deviation(history.iter().map(|forces| forces[0])),
            deviation(history.iter().map(|forces| forces.iter().sum())),
        ]
    };
    let [one, all] = swing(&run(0.5 * WAVE.0));
    // a k = 10 N per strip on a head that stays where it is; the rest is of second order in the slope, 1e-3.
    assert!((one - WAVE.1 * CONTACT / f64::sqrt(2.0)).abs() < 0.01 * one, "{one}");
    assert!(all < 2e-3 * one, "{all} of {one}");
    let [one, all] = swing(&run(WAVE.0));
    assert!(
        (all / one - 2.0).abs() < 1e-3,
        "a whole wave apart both see the same: {all} of {one}"
    );
}
