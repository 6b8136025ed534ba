use super::four_bar::FourBar;
use super::thesis::thesis;
use super::{AtRest, GRAVITY};
use crate::check::dense;
use crate::multibody::DeadForce;
use crate::pantograph::{Linkage, Pantograph};
use crate::{PantographModel, Placement, VehicleError};
use dynamics::rotation::log;
use dynamics::{Blocks, Constraint, Force, JacobianRows, Layout, Marker, Motion, State, Weights};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

fn linkage(entry: &scene::Linkage) -> (Linkage, Layout) {
    let mut layout = Layout::new();
    let linkage = Linkage::new(entry, GRAVITY, "pantograph", &mut layout).unwrap();
    (linkage, layout)
}

/// Largest joint residual, m or –.
fn gap(linkage: &Linkage, state: &State) -> f64 {
    let mut worst = 0.0_f64;
    for joint in linkage.joints() {
        let mut g = [0.0; 5];
        joint.residual(&state.motion(&[]), &mut g);
        worst = g.iter().fold(worst, |worst, g| worst.max(g.abs()));
    }
    worst
}

/// Contact force of the tabulated position with the uplift of 1465 N `distance` up the arm.
fn static_force(distance: f64) -> f64 {
    let mut entry = thesis();
    entry.uplift.distance = distance;
    linkage(&entry).0.static_force()
}

#[test]
fn the_uplift_at_the_middle_of_the_lower_arm_leaves_40_newtons_at_the_head() {
    // By virtual work on the same geometry, three digits.
    assert!((static_force(0.8) - 40.4).abs() < 0.1, "{}", static_force(0.8));
}

#[test]
fn the_uplift_of_the_scene_gives_the_mean_force_of_table_6() {
    assert!((static_force(0.9557) - 107.8).abs() < 0.1, "{}", static_force(0.9557));
}

#[test]
fn the_six_bodies_ask_for_306_newtons_at_the_head() {
    let mut entry = thesis();
    entry.uplift.force = 0.0;
    assert!((linkage(&entry).0.static_force() + 306.5).abs() < 0.1);
}

#[test]
fn the_suspension_carries_head_and_contact_force_in_the_tabulated_position() {
    let (linkage, layout) = linkage(&thesis());
    let carried = 9.50 * GRAVITY + linkage.static_force();
    assert!((linkage.suspension().preload - carried).abs() < 1e-9 * carried);
    let equilibrium = linkage.equilibrium_at_height(4.945).unwrap();
    assert!((equilibrium.force - linkage.static_force()).abs() < 1e-8);
    assert!(equilibrium.q.iter().all(|q| q.abs() < 1e-9));
    assert_eq!((layout.coordinates(), layout.constraints()), (36, 32));
}

#[test]
fn the_head_moves_as_the_plane_four_bar_says() {
    let (linkage, _) = linkage(&thesis());
    let rise = 1e-4;
    let side = |sign: f64| linkage.equilibrium_at_height(4.945 + sign * rise).unwrap();
    let (up, down) = (side(1.0), side(-1.0));
    let turned = log(&(down.rotation[0].inverse() * up.rotation[0])).norm();
    let plunger = |axis: usize| up.q[6 * 4 + axis] - down.q[6 * 4 + axis];
    let slope = FourBar::slope(0.0, |bar| bar.points[4][1]);
    assert!((plunger(2) / turned + slope).abs() < 1e-6); // central difference
    assert!((slope + 2.8756).abs() < 1e-4); // instantaneous centres of the tabulated position
    assert!((plunger(0) / plunger(2) - 0.13526).abs() < 1e-5);
}

#[test]
fn the_four_bar_stays_closed_through_the_working_range() {
    let (linkage, _) = linkage(&thesis());
    for step in 0..=24 {
        let height = 4.2 + 0.05 * f64::from(step);
        let equilibrium = linkage.equilibrium_at_height(height).unwrap();
        assert_eq!(equilibrium.height, height);
        let state = linkage.local_state(&equilibrium);
        assert!(gap(&linkage, &state) <= 1e-13, "{height}"); // rounding of metres
        let sideways = state.q.iter().skip(1).step_by(6);
        assert!(
            sideways.fold(0.0_f64, |worst, y| worst.max(y.abs())) < 1e-9,
            "leaves its plane at {height}"
        );
    }
}

#[test]
fn links_that_may_spin_freely_stay_as_they_are() {
    let (linkage, _) = linkage(&thesis());
    let equilibrium = linkage.equilibrium_at_height(4.6).unwrap();
    let start = linkage
        .local(crate::pantograph::BaseMount::Fixed)
        .unwrap()
        .1
        .state_at_rest();
    for link in [2, 3] {
        let turned = log(&(start.rotation[link].inverse() * equilibrium.rotation[link]));
        assert!(turned.y.abs() > 0.01, "the link follows the arm");
        assert!(turned.x.abs() < 1e-8 && turned.z.abs() < 1e-8, "{turned}"); // rounding over the regularisation
    }
}

#[test]
fn the_contact_force_follows_from_the_potential_of_the_plane_mechanism() {
    let (linkage, _) = linkage(&thesis());
    let preload = linkage.suspension().preload;
    for theta in [-0.13, -0.05, 0.0, 0.1, 0.2] {
        let bar = FourBar::at(theta, 0.9557);
        let slope = |quantity: fn(&FourBar) -> f64| FourBar::slope(theta, quantity);
        let (rise, tilting) = (slope(|bar| bar.points[4][1]), slope(|bar| bar.angles[4]));
        let released = -slope(|bar| bar.potential(1465.0));
        let (sine, cosine) = bar.angles[4].sin_cos();
        // The head is at 0.11 m + s along the plunger's axis. Fixed point of the balance along s and of that along
        // theta.
        let (mut s, mut carried) = (0.0, 0.0);
        for _ in 0..50 {
            carried = released / (rise - sine * tilting * (0.11 + s));
            s = (preload - carried * cosine) / 9430.0;
        }
        let height = bar.points[4][1] + cosine * (0.11 + s);
        let equilibrium = linkage.equilibrium_at_height(height).unwrap();
        let expected = carried - 9.50 * GRAVITY;
        // Central differences of the potential.
        assert!(
            (equilibrium.force - expected).abs() < 1e-4,
            "{theta}: {} {expected}",
            equilibrium.force
        );
    }
}

#[test]
fn force_and_height_of_an_equilibrium_belong_together() {
    let (linkage, _) = linkage(&thesis());
    // The force has its maximum at 4.72 m: below, another height has the same force.
    for height in [4.85, 4.945, 5.2] {
        let at_height = linkage.equilibrium_at_height(height).unwrap();
        let at_force = linkage.equilibrium_at_force(at_height.force).unwrap();
        // Residual over the stiffness of 15 to 25 N/m of the mechanism there.
        assert!((at_force.height - height).abs() < 1e-6, "{height}: {}", at_force.height);
    }
}

#[test]
fn a_force_beyond_the_mechanism_has_no_equilibrium() {
    let (linkage, _) = linkage(&thesis());
    let error = linkage.equilibrium_at_force(150.0).unwrap_err();
    assert!(matches!(error, VehicleError::NotConverged { .. }), "{error}");
    assert!(error.to_string().contains("contact force 150 N"), "{error}");
}

#[test]
fn names_that_do_not_fit_are_refused() {
    let build = |change: fn(&mut scene::Linkage)| {
        let mut entry = thesis();
        change(&mut entry);
        Linkage::new(&entry, GRAVITY, "pantograph", &mut Layout::new())
            .unwrap_err()
            .to_string()
    };
    assert!(build(|entry| entry.uplift.body = "arm".into()).contains("pantograph.uplift.body = \"arm\""));
    assert!(build(|entry| entry.uplift.body = "plunger".into()).contains("no joint with the base"));
    assert!(build(|entry| entry.strip.body = "lower_arm".into()).contains("0 prismatic joints"));
    assert!(build(|entry| entry.joints[1].first = "knee".into()).contains("joints.first = \"knee\""));
    assert!(build(|entry| drop(entry.joints.remove(5))).contains("not in balance"));
}

#[test]
fn the_strip_starts_where_it_is_placed_and_travels() {
    let mut layout = Layout::new();
    layout.add_coordinates(5, "something else");
    layout.add_constraints(3);
    let placement = Placement {
        start_x: 56.25,
        speed: 55.0,
        gravity: GRAVITY,
        one_motion: false,
        vehicle: None,
        track: None,
        duration: 0.0,
    };
    let entry = scene::PantographModel::Linkage(thesis());
    let mut model = PantographModel::new(&entry, placement, "pantograph 1", &mut layout).unwrap();
    assert_eq!(layout.name(5), "pantograph 1, lower_arm, translation, coordinate 1");
    let mut state = layout.state_at_rest();
    for height in [4.7, 5.1] {
        let equilibrium = model.equilibrium_at_height(height).unwrap();
        model.set_initial(&equilibrium, &mut state);
        let strip = model.strip();
        let frame = strip.frame(&state.motion(&[]));
        assert!((frame.position - nalgebra::Vector3::new(56.25, 0.0, height)).norm() < 1e-9);
        state.t = 2.0;
        let frame = strip.frame(&state.motion(&[]));
        assert!((frame.position.x - 166.25).abs() < 1e-9 && frame.velocity.x == 55.0);
        state.t = 0.0;
        // The part of the state belongs to the pantograph alone, and is at rest there.
        assert!(state.q[..5].iter().chain(&state.lambda[..3]).all(|&value| value == 0.0));
        let motion = state.motion(&[]);
        let mut unbalanced = vec![0.0; layout.coordinates()];
        model.forces(&mut |force| force.add_force(&motion, &mut unbalanced));
        let (mut first, lambda) = (3, &state.lambda);
        model.constraints(&mut |joint| {
            let mut sink = |row: usize, columns: &[usize], values: &[f64]| {
                for (&column, value) in columns.iter().zip(values) {
                    unbalanced[column] -= value * lambda[first + row];
                }
            };
            joint.jacobian(&motion, &mut JacobianRows::new(&mut sink));
            first += joint.dimension();
        });
        let mut columns = dynamics::Columns::default();
        strip.columns(&motion, &mut columns);
        columns.add_force(
            &nalgebra::Vector3::new(0.0, 0.0, -equilibrium.force),
            &nalgebra::Vector3::zeros(),
            &mut unbalanced,
        );
        assert!(unbalanced.iter().all(|force| force.abs() < 1e-6));
    }
}

/// Potential and mass matrix of the two coordinates: angle of the lower arm, suspension.
struct Reduced;

impl Reduced {
    /// x, z of the six centres of mass, then their angles.
    fn configuration(theta: f64, s: f64) -> DVector<f64> {
        let bar = FourBar::at(theta, 0.9557);
        let (sine, cosine) = bar.angles[4].sin_cos();
        let mut entries: Vec<f64> = bar.points.iter().flatten().copied().collect();
        entries.push(bar.points[4][0] - sine * (0.11 + s));
        entries.push(bar.points[4][1] + cosine * (0.11 + s));
        entries.extend(bar.angles);
        entries.push(bar.angles[4]);
        DVector::from_vec(entries)
    }

    fn height(theta: f64, s: f64) -> f64 {
        Self::configuration(theta, s)[11]
    }

    /// Derivatives at the tabulated position.
    fn rates() -> (DVector<f64>, DVector<f64>) {
        let h = 1e-5;
        let c = Self::configuration;
        (
            (c(h, 0.0) - c(-h, 0.0)) / (2.0 * h),
            (c(0.0, h) - c(0.0, -h)) / (2.0 * h),
        )
    }

    fn mass() -> Matrix2<f64> {
        let masses = [32.18, 15.60, 3.10, 1.15, 1.51, 9.50];
        let inertia = [10.43, 7.76, 0.46, 0.48, 0.05, 0.21];
        let weights: Vec<f64> = masses.iter().flat_map(|&m| [m, m]).chain(inertia).collect();
        let (theta, s) = Self::rates();
        let product = |a: &DVector<f64>, b: &DVector<f64>| -> f64 { (0..18).map(|i| weights[i] * a[i] * b[i]).sum() };
        let coupling = product(&theta, &s);
        Matrix2::new(product(&theta, &theta), coupling, coupling, product(&s, &s))
    }

    /// Squared frequencies with the strip on a spring of `contact` N/m that is unstretched at the tabulated height, and
    /// a dead load `force` on the strip.
    fn potential(theta: f64, s: f64, preload: f64, force: f64, contact: f64) -> f64 {
        let bar = FourBar::at(theta, 0.9557);
        let height = Self::height(theta, s);
        bar.potential(1465.0) + (9.50 * GRAVITY + force) * height + 0.5 * 9430.0 * s * s - preload * s
            + 0.5 * contact * (height - 4.945) * (height - 4.945)
    }

    fn hessian(preload: f64, force: f64, contact: f64) -> Matrix2<f64> {
        let v = |theta: f64, s: f64| Self::potential(theta, s, preload, force, contact);
        let h = 3e-4;
        let second = |f: &dyn Fn(f64) -> f64| (f(h) - 2.0 * f(0.0) + f(-h)) / (h * h);
        let mixed = (v(h, h) - v(h, -h) - v(-h, h) + v(-h, -h)) / (4.0 * h * h);
        Matrix2::new(second(&|x| v(x, 0.0)), mixed, mixed, second(&|x| v(0.0, x)))
    }
}

/// A vertical spring on the strip, unstretched at `height`.
pub(super) struct StripSpring {
    pub marker: Box<dyn Marker>,
    pub stiffness: f64,
    pub height: f64,
}

impl Force for StripSpring {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let mut columns = dynamics::Columns::default();
        self.marker.columns(motion, &mut columns);
        let lift = self.stiffness * (self.height - self.marker.frame(motion).position.z);
        columns.add_force(
            &nalgebra::Vector3::new(0.0, 0.0, lift),
            &nalgebra::Vector3::zeros(),
            force,
        );
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let mut columns = dynamics::Columns::default();
        self.marker.columns(motion, &mut columns);
        let columns = columns.as_slice();
        let indices: Vec<usize> = columns.iter().map(|column| column.index).collect();
        let z: Vec<f64> = columns.iter().map(|column| column.translation.z).collect();
        let k = weights.q * self.stiffness;
        let block: Vec<f64> = z.iter().flat_map(|a| z.iter().map(move |b| k * a * b)).collect();
        blocks.add(&indices, &indices, &block);
    }
}

/// Squared eigenfrequencies (1/s²) of the mechanism in the tabulated position with the strip on a spring: the motions
/// that the joints allow, in increasing order.
pub(super) fn eigenvalues(contact: f64) -> DVector<f64> {
    let (mut linkage, layout) = linkage(&thesis());
    let state = linkage.local_state(&linkage.equilibrium_at_height(4.945).unwrap());
    let (n, m) = (layout.coordinates(), layout.constraints());
    let motion = state.motion(&[]);
    let mut spring = StripSpring {
        marker: Box::new(linkage.strip_marker()),
        stiffness: contact,
        height: 4.945,
    };
    let mut weight = linkage.vertical_force_on_strip(-linkage.static_force());
    let weights = Weights { q: 1.0, v: 0.0 };
    let joints = linkage.joints().to_vec();
    let stiffness = dense(n, &mut |blocks| {
        linkage.forces(&mut |force| force.add_tangent(&motion, weights, blocks));
        spring.add_tangent(&motion, weights, blocks);
        weight.add_tangent(&motion, weights, blocks);
        let mut first = 0;
        for joint in &joints {
            joint.add_geometric_stiffness(&motion, &state.lambda[first..], blocks);
            first += joint.dimension();
        }
    });
    let mass = dense(n, &mut |blocks| linkage.forces(&mut |force| force.add_mass(blocks)));
    let mut g_q = DMatrix::<f64>::zeros(m, n);
    let mut first = 0;
    linkage.constraints(&mut |joint| {
        let mut sink = |row: usize, columns: &[usize], values: &[f64]| {
            for (&column, value) in columns.iter().zip(values) {
                g_q[(first + row, column)] += value;
            }
        };
        joint.jacobian(&motion, &mut JacobianRows::new(&mut sink));
        first += joint.dimension();
    });
    // Null space of g_q.
    let gram = (g_q.transpose() * &g_q).symmetric_eigen();
    let free: Vec<DVector<f64>> = (0..n)
        .filter(|&i| gram.eigenvalues[i] < 1e-9)
        .map(|i| gram.eigenvectors.column(i).into_owned())
        .collect();
    assert_eq!(free.len(), 4, "mechanism, suspension, and two links that spin");
    let free = DMatrix::from_columns(&free);
    let (mass, stiffness): (DMatrix<f64>, DMatrix<f64>) =
        (free.transpose() * mass * &free, free.transpose() * stiffness * &free);
    let root = mass.cholesky().unwrap().l().try_inverse().unwrap();
    let standard = &root * stiffness * root.transpose();
    let mut values = ((&standard + standard.transpose()) * 0.5).symmetric_eigenvalues();
    values.as_mut_slice().sort_by(f64::total_cmp);
    values
}

#[test]
fn the_eigenfrequencies_are_those_of_the_two_coordinate_model() {
    let (linkage, _) = linkage(&thesis());
    let full = eigenvalues(5e4);
    let root = Reduced::mass().cholesky().unwrap().l().try_inverse().unwrap();
    let stiffness = Reduced::hessian(linkage.suspension().preload, linkage.static_force(), 5e4);
    let mut reduced = (root * stiffness * root.transpose()).symmetric_eigenvalues();
    reduced.as_mut_slice().sort_by(f64::total_cmp);
    assert!(
        full[0].abs() < 1e-6 && full[1].abs() < 1e-6,
        "spinning links have no stiffness: {full}"
    );
    for i in 0..2 {
        // Second differences of the plane model over 3e-4.
        assert!((full[2 + i] / reduced[i] - 1.0).abs() < 1e-5, "{full} {reduced}");
    }
}

#[test]
fn loads_accelerate_the_mechanism_as_its_effective_masses_say() {
    let entry = scene::PantographModel::Linkage(thesis());
    let mut layout = Layout::new();
    let placement = Placement {
        start_x: 0.0,
        speed: 50.0,
        gravity: GRAVITY,
        one_motion: false,
        vehicle: None,
        track: None,
        duration: 0.0,
    };
    let mut model = PantographModel::new(&entry, placement, "pantograph", &mut layout).unwrap();
    let mut state = layout.state_at_rest();
    let equilibrium = model.equilibrium_at_height(4.945).unwrap();
    model.set_initial(&equilibrium, &mut state);
    // The contact force is gone, and the lower arm is lifted by another 100 N.
    let lift = DeadForce {
        marker: model.linkage().unwrap().body_marker("lower_arm").unwrap(),
        force: nalgebra::Vector3::new(0.0, 0.0, 100.0),
    };
    let mut alone = super::Alone {
        layout,
        model,
        loads: vec![Box::new(lift)],
    };
    dynamics::GeneralizedAlpha::new(0.9, dynamics::NewtonOptions::default())
        .start_accelerations(&mut alone, &mut state, &[])
        .unwrap();
    let (theta, s) = Reduced::rates();
    let released = Vector2::new(theta[11], s[11]) * equilibrium.force;
    let lifted = Vector2::new(theta[1], 0.0) * 100.0;
    let expected = Reduced::mass().try_inverse().unwrap() * (released + lifted);
    for (body, z) in [(0, 1), (1, 3), (2, 5), (3, 7), (4, 9), (5, 11)] {
        let acceleration = theta[z] * expected.x + s[z] * expected.y;
        let full = state.v_dot[6 * body + 2];
        // Central differences of the plane model.
        assert!((full / acceleration - 1.0).abs() < 1e-7, "{full} {acceleration}");
    }
}
