//! Polach's closed form.
use super::dual::Number;
use super::law::Inputs;
use std::f64::consts::PI;

/// ```text
/// ε = ¼ G π a b c s_c/(μN),   c = √((C₁₁ ξ_x)² + (C₂₂ ξ_y)²)/|ξ|,   s_c = √(ξ_x² + s_y²)
/// F = (2 μN/π) (ε/(1 + ε²) + arctan ε)
/// s_y = ξ_y + φ a where |ξ_y + φ a| > |ξ_y|, else ξ_y
/// T_x = −F ξ_x/s_c,   T_y = −F ξ_y/s_c + (9/16) a μN K_M (1 + 6.3 (1 − e^{−a/b})) φ/s_c
/// K_M = |ε_M| (δ³/3 − δ²/2 + 1/6) − ⅓ √((1 − δ²)³),   δ = (ε_M² − 1)/(ε_M² + 1)
/// ε_M = (8/3) G b √(a b) C₂₃ s_y/(μN (1 + 6.3 (1 − e^{−a/b})))                                  [Polach 1999]
/// ```
///
/// No moment. Without spin, and for small creepages, the forces are those of Kalker's linear theory.
pub(super) fn forces<N: Number>(inputs: &Inputs<N>) -> [N; 3] {
    let [x, y, spin] = inputs.creepage;
    let [c11, c22, c23] = inputs.coefficients;
    let (a, b) = (inputs.along, inputs.across);
    let with_spin = y + spin * a;
    let lateral = if with_spin.value().abs() > y.value().abs() {
        with_spin
    } else {
        y
    };
    let total = (x * x + lateral * lateral).sqrt();
    if total.value() == 0.0 {
        // The tangent at rest is that of the linear theory.
        let [at_rest_x, at_rest_y, _] = super::saturated::forces(inputs);
        return [at_rest_x, at_rest_y, N::constant(0.0)];
    }
    let inverse_limit = inputs.limit.inverse();
    let per_total = total.inverse();
    let translation = (x * x + y * y).sqrt();
    let stiffness = if translation.value() > 0.0 {
        ((c11 * x) * (c11 * x) + (c22 * y) * (c22 * y)).sqrt() * translation.inverse()
    } else {
        c22
    };
    let epsilon = a * b * stiffness * total * inverse_limit * (0.25 * PI * inputs.shear_modulus);
    let force = inputs.limit * (epsilon * (epsilon * epsilon + 1.0).inverse() + epsilon.atan()) * (2.0 / PI);

    let shape = (-(-(a * b.inverse())).exp() + 1.0) * 6.3 + 1.0;
    let epsilon_m =
        b * (a * b).sqrt() * c23 * lateral * inverse_limit * shape.inverse() * (8.0 / 3.0 * inputs.shear_modulus);
    let square = epsilon_m * epsilon_m;
    let delta = (square + -1.0) * (square + 1.0).inverse();
    let rest = (-(delta * delta) + 1.0).sqrt();
    let k_m = epsilon_m.abs() * (delta * delta * delta * (1.0 / 3.0) - delta * delta * 0.5 + 1.0 / 6.0)
        - rest * rest * rest * (1.0 / 3.0);
    let by_spin = a * inputs.limit * k_m * shape * spin * per_total * (9.0 / 16.0);
    [
        -(force * x * per_total),
        by_spin - force * y * per_total,
        N::constant(0.0),
    ]
}
