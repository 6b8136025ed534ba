//! Growth of a wave of the worn surface by linear theory.
//!
//! A strip on a rigid wire meets the surface `w = a sin(2π x/λ)`, raised where worn, at the circular frequency
//! `ω = 2π V/λ`. With the dynamic stiffness `D(ω)` of the pantograph at its head and the stiffness `k_c` of the contact
//! the force varies by `F̂ = −Z ŵ`, `1/Z = 1/k_c + 1/D`. A passage that takes the area `A(F)` from a flat of the width
//! `b(h)` deepens it by `A/b`, so that (derived here)
//!
//! ```text
//! ŵ₊ = (1 − A_F Z/b − A b_h/b²) ŵ
//! ```
//!
//! The last term is geometry: the flat of a round wire is wider where it is deeper, which evens every wave out. The
//! other one evens it where springs rule, `Re Z > 0`, and raises it where the inertia of the head does, `Re Z < 0`; the
//! phase of the wave moves with `Im Z`.

use nalgebra::Complex;
use scene::Lumped;

use crate::RoundSection;

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
/// `contact` the stiffness of the contact, N/m, `area` that which a passage takes away with its change with the force,
/// m² and m²/N, `section` that of the wire at its mean depth, m.
#[must_use]
pub fn growth(
    head: Complex<f64>,
    contact: f64,
    (area, by_force): (f64, f64),
    (section, depth): (RoundSection, f64),
) -> Complex<f64> {
    let width = section.width(depth);
    let together = head * contact / (head + contact);
    let evening = area * section.width_by_depth(depth) / (width * width);
    Complex::new(1.0 - evening, 0.0) - together * (by_force / width)
}
