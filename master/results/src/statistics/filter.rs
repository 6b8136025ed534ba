//! Butterworth low-pass filters.

use scene::ForceFilter;
use serde::{Deserialize, Serialize};

/// Sections of the filter of order 4.
const SECTIONS: usize = 2;
/// Sections of the causal filter, of order 6. `[EN 50317]`, order remembered
const CAUSAL_SECTIONS: usize = 3;

/// Samples added at each end of a record, `3 (2 · sections + 1)`: three times the number of
/// coefficients of the filter, the usual length for a forward-backward pass.
const PADDING: usize = 3 * (2 * SECTIONS + 1);

/// Filter of a contact force; its words are those of `run.filter`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Order 4, forward and backward.
    #[default]
    ZeroPhase,
    /// Order 6, forward only.
    Causal,
}

impl Filter {
    /// The one that it is not.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::ZeroPhase => Self::Causal,
            Self::Causal => Self::ZeroPhase,
        }
    }

    /// Its name, for reading.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::ZeroPhase => "zero-phase Butterworth filter, order 4 forward and backward",
            Self::Causal => "causal Butterworth filter, order 6",
        }
    }

    /// The filter for a `cutoff` frequency in Hz and a sampling `step` in s.
    ///
    /// # Errors
    ///
    /// [`FilterError::Cutoff`] unless `0 < cutoff < 1/(2 step)`.
    pub fn design(self, cutoff: f64, step: f64) -> Result<LowPass, FilterError> {
        match self {
            Self::ZeroPhase => LowPass::new(cutoff, step),
            Self::Causal => LowPass::causal(cutoff, step),
        }
    }
}

impl From<ForceFilter> for Filter {
    fn from(filter: ForceFilter) -> Self {
        match filter {
            ForceFilter::ZeroPhase => Self::ZeroPhase,
            ForceFilter::Causal => Self::Causal,
        }
    }
}

/// Why a signal cannot be filtered.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The cut-off frequency is not inside `(0, f_s/2)`.
    #[error(
        "cut-off frequency {cutoff} Hz: must lie between 0 and {nyquist} Hz, half of the sampling \
         frequency"
    )]
    Cutoff {
        /// Cut-off frequency, Hz.
        cutoff: f64,
        /// Half of the sampling frequency, Hz.
        nyquist: f64,
    },
    /// The record is too short for the padding at its ends.
    #[error("record of {samples} samples: the filter needs at least {needed}")]
    TooShort {
        /// Samples in the record.
        samples: usize,
        /// Smallest number of samples.
        needed: usize,
    },
}

/// One second-order section in transposed direct form II, normalised to `a₀ = 1` and to gain 1 at
/// zero frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Section {
    /// Numerator `b₀, b₁, b₂`, –.
    b: [f64; 3],
    /// Denominator `a₁, a₂`, –.
    a: [f64; 2],
}

impl Section {
    /// State for which a constant input of 1 gives a constant output of 1, 2 entries, –.
    fn steady_state(&self) -> [f64; 2] {
        let s2 = self.b[2] - self.a[1];
        [self.b[1] - self.a[0] + s2, s2]
    }

    /// Filters `signal` in place from the steady state of its first value.
    fn run(&self, signal: &mut [f64]) {
        let Some(&first) = signal.first() else { return };
        let [mut s1, mut s2] = self.steady_state().map(|s| s * first);
        for x in signal {
            let y = self.b[0] * *x + s1;
            s1 = self.b[1] * *x - self.a[0] * y + s2;
            s2 = self.b[2] * *x - self.a[1] * y;
            *x = y;
        }
    }
}

/// Butterworth low-pass of order `2 n`, bilinear transform: of order 4 forward and backward, or of order 6 forward
/// only.
///
/// ```text
/// |H(iω)|² = 1 / (1 + (ω/ω_c)^(4n))             one pass, analogue prototype
/// s² + 2 sin((2k+1) π/(4n)) s + 1,  k < n       its sections for ω_c = 1
/// s = (1/K) (z − 1)/(z + 1),  K = tan(π f_c/f_s) bilinear transform, pre-warped at f_c
/// ```
///
/// Forward and backward, there is no phase shift, and the cut-off frequency is attenuated by a factor of 2. The ends
/// are continued by point reflection (odd padding), each pass starts in the steady state of its first value: the
/// convention of `scipy.signal.sosfiltfilt` with its defaults. Forward only, the delay of a filter on a train is kept;
/// that of `scipy.signal.sosfilt` with `sosfilt_zi` times the first value.
#[derive(Clone, Debug, PartialEq)]
pub struct LowPass {
    sections: Vec<Section>,
    backward: bool,
}

impl LowPass {
    /// Designs the filter without delay for a `cutoff` frequency in Hz and a sampling `step` in s.
    ///
    /// # Errors
    ///
    /// [`FilterError::Cutoff`] unless `0 < cutoff < 1/(2 step)`.
    pub fn new(cutoff: f64, step: f64) -> Result<Self, FilterError> {
        let sections = sections(SECTIONS, cutoff, step)?;
        Ok(Self {
            sections,
            backward: true,
        })
    }

    /// Designs the causal filter for a `cutoff` frequency in Hz and a sampling `step` in s.
    ///
    /// # Errors
    ///
    /// [`FilterError::Cutoff`] unless `0 < cutoff < 1/(2 step)`.
    pub fn causal(cutoff: f64, step: f64) -> Result<Self, FilterError> {
        let sections = sections(CAUSAL_SECTIONS, cutoff, step)?;
        Ok(Self {
            sections,
            backward: false,
        })
    }

    /// Filters `signal`; the result has the same length and unit.
    ///
    /// # Errors
    ///
    /// [`FilterError::TooShort`] for records that are not longer than the padding.
    pub fn filter(&self, signal: &[f64]) -> Result<Vec<f64>, FilterError> {
        let n = signal.len();
        if n <= PADDING {
            return Err(FilterError::TooShort {
                samples: n,
                needed: PADDING + 1,
            });
        }
        if !self.backward {
            let mut filtered = signal.to_vec();
            self.pass(&mut filtered);
            return Ok(filtered);
        }
        let (first, last) = (signal[0], signal[n - 1]);
        let mut padded = Vec::with_capacity(n + 2 * PADDING);
        padded.extend((1..=PADDING).rev().map(|i| 2.0 * first - signal[i]));
        padded.extend_from_slice(signal);
        padded.extend((1..=PADDING).map(|i| 2.0 * last - signal[n - 1 - i]));
        for _pass in 0..2 {
            self.pass(&mut padded);
            padded.reverse();
        }
        padded.truncate(PADDING + n);
        padded.drain(..PADDING);
        Ok(padded)
    }

    fn pass(&self, signal: &mut [f64]) {
        for section in &self.sections {
            section.run(signal);
        }
    }
}

/// Sections of a filter of order `2 count`.
fn sections(count: usize, cutoff: f64, step: f64) -> Result<Vec<Section>, FilterError> {
    let nyquist = 0.5 / step;
    if !(cutoff > 0.0 && cutoff < nyquist) {
        return Err(FilterError::Cutoff { cutoff, nyquist });
    }
    let k = (std::f64::consts::PI * cutoff * step).tan();
    // The section with the poles next to the unit circle comes last.
    let section = |odd: usize| {
        let q = 2.0 * (odd as f64 * std::f64::consts::PI / (4 * count) as f64).sin();
        let d = 1.0 + q * k + k * k;
        let b0 = k * k / d;
        Section {
            b: [b0, 2.0 * b0, b0],
            a: [2.0 * (k * k - 1.0) / d, (1.0 - q * k + k * k) / d],
        }
    };
    Ok((0..count).rev().map(|k| section(2 * k + 1)).collect())
}
