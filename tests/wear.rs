//! Wear and arcs: closed forms, volumes, the growth of a wave by linear theory, passages that go on, refusals.
use dynamics::{Blocks, Force, Layout, Motion, NewtonOptions, RestingSpline, Simulator, State, Weights};
use integration_tests::fmus::tree;
use integration_tests::runs::scene_with;
use integration_tests::under_wire::UnderWire;
use nalgebra::Complex;
use passages::{Surroundings, Wishes, WornLine};
use results::report::{Progress, Show};
use results::{Evaluation, OutputDirectory, Record, StripRecord};
use scene::{Files, PantographModel as Entry, Scene, SceneFile};
use simulation::Mode;
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;
use vehicle::PantographModel;
use wear::{Contact, Head, Law, Passage, Profile, RoundSection};

const WEAR: &str = include_str!("../scenes/wear.toml");

/// The shipped scene, on a coarse and short line.
const COARSE: [&str; 5] = [
    "catenary.spans=4",
    "catenary.mesh.elements_per_interval=2",
    "run.duration=2.4",
    "run.evaluate={spans=[2,3]}",
    "model.reduce=[\"planar\"]",
];

fn loaded(overrides: &[&str]) -> Result<Scene, String> {
    let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
    let files = Files::new(|path| {
        let read = std::fs::read_to_string(tree().join("scenes").join(path));
        read.map_err(|error| error.to_string())
    });
    system::load_with(WEAR, "wear.toml", &overrides, &files).map_err(|error| error.to_string())
}

fn shipped(overrides: &[&str]) -> Scene {
    loaded(overrides).unwrap()
}

/// Record of one strip that travels from x = 0 with these forces, a sample every `step` s, and its evaluation.
fn travelled(scene: &Scene, force: Vec<f64>, gap: f64) -> (Evaluation, Record) {
    let step = scene.run.output_step;
    let time: Vec<f64> = (0..force.len()).map(|sample| step * sample as f64).collect();
    let x: Vec<f64> = time.iter().map(|t| scene.run.speed * t).collect();
    let evaluation = Evaluation {
        time: vec![(0.0, time[time.len() - 1])],
        output_step: step,
        speed: scene.run.speed,
        ..Evaluation::default()
    };
    let strip = StripRecord {
        gap: force
            .iter()
            .map(|force| if *force > 0.0 { -1e-3 } else { gap })
            .collect(),
        aside: x.iter().map(|x| 0.2 * (x / 60.0 * TAU).sin()).collect(),
        contact_x: x,
        force,
        ..StripRecord::default()
    };
    let record = Record {
        time,
        pantographs: vec![strip],
        ..Record::default()
    };
    (evaluation, record)
}

#[test]
fn constant_force_and_current_wear_as_the_closed_form_of_the_law_says() {
    let scene = shipped(&[]);
    let own = scene.wear.clone().unwrap();
    let (force, current, speed) = (107.0, 400.0, scene.run.speed);
    // The law by hand, with the numbers of the scene.
    let resistance = 2.0e-3 * (90.0_f64 / force).sqrt();
    let lubricated = (0.5 * (1.0 + current / 500.0_f64)).powi(-2);
    let mechanical = 2.0e-4 * lubricated * (force / 90.0_f64).powf(0.4) * force / 1.1e9;
    let joule = 5.0e-4 * resistance * current * current / (1.1e9 * speed);
    let expected = mechanical + joule;
    let line = WornLine::new(&scene).unwrap();
    for applied in ["span", "place"] {
        let scene = shipped(&[&format!("wear.applied=\"{applied}\"")]);
        let line = WornLine::new(&scene).unwrap();
        let (evaluation, record) = travelled(&scene, vec![force; 3000], 0.0);
        let (by_passage, terms) = line.lost(&evaluation, &record).unwrap();
        assert!((terms.mechanical / mechanical - 1.0).abs() < 1e-12);
        assert!((terms.joule / joule - 1.0).abs() < 1e-12 && terms.arc == 0.0);
        for area in &by_passage.area {
            // Sums of some thousand pieces.
            assert!((area / expected - 1.0).abs() < 1e-9, "{applied}: {area} {expected}");
        }
    }
    // A hundred thousand passages, and their depth by the chord of the worn circle.
    let mut lost = line.begin();
    lost.area.iter_mut().for_each(|area| *area += 1e5 * expected);
    let (radius, area) = (0.5 * own.wire.diameter, 1e5 * expected);
    for depth in line.depths(&lost) {
        let half_angle = (1.0 - depth / radius).acos();
        let segment = radius * radius * (half_angle - half_angle.sin() * half_angle.cos());
        assert!((segment / area - 1.0).abs() < 1e-6, "{segment} {area}");
    }
    let (evaluation, record) = travelled(&scene, vec![force; 3000], 0.0);
    let train = simulation::wearing::of(&scene).unwrap().train(&evaluation, &record);
    let head = &train.pantographs[0];
    assert!((head.mean_resistance_ohm.unwrap() / resistance - 1.0).abs() < 1e-12);
    assert!((head.mean_drop_v.unwrap() / (resistance * current) - 1.0).abs() < 1e-12);
    assert!((head.mean_power_w.unwrap() / (resistance * current * current) - 1.0).abs() < 1e-12);
    assert!(head.arcs.is_empty());
    let strip = head.strip.unwrap();
    let worn = 1.0e-5 * force / 5.0e8 + 1.0e-4 * resistance * current * current / (5.0e8 * speed);
    assert!((strip.volume_m3_per_m.sum() / worn - 1.0).abs() < 1e-12);
    assert!((strip.worn_width_m - 0.41).abs() < 0.011, "{}", strip.worn_width_m);
}

#[test]
fn an_arc_has_its_voltage_its_duration_and_its_energy() {
    let scene = shipped(&[]);
    let mut force = vec![110.0; 2000];
    force[700..709].fill(0.0);
    force[1500] = 0.0;
    let (evaluation, record) = travelled(&scene, force, 2e-3);
    let train = simulation::wearing::of(&scene).unwrap().train(&evaluation, &record);
    let head = &train.pantographs[0];
    let step = scene.run.output_step;
    let voltage = 20.0 + 1000.0 * 2e-3;
    assert_eq!(head.arcs.len(), 2);
    for (arc, (begin, samples)) in head.arcs.iter().zip([(700.0, 9.0), (1500.0, 1.0)]) {
        assert!((arc.begin_s - begin * step).abs() < 1e-9);
        assert!((arc.duration_s - samples * step).abs() < 1e-9);
        assert!((arc.voltage_v - voltage).abs() < 1e-9);
        assert!((arc.energy_j - voltage * 400.0 * samples * step).abs() < 1e-6);
    }
    assert!((head.arc_percent - 100.0 * 10.0 / 2000.0).abs() < 1e-9);
    // The term of arcs, by the share of lost contact of the published law.
    let share = 10.0 / 2000.0;
    let expected = 1.0e-2 * share * voltage * 400.0 / (scene.run.speed * 2.05e5 * 8960.0);
    assert!((train.wire.unwrap().area_m2.arc / expected - 1.0).abs() < 1e-9);
    // Without a current there is no arc.
    let scene = shipped(&["wear.current=0"]);
    let train = simulation::wearing::of(&scene).unwrap().train(&evaluation, &record);
    assert!(train.pantographs[0].arcs.is_empty() && train.wire.unwrap().area_m2.arc == 0.0);
}

#[test]
fn the_volume_of_a_profile_is_that_of_the_pieces_that_wore_it() {
    for applied in ["span", "place"] {
        let scene = shipped(&[&format!("wear.applied=\"{applied}\""), "wear.contact_length=0.7"]);
        let line = WornLine::new(&scene).unwrap();
        let force: Vec<f64> = (0..5000)
            .map(|sample| 100.0 + 90.0 * (0.013 * f64::from(sample)).sin())
            .collect();
        let (evaluation, record) = travelled(&scene, force, 0.0);
        let (by_passage, terms) = line.lost(&evaluation, &record).unwrap();
        // By place, cells at the ends of the evaluation have the mean in full.
        let room = if applied == "span" { 1e-9 } else { 1e-3 };
        assert!((by_passage.mean() / terms.sum() - 1.0).abs() < room, "{applied}");
        // Over spans the mean is that of the integral of the law.
        assert!(by_passage.largest().1 > 1.05 * terms.sum());
    }
}

/// A rigid wire with a surface that repeats itself; the head presses by its penetration.
struct RigidWire {
    head: usize,
    force: f64,
    stiffness: f64,
    speed: f64,
    length: f64,
    /// One period with a margin on both sides.
    surface: RestingSpline,
}

impl RigidWire {
    fn pressed(&self, t: f64, q: f64) -> f64 {
        let [height, ..] = self.surface.at((self.speed * t).rem_euclid(self.length));
        (self.force + self.stiffness * (q - height)).max(0.0)
    }
}

impl Force for RigidWire {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        force[self.head] -= self.pressed(motion.t, motion.q[self.head]);
    }

    fn add_tangent(&mut self, _: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        blocks.add(&[self.head], &[self.head], &[weights.q * self.stiffness]);
    }
}

/// Cells in a wave.
const CELLS: usize = 96;
/// Samples while a wave passes, and waves until the pantograph has settled.
const SAMPLES: usize = 200;
const SETTLED: usize = 60;

/// Surface of cells of one wave, with copies before and behind.
fn repeated(heights: &[f64], length: f64) -> RestingSpline {
    let cell = length / heights.len() as f64;
    let count = heights.len() as i64;
    let places = -8..count + 8;
    let x = places.clone().map(|place| cell * (place as f64 + 0.5)).collect();
    let height = places.map(|place| heights[place.rem_euclid(count) as usize]);
    RestingSpline::new(x, height.collect())
}

/// Forces over one wave once the pantograph has settled on the surface, N.
fn forces_over(scene: &Scene, heights: &[f64], (length, stiffness): (f64, f64)) -> (f64, Vec<f64>) {
    let mut layout = Layout::new();
    let (mut model, rest) = PantographModel::started(scene, 0, &mut layout).unwrap();
    let mut state: State = layout.state_at_rest();
    model.set_initial(&rest, &mut state);
    let at_rest = state.q[0];
    let speed = scene.run.speed;
    let wire = RigidWire {
        head: 0,
        // Pressed as at rest where the surface is even.
        force: rest.force - stiffness * at_rest,
        stiffness,
        speed,
        length,
        surface: repeated(heights, length),
    };
    let step = length / speed / SAMPLES as f64;
    let options = NewtonOptions {
        tolerance: 1e-12,
        ..NewtonOptions::default()
    };
    let system = UnderWire { layout, model, wire };
    let mut simulator = Simulator::new(system, state, vec![], step / 4.0, 1.0, options);
    simulator.start_accelerations().unwrap();
    let mut forces = Vec::new();
    for sample in 0..SAMPLES * (SETTLED + 1) {
        let t = step * sample as f64;
        if sample >= SAMPLES * SETTLED {
            let now = simulator.state().q[0];
            forces.push(simulator.system.wire.pressed(t, now));
        }
        control::advance(
            &mut simulator,
            &mut [],
            (t, step),
            &mut |_, _| {},
            &mut |_, _, _, _| {},
            &mut |_, _| {},
        )
        .unwrap();
    }
    (rest.force, forces)
}

/// First harmonic of values of one wave.
fn harmonic(values: &[f64]) -> Complex<f64> {
    let n = values.len() as f64;
    let sum = values.iter().enumerate().map(|(index, value)| {
        let phase = TAU * (index as f64 + 0.5) / n;
        Complex::new(phase.cos(), -phase.sin()) * *value
    });
    sum.sum::<Complex<f64>>() * (2.0 / n)
}

#[test]
fn a_wave_of_the_surface_grows_or_decays_as_linear_theory_says() {
    let mut signs = Vec::new();
    for length in [0.9, 2.5, 9.0] {
        // Heavier dampers, so that the pantograph settles; a current would only add an even term.
        let scene = shipped(&[
            "wear.current=0",
            "pantograph[1].dampings=[20, 20, 70]",
            "pantograph[1].reference_height=5.3",
        ]);
        let own = scene.wear.as_ref().unwrap();
        let Entry::Lumped(lumped) = &scene.pantographs[0].model else {
            panic!("lumped")
        };
        let (contact, speed) = (5.0e4, scene.run.speed);
        let section = RoundSection {
            diameter: own.wire.diameter,
        };
        let worn = 4e-3;
        let mut lost = Profile::new(0.0, length, length / CELLS as f64);
        let amplitude = 1e-6;
        for index in 0..CELLS {
            let phase = TAU * (index as f64 + 0.5) / CELLS as f64;
            lost.area[index] = section.lost(worn + amplitude * phase.sin());
        }
        let law = Law::new(own, &own.wire.law);
        for block in 0..3 {
            let depths: Vec<f64> = lost.area.iter().map(|area| section.depth(*area)).collect();
            let mean = depths.iter().sum::<f64>() / CELLS as f64;
            let heights: Vec<f64> = depths.iter().map(|depth| depth - mean).collect();
            let (rest, forces) = forces_over(&scene, &heights, (length, contact));
            let passage = Passage {
                wear: own,
                wires: 1,
                speed,
                step: length / speed / SAMPLES as f64,
            };
            let closed = vec![-1.0; SAMPLES];
            let x: Vec<f64> = (0..SAMPLES).map(|sample| passage.stride() * sample as f64).collect();
            let head = Head {
                strips: vec![Contact {
                    force: &forces,
                    x: &x,
                    aside: &[],
                    gap: &closed,
                }],
                evaluated: 0..SAMPLES,
            };
            let mut by_passage = Profile::new(0.0, length, length / CELLS as f64);
            passage.worn(0, &head, (-length, 2.0 * length), &mut |places, volume| {
                by_passage.deposit_periodic(places, volume.sum());
            });
            // Passages that change the wave by about a hundredth.
            let by_force = law.mechanical_by_force(rest, 0.0);
            let area = law.mechanical(rest, 0.0);
            let stiffness = wear::head_stiffness(lumped, TAU * speed / length);
            let one = wear::growth(stiffness, contact, (area, by_force), (section, mean)) - 1.0;
            let rigid = by_force / section.width(mean) * (stiffness * contact / (stiffness + contact)).norm();
            let passages = 0.01 / rigid;
            let expected = one * passages;
            for (lost, rate) in lost.area.iter_mut().zip(&by_passage.area) {
                *lost += passages * rate;
            }
            let after: Vec<f64> = lost.area.iter().map(|area| section.depth(*area)).collect();
            let change = harmonic(&after) / harmonic(&depths) - 1.0;
            // Width that grows with the mean, means over samples and cells, the rest of the first waves.
            let error = (change - expected).norm() / 0.01;
            println!("{length} m, block {block}: {change}, by theory {expected}");
            assert!(
                error < 0.02,
                "{length} m, block {block}: {change} instead of {expected}"
            );
            signs.push(change.re > 0.0);
        }
    }
    assert!(
        signs.contains(&true) && signs.contains(&false),
        "waves that grow and waves that decay: {signs:?}"
    );
}

/// Passages on the coarse line, kept in `folder`.
fn passed(scene: &Scene, wishes: &Wishes, folder: &std::path::Path, stop: &AtomicBool) -> passages::Record {
    let progress = Progress::share("wear", Show::Never);
    let base = tree().join("scenes");
    let around = Surroundings {
        name: "wear",
        base: &base,
        mode: Mode::Monolithic,
        logging: false,
        fmus: folder.join("fmus"),
        interrupted: stop,
        progress: &progress,
    };
    let output = OutputDirectory::open(folder).unwrap();
    let record = passages::run(scene, wishes, &around, &output).unwrap();
    record.write(&output).unwrap();
    record
}

#[test]
fn passages_wear_the_line_feed_it_back_and_go_on_where_they_ended() {
    let scene = shipped(&COARSE);
    let wishes = Wishes {
        passages: 60_000,
        every: Some(20_000),
        forces: vec![80.0, 120.0],
    };
    let (whole, parts) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let stop = AtomicBool::new(false);
    let record = passed(&scene, &wishes, whole.path(), &stop);
    assert!(record.complete && record.passages() == 60_000);
    assert_eq!(record.blocks.len(), 4);
    assert_eq!(record.blocks[3].added, 0);
    let mut mean = 0.0;
    for block in &record.blocks {
        // The mean of the profile is the sum of the mean areas of the passages: no volume is lost on the way.
        mean += block.added as f64 * block.figures.area_m2.sum();
        let kept = block.area_m2.iter().sum::<f64>() / block.area_m2.len() as f64;
        assert!((kept / mean - 1.0).abs() < 1e-9, "{kept} {mean}");
        assert!(block.largest_depth_m > block.mean_depth_m && block.mean_depth_m > block.smallest_depth_m);
    }
    let deviation = |index: usize| record.blocks[index].figures.std_n[0].unwrap();
    assert!(
        deviation(0) != deviation(1),
        "a worn surface is felt: {} N",
        deviation(0)
    );
    let [light, heavy] = &record.forces[..] else {
        panic!("{:?}", record.forces)
    };
    assert!(heavy.figures.mean_n[0] > light.figures.mean_n[0]);
    assert!(heavy.figures.area_m2.mechanical > light.figures.area_m2.mechanical);
    assert!(heavy.figures.area_m2.joule < light.figures.area_m2.joule);
    let csv = std::fs::read_to_string(whole.path().join(passages::CSV)).unwrap();
    assert_eq!(csv.lines().count(), 1 + 4 * record.lost.area.len());
    // As if killed after its first block.
    let mut killed = record.clone();
    killed.complete = false;
    killed.blocks.truncate(1);
    killed.lost.area.clone_from(&killed.blocks[0].area_m2);
    OutputDirectory::open(parts.path())
        .unwrap()
        .write_json(passages::JSON, &killed)
        .unwrap();
    let again = passed(&scene, &wishes, parts.path(), &stop);
    let depths = |record: &passages::Record| record.lost.area.iter().map(|area| area.to_bits()).collect::<Vec<_>>();
    assert_eq!(depths(&again), depths(&record), "bit for bit");
    assert_eq!(again.blocks.len(), 4);
    // Another wish begins anew.
    let other = Wishes { passages: 1, ..wishes };
    assert_eq!(
        passed(&scene, &other, parts.path(), &AtomicBool::new(true)).passages(),
        0
    );
}

#[test]
fn wear_changes_no_bit_of_the_run_that_it_looks_at() {
    let with = shipped(&COARSE);
    let mut without = with.clone();
    without.wear = None;
    let run = |scene: Scene| {
        let base = tree().join("scenes");
        integration_tests::runs::run_beside(scene, Mode::Monolithic, "wear", &base)
    };
    let (with, without) = (run(with), run(without));
    assert_eq!(with.record, without.record);
    assert_eq!(with.summary.pantographs, without.summary.pantographs);
    let json = |run: &integration_tests::runs::Run| serde_json::to_value(&run.summary).unwrap();
    assert!(json(&with).get("wear").is_some() && json(&without).get("wear").is_none());
    let page = |run: integration_tests::runs::Run| {
        results::report::render(&[results::RunBundle {
            summary: run.summary,
            record: run.record,
            scene: run.written,
        }])
    };
    let (with, without) = (page(with), page(without));
    assert!(with.contains("Worn area of the contact wire") && !without.contains("Current and wear"));
}

#[test]
fn wear_that_cannot_be_is_refused_with_key_and_remedy() {
    let said = |overrides: &[&str]| loaded(overrides).map(|_| ()).unwrap_err();
    for (key, value, expected) in [
        ("wear.wire.mechanical_coefficient", "-1e-4", "must be zero or positive"),
        ("wear.strip.arc_coefficient", "-1", "must be zero or positive"),
        ("wear.wire.diameter", "13.85", "must be at most 0.05 m"),
        ("wear.wire.diameter", "0", "must be positive"),
        ("wear.wire.hardness", "1100", "must be from 1000000 to"),
        ("wear.wire.worn_depth", "0.009", "half of wear.wire.diameter"),
        ("wear.wire.limit_percent", "0.2", "must be from 1 to 50"),
        ("wear.current", "[400, 300]", "must be one number, or 1"),
        ("wear.current", "-5", "must be zero or positive"),
        ("wear.arc_voltage", "0", "must be positive"),
        ("wear.constriction_resistance", "nan", "must be positive"),
        ("wear.grid", "5", "must be from 0.01 to 1"),
        ("wear.applied", "\"everywhere\"", "must be \"span\" or \"place\""),
    ] {
        let said = said(&[&format!("{key}={value}")]);
        assert!(said.contains(key) && said.contains(expected), "{key}={value}: {said}");
    }
    let missing = WEAR.replace("diameter = 0.01385", "# diameter = 0.01385");
    let files = Files::new(|path| Ok(std::fs::read_to_string(tree().join("scenes").join(path)).unwrap()));
    let said_missing = SceneFile::read(&missing, "wear.toml", &[], &files)
        .map(|_| ())
        .unwrap_err();
    let said_missing = said_missing.to_string();
    assert!(
        said_missing.contains("wear.wire.diameter is missing: must be a positive number in m"),
        "{said_missing}"
    );
    let uneven = said(&["catenary.span_length=[60, 60, 50, 60, 60, 60]"]);
    assert!(
        uneven.contains("wear.applied") && uneven.contains("must be \"place\""),
        "{uneven}"
    );
    let none = WornLine::new(&scene_with(integration_tests::runs::EN_250, &[])).unwrap_err();
    assert!(none.to_string().contains("wear is missing: must be a table"));
    // An evaluation without a whole span.
    let scene = shipped(&[]);
    let (evaluation, record) = travelled(&scene, vec![100.0; 500], 0.0);
    let narrow = WornLine::new(&scene)
        .unwrap()
        .lost(&evaluation, &record)
        .unwrap_err()
        .to_string();
    assert!(
        narrow.contains("covers no whole span") && narrow.contains("wear.applied = \"place\""),
        "{narrow}"
    );
}
