//! Figures of a recorded signal: low-pass filters, contact force statistics by band and stretch, losses of contact,
//! power spectral density and histogram; orders of convergence.
//!
//! Signals are sampled at a constant step. Forces are in N, times in s.
//!
//! Sources: `[EN 50317]` CENELEC, EN 50317: Railway applications – Current collection systems –
//! Requirements for and validation of measurements of the dynamic interaction between pantograph
//! and overhead contact line.

mod bands;
#[cfg(test)]
mod detail_tests;
mod filter;
mod force;
mod losses;
mod order;
mod spectrum;
mod stretches;
#[cfg(test)]
mod tests;

pub use bands::{Band, band_pass, bands};
pub use filter::{Filter, FilterError, LowPass};
pub use force::{
    ForceStatistics, Histogram, Quantile, histogram, largest_slope, long_loss_of_contact_percent,
    loss_of_contact_percent, peak_to_peak, quantiles, rms_difference, sample_range,
};
pub use losses::{Loss, LossClass, loss_classes, losses};
pub use order::order_of_convergence;
pub use spectrum::{Spectrum, power_spectral_density};
pub use stretches::{Stretch, stretches};
