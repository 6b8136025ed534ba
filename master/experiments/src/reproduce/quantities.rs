//! The quantities that the thesis leaves open.

use super::open::{Open, Values};

/// Why the vehicle is changed on the thesis' mesh only.
const SMOOTH: Option<&str> = Some(
    "on straight smooth track nothing but the contact force excites the vehicle, on any mesh: without any vehicle the force differs \
     by 0.1 % of its standard deviation (study --sweeps vehicle)",
);

/// All of them. The scene's own value is computed by the case itself.
pub const OPEN: &[Open] = &[
    Open {
        quantity: "contact stiffness k",
        case: 0,
        values: Values::Of {
            key: "contact.stiffness",
            unit: "N/m",
            values: &["10000.0", "20000.0", "100000.0", "200000.0", "1000000.0"],
        },
        range: "Thesis, Eq. (17), gives none; EN 50318 has 5e4, the literature 1e4 to 1e6",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "contact damping d",
        case: 0,
        values: Values::Of {
            key: "contact.damping",
            unit: "N s/m",
            values: &["10.0", "50.0", "100.0", "300.0"],
        },
        range: "Thesis, Eq. (17), gives none; 300 N s/m is a fifth of critical for the pan-head on k",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "dropper positions",
        case: 0,
        values: Values::Of {
            key: "catenary.droppers.positions",
            unit: "m",
            values: &[
                "[4.5, 11.25, 18.0, 24.75, 31.5, 38.25, 45.0, 51.75]",
                "[5.0, 11.6071, 18.2143, 24.8214, 31.4286, 38.0357, 44.6429, 51.25]",
                "[8.0, 13.75, 19.5, 25.25, 31.0, 36.75, 42.5, 48.25]",
                "[8.035714, 16.071429, 24.107143, 32.142857, 40.178571, 48.214286]",
                "[5.625, 11.25, 16.875, 22.5, 28.125, 33.75, 39.375, 45.0, 50.625]",
            ],
        },
        range: "not given; evenly spaced between first and last ones 4.5 m, 5 m and 8 m from a support, six and nine of them (where elements are one per interval, the mesh changes with them)",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "stiffness of the head suspension",
        case: 0,
        values: Values::Of {
            key: "pantograph[1].collector_suspension.stiffness",
            unit: "N/m",
            values: &["4500.0", "7000.0", "15000.0", "30000.0", "100000.0"],
        },
        range: "not given; published lumped models have 4.2 (EN 50318) to 9.4 kN/m (DSA 380), one 53 kN/m; 100 kN/m is nearly rigid",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "damping of the head suspension",
        case: 0,
        values: Values::Of {
            key: "pantograph[1].collector_suspension.damping",
            unit: "N s/m",
            values: &["0.0", "20.0", "100.0", "200.0"],
        },
        range: "not given; published lumped models have 0 to 45 N s/m; 200 N s/m is a third of critical",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "point of the uplift force on the lower arm",
        case: 0,
        values: Values::Of {
            key: "pantograph[1].uplift.distance",
            unit: "m",
            values: &["0.8", "0.9", "1.0", "1.1"],
        },
        range: "not given; from the arm's centre of mass towards the knee. It sets the mean force, which the scene calibrates",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "damping of the wires, mass part",
        case: 0,
        values: Values::Of {
            key: "catenary.damping.alpha",
            unit: "1/s",
            values: &["0.0", "0.05", "0.1"],
        },
        range: "not given; EN 50318:2018 has 0.0125, measured lines 0.01 to 0.1",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "damping of the wires, stiffness part",
        case: 0,
        values: Values::Of {
            key: "catenary.damping.beta",
            unit: "s",
            values: &["0.0", "1e-5", "1e-3"],
        },
        range: "not given; EN 50318:2018 has 1e-4",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "mass of the registration arm",
        case: 0,
        values: Values::Of {
            key: "catenary.registration_arms.mass",
            unit: "kg",
            values: &["0.5", "1.0", "2.0"],
        },
        range: "the thesis says low inertia; papers on EN 50318 take 1 kg",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "vertical stiffness of the registration arm",
        case: 0,
        values: Values::Of {
            key: "catenary.registration_arms.vertical_stiffness",
            unit: "N/m",
            values: &["50.0", "300.0", "1000.0"],
        },
        range: "not given; an arm that swings has next to none, papers on EN 50318 take 300 N/m",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "vertical stiffness of the messenger's supports",
        case: 0,
        values: Values::Of {
            key: "catenary.supports.messenger_vertical_stiffness",
            unit: "N/m",
            values: &["1e5", "2e6", "1e7"],
        },
        range: "not given; EN 50318 has 5e5",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "encumbrance",
        case: 0,
        values: Values::Of {
            key: "catenary.encumbrance",
            unit: "m",
            values: &["0.9", "1.05", "1.4"],
        },
        range: "not given; lines for 200 km/h have 0.9 to 1.6 m",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "presag of the contact wire",
        case: 0,
        values: Values::Of {
            key: "catenary.presag",
            unit: "m",
            values: &["0.028", "0.056"],
        },
        range: "the thesis says straight; 0.5 and 1 per mille of the span",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "low-pass filter",
        case: 0,
        values: Values::Of {
            key: "run.low_pass_hz",
            unit: "Hz",
            values: &["10.0", "40.0", "100.0"],
        },
        range: "the thesis does not say whether its force is filtered; EN 50317 asks for 20 Hz. The column of the raw force has no filter",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "time step",
        case: 0,
        values: Values::Of {
            key: "solver.micro_step",
            unit: "s",
            values: &["0.00025", "0.0005"],
        },
        range: "not given",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "mass of a dropper",
        case: 0,
        values: Values::Of {
            key: "catenary.droppers.mass",
            unit: "kg",
            values: &["0.2", "0.5"],
        },
        range: "not given; the scene's droppers have none. 1 m of bronze rope of 10 mm2 has 0.1 kg, the clamps of both ends 0.1 to 0.4 kg",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "longitudinal stiffness of the messenger's supports",
        case: 0,
        values: Values::Of {
            key: "catenary.supports.messenger_longitudinal_stiffness",
            unit: "N/m",
            values: &["1e5", "1e7"],
        },
        range: "not given; a cantilever that swings has none, a clamp on a fixed beam holds the wire",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "ends of the wires",
        case: 0,
        values: Values::Of {
            key: "catenary.wire_ends",
            unit: "",
            values: &["\"constant_tension\""],
        },
        range: "the thesis tensions by nodal displacement, which the scene reads as fixed ends; lines for 200 km/h have tensioning weights",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "start along the line",
        case: 0,
        values: Values::Of {
            key: "run.start_x",
            unit: "m",
            values: &["84.375", "281.25"],
        },
        range: "not given; half a span on (the 444 m evaluated hold no whole number of spans), and four spans on: farther from the fixed end",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "track irregularities",
        case: 0,
        values: Values::Together(&[
            (
                "ORE B176, low level",
                &[concat!(
                    "track.irregularities={ model = \"spectrum\", seed = 1, wavelengths = [3.0, 80.0], vertical_roughness = 4.032e-7, ",
                    "lateral_roughness = 2.119e-7, corners = [0.0206, 0.8246, 0.438], fade = 50.0 }"
                )],
            ),
            (
                "ORE B176, high level",
                &[concat!(
                    "track.irregularities={ model = \"spectrum\", seed = 1, wavelengths = [3.0, 80.0], vertical_roughness = 1.08e-6, ",
                    "lateral_roughness = 6.125e-7, corners = [0.0206, 0.8246, 0.438], fade = 50.0 }"
                )],
            ),
        ]),
        range: "the thesis says straight track, and nothing of its irregularities; levels of ORE B176 for good and for poor track, one realisation of 3 to 80 m",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "secondary suspension of the vehicle",
        case: 0,
        values: Values::Together(&[
            (
                "0.7 of stiffness and damping",
                &[
                    "vehicle.bushings[1].stiffness=[56000.0, 56000.0, 150500.0]",
                    "vehicle.bushings[2].damping=[0.0, 0.0, 14000.0]",
                    "vehicle.bushings[3].damping=[0.0, 22400.0, 0.0]",
                ],
            ),
            (
                "1.3 of stiffness and damping",
                &[
                    "vehicle.bushings[1].stiffness=[104000.0, 104000.0, 279500.0]",
                    "vehicle.bushings[2].damping=[0.0, 0.0, 26000.0]",
                    "vehicle.bushings[3].damping=[0.0, 41600.0, 0.0]",
                ],
            ),
        ]),
        range: "not given; the scene takes a published coach (Manchester benchmark, vehicle 1), here 30 % softer and stiffer",
        thesis_mesh_only: SMOOTH,
    },
    Open {
        quantity: "primary suspension of the vehicle",
        case: 0,
        values: Values::Together(&[
            (
                "0.7 of stiffness and damping",
                &[
                    "vehicle.bushings[7].stiffness=[0.0, 0.0, 854000.0]",
                    "vehicle.bushings[8].damping=[0.0, 0.0, 2800.0]",
                ],
            ),
            (
                "1.3 of stiffness and damping",
                &[
                    "vehicle.bushings[7].stiffness=[0.0, 0.0, 1586000.0]",
                    "vehicle.bushings[8].damping=[0.0, 0.0, 5200.0]",
                ],
            ),
        ]),
        range: "as the secondary one",
        thesis_mesh_only: SMOOTH,
    },
    Open {
        quantity: "friction of wheel and rail",
        case: 0,
        values: Values::Of {
            key: "vehicle.contact.friction",
            unit: "",
            values: &["0.1", "0.5"],
        },
        range: "not given; wet and greasy to dry rails",
        thesis_mesh_only: SMOOTH,
    },
    Open {
        quantity: "creep law of wheel and rail",
        case: 0,
        values: Values::Of {
            key: "vehicle.contact.creep",
            unit: "",
            values: &["\"saturated\"", "\"fastsim\""],
        },
        range: "the thesis names none; the two others in common use",
        thesis_mesh_only: SMOOTH,
    },
    Open {
        quantity: "density of the air",
        case: 3,
        values: Values::Of {
            key: "wind.air_density",
            unit: "kg/m3",
            values: &["1.16", "1.29"],
        },
        range: "not given; dry air at sea level, 30 and 0 degrees C. Changed with wind on pantograph and wires: in still air it has no part",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "drag coefficient of the wires",
        case: 3,
        values: Values::Of {
            key: "wind.wires.drag_coefficient",
            unit: "",
            values: &["1.0", "1.4"],
        },
        range: "not given; 1.2 for a smooth cylinder below the critical Reynolds number (Hoerner 1965), 1.0 in the design of overhead lines (EN 50341-1), as much more on the other side. Changed with wind on pantograph and wires",
        thesis_mesh_only: None,
    },
    Open {
        quantity: "numerical damping",
        case: 0,
        values: Values::Of {
            key: "solver.rho_inf",
            unit: "",
            values: &["0.5", "0.7", "1.0"],
        },
        range: "the thesis does not name its integrator; spectral radius at infinity of generalised alpha, 1.0 has no damping",
        thesis_mesh_only: Some(
            "no physical quantity: it leaves with the step, and the corrections of the converged mesh are made for 0.9 and above",
        ),
    },
    Open {
        quantity: "axial strain of an element",
        case: 0,
        values: Values::Of {
            key: "catenary.mesh.axial_strain",
            unit: "",
            values: &["\"full\""],
        },
        range: "the thesis does not say how it integrates the strain of its cable element; at five Gauss points instead of the mean. It leaves with the element length",
        thesis_mesh_only: None,
    },
];
