//! Integration of one system with error control: every step whose estimated error exceeds its tolerance is refused.
//!
//! [`Stepper`] integrates any [`Stepped`] system, with ideal joints and with contact laws that depend on their history.
//! [`super::LaneStepper`] does the same for systems without either, one per lane. The decisions about a step are those of
//! [`SpanProgress`] in both.

use super::{
    IntegrationError, Linearised, Passing, ProjectedStep, Rosenbrock, SpanProgress, State, StepControl,
    StepCounts, Stepped, nan_as_infinite, projected_step_ratio, step_ratio, worst_coordinate,
};
use crate::lanes::{Vectorised, fused};
use std::ops::Range;

/// Receives every accepted state with the linearisation there, in order of time.
pub trait StateObserver<D> {
    /// Called with the state `q`, `v` `(n,)` at time `t` [s].
    fn observe(&mut self, system: &D, t: f64, q: &[f64], v: &[f64], at: &Linearised);
}

/// Ignores every state.
impl<D> StateObserver<D> for () {
    fn observe(&mut self, _system: &D, _t: f64, _q: &[f64], _v: &[f64], _at: &Linearised) {}
}

/// Scheme, linearisation and step control of one system.
#[derive(Debug, Clone)]
pub struct Stepper {
    scheme: Rosenbrock,
    at: Linearised,
    /// Length of the steps, kept from one span to the next.
    pub control: StepControl,
    /// State before ideal joints were closed `(n,)` each.
    open_q: Vec<f64>,
    open_v: Vec<f64>,
    /// Explicit steps, and the number of those through positions of dependent constraints in this span.
    projected: ProjectedStep,
    passages: u64,
}

/// An integration over a span of time, compiled for the instructions of this processor.
struct Integration<'a, D> {
    stepper: &'a mut Stepper,
    system: &'a mut D,
    progress: &'a mut SpanProgress,
    q: &'a mut [f64],
    v: &'a mut [f64],
    observer: &'a mut dyn StateObserver<D>,
}

impl<D: Stepped> Vectorised for Integration<'_, D> {
    type Output = Result<(), IntegrationError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Integration { stepper, system, progress, q, v, observer } = self;
        stepper.integrate(system, progress, q, v, observer)
    }
}

impl Stepper {
    /// A stepper with room in `at` for the system's linearisation.
    pub fn new(at: Linearised, control: StepControl) -> Self {
        let n = at.f.len();
        Stepper {
            scheme: Rosenbrock::new(0.0, &at.band),
            open_q: vec![0.0; n],
            open_v: vec![0.0; n],
            projected: ProjectedStep::new(n),
            passages: 0,
            at,
            control,
        }
    }

    /// Integrates (`q`, `v`) `(n,)` over the span of time [s]; `observer` receives every accepted state, both ends included.
    /// Adds the work to `counts`.
    ///
    /// # Errors
    /// [`IntegrationError`]; the state is then the last accepted one.
    pub fn run<D: Stepped>(
        &mut self,
        system: &mut D,
        span: Range<f64>,
        q: &mut [f64],
        v: &mut [f64],
        observer: &mut dyn StateObserver<D>,
        counts: &mut StepCounts,
    ) -> Result<(), IntegrationError> {
        let mut progress = SpanProgress::new(span, self.control);
        self.passages = 0;
        let result = fused(Integration { stepper: self, system, progress: &mut progress, q, v, observer });
        self.control = progress.control;
        counts.add(&StepCounts { passages: self.passages, ..progress.counts() });
        result.map_err(|error| match (error, system.locked_joint()) {
            // The steps tried last led to states at which the force does not exist.
            (IntegrationError::StepTooSmall { time, .. }, Some(joint)) => {
                IntegrationError::SelfLocking { time, joint }
            }
            (error, _) => self.named(system, error),
        })
    }

    /// Adds the joint to name to an error.
    fn named<D: Stepped>(&self, system: &D, error: IntegrationError) -> IntegrationError {
        match (error, system.dependent_joint()) {
            // No length of the step passes the position.
            (IntegrationError::StepTooSmall { time, .. } | IntegrationError::Singular(time), Some(joint)) => {
                IntegrationError::Branching { time, joint }
            }
            (error, _) => error.with_joint(self.responsible_joint(system)),
        }
    }

    #[inline(always)]
    fn integrate<D: Stepped>(
        &mut self,
        system: &mut D,
        progress: &mut SpanProgress,
        q: &mut [f64],
        v: &mut [f64],
        observer: &mut dyn StateObserver<D>,
    ) -> Result<(), IntegrationError> {
        loop {
            self.linearise(system, progress, q, v)?;
            observer.observe(system, progress.time, q, v, &self.at);
            system.on_accepted(q, v, &self.at);
            if progress.is_complete() {
                return Ok(());
            }
            progress.check_bound()?;
            let refused = progress.rejected;
            loop {
                let is_first = progress.rejected == refused;
                let (h, error) = self.try_any_step(system, progress, is_first, (q, v))?;
                let ratio =
                    if system.is_projected() { projected_step_ratio(error) } else { step_ratio(error) };
                let [accepted, too_small] = progress.decide(1.0, h, error, ratio);
                if too_small > 0.0 {
                    return Err(progress.too_small(error));
                }
                if accepted > 0.0 {
                    break;
                }
            }
            q.copy_from_slice(&self.scheme.new_q);
            v.copy_from_slice(&self.scheme.new_v);
        }
    }

    /// Linearises the system at the time reached, if the state lies in the range of the model.
    #[inline(always)]
    fn linearise<D: Stepped>(
        &mut self,
        system: &mut D,
        progress: &mut SpanProgress,
        q: &[f64],
        v: &[f64],
    ) -> Result<(), IntegrationError> {
        let time = progress.time;
        system.linearise(time, q, v, &mut self.at);
        progress.forces += 1.0;
        if self.at.independent == Some(0.0) {
            return Err(IntegrationError::Singular(time));
        }
        if self.at.balanced == Some(0.0)
            && let Some(joint) = system.locked_joint()
        {
            return Err(IntegrationError::SelfLocking { time, joint });
        }
        if !self.at.f.iter().all(|f| f.is_finite()) {
            return Err(IntegrationError::NotFinite(time));
        }
        self.at.in_guides().map_err(|(guide, distance)| IntegrationError::LeftGuide {
            time,
            guide,
            distance,
        })?;
        system.in_range(&self.at).map_err(|(joint, penetration)| IntegrationError::OutOfRange {
            time,
            joint,
            penetration,
        })
    }

    /// Computes the next step, explicit if the system asks for it; its length [s] and its error over the tolerance, which is infinite if it
    /// may not pass a position in which the constraints of ideal joints are dependent.
    ///
    /// # Errors
    /// [`IntegrationError::Branching`] if the motion branches there.
    #[inline(always)]
    fn try_any_step<D: Stepped>(
        &mut self,
        system: &mut D,
        progress: &mut SpanProgress,
        is_first: bool,
        (q, v): (&[f64], &[f64]),
    ) -> Result<(f64, f64), IntegrationError> {
        let (mut h, is_projected) = (progress.next_step(), system.is_projected());
        let error = if is_projected {
            h = system.step_length(h, is_first).min(progress.end - progress.time);
            self.try_projected_step(system, progress, h, q, v)
        } else {
            self.try_step(system, progress, h, q, v)
        };
        if error > 1.0 || !system.is_constrained() {
            return Ok((h, error));
        }
        let time = progress.time;
        let from = State { time, q, v, f: Some(&self.at.f) };
        let f = is_projected.then_some(self.projected.f.as_slice());
        let to = State { time: time + h, q: &self.scheme.new_q, v: &self.scheme.new_v, f };
        match (system.passing(h, from, to), system.dependent_joint()) {
            (Passing::Clear, _) => Ok((h, error)),
            (Passing::Through, _) => {
                self.passages += 1;
                Ok((h, error))
            }
            (Passing::Branching, Some(joint)) => Err(IntegrationError::Branching { time, joint }),
            (Passing::Branching | Passing::Unclear, _) => Ok((h, f64::INFINITY)),
        }
    }

    /// Computes an explicit step of length `h` [s] whose stages and end are closed; its error over the tolerance.
    fn try_projected_step<D: Stepped>(
        &mut self,
        system: &mut D,
        progress: &mut SpanProgress,
        h: f64,
        q: &[f64],
        v: &[f64],
    ) -> f64 {
        let (t, end) = (progress.time, progress.time + h);
        progress.forces += 6.0;
        if !self.projected.step(system, &self.at.f, (t, h), (q, v), &mut self.scheme) {
            return f64::INFINITY;
        }
        let moved = self.close(system, end, &mut progress.drift);
        if !moved.is_finite() {
            return moved;
        }
        self.projected.finish(system, (end, h), &mut self.scheme);
        // No step has less error than rounding leaves.
        let attainable = (system.rounding(h) / self.control.tolerance).max(1.0);
        moved.max(self.error(system.scales())) / attainable
    }

    /// Computes a step of length `h` [s] and closes the ideal joints at its end; its error over the tolerance.
    #[inline(always)]
    fn try_step<D: Stepped>(
        &mut self,
        system: &mut D,
        progress: &mut SpanProgress,
        h: f64,
        q: &[f64],
        v: &[f64],
    ) -> f64 {
        let sound = self.scheme.step(system, &self.at, progress.time, h, q, v);
        progress.forces += 2.0;
        let mut error = if sound == 1.0 { self.error(system.scales()) } else { f64::INFINITY };
        if error <= 1.0 && system.begins_contacts() {
            let (t, end) = (progress.time + h, &self.scheme);
            let begun = system.begun(&self.at, h, t, &end.new_q, &end.new_v);
            error = error.max(nan_as_infinite(begun / self.control.tolerance));
        }
        if error <= 1.0 && system.is_constrained() {
            return error.max(self.close(system, progress.time + h, &mut progress.drift));
        }
        error
    }

    /// Closes the ideal joints at the end of the step just tried: the largest resulting change of the state, over the scales
    /// and the tolerance of the local error; infinite if the joints cannot be closed.
    #[inline(always)]
    fn close<D: Stepped>(&mut self, system: &mut D, t: f64, largest_drift: &mut f64) -> f64 {
        let s = &mut self.scheme;
        self.open_q.copy_from_slice(&s.new_q);
        self.open_v.copy_from_slice(&s.new_v);
        let Some(drift) = system.close(t, &mut s.new_q, &mut s.new_v) else { return f64::INFINITY };
        let largest_change = |new: &[f64], open: &[f64], scale: &[f64]| {
            let each =
                new.iter().zip(open).zip(scale).map(|((new, open), scale)| ((new - open) / scale).abs());
            each.fold(0.0, f64::max)
        };
        let (scale_q, scale_v) = system.scales();
        let moved = largest_change(&s.new_q, &self.open_q, scale_q).max(largest_change(
            &s.new_v,
            &self.open_v,
            scale_v,
        )) / self.control.tolerance;
        if moved <= 1.0 {
            *largest_drift = largest_drift.max(drift);
        }
        nan_as_infinite(moved)
    }

    /// The joint to name for the step tried last: that of the coordinate with the largest error.
    fn responsible_joint<D: Stepped>(&self, system: &D) -> Option<usize> {
        let errors = self.scheme.error_q.iter().copied().zip(self.scheme.error_v.iter().copied());
        let worst = worst_coordinate(errors, system.scales())?;
        system.responsible_joint(worst, &self.at)
    }

    /// Largest scaled error of the step just tried, over the tolerance; infinite if anything is not finite.
    #[inline(always)]
    fn error(&self, (scale_q, scale_v): (&[f64], &[f64])) -> f64 {
        nan_as_infinite(self.scheme.error(|i| (1.0 / scale_q[i], 1.0 / scale_v[i])) / self.control.tolerance)
    }
}
