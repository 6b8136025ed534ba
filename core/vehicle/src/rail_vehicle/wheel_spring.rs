//! Wheels on linear springs.
use crate::Base;
use crate::multibody::{Anchor, BaseMarker, BodyMarker, Measure, Pair};
use crate::track::RailShape;
use dynamics::{Blocks, Columns, Force, Marker, Motion, Power, Weights};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// The contact of one wheel with a rail, linearised about a load: a vertical spring–damper between the wheel's axle and
/// the height of the rail under it.
///
/// ```text
/// F = k (ζ − w) + c (ζ̇ − ẇ),    ζ(t) = ζ_rail(x₀ + v t)
/// ```
///
/// `w` is the rise of the axle, `ζ` the rise of the rail at the wheel's position in undisturbed travel, so that ζ is a
/// function of time alone. The spring pulls on a wheel that would lift off.
#[derive(Clone, Debug)]
pub struct WheelSpring {
    pair: Pair,
    /// x of the wheel in the frame of the base, m.
    x: f64,
    base: Base,
    rail: Option<Arc<RailShape>>,
    stiffness: f64,
    damping: f64,
}

impl WheelSpring {
    const RISE: Measure = Measure::Point(2);

    /// Wheel with the axle at `axle` (m, frame of the base) in the reference position. `stiffness` in N/m, `damping` in
    /// N·s/m.
    #[must_use]
    pub fn new(
        wheelset: BodyMarker,
        axle: Vector3<f64>,
        base: Base,
        rail: Option<Arc<RailShape>>,
        [stiffness, damping]: [f64; 2],
    ) -> Self {
        let first = Anchor::Base(BaseMarker {
            position: axle,
            axes: Matrix3::identity(),
        });
        Self {
            pair: Pair {
                first,
                second: Anchor::Body(wheelset),
            },
            x: axle.x,
            base,
            rail,
            stiffness,
            damping,
        }
    }

    /// `ζ` and its rate, m and m/s.
    fn rail(&self, t: f64) -> [f64; 2] {
        self.rail.as_ref().map_or([0.0; 2], |rail| {
            let [rise, slope, _] = rail.rise(self.base.position(t).x + self.x);
            [rise, slope * self.base.speed]
        })
    }

    /// `ζ − w` and its rate.
    fn compression(&self, motion: &Motion<'_>) -> [f64; 2] {
        let frame = self.pair.second.frame(motion);
        let rise = frame.position.z - self.pair.first.frame(motion).position.z;
        let [rail, rail_rate] = self.rail(motion.t);
        [rail - rise, rail_rate - frame.velocity.z]
    }

    /// Vertical force of the rail on the wheel, N.
    #[must_use]
    pub fn load(&self, motion: &Motion<'_>) -> f64 {
        let [compression, rate] = self.compression(motion);
        self.stiffness * compression + self.damping * rate
    }
}

impl Force for WheelSpring {
    fn depends_on_inputs(&self) -> bool {
        false
    }

    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let mut columns = Columns::default();
        self.pair.second.columns(motion, &mut columns);
        columns.add_force(&Vector3::new(0.0, 0.0, self.load(motion)), &Vector3::zeros(), force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let view = self.pair.view(motion);
        let (rise_q, rise_qq) = (view.gradient(Self::RISE), view.hessian(Self::RISE));
        let mut v = rise_q * 0.0;
        for (v, &index) in v.iter_mut().zip(view.indices()) {
            *v = motion.v[index];
        }
        let rate_q = rise_qq.transpose() * v;
        let stiffness =
            rise_q * (rise_q * self.stiffness + rate_q * self.damping).transpose() - rise_qq * self.load(motion);
        let damping = rise_q * rise_q.transpose() * self.damping;
        crate::multibody::add_square(blocks, view.indices(), &(stiffness * weights.q + damping * weights.v));
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let [compression, _] = self.compression(motion);
        0.5 * self.stiffness * compression * compression
    }

    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let [_, rate] = self.compression(motion);
        Some(Power {
            driven: self.load(motion) * self.rail(motion.t)[1],
            dissipated: self.damping * rate * rate,
        })
    }
}
