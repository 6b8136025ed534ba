//! Bytes of the protocol: numbers, lists and texts, and frames on a socket.

use std::io::{self, ErrorKind, Read, Write};
use std::ops::Range;
use std::time::Instant;

/// Longest frame that is taken, bytes: a serialised state of the largest size and something around it.
const LONGEST: usize = (1 << 30) + (1 << 20);

/// Bytes asked of the socket at once.
const CHUNK: usize = 1 << 16;

/// A frame that is being written; the buffer is used again.
#[derive(Debug)]
pub(super) struct Writer {
    /// Length, then content.
    bytes: Vec<u8>,
}

impl Writer {
    pub(super) fn new() -> Self {
        Self { bytes: vec![0; 4] }
    }

    /// Begins a new frame.
    pub(super) fn clear(&mut self) {
        self.bytes.truncate(4);
    }

    /// Bytes of content so far.
    pub(super) fn len(&self) -> usize {
        self.bytes.len() - 4
    }

    /// Takes back everything behind the first `length` bytes of content.
    pub(super) fn truncate(&mut self, length: usize) {
        self.bytes.truncate(4 + length);
    }

    /// Replaces content that was written before.
    pub(super) fn replace(&mut self, at: usize, bytes: &[u8]) {
        self.bytes[4 + at..4 + at + bytes.len()].copy_from_slice(bytes);
    }

    pub(super) fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub(super) fn u8(&mut self, value: u8) {
        self.bytes.push(value);
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.raw(&value.to_le_bytes());
    }

    pub(super) fn i32(&mut self, value: i32) {
        self.raw(&value.to_le_bytes());
    }

    pub(super) fn u64(&mut self, value: u64) {
        self.raw(&value.to_le_bytes());
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.raw(&value.to_le_bytes());
    }

    pub(super) fn length(&mut self, length: usize) {
        self.u32(u32::try_from(length).expect("lists are shorter than a frame"));
    }

    pub(super) fn bytes(&mut self, bytes: &[u8]) {
        self.length(bytes.len());
        self.raw(bytes);
    }

    pub(super) fn text(&mut self, text: &str) {
        self.bytes(text.as_bytes());
    }

    pub(super) fn u32s(&mut self, values: &[u32]) {
        self.length(values.len());
        for value in values {
            self.u32(*value);
        }
    }

    pub(super) fn i32s(&mut self, values: &[i32]) {
        self.length(values.len());
        for value in values {
            self.i32(*value);
        }
    }

    pub(super) fn f64s(&mut self, values: &[f64]) {
        self.length(values.len());
        for value in values {
            self.f64(*value);
        }
    }

    /// Sends the frame.
    pub(super) fn send(&mut self, mut to: impl Write) -> io::Result<()> {
        let length = u32::try_from(self.len())
            .ok()
            .filter(|length| *length as usize <= LONGEST);
        let length = length.ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "the frame is too long"))?;
        self.bytes[..4].copy_from_slice(&length.to_le_bytes());
        to.write_all(&self.bytes)
    }
}

/// Bytes that are not what they should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Malformed;

/// The content of a frame, read from its begin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(super) fn new(content: &'a [u8]) -> Self {
        Self { rest: content }
    }

    pub(super) fn raw(&mut self, length: usize) -> Result<&'a [u8], Malformed> {
        let (bytes, rest) = self.rest.split_at_checked(length).ok_or(Malformed)?;
        self.rest = rest;
        Ok(bytes)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        self.raw(N)?.try_into().map_err(|_| Malformed)
    }

    pub(super) fn u8(&mut self) -> Result<u8, Malformed> {
        Ok(self.array::<1>()?[0])
    }

    pub(super) fn u32(&mut self) -> Result<u32, Malformed> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    pub(super) fn i32(&mut self) -> Result<i32, Malformed> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64, Malformed> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub(super) fn f64(&mut self) -> Result<f64, Malformed> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    pub(super) fn bytes(&mut self) -> Result<&'a [u8], Malformed> {
        let length = self.u32()? as usize;
        self.raw(length)
    }

    pub(super) fn text(&mut self) -> Result<&'a str, Malformed> {
        std::str::from_utf8(self.bytes()?).map_err(|_| Malformed)
    }

    /// Length of a list whose elements have `size` bytes each.
    pub(super) fn length(&mut self, size: usize) -> Result<usize, Malformed> {
        let length = self.u32()? as usize;
        if length.checked_mul(size).is_none_or(|bytes| bytes > self.rest.len()) {
            return Err(Malformed);
        }
        Ok(length)
    }

    fn list<T, const N: usize>(&mut self, into: &mut Vec<T>, of: impl Fn([u8; N]) -> T) -> Result<(), Malformed> {
        let length = self.length(N)?;
        into.clear();
        for bytes in self.raw(length * N)?.chunks_exact(N) {
            into.push(of(bytes.try_into().map_err(|_| Malformed)?));
        }
        Ok(())
    }

    pub(super) fn u32s(&mut self, into: &mut Vec<u32>) -> Result<(), Malformed> {
        self.list(into, u32::from_le_bytes)
    }

    pub(super) fn i32s(&mut self, into: &mut Vec<i32>) -> Result<(), Malformed> {
        self.list(into, i32::from_le_bytes)
    }

    pub(super) fn f64s(&mut self, into: &mut Vec<f64>) -> Result<(), Malformed> {
        self.list(into, f64::from_le_bytes)
    }
}

/// The receiving end of a socket; what it has beyond a frame stays for the next one.
#[derive(Debug)]
pub(super) struct Receiver<R> {
    from: R,
    buffer: Vec<u8>,
    /// Begin and end of what is received and not yet taken.
    begin: usize,
    end: usize,
}

impl<R: Read> Receiver<R> {
    pub(super) fn new(from: R) -> Self {
        Self {
            from,
            buffer: vec![0; CHUNK],
            begin: 0,
            end: 0,
        }
    }

    /// Bytes that the buffer has room for.
    #[cfg(test)]
    pub(super) fn room(&self) -> usize {
        self.buffer.len()
    }

    /// Content of the next frame; `None` where the other side has closed.
    ///
    /// # Errors
    /// Errors of the socket, and a frame that is longer than any.
    pub(super) fn receive(&mut self) -> io::Result<Option<&[u8]>> {
        self.receive_until(None)
    }

    /// The same until `deadline`, where the socket has a time limit of its own, after which it is asked again.
    ///
    /// # Errors
    /// As [`Receiver::receive`]; `TimedOut` where no whole frame has come in time.
    pub(super) fn receive_until(&mut self, deadline: Option<Instant>) -> io::Result<Option<&[u8]>> {
        let frame = self.find(deadline)?;
        Ok(frame.map(|content| &self.buffer[content]))
    }

    /// Place of the next frame in the buffer.
    fn find(&mut self, deadline: Option<Instant>) -> io::Result<Option<Range<usize>>> {
        let length = loop {
            let received = &self.buffer[self.begin..self.end];
            let needed = match received.first_chunk::<4>() {
                Some(length) => 4 + u32::from_le_bytes(*length) as usize,
                None => 4,
            };
            if needed > 4 + LONGEST {
                return Err(io::Error::new(ErrorKind::InvalidData, "the frame is too long"));
            }
            if received.len() >= needed && received.len() >= 4 {
                break needed;
            }
            // One that comes byte by byte as well.
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return Err(ErrorKind::TimedOut.into());
            }
            if self.begin + needed > self.buffer.len() || self.begin == self.end {
                if self.begin > 0 {
                    self.buffer.copy_within(self.begin..self.end, 0);
                    (self.begin, self.end) = (0, self.end - self.begin);
                }
                // Not for the length that is said: memory is taken for what has come.
                if self.end == self.buffer.len() {
                    self.buffer.resize(needed.min(2 * self.buffer.len()), 0);
                }
            }
            match self.from.read(&mut self.buffer[self.end..]) {
                Ok(0) => return Ok(None),
                Ok(more) => self.end += more,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error)
                    if deadline.is_some() && matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(error) => return Err(error),
            }
        };
        let content = self.begin + 4..self.begin + length;
        self.begin = content.end;
        Ok(Some(content))
    }
}
