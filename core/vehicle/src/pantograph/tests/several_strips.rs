//! Strips fixed to the head of a linkage.
use super::*;
use crate::pantograph::{Linkage, ReducedLinkage};
use scene::{Body, CollectorSuspension, HeadStrip, Joint, JointKind, LinkageStrip, Uplift};

fn places(places: &[f64]) -> Vec<HeadStrip> {
    places.iter().map(|&x| HeadStrip::fixed(x)).collect()
}

fn built(entry: &scene::Linkage) -> Linkage {
    Linkage::new(entry, GRAVITY, "linkage", &mut Layout::new()).unwrap()
}

/// Distance of the head's centre of mass ahead of its hinge, m.
const AHEAD: f64 = 0.02;
const HEAD: f64 = 8.0;
const UPLIFT: f64 = 400.0;

/// Mast that slides up, a frame hinged on it, a head that slides on the frame: the head is free to pitch.
fn hinged(strips: &[f64]) -> scene::Linkage {
    let body = |name: &str, mass: f64, x: f64, z: f64| Body {
        name: name.into(),
        mass,
        position: [x, 0.0, z],
        orientation: [0.0; 3],
        inertia: [1.0; 3],
    };
    let joint = |kind, first: &str, second: &str, z| Joint {
        kind,
        first: first.into(),
        second: second.into(),
        point: [0.0, 0.0, z],
    };
    let upright = JointKind::Prismatic { axis: [0.0, 0.0, 1.0] };
    let lateral = JointKind::Revolute { axis: [0.0, 1.0, 0.0] };
    scene::Linkage {
        strip: LinkageStrip {
            width: 1.6,
            horns: None,
            body: "head".into(),
            offset: [-AHEAD, 0.0, 0.0],
        },
        strips: places(strips),
        base: [0.0, 0.0, 3.5],
        collector_suspension: CollectorSuspension {
            stiffness: 5000.0,
            damping: 0.0,
        },
        uplift: Uplift {
            force: UPLIFT,
            body: "mast".into(),
            distance: 0.5,
        },
        bodies: vec![
            body("mast", 10.0, 0.0, 4.0),
            body("frame", 2.0, 0.0, 4.9),
            body("head", HEAD, AHEAD, 5.0),
        ],
        joints: vec![
            joint(upright, "base", "mast", 3.5),
            joint(lateral, "mast", "frame", 4.9),
            joint(upright, "frame", "head", 5.0),
        ],
    }
}

#[test]
fn a_hinged_head_shares_the_force_by_the_balance_of_its_moments() {
    let linkage = built(&hinged(&[0.3, -0.3]));
    assert!(linkage.head().pitch);
    let total = UPLIFT - 20.0 * GRAVITY;
    // The weight of the head leans ahead of the hinge, so that the wire presses less on the strip ahead.
    let lean = HEAD * GRAVITY * AHEAD;
    let expected = [0.5 * total - lean / 0.6, 0.5 * total + lean / 0.6];
    for rest in [
        linkage.equilibrium_at_height(5.05).unwrap(),
        linkage.equilibrium_at_force(total).unwrap(),
    ] {
        assert!((rest.force - total).abs() < 1e-7, "{rest:?}");
        for (force, expected) in rest.strip_forces.iter().zip(expected) {
            assert!((force - expected).abs() < 1e-6, "{:?} {expected:?}", rest.strip_forces);
        }
    }
    // Under a wire that rises by 1 in 100 the head inclines, and its centre of mass moves back over the hinge.
    let heights = [5.053, 5.047];
    let rest = linkage.equilibrium_under(None, &heights).unwrap();
    for (height, wanted) in rest.strip_heights.iter().zip(heights) {
        assert!((height - wanted).abs() < 1e-9, "{:?}", rest.strip_heights);
    }
    let symmetric = built(&scene::Linkage {
        bodies: hinged(&[])
            .bodies
            .into_iter()
            .map(|body| Body {
                position: [0.0, 0.0, body.position[2]],
                ..body
            })
            .collect(),
        strip: LinkageStrip {
            offset: [0.0; 3],
            ..hinged(&[]).strip
        },
        ..hinged(&[0.3, -0.3])
    });
    let even = symmetric.equilibrium_at_height(5.05).unwrap().strip_forces;
    assert!((even[0] - even[1]).abs() < 1e-7, "{even:?}");
}

#[test]
fn a_head_that_its_mechanism_guides_shares_the_force_evenly_and_rests_as_under_its_middle() {
    let mut entry = thesis::thesis();
    entry.strips = places(&[0.4, -0.2]);
    let two = built(&entry);
    assert!(!two.head().pitch && two.rises() == vec![vec![1.0; 2]]);
    let mut middle = thesis::thesis();
    middle.strip.offset[0] += 0.1;
    let middle = built(&middle);
    for height in [4.8, 4.945, 5.1] {
        let (of_two, of_middle) = (
            two.equilibrium_at_height(height).unwrap(),
            middle.equilibrium_at_height(height).unwrap(),
        );
        // Forces of half the size act on a rigid head as the whole in their middle.
        assert!((of_two.force - of_middle.force).abs() < 1e-8 * of_middle.force);
        assert_eq!(of_two.strip_forces, vec![0.5 * of_two.force; 2]);
        let x = |linkage: &Linkage, rest| linkage.strip_position(rest).x;
        assert!((x(&two, &of_two) + 0.1 - x(&middle, &of_middle)).abs() < 1e-12);
    }
}

#[test]
fn a_reduced_linkage_has_the_strips_of_the_whole_one() {
    let mut entry = thesis::thesis();
    entry.strips = places(&[0.4, -0.2]);
    let full = built(&entry);
    let reduced = ReducedLinkage::new(&entry, GRAVITY, "linkage", &mut Layout::new()).unwrap();
    assert_eq!(reduced.strips(), 2);
    for height in [4.8, 5.1] {
        let (whole, one) = (
            full.equilibrium_at_height(height).unwrap(),
            reduced.equilibrium_at_height(height).unwrap(),
        );
        assert!((whole.force - one.force).abs() < 1e-6 * whole.force);
        for (a, b) in whole.strip_heights.iter().zip(&one.strip_heights) {
            assert!(
                (a - b).abs() < 1e-8,
                "{:?} {:?}",
                whole.strip_heights,
                one.strip_heights
            );
        }
        assert!(
            (whole.strip_heights[0] - whole.strip_heights[1]).abs() > 1e-6,
            "the mechanism turns its head"
        );
    }
}
