//! Cable element.
use super::axial::{Axial, AxialLaw, nominal_stretch};
use super::bending::{Bending, BendingLaw};
use super::shape::{bending_matrix, tension_matrix};
use super::slopes::{Length, SlopeTangent, Slopes};
use dynamics::simd::{Number, Space};
use nalgebra::{SMatrix, Vector3};

/// The twelve coordinates as columns `r₁, r₁,ₓ, r₂, r₂,ₓ` [Thesis, Eq. (1)]; also a force on them (N, N·m, N, N·m).
pub type Coordinates = SMatrix<f64, 3, 4>;

/// Second derivatives of an energy with respect to the twelve coordinates, 12 × 12, symmetric.
pub type Tangent = SMatrix<f64, 12, 12>;

/// Stiffness of a wire and the tension its element lengths belong to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CableSection {
    /// Law of the stretch of the axis.
    pub axial: Axial,
    /// Law of bending.
    pub bending: Bending,
}

/// The tangent of a tensioned beam: constant matrices on each axis, and the change of its one tension along the
/// gradient of the mean strain.
///
/// ```text
/// K = (τ ∫ s,ₓ s,ₓᵀ dx + EI ∫ s,ₓₓ s,ₓₓᵀ dx) ⊗ I + κ g gᵀ
/// ```
#[derive(Clone, Copy, Debug)]
pub struct BeamTangent<V: Space> {
    /// `τ`, N.
    pub tension: V::Number,
    /// `g` on `r₁, r₁,ₓ, r₂, r₂,ₓ`: 1/m, –, 1/m, –.
    pub gradient: [V; 4],
    /// `κ`, N·m.
    pub rate: V::Number,
}

impl CableSection {
    /// A section with `EA` (N), `EI` (N·m²) that carries `tension` (N) where `|r,ₓ| = 1`.
    ///
    /// # Panics
    /// When the axial stiffness is not positive, or another value negative.
    #[must_use]
    pub fn new(axial_stiffness: f64, bending_stiffness: f64, tension: f64, laws: (AxialLaw, BendingLaw)) -> Self {
        assert!(axial_stiffness > 0.0, "axial stiffness {axial_stiffness} N");
        assert!(bending_stiffness >= 0.0, "bending stiffness {bending_stiffness} N·m²");
        assert!(tension >= 0.0, "tension {tension} N");
        Self {
            axial: Axial {
                law: laws.0,
                stiffness: axial_stiffness,
                stretch: nominal_stretch(laws.0, tension, axial_stiffness),
            },
            bending: Bending {
                law: laws.1,
                stiffness: bending_stiffness,
            },
        }
    }

    /// Gradient of the strain energy of an element.
    #[inline(always)]
    pub fn slope_force<V: Space>(&self, length: Length<V::Number>, slopes: &Slopes<V>) -> Slopes<V> {
        let tension = self.axial.common_tau(slopes) * length.value;
        let mut force = slopes.beam_gradient(tension, length.inverse * self.bending.common_stiffness());
        self.axial.add_point_forces(length, slopes, &mut force);
        self.bending.add_point_forces(length, slopes, &mut force);
        force
    }

    /// True for mean strain and the constant bending law.
    #[inline(always)]
    pub fn is_beam(&self) -> bool {
        (self.axial.law, self.bending.law) == (AxialLaw::Mean, BendingLaw::Constant)
    }

    /// First-order change of [`CableSection::slope_force`] by a small `change` of the slopes from `reference`: the beam
    /// under the tension of the reference, and the change of tension along the gradient there. Valid only if
    /// [`CableSection::is_beam`].
    #[inline(always)]
    pub fn slope_force_about<V: Space>(
        &self,
        length: Length<V::Number>,
        reference: &Slopes<V>,
        change: &Slopes<V>,
    ) -> Slopes<V> {
        let one = length.value.constant(1.0);
        let gradient = reference.beam_gradient(one, one.constant(0.0));
        let rate = length.value * (self.axial.stiffness * self.axial.stretch.powi(3));
        let tension = self.axial.common_tau(reference) * length.value;
        let force = change.beam_gradient(tension, length.inverse * self.bending.common_stiffness());
        force.and(&gradient.times(gradient.dot(change) * rate))
    }

    /// Variable part of the tangent of an element if [`CableSection::is_beam`], else none.
    #[inline(always)]
    pub fn beam_tangent<V: Space>(&self, length: Length<V::Number>, slopes: &Slopes<V>) -> Option<BeamTangent<V>> {
        if !self.is_beam() {
            return None;
        }
        let one = length.value.constant(1.0);
        Some(BeamTangent {
            tension: self.axial.common_tau(slopes),
            gradient: slopes.beam_gradient(one, one.constant(0.0)).on_nodes(length),
            rate: length.value * (self.axial.stiffness * self.axial.stretch.powi(3)),
        })
    }

    /// Second derivatives of the strain energy with respect to the node coordinates.
    pub fn node_tangent(&self, length: f64, slopes: &Slopes) -> Tangent {
        let Some(beam) = self.beam_tangent(Length::new(length), slopes) else {
            return to_nodes(&self.slope_tangent(length, slopes), length);
        };
        let matrix = tension_matrix(length) * beam.tension + bending_matrix(length) * self.bending.stiffness;
        let gradient = Coordinates::from_columns(&beam.gradient);
        let mut tangent = Tangent::zeros();
        for (j, mut column) in tangent.column_iter_mut().enumerate() {
            let factor = beam.rate * gradient[j];
            for i in 0..12 {
                column[i] = factor * gradient[i];
            }
            let axis = j % 3;
            for i in 0..4 {
                column[3 * i + axis] += matrix[(i, j / 3)];
            }
        }
        tangent
    }

    /// Second derivatives of the strain energy with respect to the slopes.
    fn slope_tangent(&self, length: f64, slopes: &Slopes) -> SlopeTangent {
        self.axial.tangent(length, slopes) + self.bending.tangent(length, slopes)
    }

    /// Strain energy, J.
    pub fn slope_energy(&self, length: f64, slopes: &Slopes) -> f64 {
        self.axial.energy(length, slopes) + self.bending.energy(length, slopes)
    }
}

/// A cable element: section and length at nominal tension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cable {
    /// Stiffness and laws.
    pub section: CableSection,
    /// Length `L` at nominal tension, m.
    pub length: f64,
}

impl Cable {
    fn slopes(&self, e: &Coordinates) -> Slopes {
        let column = |i: usize| Vector3::new(e[(0, i)], e[(1, i)], e[(2, i)]);
        Slopes::new([0, 1, 2, 3].map(column), Length::new(self.length))
    }

    /// Strain energy, J.
    #[must_use]
    pub fn energy(&self, e: &Coordinates) -> f64 {
        self.section.slope_energy(self.length, &self.slopes(e))
    }

    /// `∂U/∂e`, the force of the element's strain (the wire feels its negative).
    #[must_use]
    pub fn force(&self, e: &Coordinates) -> Coordinates {
        let length = Length::new(self.length);
        let force = self.section.slope_force(length, &self.slopes(e));
        Coordinates::from_columns(&force.on_nodes(length))
    }

    /// `∂²U/∂e²`.
    #[must_use]
    pub fn tangent(&self, e: &Coordinates) -> Tangent {
        self.section.node_tangent(self.length, &self.slopes(e))
    }

    /// Axial force, N, the mean over the element.
    #[must_use]
    pub fn tension(&self, e: &Coordinates) -> f64 {
        self.section.axial.tension(&self.slopes(e))
    }
}

/// Takes a tangent from the slopes to the node coordinates.
fn to_nodes(tangent: &SlopeTangent, length: f64) -> Tangent {
    let i = 1.0 / length;
    // ∂(p, a₁, a₂)/∂(r₁, r₁,ₓ, r₂, r₂,ₓ), each entry times the identity.
    let b = [[-i, 0.0, i, 0.0], [i, 1.0, -i, 0.0], [i, 0.0, -i, 1.0]];
    let mut half = SMatrix::<f64, 9, 12>::zeros();
    for (k, row) in b.iter().enumerate() {
        for (j, &factor) in row.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            let mut target = half.fixed_columns_mut::<3>(3 * j);
            target += tangent.fixed_columns::<3>(3 * k) * factor;
        }
    }
    let mut result = Tangent::zeros();
    for (k, row) in b.iter().enumerate() {
        for (j, &factor) in row.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            let mut target = result.fixed_rows_mut::<3>(3 * j);
            target += half.fixed_rows::<3>(3 * k) * factor;
        }
    }
    result
}
