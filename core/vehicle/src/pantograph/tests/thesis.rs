//! The linkage of the thesis.
use scene::{CollectorSuspension, JointKind, LinkageStrip, Uplift};
use std::f64::consts::FRAC_PI_2;

/// [Thesis, Tables 2 and 3], with the joints where the bars of the tables meet.
pub(crate) fn thesis() -> scene::Linkage {
    let (up, down) = ([1.0, -1.0], [-1.0, 1.0]);
    let body = |name: &str, mass, x, z, theta, sense: [f64; 2], inertia| scene::Body {
        name: name.into(),
        mass,
        position: [x, 0.0, z],
        orientation: [sense[0] * FRAC_PI_2, theta, sense[1] * FRAC_PI_2],
        inertia,
    };
    let joint = |kind, first: &str, second: &str, x, z| scene::Joint {
        kind,
        first: first.into(),
        second: second.into(),
        point: [x, 0.0, z],
    };
    let revolute = JointKind::Revolute { axis: [0.0, 1.0, 0.0] };
    let upright = JointKind::Prismatic { axis: [0.0, 0.0, 1.0] };
    let mut bodies = vec![
        body(
            "lower_arm",
            32.18,
            11.26924156,
            3.84511275,
            0.5528807212,
            up,
            [0.31, 10.43, 10.65],
        ),
        body(
            "upper_arm",
            15.60,
            11.45796454,
            4.52440451,
            0.2896816713,
            down,
            [0.15, 7.76, 7.86],
        ),
        body(
            "lower_link",
            3.10,
            10.96436876,
            3.81940451,
            0.6234559506,
            up,
            [0.05, 0.46, 0.46],
        ),
        body(
            "upper_link",
            1.15,
            11.58587608,
            4.49940451,
            0.3028168645,
            down,
            [0.05, 0.48, 0.48],
        ),
        body("plunger", 1.51, 12.5, 4.835, 0.0, up, [0.07, 0.05, 0.07]),
        body("pan_head", 9.50, 12.5, 4.945, 0.0, up, [1.59, 0.21, 1.78]),
    ];
    for upright in &mut bodies[4..] {
        upright.orientation = [0.0; 3];
    }
    scene::Linkage {
        strips: Vec::new(),
        strip: LinkageStrip {
            width: 1.6,
            horns: None,
            body: "pan_head".into(),
            offset: [0.0; 3],
        },
        base: [11.95005378, 0.0, 3.425],
        collector_suspension: CollectorSuspension {
            stiffness: 9430.0,
            damping: 50.0,
        },
        uplift: Uplift {
            force: 1465.0,
            body: "lower_arm".into(),
            distance: 0.9557,
        },
        bodies,
        joints: vec![
            joint(revolute, "base", "lower_arm", 11.95005378, 3.425),
            joint(revolute, "lower_arm", "upper_arm", 10.58842934, 4.26522551),
            joint(revolute, "upper_arm", "plunger", 12.5, 4.835),
            joint(JointKind::Spherical, "base", "lower_link", 11.51280844, 3.425),
            joint(JointKind::Spherical, "upper_arm", "lower_link", 10.41592908, 4.21380902),
            joint(JointKind::Spherical, "plunger", "upper_link", 12.5, 4.785),
            joint(JointKind::Spherical, "lower_arm", "upper_link", 10.67175216, 4.21380902),
            joint(upright, "plunger", "pan_head", 12.5, 4.945),
        ],
    }
}
