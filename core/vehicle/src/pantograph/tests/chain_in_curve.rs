//! The lumped pantograph on a base that follows a curve.
use crate::check::{assert_tangent, force};
use crate::pantograph::ChainInertia;
use crate::track::Alignment;
use crate::{Base, Travel};
use dynamics::{Force, Layout};
use std::sync::Arc;

const SPEED: f64 = 60.0;

fn curve() -> scene::Curve {
    scene::Curve {
        radius: 1000.0,
        direction: scene::Direction::Right,
        cant: 0.15,
        start: 10.0,
        transition: 100.0,
        length: 200.0,
        rounding: 6.0,
    }
}

fn chain() -> (ChainInertia, Layout) {
    let mut layout = Layout::new();
    let base = Base {
        start_x: 0.0,
        speed: SPEED,
    };
    let chain = ChainInertia {
        travel: Travel::along(base, Alignment::new(&[curve()], 1.5).map(Arc::new)),
        first: layout.add_coordinates(2, "mass"),
        masses: vec![7.2, 15.0],
        lateral: 0.4,
        height: 5.3,
        gravity: 9.81,
    };
    (chain, layout)
}

#[test]
fn in_an_arc_the_leaning_weight_and_the_centrifugal_force_load_a_chain() {
    let (mut chain, layout) = chain();
    let mut state = layout.state_at_rest();
    state.t = 200.0 / SPEED;
    let found = force(&mut chain, &state.motion(&[]));
    let (sine, cosine) = curve().cant_angle(1.5).sin_cos();
    let centrifugal = SPEED * SPEED / 1000.0;
    // 5.3 m up a plane that leans, and 0.4 m to the outside of the curve, the radius is 5.3 m sin φ − 0.4 m cos φ
    // smaller.
    let turning = (SPEED / 1000.0).powi(2) * sine * (5.3 * sine - 0.4 * cosine);
    let expected = 9.81 * (1.0 - cosine) - centrifugal * sine + turning;
    println!("{} N/kg", found[0] / 7.2);
    assert!(
        (found[0] / 7.2 - expected).abs() < 1e-12 && (found[1] / 15.0 - expected).abs() < 1e-12,
        "{found}"
    );
}

#[test]
fn the_tangent_of_what_a_chain_feels_is_the_derivative_of_its_force() {
    let (mut chain, layout) = chain();
    let mut state = layout.state_at_rest();
    state.q.copy_from_slice(&[0.1, -0.2]);
    state.v.copy_from_slice(&[0.7, 0.4]);
    for place in [60.0, 109.0, 200.0] {
        state.t = place / SPEED;
        assert_tangent(&mut chain, &layout, &state, &[]);
        let motion = state.motion(&[]);
        let given: f64 = force(&mut chain, &motion)
            .iter()
            .zip(&state.v)
            .map(|(f, v)| f * v)
            .sum();
        assert_eq!(chain.power(&motion).unwrap().driven, given);
    }
}

#[test]
fn on_straight_track_a_chain_feels_nothing() {
    let (mut chain, layout) = chain();
    let state = layout.state_at_rest();
    assert_eq!(force(&mut chain, &state.motion(&[])).amax(), 0.0);
}
