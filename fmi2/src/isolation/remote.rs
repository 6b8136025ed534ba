//! An instance in a child, as seen from here.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::os::unix::ffi::OsStrExt as _;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::Log;
use crate::abi::Status;
use crate::import::guard::{Ending, Obituary};
use crate::import::{Fmu, LogMessage};

use super::frame::{Malformed, Reader, Receiver, Writer};
use super::process::{self, Process};
use super::protocol::{Code, MAGIC, MESSAGE, PROGRESS, REPLY, VERSION, outcome};
use super::{End, GRACE, Isolation, IsolationError, Reported};
use crate::instance::{InstanceError, SavedState};

mod calls;
#[cfg(test)]
mod tests;

/// Most messages that are kept until they are fetched.
const KEPT: usize = 1000;

/// Requests that may be put off.
const PUT_OFF: u32 = 256;

/// Time after which a socket without answer is looked at again.
const LOOK: Duration = Duration::from_millis(100);

/// Messages of the FMU that are told with its end.
const TOLD: usize = 5;

/// An instance of an FMU in a child process.
pub(super) struct Remote {
    name: String,
    /// Keeps the folder that the child works in.
    fmu: Fmu,
    isolation: Isolation,
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
    /// References read after each step; their values, and whether these are of the present, stand beside.
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
        let mut remote = Self::over(fmu, name, isolation, (process, stream))
            .map_err(failed("its socket, or no descriptor is left"))?;
        remote.greet(&archive, &folder, program)?;
        let request = remote.request(Code::Instantiate);
        request.text(name);
        request.u8(u8::from(logging));
        remote.ask("fmi2Instantiate")?;
        Ok(remote)
    }

    /// An instance behind a socket, before any word was exchanged.
    fn over(fmu: &Fmu, name: &str, isolation: &Isolation, child: (Process, UnixStream)) -> std::io::Result<Self> {
        let (process, stream) = child;
        let longest = isolation.time_limit.saturating_add(GRACE);
        stream.set_read_timeout(Some(LOOK))?;
        stream.set_write_timeout(Some(longest))?;
        let receiver = Receiver::new(stream.try_clone()?);
        Ok(Self {
            name: name.to_owned(),
            fmu: fmu.clone(),
            isolation: isolation.clone(),
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
        })
    }

    fn greet(
        &mut self,
        archive: &std::path::Path,
        folder: &std::path::Path,
        program: PathBuf,
    ) -> Result<(), IsolationError> {
        let limit = u64::try_from(self.isolation.time_limit.as_millis()).unwrap_or(u64::MAX);
        let mut greeting = Writer::new();
        greeting.raw(MAGIC);
        greeting.u32(VERSION);
        greeting.u64(limit);
        greeting.u64(self.isolation.memory_limit.unwrap_or(0));
        greeting.bytes(archive.as_os_str().as_bytes());
        greeting.bytes(folder.as_os_str().as_bytes());
        // a child that has gone is noticed when its answer is awaited
        let _ = greeting.send(&self.stream);
        let mut reply = [0; 8];
        let deadline = self.deadline(1);
        match self.receiver.receive_until(deadline) {
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
        // each call may take its time, and says so before the next one
        let last = self.deadline(count);
        let mut deadline = self.deadline(1);
        // a child that has gone may have left a word, which is read below
        let _ = self.requests.send(&self.stream);
        loop {
            let frame = match self.receiver.receive_until(deadline) {
                Ok(Some(frame)) => frame,
                Ok(None) => return Err(self.lost(function, None)),
                Err(error) if error.kind() == ErrorKind::TimedOut => {
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
                    if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                        return Err(self.lost(function, None));
                    }
                }
                [PROGRESS] => deadline = self.deadline(1).min(last),
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

    /// Time by which so many calls are done, or the child has told why not; `None` beyond all times.
    fn deadline(&self, calls: u32) -> Option<Instant> {
        let patience = self.isolation.time_limit.saturating_mul(calls).saturating_add(GRACE);
        Instant::now().checked_add(patience)
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
            Some(obituary) => process::told(obituary.ending, self.isolation.time_limit),
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

    /// Remedy against the end of the child in `function`.
    fn remedy(&self, function: &str, ending: Option<Ending>) -> String {
        let user = match (ending, function) {
            (Some(Ending::TimeLimit), _) => "raise step_timeout if it needs longer",
            (_, "fmi2DoStep") => "another coupling.macro_step may avoid it",
            (_, "fmi2Instantiate" | "fmi2EnterInitializationMode" | "fmi2ExitInitializationMode") => {
                "its parameters and its environment may be what it does not bear"
            }
            _ => "its messages (-vv) may explain it",
        };
        let memory = match (ending, self.isolation.memory_limit) {
            (Some(Ending::TimeLimit), _) | (_, None) => String::new(),
            (_, Some(bytes)) => format!("memory_limit = {bytes} B may be too little for it, or "),
        };
        let tool = self.fmu.description().generation_tool.as_deref();
        let maker = match tool.filter(|tool| !tool.is_empty()) {
            Some(tool) => format!("its maker (it was made with {tool})"),
            None => "its maker".to_owned(),
        };
        format!("{memory}{user}, else it is a fault in the FMU, for {maker} to mend")
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
