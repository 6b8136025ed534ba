//! Interpolating cubic splines: twice continuously differentiable curves through given points.

/// Natural cubic spline through `(x, y)`, continued beyond the ends by the end tangents.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spline {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Powers of the distance from the first point of each segment, ascending.
    powers: Vec<[f64; 4]>,
}

/// Value and the first three derivatives of a spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Jet3(pub [f64; 4]);

impl Spline {
    /// Spline through at least two points with increasing `x`.
    pub fn new(x: Vec<f64>, y: Vec<f64>) -> Self {
        let n = x.len();
        debug_assert!(n >= 2 && n == y.len() && x.windows(2).all(|pair| pair[0] < pair[1]));
        // Tridiagonal equations for the second derivatives, solved from the left.
        let mut curvature = vec![0.0; n];
        let mut upper = vec![0.0; n];
        for i in 1..n - 1 {
            let (before, after) = (x[i] - x[i - 1], x[i + 1] - x[i]);
            let right = 6.0 * ((y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before);
            let pivot = 2.0 * (before + after) - before * upper[i - 1];
            upper[i] = after / pivot;
            curvature[i] = (right - before * curvature[i - 1]) / pivot;
        }
        for i in (1..n - 1).rev() {
            curvature[i] -= upper[i] * curvature[i + 1];
        }
        let powers = (0..n - 1)
            .map(|i| {
                let (h, m) = (x[i + 1] - x[i], [curvature[i], curvature[i + 1]]);
                let slope = (y[i + 1] - y[i]) / h - (2.0 * m[0] + m[1]) * h / 6.0;
                [y[i], slope, 0.5 * m[0], (m[1] - m[0]) / (6.0 * h)]
            })
            .collect();
        Self { x, y, powers }
    }

    /// First and last abscissa.
    pub fn range(&self) -> [f64; 2] {
        [self.x[0], self.x[self.x.len() - 1]]
    }

    /// The points' abscissas.
    pub fn knots(&self) -> &[f64] {
        &self.x
    }

    /// Values at the points.
    pub fn values(&self) -> &[f64] {
        &self.y
    }

    /// Number of the segment that holds `x`; the first or the last one for an outside `x`.
    pub fn segment(&self, x: f64) -> usize {
        let after = self.x.partition_point(|&knot| knot <= x);
        after.clamp(1, self.x.len() - 1) - 1
    }

    /// Value and derivatives at `x`.
    #[cfg(test)]
    pub fn at(&self, x: f64) -> Jet3 {
        self.in_segment(self.segment(x), x)
    }

    /// Value and derivatives at `x`, which lies in the given segment.
    #[inline]
    pub fn in_segment(&self, segment: usize, x: f64) -> Jet3 {
        let [first, last] = self.range();
        let inside = x.clamp(first, last);
        let (t, [a, b, c, d]) = (inside - self.x[segment], self.powers[segment]);
        let value = a + t * (b + t * (c + t * d));
        let slope = b + t * (2.0 * c + 3.0 * t * d);
        if inside == x {
            Jet3([value, slope, 2.0 * c + 6.0 * t * d, 6.0 * d])
        } else {
            Jet3([value + slope * (x - inside), slope, 0.0, 0.0])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(n: usize) -> Spline {
        let x: Vec<f64> = (0..=n)
            .map(|i| 2.0 * std::f64::consts::PI * i as f64 / n as f64)
            .collect();
        let y = x.iter().map(|x| x.sin()).collect();
        Spline::new(x, y)
    }

    #[test]
    fn a_spline_passes_its_points_and_converges_with_order_four() {
        let error = |n: usize| {
            let spline = sine(n);
            for (x, y) in spline.x.iter().zip(&spline.y) {
                assert!((spline.at(*x).0[0] - y).abs() < 1e-15); // rounding
            }
            (0..1000)
                .map(|i| 0.006_28 * f64::from(i))
                .map(|x| (spline.at(x).0[0] - x.sin()).abs())
                .fold(0.0, f64::max)
        };
        // The second derivative of a sine is zero at both ends, as that of a natural spline.
        let order = (error(20) / error(40)).log2();
        assert!((order - 4.0).abs() < 0.1, "{order}");
    }

    #[test]
    fn derivatives_are_those_of_the_value_and_continuous_up_to_the_second() {
        let spline = sine(12);
        let h = 1e-5;
        for x in [-0.3, 0.4, 1.9, 3.3, 6.1, 7.0] {
            let Jet3([_, slope, second, third]) = spline.at(x);
            let [plus, minus] = [spline.at(x + h).0, spline.at(x - h).0];
            // Central differences: h² and rounding / h.
            for (order, exact) in [slope, second, third].into_iter().enumerate() {
                assert!(((plus[order] - minus[order]) / (2.0 * h) - exact).abs() < 1e-9, "{x}");
            }
        }
        for &knot in &spline.x[1..12] {
            let [left, right] = [spline.at(knot - 1e-12).0, spline.at(knot + 1e-12).0];
            assert!((0..3).all(|order| (left[order] - right[order]).abs() < 1e-11));
        }
    }
}
