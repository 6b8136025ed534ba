//! Figures of a recorded signal: zero-phase low-pass filter, contact force statistics,
//! power spectral density and histogram.
//!
//! Signals are sampled at a constant step. Forces are in N, times in s.
//!
//! Sources: `[EN 50317]` CENELEC, EN 50317: Railway applications – Current collection systems –
//! Requirements for and validation of measurements of the dynamic interaction between pantograph
//! and overhead contact line.

mod filter;
mod force;
mod spectrum;
#[cfg(test)]
mod tests;

pub use filter::{FilterError, LowPass};
pub use force::{
    ForceStatistics, Histogram, histogram, long_loss_of_contact_percent, loss_of_contact_percent, peak_to_peak,
    sample_range,
};
pub use spectrum::{Spectrum, power_spectral_density};
