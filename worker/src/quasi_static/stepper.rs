//! Integration of the gaps with error control: every step that does not converge or whose estimated error exceeds its tolerance
//! is refused.
//!
//! The local error of the second-order formula grows as h^3 with the step h [s]. With the error e over its tolerance [1] the
//! next length is h clamp(0.9 e^(-1/3), 0.3, 2) after an accepted step, h clamp(0.9 e^(-1/3), 0.1, 0.5) after a refused one,
//! h / 4 where Newton's method did not converge.
//!
//! # Source
//! Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I (1993), section II.4 (step length) and III.5 (bound on
//! its growth).

use super::gap_solver::{GapSolver, NotConverged};
use super::{IdealMotion, Unsuitable};
use crate::integrate::{Linearised, StateObserver, StepDecision, Stepped, within_remaining};

/// Work done in one or more spans of time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct QuasiStaticCounts {
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of refused steps.
    pub refused: u64,
    /// Newton iterations, each an evaluation of force and derivatives.
    pub iterations: u64,
}

/// Bounds of the steps of a [`QuasiStaticStepper`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepBounds {
    /// Largest step [s].
    pub largest: f64,
    /// Smallest step [s].
    pub smallest: f64,
    /// Bound on the accepted steps of one span.
    pub most: u64,
}

/// The gaps of one island on its ideal motion, with their step control.
#[derive(Debug, Clone)]
pub struct QuasiStaticStepper {
    ideal: IdealMotion,
    solver: GapSolver,
    /// Tolerance of the local error, in the system's scales [1].
    tolerance: f64,
    bounds: StepBounds,
    /// Step to try next [s].
    step: f64,
    /// Time reached [s].
    time: f64,
}

/// Largest factor from one step to the next [1]: the variable-step formula is stable below 1 + sqrt 2.
const LARGEST_GROWTH: f64 = 2.0;
/// First step after a start, as a share of the largest step [1].
const FIRST_STEP: f64 = 1e-2;

impl QuasiStaticStepper {
    /// A stepper on this ideal motion, with space in `at` for the island's linearisation and local errors up to `tolerance` in
    /// its scales [1].
    pub(crate) fn new(ideal: IdealMotion, at: Linearised, tolerance: f64, bounds: StepBounds) -> Self {
        let solver = GapSolver::new(at);
        QuasiStaticStepper { ideal, solver, tolerance, bounds, step: bounds.largest, time: 0.0 }
    }

    /// The gaps `(n,)`: coordinates minus those of the ideal mechanism [m, rad].
    pub(crate) fn gaps(&self) -> &[f64] {
        self.solver.gaps()
    }

    /// Coordinates and their rates at the time reached `(n,)` each.
    pub(crate) fn state(&self) -> (&[f64], &[f64]) {
        (&self.solver.q, &self.solver.v)
    }

    /// Starts at time `t` [s] from the equilibrium of the gaps, searched for from the gaps `start` `(n,)`.
    ///
    /// # Errors
    /// [`Unsuitable::NoRest`] if no equilibrium is found.
    pub(crate) fn start<D: Stepped>(
        &mut self,
        system: &mut D,
        t: f64,
        start: &[f64],
        counts: &mut QuasiStaticCounts,
    ) -> Result<(), Unsuitable> {
        let before = self.solver.iterations;
        let found = self.solver.solve_rest(system, &self.ideal, t, start);
        counts.iterations += self.solver.iterations - before;
        (self.time, self.step) = (t, FIRST_STEP * self.bounds.largest);
        found.map_err(|_| Unsuitable::NoRest(t))
    }

    /// Integrates the gaps to time `end` [s]; `observer` receives every accepted state, both ends included.
    ///
    /// # Errors
    /// [`Unsuitable`]: the step or the number of steps left its bounds, or a joint the range of its contact law.
    pub(crate) fn run<D: Stepped>(
        &mut self,
        system: &mut D,
        end: f64,
        observer: &mut dyn StateObserver<D>,
        counts: &mut QuasiStaticCounts,
    ) -> Result<(), Unsuitable> {
        let before = self.solver.iterations;
        let done = self.integrate(system, end, observer, counts);
        counts.iterations += self.solver.iterations - before;
        done
    }

    fn integrate<D: Stepped>(
        &mut self,
        system: &mut D,
        end: f64,
        observer: &mut dyn StateObserver<D>,
        counts: &mut QuasiStaticCounts,
    ) -> Result<(), Unsuitable> {
        observer.observe(system, self.time, &self.solver.q, &self.solver.v, &self.solver.at);
        let mut taken = 0;
        while self.time < end {
            let left = end - self.time;
            let h = within_remaining(self.step, left);
            if self.try_step(system, h) == StepDecision::Refused {
                counts.refused += 1;
                if self.step < self.bounds.smallest {
                    return Err(Unsuitable::LostHold { time: self.time, step: self.step });
                }
                continue;
            }
            self.time = if h == left { end } else { self.time + h };
            self.solver.accept(self.time);
            if let Err((joint, _)) = system.in_range(&self.solver.at) {
                return Err(Unsuitable::OutOfRange { time: self.time, joint });
            }
            counts.steps += 1;
            taken += 1;
            system.on_accepted(&self.solver.q, &self.solver.v, &self.solver.at);
            observer.observe(system, self.time, &self.solver.q, &self.solver.v, &self.solver.at);
            if taken >= self.bounds.most && self.time < end {
                return Err(Unsuitable::TooManySteps(self.time));
            }
        }
        Ok(())
    }

    /// Computes a step of length `h` [s], accepts or refuses it, and sets the length of the next one.
    fn try_step<D: Stepped>(&mut self, system: &mut D, h: f64) -> StepDecision {
        let error = match self.solver.try_step(system, &self.ideal, h) {
            Ok(()) => self.solver.estimate_error(h, system.scales().0) / self.tolerance,
            Err(NotConverged) => f64::INFINITY,
        };
        if error <= 1.0 {
            let growth = (0.9 / libm::cbrt(error.max(1e-6))).clamp(0.3, LARGEST_GROWTH);
            if h >= self.step || growth < 1.0 {
                self.step = (h * growth).min(self.bounds.largest);
            }
            return StepDecision::Accepted;
        }
        let shrink = if error.is_finite() { 0.9 / libm::cbrt(error) } else { 0.25 };
        self.step = h * shrink.clamp(0.1, 0.5);
        StepDecision::Refused
    }
}
