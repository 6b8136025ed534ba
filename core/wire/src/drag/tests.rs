//! Drag on a wire: sums, differences, power.
use super::*;
use crate::NodeMap;
use dynamics::testing::{LawTrio, plain_layout, tangent};
use dynamics::{ByRange, CrossFlow, OnePass, Polar, SectionFlow, State};

const LENGTHS: [f64; 4] = [3.0, 2.5, 4.0, 1.5];

fn geometry(spatial: bool) -> Arc<WireGeometry> {
    let start = Vector3::new(10.0, 0.2, 5.0);
    let map = |node: usize| {
        if spatial {
            NodeMap::spatial(6 * node)
        } else {
            NodeMap::planar(4 * node)
        }
    };
    Arc::new(WireGeometry::straight(start, Vector3::x(), &LENGTHS, map))
}

fn drag(wind: Vector3<f64>) -> WireDrag {
    WireDrag::new(
        geometry(true),
        CrossFlow::new(1.225, 1.2, 0.012),
        Arc::new(Wind::uniform(wind)),
    )
}

/// A wire that bends and moves.
fn moving() -> State {
    let mut state = State::at_rest(30, 0, Vec::new());
    for (i, (q, v)) in state.q.iter_mut().zip(&mut state.v).enumerate() {
        *q = 0.05 * (1.7 * i as f64).sin();
        *v = 2.0 * (0.9 * i as f64).cos();
    }
    state
}

#[test]
fn the_whole_force_is_pressure_times_area_and_acts_in_the_middle() {
    let mut drag = drag(Vector3::new(-20.0, 15.0, 0.0));
    let state = State::at_rest(30, 0, Vec::new());
    let mut force = vec![0.0; 30];
    drag.add_force(&state.motion(&[]), &mut force);
    let whole: f64 = (0..5).map(|node| force[6 * node + 1]).sum();
    // ½ 1.225 · 15² · 1.2 · 0.012 over 11 m, rounding.
    let expected = 0.5 * 1.225 * 225.0 * 1.2 * 0.012 * 11.0;
    assert!((whole - expected).abs() < 1e-13 * expected);
    // A rigid turn about the start does the work of a moment F L/2; its slopes are one.
    let mut s = 0.0;
    let mut moment = 0.0;
    for node in 0..5 {
        moment += s * force[6 * node + 1] + force[6 * node + 4];
        s += LENGTHS.get(node).copied().unwrap_or(0.0);
    }
    assert!((moment - expected * 5.5).abs() < 1e-12 * expected);
    assert!((0..5).all(|node| force[6 * node] == 0.0 && force[6 * node + 2] == 0.0));
}

#[test]
fn the_tangent_is_the_derivative_by_the_velocities_and_symmetric() {
    let mut drag = drag(Vector3::new(-20.0, 15.0, 2.0));
    let state = moving();
    // Rounding 1e-15/h of forces of some 10 N, and h².
    let trio = LawTrio {
        v_step: 1e-5,
        tolerance: 1e-8,
        ..LawTrio::default()
    };
    trio.assert_damping(&mut drag, &plain_layout(30), &state, &[]);
    let damping = tangent(&mut drag, 30, &state.motion(&[]), Weights { q: 0.0, v: 1.0 });
    assert!((&damping - damping.transpose()).amax() < 1e-14);
}

#[test]
fn a_range_gets_what_the_whole_gives_there() {
    for (spatial, size) in [(true, 30), (false, 20)] {
        let law = CrossFlow::new(1.225, 1.2, 0.012);
        let mut drag = WireDrag::new(
            geometry(spatial),
            law,
            Arc::new(Wind::uniform(Vector3::new(3.0, 9.0, 5.0))),
        );
        let mut state = moving();
        for values in [&mut state.q, &mut state.v] {
            values.truncate(size);
        }
        assert_eq!(drag.by_range().is_some(), spatial);
        let mut whole = vec![0.0; size];
        drag.add_force(&state.motion(&[]), &mut whole);
        for range in [0..3, 5..14, 13..14, size - 1..size, 7..7] {
            let mut part = vec![0.0; size];
            drag.add_dynamic_force_within(range.clone(), &state.motion(&[]), &[], &mut part);
            assert_eq!(part[range.clone()], whole[range], "{spatial}");
        }
    }
}

#[test]
fn power_brought_in_less_power_lost_is_that_of_the_force() {
    let mut drag = drag(Vector3::new(-20.0, 15.0, 2.0));
    let state = moving();
    let motion = state.motion(&[]);
    let mut force = vec![0.0; 30];
    drag.add_force(&motion, &mut force);
    let expected: f64 = force.iter().zip(&state.v).map(|(q, v)| q * v).sum();
    let power = Force::power(&drag, &motion).unwrap();
    assert!((power.driven - power.dissipated - expected).abs() < 1e-12 * power.driven.abs().max(1.0)); // rounding
}

#[test]
fn a_wire_with_lift_has_the_tangent_of_its_force_and_is_pushed_up_by_air_from_the_side() {
    let polar = Polar::table(vec![-1.5, 0.2, 1.5], vec![1.1, 1.3, 0.9], vec![-0.4, 0.7, 0.2]);
    let law = SectionFlow::new(1.225, 0.03, polar);
    let wind = Arc::new(Wind::uniform(Vector3::new(-20.0, 15.0, 2.0)));
    let mut drag = WireDrag::new(geometry(true), law.clone(), wind);
    let trio = LawTrio {
        v_step: 1e-5,
        tolerance: 1e-8,
        ..LawTrio::default()
    };
    trio.assert_damping(&mut drag, &plain_layout(30), &moving(), &[]);
    let rest = State::at_rest(30, 0, Vec::new());
    let mut force = vec![0.0; 30];
    drag.add_force(&rest.motion(&[]), &mut force);
    let up: f64 = (0..5).map(|node| force[6 * node + 2]).sum();
    // The straight wire along x sees 11 m of the same air.
    let expected = law.force(&Vector3::new(-20.0, 15.0, 2.0), &Vector3::x()).z * 11.0;
    assert!((up - expected).abs() < 1e-12 * expected.abs());
}
