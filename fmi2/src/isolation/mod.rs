//! FMUs in processes of their own: `isolate = true`.
//!
//! The child is this program again, under a subcommand that help does not show. It loads the FMU's binary, which this
//! process then never does: an FMU that crashes, never returns or ends its process takes only the child with it, two
//! FMUs whose libraries clash do not meet, and one that needs an environment gets it.
//!
//! ```text
//! remote    an instance in a child, as seen from here: the link, and its calls as requests
//! process   the child: start, end, what it prints
//! child     what the child does
//! protocol  requests and replies
//! frame     their bytes
//! ```
//!
//! # The child
//!
//! - Standard input is one end of a local stream socket, the only way in and out. The child takes it, and puts an empty
//!   input in its place; what the FMU prints on either stream comes to this program's standard error stream, with the
//!   instance's name before each line.
//! - It works in the folder `resources` of the unpacked archive, which belongs to this process and goes with it. The
//!   environment is this program's, with the scene's `environment` over it.
//! - It is a process group of its own, so that Ctrl-C reaches this program only, and is killed as a group; processes
//!   that have left the group are found by a mark in their environment, where the system shows it.
//! - It ends when its socket is closed, however the parent ended: in order where it is idle, by force after
//!   [`CLOSED_GRACE`] where the FMU holds it.
//! - A call that takes longer than `step_timeout`, a crash or `exit()` is noticed in the child itself, which says what
//!   it was in with an [`Obituary`](crate::import::guard::Obituary) and ends. The parent waits [`GRACE`] longer and
//!   then kills.
//! - A copy of the child that the FMU makes by `fork()` ends when it comes back from the FMU, and says nothing.
//!
//! # Protocol, version 2
//!
//! Both directions carry frames: a length (4 bytes), then as many bytes. Numbers are little-endian: `u8`, `u32`, `i32`,
//! `u64`, `f64` (its bits, so that nothing is rounded); a list or text is its length in a `u32`, then its elements
//! (text:
//! UTF-8, or whatever the system has in paths).
//!
//! ```text
//! parent → child   first   "PFMU", u32 version, u64 time limit (ms), u64 memory limit (bytes, 0 for none), path of the
//!                          archive, folder it is unpacked in
//!                  then    u32 number of requests; each: u8 code, arguments (see protocol::Code)
//! child → parent   first   "PFMU", u32 version
//!                  then    0x01 reply: u8 outcome, results of the requests in order; after a failure a text instead
//!                          0x02 message of the FMU: i32 status, category, text; at any time
//!                          0x03 the next request begins; only where the last ones took their time
//!                          0xDE obituary; the last frame
//! ```
//!
//! Requests of a frame are carried out in order until one fails; a step that is discarded ends the frame as well,
//! without being a failure. What only sets something has no result and is put off by the parent until something is
//! asked for: a coupling step — restore, inputs, their derivatives, step, outputs — is one frame each way.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::import::Fmu;

use crate::instance::FmuInstance;

#[cfg(unix)]
mod child;
#[cfg(unix)]
mod frame;
#[cfg(unix)]
mod process;
#[cfg(unix)]
mod protocol;
#[cfg(unix)]
mod remote;

#[cfg(unix)]
pub use child::serve;
#[cfg(unix)]
pub(crate) use process::program;

/// The hidden subcommand.
pub const SUBCOMMAND: &str = "isolated-fmu";

/// `true` where this program has the subcommand.
static SERVES: AtomicBool = AtomicBool::new(false);

/// Says that this program has the subcommand, so that children are started with it.
pub fn this_program_serves() {
    SERVES.store(true, Ordering::Relaxed);
}

/// `true` once it has been said that this program has the subcommand.
#[must_use]
pub fn serves() -> bool {
    SERVES.load(Ordering::Relaxed)
}

/// `true` where children can be started: this program is one, or names one that stands for it.
#[must_use]
pub fn is_at_hand() -> bool {
    serves() || crate::program::is_elsewhere()
}

/// Time that the parent allows beyond the time limit before it kills the child.
pub const GRACE: Duration = Duration::from_secs(2);

/// Time that a child is given to end by itself once the parent is gone.
pub const CLOSED_GRACE: Duration = Duration::from_secs(1);

/// How an FMU is isolated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Isolation {
    /// Longest that a call may take, in wall time.
    pub time_limit: Duration,
    /// Most memory of the process, bytes; `None` for no limit.
    pub memory_limit: Option<u64>,
    /// Variables of the child's environment besides this program's.
    pub environment: BTreeMap<String, String>,
}

/// Kinds of errors that the other side reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reported {
    /// A call returned a bad status: [`crate::Error::Call`].
    Refused,
    /// The FMU cannot be used on this system at all: [`crate::Error::NoBinary`].
    Unfit,
    /// Anything else.
    Other,
}

/// The end of a child while it was asked for something.
#[derive(Debug, thiserror::Error)]
#[error("{}: {call} {ending}{words}; {remedy}", fmu.display())]
pub struct End {
    /// The archive.
    pub fmu: PathBuf,
    /// Name of the instance, function and time.
    pub call: String,
    /// Fate of the child.
    pub ending: String,
    /// Last words of the FMU, or nothing.
    pub words: crate::Log,
    /// Remedy for the user.
    pub remedy: String,
}

/// Failure of an FMU in a process of its own.
#[derive(Debug, thiserror::Error)]
pub enum IsolationError {
    /// The FMU reports it, as it would in this process.
    #[error("{message}")]
    Reported {
        /// Message of the error on the other side.
        message: String,
        /// Kind of the error.
        kind: Reported,
    },
    /// The child has ended while it was asked for something.
    #[error(transparent)]
    Ended(Box<End>),
    /// Asked for something after its child has ended.
    #[error("{instance} has ended before: nothing can be asked of it")]
    Gone {
        /// Name of the instance.
        instance: String,
    },
    /// No child.
    #[error("{}: no process of its own can be started: {what}", fmu.display())]
    Start {
        /// The archive.
        fmu: PathBuf,
        /// Action that failed.
        what: &'static str,
        /// Reason of the operating system.
        #[source]
        source: std::io::Error,
    },
    /// The other side is another version of the program.
    #[error("the program {} does not speak version {expected} of the protocol: it was replaced while this one was \
        running", program.display())]
    Version {
        /// The program that was started.
        program: PathBuf,
        /// This side's version.
        expected: u32,
    },
    /// Bytes that mean nothing.
    #[error("{instance}: its process does not keep to the protocol: {what}")]
    Protocol {
        /// Name of the instance.
        instance: String,
        /// Finding.
        what: &'static str,
    },
    /// There are no such processes on this system.
    #[error("isolate = true needs a Unix system: leave it out here")]
    NotHere,
}

/// Starts a child and makes an instance in it.
///
/// # Errors
/// See [`IsolationError`].
#[cfg(unix)]
pub fn start(
    fmu: &Fmu,
    name: &str,
    logging: bool,
    isolation: &Isolation,
) -> Result<Box<dyn FmuInstance>, IsolationError> {
    Ok(Box::new(remote::Remote::start(fmu, name, logging, isolation)?))
}

/// Refuses: there is no such process on this system.
///
/// # Errors
/// [`IsolationError::NotHere`].
#[cfg(not(unix))]
pub fn start(_: &Fmu, _: &str, _: bool, _: &Isolation) -> Result<Box<dyn FmuInstance>, IsolationError> {
    Err(IsolationError::NotHere)
}

/// Refuses: nobody starts this program as a child on this system.
///
/// # Errors
/// [`IsolationError::NotHere`].
#[cfg(not(unix))]
pub fn serve() -> Result<(), IsolationError> {
    Err(IsolationError::NotHere)
}

#[cfg(all(test, unix))]
mod tests;
