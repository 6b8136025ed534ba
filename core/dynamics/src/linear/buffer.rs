//! Numbers at the boundary of a cache line.
use std::ops::{Deref, DerefMut};

/// Numbers of a cache line, which is also the widest SIMD vector.
pub(crate) const LINE: usize = LINE_BYTES / size_of::<f64>();

const LINE_BYTES: usize = 64;

/// A slice of zeros that begins at the boundary of a cache line: a vector loaded across two lines costs twice.
#[derive(Debug, Default)]
pub(crate) struct Buffer<T = f64> {
    memory: Vec<T>,
    first: usize,
    len: usize,
}

impl<T: Copy + Default> Buffer<T> {
    /// `len` zeros.
    pub fn new(len: usize) -> Self {
        let line = LINE_BYTES / size_of::<T>();
        let memory = vec![T::default(); len + line];
        let first = memory.as_ptr().align_offset(LINE_BYTES).min(line);
        Self { memory, first, len }
    }
}

impl<T> Deref for Buffer<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.memory[self.first..self.first + self.len]
    }
}

impl<T> DerefMut for Buffer<T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.memory[self.first..self.first + self.len]
    }
}
