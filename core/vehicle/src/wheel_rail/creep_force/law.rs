//! The creep laws behind one method.
use super::dual::{Dual, INPUTS, Number};
use super::{Fastsim, polach, saturated};
use crate::wheel_rail::{Creepage, KalkerCoefficients};

/// Law from creepages to tangential forces.
///
/// The thesis names no creep law (section 4.1 ends with the contact points), so there is no default here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CreepLaw {
    /// No tangential force.
    Frictionless,
    /// Kalker's linear theory with the saturation of Shen, Hedrick & Elkins.
    Saturated,
    /// Kalker's simplified theory.
    Fastsim(Fastsim),
    /// Polach's closed form.
    Polach,
}

/// Contact ellipse with load, as seen by a creep law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Semi-axis along the rolling direction, m.
    pub along: f64,
    /// Semi-axis across it, m.
    pub across: f64,
    /// N.
    pub normal_force: f64,
}

/// Derivatives of the longitudinal force, the lateral force and the moment about the normal by ξ_x (–), ξ_y (–),
/// φ (1/m), a (m), b (m) and the normal force (N).
pub type CreepSlopes = [[f64; INPUTS]; 3];

/// Arguments of the laws.
pub(super) struct Inputs<N> {
    /// ξ_x, ξ_y, φ.
    pub creepage: [N; 3],
    pub along: N,
    pub across: N,
    /// μN.
    pub limit: N,
    /// C11, C22, C23.
    pub coefficients: [N; 3],
    pub shear_modulus: f64,
}

/// A creep law with its constants.
#[derive(Clone, Debug)]
pub struct CreepModel {
    /// The law.
    pub law: CreepLaw,
    /// Friction coefficient μ, –.
    pub friction: f64,
    /// Shear modulus G, Pa.
    pub shear_modulus: f64,
    /// Coefficients for the material's Poisson's ratio.
    pub coefficients: KalkerCoefficients,
}

impl CreepModel {
    /// Force of the rail on the wheel, in the directions of the creepages: longitudinal force (N), lateral force (N),
    /// moment about the normal (N·m).
    #[must_use]
    pub fn force(&self, creepage: &Creepage, patch: &Patch) -> [f64; 3] {
        self.forces(creepage, patch)
    }

    /// Derivatives of [`CreepModel::force`].
    #[must_use]
    pub fn slopes(&self, creepage: &Creepage, patch: &Patch) -> CreepSlopes {
        self.forces(creepage, patch).map(|force: Dual| force.slopes)
    }

    pub(super) fn forces<N: Number>(&self, creepage: &Creepage, patch: &Patch) -> [N; 3] {
        let none = [N::constant(0.0); 3];
        if self.law == CreepLaw::Frictionless || !(patch.normal_force > 0.0 && self.friction > 0.0) {
            return none;
        }
        let (along, across) = (N::input(patch.along, 3), N::input(patch.across, 4));
        let logarithm =
            along.map(patch.along.ln(), 1.0 / patch.along) - across.map(patch.across.ln(), 1.0 / patch.across);
        let inputs = Inputs {
            creepage: [
                N::input(creepage.longitudinal, 0),
                N::input(creepage.lateral, 1),
                N::input(creepage.spin, 2),
            ],
            along,
            across,
            limit: N::input(patch.normal_force, 5) * self.friction,
            coefficients: (self.coefficients.at(patch.along, patch.across))
                .map(|[value, slope]| logarithm.map(value, slope)),
            shear_modulus: self.shear_modulus,
        };
        match self.law {
            CreepLaw::Frictionless => none,
            CreepLaw::Saturated => saturated::forces(&inputs),
            CreepLaw::Fastsim(grid) => grid.forces(&inputs),
            CreepLaw::Polach => polach::forces(&inputs),
        }
    }
}
