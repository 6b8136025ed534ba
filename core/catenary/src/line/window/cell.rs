//! A span far from the strips, reduced to its supports, to the elongations of its droppers and to its lowest modes.
use super::elongations::Elongations;
use super::end_layers::EndLayers;
use super::modes::Kept;
use super::part::Part;
use super::places::SpanPlaces;
use dynamics::SparseMatrix;
use nalgebra::DVector;
use std::ops::Range;

/// Stiffness, damping and mass of one span between its supports, linear about the static state.
pub(super) struct SpanMatrices {
    /// Positions of the coordinates of the span.
    pub places: SpanPlaces,
    pub stiffness: SparseMatrix,
    pub damping: SparseMatrix,
    pub mass: SparseMatrix,
    /// Elongations of droppers, which belong to the interface beside the supports.
    pub elongations: Elongations,
    /// Bending layers at the supports, which follow the rest of the span.
    pub layers: EndLayers,
    /// Coordinates that are held, of wires that end in the span.
    pub held: Vec<usize>,
    /// Axis of each coordinate: 0 along the track, 1 across, 2 up; none for a bending layer.
    pub axes: Vec<Option<usize>>,
}

/// A reduced span: of each tension length there, which nothing couples to the others, a [`Part`].
#[derive(Debug)]
pub(super) struct Cell {
    /// All coordinates of the span.
    size: usize,
    elongations: Elongations,
    layers: EndLayers,
    places: SpanPlaces,
    /// Interface among the coordinates of the span: the supports, left one first, and the elongations of droppers with
    /// dampers.
    interface: Vec<usize>,
    pub parts: Vec<Part>,
}

/// Motion between the supports of a span.
pub(super) struct Between {
    /// Bending layers of the left and of the right support.
    pub end_layers: Vec<Vec<f64>>,
    pub inner: Vec<f64>,
}

impl Cell {
    /// Reduces a span of `beside` tension lengths to modes, as many of each. `None` where its inner stiffness is not
    /// positive definite.
    pub fn new(span: SpanMatrices, beside: usize, kept: Kept) -> Option<Self> {
        let size = span.stiffness.size();
        let supports = span.places.supports.concat();
        let interface: Vec<usize> = supports.into_iter().chain(span.elongations.places()).collect();
        let mut is_free = vec![false; size];
        is_free[span.places.inner[0].clone()].fill(true);
        for &index in interface.iter().chain(&span.held) {
            is_free[index] = false;
        }
        let matrices = [&span.stiffness, &span.damping, &span.mass].map(|matrix| span.elongations.transform(matrix));
        let mut apart = uncoupled(&matrices, |index| is_free[index] || interface.contains(&index));
        apart.retain(|coordinates| coordinates.iter().any(|&index| is_free[index]));
        // Another number than that of tension lengths has another cause: one part is right whatever it is.
        let (apart, kept) = if apart.len() == beside {
            (apart, kept)
        } else {
            (vec![(0..size).collect()], kept.times(beside))
        };
        let parts = apart.iter().map(|coordinates| {
            let rows = (0..interface.len()).filter(|&row| coordinates.contains(&interface[row]));
            let inner = coordinates.iter().copied().filter(|&index| is_free[index]);
            Part::new(
                &matrices,
                &interface,
                (rows.collect(), inner.collect()),
                &span.axes,
                kept,
            )
        });
        Some(Self {
            parts: parts.collect::<Option<_>>()?,
            size,
            elongations: span.elongations,
            layers: span.layers,
            places: span.places,
            interface,
        })
    }

    /// Divides the modes of the span among its parts.
    pub fn by_part(&self, modes: Range<usize>) -> impl Iterator<Item = Range<usize>> + use<> {
        let each = modes.len() / self.parts.len();
        (0..self.parts.len()).map(move |part| modes.start + part * each..modes.start + (part + 1) * each)
    }

    /// Motion between the supports from that of the interface and of the first modes.
    pub fn expand(&self, interface: &[f64], modes: &[f64]) -> Between {
        let mut values = vec![0.0; self.size];
        for (&index, &value) in self.interface.iter().zip(interface) {
            values[index] = value;
        }
        for (part, modes_of) in self.parts.iter().zip(self.by_part(0..modes.len())) {
            part.expand(interface, &modes[modes_of], &mut values);
        }
        self.elongations.displace(&mut values);
        self.layers.follow(&mut values);
        let at = |places: &Vec<usize>| places.iter().map(|&index| values[index]).collect();
        Between {
            end_layers: self.places.layers.iter().map(at).collect(),
            inner: values[self.places.inner[0].clone()].to_vec(),
        }
    }

    /// Elongations, and for each part the modes' share by mass, of a motion at and between the supports.
    pub fn project(&self, supports: &[f64], inner: &[f64]) -> (Vec<f64>, Vec<DVector<f64>>) {
        let mut values = vec![0.0; self.size];
        values[self.places.inner[0].clone()].copy_from_slice(inner);
        self.elongations.measure(&mut values);
        for (&index, value) in self.interface.iter().zip(supports) {
            values[index] = *value;
        }
        let interface: Vec<f64> = self.interface.iter().map(|&index| values[index]).collect();
        let shares = self.parts.iter().map(|part| part.project(&interface, &values));
        (interface[supports.len()..].to_vec(), shares.collect())
    }
}

/// Sets of coordinates, each ascending, that no entry of a matrix couples to one another, of those that `counts`.
fn uncoupled(matrices: &[SparseMatrix; 3], counts: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
    let size = matrices[0].size();
    let mut found: Vec<Vec<usize>> = Vec::new();
    let mut seen: Vec<bool> = (0..size).map(|index| !counts(index)).collect();
    for first in 0..size {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut set = vec![first];
        let mut next = 0;
        while let Some(&index) = set.get(next) {
            next += 1;
            for (column, _) in matrices.iter().flat_map(|matrix| matrix.row(index)) {
                if !std::mem::replace(&mut seen[column], true) {
                    set.push(column);
                }
            }
        }
        set.sort_unstable();
        found.push(set);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_chains_are_two_sets_and_what_does_not_count_divides() {
        let chain = |links: &[(u32, u32)]| {
            let entries = links
                .iter()
                .flat_map(|&(i, j)| [(i, i, 2.0), (i, j, -1.0), (j, i, -1.0), (j, j, 2.0)]);
            SparseMatrix::from_entries(6, entries.collect())
        };
        let matrices = [chain(&[(0, 2), (1, 3)]), chain(&[(2, 4)]), chain(&[(3, 5)])];
        assert_eq!(uncoupled(&matrices, |_| true), [vec![0, 2, 4], vec![1, 3, 5]]);
        assert_eq!(
            uncoupled(&matrices, |index| index != 2),
            [vec![0], vec![1, 3, 5], vec![4]]
        );
    }
}
