//! The vehicle in space, on wheels that roll.
use super::vertical::modes;
use super::*;
use crate::check::{assert_tangent, awkward, dense};
use dynamics::{NewtonOptions, Simulator};
use nalgebra::{Matrix2, SymmetricEigen};

pub(super) fn full(scene: &Scene, shape: Option<&TrackShape>) -> Alone {
    let mut layout = Layout::new();
    let entry = scene.vehicle.as_deref().unwrap().train().unwrap();
    let rails = scene.track.as_deref().unwrap();
    let base = Base {
        speed: scene.run.speed,
        ..BASE
    };
    let vehicle = Vehicle::full(entry, (rails, shape), base, 9.81, "vehicle", &mut layout).unwrap();
    Alone { layout, vehicle }
}

/// The vehicle at rest in its frame, its wheelsets rolling freely.
pub(super) fn rolling(alone: &mut Alone) -> State {
    let mut state = alone.layout.state_at_rest();
    let rest = alone.vehicle.rest(&alone.layout, &mut state, &[]).unwrap();
    alone.vehicle.set_rest(&rest, &mut state);
    state
}

#[test]
fn each_rolling_wheel_bears_an_eighth_of_the_weight_at_rest() {
    let mut alone = full(&full_scene(&[]), None);
    let state = rolling(&mut alone);
    for load in alone.vehicle.wheel_loads(&state.motion(&[])) {
        // Residuals of 1e-5 N; what holds the speed against the rolling resistance of the spin lifts the front by 1e-4
        // N.
        assert!((load - 43_052.0 * 9.81 / 8.0).abs() < 1e-3, "{load}");
    }
    // Bearings and contacts give way, no spring does.
    let farthest = state.q.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    assert!(farthest < 1e-3, "{farthest}");
}

#[test]
fn on_rails_that_lie_elsewhere_the_vehicle_rests_there() {
    // Below the wheels, and one rail below the other: at the nominal pose wheels hang in the air.
    for (drop, aslant) in [(5e-3, 0.0), (20e-3, 0.0), (0.0, 1e-4)] {
        let rails = format!(
            "track.irregularities={{model=\"points\",x=[0,200],z_left=[{0},{0}],z_right=[{1},{1}]}}",
            aslant - drop,
            -aslant - drop
        );
        let scene = full_scene(&[&rails]);
        let reach = Reach {
            start: 60.0,
            end: 150.0,
            rail_distance: 1.5,
        };
        let shape = TrackShape::new(scene.track.as_deref().unwrap(), reach);
        let [mut level, mut lower] = [full(&full_scene(&[]), None), full(&scene, shape.as_ref())];
        let [before, after] = [rolling(&mut level), rolling(&mut lower)];
        let sunk = level.vehicle.base_frame(&before.motion(&[])).position.z
            - lower.vehicle.base_frame(&after.motion(&[])).position.z;
        assert!((sunk - drop).abs() < 2e-6, "{drop} m, {aslant} m: {sunk} m");
        let weight: f64 = lower.vehicle.wheel_loads(&after.motion(&[])).sum();
        assert!((weight / (43_052.0 * 9.81) - 1.0).abs() < 1e-6, "{weight} N");
    }
}

#[test]
fn a_rolling_vehicle_on_smooth_track_goes_on_rolling() {
    let mut alone = full(&full_scene(&[]), None);
    let state = rolling(&mut alone);
    let start = state.clone();
    let loads: Vec<f64> = alone.vehicle.wheel_loads(&state.motion(&[])).collect();
    let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 0.9, NewtonOptions::default());
    let (mut largest, mut change) = (0.0_f64, 0.0_f64);
    simulator
        .advance(0.0, 2.0, &mut |_, _| (), &mut |alone, motion, _, _| {
            let base = alone.vehicle.base_frame(&motion);
            largest = largest.max(base.velocity.norm());
            for (i, load) in alone.vehicle.wheel_loads(&motion).enumerate() {
                change = change.max((load - loads[i]).abs());
            }
        })
        .unwrap();
    let moved = alone_moved(&start, simulator.state());
    println!("{largest} m/s, {moved} m, {change} N");
    // Residuals of statics and steps, 1e-5 N to 1e-3 N, on springs of 1e6 N/m and 43 t; creep forces that statics leave
    // out would be 30 N.
    assert!(largest < 1e-7, "{largest} m/s");
    assert!(moved < 1e-8, "{moved} m");
    assert!(change < 2e-3, "{change} N");
}

/// Largest change of a displacement, spins left out.
fn alone_moved(a: &State, b: &State) -> f64 {
    (0..78).map(|i| (a.q[i] - b.q[i]).abs()).fold(0.0, f64::max)
}

/// Largest growth rate (1/s) of an oscillation about rolling at a speed (m/s), from the eigenvalues of the linearised
/// system.
fn hunting(speed: f64) -> f64 {
    let mut scene = full_scene(&[]);
    scene.run.speed = speed;
    let mut alone = full(&scene, None);
    let state = rolling(&mut alone);
    let n = state.q.len();
    let motion = state.motion(&[]);
    let tangent = |alone: &mut Alone, weights: dynamics::Weights| {
        dense(n, &mut |blocks| {
            alone
                .vehicle
                .forces(&mut |force| force.add_tangent(&motion, weights, blocks));
            let mut first = 0;
            for joint in &alone.vehicle.joints {
                if weights.q != 0.0 {
                    joint.add_geometric_stiffness(&motion, &state.lambda[first..], blocks);
                }
                first += joint.dimension();
            }
        })
    };
    let stiffness = tangent(&mut alone, dynamics::Weights { q: 1.0, v: 0.0 });
    let damping = tangent(&mut alone, dynamics::Weights { q: 0.0, v: 1.0 });
    let mass = dense(n, &mut |blocks| {
        alone.vehicle.forces(&mut |force| force.add_mass(blocks))
    });
    let basis = free_motions(&alone, &state);
    let reduced = |matrix: DMatrix<f64>| basis.transpose() * matrix * &basis;
    let inverse = reduced(mass).try_inverse().unwrap();
    let (stiffness, damping) = (&inverse * reduced(stiffness), &inverse * reduced(damping));
    let free = basis.ncols();
    let mut matrix = DMatrix::zeros(2 * free, 2 * free);
    matrix.view_mut((0, free), (free, free)).fill_with_identity();
    matrix.view_mut((free, 0), (free, free)).copy_from(&-stiffness);
    matrix.view_mut((free, free), (free, free)).copy_from(&-damping);
    let values = matrix.complex_eigenvalues();
    let worst = (values.iter())
        .filter(|value| value.im > 1.0)
        .max_by(|a, b| a.re.total_cmp(&b.re))
        .unwrap();
    worst.re
}

/// Growth rate (1/s) of the wheelsets' lateral motion after a small push, at a speed (m/s), from a run in time.
fn simulated_growth(speed: f64) -> f64 {
    let mut scene = full_scene(&[]);
    scene.run.speed = speed;
    let mut alone = full(&scene, None);
    let mut state = rolling(&mut alone);
    let lateral: Vec<usize> = alone
        .vehicle
        .spins
        .iter()
        .map(|spin| spin.pose.translation + 1)
        .collect();
    for &index in &lateral {
        state.v[index] = 1e-3;
    }
    let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 1.0, NewtonOptions::default());
    let mut squares = [0.0; 2];
    let mut time = 0.0;
    simulator
        .advance(0.0, 8.0, &mut |_, _| (), &mut |_, motion, _, h| {
            time += h;
            let square: f64 = lateral.iter().map(|&index| motion.q[index].powi(2)).sum();
            // Other motions excited by the push have died away in 2 s; then two windows of 3 s.
            if time > 2.0 {
                squares[usize::from(time > 5.0)] += square * h;
            }
        })
        .unwrap();
    let (before, after) = (squares[0], squares[1]);
    f64::ln(after / before) / 6.0
}

#[test]
fn the_speed_at_which_hunting_begins_is_that_of_the_eigenvalues() {
    let calm = hunting(200.0 / 3.6);
    let (mut low, mut high) = (20.0, 250.0);
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if hunting(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    assert!(calm < 0.0, "{calm}: unstable at the speed of the thesis");
    // Hunting of the bogies at 1.4 Hz, which the dampers of the bolsters hold up to some 240 km/h.
    assert!((60.0..75.0).contains(&low), "{low} m/s");
    let growth = [0.97, 1.03].map(|part| simulated_growth(part * low));
    assert!(growth[0] < 0.0 && growth[1] > 0.0, "{growth:?}");
}

#[test]
fn the_energy_of_a_full_run_on_rough_track_is_accounted_for() {
    let residual = |step: f64| {
        let mut alone = full(&full_scene(&[]), rough().as_ref());
        let state = rolling(&mut alone);
        let mut simulator = Simulator::new(alone, state, Vec::new(), 1e-3, 1.0, NewtonOptions::default());
        let mut balance = simulator.energy_balance();
        for i in 0..(2.0 / step).round() as usize {
            simulator
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
            simulator.balance(&mut balance, step);
        }
        assert!(balance.dissipated() > 0.0);
        balance.worst_residual() / balance.exchanged()
    };
    let (coarse, fine) = (residual(1e-3), residual(5e-4));
    assert!(coarse < 1e-4, "{coarse}");
    assert!(fine < 0.5 * coarse, "{fine} {coarse}");
}

#[test]
fn the_tangent_of_a_spin_is_the_derivative_of_its_moments() {
    let mut alone = full(&full_scene(&[]), None);
    let state = awkward(&alone.layout);
    assert_tangent(&mut alone.vehicle.spins[1], &alone.layout, &state, &[]);
}

#[test]
fn the_gyroscopic_moments_of_a_spin_do_no_work() {
    let mut alone = full(&full_scene(&[]), None);
    let state = awkward(&alone.layout);
    let found = crate::check::force(&mut alone.vehicle.spins[2], &state.motion(&[]));
    let power: f64 = found.iter().zip(&state.v).map(|(force, v)| force * v).sum();
    let size: f64 = found.iter().zip(&state.v).map(|(force, v)| (force * v).abs()).sum();
    assert!(size > 1.0 && power.abs() < 1e-12 * size, "{power} of {size}");
}

#[test]
fn sway_and_roll_are_those_of_a_car_body_on_its_springs() {
    // All motions free on the springs of the wheels; the rails hold the wheelsets sideways.
    let scene = full_scene(&[]);
    let entry = scene.vehicle.as_deref().unwrap().train().unwrap();
    let mut layout = Layout::new();
    let vehicle = Vehicle::build(entry, None, BASE, 9.81, "vehicle", &mut layout, false).unwrap();
    layout.fix(vehicle.pantograph_base.pose.translation);
    for (body, name) in vehicle.bodies.iter().zip(&vehicle.names) {
        if name.starts_with("wheelset") {
            layout.fix(body.pose.translation + 1);
            layout.fix(body.pose.rotation + 1);
            layout.fix(body.pose.rotation + 2);
        }
    }
    let mut alone = Alone { layout, vehicle };
    let mut state = alone.layout.state_at_rest();
    alone.vehicle.rest(&alone.layout, &mut state, &[]).unwrap();
    let found = modes(&mut alone, &state);
    let car = alone.vehicle.bodies()[0].pose;
    // Modes in which the car body moves sideways or rolls more than it does anything else.
    let sideways: Vec<f64> = (found.iter())
        .filter(|(omega, mode)| {
            let [y, roll] = [car.translation + 1, car.rotation].map(|index| mode[index].abs());
            let others = [car.translation + 2, car.rotation + 1, car.rotation + 2].map(|index| mode[index].abs());
            *omega > 1.0 && y.max(roll) > 10.0 * others.into_iter().fold(0.0, f64::max)
        })
        .map(|(omega, _)| *omega)
        .collect();
    // Car body and bolsters as one body on massless bogies: springs in series, the weight above them topples it.
    let (body, bolsters): (f64, f64) = (24_170.0, 2.0 * 1107.0);
    let mass = body + bolsters;
    let height = (body * 1.8289 + bolsters * 0.7088) / mass;
    let inertia = 30_000.0 + body * (1.8289 - height).powi(2) + 2.0 * 498.0 + bolsters * (height - 0.7088_f64).powi(2);
    let series = |a: f64, b: f64| a * b / (a + b);
    let lateral = series(8.0 * 80e3, 8.0 * 3.884e6);
    let roll = series(8.0 * 215e3 + 2.0 * 940e3, 8.0 * 1.22e6 * 1.0287_f64.powi(2));
    let h = height - 0.6;
    let toppling = mass * 9.81 * h;
    let (m, i) = (mass.sqrt(), inertia.sqrt());
    let coupling = lateral * h / (m * i);
    let matrix = Matrix2::new(
        lateral / mass,
        coupling,
        coupling,
        (lateral * h * h + roll - toppling) / inertia,
    );
    let mut expected: Vec<f64> = SymmetricEigen::new(matrix)
        .eigenvalues
        .iter()
        .map(|square| square.sqrt())
        .collect();
    expected.sort_by(f64::total_cmp);
    for expected in expected {
        let nearest = (sideways.iter())
            .map(|omega| (omega / expected - 1.0).abs())
            .fold(f64::INFINITY, f64::min);
        // Left out: masses of the bogies, and the distance of the planes of their springs.
        assert!(nearest < 0.08, "{expected} rad/s among {sideways:?}");
    }
}
