//! Names beside the points of a diagram, where there is room for them.

/// Width and height of the diagram's axes at least, points of the screen.
const AXES: [f64; 2] = [760.0, 440.0];

/// Width of a letter and height of a line of the names, likewise.
const LETTER: [f64; 2] = [6.0, 14.0];

/// Names that have been set in a diagram with two logarithmic axes, each above and to the right of its point.
pub struct Labels {
    /// Points of the screen per natural logarithm.
    scale: [f64; 2],
    /// Left, lower, right and upper end of each.
    taken: Vec<[f64; 4]>,
}

impl Labels {
    /// For points between `low` and `high`.
    pub fn new(low: (f64, f64), high: (f64, f64)) -> Self {
        let scale = |axes: f64, low: f64, high: f64| axes / (high / low).ln().max(1e-3);
        Self {
            scale: [scale(AXES[0], low.0, high.0), scale(AXES[1], low.1, high.1)],
            taken: Vec::new(),
        }
    }

    /// The name where it is free of those before it, else nothing.
    pub fn set(&mut self, (x, y): (f64, f64), name: String) -> String {
        let (left, lower) = (self.scale[0] * x.ln(), self.scale[1] * y.ln());
        let right = left + LETTER[0] * name.chars().count() as f64;
        let own = [left, lower, right, lower + LETTER[1]];
        let apart =
            |other: &[f64; 4]| own[0] >= other[2] || other[0] >= own[2] || own[1] >= other[3] || other[1] >= own[3];
        if !self.taken.iter().all(apart) {
            return String::new();
        }
        self.taken.push(own);
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_would_lie_on_another_one_is_left_out() {
        let mut labels = Labels::new((0.01, 0.1), (1.0, 100.0));
        let mut set = |x: f64, y: f64| !labels.set((x, y), "8, 1 ms".to_owned()).is_empty();
        assert!(set(0.1, 1.0));
        assert!(!set(0.101, 1.01), "on it");
        assert!(!set(0.12, 0.95), "partly on it");
        // A name is 42 points wide and 14 high; a decade is 380 and 147 points.
        assert!(set(0.1 * 10_f64.powf(43.0 / 380.0), 1.0), "beside it");
        assert!(set(0.1, 10_f64.powf(15.0 / 146.0)), "above it");
    }
}
