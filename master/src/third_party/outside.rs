//! Probing in a process of its own: an FMU that crashes or hangs while it is tried takes nothing else down.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::time::Duration;

use fmi2::import::Fmu;
use serde::{Deserialize, Serialize};

use super::probe::{Probe, Request, probe};

/// Word of the command line that is for [`answer`] only.
pub const SUBCOMMAND: &str = "probe-fmu";

/// What goes to the other process.
#[derive(Serialize, Deserialize)]
struct Order {
    fmu: PathBuf,
    request: Request,
}

/// This program, where it is what runs: tests and other programs that use the library have no such subcommand.
fn program() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    (program.file_stem()? == env!("CARGO_PKG_NAME")).then_some(program)
}

/// Probes an FMU, in another process where that is possible; each thing tried may take `timeout` s.
#[must_use]
pub fn probed(fmu: &Fmu, request: &Request, timeout: f64) -> Probe {
    match program() {
        Some(program) => ask(&program, fmu.path(), request, timeout),
        None => probe(fmu, request, &mut |_| {}),
    }
}

/// Kills the process when dropped.
struct Guard(Child);

impl Drop for Guard {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn ask(program: &Path, fmu: &Path, request: &Request, timeout: f64) -> Probe {
    let mut last = Probe {
        stage: "starting a process for it".to_owned(),
        ..Probe::default()
    };
    let order = Order {
        fmu: std::path::absolute(fmu).unwrap_or_else(|_| fmu.to_owned()),
        request: request.clone(),
    };
    let child = Command::new(program)
        .arg(SUBCOMMAND)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let mut child = match child {
        Ok(child) => Guard(child),
        Err(error) => {
            last.failure = Some(format!("no process to try it in: {error}"));
            return last;
        }
    };
    if let (Some(mut stdin), Ok(text)) = (child.0.stdin.take(), serde_json::to_string(&order)) {
        // A process that has ended already is told by its status.
        let _ = stdin.write_all(text.as_bytes());
    }
    let (sender, receiver) = mpsc::channel();
    if let Some(stdout) = child.0.stdout.take() {
        std::thread::spawn(move || {
            for line in BufReader::new(stdout).lines().map_while(Result::ok) {
                // An FMU may print between the answers.
                if let Ok(found) = serde_json::from_str::<Probe>(&line)
                    && sender.send(found).is_err()
                {
                    return;
                }
            }
        });
    }
    let patience = Duration::from_secs_f64(timeout);
    loop {
        match receiver.recv_timeout(patience) {
            Ok(found) => last = found,
            Err(mpsc::RecvTimeoutError::Timeout) => {
                last.failure = Some(format!(
                    "the trial was given up after {timeout} s of {}: its claims are not relied on",
                    last.stage
                ));
                return last;
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
        }
    }
    if last.stage != "done" && last.failure.is_none() {
        let how = child
            .0
            .wait()
            .map_or_else(|error| error.to_string(), |status| ended(status));
        last.failure = Some(format!(
            "the FMU ended its process ({how}) while {}: its claims are not relied on",
            last.stage
        ));
    }
    last
}

#[cfg(unix)]
fn ended(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt as _;
    status.signal().map_or_else(
        || status.to_string(),
        |signal| match signal {
            6 => "abort".to_owned(),
            11 => "segmentation fault".to_owned(),
            other => format!("signal {other}"),
        },
    )
}

#[cfg(not(unix))]
fn ended(status: ExitStatus) -> String {
    status.to_string()
}

/// The other process: an order on standard input, what is known on standard output, one line each time it grows.
///
/// # Errors
/// An order that cannot be read.
pub fn answer() -> std::io::Result<()> {
    let order: Order = serde_json::from_reader(std::io::stdin()).map_err(std::io::Error::other)?;
    let tell = |found: &Probe| {
        let mut out = std::io::stdout().lock();
        // Nobody listens any more where this fails.
        let _ = serde_json::to_writer(&mut out, found).map_err(std::io::Error::other);
        let _ = out.write_all(b"\n").and_then(|()| out.flush());
    };
    let found = match Fmu::open(&order.fmu) {
        Ok(fmu) => probe(&fmu, &order.request, &mut |found| tell(found)),
        Err(error) => Probe {
            failure: Some(crate::simulation::chain(&error)),
            ..Probe::default()
        },
    };
    tell(&found);
    // What the FMU does when it is unloaded is not awaited.
    std::process::exit(0)
}
