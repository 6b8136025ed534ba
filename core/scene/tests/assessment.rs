//! Limits of the user's own and editions of standards, in the scene or in a file.

use scene::{Files, LimitedQuantity, Mark, Scene, SceneFile};

const EN: &str = include_str!("../../../scenes/en50318-250.toml");
const LIMITS: &str = include_str!("../../../standards/limits.toml");

/// A scene of EN 50318 with these tables behind its own, and files beside it.
fn read(tables: &str, files: &[(&str, &str)]) -> Result<Scene, String> {
    let (scene, ranges) = EN.split_once("[ranges]").unwrap();
    let text = format!("{scene}\n{tables}\n[ranges]{ranges}");
    let opened = Files::new(|path| {
        let found = files.iter().find(|(name, _)| *name == path);
        found
            .map(|(_, text)| (*text).to_owned())
            .ok_or_else(|| "cannot be read".to_owned())
    });
    let read = SceneFile::read(&text, "x.toml", &[], &opened);
    let read = read.and_then(|file| file.check(&|_| Vec::new()).map(|()| file.scene));
    read.map_err(|error| error.to_string())
}

#[test]
fn a_file_of_limits_is_taken_in_and_the_written_scene_needs_it_no_more() {
    let from = "[assessment]\nfrom = \"limits.toml\"\neditions = [\"EN 50367:2012\"]";
    let scene = read(from, &[("limits.toml", LIMITS)]).unwrap();
    let rows = &scene.assessment.limits;
    assert_eq!(
        (rows.len(), rows[2].quantity, rows[2].factor),
        (3, LimitedQuantity::Std, Some(0.3))
    );
    assert_eq!(
        (rows[0].name(), rows[0].mark, rows[0].speed_squared),
        ("EN 50367", Mark::Cited, 0.00047)
    );
    assert_eq!(Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap(), scene);
    // A scene without the table has none when it is written.
    assert!(!read("", &[]).unwrap().to_toml().contains("assessment"));
}

#[test]
fn wrong_rows_are_refused_with_key_value_and_what_would_be_right() {
    let row = |keys: &str| {
        format!("[[assessment.limit]]\nstandard = \"EN 50367:2020\"\nclause = \"7\"\nquantity = \"mean\"\n{keys}")
    };
    for (tables, parts) in [
        (row(""), vec!["assessment.limit[1].value", "\"mean\" in N"]),
        (
            row("value = 1.0\nfactor = 0.3"),
            vec!["assessment.limit[1].factor", "held against a number"],
        ),
        (
            row("value = 1.0\nabove_kmh = 200\nup_to_kmh = 160"),
            vec!["up_to_kmh = 160", "more than above_kmh = 200 km/h"],
        ),
        (row("value = nan"), vec!["assessment.limit[1].value"]),
        (row("value = 1.0\nsystem = \"ac_26kv\""), vec!["system", "ac_25kv"]),
        (row("value = 1.0\nmark = \"sure\""), vec!["mark", "remembered"]),
        (row("value = 1.0\npantographs = [2, 1]"), vec!["pantographs"]),
        (
            row("value = 1.0").replace(":2020", ""),
            vec!["standard = \"EN 50367\"", "edition behind a colon"],
        ),
        (
            row("value = 1.0").replace("\"mean\"", "\"median\""),
            vec!["quantity", "mean"],
        ),
        (row("valeu = 1.0"), vec!["assessment.limit[1].valeu", "value"]),
        (
            "[assessment]\neditions = [\"EN 50367:2020\"]".to_owned(),
            vec![
                "assessment.editions = \"EN 50367:2020\"",
                "EN 50367:2012",
                "[[assessment.limit]]",
            ],
        ),
        (
            "[assessment]\neditions = 3".to_owned(),
            vec!["assessment.editions = 3", "EN 50367:2012"],
        ),
        (
            "[assessment]\nfrom = \"no.toml\"".to_owned(),
            vec!["assessment.from", "no.toml", "cannot be read"],
        ),
    ] {
        let message = read(&tables, &[]).unwrap_err();
        for part in parts {
            assert!(message.contains(part), "no {part:?} in\n{message}");
        }
    }
    // A problem in the file is told with its name and line.
    let wrong = LIMITS.replace("speed_squared = 0.00047", "speed_squared = \"v\"");
    let message = read("[assessment]\nfrom = \"limits.toml\"", &[("limits.toml", &wrong)]).unwrap_err();
    assert!(message.contains("limits.toml:20"), "{message}");
}
