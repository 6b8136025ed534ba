//! Loads that do not depend on the motion.
use dynamics::{Force, Motion};

/// A constant generalised force.
#[derive(Clone, Debug, Default)]
pub(crate) struct DeadLoad {
    /// Coordinate and force on it, N.
    pub entries: Vec<(usize, f64)>,
}

impl Force for DeadLoad {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        for &(index, value) in &self.entries {
            force[index] += value;
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self
            .entries
            .iter()
            .map(|&(index, value)| value * motion.q[index])
            .sum::<f64>()
    }
}
