//! Coefficients of the linear theory of rolling contact.
use super::spline::Spline;

/// Table E.3 of [Kalker 1990].
const TABLE: &str = include_str!("kalker_coefficients.csv");

/// Kalker's creepage coefficients C11, C22, C23 for one Poisson's ratio, over the ratio of the semi-axes.
///
/// The inverse of a coefficient is a parabola in ν through the three tabulated values, its logarithm a cubic spline in the
/// logarithm of a/b; beyond the table (a/b < 0.1, a/b > 10) the coefficient goes on as a power of a/b.
#[derive(Clone, Debug)]
pub struct KalkerCoefficients {
    logarithms: [Spline; 3],
}

impl KalkerCoefficients {
    /// The coefficients for Poisson's ratio `poisson`, 0 to 0.5.
    ///
    /// # Panics
    /// When `poisson` is outside this range.
    #[must_use]
    pub fn new(poisson: f64) -> Self {
        assert!(
            (0.0..=0.5).contains(&poisson),
            "Poisson's ratio {poisson} is outside 0…0.5"
        );
        let rows = table();
        let ratios: Vec<f64> = rows.iter().map(|row| row.axis_ratio.ln()).collect();
        let column = |k: usize| {
            let values = rows.iter().map(|row| at_poisson(row.values[k], poisson).ln()).collect();
            Spline::new(ratios.clone(), values)
        };
        Self {
            logarithms: [column(0), column(1), column(2)],
        }
    }

    /// C11, C22, C23 (–) for semi-axes `along` and `across` the rolling direction (m), and their derivatives by ln(a/b).
    #[must_use]
    pub fn at(&self, along: f64, across: f64) -> [[f64; 2]; 3] {
        let ratio = (along / across).ln();
        let segment = self.logarithms[0].segment(ratio);
        [0, 1, 2].map(|k| {
            let [logarithm, slope, ..] = self.logarithms[k].in_segment(segment, ratio).0;
            let value = logarithm.exp();
            [value, value * slope]
        })
    }
}

/// A coefficient at ν from its values at 0, ¼ and ½: `1/C` is a parabola.
fn at_poisson(values: [f64; 3], nu: f64) -> f64 {
    let weights = [
        8.0 * (nu - 0.25) * (nu - 0.5),
        -16.0 * nu * (nu - 0.5),
        8.0 * nu * (nu - 0.25),
    ];
    1.0 / (0..3).map(|i| weights[i] / values[i]).sum::<f64>()
}

struct Row {
    /// a/b.
    axis_ratio: f64,
    /// C11, C22, C23 at ν = 0, ¼, ½.
    values: [[f64; 3]; 3],
}

/// The rows by increasing a/b; the row a/b = 1 is there once.
fn table() -> Vec<Row> {
    let mut rows: Vec<Row> = TABLE
        .lines()
        .filter(|line| line.starts_with("a/b") || line.starts_with("b/a"))
        .map(|line| {
            let mut cells = line.split(',');
            let is_inverse = cells.next() == Some("b/a");
            let mut number = || -> f64 { cells.next().and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN) };
            let ratio = number();
            let axis_ratio = if is_inverse { 1.0 / ratio } else { ratio };
            let mut three = || [number(), number(), number()];
            Row {
                axis_ratio,
                values: [three(), three(), three()],
            }
        })
        .collect();
    rows.sort_by(|a, b| a.axis_ratio.total_cmp(&b.axis_ratio));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficients_are_those_of_the_table() {
        assert_eq!(table().len(), 19);
        for (column, poisson) in [0.0, 0.25, 0.5].into_iter().enumerate() {
            let coefficients = KalkerCoefficients::new(poisson);
            for row in table() {
                let values = coefficients.at(row.axis_ratio, 1.0);
                for (value, tabulated) in values.iter().zip(row.values) {
                    assert!((value[0] / tabulated[column] - 1.0).abs() < 1e-12, "{}", row.axis_ratio); // rounding
                }
            }
        }
    }

    #[test]
    fn beyond_the_table_the_coefficients_stay_near_their_asymptotes() {
        // [Kalker 1990, Table E.3, first and last row], to the few per cent by which the rows next to them depart.
        let nu: f64 = 0.25;
        let coefficients = KalkerCoefficients::new(nu);
        let pi = std::f64::consts::PI;
        let [c11, c22, _] = coefficients.at(0.03, 1.0).map(|value| value[0]);
        assert!((c11 / (pi * pi / 4.0 / (1.0 - nu)) - 1.0).abs() < 0.05, "{c11}");
        assert!((c22 / (pi * pi / 4.0) - 1.0).abs() < 0.05, "{c22}");
        let g: f64 = 0.05;
        let lambda = (16.0 / (g * g)).ln();
        let (c11, at_table) = (coefficients.at(1.0, g)[0][0], coefficients.at(1.0, 0.1)[0][0]);
        let exact = 2.0 * pi / ((lambda - 2.0 * nu) * g) * (1.0 + (3.0 - 4.0_f64.ln()) / (lambda - 2.0 * nu));
        assert!((c11 / exact - 1.0).abs() < 0.06 && c11 > at_table, "{c11} {exact}");
    }

    #[test]
    fn slopes_are_the_derivatives_by_the_logarithm_of_the_axis_ratio() {
        let coefficients = KalkerCoefficients::new(0.28);
        let h = 1e-5_f64;
        for ratio in [0.05, 0.33, 1.0, 1.45, 7.0, 20.0] {
            let [plus, minus] = [h, -h].map(|h| coefficients.at(ratio * h.exp(), 1.0));
            for (k, [_, slope]) in coefficients.at(ratio, 1.0).into_iter().enumerate() {
                assert!(((plus[k][0] - minus[k][0]) / (2.0 * h) - slope).abs() < 1e-7 * slope.abs().max(1.0)); // h²
            }
        }
    }
}
