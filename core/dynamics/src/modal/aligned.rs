//! Numbers of all modes at a place in memory that vector registers are filled from at once.
use std::ops::{Deref, DerefMut};

/// Bytes of the largest register, and of what a processor fetches from memory at a time.
const BYTES: usize = 64;
/// Numbers by which the place is moved at most.
const SPARE: usize = BYTES / size_of::<f32>() - 1;

/// Numbers that begin at a multiple of 64 bytes.
#[derive(Debug)]
pub struct Aligned {
    room: Vec<f32>,
    from: usize,
    len: usize,
}

impl Aligned {
    /// `len` zeros.
    #[must_use]
    pub fn zeros(len: usize) -> Self {
        let room = vec![0.0_f32; len + SPARE];
        let from = room.as_ptr().align_offset(BYTES).min(SPARE);
        Self { room, from, len }
    }
}

impl Default for Aligned {
    fn default() -> Self {
        Self::zeros(0)
    }
}

impl From<&[f32]> for Aligned {
    fn from(values: &[f32]) -> Self {
        let mut aligned = Self::zeros(values.len());
        aligned.copy_from_slice(values);
        aligned
    }
}

impl Clone for Aligned {
    fn clone(&self) -> Self {
        Self::from(&**self)
    }
}

impl Deref for Aligned {
    type Target = [f32];

    #[inline]
    fn deref(&self) -> &[f32] {
        &self.room[self.from..][..self.len]
    }
}

impl DerefMut for Aligned {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.room[self.from..][..self.len]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_begin_at_a_multiple_of_a_register_and_clones_too() {
        for len in [1, 32, 1000] {
            let mut numbers = Aligned::zeros(len);
            numbers[len - 1] = 3.0;
            let clone = numbers.clone();
            assert_eq!(*numbers, *clone);
            for numbers in [numbers, clone] {
                assert_eq!(numbers.len(), len);
                assert_eq!(numbers.as_ptr().align_offset(BYTES), 0);
            }
        }
    }
}
