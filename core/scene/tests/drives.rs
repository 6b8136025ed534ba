//! Drives of `pantograph.control`: refused with the remedy, and written as they are read.

use scene::Scene;

const LUMPED: &str = include_str!("../../../scenes/thesis-controlled.toml");
const LINKAGE: &str = include_str!("../../../scenes/thesis-pantograph.toml");

fn read(text: &str, control: &str) -> Result<Scene, String> {
    let overrides = [format!("pantograph[1].control={{ sample_time=0.005, {control} }}")];
    Scene::from_toml(text, "x.toml", &overrides).map_err(|error| error.to_string())
}

#[test]
fn a_drive_that_cannot_be_is_refused_with_the_remedy() {
    let skyhook = |actuator: &str| format!("law=\"skyhook\", damping=300, actuator={{ {actuator} }}");
    for (text, control, said) in [
        (LUMPED, skyhook("mass=4"), "actuator.mass = 4: must be at most 3"),
        (
            LUMPED,
            skyhook("joint=\"a-b\""),
            "which has no joints: mass names what is driven",
        ),
        (
            LINKAGE,
            skyhook("mass=1"),
            "where its raising force acts, or on a joint",
        ),
        (
            LINKAGE,
            skyhook("joint=\"base-upper_arm\""),
            "\"base-upper_arm\": no such joint: must be one of \"base-lower_arm\", \"lower_arm-upper_arm\", \
             \"upper_arm-plunger\"",
        ),
        (
            LINKAGE,
            skyhook("joint=\"base-lower_link\""),
            "no revolute joint: must be one of",
        ),
        (
            LINKAGE,
            skyhook("joint=\"base-lower_arm\", limit=-3"),
            "actuator.limit = -3 N m",
        ),
        (
            LINKAGE,
            skyhook("joint=\"base-lower_arm\", rate_limit=0"),
            "actuator.rate_limit = 0 N m/s",
        ),
        (
            LINKAGE,
            "law=\"pid\", kp=-1, actuator={ joint=\"base-lower_arm\" }".to_owned(),
            "control.kp = -1 m:",
        ),
        (
            LINKAGE,
            "law=\"lqr\", effort_weight=1, wire_stiffness=3000, actuator={ joint=\"base-lower_arm\" }".to_owned(),
            "the gains of \"lqr\" are those of a lumped pantograph",
        ),
    ] {
        let told = read(text, &control).err().unwrap_or_else(|| "accepted".to_owned());
        assert!(told.contains(said), "{control}: {said:?} is not in:\n{told}");
    }
}

#[test]
fn a_drive_on_a_joint_survives_writing() {
    let control = "law=\"skyhook\", damping=300, \
                   actuator={ joint=\"base-lower_arm\", limit=60, rate_limit=900, lag=0.01 }";
    let scene = read(LINKAGE, control).unwrap();
    let again = Scene::from_toml(&scene.to_toml(), "again.toml", &[]).unwrap();
    assert_eq!(scene.pantographs[0].control, again.pantographs[0].control);
    let actuator = &again.pantographs[0].control.as_ref().unwrap().actuator;
    assert_eq!(
        (actuator.joint.as_deref(), actuator.unit()),
        (Some("base-lower_arm"), "N m")
    );
}
