//! Where the entries of an island's matrices are: near the diagonal, if its bodies form a chain.

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
    /// Of an `n` x `n` matrix with `half` diagonals beside the main one on either side; all entries are kept where
    /// that takes less than twice the room.
    pub fn new(n: usize, half: usize) -> Self {
        if 2 * (2 * half + 1) > n {
            return Band { n, half: n, stride: n, offset: 0 };
        }
        Band { n, half, stride: 2 * half, offset: half }
    }

    /// The layout that has twice as many diagonals beside the main one.
    pub fn widened(&self) -> Self {
        Band::new(self.n, 2 * self.half)
    }

    /// Rows.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Room that the matrix takes.
    pub fn len(&self) -> usize {
        if self.offset == 0 { self.n * self.n } else { self.n * (self.stride + 1) }
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Where entry (i, j) is.
    #[inline(always)]
    pub fn index(&self, i: usize, j: usize) -> usize {
        i * self.stride + j + self.offset
    }

    /// Columns kept of row `i`; by symmetry of the layout, rows of column `i`.
    #[inline(always)]
    pub fn kept(&self, i: usize) -> Range<usize> {
        i.saturating_sub(self.half)..(i + self.half + 1).min(self.n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_has_a_place_of_its_own() {
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
