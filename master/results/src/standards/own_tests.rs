use scene::Electrification::{self, Ac25Kv, Dc3Kv};
use scene::{Assessment, Scene};

use super::*;

/// An assessment as it is typed behind a scene.
fn typed(text: &str) -> Assessment {
    const EN_250: &str = include_str!("../../../../scenes/en50318-250.toml");
    let (scene, ranges) = EN_250.split_once("[ranges]").unwrap();
    let text = format!("{scene}\n{text}\n[ranges]{ranges}");
    Scene::from_toml(&text, "own.toml", &[]).unwrap().assessment
}

const OWN: &str = r#"
[assessment]
source = "own copy"

[[assessment.limit]]
standard = "EN 50367:2020"
clause = "7.3"
quantity = "mean"
system = "ac"
up_to_kmh = 200
value = 91.0
speed_squared = 0.0005

[[assessment.limit]]
standard = "EN 50367:2020"
clause = "7.3"
quantity = "mean"
system = "ac"
above_kmh = 200
value = 71.0
speed_squared = 0.001
mark = "remembered"

[[assessment.limit]]
standard = "EN 50367:2020"
clause = "7.4"
quantity = "std"
pantographs = [2, 9]
factor = 0.25
text = "spread of the trailing head"

[[assessment.limit]]
standard = "Line manual:3"
clause = "5"
quantity = "min"
value = 20.0
"#;

fn conditions(system: Option<Electrification>, speed_kmh: f64) -> Conditions {
    Conditions {
        line: Line {
            electrification: system,
            wave_speed: Some(120.0),
            free_uplift: Some(0.12),
            uplift_stop: false,
        },
        speed: speed_kmh / 3.6,
        low_pass_hz: 20.0,
        filter: Filter::ZeroPhase,
        output_step: 1e-3,
        uplift: Some(0.05),
    }
}

/// Mean 100 N, σ 20 N.
fn figures() -> Figures {
    Figures {
        force: ForceStatistics::of(&[80.0, 120.0]),
        vertical_amplitude: Some(0.02),
        loss_of_contact: Some(0.0),
        arcing: Some(0.0),
        section: 120.0,
        longest_span: Some(60.0),
    }
}

fn found(all: &[Limit], standard: &str, quantity: &str) -> Vec<Limit> {
    let wanted = |limit: &&Limit| limit.standard == standard && limit.quantity == quantity;
    all.iter().filter(wanted).cloned().collect()
}

#[test]
fn rows_of_the_user_stand_in_place_of_the_limits_of_the_same_standard_and_quantity_and_are_named() {
    let own = typed(OWN);
    for (speed, expected, certainty) in [
        // By hand: 91 + 0.0005 v², 71 + 0.001 v².
        (100.0, 96.0, Certainty::Standard),
        (200.0, 111.0, Certainty::Standard),
        (250.0, 133.5, Certainty::Remembered),
    ] {
        let all = limits(&conditions(Some(Ac25Kv), speed), &[figures()], &own);
        let [mean] = &found(&all, "EN 50367", "mean")[..] else {
            panic!()
        };
        assert!(
            (mean.limit.unwrap() - expected).abs() < 1e-9,
            "{speed}: {:?}",
            mean.limit
        ); // rounding of km/h
        assert_eq!((mean.edition.as_str(), mean.clause.as_str()), ("2020", "2020, 7.3"));
        assert_eq!((mean.source.as_deref(), mean.certainty), (Some("own copy"), certainty));
        assert_eq!((mean.pass, mean.pantograph), (Some(100.0 <= expected), Some(1)));
        // Other quantities are those that the program knows.
        let known = limits(&conditions(Some(Ac25Kv), speed), &[figures()], &Assessment::default());
        assert_eq!(
            found(&all, "EN 50367", "mean_lower"),
            found(&known, "EN 50367", "mean_lower")
        );
        assert_eq!(found(&all, "EN 50119", "max"), found(&known, "EN 50119", "max"));
    }
}

#[test]
fn a_factor_multiplies_the_mean_of_the_same_pantograph_or_the_uplift() {
    let more = Figures {
        force: ForceStatistics::of(&[120.0, 180.0]),
        ..figures()
    };
    let all = limits(&conditions(Some(Ac25Kv), 250.0), &[figures(), more], &typed(OWN));
    let std = found(&all, "EN 50367", "std");
    let limits_of: Vec<(Option<f64>, Option<bool>)> = std.iter().map(|limit| (limit.limit, limit.pass)).collect();
    // 0.25 · 100 N over σ = 20 N; 0.25 · 150 N over σ = 30 N.
    assert_eq!(limits_of, [(Some(25.0), Some(true)), (Some(37.5), Some(true))]);
    assert!(
        std[0].remark.starts_with("spread of the trailing head; 0.25 times"),
        "{}",
        std[0].remark
    );

    let space = "[[assessment.limit]]\nstandard = \"EN 50119:2020\"\nclause = \"5\"\nquantity = \"free_uplift\"\n\
                 factor = 3.0";
    let all = limits(&conditions(None, 250.0), &[figures()], &typed(space));
    let [space] = &found(&all, "EN 50119", "free_uplift")[..] else {
        panic!()
    };
    assert!((space.limit.unwrap() - 0.15).abs() < 1e-12); // rounding of the product
    assert_eq!((space.value, space.pass), (Some(0.12), Some(false)));
}

#[test]
fn a_row_for_another_case_leaves_the_limit_undecided_with_the_reason() {
    let own = typed(OWN);
    for (system, count, quantity, reason) in [
        (Some(Dc3Kv), 1, "mean", "none of the 2 rows of own copy"),
        (None, 1, "mean", "none of the 2 rows"),
        (Some(Ac25Kv), 1, "std", "another number of pantographs"),
    ] {
        let all = limits(&conditions(system, 250.0), &vec![figures(); count], &own);
        for limit in found(&all, "EN 50367", quantity) {
            assert_eq!(
                (limit.applicable, limit.pass, limit.limit),
                (false, None, None),
                "{quantity}"
            );
            assert!(limit.reason.contains(reason), "{}", limit.reason);
        }
    }
}

#[test]
fn a_standard_that_the_program_does_not_know_is_added() {
    let all = limits(&conditions(None, 250.0), &[figures(), figures()], &typed(OWN));
    let own = found(&all, "Line manual", "min");
    assert_eq!(own.len(), 2);
    assert!(
        own.iter()
            .all(|limit| limit.bound == Bound::Above && limit.pass == Some(true))
    );
    // The one of EN 50119 still stands.
    assert_eq!(found(&all, "EN 50119", "min").len(), 2);
}

#[test]
fn editions_choose_among_limits_and_those_of_the_program_are_the_ones_a_scene_may_name() {
    let known = limits(&conditions(Some(Ac25Kv), 250.0), &[figures()], &Assessment::default());
    let at_rest = limits_at_rest(
        &conditions(None, 250.0).line,
        (60.0, 1),
        (Some(1e-3), None),
        &Assessment::default(),
    );
    for edition in scene::EDITIONS {
        assert!(known.iter().any(|limit| limit.edition_name() == edition), "{edition}");
    }
    for limit in known.iter().chain(&at_rest) {
        assert!(
            scene::EDITIONS.contains(&limit.edition_name().as_str()),
            "{}",
            limit.edition_name()
        );
    }
    let only = typed("[assessment]\neditions = [\"EN 50367:2012\", \"TSI ENE:2014\"]");
    let all = limits(&conditions(Some(Ac25Kv), 250.0), &[figures()], &only);
    let quantities: Vec<&str> = all.iter().map(|limit| limit.quantity.as_str()).collect();
    assert_eq!(quantities, ["mean", "mean_lower", "arcing"]);
}

#[test]
fn a_value_closer_to_its_limit_than_the_computation_is_certain_is_told() {
    let mut limit = Limit::new(("X", "1", "1"), "std", Some(29.9), "N").bounded(Bound::Below, 30.0);
    limit.decide();
    assert!(!limit.is_close(), "no tolerance is known");
    limit.tolerance = Some(0.2);
    assert!(limit.is_close());
    limit.tolerance = Some(0.05);
    assert!(!limit.is_close());
    limit.tolerance = Some(0.2);
    limit.pass = None;
    assert!(!limit.is_close(), "nothing was decided");
}
