//! The shape of the track: its curves, and the irregularities of its rails.
mod alignment;
mod spectrum;

pub(crate) use alignment::Alignment;

use dynamics::RestingSpline;
use scene::{Irregularities, Points};
use std::sync::Arc;

/// Deviation of one rail from the ideal line, along the axes of the track.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RailShape {
    z: RestingSpline,
    y: RestingSpline,
}

impl RailShape {
    /// Rise and its first and second derivative along the track at `x` (m): m, –, 1/m.
    #[must_use]
    pub fn rise(&self, x: f64) -> [f64; 3] {
        self.z.at(x)
    }

    /// Lateral deviation to the left, as [`RailShape::rise`].
    #[must_use]
    pub fn lateral(&self, x: f64) -> [f64; 3] {
        self.y.at(x)
    }
}

/// Both rails.
#[derive(Clone, Debug)]
pub(crate) struct TrackShape {
    /// Left and right.
    pub rails: [Arc<RailShape>; 2],
}

/// Range for which the shape of a track is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reach {
    /// Begin of the irregularities, m: the foremost wheel at t = 0.
    pub start: f64,
    /// Last position reached by a wheel, m.
    pub end: f64,
    /// Distance of the rails, m.
    pub rail_distance: f64,
}

impl TrackShape {
    /// Irregularities of a track; `None` if both rails are smooth.
    #[must_use]
    pub fn new(track: &scene::Track, reach: Reach) -> Option<Self> {
        match &track.irregularities {
            Irregularities::None => None,
            Irregularities::Spectrum(entry) => Some(spectrum::realise(entry, reach)),
            Irregularities::Points(points) => Some(Self::measured(points)),
        }
    }

    fn measured(points: &Points) -> Self {
        let rail = |z: &[f64], y: &[f64]| {
            Arc::new(RailShape {
                z: RestingSpline::new(points.x.clone(), z.to_vec()),
                y: RestingSpline::new(points.x.clone(), y.to_vec()),
            })
        };
        Self {
            rails: [
                rail(&points.z_left, &points.y_left),
                rail(&points.z_right, &points.y_right),
            ],
        }
    }
}
