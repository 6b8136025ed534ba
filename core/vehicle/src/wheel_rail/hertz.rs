//! Elastic contact of two bodies that touch in a point.
use super::spline::Spline;
use std::sync::Arc;

/// Elastic constants of wheel and rail, which are of one material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Shear modulus G, Pa.
    pub shear_modulus: f64,
    /// Poisson's ratio ν, –.
    pub poisson: f64,
}

impl Material {
    /// `E* = G/(1 − ν)`: the modulus of the contact of two bodies of this material, Pa.
    #[must_use]
    pub fn contact_modulus(&self) -> f64 {
        self.shear_modulus / (1.0 - self.poisson)
    }
}

/// Carlson's complete integral `R_F(0, x, y)` = (π/2)/agm(√x, √y). [Carlson 1995]
fn r_f(x: f64, y: f64) -> f64 {
    let (mut a, mut g) = (x.sqrt(), y.sqrt());
    while (a - g).abs() > 1e-8 * a {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    // The mean of both has an error of the square of their difference.
    std::f64::consts::PI / (a + g)
}

/// Carlson's integral `R_D(0, y, z)` by duplication. [Carlson 1995]
fn r_d(y: f64, z: f64) -> f64 {
    let (mut x, mut y, mut z) = (0.0_f64, y, z);
    let (mut sum, mut factor) = (0.0, 1.0);
    loop {
        let mean = (x + y + 3.0 * z) / 5.0;
        let (dx, dy, dz) = (1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean);
        // The first term left out is of order seven.
        if dx.abs().max(dy.abs()).max(dz.abs()) < 2e-3 {
            let (e2, e3) = (dx * dy - 6.0 * dz * dz, (3.0 * dx * dy - 8.0 * dz * dz) * dz);
            let (e4, e5) = (3.0 * (dx * dy - dz * dz) * dz * dz, dx * dy * dz * dz * dz);
            let series =
                1.0 - 3.0 / 14.0 * e2 + e3 / 6.0 + 9.0 / 88.0 * e2 * e2 - 3.0 / 22.0 * e4 - 9.0 / 52.0 * e2 * e3
                    + 3.0 / 26.0 * e5;
            return 3.0 * sum + factor * series / (mean * mean.sqrt());
        }
        let lambda = (x * y).sqrt() + (x * z).sqrt() + (y * z).sqrt();
        sum += factor / (z.sqrt() * (z + lambda));
        factor *= 0.25;
        (x, y, z) = (0.25 * (x + lambda), 0.25 * (y + lambda), 0.25 * (z + lambda));
    }
}

/// Functions of the ratio of the semi-axes alone.
///
/// ```text
/// A a²/δ = R_D(0, b², a²) a³ / (3 R_F),   B b²/δ likewise with a, b exchanged,   F = ⅔ π E* b δ a / (a R_F(0, b², a²))
/// ```
///
/// for the surfaces' distance `A x² + B y²` (from [Johnson 1985, Eq. (4.26)–(4.28)] with Carlson's integrals, which
/// need no ordering of the axes).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shape {
    /// `ln(A/B)`.
    curvature_ratio: f64,
    /// `ln(a √((A + B)/δ))`, `ln(b √((A + B)/δ))`, `ln(F √(A + B)/(E* δ^{3/2}))`.
    logarithms: [f64; 3],
}

impl Shape {
    fn new(axis_ratio: f64) -> Self {
        // Semi-axes with the product 1.
        let (a, b) = (axis_ratio.sqrt(), 1.0 / axis_ratio.sqrt());
        let k = r_f(a * a, b * b);
        // Curvatures per δ for these semi-axes.
        let along = r_d(b * b, a * a) / (3.0 * k);
        let across = r_d(a * a, b * b) / (3.0 * k);
        let sum = along + across;
        Self {
            curvature_ratio: (along / across).ln(),
            logarithms: [
                (a * sum.sqrt()).ln(),
                (b * sum.sqrt()).ln(),
                // F = ⅔ π a b p₀ with p₀ = E* δ / R_F, and a b = 1.
                (2.0 / 3.0 * std::f64::consts::PI / k * sum.sqrt()).ln(),
            ],
        }
    }
}

/// A Hertzian contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    /// Semi-axis along the rail a, m.
    pub along: f64,
    /// Semi-axis across the rail b, m.
    pub across: f64,
    /// Elastic force, N.
    pub force: f64,
    /// `∂ ln(a, b, F)/∂ ln δ`.
    pub(crate) by_penetration: [f64; 3],
    /// `∂ ln(a, b, F)/∂(k_x, k_y)`, m.
    pub(crate) by_curvature: [[f64; 2]; 3],
}

impl Ellipse {
    /// Largest pressure, Pa.
    #[must_use]
    #[cfg(test)]
    pub fn largest_pressure(&self) -> f64 {
        1.5 * self.force / (std::f64::consts::PI * self.along * self.across)
    }
}

/// Hertz' solution, tabulated over the ratio of the curvatures.
#[derive(Clone, Debug)]
pub struct Hertz {
    modulus: f64,
    table: Arc<[Spline; 3]>,
}

/// End of the table: a ratio of the semi-axes of `e^{6}` ≈ 400, far beyond a line contact.
const LARGEST_LOG_RATIO: f64 = 6.0;

/// Distance of the entries of the table in the logarithm of the ratio of the semi-axes.
const TABLE_STEP: f64 = 0.025;

impl Hertz {
    /// Contact of two bodies of one material.
    #[must_use]
    pub fn new(material: &Material) -> Self {
        let count = (LARGEST_LOG_RATIO / TABLE_STEP) as i32;
        let shapes: Vec<Shape> = (-count..=count)
            .map(|i| Shape::new((-f64::from(i) * TABLE_STEP).exp()))
            .collect();
        let ratios: Vec<f64> = shapes.iter().map(|shape| shape.curvature_ratio).collect();
        let column = |k: usize| Spline::new(ratios.clone(), shapes.iter().map(|shape| shape.logarithms[k]).collect());
        Self {
            modulus: material.contact_modulus(),
            table: Arc::new([column(0), column(1), column(2)]),
        }
    }

    /// Contact at a penetration δ (m, positive) with the relative curvatures `k_x`, `k_y` (1/m): the surfaces' distance
    /// is `½ k_x x² + ½ k_y y²`.
    ///
    /// A curvature below 10⁻⁴ of the other one, or negative, counts as 10⁻⁴ of the other one: the contact is then
    /// longer than Hertz' theory covers.
    #[must_use]
    pub fn contact(&self, penetration: f64, curvature: [f64; 2]) -> Ellipse {
        const LEAST: f64 = 1e-4;
        let [along, across] = [
            curvature[0].max(LEAST * curvature[1]),
            curvature[1].max(LEAST * curvature[0]),
        ];
        let free = [f64::from(along == curvature[0]), f64::from(across == curvature[1])];
        let ratio = (along / across).ln();
        let sum = 0.5 * (along + across);
        let segment = self.table[0].segment(ratio);
        let [a, b, force] = [0, 1, 2].map(|k| self.table[k].in_segment(segment, ratio).0);
        // d ln(A + B) and d ln(A/B) by the curvatures.
        let by_sum = [0.5 / sum * free[0], 0.5 / sum * free[1]];
        let by_ratio = if free == [1.0; 2] {
            [1.0 / along, -1.0 / across]
        } else {
            [0.0; 2]
        };
        let by = |slope: f64| [0, 1].map(|k| slope * by_ratio[k] - 0.5 * by_sum[k]);
        let width = (penetration / sum).sqrt();
        Ellipse {
            along: a[0].exp() * width,
            across: b[0].exp() * width,
            force: self.modulus * force[0].exp() * penetration * width,
            by_penetration: [0.5, 0.5, 1.5],
            by_curvature: [by(a[1]), by(b[1]), by(force[1])],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const STEEL: Material = Material {
        shear_modulus: 82e9,
        poisson: 0.28,
    };

    /// `E* = E/(2(1 − ν²))` with `E = 2 G (1 + ν)`.
    fn modulus() -> f64 {
        2.0 * STEEL.shear_modulus * (1.0 + STEEL.poisson) / (2.0 * (1.0 - STEEL.poisson * STEEL.poisson))
    }

    /// Complete elliptic integrals K, E of the parameter m by Legendre's series of the arithmetic-geometric mean.
    fn legendre(m: f64) -> [f64; 2] {
        let (mut a, mut g, mut c, mut power, mut sum) = (1.0, (1.0 - m).sqrt(), m.sqrt(), 0.5, 0.0);
        while c > 1e-17 {
            sum += power * c * c;
            power *= 2.0;
            (a, g, c) = (0.5 * (a + g), (a * g).sqrt(), 0.5 * (a - g));
        }
        let k = PI / (2.0 * a);
        [k, k * (1.0 - sum)]
    }

    #[test]
    fn the_modulus_of_equal_bodies_is_half_the_plane_strain_modulus() {
        assert!((STEEL.contact_modulus() / modulus() - 1.0).abs() < 1e-15); // rounding
    }

    #[test]
    fn a_sphere_on_a_plane_has_the_closed_form() {
        // k = 1/R both ways: F = 4/3 E* √R δ^{3/2}, a² = R δ. [Johnson 1985, Eq. (4.22)–(4.23)]
        let (radius, delta) = (0.46, 5e-5);
        let contact = Hertz::new(&STEEL).contact(delta, [1.0 / radius; 2]);
        let force = 4.0 / 3.0 * modulus() * radius.sqrt() * delta.powf(1.5);
        // 1e-6 asked; interpolation of the table.
        assert!((contact.force / force - 1.0).abs() < 1e-8);
        assert!((contact.along / (radius * delta).sqrt() - 1.0).abs() < 1e-8);
        assert!((contact.along / contact.across - 1.0).abs() < 1e-12);
    }

    #[test]
    fn semi_axes_and_approach_satisfy_the_closed_forms_at_any_ratio() {
        // [Johnson 1985, Eq. (4.26)–(4.28)]; a is the longer semi-axis there, its curvature the smaller one.
        let hertz = Hertz::new(&STEEL);
        for ratio in [1.01, 1.3, 2.7, 10.0, 55.0, 400.0] {
            let (curvature, delta) = ([1.0 / 0.46, ratio / 0.46], 6.2e-5);
            let contact = hertz.contact(delta, curvature);
            let (a, b) = (contact.along, contact.across);
            let m = 1.0 - b * b / (a * a);
            let [k, e] = legendre(m);
            let pressure = contact.largest_pressure() / modulus();
            let small = pressure * b / (m * a * a) * (k - e);
            let large = pressure * b / (m * a * a) * ((a * a) / (b * b) * e - k);
            for (value, exact) in [
                (small, 0.5 * curvature[0]),
                (large, 0.5 * curvature[1]),
                (pressure * b * k, delta),
            ] {
                assert!((value / exact - 1.0).abs() < 1e-6, "ratio {ratio}: {value} {exact}"); // as asked
            }
            // And the same with the axes exchanged.
            let turned = hertz.contact(delta, [curvature[1], curvature[0]]);
            assert!((turned.across / a - 1.0).abs() < 1e-12 && (turned.force / contact.force - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn derivatives_of_the_ellipse_are_those_of_its_values() {
        let hertz = Hertz::new(&STEEL);
        let values = |delta: f64, k: [f64; 2]| {
            let contact = hertz.contact(delta, k);
            [contact.along, contact.across, contact.force].map(f64::ln)
        };
        for k in [[2.1, 2.3], [2.2, 0.7], [1.9, 60.0]] {
            let (delta, h) = (7e-5, 1e-5);
            let contact = hertz.contact(delta, k);
            for row in 0..3 {
                let by_delta = values(delta * (1.0 + h), k)[row] - values(delta * (1.0 - h), k)[row];
                assert!((by_delta / (2.0 * h) - contact.by_penetration[row]).abs() < 1e-8); // h² and rounding / h
                for axis in 0..2 {
                    let moved = |sign: f64| {
                        let mut k = k;
                        k[axis] *= 1.0 + sign * h;
                        values(delta, k)[row]
                    };
                    let difference = (moved(1.0) - moved(-1.0)) / (2.0 * h * k[axis]);
                    assert!((difference - contact.by_curvature[row][axis]).abs() < 1e-7); // the same
                }
            }
        }
    }
}
