//! Travel of the pantograph's base along the track, and markers that travel with the base.
use dynamics::{Columns, Frame, Marker, Motion};
use nalgebra::Vector3;

/// Straight travel along the track at constant speed; the height of the base does not change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// x of the origin of the base's frame at t = 0, m.
    pub start_x: f64,
    /// m/s.
    pub speed: f64,
}

impl Base {
    /// World position of the origin of the base's frame at time `t` (s), m.
    #[must_use]
    pub fn position(&self, t: f64) -> Vector3<f64> {
        Vector3::new(self.start_x + self.speed * t, 0.0, 0.0)
    }

    /// World velocity of the base, m/s.
    #[must_use]
    pub fn velocity(&self) -> Vector3<f64> {
        Vector3::new(self.speed, 0.0, 0.0)
    }
}

/// A marker given in the frame of a base, as the world sees it.
#[derive(Clone, Copy, Debug)]
pub struct Travelling<M> {
    /// In the frame of the base.
    pub marker: M,
    /// Base with which the marker travels.
    pub base: Base,
}

impl<M: Marker> Marker for Travelling<M> {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let frame = self.marker.frame(motion);
        Frame {
            position: frame.position + self.base.position(motion.t),
            velocity: frame.velocity + self.base.velocity(),
            ..frame
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        // The travel is prescribed: it has no generalised velocity.
        self.marker.columns(motion, columns);
    }
}
