//! Which blocks of an island's derivatives have been written in a linearisation.
//!
//! K and D consist of blocks of 3 x 3: the force on one body by the motion of another. The first joint or load that acts on a pair of bodies writes its
//! block, those after it add to it, and the blocks that none has written are set to zero at the end: cheaper than to set all to zero before.

use crate::integrate::Linearised;
use crate::lanes::Real;

/// Blocks written so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct WrittenBlocks {
    /// Bit 8 i + j: the block of bodies i and j. All bits are one if the bodies are more than [`MOST_BODIES`].
    bits: u64,
}

/// Number of bodies of which each pair has a bit.
const MOST_BODIES: usize = 8;

impl WrittenBlocks {
    /// Begins the derivatives of this number of bodies: no block is written, or of more bodies than have bits all are, with zeros.
    #[inline(always)]
    pub(super) fn begin<R: Real>(bodies: usize, at: &mut Linearised<R>) -> Self {
        if bodies <= MOST_BODIES {
            return WrittenBlocks { bits: 0 };
        }
        for entry in 0..at.k.len() {
            (at.k[entry], at.d[entry]) = (at.k[entry].zero(), at.d[entry].zero());
        }
        WrittenBlocks { bits: u64::MAX }
    }

    /// Marks the block of bodies `i` and `j` as written. True if it was not before.
    #[inline(always)]
    pub(super) fn mark(&mut self, i: usize, j: usize) -> bool {
        let before = self.bits;
        self.bits |= 1_u64.wrapping_shl((MOST_BODIES * i + j) as u32);
        before != self.bits
    }

    /// Sets the block of bodies `i` and `j` to zero and marks it as written, unless it was before.
    #[inline(always)]
    pub(super) fn clear_unless_written<R: Real>(&mut self, i: usize, j: usize, at: &mut Linearised<R>) {
        if !self.mark(i, j) {
            return;
        }
        for r in 0..3 {
            let first = at.band.index(3 * i + r, 3 * j);
            for entry in first..first + 3 {
                (at.k[entry], at.d[entry]) = (at.k[entry].zero(), at.d[entry].zero());
            }
        }
    }

    /// Sets the blocks of all other pairs of `bodies` to zero.
    #[inline(always)]
    pub(super) fn clear_others<R: Real>(mut self, bodies: usize, at: &mut Linearised<R>) {
        if bodies > MOST_BODIES {
            return;
        }
        for i in 0..bodies {
            for j in 0..bodies {
                if at.band.kept(3 * i).contains(&(3 * j)) {
                    self.clear_unless_written(i, j, at);
                }
            }
        }
    }
}
