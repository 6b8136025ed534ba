//! What the thesis leaves open, and the range each such quantity plausibly has.

/// A quantity that the thesis does not give, with values over its plausible range.
pub struct Open {
    /// What it is called.
    pub quantity: &'static str,
    /// Its key in the scene; every value is set there.
    pub key: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Values as they are typed.
    pub values: &'static [&'static str],
    /// Why these.
    pub range: &'static str,
}

/// All of them. The scene's own value is computed by the case itself.
pub const OPEN: &[Open] = &[
    Open {
        quantity: "contact stiffness k",
        key: "contact.stiffness",
        unit: "N/m",
        values: &["10000.0", "20000.0", "100000.0", "200000.0", "1000000.0"],
        range: "Thesis, Eq. (17), gives none; EN 50318 has 5e4, the literature 1e4 to 1e6",
    },
    Open {
        quantity: "contact damping d",
        key: "contact.damping",
        unit: "N s/m",
        values: &["10.0", "50.0", "100.0", "300.0"],
        range: "Thesis, Eq. (17), gives none; 300 N s/m is a fifth of critical for the pan-head on k",
    },
    Open {
        quantity: "dropper positions",
        key: "catenary.droppers.positions",
        unit: "m",
        values: &[
            "[4.5, 11.25, 18.0, 24.75, 31.5, 38.25, 45.0, 51.75]",
            "[5.0, 11.6071, 18.2143, 24.8214, 31.4286, 38.0357, 44.6429, 51.25]",
            "[8.0, 13.75, 19.5, 25.25, 31.0, 36.75, 42.5, 48.25]",
            "[8.035714, 16.071429, 24.107143, 32.142857, 40.178571, 48.214286]",
            "[5.625, 11.25, 16.875, 22.5, 28.125, 33.75, 39.375, 45.0, 50.625]",
        ],
        range: "not given; evenly spaced between first and last ones 4.5 m, 5 m and 8 m from a support, six and nine of them (where elements are one per interval, the mesh changes with them)",
    },
    Open {
        quantity: "stiffness of the head suspension",
        key: "pantograph[1].collector_suspension.stiffness",
        unit: "N/m",
        values: &["4500.0", "7000.0", "15000.0", "30000.0", "100000.0"],
        range: "not given; published lumped models have 4.2 (EN 50318) to 9.4 kN/m (DSA 380), one 53 kN/m; 100 kN/m is nearly rigid",
    },
    Open {
        quantity: "damping of the head suspension",
        key: "pantograph[1].collector_suspension.damping",
        unit: "N s/m",
        values: &["0.0", "20.0", "100.0", "200.0"],
        range: "not given; published lumped models have 0 to 45 N s/m; 200 N s/m is a third of critical",
    },
    Open {
        quantity: "point of the uplift force on the lower arm",
        key: "pantograph[1].uplift.distance",
        unit: "m",
        values: &["0.8", "0.9", "1.0", "1.1"],
        range: "not given; from the arm's centre of mass towards the knee. It sets the mean force, which the scene calibrates",
    },
    Open {
        quantity: "damping of the wires, mass part",
        key: "catenary.damping.alpha",
        unit: "1/s",
        values: &["0.0", "0.05", "0.1"],
        range: "not given; EN 50318:2018 has 0.0125, measured lines 0.01 to 0.1",
    },
    Open {
        quantity: "damping of the wires, stiffness part",
        key: "catenary.damping.beta",
        unit: "s",
        values: &["0.0", "1e-5", "1e-3"],
        range: "not given; EN 50318:2018 has 1e-4",
    },
    Open {
        quantity: "mass of the registration arm",
        key: "catenary.registration_arms.mass",
        unit: "kg",
        values: &["0.5", "1.0", "2.0"],
        range: "the thesis says low inertia; papers on EN 50318 take 1 kg",
    },
    Open {
        quantity: "vertical stiffness of the registration arm",
        key: "catenary.registration_arms.vertical_stiffness",
        unit: "N/m",
        values: &["50.0", "300.0", "1000.0"],
        range: "not given; an arm that swings has next to none, papers on EN 50318 take 300 N/m",
    },
    Open {
        quantity: "vertical stiffness of the messenger's supports",
        key: "catenary.supports.messenger_vertical_stiffness",
        unit: "N/m",
        values: &["1e5", "2e6", "1e7"],
        range: "not given; EN 50318 has 5e5",
    },
    Open {
        quantity: "encumbrance",
        key: "catenary.encumbrance",
        unit: "m",
        values: &["0.9", "1.05", "1.4"],
        range: "not given; lines for 200 km/h have 0.9 to 1.6 m",
    },
    Open {
        quantity: "presag of the contact wire",
        key: "catenary.presag",
        unit: "m",
        values: &["0.028", "0.056"],
        range: "the thesis says straight; 0.5 and 1 per mille of the span",
    },
    Open {
        quantity: "low-pass filter",
        key: "run.low_pass_hz",
        unit: "Hz",
        values: &["10.0", "40.0", "100.0"],
        range: "the thesis does not say whether its force is filtered; EN 50317 asks for 20 Hz. The column of the raw force has no filter",
    },
    Open {
        quantity: "time step",
        key: "solver.micro_step",
        unit: "s",
        values: &["0.00025", "0.0005"],
        range: "not given",
    },
];
