//! Forces that slack droppers lack, within steps.
//!
//! With every dropper among the springs of the modes, a slack one has to be pushed open by what its spring would push
//! back with, up to some hundred newtons. Two corrections make the straight force of a step what it stands for: the
//! bend of a force that is smooth, continued from the steps before, and the impulse that the straight force of the last
//! step had too much where the dropper went slack or taut within it.
use super::modes::Modes;
use dynamics::unilateral::next_of;

/// Forces that all droppers lack, at the ends of steps.
pub(super) struct Lacking {
    /// Force that each dropper lacks beyond what it lacks at rest, N: at the end of the last step, and of the two
    /// before where these were as long; else not a number.
    last: [Vec<f64>; 3],
    /// Impulse that the straight force of the last step had too much, N s.
    excess: Vec<f64>,
    /// Length of the last step, s.
    h: f64,
}

impl Lacking {
    /// Forces at rest.
    pub fn new(droppers: usize) -> Self {
        let unknown = vec![f64::NAN; droppers];
        Self {
            last: [vec![0.0; droppers], unknown.clone(), unknown],
            excess: vec![0.0; droppers],
            h: 0.0,
        }
    }

    /// Force that each dropper lacks beyond what it lacks at rest, N.
    pub fn beyond_rest(&self) -> &[f64] {
        &self.last[0]
    }

    /// Droppers for which that is not nothing.
    pub fn all(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.last[0].iter().copied().enumerate();
        all.filter(|(_, lacking)| *lacking != 0.0)
    }

    /// Takes what the droppers lack at the end of a step of `h` s.
    pub fn end_step(&mut self, h: f64, lacking: impl Iterator<Item = (usize, f64)>) {
        let [now, before, earlier] = &mut self.last;
        if as_long(h, self.h) {
            earlier.copy_from_slice(before);
        } else {
            earlier.fill(f64::NAN);
        }
        before.copy_from_slice(now);
        self.h = h;
        self.excess.fill(0.0);
        for (dropper, lacking) in lacking {
            now[dropper] = lacking;
        }
    }

    /// Takes the tension of a dropper before and after the last step, N, negative for what a slack one lacks.
    ///
    /// A force `max(0, −s)` with `s` straight from `s₀` to `s₁` of another sign has the impulse of the straight force
    /// but for `h |s₀ s₁| / (2 |s₁ − s₀|)`.
    pub fn cross(&mut self, dropper: usize, [before, now]: [f64; 2]) {
        if before * now < 0.0 {
            self.excess[dropper] = 0.5 * self.h * (before * now / (now - before)).abs();
        }
    }

    /// Droppers whose force in the coming step of `h` s is not straight, with minus the second derivative of the force
    /// that pulls at the line, N/s².
    pub fn bends<'a>(&'a self, modes: &'a Modes, h: f64) -> impl Iterator<Item = (usize, f64)> + 'a {
        let known = as_long(h, self.h);
        let [now, before, earlier] = &self.last;
        (0..if known { now.len() } else { 0 }).filter_map(move |dropper| {
            let all = [now[dropper], before[dropper], earlier[dropper]];
            if all == [0.0; 3] && self.excess[dropper] == 0.0 {
                return None;
            }
            let at_rest = modes.lacks_at_rest(dropper);
            let smooth = all.iter().all(|lacking| lacking + at_rest > 0.0);
            let second = if smooth { all[0] - 2.0 * all[1] + all[2] } else { 0.0 };
            // A bend of 1 N/s² is an impulse of h³/12.
            let bend = (second + 12.0 * self.excess[dropper] / h) / (h * h);
            (bend != 0.0).then_some((dropper, bend))
        })
    }

    /// Writes all that the next step goes by.
    pub fn save(&self, out: &mut Vec<f64>) {
        out.push(self.h);
        for values in self.last.iter().chain([&self.excess]) {
            out.extend_from_slice(values);
        }
    }

    /// See [`Lacking::save`].
    pub fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        self.h = next_of(values);
        let all = self.last.iter_mut().chain([&mut self.excess]).flatten();
        all.for_each(|value| *value = next_of(values));
    }
}

/// True for two steps of the same length that is not zero.
fn as_long(h: f64, last: f64) -> bool {
    h > 0.0 && (h - last).abs() <= 1e-9 * h
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_ends_within_a_step_gives_back_what_the_straight_force_had_too_much() {
        let h = 1e-3;
        let mut lacking = Lacking::new(1);
        lacking.end_step(h, [(0, 30.0)].into_iter());
        lacking.end_step(h, [(0, 0.0)].into_iter());
        // From −30 N to 10 N: slack for three quarters of the step, with a mean of 15 N there.
        lacking.cross(0, [-30.0, 10.0]);
        let straight = 0.5 * h * 30.0;
        assert!((straight - lacking.excess[0] - 0.75 * h * 15.0).abs() < 1e-12);
        lacking.end_step(h, std::iter::empty());
        assert_eq!(lacking.excess, [0.0]);
    }

    #[test]
    fn a_saved_state_comes_back() {
        let mut lacking = Lacking::new(2);
        for step in 0..3 {
            lacking.end_step(1e-3, [(1, f64::from(step).powi(2))].into_iter());
        }
        lacking.cross(0, [1.0, -3.0]);
        let (mut saved, mut again) = (Vec::new(), Vec::new());
        lacking.save(&mut saved);
        let mut other = Lacking::new(2);
        other.restore(&mut saved.iter());
        other.save(&mut again);
        let bits = |values: &[f64]| -> Vec<u64> { values.iter().map(|value| value.to_bits()).collect() };
        assert_eq!(bits(&saved), bits(&again));
    }
}
