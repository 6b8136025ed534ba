//! Contacts of one wheel that share a patch.
use super::ContactPoint;
use super::search::MAX_CONTACTS;
use nalgebra::Vector3;

/// Counted penetration of a contact, and the derivatives.
///
/// Between two points of largest overlap there is one of least overlap, v. For v > 0 both are one patch of material,
/// and the overlap below v would count twice. This overlap is shared out:
///
/// ```text
/// δ̂₁ = δ₁ − v p₂/(p₁ + p₂),   δ̂₂ = δ₂ − v p₁/(p₁ + p₂),   p = δ − v                             (derived here)
/// ```
///
/// Two separate patches (v ≤ 0) keep their overlap. A maximum about to vanish (p₂ → 0) has a part of zero and the other
/// one the whole, so that no force jumps at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overlap {
    /// δ̂, m.
    pub penetration: f64,
    /// `dδ̂ = −N·dr − M·dθ` for a displacement of the middle of the wheelset and a rotation of the wheelset: N (–), M
    /// (m).
    pub gradient: [Vector3<f64>; 2],
}

impl Overlap {
    fn add(&mut self, point: &ContactPoint, weight: f64) {
        // The points of wheel and rail lie on a common normal: their wandering does not change the overlap.
        self.gradient[0] += point.normal * weight;
        self.gradient[1] += point.lever.cross(&point.normal) * weight;
    }

    /// Rate of δ̂ with the velocity of the middle of the wheelset and its angular velocity, m/s.
    pub fn rate(&self, velocity: &Vector3<f64>, angular_velocity: &Vector3<f64>) -> f64 {
        -self.gradient[0].dot(velocity) - self.gradient[1].dot(angular_velocity)
    }
}

/// Counted penetration of each point; `valleys` hold the points of least overlap after each point.
pub(super) fn overlaps(
    points: &[Option<ContactPoint>; MAX_CONTACTS],
    valleys: &[Option<ContactPoint>; MAX_CONTACTS],
) -> [Option<Overlap>; MAX_CONTACTS] {
    let mut overlaps = std::array::from_fn(|place| {
        points[place].as_ref().map(|point| {
            let mut overlap = Overlap {
                penetration: point.penetration,
                gradient: [Vector3::zeros(); 2],
            };
            overlap.add(point, 1.0);
            overlap
        })
    });
    for place in 0..MAX_CONTACTS - 1 {
        let ([Some(first), Some(second)], Some(valley)) = ([&points[place], &points[place + 1]], &valleys[place])
        else {
            continue;
        };
        let v = valley.penetration;
        let sum = first.penetration + second.penetration - 2.0 * v;
        if v <= 0.0 || sum <= 0.0 {
            continue;
        }
        for (index, own, other) in [(place, first, second), (place + 1, second, first)] {
            let (p, q) = (own.penetration - v, other.penetration - v);
            if let Some(overlap) = &mut overlaps[index] {
                overlap.penetration -= v * q / sum;
                overlap.add(own, v * q / (sum * sum));
                overlap.add(other, -v * p / (sum * sum));
                overlap.add(valley, -q / sum - v * (q - p) / (sum * sum));
            }
        }
    }
    overlaps
}
