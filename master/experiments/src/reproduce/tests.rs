mod judged;
mod table;

use super::judge::Line;
use super::open::{OPEN, Value};
use super::page::page;
use super::plan::plan;
use super::text::text;
use super::{CASES, Extent, HeadWind, Mesh, Reproduction, RunGroup, wind};
use crate::engine::Table as _;
use crate::engine::table::{RunRow, Status};
use results::WindRecord;
use simulation::Mode;

/// A run that was made, with these figures.
fn line(group: RunGroup, case: usize, mesh: Mesh, mean: f64, std: f64) -> Line {
    Line {
        group,
        case: &CASES[case],
        mesh,
        quantity: "",
        value: String::new(),
        row: RunRow {
            mode: Mode::Monolithic.name().to_owned(),
            status: Some(Status::Stable),
            mean: Some(mean),
            std: Some(std),
            ..RunRow::default()
        },
        raw_std: Some(1.5 * std),
        head: None,
        even_head: None,
        curve: None,
        wind: None,
        output_step: 1e-3,
    }
}

fn reproduction(lines: Vec<Line>) -> Reproduction {
    Reproduction::new(lines)
}

#[test]
fn published_figures_are_printed_with_the_digits_of_the_thesis() {
    let printed: Vec<String> = CASES
        .iter()
        .flat_map(|case| [case.mean.printed(), case.std.printed()])
        .collect();
    assert_eq!(
        printed,
        [
            "107.79", "36.73", "110.427", "37.3033", "120.22", "35.70", "120.21", "35.66"
        ]
    );
}

#[test]
fn every_published_case_is_planned_on_every_mesh_and_the_first_through_fmus() {
    let runs = plan(false, &[]);
    for case in CASES.iter() {
        for mesh in Mesh::ALL {
            let of = |run: &&super::ReproductionRun| {
                run.case == case && run.mesh == mesh && run.quantity.is_empty() && run.variant.mode == Mode::Monolithic
            };
            assert_eq!(runs.iter().filter(of).count(), 1, "{} {mesh:?}", case.scene);
        }
    }
    let coupled: Vec<&str> = runs
        .iter()
        .filter(|run| run.variant.mode == Mode::Cosimulation)
        .map(|run| &*run.case.scene)
        .collect();
    assert_eq!(coupled, ["thesis-own-mesh"]);
}

#[test]
fn an_open_quantity_is_changed_alone_and_behind_what_was_typed() {
    let typed = ["run.duration=3.0".to_owned()];
    let runs = plan(false, &typed);
    for open in OPEN.iter() {
        for mesh in Mesh::ALL {
            let of = |run: &&super::ReproductionRun| run.quantity == open.quantity && run.mesh == mesh;
            let made: Vec<_> = runs.iter().filter(of).collect();
            let own: Vec<String> = mesh.keys();
            for run in &made {
                let keys = &run.variant.overrides;
                assert_eq!(keys[0], typed[0]);
                assert_eq!(&keys[1..=own.len()], own, "the mesh");
                let value = open.values().into_iter().find(|value| value.name == run.value).unwrap();
                assert_eq!(&keys[1 + own.len()..], value.keys, "{} {}", run.quantity, run.value);
                assert_eq!(run.case, &CASES[open.case]);
            }
            let changes = |value: &super::open::Value| value.keys.iter().any(|key| !own.contains(key));
            let expected = open.values().iter().filter(|value| changes(value)).count();
            assert_eq!(
                made.len(),
                if open.is_on(mesh) { expected } else { 0 },
                "{} {mesh:?}",
                open.quantity
            );
        }
    }
}

#[test]
fn a_quick_plan_is_a_part_of_the_whole_one() {
    let all = plan(false, &[]);
    let quick = plan(true, &[]);
    assert!(quick.len() < all.len());
    assert!(quick.iter().all(|run| all.contains(run)));
    let planned = |run: &super::ReproductionRun| all.iter().filter(|other| *other == run).count();
    assert!(all.iter().all(|run| planned(run) == 1), "a run is planned twice");
}

#[test]
fn the_wind_on_the_pan_head_stands_beside_the_hand_calculation() {
    // Thesis, Eq. (18): 20 m/s over the ground at 15 degrees and 200 km/h ahead make |v_r|² = 5632.74 m²/s², q =
    // 3450.05 Pa.
    let of = |keys: &[&str]| {
        let text = include_str!("../../../../scenes/thesis-wind-pantograph.toml");
        let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
        let scene = system::load(text, "thesis-wind-pantograph.toml", &keys).unwrap();
        wind::on_even_head(&scene)
    };
    let [drag, lift] = of(&[]).unwrap();
    assert!(
        (drag - 172.50).abs() < 0.01 && (lift - 69.00).abs() < 0.01,
        "{drag} {lift}"
    ); // printed digits
    // Of the scene: half the density, half the force; a wind that changes has none.
    let [thin, _] = of(&["wind.air_density=0.6125"]).unwrap();
    assert!((thin - 0.5 * drag).abs() < 1e-12); // rounding
    assert_eq!(of(&["wind.record=[[0, 0, 0, 0], [1, 2, 0, 0]]"]), None);
    let mut calm = line(RunGroup::Published, 0, Mesh::Plain(1), 100.0, 40.0);
    calm.output_step = 0.5;
    let mut windy = line(RunGroup::Published, 2, Mesh::Plain(1), 112.0, 40.0);
    windy.even_head = Some([drag, lift]);
    windy.head = Some(HeadWind {
        drag: Extent {
            min: 171.25,
            mean: 172.5,
            max: 173.75,
        },
        lift: Extent {
            min: 68.5,
            mean: 69.0,
            max: 69.5,
        },
    });
    windy.wind = Some(WindRecord {
        drag: vec![171.25, 172.5, 173.75],
        lift: vec![68.5, 69.0, 69.5],
    });
    let made = reproduction(vec![calm, windy]);
    let page = page(&made).finish();
    for part in [
        "Fig. 11: drag on the pan-head",
        "Fig. 12: lift on the pan-head",
        "173.75",
    ] {
        assert!(
            page.contains(part) && page.contains("figure-11") && page.contains("figure-12"),
            "{part}"
        );
    }
    for part in ["173.75", "172.50", "69.00", "wind on the pan-head"] {
        assert!(text(&made).contains(part), "{}", text(&made));
    }
    // Nothing, not even a heading, where no wind was computed.
    let none = text(&reproduction(Vec::new()));
    assert!(!none.contains("pan-head") && !none.contains("readings"), "{none}");
    let sheet = made.sheet();
    let column = sheet
        .trailing
        .iter()
        .find(|(name, _)| *name == "head_lift_max_N")
        .unwrap();
    // Runs first, then what they say.
    assert_eq!(column.1[..2], ["", "69.5"]);
}

#[test]
fn the_keys_of_a_reading_make_the_air_that_it_says() {
    let text = include_str!("../../../../scenes/thesis-wind-pantograph.toml");
    let train = 200.0 / 3.6;
    let (sine, cosine) = 15.0_f64.to_radians().sin_cos();
    // The air past the train, along and across, m/s; one that is met at the yaw angle is known by that.
    let expected = [
        Some([-train - 20.0 * cosine, -20.0 * sine]),
        Some([-train + 20.0 * cosine, -20.0 * sine]),
        None,
        Some([-20.0 * cosine, -20.0 * sine]),
        Some([20.0 * cosine, -20.0 * sine]),
        Some([-train, 0.0]),
    ];
    let own = Value {
        name: wind::OWN.to_owned(),
        keys: Vec::new(),
    };
    let all: Vec<_> = std::iter::once(own).chain(wind::readings()).collect();
    assert_eq!(all.len(), expected.len());
    for (reading, expected) in all.into_iter().zip(expected) {
        let scene = system::load(text, "thesis-wind-pantograph.toml", &reading.keys).unwrap();
        let over_ground = scene.wind_field().unwrap().velocity(0.0, 0.0);
        let air = [over_ground.x - scene.run.speed, over_ground.y];
        match expected {
            // Degrees and back.
            Some(expected) => {
                let off = (air[0] - expected[0]).hypot(air[1] - expected[1]);
                assert!(off < 1e-12, "{}: {air:?} {expected:?}", reading.name);
            }
            None => {
                assert!(
                    (air[1] / air[0] - sine / cosine).abs() < 1e-12,
                    "{}: {air:?}",
                    reading.name
                );
                assert!((over_ground.norm() - 20.0).abs() < 1e-12); // rounding
            }
        }
    }
}

#[test]
fn what_could_not_be_computed_is_said_with_its_reason() {
    let mut refused = line(RunGroup::Mesh, 1, Mesh::Corrected, 0.0, 0.0);
    refused.row = RunRow {
        status: Some(Status::Refused),
        reason: "the correction has no meaning here".to_owned(),
        ..RunRow::default()
    };
    let made = reproduction(vec![refused]);
    assert!(
        text(&made).contains("the correction has no meaning here"),
        "{}",
        text(&made)
    );
    assert!(page(&made).finish().contains("the correction has no meaning here"));
}

#[test]
fn every_open_quantity_changes_the_scene_of_its_case() {
    let texts = [
        include_str!("../../../../scenes/thesis-own-mesh.toml"),
        include_str!("../../../../scenes/thesis-sliding-joint.toml"),
        include_str!("../../../../scenes/thesis-wind-pantograph.toml"),
        include_str!("../../../../scenes/thesis-wind-both.toml"),
    ];
    for open in OPEN.iter() {
        let read = |keys: &[String]| system::load(texts[open.case], &CASES[open.case].scene, keys);
        let own = read(&[]).unwrap();
        for value in open.values() {
            match read(&value.keys) {
                Ok(scene) => assert_ne!(scene, own, "{} {} changes nothing", open.quantity, value.name),
                Err(error) => panic!("{} {}: {error}", open.quantity, value.name),
            }
        }
    }
}

#[test]
fn the_suspensions_are_scaled_as_they_say() {
    let read = |keys: &[String]| {
        let text = include_str!("../../../../scenes/thesis-own-mesh.toml");
        let scene = system::load(text, "thesis-own-mesh.toml", keys).unwrap();
        match scene.vehicle.as_deref() {
            Some(scene::Vehicle::Full(train)) => train.bushings.clone(),
            _ => panic!("the thesis scene has a full vehicle"),
        }
    };
    let own = read(&[]);
    for (quantity, bodies, axes) in [
        ("secondary suspension of the vehicle", ["frame", "bolster"], [1, 2]),
        ("primary suspension of the vehicle", ["equalizer", "frame"], [2, 2]),
    ] {
        let open = OPEN.iter().find(|open| open.quantity == quantity).unwrap();
        for value in open.values() {
            let factor: f64 = value.name.split(' ').next().unwrap().parse().unwrap();
            let changed = read(&value.keys);
            let mut scaled = 0;
            for (was, is) in own.iter().zip(&changed) {
                let of = [was.first.as_str(), was.second.as_str()] == bodies;
                for axis in 0..3 {
                    for (was, is) in [
                        (was.stiffness[axis], is.stiffness[axis]),
                        (was.damping[axis], is.damping[axis]),
                    ] {
                        if was != is {
                            assert!(of, "{quantity}: another suspension was changed");
                            assert!((is / was - factor).abs() < 1e-12, "{was} {is}"); // rounding
                            scaled += usize::from(axis >= axes[0]);
                        }
                    }
                }
                assert_eq!(was.preload, is.preload, "a preload is a weight");
            }
            // Vertical stiffness and damping, and for the secondary one both lateral ones too.
            assert_eq!(scaled, if axes[0] == 1 { 4 } else { 2 }, "{quantity} {}", value.name);
        }
    }
}
