//! Length of the time steps: as long as the local error allows, with one tolerance for the whole cycle.
//!
//! A step of length h has an estimated error e, divided by its tolerance [1]. The embedded estimate grows as h^4
//! ([`super::Rosenbrock`]), hence the next length is
//!
//! - h clamp(0.9 e^(-1/4), 0.3, 3) after an accepted step (e <= 1), at most the largest step;
//! - h clamp(0.9 e^(-1/4), 0.1, 0.5) after a refused step, h / 10 if e is not finite.
//!
//! Under `local-hertz` the error stays near its bound through the whole cycle, with some seven steps a period of the softest
//! contact vibration (6 to 9 kHz in the flapping-wing drive), though only a fifth of the cycle lets that vibration grow: its damping is
//! 2 to 6 % of critical elsewhere and falls below 1 % there, late in life. A tolerance loosened in proportion to the rate at which
//! perturbations die (from the eigenvalues of the linearised island, 40 to 100 times a cycle) saved 30 to 50 % of the steps and
//! left the wear and the early life unchanged; but it displaced the asymmetry from 48 000 cycles on by 2 to 50 % of its limit,
//! because the weakly damped part of the cycle amplifies the errors of the long steps. The tolerance is therefore constant within a cycle; early
//! cycles of a life may have a looser one (`simulate/longer_steps.rs`).
//!
//! # Source
//! Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I (1993), section II.4.

use crate::lanes::{Real, lanewise};

/// Bounds of the steps of one island, and the step to try next; in lanes those of one island each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl<R = f64> {
    /// Tolerance of the local error, in the scales of the system [1].
    pub tolerance: R,
    /// Largest step [s].
    pub largest: R,
    /// Smallest step [s].
    pub smallest: R,
    /// Bound on the accepted steps of one span, a whole number.
    pub bound: R,
    /// Step to try next [s].
    pub step: R,
}

lanewise!(numbers StepControl { tolerance, largest, smallest, bound, step });

/// First step after a start or a jump of the system, as a share of the largest step [1].
const FIRST_STEP: f64 = 1e-2;

impl StepControl {
    /// Steps between `smallest` and `largest` [s], at most `bound` accepted ones a span, with local errors up to `tolerance`.
    pub fn new(tolerance: f64, largest: f64, smallest: f64, bound: u64) -> Self {
        StepControl { tolerance, largest, smallest, bound: bound as f64, step: largest * FIRST_STEP }
    }

    /// Shortens the next step after a discontinuous change of the system, e.g. of a bore.
    pub(crate) fn after_jump(&mut self) {
        self.step = self.largest * FIRST_STEP;
    }
}

impl<R: Real> StepControl<R> {
    /// The step to try [s] if the time `left` [s] remains in the span.
    #[inline(always)]
    pub(crate) fn next(&self, left: R) -> R {
        within_remaining(self.step, left)
    }

    /// The next step after an accepted one of length `h` [s] with this [`step_ratio`]. A step cut short by the end of a span does
    /// not lengthen it.
    #[inline(always)]
    pub(crate) fn lengthened(&self, h: R, ratio: R) -> R {
        let growth = ratio.larger(h.like(0.3)).smaller(h.like(3.0));
        let next = (h * growth).smaller(self.largest);
        let shorter = R::select(growth.below(h.like(1.0)), next, self.step);
        R::select(h.below(self.step), shorter, next)
    }

    /// The next step after a refused one of length `h` [s] with this [`step_ratio`].
    #[inline(always)]
    pub(crate) fn shortened(&self, h: R, ratio: R) -> R {
        h * ratio.larger(h.like(0.1)).smaller(h.like(0.5))
    }
}

/// Ratio 0.9 e^(-1/4) of the length wanted to that of a step with the error over tolerance e = `error` [1], before its bounds; zero if e is
/// infinite.
#[inline(always)]
pub(crate) fn step_ratio<R: Real>(error: R) -> R {
    error.like(0.9) / error.larger(error.like(1e-6)).sqrt().sqrt()
}

/// Ratio 0.9 e^(-1/5) for an explicit step of fifth order, whose estimate grows as h^5, as [`step_ratio`] is for the others. (With that one, every
/// second step of a long motion was refused.)
#[inline]
pub(crate) fn projected_step_ratio(error: f64) -> f64 {
    0.9 * libm::pow(error.max(1e-6), -0.2)
}

/// `step`, or what the time `left` allows [s]: the last two steps of a span share it equally, so that no sliver remains.
#[inline(always)]
pub(crate) fn within_remaining<R: Real>(step: R, left: R) -> R {
    let shared = R::select(left.below(step * 2.0), left * 0.5, step);
    R::select(step.below(left), shared, left)
}
