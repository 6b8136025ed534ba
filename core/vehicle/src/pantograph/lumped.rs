//! The lumped pantograph: any number of masses one above the other.
mod chain;
mod head;
mod marker;

use super::air::{Air, AirForces, AirMarker};
use super::base_mount::{BaseDisplacement, BaseMount};
use super::equilibrium::{Equilibrium, Offsets, Target};
use super::interface::Pantograph;
use crate::{Base, Travel, Travelling, VehicleError};
use chain::ChainMasses;
pub(super) use chain::{ChainDrive, ChainElement, ChainInertia, Foot};
use control::Reading;
use dynamics::{AerodynamicLaw, Layout, Marker, Motion, PartVisitor};
use head::{Head, HeadAtRest};
pub(super) use marker::HeadMarker;
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
///
/// Springs under strips of their own are one more spring of the chain in this sum, of the stiffness of all together.
#[derive(Clone, Debug)]
pub(crate) struct Lumped {
    offsets: Offsets,
    masses: ChainMasses,
    elements: Vec<ChainElement>,
    head: Head,
    /// Contact force at rest at the reference height, N.
    reference_force: f64,
    drive: Option<ChainDrive>,
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
        let middle = HeadMarker {
            coordinate: first,
            x: 0.0,
            pitch: None,
            lateral: 0.0,
            reference_height,
        };
        let head = Head::new(entry, middle, reference_force, name, layout);
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
            head,
            reference_force,
            drive: None,
            air: AirForces::default(),
            inertia: None,
        })
    }

    /// Adds the inertia forces of the curves that the base runs through; `gravity` in m/s².
    pub(crate) fn follow_curves(&mut self, travel: &Travel, gravity: f64) {
        self.inertia = travel.alignment().map(|_| ChainInertia {
            travel: travel.clone(),
            first: self.masses.first,
            masses: [&self.masses.masses[..], self.head.sprung_masses()].concat(),
            lateral: self.head.middle.lateral,
            height: self.head.middle.reference_height,
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
        self.head.set_lateral(mount.lateral());
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
        let mut equilibrium = self.chain_at_force(force)?;
        self.put_level_head(&mut equilibrium);
        Ok(equilibrium)
    }

    /// State of rest of the chain without what its head carries.
    fn chain_at_force(&self, force: f64) -> Result<Equilibrium, VehicleError> {
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

    /// Adds a level head to an equilibrium of the chain alone.
    fn put_level_head(&self, equilibrium: &mut Equilibrium) {
        let (rise, excess) = (equilibrium.q[0], equilibrium.force - self.reference_force);
        let q = self.head.level(rise, excess);
        let at_rest = HeadAtRest { rise, q };
        equilibrium.strip_forces = self.head.strip_forces(&at_rest, equilibrium.force);
        if !self.head.sprung_masses().is_empty() {
            equilibrium.height = self.reference_height() + at_rest.q[0];
        }
        equilibrium.q.extend(at_rest.q);
    }

    /// State of rest with the strips at these heights, m, as far as the head allows them.
    ///
    /// # Errors
    /// [`VehicleError::OutOfReach`] if an element that pushes only would have to pull.
    fn at_heights(&self, heights: &[f64]) -> Result<Equilibrium, VehicleError> {
        let rises: Vec<f64> = heights.iter().map(|height| height - self.reference_height()).collect();
        let soft = self.elements.iter().any(|element| element.stiffness == 0.0);
        let compliance = (!soft).then(|| self.elements.iter().map(|element| 1.0 / element.stiffness).sum());
        let at_rest = self.head.at_rises(&rises, compliance, self.uplift());
        let mut equilibrium = self.chain_at_height(self.reference_height() + at_rest.rise)?;
        equilibrium.strip_forces = self.head.strip_forces(&at_rest, equilibrium.force);
        equilibrium.force = equilibrium.strip_forces.iter().sum();
        equilibrium.height = heights.iter().sum::<f64>() / heights.len() as f64;
        equilibrium.q.extend(at_rest.q);
        Ok(equilibrium)
    }

    /// State of rest with the strip at `height` (m); a negative force means a hanging strip.
    ///
    /// # Errors
    /// [`VehicleError::OutOfReach`] if an element that pushes only would have to pull.
    fn at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        let strips = self.head.strips().len();
        if strips > 1 || !self.head.sprung_masses().is_empty() {
            return self.at_heights(&vec![height; strips]);
        }
        let mut equilibrium = self.chain_at_height(height)?;
        equilibrium.strip_forces = vec![equilibrium.force];
        Ok(equilibrium)
    }

    /// State of rest of the chain without what its head carries, with the first mass at `height` (m).
    fn chain_at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        let rise = height - self.reference_height();
        let soft = self.elements.iter().rposition(|element| element.stiffness == 0.0);
        if let Some(soft) = soft {
            // An element without stiffness gives way at no force; the others stay unchanged.
            let mut compressions = vec![0.0; self.elements.len()];
            compressions[soft] = -rise;
            return Ok(self.state(self.reference_force + self.uplift(), &compressions));
        }
        let compliance: f64 = self.elements.iter().map(|element| 1.0 / element.stiffness).sum();
        let mut equilibrium = self.chain_at_force(self.reference_force + self.uplift() - rise / compliance)?;
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
            strip_forces: Vec::new(),
            strip_heights: Vec::new(),
            rotation: Vec::new(),
            lambda: Vec::new(),
            vehicle: None,
        }
    }

    /// The same with the base risen by `rise` m.
    fn lifted(&self, mut equilibrium: Equilibrium, rise: f64) -> Equilibrium {
        let (chain, head) = equilibrium.q.split_at_mut(self.masses.masses.len());
        chain.iter_mut().for_each(|q| *q += rise);
        self.head.lift(head, rise);
        equilibrium.height += rise;
        equilibrium
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
        self.head.forces(&mut |force| visit("pantograph", force));
        if let Some(drive) = &mut self.drive {
            visit("pantograph", drive);
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
            self.air
                .push(air.force(AirMarker::Head(self.head.middle), base, law), true);
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
        let equilibrium = match target {
            Target::Force(force) => self.at_force(force),
            Target::Height(height) => self.at_height(height - rise),
        }?;
        Ok(self.lifted(equilibrium, rise))
    }

    fn strips(&self) -> usize {
        self.head.strips().len()
    }

    fn rises(&self) -> Vec<Vec<f64>> {
        self.head.rises()
    }

    fn equilibrium_under(&self, base: Option<BaseDisplacement>, heights: &[f64]) -> Result<Equilibrium, VehicleError> {
        if let [height] = *heights {
            return self.equilibrium(base, Target::Height(height));
        }
        let rise = base.map_or(0.0, |base| base.frame.position.z - base.reference.z);
        let heights: Vec<f64> = heights.iter().map(|height| height - rise).collect();
        Ok(self.lifted(self.at_heights(&heights)?, rise))
    }

    fn offsets(&self) -> Offsets {
        self.offsets
    }

    fn strip_position(&self, equilibrium: &Equilibrium) -> Vector3<f64> {
        Vector3::new(0.0, self.head.middle.lateral, equilibrium.height)
    }

    fn strip(&self, base: Base, strip: usize) -> Box<dyn Marker> {
        let marker = self.head.strips()[strip];
        Box::new(Travelling { marker, base })
    }

    /// The head from the side, then each strip of several.
    fn outline(&self, motion: &Motion<'_>) -> Vec<Vec<Vector3<f64>>> {
        /// Half the drawn length of a collector head along the track, m.
        const HALF_HEAD: f64 = 0.25;
        /// Half the drawn length of a strip among several, m.
        const HALF_STRIP: f64 = 0.03;
        let line = |middle: Vector3<f64>, half: f64| {
            let ends = [-half, half].map(|x| middle + Vector3::new(x, 0.0, 0.0));
            ends.to_vec()
        };
        let strips = self.head.strips();
        let middle = self.head.middle.frame(motion).position;
        let furthest = strips.iter().map(|strip| strip.x.abs()).fold(HALF_HEAD, f64::max);
        let mut lines = vec![line(middle, furthest)];
        if strips.len() > 1 {
            lines.extend(
                strips
                    .iter()
                    .map(|strip| line(strip.frame(motion).position, HALF_STRIP)),
            );
        }
        lines
    }

    /// The reference height, because a chain has no extent.
    fn base_z(&self) -> f64 {
        self.reference_height()
    }

    /// The static force on the last mass.
    fn uplift_force(&self) -> f64 {
        self.masses.static_force
    }

    fn set_uplift_force(&mut self, force: f64) -> bool {
        self.masses.static_force = force;
        for foot in self.elements.iter_mut().filter_map(|element| element.foot.as_mut()) {
            foot.lift = force;
        }
        true
    }

    fn drive_by(&mut self, actuator: &scene::Actuator, input: usize) -> Result<(), VehicleError> {
        let masses = &self.masses;
        let last = masses.masses.len() - 1;
        self.drive = Some(ChainDrive {
            coordinate: masses.first + actuator.mass.map_or(last, |mass| mass - 1),
            input,
            foot: self.elements.last().and_then(|element| element.foot.clone()),
        });
        Ok(())
    }

    fn read(&self, motion: &Motion<'_>, reading: &mut Reading) {
        let masses = self.masses.first..self.masses.first + self.masses.masses.len();
        reading.rises.clear();
        reading.rises.extend_from_slice(&motion.q[masses.clone()]);
        reading.velocities.clear();
        reading.velocities.extend_from_slice(&motion.v[masses]);
        let drive = self.drive.as_ref();
        reading.driven = drive.map_or(0.0, |drive| motion.v[drive.coordinate]);
        reading.driven_place = drive.map_or(0.0, |drive| motion.q[drive.coordinate]);
    }

    fn static_force(&self) -> f64 {
        self.reference_force
    }

    fn reference_height(&self) -> f64 {
        self.head.middle.reference_height
    }

    fn coordinates(&self) -> usize {
        self.masses.masses.len() + self.head.coordinates()
    }
}

/// Reference force of [`Lumped`]; a chain with a spring of no stiffness above the grounded one presses with nothing.
fn reference_force(entry: &scene::Lumped) -> f64 {
    let (grounded, upper) = match entry.stiffnesses.split_last() {
        Some((grounded, upper)) if *grounded > 0.0 => (*grounded, upper),
        _ => return entry.static_force,
    };
    let mut compliance: f64 = upper.iter().map(|stiffness| 1.0 / stiffness).sum();
    if let Some(strips) = entry.strip_stiffness() {
        compliance += 1.0 / strips;
    }
    entry.static_force / (1.0 + grounded * compliance)
}
