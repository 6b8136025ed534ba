//! Residual compliance: flexibility of a wire under a moving point force that its mesh lacks.
use ancf::{AxialLaw, BendingLaw};
use dynamics::{Blocks, Force, Motion, Weights};
use nalgebra::{DMatrix, DVector, Vector3};
use std::collections::BTreeMap;
use std::sync::Arc;
use wire::{
    Compliance, CurveColumns, Enrichment, NodeMap, Rayleigh, Wire, WireCurve, WireGeometry, WireSection,
    element_between,
};

/// Residual compliance of a wire under a transverse point force that moves along it with the speed `v`: the deflection
/// under the force that the coordinates of the mesh cannot take.
///
/// In the frame of the force the wire is a beam under the tension `T_v = T − m v²`. With `K_v = ∫ T_v N′ᵀN′ + EI N″ᵀN″`
/// of the wire alone, held at its ends, and `N` all functions of the mesh, those of bending layers included,
///
/// ```text
/// g_v(x) = G_v(x, x) − N(x) K_v⁻¹ N(x)ᵀ
/// G_v(x, x) = x (L − x) / (T_v L) − (λ_v/T_v) sinh(x/λ_v) sinh((L − x)/λ_v) / sinh(L/λ_v),    λ_v = √(EI/T_v)
/// ```
///
/// `g_v ≥ 0`, for the mesh is a subspace (Rayleigh–Ritz). `g_v` is local: elements farther away than `NEIGHBOURS`
/// change no digit that matters. A patch of the wire around each element therefore gives `g_v`, and elements with equal
/// patches share one solution: a line of any number of equal spans has the patches of one span and of both ends. Within
/// an element `g_v` is evaluated in closed form, from the inverse for the element's own coordinates.
#[derive(Clone, Debug)]
pub struct ResidualCompliance {
    /// `s` of each node, m.
    starts: Vec<f64>,
    /// Patch of each element.
    patch: Vec<u32>,
    patches: Vec<Patch>,
    known: BTreeMap<Key, u32>,
    beam: Beam,
}

/// Key of a patch: the number of its middle element, lengths in steps of `ALIKE`, and the bits of the bending length of
/// the vertical layer at each node, zero for none. The beam is the same for all.
type Key = (usize, Vec<i64>, Vec<u64>);

/// Elements in a patch on either side of the middle one. The answer of cubic elements to a force at another node falls
/// by a factor of about eight per element.
const NEIGHBOURS: usize = 10;
/// Relative difference of length below which elements count as equal: the sag of equal spans differs by rounding only.
const ALIKE: f64 = 1e-4;

/// The middle element of a patch.
#[derive(Clone, Debug)]
struct Patch {
    /// Middle element alone, with its four coordinates and those of its layers numbered from 0.
    element: WireGeometry,
    /// Rows and columns of `K_v⁻¹` for these coordinates, m/N.
    inverse: DMatrix<f64>,
    /// `x` of the element's first node from the beginning of the patch, m.
    start: f64,
    /// Length of the patch, m.
    length: f64,
    beam: Beam,
}

/// A tensioned beam in the frame of the force.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Beam {
    /// `T_v`, N.
    tension: f64,
    /// `λ_v`, m.
    bending_length: f64,
}

impl Beam {
    /// `G_v(x, x)` of a beam of `length` m that is held at its ends and free to turn there, and its derivative.
    fn under_force(&self, x: f64, length: f64) -> Compliance {
        let rest = length - x;
        let string = Compliance {
            value: x * rest / (self.tension * length),
            slope: (rest - x) / (self.tension * length),
        };
        let layer = self.bending_length;
        if layer == 0.0 {
            return string;
        }
        // sinh a sinh b / sinh (a + b) without overflow.
        let (a, b) = ((-2.0 * x / layer).exp(), (-2.0 * rest / layer).exp());
        let whole = 2.0 * (1.0 - a * b);
        Compliance {
            value: string.value - layer / self.tension * (1.0 - a) * (1.0 - b) / whole,
            slope: string.slope - 2.0 / self.tension * (a - b) / whole,
        }
    }
}

impl Patch {
    fn at(&self, x: f64) -> Compliance {
        let exact = self.beam.under_force(self.start + x, self.length);
        let mut columns = CurveColumns::default();
        self.element.columns(x, &mut columns);
        let columns = columns.as_slice();
        let (mut value, mut slope) = (exact.value, exact.slope);
        for a in columns {
            let row: f64 = (columns.iter()).map(|b| self.inverse[(a.index, b.index)] * b.n.z).sum();
            value -= a.n.z * row;
            slope -= 2.0 * a.n_s.z * row;
        }
        Compliance { value, slope }
    }
}

impl ResidualCompliance {
    /// Residual compliance for the vertical motion of a wire along `geometry`, nearly straight and level, under a force
    /// that moves with `speed` m/s. `None` for a speed not below that of the wire's waves.
    #[must_use]
    pub fn new(geometry: &WireGeometry, section: &WireSection, speed: f64) -> Option<Self> {
        let tension = section.tension - section.mass_per_length * speed * speed;
        if tension <= 0.0 {
            return None;
        }
        let beam = Beam {
            tension,
            bending_length: (section.bending_stiffness / tension).sqrt(),
        };
        let none = Self {
            starts: Vec::new(),
            patch: Vec::new(),
            patches: Vec::new(),
            known: BTreeMap::new(),
            beam,
        };
        Some(none.along(geometry))
    }

    /// Residual compliance along another section of the wire. Common patches are reused, to the last bit.
    #[must_use]
    pub fn along(&self, geometry: &WireGeometry) -> Self {
        let lengths: Vec<i64> = (geometry.lengths().iter())
            .map(|length| (length.ln() / ALIKE).round() as i64)
            .collect();
        let mut layers = vec![0.0; geometry.nodes().len()];
        for enrichment in geometry.enrichments() {
            if enrichment.direction.z.abs() > 0.5 {
                layers[enrichment.node] = enrichment.bending_length;
            }
        }
        // Other patches are dropped: memory does not grow on the way along a line.
        let (mut known, mut patches) = (BTreeMap::new(), Vec::new());
        let patch = (0..lengths.len()).map(|element| {
            let first = element.saturating_sub(NEIGHBOURS);
            let last = (element + NEIGHBOURS).min(lengths.len() - 1);
            let bits = layers[first..=last + 1].iter().map(|layer| layer.to_bits());
            let key: Key = (element - first, lengths[first..=last].to_vec(), bits.collect());
            *known.entry(key).or_insert_with_key(|key| {
                patches.push(match self.known.get(key) {
                    Some(&at) => self.patches[at as usize].clone(),
                    None => solved_for(key, self.beam),
                });
                patches.len() as u32 - 1
            })
        });
        Self {
            patch: patch.collect(),
            starts: (0..geometry.nodes().len()).map(|node| geometry.node_s(node)).collect(),
            patches,
            known,
            beam: self.beam,
        }
    }

    /// The residual compliance at `s` m.
    #[must_use]
    pub fn at(&self, s: f64) -> Compliance {
        let element = element_between(&self.starts, s);
        let (start, end) = (self.starts[element], self.starts[element + 1]);
        let patch = &self.patches[self.patch[element] as usize];
        let scale = patch.element.length() / (end - start);
        let found = patch.at(((s - start) * scale).clamp(0.0, patch.element.length()));
        Compliance {
            value: found.value.max(0.0),
            slope: found.slope * scale,
        }
    }

    /// Number of different patches, with which memory grows.
    #[must_use]
    pub fn patches(&self) -> usize {
        self.patches.len()
    }
}

/// A straight wire that moves vertically only, coordinates node after node and then those of its layers; a bending
/// length of zero is no layer.
fn straight(lengths: &[f64], layers: &[f64]) -> WireGeometry {
    let nodes = lengths.len() + 1;
    let map = |node| NodeMap::new([None, None, Some(2 * node), None, None, Some(2 * node + 1)]);
    let here = layers.iter().enumerate().filter(|(_, length)| **length > 0.0);
    let enrichments = here.enumerate().map(|(i, (node, &bending_length))| Enrichment {
        node,
        index: 2 * nodes + i,
        direction: Vector3::z(),
        bending_length,
        reference: 0.0,
    });
    WireGeometry::straight(Vector3::zeros(), Vector3::x(), lengths, map).with_enrichments(enrichments.collect())
}

fn solved_for((middle, lengths, layers): &Key, beam: Beam) -> Patch {
    let lengths: Vec<f64> = lengths.iter().map(|length| (*length as f64 * ALIKE).exp()).collect();
    let layers: Vec<f64> = layers.iter().map(|bits| f64::from_bits(*bits)).collect();
    solved(*middle, &lengths, &layers, beam)
}

/// Solves a patch for its element `middle`.
fn solved(middle: usize, lengths: &[f64], layers: &[f64], beam: Beam) -> Patch {
    let geometry = straight(lengths, layers);
    let size = 2 * geometry.nodes().len() + geometry.enrichments().len();
    let mut stiffness = transverse_stiffness(&geometry, beam, size);
    for end in [0, 2 * lengths.len()] {
        stiffness.row_mut(end).fill(0.0);
        stiffness.column_mut(end).fill(0.0);
        stiffness[(end, end)] = 1.0;
    }
    let element = straight(&lengths[middle..=middle], &layers[middle..=middle + 1]);
    // Positions of the coordinates of the element in the patch.
    let mut places: Vec<usize> = (2 * middle..2 * middle + 4).collect();
    let own = |node: usize| geometry.enrichments().iter().filter(move |layer| layer.node == node);
    places.extend(own(middle).chain(own(middle + 1)).map(|layer| layer.index));
    let factor = stiffness.cholesky().expect("the stiffness of a held wire is positive");
    let mut inverse = DMatrix::zeros(places.len(), places.len());
    for (column, &place) in places.iter().enumerate() {
        let mut unit = DVector::zeros(size);
        if ![0, 2 * lengths.len()].contains(&place) {
            unit[place] = 1.0;
        }
        factor.solve_mut(&mut unit);
        for (row, &place) in places.iter().enumerate() {
            inverse[(row, column)] = unit[place];
        }
    }
    Patch {
        element,
        inverse,
        start: lengths[..middle].iter().sum(),
        length: lengths.iter().sum(),
        beam,
    }
}

/// `∫ T_v N′ᵀN′ + EI N″ᵀN″`, assembled as a Rayleigh damping of `β` = 1 s.
fn transverse_stiffness(geometry: &WireGeometry, beam: Beam, size: usize) -> DMatrix<f64> {
    let section = WireSection {
        axial_stiffness: 1e3 * beam.tension,
        bending_stiffness: beam.tension * beam.bending_length * beam.bending_length,
        mass_per_length: 1.0,
        tension: beam.tension,
    };
    let damping = Rayleigh { alpha: 0.0, beta: 1.0 };
    let laws = (AxialLaw::Mean, BendingLaw::Constant);
    let mut wire = Wire::new(section, damping, laws, 0.0, Arc::new(geometry.clone()));
    let rest = vec![0.0; size];
    let motion = Motion {
        t: 0.0,
        q: &rest,
        v: &rest,
        rotation: &[],
        u: &[],
    };
    let weights = Weights { q: 0.0, v: 1.0 };
    let mut matrix = DMatrix::zeros(size, size);
    for (row, column, value) in Blocks::collect(|blocks| wire.add_tangent(&motion, weights, blocks)) {
        matrix[(row as usize, column as usize)] += value;
    }
    matrix
}

#[cfg(test)]
mod tests;
