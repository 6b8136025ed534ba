//! System services for a process that runs FMUs.

use std::io;
use std::os::fd::{AsFd as _, AsRawFd as _, OwnedFd, RawFd};
use std::os::unix::net::UnixStream;
use std::sync::OnceLock;
use std::time::Duration;

/// Takes the socket that this process was given as its standard input. Output of the FMU then goes to the standard
/// error stream, and its standard input is empty.
///
/// # Errors
/// The standard input is no socket, or the system refuses.
pub fn detached_stdin() -> io::Result<UnixStream> {
    let channel = UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?);
    channel.peer_addr()?;
    let nothing = std::fs::File::open("/dev/null")?;
    replace(nothing.as_raw_fd(), 0)?;
    replace(2, 1)?;
    Ok(channel)
}

/// Takes the standard output of this process for its own use. Output of the FMU then goes to the standard error stream.
///
/// # Errors
/// The system has no descriptor left.
pub fn own_stdout() -> io::Result<std::fs::File> {
    let own = io::stdout().as_fd().try_clone_to_owned()?;
    let _ = KEPT.set(own.try_clone()?);
    replace(2, 1)?;
    Ok(own.into())
}

/// Standard output of this process, once FMUs have another.
static KEPT: OnceLock<OwnedFd> = OnceLock::new();

/// Standard output that [`own_stdout`] has taken, for a child that is to have the same.
pub(crate) fn kept_stdout() -> Option<OwnedFd> {
    KEPT.get()?.try_clone().ok()
}

/// Has `handler` called at `signal`, unless the signal is ignored.
pub(crate) fn handle_unless_ignored(signal: i32, handler: extern "C" fn(i32)) {
    if is_ignored(signal) {
        return;
    }
    // SAFETY: a sigaction of zeros is valid, the handler has the signature of one without SA_SIGINFO.
    unsafe {
        let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed().assume_init();
        action.sa_sigaction = handler as usize;
        action.sa_flags = libc::SA_RESTART;
        libc::sigemptyset(&raw mut action.sa_mask);
        libc::sigaction(signal, &raw const action, std::ptr::null_mut());
    }
}

/// True where this process ignores `signal`.
fn is_ignored(signal: i32) -> bool {
    let mut before = std::mem::MaybeUninit::<libc::sigaction>::uninit();
    // SAFETY: a valid place for the present action; no new one is set.
    let asked = unsafe { libc::sigaction(signal, std::ptr::null(), before.as_mut_ptr()) };
    // SAFETY: the system has filled the place where it reports success.
    asked == 0 && unsafe { before.assume_init() }.sa_sigaction == libc::SIG_IGN
}

/// Sends `signal` to a child of this process.
pub(crate) fn signal(child: u32, signal: i32) {
    if let Ok(child) = libc::pid_t::try_from(child) {
        // SAFETY: a plain call; a process that is gone is no harm.
        unsafe { libc::kill(child, signal) };
    }
}

/// Makes the descriptor `number` that of `by`.
fn replace(by: RawFd, number: RawFd) -> io::Result<()> {
    // SAFETY: plain numbers of open descriptors, of which `number` is a standard stream that is not used as what it
    // was.
    if unsafe { libc::dup2(by, number) } < 0 {
        return Err(io::Error::last_os_error());
    }
    Ok(())
}

/// Calls `install`, which may take hold of signals, and leaves the hangup ignored where it was ignored before: a
/// program started by `nohup` outlives its terminal.
pub fn with_hangup_as_it_was<T>(install: impl FnOnce() -> T) -> T {
    let ignored = is_ignored(libc::SIGHUP);
    let installed = install();
    if ignored {
        // SAFETY: a plain call; to ignore a signal needs no handler.
        unsafe { libc::signal(libc::SIGHUP, libc::SIG_IGN) };
    }
    installed
}

/// Ends this process, whatever it is doing, when the other end of `channel` has been closed for `grace`.
///
/// # Errors
/// The system has no thread or descriptor left.
pub fn end_when_closed(channel: &UnixStream, grace: Duration) -> io::Result<()> {
    let channel: OwnedFd = channel.as_fd().try_clone_to_owned()?;
    let watch = move || {
        let mut poll = libc::pollfd {
            fd: channel.as_raw_fd(),
            events: 0,
            revents: 0,
        };
        loop {
            // SAFETY: one valid element. With no events asked for, only the end of the other side wakes it.
            let found = unsafe { libc::poll(&raw mut poll, 1, -1) };
            if found > 0 {
                break;
            }
        }
        std::thread::sleep(grace);
        // SAFETY: ends the process without calling anything of the FMU.
        unsafe { libc::_exit(1) }
    };
    std::thread::Builder::new()
        .name("end of input".to_owned())
        .spawn(watch)?;
    Ok(())
}

/// Bounds the memory that this process may take, in bytes; beyond it the system refuses more. Address space where the
/// system knows no limit of data.
///
/// # Errors
/// The system refuses.
pub fn limit_memory(bytes: u64) -> io::Result<()> {
    #[cfg(target_os = "linux")]
    let kind = libc::RLIMIT_DATA;
    #[cfg(not(target_os = "linux"))]
    let kind = libc::RLIMIT_AS;
    let bytes = libc::rlim_t::try_from(bytes).unwrap_or(libc::RLIM_INFINITY);
    let limit = libc::rlimit {
        rlim_cur: bytes,
        rlim_max: bytes,
    };
    // SAFETY: a plain call with a valid limit.
    match unsafe { libc::setrlimit(kind, &raw const limit) } {
        0 => Ok(()),
        _ => Err(io::Error::last_os_error()),
    }
}

/// Kills all processes but this one whose environment has `mark`, a variable with its value, where the system shows it.
pub fn kill_marked(mark: &str) {
    /// Looks, as processes may start others meanwhile.
    const LOOKS: usize = 10;
    let own = std::process::id();
    for _ in 0..LOOKS {
        let Ok(entries) = std::fs::read_dir("/proc") else {
            return;
        };
        let is_marked = |process: &u32| {
            let environment = std::fs::read(format!("/proc/{process}/environ")).unwrap_or_default();
            *process != own
                && environment
                    .split(|byte| *byte == 0)
                    .any(|variable| variable == mark.as_bytes())
        };
        let processes = entries
            .flatten()
            .filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        let marked: Vec<u32> = processes.filter(is_marked).collect();
        for process in &marked {
            if let Ok(process) = libc::pid_t::try_from(*process) {
                // SAFETY: a plain call; a process that is gone is no harm.
                unsafe { libc::kill(process, libc::SIGKILL) };
            }
        }
        if marked.is_empty() {
            return;
        }
    }
}

/// Kills the process group of the child `leader`, with all processes that the child has started.
pub fn kill_group(leader: u32) {
    if let Ok(leader) = libc::pid_t::try_from(leader)
        && leader > 1
    {
        // SAFETY: a plain call; a group that is gone is no harm.
        unsafe { libc::kill(-leader, libc::SIGKILL) };
    }
}
