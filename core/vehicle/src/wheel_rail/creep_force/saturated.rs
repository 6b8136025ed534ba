//! Kalker's linear theory, saturated by friction.
use super::dual::Number;
use super::law::Inputs;

/// ```text
/// T_x = −f₁₁ ξ_x,   T_y = −f₂₂ ξ_y − f₂₃ φ,   M_z = f₂₃ ξ_y                        [Kalker 1990, section 2.2.1]
/// f₁₁ = G a b C₁₁,   f₂₂ = G a b C₂₂,   f₂₃ = G (a b)^{3/2} C₂₃
/// |T| → μN (τ − τ²/3 + τ³/27) with τ = |T|/(μN) up to 3, μN beyond                 [Shen, Hedrick & Elkins 1983]
/// ```
///
/// The moment of the spin, −f₃₃ φ, is left out: the table lacks C33, and the part of this moment in a wheelset's yaw
/// moment is that of the patch's width to the gauge, squared. The moment is reduced as the force.
pub(super) fn forces<N: Number>(inputs: &Inputs<N>) -> [N; 3] {
    let area = inputs.along * inputs.across * inputs.shear_modulus;
    let lever = (inputs.along * inputs.across).sqrt();
    let [c11, c22, c23] = inputs.coefficients;
    let coupling = area * lever * c23;
    let linear_x = -(area * c11 * inputs.creepage[0]);
    let linear_y = -(area * c22 * inputs.creepage[1] + coupling * inputs.creepage[2]);
    let moment = coupling * inputs.creepage[1];
    let tau = (linear_x * linear_x + linear_y * linear_y).sqrt() * inputs.limit.inverse();
    let reduction = if tau.value() < 3.0 {
        tau * tau * (1.0 / 27.0) - tau * (1.0 / 3.0) + 1.0
    } else {
        tau.inverse()
    };
    [linear_x * reduction, linear_y * reduction, moment * reduction]
}
