//! Real lines against closed forms: stitch wires, overlaps, twin and single wires, curves, changes after the erection.
use catenary::{LineOptions, StaticLine, Subsystem, WireName};
use component::Component;
use dynamics::Force;
use integration_tests::runs::{Run, prepared, rms, run, scene_with};
use scene::Catenary;
use simulation::Mode;

const EN: &str = include_str!("../scenes/en50318-250.toml");
const STITCHED: &str = include_str!("../scenes/ac-stitched.toml");
const TWIN: &str = include_str!("../scenes/dc-twin-wire.toml");
const OVERLAP: &str = include_str!("../scenes/overlap.toml");
const TRAM: &str = include_str!("../scenes/tram-single-wire.toml");
const RAIL: &str = include_str!("../scenes/conductor-rail.toml");

fn line(text: &str, overrides: &[&str]) -> Catenary {
    let scene = scene_with(text, overrides);
    scene.modelled_line().unwrap().0.clone()
}

fn solved(catenary: &Catenary) -> StaticLine {
    StaticLine::solve(catenary, LineOptions::default()).unwrap()
}

/// Largest difference of two runs of the same steps, N.
fn largest_difference(a: &Run, b: &Run) -> f64 {
    let pairs = a.raw().iter().zip(b.raw());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn at_a_clamp_the_tension_of_the_messenger_wire_jumps_by_that_of_the_stitch_wire() {
    let statics = solved(&line(STITCHED, &["catenary.mesh.elements_per_interval=2"]).part(0, 6));
    let line = statics.line();
    let state = vec![0.0; statics.coordinates()];
    let motion = dynamics::Motion {
        t: 0.0,
        q: &state,
        v: &state,
        rotation: &[],
        u: &[],
    };
    let wires = line.topology().wires();
    let number = wires
        .iter()
        .position(|wire| wire.name == WireName::MessengerWire)
        .unwrap();
    let mut force = vec![0.0; state.len()];
    line.wires()[number].clone().add_force(&motion, &mut force);
    let messenger = line.wires()[number].geometry().nodes();
    let mut clamps = 0;
    for (planned, wire) in wires
        .iter()
        .zip(line.wires())
        .filter(|(wire, _)| wire.name == WireName::StitchWire)
    {
        let nodes = wire.geometry().nodes();
        for (end, sign) in [(0, -1.0), (planned.last(), 1.0)] {
            let x = nodes[end].map.position(0).unwrap();
            assert!(
                messenger.iter().any(|node| node.map.position(0) == Some(x)),
                "the clamp shares its place"
            );
            // The wires are in balance along the track, so the jump is the horizontal force of the stitch wire.
            assert!(
                (force[x] - sign * 3500.0).abs() < 3.5e-3,
                "{}: {} N",
                planned.label,
                force[x]
            );
            clamps += 1;
        }
    }
    assert_eq!(clamps, 10);
}

#[test]
fn stitch_wires_without_tension_and_droppers_change_nothing() {
    let droppers = |tension: f64| -> Vec<f64> {
        let mut catenary = line(EN, &["catenary.mesh.elements_per_interval=2"]).part(0, 5);
        if tension > 0.0 {
            // The first dropper is 5 m from the support, so that a stitch wire of 8 m carries none.
            catenary.stitch_wires = Some(scene::StitchWires {
                length: 8.0,
                clamp_mass: 0.0,
                wire: scene::Wire::new(1e-4, tension, 1e6, 0.0),
            });
        }
        solved(&catenary)
            .report()
            .droppers
            .iter()
            .map(|dropper| dropper.force)
            .collect()
    };
    // The effect of a small tension is linear in it, and zero where it is extended to.
    let (none, small, twice) = (droppers(0.0), droppers(100.0), droppers(200.0));
    for ((none, small), twice) in none.iter().zip(&small).zip(&twice) {
        assert!(
            (2.0 * small - twice - none).abs() < 0.01,
            "{none} N, {small} N, {twice} N"
        );
    }
}

#[test]
fn a_stitched_line_has_its_heights_and_carries_its_weight() {
    let overrides = ["catenary.presag=0.03", "catenary.mesh.elements_per_interval=2"];
    let mut catenary = line(STITCHED, &overrides).part(0, 6);
    catenary.tension_lengths[0].contact_wire_height = vec![5.3, 5.3, 5.35, 5.5, 5.6, 5.6, 5.5];
    let statics = solved(&catenary);
    let topology = statics.line().topology();
    for place in topology.droppers() {
        let node = &statics.line().wires()[place.lower.wire].geometry().nodes()[place.lower.node];
        let prescribed = topology.prescribed_height(&catenary, place.lower);
        assert!(
            (node.position.z - prescribed).abs() < 1e-9,
            "{} m, {prescribed} m",
            node.position.z
        );
    }
    let g = catenary.gravity;
    let wires = topology.wires().iter().zip(statics.line().wires());
    let of_wires = |(planned, wire): (&catenary::PlannedWire, &catenary::Wire)| {
        planned.parameters.mass_per_length * wire.geometry().lengths().iter().sum::<f64>()
    };
    let masses: f64 = topology.masses().iter().map(|(_, mass)| mass).sum();
    let droppers = catenary.droppers.mass * topology.droppers().len() as f64;
    let arms = catenary.registration_arms.mass * 5.0;
    let weight = g * (wires.map(of_wires).sum::<f64>() + masses + droppers + arms);
    let report = statics.report();
    let carried: f64 = report
        .supports
        .iter()
        .map(|support| support.messenger_reaction + support.arm_force)
        .sum();
    assert!((carried / weight - 1.0).abs() < 1e-6, "{carried} N carry {weight} N");
}

/// Short runs of the reference line, with the equal parts of both lines doubled by hand.
const SHORT: [&str; 8] = [
    "catenary.spans=4",
    "catenary.wire_ends=fixed",
    "catenary.mesh={elements_per_interval=2, corrections=\"none\"}",
    "run.duration=1.2",
    "run.evaluate={time=[0.3,1.1]}",
    "run.start_x=30",
    "model.reduce=none",
    "solver.newton_tolerance=1e-7",
];

/// The contact wire doubled, and with it droppers and contact.
const DOUBLED: [&str; 6] = [
    "catenary.contact_wire.mass_per_length=2.7",
    "catenary.contact_wire.tension=40000",
    "catenary.contact_wire.axial_stiffness=3.4e7",
    "catenary.contact_wire.bending_stiffness=390",
    "catenary.droppers.stiffness=2e5",
    "contact.stiffness=1e5",
];

#[test]
fn a_twin_contact_wire_is_one_of_twice_the_mass_tension_and_stiffness() {
    let twin = [&SHORT[..], &["catenary.contact_wire_spacing=1e-6"]].concat();
    let twin = run(scene_with(EN, &twin), Mode::Monolithic, "twin");
    let single = run(
        scene_with(EN, &[&SHORT[..], &DOUBLED].concat()),
        Mode::Monolithic,
        "single",
    );
    // Rounding and the tolerance of Newton's method.
    assert!(
        largest_difference(&twin, &single) < 1e-5,
        "{} N",
        largest_difference(&twin, &single)
    );
}

#[test]
fn two_equal_tension_lengths_share_the_strip_evenly() {
    let doubled: Vec<&str> = [&SHORT[..], &DOUBLED].concat();
    let doubled = [
        &doubled[..],
        &[
            "catenary.messenger_wire.mass_per_length=2.14",
            "catenary.messenger_wire.tension=32000",
            "catenary.messenger_wire.axial_stiffness=2.2e7",
            "catenary.messenger_wire.bending_stiffness=263.4",
            "catenary.supports.messenger_vertical_stiffness=1e6",
        ],
    ]
    .concat();
    let single = run(scene_with(EN, &doubled), Mode::Monolithic, "one line");
    // The keys from `spans` to `stagger` are those of the tension lengths.
    let (head, rest) = EN.split_once("spans = 10\n").unwrap();
    let (_, tail) = rest.split_once("wire_ends").unwrap();
    let text = format!("{head}wire_ends{tail}");
    let length = |stagger: f64| {
        format!(
            "[[catenary.tension_length]]\nspans = 4\nspan_length = 60.0\ncontact_wire_height = 5.3\n\
             encumbrance = 1.2\npresag = 0.0\nstagger = [{stagger}]\n"
        )
    };
    let text = text.replace(
        "[catenary.contact_wire]",
        &format!("{}{}[catenary.contact_wire]", length(0.1), length(-0.1)),
    );
    let both = run(scene_with(&text, &SHORT[1..]), Mode::Monolithic, "two lines");
    assert!(
        largest_difference(&both, &single) < 1e-5,
        "{} N",
        largest_difference(&both, &single)
    );
}

#[test]
fn the_force_is_continuous_where_a_strip_passes_from_one_wire_to_the_other() {
    let jump = |step: &str| {
        let step = [
            format!("solver.micro_step={step}"),
            format!("coupling.macro_step={step}"),
            format!("run.output_step={step}"),
        ];
        let mut overrides = vec![
            "catenary.mesh={elements_per_interval=3}",
            "run.start_x=280",
            "run.duration=1.6",
            "run.evaluate={time=[0.1,1.5]}",
        ];
        overrides.extend(step.iter().map(String::as_str));
        let run = run(scene_with(OVERLAP, &overrides), Mode::Monolithic, "overlap");
        run.raw()
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).abs())
            .fold(0.0, f64::max)
    };
    let (coarse, fine) = (jump("1e-3"), jump("2.5e-4"));
    // A jump would be as large in a quarter of the step; a kink is half as large or less.
    assert!(fine < 0.5 * coarse, "{coarse} N in 1 ms, {fine} N in 0.25 ms");
}

#[test]
fn co_simulation_agrees_with_one_system_on_stitched_twin_and_overlapping_lines() {
    let mesh = "catenary.mesh={elements_per_interval=3}";
    for (text, start, spans) in [
        (STITCHED, 80.0, "catenary.spans=6"),
        (TWIN, 70.0, "catenary.spans=6"),
        (OVERLAP, 270.0, ""),
    ] {
        let start = format!("run.start_x={start}");
        let mut overrides = vec![mesh, &start, "run.duration=2", "run.evaluate={time=[0.2,1.9]}"];
        overrides.extend(Some(spans).filter(|spans| !spans.is_empty()));
        let scene = scene_with(text, &overrides);
        let whole = run(scene.clone(), Mode::Monolithic, "whole");
        let coupled = run(scene, Mode::Inprocess, "coupled");
        let percent = 100.0 * rms(whole.raw(), coupled.raw()) / whole.sigma();
        println!("{percent:.4} % of the standard deviation");
        assert!(percent < 0.2, "{percent} %");
    }
}

/// Deflection in the middle of a span of a continuous beam under tension and even load, m: slopes vanish at supports.
///
/// ```text
/// f = w L²/(8 T) (1 − tanh(κ)/κ),    κ = L/4 √(T/EI)
/// ```
fn sag(wire: &scene::Wire, length: f64, gravity: f64) -> f64 {
    let weight = wire.mass_per_length * gravity;
    let parabola = weight * length * length / (8.0 * wire.tension);
    if wire.bending_stiffness == 0.0 {
        return parabola;
    }
    let kappa = 0.25 * length * (wire.tension / wire.bending_stiffness).sqrt();
    parabola * (1.0 - kappa.tanh() / kappa)
}

#[test]
fn a_single_wire_and_a_rail_sag_as_a_continuous_beam_under_tension() {
    for (text, elements) in [
        (TRAM, "catenary.mesh={element_length=0.2}"),
        (RAIL, "catenary.mesh.elements_per_interval=16"),
    ] {
        let catenary = line(text, &[elements, "catenary.stagger=[0.0]"]);
        let statics = solved(&catenary);
        let nodes = statics.line().wire(WireName::ContactWire).geometry().nodes();
        let supports = statics.line().topology().supports();
        // Of the ends nothing is left in the middle of the line.
        let middle = catenary.spans() / 2;
        let (left, right) = (supports[middle], supports[middle + 1]);
        let found = nodes[left].position.z - nodes[usize::midpoint(left, right)].position.z;
        let expected = sag(
            &catenary.contact_wire,
            catenary.span_lengths()[middle],
            catenary.gravity,
        );
        assert!((found / expected - 1.0).abs() < 0.005, "{found} m, {expected} m");
    }
}

#[test]
fn in_a_curve_a_wire_lies_on_its_chords_and_its_arms_pull_with_tension_times_turn() {
    let (radius, length) = (800.0, 30.0);
    let curve = format!("catenary.curve_radius={radius}");
    let catenary = line(
        TRAM,
        &[
            &curve,
            "catenary.stagger=[-0.05]",
            "catenary.contact_wire.bending_stiffness=0",
            "catenary.mesh={element_length=0.2}",
        ],
    );
    let statics = solved(&catenary);
    let nodes = statics.line().wire(WireName::ContactWire).geometry().nodes();
    let supports = statics.line().topology().supports();
    for node in &nodes[supports[4]..=supports[5]] {
        let x = node.position.x - 4.0 * length;
        let expected = -0.05 + x * (length - x) / (2.0 * radius);
        assert!(
            (node.position.y - expected).abs() < 5e-4,
            "{} m, {expected} m",
            node.position.y
        );
    }
    // The arm holds the wire against the pull towards the middle of the curve.
    let pull = catenary.contact_wire.tension * length / radius;
    let arm = &statics.line().registration_arms().as_slice()[4];
    assert!(
        (arm.reaction.y + pull).abs() < 0.005 * pull,
        "{} N, {pull} N",
        arm.reaction.y
    );
}

#[test]
fn warmth_slackens_a_wire_between_fixed_ends_and_lets_a_weighted_one_travel() {
    let weightless = "catenary.gravity=1e-3";
    let warm = "catenary.change={temperature=20, thermal_expansion=1.7e-5}";
    let fixed = line(
        TRAM,
        &[weightless, warm, "catenary.wire_ends=fixed", "catenary.stagger=[0.0]"],
    );
    let tension = solved(&fixed).report().tension.contact_wire;
    let (change, expected) = (
        tension - fixed.contact_wire.tension,
        -fixed.contact_wire.axial_stiffness * 1.7e-5 * 20.0,
    );
    assert!((change / expected - 1.0).abs() < 0.005, "{change} N, {expected} N");

    let weighted = line(TRAM, &[weightless, warm, "catenary.stagger=[0.0]"]);
    let statics = solved(&weighted);
    let nodes = statics.line().wire(WireName::ContactWire).geometry().nodes();
    let travel = nodes[nodes.len() - 1].position.x - nodes[0].position.x - 300.0;
    assert!((travel - 1.7e-5 * 20.0 * 300.0).abs() < 1e-4, "{travel} m");
    assert!((statics.report().tension.contact_wire - 10_000.0).abs() < 0.5);
}

#[test]
fn ice_sags_a_wire_of_given_length_as_the_change_of_state_equation_says() {
    let ice = 0.6;
    let change = format!("catenary.change={{ice_per_length={ice}}}");
    let overrides = [
        "catenary.wire_ends=fixed",
        "catenary.stagger=[0.0]",
        "catenary.contact_wire.bending_stiffness=0",
        "catenary.registration_arms.vertical_stiffness=1e9",
        "catenary.registration_arms.mass=0",
        &change,
    ];
    let catenary = line(TRAM, &overrides);
    let wire = &catenary.contact_wire;
    let found = solved(&catenary).report().tension.contact_wire;
    // (T′ − T)/EA = (w′²/T′² − w²/T²) L²/24, by bisection.
    let (w, iced, length) = (
        wire.mass_per_length * 9.81,
        (wire.mass_per_length + ice) * 9.81,
        30.0_f64,
    );
    let residual = |tension: f64| {
        (tension - wire.tension) / wire.axial_stiffness
            - ((iced / tension).powi(2) - (w / wire.tension).powi(2)) * length * length / 24.0
    };
    let (mut low, mut high) = (wire.tension, 3.0 * wire.tension);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if residual(middle) > 0.0 {
            high = middle
        } else {
            low = middle
        }
    }
    // The parabola of the equation stands for the catenary, and the mass of ice is per length of the iced wire.
    assert!((found / low - 1.0).abs() < 1e-3, "{found} N, {low} N");
}

#[test]
fn a_missing_dropper_is_carried_by_its_neighbours() {
    let overrides = ["catenary.mesh.elements_per_interval=2"];
    let whole = solved(&line(EN, &overrides));
    let change = "catenary.change={dropper=[{span=5, dropper=5, missing=true}]}";
    let broken = solved(&line(EN, &[overrides[0], change]));
    let (before, after) = (&whole.report().droppers, &broken.report().droppers);
    assert_eq!(after.len(), before.len() - 1);
    let sum = |droppers: &[catenary::DropperReport]| -> f64 { droppers.iter().map(|dropper| dropper.force).sum() };
    // The arms carry what they carried, so the droppers carry the same together.
    assert!((sum(before) - sum(after)).abs() < 1e-3);
    let force = |x: f64| after.iter().find(|dropper| (dropper.x - x).abs() < 0.01).unwrap().force;
    assert!(force(263.5) > 125.0 && (force(263.5) - force(276.5)).abs() < 0.1);
}

#[test]
fn a_wave_of_the_running_surface_drives_a_pantograph_as_a_moving_base_does() {
    // A rail so stiff that it does not move: what is left is the contact spring and the two masses.
    let (amplitude, wave, speed) = (2e-4, 2.5, 100.0 / 3.6);
    let points = 1200;
    let x: Vec<f64> = (0..=points).map(|i| 200.0 * f64::from(i) / f64::from(points)).collect();
    let height: Vec<f64> = x
        .iter()
        .map(|x| amplitude * (std::f64::consts::TAU * x / wave).sin())
        .collect();
    let surface = format!("catenary.surface={{x={x:?}, height={height:?}}}");
    let overrides = [
        "catenary.contact_wire.bending_stiffness=1e8",
        "catenary.contact_wire.axial_stiffness=1e9",
        "catenary.registration_arms.vertical_stiffness=1e9",
        "catenary.stagger=[0.0]",
        "catenary.gravity=1e-3",
        "catenary.mesh={elements_per_interval=1, corrections=\"none\"}",
        "solver.micro_step=2.5e-4",
        "solver.rho_inf=1",
        "coupling.macro_step=1e-3",
        "run.evaluate={time=[3.0,5.7]}",
        &surface,
    ];
    let run = run(scene_with(RAIL, &overrides), Mode::Monolithic, "surface");
    let omega = std::f64::consts::TAU * speed / wave;
    // Whole periods of 90 ms, after the start has died out.
    let period = 1e3 * wave / speed;
    let count = (period * (2700.0 / period).floor()).round() as usize;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (i, force) in run.raw()[..count].iter().enumerate() {
        let (s, c) = (omega * 1e-3 * i as f64).sin_cos();
        sine += 2.0 * force * s / count as f64;
        cosine += 2.0 * force * c / count as f64;
    }
    let found = sine.hypot(cosine);
    // Receptance at the head of masses on springs and dampers, and the contact spring in series.
    let (m, k, c) = ([7.2, 15.0], [4200.0, 50.0], [10.0, 90.0]);
    type Complex = (f64, f64);
    let div = |a: Complex, b: Complex| {
        let square = b.0 * b.0 + b.1 * b.1;
        ((a.0 * b.0 + a.1 * b.1) / square, (a.1 * b.0 - a.0 * b.1) / square)
    };
    let mul = |a: Complex, b: Complex| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let upper = (k[0], omega * c[0]);
    let lower = (k[1] - m[1] * omega * omega, omega * c[1]);
    let below = div(mul(upper, lower), (upper.0 + lower.0, upper.1 + lower.1));
    let head = (below.0 - m[0] * omega * omega, below.1);
    let contact = (5e4, 0.0);
    let total = div(mul(contact, head), (contact.0 + head.0, contact.1 + head.1));
    let expected = amplitude * total.0.hypot(total.1);
    assert!((found / expected - 1.0).abs() < 0.01, "{found} N, {expected} N");
}

/// In the middle span of the overlap the strip, 20 mm above the wires' height at rest, touches both.
#[test]
fn a_contact_with_two_wires_is_the_sum_of_its_parts() {
    let scene = scene_with(
        OVERLAP,
        &[
            "catenary.mesh={elements_per_interval=3}",
            "run.start_x=330",
            "run.duration=1",
            "run.evaluate={time=[0.2,0.8]}",
        ],
    );
    let signals = Subsystem::signals(&scene);
    let position = |name: &str| signals.iter().position(|signal| signal.name == name).unwrap();
    let mut line = Subsystem::build(&scene).unwrap();
    let z = position("strip[1].z");
    let rest = line.input(z);
    line.set_input(z, rest + 0.02);
    line.do_step(0.0, 1e-3).unwrap();

    let parts = |name: &str| [1, 2].map(|wire| position(&format!("contact[1].wire[{wire}].{name}")));
    let [first, second] = parts("force").map(|signal| line.output(signal));
    let total = line.output(position("contact[1].force"));
    assert!(first > 1.0 && second > 1.0, "{first} N and {second} N");
    assert!(
        (first + second - total).abs() < 1e-12 * total,
        "{first} + {second} N, {total} N"
    );
    let [left, right] = parts("y").map(|signal| line.output(signal));
    assert!((left - right).abs() > 0.1, "wires at {left} m and {right} m");

    for name in ["force", "x", "y", "z", "gap"] {
        for signal in parts(name) {
            let partial = line.sensitivity(signal, z);
            let of_strip: Vec<usize> = (0..signals.len())
                .filter(|i| signals[*i].name.starts_with("strip[1]."))
                .collect();
            assert_eq!(signals[signal].feedthrough, of_strip, "{name}");
            let mut at = |height: f64| {
                line.set_input(z, height);
                line.output(signal)
            };
            let difference = (at(rest + 0.02 + 1e-6) - at(rest + 0.02 - 1e-6)) / 2e-6;
            line.set_input(z, rest + 0.02);
            let scale = difference.abs().max(1.0);
            assert!(
                (partial - difference).abs() < 1e-5 * scale,
                "{name}: {partial}, {difference}"
            );
        }
    }
}

#[test]
fn a_contact_with_the_only_wire_has_no_parts() {
    let signals = Subsystem::signals(&scene_with(EN, &[]));
    assert!(signals.iter().all(|signal| !signal.name.contains("wire[")));
}

/// The first and the last of forty spans, and one in the middle that a solved one stands for.
#[test]
fn the_page_of_a_long_line_solved_as_a_short_one_has_all_its_droppers_and_wires() {
    let page = |reduce: &str| {
        let scene = scene_with(EN, &["catenary.spans=40", reduce]);
        let prepared = prepared(scene, "long");
        let report = simulation::check::Report::of(&prepared).unwrap();
        simulation::check_page::page(&prepared, &report).unwrap()
    };
    let (short, whole) = (
        page("model.reduce=[\"planar\",\"window\"]"),
        page("model.reduce=[\"planar\"]"),
    );
    assert_eq!((short.droppers.len(), whole.droppers.len()), (360, 360));
    for (a, b) in short.droppers.iter().zip(&whole.droppers) {
        assert_eq!((a.span, a.number), (b.span, b.number));
        let apart = |a: f64, b: f64| (a - b).abs();
        assert!(apart(a.position, b.position) < 1e-9 && apart(a.bottom[0], b.bottom[0]) < 1e-3);
        // End effects of the wires' own motion along the track are left out.
        assert!(
            apart(a.force, b.force) < 0.5 && apart(a.top[2], b.top[2]) < 0.01,
            "{a:?} {b:?}"
        );
    }
    for (a, b) in short.wires.iter().zip(&whole.wires) {
        let ends = |points: &[[f64; 3]]| (points[0][0], points[points.len() - 1][0]);
        let ((first, last), (whole_first, whole_last)) = (ends(&a.points), ends(&b.points));
        assert!(
            (first - whole_first).abs() < 1e-3 && (last - whole_last).abs() < 1e-2,
            "{last} m, {whole_last} m"
        );
    }
}
