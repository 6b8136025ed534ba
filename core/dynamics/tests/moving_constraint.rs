//! A mass that is held on a path which passes under it, against closed forms.
use dynamics::{
    Blocks, Constraint, Force, GeneralizedAlpha, JacobianRows, Layout, LowRank, Motion, NewtonOptions, State, System,
    Updates, Weights,
};

/// kg, kg, N/m.
const MASS: f64 = 2.0;
const RIDER: f64 = 0.5;
const SPRING: f64 = 800.0;

/// Height (m) of a path at a time (s), with its first and second rate.
type Path = fn(f64) -> [f64; 3];

/// Two masses on a spring on top of each other, without weight.
struct Masses;

impl Force for Masses {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let stretch = motion.q[1] - motion.q[0];
        force[0] += SPRING * stretch;
        force[1] -= SPRING * stretch;
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let k = weights.q * SPRING;
        blocks.add(&[0, 1], &[0, 1], &[k, -k, -k, k]);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        blocks.add(&[0, 1], &[0, 1], &[MASS, 0.0, 0.0, RIDER]);
    }
}

/// Holds the lower mass on the path: `g = w(t) − z`.
struct Rail(Path);

impl Force for Rail {
    fn add_force(&mut self, _motion: &Motion<'_>, _force: &mut [f64]) {}

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }
}

impl LowRank for Rail {
    fn push_updates(&mut self, _motion: &Motion<'_>, _weights: Weights, updates: &mut Updates) {
        updates.border(0, 0, 0, std::iter::once((0, -1.0, 0.0)));
    }
}

impl Constraint for Rail {
    fn dimension(&self) -> usize {
        1
    }

    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]) {
        g[0] = self.0(motion.t)[0] - motion.q[0];
    }

    fn jacobian(&self, _motion: &Motion<'_>, rows: &mut JacobianRows<'_>) {
        rows.add(0, &[0], &[-1.0]);
    }

    fn moves(&self) -> bool {
        true
    }

    fn add_rate(&self, motion: &Motion<'_>, rates: &mut [f64]) {
        rates[0] += self.0(motion.t)[1] - motion.v[0];
    }
}

struct Ride {
    layout: Layout,
    masses: Masses,
    rail: Rail,
}

impl System for Ride {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.masses);
        visit(&mut self.rail);
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        visit(&mut self.rail);
    }
}

/// The state at the end of each of `count` steps of `h` s from a state that is completed by its accelerations.
fn ride(path: Path, start: [[f64; 2]; 2], (rho_inf, h, count): (f64, f64, usize)) -> Vec<State> {
    let mut layout = Layout::new();
    layout.add_coordinates(2, "masses");
    layout.add_constraints(1);
    let mut state = layout.state_at_rest();
    let mut ride = Ride {
        layout,
        masses: Masses,
        rail: Rail(path),
    };
    (state.q, state.v) = (start[0].to_vec(), start[1].to_vec());
    let options = NewtonOptions {
        tolerance: 1e-9,
        constraint_tolerance: 1e-15,
        ..NewtonOptions::default()
    };
    let mut integrator = GeneralizedAlpha::new(rho_inf, options);
    integrator.start_accelerations(&mut ride, &mut state, &[]).unwrap();
    let steps = (1..=count).map(|n| {
        integrator.step(&mut ride, &mut state, &[], n as f64 * h, h).unwrap();
        state.clone()
    });
    steps.collect()
}

/// 1/s, m.
const WAVE: f64 = 25.0;
const AMPLITUDE: f64 = 0.03;

fn waves(t: f64) -> [f64; 3] {
    let (sin, cos) = (WAVE * t).sin_cos();
    [AMPLITUDE * sin, AMPLITUDE * WAVE * cos, -AMPLITUDE * WAVE * WAVE * sin]
}

#[test]
fn positions_and_multiplier_follow_a_forced_vibration_to_second_order_whatever_rho_inf() {
    // m₂ ÿ = c (w − y) is met by y = w c/(c − m₂ Ω²); λ is what the path presses up with.
    let share = SPRING / (SPRING - RIDER * WAVE * WAVE);
    let multiplier = |t: f64| MASS * waves(t)[2] + SPRING * (1.0 - share) * waves(t)[0];
    let start = [[0.0, 0.0], [waves(0.0)[1], share * waves(0.0)[1]]];
    for rho_inf in [1.0, 0.9, 0.5, 0.0] {
        let errors = [2e-3, 1e-3].map(|h| {
            let count = (2.0_f64 / h).round() as usize;
            let states = ride(waves, start, (rho_inf, h, count));
            let mut worst = [0.0_f64; 3];
            for state in &states {
                let path = waves(state.t)[0];
                let of_masses = (state.q[0] - path).abs().max((state.q[1] - share * path).abs());
                worst[0] = worst[0].max(of_masses);
                // The auxiliary accelerations start with the accelerations, (α_f − α_m) h too late.
                if state.t > 0.05 {
                    worst[1] = worst[1].max((state.lambda[0] - multiplier(state.t)).abs());
                }
                worst[2] = worst[2].max((state.v[0] - waves(state.t)[1]).abs());
            }
            worst
        });
        let orders = [0, 1].map(|i| (errors[0][i] / errors[1][i]).log2());
        println!(
            "rho_inf = {rho_inf}: errors of positions (m), multiplier (N), rate (m/s) {errors:?}; orders {orders:.2?}"
        );
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.2), "{orders:?}");
        // The drift of the position, 1e-5 m at most, times 50 1/s.
        assert!(errors[1][2] < 5e-4, "{errors:?}");
    }
}

/// m/s².
const BEND: f64 = 40.0;

/// Level up to 0.0203 s, then bent upwards.
fn bend(t: f64) -> [f64; 3] {
    let after = (t - 0.0203).max(0.0);
    [0.5 * BEND * after * after, BEND * after, BEND]
}

#[test]
fn where_the_path_bends_the_multiplier_steps_within_two_steps_and_does_not_follow_to_and_fro() {
    const H: f64 = 1e-3;
    for rho_inf in [1.0, 0.9, 0.5, 0.0] {
        let states = ride(bend, [[0.0; 2]; 2], (rho_inf, H, 2000));
        let excess = |state: &State| {
            let rider = SPRING * (state.q[0] - state.q[1]);
            state.lambda[0] - rider
        };
        let before = states[..20].iter().map(|state| excess(state).abs());
        assert!(before.fold(0.0, f64::max) < 1e-9, "Newton's tolerance");
        let step = MASS * BEND;
        let off = states[22..].iter().map(|state| (excess(state) / step - 1.0).abs());
        let worst = off.fold(0.0, f64::max);
        println!("rho_inf = {rho_inf}: {worst:.1e} of {step} N");
        // A bend within a step leaves up to h²/8 of it in the position, and ω² = 2500 1/s² of that in the force; the
        // rider's force, of 20 rad/s squared times h²/12 and less, is taken at the ends of steps where its mean acts.
        assert!(worst < 1e-3, "rho_inf = {rho_inf}: {worst}");
        // The mean of the accelerations that Newmark's formula takes over the step: β + ½ of it at most.
        let gap = states.iter().map(|state| (state.q[0] - bend(state.t)[0]).abs());
        assert!(gap.fold(0.0, f64::max) < BEND * H * H);
    }
}
