//! Coefficients of the time integration.

/// Coefficients of generalized-α for a spectral radius at infinite frequency `rho_inf` in 0…1
/// [Chung & Hulbert 1993; Arnold & Brüls 2007, Eq. (8)].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scheme {
    /// Weight of the old auxiliary acceleration, –.
    pub alpha_m: f64,
    /// Weight of the old acceleration, –.
    pub alpha_f: f64,
    /// Newmark's β, –.
    pub beta: f64,
    /// Newmark's γ, –.
    pub gamma: f64,
}

impl Scheme {
    /// The second-order coefficients for `rho_inf`: 1 keeps energy (trapezoid), 0 annihilates the highest frequencies.
    ///
    /// # Panics
    /// When `rho_inf` is outside 0…1.
    #[must_use]
    pub fn new(rho_inf: f64) -> Self {
        assert!((0.0..=1.0).contains(&rho_inf), "rho_inf = {rho_inf} is outside 0…1");
        let alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0);
        let alpha_f = rho_inf / (rho_inf + 1.0);
        let gamma = 0.5 + alpha_f - alpha_m;
        Self {
            alpha_m,
            alpha_f,
            beta: 0.25 * (gamma + 0.5) * (gamma + 0.5),
            gamma,
        }
    }

    /// The same with the `β` that keeps periods to the fourth order of the step where nothing is damped: 1/12 in place
    /// of 1/4 where `rho_inf` is 1 [Fox & Goodwin 1949].
    ///
    /// `β` acts as a mass of `β h² K` against [`period_error`] (*derived here*). Steps are stable for `ωh` up to √6
    /// only, so that `rho_inf` is no longer that of infinite frequency.
    #[must_use]
    pub fn fox_goodwin(self) -> Self {
        let rho_inf = self.alpha_f / (1.0 - self.alpha_f);
        Self {
            beta: self.beta - period_error(rho_inf) / 6.0,
            ..self
        }
    }

    /// `(β', γ')`: change of acceleration and velocity per change of the coordinates at the end of a step of `h` s.
    pub(crate) fn rates(&self, h: f64) -> (f64, f64) {
        (
            (1.0 - self.alpha_m) / (h * h * self.beta * (1.0 - self.alpha_f)),
            self.gamma / (h * self.beta),
        )
    }
}

/// Error of the periods of generalised-α in errors of the trapezoid, –.
///
/// A step of `h` s turns `ω` into `ω (1 − (ωh)² (1/12 + 3/8 r²))`, `r = (1 − rho_inf)/(1 + rho_inf)`; the trapezoid is
/// `r = 0`.
#[must_use]
pub fn period_error(rho_inf: f64) -> f64 {
    let r = (1.0 - rho_inf) / (1.0 + rho_inf);
    1.0 + 4.5 * r * r
}
