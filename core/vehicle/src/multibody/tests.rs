use super::*;
use crate::check::{assert_driven, assert_energy, assert_law, assert_tangent, awkward, dense, jacobian, tilted};
use dynamics::{Constraint, JacobianRows, Layout, Marker, State};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Two bodies in skew positions.
struct Two {
    layout: Layout,
    poses: [Pose; 2],
}

fn two() -> Two {
    let mut layout = Layout::new();
    let first = Pose::new(Vector3::new(0.3, -0.2, 1.0), tilted(0.1), "first", &mut layout);
    let second = Pose::new(Vector3::new(1.1, 0.4, 0.7), tilted(-0.5), "second", &mut layout);
    Two {
        layout,
        poses: [first, second],
    }
}

impl Two {
    fn anchor(&self, body: usize) -> Anchor {
        Anchor::Body(BodyMarker::at(
            self.poses[body],
            &tilted([0.1, -0.5][body]),
            &Vector3::new(0.6, 0.1, 0.9),
            &tilted(0.7).to_rotation_matrix().into_inner(),
        ))
    }

    fn base() -> Anchor {
        Anchor::Base(BaseMarker {
            position: Vector3::new(0.6, 0.1, 0.9),
            axes: tilted(0.7).to_rotation_matrix().into_inner(),
        })
    }

    fn joints(&self) -> Vec<Joint> {
        let kinds = [Joint::spherical, Joint::revolute, Joint::prismatic];
        let ends = [
            (self.anchor(0), self.anchor(1)),
            (self.anchor(1), self.anchor(0)),
            (Self::base(), self.anchor(1)),
            (self.anchor(0), Self::base()),
        ];
        kinds
            .iter()
            .flat_map(|joint| ends.clone().map(|(first, second)| joint(first, second)))
            .collect()
    }
}

fn residual(joint: &Joint, state: &State) -> DVector<f64> {
    let mut g = DVector::zeros(joint.dimension());
    joint.residual(&state.motion(&[]), g.as_mut_slice());
    g
}

fn g_q(joint: &Joint, state: &State) -> DMatrix<f64> {
    let mut g_q = DMatrix::zeros(joint.dimension(), state.q.len());
    let mut sink = |row: usize, columns: &[usize], values: &[f64]| {
        for (&column, &value) in columns.iter().zip(values) {
            g_q[(row, column)] += value;
        }
    };
    joint.jacobian(&state.motion(&[]), &mut JacobianRows::new(&mut sink));
    g_q
}

#[test]
fn joints_hold_in_the_position_they_were_built_in() {
    let two = two();
    for joint in two.joints() {
        // Rounding of positions of about a metre.
        assert!(residual(&joint, &two.layout.state_at_rest()).amax() < 1e-15);
    }
}

#[test]
fn each_joint_leaves_its_own_motion_free() {
    let two = two();
    let rest = two.layout.state_at_rest();
    for (joint, rank) in two.joints().iter().zip([3, 3, 3, 3, 5, 5, 5, 5, 5, 5, 5, 5]) {
        assert_eq!(joint.dimension(), rank);
        assert_eq!(g_q(joint, &rest).rank(1e-9), rank);
    }
}

#[test]
fn the_jacobian_of_a_joint_is_the_derivative_of_its_residual() {
    let two = two();
    let state = awkward(&two.layout);
    for joint in two.joints() {
        let difference = jacobian(&two.layout, &state, &mut |state| residual(&joint, state));
        let error = (difference - g_q(&joint, &state)).amax();
        assert!(error < 1e-9, "{error}"); // h² and rounding / h
    }
}

#[test]
fn the_velocity_terms_of_a_joint_are_the_rate_of_its_rate_at_constant_velocities() {
    let two = two();
    let state = awkward(&two.layout);
    let v = DVector::from_column_slice(&state.v);
    for joint in two.joints() {
        // (g_q v)_q v
        let difference = jacobian(&two.layout, &state, &mut |state| g_q(&joint, state) * &v) * &v;
        let mut terms = DVector::zeros(joint.dimension());
        assert!(joint.add_velocity_terms(&state.motion(&[]), terms.as_mut_slice()));
        assert!(terms.amax() > 0.1 && (&difference - &terms).amax() < 1e-7 * terms.amax());
    }
}

#[test]
fn the_geometric_stiffness_is_the_derivative_of_the_joint_forces() {
    let two = two();
    let state = awkward(&two.layout);
    let lambda = DVector::from_vec(vec![40.0, -25.0, 60.0, 33.0, -12.0]);
    for joint in two.joints() {
        let lambda = lambda.rows(0, joint.dimension()).into_owned();
        let difference = jacobian(&two.layout, &state, &mut |state| {
            g_q(&joint, state).transpose() * &lambda
        });
        let exact = dense(two.layout.coordinates(), &mut |blocks| {
            joint.add_geometric_stiffness(&state.motion(&[]), lambda.as_slice(), blocks);
        });
        let error = (difference - &exact).amax();
        assert!(error < 1e-7 * exact.amax(), "{error}");
    }
}

fn body(two: &Two) -> RigidBody {
    RigidBody {
        pose: two.poses[1],
        mass: 3.0,
        inertia: Vector3::new(0.4, 1.1, 0.8),
        gravity: 9.81,
    }
}

#[test]
fn the_tangent_of_a_body_is_the_derivative_of_its_gyroscopic_moment() {
    let two = two();
    let (mut body, state) = (body(&two), awkward(&two.layout));
    assert_law(&mut body, &two.layout, &state);
}

#[test]
fn the_gyroscopic_moment_does_no_work() {
    let two = two();
    let (body, state) = (body(&two), awkward(&two.layout));
    let mut weightless = RigidBody { gravity: 0.0, ..body };
    let force = crate::check::force(&mut weightless, &state.motion(&[]));
    let power = force.dot(&DVector::from_column_slice(&state.v));
    assert!(power.abs() < 1e-14 && force.amax() > 0.1);
}

#[test]
fn the_tangent_of_a_guided_spring_is_the_derivative_of_its_force() {
    let two = two();
    let state = awkward(&two.layout);
    for (first, second) in [
        (two.anchor(0), two.anchor(1)),
        (Two::base(), two.anchor(1)),
        (two.anchor(1), Two::base()),
    ] {
        let mut spring = AxialSpring {
            pair: Pair { first, second },
            stiffness: 900.0,
            damping: 35.0,
            preload: 120.0,
        };
        assert_tangent(&mut spring, &two.layout, &state, &[]);
        spring.damping = 0.0;
        assert_energy(&mut spring, &two.layout, &state);
    }
}

#[test]
fn the_tangent_of_a_dead_force_is_the_derivative_of_its_force() {
    let two = two();
    let Anchor::Body(marker) = two.anchor(1) else {
        unreachable!()
    };
    let mut load = DeadForce {
        marker,
        force: Vector3::new(20.0, -50.0, 110.0),
    };
    let state = awkward(&two.layout);
    assert_law(&mut load, &two.layout, &state);
}

#[test]
fn the_tangent_and_the_power_of_a_drive_are_those_of_its_force() {
    let two = two();
    let Anchor::Body(marker) = two.anchor(1) else {
        unreachable!()
    };
    let mut drive = DriveForce::new(marker, 1);
    let (state, u) = (awkward(&two.layout), [0.0, 70.0]);
    assert_tangent(&mut drive, &two.layout, &state, &u);
    assert_driven(&mut drive, &state, &u);
}

#[test]
fn the_tangent_and_the_power_of_a_moment_in_a_joint_are_those_of_its_force() {
    let two = two();
    let (state, u) = (awkward(&two.layout), [0.0, 70.0]);
    for anchors in [
        [two.anchor(0), two.anchor(1)],
        [Two::base(), two.anchor(1)],
        [two.anchor(1), Two::base()],
    ] {
        for sense in [1.0, -1.0] {
            let mut moment = JointMoment::new(anchors.clone(), sense, 1);
            assert_driven(&mut moment, &state, &u);
            // About an axis of the one body that turns, the moment is constant in the directions of the body.
            if !matches!(anchors[1], Anchor::Base(_)) {
                assert_tangent(&mut moment, &two.layout, &state, &u);
            }
        }
    }
}

/// Top of a short head with horns.
fn top() -> dynamics::MonotoneCubic {
    scene::Horns {
        y: vec![0.15, 0.4],
        z: vec![-0.02, -0.2],
    }
    .top(0.1)
}

#[test]
fn the_tangent_of_the_contact_force_is_the_derivative_of_its_force() {
    let two = two();
    let Anchor::Body(marker) = two.anchor(1) else {
        unreachable!()
    };
    let mut load = AppliedForce {
        marker: Box::new(BodyMarker {
            axes: Matrix3::identity(),
            ..marker
        }),
        first: 2,
        top: None,
    };
    let state = awkward(&two.layout);
    let u = [0.0, 0.0, 5.0, -3.0, -110.0, 0.25];
    assert_tangent(&mut load, &two.layout, &state, &u);
    load.top = Some(top());
    let frame = load.marker.frame(&state.motion(&u));
    let lever = load.lever(&frame, &state.motion(&u));
    assert!(lever.dot(&frame.axes.column(2)) < -0.01, "on the horn: {lever}");
    assert!((frame.position.y + lever.y - 0.25).abs() < 1e-12);
    assert_tangent(&mut load, &two.layout, &state, &u);
}

#[test]
fn the_contact_force_acts_where_the_strip_passes_its_lateral_position() {
    let two = two();
    let marker = BodyMarker {
        pose: two.poses[0],
        offset: Vector3::new(0.1, 0.0, 0.2),
        axes: Matrix3::identity(),
    };
    let state = awkward(&two.layout);
    let motion = state.motion(&[]);
    let frame = marker.frame(&motion);
    let point = frame.position + frame.axes * Vector3::new(0.0, 0.4, 0.0);
    let mut load = AppliedForce {
        marker: Box::new(marker),
        first: 0,
        top: None,
    };
    let u = [3.0, -2.0, -100.0, point.y];
    let force = crate::check::force(&mut load, &state.motion(&u));
    // Power of the force at that point of the body.
    let velocity = frame.velocity + frame.angular_velocity.cross(&(point - frame.position));
    let power = velocity.dot(&Vector3::new(u[0], u[1], u[2]));
    assert!((force.dot(&DVector::from_column_slice(&state.v)) - power).abs() < 1e-12 * power.abs());
}

#[test]
fn the_columns_of_a_marker_give_its_velocity() {
    let two = two();
    let Anchor::Body(marker) = two.anchor(1) else {
        unreachable!()
    };
    let state = awkward(&two.layout);
    let motion = state.motion(&[]);
    let mut columns = dynamics::Columns::default();
    marker.columns(&motion, &mut columns);
    let frame = marker.frame(&motion);
    let (mut velocity, mut angular) = (Vector3::zeros(), Vector3::zeros());
    for column in columns.as_slice() {
        velocity += column.translation * state.v[column.index];
        angular += column.rotation * state.v[column.index];
    }
    assert!((velocity - frame.velocity).norm() < 1e-14 && (angular - frame.angular_velocity).norm() < 1e-14);
    // Velocity is the rate of the position, too.
    let position = |state: &State| DVector::from_column_slice(marker.frame(&state.motion(&[])).position.as_slice());
    let rate = jacobian(&two.layout, &state, &mut |state| position(state)) * DVector::from_column_slice(&state.v);
    assert!((rate - DVector::from_column_slice(frame.velocity.as_slice())).amax() < 1e-8);
}
