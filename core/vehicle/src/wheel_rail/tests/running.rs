//! A free wheelset on straight track.
use super::support::{Design, Wheelset, cone, round_rail};
use crate::multibody::RigidBody;
use crate::wheel_rail::{CreepLaw, WheelRail};
use dynamics::{Force, Layout, NewtonOptions, Simulator, State, System};
use nalgebra::Vector3;

struct Rig {
    layout: Layout,
    body: RigidBody,
    wheels: [WheelRail; 2],
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
    }
}

/// A wheelset of 20 kN that spins with its body.
fn rig(design: &Design) -> Rig {
    let Wheelset { layout, pose, wheels } = Design {
        spin: 0.0,
        ..design.clone()
    }
    .build();
    Rig {
        layout,
        body: RigidBody {
            pose,
            mass: 2040.0,
            inertia: Vector3::new(1000.0, 150.0, 1000.0),
            gravity: 9.81,
        },
        wheels,
    }
}

/// A simulator at a state with consistent accelerations.
fn start(mut rig: Rig, state: State, step: f64, rho_inf: f64) -> Simulator<Rig> {
    let motion = state.motion(&[]);
    rig.wheels.iter_mut().for_each(|wheel| wheel.begin_step(&motion));
    let mut simulator = Simulator::new(rig, state, Vec::new(), step, rho_inf, NewtonOptions::default());
    simulator.start_accelerations().unwrap();
    simulator
}

/// Lateral positions over time of a wheelset that starts off the middle, rolling freely.
fn hunting(design: &Design, left: f64, duration: f64, step: f64) -> Vec<f64> {
    let set = design.build();
    let mut state = set.loaded(0, 10e3, left, 0.0, 0.0);
    state.v[4] = design.speed / design.radius;
    let mut simulator = start(rig(design), state, step, 0.8);
    let count = (duration / step) as usize;
    (0..count)
        .map(|i| {
            simulator
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _| ())
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

fn conical(law: CreepLaw) -> Design {
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
    let record = hunting(&design, 0.5e-3, 20.0, step);
    let times = crossings(&record, step);
    let length = design.speed * (times[3] - times[1]);
    println!(
        "{times:?} {:?}",
        record.iter().fold([0.0_f64; 2], |m, v| [m[0].min(*v), m[1].max(*v)])
    );
    for i in 0..3 {
        let p: Vec<f64> = record
            .iter()
            .enumerate()
            .filter(|(k, _)| (*k as f64 * step) > times[i] && (*k as f64 * step) < times[i + 1])
            .map(|x| x.1.abs())
            .collect();
        println!("{}", p.iter().fold(0.0_f64, |m, v| m.max(*v)));
    }
    // Conical wheels on round rails: lateral displacement rolls the wheelset by φ = γ y/(e − r γ), which moves the contacts on rails
    // and wheels by (R + r) φ, so that the effective conicity is γ (e + R γ)/(e − r γ), with e half the distance of the contacts.
    let (cone, rail) = (0.05, 0.3);
    let half = design.rail_distance - rail * cone;
    let radius = design.radius - cone * (half - design.distance);
    let conicity = cone * (half + rail * cone) / (half - radius * cone);
    let klingel = 2.0 * std::f64::consts::PI * (radius * half / conicity).sqrt();
    println!("wavelength {length:.4} m, Klingel {klingel:.4} m");
    assert!((length / klingel - 1.0).abs() < 0.01, "{length} {klingel}"); // as asked
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
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _| ())
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
