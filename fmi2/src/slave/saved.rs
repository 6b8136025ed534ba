//! Saved states, in memory and as bytes.

use super::instance::{Failure, Progress, refuse};
use super::model::{Experiment, Model};
use super::phase::Phase;
use crate::abi::Status;

/// Target of an `fmi2FMUstate`.
pub(super) struct Saved<M: Model> {
    /// GUID of the FMU that the state is of.
    pub guid: String,
    pub progress: Progress,
    pub experiment_set: bool,
    pub model: M::State,
}

const MAGIC: &[u8; 8] = b"FMI2SAVE";
const VERSION: u32 = 1;

/// Header, state of the model, checksum:
///
/// ```text
/// magic 8 | version u32 | guid length u32 | guid | progress 36 | model length u64 | model | CRC-32 of all before
/// ```
///
/// Numbers are little-endian.
pub(super) fn serialize<M: Model>(saved: &Saved<M>) -> Result<Vec<u8>, Failure> {
    let (model, guid) = (M::serialize(&saved.model)?, &saved.guid);
    let Ok(guid_length) = u32::try_from(guid.len()) else {
        return refuse("the GUID is too long");
    };
    let mut bytes = Vec::with_capacity(64 + guid.len() + model.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&guid_length.to_le_bytes());
    bytes.extend_from_slice(guid.as_bytes());
    let Progress {
        phase,
        experiment,
        time,
        step_status,
    } = saved.progress;
    let flags = [
        phase as u8,
        u8::from(step_status == Status::Discard),
        u8::from(experiment.stop_time.is_some()) | u8::from(experiment.tolerance.is_some()) << 1,
        u8::from(saved.experiment_set),
    ];
    bytes.extend_from_slice(&flags);
    let (stop, tolerance) = (experiment.stop_time.unwrap_or(0.0), experiment.tolerance.unwrap_or(0.0));
    for number in [time, experiment.start_time, stop, tolerance] {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    bytes.extend_from_slice(&(model.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&model);
    bytes.extend_from_slice(&crc32fast::hash(&bytes).to_le_bytes());
    Ok(bytes)
}

/// Model's part of a serialised state, as its `serialize` wrote it; `None` for bytes that are no intact state.
#[must_use]
pub fn model_part(bytes: &[u8]) -> Option<&[u8]> {
    let (content, checksum) = bytes.split_last_chunk::<4>()?;
    let mut cursor = Cursor(content);
    let intact = cursor.take(MAGIC.len()).ok()? == MAGIC
        && cursor.array().ok()? == VERSION.to_le_bytes()
        && u32::from_le_bytes(*checksum) == crc32fast::hash(content);
    let guid_length = u32::from_le_bytes(cursor.array().ok()?);
    cursor.take(usize::try_from(guid_length).ok()?).ok()?;
    cursor.take(4 + 4 * size_of::<f64>()).ok()?;
    let length = u64::from_le_bytes(cursor.array().ok()?);
    (intact && cursor.0.len() as u64 == length).then_some(cursor.0)
}

/// Takes fixed-size parts off the front.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Failure> {
        let Some((piece, rest)) = self.0.split_at_checked(count) else {
            return refuse("the serialised state is truncated");
        };
        self.0 = rest;
        Ok(piece)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Failure> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }
}

pub(super) fn deserialize<M: Model>(bytes: &[u8], guid: &str) -> Result<Saved<M>, Failure> {
    let mut cursor = Cursor(bytes);
    if cursor.take(MAGIC.len())? != MAGIC {
        return refuse("the bytes are no serialised state: wrong magic number");
    }
    let version = u32::from_le_bytes(cursor.array()?);
    if version != VERSION {
        return refuse(format!(
            "the serialised state has version {version}, expected {VERSION}"
        ));
    }
    let Some((content, checksum)) = bytes.split_last_chunk::<4>() else {
        return refuse("the serialised state is truncated");
    };
    let (written, found) = (u32::from_le_bytes(*checksum), crc32fast::hash(content));
    if written != found {
        return refuse(format!(
            "the serialised state is damaged: its checksum is {found:08x}, written was {written:08x}"
        ));
    }
    let guid_length = u32::from_le_bytes(cursor.array()?);
    let written_guid = cursor.take(usize::try_from(guid_length).unwrap_or(usize::MAX))?;
    if written_guid != guid.as_bytes() {
        return refuse(format!(
            "the serialised state is of the FMU {}, this one is {guid}",
            String::from_utf8_lossy(written_guid)
        ));
    }
    let [phase, discarded, given, experiment_set] = cursor.array()?;
    let Some(phase) = Phase::from_number(phase) else {
        return refuse(format!("the serialised state has the unknown phase {phase}"));
    };
    let mut numbers = [0.0; 4];
    for number in &mut numbers {
        *number = f64::from_le_bytes(cursor.array()?);
    }
    let [time, start_time, stop, tolerance] = numbers;
    let length = u64::from_le_bytes(cursor.array()?);
    if cursor.0.len() as u64 != length.saturating_add(4) {
        return refuse(format!(
            "the serialised state holds {} bytes of the model, its header says {length}",
            cursor.0.len().saturating_sub(4)
        ));
    }
    let model = M::deserialize(&cursor.0[..cursor.0.len() - 4])
        .map_err(|error| Failure::Refused(format!("the serialised state is of no use: {error}")))?;
    let experiment = Experiment {
        start_time,
        stop_time: (given & 1 != 0).then_some(stop),
        tolerance: (given & 2 != 0).then_some(tolerance),
    };
    let step_status = if discarded != 0 { Status::Discard } else { Status::Ok };
    Ok(Saved {
        guid: guid.to_owned(),
        progress: Progress {
            phase,
            experiment,
            time,
            step_status,
        },
        experiment_set: experiment_set != 0,
        model,
    })
}
