//! Columns into rows of bytes: one pass a column over the batch's rows, so that no row asks which columns there are.

/// Rows of one length, reused from batch to batch.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    row_bytes: usize,
    bytes: Vec<u8>,
}

impl Rows {
    /// Rows of `row_bytes` bytes (at least one).
    pub(crate) fn new(row_bytes: usize) -> Self {
        Self {
            row_bytes: row_bytes.max(1),
            bytes: Vec::new(),
        }
    }

    /// `count` rows; what stood in them before may still stand there.
    pub(crate) fn reset(&mut self, count: usize) {
        self.bytes.resize(count * self.row_bytes, 0);
    }

    /// Every row; none where rows are not of `N` bytes.
    pub(crate) fn each<const N: usize>(&mut self) -> impl Iterator<Item = &mut [u8; N]> {
        let fits = N == self.row_bytes;
        let (rows, _) = self.bytes.as_chunks_mut::<N>();
        rows.iter_mut().take(if fits { usize::MAX } else { 0 })
    }

    /// Writes a column at byte `offset` of every row.
    pub(crate) fn fill<const N: usize>(
        &mut self,
        offset: usize,
        values: impl Iterator<Item = [u8; N]>,
    ) {
        fill(&mut self.bytes, self.row_bytes, offset, values);
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// The same over rows that someone else keeps.
pub(crate) fn fill<const N: usize>(
    rows: &mut [u8],
    row_bytes: usize,
    offset: usize,
    values: impl Iterator<Item = [u8; N]>,
) {
    for (row, value) in rows.chunks_exact_mut(row_bytes.max(1)).zip(values) {
        if let Some(slot) = row.get_mut(offset..offset + N) {
            slot.copy_from_slice(&value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_become_rows() {
        let mut rows = Rows::new(3);
        rows.reset(2);
        rows.fill(0, [1u8, 2].iter().map(|v| [*v]));
        rows.fill(1, [0x0304u16, 0x0506].iter().map(|v| v.to_be_bytes()));
        assert_eq!(rows.bytes(), [1, 3, 4, 2, 5, 6]);
        rows.reset(1);
        assert_eq!(rows.bytes(), [1, 3, 4]);
        rows.each::<3>().for_each(|row| *row = [7, 8, 9]);
        assert_eq!(rows.bytes(), [7, 8, 9]);
        assert_eq!(rows.each::<2>().count(), 0);
    }
}
