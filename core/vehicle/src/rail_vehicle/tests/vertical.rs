//! The vehicle in the plane along the track.
use super::*;
use crate::check::{assert_tangent, awkward, dense};
use dynamics::{NewtonOptions, Simulator};
use nalgebra::{DVector, SMatrix};

fn vertical(scene: &Scene, track: Option<&TrackShape>) -> Alone {
    let mut layout = Layout::new();
    let entry = scene.vehicle.as_deref().unwrap().train().unwrap();
    let vehicle = Vehicle::vertical(entry, track, BASE, 9.81, "vehicle", &mut layout).unwrap();
    Alone { layout, vehicle }
}

/// The vehicle at rest, without a pantograph.
fn resting(alone: &mut Alone) -> State {
    let mut state = alone.layout.state_at_rest();
    alone.vehicle.rest(&alone.layout, &mut state, &[]).unwrap();
    state
}

/// Undamped angular frequencies (rad/s, ascending) and modes of the free coordinates, about a state.
pub(super) fn modes(alone: &mut Alone, state: &State) -> Vec<(f64, DVector<f64>)> {
    let n = state.q.len();
    let motion = state.motion(&[]);
    let stiffness = dense(n, &mut |blocks| {
        let weights = dynamics::Weights { q: 1.0, v: 0.0 };
        alone
            .vehicle
            .forces(&mut |force| force.add_tangent(&motion, weights, blocks));
        let mut first = 0;
        for joint in &alone.vehicle.joints {
            joint.add_geometric_stiffness(&motion, &state.lambda[first..], blocks);
            first += joint.dimension();
        }
    });
    let mass = dense(n, &mut |blocks| {
        alone.vehicle.forces(&mut |force| force.add_mass(blocks))
    });
    let basis = free_motions(alone, state);
    let (mass, stiffness) = (
        basis.transpose() * mass * &basis,
        basis.transpose() * stiffness * &basis,
    );
    let root = mass.cholesky().unwrap().l();
    let inverse = root.try_inverse().unwrap();
    let symmetric = &inverse * (&stiffness + stiffness.transpose()) * 0.5 * inverse.transpose();
    let eigen = SymmetricEigen::new(symmetric);
    let mut found: Vec<_> = (0..basis.ncols())
        .map(|i| {
            let mode = &basis * inverse.transpose() * eigen.eigenvectors.column(i);
            (eigen.eigenvalues[i].max(0.0).sqrt(), mode.normalize())
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// Angular frequencies of a chain of masses, the last one on rigid ground; spring i is below mass i.
fn chain<const N: usize>(masses: [f64; N], springs: [f64; N]) -> Vec<f64> {
    let mut scaled = SMatrix::<f64, N, N>::zeros();
    for i in 0..N {
        scaled[(i, i)] += springs[i] / masses[i];
        if i + 1 < N {
            scaled[(i + 1, i + 1)] += springs[i] / masses[i + 1];
            let coupling = -springs[i] / (masses[i] * masses[i + 1]).sqrt();
            scaled[(i, i + 1)] = coupling;
            scaled[(i + 1, i)] = coupling;
        }
    }
    let dynamic = DMatrix::from_iterator(N, N, scaled.iter().copied());
    let mut found: Vec<f64> = SymmetricEigen::new(dynamic)
        .eigenvalues
        .iter()
        .map(|square| square.sqrt())
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

#[test]
fn the_vehicle_of_the_thesis_has_its_bodies_bushings_bearings_and_joints() {
    let alone = vertical(&scene(&[]), None);
    // [Thesis, section 3.1]: 14 with the ground, 48, 8 and 2.
    assert_eq!(alone.vehicle.bodies().len(), 13);
    assert_eq!(alone.vehicle.counts(), [48, 8, 2]);
    let mass: f64 = alone.vehicle.bodies().iter().map(|body| body.mass).sum();
    assert!((mass - 43_052.0).abs() < 1e-9);
}

#[test]
fn each_wheel_bears_an_eighth_of_the_weight_at_rest() {
    let mut alone = vertical(&scene(&[]), None);
    let state = resting(&mut alone);
    let loads: Vec<f64> = alone.vehicle.wheel_loads(&state.motion(&[])).collect();
    assert_eq!(loads.len(), 8);
    for load in loads {
        // 52.8 kN; the preloads are weights to the printed digit.
        assert!((load - 43_052.0 * 9.81 / 8.0).abs() < 1.0, "{load}");
    }
    // Bearings and wheels give way by the load over their stiffness, no spring does: 0.21 + 0.04 mm.
    let base = alone.vehicle.base_frame(&state.motion(&[])).position;
    assert!((base.z - 3.425 + 0.00026).abs() < 2e-5, "{base}");
}

#[test]
fn bounce_is_that_of_a_chain_of_masses() {
    let mut alone = vertical(&scene(&[]), None);
    let state = resting(&mut alone);
    let found = modes(&mut alone, &state);
    let masses = [24170.0 + 2.0 * 1107.0, 2.0 * 3214.0, 4.0 * 469.0, 4.0 * 2091.0];
    let springs = [8.0 * 215e3, 8.0 * 1.22e6, 8.0 * 2e8, 8.0 * 1.2e9];
    for expected in chain(masses, springs) {
        let nearest = found
            .iter()
            .map(|(omega, _)| (omega / expected - 1.0).abs())
            .fold(f64::INFINITY, f64::min);
        // All bodies rise together, without pitch: nothing is left out of the chain but the longitudinal motion that
        // weights on preloaded springs couple in.
        assert!(nearest < 2e-3, "{expected} rad/s is missed by {nearest}");
    }
    // The textbook's two masses: rigid below the frames. 1.15 Hz.
    let two = chain([masses[0], masses[1]], [springs[0], springs[1]])[0];
    let (omega, mode) = found
        .iter()
        .find(|(omega, _)| (omega / two - 1.0).abs() < 0.02)
        .expect("bounce of the car body");
    let car = &alone.vehicle.bodies()[0].pose;
    assert!(mode[car.translation + 2].abs() > 10.0 * mode[car.rotation + 1].abs());
    assert!((1.0..1.3).contains(&(omega / std::f64::consts::TAU)), "{omega}");
}

#[test]
fn pitch_is_that_of_car_body_and_frames_on_their_springs() {
    let mut alone = vertical(&scene(&[]), None);
    let state = resting(&mut alone);
    let found = modes(&mut alone, &state);
    let car = alone.vehicle.bodies()[0].pose;
    let pitches = |mode: &DVector<f64>| mode[car.rotation + 1].abs() > mode[car.translation + 2].abs();
    let (omega, _) = found.iter().find(|(_, mode)| pitches(mode)).unwrap();
    // Half of the car body with one bolster over one bogie, turned into a mass at the distance a of the bogies from the
    // middle: I/a² over springs in series; the frame moves with them.
    let a = 6.2865_f64;
    let inertia = 687_231.0 + 2.0 * 1107.0 * (a * a + 1.1201_f64.powi(2)) + 2.0 * 20.4;
    let expected = chain([inertia / (a * a), 2.0 * 3214.0], [8.0 * 215e3, 8.0 * 1.22e6])[0];
    // Left out: the anchor rods below the centre of mass, which drive the frames' pitch.
    assert!((omega / expected - 1.0).abs() < 0.05, "{omega} against {expected}");
}

#[test]
fn the_tangent_of_a_wheel_is_the_derivative_of_its_force() {
    let mut alone = vertical(&scene(&[]), rough().as_ref());
    let mut state = awkward(&alone.layout);
    state.t = 1.3;
    assert_tangent(alone.vehicle.wheels[3].contribution(), &alone.layout, &state, &[]);
}

fn simulator(mut alone: Alone, rho_inf: f64) -> Simulator<Alone> {
    let state = resting(&mut alone);
    Simulator::new(alone, state, Vec::new(), 1e-3, rho_inf, NewtonOptions::default())
}

#[test]
fn a_vehicle_at_rest_on_smooth_track_stays_at_rest() {
    let mut simulator = simulator(vertical(&scene(&[]), None), 0.9);
    let start = simulator.state().clone();
    simulator
        .advance(0.0, 2.0, &mut |_, _| (), &mut |_, _, _, _| ())
        .unwrap();
    let moved = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // Forces of the statics are balanced to 1e-5 N; the softest spring has 1e6 N/m.
    assert!(moved(&simulator.state().q, &start.q) < 1e-10);
    assert!(moved(&simulator.state().v, &start.v) < 1e-9);
}

#[test]
fn the_energy_of_a_run_on_rough_track_is_accounted_for() {
    let residual = |step: f64| {
        let mut simulator = simulator(vertical(&scene(&[]), rough().as_ref()), 1.0);
        let mut balance = simulator.energy_balance();
        for i in 0..(3.0 / step).round() as usize {
            simulator
                .advance(i as f64 * step, step, &mut |_, _| (), &mut |_, _, _, _| ())
                .unwrap();
            simulator.balance(&mut balance, step);
        }
        assert!(balance.exchanged() > 10.0, "{}", balance.exchanged());
        assert!(balance.dissipated() > 0.0);
        balance.worst_residual() / balance.exchanged()
    };
    // The trapezoid's error of the rails' work falls with the square of the step.
    let (coarse, fine) = (residual(1e-3), residual(5e-4));
    assert!(coarse < 1e-2, "{coarse}");
    assert!(fine < 0.4 * coarse, "{fine} {coarse}");
}
