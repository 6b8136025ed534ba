//! The child process as the parent has it: start, end, and what it prints.

use std::collections::VecDeque;
use std::io::{self, BufRead as _, BufReader, Read as _};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::import::guard::Ending;
use crate::import::process::{kill_group, kill_marked};

use super::{GRACE, Isolation, SERVES, SUBCOMMAND};

/// Lines of the child's output that are kept for a message about its end.
const LINES: usize = 5;

/// Longest line of the child's output, bytes; more is broken.
const LINE: u64 = 1 << 14;

/// The program that children are started with: this one, or the one beside it where a test runs it as a library.
///
/// # Errors
/// There is none.
pub(crate) fn program() -> io::Result<PathBuf> {
    let this = crate::program::file()?;
    if SERVES.load(Ordering::Relaxed) {
        // itself, also if its file was replaced meanwhile
        let itself = PathBuf::from("/proc/self/exe");
        return Ok(if itself.exists() { itself } else { this });
    }
    let name = format!("master{}", std::env::consts::EXE_SUFFIX);
    let mut around = this.ancestors().skip(1).take(2).map(|folder| folder.join(&name));
    around.find(|path| path.is_file()).ok_or_else(|| {
        let there = this.parent().unwrap_or(Path::new(".")).display();
        io::Error::new(
            io::ErrorKind::NotFound,
            format!("{name} is not beside this program ({there})"),
        )
    })
}

/// Variable of the environment of a child and of all processes that it starts.
const MARK: &str = "PANTOLINE_ISOLATED";

/// A value that no other child has.
fn mark() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let since = std::time::UNIX_EPOCH.elapsed().unwrap_or_default();
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!("{}-{}-{count}", std::process::id(), since.as_nanos())
}

/// Last lines that the child has printed.
type Lines = Arc<Mutex<VecDeque<String>>>;

/// A child and the thread that hands on what it prints; killed when dropped, if it has not ended.
pub(super) struct Process {
    child: Child,
    /// Value of [`MARK`].
    mark: String,
    lines: Lines,
    printer: Option<JoinHandle<()>>,
    ended: Option<ExitStatus>,
}

impl Process {
    /// Starts `program` in `folder` and gives this side's end of its socket.
    pub(super) fn start(
        program: &Path,
        folder: &Path,
        name: &str,
        isolation: &Isolation,
    ) -> io::Result<(Self, UnixStream)> {
        let (ours, theirs) = UnixStream::pair()?;
        let mark = mark();
        let mut child = Command::new(program)
            .arg(SUBCOMMAND)
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .current_dir(folder)
            .envs(&isolation.environment)
            .env(MARK, &mark)
            .process_group(0)
            .spawn()?;
        let lines = Lines::default();
        let printed = child.stderr.take();
        let mut process = Self {
            child,
            mark,
            lines: Arc::clone(&lines),
            printer: None,
            ended: None,
        };
        if let Some(printed) = printed {
            let name = name.to_owned();
            let hand_on = move || hand_on(printed, &name, &lines);
            process.printer = Some(std::thread::Builder::new().spawn(hand_on)?);
        }
        Ok((process, ours))
    }

    /// Waits for the end, `patience` at most, then kills; says how it ended.
    pub(super) fn end(&mut self, patience: Duration) -> Option<ExitStatus> {
        let begin = Instant::now();
        while self.ended.is_none() && begin.elapsed() < patience {
            self.ended = self.child.try_wait().ok().flatten();
            if self.ended.is_none() {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        // also what it has started itself
        kill_group(self.child.id());
        if self.ended.is_none() {
            self.ended = self.child.wait().ok();
        }
        kill_marked(&format!("{MARK}={}", self.mark));
        self.ended
    }

    /// The last lines that it printed, once it has ended.
    pub(super) fn last_lines(&mut self) -> Vec<String> {
        // its end of the pipe is closed, so that the thread ends as soon as it has read what is left; unless a process
        // that it has started, and that has left its group, holds the pipe
        let begin = Instant::now();
        while self.printer.as_ref().is_some_and(|printer| !printer.is_finished()) && begin.elapsed() < GRACE {
            std::thread::sleep(Duration::from_millis(1));
        }
        let lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        lines.iter().cloned().collect()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.ended.is_none() {
            self.end(GRACE);
        }
        self.last_lines();
    }
}

/// Prints the child's lines with its name before each.
fn hand_on(printed: impl io::Read, name: &str, lines: &Lines) {
    let mut printed = BufReader::new(printed);
    let mut line = Vec::new();
    loop {
        line.clear();
        match printed.by_ref().take(LINE).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let text = crate::visible(String::from_utf8_lossy(&line).trim_end()).into_owned();
        eprintln!("{name}: {text}");
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        if lines.len() == LINES {
            lines.pop_front();
        }
        lines.push_back(text);
    }
}

/// How a process ended that left no word, as the rest of a sentence.
pub(super) fn ending(status: Option<ExitStatus>) -> String {
    match status.map(|status| (status.signal(), status.code())) {
        Some((Some(signal), _)) => signalled(signal),
        Some((None, Some(code))) => format!("ended its process with exit status {code}"),
        _ => "ended its process".to_owned(),
    }
}

/// The same, for one whose last words name the reason.
pub(super) fn told(ending: Ending, time_limit: Duration) -> String {
    match ending {
        Ending::Signal(signal) => signalled(signal),
        Ending::TimeLimit => too_long(time_limit),
        Ending::Exit(status) if status >= 0 => format!("ended its process by exit({status})"),
        Ending::Exit(_) => "ended its process by exit()".to_owned(),
    }
}

pub(super) fn too_long(time_limit: Duration) -> String {
    format!(
        "took longer than step_timeout = {} s of wall time and was ended",
        time_limit.as_secs_f64()
    )
}

fn signalled(signal: i32) -> String {
    match Ending::signal(signal) {
        (_, "") => format!("was ended by signal {signal}"),
        (name, meaning) => format!("crashed with {name} ({meaning})"),
    }
}
