//! Layouts of an island's matrices: banded or dense with a size known only when the program runs, or dense with a size known when it is
//! compiled, whose loops become straight code. Banded ones are stored by diagonals: the bodies of a chain couple only to their neighbours.
//!
//! # Source
//! Storage by rows, as in Golub, Van Loan: Matrix Computations (2013), section 1.2.

use std::fmt::Debug;
use std::ops::Range;

/// Which entries of a square matrix are stored, and where.
pub trait Layout: Debug + Copy {
    /// Number of rows if it is known when the program is compiled, else zero.
    const ROWS: usize;
    /// Number of rows.
    fn n(&self) -> usize;
    /// Number of stored entries.
    fn len(&self) -> usize;
    /// Index of entry (i, j) in the storage.
    fn index(&self, i: usize, j: usize) -> usize;
    /// Stored columns of row `i`; by symmetry of the layout also the stored rows of column `i`.
    fn kept(&self, i: usize) -> Range<usize>;
}

/// A matrix of `N` rows with all its entries.
#[derive(Debug, Clone, Copy)]
pub struct Dense<const N: usize>;

impl<const N: usize> Layout for Dense<N> {
    const ROWS: usize = N;
    #[inline(always)]
    fn n(&self) -> usize {
        N
    }
    #[inline(always)]
    fn len(&self) -> usize {
        N * N
    }
    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * N + j
    }
    #[inline(always)]
    fn kept(&self, _i: usize) -> Range<usize> {
        0..N
    }
}

impl Layout for Band {
    const ROWS: usize = 0;
    fn n(&self) -> usize {
        self.n
    }
    fn len(&self) -> usize {
        if self.offset == 0 { self.n * self.n } else { self.n * (self.stride + 1) }
    }
    #[inline(always)]
    fn index(&self, i: usize, j: usize) -> usize {
        i * self.stride + j + self.offset
    }
    #[inline(always)]
    fn kept(&self, i: usize) -> Range<usize> {
        i.saturating_sub(self.half)..(i + self.half + 1).min(self.n)
    }
}

/// Evaluates an expression with the layout of a [`Band`]: dense ones of one to three free bodies are known when compiled.
macro_rules! with_layout {
    ($band:expr, $layout:ident => $value:expr) => {
        match $band.dense() {
            3 => {
                let $layout = $crate::integrate::layout::Dense::<3>;
                $value
            }
            6 => {
                let $layout = $crate::integrate::layout::Dense::<6>;
                $value
            }
            9 => {
                let $layout = $crate::integrate::layout::Dense::<9>;
                $value
            }
            _ => {
                let $layout = $band;
                $value
            }
        }
    };
}

/// Does `body` for each row k of a layout, forwards or backwards: one copy for each row where their number is known when compiled.
macro_rules! each_row {
    ($layout:ident: $type:ty, $k:ident => $body:block) => {
        match <$type>::ROWS {
            3 => each_row!(@copies $k $body 0 1 2),
            6 => each_row!(@copies $k $body 0 1 2 3 4 5),
            9 => each_row!(@copies $k $body 0 1 2 3 4 5 6 7 8),
            _ => for $k in 0..$layout.n() $body
        }
    };
    ($layout:ident: $type:ty, backwards $k:ident => $body:block) => {
        match <$type>::ROWS {
            3 => each_row!(@copies $k $body 2 1 0),
            6 => each_row!(@copies $k $body 5 4 3 2 1 0),
            9 => each_row!(@copies $k $body 8 7 6 5 4 3 2 1 0),
            _ => for $k in (0..$layout.n()).rev() $body
        }
    };
    (@copies $k:ident $body:block $($row:literal)+) => {{
        $({
            let $k: usize = $row;
            $body
        })+
    }};
}

pub(super) use {each_row, with_layout};

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
