use super::execute::Line;
use super::relation::relations;
use super::{CASES, Extent, Group, HeadWind, Mesh, Reproduction, page, plan, text, wind};
use crate::results::WindRecord;
use crate::simulation::Mode;
use crate::table_of_runs::{Row, Status};

/// A run that was made, with these figures.
fn line(group: Group, case: usize, mesh: Mesh, mean: f64, std: f64) -> Line {
    Line {
        group,
        case: &CASES[case],
        mesh,
        quantity: "",
        value: String::new(),
        row: Row {
            mode: Mode::Monolithic.name().to_owned(),
            status: Some(Status::Stable),
            mean: Some(mean),
            std: Some(std),
            ..Row::default()
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
    Reproduction {
        complete: true,
        relations: relations(&lines),
        lines,
    }
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
    for case in &CASES {
        for mesh in Mesh::ALL {
            let of = |run: &&super::Planned| {
                run.case == case && run.mesh == mesh && run.quantity.is_empty() && run.variant.mode == Mode::Monolithic
            };
            assert_eq!(runs.iter().filter(of).count(), 1, "{} {mesh:?}", case.scene);
        }
    }
    let coupled: Vec<&str> = runs
        .iter()
        .filter(|run| run.variant.mode == Mode::Cosimulation)
        .map(|run| run.case.scene)
        .collect();
    assert_eq!(coupled, ["thesis"]);
}

#[test]
fn an_open_quantity_is_changed_alone_and_behind_what_was_typed() {
    let typed = ["run.duration=3.0".to_owned()];
    for run in plan(true, &typed).iter().filter(|run| run.group == Group::Open) {
        let keys = &run.variant.overrides;
        assert_eq!(keys[0], typed[0]);
        // Two keys of the mesh and one of the quantity.
        assert_eq!(keys.len(), 4, "{keys:?}");
    }
}

#[test]
fn a_relation_holds_in_the_direction_of_the_published_change_only() {
    let thesis = Mesh::Plain(1);
    let lines = vec![
        line(Group::Published, 0, thesis, 100.0, 40.0),
        line(Group::Published, 1, thesis, 101.0, 39.0),
        line(Group::Published, 2, thesis, 112.0, 40.0),
        line(Group::Published, 3, thesis, 112.0, 40.0),
    ];
    let found = relations(&lines);
    let verdicts: Vec<&str> = found.iter().map(super::relation::Relation::verdict).collect();
    assert_eq!(
        verdicts,
        [
            "holds: same direction",
            "refuted: other direction",
            "holds: same direction",
            "refuted: no visible change",
            "holds: no visible change",
            // Published: 35.70 N to 35.66 N, -0.11 %.
            "holds: no visible change",
        ]
    );
    // 112/100, and 120.22/107.79.
    assert!((found[2].computed.unwrap() - 12.0).abs() < 1e-9); // rounding
    assert!((found[2].published - 11.53).abs() < 0.005); // printed digits
}

#[test]
fn a_spread_says_whether_the_published_value_lies_inside() {
    let thesis = Mesh::Plain(1);
    let mut changed = line(Group::Open, 0, thesis, 100.0, 30.0);
    changed.quantity = "contact damping d";
    changed.value = "300.0 N s/m".to_owned();
    let mut lines = vec![line(Group::Published, 0, thesis, 100.0, 40.0), changed];
    let inside = reproduction(lines.clone());
    assert!(text(&inside).contains("published inside"), "{}", text(&inside));
    assert!(page(&inside).contains("inside the range of: contact damping d"));
    lines[1].row.std = Some(38.0);
    let outside = reproduction(lines);
    assert!(!text(&outside).contains("published inside"), "{}", text(&outside));
    assert!(page(&outside).contains("inside the range of none of them"));
}

#[test]
fn the_wind_on_the_pan_head_stands_beside_the_hand_calculation() {
    // Thesis, Eq. (18): 20 m/s over the ground at 15 degrees and 200 km/h ahead make |v_r|² = 5632.74 m²/s², q = 3450.05 Pa.
    let of = |keys: &[&str]| {
        let text = include_str!("../../../scenes/thesis-wind-pantograph.toml");
        let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
        let scene = scene::Scene::from_toml(text, "thesis-wind-pantograph.toml", &keys).unwrap();
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
    let mut calm = line(Group::Published, 0, Mesh::Plain(1), 100.0, 40.0);
    calm.output_step = 0.5;
    let mut windy = line(Group::Published, 2, Mesh::Plain(1), 112.0, 40.0);
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
    let page = page(&made);
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
    let (_, behind) = made.columns();
    let column = behind.iter().find(|(name, _)| *name == "head_lift_max_N").unwrap();
    assert_eq!(column.1, ["", "69.5"]);
}

#[test]
fn the_keys_of_a_reading_make_the_air_that_it_says() {
    let text = include_str!("../../../scenes/thesis-wind-pantograph.toml");
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
    let all: Vec<_> = std::iter::once(wind::own()).chain(wind::readings()).collect();
    assert_eq!(all.len(), expected.len());
    for (reading, expected) in all.into_iter().zip(expected) {
        let scene = scene::Scene::from_toml(text, "thesis-wind-pantograph.toml", &reading.keys).unwrap();
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
    let mut refused = line(Group::Mesh, 1, Mesh::Cured, 0.0, 0.0);
    refused.row = Row {
        status: Some(Status::Refused),
        reason: "the cure has no meaning here".to_owned(),
        ..Row::default()
    };
    let made = reproduction(vec![refused]);
    assert!(text(&made).contains("the cure has no meaning here"), "{}", text(&made));
    assert!(page(&made).contains("the cure has no meaning here"));
}

#[test]
fn every_open_quantity_is_a_key_of_the_thesis_scene() {
    let text = include_str!("../../../scenes/thesis.toml");
    for run in plan(true, &[]).iter().filter(|run| run.group == Group::Open) {
        let scene = scene::Scene::from_toml(text, "thesis.toml", &run.variant.overrides);
        let own = scene::Scene::from_toml(text, "thesis.toml", &[]).unwrap();
        match scene {
            Ok(scene) => assert_ne!(scene, own, "{} {} changes nothing", run.quantity, run.value),
            Err(error) => panic!("{} {}: {error}", run.quantity, run.value),
        }
    }
}
