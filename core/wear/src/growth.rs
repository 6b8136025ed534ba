//! Growth of a wave of the worn surface by linear theory.
//!
//! A strip on a rigid wire meets the surface `w = a sin(2π x/λ)`, raised where worn, at the circular frequency
//! `ω = 2π V/λ`. With the dynamic stiffness `D(ω)` of the pantograph at its head and the stiffness `k_c` of the contact
//! the force varies by `F̂ = −Z ŵ`, `1/Z = 1/k_c + 1/D`. A passage deepens the surface by `ŵ' = w_F F̂/b`, with the
//! change `w_F` of the worn area with the force and the width `b` of the flat, so that (derived here)
//!
//! ```text
//! ŵ₊ = (1 − (w_F/b) Z) ŵ
//! ```
//!
//! A wave decays where springs rule, `Re Z > 0`, and grows where the inertia of the head does, `Re Z < 0`; its phase
//! moves with `Im Z`.

use nalgebra::Complex;
use scene::Lumped;

/// Dynamic stiffness of a lumped pantograph at its head, N/m, at the circular frequency `omega` (rad/s); friction and
/// one-way elements are left out.
#[must_use]
pub fn head_stiffness(pantograph: &Lumped, omega: f64) -> Complex<f64> {
    let spring = |index: usize| {
        let of = |list: &[f64]| list.get(index).copied().unwrap_or_default();
        Complex::new(of(&pantograph.stiffnesses), omega * of(&pantograph.dampings))
    };
    let mut below: Option<Complex<f64>> = None;
    for (index, mass) in pantograph.masses.iter().enumerate().rev() {
        let carried = match below {
            None => spring(index),
            Some(below) => spring(index) * below / (spring(index) + below),
        };
        below = Some(carried - mass * omega * omega);
    }
    below.unwrap_or_default()
}

/// Factor of a wave of the surface from one passage to the next: `head` is the dynamic stiffness of the pantograph,
/// `contact` the stiffness of the contact, N/m, `by_force` the change of the worn area with the force, m²/N, and
/// `width` that of the flat, m.
#[must_use]
pub fn growth(head: Complex<f64>, contact: f64, by_force: f64, width: f64) -> Complex<f64> {
    let together = head * contact / (head + contact);
    Complex::new(1.0, 0.0) - together * (by_force / width)
}
