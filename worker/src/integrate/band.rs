//! Storage of an island's matrices by diagonals: the bodies of a chain couple only to their neighbours.
//!
//! # Source
//! Banded storage by rows, as in Golub, Van Loan: Matrix Computations (2013), section 1.2.

use std::ops::Range;

/// Layout of a square matrix whose entries (i, j) vanish for |i - j| above half its band.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Band {
    n: usize,
    half: usize,
    stride: usize,
    offset: usize,
}

impl Band {
    /// Layout of an `n` x `n` matrix with `half` diagonals on either side of the main one; all entries are stored where that takes
    /// less than twice the space.
    pub(crate) fn new(n: usize, half: usize) -> Self {
        if 2 * (2 * half + 1) > n {
            return Band { n, half: n, stride: n, offset: 0 };
        }
        Band { n, half, stride: 2 * half, offset: half }
    }

    /// The layout with twice as many diagonals on either side of the main one.
    pub(crate) fn widened(&self) -> Self {
        Band::new(self.n, 2 * self.half)
    }

    /// Number of rows if all entries are stored, else zero.
    pub(crate) fn dense(&self) -> usize {
        if self.offset == 0 { self.n } else { 0 }
    }

    /// Number of rows.
    pub(crate) fn n(&self) -> usize {
        self.n
    }

    /// Number of stored entries.
    pub(crate) fn len(&self) -> usize {
        if self.offset == 0 { self.n * self.n } else { self.n * (self.stride + 1) }
    }

    /// Index of entry (i, j) in the storage.
    #[inline(always)]
    pub(crate) fn index(&self, i: usize, j: usize) -> usize {
        i * self.stride + j + self.offset
    }

    /// Stored columns of row `i`; by symmetry of the layout also the stored rows of column `i`.
    #[inline(always)]
    pub(crate) fn kept(&self, i: usize) -> Range<usize> {
        i.saturating_sub(self.half)..(i + self.half + 1).min(self.n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_entries_share_a_place() {
        for (n, half) in [(0, 0), (6, 5), (21, 5), (22, 5), (180, 5), (9, 0)] {
            let band = Band::new(n, half);
            let mut taken = vec![false; band.len()];
            for i in 0..n {
                assert!(band.kept(i).contains(&i) && band.kept(i).len() > half.min(n - 1));
                for j in band.kept(i) {
                    assert!(band.kept(j).contains(&i));
                    assert!(!std::mem::replace(&mut taken[band.index(i, j)], true));
                }
            }
        }
        assert_eq!(Band::new(180, 5).len(), 180 * 11);
    }
}
