//! Integration of several systems at once, one per SIMD lane, each with its own step length.
//!
//! Scheme and decisions are those of [`super::Stepper`]: [`SpanProgress`] accepts or refuses the step of every lane. One thing differs,
//! which is why there are two steppers: all lanes linearise and try a step in the same round, so that a lane whose step was
//! refused linearises the same state again. The result of a lane does not depend on the other lanes.

use super::{
    Closed, Dynamics, IntegrationError, Linearised, Rosenbrock, SpanProgress, StepControl, StepDecision,
    step_ratio,
};
use crate::lanes::Real;
use std::ops::Range;

/// The integration under way in one lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneState {
    /// Time reached, step control and counts.
    pub progress: SpanProgress,
    /// True if no earlier round has linearised the present state.
    fresh: bool,
    /// Length of the step tried in this round [s].
    tried: f64,
}

impl LaneState {
    /// The start of a span of time [s].
    pub(crate) fn new(span: Range<f64>, control: StepControl) -> Self {
        LaneState { progress: SpanProgress::new(span, control), fresh: true, tried: 0.0 }
    }

    /// True if this round is the first that linearises the present state.
    pub(crate) fn is_fresh(&self) -> bool {
        self.fresh
    }
}

/// Dynamics with what error control needs: scales and constraints.
pub trait SteppedLanes<R: Real>: Dynamics<R> {
    /// True if the systems have ideal joints, so that [`SteppedLanes::close`] changes their states.
    fn is_constrained(&self) -> bool {
        false
    }
    /// Called with the linearisation `at` of the present states, again where a step was refused: contact laws whose damping depends on the
    /// speed at impact update it here.
    fn on_accepted(&mut self, at: &Linearised<R>) {
        let _ = at;
    }
    /// Moves positions and velocities back onto the constraints of ideal joints at the times `t` [s], in lanes where `wanted` is one.
    fn close(&mut self, t: R, wanted: R, q: &mut [R], v: &mut [R]) -> Closed<R> {
        let _ = (q, v);
        Closed { drift: t.zero(), closed: wanted }
    }
    /// Inverse scales of the local error of position and velocity `(n,)` [1/m or 1/rad, s/m or s/rad].
    fn inverse_scales(&self) -> &[(R, R)];
}

/// What a round means for one lane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneOutcome {
    /// The end of the span is reached and has been linearised.
    Arrived,
    /// The lane goes on with the next round.
    UnderWay,
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
    /// Integration of each lane, `None` in idle lanes `(LANES,)`.
    pub lanes: Vec<Option<LaneState>>,
    /// Length of the step tried in idle lanes [s].
    idle: f64,
    /// Time of the states of this round, zero in idle lanes [s].
    pub time: R,
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
            lanes: vec![None; R::LANES],
            idle,
            time: like.zero(),
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

    /// First half of a round: linearises the state of every lane and tries a step from it.
    #[inline(always)]
    pub(crate) fn try_steps(&mut self, system: &mut impl SteppedLanes<R>) {
        let like = self.error;
        let lanes = &mut self.lanes;
        let h = like.each(|k| match &mut lanes[k] {
            Some(lane) if !lane.progress.is_complete() => {
                lane.tried = lane.progress.next_step();
                lane.tried
            }
            _ => self.idle,
        });
        let t = like.each(|k| lanes[k].map_or(0.0, |lane| lane.progress.time));
        let tolerance = like.each(|k| lanes[k].map_or(1.0, |lane| lane.progress.control.tolerance));
        self.time = t;
        system.linearise(t, &self.q, &self.v, &mut self.at);
        system.on_accepted(&self.at);
        self.force = like.zero();
        for f in &self.at.f {
            self.force = self.force.plus_product(*f, like.zero());
        }
        let sound = self.scheme.step(system, &self.at, t, h, &self.q, &self.v);
        // Not a number where the matrix was as good as singular.
        let inverse = system.inverse_scales();
        let error = self.scheme.error(|i| inverse[i]) / sound / tolerance;
        let infinite = error.like(f64::INFINITY);
        self.error = R::select(error.below(infinite), error, infinite);
        if system.is_constrained() {
            self.close(system, t + h, tolerance);
        }
        self.ratio = step_ratio(self.error);
    }

    /// Closes the ideal joints at the ends `t` [s] of the steps just tried, where their errors allow them: the largest resulting change of
    /// the state, over the scales and the tolerance of the local error, counts as an error too. Infinite if the joints cannot be closed.
    #[inline(always)]
    fn close(&mut self, system: &mut impl SteppedLanes<R>, t: R, tolerance: R) {
        let (zero, one) = (t.zero(), t.like(1.0));
        let lanes = &self.lanes;
        let under_way = t.each(|k| match &lanes[k] {
            Some(lane) if !lane.progress.is_complete() => 1.0,
            _ => 0.0,
        });
        let wanted = R::select(one.below(self.error), zero, under_way);
        let s = &mut self.scheme;
        self.open_q.copy_from_slice(&s.new_q);
        self.open_v.copy_from_slice(&s.new_v);
        let Closed { drift, closed } = system.close(t, wanted, &mut s.new_q, &mut s.new_v);
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

    /// True if the force of a lane exists at the state linearised in this round: the constraints of its ideal joints are independent,
    /// and their reactions balance their friction.
    pub(crate) fn has_reactions(&self, lane: usize) -> bool {
        let exist = |one: &Option<R>| one.is_none_or(|one| one.lane(lane) == 1.0);
        exist(&self.at.independent) && exist(&self.at.balanced)
    }

    /// True if the force of a lane is finite at the state linearised in this round.
    pub(crate) fn is_finite(&self, lane: usize) -> bool {
        self.force.lane(lane) == 0.0
    }

    /// Second half of a round for one lane: accepts or refuses the step tried, unless the end of the span was reached before.
    ///
    /// # Errors
    /// [`IntegrationError`] without a joint; the state is then the last accepted one.
    pub(crate) fn finish_round(&mut self, lane: usize) -> Result<LaneOutcome, IntegrationError> {
        let Some(state) = &mut self.lanes[lane] else { return Ok(LaneOutcome::UnderWay) };
        let progress = &mut state.progress;
        progress.counts.forces += 1;
        if progress.is_complete() {
            return Ok(LaneOutcome::Arrived);
        }
        progress.check_bound()?;
        progress.counts.forces += 2;
        let (error, ratio) = (self.error.lane(lane), self.ratio.lane(lane));
        state.fresh = progress.decide(state.tried, error, ratio)? == StepDecision::Accepted;
        if state.fresh {
            progress.counts.drift = progress.counts.drift.max(self.drift.lane(lane));
            for (to, from) in self.q.iter_mut().zip(&self.scheme.new_q) {
                to.set_lane(lane, from.lane(lane));
            }
            for (to, from) in self.v.iter_mut().zip(&self.scheme.new_v) {
                to.set_lane(lane, from.lane(lane));
            }
        }
        Ok(LaneOutcome::UnderWay)
    }

    /// Errors (position, velocity) of every coordinate of the step last tried in a lane.
    pub(crate) fn errors(&self, lane: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.scheme.error_q.iter().zip(&self.scheme.error_v).map(move |(q, v)| (q.lane(lane), v.lane(lane)))
    }

    /// Reads the state `(n,)` of a lane.
    pub(crate) fn read_state(&self, lane: usize, q: &mut [f64], v: &mut [f64]) {
        q.iter_mut().zip(&self.q).for_each(|(to, from)| *to = from.lane(lane));
        v.iter_mut().zip(&self.v).for_each(|(to, from)| *to = from.lane(lane));
    }

    /// Reads the generalised forces `(n,)` of a lane from the linearisation of this round.
    pub(crate) fn read_force(&self, lane: usize, to: &mut Linearised) {
        to.f.iter_mut().zip(&self.at.f).for_each(|(to, from)| *to = from.lane(lane));
    }

    /// Reads forces, eccentricities and joint states of a lane from the linearisation of this round, without the matrices.
    pub(crate) fn read_forces(&self, lane: usize, to: &mut Linearised) {
        self.read_force(lane, to);
        for (to, from) in to.joints.iter_mut().zip(&self.at.joints) {
            to.force = from.force.map(|x| x.lane(lane));
            to.torque_journal = from.torque_journal.lane(lane);
            to.torque_bushing = from.torque_bushing.lane(lane);
            to.normal = from.normal.lane(lane);
            to.direction = from.direction.map(|x| x.lane(lane));
            to.penetration = from.penetration.lane(lane);
            to.sliding = from.sliding.lane(lane);
        }
        for (to, from) in to.friction.iter_mut().zip(&self.at.friction) {
            *to = from.map(|x| x.lane(lane));
        }
        to.lambda.iter_mut().zip(&self.at.lambda).for_each(|(to, from)| *to = from.lane(lane));
        to.e.iter_mut().zip(&self.at.e).for_each(|(to, from)| *to = from.map(|x| x.lane(lane)));
        to.turns.iter_mut().zip(&self.at.turns).for_each(|(to, from)| *to = from.lane(lane));
        for (to, from) in to.prescribed.iter_mut().zip(&self.at.prescribed) {
            *to = from.map(|x| x.lane(lane));
        }
    }
}
