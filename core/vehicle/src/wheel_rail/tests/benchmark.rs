//! The Manchester contact benchmark, case, against CONTACT.
use super::support::{Design, Wheelset, rows};
use crate::wheel_rail::WheelContact;
use dynamics::State;

const LEFT: &str = include_str!("../../../../../tests/data/manchester_contact/a22_left.csv");
const RIGHT: &str = include_str!("../../../../../tests/data/manchester_contact/a22_right.csv");

/// Vertical force on one wheel, N.
const LOAD: f64 = 10e3;

/// A row of the benchmark in our axes (y left, z up, force on the wheel), m, rad, N, Pa.
struct BenchmarkRow {
    /// Lateral displacement to the right, mm, as tabulated.
    shift: f64,
    up: f64,
    roll: f64,
    yaw: f64,
    spin: f64,
    /// Position of the contact.
    y: f64,
    angle: f64,
    normal_force: f64,
    /// Forces on the patch, along and across.
    tangential: [f64; 2],
    pressure: f64,
}

impl BenchmarkRow {
    fn read(text: &str) -> Vec<Self> {
        rows(text)
            .map(|row| Self {
                shift: row[0],
                up: -1e-3 * row[1],
                roll: row[2],
                yaw: -row[3],
                spin: -row[4],
                y: -1e-3 * row[8],
                angle: row[9],
                normal_force: row[13],
                tangential: [-row[14], row[15]],
                pressure: 1e6 * row[17],
            })
            .collect()
    }

    /// The wheelset in this position, and the contacts of a wheel.
    fn place(&self, wheel: usize) -> (Wheelset, State, Vec<WheelContact>) {
        let design = Design {
            spin: self.spin,
            ..Design::manchester()
        };
        let set = design.build();
        let state = set.loaded(wheel, LOAD, -1e-3 * self.shift, self.roll, self.yaw);
        let contacts = set.wheels[wheel].contacts(&state.motion(&[]));
        (set, state, contacts.into_iter().flatten().collect())
    }
}

/// Inclination of the tangent plane, as the reference counts it: positive where it rises to the right.
fn angle(contact: &WheelContact) -> f64 {
    (-contact.point.normal.y).atan2(contact.point.normal.z)
}

/// The reference location of CONTACT: the mean of y and of the inclination of the rail over the area where the
/// undeformed surfaces overlap, weighted with the square of the overlap. [eve70a/CONTACT, src/m_wr_locatecp.f90]
///
/// The overlap is a parabola along the rail, of which the integral of the square goes with δ^{5/2}.
fn weighted_location(set: &Wheelset, state: &State, wheel: usize) -> [f64; 2] {
    let parts = set.wheels[wheel].parts();
    let sign = parts.wheel.side.sign();
    let axes = state.rotation[0].to_rotation_matrix().into_inner();
    let rail_y = parts.rail.line.frame(0.0, 0.0).position.y;
    let mut sums = [0.0; 3];
    for i in 0..40_000 {
        let sigma = parts.wheel.profile.range()[1] * f64::from(i) / 40e3;
        let profile = parts.wheel.profile.at(sigma);
        // The lowest point of the wheel's circle, seen along the rail: the normal there is perpendicular to x.
        let phi = (-profile.first.y / profile.first.x * sign * axes[(0, 1)] / axes[(0, 0)]).asin();
        let point = parts.wheel.at(&axes, phi, &parts.wheel.profile.at(sigma)).position;
        let (y, z) = (state.q[1] + point.y, state.q[2] + parts.wheel.radius + point.z);
        let Some(at) = parts.rail.profile.parameter_at(sign * (y - rail_y)) else {
            continue;
        };
        let rail = parts.rail.profile.at(at);
        let overlap = rail.position.y - z;
        if overlap > 0.0 {
            let weight = overlap.powf(2.5);
            let inclination = sign * (rail.first.y / rail.first.x).atan();
            sums = [sums[0] + weight, sums[1] + weight * y, sums[2] + weight * inclination];
        }
    }
    [sums[1] / sums[0], sums[2] / sums[0]]
}

#[test]
fn a22_left_wheel_touches_where_contact_says() {
    let mut listed = 0;
    for row in BenchmarkRow::read(LEFT) {
        let (set, state, contacts) = row.place(0);
        let normal: f64 = contacts.iter().map(|contact| contact.normal_force).sum();
        assert!(
            (normal / row.normal_force - 1.0).abs() < 5e-3,
            "{} mm: {normal} N",
            row.shift
        ); // as asked
        // Hertz for a patch that is no ellipse.
        assert!((state.q[2] - row.up).abs() < 5e-6, "{} mm: z {}", row.shift, state.q[2]);
        // Definition of location of the reference, at the height of the reference; required are 0.5 mm and 1 mrad.
        let there = set.placed(-1e-3 * row.shift, row.up, row.roll, row.yaw);
        let [y, inclination] = weighted_location(&set, &there, 0);
        println!(
            "{} mm: weighted y {:.4} ({:.4}) mm, {:.2} ({:.2}) mrad",
            row.shift,
            1e3 * y,
            1e3 * row.y,
            1e3 * inclination,
            1e3 * row.angle
        );
        assert!((y - row.y).abs() < 0.02e-3, "{} mm: {y} {}", row.shift, row.y);
        assert!(
            (inclination - row.angle).abs() < 0.1e-3,
            "{} mm: {inclination} {}",
            row.shift,
            row.angle
        );
        // Point of largest overlap, if there is only one.
        if let [contact] = contacts[..] {
            let y = state.q[1] + contact.point.lever.y;
            assert!((y - row.y).abs() < 0.5e-3, "{} mm: y {y}, {}", row.shift, row.y); // as asked
            if row.shift >= 1.0 {
                assert!(
                    (angle(&contact) - row.angle).abs() < 1e-3,
                    "{} mm: {}",
                    row.shift,
                    angle(&contact)
                ); // as asked
                let pressure = contact.ellipse.largest_pressure();
                assert!(
                    (pressure / row.pressure - 1.0).abs() < 5e-3,
                    "{} mm: {pressure} Pa",
                    row.shift
                ); // ellipse or not
            }
            listed += 1;
        }
    }
    // All but the centred position, where the overlap has two maxima within one patch.
    assert_eq!(listed, 20);
}

#[test]
fn a22_creep_forces_are_those_of_the_exact_theory_to_the_error_of_fastsim() {
    let mut worst = 0.0_f64;
    for (wheel, text) in [LEFT, RIGHT].into_iter().enumerate() {
        for row in BenchmarkRow::read(text) {
            let (_, _, contacts) = row.place(wheel);
            let [contact] = contacts[..] else {
                continue;
            };
            // Overlap of the right wheel in one patch with a point of largest overlap at the end.
            if wheel == 1 && row.shift < 1.5 {
                continue;
            }
            let [x, y, _] = contact.creep;
            let difference = (x - row.tangential[0]).hypot(y - row.tangential[1]) / (0.3 * row.normal_force);
            worst = worst.max(difference);
            assert!(difference < 0.1, "{} mm: {x} {y} {:?}", row.shift, row.tangential); // 10 % [Kalker 1990]
        }
    }
    println!("largest difference {worst:.3} of μN");
}

#[test]
fn a22_right_wheel_climbs_from_the_tread_to_the_flange() {
    let mut places = Vec::new();
    for row in BenchmarkRow::read(RIGHT) {
        let (_, state, contacts) = row.place(1);
        for contact in &contacts {
            let y = state.q[1] + contact.point.lever.y;
            println!(
                "{:4.1} mm: y {:8.3} ({:8.3}) mm, angle {:6.3} ({:6.3}) rad, N {:6.0} ({:6.0}) N",
                row.shift,
                1e3 * y,
                1e3 * row.y,
                angle(contact),
                row.angle,
                contact.normal_force,
                row.normal_force
            );
        }
        let deepest = contacts
            .iter()
            .max_by(|a, b| a.normal_force.total_cmp(&b.normal_force))
            .unwrap();
        places.push((row.shift, angle(deepest)));
        if row.shift >= 1.5 && row.shift != 5.0 {
            let [contact] = contacts[..] else {
                panic!("{} contacts at {} mm", contacts.len(), row.shift)
            };
            let y = state.q[1] + contact.point.lever.y;
            // At the flange the friction, and with it the normal force, carries FASTSIM's error.
            assert!(
                (y - row.y).abs() < 0.5e-3 && (contact.normal_force / row.normal_force - 1.0).abs() < 0.012,
                "{} mm",
                row.shift
            );
            assert!(
                (angle(&contact) - row.angle).abs() < 8e-3,
                "{} mm: {}",
                row.shift,
                angle(&contact)
            ); // as 0.1 mm in the root
        }
    }
    // From the tread to the root between 4.5 and 5 mm, from the root to the flange between 6 and 6.5 mm.
    let at = |shift: f64| places.iter().find(|place| place.0 == shift).unwrap().1;
    assert!(at(4.5).abs() < 0.15 && at(5.0).abs() > 0.25 && at(6.0).abs() < 0.5 && at(6.5).abs() > 1.0);
}
