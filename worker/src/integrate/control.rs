//! How long the next step is: as long as the local error allows, the same tolerance everywhere in the cycle.
//!
//! Under `local-hertz` the error stays near its bound through the whole cycle, with some seven steps a period of the softest
//! contact vibration (6 to 9 kHz in the flapping-wing drive), though only a fifth of the cycle lets that vibration grow: its damping is
//! 2 to 6 % of critical elsewhere and falls below 1 % there, late in life. A tolerance loosened in proportion to the rate at which
//! perturbations die (from the eigenvalues of the linearised island, 40 to 100 times a cycle) took 30 to 50 % off the steps and
//! left the wear and the early life as they were; but it displaced the asymmetry from 48 000 cycles on by 2 to 50 % of its limit:
//! what a long step leaves behind is what the weakly damped part of the cycle amplifies. So it is not done.

/// Bounds of the steps of one island, and the step to try next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl {
    /// Relative tolerance of the local error.
    pub tolerance: f64,
    /// Largest step [s].
    pub largest: f64,
    /// Smallest step [s].
    pub smallest: f64,
    /// Bound on steps per call.
    pub bound: u64,
    /// Step to try next [s].
    pub step: f64,
}

impl StepControl {
    /// Steps between `smallest` and `largest` [s], at most `bound` of them a call.
    pub fn new(tolerance: f64, largest: f64, smallest: f64, bound: u64) -> Self {
        StepControl { tolerance, largest, smallest, bound, step: largest * 1e-2 }
    }

    /// Shortens the next step, because the system has just been changed in a jump.
    pub fn after_jump(&mut self) {
        self.step = self.largest * 1e-2;
    }

    /// The step to try where so much time is `left` [s]; the last two share what is left, so that no sliver remains.
    #[inline]
    pub fn next(&self, left: f64) -> f64 {
        if self.step >= left {
            left
        } else if 2.0 * self.step > left {
            0.5 * left
        } else {
            self.step
        }
    }

    /// A step of length `h` was accepted, its error over the tolerance being `error`.
    #[inline]
    pub fn accepted(&mut self, h: f64, error: f64) {
        let growth = (0.9 / error.max(1e-6).sqrt().sqrt()).clamp(0.3, 3.0);
        if h >= self.step || growth < 1.0 {
            self.step = (h * growth).min(self.largest);
        }
    }

    /// A step of length `h` was refused; false if the next one would be too small.
    pub fn refused(&mut self, h: f64, error: f64) -> bool {
        let shrink = if error.is_finite() { (0.9 / error.sqrt().sqrt()).clamp(0.1, 0.5) } else { 0.1 };
        self.step = h * shrink;
        self.step >= self.smallest
    }
}
