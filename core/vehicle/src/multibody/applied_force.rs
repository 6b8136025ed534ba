//! The contact force on a strip, as an input of the system.
use dynamics::{Blocks, Column, Columns, Force, Frame, Marker, MonotoneCubic, Motion, Weights};
use nalgebra::Vector3;

/// Force on a collector strip, set through the inputs: `u[first..first + 4]` = (f_x, f_y, f_z) in N, world axes, and
/// the lateral position y of the point of action, m.
///
/// The point of action is the point of the strip's lateral axis, or of the top of a head with horns, at y; a strip that
/// can only rise takes up the vertical force alone.
pub struct AppliedForce {
    /// Middle of the strip; the second axis runs along the strip.
    pub marker: Box<dyn Marker>,
    /// Index of `f_x` in the inputs.
    pub first: usize,
    /// Height of the top of a head with horns above the strip over the distance from its middle.
    pub top: Option<MonotoneCubic>,
}

/// The force at one instant.
struct Load {
    force: Vector3<f64>,
    point: Point,
    columns: Columns,
}

/// Newton's corrections of the place on a horn that rolls.
const CORRECTIONS: usize = 4;

/// Point of action on the strip.
struct Point {
    /// Direction of the strip.
    lateral: Vector3<f64>,
    /// Distance along the strip from its middle, m.
    distance: f64,
    /// Way from the strip's axis, m; zero without horns.
    drop: Vector3<f64>,
    /// Direction in which the point slides, per metre along the strip.
    tangent: Vector3<f64>,
}

impl AppliedForce {
    /// Number of inputs.
    pub const INPUTS: usize = 4;

    /// Point of action from the middle of the strip, which is at `frame`, m.
    pub(crate) fn lever(&self, frame: &Frame, motion: &Motion<'_>) -> Vector3<f64> {
        self.point(frame, motion.u[self.first + 3]).lever()
    }

    /// Point of the strip at the lateral position `y`, m.
    fn point(&self, frame: &Frame, y: f64) -> Point {
        let lateral = frame.axes.column(1).into_owned();
        let mut point = Point {
            distance: (y - frame.position.y) / lateral.y,
            drop: Vector3::zeros(),
            tangent: lateral,
            lateral,
        };
        if let Some(top) = &self.top {
            let up: Vector3<f64> = frame.axes.column(2).into();
            // A strip that does not roll is there at once.
            for _ in 0..CORRECTIONS {
                let [height, slope, _] = top.at(point.distance.abs());
                point.drop = height * up;
                point.tangent = lateral + slope * point.distance.signum() * up;
                let beyond = frame.position.y + point.lever().y - y;
                point.distance -= beyond / point.tangent.y;
            }
        }
        point
    }

    fn load(&self, motion: &Motion<'_>) -> Load {
        let u = &motion.u[self.first..self.first + Self::INPUTS];
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        Load {
            force: Vector3::new(u[0], u[1], u[2]),
            point: self.point(&self.marker.frame(motion), u[3]),
            columns,
        }
    }
}

impl Point {
    /// Way from the middle of the strip, m.
    fn lever(&self) -> Vector3<f64> {
        self.lateral * self.distance + self.drop
    }
}

impl Force for AppliedForce {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let load = self.load(motion);
        load.columns.add_force(&load.force, &load.point.lever(), force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let load = self.load(motion);
        let columns = load.columns.as_slice();
        let mut values = [0.0; Columns::CAPACITY * Columns::CAPACITY];
        let mut indices = [0; Columns::CAPACITY];
        let n = columns.len();
        for (k, of) in columns.iter().enumerate() {
            indices[k] = of.index;
            for (l, by) in columns.iter().enumerate() {
                values[k * n + l] = -weights.q * load.derivative(of, by);
            }
        }
        blocks.add(&indices[..n], &indices[..n], &values[..n * n]);
    }
}

impl Load {
    /// Derivative of the generalised force of the column `of` in the direction `by`; both belong to one rigid body.
    fn derivative(&self, of: &Column, by: &Column) -> f64 {
        if of.rotation == Vector3::zeros() {
            return 0.0; // The force is constant and so is the column of a displacement.
        }
        let point = &self.point;
        let lever = of.translation + of.rotation.cross(&point.lever());
        let lateral_rate = by.rotation.cross(&point.lateral);
        let drop_rate = by.rotation.cross(&point.drop);
        // The point stays at the same y while the strip slides under it.
        let aside = by.translation.y + point.distance * lateral_rate.y + drop_rate.y;
        let sliding = of.rotation.cross(&point.tangent) * (-aside / point.tangent.y);
        self.force.dot(&(by.rotation.cross(&lever) + sliding))
    }
}
