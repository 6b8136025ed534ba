use super::*;
use scene::Direction;

const DISTANCE: f64 = 1.5;

fn curve(direction: Direction) -> Curve {
    Curve {
        radius: 600.0,
        direction,
        cant: 0.12,
        start: 50.0,
        transition: 90.0,
        length: 200.0,
        rounding: 6.0,
    }
}

/// Point in the world.
impl Alignment {
    fn at(&self, s: f64) -> RailFrame {
        self.seen_from(s, 0.0)
    }
}

fn left() -> Alignment {
    Alignment::new(&[curve(Direction::Left)], DISTANCE).unwrap()
}

/// x, y of a clothoid with `θ = l²/(2A²)` by the series of the Fresnel integrals:
/// `x + i y = Σ iⁿ l^(4n/2+1) / ((2n+1) n! (2A²)ⁿ)`.
fn clothoid(length: f64, square: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    let mut factor = length;
    for n in 0..20 {
        let term = factor / (2.0 * f64::from(n) + 1.0);
        match n % 4 {
            0 => sum[0] += term,
            1 => sum[1] += term,
            2 => sum[0] -= term,
            _ => sum[1] -= term,
        }
        factor *= length * length / (2.0 * square) / f64::from(n + 1);
    }
    sum
}

#[test]
fn before_its_first_curve_the_track_is_the_x_axis() {
    for s in [-300.0, 0.0, 46.9] {
        let frame = left().at(s);
        assert!((frame.position - Vector3::new(s, 0.0, 0.0)).norm() < 1e-12); // rounding of a sum of 300 intervals
        assert_eq!(frame.axes, Matrix3::identity());
        assert_eq!(frame.direction, Vector3::x());
        assert_eq!([frame.bend, frame.turn, frame.turn_rate], [Vector3::zeros(); 3]);
    }
}

#[test]
fn a_transition_is_a_clothoid() {
    let alignment = left();
    let square = 600.0 * 90.0;
    for length in [0.0, 0.3, 17.0, 44.44, 89.99, 90.0] {
        let [x, y] = clothoid(length, square);
        let found = alignment.at(50.0 + length).position;
        // Rounding of a hundred terms of some 100 m.
        assert!(
            (found.x - 50.0 - x).abs() < 1e-12 * 100.0 && (found.y - y).abs() < 1e-12 * 100.0,
            "{length}"
        );
    }
    // The way out mirrors the way in.
    let [arrival, leaving] = [alignment.at(50.0), alignment.at(430.0)];
    let middle = alignment.at(240.0);
    let mirrored = |frame: &RailFrame| {
        let chord = frame.position - middle.position;
        [
            chord.dot(&middle.axes.column(0)).abs(),
            chord.dot(&Vector3::z().cross(&middle.direction)),
        ]
    };
    for (a, b) in mirrored(&arrival).into_iter().zip(mirrored(&leaving)) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}

#[test]
fn an_arc_keeps_its_distance_from_its_middle() {
    let alignment = left();
    let middle = |s: f64| {
        let frame = alignment.at(s);
        let left = Vector3::z().cross(&Vector3::new(frame.direction.x, frame.direction.y, 0.0));
        (frame.position + left * 600.0).xy()
    };
    for s in [140.0, 161.7, 300.3, 340.0] {
        assert!((middle(s) - middle(200.0)).norm() < 1e-10, "{s}");
    }
}

#[test]
fn behind_a_curve_the_track_goes_on_straight_in_its_new_direction() {
    let alignment = left();
    let [near, far] = [alignment.at(434.0), alignment.at(1434.0)];
    let heading: f64 = (200.0 + 90.0) / 600.0;
    let along = Vector3::new(heading.cos(), heading.sin(), 0.0);
    assert!((far.position - near.position - along * 1000.0).norm() < 1e-10);
    assert!((far.direction - along).norm() < 1e-14);
    assert_eq!([far.bend, far.turn, far.turn_rate], [Vector3::zeros(); 3]);
}

#[test]
fn position_and_axes_have_the_derivatives_they_are_given_with() {
    let alignment = left();
    let h = 1e-3;
    // In the straight, in all roundings, on ramps, in the arc, behind: away from the corners of κ' and D''.
    for s in [
        20.0, 48.6, 51.2, 70.0, 138.7, 141.9, 200.0, 338.0, 341.0, 400.0, 428.2, 431.7, 500.0,
    ] {
        let [plus, minus, frame] = [s + h, s - h, s].map(|place| alignment.seen_from(place, s - 1.3));
        // Central differences: h² of third derivatives below 1e-4, and rounding of 1 m by h, seen from nearby.
        let near = |a: Vector3<f64>, b: Vector3<f64>| (a - b).norm() < 2e-10;
        assert!(
            near((plus.position - minus.position) / (2.0 * h), frame.direction),
            "{s}"
        );
        assert!(near((plus.direction - minus.direction) / (2.0 * h), frame.bend), "{s}");
        assert!(near((plus.turn - minus.turn) / (2.0 * h), frame.turn_rate), "{s}");
        for axis in 0..3 {
            let rate = (plus.axes.column(axis) - minus.axes.column(axis)) / (2.0 * h);
            assert!(near(rate, frame.turn.cross(&frame.axes.column(axis))), "{s}");
        }
    }
}

#[test]
fn place_direction_and_lean_are_continuous_at_every_corner() {
    let alignment = left();
    for corner in [50.0, 140.0, 340.0, 430.0] {
        for edge in [corner - 3.0, corner, corner + 3.0] {
            let [before, after] = [edge - 1e-9, edge + 1e-9].map(|s| alignment.at(s));
            assert!((before.position - after.position).norm() < 3e-9);
            assert!((before.direction - after.direction).norm() < 1e-10);
            assert!((before.axes - after.axes).norm() < 1e-10);
            assert!((before.turn - after.turn).norm() < 1e-10);
        }
    }
}

#[test]
fn the_inner_rail_stays_level_and_the_outer_one_rises_by_the_cant() {
    for (direction, inner) in [(Direction::Left, 0.5), (Direction::Right, -0.5)] {
        let alignment = Alignment::new(&[curve(direction)], DISTANCE).unwrap();
        for (s, cant) in [(20.0, 0.0), (95.0, 0.06), (200.0, 0.12), (400.0, 0.04)] {
            let rail = |side: f64| {
                let offset = Vector3::new(0.0, side * DISTANCE, 0.0);
                alignment.at(s).beside([offset, Vector3::zeros(), Vector3::zeros()])
            };
            assert!(rail(inner).position.z.abs() < 1e-15);
            assert!((rail(-inner).position.z - cant).abs() < 1e-15);
        }
    }
}

#[test]
fn the_ends_of_a_cant_ramp_are_rounded_to_half_a_parabola() {
    let alignment = left();
    // D''= ramp/rounding over the rounding: D = ramp · rounding/8 at the corner.
    let at_corner = 2.0 * alignment.bend(50.0).rise[0];
    assert!((at_corner - 0.12 / 90.0 * 6.0 / 8.0).abs() < 1e-15, "{at_corner}");
    assert_eq!(alignment.bend(47.0).rise, [0.0; 3]);
}

#[test]
fn a_curve_to_the_right_mirrors_one_to_the_left() {
    let right = Alignment::new(&[curve(Direction::Right)], DISTANCE).unwrap();
    for s in [60.0, 200.0, 500.0] {
        let [a, b] = [left().at(s), right.at(s)];
        let mirrored = |vector: Vector3<f64>| Vector3::new(vector.x, -vector.y, vector.z);
        assert_eq!(a.position, mirrored(b.position));
        assert_eq!(a.bend, mirrored(b.bend));
        assert_eq!(a.turn, -mirrored(b.turn));
    }
}

#[test]
fn a_reverse_curve_ends_in_its_first_direction() {
    let curves = [
        curve(Direction::Left),
        Curve {
            start: 460.0,
            ..curve(Direction::Right)
        },
    ];
    let alignment = Alignment::new(&curves, DISTANCE).unwrap();
    let [first, last] = [alignment.at(10.0), alignment.at(900.0)];
    assert!((first.axes - last.axes).norm() < 1e-14);
    // As far to the left as twice the first curve has moved the track, and the way between both at its angle.
    let alone = left();
    let (end, between): (RailFrame, f64) = (alone.at(430.0), 30.0);
    let heading: f64 = 290.0 / 600.0;
    // The second curve, seen backwards from its end, is the first one turned by half a circle.
    let expected = 2.0 * end.position.y + between * heading.sin();
    assert!(
        (last.position.y - expected).abs() < 1e-10,
        "{} {expected}",
        last.position.y
    );
}

#[test]
fn an_offset_that_changes_along_a_line_has_its_derivatives() {
    let alignment = left();
    let offset = |s: f64| {
        [
            Vector3::new(0.0, 0.75 + 1e-3 * (0.3 * s).sin(), 2e-3 * (0.2 * s).cos()),
            Vector3::new(0.0, 3e-4 * (0.3 * s).cos(), -4e-4 * (0.2 * s).sin()),
            Vector3::new(0.0, -9e-5 * (0.3 * s).sin(), -8e-5 * (0.2 * s).cos()),
        ]
    };
    let at = |s: f64| alignment.at(s).beside(offset(s));
    let (s, h) = (77.0, 1e-3);
    let [plus, minus, frame] = [s + h, s - h, s].map(at);
    assert!(((plus.position - minus.position) / (2.0 * h) - frame.direction).norm() < 1e-10);
    assert!(((plus.direction - minus.direction) / (2.0 * h) - frame.bend).norm() < 1e-10);
}

#[test]
fn a_track_seen_from_another_place_is_the_same_track() {
    let alignment = left();
    for from in [20.0, 49.0, 97.3, 200.0, 341.0, 500.0] {
        let origin = alignment.at(from);
        for s in [30.0, 97.0, 97.3, 150.0, 339.0, 460.0] {
            let (seen, at) = (alignment.seen_from(s, from), alignment.at(s));
            let position = origin.position + origin.axes * (seen.position - Vector3::new(from, 0.0, 0.0));
            assert!((position - at.position).norm() < 1e-11, "{from} {s}");
            let vectors = [
                (seen.direction, at.direction),
                (seen.bend, at.bend),
                (seen.turn, at.turn),
                (seen.turn_rate, at.turn_rate),
            ];
            for (seen, at) in vectors {
                assert!((origin.axes * seen - at).norm() < 1e-13, "{from} {s}");
            }
            assert!((origin.axes * seen.axes - at.axes).norm() < 1e-13, "{from} {s}");
        }
    }
}
