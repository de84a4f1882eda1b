//! A short list in a fixed array. Unlike `heapless::Vec` it is `Copy`, as the messages that contain
//! it are, and extending it past its capacity does not panic.

use core::fmt;
use core::ops::Deref;

use thiserror::Error;

/// A list of at most `N` values, read as a slice.
#[derive(Clone, Copy)]
pub struct BoundedVec<T, const N: usize> {
    items: [T; N],
    len: usize,
}

/// The list is at its capacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("no room for more than {capacity} values")]
#[non_exhaustive]
pub struct CapacityError {
    /// The most values it holds.
    pub capacity: usize,
}

impl<T: Copy + Default, const N: usize> BoundedVec<T, N> {
    /// An empty list.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A copy of `items`.
    ///
    /// # Errors
    /// [`CapacityError`] where they are more than `N`.
    pub fn from_slice(items: &[T]) -> Result<Self, CapacityError> {
        if items.len() > N {
            return Err(CapacityError { capacity: N });
        }
        Ok(items.iter().copied().collect())
    }

    /// Appends `item`.
    ///
    /// # Errors
    /// [`CapacityError`] where there are `N` already; the list is unchanged.
    pub fn push(&mut self, item: T) -> Result<(), CapacityError> {
        *self
            .items
            .get_mut(self.len)
            .ok_or(CapacityError { capacity: N })? = item;
        self.len += 1;
        Ok(())
    }

    /// Removes all values.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// The values.
    #[must_use]
    pub fn as_slice(&self) -> &[T] {
        self
    }
}

impl<T: Copy + Default, const N: usize> Default for BoundedVec<T, N> {
    fn default() -> Self {
        let items = [T::default(); N];
        Self { items, len: 0 }
    }
}

impl<T, const N: usize> Deref for BoundedVec<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        self.items.get(..self.len).unwrap_or_default()
    }
}

/// Appends up to the capacity and drops the rest.
impl<T: Copy + Default, const N: usize> Extend<T> for BoundedVec<T, N> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, items: I) {
        items.into_iter().all(|item| self.push(item).is_ok());
    }
}

/// Takes values up to the capacity and drops the rest.
impl<T: Copy + Default, const N: usize> FromIterator<T> for BoundedVec<T, N> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        let mut list = Self::default();
        list.extend(items);
        list
    }
}

impl<T, const N: usize> IntoIterator for BoundedVec<T, N> {
    type Item = T;
    type IntoIter = core::iter::Take<core::array::IntoIter<T, N>>;

    fn into_iter(self) -> Self::IntoIter {
        self.items.into_iter().take(self.len)
    }
}

impl<T: PartialEq, const N: usize> PartialEq for BoundedVec<T, N> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Eq, const N: usize> Eq for BoundedVec<T, N> {}

impl<T: fmt::Debug, const N: usize> fmt::Debug for BoundedVec<T, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_hold_n_elements_and_refuse_more() {
        let mut list = BoundedVec::<u8, 2>::new();
        assert_eq!(list.push(1), Ok(()));
        assert_eq!(list.push(2), Ok(()));
        assert_eq!(list.push(3), Err(CapacityError { capacity: 2 }));
        assert_eq!(list.as_slice(), [1, 2]);
        assert_eq!(
            BoundedVec::<u8, 2>::from_slice(&[1, 2, 3]),
            Err(CapacityError { capacity: 2 })
        );
    }

    #[test]
    fn equality_ignores_cleared_values() {
        let mut list = BoundedVec::<u8, 4>::from_slice(&[9, 9]).unwrap();
        list.clear();
        list.extend([1]);
        assert_eq!(list, BoundedVec::from_slice(&[1]).unwrap());
    }
}
