use std::sync::atomic::{AtomicUsize, Ordering};

use dynamics::lockstep::{Asked, Stopwatch, ask};

use super::*;

/// Questions that were answered with others.
static COMPANIONS: AtomicUsize = AtomicUsize::new(0);

struct Square {
    of: u64,
    is: u64,
    together: usize,
}

impl Asked for Square {
    fn answer(all: &mut [&mut Self]) {
        let together = all.len();
        for square in all {
            square.is = square.of * square.of;
            square.together = together;
        }
    }
}

struct Cube(u64);

impl Asked for Cube {
    fn answer(all: &mut [&mut Self]) {
        COMPANIONS.fetch_max(all.len(), Ordering::Relaxed);
        all.iter_mut().for_each(|cube| cube.0 = cube.0.pow(3));
    }
}

fn square(of: u64) -> Box<Square> {
    ask(Box::new(Square { of, is: 0, together: 0 }))
}

/// Results of the jobs `0..count`, in the order in which they end.
fn made<R: Send>(most: usize, count: u64, one: impl Fn(u64) -> R + Sync) -> Vec<R> {
    let (mut jobs, mut all) = (0..count, Vec::new());
    together(most, &mut || jobs.next(), &one, &mut |result| {
        all.push(result);
        true
    });
    all
}

#[test]
fn questions_are_answered_together_and_go_back_to_whom_asked() {
    let sum = |job: u64| (0..50).map(|n| square(job + n).is).sum::<u64>();
    let alone: Vec<u64> = (0..7).map(sum).collect();
    assert_eq!(made(3, 7, sum), alone);
    assert_eq!(made(1, 7, sum), alone);
    assert_eq!(made(4, 4, |job| square(job).together), [4; 4]);
    assert_eq!(square(3).together, 1);
}

#[test]
fn simulations_that_end_early_or_ask_other_things_keep_nobody_waiting() {
    let mixed = |job: u64| {
        (0..job % 4).for_each(|n| assert_eq!(square(n).is, n * n));
        if job % 2 == 1 {
            assert_eq!(ask(Box::new(Cube(job))).0, job.pow(3));
        }
        job
    };
    let mut all = made(8, 21, mixed);
    all.sort_unstable();
    assert!(all.into_iter().eq(0..21));
    assert!(COMPANIONS.load(Ordering::Relaxed) > 1);
}

#[test]
fn no_further_job_is_drawn_where_none_is_wanted() {
    for most in [1, 2] {
        let (mut drawn, mut kept) = (0, 0);
        let mut draw = || {
            drawn += 1;
            Some(drawn)
        };
        together(most, &mut draw, &|job: u64| square(job).is, &mut |_| {
            kept += 1;
            false
        });
        assert!(drawn <= most as u64 && kept == drawn, "{drawn} {kept}");
    }
}

#[test]
fn a_simulation_that_panics_takes_its_own_stack_down_and_no_other() {
    let mut all = made(3, 3, |job| {
        let own = std::panic::catch_unwind(|| {
            assert!(square(job).is != 1, "on purpose");
            square(job).is
        });
        own.ok()
    });
    all.sort_unstable();
    assert_eq!(all, [None, Some(0), Some(4)]);
}

#[test]
fn a_stopwatch_stands_still_while_others_go_on() {
    let pause = Duration::from_millis(20);
    let begin = Instant::now();
    let own = made(4, 4, |job| {
        let watch = Stopwatch::start();
        for n in 0..3 {
            std::thread::sleep(pause);
            square(job + n);
        }
        watch.elapsed()
    });
    let all = begin.elapsed();
    let sum: Duration = own.iter().sum();
    assert!(own.iter().all(|own| *own >= 3 * pause), "{own:?}");
    assert!(sum <= all && sum >= 12 * pause, "{sum:?} of {all:?}");
}
