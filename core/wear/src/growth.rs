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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pantograph_at_rest_is_its_springs_and_a_fast_one_its_head() {
        let chain = Lumped::new(1.6, 100.0, &[7.0, 12.0], &[9000.0, 1000.0], &[30.0, 70.0]);
        let slow = head_stiffness(&chain, 0.0);
        assert!((slow.re - 900.0).abs() < 1e-9 && slow.im == 0.0);
        let fast = head_stiffness(&chain, 1e5);
        // Less springs and dampers, some 1e-6 and 1e-4 of the inertia.
        assert!((fast / (-7.0 * 1e10) - 1.0).norm() < 1e-3);
    }

    #[test]
    fn a_flat_that_grows_wider_evens_a_wave_out_without_any_change_of_the_force() {
        let section = RoundSection { diameter: 0.012 };
        let (depth, area, wave) = (1e-3, 1e-10, 1e-6);
        let factor = growth(Complex::new(1e4, 0.0), 5e4, (area, 0.0), (section, depth));
        let worn = |depth: f64| section.depth(section.lost(depth) + area);
        let found = (worn(depth + wave) - worn(depth - wave)) / (2.0 * wave);
        // The change of one passage is 1e-5; digits of differences of depths bound the rest.
        assert!((factor.re - found).abs() < 1e-3 * (1.0 - factor.re), "{factor} {found}");
    }
}
