//! Force that a member which only pulls lacks within a step.

/// Bend of the force `max(0, −s)` within a step, its second derivative times the square of the step, N, and the change
/// of that with `s` at the end, –.
///
/// `s` is the parabola through the tensions one step before, at the begin and at the end, N, or straight where the
/// first is not a number. A bend of 1 N has an impulse of minus a twelfth of the step.
#[must_use]
#[inline]
pub fn bend([before, begin, end]: [f64; 3]) -> [f64; 2] {
    let half = if before.is_nan() {
        0.0
    } else {
        0.5 * (end - 2.0 * begin + before)
    };
    // A parabola is off its chord by a quarter of `half` at most: most members stay taut or slack all the time.
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
    fn a_member_that_stays_slack_has_the_second_difference_of_its_force() {
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
}
