//! A span far from the strips, reduced to its supports and its lowest modes.
use super::modes::{Envelope, lowest_modes, product};
use dynamics::SparseMatrix;
use nalgebra::{DMatrix, DVector};

/// Modes that are evaluated side by side.
pub(super) const GROUP: usize = 8;

/// Stiffness, damping and mass of one span between its supports, linear about the static state.
pub(super) struct SpanMatrices {
    /// Coordinates per support: the first ones are those of the left support, the last ones those of the right.
    pub at_support: usize,
    pub stiffness: SparseMatrix,
    pub damping: SparseMatrix,
    pub mass: SparseMatrix,
}

/// A span reduced by fixed-interface modes [Craig & Bampton 1968]:
///
/// ```text
/// q_inner = Φₛ q_supports + Φₘ η,    Φₛ = −K_ff⁻¹ K_fs,    K_ff Φₘ = M_ff Φₘ Ω²,    Φₘᵀ M_ff Φₘ = 1
/// ```
///
/// Static answers to motions of the supports are exact, tension and sag included; waves are carried up to the frequency of the
/// last mode. Its droppers are taut. The damping couples no two modes, see `matrices`.
#[derive(Debug)]
pub(super) struct Cell {
    /// `Φₛ`.
    shapes: DMatrix<f64>,
    /// `Φₘ`.
    modes: DMatrix<f64>,
    /// `M_ff Φₘ`.
    weighted_modes: DMatrix<f64>,
    /// On the coordinates of both supports, left one first.
    pub stiffness: DMatrix<f64>,
    pub damping: DMatrix<f64>,
    pub mass: DMatrix<f64>,
    /// `ω²` of each mode, 1/s².
    pub squares: Vec<f64>,
    /// Damping of each mode, 1/s.
    pub mode_damping: Vec<f64>,
    /// Between supports (rows) and modes.
    pub damping_coupling: DMatrix<f64>,
    pub mass_coupling: DMatrix<f64>,
    /// The same, group by group of modes and in these support by support, filled up with zeros: damping, then mass.
    pub couplings: Vec<Pair>,
}

/// Two numbers for each mode of a group, at the boundary of a cache line: a vector loaded across two lines costs twice.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Pair(pub [[f64; GROUP]; 2]);

impl Cell {
    /// Reduces a span to `count` modes; `None` where its inner stiffness is not positive definite.
    pub fn new(span: &SpanMatrices, count: usize) -> Option<Self> {
        let (size, ni) = (span.stiffness.size(), span.at_support);
        let inner = size - 2 * ni;
        let place = |index: usize| -> (bool, usize) {
            if index < ni {
                (false, index)
            } else if index < size - ni {
                (true, index - ni)
            } else {
                (false, index - inner)
            }
        };
        let split = |matrix: &SparseMatrix| -> (SparseMatrix, DMatrix<f64>, DMatrix<f64>) {
            let mut ff = Vec::new();
            let (mut fs, mut ss) = (DMatrix::zeros(inner, 2 * ni), DMatrix::zeros(2 * ni, 2 * ni));
            for row in 0..size {
                for (column, value) in matrix.row(row) {
                    match (place(row), place(column)) {
                        ((true, i), (true, j)) => ff.push((i as u32, j as u32, value)),
                        ((true, i), (false, j)) => fs[(i, j)] += value,
                        ((false, i), (false, j)) => ss[(i, j)] += value,
                        ((false, _), (true, _)) => {}
                    }
                }
            }
            (SparseMatrix::from_entries(inner, ff), fs, ss)
        };
        let (k_ff, k_fs, k_ss) = split(&span.stiffness);
        let (d_ff, d_fs, d_ss) = split(&span.damping);
        let (m_ff, m_fs, m_ss) = split(&span.mass);
        let factor = Envelope::factor(&k_ff)?;
        let mut shapes = -k_fs.clone();
        for column in 0..2 * ni {
            factor.solve(shapes.column_mut(column).as_mut_slice());
        }
        let (modes, squares) = lowest_modes(&factor, &m_ff, count);
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
        let couplings = (0..modes.ncols().div_ceil(GROUP)).flat_map(|group| (0..2 * ni).map(move |row| (group, row)));
        let lanes = |matrix: &DMatrix<f64>, group: usize, row: usize| {
            std::array::from_fn(|lane| matrix.get((row, GROUP * group + lane)).copied().unwrap_or(0.0))
        };
        let couplings = couplings
            .map(|(group, row)| Pair([&damping_coupling, &mass_coupling].map(|matrix| lanes(matrix, group, row))))
            .collect();
        let damped = product(&d_ff, &modes);
        let mode_damping = (0..modes.ncols()).map(|i| modes.column(i).dot(&damped.column(i)));
        Some(Self {
            mode_damping: mode_damping.collect(),
            weighted_modes: product(&m_ff, &modes),
            shapes,
            modes,
            stiffness,
            damping,
            mass,
            squares,
            couplings,
            damping_coupling,
            mass_coupling,
        })
    }

    /// Number of modes.
    pub fn mode_count(&self) -> usize {
        self.squares.len()
    }

    /// Inner values from those of both supports and of the first modes.
    pub fn expand(&self, supports: &[f64], modes: &[f64]) -> DVector<f64> {
        let supports = DVector::from_column_slice(supports);
        let modes = DVector::from_column_slice(modes);
        &self.shapes * supports + self.modes.columns(0, modes.len()) * modes
    }

    /// The modes' share in inner values, by mass.
    pub fn project(&self, supports: &[f64], inner: &[f64]) -> DVector<f64> {
        let rest = DVector::from_column_slice(inner) - &self.shapes * DVector::from_column_slice(supports);
        self.weighted_modes.tr_mul(&rest)
    }
}
