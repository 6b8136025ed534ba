//! A chain of equal beam elements along x as a system, clamped at its start: position and directors are held there; a
//! clamp leaves the axis its shear angle.
use catenary::{AxialLaw, Beam, BeamCoordinates, BeamInertia, BeamStiffness, beam_mass_matrix};
use dynamics::{Blocks, Force, Layout, Motion, State, StaticOptions, System, Weights, solve_static};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Coordinates per node.
const NODE: usize = 12;

/// Load on the last node.
#[derive(Clone, Copy, Debug)]
pub enum Load {
    /// A force of constant direction on the axis, N.
    Force(Vector3<f64>),
    /// A moment about z that turns `r,ᵧ`, N·m.
    Moment(f64),
}

/// The elements; coordinates are displacements from the straight beam on the x axis.
pub struct Chain {
    layout: Layout,
    contribution: Contribution,
}

struct Contribution {
    beam: Beam,
    mass: nalgebra::SMatrix<f64, 8, 8>,
    length: f64,
    elements: usize,
    load: Load,
}

impl Chain {
    /// `elements` of a beam of `length` (m) with the nominal tension of `law` (N).
    pub fn clamped(
        stiffness: &BeamStiffness,
        inertia: &BeamInertia,
        law: (AxialLaw, f64),
        length: f64,
        elements: usize,
    ) -> Self {
        let element_length = length / elements as f64;
        let mut layout = Layout::new();
        layout.add_coordinates(NODE * (elements + 1), "beam");
        for i in (0..3).chain(6..NODE) {
            layout.fix(i);
        }
        Self {
            layout,
            contribution: Contribution {
                beam: Beam::new(stiffness, law, element_length),
                mass: beam_mass_matrix(inertia, element_length),
                length: element_length,
                elements,
                load: Load::Force(Vector3::zeros()),
            },
        }
    }

    /// Holds one coordinate of a node: 0 to 2 position, 3 to 5 `r,ₓ`, 6 to 8 `r,ᵧ`, 9 to 11 `r,𝓏`.
    pub fn hold(&mut self, node: usize, coordinate: usize) {
        self.layout.fix(NODE * node + coordinate);
    }

    /// Lets go of one coordinate of the first node.
    pub fn release(&mut self, coordinate: usize) {
        let held: Vec<usize> = (self.layout.fixed().iter().copied())
            .filter(|&index| index != coordinate)
            .collect();
        self.layout
            .fix_within(0..NODE * (self.contribution.elements + 1), &held);
    }

    /// Equilibrium under `load`, reached in equal steps; the displacement of the last node, m.
    pub fn bend(&mut self, load: Load, steps: usize, tolerance: f64) -> Vector3<f64> {
        let mut state = self.layout.state_at_rest();
        for step in 1..=steps {
            let factor = step as f64 / steps as f64;
            self.contribution.load = match load {
                Load::Force(force) => Load::Force(force * factor),
                Load::Moment(moment) => Load::Moment(moment * factor),
            };
            let mut options = StaticOptions::default();
            options.newton.tolerance = tolerance;
            solve_static(self, &mut state, &[], &options).unwrap();
        }
        self.displacement(&state)
    }

    fn displacement(&self, state: &State) -> Vector3<f64> {
        Vector3::from_column_slice(&state.q[NODE * self.contribution.elements..][..3])
    }

    /// The lowest natural frequencies of the straight beam, Hz.
    pub fn frequencies(&mut self, count: usize) -> Vec<f64> {
        let n = self.layout.coordinates();
        let rest = self.layout.state_at_rest();
        let dense = |add: &dyn Fn(&mut Blocks<'_>)| {
            let mut places = Vec::new();
            add(&mut Blocks::record(&mut places));
            let positions: Vec<u32> = places.iter().map(|&(row, column)| column * n as u32 + row).collect();
            let mut values = vec![0.0; n * n];
            add(&mut Blocks::add_to(&positions, &mut values));
            let free: Vec<usize> = (0..n).filter(|index| !self.layout.fixed().contains(index)).collect();
            DMatrix::from_vec(n, n, values).select_rows(&free).select_columns(&free)
        };
        let stiffness = dense(&|blocks| self.contribution.add_elements(&rest.motion(&[]), 1.0, blocks));
        let mass = dense(&|blocks| self.contribution.add_mass(blocks));
        // Largest 1/ω² of L⁻¹ M L⁻ᵀ with K = L Lᵀ: the low modes keep their digits beside the stiff cross-section.
        let lower = stiffness.cholesky().expect("a stable beam").l();
        let half = lower.solve_lower_triangular(&mass).unwrap();
        let flexibility = lower.solve_lower_triangular(&half.transpose()).unwrap();
        let mut squares: Vec<f64> = flexibility.symmetric_eigenvalues().iter().copied().collect();
        squares.sort_by(|a, b| b.total_cmp(a));
        let hertz = |square: &f64| 1.0 / (square.sqrt() * std::f64::consts::TAU);
        squares.iter().take(count).map(hertz).collect()
    }
}

impl System for Chain {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.contribution);
    }
}

impl Contribution {
    fn coordinates(&self, element: usize, q: &[f64]) -> BeamCoordinates {
        let mut e = BeamCoordinates::from_column_slice(&q[NODE * element..][..2 * NODE]);
        for node in 0..2 {
            e[(0, 4 * node)] += (element + node) as f64 * self.length;
            for axis in 0..3 {
                e[(axis, 4 * node + 1 + axis)] += 1.0;
            }
        }
        e
    }

    fn add_elements(&self, motion: &Motion<'_>, weight: f64, blocks: &mut Blocks<'_>) {
        for element in 0..self.elements {
            let index: [usize; 24] = std::array::from_fn(|i| NODE * element + i);
            let tangent = self.beam.tangent(&self.coordinates(element, motion.q)) * weight;
            blocks.add(&index, &index, tangent.as_slice());
        }
    }

    /// `M ẑ × r,ᵧ/|r,ᵧ|²` on `r,ᵧ`, and its derivative.
    fn moment(&self, moment: f64, q: &[f64]) -> (usize, Vector3<f64>, Matrix3<f64>) {
        let first = NODE * self.elements + 6;
        let director = Vector3::new(q[first], 1.0 + q[first + 1], q[first + 2]);
        let square = director.norm_squared();
        let force = Vector3::z().cross(&director) * (moment / square);
        let turn = Vector3::z().cross_matrix() * (moment / square);
        (first, force, turn - force * director.transpose() * (2.0 / square))
    }
}

impl Force for Contribution {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for element in 0..self.elements {
            let own = self.beam.force(&self.coordinates(element, motion.q));
            for (value, own) in force[NODE * element..].iter_mut().zip(own.as_slice()) {
                *value -= own;
            }
        }
        let (first, load) = match self.load {
            Load::Force(load) => (NODE * self.elements, load),
            Load::Moment(moment) => {
                let (first, load, _) = self.moment(moment, motion.q);
                (first, load)
            }
        };
        for axis in 0..3 {
            force[first + axis] += load[axis];
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.add_elements(motion, weights.q, blocks);
        if let Load::Moment(moment) = self.load {
            let (first, _, rate) = self.moment(moment, motion.q);
            let index = [first, first + 1, first + 2];
            blocks.add(&index, &index, (rate.transpose() * -weights.q).as_slice());
        }
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for element in 0..self.elements {
            for axis in 0..3 {
                let index: [usize; 8] = std::array::from_fn(|i| NODE * element + 3 * i + axis);
                blocks.add(&index, &index, self.mass.as_slice());
            }
        }
    }
}
