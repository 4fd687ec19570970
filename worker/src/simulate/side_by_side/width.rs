//! How many numbers the vectors of a lane group hold.

use super::lanes::{Group, LaneGroup};
use super::queue::PendingSpan;
use pulp::Simd;
#[cfg(target_arch = "aarch64")]
use pulp::aarch64::Neon;
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3;
#[cfg(all(target_arch = "x86_64", not(test)))]
use pulp::x86::V4;

/// Numbers that a SIMD lane group holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneWidth {
    /// As many as the vectors of this processor.
    Widest,
    /// At least this number, in the narrowest vectors that have as many: vectors wider than there are islands for cost time. One island is
    /// integrated by itself.
    Holding(usize),
    /// As many as islands of one topology wait for lanes when the group is opened: for one evaluation by itself.
    Fitting,
}

/// Vectors of this processor.
pub(super) enum Vectors {
    #[cfg(target_arch = "aarch64")]
    Two(Neon),
    #[cfg(target_arch = "x86_64")]
    Four(V3),
    #[cfg(all(target_arch = "x86_64", not(test)))]
    Eight(V4),
}

impl Vectors {
    /// Opens a group in these vectors with its first island.
    pub(super) fn open(self, first: PendingSpan) -> Box<dyn Group> {
        match self {
            #[cfg(target_arch = "aarch64")]
            Vectors::Two(simd) => Box::new(LaneGroup::new(simd, first)),
            #[cfg(target_arch = "x86_64")]
            Vectors::Four(simd) => Box::new(LaneGroup::new(simd, first)),
            #[cfg(all(target_arch = "x86_64", not(test)))]
            Vectors::Eight(simd) => Box::new(LaneGroup::new(simd, first)),
        }
    }
}

impl LaneWidth {
    /// The width of a group for this number of islands that wait.
    pub(super) fn for_waiting(self, islands: usize) -> Self {
        if self == LaneWidth::Fitting { LaneWidth::Holding(islands) } else { self }
    }

    /// The vectors of this width that this processor has; `None` where islands are integrated by themselves: one alone, or on a processor
    /// without vectors. Unit tests leave out AVX-512, which is a third of their compilation; the tests of whole evaluations have it.
    pub(super) fn vectors(self) -> Option<Vectors> {
        if matches!(self, LaneWidth::Holding(..=1)) {
            return None;
        }
        #[cfg(all(target_arch = "x86_64", not(test)))]
        if !matches!(self, LaneWidth::Holding(..=4))
            && let Some(simd) = V4::try_new()
        {
            return Some(Vectors::Eight(simd));
        }
        #[cfg(target_arch = "x86_64")]
        return V3::try_new().map(Vectors::Four);
        #[cfg(target_arch = "aarch64")]
        return Neon::try_new().map(Vectors::Two);
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        None
    }
}

/// Numbers in the widest vectors of this processor.
pub(crate) fn widest_lanes() -> usize {
    /// Numbers in vectors of `S`.
    fn lanes<S: Simd>(_simd: S) -> usize {
        S::F64_LANES
    }
    match LaneWidth::Widest.vectors() {
        #[cfg(target_arch = "aarch64")]
        Some(Vectors::Two(simd)) => lanes(simd),
        #[cfg(target_arch = "x86_64")]
        Some(Vectors::Four(simd)) => lanes(simd),
        #[cfg(all(target_arch = "x86_64", not(test)))]
        Some(Vectors::Eight(simd)) => lanes(simd),
        None => 1,
    }
}
