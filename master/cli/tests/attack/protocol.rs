//! Frames of the isolation protocol that are changed at random, sent to a child as its parent would: the child answers,
//! or ends with a message.
#![cfg(target_os = "linux")]

use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::net::UnixStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use fastrand::Rng;
use fmi2::import::Fmu;

use crate::archives::whole;
use crate::texts::change_bytes;
use crate::{SEEDS, by_thousands, dice, kept};

/// Longest wall time of a call, which the child is told.
const LIMIT: Duration = Duration::from_secs(20);

/// First bytes of both sides, and the version of what follows.
const GREETING: &[u8] = b"PFMU\x02\0\0\0";

fn list(bytes: &mut Vec<u8>, count: usize, items: &[u8]) {
    bytes.extend((count as u32).to_le_bytes());
    bytes.extend(items);
}

fn words<const N: usize>(bytes: &mut Vec<u8>, words: impl ExactSizeIterator<Item = [u8; N]>) {
    let count = words.len();
    list(bytes, count, &words.flatten().collect::<Vec<_>>());
}

fn numbers(bytes: &mut Vec<u8>, numbers: &[u32]) {
    words(bytes, numbers.iter().map(|number| number.to_le_bytes()));
}

fn reals(bytes: &mut Vec<u8>, numbers: &[f64]) {
    words(bytes, numbers.iter().map(|number| number.to_le_bytes()));
}

fn greeting(fmu: &Fmu) -> Vec<u8> {
    let mut bytes = GREETING.to_vec();
    bytes.extend((LIMIT.as_millis() as u64).to_le_bytes());
    bytes.extend(0_u64.to_le_bytes());
    for path in [fmu.path(), fmu.folder()] {
        let path = path.as_os_str().as_bytes();
        list(&mut bytes, path.len(), path);
    }
    bytes
}

/// One request: its code and arguments that are most often right.
fn request(rng: &mut Rng, code: u8, time: &mut f64) -> Vec<u8> {
    let mut bytes = vec![code];
    let references: Vec<u32> = (0..rng.usize(..4)).map(|_| rng.u32(..40)).collect();
    let values: Vec<f64> = references
        .iter()
        .map(|_| [0.0, 5.5, f64::NAN, 1e300][rng.usize(..4)])
        .collect();
    match code {
        1 => {
            list(&mut bytes, 1, b"a");
            bytes.push(rng.u8(..2));
        }
        2 => {
            for (given, value) in [(None, 0.0), (Some(1), 10.0), (Some(0), 0.0)] {
                bytes.extend(given);
                bytes.extend(f64::to_le_bytes(value));
            }
        }
        7 => {
            numbers(&mut bytes, &references);
            reals(&mut bytes, &values);
        }
        8 | 9 | 16 => {
            numbers(&mut bytes, &references);
            numbers(&mut bytes, &vec![1; references.len()]);
        }
        10 => {
            numbers(&mut bytes, &references);
            references.iter().for_each(|_| list(&mut bytes, 2, b"/x"));
        }
        11..=14 => numbers(&mut bytes, &references),
        15 => {
            numbers(&mut bytes, &references);
            numbers(&mut bytes, &vec![1; references.len()]);
            reals(&mut bytes, &values);
        }
        17 => {
            numbers(&mut bytes, &references);
            numbers(&mut bytes, &references);
            reals(&mut bytes, &values);
        }
        18 => {
            bytes.extend(time.to_le_bytes());
            bytes.extend(1e-3_f64.to_le_bytes());
            *time += 1e-3;
        }
        22..=25 => bytes.extend([0, 0, 1, 2, 7, u32::MAX][rng.usize(..6)].to_le_bytes()),
        26 => list(&mut bytes, 20, &[7; 20]),
        27 => {
            bytes.push(1);
            bytes.extend(1_u32.to_le_bytes());
            list(&mut bytes, 9, b"logEvents");
        }
        _ => {}
    }
    bytes
}

/// Bytes that the child is sent: greeting and frames of requests, some of them changed.
fn sent(rng: &mut Rng, fmu: &Fmu) -> Vec<u8> {
    let mut contents = vec![greeting(fmu)];
    let mut time = 0.0;
    // First as an importer begins: instance, experiment, initialisation.
    let mut ordered = 1..=rng.u8(..=4);
    for _ in 0..rng.usize(1..12) {
        let mut content = Vec::new();
        let begun = ordered.next();
        let count = if begun.is_some() { 1 } else { rng.usize(..4) };
        content.extend((count as u32).to_le_bytes());
        for _ in 0..count {
            let code = begun.unwrap_or_else(|| rng.u8(1..30));
            content.extend(request(rng, code, &mut time));
        }
        contents.push(content);
    }
    let attacked = rng.usize(..contents.len());
    let attacked = if rng.u8(..4) == 0 {
        attacked
    } else {
        attacked.max(1).min(contents.len() - 1)
    };
    if rng.u8(..5) > 0 {
        change_bytes(rng, &mut contents[attacked]);
    }
    let mut bytes = Vec::new();
    for (number, content) in contents.iter().enumerate() {
        let mut length = content.len() as u32;
        if number == attacked && rng.u8(..4) == 0 {
            length = [0, length + 1, length.saturating_sub(1), 1 << 30, u32::MAX][rng.usize(..5)];
        }
        bytes.extend(length.to_le_bytes());
        bytes.extend(content);
    }
    bytes
}

/// Fault of a child that is sent these bytes.
fn fault(bytes: &[u8]) -> Option<String> {
    let (mut ours, theirs) = UnixStream::pair().unwrap();
    let mut child = Command::new("sh")
        .args([
            "-c",
            "ulimit -v 4000000; exec \"$0\" isolated-fmu",
            env!("CARGO_BIN_EXE_master"),
        ])
        .stdin(Stdio::from(OwnedFd::from(theirs)))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    ours.set_read_timeout(Some(LIMIT + Duration::from_secs(10))).unwrap();
    ours.set_write_timeout(Some(LIMIT)).unwrap();
    // One that has ended takes no more.
    let _ = ours.write_all(bytes);
    let _ = ours.shutdown(std::net::Shutdown::Write);
    let mut answered = Vec::new();
    let read = ours.read_to_end(&mut answered);
    let begin = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begin.elapsed() > LIMIT {
            child.kill().unwrap();
            child.wait().unwrap();
            return Some("it does not end".to_owned());
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let raw = |c: char| c.is_control() && c != '\n' && c != '\t';
    match output.status.code() {
        Some(0) => {}
        Some(1 | 2) if said.trim().is_empty() => return Some("nothing is said".to_owned()),
        Some(1 | 2) => {}
        _ => return Some(format!("{}: {said}", output.status)),
    }
    if said.contains(raw) || said.contains("panicked") || said.contains("a defect of this program") {
        return Some(said);
    }
    if let Err(error) = read.as_ref().map_err(std::io::Error::kind)
        && error != std::io::ErrorKind::ConnectionReset
    {
        return Some(format!("its answer: {error}"));
    }
    unframed(&answered)
}

/// Fault of bytes that are no frames of a child.
fn unframed(mut answered: &[u8]) -> Option<String> {
    let mut first = true;
    while let Some((length, rest)) = answered.split_first_chunk::<4>() {
        let Some((content, rest)) = rest.split_at_checked(u32::from_le_bytes(*length) as usize) else {
            return Some("a frame is cut off".to_owned());
        };
        let known = if first {
            content == GREETING
        } else {
            matches!(content.first(), Some(1..=3))
        };
        if !known {
            return Some(format!(
                "a frame of no known kind: {:?}",
                String::from_utf8_lossy(content)
            ));
        }
        if String::from_utf8_lossy(content).contains("panicked") {
            return Some(String::from_utf8_lossy(content).into_owned());
        }
        (answered, first) = (rest, false);
    }
    None
}

/// Frames as the parent sends them.
fn framed(contents: &[Vec<u8>]) -> Vec<u8> {
    let framed = contents
        .iter()
        .map(|content| [&(content.len() as u32).to_le_bytes(), &**content].concat());
    framed.collect::<Vec<_>>().concat()
}

/// The number of a state that was never saved made the child panic.
#[test]
fn regress_35_a_child_refuses_a_state_that_it_has_not_saved() {
    let whole = whole();
    let instantiate = [&1_u32.to_le_bytes()[..], &[1, 1, 0, 0, 0, b'a', 0]].concat();
    for code in [22, 23, 25] {
        let unknown = [&1_u32.to_le_bytes()[..], &[code, 7, 0, 0, 0]].concat();
        let bytes = framed(&[greeting(&whole.fmus[1]), instantiate.clone(), unknown]);
        assert_eq!(fault(&bytes), None);
    }
}

fn attack(seed: u64, count: usize) {
    let fmus = whole();
    for number in 0..count {
        let mut rng = dice(seed, number);
        let bytes = sent(&mut rng, &fmus.fmus[number % 2]);
        if let Some(fault) = fault(&bytes) {
            panic!("seed {seed}, {}: {fault}", kept(&bytes, "frames", seed, number));
        }
    }
}

#[test]
fn a_child_answers_changed_frames_or_ends_with_a_message() {
    SEEDS.iter().for_each(|&seed| attack(seed, 30));
}

#[test]
#[ignore = "for hours: thousands of children; ATTACK_SEED chooses others"]
fn attack_by_frames_to_a_child() {
    by_thousands(attack, 3_000, "children");
}
