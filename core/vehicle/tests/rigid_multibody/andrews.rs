//! Andrews' squeezing mechanism: seven bodies, three loops through one point, 30 ms in which the crank turns 2.5 times.
//! [IVP]
use super::mechanism::{InPlane, Mechanism, Moment, PointSpring, order, run, shown};
use dynamics::{NewtonOptions, State};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use vehicle::multibody::{Anchor, BaseMarker, BodyMarker, Joint, Pose};

// Parameters [IVP]: kg, kg m², m, N/m, N m.
const MASSES: [f64; 7] = [0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498];
const INERTIAS: [f64; 7] = [2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5];
const A: [f64; 2] = [-0.06934, -0.00227];
const B: [f64; 2] = [-0.03635, 0.03273];
const C: [f64; 2] = [0.014, 0.072];
const D: f64 = 28e-3;
const DA: f64 = 115e-4;
const E: f64 = 2e-2;
const EA: f64 = 1421e-5;
const RR: f64 = 7e-3;
const RA: f64 = 92e-5;
const SS: f64 = 35e-3;
const SA: f64 = 1874e-5;
const SB: f64 = 1043e-5;
const SC: f64 = 18e-3;
const SD: f64 = 2e-2;
const TA: f64 = 2308e-5;
const TB: f64 = 916e-5;
const U: f64 = 4e-2;
const UA: f64 = 1228e-5;
const UB: f64 = 449e-5;
const ZF: f64 = 2e-2;
const ZT: f64 = 4e-2;
const FA: f64 = 1421e-5;
const STIFFNESS: f64 = 4530.0;
const UNSTRESSED: f64 = 7785e-5;
const MOMENT: f64 = 33e-3;

/// β, Θ, γ, Φ, δ, Ω, ε at t = 0, rad. [IVP]
const START: [f64; 7] = [
    -0.061_713_890_014_276_45,
    0.0,
    0.455_279_819_163_070_4,
    0.222_668_390_165_885_9,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_9,
    1.230_547_444_549_821_2,
];

/// Accelerations of β and Θ at t = 0, rad/s²; those of the other angles are zero. [IVP]
const START_ACCELERATIONS: [f64; 2] = [14_222.443_919_954_14, -10_666.832_939_965_585];

/// The multipliers λ₁, λ₂ at t = 0, N; the others are zero. [IVP]
const START_MULTIPLIERS: [f64; 2] = [98.566_870_396_241_09, -6.122_688_344_255_662];

/// The angles at t = 0.03 s, rad. [IVP]
const END: [f64; 7] = [
    15.810_771_196_299_04,
    -15.756_371_059_842_98,
    0.040_822_240_130_731_01,
    -0.534_730_116_322_694_8,
    0.524_409_965_880_530_4,
    0.534_730_116_322_694_8,
    1.048_080_741_042_263,
];

/// Their rates at t = 0.03 s, rad/s. [IVP]
const END_RATES: [f64; 7] = [
    1_139.920_302_151_208,
    -1_424.379_294_994_111,
    11.032_912_219_371_34,
    19.293_374_644_213_85,
    0.573_569_928_479_080_8,
    -19.293_374_644_213_85,
    0.323_179_165_802_695_5,
];

/// The multipliers at t = 0.03 s, N. [IVP]
const END_MULTIPLIERS: [f64; 6] = [
    199.175_333_373_191,
    -29.755_312_280_150_52,
    23.066_541_190_983_99,
    31.452_713_654_759_27,
    22.642_492_320_827_39,
    11.617_407_000_196_73,
];

/// Angles of the seven bodies against the x axis, or a fixed direction, from those of the test set.
fn of_bodies([beta, theta, gamma, phi, delta, omega, epsilon]: [f64; 7]) -> [f64; 7] {
    [beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon]
}

/// `p` plus offsets `along` and `across` the direction `angle`, in the plane.
fn from(p: [f64; 2], angle: f64, along: f64, across: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [
        p[0] + along * cosine - across * sine,
        p[1] + along * sine + across * cosine,
    ]
}

fn point([x, y]: [f64; 2]) -> Vector3<f64> {
    Vector3::new(x, y, 0.0)
}

struct Squeezer {
    mechanism: Mechanism,
    poses: [Pose; 7],
    /// First multiplier of each loop.
    loops: [usize; 3],
}

/// The mechanism in its start position: seven revolute joints about z make the open chains, and the ends of bodies 3, 4
/// and 6 meet that of body 2.
fn squeezer() -> Squeezer {
    let mut mechanism = Mechanism::default();
    let angles = of_bodies(START);
    let [k1, k2, k3, k4, k5, k6, k7] = angles;
    let crank = from([0.0; 2], k1, RR, 0.0);
    let elbow_5 = from(A, k5, ZT, 0.0);
    let elbow_7 = from(A, k7, 0.0, -U);
    let centres = [
        from([0.0; 2], k1, RA, 0.0),
        from(crank, k2, -DA, 0.0),
        from(B, k3, SB, -SA),
        from(elbow_5, k4, 0.0, -(E - EA)),
        from(A, k5, TA, TB),
        from(elbow_7, k6, ZF - FA, 0.0),
        from(A, k7, -UB, -UA),
    ];
    let identity = UnitQuaternion::identity();
    let poses = std::array::from_fn(|k| {
        let inertia = Vector3::repeat(INERTIAS[k]); // the first two do not enter a plane motion
        mechanism.add_body(point(centres[k]), identity, (MASSES[k], inertia, 0.0))
    });
    let axes = Matrix3::identity();
    let marker = |k: usize, p: [f64; 2]| BodyMarker::at(poses[k - 1], &identity, &point(p), &axes);
    let on = |k: usize, p: [f64; 2]| Anchor::Body(marker(k, p));
    let ground = |p: [f64; 2]| {
        Anchor::Base(BaseMarker {
            position: point(p),
            axes,
        })
    };
    for (first, second) in [
        (ground([0.0; 2]), on(1, [0.0; 2])),
        (on(1, crank), on(2, crank)),
        (ground(B), on(3, B)),
        (ground(A), on(5, A)),
        (on(5, elbow_5), on(4, elbow_5)),
        (ground(A), on(7, A)),
        (on(7, elbow_7), on(6, elbow_7)),
    ] {
        mechanism.add_joint(Joint::revolute(first, second));
    }
    // The end of body 2 less that of the other one, as in the test set.
    let end_of_2 = from(crank, k2, -D, 0.0);
    let ends = [
        (3, from(B, k3, 0.0, -SS)),
        (4, from(elbow_5, k4, 0.0, -E)),
        (6, from(elbow_7, k6, ZF, 0.0)),
    ];
    let loops = ends.map(|(k, end)| mechanism.add_joint(InPlane(Joint::spherical(on(k, end), on(2, end_of_2)))));
    mechanism.add_load(Moment {
        pose: poses[0],
        moment: MOMENT,
    });
    mechanism.add_load(PointSpring {
        marker: marker(3, from(B, k3, SD, -SC)),
        fixed: point(C),
        stiffness: STIFFNESS,
        length: UNSTRESSED,
    });
    Squeezer {
        mechanism,
        poses,
        loops,
    }
}

const OPTIONS: NewtonOptions = NewtonOptions {
    tolerance: 1e-10,            // 1e-12 of the joint forces
    constraint_tolerance: 1e-15, // rounding at centimetres
    max_iterations: 50,
    jacobian: dynamics::Jacobian::Modified,
    formulation: dynamics::Formulation::Index3,
    passes: None,
};

/// Largest errors of the angles (rad), of the rates (of the largest one), and of the multipliers (of the largest one),
/// against the test set at 0.03 s, with the values themselves.
struct Found {
    angles: [f64; 7],
    rates: [f64; 7],
    multipliers: [f64; 6],
}

impl Found {
    fn at(squeezer: &Squeezer, state: &State) -> Self {
        let before = of_bodies(START);
        let near = of_bodies(END);
        let angles = std::array::from_fn(|k| {
            let rotation = &state.rotation[squeezer.poses[k].orientation];
            let angle = before[k] + 2.0 * rotation.k.atan2(rotation.w);
            // The turn next to the published angle.
            let turn = 2.0 * std::f64::consts::PI;
            angle + turn * ((near[k] - angle) / turn).round()
        });
        let rates = std::array::from_fn(|k| state.v[squeezer.poses[k].rotation + 2]);
        let multipliers = std::array::from_fn(|i| state.lambda[squeezer.loops[i / 2] + i % 2]);
        Self {
            angles,
            rates,
            multipliers,
        }
    }

    fn errors(&self) -> [f64; 3] {
        let far = |found: &[f64], published: &[f64]| {
            let differences = found.iter().zip(published).map(|(a, b)| (a - b).abs());
            differences.fold(0.0, f64::max)
        };
        [
            far(&self.angles, &of_bodies(END)),
            far(&self.rates, &of_bodies(END_RATES)) / END_RATES[0],
            far(&self.multipliers, &END_MULTIPLIERS) / END_MULTIPLIERS[0],
        ]
    }
}

#[test]
fn the_squeezing_mechanism_starts_with_the_published_accelerations_and_multipliers() {
    let mut squeezer = squeezer();
    let mut state = squeezer.mechanism.state();
    assert!(squeezer.mechanism.violation(&state) < 1e-16); // the published angles close the loops to rounding
    run(
        &mut squeezer.mechanism,
        &mut state,
        (1e-6, 0, 0.9),
        OPTIONS,
        &mut |_| {},
    );
    let [beta, theta] = START_ACCELERATIONS;
    let expected = of_bodies([beta, theta, 0.0, 0.0, 0.0, 0.0, 0.0]);
    for (k, expected) in expected.iter().enumerate() {
        let found = state.v_dot[squeezer.poses[k].rotation + 2];
        assert!((found - expected).abs() < 1e-7, "body {}: {found} rad/s²", k + 1); // 1e-11 of the crank's
    }
    let [first, second] = START_MULTIPLIERS;
    for (i, expected) in [first, second, 0.0, 0.0, 0.0, 0.0].into_iter().enumerate() {
        let found = state.lambda[squeezer.loops[i / 2] + i % 2];
        assert!((found - expected).abs() < 1e-9, "multiplier {}: {found} N", i + 1); // 1e-11 of the largest
    }
}

#[test]
fn the_squeezing_mechanism_ends_where_the_test_set_says() {
    let runs = [4e-6, 2e-6].map(|h| {
        let mut squeezer = squeezer();
        let mut state = squeezer.mechanism.state();
        let steps = (0.03_f64 / h).round() as usize;
        run(
            &mut squeezer.mechanism,
            &mut state,
            (h, steps, 0.9),
            OPTIONS,
            &mut |_| {},
        );
        assert!(squeezer.mechanism.violation(&state) < 1e-14, "{h}"); // rounding at centimetres
        Found::at(&squeezer, &state)
    });
    let errors = [runs[0].errors(), runs[1].errors()];
    println!(
        "angles, rates, multipliers: {} at 4 µs, {} at 2 µs",
        shown(&errors[0]),
        shown(&errors[1])
    );
    for (i, name) in ["angles", "rates", "multipliers"].iter().enumerate() {
        let order = order(errors[0][i], errors[1][i]);
        assert!((order - 2.0).abs() < 0.2, "{name}: order {order}");
    }
    // The error of second order is taken off: (4 fine − coarse)/3.
    let better = |fine: f64, coarse: f64| (4.0 * fine - coarse) / 3.0;
    let extrapolated = Found {
        angles: std::array::from_fn(|k| better(runs[1].angles[k], runs[0].angles[k])),
        rates: std::array::from_fn(|k| better(runs[1].rates[k], runs[0].rates[k])),
        multipliers: std::array::from_fn(|k| better(runs[1].multipliers[k], runs[0].multipliers[k])),
    };
    let extrapolated = extrapolated.errors();
    println!("extrapolated: {}", shown(&extrapolated));
    // Against the values at 30 ms themselves, of some 15 rad, 1000 rad/s and 200 N: (ω h)²/12 of a crank that turns by
    // 1000 rad/s in 2 µs would be 3e-7; springs and joint forces swing faster. The extrapolated values have seven
    // digits and more.
    for (i, name) in ["angles", "rates", "multipliers"].iter().enumerate() {
        assert!(errors[1][i] < 5e-6, "{name}: {:e}", errors[1][i]);
        assert!(extrapolated[i] < [5e-9, 2e-9, 5e-7][i], "{name}: {:e}", extrapolated[i]);
    }
    for (i, extrapolated) in extrapolated.into_iter().enumerate() {
        // Third-order terms of the joint forces are a tenth of those of second order.
        assert!(
            extrapolated < 0.15 * errors[1][i],
            "{extrapolated:e} of {:e}",
            errors[1][i]
        );
    }
}
