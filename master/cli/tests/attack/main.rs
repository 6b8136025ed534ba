//! Files that are changed at random: whatever a file says, the program answers with a result or with a message.
#![forbid(unsafe_code)]

mod archives;
mod libraries;
mod protocol;
mod scenes;
mod ssp;
mod sweeps;
mod tables;
mod texts;
mod xml;
mod zip;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Seeds of the suite.
const SEEDS: [u64; 3] = [1, 2, 3];

/// Time that the program may take, by far: a line of a thousand spans takes a minute on a busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// Address space of the program, kB: a file that asks for more is refused, or a defect.
const MEMORY: u64 = 4_000_000;

/// The seeds of a run by thousands.
fn thousands() -> std::ops::Range<u64> {
    let first = std::env::var("ATTACK_SEED").map_or(10, |seed| seed.parse().expect("a whole number"));
    let count = std::env::var("ATTACK_SEEDS").map_or(3, |count| count.parse().expect("a whole number"));
    first..first + count
}

/// Attacks with `count` cases of each of these seeds, and says so.
fn by_thousands(attack: fn(u64, usize), count: usize, what: &str) {
    for seed in thousands() {
        attack(seed, count);
        println!("seed {seed}: {count} {what}");
    }
}

/// Random numbers of one case, which can be made again alone.
fn dice(seed: u64, number: usize) -> fastrand::Rng {
    fastrand::Rng::with_seed(seed << 32 | number as u64)
}

/// Keeps a file that has shown a fault, and says where.
fn kept(bytes: &[u8], ending: &str, seed: u64, number: usize) -> String {
    let path = std::env::temp_dir().join(format!("pantoline-attack-{seed}-{number}.{ending}"));
    std::fs::write(&path, bytes).unwrap();
    path.display().to_string()
}

/// Fault of a body that panics, or says so.
fn caught(body: impl FnOnce() -> Option<String>) -> Option<String> {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or_else(|_| Some("it panics".to_owned()))
}

/// Fault of a refusal that says nothing.
fn unsaid(said: &str) -> Option<String> {
    said.trim().is_empty().then(|| "nothing is said".to_owned())
}

/// An ended program.
struct Ended {
    status: std::process::ExitStatus,
    shown: String,
    said: String,
}

impl Ended {
    /// Fault of a program: a status beyond those that are documented, no message where it is not 0, a control character
    /// that reaches the terminal, a panic.
    fn fault(&self) -> Option<String> {
        let Self { status, shown, said } = self;
        let raw = |c: char| c.is_control() && c != '\n' && c != '\t';
        let fault = match status.code() {
            Some(1 | 2) if said.trim().is_empty() => Some("nothing is said".to_owned()),
            Some(0..=2) if said.contains(raw) || shown.contains(raw) => {
                Some("a control character is printed".to_owned())
            }
            Some(0..=2) if said.contains("a defect of this program") => Some("it panics".to_owned()),
            Some(0..=2) => None,
            _ => Some(status.to_string()),
        };
        fault.map(|fault| format!("{fault}: {said}"))
    }
}

/// The program with bounded memory in a folder; nothing where it does not end.
fn program(folder: &Path, arguments: &[&str]) -> Option<Ended> {
    let file = |name: &str| std::fs::File::create(folder.join(name)).unwrap();
    let temporary = folder.join("temporary");
    std::fs::create_dir_all(&temporary).unwrap();
    let mut child = Command::new("sh")
        .arg("-c")
        .arg(format!("ulimit -v {MEMORY}; exec \"$0\" \"$@\""))
        .arg(env!("CARGO_BIN_EXE_master"))
        .args(arguments)
        .current_dir(folder)
        .env("TMPDIR", &temporary)
        .stdin(Stdio::null())
        .stdout(file("shown"))
        .stderr(file("said"))
        .spawn()
        .unwrap();
    let begin = Instant::now();
    while begin.elapsed() < PATIENCE {
        if let Some(status) = child.try_wait().unwrap() {
            let text = |name: &str| String::from_utf8_lossy(&std::fs::read(folder.join(name)).unwrap()).into_owned();
            return Some(Ended {
                status,
                shown: text("shown"),
                said: text("said"),
            });
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    None
}

/// Fault of the program on a file; `left` are the names that may be left in its folder.
fn program_fault(folder: &Path, arguments: &[&str], left: &[&str]) -> Option<String> {
    let Some(ended) = program(folder, arguments) else {
        return Some("it does not end".to_owned());
    };
    let own = ["temporary", "shown", "said"];
    let names = |folder: &Path| -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect()
    };
    let stray = names(folder)
        .into_iter()
        .find(|name| !left.contains(&&**name) && !own.contains(&&**name));
    let stray = stray.or_else(|| names(&folder.join("temporary")).pop());
    ended
        .fault()
        .or(stray.map(|name| format!("it leaves {name}: {}", ended.said)))
}
