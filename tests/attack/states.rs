//! Serialised states that were changed: refused, or restored, and then a step is made or refused.
use super::{IDENTIFIERS, SEEDS, SMALL, Watchdog, cases, dice, first_seed};
use fastrand::Rng;
use fmi2::import::{Fmu, Instance};
use fmi2::model_description::Causality;
use integration_tests::fmus::reals;

/// States of an FMU in several phases.
fn states(fmu: &Fmu) -> Vec<Vec<u8>> {
    let mut states = Vec::new();
    let mut instance = fmu.instantiate("states", false, false).unwrap();
    let mut keep = |instance: &mut Instance| {
        let state = instance.save_state().unwrap();
        states.push(instance.serialize_state(&state).unwrap());
        instance.free_state(state).unwrap();
    };
    keep(&mut instance);
    instance.setup_experiment(0.0, Some(2.0), None).unwrap();
    instance.enter_initialization_mode().unwrap();
    keep(&mut instance);
    instance.exit_initialization_mode().unwrap();
    keep(&mut instance);
    for n in 0..3 {
        instance.do_step(f64::from(n) * 1e-3, 1e-3).unwrap();
    }
    keep(&mut instance);
    instance.terminate().unwrap();
    keep(&mut instance);
    states
}

/// Writes the checksum anew: it keeps out accidents, not attackers.
fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some((content, checksum)) = bytes.split_last_chunk_mut::<4>() {
        *checksum = crc32fast::hash(content).to_le_bytes();
    }
    bytes
}

/// Writes the length of the model's part and the checksum anew.
pub fn complete(mut bytes: Vec<u8>, begin: usize) -> Vec<u8> {
    let length = bytes.len().saturating_sub(begin + 4) as u64;
    bytes[begin - 8..begin].copy_from_slice(&length.to_le_bytes());
    signed(bytes)
}

/// Begin of the model's part: magic number, version, GUID with its length, progress, length of the model.
pub fn begin_of_model(bytes: &[u8]) -> usize {
    let guid = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    8 + 4 + 4 + guid + 36 + 8
}

/// Changes bytes from `begin` on; `end` bytes at the end stay.
fn change(rng: &mut Rng, bytes: &mut Vec<u8>, begin: usize, others: &[Vec<u8>]) {
    let end = bytes.len() - 4;
    let place = rng.usize(begin..end);
    match rng.u8(..8) {
        0 => bytes[place] = rng.u8(..),
        1 => bytes[place] ^= 1 << rng.u32(..8),
        2 => {
            let odd = [f64::NAN, f64::INFINITY, 1e300, -1e300, 0.0, -1.0, 1e9, 5e-324];
            let value = odd[rng.usize(..odd.len())].to_le_bytes();
            let count = 8.min(end - place);
            bytes[place..place + count].copy_from_slice(&value[..count]);
        }
        3 => drop(bytes.drain(place..(place + rng.usize(1..64)).min(end))),
        4 => {
            let count = rng.usize(1..64);
            bytes.splice(place..place, std::iter::repeat_n(rng.u8(..), count));
        }
        5 => bytes[place..(place + 10).min(end)].fill(0xff),
        6 => {
            let other = &others[rng.usize(..others.len())];
            let from = rng.usize(..other.len() - 4);
            let until = (from + rng.usize(1..4096)).min(other.len() - 4);
            bytes.splice(place..place, other[from..until].iter().copied());
        }
        _ => bytes.truncate(place.max(begin + 4)),
    }
}

/// A state that is changed in header or model, most often so that length and checksum are right.
fn changed(rng: &mut Rng, states: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = states[rng.usize(..states.len())].clone();
    let begin = begin_of_model(&bytes);
    for _ in 0..rng.usize(1..3) {
        if bytes.len() < begin + 16 {
            break;
        }
        if rng.u8(..4) == 0 {
            // Phase, flags and times; the GUID and the length before it stay.
            let place = rng.usize(begin - 44..begin - 8);
            bytes[place] = [0, 1, 3, 7, 0xff, 0xf0, 0x7f, rng.u8(..)][rng.usize(..8)];
        } else {
            change(rng, &mut bytes, begin, states);
        }
    }
    match rng.u8(..8) {
        0 => bytes,
        1 => signed(bytes),
        _ => complete(bytes, begin),
    }
}

/// Refuses text that tells of a panic.
fn is_no_panic<T, E: std::fmt::Display>(result: Result<T, E>) -> Option<T> {
    result
        .inspect_err(|error| assert!(!error.to_string().contains("panicked"), "{error}"))
        .ok()
}

/// Restores a changed state and goes on.
fn restored(fmu: &Fmu, instance: &mut Instance, bytes: &[u8]) {
    let Some(state) = is_no_panic(instance.deserialize_state(bytes)) else {
        return;
    };
    if is_no_panic(instance.restore_state(&state)).is_some() {
        let outputs = reals(fmu, Causality::Output);
        let mut values = vec![f64::NAN; outputs.len()];
        if is_no_panic(instance.get_real(&outputs, &mut values)).is_some() {
            assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
        }
        if let Ok(Some(time)) = instance.last_successful_time() {
            is_no_panic(instance.do_step(time, 1e-3));
        }
        if is_no_panic(instance.get_real(&outputs, &mut values)).is_some() {
            assert!(values.iter().all(|value| value.is_finite()), "{values:?}");
        }
        let again = is_no_panic(instance.save_state());
        if let Some(again) = again {
            is_no_panic(instance.serialize_state(&again));
            instance.free_state(again).unwrap();
        }
    }
    instance.free_state(state).unwrap();
    instance.reset().unwrap();
}

fn attack(seed: u64, count: u64) {
    for (identifier, from) in IDENTIFIERS.into_iter().zip([0, count / 2]) {
        let fmu = SMALL.open(identifier);
        let states = states(&fmu);
        let mut instance = fmu.instantiate("attacked", false, false).unwrap();
        Watchdog::over(seed, from..from + count / 2, |number| {
            let bytes = changed(&mut dice(seed, number), &states);
            let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                restored(&fmu, &mut instance, &bytes);
            }));
            if let Err(panic) = caught {
                let path = std::env::temp_dir().join(format!("pantoline-attack-{identifier}-{seed}-{number}.state"));
                std::fs::write(&path, &bytes).unwrap();
                eprintln!("{identifier}, seed {seed}, state {number}: {}", path.display());
                std::panic::resume_unwind(panic);
            }
        });
    }
}

#[test]
fn changed_states_are_refused_or_restored() {
    let _process = super::beside_others();
    SEEDS.iter().for_each(|&seed| attack(seed, 400));
}

#[test]
#[ignore = "for hours: thousands of states; ATTACK_SEED and ATTACK_COUNT choose others"]
fn attack_by_saved_states() {
    let _process = super::beside_others();
    let (seed, count) = (first_seed(), cases(20_000));
    attack(seed, count);
    println!("seed {seed}: {count} changed states");
}
