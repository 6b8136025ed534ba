//! Results that follow from a static state, kept with it.
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// The last few results, for cases of a sweep that share a static state; a copy of the state begins without.
pub(crate) struct Kept<K, V> {
    held: Mutex<Vec<(K, V)>>,
    most: usize,
}

impl<K: PartialEq, V: Clone> Kept<K, V> {
    /// Keeps as many results as this; the oldest go first.
    pub fn keeping(most: usize) -> Self {
        Self {
            held: Mutex::default(),
            most,
        }
    }

    /// The result for `key`, made by `make` where it is not kept.
    pub fn or_made<E>(&self, key: K, make: impl FnOnce() -> Result<V, E>) -> Result<V, E> {
        let held = || self.held.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, value)) = held().iter().find(|(known, _)| *known == key) {
            return Ok(value.clone());
        }
        let value = make()?;
        let mut held = held();
        held.insert(0, (key, value.clone()));
        held.truncate(self.most);
        Ok(value)
    }
}

impl<K: PartialEq, V: Clone> Clone for Kept<K, V> {
    fn clone(&self) -> Self {
        Self::keeping(self.most)
    }
}

impl<K, V> fmt::Debug for Kept<K, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Kept").finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_results_are_made_anew() {
        let (kept, mut made) = (Kept::keeping(2), Vec::new());
        for key in [1, 2, 1, 3, 2, 1] {
            let value = kept.or_made(key, || {
                made.push(key);
                Ok::<_, ()>(10 * key)
            });
            assert_eq!(value, Ok(10 * key));
        }
        assert_eq!(made, [1, 2, 3, 1]);
        assert_eq!(kept.or_made(4, || Err("none")), Err("none"));
        assert_eq!(
            kept.clone().or_made(1, || Err("a copy has none")),
            Err("a copy has none")
        );
    }
}
