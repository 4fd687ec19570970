//! Step control: carries an island from one time to another, refusing every step whose error estimate is above
//! its bound.

use super::{Dynamics, Linearised, Rosenbrock};
use std::ops::Range;

/// Sees every accepted state, with the linearisation there, in order of time.
pub trait Watch<D> {
    /// Takes notice of the state at time `t` [s].
    fn state(&mut self, system: &D, t: f64, q: &[f64], v: &[f64], at: &Linearised);
}

/// Watches nothing.
impl<D> Watch<D> for () {
    fn state(&mut self, _system: &D, _t: f64, _q: &[f64], _v: &[f64], _at: &Linearised) {}
}

/// Counts.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AdvanceStats {
    /// Accepted steps.
    pub steps: u64,
    /// Refused steps.
    pub rejected: u64,
    /// Evaluations of the force.
    pub forces: u64,
    /// Largest distance by which an ideal joint drifted open in one step, before it was closed again [m].
    pub drift: f64,
}

/// Why the island could not be carried on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AdvanceError {
    /// The step fell below its bound.
    StepTooSmall {
        /// Time [s].
        time: f64,
        /// Step [s].
        step: f64,
        /// Error over its bound, finite.
        error: f64,
        /// Joint of the island.
        joint: Option<usize>,
    },
    /// Too many steps.
    TooManySteps {
        /// Time [s].
        time: f64,
        /// Bound on steps.
        bound: u64,
        /// Joint of the island.
        joint: Option<usize>,
    },
    /// A joint left the range of its contact law.
    OutOfRange {
        /// Time [s].
        time: f64,
        /// Joint of the island.
        joint: usize,
        /// Penetration [m].
        penetration: f64,
    },
    /// The ideal joints' directions became dependent.
    Singular {
        /// Time [s].
        time: f64,
    },
    /// The state is not finite.
    NotFinite {
        /// Time [s].
        time: f64,
    },
}

/// One island under way: scheme, linearisation, step.
#[derive(Debug, Clone)]
pub struct Advance {
    scheme: Rosenbrock,
    at: Linearised,
    /// Relative tolerance of the local error.
    tolerance: f64,
    /// Largest step [s].
    largest: f64,
    /// Smallest step [s].
    smallest: f64,
    /// Bound on steps per call.
    bound: u64,
    /// Step to try next [s].
    step: f64,
    /// State before ideal joints were closed `(n,)` each.
    open_q: Vec<f64>,
    open_v: Vec<f64>,
}

impl Advance {
    /// With room in `at` for the system's linearisation; steps between `smallest` and `largest` [s].
    pub fn new(at: Linearised, tolerance: f64, largest: f64, smallest: f64, bound: u64) -> Self {
        let n = at.f.len();
        Advance {
            scheme: Rosenbrock::new(n),
            open_q: vec![0.0; n],
            open_v: vec![0.0; n],
            at,
            tolerance,
            largest,
            smallest,
            bound,
            step: largest * 1e-2,
        }
    }

    /// Shortens the next step, because the system has just been changed in a jump.
    pub fn after_jump(&mut self) {
        self.step = self.largest * 1e-2;
    }

    /// Carries (`q`, `v`) over the span of time [s]; `watch` sees every accepted state, both ends included.
    ///
    /// # Errors
    /// [`AdvanceError`]; the state is then the last accepted one.
    pub fn run<D: Dynamics, W: Watch<D>>(
        &mut self,
        system: &mut D,
        span: Range<f64>,
        q: &mut [f64],
        v: &mut [f64],
        watch: &mut W,
        stats: &mut AdvanceStats,
    ) -> Result<(), AdvanceError> {
        let Range { start: mut t, end } = span;
        let mut taken = 0;
        loop {
            system.linearise(t, q, v, &mut self.at);
            stats.forces += 1;
            if self.at.singular {
                return Err(AdvanceError::Singular { time: t });
            }
            if !self.at.f.iter().all(|f| f.is_finite()) {
                return Err(AdvanceError::NotFinite { time: t });
            }
            if let Err((joint, penetration)) = system.in_range(&self.at) {
                return Err(AdvanceError::OutOfRange { time: t, joint, penetration });
            }
            watch.state(system, t, q, v, &self.at);
            system.accepted(q, v, &self.at);
            let left = end - t;
            if left <= 0.0 {
                return Ok(());
            }
            if taken >= self.bound {
                let (bound, joint) = (self.bound, self.blamed(system));
                return Err(AdvanceError::TooManySteps { time: t, bound, joint });
            }
            loop {
                // The last two steps share what is left, so that no sliver remains.
                let h = if self.step >= left {
                    left
                } else if 2.0 * self.step > left {
                    0.5 * left
                } else {
                    self.step
                };
                let solved = self.scheme.step(system, &self.at, t, h, q, v);
                stats.forces += 2;
                let mut error = if solved { self.error(system.scales()) } else { f64::INFINITY };
                if error <= 1.0 && system.is_constrained() {
                    error = error.max(self.close(system, t + h, stats));
                }
                if error <= 1.0 {
                    q.copy_from_slice(&self.scheme.new_q);
                    v.copy_from_slice(&self.scheme.new_v);
                    t = if h == left { end } else { t + h };
                    taken += 1;
                    stats.steps += 1;
                    let growth = (0.9 * libm::pow(error.max(1e-6), -0.25)).clamp(0.3, 3.0);
                    if h >= self.step || growth < 1.0 {
                        self.step = (h * growth).min(self.largest);
                    }
                    break;
                }
                stats.rejected += 1;
                let shrink =
                    if error.is_finite() { (0.9 * libm::pow(error, -0.25)).clamp(0.1, 0.5) } else { 0.1 };
                self.step = h * shrink;
                if self.step < self.smallest {
                    let error = error.min(f64::MAX);
                    let joint = self.blamed(system);
                    return Err(AdvanceError::StepTooSmall { time: t, step: self.step, error, joint });
                }
            }
        }
    }

    /// Closes the ideal joints at the end of the step just tried: how far that moves the state, on the scales of
    /// the local error and over the tolerance.
    fn close<D: Dynamics>(&mut self, system: &mut D, t: f64, stats: &mut AdvanceStats) -> f64 {
        let s = &mut self.scheme;
        self.open_q.copy_from_slice(&s.new_q);
        self.open_v.copy_from_slice(&s.new_v);
        let Some(drift) = system.close(t, &mut s.new_q, &mut s.new_v) else { return f64::INFINITY };
        let moved = |new: &[f64], open: &[f64], scale: &[f64]| {
            let each =
                new.iter().zip(open).zip(scale).map(|((new, open), scale)| ((new - open) / scale).abs());
            each.fold(0.0, f64::max)
        };
        let (scale_q, scale_v) = system.scales();
        let moved = moved(&s.new_q, &self.open_q, scale_q).max(moved(&s.new_v, &self.open_v, scale_v))
            / self.tolerance;
        if moved <= 1.0 {
            stats.drift = stats.drift.max(drift);
        }
        // A comparison with NaN is false: count it as infinite.
        if moved <= f64::MAX { moved } else { f64::INFINITY }
    }

    /// The joint to be named for the step tried last: that of the coordinate with the largest error.
    fn blamed<D: Dynamics>(&self, system: &D) -> Option<usize> {
        let (scale_q, scale_v) = system.scales();
        let size = |i: usize| {
            let e =
                (self.scheme.error_q[i] / scale_q[i]).abs().max((self.scheme.error_v[i] / scale_v[i]).abs());
            if e.is_finite() { e } else { f64::INFINITY }
        };
        let worst = (0..scale_q.len()).max_by(|&a, &b| size(a).total_cmp(&size(b)))?;
        system.blamed(worst, &self.at)
    }

    /// Largest scaled error of the step just tried, over the tolerance; infinite if anything is not finite.
    fn error(&self, (scale_q, scale_v): (&[f64], &[f64])) -> f64 {
        let s = &self.scheme;
        let mut worst: f64 = 0.0;
        for i in 0..scale_q.len() {
            let e = (s.error_q[i] / scale_q[i]).abs().max((s.error_v[i] / scale_v[i]).abs());
            // A comparison with NaN is false: count it as infinite.
            worst = if e <= f64::MAX { worst.max(e) } else { f64::INFINITY };
            if !(s.new_q[i].is_finite() && s.new_v[i].is_finite()) {
                worst = f64::INFINITY;
            }
        }
        worst / self.tolerance
    }
}
