//! Strips fixed to the head of a linkage.
use super::builder::Builder;
use crate::VehicleError;
use crate::multibody::BodyMarker;
use scene::Linkage as Entry;

/// Strips of the head of a linkage, on one line along the track.
///
/// Forces `F_k` at `x_k` act on the rigid head as their sum `F` in the mean place and the moment `M` about it. A head
/// that is free to pitch determines both at rest by its height and slope; else `M` is taken as zero (*derived here*):
///
/// ```text
/// M = Σ F_k (x_k − x̄),    F_k = F/n + M (x_k − x̄)/Σ (x_l − x̄)²
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Strips {
    /// Strips in order.
    pub markers: Vec<BodyMarker>,
    /// Places along the track from the mean place, m.
    places: Vec<f64>,
    /// Mean place along the track from the middle of the head, m.
    pub mean: f64,
    /// Point of the head a metre ahead of the mean place.
    pub ahead: BodyMarker,
    /// True where the joints let the head pitch beside its rise and that of the mechanism.
    pub pitch: bool,
}

impl Strips {
    pub(super) fn new(entry: &Entry, builder: &Builder<'_>) -> Result<Self, VehicleError> {
        let places: Vec<f64> = if entry.strips.is_empty() {
            vec![0.0]
        } else {
            entry.strips.iter().map(|strip| strip.x).collect()
        };
        let mean = mean(&places);
        let markers = places.iter().map(|&x| builder.strip(x)).collect::<Result<_, _>>()?;
        Ok(Self {
            markers,
            places: places.iter().map(|x| x - mean).collect(),
            mean,
            ahead: builder.strip(mean + 1.0)?,
            pitch: false,
        })
    }

    /// Sum of the squared distances from the mean place, m²; 0 of one strip.
    fn square(&self) -> f64 {
        self.places.iter().map(|x| x * x).sum()
    }

    /// Slope of the straight line of least squares through `heights` of the strips, m, rising ahead, –.
    pub fn slope(&self, heights: &[f64]) -> f64 {
        let square = self.square();
        if square == 0.0 {
            return 0.0;
        }
        self.places
            .iter()
            .zip(heights)
            .map(|(x, height)| x * height)
            .sum::<f64>()
            / square
    }

    /// Heights of the strips on a head with the mean height `height` (m) and this slope.
    pub fn heights(&self, height: f64, slope: f64) -> Vec<f64> {
        self.places.iter().map(|x| height + x * slope).collect()
    }

    /// Forces of the strips (N) with this sum (N) and moment (N·m).
    pub fn forces(&self, sum: f64, moment: f64) -> Vec<f64> {
        let (count, square) = (self.places.len() as f64, self.square());
        if square == 0.0 {
            return vec![sum; self.places.len()];
        }
        self.places.iter().map(|x| sum / count + moment * x / square).collect()
    }

    /// Changes of the strips' heights (m, one per strip) that the head allows, one row for each.
    pub fn rises(&self) -> Vec<Vec<f64>> {
        let mut rises = vec![vec![1.0; self.places.len()]];
        if self.pitch {
            rises.push(self.places.clone());
        }
        rises
    }
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
