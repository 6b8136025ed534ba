//! Arguments of random calls: references, values, times, texts.
use fastrand::Rng;
use fmi2::model_description::{BaseType, Causality, ModelDescription};
use std::ffi::CString;
use std::ptr::null;

/// More elements than any call has.
const HUGE: [usize; 3] = [1 << 25, 1 << 40, usize::MAX];

/// Care that an importer takes of the arguments of a call.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Care {
    /// Nothing wrong with its arguments.
    Careful,
    /// Anything may be wrong with them.
    Careless,
}

/// References of the variables of one base type, and how many there are of all types.
pub struct References {
    /// By base type: real, integer, boolean, string; inputs and tunable parameters first.
    of: [Vec<u32>; 4],
    inputs: Vec<u32>,
    outputs: Vec<u32>,
    parameters: Vec<u32>,
    starts: Vec<f64>,
    count: u32,
}

pub fn index(base_type: BaseType) -> usize {
    match base_type {
        BaseType::Real => 0,
        BaseType::Integer => 1,
        BaseType::Boolean => 2,
        BaseType::String => 3,
    }
}

impl References {
    pub fn of(description: &ModelDescription) -> Self {
        let mut of: [Vec<u32>; 4] = Default::default();
        let (mut inputs, mut outputs, mut parameters) = (Vec::new(), Vec::new(), Vec::new());
        let count = description.variables.len() as u32;
        let mut starts = vec![0.0; description.variables.len()];
        for variable in &description.variables {
            let (reference, base_type) = (variable.value_reference, variable.base_type());
            of[index(base_type)].push(reference);
            starts[reference as usize] = variable.real_start().unwrap_or(0.0);
            match variable.causality {
                Causality::Input if base_type == BaseType::Real => inputs.push(reference),
                Causality::Output if base_type == BaseType::Real => outputs.push(reference),
                Causality::Parameter if base_type == BaseType::Real => parameters.push(reference),
                _ => {}
            }
        }
        Self {
            of,
            inputs,
            outputs,
            parameters,
            starts,
            count,
        }
    }

    /// Some references of a list; careless ones are of any type, or of nothing.
    fn some(&self, rng: &mut Rng, list: &[u32], care: Care) -> Vec<u32> {
        let count = [0, 1, 1, 1, 2, 5][rng.usize(..6)];
        let mut one = || match rng.u8(..8) {
            0 if care == Care::Careless => [self.count, u32::MAX, 1 << 31, rng.u32(..)][rng.usize(..4)],
            1 if care == Care::Careless => rng.u32(..self.count),
            _ if list.is_empty() => rng.u32(..self.count),
            _ => list[rng.usize(..list.len())],
        };
        (0..count).map(|_| one()).collect()
    }

    /// References to read values of a type.
    pub fn to_read(&self, rng: &mut Rng, base_type: BaseType, care: Care) -> Vec<u32> {
        self.some(rng, &self.of[index(base_type)], care)
    }

    /// References of real variables to set: most often inputs, seldom parameters.
    pub fn to_set(&self, rng: &mut Rng, care: Care) -> Vec<u32> {
        let list = if rng.u8(..6) == 0 {
            &self.parameters
        } else {
            &self.inputs
        };
        self.some(rng, list, care)
    }

    pub fn inputs(&self, rng: &mut Rng, care: Care) -> Vec<u32> {
        self.some(rng, &self.inputs, care)
    }

    pub fn outputs(&self, rng: &mut Rng, care: Care) -> Vec<u32> {
        self.some(rng, &self.outputs, care)
    }

    /// A value for each reference: near its start, or anything.
    pub fn values(&self, rng: &mut Rng, references: &[u32], care: Care) -> Vec<f64> {
        let mut value = |reference: &u32| {
            let start = self.starts.get(*reference as usize).copied().unwrap_or(0.0);
            if care == Care::Careless && rng.u8(..4) == 0 {
                return number(rng);
            }
            let scale = [0.0, 1e-3, 0.1][rng.usize(..3)];
            start * (1.0 + scale * (rng.f64() - 0.5)) + if start == 0.0 { scale * rng.f64() } else { 0.0 }
        };
        references.iter().map(&mut value).collect()
    }
}

/// Any number, odd ones among them.
pub fn number(rng: &mut Rng) -> f64 {
    let odd = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        5e-324,
        1e-300,
        1e300,
        -1e300,
        f64::MAX,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e6,
        -1e6,
        1e12,
        0.5,
    ];
    match rng.u8(..4) {
        0 => f64::from_bits(rng.u64(..)),
        _ => odd[rng.usize(..odd.len())],
    }
}

/// A step that is odd, but for those of seconds to weeks, which are allowed and take their time.
pub fn odd_step(rng: &mut Rng) -> f64 {
    let step = number(rng);
    if (0.01..1e6).contains(&step) { 1e-3 } else { step }
}

/// An array as a C function gets it: its pointer and the count that is said. A careless one is null, or longer than
/// any.
pub fn array<T>(rng: &mut Rng, list: &[T], care: Care) -> (*const T, usize) {
    let pointer = if list.is_empty() { null() } else { list.as_ptr() };
    if care == Care::Careful {
        return (pointer, list.len());
    }
    match rng.u8(..24) {
        0 => (null(), list.len()),
        1 => (pointer, HUGE[rng.usize(..HUGE.len())]),
        2 => (null(), HUGE[rng.usize(..HUGE.len())]),
        3 => (pointer, 0),
        _ => (pointer, list.len()),
    }
}

/// Texts for a string parameter, which is the path of a scene.
pub fn text(rng: &mut Rng) -> CString {
    let texts: [&[u8]; 10] = [
        b"",
        b"",
        b"relative.toml",
        b"/no/such/scene.toml",
        b"/",
        b"/dev/null",
        b"a\x07\x1b[31mb",
        b"\xff\xfe",
        b"/proc/self/cmdline",
        "/π".as_bytes(),
    ];
    let text = texts[rng.usize(..texts.len())];
    let text = if rng.u8(..12) == 0 {
        vec![b'/'; 1 << 16]
    } else {
        text.to_vec()
    };
    CString::new(text).expect("none of them has a NUL")
}
