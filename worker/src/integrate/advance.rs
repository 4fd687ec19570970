//! Step control: carries an island from one time to another, refusing every step whose error estimate is above
//! its bound.

use super::{Linearised, Rosenbrock, StepControl, Stepped};
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

impl AdvanceStats {
    /// Adds the counts of another stretch.
    pub fn add(&mut self, other: &AdvanceStats) {
        self.steps += other.steps;
        self.rejected += other.rejected;
        self.forces += other.forces;
        self.drift = self.drift.max(other.drift);
    }
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
    /// Lengths of its steps.
    pub control: StepControl,
    /// State before ideal joints were closed `(n,)` each.
    open_q: Vec<f64>,
    open_v: Vec<f64>,
}

impl Advance {
    /// With room in `at` for the system's linearisation; steps between `smallest` and `largest` [s].
    pub fn new(at: Linearised, tolerance: f64, largest: f64, smallest: f64, bound: u64) -> Self {
        let n = at.f.len();
        Advance {
            scheme: Rosenbrock::new(0.0, &at.band),
            open_q: vec![0.0; n],
            open_v: vec![0.0; n],
            at,
            control: StepControl::new(tolerance, largest, smallest, bound),
        }
    }

    /// Carries (`q`, `v`) over the span of time [s]; `watch` sees every accepted state, both ends included.
    ///
    /// # Errors
    /// [`AdvanceError`]; the state is then the last accepted one.
    pub fn run<D: Stepped, W: Watch<D>>(
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
            if taken >= self.control.bound {
                let (bound, joint) = (self.control.bound, self.blamed(system));
                return Err(AdvanceError::TooManySteps { time: t, bound, joint });
            }
            loop {
                let h = self.control.next(left);
                let sound = self.scheme.step(system, &self.at, t, h, q, v);
                stats.forces += 2;
                let mut error = if sound == 1.0 { self.error(system.scales()) } else { f64::INFINITY };
                if error <= 1.0 && system.is_constrained() {
                    error = error.max(self.close(system, t + h, stats));
                }
                if error <= 1.0 {
                    q.copy_from_slice(&self.scheme.new_q);
                    v.copy_from_slice(&self.scheme.new_v);
                    t = if h == left { end } else { t + h };
                    taken += 1;
                    stats.steps += 1;
                    self.control.accepted(h, error);
                    break;
                }
                stats.rejected += 1;
                if !self.control.refused(h, error) {
                    let (error, joint, step) = (error.min(f64::MAX), self.blamed(system), self.control.step);
                    return Err(AdvanceError::StepTooSmall { time: t, step, error, joint });
                }
            }
        }
    }

    /// Closes the ideal joints at the end of the step just tried: how far that moves the state, on the scales of
    /// the local error and over the tolerance.
    fn close<D: Stepped>(&mut self, system: &mut D, t: f64, stats: &mut AdvanceStats) -> f64 {
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
            / self.control.tolerance;
        if moved <= 1.0 {
            stats.drift = stats.drift.max(drift);
        }
        // A comparison with NaN is false: count it as infinite.
        if moved <= f64::MAX { moved } else { f64::INFINITY }
    }

    /// The joint to be named for the step tried last: that of the coordinate with the largest error.
    fn blamed<D: Stepped>(&self, system: &D) -> Option<usize> {
        let errors = self.scheme.error_q.iter().copied().zip(self.scheme.error_v.iter().copied());
        let worst = worst_coordinate(errors, system.scales())?;
        system.responsible_joint(worst, &self.at)
    }

    /// Largest scaled error of the step just tried, over the tolerance; infinite if anything is not finite.
    fn error(&self, (scale_q, scale_v): (&[f64], &[f64])) -> f64 {
        let error = self.scheme.error(|i| (1.0 / scale_q[i], 1.0 / scale_v[i])) / self.control.tolerance;
        // A comparison with NaN is false: count it as infinite.
        if error <= f64::MAX { error } else { f64::INFINITY }
    }
}

/// The coordinate with the largest of these errors of position and velocity, on these scales.
pub fn worst_coordinate(
    errors: impl Iterator<Item = (f64, f64)>,
    (scale_q, scale_v): (&[f64], &[f64]),
) -> Option<usize> {
    let size = |((q, v), (scale_q, scale_v)): ((f64, f64), (&f64, &f64))| {
        let e = (q / scale_q).abs().max((v / scale_v).abs());
        if e.is_finite() { e } else { f64::INFINITY }
    };
    let sizes = errors.zip(scale_q.iter().zip(scale_v)).map(size);
    sizes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}
