//! Bodies, joints and loads as one system.
use dynamics::{
    Columns, Constraint, Force, GeneralizedAlpha, JacobianRows, Layout, Marker, Motion, NewtonOptions, State, System,
};
use nalgebra::{UnitQuaternion, Vector3};
use vehicle::multibody::{Joint, Pose, RigidBody};

/// Mechanism assembled body by body.
#[derive(Default)]
pub struct Mechanism {
    layout: Layout,
    pub bodies: Vec<RigidBody>,
    joints: Vec<Box<dyn Constraint>>,
    loads: Vec<Box<dyn Force>>,
}

impl Mechanism {
    /// Adds a body of `mass` kg with principal moments of inertia in kg·m².
    pub fn add_body(
        &mut self,
        position: Vector3<f64>,
        orientation: UnitQuaternion<f64>,
        (mass, inertia, gravity): (f64, Vector3<f64>, f64),
    ) -> Pose {
        let name = format!("body {}", self.bodies.len() + 1);
        let pose = Pose::new(position, orientation, &name, &mut self.layout);
        self.bodies.push(RigidBody {
            pose,
            mass,
            inertia,
            gravity,
        });
        pose
    }

    /// Adds a joint; returns the number of its first multiplier.
    pub fn add_joint(&mut self, joint: impl Constraint + 'static) -> usize {
        let first = self.layout.add_constraints(joint.dimension());
        self.joints.push(Box::new(joint));
        first
    }

    pub fn add_load(&mut self, load: impl Force + 'static) {
        self.loads.push(Box::new(load));
    }

    /// At rest in the position that the mechanism was built in.
    pub fn state(&self) -> State {
        self.layout.state_at_rest()
    }

    /// Kinetic and potential energy, J.
    pub fn energy(&self, state: &State) -> f64 {
        let motion = state.motion(&[]);
        let bodies = self
            .bodies
            .iter()
            .map(|body| body.kinetic_energy(&motion) + body.energy(&motion));
        bodies.sum::<f64>() + self.loads.iter().map(|load| load.energy(&motion)).sum::<f64>()
    }

    /// Largest residual of a joint, m or –.
    pub fn violation(&self, state: &State) -> f64 {
        let mut worst = 0.0_f64;
        for joint in &self.joints {
            let mut g = vec![0.0; joint.dimension()];
            joint.residual(&state.motion(&[]), &mut g);
            worst = g.iter().fold(worst, |worst, g| worst.max(g.abs()));
        }
        worst
    }
}

impl System for Mechanism {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        for body in &mut self.bodies {
            visit(body);
        }
        for load in &mut self.loads {
            visit(load.as_mut());
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        for joint in &mut self.joints {
            visit(joint.as_mut());
        }
    }
}

/// Part in the x–y plane of the joint of two points: closes a loop of revolute joints about z without stating twice
/// that the loop is plane.
pub struct InPlane(pub Joint);

impl Constraint for InPlane {
    fn dimension(&self) -> usize {
        2
    }

    fn residual(&self, motion: &Motion<'_>, g: &mut [f64]) {
        let mut all = [0.0; 3];
        self.0.residual(motion, &mut all);
        g.copy_from_slice(&all[..2]);
    }

    fn jacobian(&self, motion: &Motion<'_>, rows: &mut JacobianRows<'_>) {
        let mut first_two = |row: usize, columns: &[usize], values: &[f64]| {
            if row < 2 {
                rows.add(row, columns, values);
            }
        };
        self.0.jacobian(motion, &mut JacobianRows::new(&mut first_two));
    }
}

/// Spring between a point of a body and a fixed point, without a tangent: Newton's method takes up the missing
/// stiffness.
pub struct PointSpring<M> {
    pub marker: M,
    pub fixed: Vector3<f64>,
    /// N/m.
    pub stiffness: f64,
    /// Unstressed length, m.
    pub length: f64,
}

impl<M: Marker + Send> Force for PointSpring<M> {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let arm = self.marker.frame(motion).position - self.fixed;
        let mut columns = Columns::default();
        self.marker.columns(motion, &mut columns);
        let pull = -self.stiffness * (1.0 - self.length / arm.norm());
        columns.add_force(&(arm * pull), &Vector3::zeros(), force);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let stretch = (self.marker.frame(motion).position - self.fixed).norm() - self.length;
        0.5 * self.stiffness * stretch * stretch
    }
}

/// A constant moment about the third axis of a body, N·m.
pub struct Moment {
    pub pose: Pose,
    pub moment: f64,
}

impl Force for Moment {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        force[self.pose.rotation + 2] += self.moment;
    }
}

/// Sets the velocity of the centre of mass (m/s) and the angular velocity in body axes (rad/s).
pub fn set_velocity(state: &mut State, pose: &Pose, velocity: Vector3<f64>, omega_b: Vector3<f64>) {
    state.v[pose.translation..pose.translation + 3].copy_from_slice(velocity.as_slice());
    state.v[pose.rotation..pose.rotation + 3].copy_from_slice(omega_b.as_slice());
}

/// Continues from `state` in `steps` steps of `h` s; `after` sees each state. Accelerations at the start are found
/// first.
pub fn run(
    mechanism: &mut Mechanism,
    state: &mut State,
    (h, steps, rho_inf): (f64, usize, f64),
    options: NewtonOptions,
    after: &mut dyn FnMut(&State),
) {
    let mut integrator = GeneralizedAlpha::new(rho_inf, options);
    integrator.start_accelerations(mechanism, state, &[]).unwrap();
    for step in 1..=steps {
        integrator
            .step(mechanism, state, &[], step as f64 * h, h)
            .unwrap_or_else(|error| panic!("step {step} of {h} s: {error}"));
        after(state);
    }
}

/// Order between two errors at `h` and `h / 2`.
pub fn order(coarse: f64, fine: f64) -> f64 {
    (coarse / fine).log2()
}

/// Errors for reading.
pub fn shown(errors: &[f64]) -> String {
    let each: Vec<String> = errors.iter().map(|error| format!("{error:.2e}")).collect();
    each.join(" ")
}
