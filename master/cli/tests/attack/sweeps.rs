//! Files of sweeps that are changed at random: a plan comes out of them, or a message.

use std::path::Path;

use fastrand::Rng;
use sweep::base::Numbers;
use sweep::{Base, Plan, Wishes};

use crate::scenes::{changed, text};
use crate::texts::{ODD, change_bytes};
use crate::{SEEDS, by_thousands, caught, dice, kept, unsaid};

/// A file with something of everything.
const FILE: &str = r#"
scene = "en50318-300.toml"
mode = "monolithic"
where = ["run.speed_kmh < 300", "pantograph[1].static_force <= 80 + run.speed_kmh / 4"]
series = true

[set]
"catenary.spans" = 8
"run.evaluate" = { spans = [3, 4] }
"model.reduce" = ["planar", "linearised"]

[vary]
run.speed_kmh = "200:320:40"
"pantograph[1].static_force" = { from = 100, to = 140, step = 20 }
coupling.algorithm = ["jacobi", "gauss_seidel"]

[derive]
distance = "4.5 * catenary.span_length - run.start_x"
"run.duration" = "distance / (run.speed_kmh / 3.6)"
"#;

/// A file of samples.
const SAMPLES: &str = r#"
scene = "en50318-300.toml"
where = "force > 90 && not(run.speed_kmh == 0)"

[vary]
force = { normal = [110, 5] }
"contact.stiffness" = { log_uniform = [1e4, 1e5] }
run.speed_kmh = { uniform = [200, 300] }
coupling.algorithm = { choice = ["jacobi", "auto"] }

[derive]
"pantograph[1].static_force" = "max(force, 100) ^ 1"

[sample]
method = "sobol"
count = 64
seed = 3
"#;

/// Values and expressions that are odd.
const WORDS: [&str; 24] = [
    "0:1e9:1",
    "0:1:1e-300",
    "1:0:1",
    "0:1:0",
    "nan:1:1",
    "-1e308:1e308:1e307",
    "normal(0,0)",
    "normal(1e300,1e300)",
    "uniform(1,1)",
    "uniform(2,1)",
    "log_uniform(-1,1)",
    "choice()",
    "1,,2",
    "((((((((((1))))))))))",
    "1 / 0",
    "distance + distance",
    "run.duration + 1",
    "sqrt(-1)",
    "1 2",
    "pi pi",
    "max(1)",
    "min",
    "--1 ^ -2 ^ 1e300",
    "é + 1",
];

/// Text of a file that is changed on its tables, in a word, or as bytes.
fn attacked(rng: &mut Rng) -> String {
    let file = if rng.bool() { FILE } else { SAMPLES };
    match rng.u8(..4) {
        0 => {
            let mut bytes = file.as_bytes().to_vec();
            change_bytes(rng, &mut bytes);
            String::from_utf8_lossy(&bytes).into_owned()
        }
        1 => {
            let quoted: Vec<(usize, usize)> = {
                let marks: Vec<usize> = file.match_indices('"').map(|(at, _)| at).collect();
                marks.chunks_exact(2).map(|pair| (pair[0] + 1, pair[1])).collect()
            };
            let (from, to) = quoted[rng.usize(..quoted.len())];
            let all = WORDS.len() + ODD.len();
            let word = match rng.usize(..all) {
                at if at < WORDS.len() => WORDS[at].to_owned(),
                at => ODD[at - WORDS.len()].escape_default().to_string(),
            };
            let word = if rng.u8(..6) == 0 {
                word.repeat(1 << rng.u32(..13))
            } else {
                word
            };
            format!("{}{word}{}", &file[..from], &file[to..])
        }
        _ => changed(rng, file),
    }
}

/// Reads a file as the program does, up to the first cases.
fn plan(base: &Base, text: &str) -> Result<(), String> {
    let shown = |error: sweep::SweepError| error.to_string();
    let wishes = Wishes::read(text, "changed.toml").map_err(shown)?;
    let base = Base::new(
        &base.name,
        &base.origin,
        &base.folder,
        self::text("en50318-300"),
        wishes.set.clone(),
    );
    let scene = base.read(&[]).map_err(|error| error.to_string())?;
    let plan = Plan::new(wishes.plan().map_err(shown)?, &Numbers::of(&scene)).map_err(shown)?;
    for case in plan.cases().take(20) {
        let _ = plan.undefined(&case);
        let _ = plan.overrides(&case);
    }
    Ok(())
}

fn read(seed: u64, count: usize) {
    let base = Base::new(
        "en50318-300",
        "en50318-300.toml",
        Path::new(""),
        String::new(),
        Vec::new(),
    );
    for number in 0..count {
        let text = attacked(&mut dice(seed, number));
        let fault = caught(|| plan(&base, &text).err().and_then(|said| unsaid(&said)));
        if let Some(fault) = fault {
            panic!("seed {seed}, {}: {fault}", kept(text.as_bytes(), "toml", seed, number));
        }
    }
}

#[test]
fn files_of_sweeps_that_are_not_changed_are_read() {
    let base = Base::new("a", "a.toml", Path::new(""), String::new(), Vec::new());
    for file in [FILE, SAMPLES] {
        plan(&base, file).unwrap();
    }
}

#[test]
fn changed_files_of_sweeps_become_plans_or_are_refused_with_a_message() {
    SEEDS.iter().for_each(|&seed| read(seed, 300));
}

#[test]
#[ignore = "for hours: thousands of files; ATTACK_SEED chooses others"]
fn attack_by_sweeps() {
    by_thousands(read, 20_000, "files of sweeps");
}
