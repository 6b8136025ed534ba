//! Section of a round wire that is worn flat from below.

/// Round wire of radius `R`; a depth `h` takes a circular segment away (derived here):
///
/// ```text
/// h = 2 R sin²(φ/4),    A = R²/2 (φ − sin φ),    b = 2 R sin(φ/2)        φ opening angle of the segment
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundSection {
    /// Diameter, m.
    pub diameter: f64,
}

/// Opening angle below which `φ − sin φ` is taken from its series, which loses no digits there, rad.
const SMALL: f64 = 0.5;

/// `φ − sin φ`.
fn excess(angle: f64) -> f64 {
    if angle > SMALL {
        return angle - angle.sin();
    }
    let square = angle * angle;
    let inner = 1.0 - square / 42.0 * (1.0 - square / 72.0 * (1.0 - square / 110.0));
    angle * square / 6.0 * (1.0 - square / 20.0 * inner)
}

impl RoundSection {
    fn radius(self) -> f64 {
        0.5 * self.diameter
    }

    /// Area of the unworn section, m².
    #[must_use]
    pub fn whole(self) -> f64 {
        std::f64::consts::PI * self.radius().powi(2)
    }

    fn angle(self, depth: f64) -> f64 {
        4.0 * (depth / self.diameter).clamp(0.0, 1.0).sqrt().asin()
    }

    /// Area lost at a depth (m), m².
    #[must_use]
    pub fn lost(self, depth: f64) -> f64 {
        0.5 * self.radius().powi(2) * excess(self.angle(depth))
    }

    /// Width of the flat at a depth (m), m.
    #[must_use]
    pub fn width(self, depth: f64) -> f64 {
        self.diameter * (0.5 * self.angle(depth)).sin()
    }

    /// Change of the width of the flat with the depth (m), –; infinite where nothing is worn.
    #[must_use]
    pub fn width_by_depth(self, depth: f64) -> f64 {
        2.0 * (self.diameter - 2.0 * depth) / self.width(depth)
    }

    /// Depth at which an area (m²) is lost, m; the diameter where nothing is left.
    #[must_use]
    pub fn depth(self, lost: f64) -> f64 {
        /// Steps of Newton's method: each doubles the digits of an estimate that is right to a third.
        const STEPS: usize = 30;
        let wanted = 2.0 * lost.max(0.0) / self.radius().powi(2);
        if wanted <= 0.0 {
            return 0.0;
        }
        let full = std::f64::consts::TAU;
        if wanted >= full {
            return self.diameter;
        }
        // `φ − sin φ < φ³/6`: the estimate is below, and Newton's method comes from above after its first step.
        let mut angle = (6.0 * wanted).cbrt().min(full);
        for _ in 0..STEPS {
            let slope = 2.0 * (0.5 * angle).sin().powi(2);
            if slope <= 0.0 {
                break;
            }
            let next = (angle - (excess(angle) - wanted) / slope).clamp(0.5 * angle, full);
            if next == angle {
                break;
            }
            angle = next;
        }
        self.diameter * (0.25 * angle).sin().powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIRE: RoundSection = RoundSection { diameter: 0.012 };

    #[test]
    fn depth_and_lost_area_are_inverse_to_each_other() {
        for exponent in -14..=0 {
            let depth = WIRE.diameter * 10.0_f64.powf(0.5 * f64::from(exponent));
            let again = WIRE.depth(WIRE.lost(depth));
            assert!((again / depth - 1.0).abs() < 1e-9, "{depth} {again}");
        }
        assert_eq!((WIRE.lost(0.0), WIRE.depth(0.0), WIRE.depth(-1.0)), (0.0, 0.0, 0.0));
        assert_eq!(WIRE.depth(2.0 * WIRE.whole()), WIRE.diameter);
    }

    #[test]
    fn half_the_wire_is_lost_at_its_middle() {
        let middle = 0.5 * WIRE.diameter;
        assert!((WIRE.lost(middle) / (0.5 * WIRE.whole()) - 1.0).abs() < 1e-14);
        assert!((WIRE.width(middle) / WIRE.diameter - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_width_is_the_change_of_the_lost_area_with_depth() {
        for depth in [1e-5, 3e-4, 2e-3, 8e-3] {
            // Central difference: its error is some 1e-8 of the width.
            let h = 1e-4 * depth;
            let width = (WIRE.lost(depth + h) - WIRE.lost(depth - h)) / (2.0 * h);
            assert!((width / WIRE.width(depth) - 1.0).abs() < 1e-7, "{depth}");
            let by_depth = (WIRE.width(depth + h) - WIRE.width(depth - h)) / (2.0 * h);
            assert!((by_depth / WIRE.width_by_depth(depth) - 1.0).abs() < 1e-7, "{depth}");
        }
    }
}
