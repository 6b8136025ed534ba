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

    /// True for a dropper that was left out at the end of the step.
    pub fn is_left_out(&self, dropper: usize) -> bool {
        self.tensions[1][dropper] == f64::INFINITY
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

#[cfg(test)]
mod tests {
    use super::*;

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
