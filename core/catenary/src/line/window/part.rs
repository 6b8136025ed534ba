//! The part of a reduced span that belongs to one tension length.
use super::modes::Kept;
use dynamics::SparseMatrix;
use dynamics::eigen::{BandedFactor, BandedMatrix};
use nalgebra::{DMatrix, DVector};

/// Number of modes that are evaluated side by side; the rows of an interface are padded with zeros to whole groups.
pub(super) const GROUP: usize = 8;

/// Coordinates of a span reduced by fixed-interface modes [Craig & Bampton 1968]:
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
pub(super) struct Part {
    /// Rows of the span's interface that belong to the part.
    pub rows: Vec<usize>,
    /// Remaining coordinates between the supports, `f`, among those of the span.
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

impl Part {
    /// Reduces the rows of an interface and the coordinates between them to modes. `None` where the stiffness between
    /// the supports is not positive definite.
    pub fn new(
        [stiffness, damping, mass]: &[SparseMatrix; 3],
        interface: &[usize],
        (rows, inner): (Vec<usize>, Vec<usize>),
        axes: &[Option<usize>],
        kept: Kept,
    ) -> Option<Self> {
        let mut place = vec![None; stiffness.size()];
        for (number, &index) in inner.iter().enumerate() {
            place[index] = Some((true, number));
        }
        for (number, &row) in rows.iter().enumerate() {
            place[interface[row]] = Some((false, number));
        }
        let (count_f, count_s) = (inner.len(), rows.len().next_multiple_of(GROUP));
        let split = |matrix: &SparseMatrix| -> (SparseMatrix, DMatrix<f64>, DMatrix<f64>) {
            let mut ff = Vec::new();
            let (mut fs, mut ss) = (DMatrix::zeros(count_f, count_s), DMatrix::zeros(count_s, count_s));
            for row in 0..matrix.size() {
                for (column, value) in matrix.row(row) {
                    match (place[row], place[column]) {
                        (Some((true, i)), Some((true, j))) => ff.push((i as u32, j as u32, value)),
                        (Some((true, i)), Some((false, j))) => fs[(i, j)] += value,
                        (Some((false, i)), Some((false, j))) => ss[(i, j)] += value,
                        _ => {}
                    }
                }
            }
            (SparseMatrix::from_entries(count_f, ff), fs, ss)
        };
        let (k_ff, k_fs, k_ss) = split(stiffness);
        let (d_ff, d_fs, d_ss) = split(damping);
        let (m_ff, m_fs, m_ss) = split(mass);
        let factor = BandedFactor::new(&BandedMatrix::from(&k_ff));
        if factor.negative() > 0 {
            return None;
        }
        let mut shapes = -k_fs.clone();
        factor.solve_columns(shapes.as_mut_slice());
        let moves = |axis: usize| -> Vec<bool> { inner.iter().map(|&index| axes[index] == Some(axis)).collect() };
        let found = kept.modes((&k_ff, &factor), &m_ff, [&moves(0), &moves(1)]);
        let (squares, count) = (found.values, found.vectors.len());
        let modes = DMatrix::from_vec(count_f, count, found.vectors.concat());
        let product = |matrix: &SparseMatrix, x: &DMatrix<f64>| {
            DMatrix::from_vec(count_f, x.ncols(), matrix.multiply_columns(x.as_slice()))
        };
        // Products, not `tr_mul`, which is several times slower as it is not blocked.
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
            mode_damping: mode_damping.collect(),
            weighted_modes: product(&m_ff, &modes),
            rows,
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

    /// Adds the motion of the inner coordinates, from that of the span's interface and of the first modes, to `values`
    /// of the span.
    pub fn expand(&self, interface: &[f64], modes: &[f64], values: &mut [f64]) {
        let s = self.of_interface(interface);
        let modes = DVector::from_column_slice(modes);
        let inner = self.shapes.columns(0, s.len()) * &s + self.modes.columns(0, modes.len()) * modes;
        for (&index, value) in self.inner.iter().zip(&inner) {
            values[index] = *value;
        }
    }

    /// The modes' share by mass of the motion `values` of the span, of which `interface` is the interface.
    pub fn project(&self, interface: &[f64], values: &[f64]) -> DVector<f64> {
        let s = self.of_interface(interface);
        let inner = self.inner.iter().map(|&index| values[index]);
        let rest = DVector::from_iterator(self.inner.len(), inner) - self.shapes.columns(0, s.len()) * &s;
        self.weighted_modes.tr_mul(&rest)
    }

    fn of_interface(&self, interface: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(|&row| interface[row]))
    }
}
