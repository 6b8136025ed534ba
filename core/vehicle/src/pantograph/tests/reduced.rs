//! The linkage in two coordinates against the full mechanism of six bodies and eight joints.
use super::four_bar::FourBar;
use super::linkage::StripSpring;
use super::thesis::thesis;
use super::{AtRest, GRAVITY};
use crate::check::{assert_driven, assert_law, assert_tangent, dense};
use crate::pantograph::{Linkage, Pantograph, ReducedLinkage};
use crate::{PantographModel, Placement, VehicleError};
use control::Reading;
use dynamics::{GeneralizedAlpha, Layout, Marker, NewtonOptions, State, rotation};
use nalgebra::{DVector, Matrix2, Vector3};

/// The thesis' mechanism with its strip beside the centre of mass and a suspension that leans.
fn leaning() -> scene::Linkage {
    let mut entry = thesis();
    entry.strip.offset = [0.12, 0.05, 0.07];
    let guide = entry.joints.last_mut().unwrap();
    guide.kind = scene::JointKind::Prismatic {
        axis: [-0.6, 0.0, -2.0],
    };
    entry
}

fn both() -> [scene::Linkage; 2] {
    [thesis(), leaning()]
}

fn reduced(entry: &scene::Linkage) -> (ReducedLinkage, Layout) {
    let mut layout = Layout::new();
    let linkage = ReducedLinkage::new(entry, GRAVITY, "pantograph", &mut layout).unwrap();
    (linkage, layout)
}

fn full(entry: &scene::Linkage) -> Linkage {
    Linkage::new(entry, GRAVITY, "pantograph", &mut Layout::new()).unwrap()
}

/// A state of the two coordinates.
fn state(layout: &Layout, q: [f64; 2], v: [f64; 2]) -> State {
    let mut state = layout.state_at_rest();
    state.q.copy_from_slice(&q);
    state.v.copy_from_slice(&v);
    state
}

/// The same state of the full mechanism; velocities by central differences of the fourth order over 1e-3, error 1e-11.
fn in_full(linkage: &ReducedLinkage, layout: &Layout, at: &State) -> State {
    let h = 1e-3;
    let shifted = |steps: f64| {
        let moved = [0, 1].map(|i| at.q[i] + steps * h * at.v[i]);
        linkage.configuration(&state(layout, moved, [0.0; 2]).motion(&[]))
    };
    let (q, orientations) = shifted(0.0);
    let mut full = State::at_rest(q.len(), 32, orientations.clone());
    full.q.copy_from_slice(&q);
    for (sign, weight, distance) in [(1.0, 8.0, 1.0), (-1.0, -8.0, 1.0), (1.0, -1.0, 2.0), (-1.0, 1.0, 2.0)] {
        let (q, turned) = shifted(sign * distance);
        let weight = weight / (12.0 * h);
        for (v, q) in full.v.iter_mut().zip(&q) {
            *v += weight * q;
        }
        for (body, (turned, still)) in turned.iter().zip(&orientations).enumerate() {
            let turn = rotation::log(&(still.inverse() * turned));
            for axis in 0..3 {
                full.v[6 * body + 3 + axis] += weight * turn[axis];
            }
        }
    }
    full
}

#[test]
fn statics_are_those_of_the_full_mechanism() {
    for entry in both() {
        let (reduced, _) = reduced(&entry);
        let full = full(&entry);
        assert!((reduced.static_force() - full.static_force()).abs() < 1e-9);
        // A guide that points down has its force the other way round.
        assert!((reduced.preload() - full.suspension().preload.abs()).abs() < 1e-9);
        assert!((reduced.strip_at([0.0; 2]) - full.reference_strip_position()).norm() < 1e-12);
        let top = full.reference_height();
        for step in -14..=8 {
            let height = top + 0.05 * f64::from(step);
            let (ours, theirs) = (
                reduced.equilibrium_at_height(height).unwrap(),
                full.equilibrium_at_height(height).unwrap(),
            );
            assert_eq!(ours.height, height);
            // Newton's tolerance of the full mechanism.
            assert!(
                (ours.force - theirs.force).abs() < 1e-6,
                "{height}: {} {}",
                ours.force,
                theirs.force
            );
            assert!(
                (reduced.strip_position(&ours) - full.strip_position(&theirs)).norm() < 1e-10,
                "{height}"
            );
        }
    }
}

#[test]
fn the_bodies_on_the_curve_keep_every_joint_closed() {
    for entry in both() {
        let (reduced, layout) = reduced(&entry);
        let mut full = full(&entry);
        for step in -60..=40 {
            // Steps that fall between the nodes.
            let at = state(&layout, [0.0317 * f64::from(step), 0.00731 * f64::from(step)], [0.0; 2]);
            let same = in_full(&reduced, &layout, &at);
            let mut worst = 0.0_f64;
            full.constraints(&mut |joint| {
                let mut g = [0.0; 5];
                joint.residual(&same.motion(&[]), &mut g);
                worst = g.iter().fold(worst, |worst, g| worst.max(g.abs()));
            });
            assert!(worst < 1e-10, "{step}: {worst} m");
            let (ours, theirs) = (
                reduced.strip_marker().frame(&at.motion(&[])),
                full.strip_marker().frame(&same.motion(&[])),
            );
            assert!((ours.position - theirs.position).norm() < 1e-10);
            assert!((ours.axes - theirs.axes).norm() < 1e-10);
        }
    }
}

#[test]
fn energies_are_those_of_the_full_mechanism() {
    for entry in both() {
        let (reduced, layout) = reduced(&entry);
        let mut full = full(&entry);
        for (q, v) in [
            ([0.3, 0.06], [2.0, -0.4]),
            ([-0.8, -0.2], [-1.0, 1.5]),
            ([0.01, 0.03], [0.7, 0.2]),
        ] {
            let at = state(&layout, q, v);
            let same = in_full(&reduced, &layout, &at);
            let motion = same.motion(&[]);
            let kinetic: f64 = full.bodies().iter().map(|body| body.kinetic_energy(&motion)).sum();
            let mut potential = 0.0;
            full.forces(&mut |force| potential += force.energy(&motion));
            let ours = reduced.kinetic_energy(&at.motion(&[]));
            assert!((ours / kinetic - 1.0).abs() < 1e-8, "{ours} {kinetic}");
            let ours = dynamics::Force::energy(&reduced, &at.motion(&[]));
            assert!((ours - potential).abs() < 1e-8 * potential.abs(), "{ours} {potential}");
            let (ours, theirs) = (
                reduced.strip_marker().frame(&at.motion(&[])),
                full.strip_marker().frame(&motion),
            );
            assert!((ours.velocity - theirs.velocity).norm() < 1e-8);
            assert!((ours.angular_velocity - theirs.angular_velocity).norm() < 1e-8);
        }
    }
}

#[test]
fn forces_have_their_tangent_and_potential() {
    for entry in both() {
        let (mut reduced, layout) = reduced(&entry);
        // The derivative of the velocity's own inertia forces with respect to position is left out: none at rest.
        for q in [[0.3, 0.06], [-0.8, -0.2]] {
            let at = state(&layout, q, [0.0; 2]);
            assert_law(&mut reduced, &layout, &at);
        }
    }
}

/// State with the force of the drive as its only input.
const DRIVE: [f64; 1] = [70.0];

/// Joints of the thesis' mechanism that raise the strip, and the raising force's point.
fn drives() -> [scene::Actuator; 4] {
    let on = |joint: Option<&str>| scene::Actuator {
        joint: joint.map(str::to_owned),
        ..scene::Actuator::default()
    };
    [
        on(None),
        on(Some("base-lower_arm")),
        on(Some("lower_arm-upper_arm")),
        on(Some("upper_arm-plunger")),
    ]
}

#[test]
fn the_drive_acts_as_on_the_full_mechanism_and_has_its_tangent() {
    for (entry, actuator) in both()
        .iter()
        .flat_map(|entry| drives().map(|actuator| (entry.clone(), actuator)))
    {
        let (mut reduced, layout) = reduced(&entry);
        let mut full = full(&entry);
        reduced.drive_by(&actuator, 0).unwrap();
        full.drive_by(&actuator, 0).unwrap();
        for (q, v) in [([0.3, 0.06], [2.0, -0.4]), ([-0.8, -0.2], [-1.0, 1.5])] {
            let at = state(&layout, q, v);
            let same = in_full(&reduced, &layout, &at);
            let [mut ours, mut theirs] = [Reading::default(), Reading::default()];
            reduced.read(&at.motion(&DRIVE), &mut ours);
            full.read(&same.motion(&DRIVE), &mut theirs);
            assert!((ours.driven_place - theirs.driven_place).abs() < 1e-10);
            assert!(
                (ours.driven - theirs.driven).abs() < 1e-8,
                "{} {}",
                ours.driven,
                theirs.driven
            );
            let mut drives = 0;
            reduced.parts(&mut |_, force| {
                if let Some(power) = force.power(&at.motion(&DRIVE)).filter(|power| power.driven != 0.0) {
                    assert!((power.driven - DRIVE[0] * theirs.driven).abs() < 1e-6);
                    assert_tangent(force, &layout, &at, &DRIVE);
                    assert_driven(force, &at, &DRIVE);
                    drives += 1;
                }
            });
            assert_eq!(drives, 1);
        }
    }
}

/// Generalised force of a unit of the drive on the one motion.
fn along_motion(entry: &scene::Linkage, actuator: &scene::Actuator, q: [f64; 2]) -> f64 {
    let (mut linkage, layout) = reduced(entry);
    let at = state(&layout, q, [0.0; 2]);
    let without = crate::check::force(&mut linkage, &at.motion(&[]));
    linkage.drive_by(actuator, 0).unwrap();
    let mut sum = DVector::zeros(2);
    linkage.parts(&mut |_, force| force.add_force(&at.motion(&[1.0]), sum.as_mut_slice()));
    (sum - without)[0]
}

#[test]
fn a_moment_on_a_joint_does_what_a_vertical_force_does_by_its_transmission() {
    let entry = thesis();
    let [force, base, knee, _] = drives();
    for q in [[0.0, 0.0], [0.3, 0.06], [-0.8, -0.2]] {
        let (linkage, layout) = reduced(&entry);
        let same = in_full(&linkage, &layout, &state(&layout, q, [0.0; 2]));
        let motion = same.motion(&[]);
        let full = full(&entry);
        // On the joint with the base: the lever of the raising force. The base is at x = 0.
        let lever = full.uplift_marker().frame(&motion).position.x.abs();
        let by_force = along_motion(&entry, &force, q);
        let by_base = along_motion(&entry, &base, q);
        // Difference of forces of a kilonewton, and curves to 1e-12 m.
        assert!(
            (by_force / by_base / lever - 1.0).abs() < 1e-8,
            "{by_force} {by_base} {lever}"
        );
        // Between the arms: plane trigonometry of the four-bar, by differences.
        let arm = full.bodies()[0].pose.orientation;
        let turned = rotation::log(&(same.rotation[arm] * full.orientation(0).inverse()));
        let theta = -turned.y;
        let [at_knee, raised] = [
            FourBar::slope(theta, |bar| bar.angles[1] - bar.angles[0]),
            FourBar::slope(theta, |bar| bar.uplift[1]),
        ];
        let found = along_motion(&entry, &knee, q) / by_force;
        let expected = (at_knee / raised).abs();
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }
}

#[test]
fn a_moment_on_a_joint_bears_the_contact_force_of_virtual_work() {
    let full = full(&thesis());
    let rise = FourBar::slope(0.0, |bar| bar.points[4][1]);
    for (number, turn) in [
        (0, 1.0),
        (1, FourBar::slope(0.0, |bar| bar.angles[1] - bar.angles[0])),
        (2, FourBar::slope(0.0, |bar| bar.angles[4] - bar.angles[1])),
    ] {
        // The axes of the thesis point to the left, about which a turn in the x–z plane counts the other way round.
        let (found, expected) = (full.borne_by(number).unwrap(), -turn / rise);
        assert!((found / expected - 1.0).abs() < 1e-6, "{number}: {found} {expected}");
    }
    for name in ["base-upper_arm", "base-lower_link"] {
        let error = full.moment_on(name, 0).unwrap_err();
        assert!(matches!(error, VehicleError::UnknownJoint { .. }), "{name}: {error}");
    }
}

/// Accelerations under loads.
fn accelerations(model: PantographModel, layout: Layout, mut state: State, lift: f64) -> State {
    let spring = StripSpring {
        marker: model.strip(),
        stiffness: 5e4,
        height: model.reference_height() + lift,
    };
    let mut alone = super::Alone {
        layout,
        model,
        loads: vec![Box::new(spring)],
    };
    GeneralizedAlpha::new(0.9, NewtonOptions::default())
        .start_accelerations(&mut alone, &mut state, &[])
        .unwrap();
    state
}

fn model(entry: &scene::Linkage, one_motion: bool) -> (PantographModel, Layout) {
    let mut layout = Layout::new();
    let placement = Placement {
        start_x: 3.0,
        speed: 50.0,
        gravity: GRAVITY,
        one_motion,
        vehicle: None,
        track: None,
        duration: 0.0,
    };
    let entry = scene::PantographModel::Linkage(entry.clone());
    let model = PantographModel::new(&entry, placement, "pantograph", &mut layout).unwrap();
    (model, layout)
}

/// Fast motion too: the terms with squares of velocities.
#[test]
fn accelerations_are_those_of_the_full_mechanism() {
    for entry in both() {
        for (height, v) in [(4.7, [2.0, -0.4]), (4.98, [-3.0, 2.5]), (5.2, [0.0, 0.0])] {
            let (mut ours, layout) = model(&entry, true);
            let mut at = layout.state_at_rest();
            let equilibrium = ours.equilibrium_at_height(height).unwrap();
            ours.set_initial(&equilibrium, &mut at);
            at.v.copy_from_slice(&v);
            let at = accelerations(ours, layout, at, 0.01);

            let (theirs, full_layout) = model(&entry, false);
            let (small, small_layout) = reduced(&entry);
            let same = in_full(&small, &small_layout, &at);
            let same = accelerations(theirs, full_layout, same, 0.01);

            // The full acceleration from the two coordinates: q̈ᵢ = rate of the mapped velocity along (v, v̇).
            let h = 1e-4;
            let side = |sign: f64| {
                let step = |x: f64, v: f64, a: f64| x + sign * h * v + 0.5 * h * h * a;
                let q = [0, 1].map(|i| step(at.q[i], at.v[i], at.v_dot[i]));
                let v = [0, 1].map(|i| at.v[i] + sign * h * at.v_dot[i]);
                in_full(&small, &small_layout, &state(&small_layout, q, v)).v
            };
            let (ahead, behind) = (side(1.0), side(-1.0));
            for i in 0..36 {
                let ours = (ahead[i] - behind[i]) / (2.0 * h);
                // Differences over 1e-4 s (here) and 1e-6 s (constraints of the full mechanism).
                let size = same.v_dot.iter().fold(0.0_f64, |worst, a| worst.max(a.abs()));
                assert!(
                    (ours - same.v_dot[i]).abs() < 2e-6 * size,
                    "{height}, {i}: {ours} {}, largest {size}",
                    same.v_dot[i]
                );
            }
        }
    }
}

#[test]
fn eigenfrequencies_are_those_of_the_full_mechanism() {
    let (mut reduced, layout) = reduced(&thesis());
    let at = layout.state_at_rest();
    let motion = at.motion(&[]);
    let mut spring = StripSpring {
        marker: Box::new(reduced.strip_marker()),
        stiffness: 5e4,
        height: 4.945,
    };
    let weights = dynamics::Weights { q: 1.0, v: 0.0 };
    let stiffness = dense(2, &mut |blocks| {
        dynamics::Force::add_tangent(&mut reduced, &motion, weights, blocks);
        dynamics::Force::add_tangent(&mut spring, &motion, weights, blocks);
    });
    let mass = dense(2, &mut |blocks| dynamics::Force::add_mass(&reduced, blocks));
    let fixed = |m: &nalgebra::DMatrix<f64>| Matrix2::new(m[(0, 0)], m[(0, 1)], m[(1, 0)], m[(1, 1)]);
    let root = fixed(&mass).cholesky().unwrap().l().try_inverse().unwrap();
    let mut ours = (root * fixed(&stiffness) * root.transpose()).symmetric_eigenvalues();
    ours.as_mut_slice().sort_by(f64::total_cmp);
    let theirs = super::linkage::eigenvalues(5e4);
    for i in 0..2 {
        assert!((ours[i] / theirs[2 + i] - 1.0).abs() < 1e-8, "{ours} {theirs}");
    }
}

/// Strip pushed sideways and pressed down beside the middle: the joints bear the load.
#[test]
fn lateral_forces_and_rolling_moments_move_nothing() {
    let run = |one_motion: bool, u: [f64; 4], h: f64| {
        let (mut model, layout) = model(&thesis(), one_motion);
        let mut state = layout.state_at_rest();
        let equilibrium = model.equilibrium_at_height(4.9).unwrap();
        model.set_initial(&equilibrium, &mut state);
        let strip = model.strip();
        let load = model.applied_force(0);
        let mut alone = super::Alone {
            layout,
            model,
            loads: vec![Box::new(load)],
        };
        let mut integrator = GeneralizedAlpha::new(0.9, NewtonOptions::default());
        integrator.start_accelerations(&mut alone, &mut state, &u).unwrap();
        for step in 1..=(0.1 / h).round() as usize {
            integrator.step(&mut alone, &mut state, &u, step as f64 * h, h).unwrap();
        }
        strip.frame(&state.motion(&u))
    };
    let difference =
        |a: &dynamics::Frame, b: &dynamics::Frame| (a.position - b.position).norm().max((a.axes - b.axes).norm());
    let pressed = [15.0, 0.0, -190.0, 0.0];
    let pushed = [15.0, 60.0, -190.0, 0.35];
    let (plain, loaded) = (run(false, pressed, 1e-3), run(false, pushed, 1e-3));
    assert!((plain.position - Vector3::new(8.0, 0.0, 4.9)).norm() > 0.01, "it moves");
    assert!(difference(&plain, &loaded) < 1e-9, "{}", difference(&plain, &loaded)); // rounding, Newton's tolerance
    // Against the reduced one two second-order schemes differ by h²; half the step, a quarter.
    let ours = run(true, pushed, 1e-3);
    let coarse = difference(&ours, &loaded);
    let fine = difference(&run(true, pushed, 5e-4), &run(false, pushed, 5e-4));
    assert!(coarse < 1e-6 && fine < 0.3 * coarse + 1e-10, "{coarse} {fine}");
}

#[test]
fn the_drawing_is_that_of_the_full_mechanism() {
    let (mut ours, layout) = model(&thesis(), true);
    let (mut theirs, full_layout) = model(&thesis(), false);
    assert_eq!((layout.coordinates(), layout.constraints()), (2, 0));
    let (mut at, mut same) = (layout.state_at_rest(), full_layout.state_at_rest());
    for height in [4.6, 5.1] {
        let equilibrium = ours.equilibrium_at_height(height).unwrap();
        ours.set_initial(&equilibrium, &mut at);
        theirs.set_initial(&theirs.equilibrium_at_height(height).unwrap(), &mut same);
        assert!((ours.base().start_x - theirs.base().start_x).abs() < 1e-10);
        let (ours, theirs) = (ours.outline(&at.motion(&[])), theirs.outline(&same.motion(&[])));
        assert_eq!(ours.len(), 6);
        for (ours, theirs) in ours.iter().zip(&theirs) {
            assert_eq!(ours.len(), theirs.len());
            for (ours, theirs) in ours.iter().zip(theirs) {
                assert!((ours - theirs).norm() < 1e-9);
            }
        }
    }
}

#[test]
fn a_motion_beyond_the_mechanism_is_no_number() {
    let (mut reduced, layout) = reduced(&thesis());
    let at = state(&layout, [100.0, 0.0], [0.0; 2]);
    let mut force = DVector::zeros(2);
    dynamics::Force::add_force(&mut reduced, &at.motion(&[]), force.as_mut_slice());
    assert!(force.iter().all(|force| force.is_nan()), "{force}");
}

#[test]
fn a_mechanism_with_other_motions_is_refused() {
    let build = |change: fn(&mut scene::Linkage)| {
        let mut entry = thesis();
        change(&mut entry);
        ReducedLinkage::new(&entry, GRAVITY, "pantograph", &mut Layout::new())
            .unwrap_err()
            .to_string()
    };
    // A knee that is a ball lets the upper arm swing aside.
    let message = build(|entry| entry.joints[1].kind = scene::JointKind::Spherical);
    assert!(message.contains("\"pan_head\" may leave the plane"), "{message}");
    assert!(message.contains("leave \"linkage\" out of model.reduce"), "{message}");
    let message = build(|entry| drop(entry.joints.remove(5)));
    assert!(
        message.contains("7 joints hold 14 of the bodies' 18 motions"),
        "{message}"
    );
}

#[test]
fn force_and_height_of_an_equilibrium_belong_together() {
    let (reduced, _) = reduced(&thesis());
    let beyond = reduced.equilibrium_at_force(150.0);
    assert!(matches!(beyond, Err(VehicleError::NotConverged { .. })), "{beyond:?}");
    for height in [4.85, 4.945, 5.2] {
        let at_height = reduced.equilibrium_at_height(height).unwrap();
        let at_force = reduced.equilibrium_at_force(at_height.force).unwrap();
        // Rounding of the forces over the stiffness of 15 to 25 N/m of the mechanism there.
        assert!((at_force.height - height).abs() < 1e-8, "{height}: {}", at_force.height);
    }
}
