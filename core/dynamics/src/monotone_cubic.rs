//! Curves through samples that rise or fall only where the samples do.
use crate::hermite::hermite;

/// Piecewise cubic through samples with continuous slope, monotone where they are [Fritsch & Carlson, SIAM Journal on
/// Numerical Analysis 17 (1980) 238–246], continued along the end slopes.
#[derive(Clone, Debug, PartialEq)]
pub struct MonotoneCubic {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

/// Slopes at samples with ascending `x`, at least two, for cubics that are monotone where the samples are.
///
/// The first slope is `first`, or that of the first two samples.
#[must_use]
pub fn monotone_slopes(x: &[f64], y: &[f64], first: Option<f64>) -> Vec<f64> {
    let n = x.len();
    debug_assert!(n > 1 && n == y.len() && x.windows(2).all(|pair| pair[0] < pair[1]));
    let width = |i: usize| x[i + 1] - x[i];
    let secant = |i: usize| (y[i + 1] - y[i]) / width(i);
    let slope = |i: usize| {
        if i == 0 {
            return first.unwrap_or_else(|| secant(0));
        }
        if i + 1 == n {
            return secant(n - 2);
        }
        let (before, after) = (secant(i - 1), secant(i));
        if before == 0.0 || after == 0.0 {
            return 0.0;
        }
        // Weighted harmonic mean: never more than three times either secant, so that the cubic does not overshoot.
        let (first, second) = (2.0 * width(i) + width(i - 1), width(i) + 2.0 * width(i - 1));
        (first + second) / (first / before + second / after)
    };
    (0..n).map(slope).collect()
}

impl MonotoneCubic {
    /// Curve through samples with ascending `x`, at least two; it begins with the slope `first`, or that of the first
    /// two samples.
    #[must_use]
    pub fn new(x: Vec<f64>, y: Vec<f64>, first: Option<f64>) -> Self {
        let slopes = monotone_slopes(&x, &y, first);
        Self { x, y, slopes }
    }

    /// First and last `x`.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        [self.x[0], self.x[self.x.len() - 1]]
    }

    /// Value, first and second derivative at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> [f64; 3] {
        let last = self.x.len() - 1;
        let end = if x <= self.x[0] {
            Some(0)
        } else if x >= self.x[last] {
            Some(last)
        } else {
            None
        };
        if let Some(end) = end {
            let slope = self.slopes[end];
            return [self.y[end] + slope * (x - self.x[end]), slope, 0.0];
        }
        // No number is on any side of a sample: the result is none either, for the solver to report.
        let i = self.x.partition_point(|&at| at <= x).saturating_sub(1);
        let h = self.x[i + 1] - self.x[i];
        let u = (x - self.x[i]) / h;
        hermite((self.y[i], self.slopes[i]), (self.y[i + 1], self.slopes[i + 1]), h, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn falling() -> MonotoneCubic {
        MonotoneCubic::new(vec![0.5, 0.6, 0.7, 0.8], vec![0.0, -0.01, -0.05, -0.2], Some(0.0))
    }

    #[test]
    fn the_curve_falls_through_its_samples_from_its_first_slope_on() {
        let curve = falling();
        for (x, y) in [(0.5, 0.0), (0.6, -0.01), (0.7, -0.05), (0.8, -0.2)] {
            assert!((curve.at(x)[0] - y).abs() < 1e-15);
        }
        assert_eq!(curve.at(0.2), [0.0; 3]);
        assert_eq!(curve.at(0.5)[1], 0.0);
        let end = curve.at(0.9);
        assert!((end[0] + 0.35).abs() < 1e-12 && end[2] == 0.0, "{end:?}");
        let heights: Vec<f64> = (0..=400).map(|i| curve.at(0.5 + f64::from(i) * 1e-3)[0]).collect();
        assert!(heights.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!(curve.at(f64::NAN)[0].is_nan());
    }

    #[test]
    fn derivatives_are_those_of_the_values_and_slopes_do_not_jump() {
        let curve = falling();
        for x in [0.3, 0.53, 0.61, 0.75, 0.79, 0.85] {
            let h = 1e-6;
            let (plus, minus) = (curve.at(x + h), curve.at(x - h));
            for order in 0..2 {
                let slope = (plus[order] - minus[order]) / (2.0 * h);
                assert!((slope - curve.at(x)[order + 1]).abs() < 1e-7); // rounding / h
            }
        }
        for knot in [0.5, 0.6, 0.7, 0.8] {
            let jump = curve.at(knot + 1e-12)[1] - curve.at(knot - 1e-12)[1];
            assert!(jump.abs() < 1e-9, "{knot}: {jump}"); // second derivative times 2e-12
        }
    }
}
