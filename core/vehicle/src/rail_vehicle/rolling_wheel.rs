//! Wheels that roll on rails.
use super::spin::{Spin, WheelsetMarker};
use crate::Travel;
use crate::track::{Alignment, RailShape};
use crate::wheel_rail::{
    CreepLaw, CreepModel, Hertz, Profile, Rail, RailFrame, RailLine, Side, Wheel, WheelRail, WheelRailParts,
};
use dynamics::{Blocks, Force, Motion, Power, StepHistory, Weights};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// Speed below which rolling counts as this speed in creepages, m/s: walking pace.
const SLOWEST: f64 = 1.0;

/// Rail beside the middle of the track, with irregularities; the cross-section stays across the track and upright on
/// the track plane.
struct IrregularRail {
    /// y of the profile's origin, m.
    y: f64,
    shape: Option<Arc<RailShape>>,
    /// Share of the irregularities, 0…1.
    part: f64,
    /// Alignment of the track; `None` is straight and level.
    alignment: Option<Arc<Alignment>>,
}

impl RailLine for IrregularRail {
    fn frame(&self, s: f64, from: f64) -> RailFrame {
        let none = ([0.0; 3], [0.0; 3]);
        let (y, z) = self
            .shape
            .as_ref()
            .map_or(none, |shape| (shape.lateral(s), shape.rise(s)));
        let [y, z] = [y, z].map(|shape| shape.map(|value| self.part * value));
        if let Some(alignment) = &self.alignment {
            return alignment.seen_from(s, from).beside([
                Vector3::new(0.0, self.y + y[0], z[0]),
                Vector3::new(0.0, y[1], z[1]),
                Vector3::new(0.0, y[2], z[2]),
            ]);
        }
        RailFrame {
            position: Vector3::new(s, self.y + y[0], z[0]),
            direction: Vector3::new(1.0, y[1], z[1]),
            bend: Vector3::new(0.0, y[2], z[2]),
            axes: Matrix3::identity(),
            turn: Vector3::zeros(),
            turn_rate: Vector3::zeros(),
        }
    }
}

/// Data shared by all wheels of a vehicle.
#[derive(Clone)]
pub(super) struct Rolling {
    pub travel: Travel,
    pub radius: f64,
    /// Distance from the middle of a wheelset to the nominal rolling circle, m.
    pub distance: f64,
    pub wheel: Arc<Profile>,
    pub rail: Arc<Profile>,
    /// Distance from the middle of the track to the origin of a rail's profile, m.
    pub rail_distance: f64,
    pub hertz: Hertz,
    pub damping: f64,
    pub creep: CreepModel,
}

/// One wheel on its rail.
pub struct RollingWheel {
    shared: Rolling,
    spin: Spin,
    side: Side,
    shape: Option<Arc<RailShape>>,
    contact: WheelRail,
}

impl Clone for RollingWheel {
    /// Clones without the memory of past searches.
    fn clone(&self) -> Self {
        Self::new(self.shared.clone(), self.spin, self.side, self.shape.clone())
    }
}

impl std::fmt::Debug for RollingWheel {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("RollingWheel")
            .field("side", &self.side)
            .finish_non_exhaustive()
    }
}

impl RollingWheel {
    pub(super) fn new(shared: Rolling, spin: Spin, side: Side, shape: Option<Arc<RailShape>>) -> Self {
        Self::on_part(shared, spin, side, shape, 1.0)
    }

    /// Wheel on rails with the share `part` of their irregularities.
    fn on_part(shared: Rolling, spin: Spin, side: Side, shape: Option<Arc<RailShape>>, part: f64) -> Self {
        let contact = WheelRail::new(WheelRailParts {
            marker: Box::new(WheelsetMarker::new(spin.pose, spin.coordinate)),
            travel: shared.travel.clone(),
            along: spin.pose.reference.x,
            spin: spin.rolling,
            wheel: Wheel {
                profile: Arc::clone(&shared.wheel),
                radius: shared.radius,
                distance: shared.distance,
                side,
            },
            rail: Rail {
                profile: Arc::clone(&shared.rail),
                line: Arc::new(IrregularRail {
                    y: side.sign() * shared.rail_distance,
                    shape: shape.clone(),
                    part,
                    alignment: shared.travel.alignment().cloned(),
                }),
                side,
            },
            hertz: shared.hertz.clone(),
            damping: shared.damping,
            creep: shared.creep.clone(),
            slowest: SLOWEST,
        });
        Self {
            shared,
            spin,
            side,
            shape,
            contact,
        }
    }

    /// Scales the irregularities of the rail by `part`, for statics that begin on smooth rails; creep forces are left
    /// out as for smooth rails.
    pub(super) fn set_irregularity(&mut self, part: f64) {
        *self = Self::on_part(self.shared.clone(), self.spin, self.side, self.shape.clone(), part);
        self.set_creeping(false);
    }

    /// Takes the creep forces out for statics, in which nothing rolls, or puts them back.
    pub(super) fn set_creeping(&mut self, creeping: bool) {
        let law = if creeping {
            self.shared.creep.law
        } else {
            CreepLaw::Frictionless
        };
        self.contact.set_creep(CreepModel {
            law,
            ..self.shared.creep.clone()
        });
    }

    /// Adds `rate` (rad/s) to the spin given by the coordinates.
    pub(super) fn set_rolling(&mut self, rate: f64) {
        self.contact.set_spin(self.spin.rolling + rate);
    }

    /// Force of the rail on the wheel, N: along the track, to its left, and up from the plane of the rails.
    #[must_use]
    pub fn force(&self, motion: &Motion<'_>) -> Vector3<f64> {
        self.contact.force(motion)
    }

    /// Y/Q: force in the plane of the rails that presses the rail outward, over the force perpendicular to that plane
    /// [EN 14363]; 0 for a lifted wheel.
    #[must_use]
    pub fn derailment_quotient(&self, motion: &Motion<'_>) -> f64 {
        let force = self.force(motion);
        if force.z > 0.0 {
            -self.side.sign() * force.y / force.z
        } else {
            0.0
        }
    }
}

impl Force for RollingWheel {
    fn depends_on_inputs(&self) -> bool {
        false
    }

    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.contact.add_force(motion, force);
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        // The matrix may be analysed and made again at other motions than the present one: a restored run repeats bit
        // for bit only if the start of the next search is left alone.
        let mut start = Vec::new();
        self.contact.save(&mut start);
        self.contact.add_tangent(motion, weights, blocks);
        self.contact.restore(&mut start.iter());
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.contact.energy(motion)
    }

    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        self.contact.power(motion)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl StepHistory for RollingWheel {
    fn begin_step(&mut self, motion: &Motion<'_>, h: f64) {
        self.contact.begin_step(motion, h);
    }

    fn save(&self, out: &mut Vec<f64>) {
        self.contact.save(out);
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        self.contact.restore(values);
    }
}
