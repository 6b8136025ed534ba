use super::*;
use dynamics::State;
use dynamics::testing::{LawTrio, plain_layout};

const LAW: DropperLaw = DropperLaw {
    stiffness: 1.0e5,
    damping: 300.0,
};

fn batch(mass: f64) -> Droppers {
    let upper = Attachment::new(Vector3::new(10.0, 0.3, 6.5), [Some(0), Some(1), Some(2)]);
    let lower = Attachment::new(Vector3::new(10.1, -0.1, 5.3), [Some(3), Some(4), Some(5)]);
    let length = (upper.reference - lower.reference).norm();
    let dropper = Dropper {
        upper,
        lower,
        unstressed_length: length - 1e-3,
        mass,
    };
    Droppers::new(LAW, vec![dropper], 9.81)
}

fn state(q: [f64; 6], v: [f64; 6]) -> State {
    let mut state = State::at_rest(6, 0, Vec::new());
    state.q.copy_from_slice(&q);
    state.v.copy_from_slice(&v);
    state
}

const TAUT: [f64; 6] = [0.02, -0.01, 0.03, -0.01, 0.005, 0.01];
const SLACK: [f64; 6] = [0.0, 0.0, -0.01, 0.0, 0.0, 0.02];
const MOVING: [f64; 6] = [0.3, -0.2, 0.1, -0.4, 0.6, -0.2];

fn force(droppers: &mut Droppers, state: &State) -> [f64; 6] {
    let mut out = [0.0; 6];
    droppers.add_force(&state.motion(&[]), &mut out);
    out
}

fn tangent(droppers: &mut Droppers, state: &State, weights: Weights) -> [f64; 36] {
    let places: Vec<u32> = (0..36).collect();
    let mut values = [0.0; 36];
    droppers.add_tangent(&state.motion(&[]), weights, &mut Blocks::add_to(&places, &mut values));
    values
}

const TRIO: LawTrio = LawTrio {
    q_step: 1e-6,
    v_step: 1e-6,
    tolerance: 1e-6,
};

#[test]
fn the_force_is_the_gradient_of_the_energy() {
    TRIO.assert_energy(&mut batch(0.4), &plain_layout(6), &state(TAUT, [0.0; 6]));
}

#[test]
fn the_tangent_is_the_jacobian_of_the_force_in_position_and_velocity() {
    TRIO.assert(&mut batch(0.4), &plain_layout(6), &state(TAUT, MOVING));
}

#[test]
fn a_slack_dropper_exerts_no_force_whatever_its_rate() {
    let mut droppers = batch(0.0);
    let at = state(SLACK, [0.0, 0.0, 5.0, 0.0, 0.0, -5.0]);
    droppers.end_step(&at.motion(&[]));
    assert_eq!(force(&mut droppers, &at), [0.0; 6]);
    assert_eq!(tangent(&mut droppers, &at, Weights { q: 1.0, v: 1.0 }), [0.0; 36]);
    assert_eq!(droppers.slack_count(&at.motion(&[])), 1);
    assert_eq!(droppers.slack_count(&state(TAUT, [0.0; 6]).motion(&[])), 0);
}

#[test]
fn a_taut_dropper_never_pushes() {
    let began = |start: f64| UnilateralStep::new(UnilateralStart::Known(start), 5e-4);
    assert_eq!(LAW.force(began(1e-3), 1e-4, -10.0), 0.0);
    assert_eq!(LAW.force(began(-1e-3), -5e-3, 10.0), 0.0);
    assert_eq!(LAW.force(began(1e-3), 1e-3, 0.1), 130.0);
}

#[test]
fn its_pull_is_equal_and_opposite_and_its_weight_is_shared() {
    let mut droppers = batch(0.4);
    let f = force(&mut droppers, &state(TAUT, MOVING));
    for (i, sum) in [0.0, 0.0, -0.4 * 9.81].into_iter().enumerate() {
        assert!((f[i] + f[i + 3] - sum).abs() < 1e-9); // rounding of 4 kN
    }
    let half = force(&mut droppers, &state(SLACK, [0.0; 6]));
    assert!((half[2] + 0.2 * 9.81).abs() < 1e-12 && (half[5] + 0.2 * 9.81).abs() < 1e-12);
}

/// The whole matrix that the solver sees: blocks of the factorisation and pushed corrections.
fn corrected(droppers: &mut Droppers, factored: &State, now: &State, weights: Weights) -> ([f64; 36], usize) {
    let mut matrix = tangent(droppers, factored, weights);
    let mut updates = Updates::default();
    droppers.push_updates(&now.motion(&[]), weights, &mut updates);
    updates.add_to_dense(6, &mut matrix);
    (matrix, updates.rank())
}

#[test]
fn a_dropper_that_tautens_after_the_factorisation_is_a_rank_one_correction() {
    let weights = Weights { q: 1.0, v: 700.0 };
    let (slack, taut) = (state(SLACK, [0.0; 6]), state(TAUT, MOVING));
    let (matrix, rank) = corrected(&mut batch(0.0), &slack, &taut, weights);
    let exact = tangent(&mut batch(0.0), &taut, weights);
    assert_eq!(rank, 1);
    let scale = weights.q * LAW.stiffness + weights.v * LAW.damping;
    for (approximate, exact) in matrix.iter().zip(&exact) {
        // The direction is that of the slack dropper, 3 cm of 1.27 m away.
        assert!((approximate - exact).abs() < 0.06 * scale, "{approximate} {exact}");
    }
}

#[test]
fn a_dropper_that_slackens_after_the_factorisation_is_taken_out_but_for_its_transverse_part() {
    let weights = Weights { q: 1.0, v: 700.0 };
    let (slack, taut) = (state(SLACK, [0.0; 6]), state(TAUT, [0.0; 6]));
    let (matrix, rank) = corrected(&mut batch(0.0), &taut, &slack, weights);
    assert_eq!(rank, 1);
    let pull = 2.0
        * force(&mut batch(0.0), &taut)
            .iter()
            .fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(matrix.iter().all(|value| value.abs() < pull), "only F/length may stay");
}

#[test]
fn an_unchanged_dropper_pushes_no_correction() {
    let weights = Weights { q: 1.0, v: 700.0 };
    for at in [state(SLACK, MOVING), state(TAUT, MOVING)] {
        assert_eq!(corrected(&mut batch(0.0), &at, &at, weights).1, 0);
    }
}

#[test]
fn a_restored_batch_pushes_the_same_correction() {
    let weights = Weights { q: 1.0, v: 700.0 };
    let (slack, taut) = (state(SLACK, [0.0; 6]), state(TAUT, MOVING));
    let pushed = |droppers: &mut Droppers| {
        let mut updates = Updates::default();
        droppers.push_updates(&taut.motion(&[]), weights, &mut updates);
        let mut sum = [0.0; 36];
        updates.add_to_dense(6, &mut sum);
        sum
    };
    let mut droppers = batch(0.0);
    tangent(&mut droppers, &slack, weights);
    droppers.begin_step(&taut.motion(&[]), 1e-3);
    let (mut memory, before) = (Vec::new(), pushed(&mut droppers));
    droppers.save(&mut memory);
    // A step that begins slack weighs the damper with another part.
    droppers.end_step(&slack.motion(&[]));
    assert_ne!(pushed(&mut droppers), before);
    let mut values = memory.iter();
    droppers.restore(&mut values);
    assert_eq!(values.len(), 0);
    assert_eq!(pushed(&mut droppers), before);
}

#[test]
fn a_planar_dropper_has_four_coordinates_and_the_same_force() {
    let (mut spatial, at) = (batch(0.2), state(TAUT, [0.0; 6]));
    let dropper = spatial.as_slice()[0];
    let mut planar = dropper;
    planar.upper = Attachment::new(dropper.upper.reference, [Some(0), None, Some(1)]);
    planar.lower = Attachment::new(dropper.lower.reference, [Some(2), None, Some(3)]);
    let mut planar = Droppers::new(LAW, vec![planar], 9.81);
    let mut flat = State::at_rest(4, 0, Vec::new());
    flat.q = vec![TAUT[0], TAUT[2], TAUT[3], TAUT[5]];
    let mut lateral_free = at.clone();
    (lateral_free.q[1], lateral_free.q[4]) = (0.0, 0.0);
    let expected = force(&mut spatial, &lateral_free);
    let mut out = [0.0; 4];
    planar.add_force(&flat.motion(&[]), &mut out);
    assert_eq!(out, [expected[0], expected[2], expected[3], expected[5]]);
    let mut places = Vec::new();
    planar.add_tangent(
        &flat.motion(&[]),
        Weights { q: 1.0, v: 0.0 },
        &mut Blocks::record(&mut places),
    );
    assert_eq!(places.len(), 16);
}

#[test]
fn in_a_step_that_closes_a_damper_acts_with_the_part_in_which_its_dropper_is_taut() {
    const HALF: f64 = 5e-4;
    let mut droppers = batch(0.0);
    let (slack, taut) = (state(SLACK, MOVING), state(TAUT, MOVING));
    let [begin, pose] = [&slack, &taut].map(|at| droppers.as_slice()[0].pose(&at.motion(&[])));
    let start = begin.elongation + HALF * begin.rate;
    droppers.begin_step(&slack.motion(&[]), 2.0 * HALF);
    droppers.end_step(&slack.motion(&[]));
    let closing = droppers.tension(0, &taut.motion(&[]));
    droppers.end_step(&taut.motion(&[]));
    let closed = droppers.tension(0, &taut.motion(&[]));
    let ahead = pose.elongation + HALF * pose.rate;
    let part = ahead / (ahead - start);
    let expected = LAW.stiffness * pose.elongation + part * LAW.damping * pose.rate;
    assert!(
        (closing - expected).abs() < 1e-12 * expected,
        "{closing} against {expected}"
    );
    assert_eq!(closed, LAW.stiffness * pose.elongation + LAW.damping * pose.rate);
    assert!(start < 0.0 && pose.elongation > 0.0 && closed != closing);
}

#[test]
fn the_dynamic_force_takes_the_mass_of_its_ends_into_account_within_any_range() {
    let mut droppers = batch(0.4);
    let at = state(TAUT, MOVING);
    let v_dot = [3.0, -4.0, 5.0, -6.0, 7.0, -8.0];
    let mut expected = force(&mut droppers, &at);
    for (force, v_dot) in expected.iter_mut().zip(v_dot) {
        *force -= 0.2 * v_dot;
    }
    let mut whole = [0.0; 6];
    droppers.add_dynamic_force(&at.motion(&[]), &v_dot, &mut whole);
    for (a, b) in whole.iter().zip(expected) {
        assert!((a - b).abs() < 1e-12 * 4e3, "{a} against {b}");
    }
    let mut part = [0.0; 6];
    droppers.add_dynamic_force_within(5..9, &at.motion(&[]), &v_dot, &mut part);
    assert_eq!(part[5], whole[5]);
    let mut nothing = [0.0; 6];
    droppers.add_dynamic_force_within(6..9, &at.motion(&[]), &v_dot, &mut nothing);
    assert_eq!(nothing, [0.0; 6]);
}

/// Nineteen droppers, the first ten and every third without lateral coordinates, some of them slack.
fn many() -> (Vec<Dropper>, State) {
    let mut next = 0;
    let mut droppers = Vec::new();
    for k in 0..19 {
        let mut end = |x: f64, y: f64, z: f64| {
            let coordinates = [0, 1, 2].map(|axis| {
                (axis != 1 || (k >= 10 && k % 3 != 0)).then(|| {
                    next += 1;
                    next - 1
                })
            });
            Attachment::new(Vector3::new(x, y, z), coordinates)
        };
        let x = 5.0 * f64::from(k);
        let (upper, lower) = (end(x, 0.1, 6.5), end(x + 0.1, -0.2, 5.3));
        let length = (upper.reference - lower.reference).norm();
        droppers.push(Dropper {
            upper,
            lower,
            unstressed_length: length + 2e-3 * f64::from(k % 4 - 2),
            mass: 0.1 * f64::from(k % 2),
        });
    }
    let mut state = State::at_rest(next, 0, Vec::new());
    shake(&mut state);
    (droppers, state)
}

fn shake(state: &mut State) {
    for (i, (q, v)) in state.q.iter_mut().zip(&mut state.v).enumerate() {
        *q = 1e-3 * (1.7 * i as f64).sin();
        *v = 0.3 * (2.3 * i as f64).cos();
    }
}

#[test]
fn droppers_in_groups_pull_as_each_by_itself() {
    let (droppers, state) = many();
    let motion = state.motion(&[]);
    let v_dot: Vec<f64> = (0..state.q.len()).map(|i| (0.9 * i as f64).sin()).collect();
    let weights = Weights { q: 1.0, v: 700.0 };
    let rank = |batch: &mut Droppers| {
        let mut updates = Updates::default();
        batch.push_updates(&motion, weights, &mut updates);
        updates.rank()
    };
    let mut batch = Droppers::new(LAW, droppers.clone(), 9.81);
    let slack = batch.slack_count(&motion);
    assert!(slack > 2 && slack < 17, "{slack}");
    let taut = rank(&mut batch);
    let mut all = vec![0.0; state.q.len()];
    batch.add_dynamic_force(&motion, &v_dot, &mut all);
    assert_eq!(rank(&mut batch), taut, "seen from the evaluation as from the motion");
    batch.end_step(&motion);
    for (one, (dropper, start_closure)) in droppers.iter().zip(&batch.start_closure).enumerate() {
        let elongation = dropper.pose(&motion).elongation;
        assert!((elongation - start_closure).abs() < 1e-14, "{one}: rounding of 1.2 m");
    }
    let mut sum = vec![0.0; state.q.len()];
    for dropper in droppers {
        let mut alone = Droppers::new(LAW, vec![dropper], 9.81);
        alone.add_dynamic_force(&motion, &v_dot, &mut sum);
    }
    for (all, sum) in all.iter().zip(sum) {
        assert!((all - sum).abs() < 1e-11, "rounding of 1 kN: {all} {sum}");
    }
    let mut part = vec![0.0; state.q.len()];
    Droppers::new(LAW, many().0, 9.81).add_dynamic_force_within(40..70, &motion, &v_dot, &mut part);
    assert_eq!(part[40..70], all[40..70]);
}

#[test]
fn droppers_pull_the_same_in_registers_of_any_width() {
    let mut state = State::at_rest(4 * 22, 0, Vec::new());
    shake(&mut state);
    let motion = state.motion(&[]);
    let ends = |k: usize, axes: usize| {
        let end = |place: usize, y: f64, z: f64| {
            let first = 4 * (2 * k + place);
            let coordinates = match axes {
                2 => [Some(first), None, Some(first + 1)],
                _ => [Some(first), Some(first + 1), Some(first + 2)],
            };
            Attachment::new(Vector3::new(5.0 * k as f64, y, z), coordinates)
        };
        let (upper, lower) = (end(0, 0.1, 6.5), end(1, -0.2, 5.3));
        let length = (upper.reference - lower.reference).norm();
        Dropper {
            upper,
            lower,
            unstressed_length: length + 1e-3 * ((k % 4) as f64 - 2.0),
            mass: 0.0,
        }
    };
    for axes in [2, 3] {
        let droppers: Vec<Dropper> = (0..11).map(|k| ends(k, axes)).collect();
        let pulled = |arch: Arch| {
            let mut batch = Droppers::new(LAW, droppers.clone(), 9.81);
            batch.arch = arch;
            batch.start_closure[2] = -1e-3;
            batch.half = 5e-4;
            let mut force = vec![0.0; state.q.len()];
            batch.add_dynamic_force(&motion, &state.v_dot, &mut force);
            assert!(batch.continues_to(&motion));
            force
        };
        let mut each = vec![0.0; state.q.len()];
        for (k, dropper) in droppers.iter().enumerate() {
            let pose = dropper.pose(&motion);
            let start = if k == 2 { -1e-3 } else { 0.0 };
            let step = UnilateralStep::new(UnilateralStart::Known(start), 5e-4);
            let pull = LAW.force(step, pose.elongation, pose.rate) * pose.direction;
            dropper.upper.add_force(&-pull, &mut each);
            dropper.lower.add_force(&pull, &mut each);
        }
        let mut kinds = vec![Arch::Scalar, Arch::new()];
        #[cfg(target_arch = "x86_64")]
        kinds.extend(pulp::x86::V3::try_new().map(Arch::V3));
        for arch in kinds {
            for (force, each) in pulled(arch).iter().zip(&each) {
                assert!(
                    (force - each).abs() < 1e-10,
                    "{axes} axes: {force} against {each}, 1e5 N/m times the rounding of 1.2 m"
                );
            }
        }
    }
}

#[test]
fn after_an_evaluation_within_a_range_extensions_are_those_of_the_new_motion() {
    let (droppers, mut state) = many();
    let v_dot = vec![0.0; state.q.len()];
    let mut force = vec![0.0; state.q.len()];
    let mut batch = Droppers::new(LAW, droppers.clone(), 9.81);
    batch.add_dynamic_force(&state.motion(&[]), &v_dot, &mut force);
    for index in 50..60 {
        state.q[index] += 1e-3;
        state.v[index] -= 0.1;
    }
    let motion = state.motion(&[]);
    let stale = |batch: &Droppers| -> usize {
        let all = droppers.iter().enumerate();
        all.filter(|(index, dropper)| {
            let (elongation, rate) = batch.extension(*index, &motion);
            let pose = dropper.pose(&motion);
            // Rounding of 1.2 m and of 0.5 m/s.
            (elongation - pose.elongation).abs() > 1e-14 || (rate - pose.rate).abs() > 1e-14
        })
        .count()
    };
    assert!(stale(&batch) > 1, "they are kept until the next evaluation");
    batch.add_dynamic_force_within(50..60, &motion, &v_dot, &mut force);
    assert_eq!(stale(&batch), 0);
    batch.end_step(&motion);
    state.q[0] += 1e-3;
    let pose = droppers[0].pose(&state.motion(&[]));
    let (elongation, _) = batch.extension(0, &state.motion(&[]));
    assert_eq!(elongation, pose.elongation, "after the step nothing is kept");
}

/// The batch of [`many`] after a step that began and ended taut, its tangent assembled there, and this motion.
fn many_taut(weights: Weights) -> (Droppers, State) {
    let (mut droppers, state) = many();
    for dropper in &mut droppers {
        dropper.unstressed_length -= 0.05;
    }
    let mut batch = Droppers::new(LAW, droppers, 9.81);
    batch.begin_step(&state.motion(&[]), H);
    batch.end_step(&state.motion(&[]));
    let mut places = Vec::new();
    batch.add_tangent(&state.motion(&[]), weights, &mut Blocks::record(&mut places));
    (batch, state)
}

const H: f64 = 1e-3;

#[test]
fn groups_that_are_as_taut_as_assembled_are_passed_over_and_no_others() {
    let weights = Weights { q: 1.0, v: 700.0 };
    let (mut batch, mut state) = many_taut(weights);
    let rank = |batch: &mut Droppers, state: &State, weights: Weights| {
        let mut updates = Updates::default();
        batch.push_updates(&state.motion(&[]), weights, &mut updates);
        updates.rank()
    };
    let v_dot = vec![0.0; state.q.len()];
    let mut force = v_dot.clone();
    batch.add_dynamic_force(&state.motion(&[]), &v_dot, &mut force);
    assert_eq!(rank(&mut batch, &state, weights), 0);
    let other = Weights { q: 1.0, v: 350.0 };
    assert_eq!(
        rank(&mut batch, &state, other),
        19,
        "another step asks for another slope"
    );
    // The upper end of the fourth dropper and the lower one of the last.
    for (dropper, end) in [(3, 0), (18, 1)] {
        let dropper = batch.as_slice()[dropper];
        let (attachment, sign) = [(dropper.upper, -1.0), (dropper.lower, 1.0)][end];
        state.q[attachment.coordinate(2).unwrap()] += sign * 0.1;
    }
    batch.add_dynamic_force(&state.motion(&[]), &v_dot, &mut force);
    assert_eq!(rank(&mut batch, &state, weights), 2);
}

#[test]
fn a_step_that_ends_unevaluated_ends_as_an_evaluated_one_or_asks_for_the_evaluation() {
    let weights = Weights { q: 1.0, v: 700.0 };
    let (mut batch, mut state) = many_taut(weights);
    let v_dot = vec![0.0; state.q.len()];
    let mut force = v_dot.clone();
    assert!(
        !batch.continues_to(&state.motion(&[])),
        "nothing was evaluated in this step"
    );
    batch.add_dynamic_force(&state.motion(&[]), &v_dot, &mut force);
    for (i, q) in state.q.iter_mut().enumerate() {
        *q += 1e-4 * (0.7 * i as f64).sin();
    }
    let (motion, mut evaluated) = (state.motion(&[]), batch.clone());
    assert!(batch.continues_to(&motion));
    evaluated.add_dynamic_force(&motion, &v_dot, &mut force);
    for batch in [&mut batch, &mut evaluated] {
        batch.end_step(&motion);
    }
    assert_eq!(batch.start_closure, evaluated.start_closure);
    batch.add_dynamic_force(&motion, &v_dot, &mut force);
    let upper = batch.as_slice()[17].upper;
    state.q[upper.coordinate(2).unwrap()] -= 0.1;
    assert!(!batch.continues_to(&state.motion(&[])), "one has gone slack");
    assert_eq!(batch.slack_count(&state.motion(&[])), 1);
}
