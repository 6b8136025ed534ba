//! The lumped pantograph: any number of masses one above the other.
mod chain;

use super::air::{Air, AirForces, AirMarker};
use super::base_mount::{BaseDisplacement, BaseMount};
use super::equilibrium::{Equilibrium, Offsets, Target};
use super::interface::Pantograph;
use crate::{Base, Travel, Travelling, VehicleError};
pub(super) use chain::{ChainElement, ChainInertia, HeadMarker};
use chain::{ChainMasses, Foot};
use dynamics::{AerodynamicLaw, Layout, Marker, Motion, PartVisitor};
use nalgebra::{Matrix3, Vector3};

/// A vertical chain of masses, collector head first, each on a spring–damper, the last one on the base.
///
/// All springs of the chain are unstretched with the strip, without any force, at `reference_height`: EN 50318 counts
/// the grounded spring this way. The coordinates are the rises of the masses from the state of rest with the strip held
/// at that height; there the static force `S` on the last mass has shortened the springs above:
///
/// ```text
/// F₀ = S / (1 + kₙ Σ 1/kᵢ),  i < n                                         derived here: Fₙ = F₀ − S = −kₙ Σ F₀/kᵢ
/// ```
#[derive(Clone, Debug)]
pub(crate) struct Lumped {
    offsets: Offsets,
    masses: ChainMasses,
    elements: Vec<ChainElement>,
    head: HeadMarker,
    /// Contact force at rest at the reference height, N.
    reference_force: f64,
    /// Uplift of the air on the strip.
    air: AirForces,
    /// Inertia on a base in a curve; no part of statics.
    inertia: Option<ChainInertia>,
}

impl Lumped {
    /// Builds the chain into `layout`; `name` begins the names of the coordinates.
    ///
    /// # Errors
    /// [`VehicleError::NoReferenceHeight`].
    pub(crate) fn new(entry: &scene::Lumped, name: &str, layout: &mut Layout) -> Result<Self, VehicleError> {
        let reference_height = entry.reference_height.ok_or(VehicleError::NoReferenceHeight)?;
        let n = entry.masses.len();
        let offsets = Offsets {
            coordinate: layout.add_coordinates(n, format!("{name}, mass")),
            constraint: layout.constraints(),
            orientation: layout.rotations().len(),
        };
        let first = offsets.coordinate;
        let reference_force = reference_force(entry);
        let elements = (0..n)
            .map(|i| {
                let grounded = i + 1 == n;
                let (below, preload) = if grounded {
                    (None, reference_force - entry.static_force)
                } else {
                    (Some(first + i + 1), reference_force)
                };
                let mut element = ChainElement::new(first + i, below, entry.stiffnesses[i], entry.dampings[i], preload);
                element.unilateral = entry.unilateral[i];
                element.friction = entry.friction[i];
                element
            })
            .collect();
        Ok(Self {
            offsets,
            masses: ChainMasses {
                first,
                masses: entry.masses.clone(),
                static_force: entry.static_force,
            },
            elements,
            head: HeadMarker {
                coordinate: first,
                lateral: 0.0,
                reference_height,
            },
            reference_force,
            air: AirForces::default(),
            inertia: None,
        })
    }

    /// Adds the inertia forces of the curves that the base runs through; `gravity` in m/s².
    pub(crate) fn follow_curves(&mut self, travel: &Travel, gravity: f64) {
        self.inertia = travel.alignment().map(|_| ChainInertia {
            travel: travel.clone(),
            first: self.masses.first,
            masses: self.masses.masses.clone(),
            lateral: self.head.lateral,
            height: self.head.reference_height,
            gravity,
        });
    }

    /// Uplift of the air on the strip at rest at t = 0, N: this part of the contact force needs no spring.
    fn uplift(&self) -> f64 {
        let q = vec![0.0; self.offsets.coordinate + 1];
        let mut force = q.clone();
        super::air::add_at_rest(self.air.clone().as_mut_slice(), &q, &mut force);
        force[self.offsets.coordinate]
    }

    /// Puts the chain on a moving mount; `base` (m) is the base in the reference position.
    pub(crate) fn mount_on(&mut self, mount: &BaseMount, base: Vector3<f64>) {
        let lift = self.masses.static_force;
        self.head.lateral = mount.lateral();
        if let (Some(last), false) = (self.elements.last_mut(), matches!(mount, BaseMount::Fixed)) {
            last.foot = Some(Foot::new(mount.anchor(base, Matrix3::identity()), base, lift));
        }
    }

    /// The state of rest under a contact force (N).
    ///
    /// Every element carries the difference to the reference state: `s_i = (f − F₀)/k_i`.
    ///
    /// # Errors
    /// [`VehicleError::OutOfReach`] if an element that pushes only would have to pull, or an element without stiffness
    /// to bear a force.
    fn at_force(&self, force: f64) -> Result<Equilibrium, VehicleError> {
        let excess = force - self.uplift() - self.reference_force;
        let compressions = self.elements.iter().map(|element| {
            let carried = element.preload + excess;
            if excess == 0.0 {
                return Ok(0.0);
            }
            if element.stiffness == 0.0 || (element.unilateral && carried < 0.0) {
                return Err(self.out_of_reach(force));
            }
            Ok(excess / element.stiffness)
        });
        let compressions = compressions.collect::<Result<Vec<_>, _>>()?;
        Ok(self.state(force, &compressions))
    }

    /// State of rest with the strip at `height` (m); a negative force means a hanging strip.
    ///
    /// # Errors
    /// [`VehicleError::OutOfReach`] if an element that pushes only would have to pull.
    fn at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        let rise = height - self.reference_height();
        let soft = self.elements.iter().rposition(|element| element.stiffness == 0.0);
        if let Some(soft) = soft {
            // An element without stiffness gives way at no force; the others stay unchanged.
            let mut compressions = vec![0.0; self.elements.len()];
            compressions[soft] = -rise;
            return Ok(self.state(self.reference_force + self.uplift(), &compressions));
        }
        let compliance: f64 = self.elements.iter().map(|element| 1.0 / element.stiffness).sum();
        let mut equilibrium = self.at_force(self.reference_force + self.uplift() - rise / compliance)?;
        equilibrium.height = height;
        Ok(equilibrium)
    }

    fn state(&self, force: f64, compressions: &[f64]) -> Equilibrium {
        let mut q = vec![0.0; compressions.len()];
        let mut below = 0.0;
        for (q, s) in q.iter_mut().zip(compressions).rev() {
            below -= s;
            *q = below;
        }
        Equilibrium {
            height: self.reference_height() + q[0],
            force,
            q,
            rotation: Vec::new(),
            lambda: Vec::new(),
            vehicle: None,
        }
    }

    fn out_of_reach(&self, force: f64) -> VehicleError {
        VehicleError::OutOfReach {
            force,
            static_force: self.uplift_force(),
        }
    }
}

impl Pantograph for Lumped {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        visit("pantograph", &mut self.masses);
        for element in &mut self.elements {
            visit("pantograph", element);
        }
        for air in self.air.as_mut_slice() {
            visit("wind_pantograph", air);
        }
        if let Some(inertia) = &mut self.inertia {
            visit("pantograph", inertia);
        }
    }

    fn expose(&mut self, air: &Air, base: Base) {
        self.air = AirForces::default();
        if let Some(coefficient) = air.uplift {
            let law = AerodynamicLaw::Uplift { coefficient };
            self.air.push(air.force(AirMarker::Head(self.head), base, law), true);
        }
    }

    fn air(&self) -> &AirForces {
        &self.air
    }

    fn air_mut(&mut self) -> &mut AirForces {
        &mut self.air
    }

    fn equilibrium(&self, base: Option<BaseDisplacement>, target: Target) -> Result<Equilibrium, VehicleError> {
        let Some(BaseDisplacement { reference, frame }) = base else {
            return match target {
                Target::Force(force) => self.at_force(force),
                Target::Height(height) => self.at_height(height),
            };
        };
        let rise = frame.position.z - reference.z;
        let mut equilibrium = match target {
            Target::Force(force) => self.at_force(force),
            Target::Height(height) => self.at_height(height - rise),
        }?;
        equilibrium.q.iter_mut().for_each(|q| *q += rise);
        equilibrium.height += rise;
        Ok(equilibrium)
    }

    fn offsets(&self) -> Offsets {
        self.offsets
    }

    fn strip_position(&self, equilibrium: &Equilibrium) -> Vector3<f64> {
        Vector3::new(0.0, self.head.lateral, equilibrium.height)
    }

    fn strip(&self, base: Base) -> Box<dyn Marker> {
        let marker = self.head;
        Box::new(Travelling { marker, base })
    }

    /// The strip from the side.
    fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        /// Half the drawn length of a collector head along the track, m.
        const HALF_HEAD: f64 = 0.25;
        let middle = self.head.frame(motion).position;
        let ends = [-HALF_HEAD, HALF_HEAD].map(|x| middle + Vector3::new(x, 0.0, 0.0));
        vec![ends.to_vec()]
    }

    /// The reference height, because a chain has no extent.
    fn base_z(&self) -> f64 {
        self.reference_height()
    }

    /// The static force on the last mass.
    fn uplift_force(&self) -> f64 {
        self.masses.static_force
    }

    fn static_force(&self) -> f64 {
        self.reference_force
    }

    fn reference_height(&self) -> f64 {
        self.head.reference_height
    }

    fn coordinates(&self) -> usize {
        self.masses.masses.len()
    }
}

/// Reference force of [`Lumped`]; a chain with a spring of no stiffness above the grounded one presses with nothing.
fn reference_force(entry: &scene::Lumped) -> f64 {
    let (grounded, upper) = match entry.stiffnesses.split_last() {
        Some((grounded, upper)) if *grounded > 0.0 => (*grounded, upper),
        _ => return entry.static_force,
    };
    let compliance: f64 = upper.iter().map(|stiffness| 1.0 / stiffness).sum();
    entry.static_force / (1.0 + grounded * compliance)
}
