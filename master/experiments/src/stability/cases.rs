//! The hard cases.

use system::disturbance::{Deflection, Discards, Disturbance, Lift, Ramp};

/// A line of three spans under a lumped pantograph.
const SHORT_LINE: &str = include_str!("base.toml");

/// The six-body linkage of the thesis.
const LINKAGE: &str = include_str!("../../../../scenes/thesis-pantograph.toml");

/// Which algorithms a case is run with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coupled {
    /// Every one, and the automatic choice through FMUs.
    All,
    /// None: what the case asks for has no meaning in a coupled run.
    No,
}

/// The key that makes a case hard, from a value that is harmless to the hard one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knob {
    /// What it is called, with its unit in brackets.
    pub name: &'static str,
    /// The override, with `{}` for the value.
    pub key: &'static str,
    /// A value that is harmless; positive.
    pub harmless: f64,
    /// The value of the case; positive.
    pub hard: f64,
}

impl Knob {
    /// The override that sets it.
    #[must_use]
    pub fn set(&self, value: f64) -> String {
        self.key.replace("{}", &format!("{value:?}"))
    }
}

/// A scene, what is done to it, and what it is to show.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name in the table.
    pub name: String,
    /// What is hard about it, one line.
    pub about: String,
    /// The scene that the overrides change.
    pub base: &'static str,
    /// Keys, in the form of the command line.
    pub overrides: Vec<String>,
    /// What is done to the run besides.
    pub disturbance: Disturbance,
    /// What its boundary is looked for with; the step where there is none.
    pub knob: Option<Knob>,
    /// With which algorithms it is run.
    pub coupled: Coupled,
    /// Whether it takes long: no boundary is looked for.
    pub slow: bool,
}

impl Case {
    fn new(name: &str, about: &str, overrides: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            about: about.to_owned(),
            base: SHORT_LINE,
            overrides: overrides.iter().map(ToString::to_string).collect(),
            disturbance: Disturbance {
                audited: true,
                ..Disturbance::default()
            },
            knob: None,
            coupled: Coupled::All,
            slow: false,
        }
    }

    /// The scene that all others change.
    #[must_use]
    pub fn plain() -> Self {
        Self::new("plain", "the scene that all others change: nothing hard", &[])
    }

    /// Three spans of the thesis line under its linkage.
    fn linkage(name: &str, about: &str, overrides: &[&str]) -> Self {
        let short = [
            "run.duration=1.5",
            "run.start_x=20",
            "run.evaluate={time=[0.3,1.25]}",
            "catenary.spans=3",
        ];
        let all: Vec<&str> = short.iter().chain(overrides).copied().collect();
        Self {
            base: LINKAGE,
            ..Self::new(name, about, &all)
        }
    }

    fn by(mut self, name: &'static str, key: &'static str, harmless: f64, hard: f64) -> Self {
        let knob = Knob {
            name,
            key,
            harmless,
            hard,
        };
        self.overrides.push(knob.set(hard));
        self.knob = Some(knob);
        self
    }

    /// A contact of this stiffness, N/m.
    fn stiff(self, hard: f64) -> Self {
        self.by("contact stiffness [N/m]", "contact.stiffness={}", 5e4, hard)
    }

    fn lifted(mut self, ramps: &[(f64, f64, f64)]) -> Self {
        let ramp = |&(start, duration, rise): &(f64, f64, f64)| Ramp { start, duration, rise };
        self.disturbance.lift = Some(Lift(ramps.iter().map(ramp).collect()));
        self
    }

    fn repeated(mut self) -> Self {
        self.disturbance.repeated = true;
        self
    }

    fn discarding(mut self, one_in: u64) -> Self {
        self.disturbance.discards = Some(Discards { seed: 50318, one_in });
        self
    }

    fn deflected(mut self, amplitude: f64) -> Self {
        self.disturbance.deflection = Some(Deflection { amplitude });
        self.coupled = Coupled::No;
        self
    }

    fn slow(mut self) -> Self {
        self.slow = true;
        self
    }
}

/// Loss and impact three times: the strip is lowered by 60 mm within 40 ms and raised again.
const LOWERED: [(f64, f64, f64); 6] = [
    (0.35, 0.04, -0.06),
    (0.47, 0.04, 0.06),
    (0.65, 0.04, -0.06),
    (0.77, 0.04, 0.06),
    (0.95, 0.04, -0.06),
    (1.07, 0.04, 0.06),
];

/// No damping anywhere and a trapezoid in time.
const UNDAMPED: [&str; 7] = [
    "catenary.mesh.elements_per_interval=1",
    "catenary.damping.alpha=0",
    "catenary.damping.beta=0",
    "pantograph.0.dampings=[0,0]",
    "solver.rho_inf=1",
    "coupling.macro_step=0.001",
    "run.initialise=\"as_given\"",
];

fn undamped(name: &str, about: &str, seconds: f64, more: &[&str]) -> Case {
    let run = [
        "run.speed_kmh=1".to_owned(),
        format!("run.duration={seconds}"),
        format!("run.evaluate={{time=[{},{}]}}", 0.1 * seconds, 0.9 * seconds),
    ];
    let mut case = Case::new(name, about, &UNDAMPED);
    case.overrides.extend(run);
    case.overrides.extend(more.iter().map(ToString::to_string));
    case
}

/// All cases, in the order of the table; a quick look shortens the longest.
#[must_use]
pub fn cases(quick: bool) -> Vec<Case> {
    let long = if quick { 10.0 } else { 100.0 };
    vec![
        Case::plain(),
        // Speed.
        Case::new(
            "speed_0.95_c",
            "0.95 of the wave speed of the contact wire",
            &[
                "run.speed_kmh=416.26",
                "run.duration=1.1",
                "run.evaluate={time=[0.3,0.8]}",
            ],
        ),
        Case::new(
            "speed_1.05_c",
            "above the wave speed",
            &["run.speed_kmh=460", "run.duration=1.0", "run.evaluate={time=[0.3,0.7]}"],
        ),
        Case::new(
            "speed_1.05_c_allowed",
            "above the wave speed, and the scene says that it may",
            &[
                "run.speed_kmh=460",
                "run.duration=1.0",
                "run.evaluate={time=[0.3,0.7]}",
                "run.allow_supercritical=true",
            ],
        ),
        Case::new("speed_5_kmh", "walking pace", &["run.speed_kmh=5"]),
        // Contact.
        Case::new("contact_1e4", "contact stiffness 1e4 N/m", &[]).stiff(1e4),
        Case::new("contact_1e6", "contact stiffness 1e6 N/m", &[]).stiff(1e6),
        Case::new("contact_1e7", "contact stiffness 1e7 N/m", &[]).stiff(1e7),
        Case::new("contact_1e8", "contact stiffness 1e8 N/m", &[]).stiff(1e8),
        Case::new(
            "contact_damped_100",
            "contact damping 100 N s/m",
            &["contact.damping=100"],
        ),
        Case::new(
            "contact_damped_1e4",
            "contact damping 1e4 N s/m",
            &["contact.damping=1e4"],
        ),
        Case::new(
            "contact_1e6_damped",
            "contact stiffness 1e6 N/m, damping 1e3 N s/m",
            &["contact.damping=1e3"],
        )
        .stiff(1e6),
        Case::new(
            "contact_1e8_damped",
            "contact stiffness 1e8 N/m, damping 1e4 N s/m",
            &["contact.damping=1e4"],
        )
        .stiff(1e8),
        // Pantograph.
        Case::new("head_0.5_kg", "collector head of 0.5 kg", &[]).by(
            "head mass [kg]",
            "pantograph.0.masses=[{},15.0]",
            7.2,
            0.5,
        ),
        Case::new("head_15_kg", "collector head of 15 kg", &[]).by(
            "head mass [kg]",
            "pantograph.0.masses=[{},15.0]",
            7.2,
            15.0,
        ),
        Case::new(
            "friction_50_N",
            "friction of 50 N in the frame",
            &["pantograph.0.friction=[0,50]"],
        ),
        Case::new(
            "loose_head",
            "a head that lies loose on its springs",
            &["pantograph.0.unilateral=[true,false]"],
        ),
        Case::new(
            "static_force_1000_N",
            "pressed up with 1000 N",
            &["pantograph.0.static_force=1000"],
        ),
        Case::new(
            "two_pantographs_15_m",
            "two pantographs 15 m apart",
            &[
                "run.start_x=30",
                "pantograph=[{model=\"lumped\",static_force=120,strip={width=1.2},masses=[7.2,15],stiffnesses=[4200,50],\
                 dampings=[10,90]},{model=\"lumped\",offset_x=-15,static_force=120,strip={width=1.2},masses=[7.2,15],\
                 stiffnesses=[4200,50],dampings=[10,90]}]",
            ],
        ),
        // Steps.
        Case::new(
            "macro_0.1_ms",
            "macro and micro step 0.1 ms",
            &["coupling.macro_step=0.0001", "solver.micro_step=0.0001"],
        ),
        Case::new(
            "macro_0.7_ms",
            "macro step 0.7 ms, the micro step with it",
            &["coupling.macro_step=0.0007"],
        ),
        Case::new(
            "macro_3.7_ms",
            "macro step 3.7 ms, no multiple of the micro step of 1 ms or the output step of 1.3 ms",
            &["coupling.macro_step=0.0037", "run.output_step=0.0013"],
        ),
        Case::new("macro_5_ms", "macro step 5 ms", &["coupling.macro_step=0.005"]),
        Case::new("macro_10_ms", "macro step 10 ms", &["coupling.macro_step=0.01"]),
        Case::new("macro_20_ms", "macro step 20 ms", &["coupling.macro_step=0.02"]),
        Case::new("rho_inf_0", "strongest numerical damping", &["solver.rho_inf=0"]),
        Case::new("rho_inf_0.5", "medium numerical damping", &["solver.rho_inf=0.5"]),
        Case::new("rho_inf_1", "no numerical damping", &["solver.rho_inf=1"]),
        // Loss and impact.
        Case::new(
            "lowered_and_raised",
            "the strip lowered by 60 mm and raised again, three times",
            &[],
        )
        .lifted(&LOWERED),
        Case::new("lowered_at_1e6", "the same on a contact of 1e6 N/m", &[])
            .stiff(1e6)
            .lifted(&LOWERED),
        Case::new(
            "lowered_10_ms",
            "the same in macro steps of 10 ms",
            &["coupling.macro_step=0.01"],
        )
        .lifted(&LOWERED),
        Case::new("wire_step_down_50_mm", "the wire 50 mm lower within 1 m of travel", &[])
            .lifted(&[(0.8, 0.018, 0.05)]),
        Case::new("wire_step_up_50_mm", "the wire 50 mm higher within 1 m of travel", &[])
            .lifted(&[(0.8, 0.018, -0.05)]),
        Case::new(
            "thrown_up",
            "the strip starts 0.3 m below the wire and is thrown against it",
            &[
                "run.initialise=\"as_given\"",
                "pantograph.0.reference_height=5.0",
                "pantograph.0.static_force=200",
            ],
        ),
        Case::new(
            "bouncing",
            "pressed up with 40 N only, at 380 km/h",
            &[
                "pantograph.0.static_force=40",
                "run.speed_kmh=380",
                "run.duration=1.2",
                "run.evaluate={time=[0.3,0.9]}",
            ],
        ),
        Case::new("gust", "the wire thrown up by 0.2 m within 0.1 s: droppers slack", &[])
            .lifted(&[(0.5, 0.1, 0.2), (0.8, 0.2, -0.2)]),
        Case::new(
            "restart_in_impacts",
            "every step taken back and repeated from a saved state, in impacts",
            &[],
        )
        .lifted(&LOWERED)
        .repeated(),
        Case::new("discards", "each side discards one step in twenty at random", &[]).discarding(20),
        Case::new(
            "discards_in_impacts",
            "one step in twenty discarded at random, in impacts",
            &[],
        )
        .lifted(&LOWERED)
        .discarding(20),
        // Line.
        Case::new(
            "dropper_1e7",
            "dropper stiffness 1e7 N/m",
            &["catenary.droppers.stiffness=1e7"],
        ),
        Case::new(
            "dropper_1e7_damped",
            "dropper stiffness 1e7 N/m, damping 1e4 N s/m",
            &["catenary.droppers.stiffness=1e7", "catenary.droppers.damping=1e4"],
        ),
        Case::new(
            "no_bending",
            "wires without bending stiffness",
            &[
                "catenary.contact_wire.bending_stiffness=0",
                "catenary.messenger_wire.bending_stiffness=0",
            ],
        ),
        Case::new(
            "two_elements_per_span",
            "one dropper and two elements per span and wire",
            &[
                "catenary.droppers.positions=[25]",
                "catenary.mesh.elements_per_interval=1",
            ],
        ),
        Case::new(
            "one_element_per_span",
            "one element per span and no dropper",
            &[
                "catenary.droppers.positions=[]",
                "catenary.mesh.elements_per_interval=1",
            ],
        ),
        Case::new(
            "1000_elements_per_span",
            "1002 elements of 50 mm in each wire of a span",
            &[
                "catenary.mesh.elements_per_interval=167",
                "catenary.spans=1",
                "run.start_x=12",
                "run.duration=0.4",
                "run.evaluate={time=[0.05,0.3]}",
            ],
        )
        .slow(),
        Case::new(
            "tension_0.2",
            "0.2 times the tension, at 0.84 of the wave speed",
            &[
                "catenary.contact_wire.tension=4000",
                "catenary.messenger_wire.tension=3200",
                "catenary.encumbrance=3.5",
                "run.speed_kmh=165",
            ],
        ),
        Case::new(
            "tension_3",
            "3 times the tension",
            &[
                "catenary.contact_wire.tension=60000",
                "catenary.messenger_wire.tension=48000",
            ],
        ),
        Case::new(
            "presag_0.1_m",
            "contact wire 0.1 m lower at mid-span",
            &["catenary.presag=0.1"],
        ),
        Case::new(
            "presag_1_m",
            "contact wire 1 m lower at mid-span",
            &["catenary.presag=1.0"],
        ),
        Case::new("presag_5.4_m", "a presag below the rail", &["catenary.presag=5.4"]),
        Case::new(
            "stagger",
            "stagger of 0.3 m: the wires move in three dimensions",
            &["catenary.stagger=[0.3,-0.3]"],
        ),
        Case::new(
            "fixed_ends",
            "wires fixed at their ends, arms and droppers with mass",
            &[
                "catenary.wire_ends=\"fixed\"",
                "catenary.droppers.mass=0.5",
                "catenary.registration_arms.mass=1.0",
                "catenary.registration_arms.vertical_stiffness=200",
            ],
        ),
        // Laws.
        Case::new(
            "sliding_joint",
            "strip and wire joined by a sliding joint over a kink, no numerical damping",
            &["contact={law=\"sliding_joint\"}", "solver.rho_inf=1"],
        ),
        // Energy.
        undamped(
            "undamped",
            "no damping anywhere, the strip falls onto the wire: 100 s",
            long,
            &[],
        )
        .slow(),
        undamped(
            "plucked",
            "no damping, no contact, half sines of 50 mm in all spans: 100 s",
            long,
            &[
                "pantograph.0.reference_height=4.5",
                "pantograph.0.static_force=1",
                "pantograph.0.stiffnesses=[4200,5000]",
            ],
        )
        .deflected(0.05)
        .slow(),
        // Linkage.
        Case::linkage("linkage", "the six-body linkage of the thesis", &[]),
        Case::linkage("linkage_lowered", "the linkage lowered and raised three times", &[]).lifted(&LOWERED),
        Case::linkage(
            "linkage_folded",
            "the linkage nearly folded",
            &["catenary.contact_wire_height=3.8"],
        ),
        Case::linkage(
            "linkage_stretched",
            "the linkage near its singular position",
            &["catenary.contact_wire_height=5.3"],
        ),
        Case::linkage(
            "linkage_out_of_reach",
            "a wire that the linkage does not reach",
            &["catenary.contact_wire_height=5.8"],
        ),
        Case::linkage(
            "linkage_stops",
            "the linkage at its stops",
            &["pantograph.0.stops={height=[4.0,6.0]}"],
        ),
        // Everything at once.
        Case::new(
            "all_at_once",
            "head of 1 kg, contact 5e5 N/m, dropper damping 1e3 N s/m, lowered and raised in macro steps of 5 ms",
            &[
                "pantograph.0.masses=[1,15]",
                "contact.stiffness=5e5",
                "catenary.droppers.damping=1e3",
                "coupling.macro_step=0.005",
            ],
        )
        .lifted(&LOWERED),
    ]
}
