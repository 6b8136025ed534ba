//! Cross-sections of wheels and rails.
use super::spline::{Jet3, Spline};
use nalgebra::Vector2;

/// A wheel or rail profile: an interpolating curve through given points, both coordinates natural cubic splines of the
/// arc length of the polygon through the points. Position, tangent and curvature are continuous.
///
/// Coordinates: outward, away from the middle of the track, and up. The same list serves the left and the right side.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    outward: Spline,
    up: Spline,
}

/// A point of a profile with its derivatives by the curve's parameter σ (m); vectors are (outward, up).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// m.
    pub position: Vector2<f64>,
    /// First derivative, –; nearly of unit length.
    pub first: Vector2<f64>,
    /// Second derivative, 1/m.
    pub second: Vector2<f64>,
    /// Third derivative, 1/m².
    pub third: Vector2<f64>,
}

impl ProfilePoint {
    /// Signed curvature and the derivative by σ, 1/m and 1/m²: positive for a curve that turns upward on the way
    /// outward.
    #[must_use]
    pub fn curvature(&self) -> [f64; 2] {
        let speed = self.first.norm();
        let turn = self.first.perp(&self.second);
        let cube = speed * speed * speed;
        let speed_rate = self.first.dot(&self.second) / speed;
        let turn_rate = self.first.perp(&self.third);
        [turn / cube, turn_rate / cube - 3.0 * turn * speed_rate / (cube * speed)]
    }
}

/// A point list that makes no profile.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// There are too few points.
    #[error("a profile of {count} points, at least {least} are needed")]
    TooFew {
        /// Number of points left without those too close together.
        count: usize,
        /// Number needed.
        least: usize,
    },
    /// A coordinate is not a number.
    #[error("point {number} of a profile is ({outward} m, {up} m), finite coordinates are needed")]
    NotFinite {
        /// Number of the point, from 1.
        number: usize,
        /// m.
        outward: f64,
        /// m.
        up: f64,
    },
    /// The list does not run outward.
    #[error("a profile runs from {first} m to {last} m, its points have to run outward")]
    NotOutward {
        /// Outward coordinate of the first point, m.
        first: f64,
        /// Outward coordinate of the last point, m.
        last: f64,
    },
}

impl Profile {
    /// Fewest points of a profile.
    const LEAST: usize = 4;

    /// Profile through `points` (outward, up; m), listed from the inside outward. A point nearer than `spacing` (m) to
    /// the one before is left out: points closer than the digits of their coordinates make a noisy curvature.
    ///
    /// # Errors
    /// See [`ProfileError`].
    pub fn new(points: &[[f64; 2]], spacing: f64) -> Result<Self, ProfileError> {
        let (mut length, mut outward, mut up) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &[y, z]) in points.iter().enumerate() {
            if !(y.is_finite() && z.is_finite()) {
                return Err(ProfileError::NotFinite {
                    number: i + 1,
                    outward: y,
                    up: z,
                });
            }
            let Some(&before) = length.last() else {
                length.push(0.0);
                outward.push(y);
                up.push(z);
                continue;
            };
            let last = outward.len() - 1;
            let distance = (y - outward[last]).hypot(z - up[last]);
            if distance > spacing.max(0.0) {
                length.push(before + distance);
                outward.push(y);
                up.push(z);
            }
        }
        let count = length.len();
        if count < Self::LEAST {
            return Err(ProfileError::TooFew {
                count,
                least: Self::LEAST,
            });
        }
        let (first, last) = (outward[0], outward[count - 1]);
        if first >= last {
            return Err(ProfileError::NotOutward { first, last });
        }
        Ok(Self {
            outward: Spline::new(length.clone(), outward),
            up: Spline::new(length, up),
        })
    }

    /// First and last value of the parameter, m.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        self.outward.range()
    }

    /// Curve at the parameter `sigma`, m; beyond the ends the end tangent.
    #[must_use]
    pub fn at(&self, sigma: f64) -> ProfilePoint {
        let segment = self.outward.segment(sigma);
        let Jet3(y) = self.outward.in_segment(segment, sigma);
        let Jet3(z) = self.up.in_segment(segment, sigma);
        ProfilePoint {
            position: Vector2::new(y[0], z[0]),
            first: Vector2::new(y[1], z[1]),
            second: Vector2::new(y[2], z[2]),
            third: Vector2::new(y[3], z[3]),
        }
    }

    /// Parameter of the first point with the outward coordinate `outward`, m; `None` if there is none.
    #[must_use]
    pub fn parameter_at(&self, outward: f64) -> Option<f64> {
        let values = self.outward.values();
        let end = values.iter().position(|&value| value >= outward)?;
        if end == 0 {
            return (values[0] == outward).then(|| self.outward.knots()[0]);
        }
        let mut bracket = [self.outward.knots()[end - 1], self.outward.knots()[end]];
        let mut sigma = 0.5 * (bracket[0] + bracket[1]);
        for _ in 0..60 {
            let Jet3([value, slope, ..]) = self.outward.in_segment(end - 1, sigma);
            let miss = value - outward;
            bracket[usize::from(miss > 0.0)] = sigma;
            let newton = sigma - miss / slope;
            let next = if newton > bracket[0] && newton < bracket[1] {
                newton
            } else {
                0.5 * (bracket[0] + bracket[1])
            };
            if next == sigma {
                break;
            }
            sigma = next;
        }
        Some(sigma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of radius 0.3 m about (0, −0.3 m), points 1° apart.
    fn arc() -> Profile {
        let points: Vec<[f64; 2]> = (-20..=20)
            .map(|i| f64::from(i).to_radians())
            .map(|angle| [0.3 * angle.sin(), 0.3 * angle.cos() - 0.3])
            .collect();
        Profile::new(&points, 1e-6).unwrap()
    }

    #[test]
    fn the_curvature_of_a_circle_is_the_inverse_of_its_radius() {
        let arc = arc();
        // Away from the natural ends; the spline's second derivative has an error of h² κ³ / 12, its third one of
        // h κ⁴ / 6.
        let [curvature, rate] = arc.at(0.5 * arc.range()[1] + 0.001).curvature();
        assert!(
            (curvature + 1.0 / 0.3).abs() < 1e-4 && rate.abs() < 0.11,
            "{curvature} {rate}"
        );
    }

    #[test]
    fn the_parameter_of_a_lateral_position_is_found() {
        let arc = arc();
        for outward in [-0.1, -0.03, 0.0, 0.0777] {
            let sigma = arc.parameter_at(outward).unwrap();
            assert!((arc.at(sigma).position.x - outward).abs() < 1e-15); // rounding
        }
        assert_eq!(arc.parameter_at(0.2), None);
        assert_eq!(arc.parameter_at(-0.2), None);
    }

    #[test]
    fn points_that_coincide_are_left_out_and_lists_that_make_no_curve_refused() {
        let points = [
            [0.0, 0.0],
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 1e-9],
            [2.0 + 1e-9, 0.0],
            [3.0, 0.0],
        ];
        assert_eq!(Profile::new(&points, 1e-6).unwrap().outward.knots().len(), 4);
        let few = Profile::new(&points[..4], 1e-6).unwrap_err();
        assert_eq!(few.to_string(), "a profile of 3 points, at least 4 are needed");
        let back: Vec<_> = points.iter().rev().copied().collect();
        let refused = Profile::new(&back, 1e-6).unwrap_err().to_string();
        assert!(refused.contains("from 3 m to 0 m"), "{refused}");
        let broken = Profile::new(&[[0.0, f64::NAN]], 1e-6).unwrap_err().to_string();
        assert!(broken.starts_with("point 1 of a profile is (0 m, NaN m)"), "{broken}");
    }
}
