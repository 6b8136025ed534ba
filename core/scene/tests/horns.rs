//! Horns of a head: what is read is what was typed, and what no head can have is refused with its remedy.

use scene::{Horns, Scene};

const EN: &str = include_str!("../../../scenes/en50318-250.toml");
const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");

const HORNS: &str =
    "pantograph[1].strip={ width = 0.4, horns = { y = [0.25, 0.35, 0.5], z = [-0.005, -0.03, -0.12] } }";

fn read(text: &str, keys: &[&str]) -> Result<Scene, String> {
    let keys: Vec<String> = keys.iter().map(ToString::to_string).collect();
    Scene::from_toml(text, "x.toml", &keys).map_err(|error| error.to_string())
}

#[test]
fn horns_are_read_as_typed_and_survive_writing() {
    let scene = read(EN, &[HORNS]).unwrap();
    let expected = Horns {
        y: vec![0.25, 0.35, 0.5],
        z: vec![-0.005, -0.03, -0.12],
    };
    assert_eq!(scene.pantographs[0].horns(), Some(&expected));
    assert_eq!(scene.pantographs[0].half_length(), Some(0.5));
    assert_eq!(read(&scene.to_toml(), &[]).unwrap(), scene);
    let top = scene.pantographs[0].top().unwrap();
    assert_eq!(top.range(), [0.2, 0.5]);
    assert_eq!(top.at(0.1), [0.0; 3]);
    let plain = read(EN, &[]).unwrap();
    assert!(plain.pantographs[0].top().is_none() && plain.pantographs[0].half_length() == Some(0.6));
}

#[test]
fn points_that_are_no_horn_are_refused_with_the_remedy() {
    let refused = |y: &str, z: &str, expected: &str| {
        let key = format!("pantograph[1].strip={{ width = 0.4, horns = {{ y = {y}, z = {z} }} }}");
        let said = read(EN, &[&key]).unwrap_err();
        assert!(said.contains(expected), "{said}");
    };
    refused("[0.25, 0.3]", "[-0.1]", "horns.z");
    refused("[0.25, 0.3]", "[-0.1]", "must be 2, one for each entry of y");
    refused("[0.2]", "[-0.1]", "must be more than 0.2 m");
    refused("[0.3, 0.25]", "[-0.1, -0.2]", "horns.y[2]");
    refused("[0.3]", "[0.1]", "must be below 0 m");
    refused("[0.325, 0.45]", "[-0.125, -0.2]", "must be at most -0.25 m");
    refused("[]", "[]", "at least one");
}

#[test]
fn horns_are_refused_where_they_have_no_meaning() {
    let joint = read(EN, &[HORNS, "contact={ law = \"sliding_joint\" }"]).unwrap_err();
    assert!(
        joint.contains("pantograph[1].strip.horns") && joint.contains("sliding_joint"),
        "{joint}"
    );
    let planar = read(
        EN,
        &[HORNS, "catenary.stagger=[0.1, -0.1]", "model.reduce=[\"planar\"]"],
    )
    .unwrap_err();
    assert!(planar.contains("push it sideways"), "{planar}");
    assert!(
        read(EN, &[HORNS, "model.reduce=[\"planar\"]"]).is_ok(),
        "no wire leads there"
    );
    let modal = [HORNS, "catenary.stagger=[0.1, -0.1]", "model.reduce=[\"modal\"]"];
    let modal = read(EN, &modal).unwrap_err();
    assert!(modal.contains("lets strips lift the wire only"), "{modal}");
    let beyond = read(EN, &[HORNS, "catenary.stagger=[0.1, -0.6]"]).unwrap_err();
    assert!(beyond.contains("half the length of the head under"), "{beyond}");
    assert!(read(EN, &[HORNS, "catenary.stagger=[0.1, -0.45]"]).is_ok());
    let strip = "pantograph[1].strip={ width = 1.6, body = \"pan_head\", offset = [0, 0, 0], horns = { y = [0.9], z = \
                 [-0.1] } }";
    assert!(read(THESIS, &[strip]).is_ok());
    let tilted = "pantograph[1].bodies[6].orientation=[0, 0.3, 0]";
    let said = read(THESIS, &[strip, tilted]).unwrap_err();
    assert!(said.contains("third axis of its body"), "{said}");
}
