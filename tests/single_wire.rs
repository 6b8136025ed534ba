//! A wire as a system, for comparisons with closed forms and published examples.
use catenary::{
    AxialLaw, BendingLaw, ContactPair, CurveColumns, CurvePoint, NodeMap, Rayleigh, Wire, WireCurve, WireGeometry,
    WireSection, mass_matrix,
};
use dynamics::{
    Blocks, Force, GeneralizedAlpha, Layout, Motion, NewtonOptions, State, StaticOptions, System, Weights, solve_static,
};
use nalgebra::{DMatrix, DVector, Vector3};
use std::sync::Arc;

/// A dead force (N) at a point of the wire that moves with `speed` (m/s) from `start` (m), while on the wire.
#[derive(Clone, Debug)]
pub struct Load {
    /// The wire.
    pub geometry: Arc<WireGeometry>,
    /// Force, N.
    pub force: Vector3<f64>,
    /// `s` at time zero, m.
    pub start: f64,
    /// m/s.
    pub speed: f64,
}

impl Load {
    /// Position at time `t`, m.
    #[must_use]
    pub fn s(&self, t: f64) -> f64 {
        self.start + self.speed * t
    }
}

impl Force for Load {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let s = self.s(motion.t);
        if !(0.0..=self.geometry.length()).contains(&s) {
            return;
        }
        let mut columns = CurveColumns::default();
        self.geometry.columns(s, &mut columns);
        for column in columns.as_slice() {
            force[column.index] += column.n.dot(&self.force);
        }
    }
}

/// An elastic foundation under a wire, `stiffness` in N/m per metre, vertical.
#[derive(Clone, Debug)]
pub struct Foundation {
    /// The wire.
    pub geometry: Arc<WireGeometry>,
    /// N/m².
    pub stiffness: f64,
}

impl Foundation {
    fn index(&self, element: usize) -> [usize; 4] {
        let nodes = self.geometry.nodes();
        let (a, b) = (&nodes[element].map, &nodes[element + 1].map);
        [a.position(2), a.slope(2), b.position(2), b.slope(2)].map(|index| index.expect("a vertical coordinate"))
    }
}

impl Force for Foundation {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for (element, &length) in self.geometry.lengths().iter().enumerate() {
            let matrix = mass_matrix(length) * self.stiffness;
            let index = self.index(element);
            for (row, &to) in index.iter().enumerate() {
                for (column, &from) in index.iter().enumerate() {
                    force[to] -= matrix[(row, column)] * motion.q[from];
                }
            }
        }
    }

    fn add_tangent(&mut self, _motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for (element, &length) in self.geometry.lengths().iter().enumerate() {
            let matrix = mass_matrix(length) * (self.stiffness * weights.q);
            let index = self.index(element);
            blocks.add(&index, &index, matrix.as_slice());
        }
    }
}

/// Data of a wire.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    /// Section.
    pub section: WireSection,
    /// Laws.
    pub laws: (AxialLaw, BendingLaw),
    /// m/s².
    pub gravity: f64,
}

/// A wire with its own coordinates, loads and perhaps a foundation.
pub struct SingleWire {
    /// Coordinates.
    pub layout: Layout,
    /// The wire.
    pub wire: Wire,
    /// Loads.
    pub loads: Vec<Load>,
    /// Foundation.
    pub foundation: Option<Foundation>,
    /// A strip under the wire.
    pub contact: Option<ContactPair>,
}

impl System for SingleWire {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.wire);
        for load in &mut self.loads {
            visit(load);
        }
        if let Some(foundation) = &mut self.foundation {
            visit(foundation);
        }
        if let Some(contact) = &mut self.contact {
            visit(contact);
        }
    }
}

impl SingleWire {
    /// A straight planar wire along x of `count` elements over `length` (m); no coordinate is fixed.
    #[must_use]
    pub fn planar(material: &Material, length: f64, count: usize) -> Self {
        Self::along(material, Vector3::x(), length, count, 4)
    }

    /// A straight wire in space.
    #[must_use]
    pub fn spatial(material: &Material, length: f64, count: usize) -> Self {
        Self::along(material, Vector3::x(), length, count, 6)
    }

    fn along(material: &Material, direction: Vector3<f64>, length: f64, count: usize, per_node: usize) -> Self {
        let lengths = vec![length / count as f64; count];
        let geometry = WireGeometry::straight(Vector3::zeros(), direction, &lengths, |node| {
            if per_node == 4 {
                NodeMap::planar(4 * node)
            } else {
                NodeMap::spatial(6 * node)
            }
        });
        Self::new(material, geometry, per_node * (count + 1))
    }

    /// A wire on a geometry whose coordinates are numbered from zero.
    #[must_use]
    pub fn new(material: &Material, geometry: WireGeometry, coordinates: usize) -> Self {
        let mut layout = Layout::new();
        layout.add_coordinates(coordinates, "wire");
        let Material { section, laws, gravity } = *material;
        Self {
            layout,
            wire: Wire::new(section, Rayleigh::default(), laws, gravity, Arc::new(geometry)),
            loads: Vec::new(),
            foundation: None,
            contact: None,
        }
    }

    /// The geometry.
    #[must_use]
    pub fn geometry(&self) -> &Arc<WireGeometry> {
        self.wire.geometry()
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.geometry().nodes().len()
    }

    /// Holds the position of a node.
    #[must_use]
    pub fn pinned(mut self, node: usize) -> Self {
        for axis in 0..3 {
            if let Some(index) = self.geometry().nodes()[node].map.position(axis) {
                self.layout.fix(index);
            }
        }
        self
    }

    /// Holds the position of a node and the direction of its slope, which is along x; its size stays free.
    #[must_use]
    pub fn clamped(mut self, node: usize) -> Self {
        self = self.pinned(node);
        for axis in [1, 2] {
            if let Some(index) = self.geometry().nodes()[node].map.slope(axis) {
                self.layout.fix(index);
            }
        }
        self
    }

    /// Holds the height of a node.
    #[must_use]
    pub fn supported(mut self, node: usize) -> Self {
        self.layout.fix(
            self.geometry().nodes()[node]
                .map
                .position(2)
                .expect("a vertical coordinate"),
        );
        self
    }

    /// Holds the vertical slope of a node.
    #[must_use]
    pub fn guided(mut self, node: usize) -> Self {
        self.layout.fix(
            self.geometry().nodes()[node]
                .map
                .slope(2)
                .expect("a vertical coordinate"),
        );
        self
    }

    /// Adds a load at rest.
    #[must_use]
    pub fn loaded(mut self, s: f64, force: Vector3<f64>) -> Self {
        let geometry = Arc::clone(self.geometry());
        self.loads.push(Load {
            geometry,
            force,
            start: s,
            speed: 0.0,
        });
        self
    }

    /// The equilibrium next to `state`.
    ///
    /// # Panics
    /// When there is none.
    pub fn settle(&mut self, state: &mut State) {
        let options = StaticOptions::default();
        solve_static(self, state, &[], &options).expect("the wire has an equilibrium");
    }

    /// The equilibrium next to the reference.
    #[must_use]
    pub fn equilibrium(&mut self) -> State {
        let mut state = self.layout.state_at_rest();
        self.settle(&mut state);
        state
    }

    /// The wire at `s`.
    #[must_use]
    pub fn point(&self, s: f64, state: &State) -> CurvePoint {
        self.geometry().point(s, &state.q, &state.v)
    }

    /// The mass matrix.
    #[must_use]
    pub fn mass(&self) -> DMatrix<f64> {
        dense(self.layout.coordinates(), &mut |blocks| self.wire.add_mass(blocks))
    }

    /// Potential and kinetic energy, J.
    #[must_use]
    pub fn energy(&self, state: &State, mass: &DMatrix<f64>) -> f64 {
        let v = DVector::from_column_slice(&state.v);
        self.wire.energy(&state.motion(&[])) + 0.5 * v.dot(&(mass * &v))
    }

    /// Adds a vertical displacement and velocity field: `field(s)` gives `(w, w_s, ẇ, ẇ_s)`.
    pub fn displace(&self, state: &mut State, field: impl Fn(f64) -> [f64; 4]) {
        let geometry = self.geometry();
        for (i, node) in geometry.nodes().iter().enumerate() {
            let [w, w_s, rate, rate_s] = field(geometry.node_s(i));
            if let (Some(position), Some(slope)) = (node.map.position(2), node.map.slope(2)) {
                state.q[position] += w;
                state.q[slope] += w_s;
                state.v[position] += rate;
                state.v[slope] += rate_s;
            }
        }
    }

    /// Natural frequencies, Hz, ascending, of vibration in the vertical plane about `state`.
    ///
    /// # Panics
    /// When the mass matrix is not positive definite.
    pub fn frequencies(&mut self, state: &State) -> Vec<f64> {
        let n = self.layout.coordinates();
        let weights = Weights { q: 1.0, v: 0.0 };
        let stiffness = dense(n, &mut |blocks| {
            self.forces(&mut |force| force.add_tangent(&state.motion(&[]), weights, blocks));
        });
        let mass = self.mass();
        let free: Vec<usize> = (self.geometry().nodes().iter())
            .flat_map(|node| [node.map.position(2), node.map.slope(2)])
            .flatten()
            .filter(|index| !self.layout.fixed().contains(index))
            .collect();
        let select = |matrix: &DMatrix<f64>| matrix.select_rows(&free).select_columns(&free);
        let root = select(&mass).cholesky().expect("positive definite mass");
        // L⁻¹ K L⁻ᵀ
        let half = root
            .l()
            .solve_lower_triangular(&select(&stiffness))
            .expect("no zero on the diagonal");
        let full = root
            .l()
            .solve_lower_triangular(&half.transpose())
            .expect("no zero on the diagonal");
        let symmetric = (&full + full.transpose()) * 0.5;
        let mut frequencies: Vec<f64> = (symmetric.symmetric_eigenvalues().iter())
            .map(|square| square.max(0.0).sqrt() / (2.0 * std::f64::consts::PI))
            .collect();
        frequencies.sort_by(f64::total_cmp);
        frequencies
    }
}

/// Dense matrix of the blocks that `add` writes.
pub fn dense(n: usize, add: &mut dyn FnMut(&mut Blocks<'_>)) -> DMatrix<f64> {
    let mut places = Vec::new();
    add(&mut Blocks::record(&mut places));
    let positions: Vec<u32> = places.iter().map(|&(row, column)| column * n as u32 + row).collect();
    let mut values = vec![0.0; n * n];
    add(&mut Blocks::add_to(&positions, &mut values));
    DMatrix::from_vec(n, n, values)
}

/// An integrator without numerical damping, tight enough for comparisons: `tolerance` in N.
#[must_use]
pub fn trapezoid(tolerance: f64) -> GeneralizedAlpha {
    let options = NewtonOptions {
        tolerance,
        ..NewtonOptions::default()
    };
    GeneralizedAlpha::new(1.0, options)
}

/// Numbers of a data file: rows of `columns` values; comments, headings and other rows are passed over.
#[must_use]
pub fn numbers(text: &str, columns: usize) -> Vec<Vec<f64>> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.split(',').filter_map(|field| field.parse().ok()).collect())
        .filter(|row: &Vec<f64>| row.len() == columns)
        .collect()
}
