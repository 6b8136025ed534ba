//! Numbers at the boundary of a cache line.
use std::ops::{Deref, DerefMut};

/// Numbers of a cache line, which is also the widest SIMD vector.
pub(crate) const LINE: usize = 8;

/// A slice of zeros that begins at the boundary of a cache line: a vector loaded across two lines costs twice.
#[derive(Debug, Default)]
pub(crate) struct Buffer {
    memory: Vec<f64>,
    first: usize,
    len: usize,
}

impl Buffer {
    /// `len` zeros.
    pub fn new(len: usize) -> Self {
        let memory = vec![0.0; len + LINE];
        let first = memory.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE);
        Self { memory, first, len }
    }
}

impl Deref for Buffer {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.memory[self.first..self.first + self.len]
    }
}

impl DerefMut for Buffer {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.memory[self.first..self.first + self.len]
    }
}
