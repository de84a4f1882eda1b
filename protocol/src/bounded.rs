//! A short list in a fixed array: what frames and words are kept in where there is no heap.
//!
//! It only grows at its end and is read as a slice.

use core::fmt;
use core::ops::Deref;

use thiserror::Error;

/// At most `N` values in place.
#[derive(Clone, Copy)]
pub struct Bounded<T, const N: usize> {
    items: [T; N],
    len: usize,
}

/// The list holds as many values as it can.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("no room for more than {capacity} values")]
pub struct Full {
    /// How many it holds.
    pub capacity: usize,
}

impl<T: Copy + Default, const N: usize> Bounded<T, N> {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            items: [T::default(); N],
            len: 0,
        }
    }

    /// A copy of `items`.
    ///
    /// # Errors
    /// [`Full`] where they are more than `N`.
    pub fn from_slice(items: &[T]) -> Result<Self, Full> {
        let mut list = Self::new();
        list.items
            .get_mut(..items.len())
            .ok_or(Full { capacity: N })?
            .copy_from_slice(items);
        list.len = items.len();
        Ok(list)
    }

    /// Appends `item`.
    ///
    /// # Errors
    /// [`Full`] where there are `N` already; the list stays as it was.
    pub fn push(&mut self, item: T) -> Result<(), Full> {
        *self.items.get_mut(self.len).ok_or(Full { capacity: N })? = item;
        self.len += 1;
        Ok(())
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// The values.
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        self.items.get(..self.len).unwrap_or_default()
    }
}

impl<T: Copy + Default, const N: usize> Default for Bounded<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Copy + Default, const N: usize> Deref for Bounded<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        self.as_slice()
    }
}

/// Appends as long as there is room and drops the rest: for buffers sized for the longest content there is.
impl<T: Copy + Default, const N: usize> Extend<T> for Bounded<T, N> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        for item in items {
            if self.push(item).is_err() {
                return;
            }
        }
    }
}

impl<T: Copy + Default + PartialEq, const N: usize> PartialEq for Bounded<T, N> {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

impl<T: Copy + Default + Eq, const N: usize> Eq for Bounded<T, N> {}

impl<T: Copy + Default + fmt::Debug, const N: usize> fmt::Debug for Bounded<T, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_slice().fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_holds_n_and_refuses_more() {
        let mut list = Bounded::<u8, 2>::new();
        assert_eq!(list.push(1), Ok(()));
        assert_eq!(list.push(2), Ok(()));
        assert_eq!(list.push(3), Err(Full { capacity: 2 }));
        assert_eq!(list.as_slice(), [1, 2]);
        assert_eq!(
            Bounded::<u8, 2>::from_slice(&[1, 2, 3]),
            Err(Full { capacity: 2 })
        );
    }

    #[test]
    fn equality_ignores_what_was_cleared() {
        let mut list = Bounded::<u8, 4>::from_slice(&[9, 9]).unwrap();
        list.clear();
        list.extend([1]);
        assert_eq!(list, Bounded::from_slice(&[1]).unwrap());
    }
}
