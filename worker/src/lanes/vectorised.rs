//! Work compiled for the instructions of this processor.
//!
//! What the work calls must be `#[inline(always)]`, without closures: what is not inlined stays compiled for the oldest processor, where
//! a fused operation is a call of the C library. Its results have the same bits everywhere, it only takes longer.

use super::real::OnProcessor;
use super::{Lanes, Real, Vectorised};
#[cfg(not(all(test, target_arch = "x86_64")))]
use pulp::Arch;
use pulp::{Scalar, Simd, WithSimd};

/// Work in lanes of any width, with the same result in each.
pub trait InLanes {
    /// Does the work; `like` sets the number of lanes.
    fn run<R: Real>(self, like: R);
}

/// Does `work` in the widest lanes of this processor.
pub(crate) fn in_widest_lanes(work: impl InLanes) {
    widest(Wide(work));
}

/// Does `work` with the widest vectors of this processor. Unit tests leave out AVX-512, which is a third of their compilation; the tests of
/// whole evaluations have it.
pub(crate) fn widest<W: WithSimd>(work: W) -> W::Output {
    #[cfg(all(test, target_arch = "x86_64"))]
    return match pulp::x86::V3::try_new() {
        Some(avx2) => Simd::vectorize(avx2, work),
        None => work.with_simd(Scalar::new()),
    };
    #[cfg(not(all(test, target_arch = "x86_64")))]
    Arch::new().dispatch(work)
}

/// Does `work` on single numbers with the fused operations of this processor, if it has them.
pub(crate) fn fused<W: Vectorised>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = pulp::x86::V3::try_new() {
        return Simd::vectorize(avx2, OnProcessor(work));
    }
    Scalar::new().vectorize(OnProcessor(work))
}

struct Wide<W>(W);

impl<W: InLanes> WithSimd for Wide<W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.0.run(Lanes::all(simd, 0.0));
    }
}
