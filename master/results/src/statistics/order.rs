//! Orders of convergence from differences of successive runs: no reference takes part.

/// Highest order that is looked for.
const HIGHEST: f64 = 16.0;

/// Order `p` of an error `C hᵖ` from the differences of successive runs at sizes `h₁ > h₂ > h₃`:
///
/// ```text
/// d₁₂ / d₂₃ = (h₁ᵖ − h₂ᵖ) / (h₂ᵖ − h₃ᵖ)
/// ```
///
/// Derived here; with a constant ratio `h₁/h₂ = h₂/h₃ = r` it is `p = ln(d₁₂/d₂₃) / ln r`. The right side rises with
/// `p`, so that it is halved to the root. `None` where there is none between 0 and 16.
#[must_use]
pub fn order_of_convergence([h1, h2, h3]: [f64; 3], [d12, d23]: [f64; 2]) -> Option<f64> {
    let falls = h1 > h2 && h2 > h3 && h3 > 0.0;
    if !(falls && d12 > 0.0 && d23 > 0.0 && d12.is_finite() && d23.is_finite()) {
        return None;
    }
    let ratio = |p: f64| {
        let power = |h: f64| (h / h2).powf(p);
        (power(h1) - 1.0) / (1.0 - power(h3))
    };
    let wanted = d12 / d23;
    let (mut low, mut high) = (1e-6, HIGHEST);
    if wanted < ratio(low) || wanted > ratio(high) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if ratio(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_a_power_law_is_found_for_any_sizes() {
        for p in [0.5, 1.0, 2.0, 3.7] {
            for sizes in [[1.0, 0.5, 0.25], [1.0, 0.7, 0.1], [2e-3, 1e-3, 2.5e-4]] {
                let error = sizes.map(|h: f64| 3.0 * h.powf(p));
                let found = order_of_convergence(sizes, [error[0] - error[1], error[1] - error[2]]).unwrap();
                assert!((found - p).abs() < 1e-6, "{p} {sizes:?}: {found}");
            }
        }
    }

    #[test]
    fn differences_that_do_not_fall_show_no_order() {
        assert_eq!(order_of_convergence([1.0, 0.5, 0.25], [1.0, 1.0]), None);
        assert_eq!(order_of_convergence([1.0, 0.5, 0.25], [0.0, 1.0]), None);
        assert_eq!(order_of_convergence([1.0, 0.5, 0.5], [2.0, 1.0]), None);
        assert_eq!(order_of_convergence([1.0, 0.5, 0.25], [f64::NAN, 1.0]), None);
    }
}
