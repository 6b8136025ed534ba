//! A span far from the strips, reduced to its supports, to the elongations of its droppers and to its lowest modes.
use super::elongations::Elongations;
use super::end_layers::EndLayers;
use super::modes::{Envelope, lowest_modes, product};
use super::places::SpanPlaces;
use dynamics::SparseMatrix;
use nalgebra::{DMatrix, DVector};

/// Number of modes that are evaluated side by side; the rows of a span's interface are padded with zeros to whole
/// groups.
pub(super) const GROUP: usize = 8;

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
    /// For each coordinate, true if it is along the track.
    pub longitudinal: Vec<bool>,
}

/// A span reduced by fixed-interface modes [Craig & Bampton 1968]:
///
/// ```text
/// q_f = Φₛ s + Φₘ η,    Φₛ = −K_ff⁻¹ K_fs,    K_ff Φₘ = M_ff Φₘ Ω²,    Φₘᵀ M_ff Φₘ = 1
/// ```
///
/// The interface `s` are the supports, left one first, and the elongations of droppers with dampers. Static answers to
/// motions of the interface are exact, tension and sag included; waves are carried up to the frequency of the last
/// mode. The droppers are taut. Dampers of droppers act on the interface alone, as exactly as the springs: on modes
/// that stretch droppers the dampers would couple all modes, and more strongly than any other coupling where `ω c` is
/// above `k`, as on the thesis' line. The modes have the damping of the wires, whose weak coupling between modes is
/// left out.
#[derive(Debug)]
pub(super) struct Cell {
    /// All coordinates of the span.
    size: usize,
    elongations: Elongations,
    layers: EndLayers,
    places: SpanPlaces,
    /// Interface among the coordinates of the span, and the remaining coordinates between the supports, `f`.
    interface: Vec<usize>,
    inner: Vec<usize>,
    /// `Φₛ`.
    shapes: DMatrix<f64>,
    /// `Φₘ`.
    modes: DMatrix<f64>,
    /// `M_ff Φₘ`.
    weighted_modes: DMatrix<f64>,
    /// Stiffness on the interface.
    pub stiffness: DMatrix<f64>,
    pub damping: DMatrix<f64>,
    pub mass: DMatrix<f64>,
    /// `ω²` of each mode, 1/s².
    pub squares: Vec<f64>,
    /// Damping of each mode, 1/s.
    pub mode_damping: Vec<f64>,
    /// Damping between interface (rows) and modes.
    pub damping_coupling: DMatrix<f64>,
    pub mass_coupling: DMatrix<f64>,
    /// Stiffness, damping and mass in groups of rows, each group column by column.
    pub dense: Vec<Grouped<3>>,
    /// Couplings, damping, then mass, in groups of modes, each group row by row, padded with zeros.
    pub couplings: Vec<Grouped<2>>,
}

/// Motion between the supports of a span.
pub(super) struct Between {
    /// Bending layers of the left and of the right support.
    pub end_layers: Vec<Vec<f64>>,
    pub inner: Vec<f64>,
}

/// Numbers for each member of a group, at the boundary of a cache line: a vector loaded across two lines costs twice.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Grouped<const COUNT: usize>(pub [[f64; GROUP]; COUNT]);

impl<const COUNT: usize> Grouped<COUNT> {
    /// Numbers `of(row, member)` of the group that begins with member `first`.
    pub fn new(first: usize, of: impl Fn(usize, usize) -> f64) -> Self {
        Self(std::array::from_fn(|kind| {
            std::array::from_fn(|lane| of(kind, first + lane))
        }))
    }
}

impl Cell {
    /// Reduces a span to `count` modes: the first `longitudinal` ones along the track among the lowest `searched`, and
    /// the lowest others. `None` where its inner stiffness is not positive definite.
    pub fn new(span: SpanMatrices, count: usize, (searched, longitudinal): (usize, usize)) -> Option<Self> {
        let size = span.stiffness.size();
        let supports = span.places.supports.concat();
        let interface: Vec<usize> = supports.into_iter().chain(span.elongations.places()).collect();
        let mut place = vec![None; size];
        for (row, &index) in interface.iter().enumerate() {
            place[index] = Some(row);
        }
        let between = span.places.inner[0].clone();
        let free = |index: &usize| place[*index].is_none() && !span.held.contains(index);
        let inner: Vec<usize> = between.filter(free).collect();
        let mut number = vec![0; size];
        inner.iter().enumerate().for_each(|(i, &index)| number[index] = i);
        let place = |index: usize| place[index].map_or((true, number[index]), |row| (false, row));
        let held = |index: usize| span.held.contains(&index);
        let (count_f, count_s) = (inner.len(), interface.len().next_multiple_of(GROUP));
        let split = |matrix: &SparseMatrix| -> (SparseMatrix, DMatrix<f64>, DMatrix<f64>) {
            let matrix = span.elongations.transform(matrix);
            let mut ff = Vec::new();
            let (mut fs, mut ss) = (DMatrix::zeros(count_f, count_s), DMatrix::zeros(count_s, count_s));
            for row in (0..size).filter(|&row| !held(row)) {
                for (column, value) in matrix.row(row).filter(|&(column, _)| !held(column)) {
                    match (place(row), place(column)) {
                        ((true, i), (true, j)) => ff.push((i as u32, j as u32, value)),
                        ((true, i), (false, j)) => fs[(i, j)] += value,
                        ((false, i), (false, j)) => ss[(i, j)] += value,
                        ((false, _), (true, _)) => {}
                    }
                }
            }
            (SparseMatrix::from_entries(count_f, ff), fs, ss)
        };
        let (k_ff, k_fs, k_ss) = split(&span.stiffness);
        let (d_ff, d_fs, d_ss) = split(&span.damping);
        let (m_ff, m_fs, m_ss) = split(&span.mass);
        let factor = Envelope::factor(&k_ff)?;
        let mut shapes = -k_fs.clone();
        for column in 0..count_s {
            factor.solve(shapes.column_mut(column).as_mut_slice());
        }
        let (modes, squares) = lowest_modes((&k_ff, &factor), &m_ff, searched.max(count));
        let along = inner.iter().map(|&index| f64::from(u8::from(span.longitudinal[index])));
        let along = DVector::from_iterator(count_f, along);
        let order = longitudinal_first(
            &(modes.component_mul(&product(&m_ff, &modes)).tr_mul(&along)),
            longitudinal,
            count,
        );
        let (modes, squares) = (
            modes.select_columns(&order),
            order.iter().map(|&mode| squares[mode]).collect::<Vec<_>>(),
        );
        // Products, not `tr_mul`: see `lowest_modes`.
        let reduced = |ff: &SparseMatrix, fs: &DMatrix<f64>, ss: &DMatrix<f64>| {
            let inner = product(ff, &shapes);
            let cross = fs.transpose() * &shapes;
            let sum = ss + &cross + cross.transpose() + shapes.transpose() * &inner;
            let sum = (&sum + sum.transpose()) * 0.5;
            (sum, (fs + inner).transpose() * &modes)
        };
        let (stiffness, _) = reduced(&k_ff, &k_fs, &k_ss);
        let (damping, damping_coupling) = reduced(&d_ff, &d_fs, &d_ss);
        let (mass, mass_coupling) = reduced(&m_ff, &m_fs, &m_ss);
        let (of_interface, of_couplings) = ([&stiffness, &damping, &mass], [&damping_coupling, &mass_coupling]);
        let pairs = |groups: usize| (0..groups).flat_map(|group| (0..count_s).map(move |other| (GROUP * group, other)));
        let dense = pairs(count_s / GROUP)
            .map(|(rows, column)| Grouped::new(rows, |kind, row| of_interface[kind][(row, column)]))
            .collect();
        let coupling =
            |kind: usize, row: usize, mode: usize| of_couplings[kind].get((row, mode)).copied().unwrap_or(0.0);
        let couplings = pairs(modes.ncols().div_ceil(GROUP))
            .map(|(modes, row)| Grouped::new(modes, |kind, mode| coupling(kind, row, mode)))
            .collect();
        let damped = product(&d_ff, &modes);
        let mode_damping = (0..modes.ncols()).map(|i| modes.column(i).dot(&damped.column(i)));
        Some(Self {
            size,
            elongations: span.elongations,
            layers: span.layers,
            mode_damping: mode_damping.collect(),
            weighted_modes: product(&m_ff, &modes),
            places: span.places,
            interface,
            inner,
            shapes,
            modes,
            stiffness,
            damping,
            mass,
            squares,
            dense,
            couplings,
            damping_coupling,
            mass_coupling,
        })
    }

    /// Motion between the supports from that of the interface and of the first modes.
    pub fn expand(&self, interface: &[f64], modes: &[f64]) -> Between {
        let s = DVector::from_column_slice(interface);
        let modes = DVector::from_column_slice(modes);
        let inner = self.shapes.columns(0, s.len()) * &s + self.modes.columns(0, modes.len()) * modes;
        let mut values = vec![0.0; self.size];
        for (&index, value) in self.inner.iter().zip(&inner).chain(self.interface.iter().zip(&s)) {
            values[index] = *value;
        }
        self.elongations.displace(&mut values);
        self.layers.follow(&mut values);
        let at = |places: &Vec<usize>| places.iter().map(|&index| values[index]).collect();
        Between {
            end_layers: self.places.layers.iter().map(at).collect(),
            inner: values[self.places.inner[0].clone()].to_vec(),
        }
    }

    /// Elongations, and the modes' share by mass, of a motion at and between the supports.
    pub fn project(&self, supports: &[f64], inner: &[f64]) -> (Vec<f64>, DVector<f64>) {
        let mut values = vec![0.0; self.size];
        values[self.places.inner[0].clone()].copy_from_slice(inner);
        self.elongations.measure(&mut values);
        for (&index, value) in self.interface.iter().zip(supports) {
            values[index] = *value;
        }
        let of = |places: &[usize]| DVector::from_iterator(places.len(), places.iter().map(|&index| values[index]));
        let interface = of(&self.interface);
        let rest = of(&self.inner) - self.shapes.columns(0, interface.len()) * &interface;
        (
            interface.as_slice()[supports.len()..].to_vec(),
            self.weighted_modes.tr_mul(&rest),
        )
    }
}

/// Longitudinal modes of a span of one tension length that come before all others: the first two of each wire.
pub(super) const LONGITUDINAL: usize = 4;

/// Numbers of the `count` modes that are kept, in their order: of all modes by ascending frequency the `shares` of
/// their mass that move along the track.
///
/// Tension changes run along the line at kilometres per second, as waves longer than the spans far beyond the
/// frequencies of the contact force. With the quasi-static shape alone the mass of a span would stand at its supports,
/// and these waves would be too fast.
fn longitudinal_first(shares: &DVector<f64>, longitudinal: usize, count: usize) -> Vec<usize> {
    let along: Vec<usize> = (0..shares.len())
        .filter(|&mode| shares[mode] > 0.5)
        .take(longitudinal)
        .collect();
    let others = (0..shares.len()).filter(|mode| !along.contains(mode));
    along.iter().copied().chain(others).take(count).collect()
}
