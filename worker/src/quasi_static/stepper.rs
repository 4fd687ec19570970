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

use super::gap_solver::GapSolver;
use super::{IdealMotion, Unsuitable};
use crate::integrate::{Linearised, StateObserver, StepControl, StepCounts, Stepped};

/// The gaps of one island on its ideal motion, with their step control.
#[derive(Debug, Clone)]
pub struct QuasiStaticStepper {
    ideal: IdealMotion,
    pub(crate) solver: GapSolver,
    control: StepControl,
    /// Time reached [s].
    time: f64,
}

/// Largest factor from one step to the next [1]: the variable-step formula is stable below 1 + sqrt 2.
const LARGEST_GROWTH: f64 = 2.0;

impl QuasiStaticStepper {
    /// A stepper on this ideal motion, with space in `at` for the island's linearisation.
    pub(crate) fn new(ideal: IdealMotion, at: Linearised, control: StepControl) -> Self {
        QuasiStaticStepper { ideal, solver: GapSolver::new(at), control, time: 0.0 }
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
        counts: &mut StepCounts,
    ) -> Result<(), Unsuitable> {
        let before = self.solver.iterations;
        let found = self.solver.solve_rest(system, &self.ideal, t, start);
        counts.forces += self.solver.iterations - before;
        self.time = t;
        self.control.after_jump();
        found.ok_or(Unsuitable::NoRest(t))
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
        counts: &mut StepCounts,
    ) -> Result<(), Unsuitable> {
        let before = self.solver.iterations;
        let done = self.integrate(system, end, observer, counts);
        counts.forces += self.solver.iterations - before;
        done
    }

    fn integrate<D: Stepped>(
        &mut self,
        system: &mut D,
        end: f64,
        observer: &mut dyn StateObserver<D>,
        counts: &mut StepCounts,
    ) -> Result<(), Unsuitable> {
        observer.observe(system, self.time, &self.solver.q, &self.solver.v, &self.solver.at);
        let mut taken = 0.0;
        while self.time < end {
            let left = end - self.time;
            let h = self.control.next(left);
            if !self.try_step(system, h) {
                counts.rejected += 1;
                if self.control.step < self.control.smallest {
                    return Err(Unsuitable::LostHold { time: self.time, step: self.control.step });
                }
                continue;
            }
            self.time = if h == left { end } else { self.time + h };
            self.solver.accept(self.time);
            if let Err((joint, _)) = system.in_range(&self.solver.at) {
                return Err(Unsuitable::OutOfRange { time: self.time, joint });
            }
            counts.steps += 1;
            taken += 1.0;
            system.on_accepted(&self.solver.q, &self.solver.v, &self.solver.at);
            observer.observe(system, self.time, &self.solver.q, &self.solver.v, &self.solver.at);
            if taken >= self.control.bound && self.time < end {
                return Err(Unsuitable::TooManySteps(self.time));
            }
        }
        Ok(())
    }

    /// Computes a step of length `h` [s], and sets the length of the next one; true if it is accepted.
    fn try_step<D: Stepped>(&mut self, system: &mut D, h: f64) -> bool {
        let error = match self.solver.try_step(system, &self.ideal, h) {
            Some(()) => self.solver.estimate_error(h, system.scales().0) / self.control.tolerance,
            None => f64::INFINITY,
        };
        if error <= 1.0 {
            let growth = (0.9 / libm::cbrt(error.max(1e-6))).clamp(0.3, LARGEST_GROWTH);
            if h >= self.control.step || growth < 1.0 {
                self.control.step = (h * growth).min(self.control.largest);
            }
            return true;
        }
        let shrink = if error.is_finite() { 0.9 / libm::cbrt(error) } else { 0.25 };
        self.control.step = h * shrink.clamp(0.1, 0.5);
        false
    }
}
