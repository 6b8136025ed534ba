//! Native calls in random order: in the order of the standard and against it, with null pointers, wrong references,
//! counts beyond all, several instances, and two threads with instances of their own.
use super::sequence::{Care, References, array, number, odd_step, text};
use super::{IDENTIFIERS, SEEDS, SMALL, Watchdog, cases, dice, first_seed};
use fastrand::Rng;
use fmi2::abi::*;
use fmi2::model_description::BaseType;
use integration_tests::raw::{Identity, Raw};
use std::ffi::{CStr, CString, c_int};
use std::ptr::{null, null_mut};

const OK: c_int = Status::Ok as c_int;
const ERROR: c_int = Status::Error as c_int;

/// The library of an FMU, and what it needs.
struct Host {
    raw: Raw,
    references: References,
    guid: String,
}

impl Host {
    fn new(identifier: &str) -> Self {
        let raw = Raw::new(SMALL.open(identifier));
        let description = raw.fmu.description();
        Self {
            references: References::of(description),
            guid: description.guid.clone(),
            raw,
        }
    }

    /// A function of the library.
    fn call<T: Copy>(&self, name: &str) -> T {
        // SAFETY: every caller names the type that FMI 2.0 gives the function.
        *unsafe { self.raw.function::<T>(name) }
    }

    fn instantiate(&self, rng: &mut Rng) -> fmi2Component {
        let resources = self.raw.fmu.folder().join("resources").display().to_string();
        let mut identity = Identity {
            name: Some("a"),
            kind: 1,
            guid: Some(&self.guid),
            location: Some(&resources),
            logging: c_int::from(rng.bool()),
        };
        match rng.u8(..40) {
            0 => identity.name = [None, Some(""), Some("\u{7}\u{1b}[31m")][rng.usize(..3)],
            1 => identity.kind = [0, 2, -1, c_int::MAX][rng.usize(..4)],
            2 => identity.guid = [None, Some(""), Some("{wrong}")][rng.usize(..3)],
            3 => identity.location = [None, Some("file:///no/such"), Some("http://%ff%00"), Some("%")][rng.usize(..4)],
            _ => {}
        }
        self.raw.instantiate(identity, &fmi2CallbackFunctions::default())
    }
}

/// Phases of an instance as an importer keeps account of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Instantiated,
    Initialization,
    Step,
    Ended,
}

struct Instance {
    component: fmi2Component,
    phase: Phase,
    time: f64,
}

/// One sequence: some instances of one FMU, the states saved of them, and the calls so far.
struct Sequence<'a> {
    host: &'a Host,
    rng: Rng,
    instances: Vec<Instance>,
    states: Vec<fmi2FMUstate>,
    bytes: Vec<u8>,
    calls: Vec<&'static str>,
}

/// Calls by their weight where the standard allows them; the rest of the calls is drawn from all.
const BEFORE: [&str; 8] = [
    "SetupExperiment",
    "SetReal",
    "SetString",
    "SetBoolean",
    "EnterInitializationMode",
    "EnterInitializationMode",
    "SetRealInputDerivatives",
    "GetFMUstate",
];
const INITIALIZATION: [&str; 7] = [
    "SetReal",
    "GetReal",
    "ExitInitializationMode",
    "ExitInitializationMode",
    "GetDirectionalDerivative",
    "SetRealInputDerivatives",
    "GetFMUstate",
];
const STEP: [&str; 14] = [
    "DoStep",
    "DoStep",
    "DoStep",
    "SetReal",
    "SetReal",
    "GetReal",
    "GetReal",
    "SetRealInputDerivatives",
    "GetRealOutputDerivatives",
    "GetDirectionalDerivative",
    "GetFMUstate",
    "SetFMUstate",
    "GetRealStatus",
    "SerializeFMUstate",
];
const ENDED: [&str; 4] = ["Reset", "SetFMUstate", "GetReal", "FreeFMUstate"];
const ALL: [&str; 31] = [
    "SetDebugLogging",
    "SetupExperiment",
    "EnterInitializationMode",
    "ExitInitializationMode",
    "Terminate",
    "Reset",
    "GetReal",
    "GetInteger",
    "GetBoolean",
    "GetString",
    "SetReal",
    "SetInteger",
    "SetBoolean",
    "SetString",
    "GetFMUstate",
    "SetFMUstate",
    "FreeFMUstate",
    "SerializedFMUstateSize",
    "SerializeFMUstate",
    "DeSerializeFMUstate",
    "GetDirectionalDerivative",
    "SetRealInputDerivatives",
    "GetRealOutputDerivatives",
    "DoStep",
    "CancelStep",
    "GetStatus",
    "GetRealStatus",
    "GetIntegerStatus",
    "GetBooleanStatus",
    "GetStringStatus",
    "FreeInstance",
];

impl Sequence<'_> {
    fn run(&mut self, count: usize) {
        self.add();
        for _ in 0..count {
            if self.instances.len() < 3 && self.rng.u8(..20) == 0 {
                self.add();
            }
            let Some(last) = self.instances.len().checked_sub(1) else {
                self.add();
                continue;
            };
            let at = self.rng.usize(..=last);
            let care = if self.rng.u8(..3) == 0 {
                Care::Careless
            } else {
                Care::Careful
            };
            let legal: &[&str] = match self.instances[at].phase {
                Phase::Instantiated => &BEFORE,
                Phase::Initialization => &INITIALIZATION,
                Phase::Step => &STEP,
                Phase::Ended => &ENDED,
            };
            let list = if self.rng.u8(..5) == 0 { &ALL } else { legal };
            let name = list[self.rng.usize(..list.len())];
            self.calls.push(name);
            if name == "FreeInstance" {
                let gone = self.instances.swap_remove(at);
                self.free_states_without(gone.component);
                // SAFETY: the component is alive and not used again.
                unsafe { self.host.raw.free(gone.component) };
                continue;
            }
            let nobody = care == Care::Careless && self.rng.u8(..30) == 0;
            let component = if nobody {
                null_mut()
            } else {
                self.instances[at].component
            };
            let status = self.call(name, at, component, care);
            assert!(Status::try_from(status).is_ok(), "fmi2{name} returned {status}");
            assert!(status < Status::Fatal as c_int, "fmi2{name} returned {status}");
            if nobody {
                assert_eq!(status, ERROR, "fmi2{name} of a null component");
            } else {
                self.follow(name, at, status);
            }
        }
    }

    fn add(&mut self) {
        let component = self.host.instantiate(&mut self.rng);
        if !component.is_null() {
            self.instances.push(Instance {
                component,
                phase: Phase::Instantiated,
                time: 0.0,
            });
        }
    }

    /// States outlive the instance that they were saved of while there is another one to free them.
    fn free_states_without(&mut self, gone: fmi2Component) {
        if self.instances.is_empty() {
            let free: StatePointerFn = self.host.call("fmi2FreeFMUstate");
            for mut state in self.states.drain(..) {
                // SAFETY: the component is alive, the state is of this library and not used again.
                assert_eq!(unsafe { free(gone, &raw mut state) }, OK);
            }
        }
    }

    /// Phase of an instance after a call; an instance that panicked saves no state, which is how it is found out.
    fn follow(&mut self, name: &'static str, at: usize, status: c_int) {
        let instance = &mut self.instances[at];
        if status == ERROR {
            let save: StatePointerFn = self.host.call("fmi2GetFMUstate");
            let mut state = null_mut();
            // SAFETY: the component is alive.
            let saved = unsafe { save(instance.component, &raw mut state) };
            assert_eq!(saved, OK, "fmi2{name} panicked");
            self.states.push(state);
        }
        match (name, status) {
            ("SetupExperiment" | "SetFMUstate" | "DoStep", OK) => {
                let time: StatusFn<f64> = self.host.call("fmi2GetRealStatus");
                let mut now = 0.0;
                // SAFETY: the component is alive.
                if unsafe { time(instance.component, 2, &raw mut now) } == OK {
                    (instance.time, instance.phase) = (now, Phase::Step);
                } else if name == "SetFMUstate" {
                    instance.phase = Phase::Instantiated;
                }
            }
            ("EnterInitializationMode", OK) => instance.phase = Phase::Initialization,
            ("ExitInitializationMode", OK) => instance.phase = Phase::Step,
            ("Reset", OK) => (instance.phase, instance.time) = (Phase::Instantiated, 0.0),
            ("Terminate", OK) | ("DoStep", _) => instance.phase = Phase::Ended,
            (_, ERROR) if !name.starts_with("Get") => instance.phase = Phase::Ended,
            _ => {}
        }
    }

    /// Values that were handed out with `fmi2OK`.
    fn finite(&self, name: &str, status: c_int, values: &[f64], count: usize) {
        let given = &values[..count.min(values.len())];
        let finite = given.iter().all(|value| value.is_finite());
        assert!(status != OK || finite, "fmi2{name} handed out {given:?}");
    }

    fn call(&mut self, name: &'static str, at: usize, c: fmi2Component, care: Care) -> c_int {
        let (host, time) = (self.host, self.instances[at].time);
        let full = format!("fmi2{name}");
        let rng = &mut self.rng;
        let flag = [0, 1, -1, c_int::MAX][rng.usize(..4)];
        let odd = |rng: &mut Rng| care == Care::Careless && rng.u8(..4) == 0;
        // SAFETY: types are those of the standard; the component is alive or null; every pointer is null, which is
        // tested, or points to as many elements as are said, except for counts above those that are looked at, which
        // are tested; states are of this library and alive.
        unsafe {
            match name {
                "SetDebugLogging" => {
                    let texts = [c"logStatusError", c"logEvents", c"nothing", c"\xff"];
                    let texts: Vec<fmi2String> = (0..rng.usize(..3)).map(|_| texts[rng.usize(..4)].as_ptr()).collect();
                    let (pointer, count) = array(rng, &texts, care);
                    host.call::<SetDebugLoggingFn>(&full)(c, flag, count, pointer)
                }
                "SetupExperiment" => {
                    let start = if odd(rng) { number(rng) } else { 0.0 };
                    let stop = if odd(rng) { number(rng) } else { 10.0 };
                    let tolerance = if odd(rng) { number(rng) } else { 1e-4 };
                    host.call::<SetupExperimentFn>(&full)(c, flag, tolerance, start, flag & 1, stop)
                }
                "EnterInitializationMode" | "ExitInitializationMode" | "Terminate" | "Reset" | "CancelStep" => {
                    host.call::<PlainFn>(&full)(c)
                }
                "GetReal" => {
                    let list = host.references.to_read(rng, BaseType::Real, care);
                    let (pointer, count) = array(rng, &list, care);
                    let mut values = vec![f64::NAN; list.len()];
                    let target = if odd(rng) && count > 0 {
                        null_mut()
                    } else {
                        values.as_mut_ptr()
                    };
                    let status = host.call::<GetFn<f64>>(&full)(c, pointer, count, target);
                    self.finite(name, status, &values, count);
                    status
                }
                "GetInteger" | "GetBoolean" => {
                    let of = if name == "GetInteger" {
                        BaseType::Integer
                    } else {
                        BaseType::Boolean
                    };
                    let list = host.references.to_read(rng, of, care);
                    let (pointer, count) = array(rng, &list, care);
                    let mut values = vec![7; list.len()];
                    let status = host.call::<GetFn<c_int>>(&full)(c, pointer, count, values.as_mut_ptr());
                    if status == OK && name == "GetBoolean" {
                        let given = &values[..count.min(values.len())];
                        assert!(given.iter().all(|value| matches!(value, 0 | 1)), "{given:?}");
                    }
                    status
                }
                "GetString" => {
                    let list = host.references.to_read(rng, BaseType::String, care);
                    let (pointer, count) = array(rng, &list, care);
                    let mut values: Vec<fmi2String> = vec![null(); list.len()];
                    let status = host.call::<GetFn<fmi2String>>(&full)(c, pointer, count, values.as_mut_ptr());
                    for value in values.iter().take(if status == OK { count } else { 0 }) {
                        assert!(!value.is_null());
                        assert!(CStr::from_ptr(*value).to_str().is_ok());
                    }
                    status
                }
                "SetReal" => {
                    let list = host.references.to_set(rng, care);
                    let values = host.references.values(rng, &list, care);
                    let (pointer, count) = array(rng, &list, care);
                    let source = if odd(rng) && count > 0 { null() } else { values.as_ptr() };
                    host.call::<SetFn<f64>>(&full)(c, pointer, count, source)
                }
                "SetInteger" | "SetBoolean" => {
                    let of = if name == "SetInteger" {
                        BaseType::Integer
                    } else {
                        BaseType::Boolean
                    };
                    let list = host.references.to_read(rng, of, care);
                    let values: Vec<c_int> = list.iter().map(|_| [0, 1, -1, c_int::MIN][rng.usize(..4)]).collect();
                    let (pointer, count) = array(rng, &list, care);
                    host.call::<SetFn<c_int>>(&full)(c, pointer, count, values.as_ptr())
                }
                "SetString" => {
                    let list = host.references.to_read(rng, BaseType::String, care);
                    let texts: Vec<CString> = list.iter().map(|_| text(rng)).collect();
                    let mut values: Vec<fmi2String> = texts.iter().map(|text| text.as_ptr()).collect();
                    if let Some(value) = values.first_mut().filter(|_| odd(rng)) {
                        *value = null();
                    }
                    let (pointer, count) = array(rng, &list, care);
                    host.call::<SetFn<fmi2String>>(&full)(c, pointer, count, values.as_ptr())
                }
                "GetFMUstate" => {
                    if odd(rng) {
                        return host.call::<StatePointerFn>(&full)(c, null_mut());
                    }
                    let known = self
                        .states
                        .len()
                        .checked_sub(1)
                        .filter(|_| rng.bool() || self.states.len() > 4);
                    let known = known.map(|last| rng.usize(..=last));
                    let mut state = known.map_or(null_mut(), |known| self.states[known]);
                    let status = host.call::<StatePointerFn>(&full)(c, &raw mut state);
                    match known {
                        Some(known) => assert_eq!(self.states[known], state, "a state is used again in its place"),
                        None if status == OK => self.states.push(state),
                        None => assert!(state.is_null()),
                    }
                    status
                }
                "SetFMUstate" => {
                    let state = match self.states.len() {
                        0 => null_mut(),
                        _ if odd(rng) => null_mut(),
                        count => self.states[rng.usize(..count)],
                    };
                    host.call::<SetStateFn>(&full)(c, state)
                }
                "FreeFMUstate" => {
                    if self.states.is_empty() || odd(rng) {
                        return host.call::<StatePointerFn>(&full)(c, null_mut());
                    }
                    let known = rng.usize(..self.states.len());
                    let status = host.call::<StatePointerFn>(&full)(c, &raw mut self.states[known]);
                    if self.states[known].is_null() {
                        self.states.swap_remove(known);
                    }
                    status
                }
                "SerializedFMUstateSize" | "SerializeFMUstate" => {
                    let Some(last) = self.states.len().checked_sub(1) else {
                        return host.call::<StateSizeFn>("fmi2SerializedFMUstateSize")(c, null_mut(), null_mut());
                    };
                    let state = self.states[rng.usize(..=last)];
                    let mut size = 0;
                    let target = if odd(rng) { null_mut() } else { &raw mut size };
                    let status = host.call::<StateSizeFn>("fmi2SerializedFMUstateSize")(c, state, target);
                    if name == "SerializedFMUstateSize" || status != OK {
                        return status;
                    }
                    let room = if odd(rng) { rng.usize(..size) } else { size };
                    self.bytes.clear();
                    self.bytes.resize(room, 0);
                    let target = self.bytes.as_mut_ptr().cast();
                    host.call::<SerializeStateFn>(&full)(c, state, target, room)
                }
                "DeSerializeFMUstate" => {
                    if odd(rng) && !self.bytes.is_empty() {
                        let place = rng.usize(..self.bytes.len());
                        self.bytes[place] ^= 1 << rng.u32(..8);
                    }
                    let (pointer, count) = array(rng, &self.bytes, care);
                    let mut state = null_mut();
                    let status = host.call::<DeserializeStateFn>(&full)(c, pointer.cast(), count, &raw mut state);
                    assert_eq!(status == OK, !state.is_null());
                    if status == OK {
                        self.states.push(state);
                    }
                    status
                }
                "GetDirectionalDerivative" => {
                    let unknowns = host.references.outputs(rng, care);
                    let knowns = host.references.inputs(rng, care);
                    let seed = host.references.values(rng, &knowns, care);
                    let mut values = vec![f64::NAN; unknowns.len()];
                    let (unknowns, of) = array(rng, &unknowns, care);
                    let (knowns, by) = array(rng, &knowns, care);
                    let function: DirectionalDerivativeFn = host.call(&full);
                    let status = function(c, unknowns, of, knowns, by, seed.as_ptr(), values.as_mut_ptr());
                    self.finite(name, status, &values, of);
                    status
                }
                "SetRealInputDerivatives" => {
                    let list = host.references.inputs(rng, care);
                    let values: Vec<f64> = list.iter().map(|_| if odd(rng) { number(rng) } else { 0.1 }).collect();
                    let orders: Vec<c_int> = list.iter().map(|_| order(rng, care)).collect();
                    let (pointer, count) = array(rng, &list, care);
                    let function: SetInputDerivativesFn = host.call(&full);
                    function(c, pointer, count, orders.as_ptr(), values.as_ptr())
                }
                "GetRealOutputDerivatives" => {
                    let list = host.references.outputs(rng, care);
                    let orders: Vec<c_int> = list.iter().map(|_| order(rng, care)).collect();
                    let mut values = vec![f64::NAN; list.len()];
                    let (pointer, count) = array(rng, &list, care);
                    let function: OutputDerivativesFn = host.call(&full);
                    let status = function(c, pointer, count, orders.as_ptr(), values.as_mut_ptr());
                    self.finite(name, status, &values, count);
                    status
                }
                "DoStep" => {
                    let steps = [1e-3, 1e-3, 1e-3, 2e-3, 5e-3, 1e-9];
                    let from = if odd(rng) { number(rng) } else { time };
                    let step = if odd(rng) { odd_step(rng) } else { steps[rng.usize(..6)] };
                    host.call::<DoStepFn>(&full)(c, from, step, flag)
                }
                "GetStatus" | "GetIntegerStatus" | "GetBooleanStatus" => {
                    let mut value = 0;
                    let target = if odd(rng) { null_mut() } else { &raw mut value };
                    host.call::<StatusFn<c_int>>(&full)(c, kind(rng), target)
                }
                "GetRealStatus" => {
                    let mut value = f64::NAN;
                    let target = if odd(rng) { null_mut() } else { &raw mut value };
                    let status = host.call::<StatusFn<f64>>(&full)(c, kind(rng), target);
                    self.finite(name, status, &[value], 1);
                    status
                }
                "GetStringStatus" => {
                    let mut value: fmi2String = null();
                    host.call::<StatusFn<fmi2String>>(&full)(c, kind(rng), &raw mut value)
                }
                _ => unreachable!("fmi2{name}"),
            }
        }
    }
}

fn order(rng: &mut Rng, care: Care) -> c_int {
    match care {
        Care::Careful => rng.i32(1..4),
        Care::Careless => [0, 1, 3, 4, -1, c_int::MAX, c_int::MIN][rng.usize(..7)],
    }
}

fn kind(rng: &mut Rng) -> c_int {
    [0, 1, 2, 2, 3, 4, -1, c_int::MAX][rng.usize(..8)]
}

impl Drop for Sequence<'_> {
    fn drop(&mut self) {
        while let Some(instance) = self.instances.pop() {
            self.free_states_without(instance.component);
            // SAFETY: the component is alive and not used again.
            unsafe { self.host.raw.free(instance.component) };
        }
    }
}

/// Sequences on one FMU, each of which can be made again alone.
fn sequences(host: &Host, identifier: &str, seed: u64, numbers: std::ops::Range<u64>) {
    Watchdog::over(seed, numbers, |number| {
        let mut rng = dice(seed, number);
        let length = [5, 15, 40][rng.usize(..3)];
        let mut sequence = Sequence {
            host,
            rng,
            instances: Vec::new(),
            states: Vec::new(),
            bytes: Vec::new(),
            calls: Vec::new(),
        };
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| sequence.run(length)));
        if let Err(panic) = caught {
            eprintln!("{identifier}, seed {seed}, sequence {number}: {:?}", sequence.calls);
            std::mem::forget(sequence);
            std::panic::resume_unwind(panic);
        }
    });
}

/// Half of the sequences on each FMU, of these half on each of two threads.
fn attack(seed: u64, count: u64) {
    for (identifier, from) in IDENTIFIERS.into_iter().zip([0, count / 2]) {
        let host = Host::new(identifier);
        let middle = from + count / 4;
        std::thread::scope(|scope| {
            scope.spawn(|| sequences(&host, identifier, seed, from..middle));
            sequences(&host, identifier, seed, middle..from + count / 2);
        });
    }
}

#[test]
fn native_calls_in_any_order_end_with_a_status_and_leave_the_host_alive() {
    let _process = super::beside_others();
    SEEDS.iter().for_each(|&seed| attack(seed, 400));
}

#[test]
#[ignore = "for hours: 200 000 sequences; ATTACK_SEED and ATTACK_COUNT choose others"]
fn attack_by_native_calls() {
    let _process = super::beside_others();
    let (seed, count) = (first_seed(), cases(200_000));
    attack(seed, count);
    println!("seed {seed}: {count} native call sequences");
}
