//! The last words of a process that an FMU brings down. Code here runs in signal handlers and therefore neither
//! allocates, locks nor panics.

use super::note::Call;
use std::sync::atomic::{AtomicI32, AtomicU32, Ordering};

/// Receiver of last words: a descriptor, or −1 for a sentence on the standard error stream.
static TO: AtomicI32 = AtomicI32::new(-1);

/// Descriptor that a process which watches this one reads its exit status from, or −1.
static WATCHED: AtomicI32 = AtomicI32::new(-1);

/// Names the descriptor at which another process waits for the exit status of this one.
#[cfg(unix)]
pub(crate) fn supervised(descriptor: i32) {
    WATCHED.store(descriptor, Ordering::Relaxed);
}

/// Says the exit status at `descriptor`; may be called from a signal handler.
#[cfg(unix)]
pub(crate) fn say(descriptor: i32, status: u8) {
    // SAFETY: one byte that is there.
    unsafe { libc::write(descriptor, (&raw const status).cast(), 1) };
}

/// Process that last words are of; 0 before there is one.
static OWN: AtomicU32 = AtomicU32::new(0);

/// Takes this process for the one that last words are of.
#[cfg(unix)]
pub(super) fn own() {
    OWN.store(std::process::id(), Ordering::Relaxed);
}

/// `true` in a copy of that process, which has its handlers and none of its duties.
#[cfg(unix)]
pub(super) fn is_copy() -> bool {
    let own = OWN.load(Ordering::Relaxed);
    own != 0 && own != std::process::id()
}

/// Form of last words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// As a sentence on the standard error stream.
    Sentence,
    /// As the bytes of an [`Obituary`], to an open file descriptor.
    Obituary(i32),
}

/// Cause of the end of a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// A signal in the call, by its number.
    Signal(i32),
    /// The call took longer than allowed.
    TimeLimit,
    /// The call ended the process by `exit()` with this status; −1 if the system does not tell it.
    Exit(i32),
}

/// Cause of the end of a process, and the call.
///
/// ```text
/// bytes      little-endian
/// 4          number of bytes that follow
/// 1          MARK
/// 1          1 signal, 2 time limit, 3 exit
/// 4          number of the signal, or exit status
/// 8          time of the instance, s; NaN before it has one
/// the rest   name of the function, UTF-8
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Obituary {
    /// Cause of the end.
    pub ending: Ending,
    /// Time of the instance, s; `None` before it has one.
    pub time: Option<f64>,
    /// Name of the function.
    pub function: String,
}

impl Obituary {
    /// First byte after the length.
    pub const MARK: u8 = 0xDE;

    /// Reads the bytes after the length; `None` for other bytes.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (head, function) = bytes.split_at_checked(14)?;
        let detail = i32::from_le_bytes(head[2..6].try_into().ok()?);
        let time = f64::from_le_bytes(head[6..14].try_into().ok()?);
        let ending = match (head[0], head[1]) {
            (Self::MARK, 1) => Ending::Signal(detail),
            (Self::MARK, 2) => Ending::TimeLimit,
            (Self::MARK, 3) => Ending::Exit(detail),
            _ => return None,
        };
        Some(Self {
            ending,
            time: time.is_finite().then_some(time),
            function: String::from_utf8_lossy(function).into_owned(),
        })
    }
}

impl Ending {
    /// Name and meaning of a signal.
    #[must_use]
    pub fn signal(number: i32) -> (&'static str, &'static str) {
        #[cfg(unix)]
        let known = match number {
            libc::SIGSEGV => ("SIGSEGV", "invalid memory access"),
            libc::SIGBUS => ("SIGBUS", "invalid memory access"),
            libc::SIGILL => ("SIGILL", "invalid instruction"),
            libc::SIGFPE => ("SIGFPE", "integer division by zero or a trapped floating-point error"),
            libc::SIGABRT => ("SIGABRT", "abort() or a failed assertion"),
            libc::SIGKILL => ("SIGKILL", "killed from outside, perhaps for want of memory"),
            libc::SIGTERM => ("SIGTERM", "ended from outside"),
            libc::SIGPIPE => ("SIGPIPE", "wrote to a closed pipe"),
            libc::SIGTRAP => ("SIGTRAP", "breakpoint or trap"),
            _ => ("a signal", ""),
        };
        #[cfg(not(unix))]
        let known = ("a signal", "");
        let _ = number;
        known
    }
}

/// Chooses the form of last words.
pub(super) fn direct(to: Report) {
    let descriptor = match to {
        Report::Sentence => -1,
        Report::Obituary(descriptor) => descriptor,
    };
    TO.store(descriptor, Ordering::Relaxed);
}

/// A text in a fixed place; excess characters are left out.
pub(super) struct Text {
    bytes: [u8; 1024],
    length: usize,
}

impl Text {
    pub(super) fn new() -> Self {
        Self {
            bytes: [0; 1024],
            length: 0,
        }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    pub(super) fn push(&mut self, more: &[u8]) {
        for (place, byte) in self.bytes[self.length..].iter_mut().zip(more) {
            *place = *byte;
            self.length += 1;
        }
    }

    fn whole(&mut self, number: u64, digits: usize) {
        let mut buffer = [b'0'; 20];
        let (mut rest, mut first) = (number, buffer.len());
        while rest > 0 || first > buffer.len() - digits {
            first -= 1;
            buffer[first] = b'0' + (rest % 10) as u8;
            rest /= 10;
        }
        self.push(&buffer[first..]);
    }

    /// A number with six decimals at most.
    pub(super) fn number(&mut self, value: f64) {
        if value < 0.0 {
            self.push(b"-");
        }
        let micros = (value.abs() * 1e6).round() as u64;
        self.whole(micros / 1_000_000, 1);
        if !micros.is_multiple_of(1_000_000) {
            self.push(b".");
            self.whole(micros % 1_000_000, 6);
            while self.bytes().last() == Some(&b'0') {
                self.length -= 1;
            }
        }
    }
}

/// Functions called after the results are written.
const ENDING: [&str; 2] = ["fmi2Terminate", "fmi2FreeInstance"];

/// Last words for a person.
pub(super) fn sentence(call: &Call, ending: Ending) -> Text {
    let mut text = Text::new();
    text.push(b"error: ");
    let mut label = [0; 256];
    let length = call.note.label(&mut label);
    text.push(&label[..length]);
    text.push(b": ");
    text.push(call.function.as_bytes());
    if call.time.is_finite() {
        text.push(b" at t = ");
        text.number(call.time);
        text.push(b" s");
    }
    match ending {
        Ending::Signal(number) => {
            let (name, meaning) = Ending::signal(number);
            text.push(b" crashed with ");
            text.push(name.as_bytes());
            text.push(b" (");
            text.push(meaning.as_bytes());
            text.push(b")");
        }
        Ending::TimeLimit => {
            text.push(b" took longer than ");
            text.number(call.limit.as_secs_f64());
            text.push(b" s of wall time (step_timeout)");
        }
        Ending::Exit(status) => {
            text.push(b" ended the program by exit(");
            if status >= 0 {
                text.number(f64::from(status));
            }
            text.push(b")");
        }
    }
    text.push(b"; the FMU runs in this program");
    let what = if ENDING.contains(&call.function) {
        ", which ends with it: what is written stays, and with isolate = true in its table the program goes on\n"
    } else {
        ", so the results of this run are lost: with isolate = true in its table they are kept\n"
    };
    text.push(what.as_bytes());
    text
}

/// Last words for another program.
pub(super) fn obituary(call: &Call, ending: Ending) -> Text {
    let (code, detail) = match ending {
        Ending::Signal(number) => (1, number),
        Ending::TimeLimit => (2, 0),
        Ending::Exit(status) => (3, status),
    };
    let mut text = Text::new();
    text.push(&(14 + call.function.len() as u32).to_le_bytes());
    text.push(&[Obituary::MARK, code]);
    text.push(&detail.to_le_bytes());
    text.push(&call.time.to_le_bytes());
    text.push(call.function.as_bytes());
    text
}

/// Writes the last words and ends the process with status 1.
pub(super) fn end(call: &Call, ending: Ending) -> ! {
    let descriptor = TO.load(Ordering::Relaxed);
    let (text, descriptor) = if descriptor < 0 {
        (sentence(call, ending), 2)
    } else {
        (obituary(call, ending), descriptor)
    };
    end_now(text.bytes(), descriptor)
}

#[cfg(unix)]
fn end_now(words: &[u8], descriptor: i32) -> ! {
    // SAFETY: both may be called from a signal handler; the bytes are as many as is said.
    unsafe {
        libc::write(descriptor, words.as_ptr().cast(), words.len());
    }
    let watched = WATCHED.load(Ordering::Relaxed);
    if watched >= 0 {
        say(watched, 1);
    }
    // SAFETY: may be called from a signal handler.
    unsafe { libc::_exit(1) }
}

#[cfg(not(unix))]
fn end_now(words: &[u8], _descriptor: i32) -> ! {
    use std::io::Write as _;
    let _ = std::io::stderr().write_all(words);
    std::process::exit(1)
}
