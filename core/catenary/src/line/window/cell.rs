//! A span far from the strips, reduced to its supports, to the elongations of its droppers and to its lowest modes.
use super::elongations::Elongations;
use super::end_layers::EndLayers;
use super::modes::Kept;
use super::part::Part;
use super::places::SpanPlaces;
use dynamics::{SparseMatrix, uncoupled};
use nalgebra::DVector;
use std::ops::Range;
use std::sync::Arc;

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
    parts: Vec<Arc<Part>>,
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
        let mut counts = is_free.clone();
        interface.iter().for_each(|&index| counts[index] = true);
        let entries = matrices.iter().flat_map(|matrix| {
            let of_row = |row: usize| matrix.row(row).map(move |(column, _)| (row, column));
            (0..size).flat_map(of_row)
        });
        let mut apart = uncoupled(&counts, entries);
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
            parts: parts.map(|part| part.map(Arc::new)).collect::<Option<_>>()?,
            size,
            elongations: span.elongations,
            layers: span.layers,
            places: span.places,
            interface,
        })
    }

    /// The parts, each with its own of the modes of the span.
    pub fn parts(&self, modes: Range<usize>) -> impl Iterator<Item = (&Arc<Part>, Range<usize>)> {
        self.parts.iter().zip(self.by_part(modes))
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
        for (part, modes_of) in self.parts(0..modes.len()) {
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
