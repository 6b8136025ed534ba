//! A cubic between two samples with slopes.

/// Value, first and second derivative at the part `u` (0…1) of an interval of length `h` between two samples, each a
/// value with its slope.
#[inline]
pub(crate) fn hermite((y0, slope0): (f64, f64), (y1, slope1): (f64, f64), h: f64, u: f64) -> [f64; 3] {
    let (d0, d1) = (h * slope0, h * slope1);
    let (c2, c3) = (3.0 * (y1 - y0) - 2.0 * d0 - d1, 2.0 * (y0 - y1) + d0 + d1);
    [
        y0 + u * (d0 + u * (c2 + u * c3)),
        (d0 + u * (2.0 * c2 + u * 3.0 * c3)) / h,
        (2.0 * c2 + u * 6.0 * c3) / (h * h),
    ]
}
