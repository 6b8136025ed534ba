//! Any kind of pantograph, from its scene entry.
use crate::multibody::AppliedForce;
use crate::pantograph::{Equilibrium, Linkage, Lumped, ReducedLinkage};
use crate::{Air, Base, Travelling, VehicleError};
use dynamics::{Constraint, Force, Layout, Marker, Motion, State};
use nalgebra::Vector3;
use scene::PantographModel as Entry;

/// Where and how fast a pantograph travels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// x of its strip at t = 0, m.
    pub start_x: f64,
    /// m/s.
    pub speed: f64,
    /// Gravitational acceleration, m/s²; a lumped pantograph's static force already contains its weight.
    pub gravity: f64,
    /// Whether a linkage is reduced to its one motion (`model.reduce`).
    pub one_motion: bool,
}

/// A pantograph on its base.
#[derive(Clone, Debug)]
pub struct PantographModel {
    kind: Kind,
    placement: Placement,
    base: Base,
}

#[derive(Clone, Debug)]
enum Kind {
    Lumped(Lumped),
    Linkage(Box<Linkage>),
    Reduced(Box<ReducedLinkage>),
}

impl PantographModel {
    /// Builds the pantograph into `layout`; `name` ("pantograph 1") begins the names of its coordinates.
    ///
    /// # Errors
    /// See [`VehicleError`].
    pub fn new(entry: &Entry, placement: Placement, name: &str, layout: &mut Layout) -> Result<Self, VehicleError> {
        let kind = match entry {
            Entry::Lumped(entry) => Kind::Lumped(Lumped::new(entry, name, layout)?),
            Entry::Linkage(entry) if placement.one_motion => {
                Kind::Reduced(Box::new(ReducedLinkage::new(entry, placement.gravity, name, layout)?))
            }
            Entry::Linkage(entry) => Kind::Linkage(Box::new(Linkage::new(entry, placement.gravity, name, layout)?)),
            Entry::ThirdParty(entry) => {
                return Err(VehicleError::ThirdParty { fmu: entry.fmu.clone() });
            }
        };
        let strip_x = match &kind {
            Kind::Lumped(_) => 0.0,
            Kind::Linkage(linkage) => linkage.reference_strip_position().x,
            Kind::Reduced(linkage) => linkage.reference_strip_position().x,
        };
        let base = Base {
            start_x: placement.start_x - strip_x,
            speed: placement.speed,
        };
        Ok(Self { kind, placement, base })
    }

    /// Lets the air act on the pantograph, or nothing.
    pub fn expose_to(&mut self, air: Option<&Air>) {
        let Some(air) = air else { return };
        let base = self.base;
        match &mut self.kind {
            Kind::Lumped(lumped) => lumped.expose(air, base),
            Kind::Linkage(linkage) => linkage.expose(air, base),
            Kind::Reduced(linkage) => linkage.expose(air, base),
        }
    }

    /// Visits every force in a fixed order.
    pub fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        match &mut self.kind {
            Kind::Lumped(lumped) => lumped.forces(visit),
            Kind::Linkage(linkage) => linkage.forces(visit),
            Kind::Reduced(linkage) => {
                visit(linkage.as_mut());
                for air in linkage.air_mut() {
                    visit(air);
                }
            }
        }
    }

    /// Visits every constraint in a fixed order.
    pub fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        match &mut self.kind {
            Kind::Lumped(_) | Kind::Reduced(_) => {}
            Kind::Linkage(linkage) => linkage.constraints(visit),
        }
    }

    /// The state of rest under a contact force (N, positive in compression).
    ///
    /// # Errors
    /// Where there is none: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_force(&self, force: f64) -> Result<Equilibrium, VehicleError> {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.equilibrium_at_force(force),
            Kind::Linkage(linkage) => linkage.equilibrium_at_force(force),
            Kind::Reduced(linkage) => linkage.equilibrium_at_force(force),
        }
    }

    /// The state of rest with the strip at `height` (m above the top of rail).
    ///
    /// This is the well-posed direction: a pantograph's force hardly depends on its height.
    ///
    /// # Errors
    /// Where there is none: [`VehicleError::OutOfReach`], [`VehicleError::NotConverged`].
    pub fn equilibrium_at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.equilibrium_at_height(height),
            Kind::Linkage(linkage) => linkage.equilibrium_at_height(height),
            Kind::Reduced(linkage) => linkage.equilibrium_at_height(height),
        }
    }

    /// Writes `equilibrium` into the pantograph's part of `state`, and puts the base where the strip is at the start x at
    /// t = 0. Markers taken before this call keep the old base.
    pub fn set_initial(&mut self, equilibrium: &Equilibrium, state: &mut State) {
        let (offsets, strip_x) = match &mut self.kind {
            Kind::Lumped(lumped) => (lumped.offsets(), 0.0),
            Kind::Linkage(linkage) => (linkage.offsets(), linkage.strip_position(equilibrium).x),
            Kind::Reduced(linkage) => {
                linkage.start_at(equilibrium);
                (linkage.offsets(), linkage.strip_position(equilibrium).x)
            }
        };
        equilibrium.write(offsets, state);
        self.base.start_x = self.placement.start_x - strip_x;
        let base = self.base;
        let air = match &mut self.kind {
            Kind::Lumped(lumped) => lumped.air_mut(),
            Kind::Linkage(linkage) => linkage.air_mut(),
            Kind::Reduced(linkage) => linkage.air_mut(),
        };
        for force in air {
            force.marker.base = base;
        }
    }

    /// The middle of the strip in the world; the second axis runs along the strip.
    #[must_use]
    pub fn strip(&self) -> Box<dyn Marker> {
        match &self.kind {
            Kind::Lumped(lumped) => Box::new(Travelling {
                marker: lumped.strip(),
                base: self.base,
            }),
            Kind::Linkage(linkage) => Box::new(Travelling {
                marker: linkage.strip(),
                base: self.base,
            }),
            Kind::Reduced(linkage) => Box::new(Travelling {
                marker: linkage.strip(),
                base: self.base,
            }),
        }
    }

    /// The contact force on the strip as inputs `u[first..first + 4]`, see [`AppliedForce`].
    #[must_use]
    pub fn applied_force(&self, first: usize) -> AppliedForce {
        AppliedForce {
            marker: self.strip(),
            first,
        }
    }

    /// Lines that draw the pantograph in the world, m: the bodies of a linkage, the strip of a lumped one from the side.
    #[must_use]
    pub fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        /// Half the drawn length of a collector head along the track, m.
        const HALF_HEAD: f64 = 0.25;
        let travelled = self.base.position(motion.t);
        let mut lines = match &self.kind {
            Kind::Lumped(lumped) => {
                let middle = lumped.strip().frame(motion).position;
                vec![
                    [-HALF_HEAD, HALF_HEAD]
                        .map(|x| middle + Vector3::new(x, 0.0, 0.0))
                        .to_vec(),
                ]
            }
            Kind::Linkage(linkage) => linkage.outline(motion),
            Kind::Reduced(linkage) => linkage.outline(motion),
        };
        for point in lines.iter_mut().flatten() {
            *point += travelled;
        }
        lines
    }

    /// The mechanism in two coordinates, where it is reduced to them.
    #[must_use]
    pub fn reduced_linkage(&self) -> Option<&ReducedLinkage> {
        match &self.kind {
            Kind::Reduced(linkage) => Some(linkage),
            Kind::Lumped(_) | Kind::Linkage(_) => None,
        }
    }

    /// The base.
    #[must_use]
    pub fn base(&self) -> Base {
        self.base
    }

    /// The mechanism, where it is one with all its bodies.
    #[must_use]
    pub fn linkage(&self) -> Option<&Linkage> {
        match &self.kind {
            Kind::Lumped(_) | Kind::Reduced(_) => None,
            Kind::Linkage(linkage) => Some(linkage),
        }
    }

    /// Height of the base above the top of rail, m. A lumped chain has no extent: its base is at the reference height.
    #[must_use]
    pub fn base_z(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.reference_height(),
            Kind::Linkage(linkage) => linkage.base_z(),
            Kind::Reduced(linkage) => linkage.base_z(),
        }
    }

    /// The force that raises the pantograph, N: the static force of a lumped one, the force on the lower arm of a linkage.
    #[must_use]
    pub fn uplift_force(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.static_force(),
            Kind::Linkage(linkage) => linkage.uplift_force(),
            Kind::Reduced(linkage) => linkage.uplift_force(),
        }
    }

    /// Contact force at rest in the reference position, N.
    #[must_use]
    pub fn static_force(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.reference_force(),
            Kind::Linkage(linkage) => linkage.static_force(),
            Kind::Reduced(linkage) => linkage.static_force(),
        }
    }

    /// Height of the strip in the reference position, m above the top of rail.
    #[must_use]
    pub fn reference_height(&self) -> f64 {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.reference_height(),
            Kind::Linkage(linkage) => linkage.reference_height(),
            Kind::Reduced(linkage) => linkage.reference_height(),
        }
    }

    /// Number of generalised velocities.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        match &self.kind {
            Kind::Lumped(lumped) => lumped.coordinates(),
            Kind::Linkage(linkage) => linkage.coordinates(),
            Kind::Reduced(_) => 2,
        }
    }

    /// Number of constraint equations.
    #[must_use]
    pub fn constraint_count(&self) -> usize {
        match &self.kind {
            Kind::Lumped(_) | Kind::Reduced(_) => 0,
            Kind::Linkage(linkage) => linkage.constraint_count(),
        }
    }
}
