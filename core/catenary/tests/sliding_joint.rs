//! A mass that slides along a wire: energy, steps of the multiplier at element borders, the limit of the penalty law.
use catenary::{
    AxialLaw, BendingLaw, ContactPair, ContactTangent, Curve, CurveColumns, NodeMap, PenaltyContact, Rayleigh,
    SlidingJoint, StripContact, Wire, WireGeometry, WireSection,
};
use dynamics::{
    Blocks, Checkpoint, Columns, Constraint, Force, Frame, Jacobian, Layout, Marker, Motion, NewtonOptions, Simulator,
    State, StaticOptions, System, solve_static,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::sync::Arc;

/// A mass in the plane of x and z on two coordinates, under a dead vertical force; the strip is across the plane.
#[derive(Clone, Copy)]
struct Mass {
    /// Its first coordinate.
    first: usize,
    /// kg.
    mass: f64,
    /// Vertical force on it, N.
    lift: f64,
}

impl Marker for Mass {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let in_plane = |values: &[f64]| Vector3::new(values[self.first], 0.0, values[self.first + 1]);
        Frame {
            position: in_plane(motion.q),
            axes: Matrix3::identity(),
            velocity: in_plane(motion.v),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        columns.push(self.first, Vector3::x(), Vector3::zeros());
        columns.push(self.first + 1, Vector3::z(), Vector3::zeros());
    }
}

impl Force for Mass {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        force[self.first + 1] += self.lift;
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        let index = [self.first, self.first + 1];
        blocks.add(&index, &index, &[self.mass, 0.0, 0.0, self.mass]);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self.lift * motion.q[self.first + 1]
    }
}

/// Dead vertical forces on nodes: (index, N).
struct Loads(Vec<(usize, f64)>);

impl Force for Loads {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        self.0.iter().for_each(|&(index, value)| force[index] += value);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self
            .0
            .iter()
            .map(|&(index, value)| value * motion.q[index])
            .sum::<f64>()
    }
}

/// What a case is made of.
#[derive(Clone, Copy)]
struct Case {
    section: WireSection,
    length: f64,
    elements: usize,
    /// Vertical force (N) every so many metres.
    load: (f64, f64),
    mass: f64,
    lift: f64,
    /// m/s.
    speed: f64,
    /// Of the mass at t = 0, m.
    start: f64,
    h: f64,
    rho_inf: f64,
    jacobian: Jacobian,
    /// Of Newton's method, N.
    tolerance: f64,
}

/// A wire between pins, and a mass on it.
struct Slide {
    layout: Layout,
    geometry: Arc<WireGeometry>,
    wire: Wire,
    loads: Loads,
    mass: Mass,
    contact: Option<StripContact>,
}

impl System for Slide {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.wire);
        visit(&mut self.loads);
        visit(&mut self.mass);
        if let Some(contact) = &mut self.contact {
            visit(contact.force());
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        if let Some(constraint) = self.contact.as_mut().and_then(StripContact::constraint) {
            visit(constraint);
        }
    }
}

impl Slide {
    fn new(case: &Case) -> Self {
        let mut layout = Layout::new();
        let first = layout.add_coordinates(4 * (case.elements + 1), "wire");
        let lengths = vec![case.length / case.elements as f64; case.elements];
        let geometry = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &lengths, |node| {
            NodeMap::planar(first + 4 * node)
        });
        for node in [0, case.elements] {
            layout.fix(first + 4 * node);
            layout.fix(first + 4 * node + 1);
        }
        let (load, every) = case.load;
        let stride = (every / lengths[0]).round() as usize;
        let loaded = (1..case.elements).filter(|node| load != 0.0 && node % stride == 0);
        let loads = loaded.map(|node| (first + 4 * node + 1, load)).collect();
        let mass = Mass {
            first: layout.add_coordinates(2, "mass"),
            mass: case.mass,
            lift: case.lift,
        };
        let laws = (AxialLaw::Mean, BendingLaw::Constant);
        let geometry = Arc::new(geometry);
        let wire = Wire::new(case.section, Rayleigh::default(), laws, 9.81, Arc::clone(&geometry));
        Self {
            layout,
            geometry,
            wire,
            loads: Loads(loads),
            mass,
            contact: None,
        }
    }

    /// `v²Δκ/(1/m + Y)`: what the multiplier must fall by at the border between elements `node − 1` and `node` when the curvature
    /// grows there, and the same for a wire that does not answer, N.
    fn expected_step(&self, node: usize, state: &State, inverse_mass: &DMatrix<f64>) -> [f64; 2] {
        let border = self.geometry.node_s(node);
        let at = |s: f64| self.geometry.point(s, &state.q, &state.v);
        let (before, after) = (at(border - 1e-9), at(border + 1e-9));
        let tangent = after.r_s.normalize();
        let n = Vector3::new(-tangent.z, 0.0, tangent.x);
        let kink = n.dot(&(after.r_ss - before.r_ss)) / after.r_s.norm_squared();
        let velocity = Vector3::new(state.v[self.mass.first], 0.0, state.v[self.mass.first + 1]);
        let slide = tangent.dot(&(velocity - after.velocity));
        let mut columns = CurveColumns::default();
        self.geometry.columns(border, &mut columns);
        let mut row = DVector::zeros(state.q.len());
        for column in columns.as_slice() {
            row[column.index] += column.n.dot(&n);
        }
        self.layout.fixed().iter().for_each(|&index| row[index] = 0.0);
        let answer = row.dot(&(inverse_mass * &row));
        let whole = slide * slide * kink;
        [whole / (1.0 / self.mass.mass + answer), self.mass.mass * whole]
    }
}

/// The mass matrix with unit rows for what is held, inverted.
fn inverse_mass(system: &mut Slide) -> DMatrix<f64> {
    let mut places = Vec::new();
    system.forces(&mut |force| force.add_mass(&mut Blocks::record(&mut places)));
    let order: Vec<u32> = (0..places.len() as u32).collect();
    let mut values = vec![0.0; places.len()];
    let mut blocks = Blocks::add_to(&order, &mut values);
    system.forces(&mut |force| force.add_mass(&mut blocks));
    let n = system.layout.coordinates();
    let mut matrix = DMatrix::zeros(n, n);
    for (&(row, column), value) in places.iter().zip(values) {
        matrix[(row as usize, column as usize)] += value;
    }
    for &index in system.layout.fixed() {
        matrix.row_mut(index).fill(0.0);
        matrix.column_mut(index).fill(0.0);
        matrix[(index, index)] = 1.0;
    }
    matrix.try_inverse().expect("a mass matrix is positive definite")
}

/// The law between mass and wire: a joint, or a spring of this stiffness (N/m).
#[derive(Clone, Copy)]
enum Law {
    Joint,
    Spring(f64),
}

/// The wire at rest without the mass, and the mass put on it with its speed along it.
fn start(case: &Case, law: Law) -> Simulator<Slide> {
    let mut system = Slide::new(case);
    let mut state = system.layout.state_at_rest();
    // Without contact nothing holds the mass: it is left out of the statics by holding it.
    let first = system.mass.first;
    system.layout.fix(first);
    system.layout.fix(first + 1);
    solve_static(&mut system, &mut state, &[], &StaticOptions::default()).expect("the wire has an equilibrium");
    let held = system.layout.fixed().to_vec();
    system.layout.fix_within(0..first + 2, &held[..held.len() - 2]);

    let point = system.geometry.point(case.start, &state.q, &state.v);
    let tangent = point.r_s.normalize();
    let n = Vector3::new(-tangent.z, 0.0, tangent.x);
    let tangent_of = match case.jacobian {
        Jacobian::Full => ContactTangent::Exact,
        Jacobian::Modified => ContactTangent::RankOne,
    };
    let curve: Arc<dyn Curve> = system.geometry.clone();
    let (contact, at) = match law {
        Law::Joint => {
            let multiplier = system.layout.add_constraints(1);
            state.lambda.push(0.0);
            let joint = SlidingJoint::new(curve, Box::new(system.mass), multiplier, tangent_of);
            (StripContact::SlidingJoint(joint), point.r)
        }
        Law::Spring(stiffness) => {
            let law = PenaltyContact {
                stiffness,
                damping: 0.0,
            };
            let pair = ContactPair::new(law, curve, Box::new(system.mass), 1.0, tangent_of);
            (StripContact::Penalty(pair), point.r + case.lift / stiffness * n)
        }
    };
    system.contact = Some(contact);
    (state.q[first], state.q[first + 1]) = (at.x, at.z);
    let velocity = case.speed * tangent;
    (state.v[first], state.v[first + 1]) = (velocity.x, velocity.z);
    let options = NewtonOptions {
        tolerance: case.tolerance,
        constraint_tolerance: 1e-14,
        jacobian: case.jacobian,
        ..NewtonOptions::default()
    };
    let mut simulator = Simulator::new(system, state, Vec::new(), case.h, case.rho_inf, options);
    simulator.start_accelerations().expect("the mass is on the wire");
    simulator
}

fn step(simulator: &mut Simulator<Slide>, n: usize, h: f64) {
    let t = n as f64 * h;
    let result = simulator.advance(t, h, &mut |_, _| {}, &mut |_, _, _, _| {});
    result.unwrap_or_else(|error| panic!("t = {t}: {error}"));
}

/// Place of the mass on the wire (m) and the contact force (N).
fn seen(simulator: &mut Simulator<Slide>) -> (f64, f64) {
    let lambda = simulator.state().lambda.clone();
    let (system, motion) = simulator.parts();
    let contact = system
        .contact
        .as_ref()
        .and_then(|contact| contact.state(&motion, &lambda));
    let contact = contact.expect("on the wire");
    (contact.geometry.s, contact.force)
}

/// A light wire under a heavy mass: EN contact wire, 30 elements of 1 m, 2 kN.
const HANGING: Case = Case {
    section: WireSection {
        axial_stiffness: 1e6,
        bending_stiffness: 200.0,
        mass_per_length: 1.3,
        tension: 2e3,
    },
    length: 30.0,
    elements: 30,
    load: (0.0, 1.0),
    mass: 1.0,
    lift: 30.0,
    speed: 15.0,
    start: 4.3,
    h: 1e-4,
    // With the trapezoid, 1, the multiplier of an index-3 equation grows to and fro from step to step.
    rho_inf: 1.0,
    jacobian: Jacobian::Modified,
    tolerance: 1e-6,
};

#[test]
fn a_mass_that_slides_on_a_hanging_wire_keeps_its_energy_without_dissipation() {
    let errors = [1e-4, 5e-5].map(|h| {
        let case = Case { h, ..HANGING };
        let mut simulator = start(&case, Law::Joint);
        let mut balance = simulator.energy_balance();
        let scale = 0.5 * case.mass * case.speed * case.speed;
        let (mut worst, mut exchanged, mut n) = (0.0_f64, 0.0_f64, 0);
        let first = simulator.system.mass.first;
        while seen(&mut simulator).0 < 25.0 {
            step(&mut simulator, n, h);
            simulator.balance(&mut balance, h);
            worst = worst.max(balance.gained().abs());
            let state = simulator.state();
            let speed = state.v[first].hypot(state.v[first + 1]);
            exchanged = exchanged.max((0.5 * case.mass * speed * speed - scale).abs());
            n += 1;
        }
        let [gap, rate] = balance.drift();
        println!(
            "h = {h} s, rho_inf = {}, {n} steps, 20 borders: energy off by {:.2e} of {scale} J; the mass exchanged {exchanged:.1} J; constraint \
             {gap:.1e} m, its rate {rate:.1e} m/s",
            case.rho_inf,
            worst / scale
        );
        assert!(exchanged > 0.05 * scale, "{exchanged} J: the wire moves");
        
        worst / scale
    });
    assert!(errors[0] < 1e-6, "{errors:?}");
    // Of second order in phase, of third in what is damped: a loss of its own would not fall like that.
    let order = (errors[0] / errors[1]).log2();
    assert!((1.7..3.3).contains(&order), "order {order}");
}

/// Straight line through equally spaced values, at `at` steps from the first.
fn extrapolated(values: &[f64], at: f64) -> f64 {
    let n = values.len() as f64;
    let middle = 0.5 * (n - 1.0);
    let mean = values.iter().sum::<f64>() / n;
    let (mut above, mut below) = (0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let x = i as f64 - middle;
        above += x * value;
        below += x * x;
    }
    mean + above / below * (at - middle)
}

#[test]
fn the_multiplier_steps_at_element_borders_by_what_the_curvature_steps_by() {
    let mut largest = Vec::new();
    for elements in [32, 64, 128] {
        // A heavy stiff wire with a load every 2 m, a mass far lighter than its elements.
        let case = Case {
            section: WireSection {
                axial_stiffness: 1e7,
                bending_stiffness: 2e3,
                mass_per_length: 13.0,
                tension: 2e4,
            },
            length: 16.0,
            elements,
            load: (-1200.0, 2.0),
            mass: 1e-3,
            lift: 0.0,
            speed: 20.0,
            start: 1.6,
            h: 2e-5,
            rho_inf: 1.0,
            tolerance: 1e-7,
            ..HANGING
        };
        let mut simulator = start(&case, Law::Joint);
        let inverse = inverse_mass(&mut simulator.system);
        let element = case.length / elements as f64;
        let (mut course, mut borders) = (vec![seen(&mut simulator).1], Vec::new());
        let (mut here, mut n) = ((case.start / element) as usize, 0);
        while borders.len() < 22 && here + 1 < elements {
            step(&mut simulator, n, case.h);
            n += 1;
            let (s, force) = seen(&mut simulator);
            course.push(force);
            let now = (s / element) as usize;
            if now != here {
                here = now;
                let speed = simulator.state().v[simulator.system.mass.first];
                let passed = n as f64 - (s - here as f64 * element) / (speed * case.h);
                borders.push((
                    n,
                    passed,
                    simulator.system.expected_step(here, simulator.state(), &inverse),
                ));
            }
        }
        borders.retain(|(n, ..)| n + 60 < course.len());
        assert!(borders.len() >= 20, "{}", borders.len());
        let size = borders.iter().fold(0.0_f64, |max, (.., [step, _])| max.max(step.abs()));
        let mut worst = [0.0_f64; 2];
        for &(n, passed, expected) in &borders {
            // The steps about the border, in which the integrator's damping is at work, are left out.
            let (from, to) = (n + 8, n - 2);
            let before = extrapolated(&course[to - 30..to], passed - (to - 30) as f64);
            let after = extrapolated(&course[from..from + 30], passed - from as f64);
            for (worst, expected) in worst.iter_mut().zip(expected) {
                *worst = worst.max((before - after - expected).abs());
            }
        }
        println!(
            "elements of {element} m, {} borders: steps of up to {:.3} mN; off by {:.2} % of that from v²Δκ/(1/m + Y), {:.2} % from m v²Δκ",
            borders.len(),
            1e3 * size,
            100.0 * worst[0] / size,
            100.0 * worst[1] / size
        );
        assert!(worst[0] < 0.01 * size && worst[1] < 0.01 * size, "{worst:?} of {size}");
        largest.push(size);
    }
    assert!(largest.windows(2).all(|pair| pair[1] < 0.6 * pair[0]), "{largest:?}");
}

#[test]
fn the_penalty_law_goes_over_into_the_joint_with_its_stiffness() {
    let case = Case { lift: 100.0, ..HANGING };
    let course = |law: Law| {
        let mut simulator = start(&case, law);
        let first = simulator.system.mass.first;
        let heights = (0..10_000).map(|n| {
            step(&mut simulator, n, case.h);
            simulator.state().q[first + 1]
        });
        heights.collect::<Vec<f64>>()
    };
    let joint = course(Law::Joint);
    let errors = [1e5, 1e6, 1e7].map(|stiffness| {
        let spring = course(Law::Spring(stiffness));
        let squares = spring.iter().zip(&joint).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        (squares / joint.len() as f64).sqrt()
    });
    let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log10()).collect();
    println!("rms distance of the mass' height for 1e5, 1e6, 1e7 N/m: {errors:?} m, order in 1/k {orders:.3?}");
    // A spring yields by F/k.
    assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.1), "{orders:?}");
}

#[test]
fn full_newton_and_one_direction_per_step_give_the_same_motion() {
    let case = Case { h: 1e-3, ..HANGING };
    let run = |jacobian: Jacobian| {
        let mut simulator = start(&Case { jacobian, ..case }, Law::Joint);
        (0..1000).for_each(|n| step(&mut simulator, n, case.h));
        let most = simulator.counters().most_iterations;
        (simulator.state().clone(), most, simulator.counters())
    };
    let (exact, most_exact, _) = run(Jacobian::Full);
    let (modified, most, counters) = run(Jacobian::Modified);
    println!("most iterations: {most_exact} full, {most} modified; {counters:?}");
    let apart = exact
        .q
        .iter()
        .zip(&modified.q)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    // Newton's tolerance of 1e-6 N over 1000 steps on 2 kN of tension.
    assert!(apart < 1e-7, "{apart} m");
    assert!(most_exact <= 4, "{most_exact}");
    assert!(
        counters.factorizations < 20 && counters.newton_iterations < 6 * counters.micro_steps,
        "{counters:?}"
    );
}

#[test]
fn a_restored_slide_repeats_bit_for_bit() {
    let case = Case { h: 1e-3, ..HANGING };
    let mut simulator = start(&case, Law::Joint);
    let mut checkpoint = Checkpoint::default();
    (0..300).for_each(|n| step(&mut simulator, n, case.h));
    simulator.save(&mut checkpoint);
    (300..500).for_each(|n| step(&mut simulator, n, case.h));
    let end = simulator.state().clone();
    simulator.restore(&checkpoint).expect("a saved state");
    (300..500).for_each(|n| step(&mut simulator, n, case.h));
    assert_eq!(*simulator.state(), end);
    let mut other = start(&case, Law::Joint);
    other.restore(&checkpoint).expect("a saved state");
    (300..500).for_each(|n| step(&mut other, n, case.h));
    assert_eq!(*other.state(), end, "in another instance");
}

#[test]
fn a_mass_put_on_a_sloping_wire_across_it_starts_with_the_wire_moving_along() {
    let case = HANGING;
    let mut simulator = start(&case, Law::Joint);
    let first = simulator.system.mass.first;
    let mut state = simulator.state().clone();
    // Level instead of along the wire.
    (state.v[first], state.v[first + 1]) = (case.speed, 0.0);
    simulator.set_state(state);
    simulator.start_accelerations().expect("the mass is on the wire");
    let mut balance = simulator.energy_balance();
    assert!(balance.drift()[1] < 1e-12, "{} m/s", balance.drift()[1]);
    let vertical = simulator.state().v[first + 1];
    assert!(
        vertical < -0.01 && vertical > -case.speed,
        "{vertical} m/s: the wire slopes down"
    );
    // Consistent: the first multipliers are near the one at the start.
    let force = seen(&mut simulator).1;
    step(&mut simulator, 0, 1e-5);
    simulator.balance(&mut balance, 1e-5);
    let next = seen(&mut simulator).1;
    assert!(
        (next - force).abs() < 0.05 * force.abs().max(1.0),
        "{force} N, then {next} N"
    );
    assert!(balance.drift()[1] < 1e-6, "{} m/s", balance.drift()[1]);
}
