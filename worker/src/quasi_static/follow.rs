//! Step control of the gaps: carries an island through the cycle on its ideal motion, refusing every step that
//! does not converge or whose error is above its bound.

use super::gap::Gap;
use super::{IdealMotion, Unsuitable};
use crate::integrate::{Linearised, Stepped, Watch};
use std::ops::Range;

/// Counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FollowStats {
    /// Accepted steps.
    pub steps: u64,
    /// Refused steps.
    pub refused: u64,
    /// Newton iterations, each an evaluation of force and derivatives.
    pub iterations: u64,
}

/// Bounds of the steps of a [`Follow`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepBounds {
    /// Largest step [s].
    pub largest: f64,
    /// Smallest step [s].
    pub smallest: f64,
    /// Most steps per call.
    pub most: u64,
}

/// One island that follows its ideal motion.
#[derive(Debug, Clone)]
pub struct Follow {
    ideal: IdealMotion,
    gap: Gap,
    /// Bound on the local error, in the system's scales [1].
    tolerance: f64,
    bounds: StepBounds,
    /// Step to try next [s].
    step: f64,
    time: f64,
}

/// Steps grow at most so much: the variable-step formula is stable below 1 + sqrt 2.
const LARGEST_GROWTH: f64 = 2.0;

impl Follow {
    /// On this ideal motion, with room in `at` for the island's linearisation; local error up to `tolerance` in its
    /// scales.
    pub fn new(ideal: IdealMotion, at: Linearised, tolerance: f64, bounds: StepBounds) -> Self {
        let gap = Gap::new(at);
        Follow { ideal, gap, tolerance, bounds, step: bounds.largest, time: 0.0 }
    }

    /// The gaps `(n,)`: coordinates minus those of the ideal mechanism.
    pub fn gaps(&self) -> &[f64] {
        self.gap.now()
    }

    /// Coordinates and their rates at the time reached `(n,)` each.
    pub fn state(&self) -> (&[f64], &[f64]) {
        (&self.gap.q, &self.gap.v)
    }

    /// Brings the gaps to rest at time `t` [s], from the gaps `start` `(n,)`, on the bores as they are.
    ///
    /// # Errors
    /// [`Unsuitable::NoRest`] if they find none.
    pub fn begin<D: Stepped>(
        &mut self,
        system: &mut D,
        t: f64,
        start: &[f64],
        stats: &mut FollowStats,
    ) -> Result<(), Unsuitable> {
        let before = self.gap.iterations;
        let found = self.gap.rest(system, &self.ideal, t, start);
        stats.iterations += self.gap.iterations - before;
        (self.time, self.step) = (t, 1e-2 * self.bounds.largest);
        if found { Ok(()) } else { Err(Unsuitable::NoRest { time: t }) }
    }

    /// Carries the gaps on to time `end` [s]; `watch` sees every accepted state, both ends included.
    ///
    /// # Errors
    /// [`Unsuitable`]: the step or the number of steps left its bounds, or a joint its contact law's range.
    pub fn run<D: Stepped, W: Watch<D>>(
        &mut self,
        system: &mut D,
        end: f64,
        watch: &mut W,
        stats: &mut FollowStats,
    ) -> Result<(), Unsuitable> {
        let before = self.gap.iterations;
        let done = self.carry(system, self.time..end, watch, stats);
        stats.iterations += self.gap.iterations - before;
        done
    }

    fn carry<D: Stepped, W: Watch<D>>(
        &mut self,
        system: &mut D,
        span: Range<f64>,
        watch: &mut W,
        stats: &mut FollowStats,
    ) -> Result<(), Unsuitable> {
        watch.state(system, self.time, &self.gap.q, &self.gap.v, &self.gap.at);
        let mut taken = 0;
        while self.time < span.end {
            let left = span.end - self.time;
            // The last two steps share what is left, so that no sliver remains.
            let h = if self.step >= left {
                left
            } else if 2.0 * self.step > left {
                0.5 * left
            } else {
                self.step
            };
            let error = if self.gap.step(system, &self.ideal, h) {
                self.gap.error(h, system.scales().0) / self.tolerance
            } else {
                f64::INFINITY
            };
            if error > 1.0 || error.is_nan() {
                stats.refused += 1;
                let shrink = if error.is_finite() { 0.9 / libm::cbrt(error) } else { 0.25 };
                self.step = h * shrink.clamp(0.1, 0.5);
                if self.step < self.bounds.smallest {
                    return Err(Unsuitable::LostHold { time: self.time, step: self.step });
                }
                continue;
            }
            self.time = if h == left { span.end } else { self.time + h };
            self.gap.accept(self.time);
            if let Err((joint, _)) = system.in_range(&self.gap.at) {
                return Err(Unsuitable::OutOfRange { time: self.time, joint });
            }
            stats.steps += 1;
            taken += 1;
            system.accepted(&self.gap.q, &self.gap.v, &self.gap.at);
            watch.state(system, self.time, &self.gap.q, &self.gap.v, &self.gap.at);
            let growth = (0.9 / libm::cbrt(error.max(1e-6))).clamp(0.3, LARGEST_GROWTH);
            if h >= self.step || growth < 1.0 {
                self.step = (h * growth).min(self.bounds.largest);
            }
            if taken >= self.bounds.most && self.time < span.end {
                return Err(Unsuitable::TooManySteps { time: self.time });
            }
        }
        Ok(())
    }
}
