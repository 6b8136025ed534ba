//! A process that watches this program while FMUs of others run in it.
//!
//! An FMU in this process can end it by `_exit()` with any status, and a thread that the FMU has left behind can bring
//! it down when all calls are over. No handler in the process notices either; the parent of the process does. The
//! program therefore starts itself once more with the same arguments, the child works, and the parent waits:
//!
//! - Standard input of the child is one end of a socket. The child says there with which status it comes to its end in
//!   order; an end without that word was not in order, whatever its status is.
//! - Signals that ask for an end are handed on. A child whose parent is gone ends.
//! - Standard output and standard error are the same files in both, the process group as well.

use std::process::ExitCode;

use crate::isolation;
use crate::scratch::Scratch;

/// Says with which status the program comes to its end in order, and returns the status.
#[must_use]
pub fn ended(status: u8) -> ExitCode {
    #[cfg(unix)]
    unix::say(status);
    status.into()
}

/// Has the rest of the work done by a child that runs the same command, and ends with the status of the child. `fmus`
/// names the FMUs of others that are to run in this process; with none, in the child itself, and where this program
/// does not start children, nothing happens. `unpacked`, a folder that the child makes for itself, is removed before.
pub fn supervise(fmus: &[String], unpacked: &mut Option<Scratch>) {
    #[cfg(unix)]
    if !fmus.is_empty() && isolation::serves() {
        unix::supervise(fmus, unpacked);
    }
    #[cfg(not(unix))]
    let _ = (fmus, unpacked, isolation::serves());
}

#[cfg(unix)]
mod unix {
    use std::io::{self, Read as _};
    use std::os::fd::{AsRawFd as _, OwnedFd};
    use std::os::unix::net::UnixStream;
    use std::os::unix::process::{CommandExt as _, ExitStatusExt as _, parent_id};
    use std::process::{Command, ExitStatus, Stdio};
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
    use std::time::Duration;

    use crate::import::guard::{self, Ending};
    use crate::import::process;
    use crate::scratch::{Scratch, remove_those_of};

    /// Variable of the environment that gives the child the number of its parent.
    const VARIABLE: &str = "PANTOLINE_SUPERVISED_BY";

    /// Socket of the child.
    static CHANNEL: OnceLock<UnixStream> = OnceLock::new();

    /// Number of the child in its parent.
    static CHILD: AtomicI32 = AtomicI32::new(0);

    /// True once the parent was asked to end.
    static ASKED: AtomicBool = AtomicBool::new(false);

    /// Signals that are handed on.
    const SIGNALS: [i32; 3] = [libc::SIGINT, libc::SIGTERM, libc::SIGHUP];

    pub(super) fn say(status: u8) {
        if let Some(channel) = CHANNEL.get() {
            guard::say(channel.as_raw_fd(), status);
        }
    }

    pub(super) fn supervise(fmus: &[String], unpacked: &mut Option<Scratch>) {
        if CHANNEL.get().is_some() || is_child() {
            return;
        }
        let Ok((child, channel)) = started() else {
            // Without a second process the work is done as it is without supervision.
            return;
        };
        drop(unpacked.take());
        std::process::exit(awaited(child, channel, fmus));
    }

    /// Takes the socket of a parent that watches this process; false where nobody does.
    fn is_child() -> bool {
        let parent = std::env::var(VARIABLE).ok().and_then(|text| text.parse().ok());
        if parent != Some(parent_id()) {
            return false;
        }
        let Ok(channel) = process::detached_stdin() else {
            return false;
        };
        guard::supervised(channel.as_raw_fd());
        // Without the thread, the child of a parent that was killed goes on to its end.
        let _ = process::end_when_closed(&channel, Duration::ZERO);
        CHANNEL.set(channel).is_ok()
    }

    /// Starts the child.
    fn started() -> io::Result<(std::process::Child, UnixStream)> {
        let (ours, theirs) = UnixStream::pair()?;
        let mut command = Command::new(crate::isolation::program()?);
        let mut arguments = std::env::args_os();
        if let Some(name) = arguments.next() {
            command.arg0(name);
        }
        command.args(arguments).env(VARIABLE, std::process::id().to_string());
        command.stdin(Stdio::from(OwnedFd::from(theirs)));
        if let Some(out) = process::kept_stdout() {
            command.stdout(out);
        }
        hand_on_signals();
        let child = command.spawn()?;
        CHILD.store(i32::try_from(child.id()).unwrap_or(0), Ordering::SeqCst);
        if ASKED.load(Ordering::SeqCst) {
            process::signal(child.id(), libc::SIGTERM);
        }
        Ok((child, ours))
    }

    /// Hands signals on to the child; one that is ignored stays so.
    fn hand_on_signals() {
        extern "C" fn hand_on(signal: i32) {
            ASKED.store(true, Ordering::SeqCst);
            let child = CHILD.load(Ordering::SeqCst);
            if child > 0 {
                // SAFETY: a plain call, which a handler may make.
                unsafe { libc::kill(child, signal) };
            }
        }
        for signal in SIGNALS {
            process::handle_unless_ignored(signal, hand_on);
        }
    }

    /// Waits for the child; returns the status to end with, after words on an end that was not in order.
    fn awaited(mut child: std::process::Child, mut channel: UnixStream, fmus: &[String]) -> i32 {
        let ended = child.wait();
        CHILD.store(0, Ordering::SeqCst);
        remove_those_of(child.id());
        let mut word = [0];
        // A process that an FMU has left behind may hold the other end.
        let said = channel
            .set_nonblocking(true)
            .and_then(|()| channel.read_exact(&mut word));
        let word = said.is_ok().then(|| i32::from(word[0]));
        let Ok(ended) = ended else {
            return word.unwrap_or(1);
        };
        let (status, words) = judged(ended, word, ASKED.load(Ordering::SeqCst), fmus);
        if let Some(words) = words {
            eprintln!("{}", crate::visible(&words));
        }
        status
    }

    /// Status to end with, and words on an end that was not in order; `word` is the status that the child has said.
    pub(super) fn judged(ended: ExitStatus, word: Option<i32>, asked: bool, fmus: &[String]) -> (i32, Option<String>) {
        let how = match ended.signal() {
            Some(signal) => match Ending::signal(signal) {
                (_, "") => format!("was ended by signal {signal}"),
                (name, meaning) => format!("was ended by {name} ({meaning})"),
            },
            None => format!("ended with exit status {}", ended.code().unwrap_or(1)),
        };
        let fmus = fmus.join(", ");
        match word {
            Some(word) if ended.code() == Some(word) => (word, None),
            Some(word) => {
                let words = format!(
                    "warning: the program {how} after its work was done: a supplied FMU that runs in it ({fmus}) has \
                     left something behind, such as a thread; with isolate = true in its table the program does not \
                     end with it"
                );
                (word, Some(words))
            }
            // As it was asked to; a second time it does not wait.
            None if asked => (ended.code().unwrap_or(1), None),
            None => {
                let words = format!(
                    "error: the program {how} before it came to its end in order: a supplied FMU that runs in it \
                     ({fmus}) has called _exit(), or has left a thread or damaged memory behind; results that are not \
                     written yet are lost, what is written stays, and with isolate = true in its table the program \
                     does not end with it"
                );
                (1, Some(words))
            }
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::unix::judged;
    use std::os::unix::process::ExitStatusExt as _;
    use std::process::ExitStatus;

    #[test]
    fn an_end_that_was_not_announced_is_never_a_success() {
        let exit = |code: i32| ExitStatus::from_raw(code << 8);
        let fmus = ["a.fmu".to_owned(), "b.fmu".to_owned()];
        let judge = |ended, word, asked| {
            let (status, words) = judged(ended, word, asked, &fmus);
            (status, words.unwrap_or_default())
        };
        for code in [0, 1, 2, 3] {
            assert_eq!(judge(exit(code), Some(code), false), (code, String::new()));
        }
        let (status, words) = judge(exit(0), None, false);
        assert_eq!(status, 1);
        assert!(words.contains("ended with exit status 0 before it came to its end") && words.contains("a.fmu, b.fmu"));
        let (status, words) = judge(ExitStatus::from_raw(libc::SIGSEGV), Some(0), false);
        assert_eq!(status, 0);
        assert!(words.contains("was ended by SIGSEGV (invalid memory access) after its work was done"));
        assert_eq!(judge(ExitStatus::from_raw(libc::SIGKILL), None, false).0, 1);
        assert_eq!(judge(exit(130), None, true), (130, String::new()));
    }
}
