//! Step control of several systems side by side, one per lane, each with steps of its own: the same scheme, bounds and
//! rules as [`super::Advance`], without ideal joints and without memory.
//!
//! All lanes try a step at once, from wherever each of them is. A lane whose step is refused tries again from the
//! same state with the next round; one that has arrived waits to be seated anew. What a lane does depends on nothing
//! but itself.

use super::{AdvanceError, AdvanceStats, Dynamics, Linearised, Rosenbrock, StepControl};
use crate::lanes::Real;

/// Who sits in a lane, and how far along it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seat {
    /// Time reached [s].
    pub time: f64,
    /// Time to reach [s].
    pub end: f64,
    /// Lengths of its steps.
    pub control: StepControl,
    /// Counts.
    pub stats: AdvanceStats,
    /// Steps of this call.
    taken: u64,
    /// Whether the state has been reached since the last round.
    fresh: bool,
    /// Length tried in this round [s].
    tried: f64,
}

impl Seat {
    /// From one time to another [s].
    pub fn new(from: f64, end: f64, control: StepControl) -> Self {
        Seat { time: from, end, control, stats: AdvanceStats::default(), taken: 0, fresh: true, tried: 0.0 }
    }

    /// Whether the state linearised in this round is one that no round before has linearised.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }
}

/// Systems with the scales of their errors.
pub trait Scaled<R: Real>: Dynamics<R> {
    /// Inverse scales of the local error, positions and velocities of each coordinate `(n,)`.
    fn inverse_scales(&self) -> &[(R, R)];
}

/// The lanes.
#[derive(Debug, Clone)]
pub struct Abreast<R> {
    scheme: Rosenbrock<R>,
    /// Linearisation at the states of this round.
    pub at: Linearised<R>,
    /// Positions `(n,)`.
    pub q: Vec<R>,
    /// Velocities `(n,)`.
    pub v: Vec<R>,
    /// Who sits where `(LANES,)`.
    pub seats: Vec<Option<Seat>>,
    /// Length of the step tried in lanes where nobody sits [s].
    idle: f64,
    /// Largest scaled error of this round, and zero times the force: not a number where that is none.
    error: R,
    force: R,
}

impl<R: Real> Abreast<R> {
    /// Empty lanes, with room in `at` for the linearisation; `idle` is a length of step that does no harm [s].
    pub fn new(like: R, at: Linearised<R>, idle: f64) -> Self {
        let n = at.f.len();
        Abreast {
            scheme: Rosenbrock::new(like, &at.band),
            at,
            q: vec![like.zero(); n],
            v: vec![like.zero(); n],
            seats: vec![None; R::LANES],
            idle,
            error: like.zero(),
            force: like.zero(),
        }
    }

    /// Puts a state into a lane.
    pub fn place(&mut self, lane: usize, q: &[f64], v: &[f64]) {
        self.q.iter_mut().zip(q).for_each(|(to, from)| to.set_lane(lane, *from));
        self.v.iter_mut().zip(v).for_each(|(to, from)| to.set_lane(lane, *from));
    }

    /// First half of a round: linearises every lane's state, and tries a step from it.
    #[inline(always)]
    pub fn attempt(&mut self, system: &mut impl Scaled<R>) {
        let like = self.error;
        let seats = &mut self.seats;
        let h = like.each(|k| match &mut seats[k] {
            Some(seat) if seat.time < seat.end => {
                seat.tried = seat.control.next(seat.end - seat.time);
                seat.tried
            }
            _ => self.idle,
        });
        let t = like.each(|k| seats[k].map_or(0.0, |seat| seat.time));
        system.linearise(t, &self.q, &self.v, &mut self.at);
        self.force = like.zero();
        for f in &self.at.f {
            self.force += *f * 0.0;
        }
        let sound = self.scheme.step(system, &self.at, t, h, &self.q, &self.v);
        // Not a number where the matrix was as good as singular.
        let inverse = system.inverse_scales();
        self.error = self.scheme.error(|i| inverse[i]) / sound;
    }

    /// Whether the force of a lane exists at the state linearised in this round.
    pub fn is_finite(&self, lane: usize) -> bool {
        self.force.lane(lane) == 0.0
    }

    /// Second half of a round for a lane: true if it has arrived, having been linearised there; else it goes on, with
    /// the step if that was good enough.
    ///
    /// # Errors
    /// [`AdvanceError`] without the joint to be blamed: the state is the last accepted one.
    pub fn settle(&mut self, lane: usize) -> Result<bool, AdvanceError> {
        let Some(seat) = &mut self.seats[lane] else { return Ok(false) };
        seat.stats.forces += 1;
        if seat.time >= seat.end {
            return Ok(true);
        }
        if seat.taken >= seat.control.bound {
            let bound = seat.control.bound;
            return Err(AdvanceError::TooManySteps { time: seat.time, bound, joint: None });
        }
        seat.stats.forces += 2;
        let error = self.error.lane(lane) / seat.control.tolerance;
        // A comparison with NaN is false: count it as infinite.
        let error = if error <= f64::MAX { error } else { f64::INFINITY };
        seat.fresh = error <= 1.0;
        if seat.fresh {
            let arrives = seat.tried == seat.end - seat.time;
            seat.time = if arrives { seat.end } else { seat.time + seat.tried };
            seat.taken += 1;
            seat.stats.steps += 1;
            seat.control.accepted(seat.tried, error);
            for (to, from) in self.q.iter_mut().zip(&self.scheme.new_q) {
                to.set_lane(lane, from.lane(lane));
            }
            for (to, from) in self.v.iter_mut().zip(&self.scheme.new_v) {
                to.set_lane(lane, from.lane(lane));
            }
            return Ok(false);
        }
        seat.stats.rejected += 1;
        if !seat.control.refused(seat.tried, error) {
            let (error, step) = (error.min(f64::MAX), seat.control.step);
            return Err(AdvanceError::StepTooSmall { time: seat.time, step, error, joint: None });
        }
        Ok(false)
    }

    /// Errors of every coordinate of the step last tried in a lane: of positions, of velocities.
    pub fn errors(&self, lane: usize) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.scheme.error_q.iter().zip(&self.scheme.error_v).map(move |(q, v)| (q.lane(lane), v.lane(lane)))
    }

    /// The state in a lane.
    pub fn state(&self, lane: usize, q: &mut [f64], v: &mut [f64]) {
        q.iter_mut().zip(&self.q).for_each(|(to, from)| *to = from.lane(lane));
        v.iter_mut().zip(&self.v).for_each(|(to, from)| *to = from.lane(lane));
    }

    /// What a round's linearisation says of a lane, without matrices.
    pub fn view(&self, lane: usize, to: &mut Linearised) {
        to.f.iter_mut().zip(&self.at.f).for_each(|(to, from)| *to = from.lane(lane));
        for (to, from) in to.joints.iter_mut().zip(&self.at.joints) {
            to.force = from.force.map(|x| x.lane(lane));
            to.torque_journal = from.torque_journal.lane(lane);
            to.torque_bushing = from.torque_bushing.lane(lane);
            to.normal = from.normal.lane(lane);
            to.direction = from.direction.map(|x| x.lane(lane));
            to.penetration = from.penetration.lane(lane);
            to.sliding = from.sliding.lane(lane);
        }
        to.e.iter_mut().zip(&self.at.e).for_each(|(to, from)| *to = from.map(|x| x.lane(lane)));
        for (to, from) in to.prescribed.iter_mut().zip(&self.at.prescribed) {
            *to = from.map(|x| x.lane(lane));
        }
    }
}
