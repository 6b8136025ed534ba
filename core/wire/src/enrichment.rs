//! Unknown at a point of attachment for the bending layer that cubic elements of metres cannot follow.
use super::geometry::Location;
use ancf::{ShapeFunctions, bending_matrix, mass_matrix, tension_matrix};
use nalgebra::{Vector3, Vector4};

/// An unknown `a` (–) at a node at which a part pulls at the wire:
///
/// ```text
/// r(x) = S(x) e + a ψ(x) d,    ψ(x) = λ exp(−|x − xⱼ|/λ) − (its cubic Hermite interpolant),    λ = √(EI/T)
/// ```
///
/// `ψ` lives on the two neighbouring elements; `ψ` and its slope vanish at the nodes, so that nodal coordinates keep
/// their meaning. A tensioned beam under a point force bends within `λ` (decimetres): the exponential is that layer,
/// derived from `EI w⁗ = T w″`. In a string, `λ = 0`, the layer is a kink, `r,ₓ` jumps by `2 a d`:
///
/// ```text
/// ψ(x) = L (ξ − 2 ξ² + ξ³),    ξ = |x − xⱼ|/L        L length of the element
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enrichment {
    /// Node at the centre of the layer.
    pub node: usize,
    /// Index of `a` among the coordinates of the system, a change from `reference`.
    pub index: usize,
    /// `d`, a unit vector.
    pub direction: Vector3<f64>,
    /// `λ`, m; 0 for a kink.
    pub bending_length: f64,
    /// Reference value of `a`, –.
    pub reference: f64,
}

/// End of an element at which a layer is centred.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Start,
    Finish,
}

/// Value, first and second derivative of `ψ` at a point (m, –, 1/m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    pub psi: f64,
    pub psi_x: f64,
    pub psi_xx: f64,
}

impl Layer {
    /// `ψ` at a location within an element of `length` in m; the layer is centred at `end`. `ψ` is zero outside.
    pub fn at(location: &Location, end: End, bending_length: f64, length: f64) -> Self {
        if !(0.0..=length).contains(&location.x) {
            return Self {
                psi: 0.0,
                psi_x: 0.0,
                psi_xx: 0.0,
            };
        }
        let (distance, sign) = match end {
            End::Start => (location.x, -1.0),
            End::Finish => (length - location.x, 1.0),
        };
        let h = interpolant(end, bending_length, length);
        let shape = &location.shape;
        if bending_length == 0.0 {
            return Self {
                psi: -shape.s.dot(&h),
                psi_x: -shape.s_x.dot(&h),
                psi_xx: -shape.s_xx.dot(&h),
            };
        }
        let exponential = (-distance / bending_length).exp();
        Self {
            psi: bending_length * exponential - shape.s.dot(&h),
            psi_x: sign * exponential - shape.s_x.dot(&h),
            psi_xx: exponential / bending_length - shape.s_xx.dot(&h),
        }
    }
}

/// Value and slope at start and finish (m, –, m, –) of the exponential centred at `end`.
fn interpolant(end: End, bending_length: f64, length: f64) -> Vector4<f64> {
    let far = if bending_length == 0.0 {
        0.0
    } else {
        (-length / bending_length).exp()
    };
    match end {
        End::Start => Vector4::new(bending_length, -1.0, bending_length * far, -far),
        End::Finish => Vector4::new(bending_length * far, far, bending_length, 1.0),
    }
}

/// Integrals of products `f g`, `f,ₓ g,ₓ`, `f,ₓₓ g,ₓₓ` over an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Products<T> {
    pub mass: T,
    pub tension: T,
    pub bending: T,
}

impl<T> Products<T> {
    /// Those of `f g`, `f,ₓ g,ₓ` and `f,ₓₓ g,ₓₓ`.
    fn of([mass, tension, bending]: [T; 3]) -> Self {
        Self { mass, tension, bending }
    }
}

impl Products<f64> {
    /// `weights.mass · ∫ f g + …`.
    pub fn weighted(&self, weights: &Products<f64>) -> f64 {
        weights.mass * self.mass + weights.tension * self.tension + weights.bending * self.bending
    }
}

impl Products<Vector4<f64>> {
    /// `weights.mass · ∫ f g + …`.
    pub fn weighted(&self, weights: &Products<f64>) -> Vector4<f64> {
        self.mass * weights.mass + self.tension * weights.tension + self.bending * weights.bending
    }
}

/// Integrals of one layer on one element, with the four polynomials and with itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LayerIntegrals {
    /// Integrals with the four polynomials.
    pub shape: Products<Vector4<f64>>,
    /// Integrals of the layer with itself.
    pub own: Products<f64>,
    /// `∫ ψ dx`, m².
    pub area: f64,
}

impl LayerIntegrals {
    /// Those over an element of `length` in m, in closed form (*derived here*).
    ///
    /// With `e = λ exp(−x/λ)`, its interpolant `h·s` and `M`, `K`, `B` the matrices of the polynomials,
    ///
    /// ```text
    /// ∫ s ψ = J − M h,          J = ∫ s e = λ² Σₖ λᵏ (s⁽ᵏ⁾(0) − exp(−L/λ) s⁽ᵏ⁾(L)),    k = 0…3
    /// ∫ s,ₓ ψ,ₓ = P − K h,      P = [s e,ₓ] − J/λ²        by parts, as e,ₓₓ = e/λ²
    /// ∫ s,ₓₓ ψ,ₓₓ = Q − B h,    Q = B h                   by parts, as s⁗ = 0 and ψ = ψ,ₓ = 0 at the ends
    /// ∫ ψ² = ∫ e² − h·J − h·(J − M h), …
    /// ```
    ///
    /// A kink is the interpolant alone: `e`, `J`, `P` and `Q` are zero.
    pub fn new(end: End, bending_length: f64, length: f64) -> Self {
        let h = interpolant(End::Start, bending_length, length);
        let (l, l2, l3) = (length, length.powi(2), length.powi(3));
        let of_interpolant = [mass_matrix(l), tension_matrix(l), bending_matrix(l)].map(|matrix| matrix * h);
        let mut of_exponential = [Vector4::zeros(); 3];
        let mut squares = [0.0; 3];
        let mut area = 0.0;
        if bending_length > 0.0 {
            let (layer, layer2) = (bending_length, bending_length.powi(2));
            let far = (-length / layer).exp();
            let ends = Vector4::x() - Vector4::z() * far;
            let slopes = Vector4::y() - Vector4::w() * far;
            let curvatures = Vector4::new(-6.0 / l2, -4.0 / l, 6.0 / l2, -2.0 / l)
                - Vector4::new(6.0 / l2, 2.0 / l, -6.0 / l2, 4.0 / l) * far;
            let thirds = Vector4::new(12.0 / l3, 6.0 / l2, -12.0 / l3, 6.0 / l2) * (1.0 - far);
            let of_mass = (ends + (slopes + (curvatures + thirds * layer) * layer) * layer) * layer2;
            of_exponential = [of_mass, ends - of_mass / layer2, of_interpolant[2]];
            squares = [layer2, 1.0, 1.0 / layer2].map(|factor| 0.5 * factor * layer * (1.0 - far * far));
            area = layer2 * (1.0 - far);
        }
        let shapes: [Vector4<f64>; 3] = std::array::from_fn(|i| of_exponential[i] - of_interpolant[i]);
        let own: [f64; 3] = std::array::from_fn(|i| squares[i] - h.dot(&(of_exponential[i] + shapes[i])));
        // From the other end the functions change places, and slopes their sign.
        let seen = shapes.map(|shape| match end {
            End::Start => shape,
            End::Finish => Vector4::new(shape.z, -shape.w, shape.x, -shape.y),
        });
        Self {
            shape: Products::of(seen),
            own: Products::of(own),
            area: area - h.dot(&Vector4::new(0.5 * l, l2 / 12.0, 0.5 * l, -l2 / 12.0)),
        }
    }
}

/// Integrals of the product of the layers at both ends of one element.
pub(super) fn pair_integrals(ends: (End, End), bending_lengths: (f64, f64), length: f64) -> Products<f64> {
    let mut sum = Products::default();
    quadrature(bending_lengths.0.min(bending_lengths.1), length, |at, w| {
        let a = Layer::at(at, ends.0, bending_lengths.0, length);
        let b = Layer::at(at, ends.1, bending_lengths.1, length);
        sum.mass += a.psi * b.psi * w;
        sum.tension += a.psi_x * b.psi_x * w;
        sum.bending += a.psi_xx * b.psi_xx * w;
    });
    sum
}

/// Integrates with five Gauss points per panel: panels of half a bending length within forty bending lengths from
/// either end (beyond, the exponential is below the last digit), and one panel between, where only cubics are left.
pub(super) fn quadrature(bending_length: f64, length: f64, mut add: impl FnMut(&Location, f64)) {
    let panel = 0.5 * bending_length;
    let layer = (80.0 * panel).min(0.5 * length);
    // A kink is made of cubics alone.
    let count = if layer > 0.0 {
        (layer / panel).ceil() as usize
    } else {
        1
    };
    let width = layer / count as f64;
    let mut borders: Vec<f64> = (0..=count).map(|i| width * i as f64).collect();
    borders.extend((0..=count).rev().map(|i| length - width * i as f64));
    for border in borders.windows(2) {
        let width = border[1] - border[0];
        if width <= 0.0 {
            continue;
        }
        for (xi, weight) in ancf::FIVE_POINTS {
            let x = border[0] + xi * width;
            let location = Location {
                element: 0,
                shape: ShapeFunctions::at(x / length, length),
                x,
            };
            add(&location, weight * width);
        }
    }
}
