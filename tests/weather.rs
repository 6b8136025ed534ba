//! Weather on a line against closed forms: warmth, friction and stops of tensioning devices, ice, wind, galloping.
use std::f64::consts::{PI, TAU};

use catenary::{LineOptions, StaticLine, WireName, static_line};
use integration_tests::runs::scene_with;
use results::OutputDirectory;
use scene::{Scene, WireKind};
use simulation::check::Report;
use simulation::galloping::Galloping;
use std::sync::atomic::AtomicBool;
use system::galloping::{Ends, Trial, criteria};

const TRAM: &str = include_str!("../scenes/tram-single-wire.toml");

const LENGTH: f64 = 60.0;
const TENSION: f64 = 10_000.0;
const STIFFNESS: f64 = 1.2e7;
const MASS: f64 = 0.89;

/// One span of 60 m of a wire without bending stiffness, its ends at the height of the supports.
fn span(overrides: &[&str]) -> Scene {
    let one = [
        "run.start_x=5.0",
        "run.duration=0.5",
        "run.evaluate={ time = [0.1, 0.4] }",
        "catenary.spans=1",
        "catenary.span_length=60.0",
        "catenary.stagger=[0.0]",
        "catenary.contact_wire.bending_stiffness=0.0",
        "catenary.contact_wire.diameter=0.012",
        "catenary.damping={ alpha = 0.2, beta = 0.0 }",
        "catenary.mesh={ element_length = 2.0, corrections = \"none\" }",
    ];
    let mut text = TRAM.split("[ranges]").next().unwrap().to_owned();
    text.push('\n');
    scene_with(&text, &[&one, overrides].concat())
}

fn solved(scene: &Scene) -> StaticLine {
    StaticLine::solve(scene.modelled_line().unwrap().0, LineOptions::default()).unwrap()
}

/// Tension of a wire that is stretched to `stretch` times its unstressed length: Green's strain, `EA ½ (λ² − 1) λ`.
fn tension_at(stretch: f64) -> f64 {
    STIFFNESS * 0.5 * (stretch * stretch - 1.0) * stretch
}

/// Its inverse.
fn stretch_at(tension: f64) -> f64 {
    let mut stretch = 1.0;
    for _ in 0..50 {
        stretch -= (tension_at(stretch) - tension) / (STIFFNESS * 0.5 * (3.0 * stretch * stretch - 1.0));
    }
    stretch
}

/// Tension between ends that moved apart by `way` (m) since the erection, at a temperature (K) above it.
fn held(way: f64, temperature: f64) -> f64 {
    tension_at(stretch_at(TENSION) * (1.0 + way / LENGTH) / (1.0 + 1.7e-5 * temperature))
}

/// Way of the ends at which a wire has this tension, m.
fn way_at(tension: f64, temperature: f64) -> f64 {
    LENGTH * (stretch_at(tension) / stretch_at(TENSION) * (1.0 + 1.7e-5 * temperature) - 1.0)
}

/// Tension and way of the ends, both together, after temperatures in turn.
fn after(temperatures: &str, device: &str) -> (f64, f64, Vec<String>) {
    let change = format!("catenary.change={{ temperature = {temperatures}, thermal_expansion = 1.7e-5 }}");
    let device = format!("catenary.tensioning={device}");
    let statics = solved(&span(&["catenary.gravity=1e-4", &change, &device]));
    let ends = &statics.report().ends;
    assert_eq!(ends.len(), 2);
    assert!((ends[0].tension - ends[1].tension).abs() < 1e-3);
    (
        ends[0].tension,
        ends[0].travel + ends[1].travel,
        ends.iter().map(|end| end.held_by.clone()).collect(),
    )
}

#[test]
fn a_heated_wire_between_fixed_ends_slackens_and_one_under_weights_travels() {
    let change = "catenary.change={ temperature = 25, thermal_expansion = 1.7e-5 }";
    let fixed = solved(&span(&["catenary.gravity=1e-4", change, "catenary.wire_ends=fixed"]));
    let found = fixed.report().tension.contact_wire - TENSION;
    let expected = held(0.0, 25.0) - TENSION;
    println!("heated by 25 K between fixed ends: {found:.3} N, closed form {expected:.3} N");
    assert!((found / expected - 1.0).abs() < 1e-4, "{found} N, {expected} N");
    // −EA α Δθ, but for the strain itself, 1e-3.
    assert!((found / (-STIFFNESS * 1.7e-5 * 25.0) - 1.0).abs() < 4e-3, "{found} N");
    assert!(fixed.report().ends.is_empty());

    let (tension, travel, holds) = after("25", "{ ratio = 3.0 }");
    assert!((travel / (1.7e-5 * 25.0 * LENGTH) - 1.0).abs() < 1e-4, "{travel} m");
    assert!((tension / TENSION - 1.0).abs() < 1e-7);
    assert_eq!(holds, ["weights", "weights"]);
}

#[test]
fn friction_of_the_devices_gives_the_hysteresis_of_a_slider_on_a_spring() {
    const FRICTION: f64 = 0.03;
    let device = format!("{{ friction = {FRICTION} }}");
    let mut slider = 0.0_f64;
    let mut turn = Vec::new();
    for temperature in [20.0, 60.0, 40.0, -30.0, -20.0, 15.0, 30.0] {
        turn.push(temperature);
        // The slider goes no farther than the spring behind it is strained to the friction.
        let [high, low] = [1.0 + FRICTION, 1.0 - FRICTION].map(|share| way_at(share * TENSION, temperature));
        slider = slider.clamp(low, high);
        let expected = held(slider, temperature);
        let (tension, travel, _) = after(&format!("{turn:?}"), &device);
        println!("{turn:?}: {tension:.4} N and {travel:.7} m, closed form {expected:.4} N and {slider:.7} m");
        assert!(
            (tension / expected - 1.0).abs() < 1e-6,
            "{turn:?}: {tension} N, {expected} N"
        );
        assert!((travel - slider).abs() < 1e-7, "{turn:?}: {travel} m, {slider} m");
    }
}

#[test]
fn at_a_stop_the_wire_slackens_as_between_fixed_ends_and_comes_back() {
    let device = "{ ratio = 2.0, travel = 0.02 }";
    let (tension, travel, holds) = after("50", device);
    let expected = held(0.02, 50.0);
    assert!((tension / expected - 1.0).abs() < 1e-6, "{tension} N, {expected} N");
    assert!((travel - 0.02).abs() < 1e-9);
    assert_eq!(holds, ["stop", "stop"]);
    let (tension, travel, holds) = after("[50, 10]", device);
    assert!((tension / TENSION - 1.0).abs() < 1e-6 && (travel - 1.7e-5 * 10.0 * LENGTH).abs() < 1e-5);
    assert_eq!(holds, ["weights", "weights"]);
    // In the cold the other stop.
    let (tension, ..) = after("-50", device);
    let expected = held(-0.02, -50.0);
    assert!((tension / expected - 1.0).abs() < 1e-6, "{tension} N, {expected} N");
}

/// Chord and sag of half of an elastic catenary of given unstressed length, weight per unstressed length (N/m) and
/// horizontal tension: `dx = λ H/T ds`, `dz = λ w s/T ds` [Irvine, Cable Structures, 1981, section 1.3], by Simpson's
/// rule.
fn half_catenary(unstressed: f64, weight: f64, horizontal: f64) -> (f64, f64) {
    const STEPS: usize = 200;
    let (mut x, mut z) = (0.0, 0.0);
    for step in 0..=STEPS {
        let s = 0.5 * unstressed * step as f64 / STEPS as f64;
        let tension = horizontal.hypot(weight * s);
        let share = match step {
            0 | STEPS => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        } * 0.5
            * unstressed
            / (3.0 * STEPS as f64);
        x += share * stretch_at(tension) * horizontal / tension;
        z += share * stretch_at(tension) * weight * s / tension;
    }
    (x, z)
}

fn bisect(mut low: f64, mut high: f64, is_low: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if is_low(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[test]
fn ice_by_its_thickness_sags_a_wire_as_the_elastic_catenary() {
    let thickness = 0.012;
    let ice = 900.0 * PI * thickness * (0.012 + thickness);
    let change = format!("catenary.change={{ ice = {{ thickness = {thickness} }} }}");
    let fine = "catenary.mesh={ element_length = 1.0, corrections = \"none\" }";
    let sag = |overrides: &[&str]| {
        let statics = solved(&span(&[&[fine, "catenary.wire_ends=fixed"], overrides].concat()));
        let nodes = statics.line().wire(WireName::ContactWire).geometry().nodes();
        let (first, middle) = (nodes[0].position.z, nodes[nodes.len() / 2].position.z);
        (statics.report().tension.contact_wire, first - middle)
    };
    // Masses are by length at the nominal tension; the unstressed length is that of the wire as erected.
    let weight = |mass: f64| mass * 9.81 * stretch_at(TENSION);
    let unstressed = bisect(0.99 * LENGTH, 1.01 * LENGTH, |unstressed| {
        half_catenary(unstressed, weight(MASS), TENSION).0 < 0.5 * LENGTH
    });
    let (_, erected) = half_catenary(unstressed, weight(MASS), TENSION);
    assert!((sag(&[]).1 - erected).abs() < 1e-5, "{} m, {erected} m", sag(&[]).1);
    let horizontal = bisect(TENSION, 10.0 * TENSION, |horizontal| {
        half_catenary(unstressed, weight(MASS + ice), horizontal).0 < 0.5 * LENGTH
    });
    let (_, expected) = half_catenary(unstressed, weight(MASS + ice), horizontal);
    let (tension, found) = sag(&[&change]);
    println!("sag with ice: {found:.7} m, elastic catenary {expected:.7} m");
    assert!((found - expected).abs() < 1e-5, "{found} m, {expected} m");
    assert!((tension / horizontal - 1.0).abs() < 1e-5, "{tension} N, {horizontal} N");
}

#[test]
fn a_steady_wind_blows_a_span_off_by_its_load_and_the_wider_one_with_ice_more() {
    let wind = "wind={ speed = 20.0, yaw_deg = 90.0, air_density = 1.25, wires = { drag_coefficient = 1.1 } }";
    for (change, diameter) in [
        ("catenary.change={}", 0.012),
        ("catenary.change={ ice = { thickness = 0.01 } }", 0.032),
    ] {
        let scene = span(&[wind, change]);
        assert_eq!(scene.diameter_in_wind(WireKind::Contact), Some(diameter));
        let statics = static_line(&scene).unwrap();
        let report = statics.blow_off().unwrap();
        assert_eq!((report.len(), report[0].span), (1, 1));
        let load = 0.5 * 1.25 * 1.1 * diameter * 400.0;
        let expected = -load * LENGTH * LENGTH / (8.0 * TENSION);
        // The slope of the wire takes some of the wind, 1e-3.
        let found = report[0].displacement;
        println!("blown off by {found:.5} m, parabola {expected:.5} m");
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} m, {expected} m");
        assert_eq!(report[0].lateral, found);
    }
}

#[test]
fn the_wind_on_droppers_and_arms_is_carried_by_the_wires_that_hold_them() {
    let en = include_str!("../scenes/en50318-250.toml")
        .split("[ranges]")
        .next()
        .unwrap()
        .to_owned()
        + "\n";
    let wind = |more: &str| {
        let wires = "drag_coefficient = 1.0, contact_wire_diameter = 1e-6, messenger_wire_diameter = 1e-6";
        let table = format!("wind={{ speed = 30.0, yaw_deg = 90.0, air_density = 1.25, wires = {{ {wires}{more} }} }}");
        let scene = scene_with(
            &en,
            &[
                "catenary.mesh.elements_per_interval=1",
                "catenary.mesh.corrections=none",
                &table,
            ],
        );
        let mut line = static_line(&scene).unwrap();
        line = line.in_wind(catenary::WindOnLine::of_scene(&scene));
        let mut layout = dynamics::Layout::new();
        let mut line = line.line_in(&mut layout);
        let (rest, mut force) = (layout.state_at_rest(), vec![0.0; layout.coordinates()]);
        line.parts(&mut |name, part| {
            if name == "wind_wires" {
                part.add_force(&rest.motion(&[]), &mut force);
            }
        });
        let nodes = line.wires().iter().flat_map(|wire| wire.geometry().nodes());
        let lateral: std::collections::BTreeSet<usize> = nodes.filter_map(|node| node.map.position(1)).collect();
        let whole: f64 = lateral.into_iter().map(|index| force[index]).sum();
        let heights = line
            .droppers()
            .as_slice()
            .iter()
            .map(|d| (d.upper.reference - d.lower.reference).norm());
        (
            whole,
            heights.sum::<f64>(),
            line.registration_arms().as_slice().len() as f64,
        )
    };
    let (none, lengths, arms) = wind("");
    let pressure = 0.5 * 1.25 * 900.0;
    let droppers = wind(", dropper_diameter = 0.005").0 - none;
    assert!(
        (droppers / (-pressure * 0.005 * lengths) - 1.0).abs() < 1e-9,
        "{droppers} N"
    ); // rounding
    let on_arms = wind(", registration_arm_drag_area = 0.04").0 - none;
    assert!((on_arms / (-pressure * 0.04 * arms) - 1.0).abs() < 1e-9, "{on_arms} N"); // rounding
}

/// Lift `a α + b α³` and constant drag, in steps of half a degree.
fn polar(linear: f64, cubic: f64, drag: f64) -> String {
    let degrees: Vec<f64> = (-100..=100).map(|step| 0.5 * f64::from(step)).collect();
    let lift = |angle: &f64| {
        let alpha = angle.to_radians();
        linear * alpha + cubic * alpha.powi(3)
    };
    let lift: Vec<f64> = degrees.iter().map(lift).collect();
    let drag = vec![drag; degrees.len()];
    format!("{{ angles_deg = {degrees:?}, drag = {drag:?}, lift = {lift:?} }}")
}

fn windy(polar: &str, speed: f64) -> Scene {
    let wind = format!(
        "wind={{ speed = {speed}, yaw_deg = 90.0, air_density = 1.25, wires = {{ drag_coefficient = 1.1, \
         contact_wire_diameter = 0.03, contact_wire_polar = {polar} }} }}"
    );
    span(&[&wind])
}

#[test]
fn a_span_gallops_from_the_speed_of_den_hartogs_criterion_on() {
    let scene = windy(&polar(-2.8, 12.0, 1.0), 8.0);
    let criterion = criteria(&scene)[0];
    // 2 m ζ ω = m α with damping on the mass alone.
    let expected = 2.0 * MASS * 0.2 / (1.25 * 0.03 * 1.8);
    let critical = criterion.critical_speed.unwrap();
    assert!(
        (critical / expected - 1.0).abs() < 1e-3,
        "{critical} m/s, {expected} m/s"
    );
    let statics = static_line(&scene).unwrap();
    let growth = |share: f64| {
        let trial = Trial {
            speed: share * critical,
            amplitude: 0.01,
            duration: 60.0,
        };
        let motion = trial.run(&scene, &statics).unwrap();
        assert!(
            (motion.frequency - criterion.frequency).abs() < 0.1,
            "{} Hz",
            motion.frequency
        );
        motion.growth
    };
    let (below, above) = (growth(0.98), growth(1.02));
    assert!(below < 0.0 && above > 0.0, "{below} 1/s, {above} 1/s");
    // Straight between both: the speed without growth.
    let simulated = 0.98 + 0.04 * below / (below - above);
    println!("critical speed by simulation: {simulated:.5} of Den Hartog's, {critical:.4} m/s");
    // ½ α (U/U_c − 1).
    assert!((above - 0.5 * 0.2 * 0.02).abs() < 5e-4, "{above} 1/s");
}

#[test]
fn the_limit_cycle_of_a_span_takes_from_the_wind_what_its_damping_costs() {
    let (linear, cubic, drag) = (-2.8, 12.0, 1.0);
    let scene = windy(&polar(linear, cubic, drag), 8.0);
    let critical = criteria(&scene)[0].critical_speed.unwrap();
    let speed = 1.4 * critical;
    let trial = Trial {
        speed,
        amplitude: 0.15,
        duration: 240.0,
    };
    let motion = trial.run(&scene, &static_line(&scene).unwrap()).unwrap();
    assert_eq!(motion.ends, Ends::LimitCycle);
    assert!(!motion.beyond_table, "{:?}", motion.angles);
    // Power of quasi-steady air on z = A sin(πx/L) sin ωt less that of the damping, mean over span and period.
    let omega = TAU * motion.frequency;
    let balance = |amplitude: f64| {
        const POINTS: usize = 64;
        let mut power = 0.0;
        for i in 0..POINTS {
            for k in 0..POINTS {
                let shape = (PI * (i as f64 + 0.5) / POINTS as f64).sin();
                let velocity = amplitude * omega * shape * (TAU * (k as f64 + 0.5) / POINTS as f64).cos();
                let alpha = (-velocity).atan2(speed);
                let lift = linear * alpha + cubic * alpha.powi(3);
                let pressure = 0.5 * 1.25 * 0.03 * (speed * speed + velocity * velocity);
                power +=
                    pressure * (lift * alpha.cos() + drag * alpha.sin()) * velocity - MASS * 0.2 * velocity.powi(2);
            }
        }
        power
    };
    let expected = bisect(1e-3, 3.0, |amplitude| balance(amplitude) > 0.0);
    println!(
        "limit cycle: {:.5} m, by the balance of energy {expected:.5} m",
        motion.amplitude
    );
    assert!(
        (motion.amplitude / expected - 1.0).abs() < 0.05,
        "{} m, {expected} m",
        motion.amplitude
    );
}

#[test]
fn the_page_of_galloping_has_growth_path_and_criteria() {
    let asked = Galloping {
        speeds: Vec::new(),
        amplitude: 0.01,
        duration: 20.0,
    };
    let scene = windy(&polar(-2.8, 12.0, 1.0), 8.0);
    let report = asked.run(&scene, "span", &AtomicBool::new(false)).unwrap();
    let motions = &report.motions;
    assert_eq!(motions.len(), 4);
    for motion in motions {
        let last = motion.envelope.last().unwrap();
        assert_eq!(last[1], motion.amplitude);
        let most = motion.path.iter().fold(0.0_f64, |most, [_, z]| most.max(z.abs()));
        // Four periods of a motion that hardly changes, seen at 120 places each.
        assert!(
            (most / motion.amplitude - 1.0).abs() < 0.1,
            "{most} {}",
            motion.amplitude
        );
        // The growth is the slope of the envelope.
        let [[first_t, first], [last_t, last]] = [motion.envelope[1], *last];
        let slope = (last / first).ln() / (last_t - first_t);
        assert!((slope - motion.growth).abs() < 0.02, "{slope} {}", motion.growth);
    }
    let folder = tempfile::tempdir().unwrap();
    report.write(&OutputDirectory::open(folder.path()).unwrap()).unwrap();
    let page = std::fs::read_to_string(folder.path().join("galloping.html")).unwrap();
    for part in [
        "Growth",
        "Path",
        "id=\"growth\"",
        "id=\"path\"",
        "data-csv=\"galloping\"",
        "contact wire",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(folder.path().join("galloping.csv").is_file());
}

#[test]
fn check_tells_blow_off_limit_and_galloping() {
    let scene = windy(&polar(-2.8, 12.0, 1.0), 25.0);
    let prepared = simulation::prepare(scene, "windy", std::path::Path::new("."), false).unwrap();
    let report = Report::of(&prepared).unwrap();
    let limit = report
        .limits
        .iter()
        .find(|limit| limit.quantity == "lateral_deviation")
        .unwrap();
    assert_eq!((limit.limit, limit.pass), (Some(0.4), Some(false)));
    assert_eq!(limit.value, Some(report.blow_off[0].lateral.abs()));
    let text = report.text(&prepared);
    for part in ["contact wire in the mean wind", "C_D + dC_L/dα = -1.799", "gallops"] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}
