//! How many numbers the vectors of a lane group hold.

use super::lanes::{Group, LaneGroup};
use super::queue::PendingSpan;
use pulp::Simd;
#[cfg(target_arch = "aarch64")]
use pulp::aarch64::Neon as Narrowest;
#[cfg(target_arch = "x86_64")]
use pulp::x86::V3 as Narrowest;
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

impl LaneWidth {
    /// Opens a group in vectors of this width with the first of this number of islands that wait. `None` where that is integrated by itself, which `alone` does: without company, or on a
    /// processor without vectors. Unit tests leave out AVX-512, which is a third of their compilation; the tests of whole evaluations have it.
    pub(super) fn open(
        self,
        (waiting, first): (usize, PendingSpan),
        alone: impl FnOnce(PendingSpan),
    ) -> Option<Box<dyn Group>> {
        let width = if self == LaneWidth::Fitting { LaneWidth::Holding(waiting) } else { self };
        #[cfg(all(target_arch = "x86_64", not(test)))]
        if !matches!(width, LaneWidth::Holding(..=4))
            && let Some(simd) = V4::try_new()
        {
            return Some(Box::new(LaneGroup::new(simd, first)));
        }
        #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
        if !matches!(width, LaneWidth::Holding(..=1))
            && let Some(simd) = Narrowest::try_new()
        {
            return Some(Box::new(LaneGroup::new(simd, first)));
        }
        alone(first);
        None
    }
}

/// Numbers in the widest vectors of this processor.
pub(crate) fn widest_lanes() -> usize {
    #[cfg(all(target_arch = "x86_64", not(test)))]
    if V4::try_new().is_some() {
        return V4::F64_LANES;
    }
    #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
    if Narrowest::try_new().is_some() {
        return Narrowest::F64_LANES;
    }
    1
}
