//! A strip of a lumped pantograph as others see it.
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::{Matrix3, Vector3};

/// Strip on a mass of a chain, in the frame of the base: the strip rises and falls, nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadMarker {
    /// Coordinate of the mass.
    pub coordinate: usize,
    /// Place along the track from the middle of the head, m.
    pub x: f64,
    /// Coordinate of the angle by which the front of the head is lowered; none for a head that rises only.
    pub pitch: Option<usize>,
    /// Lateral position from the middle of the track, m.
    pub lateral: f64,
    /// Height above the top of rail at coordinate zero, m.
    pub reference_height: f64,
}

impl Marker for HeadMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let mut height = self.reference_height + motion.q[self.coordinate];
        let mut rate = motion.v[self.coordinate];
        if let Some(pitch) = self.pitch {
            height -= self.x * motion.q[pitch];
            rate -= self.x * motion.v[pitch];
        }
        Frame {
            position: Vector3::new(self.x, self.lateral, height),
            axes: Matrix3::identity(),
            velocity: Vector3::new(0.0, 0.0, rate),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        columns.push(self.coordinate, Vector3::z(), Vector3::zeros());
        if let Some(pitch) = self.pitch {
            columns.push(pitch, -self.x * Vector3::z(), Vector3::zeros());
        }
    }
}
