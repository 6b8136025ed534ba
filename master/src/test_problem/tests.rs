//! The test problem and what the algorithms reach on it.

use super::*;

#[test]
fn table() {
    for case in cases() {
        for h in [1e-3, 2e-3, 5e-3] {
            let o = run(&case, h);
            println!(
                "{:70} {:5.1} ms {:>6} rms {:10.6} N min {:8.3} N passes {:5.3} residual {:+.2e} J {}",
                case.name,
                1e3 * h,
                o.stable,
                o.rms_error,
                o.smallest_force,
                o.passes_per_step,
                o.energy_residual,
                o.failure.unwrap_or_default()
            );
        }
    }
}
