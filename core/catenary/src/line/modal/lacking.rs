//! Forces that slack droppers lack, within steps.
//!
//! With every dropper among the springs of the modes, a slack one has to be pushed open by what its spring would push
//! back with, up to some hundred newtons, and its tension `s` if it could push goes on smoothly where the dropper goes
//! slack or taut: velocities and accelerations of the wires do not jump there. Within a step the force `max(0, −s)` is
//! that of the parabola through `s` at the ends of the step and at the end of the step before, and modes feel the force
//! with a constant second derivative that has the same impulse.
use dynamics::unilateral::next_of;

/// Droppers from step to step.
pub(super) struct Lacking {
    /// Force that each dropper lacks at the end of the last step beyond what it lacks at rest, N.
    beyond_rest: Vec<f64>,
    /// Tension of each dropper at the ends of the last two steps, N, negative for what a slack one lacks: the first
    /// when last looked at, the second not a number where that is not known, and infinite where the last step was left
    /// out.
    tensions: [Vec<f64>; 2],
}

impl Lacking {
    /// Droppers with these tensions at rest, N.
    pub fn new(at_rest: &[f64]) -> Self {
        Self {
            beyond_rest: vec![0.0; at_rest.len()],
            tensions: [at_rest.to_vec(), vec![f64::INFINITY; at_rest.len()]],
        }
    }

    /// Force that each dropper lacks beyond what it lacks at rest, N.
    pub fn beyond_rest(&self) -> &[f64] {
        &self.beyond_rest
    }

    /// Droppers for which that is not nothing.
    pub fn all(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.beyond_rest.iter().copied().enumerate();
        all.filter(|(_, lacking)| *lacking != 0.0)
    }

    /// Tension of a dropper when last looked at, N, negative for what a slack one lacks.
    pub fn tension(&self, dropper: usize) -> f64 {
        self.tensions[0][dropper]
    }

    /// Tensions of a dropper one step before the coming one and at its begin, N; the first is not a number where that
    /// is not known. The last step was `as_long` as the coming one.
    pub fn course(&self, dropper: usize, as_long: bool) -> [f64; 2] {
        let [now, before] = &self.tensions;
        let known = as_long && before[dropper].is_finite();
        [if known { before[dropper] } else { f64::NAN }, now[dropper]]
    }

    /// Takes what droppers lack at the end of a step beyond what they lack at rest, N.
    pub fn end_step(&mut self, lacking: impl Iterator<Item = (usize, f64)>) {
        for (dropper, lacking) in lacking {
            self.beyond_rest[dropper] = lacking;
        }
    }

    /// Takes the tension of a dropper at the end of a step, N, negative for what a slack one lacks.
    pub fn look_at(&mut self, dropper: usize, tension: f64) {
        let [now, before] = &mut self.tensions;
        let last = std::mem::replace(&mut now[dropper], tension);
        before[dropper] = if before[dropper] == f64::INFINITY {
            f64::NAN
        } else {
            last
        };
    }

    /// Leaves a dropper out that is taut at the end of a step.
    pub fn leave_out(&mut self, dropper: usize) {
        self.tensions[1][dropper] = f64::INFINITY;
    }

    /// Writes all that the next step goes by.
    pub fn save(&self, out: &mut Vec<f64>) {
        for values in self.tensions.iter().chain([&self.beyond_rest]) {
            out.extend_from_slice(values);
        }
    }

    /// See [`Lacking::save`].
    pub fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let all = self.tensions.iter_mut().chain([&mut self.beyond_rest]).flatten();
        all.for_each(|value| *value = next_of(values));
    }
}

/// Bend of the force `max(0, −s)` within a step, its second derivative times the square of the step, N, and the change
/// of that with `s` at the end, –.
///
/// `s` is the parabola through the tensions one step before, at the begin and at the end, N, or straight where the
/// first is not a number. A bend of 1 N has an impulse of minus a twelfth of the step.
#[inline]
pub(super) fn bend([before, begin, end]: [f64; 3]) -> [f64; 2] {
    let half = if before.is_nan() {
        0.0
    } else {
        0.5 * (end - 2.0 * begin + before)
    };
    // A parabola is off its chord by a quarter of `half` at most: most droppers stay taut or slack all the time.
    if begin.min(end) >= 0.25 * half.max(0.0) {
        return [0.0; 2];
    }
    if begin.max(end) <= 0.25 * half.min(0.0) {
        return [-2.0 * half, if before.is_nan() { 0.0 } else { -1.0 }];
    }
    crossing([before, begin, end], half)
}

/// See [`bend`], of a tension that changes its sign; `half` of its second difference.
fn crossing([before, begin, end]: [f64; 3], half: f64) -> [f64; 2] {
    // With θ = τ/h: s = begin + rise θ + half θ².
    let rise = end - begin - half;
    let course = |theta: f64| begin + (rise + half * theta) * theta;
    let impulse = |theta: f64| (begin + (0.5 * rise + half / 3.0 * theta) * theta) * theta;
    // Of ½ (θ + θ²), by which s changes with its end; of θ where s is straight.
    let change = |theta: f64| {
        let straight = 0.5 * theta * theta;
        if before.is_nan() {
            straight
        } else {
            0.5 * (straight + theta.powi(3) / 3.0)
        }
    };
    let root = (rise * rise - 4.0 * half * begin).max(0.0).sqrt();
    // Either root without the difference of numbers alike.
    let sum = -0.5 * (rise + root.copysign(rise));
    let [first, second] = [sum / half, begin / sum].map(|root| if root > 0.0 && root < 1.0 { root } else { 1.0 });
    let ends = [0.0, first.min(second), first.max(second), 1.0];
    let mut lacking = [0.0; 2];
    for ends in ends.windows(2).filter(|ends| course(0.5 * (ends[0] + ends[1])) < 0.0) {
        lacking[0] -= impulse(ends[1]) - impulse(ends[0]);
        lacking[1] -= change(ends[1]) - change(ends[0]);
    }
    let straight = [
        0.5 * ((-begin).max(0.0) + (-end).max(0.0)),
        if end < 0.0 { -0.5 } else { 0.0 },
    ];
    std::array::from_fn(|k| 12.0 * (straight[k] - lacking[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dropper_that_stays_slack_has_the_second_difference_of_its_force() {
        let [bend, change] = bend([-4.0, -9.0, -11.0]);
        assert!((bend - (11.0 - 18.0 + 4.0)).abs() < 1e-12, "{bend}");
        assert!((change + 1.0).abs() < 1e-12, "{change}");
    }

    #[test]
    fn a_force_that_starts_within_a_step_has_its_impulse() {
        // Straight from 10 N to −30 N: slack for three quarters of the step, with a mean of 15 N there.
        for tensions in [[f64::NAN, 10.0, -30.0], [f64::NAN, -30.0, 10.0], [50.0, 10.0, -30.0]] {
            let [bend, _] = bend(tensions);
            assert!((0.5 * 30.0 - bend / 12.0 - 0.75 * 15.0).abs() < 1e-12, "{bend}");
        }
        // Taut at both ends, slack where (θ − ½)² < 1/16: −24 (1/16 − (θ − ½)²) has an impulse of ½ 24/12 there.
        let [bend, _] = bend([24.0 * 35.0 / 16.0, 4.5, 4.5]);
        assert!((bend + 12.0 * 24.0 / 6.0 / 8.0).abs() < 1e-12, "{bend}");
    }

    #[test]
    fn the_change_of_a_bend_is_its_derivative() {
        for [before, begin] in [
            [30.0, 8.0],
            [-20.0, -7.0],
            [f64::NAN, 8.0],
            [f64::NAN, -7.0],
            [-5.0, 3.0],
        ] {
            for end in [-21.0, -3.0, 2.0, 13.0] {
                let at = |end: f64| bend([before, begin, end]);
                let difference = (at(end + 1e-6)[0] - at(end - 1e-6)[0]) / 2e-6;
                assert!((at(end)[1] - difference).abs() < 1e-6, "{before} {begin} {end}");
            }
        }
    }

    #[test]
    fn a_saved_state_comes_back() {
        let mut lacking = Lacking::new(&[50.0, -2.0]);
        for step in 0..3 {
            lacking.end_step([(1, f64::from(step).powi(2))].into_iter());
            lacking.look_at(1, -f64::from(step));
            lacking.leave_out(0);
        }
        let (mut saved, mut again) = (Vec::new(), Vec::new());
        lacking.save(&mut saved);
        let mut other = Lacking::new(&[0.0; 2]);
        other.restore(&mut saved.iter());
        other.save(&mut again);
        let bits = |values: &[f64]| -> Vec<u64> { values.iter().map(|value| value.to_bits()).collect() };
        assert_eq!(bits(&saved), bits(&again));
    }
}
