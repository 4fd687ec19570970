//! How many numbers the vectors of a lane group hold.

use crate::lanes::widest;
use pulp::{Scalar, Simd, WithSimd};

/// Numbers that a SIMD lane group holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneWidth {
    /// As many as the vectors of this processor.
    Widest,
    /// At least this number, in the narrowest vectors that have as many: vectors wider than there are islands for cost time. One number takes
    /// the scalar instructions of any processor.
    Holding(usize),
    /// As many as islands of one topology wait for lanes when the group is opened: for one evaluation by itself.
    Fitting,
}

impl LaneWidth {
    /// The width of a group for this number of islands that wait.
    pub(super) fn for_waiting(self, islands: usize) -> Self {
        if self == LaneWidth::Fitting { LaneWidth::Holding(islands) } else { self }
    }

    /// Runs `work` in lanes of this width.
    pub(super) fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        match self {
            LaneWidth::Holding(..=1) => work.with_simd(Scalar::new()),
            #[cfg(target_arch = "x86_64")]
            LaneWidth::Holding(..=4) if let Some(avx2) = pulp::x86::V3::try_new() => {
                Simd::vectorize(avx2, work)
            }
            _ => widest(work),
        }
    }
}

/// Numbers in the widest vectors of this processor.
pub(crate) fn widest_lanes() -> usize {
    /// Counts the lanes that it is run in.
    struct Count;
    impl WithSimd for Count {
        type Output = usize;
        fn with_simd<S: Simd>(self, _simd: S) -> usize {
            S::F64_LANES
        }
    }
    LaneWidth::Widest.dispatch(Count)
}
