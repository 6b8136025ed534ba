//! An instance in a child, as seen from here.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::net::Shutdown;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use fmi2::Log;
use fmi2::abi::Status;
use fmi2::import::guard::{Ending, Obituary};
use fmi2::import::{Fmu, LogMessage, StepOutcome};

use super::frame::{Malformed, Reader, Receiver, Writer};
use super::process::{self, Process};
use super::protocol::{Code, MAGIC, MESSAGE, REPLY, VERSION, outcome};
use super::{End, GRACE, Isolation, IsolationError, Reported};
use crate::instance::{FmuInstance, InstanceError, SavedState};

/// Most messages that are kept until they are fetched.
const KEPT: usize = 1000;

/// Requests that may be put off.
const PUT_OFF: u32 = 256;

/// Messages of the FMU that are told with its end.
const TOLD: usize = 5;

/// An instance of an FMU in a child process.
pub(super) struct Remote {
    name: String,
    /// Keeps the folder that the child works in.
    fmu: Fmu,
    time_limit: Duration,
    process: Process,
    stream: UnixStream,
    receiver: Receiver<UnixStream>,
    /// Requests that are not sent yet, and their number.
    requests: Writer,
    count: u32,
    /// Results of the last frame.
    results: Vec<u8>,
    log: VecDeque<LogMessage>,
    /// Messages that are older than the last frame of requests.
    heard: usize,
    /// What is read after each step, the values, and whether they are of the present.
    read_after_step: Vec<u32>,
    fetched: Vec<f64>,
    fresh: bool,
    /// Time of the last step's end, s, for messages.
    time: Option<f64>,
    ended: bool,
}

impl Remote {
    /// Starts a child and makes an instance in it.
    pub(super) fn start(fmu: &Fmu, name: &str, logging: bool, isolation: &Isolation) -> Result<Self, IsolationError> {
        let failed = |what: &'static str| {
            let fmu = fmu.path().to_owned();
            move |source| IsolationError::Start { fmu, what, source }
        };
        let absolute =
            |path: &std::path::Path| std::path::absolute(path).map_err(failed("the current directory is gone"));
        let (archive, folder) = (absolute(fmu.path())?, absolute(fmu.folder())?);
        let program = process::program().map_err(failed("this program cannot be found"))?;
        let started = Process::start(&program, &folder.join("resources"), name, isolation);
        let (process, stream) = started.map_err(failed("the system refuses"))?;
        let longest = isolation.time_limit.saturating_add(GRACE);
        let timed = stream.set_read_timeout(Some(longest));
        timed
            .and_then(|()| stream.set_write_timeout(Some(longest)))
            .map_err(failed("its socket"))?;
        let receiver = Receiver::new(stream.try_clone().map_err(failed("no descriptor is left"))?);
        let mut remote = Self {
            name: name.to_owned(),
            fmu: fmu.clone(),
            time_limit: isolation.time_limit,
            process,
            stream,
            receiver,
            requests: Writer::new(),
            count: 0,
            results: Vec::new(),
            log: VecDeque::new(),
            heard: 0,
            read_after_step: Vec::new(),
            fetched: Vec::new(),
            fresh: false,
            time: None,
            ended: false,
        };
        remote.greet(&archive, &folder, program)?;
        let request = remote.request(Code::Instantiate);
        request.text(name);
        request.u8(u8::from(logging));
        remote.ask("fmi2Instantiate")?;
        Ok(remote)
    }

    fn greet(
        &mut self,
        archive: &std::path::Path,
        folder: &std::path::Path,
        program: PathBuf,
    ) -> Result<(), IsolationError> {
        let limit = u64::try_from(self.time_limit.as_millis()).unwrap_or(u64::MAX);
        let mut greeting = Writer::new();
        greeting.raw(MAGIC);
        greeting.u32(VERSION);
        greeting.u64(limit);
        greeting.bytes(archive.as_os_str().as_bytes());
        greeting.bytes(folder.as_os_str().as_bytes());
        // a child that has gone is noticed when its answer is awaited
        let _ = greeting.send(&self.stream);
        let mut reply = [0; 8];
        match self.receiver.receive() {
            Ok(Some(frame)) if frame.len() == reply.len() => reply.copy_from_slice(frame),
            Ok(Some(_)) => {}
            Ok(None) | Err(_) => return Err(self.lost("the start of its process", None)),
        }
        if reply[..4] != *MAGIC || reply[4..] != VERSION.to_le_bytes() {
            let expected = VERSION;
            return Err(IsolationError::Version { program, expected });
        }
        Ok(())
    }

    /// Begins a request.
    fn request(&mut self, code: Code) -> &mut Writer {
        if self.count == 0 {
            self.requests.clear();
            self.requests.u32(0);
        }
        self.count += 1;
        self.requests.u8(code as u8);
        &mut self.requests
    }

    /// After a request without results: it is sent with the next one that has some.
    fn put_off(&mut self, function: &'static str) -> Result<(), InstanceError> {
        self.fresh = false;
        if self.count >= PUT_OFF {
            self.ask(function)?;
        }
        Ok(())
    }

    /// Sends what there is and waits for the results; `function` is the last one, for messages.
    fn ask(&mut self, function: &'static str) -> Result<Reader<'_>, IsolationError> {
        let count = std::mem::take(&mut self.count);
        self.fresh = false;
        if self.ended {
            let instance = self.name.clone();
            return Err(IsolationError::Gone { instance });
        }
        self.requests.replace(0, &count.to_le_bytes());
        self.heard = self.log.len();
        // each call may take its time
        let deadline = Instant::now().checked_add(self.time_limit.saturating_mul(count).saturating_add(GRACE));
        let late = |deadline: Option<Instant>| deadline.is_some_and(|deadline| Instant::now() >= deadline);
        // a child that has gone may have left a word, which is read below
        let _ = self.requests.send(&self.stream);
        loop {
            let frame = match self.receiver.receive() {
                Ok(Some(frame)) => frame,
                Ok(None) => return Err(self.lost(function, None)),
                Err(error)
                    if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) && !late(deadline) =>
                {
                    continue;
                }
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    let obituary = Obituary {
                        ending: Ending::TimeLimit,
                        time: self.time,
                        function: function.to_owned(),
                    };
                    return Err(self.lost(function, Some(obituary)));
                }
                Err(_) => return Err(self.lost(function, None)),
            };
            match frame {
                [REPLY, outcome::DONE, results @ ..] => {
                    self.results.clear();
                    self.results.extend_from_slice(results);
                    return Ok(Reader::new(&self.results));
                }
                [REPLY, failure, text @ ..] => {
                    let message = Reader::new(text).text().unwrap_or("it does not say why").to_owned();
                    let kind = match *failure {
                        outcome::UNFIT => Reported::Unfit,
                        outcome::REFUSED => Reported::Refused,
                        _ => Reported::Other,
                    };
                    return Err(IsolationError::Reported { message, kind });
                }
                [MESSAGE, message @ ..] => {
                    if let Ok(message) = log_message(message) {
                        if self.log.len() == KEPT {
                            self.log.pop_front();
                            self.heard = self.heard.saturating_sub(1);
                        }
                        self.log.push_back(message);
                    }
                    if late(deadline) {
                        return Err(self.lost(function, None));
                    }
                }
                other => {
                    let obituary = Obituary::from_bytes(other);
                    return Err(match obituary {
                        Some(_) => self.lost(function, obituary),
                        None => self.nonsense("a frame of no known kind"),
                    });
                }
            }
        }
    }

    /// The child has ended, or is killed now.
    fn lost(&mut self, function: &str, obituary: Option<Obituary>) -> IsolationError {
        self.ended = true;
        let told = obituary.is_some();
        let status = self.process.end(if told { Duration::from_millis(100) } else { GRACE });
        let (function, time) = match &obituary {
            Some(obituary) => (obituary.function.as_str(), obituary.time),
            None => (function, self.time),
        };
        let at = time.map_or_else(String::new, |time| format!(" at t = {time} s"));
        let ending = match &obituary {
            Some(obituary) => process::told(obituary.ending, self.time_limit),
            None => process::ending(status),
        };
        let mut words: Vec<String> = self
            .log
            .iter()
            .skip(self.heard)
            .map(|message| message.text.clone())
            .collect();
        words.drain(..words.len().saturating_sub(TOLD));
        words.extend(self.process.last_lines());
        IsolationError::Ended(Box::new(End {
            fmu: self.fmu.path().to_owned(),
            call: format!("{} ({}): {function}{at}", self.name, self.fmu.description().model_name),
            ending,
            words: Log(words),
            remedy: self.remedy(function, obituary.as_ref().map(|obituary| obituary.ending)),
        }))
    }

    /// What may help against the end of the child in `function`.
    fn remedy(&self, function: &str, ending: Option<Ending>) -> String {
        let user = match (ending, function) {
            (Some(Ending::TimeLimit), _) => "raise step_timeout if it needs longer",
            (_, "fmi2DoStep") => "another coupling.macro_step may avoid it",
            (_, "fmi2Instantiate" | "fmi2EnterInitializationMode" | "fmi2ExitInitializationMode") => {
                "its parameters and its environment may be what it does not bear"
            }
            _ => "its messages (-vv) may explain it",
        };
        let tool = self.fmu.description().generation_tool.as_deref();
        let maker = match tool.filter(|tool| !tool.is_empty()) {
            Some(tool) => format!("its maker (it was made with {tool})"),
            None => "its maker".to_owned(),
        };
        format!("{user}, else it is a fault in the FMU, for {maker} to mend")
    }

    /// The child cannot be relied on any more.
    fn nonsense(&mut self, what: &'static str) -> IsolationError {
        self.ended = true;
        self.process.end(Duration::ZERO);
        let instance = self.name.clone();
        IsolationError::Protocol { instance, what }
    }

    /// Sends what there is; `read` takes the results.
    fn ask_for<T>(
        &mut self,
        function: &'static str,
        read: impl FnOnce(&mut Reader<'_>) -> Result<T, Malformed>,
    ) -> Result<T, InstanceError> {
        let mut reader = self.ask(function)?;
        match read(&mut reader) {
            Ok(value) => Ok(value),
            Err(Malformed) => Err(self.nonsense("results that are too short").into()),
        }
    }

    /// A request without arguments or results that is sent at once.
    fn simple(&mut self, code: Code, function: &'static str) -> Result<(), InstanceError> {
        self.request(code);
        self.ask_for(function, |_| Ok(()))
    }

    /// A request about a saved state that is put off.
    fn about(&mut self, state: SavedState, code: Code, function: &'static str) -> Result<(), InstanceError> {
        self.request(code).u32(state.0);
        self.put_off(function)
    }
}

/// A message of the FMU.
fn log_message(content: &[u8]) -> Result<LogMessage, Malformed> {
    let mut reader = Reader::new(content);
    Ok(LogMessage {
        status: Status::try_from(reader.i32()?).unwrap_or(Status::Error),
        category: reader.text()?.to_owned(),
        text: reader.text()?.to_owned(),
    })
}

/// As many reals as were asked for.
fn reals(reader: &mut Reader<'_>, values: &mut [f64]) -> Result<(), Malformed> {
    if reader.length(8)? != values.len() {
        return Err(Malformed);
    }
    for value in values {
        *value = reader.f64()?;
    }
    Ok(())
}

/// As many whole numbers as were asked for.
fn integers<T>(reader: &mut Reader<'_>, values: &mut [T], of: impl Fn(i32) -> T) -> Result<(), Malformed> {
    if reader.length(4)? != values.len() {
        return Err(Malformed);
    }
    for value in values {
        *value = of(reader.i32()?);
    }
    Ok(())
}

impl FmuInstance for Remote {
    fn name(&self) -> &str {
        &self.name
    }

    fn setup_experiment(&mut self, start: f64, stop: Option<f64>, tolerance: Option<f64>) -> Result<(), InstanceError> {
        let request = self.request(Code::SetupExperiment);
        request.f64(start);
        for value in [stop, tolerance] {
            request.u8(u8::from(value.is_some()));
            request.f64(value.unwrap_or(0.0));
        }
        self.time = Some(start);
        self.ask_for("fmi2SetupExperiment", |_| Ok(()))
    }

    fn enter_initialization_mode(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::EnterInitializationMode, "fmi2EnterInitializationMode")
    }

    fn exit_initialization_mode(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::ExitInitializationMode, "fmi2ExitInitializationMode")
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::Terminate, "fmi2Terminate")
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.simple(Code::Reset, "fmi2Reset")
    }

    fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetReal);
        request.u32s(references);
        request.f64s(values);
        self.put_off("fmi2SetReal")
    }

    fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetInteger);
        request.u32s(references);
        request.i32s(values);
        self.put_off("fmi2SetInteger")
    }

    fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetBoolean);
        request.u32s(references);
        request.length(values.len());
        for value in values {
            request.i32(i32::from(*value));
        }
        self.put_off("fmi2SetBoolean")
    }

    fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetString);
        request.u32s(references);
        for value in values {
            request.text(value);
        }
        self.put_off("fmi2SetString")
    }

    fn get_real(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), InstanceError> {
        if self.fresh && self.count == 0 && references == self.read_after_step {
            values.copy_from_slice(&self.fetched);
            return Ok(());
        }
        self.request(Code::GetReal).u32s(references);
        self.ask_for("fmi2GetReal", |reader| reals(reader, values))
    }

    fn get_integer(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), InstanceError> {
        self.request(Code::GetInteger).u32s(references);
        self.ask_for("fmi2GetInteger", |reader| integers(reader, values, |value| value))
    }

    fn get_boolean(&mut self, references: &[u32], values: &mut [bool]) -> Result<(), InstanceError> {
        self.request(Code::GetBoolean).u32s(references);
        self.ask_for("fmi2GetBoolean", |reader| integers(reader, values, |value| value != 0))
    }

    fn get_string(&mut self, references: &[u32]) -> Result<Vec<String>, InstanceError> {
        self.request(Code::GetString).u32s(references);
        self.ask_for("fmi2GetString", |reader| {
            let count = reader.length(4)?;
            (0..count).map(|_| Ok(reader.text()?.to_owned())).collect()
        })
    }

    fn set_real_input_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &[f64],
    ) -> Result<(), InstanceError> {
        let request = self.request(Code::SetRealInputDerivatives);
        request.u32s(references);
        request.i32s(orders);
        request.f64s(values);
        self.put_off("fmi2SetRealInputDerivatives")
    }

    fn get_real_output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), InstanceError> {
        let request = self.request(Code::GetRealOutputDerivatives);
        request.u32s(references);
        request.i32s(orders);
        self.ask_for("fmi2GetRealOutputDerivatives", |reader| reals(reader, values))
    }

    fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        derivatives: &mut [f64],
    ) -> Result<(), InstanceError> {
        let request = self.request(Code::DirectionalDerivative);
        request.u32s(unknowns);
        request.u32s(knowns);
        request.f64s(seed);
        self.ask_for("fmi2GetDirectionalDerivative", |reader| reals(reader, derivatives))
    }

    fn do_step(&mut self, time: f64, step: f64) -> Result<StepOutcome, InstanceError> {
        self.time = Some(time);
        let request = self.request(Code::DoStep);
        request.f64(time);
        request.f64(step);
        // taken out, so that the request can be written
        let references = std::mem::take(&mut self.read_after_step);
        if !references.is_empty() {
            self.request(Code::GetReal).u32s(&references);
        }
        self.read_after_step = references;
        let mut fetched = std::mem::take(&mut self.fetched);
        let outcome = self.ask_for("fmi2DoStep", |reader| {
            let done = reader.u8()? != 0;
            if done && !fetched.is_empty() {
                reals(reader, &mut fetched)?;
            }
            Ok(done)
        });
        self.fetched = fetched;
        if outcome? {
            self.fresh = !self.fetched.is_empty();
            self.time = Some(time + step);
            Ok(StepOutcome::Ok)
        } else {
            Ok(StepOutcome::Discard)
        }
    }

    fn last_successful_time(&mut self) -> Result<Option<f64>, InstanceError> {
        self.request(Code::LastSuccessfulTime);
        self.ask_for("fmi2GetRealStatus", |reader| {
            let known = reader.u8()? != 0;
            let time = reader.f64()?;
            Ok(known.then_some(time))
        })
    }

    fn wants_to_terminate(&mut self) -> Result<bool, InstanceError> {
        self.request(Code::WantsToTerminate);
        self.ask_for("fmi2GetBooleanStatus", |reader| Ok(reader.u8()? != 0))
    }

    fn save_state(&mut self) -> Result<SavedState, InstanceError> {
        self.request(Code::SaveState);
        self.ask_for("fmi2GetFMUstate", |reader| Ok(SavedState(reader.u32()?)))
    }

    fn save_state_again(&mut self, state: SavedState) -> Result<(), InstanceError> {
        let fresh = self.fresh;
        self.about(state, Code::SaveStateAgain, "fmi2GetFMUstate")?;
        self.fresh = fresh;
        Ok(())
    }

    fn restore_state(&mut self, state: SavedState) -> Result<(), InstanceError> {
        self.about(state, Code::RestoreState, "fmi2SetFMUstate")
    }

    fn free_state(&mut self, state: SavedState) -> Result<(), InstanceError> {
        self.about(state, Code::FreeState, "fmi2FreeFMUstate")
    }

    fn serialize_state(&mut self, state: SavedState) -> Result<Vec<u8>, InstanceError> {
        self.request(Code::SerializeState).u32(state.0);
        self.ask_for("fmi2SerializeFMUstate", |reader| Ok(reader.bytes()?.to_vec()))
    }

    fn deserialize_state(&mut self, bytes: &[u8]) -> Result<SavedState, InstanceError> {
        self.request(Code::DeserializeState).bytes(bytes);
        self.ask_for("fmi2DeSerializeFMUstate", |reader| Ok(SavedState(reader.u32()?)))
    }

    fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), InstanceError> {
        let request = self.request(Code::SetDebugLogging);
        request.u8(u8::from(on));
        request.length(categories.len());
        for category in categories {
            request.text(category);
        }
        self.ask_for("fmi2SetDebugLogging", |_| Ok(()))
    }

    fn take_log(&mut self) -> Vec<LogMessage> {
        self.heard = 0;
        self.log.drain(..).collect()
    }

    fn will_read(&mut self, references: &[u32]) {
        self.read_after_step = references.to_vec();
        self.fetched = vec![0.0; references.len()];
        self.fresh = false;
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        if !self.ended {
            // the child frees the instance in order when nothing more can come
            let _ = self.stream.shutdown(Shutdown::Write);
            let status = self.process.end(self.time_limit.saturating_add(GRACE));
            if !status.is_some_and(|status| status.success()) {
                eprintln!(
                    "{}: it failed at its end, in fmi2Terminate or fmi2FreeInstance",
                    self.name
                );
            }
        }
    }
}
