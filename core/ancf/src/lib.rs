//! Elements of the absolute nodal coordinate formulation: the gradient-deficient cable and the fully parameterised
//! beam.
//!
//! The cable: position and one gradient at each of two nodes, `e = (r₁, r₁,ₓ, r₂, r₂,ₓ)` [Thesis, Eq. (1)], cubic
//! Hermite polynomials between them [Thesis, Eq. (2)], a constant mass matrix [Thesis, Eq. (3)]. `x` is the arc length
//! at the nominal tension, so that `|r,ₓ| = 1` there.
//!
//! ```text
//! file       subject
//! shape      the four polynomials and their constant 4 × 4 matrices
//! slopes     variables of the strain: chord slope and deviations of the end slopes from it
//! axial      axial laws (element mean, Green–Lagrange, engineering strain)
//! bending    bending laws (|r,ₓₓ|², exact curvature)
//! cable      one element: its laws together, energy, force and tangent in the twelve coordinates
//! beam       beam element: the cable's axis, two directors per node, energy, force and tangent in the 24 coordinates
//! strain     strains of a beam beyond the stretch of its axis: shear, torsion, bending, cross-section
//! even       constant matrices of an element that are the same from either end, as batches of elements multiply them
//! ```
#![forbid(unsafe_code)]

mod axial;
mod beam;
mod bending;
mod cable;
mod even;
mod shape;
mod slopes;
mod strain;
#[cfg(test)]
mod tests;

pub use axial::{AxialLaw, FIVE_POINTS};
pub use beam::{
    Beam, BeamCoordinates, BeamInertia, BeamSection, BeamStiffness, BeamTangent, beam_mass_matrix, beam_shape,
};
pub use bending::BendingLaw;
pub use cable::{Cable, CableSection, Coordinates, Tangent};
pub use even::EvenMatrix;
pub use shape::{ShapeFunctions, bending_matrix, mass_matrix, tension_matrix};
pub use slopes::{Length, Slopes};
