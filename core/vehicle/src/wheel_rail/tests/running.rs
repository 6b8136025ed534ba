//! A free wheelset on straight track.
use super::support::{Design, Wheelset, cone, round_rail};
use crate::multibody::RigidBody;
use crate::train::CurveInertia;
use crate::wheel_rail::{CreepLaw, WheelContact, WheelRail};
use dynamics::{Force, Jacobian, Layout, NewtonOptions, Simulator, State, StaticOptions, System};

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Of the wheelset, N.
pub(super) const WEIGHT: f64 = 20e3;

pub(super) struct Rig {
    pub layout: Layout,
    body: RigidBody,
    pub wheels: [WheelRail; 2],
    inertia: Option<CurveInertia>,
}

impl System for Rig {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.body);
        for wheel in &mut self.wheels {
            visit(wheel);
        }
        if let Some(inertia) = &mut self.inertia {
            visit(inertia);
        }
    }
}

/// A wheelset that spins with its body.
pub(super) fn rig(design: &Design) -> Rig {
    let Wheelset { layout, pose, wheels } = Design {
        spin: 0.0,
        ..design.clone()
    }
    .build();
    let body = RigidBody {
        pose,
        mass: WEIGHT / 9.81,
        inertia: Vector3::new(1000.0, 150.0, 1000.0),
        gravity: 9.81,
    };
    Rig {
        layout,
        inertia: CurveInertia::new(&design.travel(), &[body], &[]),
        body,
        wheels,
    }
}

/// A simulator at a state with consistent accelerations.
pub(super) fn start(mut rig: Rig, state: State, step: f64, rho_inf: f64) -> Simulator<Rig> {
    let motion = state.motion(&[]);
    rig.wheels.iter_mut().for_each(|wheel| wheel.begin_step(&motion));
    let mut simulator = Simulator::new(rig, state, Vec::new(), step, rho_inf, NewtonOptions::default());
    simulator.start_accelerations().unwrap();
    simulator
}

/// Lateral positions over time of a wheelset that starts in the middle with a yaw angle, rolling freely.
fn hunting(design: &Design, yaw: f64, duration: f64, step: f64) -> Vec<f64> {
    let set = design.build();
    let mut state = set.loaded(0, 0.5 * WEIGHT, 0.0, 0.0, yaw);
    state.v[4] = design.speed / design.radius;
    let mut simulator = start(rig(design), state, step, 0.8);
    let count = (duration / step) as usize;
    (0..count)
        .map(|i| {
            simulator
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
            simulator.state().q[1]
        })
        .collect()
}

/// Times at which a record passes its middle, linearly between samples.
fn crossings(record: &[f64], step: f64) -> Vec<f64> {
    record
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| pair[0] * pair[1] < 0.0)
        .map(|(i, pair)| (i as f64 + 1.0 + pair[0] / (pair[0] - pair[1])) * step)
        .collect()
}

pub(super) fn conical(law: CreepLaw) -> Design {
    Design {
        wheel: cone(0.05),
        rail: round_rail(0.3),
        rail_distance: 0.765,
        law,
        damping: 1e9,
        ..Design::manchester()
    }
}

#[test]
fn a_conical_wheelset_runs_in_klingels_wave() {
    let design = conical(CreepLaw::Polach);
    let step = 2e-3;
    let record = hunting(&design, 2e-4, 20.0, step);
    let times = crossings(&record, step);
    let length = design.speed * (times[3] - times[1]);
    // Klingel: 2π √(r e/γ) with half the distance e of the contacts, here on round rails of radius R. The lateral displacement y
    // rolls the wheelset by φ = γ y/(e − r γ) and moves the contacts on the wheels by y + (R + r) φ, so that the radii differ by
    // 2 γ y (e + R γ)/(e − r γ). The wheels roll where they touch: y' + r φ' = ψ, which gives the factor e/(e − r γ) on y'.
    let (cone, rail) = (0.05, 0.3);
    let half = design.rail_distance - rail * cone;
    let radius = design.radius - cone * (half - design.distance);
    let plain = 2.0 * PI * (radius * half / cone).sqrt();
    let exact = plain / (1.0 + rail * cone / half).sqrt();
    println!("wavelength {length:.4} m, Klingel {plain:.4} m, with the roundness of the rails {exact:.4} m");
    assert!((length / plain - 1.0).abs() < 0.01, "{length} {plain}"); // as asked
    assert!((length / exact - 1.0).abs() < 1e-3, "{length} {exact}"); // inertia, m V² γ/(r C) ≈ 2e-4
}

/// Difference of the rolling radii (m) and roll angle of a wheelset in static balance at a lateral displacement.
fn rolling(design: &Design, left: f64) -> [f64; 2] {
    let design = Design {
        law: CreepLaw::Frictionless,
        ..design.clone()
    };
    let mut rig = rig(&design);
    let state = design.build().loaded(0, 0.5 * WEIGHT, left, 0.0, 0.0);
    for index in [0, 1, 4, 5] {
        rig.layout.fix(index);
    }
    let mut simulator = Simulator::new(rig, state, Vec::new(), 1e-3, 1.0, NewtonOptions::default());
    // One wheel may hang in the air at first.
    let options = StaticOptions {
        mass_shift: 1e3,
        ..StaticOptions::default()
    };
    simulator.settle(&options).unwrap();
    let roll = dynamics::rotation::log(&simulator.state().rotation[0]).x;
    let (rig, motion) = simulator.parts();
    // From the axle, weighted with the load.
    let radius = |wheel: &WheelRail| {
        let contacts = wheel.contacts(&motion);
        let parts = wheel.parts();
        let sum = |value: &dyn Fn(&WheelContact) -> f64| -> f64 {
            (contacts.iter().flatten())
                .map(|contact| contact.normal_force * value(contact))
                .sum()
        };
        let height = |contact: &WheelContact| parts.wheel.profile.at(contact.point.parameters.wheel).position.y;
        parts.wheel.radius - sum(&height) / sum(&|_| 1.0)
    };
    [radius(&rig.wheels[0]) - radius(&rig.wheels[1]), roll]
}

/// Length of the wave (m) of a wheelset that rolls without sliding from the middle, with the yaw angle `yaw` (rad):
/// `y' + r φ'(y) = ψ`, `ψ' = −Δr(y)/(2 e r)`, with Δr and φ of static positions up to `reach` (m) to either side.
fn kinematic_wave(design: &Design, yaw: f64, reach: f64) -> f64 {
    const ENTRIES: usize = 20;
    let spacing = reach / ENTRIES as f64;
    let table: Vec<[f64; 2]> = (0..=ENTRIES).map(|i| rolling(design, spacing * i as f64)).collect();
    let rate = |[y, psi]: [f64; 2]| {
        let place = y.abs() / spacing;
        let left = (place as usize).min(ENTRIES - 1);
        let [low, high] = [table[left], table[left + 1]];
        let difference = y.signum() * (low[0] + (place - left as f64) * (high[0] - low[0]));
        let roll_slope = (high[1] - low[1]) / spacing;
        [
            psi / (1.0 + design.radius * roll_slope),
            -difference / (2.0 * design.radius * design.distance),
        ]
    };
    let (step, mut state) = (2e-3, [0.0, yaw]);
    for i in 0..30_000 {
        let first = rate(state);
        let middle = rate([0, 1].map(|k| state[k] + 0.5 * step * first[k]));
        let next = [0, 1].map(|k| state[k] + step * middle[k]);
        // Half a wave ends where the wheelset is back in the middle.
        if i > 0 && next[0] <= 0.0 {
            return 2.0 * step * (f64::from(i) + state[0] / (state[0] - next[0]));
        }
        state = next;
    }
    panic!("no wave within 60 m");
}

#[test]
fn a_wheelset_with_the_profile_s1002_runs_in_the_wave_of_its_rolling_radii() {
    // On round rails, so that each wheel has one contact.
    let design = Design {
        law: CreepLaw::Polach,
        damping: 1e9,
        rail: round_rail(0.1),
        rail_distance: 0.7527,
        ..Design::manchester()
    };
    for yaw in [2e-4, 8e-4] {
        let step = 2e-3;
        let record = hunting(&design, yaw, 18.0, step);
        let times = crossings(&record, step);
        let length = design.speed * (times[2] - times[0]);
        let amplitude = record.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        let kinematic = kinematic_wave(&design, yaw, 1.1 * amplitude);
        println!(
            "amplitude {:.2} mm: {length:.3} m, from the radii {kinematic:.3} m",
            1e3 * amplitude
        );
        assert!((length / kinematic - 1.0).abs() < 0.01, "{length} {kinematic}"); // as asked
    }
}

#[test]
fn a_bouncing_wheelset_keeps_its_energy_without_friction() {
    let residual = |step: f64| {
        let design = Design {
            damping: 0.0,
            ..conical(CreepLaw::Frictionless)
        };
        let set = design.build();
        let mut state = set.placed(1e-3, 0.3e-3, 2e-4, 1e-3);
        state.v[1] = 0.02;
        state.v[5] = 0.01;
        let mut simulator = start(rig(&design), state, step, 1.0);
        let mut balance = simulator.energy_balance();
        let mut flight = 0;
        for i in 0..(0.1 / step) as usize {
            simulator
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
            simulator.balance(&mut balance, step);
            let (system, motion) = simulator.parts();
            flight += usize::from(system.wheels.iter().all(|wheel| wheel.energy(&motion) == 0.0));
        }
        assert!(
            flight > 100 && balance.dissipated().abs() < 1e-9,
            "{flight} {}",
            balance.dissipated()
        ); // rounding
        balance.worst_residual()
    };
    // The fall: 2040 kg · 9.81 m/s² · 0.3 mm = 6 J. The trapezoid is of second order where the force is smooth.
    let [coarse, fine] = [residual(2e-5), residual(1e-5)];
    println!("{coarse} {fine}");
    assert!(fine < 6e-3 && fine < 0.5 * coarse, "{coarse} {fine}");
}

#[test]
fn newtons_method_converges_through_impacts_and_flange_contact() {
    // A wheelset that falls on the rails askew at 50 m/s and runs against a flange.
    let design = Design {
        law: CreepLaw::Polach,
        damping: 1e9,
        speed: 50.0,
        ..Design::manchester()
    };
    let set = design.build();
    let mut state = set.placed(1e-3, 0.3e-3, 2e-4, 1e-3);
    state.v[4] = design.speed / design.radius;
    state.v[1] = 0.2;
    let (step, count) = (1e-3, 300_u32);
    let rig = rig(&design);
    let options = NewtonOptions {
        jacobian: Jacobian::Full,
        ..NewtonOptions::default()
    };
    let mut simulator = Simulator::new(rig, state, Vec::new(), step, 0.8, options);
    simulator.start_accelerations().unwrap();
    let mut flange = false;
    for i in 0..count {
        simulator
            .advance(f64::from(i) * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
            .unwrap();
        let (rig, motion) = simulator.parts();
        let contacts = rig.wheels.iter().flat_map(|wheel| wheel.contacts(&motion)).flatten();
        flange |= contacts.into_iter().any(|contact| contact.point.normal.z < 0.6);
    }
    let counters = simulator.counters();
    println!("{counters:?}");
    // With the exact tangent: quadratic convergence, a few corrections per step even where contacts open and close.
    assert!(
        flange && counters.newton_iterations < 4 * u64::from(count),
        "{counters:?}"
    );
}
