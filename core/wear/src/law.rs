//! Worn volume per sliding distance.

use std::ops::{Add, AddAssign, Mul};

use scene::{Wear, WearLaw};
use serde::{Deserialize, Serialize};

/// Law of one partner, wire or strip:
///
/// ```text
/// w_m = k1 (½ (1 + I/I₀))^(−α) (F/F₀)^β F/H           friction; a current lubricates
/// w_J = k2 R_c I² / (H V)                             heat of the contact
/// w_a = k3 U_a I / (H_m ρ V)                          heat of an arc
/// ```
///
/// in m³ per m of sliding. [Bucca & Collina 2009] give mean values over a section, with the share `u` of lost contact
/// as weight of `w_a` and `1 − u` of `w_J`; here each sample has either a contact or an arc.
#[derive(Clone, Copy, Debug)]
pub struct Law<'a> {
    coefficients: &'a WearLaw,
    reference_force: f64,
    reference_current: f64,
}

/// Terms of the law, m³/m, or volumes and areas made of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Terms {
    /// By friction.
    pub mechanical: f64,
    /// By the heat of the contact.
    pub joule: f64,
    /// By arcs.
    pub arc: f64,
}

impl<'a> Law<'a> {
    /// The law with the coefficients of a partner.
    #[must_use]
    pub fn new(wear: &Wear, coefficients: &'a WearLaw) -> Self {
        Self {
            coefficients,
            reference_force: wear.reference_force,
            reference_current: wear.reference_current,
        }
    }

    /// Term of friction under `force` (N) and `current` (A), m³/m.
    #[must_use]
    pub fn mechanical(&self, force: f64, current: f64) -> f64 {
        let own = self.coefficients;
        if force <= 0.0 {
            return 0.0;
        }
        let lubricated = (0.5 * (1.0 + current / self.reference_current)).powf(-own.current_exponent);
        let pressed = (force / self.reference_force).powf(own.force_exponent);
        own.mechanical_coefficient * lubricated * pressed * force / own.hardness
    }

    /// Change of [`Law::mechanical`] with the force, m³/(m N).
    #[must_use]
    pub fn mechanical_by_force(&self, force: f64, current: f64) -> f64 {
        (1.0 + self.coefficients.force_exponent) * self.mechanical(force, current) / force
    }

    /// Term of a contact that turns `power` (W) into heat at `speed` (m/s), m³/m.
    #[must_use]
    pub fn joule(&self, power: f64, speed: f64) -> f64 {
        self.coefficients.joule_coefficient * power / (self.coefficients.hardness * speed)
    }

    /// Term of an arc of `power` (W) at `speed` (m/s), m³/m.
    #[must_use]
    pub fn arc(&self, power: f64, speed: f64) -> f64 {
        let own = self.coefficients;
        own.arc_coefficient * power / (own.melting_heat * own.density * speed)
    }
}

impl Terms {
    /// All terms together.
    #[must_use]
    pub fn sum(self) -> f64 {
        self.mechanical + self.joule + self.arc
    }
}

impl Add for Terms {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            mechanical: self.mechanical + other.mechanical,
            joule: self.joule + other.joule,
            arc: self.arc + other.arc,
        }
    }
}

impl AddAssign for Terms {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul<f64> for Terms {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            mechanical: factor * self.mechanical,
            joule: factor * self.joule,
            arc: factor * self.arc,
        }
    }
}
