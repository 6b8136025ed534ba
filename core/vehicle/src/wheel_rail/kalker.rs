//! Coefficients of the linear theory of rolling contact.
use super::spline::Spline;

/// Table E.3 of [Kalker 1990].
const TABLE: &str = include_str!("kalker_coefficients.csv");

/// Kalker's creepage coefficients C11, C22, C23 for one Poisson's ratio, over the ratio of the semi-axes.
///
/// The inverse of a coefficient is a parabola in ν through the three tabulated values, its logarithm a cubic spline in
/// the logarithm of a/b; beyond the table (a/b < 0.1, a/b > 10) the coefficient goes on as a power of a/b.
#[derive(Clone, Debug)]
pub struct KalkerCoefficients {
    logarithms: [Spline; 3],
}

impl KalkerCoefficients {
    /// The coefficients for Poisson's ratio `poisson`, 0 to 0.5.
    ///
    /// # Panics
    /// Outside this range of `poisson`.
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

    /// C11, C22, C23 (–) for semi-axes `along` and `across` the rolling direction (m), and their derivatives by
    /// ln(a/b).
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

/// Rows by increasing a/b; the row a/b = 1 appears once.
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

    #[test]
    fn between_the_rows_the_coefficients_are_continuous_and_within_their_neighbours() {
        let rows = table();
        for poisson in [0.0, 0.25, 0.28, 0.5] {
            let coefficients = KalkerCoefficients::new(poisson);
            let at = |ratio: f64| coefficients.at(ratio, 1.0).map(|value| value[0]);
            for pair in rows.windows(2) {
                let [low, high] = [pair[0].axis_ratio, pair[1].axis_ratio];
                let (first, last) = (at(low), at(high));
                let mut before = first;
                for step in 1..=100 {
                    let now = at(low * (high / low).powf(f64::from(step) / 100.0));
                    for k in 0..3 {
                        // C11 at ν = ½ falls from 4.85 to 4.80 before it rises: only its own neighbours count there.
                        let [least, most] = [first[k].min(last[k]), first[k].max(last[k])];
                        let beyond = (least - now[k]).max(now[k] - most);
                        assert!(beyond < 2e-3 * most, "ν {poisson}, a/b {low} to {high}, C{k}: {now:?}");
                        // A hundredth of the way makes a hundredth of the change, twice that where a curve is bent.
                        let change = (now[k] - before[k]).abs();
                        assert!(
                            change < 0.02 * (most - least) + 2e-4 * most,
                            "a/b {low} to {high}, C{k}: {change}"
                        );
                    }
                    before = now;
                }
            }
        }
    }

    #[test]
    fn rows_that_are_left_out_are_found_again_by_interpolation() {
        // The error of the rows between which is interpolated is larger than that of all of them, by 2⁴ for a smooth
        // function.
        let rows = table();
        let mut worst = 0.0_f64;
        for column in 0..3 {
            for k in 0..3 {
                let kept: Vec<&Row> = rows.iter().step_by(2).collect();
                let ratios = kept.iter().map(|row| row.axis_ratio.ln()).collect();
                let values = kept.iter().map(|row| row.values[k][column].ln()).collect();
                let spline = Spline::new(ratios, values);
                for row in rows.iter().skip(1).step_by(2) {
                    let ratio = row.axis_ratio.ln();
                    let [logarithm, ..] = spline.in_segment(spline.segment(ratio), ratio).0;
                    worst = worst.max((logarithm.exp() / row.values[k][column] - 1.0).abs());
                }
            }
        }
        println!("rows left out are missed by {:.2} % at most", 100.0 * worst);
        // Three digits are printed, which are 0.5 % of 1.03.
        assert!(worst < 0.01, "{worst}");
    }

    #[test]
    fn both_branches_of_the_table_meet_and_only_the_ratio_of_the_axes_counts() {
        let coefficients = KalkerCoefficients::new(0.25);
        // Rows of b/a = 0.5, 1 and a/b = 0.5 [Kalker 1990, Table E.3].
        for (along, across, expected) in [
            (2.0, 1.0, [5.10, 4.90, 2.62]),
            (1.0, 1.0, [4.12, 3.67, 1.47]),
            (1.0, 2.0, [3.62, 3.01, 0.929]),
        ] {
            for scale in [1.0, 4e-3] {
                let found = coefficients.at(scale * along, scale * across).map(|value| value[0]);
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}"); // rounding
                }
            }
        }
        // No kink where the branches meet.
        let h = 1e-6;
        for k in 0..3 {
            let [before, after] = [1.0 - h, 1.0 + h].map(|ratio| coefficients.at(ratio, 1.0)[k]);
            assert!(
                (after[1] - before[1]).abs() < 1e-4 * after[1].abs(),
                "{before:?} {after:?}"
            );
        }
    }
}
