use scene::Electrification::{self, Ac25Kv, Dc3Kv};
use scene::{Assessment, Scene};

use super::tests::{conditions, figures};
use super::*;

/// An assessment as it is typed behind a scene.
pub(crate) fn typed(text: &str) -> Assessment {
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

/// Mean 100 N, σ 20 N.
fn usual() -> Figures {
    figures(&[80.0, 120.0], 0.02)
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
        let all = limits(&conditions(Some(Ac25Kv), speed), &[usual()], &own);
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
        let known = limits(&conditions(Some(Ac25Kv), speed), &[usual()], &Assessment::default());
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
        ..usual()
    };
    let all = limits(&conditions(Some(Ac25Kv), 250.0), &[usual(), more], &typed(OWN));
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
    let mut with_space = conditions(None, 250.0);
    with_space.line.free_uplift = Some(0.12);
    let all = limits(&with_space, &[usual()], &typed(space));
    let [space] = &found(&all, "EN 50119", "free_uplift")[..] else {
        panic!()
    };
    assert!((space.limit.unwrap() - 0.15).abs() < 1e-12); // rounding of the product
    assert_eq!((space.value, space.pass), (Some(0.12), Some(false)));
}

#[test]
fn where_no_row_is_for_the_case_what_the_program_knows_stays_and_a_standard_of_its_own_is_undecided() {
    let own = typed(OWN);
    for (system, quantity) in [(Some(Dc3Kv), "mean"), (None, "mean"), (Some(Ac25Kv), "std")] {
        let conditions = conditions(system, 250.0);
        let [all, known] = [&own, &Assessment::default()].map(|of| limits(&conditions, &[usual()], of));
        assert_eq!(
            found(&all, "EN 50367", quantity),
            found(&known, "EN 50367", quantity),
            "{quantity}"
        );
    }
    let slow = "[[assessment.limit]]\nstandard = \"Manual:1\"\nclause = \"1\"\nquantity = \"max\"\nvalue = 1.0\n\
                up_to_kmh = 100";
    let all = limits(&conditions(None, 250.0), &[usual()], &typed(slow));
    let [max] = &found(&all, "Manual", "max")[..] else {
        panic!()
    };
    assert_eq!((max.applicable, max.pass, max.limit), (false, None, None));
    assert!(max.reason.contains("is for other speeds"), "{}", max.reason);
}

#[test]
fn rows_of_an_edition_that_does_not_count_replace_nothing() {
    // Known: 70 + 0.00097 v² = 130.6 N at 250 km/h.
    for (editions, edition, expected) in [
        ("[\"EN 50367:2012\"]", "2012", 130.625),
        ("[\"EN 50367:2020\"]", "2020", 133.5),
    ] {
        let text = OWN.replace("source =", &format!("editions = {editions}\nsource ="));
        let all = limits(&conditions(Some(Ac25Kv), 250.0), &[usual()], &typed(&text));
        let [mean] = &found(&all, "EN 50367", "mean")[..] else {
            panic!()
        };
        assert_eq!(mean.edition, edition);
        assert!((mean.limit.unwrap() - expected).abs() < 1e-9); // rounding of km/h
    }
}

#[test]
fn the_shipped_file_of_rows_decides_as_the_program_does() {
    let rows: String = include_str!("../../../../standards/limits.toml").replace("[[limit]]", "[[assessment.limit]]");
    let own = typed(&format!("[assessment]\n{rows}"));
    for system in Electrification::ALL.iter().copied().map(Some).chain([None]) {
        for speed in [100.0, 160.0, 200.0, 200.5, 250.0, 320.0] {
            let conditions = conditions(system, speed);
            let [all, known] = [&own, &Assessment::default()].map(|of| limits(&conditions, &[usual()], of));
            let decided = |limits: &[Limit]| -> Vec<(String, Option<bool>, Option<f64>)> {
                let rounded = |limit: f64| (1e9 * limit).round() / 1e9; // order of the sum
                let of = |limit: &Limit| (limit.quantity.clone(), limit.pass, limit.limit.map(rounded));
                limits.iter().map(of).collect()
            };
            assert_eq!(decided(&all), decided(&known), "{system:?} {speed}");
        }
    }
}

#[test]
fn a_standard_that_the_program_does_not_know_is_added() {
    let all = limits(&conditions(None, 250.0), &[usual(), usual()], &typed(OWN));
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
    let known = limits(&conditions(Some(Ac25Kv), 250.0), &[usual()], &Assessment::default());
    let at_rest = limits_at_rest(
        &conditions(None, 250.0).line,
        (60.0, 1),
        (Some(1e-3), None),
        Some((0.3, Some(1.6))),
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
    let all = limits(&conditions(Some(Ac25Kv), 250.0), &[usual()], &only);
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
