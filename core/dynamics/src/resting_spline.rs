//! Curves through samples that begin and end at rest.
use crate::hermite::hermite;

/// A cubic spline through samples, twice continuously differentiable, with slope zero at both ends and constant beyond.
#[derive(Clone, Debug, PartialEq)]
pub struct RestingSpline {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

impl RestingSpline {
    /// Spline through samples with ascending `x`, at least one.
    #[must_use]
    pub fn new(x: Vec<f64>, y: Vec<f64>) -> Self {
        let n = x.len();
        debug_assert!(n > 0 && n == y.len() && x.windows(2).all(|pair| pair[0] < pair[1]));
        // Continuous second derivatives: tridiagonal equations for the slopes, the outer two of which are zero.
        let (mut slopes, mut upper) = (vec![0.0; n], vec![0.0; n]);
        for i in 1..n.saturating_sub(1) {
            let (before, after) = (x[i] - x[i - 1], x[i + 1] - x[i]);
            let right = 3.0 * ((y[i] - y[i - 1]) / (before * before) + (y[i + 1] - y[i]) / (after * after))
                - slopes[i - 1] / before;
            let pivot = 2.0 * (1.0 / before + 1.0 / after) - upper[i - 1] / before;
            upper[i] = 1.0 / (after * pivot);
            slopes[i] = right / pivot;
        }
        for i in (1..n.saturating_sub(1)).rev() {
            slopes[i] -= upper[i] * slopes[i + 1];
        }
        Self { x, y, slopes }
    }

    /// Value, first and second derivative at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> [f64; 3] {
        let after = self.x.partition_point(|&knot| knot <= x);
        if after == 0 {
            return [self.y[0], 0.0, 0.0];
        }
        if after == self.x.len() {
            return [self.y[after - 1], 0.0, 0.0];
        }
        let i = after - 1;
        let h = self.x[after] - self.x[i];
        let u = (x - self.x[i]) / h;
        hermite((self.y[i], self.slopes[i]), (self.y[after], self.slopes[after]), h, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_motion_from_rest_to_rest_is_met_to_the_fourth_order() {
        let error = |n: usize| {
            let x: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
            let exact = |x: f64| (std::f64::consts::PI * x).cos();
            let spline = RestingSpline::new(x.clone(), x.iter().map(|&x| exact(x)).collect());
            (0..997).fold(0.0_f64, |worst, i| {
                let x = f64::from(i) / 997.0;
                worst.max((spline.at(x)[0] - exact(x)).abs())
            })
        };
        let ratio = error(10) / error(20);
        assert!((12.0..20.0).contains(&ratio), "{ratio}"); // 2⁴
    }

    #[test]
    fn derivatives_are_those_of_the_values_and_continuous() {
        let spline = RestingSpline::new(vec![0.0, 0.3, 1.0, 1.4, 2.0], vec![0.1, 0.5, -0.2, 0.3, 0.0]);
        for x in [-0.5, 0.1, 0.7, 1.2, 1.9, 2.5] {
            let h = 1e-6;
            let (plus, minus) = (spline.at(x + h), spline.at(x - h));
            for order in 0..2 {
                let slope = (plus[order] - minus[order]) / (2.0 * h);
                assert!((slope - spline.at(x)[order + 1]).abs() < 1e-7); // rounding / h
            }
        }
        for knot in [0.3, 1.0, 1.4] {
            for order in 0..3 {
                let jump = spline.at(knot)[order] - spline.at(knot - 1e-12)[order];
                assert!(jump.abs() < 1e-9, "{knot} {order} {jump}"); // third derivative times 1e-12
            }
        }
        assert_eq!(spline.at(-1.0), [0.1, 0.0, 0.0]);
        assert_eq!(spline.at(9.0), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn one_sample_is_a_constant() {
        let spline = RestingSpline::new(vec![3.0], vec![0.2]);
        assert_eq!(spline.at(0.0), [0.2, 0.0, 0.0]);
        assert_eq!(spline.at(5.0), [0.2, 0.0, 0.0]);
    }
}
