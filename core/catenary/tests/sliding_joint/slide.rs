//! A wire between pins and a mass that slides along it.
use catenary::{
    AxialLaw, BendingLaw, ContactPair, ContactTangent, CurveColumns, NodeMap, PenaltyContact, Rayleigh, SlidingJoint,
    StripContact, Wire, WireCurve, WireGeometry, WireSection,
};
use dynamics::{
    Blocks, Columns, Constraint, Force, Frame, Jacobian, Layout, Marker, Motion, NewtonOptions, Simulator, SplitMix64,
    State, StaticOptions, System, solve_static,
};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use std::sync::Arc;

/// A mass in the plane of x and z on two coordinates, under a dead vertical force; the strip is across the plane.
#[derive(Clone, Copy)]
pub struct Mass {
    /// First coordinate.
    pub first: usize,
    /// kg.
    pub mass: f64,
    /// Vertical force on it, N.
    pub lift: f64,
}

impl Marker for Mass {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        let in_plane = |values: &[f64]| Vector3::new(values[self.first], 0.0, values[self.first + 1]);
        Frame {
            position: in_plane(motion.q),
            axes: Matrix3::identity(),
            velocity: in_plane(motion.v),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        columns.push(self.first, Vector3::x(), Vector3::zeros());
        columns.push(self.first + 1, Vector3::z(), Vector3::zeros());
    }
}

impl Force for Mass {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        force[self.first + 1] += self.lift;
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        let index = [self.first, self.first + 1];
        blocks.add(&index, &index, &[self.mass, 0.0, 0.0, self.mass]);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self.lift * motion.q[self.first + 1]
    }
}

/// Dead vertical forces on nodes: (index, N).
pub struct Loads(pub Vec<(usize, f64)>);

impl Force for Loads {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        self.0.iter().for_each(|&(index, value)| force[index] += value);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self
            .0
            .iter()
            .map(|&(index, value)| value * motion.q[index])
            .sum::<f64>()
    }
}

/// Parameters of a case.
#[derive(Clone, Copy)]
pub struct Case {
    pub section: WireSection,
    pub length: f64,
    pub elements: usize,
    /// Vertical load of its nodes on average, N/m; each has between nothing and twice its share.
    pub load: f64,
    pub mass: f64,
    pub lift: f64,
    /// m/s.
    pub speed: f64,
    /// Position of the mass at t = 0, m.
    pub start: f64,
    pub h: f64,
    pub rho_inf: f64,
    pub jacobian: Jacobian,
    /// Tolerance of Newton's method, N.
    pub tolerance: f64,
}

/// A wire between pins, and a mass on it.
pub struct Slide {
    pub layout: Layout,
    pub geometry: Arc<WireGeometry>,
    pub wire: Wire,
    pub loads: Loads,
    pub mass: Mass,
    pub contact: Option<StripContact>,
}

impl System for Slide {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.wire);
        visit(&mut self.loads);
        visit(&mut self.mass);
        if let Some(contact) = &mut self.contact {
            visit(contact.force());
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        if let Some(constraint) = self.contact.as_mut().and_then(StripContact::constraint) {
            visit(constraint);
        }
    }
}

impl Slide {
    pub fn new(case: &Case) -> Self {
        let mut layout = Layout::new();
        let first = layout.add_coordinates(4 * (case.elements + 1), "wire");
        let lengths = vec![case.length / case.elements as f64; case.elements];
        let geometry = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &lengths, |node| {
            NodeMap::planar(first + 4 * node)
        });
        for node in [0, case.elements] {
            layout.fix(first + 4 * node);
            layout.fix(first + 4 * node + 1);
        }
        // Equal loads would leave a wire that is symmetric about them, with the same curvature on both sides.
        let mut random = SplitMix64::new(1);
        let loads = (1..case.elements).map(|node| {
            let share = 2.0 * random.unit();
            (first + 4 * node + 1, case.load * lengths[0] * share)
        });
        let loads = loads.collect();
        let mass = Mass {
            first: layout.add_coordinates(2, "mass"),
            mass: case.mass,
            lift: case.lift,
        };
        let laws = (AxialLaw::Mean, BendingLaw::Constant);
        let geometry = Arc::new(geometry);
        let wire = Wire::new(case.section, Rayleigh::default(), laws, 9.81, Arc::clone(&geometry));
        Self {
            layout,
            geometry,
            wire,
            loads: Loads(loads),
            mass,
            contact: None,
        }
    }

    /// `v²Δκ/(1/m + Y)`: what the multiplier must fall by at the border between elements `node − 1` and `node` when the
    /// curvature grows there, and the same for a wire that does not answer, N.
    pub fn expected_step(&self, node: usize, state: &State, inverse_mass: &DMatrix<f64>) -> [f64; 2] {
        let border = self.geometry.node_s(node);
        let at = |s: f64| self.geometry.point(s, &state.q, &state.v);
        let (before, after) = (at(border - 1e-9), at(border + 1e-9));
        let tangent = after.r_s.normalize();
        let n = Vector3::new(-tangent.z, 0.0, tangent.x);
        let kink = n.dot(&(after.r_ss - before.r_ss)) / after.r_s.norm_squared();
        let velocity = Vector3::new(state.v[self.mass.first], 0.0, state.v[self.mass.first + 1]);
        let slide = tangent.dot(&(velocity - after.velocity));
        let mut columns = CurveColumns::default();
        self.geometry.columns(border, &mut columns);
        let mut row = DVector::zeros(state.q.len());
        for column in columns.as_slice() {
            row[column.index] += column.n.dot(&n);
        }
        self.layout.fixed().iter().for_each(|&index| row[index] = 0.0);
        let answer = row.dot(&(inverse_mass * &row));
        let whole = slide * slide * kink;
        [whole / (1.0 / self.mass.mass + answer), self.mass.mass * whole]
    }
}

/// The mass matrix with unit rows for what is held, inverted.
pub fn inverse_mass(system: &mut Slide) -> DMatrix<f64> {
    let mut places = Vec::new();
    system.forces(&mut |force| force.add_mass(&mut Blocks::record(&mut places)));
    let order: Vec<u32> = (0..places.len() as u32).collect();
    let mut values = vec![0.0; places.len()];
    let mut blocks = Blocks::add_to(&order, &mut values);
    system.forces(&mut |force| force.add_mass(&mut blocks));
    let n = system.layout.coordinates();
    let mut matrix = DMatrix::zeros(n, n);
    for (&(row, column), value) in places.iter().zip(values) {
        matrix[(row as usize, column as usize)] += value;
    }
    for &index in system.layout.fixed() {
        matrix.row_mut(index).fill(0.0);
        matrix.column_mut(index).fill(0.0);
        matrix[(index, index)] = 1.0;
    }
    matrix.try_inverse().expect("a mass matrix is positive definite")
}

/// The law between mass and wire: a joint, or a spring of this stiffness (N/m).
#[derive(Clone, Copy)]
pub enum Law {
    Joint,
    Spring(f64),
}

/// The wire at rest without the mass, and the mass put on it with its speed along it.
pub fn start(case: &Case, law: Law) -> Simulator<Slide> {
    let mut system = Slide::new(case);
    let mut state = system.layout.state_at_rest();
    // Without contact nothing holds the mass: it is left out of the statics by holding it.
    let first = system.mass.first;
    system.layout.fix(first);
    system.layout.fix(first + 1);
    solve_static(&mut system, &mut state, &[], &StaticOptions::default()).expect("the wire has an equilibrium");
    let held = system.layout.fixed().to_vec();
    system.layout.fix_within(0..first + 2, &held[..held.len() - 2]);

    let point = system.geometry.point(case.start, &state.q, &state.v);
    let tangent = point.r_s.normalize();
    let n = Vector3::new(-tangent.z, 0.0, tangent.x);
    let tangent_of = match case.jacobian {
        Jacobian::Full => ContactTangent::Exact,
        Jacobian::Modified => ContactTangent::RankOne,
    };
    let curve: Arc<dyn WireCurve> = system.geometry.clone();
    let (contact, at) = match law {
        Law::Joint => {
            let multiplier = system.layout.add_constraints(1);
            state.lambda.push(0.0);
            let joint = SlidingJoint::new(curve, Box::new(system.mass), multiplier, tangent_of);
            (StripContact::SlidingJoint(joint), point.r)
        }
        Law::Spring(stiffness) => {
            let law = PenaltyContact {
                stiffness,
                damping: 0.0,
            };
            let pair = ContactPair::new(law, curve, Box::new(system.mass), 1.0, tangent_of);
            (StripContact::Penalty(pair), point.r + case.lift / stiffness * n)
        }
    };
    system.contact = Some(contact);
    (state.q[first], state.q[first + 1]) = (at.x, at.z);
    let velocity = case.speed * tangent;
    (state.v[first], state.v[first + 1]) = (velocity.x, velocity.z);
    let options = NewtonOptions {
        tolerance: case.tolerance,
        constraint_tolerance: 1e-14,
        jacobian: case.jacobian,
        ..NewtonOptions::default()
    };
    let mut simulator = Simulator::new(system, state, Vec::new(), case.h, case.rho_inf, options);
    simulator.start_accelerations().expect("the mass is on the wire");
    simulator
}

pub fn step(simulator: &mut Simulator<Slide>, n: usize, h: f64) {
    let t = n as f64 * h;
    let result = simulator.advance(t, h, &mut |_, _| {}, &mut |_, _, _, _| {});
    result.unwrap_or_else(|error| panic!("t = {t}: {error}"));
}

/// Place of the mass on the wire (m) and the contact force (N).
pub fn seen(simulator: &mut Simulator<Slide>) -> (f64, f64) {
    let lambda = simulator.state().lambda.clone();
    let (system, motion) = simulator.parts();
    let contact = system
        .contact
        .as_ref()
        .and_then(|contact| contact.state(&motion, &lambda));
    let contact = contact.expect("on the wire");
    (contact.geometry.s, contact.force)
}

/// A light wire under a heavy mass: 30 elements of 1 m, 2 kN.
pub const HANGING: Case = Case {
    section: WireSection {
        axial_stiffness: 1e6,
        bending_stiffness: 200.0,
        mass_per_length: 1.3,
        tension: 2e3,
    },
    length: 30.0,
    elements: 30,
    load: 0.0,
    mass: 1.0,
    lift: 30.0,
    speed: 15.0,
    start: 4.3,
    h: 1e-4,
    rho_inf: 1.0,
    jacobian: Jacobian::Modified,
    tolerance: 1e-6,
};
