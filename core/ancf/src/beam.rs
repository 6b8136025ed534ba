//! The fully parameterised beam element: position and three gradients at each of two nodes.
use super::cable::{CableSection, Coordinates};
use super::shape::{ShapeFunctions, mass_matrix};
use super::slopes::{Length, Slopes};
use super::strain::{STRAINS, Strain, strains};
use super::{AxialLaw, BendingLaw};
use nalgebra::{Matrix2, SMatrix, SVector, Vector3};

/// The 24 coordinates as columns `r₁, r₁,ₓ, r₁,ᵧ, r₁,𝓏, r₂, r₂,ₓ, r₂,ᵧ, r₂,𝓏` [Yakoub & Shabana 2001]; also a force on
/// them (N for positions, N·m for gradients).
pub type BeamCoordinates = SMatrix<f64, 3, 8>;

/// Second derivatives of an energy with respect to the 24 coordinates, symmetric.
pub type BeamTangent = SMatrix<f64, 24, 24>;

/// Columns of [`BeamCoordinates`] that the axis depends on, in the order of the cable's coordinates.
const AXIS: [usize; 4] = [0, 1, 4, 5];

/// Stiffness of the cross-section of a beam. `y` and `z` are its principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamStiffness {
    /// `EA`, N.
    pub axial: f64,
    /// `k G A` along y and z, N; shear correction factors included.
    pub shear: [f64; 2],
    /// `G J`, N·m².
    pub torsion: f64,
    /// `E ∫ z² dA` and `E ∫ y² dA`: bending about y and about z, N·m².
    pub bending: [f64; 2],
    /// Stiffness against stretching of the cross-section along y and along z, and against shear between them, N. `EA,
    /// EA, GA` is the material's own without Poisson's ratio.
    pub section: [f64; 3],
}

/// Inertia of the cross-section of a beam, about its principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamInertia {
    /// `ρA`, kg/m.
    pub mass: f64,
    /// `ρ ∫ y² dA` and `ρ ∫ z² dA`, kg·m: inertia of the gradients along y and along z.
    pub section: [f64; 2],
}

/// The weights of the coordinates in the position of a point.
///
/// ```text
/// r(x, y, z) = Σ sᵢ(x) (axis)ᵢ + y Σ nₖ(x) r_k,ᵧ + z Σ nₖ(x) r_k,𝓏       [Yakoub & Shabana 2001]
/// ```
///
/// with the cable's cubic polynomials `s` and `n = 1 − x/L, x/L`; `xi = x/L`, `offset` is `[y, z]` in m, `length` in m.
#[must_use]
pub fn beam_shape(xi: f64, offset: [f64; 2], length: f64) -> SVector<f64, 8> {
    let s = ShapeFunctions::at(xi, length).s;
    let [y, z] = offset;
    let (a, b) = (1.0 - xi, xi);
    SVector::from([s[0], s[1], a * y, a * z, s[2], s[3], b * y, b * z])
}

/// `∫ s sᵀ dm` over an element of `length` in m: the constant mass matrix, the same for each axis (kg, kg·m, kg·m²).
#[must_use]
pub fn beam_mass_matrix(inertia: &BeamInertia, length: f64) -> SMatrix<f64, 8, 8> {
    let mut matrix = SMatrix::zeros();
    let axis = mass_matrix(length) * inertia.mass;
    for (i, &row) in AXIS.iter().enumerate() {
        for (j, &column) in AXIS.iter().enumerate() {
            matrix[(row, column)] = axis[(i, j)];
        }
    }
    let linear = Matrix2::new(2.0, 1.0, 1.0, 2.0) * (length / 6.0);
    for (gradient, inertia) in inertia.section.iter().enumerate() {
        for i in 0..2 {
            for j in 0..2 {
                matrix[(2 + 4 * i + gradient, 2 + 4 * j + gradient)] = inertia * linear[(i, j)];
            }
        }
    }
    matrix
}

/// Generalised strains of a beam element beyond the stretch of its axis: shear, torsion, bending and those of the
/// cross-section, each with its stiffness.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamSection {
    strains: [Strain; STRAINS],
}

impl BeamSection {
    /// Section of an element of `length` in m.
    ///
    /// # Panics
    /// When the length is not positive.
    #[must_use]
    pub fn new(stiffness: &BeamStiffness, length: f64) -> Self {
        assert!(length > 0.0, "element length {length} m");
        Self {
            strains: strains(stiffness, length),
        }
    }

    /// Strain energy, J.
    #[must_use]
    pub fn energy(&self, e: &BeamCoordinates) -> f64 {
        self.strains.iter().map(|strain| strain.energy(e)).sum()
    }

    /// `∂U/∂e`.
    #[must_use]
    pub fn force(&self, e: &BeamCoordinates) -> BeamCoordinates {
        let mut force = BeamCoordinates::zeros();
        for strain in &self.strains {
            force += strain.at(e).force();
        }
        force
    }

    /// `∂²U/∂e²`.
    #[must_use]
    pub fn tangent(&self, e: &BeamCoordinates) -> BeamTangent {
        let mut tangent = BeamTangent::zeros();
        let mut weights = SMatrix::<f64, 8, 8>::zeros();
        for strain in &self.strains {
            strain.at(e).add_tangent(&mut tangent, &mut weights);
        }
        for i in 0..8 {
            for j in 0..8 {
                for axis in 0..3 {
                    tangent[(3 * i + axis, 3 * j + axis)] += weights[(i, j)];
                }
            }
        }
        tangent
    }
}

/// A fully parameterised beam element.
///
/// Forces are those of structural mechanics [Gerstmayr, Matikainen & Mikkola 2008; Nachbagauer, Gruber & Gerstmayr
/// 2013]: the axis stretches as the cable's, and the generalised strains of shear, torsion and bending and those of the
/// cross-section each have their stiffness. `x` is the arc length at nominal tension, as in the cable.
///
/// The volume integral of continuum mechanics is not used: in this element it locks (Poisson's ratio against the linear
/// transverse field, shear against the cubic axis, thickness against turning directors), and its torsional stiffness is
/// that of the polar moment of area [Nachbagauer, Gruber & Gerstmayr 2013; Bauchau et al. 2015]. For the measures
/// against locking see the strains.
#[derive(Clone, Debug, PartialEq)]
pub struct Beam {
    axis: CableSection,
    length: f64,
    section: BeamSection,
}

impl Beam {
    /// An element of `length` (m) at the nominal `tension` (N), where `|r,ₓ| = 1`.
    ///
    /// # Panics
    /// When the length or a stiffness is not positive, or the tension negative.
    #[must_use]
    pub fn new(stiffness: &BeamStiffness, (law, tension): (AxialLaw, f64), length: f64) -> Self {
        Self {
            axis: CableSection::new(stiffness.axial, 0.0, tension, (law, BendingLaw::Constant)),
            length,
            section: BeamSection::new(stiffness, length),
        }
    }

    /// Strain energy, J.
    #[must_use]
    pub fn energy(&self, e: &BeamCoordinates) -> f64 {
        self.axis.slope_energy(self.length, &self.slopes(e)) + self.section.energy(e)
    }

    /// `∂U/∂e`, the force of the element's strain (the beam feels its negative).
    #[must_use]
    pub fn force(&self, e: &BeamCoordinates) -> BeamCoordinates {
        let mut force = self.section.force(e);
        let length = Length::new(self.length);
        let axis = self.axis.slope_force(length, &self.slopes(e)).on_nodes(length);
        for (axis, column) in axis.iter().zip(AXIS) {
            let mut target = force.column_mut(column);
            target += axis;
        }
        force
    }

    /// `∂²U/∂e²`.
    #[must_use]
    pub fn tangent(&self, e: &BeamCoordinates) -> BeamTangent {
        let mut tangent = self.section.tangent(e);
        let axis = self.axis.node_tangent(self.length, &self.slopes(e));
        for (i, &row) in AXIS.iter().enumerate() {
            for (j, &column) in AXIS.iter().enumerate() {
                let mut target = tangent.fixed_view_mut::<3, 3>(3 * row, 3 * column);
                target += axis.fixed_view::<3, 3>(3 * i, 3 * j);
            }
        }
        tangent
    }

    /// Axial force, N, the mean over the element.
    #[must_use]
    pub fn tension(&self, e: &BeamCoordinates) -> f64 {
        self.axis.axial.tension(&self.slopes(e))
    }

    /// The coordinates of the axis, those of a cable.
    #[must_use]
    pub fn axis(e: &BeamCoordinates) -> Coordinates {
        Coordinates::from_columns(&AXIS.map(|column| Vector3::from(e.column(column))))
    }

    fn slopes(&self, e: &BeamCoordinates) -> Slopes {
        Slopes::new(
            AXIS.map(|column| Vector3::from(e.column(column))),
            Length::new(self.length),
        )
    }
}
