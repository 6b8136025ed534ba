//! Motion of the pantograph's base beside the travel: none, given, or that of a vehicle.
use crate::pantograph::BaseMount;
use crate::rail_vehicle::Vehicle;
use crate::track::{Reach, TrackShape};
use crate::{Base, GivenMotion, Placement, VehicleError};
use dynamics::{Layout, State};
use nalgebra::Vector3;
use std::sync::Arc;

/// Motion of the pantograph's base relative to the travel along the track.
#[derive(Clone, Debug)]
pub(crate) enum BaseMotion {
    /// None: the base travels on a straight line.
    Straight,
    /// Displacements and angles as functions of time.
    Given(Arc<GivenMotion>),
    /// Motion of the vehicle body under the base.
    Vehicle(Box<Vehicle>),
}

fn unread(key: &'static str, file: &str) -> VehicleError {
    VehicleError::Unread {
        key,
        file: file.to_owned(),
    }
}

impl BaseMotion {
    /// Builds the motion of the base into `layout`; `name` begins the names of the coordinates.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub(crate) fn new(
        placement: &Placement,
        base: Base,
        name: &str,
        layout: &mut Layout,
    ) -> Result<Self, VehicleError> {
        let entry = match placement.vehicle.as_deref() {
            None => return Ok(Self::Straight),
            Some(scene::Vehicle::RigidMotion(motion)) => {
                if let Some(file) = &motion.file {
                    return Err(unread("vehicle.motion.file", file));
                }
                return Ok(Self::Given(Arc::new(GivenMotion::new(motion))));
            }
            Some(scene::Vehicle::Vertical(entry) | scene::Vehicle::Full(entry)) => entry,
        };
        if let Some(scene::Irregularities::Points(scene::Points { file: Some(file), .. })) =
            placement.track.as_deref().map(|track| &track.irregularities)
        {
            return Err(unread("track.irregularities.file", file));
        }
        let start = base.start_x + entry.foremost_wheel();
        let reach = Reach {
            start,
            end: start + base.speed * placement.duration,
            rail_distance: entry.wheels.distance,
        };
        let track = placement
            .track
            .as_deref()
            .and_then(|track| TrackShape::new(track, reach));
        if let Some(rails) = placement.track.as_deref()
            && let Some(first) = rails.curves.first()
            && let ahead = start.max(base.start_x)
            && ahead > first.start - 0.5 * first.rounding
        {
            let least = scene::millimetres_up(ahead + 0.5 * first.rounding);
            let path = rails.curve_key(0);
            return Err(VehicleError::StartsInCurve {
                path,
                start: first.start,
                least,
                ahead,
                rounding: first.rounding,
            });
        }
        let gravity = placement.gravity;
        let vehicle = match (placement.vehicle.as_deref(), placement.track.as_deref()) {
            (Some(scene::Vehicle::Full(_)), Some(rails)) => {
                Vehicle::full(entry, (rails, track.as_ref()), base, gravity, name, layout)?
            }
            (Some(scene::Vehicle::Full(_)), None) => {
                return Err(VehicleError::Missing { key: "[track]" });
            }
            _ => Vehicle::vertical(entry, track.as_ref(), base, gravity, name, layout)?,
        };
        Ok(Self::Vehicle(Box::new(vehicle)))
    }

    /// Mount of the pantograph's base.
    pub(crate) fn mount(&self) -> BaseMount {
        match self {
            Self::Straight => BaseMount::Fixed,
            Self::Given(given) => BaseMount::Given(Arc::clone(given)),
            Self::Vehicle(vehicle) => BaseMount::Body(vehicle.pantograph_base()),
        }
    }

    /// Vehicle under the pantograph, if modelled.
    #[must_use]
    pub fn vehicle(&self) -> Option<&Vehicle> {
        match self {
            Self::Vehicle(vehicle) => Some(vehicle),
            Self::Straight | Self::Given(_) => None,
        }
    }

    /// Number of generalised velocities and of constraint equations.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        self.vehicle()
            .map_or([0; 2], |vehicle| [vehicle.coordinates(), vehicle.constraint_count()])
    }

    /// Point of the pantograph's base in the reference position, in the frame of the base, m; z is `height` unless a
    /// vehicle sets it.
    pub(crate) fn base_point(&self, height: f64) -> Vector3<f64> {
        match self {
            Self::Vehicle(vehicle) => {
                let marker = vehicle.pantograph_base();
                marker.pose.reference + marker.offset
            }
            Self::Straight | Self::Given(_) => Vector3::new(0.0, 0.0, height),
        }
    }

    /// Writes the vehicle's part of an equilibrium into `state`.
    pub(crate) fn set_rest(&self, rest: Option<&crate::rail_vehicle::VehicleRest>, state: &mut State) {
        if let (Self::Vehicle(vehicle), Some(rest)) = (self, rest) {
            vehicle.set_rest(rest, state);
        }
    }
}
