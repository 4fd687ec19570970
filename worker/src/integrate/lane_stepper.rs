//! Integration of several systems at once, one per SIMD lane, each with its own step length.
//!
//! Scheme and decisions are those of [`super::Stepper`]: [`SpanProgress`] accepts or refuses the step of every lane. One thing differs,
//! which is why there are two steppers: all lanes linearise and try a step in the same round, so that a lane whose step was
//! refused linearises the same state again. The result of a lane does not depend on the other lanes.

use super::{Dynamics, IntegrationError, Linearised, Rosenbrock, SpanProgress, StepControl, step_ratio};
use crate::lanes::{InLane, Lanewise, Real, read_lane};
use std::ops::Range;

/// Dynamics with what error control needs: scales and constraints.
pub trait SteppedLanes<R: Real>: Dynamics<R> {
    /// True if the systems have ideal joints, so that [`SteppedLanes::close`] changes their states.
    fn is_constrained(&self) -> bool;
    /// True if the systems have contacts whose beginning within a step counts as an error, see [`SteppedLanes::begun`].
    fn begins_contacts(&self) -> bool;
    /// Error of the steps of length `h` [s] that led from the states linearised as `before` to (`t`, `q`, `v`), in the scales of the systems [1],
    /// because of contacts that began within them: the scheme may not have met their force.
    fn begun(&mut self, before: &Linearised<R>, h: R, t: R, q: &[R], v: &[R]) -> R;
    /// Called with the linearisation `at` of the present states, again where a step was refused: contact laws whose damping depends on the
    /// speed at impact update it here.
    fn on_accepted(&mut self, at: &Linearised<R>);
    /// Moves positions and velocities back onto the constraints of ideal joints at the times `t` [s], in lanes where `wanted` is one.
    fn close(&mut self, t: R, wanted: R, q: &mut [R], v: &mut [R]) -> [R; 2];
    /// Inverse scales of the local error of position and velocity `(n,)` [1/m or 1/rad, s/m or s/rad].
    fn inverse_scales(&self) -> &[(R, R)];
}

/// Scheme, states and step control of all lanes.
#[derive(Debug, Clone)]
pub struct LaneStepper<R> {
    scheme: Rosenbrock<R>,
    /// Linearisation at the states of this round.
    pub at: Linearised<R>,
    /// Positions `(n,)` [m, rad].
    pub q: Vec<R>,
    /// Velocities `(n,)` [m/s, rad/s].
    pub v: Vec<R>,
    /// Time reached, step control and counts of each lane; the span of an idle lane is empty.
    pub(crate) progress: SpanProgress<R>,
    /// One in lanes with a system, zero in idle ones.
    busy: R,
    /// One in busy lanes whose present state no earlier round has linearised, else zero.
    pub fresh: R,
    /// One in lanes for which the last round was the last one, see [`Self::outcome`], else zero.
    stopped: R,
    /// Length of the step tried in this round, and in lanes at the end of their spans [s].
    tried: R,
    idle: R,
    /// Error over tolerance of the step of this round [1]; infinite if the step has none.
    error: R,
    /// Ratio of the length wanted to that of this step [1].
    ratio: R,
    /// Zero times the force: not a number where the force is not finite.
    force: R,
    /// Largest distance by which an ideal joint drifted open in the step of this round [m].
    drift: R,
    /// State before ideal joints were closed `(n,)` each.
    open_q: Vec<R>,
    open_v: Vec<R>,
}

impl<R: Real> LaneStepper<R> {
    /// Idle lanes, with room in `at` for the linearisation; idle lanes compute steps of length `idle` [s].
    pub(crate) fn new(like: R, at: Linearised<R>, idle: f64) -> Self {
        let n = at.f.len();
        LaneStepper {
            scheme: Rosenbrock::new(like, &at.band),
            at,
            q: vec![like.zero(); n],
            v: vec![like.zero(); n],
            progress: SpanProgress::new(0.0..0.0, StepControl::new(1.0, idle, idle, 0)).in_lanes(like),
            busy: like.zero(),
            fresh: like.zero(),
            stopped: like.zero(),
            tried: like.like(idle),
            idle: like.like(idle),
            error: like.zero(),
            ratio: like.zero(),
            force: like.zero(),
            drift: like.zero(),
            open_q: vec![like.zero(); n],
            open_v: vec![like.zero(); n],
        }
    }

    /// Writes a state `(n,)` into a lane.
    pub(crate) fn load_state(&mut self, lane: usize, q: &[f64], v: &[f64]) {
        self.q.iter_mut().zip(q).for_each(|(to, from)| to.set_lane(lane, *from));
        self.v.iter_mut().zip(v).for_each(|(to, from)| to.set_lane(lane, *from));
    }

    /// Starts the integration of a lane from its state over a span of time [s].
    pub(crate) fn start(&mut self, lane: usize, span: Range<f64>, control: StepControl) {
        SpanProgress::new(span, control).write_lane::<R>(lane, &mut self.progress);
        self.busy.set_lane(lane, 1.0);
        self.fresh.set_lane(lane, 1.0);
        self.stopped.set_lane(lane, 0.0);
    }

    /// Leaves a lane idle, and returns its progress.
    pub(crate) fn stop(&mut self, lane: usize) -> SpanProgress {
        let progress = self.progress.in_lane(lane);
        SpanProgress { end: progress.time, ..progress }.write_lane::<R>(lane, &mut self.progress);
        for flag in [&mut self.busy, &mut self.fresh, &mut self.stopped] {
            flag.set_lane(lane, 0.0);
        }
        progress
    }

    /// First half of a round: linearises the state of every lane and tries a step from it.
    #[inline(always)]
    pub(crate) fn try_steps(&mut self, system: &mut impl SteppedLanes<R>) {
        let like = self.error;
        let (t, tolerance) = (self.progress.time, self.progress.control.tolerance);
        let under_way = t.below(self.progress.end);
        let h = R::select(under_way, self.progress.next_step(), self.idle);
        self.tried = h;
        system.linearise(t, &self.q, &self.v, &mut self.at);
        system.on_accepted(&self.at);
        self.force = like.zero();
        for f in &self.at.f {
            self.force = self.force.plus_product(*f, like.zero());
        }
        let sound = self.scheme.step(system, &self.at, t, h, &self.q, &self.v);
        let inverse = system.inverse_scales();
        let error = self.scheme.error(|i| inverse[i]) / tolerance;
        // Where the matrix was as good as singular the step has no error.
        let infinite = error.like(f64::INFINITY);
        let exists = R::both(error.below(infinite), infinite.zero().below(sound));
        self.error = R::select(exists, error, infinite);
        if system.begins_contacts() {
            let begun = system.begun(&self.at, h, t + h, &self.scheme.new_q, &self.scheme.new_v) / tolerance;
            let begun = R::select(begun.below(infinite), begun, infinite);
            self.error = R::select(error.like(1.0).below(self.error), self.error, self.error.larger(begun));
        }
        if system.is_constrained() {
            let under_way = R::select(under_way, like.like(1.0), like.zero());
            self.close(system, t + h, tolerance, under_way);
        }
        self.ratio = step_ratio(self.error);
    }

    /// Closes the ideal joints at the ends `t` [s] of the steps just tried, where their errors allow them: the largest resulting change of
    /// the state, over the scales and the tolerance of the local error, counts as an error too. Infinite if the joints cannot be closed.
    /// `under_way` is one in lanes before the end of their spans.
    #[inline(always)]
    fn close(&mut self, system: &mut impl SteppedLanes<R>, t: R, tolerance: R, under_way: R) {
        let (zero, one) = (t.zero(), t.like(1.0));
        let wanted = R::select(one.below(self.error), zero, under_way);
        let s = &mut self.scheme;
        self.open_q.copy_from_slice(&s.new_q);
        self.open_v.copy_from_slice(&s.new_v);
        let [drift, closed] = system.close(t, wanted, &mut s.new_q, &mut s.new_v);
        let mut moved = zero;
        for (i, &(inverse_q, inverse_v)) in system.inverse_scales().iter().enumerate() {
            moved = moved.larger((s.new_q[i] - self.open_q[i]).abs() * inverse_q);
            moved = moved.larger((s.new_v[i] - self.open_v[i]).abs() * inverse_v);
        }
        let infinite = t.like(f64::INFINITY);
        let moved = moved / tolerance;
        let moved = R::select(moved.below(infinite), moved, infinite);
        let moved = R::select(zero.below(closed), moved, infinite);
        self.error = R::select(zero.below(wanted), self.error.larger(moved), self.error);
        self.drift = drift;
    }

    /// One in lanes whose state has a finite force and is not `outside` the range of the model (one there, else zero), else zero.
    #[inline(always)]
    pub(crate) fn sound(&self, outside: R) -> R {
        let (zero, one) = (outside.zero(), outside.like(1.0));
        let existing = self.at.independent.unwrap_or(one) * self.at.balanced.unwrap_or(one);
        // Zero or not a number, of which only zero is below one.
        let finite = R::select(self.force.below(one), existing, zero);
        R::select(zero.below(outside), zero, finite)
    }

    /// Second half of a round: accepts or refuses the step tried in every lane, unless the end of its span was reached before or its
    /// state has no force or is `outside` the range of the model (one there, else zero). True if a lane stopped, for a reason that
    /// [`Self::outcome`] tells.
    #[inline(always)]
    pub(crate) fn finish_round(&mut self, outside: R) -> bool {
        let (zero, one) = (outside.zero(), outside.like(1.0));
        let SpanProgress { time, end, steps, control, .. } = self.progress;
        let entered = R::select(zero.below(self.fresh), self.sound(outside), one);
        let entered = R::select(zero.below(self.busy), entered, zero);
        let under_way = R::select(time.below(end), entered, zero);
        let tried = R::select(steps.below(control.bound), under_way, zero);
        self.progress.forces = self.progress.forces.plus_product(tried, one + one) + entered * self.fresh;
        let [accepted, too_small] = self.progress.decide(tried, self.tried, self.error, self.ratio);
        let is_accepted = zero.below(accepted);
        for i in 0..self.q.len() {
            self.q[i] = R::select(is_accepted, self.scheme.new_q[i], self.q[i]);
            self.v[i] = R::select(is_accepted, self.scheme.new_v[i], self.v[i]);
        }
        let drift = self.progress.drift.larger(self.drift);
        self.progress.drift = R::select(is_accepted, drift, self.progress.drift);
        self.fresh = R::select(zero.below(tried), accepted, self.fresh);
        self.stopped = self.busy - tried + too_small;
        R::any(zero.below(self.stopped))
    }

    /// How the integration of a lane ended in the round just finished, if it did not go on; `deepest` is the largest penetration of each
    /// of its joints in the range of the model `(joints,)` [m].
    ///
    /// The error is an [`IntegrationError`] without the joint with the largest error.
    pub(crate) fn outcome(
        &self,
        lane: usize,
        deepest: impl Iterator<Item = f64>,
    ) -> Option<Result<(), IntegrationError>> {
        if self.stopped.lane(lane) == 0.0 {
            return None;
        }
        let progress = self.progress.in_lane(lane);
        let entered = if self.fresh.lane(lane) == 1.0 { self.check(lane, deepest) } else { Ok(()) };
        let ended = entered.and_then(|()| {
            if progress.is_complete() {
                return Ok(());
            }
            progress.check_bound()?;
            Err(progress.too_small(self.error.lane(lane)))
        });
        Some(ended)
    }

    /// Checks the state linearised in this round in a lane: its force exists and is finite, and no joint is deeper than `deepest`
    /// `(joints,)` [m].
    ///
    /// # Errors
    /// [`IntegrationError`] with the joint that left the range.
    fn check(&self, lane: usize, deepest: impl Iterator<Item = f64>) -> Result<(), IntegrationError> {
        let time = self.progress.time.lane(lane);
        let missing = |exists: &Option<R>| exists.is_some_and(|exists| exists.lane(lane) != 1.0);
        if missing(&self.at.independent) || missing(&self.at.balanced) {
            return Err(IntegrationError::Singular(time));
        }
        if self.force.lane(lane) != 0.0 {
            return Err(IntegrationError::NotFinite(time));
        }
        for (guide, now) in self.at.guides.iter().enumerate() {
            let distance = now.beyond.lane(lane);
            if distance > 0.0 {
                return Err(IntegrationError::LeftGuide { time, guide, distance });
            }
        }
        for (joint, (penetration, deepest)) in self.at.penetrations().zip(deepest).enumerate() {
            let penetration = penetration.lane(lane);
            if penetration > deepest {
                return Err(IntegrationError::OutOfRange { time, joint, penetration });
            }
        }
        Ok(())
    }

    /// Errors (position, velocity) of every coordinate of the step last tried in a lane.
    pub(crate) fn errors(&self, lane: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.scheme.error_q.iter().zip(&self.scheme.error_v).map(move |(q, v)| (q.lane(lane), v.lane(lane)))
    }

    /// Reads the state `(n,)` of a lane.
    pub(crate) fn read_state(&self, lane: usize, q: &mut [f64], v: &mut [f64]) {
        read_lane(&self.q, lane, q);
        read_lane(&self.v, lane, v);
    }

    /// Reads forces, eccentricities and joint states of a lane from the linearisation of this round, without the matrices.
    pub(crate) fn read_forces(&self, lane: usize, to: &mut Linearised) {
        read_lane(&self.at.f, lane, &mut to.f);
        read_lane(&self.at.joints, lane, &mut to.joints);
        read_lane(&self.at.friction, lane, &mut to.friction);
        read_lane(&self.at.guides, lane, &mut to.guides);
        read_lane(&self.at.lambda, lane, &mut to.lambda);
        read_lane(&self.at.e, lane, &mut to.e);
        read_lane(&self.at.turns, lane, &mut to.turns);
        read_lane(&self.at.prescribed, lane, &mut to.prescribed);
    }
}
