//! Plain loops compiled for the vectors of this processor.

use pulp::{Arch, Simd, WithSimd};

/// Work on plain numbers whose loops the compiler turns into vector instructions. `run` and what it calls must be
/// `#[inline(always)]`, without closures: what is not inlined stays compiled for the oldest processor.
pub trait Vectorised {
    /// Does the work.
    fn run(self);
}

/// Does `work` with the instructions of this processor. The results have the same bits on every processor: operations are neither
/// fused nor reordered.
pub(crate) fn vectorise(work: impl Vectorised) {
    Arch::new().dispatch(OnProcessor(work));
}

struct OnProcessor<W>(W);

impl<W: Vectorised> WithSimd for OnProcessor<W> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        self.0.run();
    }
}
