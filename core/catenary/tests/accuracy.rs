//! `run.accuracy_percent`: what it chooses, and what it leaves alone.

use catenary::mesh::{error_shares, load, sum};
use scene::{Division, Reduction, Scene};

const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
const LUMPED: &str = include_str!("../../../scenes/thesis-lumped.toml");
const CONTROLLED: &str = include_str!("../../../scenes/thesis-controlled.toml");
const STITCHED: &str = include_str!("../../../scenes/ac-stitched.toml");
const SLIDING_JOINT: &str = include_str!("../../../scenes/thesis-sliding-joint.toml");

fn read(text: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    load(text, "x.toml", &overrides).unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(text: &str, overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    load(text, "x.toml", &overrides).unwrap_err().to_string()
}

fn expected(scene: &Scene) -> f64 {
    sum(&error_shares(scene, scene.internal_step()).unwrap())
}

fn elements(scene: &Scene) -> usize {
    let (catenary, _) = scene.modelled_line().unwrap();
    catenary.elements_per_span(catenary.mesh.division)
}

#[test]
fn expected_errors_add_up_to_no_more_than_the_wish() {
    for text in [EN_300, LUMPED, STITCHED] {
        for percent in [0.3, 1.0, 3.0, 10.0] {
            let wish = format!("run.accuracy_percent={percent}");
            let scene = read(text, &[&wish]);
            let sum = expected(&scene);
            assert!(sum <= percent * (1.0 + 1e-9), "{percent}: {sum} {}", scene.title);
            // The wish is used, not undercut by far.
            assert!(sum > 0.3 * percent, "{percent}: {sum} {}", scene.title);
            // A written scene runs as it was chosen.
            assert_eq!(read(&scene.to_toml(), &[]), scene);
        }
    }
}

#[test]
fn a_smaller_error_costs_more() {
    let rate = |percent: &str| {
        let scene = read(EN_300, &[percent]);
        elements(&scene) as f64 / scene.internal_step()
    };
    let rates = ["10", "3", "1", "0.3"].map(|percent| rate(&format!("run.accuracy_percent={percent}")));
    assert!(rates.windows(2).all(|pair| pair[0] < pair[1]), "{rates:?}");
}

#[test]
fn a_linear_line_is_chosen_where_its_error_leaves_room_for_a_mesh() {
    let linear = |wish: &str, more: &[&str]| {
        let keys = [&[wish][..], more].concat();
        read(EN_300, &keys).model.has(Reduction::Linearised)
    };
    let long = ["catenary.spans=40", "run.duration=25"];
    assert!(linear("run.accuracy_percent=3", &long) && !linear("run.accuracy_percent=0.3", &long));
    // Fixed ends make a line less linear.
    let fixed = [&long[..], &["catenary.wire_ends=fixed"]].concat();
    assert!(!linear("run.accuracy_percent=3", &fixed));
}

/// Reduction of its spans takes as long as a second of a short line.
#[test]
fn a_window_is_chosen_where_the_run_is_long_enough_for_its_set_up() {
    let windowed = |more: &[&str]| {
        let keys = [&["run.accuracy_percent=3"][..], more].concat();
        read(EN_300, &keys).model.has(Reduction::Window)
    };
    assert!(!windowed(&[]));
    assert!(windowed(&["catenary.spans=40", "run.duration=25"]));
}

#[test]
fn a_staggered_line_is_planar_where_its_arms_hardly_give_way() {
    let is_planar = |percent: &str, stiffness: &str| {
        let keys = [
            "catenary.stagger=[0.2, -0.2]",
            &format!("run.accuracy_percent={percent}"),
            &format!("catenary.registration_arms.lateral_stiffness={stiffness}"),
        ];
        read(EN_300, &keys).model.has(Reduction::Planar)
    };
    assert!(is_planar("1", "5e5"));
    assert!(!is_planar("1", "5e3") && !is_planar("0.3", "5e5"));
}

#[test]
fn given_keys_win() {
    let mesh = "catenary.mesh.elements_per_interval=4";
    let scene = read(EN_300, &["run.accuracy_percent=3", mesh]);
    assert_eq!(scene.modelled_line().unwrap().0.mesh.division, Division::PerInterval(4));
    let scene = read(EN_300, &["run.accuracy_percent=3", "model.reduce=none"]);
    assert!(scene.model.reductions.is_empty());
    let scene = read(EN_300, &["run.accuracy_percent=1", "solver.micro_step=5e-4"]);
    assert_eq!(scene.internal_step(), 5e-4);
    // So does a macro step of the file that is not chosen: beside such a micro step, and with samples of a control.
    let long = |text: &str| text.replace("macro_step = 0.001", "macro_step = 0.002");
    for (text, more) in [(EN_300, &["solver.micro_step=5e-4"][..]), (CONTROLLED, &[])] {
        let scene = read(&long(text), &[&["run.accuracy_percent=3"], more].concat());
        assert_eq!(scene.coupling.macro_step, 2e-3);
    }
    let scene = read(EN_300, &["run.accuracy_percent=1", "solver.newton_tolerance=1e-6"]);
    assert_eq!(scene.solver.newton_tolerance, 1e-6);
    // An error given to the mesh is its own.
    let scene = read(EN_300, &["run.accuracy_percent=3", "catenary.mesh.error_percent=0.5"]);
    let shares = error_shares(&scene, scene.internal_step()).unwrap();
    assert!(shares[0].percent.hypot(shares[1].percent) <= 0.5);
    // Beyond the wish, with all keys that decide given.
    let coarse = read(
        EN_300,
        &["run.accuracy_percent=0.3", "catenary.mesh.elements_per_interval=2"],
    );
    assert!(expected(&coarse) > 0.3 && coarse.model.reductions == [Reduction::Planar]);
}

#[test]
fn an_override_asks_anew_and_a_wish_in_the_file_leaves_its_keys_alone() {
    assert!(EN_300.contains("elements_per_interval = 8"), "the scene gives its mesh");
    let in_file = EN_300.replacen("[run]", "[run]\naccuracy_percent = 0.3", 1);
    let division = |scene: &Scene| scene.modelled_line().unwrap().0.mesh.division;
    assert_eq!(division(&read(&in_file, &[])), Division::PerInterval(8));
    assert!(elements(&read(EN_300, &["run.accuracy_percent=0.3"])) > elements(&read(EN_300, &[])));
    // The plain mesh of a thesis is left, and its wish for no corrections with it.
    assert!(!read(LUMPED, &["run.accuracy_percent=1"]).corrections().is_empty());
}

#[test]
fn a_scene_without_a_wish_is_as_before() {
    let scene = read(EN_300, &[]);
    assert!(scene.run.accuracy.is_none() && !scene.to_toml().contains("accuracy_percent"));
}

#[test]
fn wishes_that_no_rule_answers_are_refused() {
    for (text, overrides, reason) in [
        (EN_300, &["run.accuracy_percent=0.1"][..], "must be from 0.3 to 10 %"),
        (EN_300, &["run.accuracy_percent=20"], "must be from 0.3 to 10 %"),
        (EN_300, &["run.accuracy_percent=-1"], "must be from 0.3 to 10 %"),
        (
            EN_300,
            &["run.accuracy_percent=1", "catenary.damping.beta=0"],
            "no rule is known for catenary.damping.beta = 0 s",
        ),
    ] {
        let said = refusal(text, overrides);
        assert!(said.contains("run.accuracy_percent") && said.contains(reason), "{said}");
    }
}

#[test]
fn what_a_joint_cannot_have_is_not_chosen() {
    let scene = read(SLIDING_JOINT, &["run.accuracy_percent=10"]);
    assert!(expected(&scene) <= 10.0);
}
