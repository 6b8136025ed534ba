//! The static state of a line, against closed forms and against itself.
use catenary::{BendingLayers, Dimension, LineOptions, StaticLine, StaticsError, WireName};
use integration_tests::lines::{EN, THESIS, scene_line, shipped_scene, short_line, solve};
use scene::{Catenary, Division};

fn weight(catenary: &Catenary, line: &StaticLine) -> f64 {
    let wires = [
        (WireName::ContactWire, catenary.contact_wire.mass_per_length),
        (
            WireName::MessengerWire,
            catenary.messenger_wire.unwrap().mass_per_length,
        ),
    ];
    let mut mass: f64 = wires
        .iter()
        .map(|(name, m)| m * line.line().wire(*name).geometry().lengths().iter().sum::<f64>())
        .sum();
    mass += catenary.droppers.mass * line.report().droppers.len() as f64;
    mass += catenary.registration_arms.mass * (catenary.spans() - 1) as f64;
    mass * catenary.gravity
}

fn vertical_reactions(line: &StaticLine) -> f64 {
    line.report()
        .supports
        .iter()
        .map(|support| support.messenger_reaction + support.arm_force)
        .sum()
}

#[test]
fn form_finding_puts_every_node_at_its_x_and_the_contact_wire_at_its_heights() {
    let mut catenary = scene_line(EN, &["catenary.presag=0.03"]);
    catenary.tension_lengths[0].span_lengths[1] = 48.0;
    catenary.droppers.positions[0].truncate(6);
    let line = solve(&catenary);
    let topology = line.line().topology();
    for name in [WireName::ContactWire, WireName::MessengerWire] {
        for (node, x) in line.line().wire(name).geometry().nodes().iter().zip(topology.x()) {
            assert!((node.position.x - x).abs() < 2e-10, "{} {x}", node.position.x);
        }
    }
    let nodes = line.line().wire(WireName::ContactWire).geometry().nodes();
    for place in topology.droppers() {
        let left = catenary.support_x(place.span - 1);
        let xi = (topology.x()[place.lower.node] - left) / catenary.tension_lengths[0].span_lengths[place.span - 1];
        let height = 5.3 - 0.03 * 4.0 * xi * (1.0 - xi);
        assert!((nodes[place.lower.node].position.z - height).abs() < 1e-12);
    }
    for support in &line.report().supports {
        assert!((support.contact_wire_z - 5.3).abs() < 1e-12);
    }
}

#[test]
fn the_found_state_balances_the_whole_line_and_has_the_nominal_tension_at_its_ends() {
    for (text, overrides) in [
        (EN, vec![]),
        (
            EN,
            vec![
                "catenary.stagger=[0.2, -0.2]",
                "catenary.presag=0.03",
                "catenary.wire_ends=\"fixed\"",
            ],
        ),
        (THESIS, vec![]),
        (
            EN,
            vec![
                "catenary.contact_wire.bending_stiffness=0.0",
                "catenary.messenger_wire.bending_stiffness=0.0",
            ],
        ),
    ] {
        let catenary = scene_line(text, &overrides);
        let line = solve(&catenary);
        let report = line.report();
        // The reference is rounded to 1e-13 m at 600 m; elements have 1e7 N/m.
        assert!(
            report.residual < 1e-9 * catenary.contact_wire.tension,
            "{:e} N",
            report.residual
        );
        assert!((report.tension.contact_wire - catenary.contact_wire.tension).abs() < 1e-4);
        assert!((report.tension.messenger_wire - catenary.messenger_wire.unwrap().tension).abs() < 1e-4);
        assert!(report.iterations > 0 && report.iterations < 100);
    }
}

#[test]
fn reactions_carry_the_weight_of_wires_droppers_and_arms() {
    let set = [
        "catenary.droppers.mass=0.3",
        "catenary.registration_arms.mass=1.5",
        "catenary.presag=0.02",
    ];
    for extra in [
        vec![],
        vec!["catenary.statics=\"nodal_displacement\""],
        vec!["catenary.stagger=[0.2, -0.2]"],
    ] {
        let catenary = scene_line(EN, &[&set[..], &extra[..]].concat());
        let line = solve(&catenary);
        let (sum, weight) = (vertical_reactions(&line), weight(&catenary, &line));
        assert!((sum - weight).abs() < 1e-6 * weight, "{sum} {weight}");
    }
}

/// Numbers under `key` of an array of objects of a reference file.
fn column(file: &serde_json::Value, array: &str, key: &str) -> Vec<f64> {
    let rows = file[array].as_array().unwrap();
    rows.iter().map(|row| row[key].as_f64().unwrap()).collect()
}

#[test]
fn the_reference_model_agrees_with_an_independent_program() {
    // Independent program in another language: linear elements of small slope, statics of the sagging line; see
    // tests/data/reference2d/README.md. The program leaves out the slopes of the messenger wire (0.08), a few
    // thousandths of the elasticity.
    let text = include_str!("data/reference2d/en50318-250-statics-converged.json");
    let reference: serde_json::Value = serde_json::from_str(text).unwrap();
    let mut catenary = scene_line(EN, &[]);
    catenary.mesh.division = Division::PerInterval(16);
    let line = solve(&catenary);
    let report = line.report();
    let compare = |what: &str, ours: Vec<f64>, key: (&str, &str), tolerance: f64| {
        let theirs = column(&reference, key.0, key.1);
        assert_eq!(ours.len(), theirs.len(), "{what}");
        for (i, (a, b)) in ours.iter().zip(&theirs).enumerate() {
            assert!((a - b).abs() <= tolerance * b, "{what} {i}: {a} {b}");
        }
    };
    compare(
        "dropper x",
        report.droppers.iter().map(|d| d.x).collect(),
        ("droppers", "x"),
        1e-12,
    );
    compare(
        "dropper force",
        report.droppers.iter().map(|d| d.force).collect(),
        ("droppers", "force_N"),
        2e-3,
    );
    compare(
        "dropper length",
        report.droppers.iter().map(|d| d.length).collect(),
        ("droppers", "length_m"),
        2e-3,
    );
    let supports = &report.supports;
    let reactions = supports.iter().map(|s| s.messenger_reaction).collect();
    compare("support", reactions, ("supports", "messenger_reaction_N"), 2e-3);
    compare(
        "arm",
        supports.iter().map(|s| s.arm_force).collect(),
        ("supports", "arm_force_N"),
        1e-2,
    );
    let elasticity = line.elasticity(&column(&reference, "elasticity", "x")).unwrap();
    let elasticity = elasticity.iter().map(|e| e.elasticity).collect();
    compare("elasticity", elasticity, ("elasticity", "m_per_N"), 1e-2);
}

/// Reactions of a beam under tension `t` and load `q` on rigid supports at `x`, pinned at both ends: the equations of
/// three moments for `EI w⁗ − T w″ = −q`, with `T w = M + q x²/2 + C x + D` in each field.
fn reactions_of_continuous_beam(x: &[f64], t: f64, ei: f64, q: f64) -> Vec<f64> {
    let n = x.len() - 1;
    let k = (t / ei).sqrt();
    let m_bar = q * ei / t;
    let lengths: Vec<f64> = x.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let near = |l: f64| k / (k * l).tanh() - 1.0 / l;
    let far = |l: f64| 1.0 / l - k / (k * l).sinh();
    // T w′ at the right end of a field is near·Mb + far·Ma + r(l), at its left end the negative mirror image.
    let own = |l: f64| q * l / 2.0 - m_bar * k * (1.0 / (k * l).tanh() - 1.0 / (k * l).sinh());
    let (mut diagonal, mut right) = (vec![1.0; n + 1], vec![0.0; n + 1]);
    let (mut upper, mut lower) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    for i in 1..n {
        let (a, b) = (lengths[i - 1], lengths[i]);
        (lower[i], diagonal[i], upper[i]) = (far(a), near(a) + near(b), far(b));
        right[i] = -own(a) - own(b);
    }
    for i in 1..=n {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    let mut moments = vec![0.0; n + 1];
    for i in (1..n).rev() {
        moments[i] = (right[i] - upper[i] * moments[i + 1]) / diagonal[i];
    }
    let mut reactions = vec![0.0; n + 1];
    for (i, l) in lengths.iter().enumerate() {
        let c = (moments[i] - moments[i + 1]) / l - q * l / 2.0;
        reactions[i] -= c;
        reactions[i + 1] += q * l + c;
    }
    reactions
}

#[test]
fn dropper_forces_are_the_reactions_of_a_beam_under_tension() {
    let catenary = short_line(4);
    let wire = &catenary.contact_wire;
    let line = solve(&catenary);
    let topology = line.line().topology();
    let mut nodes: Vec<usize> = topology.supports().to_vec();
    nodes.extend(topology.droppers().iter().map(|place| place.lower.node));
    nodes.sort_unstable();
    let x: Vec<f64> = nodes.iter().map(|&node| topology.x()[node]).collect();
    let q = wire.mass_per_length * catenary.gravity;
    let expected = reactions_of_continuous_beam(&x, wire.tension, wire.bending_stiffness, q);
    let enriched = LineOptions {
        layers: BendingLayers::AtAttachments,
        ..LineOptions::default()
    };
    let enriched = StaticLine::solve(&catenary, enriched).unwrap();
    // Cubic elements of 1 m do not follow the bending layer of 0.1 m; with it as an unknown they do.
    for (line, tolerance) in [(&line, 0.01), (&enriched, 5e-4)] {
        let mut forces: Vec<(f64, f64)> = line.report().droppers.iter().map(|d| (d.x, d.force)).collect();
        forces.extend(line.report().supports.iter().map(|s| (s.x, s.arm_force)));
        forces.sort_by(|a, b| a.0.total_cmp(&b.0));
        for ((x, force), expected) in forces.iter().zip(&expected) {
            assert!(
                (force - expected).abs() < tolerance * expected,
                "{x}: {force} {expected}"
            );
        }
    }
}

#[test]
fn presag_takes_the_curvature_of_its_parabola_off_the_droppers() {
    let catenary = scene_line(EN, &["catenary.presag=0.05"]);
    let line = solve(&catenary);
    let wire = &catenary.contact_wire;
    let load = wire.mass_per_length * catenary.gravity - 8.0 * 0.05 * wire.tension / 3600.0;
    let middle = line
        .report()
        .droppers
        .iter()
        .find(|dropper| dropper.x == 270.0)
        .unwrap();
    // Field of 6.5 m on both sides; the parabola is followed at the droppers only.
    assert!(
        (middle.force - 6.5 * load).abs() < 2e-3 * middle.force,
        "{} {}",
        middle.force,
        6.5 * load
    );
}

#[test]
fn too_much_presag_is_refused_with_span_dropper_and_force() {
    let catenary = scene_line(EN, &["catenary.presag=0.4"]);
    match StaticLine::solve(&catenary, LineOptions::default()).unwrap_err() {
        StaticsError::DropperPushes {
            span: 1,
            dropper,
            x,
            force,
        } => {
            assert!(dropper >= 1 && x > 0.0 && x < 60.0 && force > 0.0);
        }
        other => panic!("{other}"),
    }
}

#[test]
fn a_messenger_wire_that_sags_to_the_contact_wire_is_refused() {
    let catenary = scene_line(EN, &["catenary.encumbrance=0.5"]);
    let error = StaticLine::solve(&catenary, LineOptions::default()).unwrap_err();
    assert!(
        matches!(error, StaticsError::NoRoomForDropper { span: 1, .. }),
        "{error}"
    );
}

#[test]
fn a_wire_above_its_breaking_force_is_refused_with_both_numbers() {
    let mut catenary = short_line(2);
    catenary.messenger_wire.as_mut().unwrap().breaking_force = Some(16_010.0);
    let error = StaticLine::solve(&catenary, LineOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("messenger_wire") && error.to_string().contains("16010"),
        "{error}"
    );
}

#[test]
fn stagger_loads_arms_and_supports_with_tension_times_change_of_direction() {
    let catenary = scene_line(EN, &["catenary.stagger=[0.2, -0.2]"]);
    let line = solve(&catenary);
    // Half of a bending length at each end of a span carries the change of direction by its moment.
    let kink = 2.0 * 0.4 / 60.0;
    for (number, arm) in line.line().registration_arms().as_slice().iter().enumerate() {
        // The second support stands at y = −0.2 m: the wire pulls to the left (+y), the arm to the right.
        let sign = if number % 2 == 0 { -1.0 } else { 1.0 };
        let expected = sign * kink * 20_000.0;
        assert!(
            (arm.reaction.y - expected).abs() < 5e-3 * expected.abs(),
            "{} {expected}",
            arm.reaction.y
        );
        let support = line.line().supports().as_slice()[number].reaction;
        let expected = sign * kink * 16_000.0;
        assert!(
            (support.y - expected).abs() < 5e-3 * expected.abs(),
            "{} {expected}",
            support.y
        );
        assert_eq!((arm.reaction.x, support.x), (0.0, 0.0));
    }
    // Straight between the arms, and the droppers vertical.
    for dropper in line.line().droppers().as_slice() {
        assert!((dropper.upper.reference.y - dropper.lower.reference.y).abs() < 1e-4);
    }
    let middle = line
        .line()
        .topology()
        .droppers()
        .iter()
        .find(|place| place.span == 5 && place.position == 4)
        .unwrap();
    let nodes = line.line().wire(WireName::ContactWire).geometry().nodes();
    assert!(nodes[middle.lower.node].position.y.abs() < 1e-6);
}

#[test]
fn a_finer_mesh_gives_the_same_droppers() {
    let coarse = solve(&short_line(3));
    let mut catenary = short_line(3);
    catenary.mesh.division = Division::PerInterval(24);
    let fine = solve(&catenary);
    for (a, b) in coarse.report().droppers.iter().zip(&fine.report().droppers) {
        // The kink over a support is rounded within an element: 0.08 rad over decimetres.
        assert!((a.length - b.length).abs() < 2e-3, "{} {}", a.length, b.length);
        assert!((a.force - b.force).abs() < 0.01 * b.force, "{} {}", a.force, b.force);
    }
    let x = [70.0, 90.0];
    let (a, b) = (coarse.elasticity(&x).unwrap(), fine.elasticity(&x).unwrap());
    for (a, b) in a.iter().zip(&b) {
        // The force itself makes a kink that elements of 1 m round off.
        assert!(
            (a.elasticity - b.elasticity).abs() < 0.02 * b.elasticity,
            "{} {}",
            a.elasticity,
            b.elasticity
        );
    }
}

#[test]
fn the_planar_line_is_the_spatial_one() {
    let catenary = short_line(3);
    let spatial = solve(&catenary);
    let planar = LineOptions {
        dimension: Dimension::Planar,
        ..LineOptions::default()
    };
    let planar = StaticLine::solve(&catenary, planar).unwrap();
    assert_eq!(3 * planar.coordinates(), 2 * spatial.coordinates());
    for (a, b) in planar.report().droppers.iter().zip(&spatial.report().droppers) {
        assert!((a.length - b.length).abs() < 1e-9 && (a.force - b.force).abs() < 1e-4);
    }
    let (a, b) = (
        planar.elasticity(&[75.0]).unwrap(),
        spatial.elasticity(&[75.0]).unwrap(),
    );
    assert!((a[0].elasticity - b[0].elasticity).abs() < 1e-6 * b[0].elasticity);
}

#[test]
fn elasticity_is_symmetric_about_the_middle_of_the_line() {
    let line = solve(&scene_line(EN, &[]));
    let points = [244.0, 255.0, 262.0, 270.0, 278.0, 285.0];
    let mirrored: Vec<f64> = points.iter().map(|x| 600.0 - x).collect();
    let all: Vec<f64> = points.iter().chain(&mirrored).copied().collect();
    let found = line.elasticity(&all).unwrap();
    let n = found.len();
    assert!(found.is_sorted_by_key(|report| report.x));
    for i in 0..n / 2 {
        let (a, b) = (found[i].elasticity, found[n - 1 - i].elasticity);
        assert!((a - b).abs() < 1e-6 * a, "{}: {a} {b}", found[i].x);
    }
    // Spans of the middle are nearly so: the neighbours on both sides are alike.
    let value = |x: f64| found.iter().find(|report| report.x == x).unwrap().elasticity;
    assert!((value(255.0) - value(285.0)).abs() < 1e-3 * value(255.0));
    // Softest at mid-span.
    assert!(value(270.0) > value(255.0) && value(255.0) > value(244.0));
}

#[test]
fn a_bare_wire_yields_as_a_pinned_beam_under_tension() {
    let mut catenary = short_line(1);
    catenary.droppers.positions[0].clear();
    catenary.mesh.division = Division::PerInterval(200);
    let line = solve(&catenary);
    let (l, t, ei) = (60.0, 20_000.0, 195.0_f64);
    let half = 0.5 * l * (t / ei).sqrt();
    let found = line.elasticity(&[30.0]).unwrap()[0].elasticity;
    let expected = l / (4.0 * t) * (1.0 - half.tanh() / half);
    // Elements of 0.3 m under a force at a node.
    assert!((found - expected).abs() < 1e-3 * expected, "{found} {expected}");
    let sag = 5.3 - line.wire_height_under(30.0, 0.0).unwrap().height;
    let q = 1.35 * 9.81;
    let expected = q * l * l / (8.0 * t) - q * ei / (t * t) * (1.0 - 1.0 / half.cosh());
    // Small slopes: the sag is a hundredth of the span.
    assert!((sag - expected).abs() < 1e-3 * expected, "{sag} {expected}");
}

#[test]
fn a_force_lifts_the_wire_where_it_acts_and_nowhere_else_much() {
    let line = solve(&scene_line(EN, &[]));
    let rest = line.wire_height_under(260.0, 0.0).unwrap();
    assert!(rest.state.q.iter().all(|q| q.abs() < 1e-8));
    let lifted = line.wire_height_under(260.0, 100.0).unwrap();
    let elasticity = line.elasticity(&[260.0]).unwrap()[0].elasticity;
    assert!((lifted.height - rest.height - 100.0 * elasticity).abs() < 1e-8);
    assert!(line.line().uplift(4, &lifted.state.q) > 1e-3);
    assert!(line.line().uplift(9, &lifted.state.q).abs() < 1e-4);
    let pushed = line.wire_height_under(260.0, 800.0).unwrap();
    assert_eq!(line.line().slack_count(&rest.state.motion(&[])), 0);
    assert!(line.line().slack_count(&pushed.state.motion(&[])) > 0);
    // Slack droppers hang no weight on the messenger wire: the wire rises more than in proportion.
    assert!(pushed.height - rest.height > 8.0 * (lifted.height - rest.height));
    let error = line.wire_height_under(600.1, 100.0).unwrap_err();
    assert!(error.to_string().contains("600.1"), "{error}");
}

#[test]
fn sliding_ends_leave_no_residual_after_nodal_displacement() {
    let mut catenary = scene_line(
        EN,
        &[
            "catenary.stagger=[0.3, -0.3]",
            "catenary.statics=\"nodal_displacement\"",
        ],
    );
    catenary.registration_arms.vertical_stiffness = 1e5;
    let line = solve(&catenary);
    // The springs at the sliding ends carry nothing in the static state.
    assert!(line.report().residual < 1e-9 * 20_000.0, "{:e}", line.report().residual);
    assert!((line.report().tension.contact_wire - 20_000.0).abs() < 1e-4);
}

#[test]
fn bending_layers_give_the_form_of_a_fine_mesh_on_a_coarse_one() {
    let enriched = LineOptions {
        layers: BendingLayers::AtAttachments,
        ..LineOptions::default()
    };
    let mut catenary = scene_line(EN, &["catenary.stagger=[0.3, -0.3]"]);
    catenary.tension_lengths[0].span_lengths.truncate(4);
    catenary.mesh.division = Division::PerInterval(2);
    let coarse = StaticLine::solve(&catenary, enriched).unwrap();
    catenary.mesh.division = Division::PerInterval(32);
    let fine = solve(&catenary);
    for (a, b) in coarse.report().droppers.iter().zip(&fine.report().droppers) {
        assert!((a.length - b.length).abs() < 2e-4, "{} {}", a.length, b.length);
        assert!((a.force - b.force).abs() < 1e-3 * b.force, "{} {}", a.force, b.force);
    }
}

#[test]
fn wires_stretched_between_fixed_ends_sag_under_their_own_weight() {
    let mut catenary = short_line(4);
    catenary.statics = scene::Statics::NodalDisplacement;
    catenary.wire_ends = scene::WireEnds::Fixed;
    // Droppers too long to touch, supports that hold.
    catenary.droppers.lengths = Some(vec![vec![3.0; 9]]);
    catenary.registration_arms.vertical_stiffness = 1e9;
    catenary.supports.messenger_vertical_stiffness = 1e9;
    let line = solve(&catenary);
    let report = line.report();
    assert!(report.residual < 1e-9 * 20_000.0, "{:e}", report.residual);
    assert!(
        report
            .droppers
            .iter()
            .all(|dropper| dropper.force == 0.0 && dropper.length == 3.0)
    );
    for (name, parameters, h) in [
        (
            WireName::ContactWire,
            catenary.contact_wire,
            report.tension.contact_wire,
        ),
        (
            WireName::MessengerWire,
            catenary.messenger_wire.unwrap(),
            report.tension.messenger_wire,
        ),
    ] {
        let q = parameters.mass_per_length * catenary.gravity;
        let nodes = line.line().wire(name).geometry().nodes();
        let topology = line.line().topology();
        let middle = topology
            .droppers()
            .iter()
            .find(|place| place.span == 2 && place.position == 4)
            .unwrap();
        let top = nodes[topology.supports()[2]].position.z;
        let sag = top - nodes[middle.lower.node].position.z;
        // Clamped by symmetry at inner supports.
        let k = (h / parameters.bending_stiffness).sqrt();
        let expected = q * 3600.0 / (8.0 * h) - q * 60.0 / (2.0 * h * k) * (k * 15.0).tanh();
        assert!((sag - expected).abs() < 5e-3 * expected, "{sag} {expected}");
        // Elongation by sag, ε = q²L²/24H², raises the tension of fixed ends; the weight is small against it.
        let raised = parameters.tension + parameters.axial_stiffness * (q * 60.0 / h).powi(2) / 24.0;
        assert!(
            (h - raised).abs() < 2e-2 * (raised - parameters.tension),
            "{h} {raised}"
        );
    }
}

#[test]
fn droppers_as_long_as_found_hold_the_contact_wire_where_it_was_found() {
    // Constant tension in both: the stretched line must find the form again.
    let found = solve(&short_line(3));
    let mut catenary = short_line(3);
    catenary.statics = scene::Statics::NodalDisplacement;
    catenary.registration_arms.vertical_stiffness = 1e8;
    catenary.supports.messenger_vertical_stiffness = 1e8;
    let second_span = &found.report().droppers[9..18];
    catenary.droppers.lengths = Some(vec![second_span.iter().map(|dropper| dropper.length).collect()]);
    let again = solve(&catenary);
    let place = again.line().topology().droppers()[13];
    let node = again.line().wire(WireName::ContactWire).geometry().nodes()[place.lower.node];
    // Straight element lengths are shorter by the sag than the found ones: the wires move along the track by
    // centimetres.
    assert!((node.position.z - 5.3).abs() < 5e-3, "{}", node.position.z);
    assert!((again.report().tension.messenger_wire - 16_000.0).abs() < 5.0);
}

#[test]
fn the_position_along_the_track_is_found_again_on_the_wire() {
    let line = solve(&scene_line(
        EN,
        &["catenary.presag=0.05", "catenary.stagger=[0.2, -0.2]"],
    ));
    let answer = line.wire_height_under(270.0, 200.0).unwrap();
    let (curve, q) = (line.line().contact_curve(0), &answer.state.q);
    for x in [0.1, 59.9, 60.0, 123.4, 270.0, 599.9] {
        let s = line.line().contact_wire_s(0, x, q);
        assert!((curve.point(s, q, &vec![0.0; q.len()]).r.x - x).abs() < 1e-9, "{x}");
    }
    assert_eq!(line.line().contact_wire_s(0, -1.0, q), 0.0);
    assert_eq!(line.line().contact_wire_s(0, 601.0, q), curve.length());
}

/// Wires that do not move sideways have the lateral forces of the line in space, in which droppers lean a little less.
#[test]
fn arms_of_a_planar_line_hold_its_wires_aside() {
    for name in [
        "en50318-2018-ac-simple",
        "curve",
        "overlap",
        "dc-twin-wire",
        "tram-single-wire",
    ] {
        let scene = shipped_scene(name, &[]);
        let catenary = scene.modelled_line().unwrap().0;
        let of = |dimension: Dimension| {
            let options = LineOptions {
                dimension,
                ..LineOptions::default()
            };
            let line = StaticLine::solve(catenary, options).unwrap();
            let supports = line.report().supports.iter();
            let forces = supports.flat_map(|support| [support.arm_lateral, support.messenger_lateral]);
            forces.map(Option::unwrap).collect::<Vec<f64>>()
        };
        let (space, plane) = (of(Dimension::Spatial), of(Dimension::Planar));
        let largest = space.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
        assert!(largest > 50.0, "{name}");
        for (support, (space, plane)) in space.iter().zip(&plane).enumerate() {
            assert!(
                (space - plane).abs() < 0.02 * largest,
                "{name}, {support}: {space} N, {plane} N"
            );
        }
    }
}
