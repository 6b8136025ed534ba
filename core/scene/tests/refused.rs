//! Every refusal names file, line, key, value, unit and what would be right.

use scene::{Reduction, Scene};

const EN: &str = include_str!("../../../scenes/en50318-250.toml");
const STITCHED: &str = include_str!("../../../scenes/ac-stitched.toml");
const OVERLAP: &str = include_str!("../../../scenes/overlap.toml");
const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");
const VEHICLE: &str = include_str!("../../../scenes/thesis-own-mesh.toml");

fn message(text: &str, overrides: &[&str]) -> String {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_string()).collect();
    match Scene::from_toml(text, "x.toml", &overrides) {
        Ok(_) => "accepted".to_string(),
        Err(error) => error.to_string(),
    }
}

fn edited(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the scene does not contain {from:?}");
    text.replacen(from, to, 1)
}

fn holds(message: &str, fragments: &[&str]) {
    for fragment in fragments {
        assert!(message.contains(fragment), "{fragment:?} is not in:\n{message}");
    }
}

/// Line of the first occurrence of `what` in the file, as messages begin.
fn at(text: &str, what: &str) -> String {
    let offset = text.find(what).expect("the scene contains it");
    format!(
        "x.toml:{}: ",
        text[..offset].lines().count() + usize::from(text[..offset].ends_with('\n'))
    )
}

/// The mesh of the scene.
const MESH: &str = "elements_per_interval = 8               # chosen with the corrections: the force is 0.5 % of its \
    standard deviation from the converged one\ncorrections = \"auto\"";

/// (what is replaced, by what, fragments of the message), on the EN 50318 scene.
#[rustfmt::skip]
const EDITS: &[(&str, &str, &[&str])] = &[
    // Unknown keys and tables.
    ("[catenary]\n", "[catenery]\n", &["catenery: unknown key, did you mean \"catenary\"?", "known keys \
        here: ", "run"]),
    ("[run]\n", "[run]\nspede_kmh = 3\n", &["run.spede_kmh: unknown key, did you mean \"speed_kmh\"?", "low_pass_hz"]),
    ("[solver]", "[sovler]", &["sovler: unknown key, did you mean \"solver\"?"]),
    ("axial_stiffness", "axial_stifness", &["catenary.contact_wire.axial_stifness: unknown \
        key", "\"axial_stiffness\"", "bending_stiffness"]),
    ("static_force", "force", &["pantograph[1].force: unknown key", "static_force"]),
    ("strip = { width", "strip = { breadth", &["pantograph[1].strip.breadth: unknown key", "width"]),
    ("spans = [5, 6]", "span = [5, 6]", &["run.evaluate.span: unknown key, did you mean \"spans\"?"]),
    ("title", "titel", &["titel: unknown key, did you mean \"title\"?"]),
    // Missing keys and tables.
    ("duration = 7.0", "", &["run.duration is missing: must be a positive number in s"]),
    ("tension = 20000.0", "", &["catenary.contact_wire.tension is missing: must be a positive number in N"]),
    ("statics = \"form_finding\"", "", &["catenary.statics is missing: must be one of \"form_finding\", \
        \"nodal_displacement\""]),
    ("model = \"lumped\"", "", &["pantograph[1].model is missing: must be \"lumped\" or \"linkage\""]),
    ("evaluate = { spans = [5, 6] }", "evaluate = {}", &["run.evaluate.spans is missing", "time = [from, to]"]),
    ("[contact]\nlaw = \"penalty\"\nstiffness = 50000.0                     # N/m\ndamping = 0.0", "", &["contact is \
        missing: must be a table"]),
    ("electrification = \"ac_25kv\"", "electrification = \"ac_25_kv\"", &["run.electrification = \"ac_25_kv\": \
        unknown word, did you mean \"ac_25kv\"?"]),
    ("electrification = \"ac_25kv\"", "electrification = 25000", &["run.electrification = 25000: must be one of \
        \"ac_25kv\", \"ac_15kv\", \"dc_3kv\", \"dc_1_5kv\""]),
    ("[catenary.registration_arms]\n", "[catenary.registration_arms]\nfree_uplift = \
        0\n", &["catenary.registration_arms.free_uplift = 0 m: must be positive and finite"]),
    // Wrong types.
    ("duration = 7.0", "duration = \"8 s\"", &["run.duration = \"8 s\": must be a positive number in s"]),
    ("allow_supercritical = false", "allow_supercritical = 0", &["run.allow_supercritical = 0: must be true or false"]),
    ("positions = [5.0, 10.5,", "positions = [5.0, true,", &["catenary.droppers.positions[2] = true: must be a number \
        in m"]),
    ("masses = [7.2, 15.0]", "masses = 7.2", &["pantograph[1].masses = 7.2: must be a list of numbers in kg, at least \
        one"]),
    ("[[pantograph]]", "[pantograph]", &["pantograph = ", "must be at least one table under the header \
        [[pantograph]]"]),
    ("law = \"penalty\"", "law = 3", &["contact.law = 3: must be one of \"penalty\", \"sliding_joint\""]),
    ("elements_per_interval = 8", "elements_per_interval = 2.5", &["catenary.mesh.elements_per_interval = 2.5: must \
        be a whole number from 1"]),
    ("[solver]\nmicro_step = 0.001                      # s\nrho_inf = 0.9", "", &["accepted"]),
    // Out of range, NaN, infinite.
    ("duration = 7.0", "duration = nan", &["run.duration = NaN s: must be positive and finite"]),
    ("start_x = 20.0", "start_x = inf", &["run.start_x = inf m: must be finite"]),
    ("mass_per_length = 1.35", "mass_per_length = -1.35", &["catenary.contact_wire.mass_per_length = -1.35 kg/m: must \
        be positive and finite"]),
    ("span_length = 60.0", "span_length = 0.0", &["catenary.span_length = 0 m: must be positive and finite"]),
    ("span_length = 60.0", "span_length = [60.0, 60.0]", &["catenary.span_length", "has 2 entries, must be a list of \
        numbers in m, 10 of them"]),
    ("stagger = [0.0]", "stagger = []", &["catenary.stagger", "has 0 entries, must be a list of numbers in m, at \
        least one"]),
    ("spans = 10", "spans = 0", &["catenary.spans = 0: must be a whole number from 1 to 5000"]),
    ("alpha = 0.0125", "alpha = -0.0125", &["catenary.damping.alpha = -0.0125 1/s: must be zero or positive, and \
        finite"]),
    ("rho_inf = 0.9", "rho_inf = 0.9\nnewton_tolerance = 10", &["solver.newton_tolerance = 10 N: must be at most 1 N, \
        which moves the filtered force by up to 0.5 %"]),
    ("rho_inf = 0.9", "rho_inf = 0.9\nnewton_tolerance = 1.0", &["accepted"]),
    ("rho_inf = 0.9", "rho_inf = 1.1", &["solver.rho_inf = 1.1: must be from 0 to 1"]),
    ("algorithm = \"auto\"", "extrapolation = 3", &["coupling.extrapolation = 3: must be a whole number from 0 to 2"]),
    ("masses = [7.2, 15.0]", "masses = [7.2, 0.0]", &["pantograph[1].masses[2] = 0 kg: must be positive and finite"]),
    ("tension = 20000.0", "tension = 1e999", &["catenary.contact_wire.tension = inf N: must be positive and finite"]),
    ("title = \"EN 50318:2002 reference model, 250 km/h\"", "title = \"\"", &["title = \"\": must be one line that \
        says what the scene is, not empty"]),
    // Words.
    ("algorithm = \"auto\"", "algorithm = \"jacobbi\"", &["coupling.algorithm = \"jacobbi\": unknown word, did you \
        mean \"jacobi\"?", "must be one of \"auto\", \"jacobi\", \"gauss_seidel\", \"iterated\", \
        \"interface_jacobian\""]),
    ("\"constant_tension\"", "\"free\"", &["catenary.wire_ends = \"free\": unknown word", "must be \
        \"constant_tension\" or \"fixed\""]),
    ("model = \"lumped\"", "model = \"lumpd\"", &["pantograph[1].model = \"lumpd\": unknown word, did you mean \
        \"lumped\"?"]),
    // Known, but not available.
    ("\"penalty\"", "\"sliding_joint\"", &["contact.stiffness: must be left out: contact.law is \"sliding_joint\", \
        which holds the strip on the wire", "contact.damping: must be left out"]),
    // A beam has what it needs, and nothing made for cables.
    ("element = \"cable\"", "element = \"beam\"", &["catenary.contact_wire.beam = left out: must be given with \
        catenary.mesh.element = \"beam\"", "torsional_stiffness = … N m²"]),
    ("bending_stiffness = 195.0", "bending_stiffness = 195.0\nbeam = { shear_stiffness = 5.6e6, torsional_stiffness = \
        145.0, rotary_inertia = 1.5e-5 }", &["catenary.contact_wire.beam = { … }: must be left out with \
        catenary.mesh.element = \"cable\", which neither shears nor twists"]),
    ("bending_stiffness = 131.7", "bending_stiffness = 131.7\nbeam = { shear_stiffness = 5.6e6, torsional_stiffness = \
        145.0, rotary_inertia = 1.5e-5 }", &["catenary.messenger_wire.beam = { … }: must be left out: the messenger \
        wire is of cable elements"]),
    ("bending_stiffness = 195.0", "bending_stiffness = 195.0\nbeam = { shear_stiffness = 5.6e6, torsional_stiffness = \
        0.0, rotary_inertia = 1.5e-5 }", &["catenary.contact_wire.beam.torsional_stiffness = 0 N m²: must be positive \
        and finite"]),
    ("macro_step = 0.001", "macro_step = { min = 1e-4, max = 1e-2 }", &["coupling.macro_step.tolerance", "a positive \
        number in N"]),
    ("macro_step = 0.001", "macro_step = { tolerance = 0.0 }", &["coupling.macro_step.tolerance = 0 N: must be \
        positive and finite"]),
    ("macro_step = 0.001", "macro_step = { tolerance = 1.0, min = 1e-3, max = 1e-4 }", &["coupling.macro_step.max = \
        0.0001: must be at least min = 0.001 s"]),
    ("macro_step = 0.001", "macro_step = { tolerance = 1.0, min = 0.1 }", &["coupling.macro_step.min = 0.1: must be \
        at most max = 0.01 s"]),
    ("macro_step = 0.001", "macro_step = { tolerance = 1.0, max = 9.0 }", &["coupling.macro_step.max = 9 s: must be \
        at most run.duration = 7 s"]),
    ("macro_step = 0.001", "macro_step = { tolerance = 1.0, maximum = 1e-2 }", &["coupling.macro_step.maximum", "did \
        you mean"]),
    ("macro_step = 0.001", "macro_step = 0.001\nparallel = \"on\"", &["coupling.parallel = \"on\": unknown \
        word", "\"auto\", \"always\", \"never\""]),
    ("rho_inf = 0.9", "formulation = \"index_1_baumgart\"", &["solver.formulation = \"index_1_baumgart\": unknown \
        word, did you mean \"index_1_baumgarte\"?"]),
    ("[coupling]", "[vehicle]\nspeed = 1\n[coupling]", &["vehicle.model is missing: must be one of \"rigid_motion\", \
        \"vertical\", \"full\""]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { time = [0.0, 1.0], z = [0.0] \
        }\n[coupling]", &["vehicle.motion.z = [0.0]: has 1 entry, must be a list of numbers in m, 2 of them"]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { time = [0.0, 0.0] \
        }\n[coupling]", &["vehicle.motion.time[2] = 0 s: must be greater than the entry before it, 0 s"]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { time = [0.0, 1.0], pitch = [0.0, 0.6] \
        }\n[coupling]", &["vehicle.motion.pitch[2] = 0.6 rad: must be between -0.5 and 0.5 rad: it is the angle of a \
        vehicle on rails"]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { time = [0.0, 1.0], pitch = [0.0] \
        }\n[coupling]", &["vehicle.motion.pitch = [0.0]: has 1 entry, must be a list of numbers in rad, 2 of them"]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { time = [0.0, 1.0], pich = [0.0, 0.0] \
        }\n[coupling]", &["pich", "pitch"]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { time = [0.0, 1.0], x = [0.0, 1e4] \
        }\n[coupling]", &["vehicle.motion.x = 10000 m: takes the strip of pantograph[1] off the line, which is from 0 \
        to", "at t = 1.000 s"]),
    ("[coupling]", "[vehicle]\nmodel = \"rigid_motion\"\nmotion = { file = \"a.csv\", z = [0.0] \
        }\n[coupling]", &["vehicle.motion.z: must be left out: file is given"]),
    ("[coupling]", "[track]\n[coupling]", &["track: must be left out: no wheel runs on it"]),
    ("[coupling]", "[track]\ncurve = 1\n[coupling]", &["track.curve = 1: must be a table under the header \
        [track.curve], or several under [[track.curve]]"]),
    ("[coupling]", "[wind]\nspeed = 20\n[coupling]", &["wind.yaw_deg is missing: must be a number from -180 to \
        180", "wind.air_density is missing: must be a positive number in kg/m³"]),
    ("[coupling]", "[wind]\nspeed = -1\nyaw_deg = 200\nair_density = 0\n[coupling]", &["wind.speed = -1 m/s: must be \
        zero or positive", "wind.yaw_deg = 200: must be from -180 to 180", "wind.air_density = 0 kg/m³: must be \
        positive"]),
    ("[coupling]", "[wind]\nspeed = 200\nyaw_deg = 0\nair_density = 1.2\n[coupling]", &["wind.speed = 200: must be a \
        speed in m/s, at most 120 m/s"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\nturbulence = { spectrum = \"kaiman\", \
        intensities = [0.1, 0.1], length_scales = [100, 50, 0], coherence_decays = [10, 10, 10], seed = 1, steps = \
        1000 }\n[coupling]", &["wind.turbulence.spectrum = \"kaiman\": unknown word, did you mean \
        \"kaimal\"?", "wind.turbulence.intensities", "wind.turbulence.length_scales[3] = 0 m: must be \
        positive", "wind.turbulence.steps = 1000: must be a power of two, such as 1024"]),
    ("[coupling]", "[wind]\nspeed = 0\nyaw_deg = 0\nair_density = 1.2\nturbulence = { spectrum = \"kaimal\", \
        intensities = [0.1, 0.1, 0.1], length_scales = [100, 50, 20], coherence_decays = [10, 10, 10], seed = 1, \
        steps = 64 }\n[coupling]", &["wind.speed = 0 m/s: must be positive with \
        wind.turbulence", "wind.turbulence.steps = 64: must be at least 256: the field would repeat itself after 3.2 \
        s"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\npantograph = { \
        }\n[coupling]", &["wind.pantograph.uplift is missing: must be a number in N/(m/s)²"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\npantograph = { uplift = [0.01, 0.02] \
        }\n[coupling]", &["wind.pantograph.uplift = [0.01, 0.02] N/(m/s)²: must be one number, or 1 of them"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\n[[wind.pantograph.surfaces]]\nbody = \
        \"head\"\ndrag = 0.1\nlift = [0.1, 0.2]\n[coupling]", &["wind.pantograph.surfaces[1].lift = [0.1, 0.2]: has 2 \
        entries, must be one number, or angles_deg be given"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\n[[wind.pantograph.surfaces]]\nbody = \
        \"head\"\ndrag = 0.1\nlift = 0.1\n[coupling]", &["wind.pantograph.surfaces = […]: must be left out, and \
        uplift given: pantograph[1] is lumped"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 90\nair_density = 1.2\nwires = { drag_coefficient = 1.2, \
        contact_wire_diameter = 0.012, messenger_wire_diameter = 0.011 }\n[model]\nreduce = \
        [\"planar\"]\n[coupling]", &["model.reduce = \"planar\": must be left out: wind.yaw_deg = 90 pushes the wires \
        sideways"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\nwires = { drag_coefficient = 1.2, \
        contact_wire_diameter = 0.012, messenger_wire_diameter = 0.011 }\n[model]\nreduce = \
        [\"window\"]\n[coupling]", &["model.reduce = \"window\": must be left out: wind.wires acts on every span"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 90\nair_density = 1.2\nwires = { drag_coefficient = 1.2 \
        }\n[coupling]", &["wind.wires.contact_wire_diameter is missing: must be the diameter in m, here or as \
        catenary.contact_wire.diameter", "wind.wires.messenger_wire_diameter is missing"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 90\nair_density = 1.2\nwires = { drag_coefficient = 1.2, \
        contact_wire_diameter = 0.012, messenger_wire_diameter = 0.011, contact_wire_polar = { angles_deg = [5, 20], \
        drag = [1, 1], lift = [0, 0] } }\n[coupling]", &["wind.wires.contact_wire_polar.angles_deg = [5.0, 20.0]°: \
        must hold 0.0°, the angle of attack of the wind: the table ends at 5° and 20°"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 90\nair_density = 1.2\nwires = { drag_coefficient = 1.2, \
        contact_wire_diameter = 0.012, messenger_wire_diameter = 0.011, messenger_wire_polar = { angles_deg = \
        [5, -20], drag = [1, 1], lift = [0] } }\n[coupling]", &["wind.wires.messenger_wire_polar.angles_deg = \
        [5, -20]: must ascend, with at least two angles", "wind.wires.messenger_wire_polar.lift = [0]"]),
    ("gravity = 9.81", "gravity = 9.81\nchange = { ice = { thickness = 0.01 } }", &["catenary.contact_wire.diameter is \
        missing: must be the diameter in m of the wire that bears catenary.change.ice.contact_wire"]),
    ("gravity = 9.81", "gravity = 9.81\nchange = { ice_per_length = 0.2, ice = { contact_wire = 0, messenger_wire = 0, \
        stitch_wires = 0 } }", &["catenary.change.ice_per_length: must be left out: catenary.change.ice is given, \
        whose mass it would count again"]),
    ("gravity = 9.81", "gravity = 9.81\nchange = { ice = { thickness = -0.01, density = 2000 } }", &[
        "catenary.change.ice.thickness = -0.01 m: must be", "catenary.change.ice.density = 2000 kg/m³: must be"]),
    ("gravity = 9.81", "gravity = 9.81\ntensioning = { friction = 0.9, ratio = 0, travel = -1 }", &[
        "catenary.tensioning.friction = 0.9: must be", "catenary.tensioning.ratio = 0: must be",
        "catenary.tensioning.travel = -1 m: must be"]),
    ("wire_ends = \"constant_tension\"", "wire_ends = \"fixed\"\ntensioning = {}", &["catenary.tensioning: must be \
        left out: catenary.wire_ends = \"fixed\" has no tensioning devices"]),
    ("[coupling]", "[wind]\nspeed = 20\nyaw_deg = 0\nair_density = 1.2\nrecord = [[0, 1, 2, 3], [0, 1, 2, \
        3]]\n[coupling]", &["wind.record = [2 rows]: row 2: time = 0 s: must be after 0 s"]),
    ("[coupling]", "[model]\nreduce = [\"linkage\"]\n[coupling]", &["model.reduce = \"linkage\": must be left out: no \
        pantograph is a linkage"]),
    ("[coupling]", "[model]\nreduce = [\"plannar\"]\n[coupling]", &["model.reduce[1] = \"plannar\": unknown word, did \
        you mean \"planar\"?"]),
    ("[coupling]", "[model]\nreduce = \"all\"\n[coupling]", &["model.reduce = \"all\": unknown word", "must be one of \
        \"auto\", \"none\", \"planar\""]),
    ("corrections = \"auto\"", "corrections = [\"bending_layer\"]", &["catenary.mesh.corrections[1] = \
        \"bending_layer\": unknown word, did you mean \"bending_layers\"?"]),
    ("corrections = \"auto\"", "corrections = [\"dropper_compliance\"]", &["catenary.mesh.corrections[1] = \
        \"dropper_compliance\": not modelled yet", "\"mass_correction\""]),
    ("corrections = \"auto\"", "error_percent = 1.0", &["catenary.mesh.elements_per_interval: must be left out: \
        catenary.mesh.error_percent chooses it"]),
    ("elements_per_interval = 8", "error_percent = 1.0", &["catenary.mesh.corrections: must be left out: \
        catenary.mesh.error_percent chooses it"]),
    (MESH, "error_percent = 0.0", &["catenary.mesh.error_percent = 0 %: must be positive"]),
    (MESH, "error_percent = 0.05", &["catenary.mesh.error_percent = 0.05 %: must be at least 0.1 %"]),
    (MESH, "", &["catenary.mesh.elements_per_interval is missing: must be a whole number from 1 to 200, or \
        element_length in m or error_percent in its place"]),
    (MESH, "elements_per_interval = 8\nelement_length = 0.9", &["catenary.mesh.element_length: must be left out: \
        catenary.mesh.elements_per_interval divides the intervals; one of the two"]),
    (MESH, "element_length = 0.9\nerror_percent = 1.0", &["catenary.mesh.element_length: must be left out: \
        catenary.mesh.error_percent chooses it"]),
    (MESH, "element_length = -0.9", &["catenary.mesh.element_length = -0.9 m: must be positive and finite"]),
    (MESH, "element_length = 0.0", &["catenary.mesh.element_length = 0 m: must be positive and finite"]),
    (MESH, "element_length = \"short\"", &["catenary.mesh.element_length = \"short\": must be a positive number in m"]),
    (MESH, "element_length = 0.0324", &["catenary.mesh.element_length = 0.0324 m: must be at least 0.0325 m: an \
        interval between droppers, here up to 6.5 m, has at most 200 elements"]),
    (MESH, "element_lenght = 0.9", &["catenary.mesh.element_lenght: unknown key, did you mean \"element_length\"?"]),
    ("[catenary]\n", "[catenary]\nfmu = \"line.fmu\"\n", &["catenary.spans: must be left out: fmu is \
        given", "catenary.droppers: must be left out", "contact: must be left out: an FMU given as catenary has its \
        own contact law"]),
    // Contradictions.
    ("duration = 7.0", "duration = 80.0", &["run.duration = 80 s: must be at most 8.352 s", "pantograph[1] would \
        leave the line, which ends at 600 m"]),
    ("start_x = 20.0", "start_x = -1.0", &["run.start_x = -1 m: the strip of pantograph[1] starts at x = -1 m, must \
        be on the line, before its end at 600 m"]),
    ("start_x = 20.0", "start_x = 0.0", &["run.start_x = 0 m: the strip of pantograph[1] starts at x = 0 m, must be \
        0.01 m or more from the end of the line at 0 m"]),
    ("speed_kmh = 250.0 ", "speed_kmh = 500.0 ", &["run.speed_kmh = 500 km/h: must be below 438.2 km/h", "121.72 \
        m/s", "allow_supercritical"]),
    ("low_pass_hz", "accuracy_percent = 0\nlow_pass_hz", &["run.accuracy_percent = 0 %: must be from 0.3 to 10 %"]),
    ("low_pass_hz", "accuracy_percent = nan\nlow_pass_hz", &["run.accuracy_percent = NaN %: must be from 0.3 to 10 %"]),
    ("low_pass_hz", "accuracy_percent = \"text\"\nlow_pass_hz", &["run.accuracy_percent = \"text\": must be a number \
        in % from 0.3 to 10"]),
    ("spans = [5, 6]", "spans = [6, 5]", &["run.evaluate.spans = [6, 5]: must be two spans from 1 to 10"]),
    ("spans = [5, 6]", "spans = [5, 11]", &["run.evaluate.spans = [5, 11]: must be two spans from 1 to 10"]),
    ("spans = [5, 6]", "spans = [1, 2]", &["run.evaluate.spans = [1, 2]: must lie within the run", "from 0 m to 120 \
        m", "from 20.000 m to 506.111 m"]),
    ("{ spans = [5, 6] }", "{ time = [2.0, 9.0] }", &["run.evaluate.time = [2, 9] s", "up to run.duration = 7 s"]),
    ("{ spans = [5, 6] }", "{ spans = [5, 6], time = [2.0, 3.0] }", &["run.evaluate.spans", "either spans or time, \
        not both"]),
    ("tension = 20000.0", "tension = 20000.0\nbreaking_force = 15000.0", &["catenary.contact_wire.tension = 20000 N: \
        must be below breaking_force = 15000 N"]),
    ("49.5, 55.0]", "49.5, 60.0]", &["catenary.droppers.positions[9] = 60 m: must be inside its span, between 0 and \
        60 m"]),
    ("23.5, 30.0", "23.5, 20.0", &["catenary.droppers.positions[5] = 20 m: must be greater than the position before \
        it, 23.5 m"]),
    ("mass = 0.0 ", "lengths = [1.0]\nmass = 0.0 ", &["catenary.droppers.lengths = [1.0] m: must be left out with \
        catenary.statics = \"form_finding\""]),
    ("23.5, 30.0", "23.5, 23.55", &["catenary.droppers.positions[5] = 23.55 m: must be at least 0.1 m from the \
        position before it, at 23.5 m"]),
    ("positions = [5.0,", "positions = [0.05,", &["catenary.droppers.positions[1] = 0.05 m: must be at least 0.1 m \
        from the support, at 0 m"]),
    ("49.5, 55.0]", "49.5, 59.9999999]", &["catenary.droppers.positions[9] = 59.9999999 m: must be at least 0.1 m \
        from the support, at 60 m"]),
    ("49.5, 55.0]", "49.5, 59.9]", &["accepted"]),
    ("span_length = 60.0", "span_length = 1e9", &["catenary.span_length = 1000000000 m: must be at most 5000 m, each \
        span"]),
    ("dampings = [10.0, 90.0]", "dampings = [10.0]", &["pantograph[1].dampings = 1 entry: must have 2, one per \
        mass"]),
    ("stiffnesses = [4200.0,", "stiffnesses = [0.0,", &["pantograph[1].stiffnesses[1] = 0 N/m: must be positive"]),
    ("stagger = [0.0]", "stagger = [0.2, -0.7]", &["catenary.stagger[2] = -0.7 m: must be within ±0.6 m, half the \
        width of the strip of pantograph[1]"]),
    ("macro_step = 0.001", "macro_step = 9.0", &["coupling.macro_step = 9 s: must be at most run.duration = 7 s"]),
    ("macro_step = 0.001", "macro_step = 1e-12", &["coupling.macro_step = 1e-12 s: must be at least 7e-8 s"]),
    ("output_step = 0.001", "output_step = 0.05", &["run.low_pass_hz = 20 Hz: must be below 10 Hz"]),
    ("model = \"lumped\"", "fmu = \"vendor/panto.fmu\"\nmodel = \"lumped\"", &["pantograph[1].model: must be left \
        out: fmu is given", "pantograph[1].static_force: must be left out", "pantograph[1].masses: must be left out"]),
];

#[test]
fn every_wrong_edit_is_refused_with_key_value_unit_and_remedy() {
    for (from, to, fragments) in EDITS {
        holds(&message(&edited(EN, from, to), &[]), fragments);
    }
}

#[test]
fn every_refusal_names_the_line_of_the_key() {
    for (from, to, key) in [
        ("duration = 7.0", "duration = -8.0", "duration = -8.0"),
        ("[run]\n", "[run]\nspede_kmh = 3\n", "spede_kmh"),
        ("rho_inf = 0.9", "rho_inf = 2.0", "rho_inf = 2.0"),
        ("49.5, 55.0]", "49.5, 60.0]", "positions"),
        ("law = \"penalty\"", "", "[contact]"),
        ("[coupling]", "[track]\n[coupling]", "[track]"),
        ("masses = [7.2, 15.0]", "masses = [7.2, -15.0]", "masses"),
        ("spans = [5, 6]", "spans = [5, 11]", "evaluate"),
    ] {
        let text = edited(EN, from, to);
        let message = message(&text, &[]);
        assert!(
            message.starts_with(&at(&text, key)),
            "{} is not the beginning of {message}",
            at(&text, key)
        );
    }
}

/// A mistake in one key is told once, whatever follows from it.
#[test]
fn one_mistake_is_one_line() {
    let told = message(&edited(EN, "duration = 7.0", "duration = 1e300"), &[]);
    assert_eq!(
        told,
        "x.toml:6: run.duration = 1e300 s: must be at most 100000 s: 1e8 steps of 0.001 s"
    );
    for error in ["0.0", "-1.0", "nan"] {
        let told = message(&edited(EN, MESH, &format!("error_percent = {error}")), &[]);
        holds(
            &told,
            &["catenary.mesh.error_percent = ", " %: must be positive and finite"],
        );
        assert_eq!(told.lines().count(), 1, "{told}");
    }
    // Where a run ends follows from its speed, which is wrong.
    let told = message(EN, &["run.speed_kmh=1e30"]);
    holds(
        &told,
        &["run.speed_kmh = 1e30 km/h: must be below", "e29 m/s is not below"],
    );
    assert_eq!(told.lines().count(), 1, "{told}");
    // A mesh is not chosen, nor a step halved, for values that are refused.
    for keys in [
        &["run.speed_kmh=-250"][..],
        &["run.low_pass_hz=0"],
        &["catenary.damping.beta=-1"],
        &["solver.rho_inf=-1"],
        &["coupling.macro_step=0"],
        &["solver.micro_step=inf", "coupling.macro_step={tolerance=1.0}"],
    ] {
        for mesh in [
            "catenary.mesh={error_percent=1.0}",
            "catenary.mesh.corrections=\"auto\"",
        ] {
            let told = message(EN, &[keys, &[mesh]].concat());
            holds(&told, &[keys[0].split('=').next().unwrap(), "must be"]);
            assert_eq!(told.lines().count(), 1, "{told}");
        }
    }
    let negative = message(EN, &["coupling.macro_step={tolerance=1.0, min=-0.01, max=-0.001}"]);
    holds(&negative, &["coupling.macro_step.max = -0.001 s: must be positive"]);
    holds(
        &message(EN, &["catenary.mesh={error_percent=1e-300}"]),
        &["catenary.mesh.error_percent = 1e-300 %: must be at least 0.1 %"],
    );
}

#[test]
fn a_line_counts_the_same_with_carriage_returns() {
    let text = edited(EN, "duration = 7.0", "duration = -8.0").replace('\n', "\r\n");
    assert_eq!(
        message(&text, &[]),
        "x.toml:6: run.duration = -8 s: must be positive and finite"
    );
}

#[test]
fn a_wrong_linkage_is_refused() {
    #[rustfmt::skip]
    let edits: &[(&str, &str, &[&str])] = &[
        ("second = \"lower_arm\"", "second = \"lower_harm\"", &["pantograph[1].joints[1].second = \"lower_harm\": no \
            such body", "\"upper_arm\"", "\"base\""]),
        ("body = \"pan_head\"", "body = \"head\"", &["pantograph[1].strip.body = \"head\": no such body"]),
        ("inertia = [0.31, 10.43, 10.65]", "inertia = [0.31, 10.43, 20.0]", &["pantograph[1].bodies[1].inertia = \
            [0.31, 10.43, 20.0] kg m²", "20 kg m² is more than the other two together"]),
        ("inertia = [0.31, 10.43, 10.65]", "inertia = [0.31, 10.43, -1.0]", &["pantograph[1].bodies[1].inertia[3] = \
            -1 kg m²: must be positive and finite"]),
        ("inertia = [0.31, 10.43, 10.65]", "inertia = [0.31, 10.43]", &["pantograph[1].bodies[1].inertia", "3 of \
            them"]),
        ("mass = 32.18", "mass = -32.18", &["pantograph[1].bodies[1].mass = -32.18 kg: must be positive and finite"]),
        ("name = \"upper_arm\"", "name = \"lower_arm\"", &["pantograph[1].bodies[2].name = \"lower_arm\": must be \
            unique"]),
        ("name = \"upper_arm\"", "name = \"base\"", &["pantograph[1].bodies[2].name = \"base\": is taken"]),
        ("axis = [0.0, 1.0, 0.0]", "axis = [0.0, 0.0, 0.0]", &["pantograph[1].joints[1].axis = [0.0, 0.0, 0.0]: must \
            have a direction"]),
        ("kind = \"revolute\"", "kind = \"revolt\"", &["pantograph[1].joints[1].kind = \"revolt\": unknown word, did \
            you mean \"revolute\"?", "\"spherical\""]),
        ("kind = \"prismatic\"", "kind = \"revolute\"", &["pantograph[1].strip.body = \"pan_head\": must have exactly \
            one prismatic joint", "has 0"]),
        ("body = \"lower_arm\", distance", "body = \"plunger\", distance", &["pantograph[1].uplift.body = \
            \"plunger\": must have a joint with the base"]),
        ("distance = 0.9557", "distance = 1.9557", &["pantograph[1].uplift.distance = 1.9557 m: must be at most 1.6"]),
        ("first = \"plunger\"\nsecond = \"pan_head\"", "first = \"pan_head\"\nsecond = \
            \"pan_head\"", &["pantograph[1].joints[8].second = \"pan_head\": must differ from first"]),
        ("base = [11.95005378, 0.0, 3.425]", "", &["pantograph[1].base is missing: must be a list of numbers in m, 3 \
            of them"]),
    ];
    for (from, to, fragments) in edits {
        holds(&message(&edited(THESIS, from, to), &[]), fragments);
    }
    let apart = edited(
        THESIS,
        "first = \"base\"\nsecond = \"lower_link\"",
        "first = \"upper_link\"\nsecond = \"lower_link\"",
    );
    assert_eq!(
        message(&apart, &[]),
        "accepted",
        "still joined to the base by the lower arm"
    );
    let stiff = format!("{THESIS}\n").replace("kind = \"spherical\" ", "axis = [0.0, 1.0, 0.0]\nkind = \"revolute\" ");
    holds(
        &message(&stiff, &[]),
        &["pantograph[1].joints = 8 joints: hold 40 of the bodies' 36 motions"],
    );
}

#[test]
fn a_wrong_supplied_pantograph_is_refused() {
    let supplied = |keys: &str| {
        let (before, rest) = EN.split_once("[[pantograph]]").expect("one pantograph");
        let after = rest.split_once("[coupling]").expect("coupling follows").1;
        format!("{before}[[pantograph]]\n{keys}\n[coupling]{after}")
    };
    assert_eq!(message(&supplied("fmu = \"p.fmu\""), &[]), "accepted");
    holds(
        &message(&supplied("fmu = \"p.fmu\""), &["contact={law=\"sliding_joint\"}"]),
        &["contact.law = \"sliding_joint\": must be \"penalty\" where pantograph[1] is an FMU"],
    );
    #[rustfmt::skip]
    let cases: &[(&str, &[&str])] = &[
        ("", &["pantograph[1].model is missing", "fmu = \"path\""]),
        ("fmu = \"\"", &["pantograph[1].fmu = \"\": must be the path of an FMU", "not empty"]),
        ("fmu = \"p.fmu\"\nmodel = \"lumped\"", &["pantograph[1].model: must be left out: fmu is given"]),
        ("fmu = \"p.fmu\"\noutputs = { hight = { variable = \"z\" } }", &["pantograph[1].outputs.hight: unknown key, \
            did you mean \"height\"?", "roll_rate"]),
        ("fmu = \"p.fmu\"\noutputs = { velocity = { variable = \"v\" } }", &["pantograph[1].outputs = velocity: must \
            name height"]),
        ("fmu = \"p.fmu\"\noutputs = { height = { factor = 2.0 } }", &["pantograph[1].outputs.height.variable is \
            missing"]),
        ("fmu = \"p.fmu\"\noutputs = { height = \"z\" }", &["pantograph[1].outputs.height = \"z\": must be a table \
            such as { variable"]),
        ("fmu = \"p.fmu\"\ninputs = { force = { variable = \"f\", factor = 0.0 } \
            }", &["pantograph[1].inputs.force.factor = 0: must be finite and not zero"]),
        ("fmu = \"p.fmu\"\ninputs = { force = { variable = \"f\", offset = \"align\" } \
            }", &["pantograph[1].inputs.force.offset = \"align\": must be a number"]),
        ("fmu = \"p.fmu\"\nparameters = { m = [1.0] }", &["pantograph[1].parameters.m = [1.0]: must be a finite \
            number, true, false or a string"]),
        ("fmu = \"p.fmu\"\nenvironment = { A = \"b\" }", &["pantograph[1].environment.A = \"b\": must be left out, or \
            isolate = true"]),
        ("fmu = \"p.fmu\"\nisolate = true\nenvironment = { A = 1 }", &["pantograph[1].environment.A = 1: must be a \
            string"]),
        ("fmu = \"p.fmu\"\nisolate = true\nenvironment = { \"A=\" = \"b\" }", &["environment.\"A=\" = \"b\": must \
            have a name without ="]),
        ("fmu = \"p.fmu\"\nstep_timeout = 0", &["pantograph[1].step_timeout = 0 s: must be positive and finite"]),
    ];
    for (keys, fragments) in cases {
        holds(&message(&supplied(keys), &[]), fragments);
    }
}

#[test]
fn a_third_party_line_is_not_aligned_and_has_no_numbered_spans() {
    let (before, rest) = EN.split_once("[catenary]").unwrap();
    let after = &rest[rest.find("[[pantograph]]").unwrap()..];
    let line = |keys: &str| format!("{before}[catenary]\nfmu = \"line.fmu\"\n{keys}\n{after}");
    let timed = ["run.evaluate={ time = [2, 3] }"];
    assert_eq!(message(&line(""), &timed), "accepted");
    holds(
        &message(&line(""), &[]),
        &["run.evaluate.spans = [5, 6]: must be time = [from, to] instead"],
    );
    let aligned = "outputs = { \"contact[1].force\" = { variable = \"F\", offset = \"align\" } }";
    let told = message(&line(aligned), &timed);
    holds(
        &told,
        &["x.toml:17: catenary.outputs.\"contact[1].force\".offset = \"align\": must be a number"],
    );
    let misspelt = "outputs = { \"contact[1].forze\" = { variable = \"F\" } }";
    holds(
        &message(&line(misspelt), &timed),
        &["did you mean \"contact[1].force\"?"],
    );
}

#[test]
fn pantographs_follow_the_first_one_and_each_must_stay_on_the_line() {
    let pantograph = &EN[EN.find("[[pantograph]]").unwrap()..EN.find("[coupling]").unwrap()];
    let two = |offset: &str| {
        let second = pantograph.replace("offset_x = 0.0", &format!("offset_x = {offset}"));
        EN.replace("[coupling]", &format!("{second}[coupling]"))
    };
    assert_eq!(message(&two("-15.0"), &[]), "accepted");
    holds(
        &message(&two("10.0"), &[]),
        &["pantograph[2].offset_x = 10 m: must be less than 0 m"],
    );
    holds(
        &message(&two("0.0"), &[]),
        &["pantograph[2].offset_x = 0 m: must be less than 0 m"],
    );
    holds(
        &message(&two("-25.0"), &[]),
        &["the strip of pantograph[2] starts at x = -5 m"],
    );
}

#[test]
fn an_empty_file_names_the_missing_tables() {
    let message = message("", &[]);
    holds(
        &message,
        &[
            "x.toml: run is missing: must be a table",
            "catenary is missing",
            "[[pantograph]]",
            "title is missing",
        ],
    );
}

#[test]
fn text_that_is_not_toml_names_the_line() {
    holds(&message("title = \"x\"\n[run\n", &[]), &["x.toml:2: not valid TOML: "]);
    holds(
        &message("title = \"x\"\ntitle = \"y\"\n", &[]),
        &["x.toml:2: not valid TOML: duplicate key"],
    );
    holds(&message("\u{0}\u{1}", &[]), &["x.toml:1: not valid TOML: "]);
}

#[test]
fn all_problems_are_reported_at_once_in_the_order_of_the_file() {
    let text = edited(
        &edited(EN, "rho_inf = 0.9", "rho_inf = 9"),
        "duration = 7.0",
        "duration = 0",
    );
    let message = message(&text, &["contact.law=bolted"]);
    let keys: Vec<&str> = message
        .lines()
        .map(|line| line.split(' ').nth(1).unwrap_or(""))
        .collect();
    assert_eq!(keys.len(), 3, "{message}");
    assert!(
        message.lines().next().is_some_and(|line| line.contains("run.duration")),
        "{message}"
    );
    assert!(
        message
            .lines()
            .nth(1)
            .is_some_and(|line| line.contains("solver.rho_inf")),
        "{message}"
    );
    assert!(
        message
            .lines()
            .nth(2)
            .is_some_and(|line| line.contains("--set contact.law=bolted: contact.law")),
        "{message}"
    );
}

#[test]
fn a_wrong_override_is_refused_with_its_own_text() {
    #[rustfmt::skip]
    let cases: &[(&str, &[&str])] = &[
        ("run.speed_kmh=-250", &["x.toml: --set run.speed_kmh=-250: run.speed_kmh = -250 km/h: must be positive and \
            finite"]),
        ("run.duration=nan", &["run.duration = NaN s: must be positive"]),
        ("coupling.macro_step=0.0", &["coupling.macro_step = 0 s: must be positive"]),
        ("coupling.algorithm=\"jacobbi\"", &["\"jacobbi\": unknown word, did you mean \"jacobi\"?"]),
        ("coupling.algorithm=jacobbi", &["\"jacobbi\": unknown word, did you mean \"jacobi\"?"]),
        ("run.spede_kmh=3", &["run.spede_kmh: unknown key, did you mean \"speed_kmh\"?"]),
        ("rum.speed_kmh=3", &["rum: unknown key, did you mean \"run\"?"]),
        ("run.speed_kmh", &["must have the form key.path=value"]),
        ("=3", &["must have the form key.path=value"]),
        ("run..speed_kmh=3", &["must have the form key.path=value"]),
        ("run.speed_kmh=", &["run.speed_kmh: \"\" is not a TOML value"]),
        ("catenary.stagger=[0.2, ", &["catenary.stagger: \"[0.2,\" is not a TOML value"]),
        ("run.speed_kmh.value=3", &["run.speed_kmh = 250.0: is not a table, so there is no key value in it"]),
        ("run.speed_kmh[1]=3", &["run.speed_kmh = 250.0: is not a list"]),
        ("pantograph[2].static_force=3", &["pantograph = list: has 1 entry, [1], and no [2]"]),
        ("pantograph[0].static_force=3", &["and no [0]"]),
        (
            "pantograph.static_force=3",
            &["pantograph = list: has 1 entry; say which one, such as pantograph[1].static_force"],
        ),
        ("pantograph.1.static_force=3", &["and no .1"]),
        ("run=3", &["run = 3: must be a table"]),
        ("pantograph[1].masses[2]=-1", &["--set pantograph[1].masses[2]=-1: pantograph[1].masses[2] = -1 kg: must be \
            positive and finite"]),
        ("run.duration=80", &["--set run.duration=80: run.duration = 80 s: must be at most"]),
    ];
    for (text, fragments) in cases {
        let message = message(EN, &[text]);
        assert!(
            message.starts_with("x.toml: --set ") || message.starts_with("x.toml:"),
            "{message}"
        );
        holds(&message, fragments);
    }
}

/// (what differs from a curve that is accepted, fragments of the message), on the scene with the full vehicle.
const CURVES: &[(&str, &[&str])] = &[
    (
        "track.curve.radius=149",
        &["track.curve.radius = 149 m: must be 150 m or more, the smallest radius of a running line"],
    ),
    (
        "track.curve.radius=-800",
        &["track.curve.radius = -800 m: must be positive and finite"],
    ),
    (
        "track.curve.direction=west",
        &["track.curve.direction = \"west\": unknown word; must be \"left\" or \"right\""],
    ),
    (
        "track.curve.cant=0.21",
        &["track.curve.cant = 0.21 m: must be from 0 to 0.2 m"],
    ),
    (
        "track.curve.cant=-0.1",
        &["track.curve.cant = -0.1 m: must be zero or positive"],
    ),
    ("track.curve.length=0", &["track.curve.length = 0 m: must be positive"]),
    (
        "track.curve.transition=12",
        &[
            "track.curve.transition = 12 m: must be 14.286 m or more: with cant = 0.1 m the track is twisted by 8.3 \
                mm per m",
        ],
    ),
    (
        "track.curve.rounding=300",
        &[
            "track.curve.rounding = 300 m: must be at most transition = 80 m",
            "must be at most length = 200 m",
        ],
    ),
    (
        "track.curve.rounding=0.5",
        &[
            "track.curve.rounding = 0.5 m: must be 0.556 m or more, 10 internal steps of 1.000 ms at run.speed_kmh = \
                200.0",
        ],
    ),
    (
        "track.curve.lenght=3",
        &["track.curve.lenght: unknown key, did you mean \"length\"?"],
    ),
    (
        "vehicle.model=vertical",
        &[
            "track.curve: must be left out: the bodies of vehicle.model = \"vertical\" stay in the plane",
            "vehicle.model = \"full\"",
        ],
    ),
    // 200 km/h in 300 m: v²/R cos φ − g sin φ = 9.61 m/s²; the vehicle of the thesis stands up to 6.33.
    (
        "track.curve.radius=300",
        &[
            "track.curve.radius = 300 m: must leave less than 6.33 m/s² along the plane of the rails",
            "run.speed_kmh = 200.0",
            "leaves 9.61 m/s²",
            "over the outer rail",
        ],
    ),
    (
        "model.reduce=planar",
        &["model.reduce = \"planar\": must be left out: track.curve makes the vehicle sway and roll"],
    ),
];

const CURVE: &str = "track.curve={ radius = 1500.0, direction = \"left\", cant = 0.1, start = 100.0, transition = \
    80.0, length = 200.0, \
                     rounding = 6.0 }";

#[test]
fn impossible_curves_are_refused_with_value_unit_and_expectation() {
    assert_eq!(message(VEHICLE, &[CURVE]), "accepted");
    for (change, fragments) in CURVES {
        holds(&message(VEHICLE, &[CURVE, change]), fragments);
    }
}

#[test]
fn a_curve_that_begins_before_the_one_before_it_ends_is_refused() {
    let second = |start: f64| {
        let first = CURVE.trim_start_matches("track.curve=");
        format!(
            "track.curve=[{first}, {}]",
            first.replace("start = 100.0", &format!("start = {start:?}"))
        )
    };
    // The first one ends at 460 m; both cant ramps are rounded over 6 m.
    assert_eq!(message(VEHICLE, &[&second(466.0)]), "accepted");
    let expected =
        "track.curve[2].start = 465.9 m: must be 466.000 m or more: there the cant ramp of the curve before it ends";
    holds(&message(VEHICLE, &[&second(465.9)]), &[expected]);
}

#[test]
fn no_line_left_out_and_no_value_replaced_makes_the_reader_panic() {
    let begins = |message: &str| message == "accepted" || message.lines().all(|line| line.starts_with("x.toml"));
    for scene in [EN, THESIS] {
        let lines: Vec<&str> = scene.lines().collect();
        for i in 0..lines.len() {
            let without = [&lines[..i], &lines[i + 1..]].concat().join("\n");
            let told = message(&without, &[]);
            assert!(begins(&told), "without {:?}: {told}", lines[i]);
            let Some((key, _)) = lines[i].split_once('=') else {
                continue;
            };
            for value in [
                "-1",
                "0",
                "nan",
                "1e308",
                "9223372036854775807",
                "\"x\"",
                "\"\"",
                "[]",
                "[[]]",
                "{}",
                "[{}]",
                "true",
                "1979-05-27",
            ] {
                let replaced = format!("{key}= {value}");
                let with = [&lines[..i], &[replaced.as_str()], &lines[i + 1..]].concat().join("\n");
                let told = message(&with, &[]);
                assert!(begins(&told), "with {replaced:?}: {told}");
            }
        }
    }
}

#[test]
fn modes_are_those_of_a_whole_line_under_the_penalty_law_in_still_air() {
    let told = |overrides: &[&str]| {
        let overrides: Vec<String> = overrides.iter().map(|each| (*each).to_owned()).collect();
        Scene::from_toml(EN, "en50318-250.toml", &overrides)
            .unwrap_err()
            .to_string()
    };
    let reduce = "model.reduce=[\"modal\", \"window\"]";
    holds(
        &told(&[reduce]),
        &["model.reduce = \"modal\": must be left out: \"window\" models a part of the line"],
    );
    let joint = ["model.reduce=[\"modal\"]", "contact={ law=\"sliding_joint\" }"];
    holds(
        &told(&joint),
        &["model.reduce = \"modal\": must be left out: contact.law = \"sliding_joint\" holds the strip on the wire"],
    );
}

#[test]
fn modes_are_planar_where_that_changes_nothing() {
    let overrides = ["model.reduce=[\"modal\"]".to_owned()];
    let scene = Scene::from_toml(EN, "en50318-250.toml", &overrides).unwrap();
    assert_eq!(scene.model.reductions, [Reduction::Modal, Reduction::Planar]);
}

#[test]
fn a_line_is_linear_in_one_way_only() {
    let overrides = ["model.reduce=[\"linearised\", \"flat\"]".to_owned()];
    let error = Scene::from_toml(EN, "en50318-250.toml", &overrides)
        .unwrap_err()
        .to_string();
    let expected = "model.reduce = \"linearised\": must be left out: \"flat\" is another linear line; one of the two";
    assert!(error.contains(expected), "{error}");
}

#[test]
fn steps_of_bounded_work_factor_once() {
    let fixed = "solver.fixed_work=true";
    assert_eq!(message(EN, &[fixed]), "accepted");
    assert_eq!(message(EN, &[fixed, "model.reduce=[\"modal\"]"]), "accepted");
    let window = message(EN, &[fixed, "model.reduce=[\"window\"]"]);
    assert!(
        window.contains("model.reduce = \"window\": must be left out: solver.fixed_work factors once"),
        "{window}"
    );
    let full = message(EN, &[fixed, "solver.jacobian=full"]);
    assert!(
        full.contains("solver.jacobian = \"full\": must be \"modified\""),
        "{full}"
    );
    let word = message(EN, &["solver.fixed_work=3"]);
    assert!(word.contains("solver.fixed_work = 3: must be true or false"), "{word}");
}

#[test]
fn a_window_is_refused_with_its_reason_only_on_masts_that_differ_and_uneven_running_surfaces() {
    let reduce = "model.reduce=[\"window\"]";
    let mixed = "catenary.span_length=[60,60,60,60,60,60,66,60,60,60]";
    let mesh = "catenary.mesh={ element_length=0.93 }";
    assert_eq!(message(EN, &[mixed, mesh, reduce]), "accepted");
    assert_eq!(message(STITCHED, &[reduce]), "accepted");
    let surface = message(EN, &["catenary.surface={ x=[100,200], height=[0,0.001] }", reduce]);
    assert_eq!(message(OVERLAP, &[reduce]), "accepted");
    let moved = message(&OVERLAP.replace("start_x = 240.0", "start_x = 243.0"), &[reduce]);
    for (refused, reason) in [
        (surface, "made for wires of even running surface"),
        (moved, "no support at a mast that it passes"),
    ] {
        holds(
            &refused,
            &["model.reduce = \"window\": must be left out: it is", reason],
        );
    }
}

#[test]
fn a_supplied_line_cannot_be_reduced() {
    let (before, rest) = EN.split_once("[catenary]").unwrap();
    let pantograph = &rest[rest.find("[[pantograph]]").unwrap()..];
    let other = format!("{before}[catenary]\nfmu = \"line.fmu\"\n[model]\nreduce = [\"linearised\"]\n{pantograph}");
    let error = Scene::from_toml(&other, "scene.toml", &["run.evaluate={ time = [2, 3] }".to_owned()])
        .unwrap_err()
        .to_string();
    let expected = "model.reduce = \"linearised\": must be left out: the line is a supplied FMU";
    assert!(error.contains(expected), "{error}");
}

/// The scene with a vehicle, its text changed in one place.
fn vehicle_message(from: &str, to: &str) -> String {
    const VEHICLE: &str = include_str!("../../../scenes/thesis-own-mesh.toml");
    assert_eq!(VEHICLE.matches(from).count(), 1, "{from}");
    let error = Scene::from_toml(&VEHICLE.replace(from, to), "thesis-own-mesh.toml", &[]).unwrap_err();
    error.to_string()
}

#[test]
fn a_vehicle_that_cannot_be_is_refused_by_key_value_and_remedy() {
    let cases: [(&str, &str, &[&str]); 10] = [
        (
            "mass = 24170.0",
            "mass = -24170.0",
            &["vehicle.bodies[1].mass = -24170 kg: must be positive"],
        ),
        (
            "carrier = \"car_body\"",
            "carrier = \"car\"",
            &["vehicle.carrier = \"car\": no such bodies: must be one of \"car_body\", \"bolster\""],
        ),
        (
            "carrier = \"car_body\"",
            "carrier = \"bolster\"",
            &["vehicle.carrier = \"bolster\": must be a body that there is one of"],
        ),
        (
            "wheelset = \"wheelset\"",
            "wheelset = \"axle\"",
            &[
                "vehicle.wheels.wheelset = \"axle\": no such bodies",
                "vehicle.bearings[1].second = \"wheelset\": must be",
            ],
        ),
        (
            "name = \"bolster\"\nmass",
            "name = \"frame\"\nmass",
            &["vehicle.bodies[3].name = \"frame\": must be unique"],
        ),
        (
            "positions = [[7.5819, 0.0, 1.8289]]",
            "positions = [[7.5819, 0.0]]",
            &["vehicle.bodies[1].positions[1] = [7.5819, 0.0]: must be a point in m, 3 numbers"],
        ),
        (
            "displacement = [-0.065, -0.060,",
            "displacement = [-0.060, -0.065,",
            &["vehicle.bushings[6].stop.displacement[2] = -0.065 m: must be greater than the entry before it, -0.06 m"],
        ),
        (
            "creep = \"polach\"",
            "creep = \"polack\"",
            &["vehicle.contact.creep = \"polack\": unknown word, did you mean \"polach\"?"],
        ),
        (
            "[track.rail]",
            "[track.rails]",
            &["track.rails: unknown key, did you mean \"rail\"?"],
        ),
        (
            "model = \"full\"",
            "model = \"fully\"",
            &["vehicle.model = \"fully\": unknown word, did you mean \"full\"?"],
        ),
    ];
    for (from, to, expected) in cases {
        holds(&vehicle_message(from, to), expected);
    }
}

#[test]
fn joints_that_change_with_time_need_constraints_of_positions() {
    let overrides = [
        "vehicle={ model = \"rigid_motion\", motion = { time = [0.0, 1.0], z = [0.0, 0.01] } }",
        "solver.formulation=index_1_baumgarte",
    ];
    let error = Scene::from_toml(THESIS, "thesis-own-mesh.toml", &overrides.map(str::to_owned)).unwrap_err();
    holds(
        &error.to_string(),
        &["solver.formulation = \"index_1_baumgarte\": must be \"index_3\""],
    );
}

#[test]
fn a_strip_on_a_base_beside_the_middle_must_reach_the_wire() {
    let base = |y: f64| format!("vehicle.pantograph_base=[11.95005378, {y:?}, 3.425]");
    assert_eq!(message(VEHICLE, &[&base(0.7)]), "accepted");
    holds(
        &message(VEHICLE, &[&base(-0.9)]),
        &[
            "catenary.stagger[1] = 0 m: must be within ±0.8 m of -0.9 m, the y of vehicle.pantograph_base, half the \
                width of the strip",
        ],
    );
}

#[test]
fn the_linkage_on_a_moving_base_is_not_reduced() {
    let message = vehicle_message("[coupling]", "[model]\nreduce = [\"linkage\"]\n[coupling]");
    holds(
        &message,
        &["model.reduce = \"linkage\": must be left out: its base moves with the vehicle"],
    );
}

/// A scene with the six-body linkage, its text changed in one place.
fn reduced_thesis(from: &str, to: &str, reduce: &str) -> Result<Scene, String> {
    assert_eq!(THESIS.matches(from).count(), 1, "{from}");
    let overrides = [format!("model.reduce={reduce}")];
    Scene::from_toml(&THESIS.replace(from, to), "thesis-own-mesh.toml", &overrides).map_err(|error| error.to_string())
}

#[test]
fn a_linkage_that_may_move_otherwise_than_in_its_plane_is_not_reduced() {
    let cases = [
        (
            r#"kind = "revolute"                       # Table 3: lower arm, upper arm
first = "lower_arm"
second = "upper_arm"
point = [10.58842934, 0.0, 4.26522551]  # K, derived: where the axes of both arms meet
axis = [0.0, 1.0, 0.0]"#,
            r#"kind = "spherical"
first = "lower_arm"
second = "upper_arm"
point = [10.58842934, 0.0, 4.26522551]"#,
            "\"pan_head\" may leave the plane: revolute and prismatic joints alone do not join it to the base",
        ),
        (
            "kind = \"spherical\"                      # Table 3: plunger, upper link",
            "kind = \"revolute\"\naxis = [0.0, 1.0, 0.1]",
            "joints[6].axis of the revolute joint is not lateral",
        ),
        (
            "axis = [0.0, 0.0, 1.0]                  # chosen: vertical",
            "axis = [1.0, 0.0, 0.5]",
            "the axis of the collector suspension is far from vertical",
        ),
        (
            "position = [10.96436876, 0.0, 3.81940451]",
            "position = [10.96436876, 0.1, 3.81940451]",
            "the centre of mass of \"lower_link\" is beside the middle",
        ),
        (
            "orientation = [1.5707963267948966, 0.6234559506, -1.5707963267948966]",
            "orientation = [1.5, 0.6234559506, -1.5]",
            "the lateral axis of \"lower_link\" is not one of its principal axes",
        ),
    ];
    for (from, to, reason) in cases {
        assert_eq!(
            reduced_thesis(from, to, "auto").unwrap().model.reductions,
            [Reduction::Planar],
            "{to}"
        );
        let told = reduced_thesis(from, to, "[\"planar\",\"linkage\"]").unwrap_err();
        let expected = format!("model.reduce = \"linkage\": must be left out: pantograph[1]: {reason}");
        assert!(told.contains(&expected), "{told}");
    }
}

#[test]
fn no_word_is_suggested_that_is_spelt_far_from_what_was_typed() {
    for (key, value) in [("anchors", "1"), ("gradient", "0.01")] {
        let told = message(
            &edited(EN, "[catenary]\n", &format!("[catenary]\n{key} = {value}\n")),
            &[],
        );
        holds(&told, &[&format!("catenary.{key}: unknown key; known keys here: ")]);
    }
    let near = message(&edited(EN, "[catenary]\n", "[catenary]\ngravty = 9.81\n"), &[]);
    holds(&near, &["catenary.gravty: unknown key, did you mean \"gravity\"?"]);
}

#[test]
fn a_pantograph_is_named_as_the_file_names_it() {
    let told = message(EN, &["pantographs[1].static_force=100"]);
    holds(&told, &["pantographs: unknown key, did you mean \"pantograph\"?"]);
    assert_eq!(told.lines().count(), 1, "{told}");
    assert!(!told.contains("pantographs[1]:"), "{told}");
}

#[test]
fn a_list_of_reductions_may_be_joined_by_plus() {
    for (word, told) in [
        ("linearised+linearised", "must name \"linearised\" once"),
        ("none+window", "model.reduce = \"none\": unknown word"),
        (
            "linearised+widow",
            "model.reduce = \"widow\": unknown word, did you mean \"window\"?",
        ),
        ("linearised+window", "accepted"),
    ] {
        holds(&message(EN, &[&format!("model.reduce={word}")]), &[told]);
    }
}

#[test]
fn a_list_of_any_length_has_a_message_that_can_be_read() {
    for (entry, told) in [
        ("\"planar\"", "model.reduce[2] = \"planar\": must name \"planar\" once"),
        ("\"plannar\"", "model.reduce[1] = \"plannar\": unknown word"),
        ("7", "model.reduce[1] = 7: must be a word in quotes"),
    ] {
        let list = vec![entry; 30_000].join(", ");
        let text = edited(EN, "[solver]\n", &format!("[model]\nreduce = [{list}]\n\n[solver]\n"));
        let told_all = message(&text, &[]);
        holds(&told_all, &[told, "\nand 29"]);
        assert!(
            told_all.lines().count() == 51 && told_all.len() < 20_000,
            "{} bytes",
            told_all.len()
        );
    }
    let joined = vec!["planar"; 3_000].join("+");
    let told = message(EN, &[&format!("model.reduce={joined}")]);
    assert!(told.lines().count() == 51, "{} lines", told.lines().count());
}

#[test]
fn a_cross_section_that_is_not_in_metres_is_refused_before_it_is_sampled() {
    let text = include_str!("../../../scenes/thesis.toml");
    for value in ["1e3", "1e300", "-35.0"] {
        for key in ["vehicle.wheels.profile", "track.rail.profile"] {
            let set = format!("{key}=[[-0.05, 0.0], [0.0, 0.0], [0.02, 0.0], [0.03, {value}]]");
            let told = message(text, &[&set]);
            holds(&told, &[&format!("{key}[4][2] = "), " m: must be from -0.5 to 0.5"]);
        }
    }
}

#[test]
fn values_in_another_unit_are_refused_with_what_was_likely_meant() {
    for (set, told) in [
        (
            "catenary.contact_wire_height=5300",
            "catenary.contact_wire_height = 5300 m: must be at most 20 m above the top of rail; 5300 mm are 5.3 m",
        ),
        (
            "catenary.contact_wire_height=530",
            "catenary.contact_wire_height = 530 m: must be at most 20 m above the top of rail; 530 cm are 5.3 m",
        ),
        (
            "catenary.contact_wire.tension=15",
            "catenary.contact_wire.tension = 15 N: must be at least 100 N for a wire to hang straight; 15 kN are \
                15000 N",
        ),
        (
            "catenary.messenger_wire.tension=16",
            "catenary.messenger_wire.tension = 16 N: must be at least 100 N for a wire to hang straight; 16 kN are \
                16000 N",
        ),
    ] {
        assert_eq!(message(EN, &[set]), format!("x.toml: --set {set}: {told}"));
    }
}

#[test]
fn an_old_key_or_word_is_refused_with_the_new_one() {
    let old = edited(EN, "corrections = \"auto\"", "cures = \"auto\"");
    assert_eq!(
        message(&old, &[]),
        format!(
            "{}catenary.mesh.cures: renamed, use catenary.mesh.corrections",
            at(&old, "cures")
        )
    );
    assert_eq!(
        message(EN, &["catenary.mesh.cures=none"]),
        "x.toml: --set catenary.mesh.cures=none: catenary.mesh.cures: renamed, use catenary.mesh.corrections"
    );
    for (word, new) in [("default", "index_3"), ("augmented_lagrangian", "index_1_baumgarte")] {
        let old = edited(EN, "rho_inf = 0.9", &format!("rho_inf = 0.9\nformulation = \"{word}\""));
        let refusal = format!("solver.formulation = \"{word}\": renamed, use \"{new}\"");
        assert_eq!(message(&old, &[]), format!("{}{refusal}", at(&old, "formulation")));
        let set = format!("solver.formulation={word}");
        assert_eq!(message(EN, &[&set]), format!("x.toml: --set {set}: {refusal}"));
        assert_eq!(message(EN, &[&format!("solver.formulation={new}")]), "accepted");
    }
}
