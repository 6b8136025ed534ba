//! Both FMUs under attack: random sequences of native calls, and saved states that were changed. Whatever comes, the
//! host lives, statuses are those of the standard, and what is handed out with `fmi2OK` is finite.
mod calls;
mod regressions;
mod sequence;
mod soak;
mod states;

use integration_tests::fmus::Packaged;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{LazyLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::{Duration, Instant};

/// Seeds of the suite.
const SEEDS: [u64; 3] = [1, 2, 3];

/// Time that a case may take, by far.
const PATIENCE: Duration = Duration::from_secs(120);

const IDENTIFIERS: [&str; 2] = ["Catenary", "Pantograph"];

/// A line that is built at once, with a pantograph of point masses.
static SMALL: LazyLock<Packaged> = LazyLock::new(|| {
    let text = include_str!("../../scenes/tram-single-wire.toml");
    let short = [
        "catenary.spans=2",
        "catenary.mesh={ elements_per_interval = 2 }",
        "run.start_x=5",
        "run.duration=1.0",
        "run.evaluate={ time = [0.0, 1.0] }",
    ];
    let (text, _) = text.split_once("[ranges]").unwrap();
    Packaged::new(text, &short)
});

/// Held by all tests, so that one that looks at the memory of this process has it to itself.
static PROCESS: RwLock<()> = RwLock::new(());

/// Other tests may run meanwhile.
fn beside_others() -> RwLockReadGuard<'static, ()> {
    PROCESS.read().unwrap_or_else(PoisonError::into_inner)
}

/// No other test runs meanwhile.
fn alone() -> RwLockWriteGuard<'static, ()> {
    PROCESS.write().unwrap_or_else(PoisonError::into_inner)
}

/// First seed of the runs by thousands.
fn first_seed() -> u64 {
    std::env::var("ATTACK_SEED").map_or(10, |seed| seed.parse().expect("a whole number"))
}

/// Number of cases of a run by thousands.
fn cases(default: u64) -> u64 {
    std::env::var("ATTACK_COUNT").map_or(default, |count| count.parse().expect("a whole number"))
}

/// Random numbers of one case, which can be made again alone.
fn dice(seed: u64, number: u64) -> fastrand::Rng {
    fastrand::Rng::with_seed(seed << 32 | number)
}

/// Ends the process where one case does not end; dropped when all have ended.
struct Watchdog<'a> {
    case: &'a AtomicU64,
}

impl Watchdog<'_> {
    /// Runs `cases` from `body` one after the other while another thread looks whether they go on.
    fn over(seed: u64, cases: std::ops::Range<u64>, mut body: impl FnMut(u64)) {
        let case = AtomicU64::new(cases.start);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let (mut seen, mut since) = (cases.start, Instant::now());
                loop {
                    std::thread::sleep(Duration::from_millis(20));
                    let now = case.load(Ordering::Relaxed);
                    if now == u64::MAX {
                        return;
                    }
                    if now != seen {
                        (seen, since) = (now, Instant::now());
                    } else if since.elapsed() > PATIENCE {
                        eprintln!("seed {seed}, case {now}: it does not end");
                        std::process::abort();
                    }
                }
            });
            let watchdog = Watchdog { case: &case };
            for number in cases.clone() {
                watchdog.case.store(number, Ordering::Relaxed);
                body(number);
            }
        });
    }
}

impl Drop for Watchdog<'_> {
    fn drop(&mut self) {
        self.case.store(u64::MAX, Ordering::Relaxed);
    }
}
