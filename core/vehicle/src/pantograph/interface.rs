//! The interface of all pantographs, and the one place where a model is chosen.
use super::air::{Air, AirForces};
use super::base_mount::{BaseDisplacement, BaseMount};
use super::equilibrium::{Equilibrium, Offsets, Target};
use super::{Linkage, Lumped, ReducedLinkage};
use crate::base_motion::BaseMotion;
use crate::error::Irreducible;
use crate::rail_vehicle::Load;
use crate::{Base, Placement, VehicleError};
use control::Reading;
use dynamics::{Constraint, Force, Layout, Marker, Motion, PartVisitor};
use nalgebra::Vector3;
use scene::PantographModel as Entry;

/// A pantograph in the frame of its base: a contribution to a system with a strip, and statics of its own.
pub(crate) trait Pantograph: std::fmt::Debug + Send {
    /// Visits every force with the name of its part, in a fixed order.
    fn parts(&mut self, visit: &mut PartVisitor<'_>);

    /// Visits every force, in the order of [`Pantograph::parts`].
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.parts(&mut |_, force| visit(force));
    }

    /// Visits every joint in a fixed order.
    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        let _ = visit;
    }

    /// Exposes the pantograph to the air; the points travel with `base`.
    fn expose(&mut self, air: &Air, base: Base);

    /// Forces of the air.
    fn air(&self) -> &AirForces;

    /// Forces of the air, to be changed.
    fn air_mut(&mut self) -> &mut AirForces;

    /// State of rest at a target, with the base in the reference position, or displaced.
    ///
    /// # Errors
    /// Without such a state: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`], or
    /// [`VehicleError::NotReducible`] for a model whose base cannot be displaced.
    fn equilibrium(&self, base: Option<BaseDisplacement>, target: Target) -> Result<Equilibrium, VehicleError>;

    /// Number of strips.
    fn strips(&self) -> usize {
        1
    }

    /// Changes of the strips' heights (m, one per strip) that the head allows beside each other, one row for each: of
    /// one strip its rise.
    fn rises(&self) -> Vec<Vec<f64>> {
        vec![vec![1.0]]
    }

    /// State of rest with the strips at these heights (m, one per strip), as far as the head allows them, with the base
    /// as in [`Pantograph::equilibrium`].
    ///
    /// # Errors
    /// See [`Pantograph::equilibrium`].
    fn equilibrium_under(&self, base: Option<BaseDisplacement>, heights: &[f64]) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(base, Target::Height(heights[0]))
    }

    /// Loads of the pantograph at rest on the vehicle. By default the base, at `base` (m), presses with the contact
    /// force alone: the weight counts as part of the vehicle.
    ///
    /// # Errors
    /// See [`VehicleError`].
    fn loads(&self, equilibrium: &Equilibrium, base: Vector3<f64>) -> Result<Vec<Load>, VehicleError> {
        Ok(vec![Load {
            point: base,
            force: -equilibrium.force,
        }])
    }

    /// Begins a motion at an equilibrium.
    fn start_at(&mut self, equilibrium: &Equilibrium) {
        let _ = equilibrium;
    }

    /// First indices of the coordinates.
    fn offsets(&self) -> Offsets;

    /// Middle of the strip, or of a head with several, in an equilibrium, in the frame of the base, m.
    fn strip_position(&self, equilibrium: &Equilibrium) -> Vector3<f64>;

    /// Middle of strip `strip` (from 0), travelling with `base`; the second axis runs along the strip.
    fn strip(&self, base: Base, strip: usize) -> Box<dyn Marker>;

    /// Lines that draw the pantograph in the frame of the base, m.
    fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>>;

    /// Height of the base above the top of rail in the reference position, m.
    fn base_z(&self) -> f64;

    /// Force that raises the pantograph, N.
    fn uplift_force(&self) -> f64;

    /// Sets the force that raises the pantograph, N; `false` where that is not possible in motion.
    fn set_uplift_force(&mut self, force: f64) -> bool {
        let _ = force;
        false
    }

    /// Lets an input drive the pantograph: a force on a mass of a chain, or where the raising force of a linkage acts,
    /// N, or a moment on a joint of a linkage, N·m.
    ///
    /// # Errors
    /// [`VehicleError::NoDrive`] for a model without such a point, [`VehicleError::UnknownJoint`],
    /// [`VehicleError::RaisesNothing`].
    fn drive_by(&mut self, actuator: &scene::Actuator, input: usize) -> Result<(), VehicleError> {
        let _ = (actuator, input);
        Err(VehicleError::NoDrive)
    }

    /// Reads the motion of the pantograph for its controller.
    fn read(&self, motion: &Motion<'_>, reading: &mut Reading) {
        let _ = (motion, reading);
    }

    /// Contact force at rest in the reference position, N.
    fn static_force(&self) -> f64;

    /// Height of the middle of the strip in the reference position, m above the top of rail.
    fn reference_height(&self) -> f64;

    /// Number of generalised velocities.
    fn coordinates(&self) -> usize;

    /// Number of constraint equations.
    fn constraint_count(&self) -> usize {
        0
    }

    /// The mechanism with all bodies, if this is one.
    fn linkage(&self) -> Option<&Linkage> {
        None
    }
}

/// x of the strip in the reference position of a scene's pantograph, in the frame of the base, m.
///
/// # Errors
/// See [`Linkage::new`].
pub(crate) fn reference_x(entry: &Entry, gravity: f64, name: &str) -> Result<f64, VehicleError> {
    Ok(match entry {
        Entry::Linkage(entry) => {
            let linkage = Linkage::new(entry, gravity, name, &mut Layout::new())?;
            linkage.reference_strip_position().x - linkage.head().mean
        }
        Entry::Lumped(_) | Entry::Supplied(_) => 0.0,
    })
}

/// Builds the pantograph of a scene into `layout`, on a base with the given motion; `name` begins the names of the
/// coordinates.
///
/// # Errors
/// See [`VehicleError`].
pub(crate) fn build(
    entry: &Entry,
    placement: &Placement,
    base: &BaseMotion,
    name: &str,
    layout: &mut Layout,
) -> Result<Box<dyn Pantograph>, VehicleError> {
    let gravity = placement.gravity;
    let mount = base.mount();
    let travel = base.vehicle().map(|vehicle| vehicle.travel());
    match entry {
        Entry::Lumped(entry) => {
            let mut lumped = Lumped::new(&entry.at_speed(placement.speed), name, layout)?;
            lumped.mount_on(&mount, base.base_point(lumped.reference_height()));
            if let Some(travel) = travel {
                lumped.follow_curves(travel, gravity);
            }
            Ok(Box::new(lumped))
        }
        Entry::Linkage(entry) if placement.one_motion => match mount {
            BaseMount::Fixed => Ok(Box::new(ReducedLinkage::new(entry, gravity, name, layout)?)),
            _ => Err(Irreducible::BaseMoves.into()),
        },
        Entry::Linkage(entry) => {
            let mut linkage = Linkage::on(mount, entry, gravity, name, layout)?;
            if let Some(travel) = travel {
                linkage.follow_curves(travel);
            }
            Ok(Box::new(linkage))
        }
        Entry::Supplied(entry) => Err(VehicleError::Supplied { fmu: entry.fmu.clone() }),
    }
}
