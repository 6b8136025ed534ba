//! Work of the child: it carries out requests until its socket is closed.

use std::ffi::OsStr;
use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::import::guard::{self, Report};
use crate::import::{Fmu, LogMessage, StepOutcome, process};

use super::frame::{Malformed, Reader, Receiver, Writer};
use super::protocol::{Code, MAGIC, MESSAGE, PROGRESS, REPLY, VERSION, outcome};
use super::{CLOSED_GRACE, IsolationError, Reported};
use crate::instance::{FmuInstance, InstanceError, Local, SavedState};

/// Time after which the parent is told that the next request begins.
const QUIET: Duration = Duration::from_millis(100);

/// Sends frames; the FMU's messages come from any thread.
type Sender = Arc<Mutex<UnixStream>>;

/// Why a frame was not carried out to its end.
enum Stop {
    /// By the FMU.
    Refused(InstanceError),
    /// The parent sends nonsense.
    Malformed,
    /// A step was discarded.
    Discarded,
}

impl From<InstanceError> for Stop {
    fn from(error: InstanceError) -> Self {
        Self::Refused(error)
    }
}

impl From<crate::Error> for Stop {
    fn from(error: crate::Error) -> Self {
        Self::Refused(error.into())
    }
}

impl From<Malformed> for Stop {
    fn from(_: Malformed) -> Self {
        Self::Malformed
    }
}

/// Runs one FMU for the process that started this one.
///
/// # Errors
/// Standard input is not the socket of a parent of the same version.
pub fn serve() -> Result<(), IsolationError> {
    let broken = |what| IsolationError::Protocol {
        instance: super::SUBCOMMAND.to_owned(),
        what,
    };
    let by_hand = |_| broken("the standard input is not its socket; this command is for the program itself");
    let channel = process::detached_stdin().map_err(by_hand)?;
    process::end_when_closed(&channel, CLOSED_GRACE).map_err(|_| broken("no thread can be started"))?;
    guard::install(Report::Obituary(channel.as_raw_fd()));
    let sender: Sender = Arc::new(Mutex::new(
        channel.try_clone().map_err(|_| broken("no descriptor is left"))?,
    ));
    let mut receiver = Receiver::new(channel);

    let first = receiver.receive().ok().flatten().ok_or_else(|| broken("no greeting"))?;
    let greeting = greeting(first).map_err(|Malformed| broken("a greeting of another version"));
    let mut reply = Writer::new();
    reply.raw(MAGIC);
    reply.u32(VERSION);
    send(&mut reply, &sender).map_err(|_| broken("it is closed"))?;
    let (archive, folder, limits) = greeting?;
    if let Some(bytes) = limits.memory {
        process::limit_memory(bytes).map_err(|_| broken("the system refuses memory_limit"))?;
    }
    let mut host = Host {
        // a description that the parent has read is read again
        fmu: Fmu::unpacked(archive, folder, Some(limits.time)),
        sender: Arc::clone(&sender),
        instance: None,
        lists: Lists::default(),
    };
    while let Ok(Some(frame)) = receiver.receive() {
        host.answer(frame, &mut reply)
            .map_err(|Malformed| broken("a request that means nothing"))?;
        if send(&mut reply, &sender).is_err() {
            break;
        }
    }
    Ok(())
}

/// Sends a frame, unless this process is a copy of the one that the parent knows, made by the FMU's `fork()`: that one
/// answers alone.
fn send(frame: &mut Writer, sender: &Sender) -> io::Result<()> {
    guard::end_of_copy();
    let stream = sender.lock().unwrap_or_else(PoisonError::into_inner);
    frame.send(&*stream)
}

/// Limits of the FMU.
struct Limits {
    time: Duration,
    /// Bytes.
    memory: Option<u64>,
}

/// Archive, folder and limits of the first frame.
fn greeting(frame: &[u8]) -> Result<(&OsStr, &OsStr, Limits), Malformed> {
    let mut reader = Reader::new(frame);
    if reader.raw(MAGIC.len())? != MAGIC || reader.u32()? != VERSION {
        return Err(Malformed);
    }
    let limits = Limits {
        time: Duration::from_millis(reader.u64()?),
        memory: Some(reader.u64()?).filter(|bytes| *bytes > 0),
    };
    Ok((
        OsStr::from_bytes(reader.bytes()?),
        OsStr::from_bytes(reader.bytes()?),
        limits,
    ))
}

/// Arguments and results, used again.
#[derive(Default)]
struct Lists {
    references: Vec<u32>,
    more_references: Vec<u32>,
    integers: Vec<i32>,
    booleans: Vec<bool>,
    reals: Vec<f64>,
    results: Vec<f64>,
}

struct Host {
    fmu: Result<Fmu, crate::Error>,
    sender: Sender,
    instance: Option<Local>,
    lists: Lists,
}

impl Host {
    /// Carries out the requests of a frame and writes the reply.
    fn answer(&mut self, frame: &[u8], reply: &mut Writer) -> Result<(), Malformed> {
        let mut reader = Reader::new(frame);
        reply.clear();
        reply.raw(&[REPLY, outcome::DONE]);
        let mut told = Instant::now();
        for request in 0..reader.u32()? {
            if request > 0 && told.elapsed() >= QUIET {
                told = Instant::now();
                let mut progress = Writer::new();
                progress.u8(PROGRESS);
                // a parent that has gone is noticed with the reply
                let _ = send(&mut progress, &self.sender);
            }
            match self.carry_out(&mut reader, reply) {
                Ok(()) => {}
                Err(Stop::Malformed) => return Err(Malformed),
                Err(Stop::Discarded) => break,
                Err(Stop::Refused(error)) => {
                    let outcome = match error {
                        InstanceError::Fmi(crate::Error::NoBinary { .. }) => outcome::UNFIT,
                        InstanceError::Fmi(crate::Error::Call { .. }) => outcome::REFUSED,
                        _ => outcome::FAILED,
                    };
                    reply.truncate(2);
                    reply.replace(1, &[outcome]);
                    reply.text(&error.to_string());
                    break;
                }
            }
        }
        Ok(())
    }

    fn instantiate(&mut self, name: &str, logging: bool) -> Result<(), Stop> {
        let fmu = self.fmu.as_ref().map_err(|error| {
            Stop::Refused(InstanceError::Isolation(IsolationError::Reported {
                message: error.to_string(),
                kind: Reported::Other,
            }))
        })?;
        let sender = Arc::clone(&self.sender);
        let listener = move |message: &LogMessage| {
            let mut frame = Writer::new();
            frame.u8(MESSAGE);
            frame.i32(message.status as i32);
            frame.text(&message.category);
            frame.text(&message.text);
            // without a parent there is nobody to tell
            let _ = send(&mut frame, &sender);
        };
        let instance = fmu.instantiate_heard(name, false, logging, Some(Box::new(listener)))?;
        self.instance = Some(Local::new(instance));
        Ok(())
    }

    /// Carries out one request and appends its results.
    fn carry_out(&mut self, reader: &mut Reader<'_>, reply: &mut Writer) -> Result<(), Stop> {
        let code = Code::from_byte(reader.u8()?).ok_or(Malformed)?;
        if code == Code::Instantiate {
            let (name, logging) = (reader.text()?, reader.u8()? != 0);
            return self.instantiate(name, logging);
        }
        let instance = self.instance.as_mut().ok_or(Malformed)?;
        let lists = &mut self.lists;
        match code {
            Code::Instantiate => {}
            Code::SetupExperiment => {
                let start = reader.f64()?;
                let mut optional = || Ok::<_, Malformed>((reader.u8()? != 0, reader.f64()?));
                let (stop, tolerance) = (optional()?, optional()?);
                let given = |(given, value): (bool, f64)| given.then_some(value);
                instance.setup_experiment(start, given(stop), given(tolerance))?;
            }
            Code::EnterInitializationMode => instance.enter_initialization_mode()?,
            Code::ExitInitializationMode => instance.exit_initialization_mode()?,
            Code::Terminate => instance.terminate()?,
            Code::Reset => instance.reset()?,
            Code::SetReal => {
                reader.u32s(&mut lists.references)?;
                reader.f64s(&mut lists.reals)?;
                alike(lists.references.len(), lists.reals.len())?;
                instance.set_real(&lists.references, &lists.reals)?;
            }
            Code::SetInteger => {
                reader.u32s(&mut lists.references)?;
                reader.i32s(&mut lists.integers)?;
                alike(lists.references.len(), lists.integers.len())?;
                instance.set_integer(&lists.references, &lists.integers)?;
            }
            Code::SetBoolean => {
                reader.u32s(&mut lists.references)?;
                reader.i32s(&mut lists.integers)?;
                alike(lists.references.len(), lists.integers.len())?;
                lists.booleans.clear();
                lists.booleans.extend(lists.integers.iter().map(|value| *value != 0));
                instance.set_boolean(&lists.references, &lists.booleans)?;
            }
            Code::SetString => {
                reader.u32s(&mut lists.references)?;
                let texts: Vec<&str> = lists
                    .references
                    .iter()
                    .map(|_| reader.text())
                    .collect::<Result<_, _>>()?;
                instance.set_string(&lists.references, &texts)?;
            }
            Code::GetReal => {
                reader.u32s(&mut lists.references)?;
                lists.results.resize(lists.references.len(), 0.0);
                instance.get_real(&lists.references, &mut lists.results)?;
                reply.f64s(&lists.results);
            }
            Code::GetInteger => {
                reader.u32s(&mut lists.references)?;
                lists.integers.resize(lists.references.len(), 0);
                instance.get_integer(&lists.references, &mut lists.integers)?;
                reply.i32s(&lists.integers);
            }
            Code::GetBoolean => {
                reader.u32s(&mut lists.references)?;
                lists.booleans.resize(lists.references.len(), false);
                instance.get_boolean(&lists.references, &mut lists.booleans)?;
                lists.integers.clear();
                lists
                    .integers
                    .extend(lists.booleans.iter().map(|value| i32::from(*value)));
                reply.i32s(&lists.integers);
            }
            Code::GetString => {
                reader.u32s(&mut lists.references)?;
                let texts = instance.get_string(&lists.references)?;
                reply.length(texts.len());
                for text in &texts {
                    reply.text(text);
                }
            }
            Code::SetRealInputDerivatives => {
                reader.u32s(&mut lists.references)?;
                reader.i32s(&mut lists.integers)?;
                reader.f64s(&mut lists.reals)?;
                alike(lists.references.len(), lists.integers.len())?;
                alike(lists.references.len(), lists.reals.len())?;
                instance.set_real_input_derivatives(&lists.references, &lists.integers, &lists.reals)?;
            }
            Code::GetRealOutputDerivatives => {
                reader.u32s(&mut lists.references)?;
                reader.i32s(&mut lists.integers)?;
                alike(lists.references.len(), lists.integers.len())?;
                lists.results.resize(lists.references.len(), 0.0);
                instance.get_real_output_derivatives(&lists.references, &lists.integers, &mut lists.results)?;
                reply.f64s(&lists.results);
            }
            Code::DirectionalDerivative => {
                reader.u32s(&mut lists.references)?;
                reader.u32s(&mut lists.more_references)?;
                reader.f64s(&mut lists.reals)?;
                alike(lists.more_references.len(), lists.reals.len())?;
                lists.results.resize(lists.references.len(), 0.0);
                instance.directional_derivative(
                    &lists.references,
                    &lists.more_references,
                    &lists.reals,
                    &mut lists.results,
                )?;
                reply.f64s(&lists.results);
            }
            Code::DoStep => {
                let (time, step) = (reader.f64()?, reader.f64()?);
                let done = instance.do_step(time, step)? == StepOutcome::Ok;
                reply.u8(u8::from(done));
                if !done {
                    return Err(Stop::Discarded);
                }
            }
            Code::LastSuccessfulTime => {
                let time = instance.last_successful_time()?;
                reply.u8(u8::from(time.is_some()));
                reply.f64(time.unwrap_or(0.0));
            }
            Code::WantsToTerminate => reply.u8(u8::from(instance.wants_to_terminate()?)),
            Code::SaveState => reply.u32(instance.save_state()?.0),
            Code::SaveStateAgain => {
                let state = saved(reader, instance)?;
                instance.save_state_again(state)?;
            }
            Code::RestoreState => {
                let state = saved(reader, instance)?;
                instance.restore_state(state)?;
            }
            Code::FreeState => instance.free_state(SavedState(reader.u32()?))?,
            Code::SerializeState => {
                let state = saved(reader, instance)?;
                reply.bytes(&instance.serialize_state(state)?);
            }
            Code::DeserializeState => reply.u32(instance.deserialize_state(reader.bytes()?)?.0),
            Code::SetDebugLogging => {
                let on = reader.u8()? != 0;
                let count = reader.length(4)?;
                let categories: Vec<&str> = (0..count).map(|_| reader.text()).collect::<Result<_, _>>()?;
                instance.set_debug_logging(on, &categories)?;
            }
        }
        Ok(())
    }
}

/// The state of a number that the instance has given.
fn saved(reader: &mut Reader<'_>, instance: &Local) -> Result<SavedState, Malformed> {
    let state = SavedState(reader.u32()?);
    if instance.has(state) { Ok(state) } else { Err(Malformed) }
}

/// Refuses lists that do not belong together.
fn alike(references: usize, values: usize) -> Result<(), Malformed> {
    if references == values { Ok(()) } else { Err(Malformed) }
}
