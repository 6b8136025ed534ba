//! A free wheelset on straight track.
use super::support::{Design, Wheelset, cone, round_rail};
use crate::multibody::RigidBody;
use crate::rail_vehicle::CurveInertia;
use crate::wheel_rail::{CreepLaw, WheelContact, WheelRail};
use dynamics::{Force, Jacobian, Layout, NewtonOptions, Simulator, State, StaticOptions, StepHistory, System};

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Weight of the wheelset, N.
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
    rig_of(design, WEIGHT)
}

/// Same wheelset of another weight (N).
fn rig_of(design: &Design, weight: f64) -> Rig {
    let Wheelset { layout, pose, wheels } = Design {
        spin: 0.0,
        ..design.clone()
    }
    .build();
    let body = RigidBody {
        pose,
        mass: weight / 9.81,
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
    rig.wheels.iter_mut().for_each(|wheel| wheel.begin_step(&motion, 1e-3));
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
    // Klingel: 2π √(r e/γ) with half the distance e of the contacts, here on round rails of radius R. The lateral
    // displacement y rolls the wheelset by φ = γ y/(e − r γ) and moves the contacts on the wheels by y + (R + r) φ, so
    // that the radii differ by 2 γ y (e + R γ)/(e − r γ). The wheels roll where they touch: y' + r φ' = ψ, which gives
    // the factor e/(e − r γ) on y'.
    let (cone, rail) = (0.05, 0.3);
    let half = design.rail_distance - rail * cone;
    let radius = design.radius - cone * (half - design.distance);
    let plain = 2.0 * PI * (radius * half / cone).sqrt();
    let exact = plain / (1.0 + rail * cone / half).sqrt();
    println!("wavelength {length:.4} m, Klingel {plain:.4} m, with the roundness of the rails {exact:.4} m");
    assert!((length / plain - 1.0).abs() < 0.01, "{length} {plain}"); // as asked
    assert!((length / exact - 1.0).abs() < 1e-3, "{length} {exact}"); // inertia, m V² γ/(r C) ≈ 2e-4
}

/// A wheelset of a weight (N) in static balance at a lateral displacement (m), without friction.
fn displaced(design: &Design, weight: f64, left: f64) -> Simulator<Rig> {
    let design = Design {
        law: CreepLaw::Frictionless,
        ..design.clone()
    };
    let mut rig = rig_of(&design, weight);
    let state = design.build().loaded(0, 0.5 * weight, left, 0.0, 0.0);
    for index in [0, 1, 4, 5] {
        rig.layout.fix(index);
    }
    let mut simulator = Simulator::new(rig, state, Vec::new(), 1e-3, 1.0, NewtonOptions::default());
    // One wheel may hang in the air at first.
    let options = StaticOptions {
        mass_shift: 1e3,
        newton: NewtonOptions {
            tolerance: 1e-4, // N: 1e-8 of a wheel load
            ..StaticOptions::default().newton
        },
        ..StaticOptions::default()
    };
    simulator.settle(&options).unwrap();
    simulator
}

/// Difference of the rolling radii (m) and roll angle of a wheelset of a weight (N) in static balance at a lateral
/// displacement.
fn rolling(design: &Design, weight: f64, left: f64) -> [f64; 2] {
    let mut simulator = displaced(design, weight, left);
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

/// Length of the wave (m) of a wheelset of a weight (N) that rolls without sliding, from an amplitude (m) to the middle
/// four times: `y' + r φ'(y) = ψ`, `ψ' = −Δr(y)/(2 e r)`, with Δr and φ of static positions; `y' = ψ` where it is not
/// to `roll`.
fn kinematic_wave(design: &Design, weight: f64, amplitude: f64, roll: bool) -> f64 {
    const ENTRIES: usize = 60;
    let spacing = amplitude / ENTRIES as f64;
    let table: Vec<[f64; 2]> = (0..=ENTRIES)
        .map(|i| rolling(design, weight, spacing * i as f64))
        .collect();
    let rate = |[y, psi]: [f64; 2]| {
        let place = y.abs() / spacing;
        let left = (place as usize).min(ENTRIES - 1);
        let [low, high] = [table[left], table[left + 1]];
        let difference = y.signum() * (low[0] + (place - left as f64) * (high[0] - low[0]));
        let roll_slope = if roll { (high[1] - low[1]) / spacing } else { 0.0 };
        [
            psi / (1.0 + design.radius * roll_slope),
            -difference / (2.0 * design.radius * design.distance),
        ]
    };
    let (step, mut state) = (1e-3, [amplitude, 0.0]);
    for i in 0..30_000 {
        let first = rate(state);
        let middle = rate([0, 1].map(|k| state[k] + 0.5 * step * first[k]));
        let next = [0, 1].map(|k| state[k] + step * middle[k]);
        if next[0] <= 0.0 {
            return 4.0 * step * (f64::from(i) + state[0] / (state[0] - next[0]));
        }
        state = next;
    }
    panic!("no wave within 120 m");
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
        let kinematic = kinematic_wave(&design, WEIGHT, amplitude, true);
        println!(
            "amplitude {:.2} mm: {length:.3} m, from the radii {kinematic:.3} m",
            1e3 * amplitude
        );
        assert!((length / kinematic - 1.0).abs() < 0.01, "{length} {kinematic}"); // as asked
    }
}

/// Weight of a wheelset whose profiles are rigid, N: an approach of 2 µm.
const NEXT_TO_NONE: f64 = 10.0;

/// Equivalent conicity of a wheelset at an amplitude (m), of rigid profiles: those of next to no weight. It is the
/// slope of the cone whose wave is as long as that of `y'' = −Δr(y)/(2 e r)` from the amplitude on [EN 15302, UIC 519].
fn equivalent_conicity(design: &Design, amplitude: f64) -> f64 {
    let length = kinematic_wave(design, NEXT_TO_NONE, amplitude, false);
    design.distance * design.radius * (2.0 * PI / length).powi(2)
}

/// Length (m) and amplitude (m) of the first wave of a wheelset that is let go at a lateral displacement (m), rolling
/// freely.
fn let_go(design: &Design, left: f64) -> [f64; 2] {
    let step = 1e-3;
    let mut state = displaced(design, WEIGHT, left).state().clone();
    state.v[4] = design.speed / design.radius;
    let mut simulator = start(rig(design), state, step, 0.8);
    let mut record = vec![left];
    while crossings(&record, step).len() < 3 {
        let t = record.len() as f64 * step;
        assert!(t < 60.0, "no wave");
        let one = simulator.advance(t - step, step, &mut |_, _| (), &mut |_, _, _, _| ());
        one.unwrap();
        record.push(simulator.state().q[1]);
    }
    let times = crossings(&record, step);
    let wave = &record[(times[0] / step) as usize..];
    let (low, high) = wave
        .iter()
        .fold((0.0_f64, 0.0_f64), |(low, high), &y| (low.min(y), high.max(y)));
    [design.speed * (times[2] - times[0]), 0.5 * (high - low)]
}

/// Wheelset and track of `scenes/thesis-own-mesh.toml`: a tread of 1:40 on the rail 60E1.
fn thesis() -> Design {
    let text = include_str!("../../../../../scenes/thesis-own-mesh.toml");
    let scene = scene::Scene::from_toml(text, "thesis-own-mesh.toml", &[]).unwrap();
    let wheels = &scene.vehicle.as_deref().unwrap().train().unwrap().wheels;
    let rail = scene.track.as_deref().unwrap().rail.clone().unwrap();
    let (sine, cosine) = rail.inclination.atan().sin_cos();
    let leaning: Vec<[f64; 2]> = (rail.profile.iter())
        .map(|[outward, up]| [outward * cosine - up * sine, outward * sine + up * cosine])
        .collect();
    let profile = |points: &[[f64; 2]]| std::sync::Arc::new(crate::wheel_rail::Profile::new(points, 1e-5).unwrap());
    let leaning = profile(&leaning);
    Design {
        wheel: profile(wheels.profile.as_ref().unwrap()),
        rail_distance: 0.5 * rail.gauge - super::support::gauge_face(&leaning, 0.014),
        rail: leaning,
        radius: wheels.radius,
        distance: 0.5 * wheels.distance,
        law: CreepLaw::Polach,
        damping: 1e9,
        ..Design::manchester()
    }
}

/// A wave as simulated (m), that of the equivalent conicity at its amplitude, the same where the roll of the wheelset
/// counts, and this on loaded profiles.
fn waves(design: &Design, left: f64) -> [f64; 4] {
    let [length, amplitude] = let_go(design, left);
    let conicity = equivalent_conicity(design, amplitude);
    let formula = 2.0 * PI * (design.radius * design.distance / conicity).sqrt();
    let rolling = kinematic_wave(design, NEXT_TO_NONE, amplitude, true);
    let loaded = kinematic_wave(design, WEIGHT, amplitude, true);
    println!(
        "amplitude {:.3} mm: {length:.3} m; conicity {conicity:.4}: {formula:.3} m; with roll {rolling:.3} m, \
         loaded {loaded:.3} m",
        1e3 * amplitude
    );
    [length, formula, rolling, loaded]
}

#[test]
fn the_profiles_of_the_thesis_scene_run_in_the_wave_of_their_equivalent_conicity() {
    for left in [0.5e-3, 2e-3] {
        let [length, formula, rolling, _] = waves(&thesis(), left);
        assert!((length / formula - 1.0).abs() < 0.01, "{length} {formula}"); // as asked
        // The wheels touch 753 mm from the middle, not at 750: 0.2 %.
        assert!((length / rolling - 1.0).abs() < 3e-3, "{length} {rolling}");
    }
}

/// The definition leaves out the roll of the wheelset: a rolling wheel follows `y' + r φ' = ψ`, which lengthens the
/// wave by `√(1 + r dφ/dy)`, as the wheelset rolls by 60 mrad per metre on these profiles. Below an amplitude of 1 mm
/// the contacts jump between two places of tread and rail within some tenths of a millimetre, and the force, not the
/// position, decides the rolling radius.
#[test]
fn s1002_on_uic60_runs_in_the_wave_of_its_equivalent_conicity_and_of_its_roll() {
    let design = Design {
        law: CreepLaw::Polach,
        damping: 1e9,
        ..Design::manchester()
    };
    for left in [2e-3, 3e-3] {
        let [length, formula, rolling, _] = waves(&design, left);
        assert!((length / formula - 1.0).abs() < 0.015, "{length} {formula}"); // the roll, above
        assert!((length / rolling - 1.0).abs() < 2e-3, "{length} {rolling}"); // the load
    }
    let [length, _, _, loaded] = waves(&design, 1e-3);
    assert!((length / loaded - 1.0).abs() < 0.01, "{length} {loaded}"); // as asked, of the radii under load
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
