//! Spectra of atmospheric turbulence.

/// One-sided power spectral density of a component of the turbulence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurbulenceSpectrum {
    /// Von Kármán's, for isotropic turbulence, as ESDU 85020 writes it, `n = f L/U` with the length scale of the
    /// component itself:
    ///
    /// ```text
    /// f S/σ² = 4 n/(1 + 70.8 n²)^(5/6)                            along the wind
    /// f S/σ² = 4 n (1 + 755.2 n²)/(1 + 283.2 n²)^(11/6)           across, vertical
    /// ```
    VonKarman,
    /// Kaimal's in the form of IEC 61400-1, annex B, the same for all components, `n = f L/U`:
    ///
    /// ```text
    /// f S/σ² = 4 n/(1 + 6 n)^(5/3)
    /// ```
    Kaimal,
}

impl TurbulenceSpectrum {
    /// `S(f)/σ²` in 1/Hz at the frequency `f` (Hz, positive) of component 0, 1, 2 (along the mean wind, across,
    /// vertical), for `time_scale = L/U` in s. The integral over all frequencies is 1.
    #[must_use]
    pub fn density(self, component: usize, f: f64, time_scale: f64) -> f64 {
        let n = f * time_scale;
        let reduced = match (self, component) {
            (Self::VonKarman, 0) => 4.0 / (1.0 + 70.8 * n * n).powf(5.0 / 6.0),
            (Self::VonKarman, _) => 4.0 * (1.0 + 755.2 * n * n) / (1.0 + 283.2 * n * n).powf(11.0 / 6.0),
            (Self::Kaimal, _) => 4.0 / (1.0 + 6.0 * n).powf(5.0 / 3.0),
        };
        reduced * time_scale
    }
}
