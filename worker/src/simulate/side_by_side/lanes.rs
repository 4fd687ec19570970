//! SIMD lanes shared by several evaluations: when an island reaches its end time, the next queued island of the same
//! topology takes its lane.

use super::queue::{CpuTime, LaneQueue, PendingSpan};
use super::width::LaneWidth;
use crate::integrate::{
    IntegrationError, LaneOutcome, LaneState, LaneStepper, Linearised, SpanProgress, Stepped,
    worst_coordinate,
};
use crate::lanes::{Lanes, Vectorised, run_in};
use crate::mechanism::{Island, IslandLanes, same_topology};
use crate::outputs::{ContactLanes, FullRecording};
use crate::simulate::island_state::IslandState;
use pulp::{Simd, WithSimd};
use std::time::Instant;

/// The lane groups of one thread.
pub struct LanePool {
    width: LaneWidth,
    groups: Vec<OpenGroup>,
}

/// A group of the pool.
struct OpenGroup {
    group: Box<dyn Group>,
    /// Number of times another group was run since this one was.
    passed_over: usize,
}

/// Islands of one topology in lanes of some width.
trait Group {
    /// Number of lanes in use.
    fn occupied(&self) -> usize;
    /// Processor time of the evaluation of each island.
    fn cpu_times(&self) -> Vec<CpuTime>;
    /// Loads queued islands of this topology into the idle lanes.
    fn fill(&mut self, queue: &LaneQueue);
    /// Integrates until an island has ended; the number of those that have.
    fn run(&mut self) -> usize;
}

impl LanePool {
    /// A pool without groups.
    pub(crate) fn new(width: LaneWidth) -> Self {
        LanePool { width, groups: vec![] }
    }

    /// Loads the queued islands into lanes and runs one group until an island of it has ended, charging the time in equal shares to
    /// the evaluations in the group. Returns the number of islands that ended; zero if no island was queued.
    pub(crate) fn run_group(&mut self, queue: &LaneQueue) -> usize {
        self.load_queued(queue);
        let Some(OpenGroup { group, .. }) = next_group(&mut self.groups) else { return 0 };
        let charged = group.cpu_times();
        let begun = Instant::now();
        let ended = group.run();
        let share = begun.elapsed() / charged.len().max(1) as u32;
        charged.iter().for_each(|cpu_time| cpu_time.set(cpu_time.get() + share));
        ended
    }

    /// Fills the idle lanes of every group, and opens groups for the topologies that have none.
    fn load_queued(&mut self, queue: &LaneQueue) {
        if self.width == LaneWidth::Fitting {
            // The next group may have to be wider.
            self.groups.retain(|open| open.group.occupied() > 0);
        }
        self.groups.iter_mut().for_each(|open| open.group.fill(queue));
        while let Some(first) = queue.take(|_| true) {
            let waiting = 1 + queue.count(|span| same_topology(&first.span.state.island, &span.state.island));
            let group = self.width.for_waiting(waiting).dispatch(NewGroup(first));
            // Empty groups of other topologies make room.
            self.groups.retain(|open| open.group.occupied() > 0);
            self.groups.push(OpenGroup { group, passed_over: 0 });
            self.groups.iter_mut().for_each(|open| open.group.fill(queue));
        }
    }
}

/// Makes a group with its first island.
struct NewGroup(PendingSpan);

impl WithSimd for NewGroup {
    type Output = Box<dyn Group>;

    fn with_simd<S: Simd>(self, simd: S) -> Box<dyn Group> {
        Box::new(LaneGroup::new(simd, self.0))
    }
}

/// The group to run next: the fullest, where every time a group was passed over counts as an occupant.
fn next_group(groups: &mut [OpenGroup]) -> Option<&mut OpenGroup> {
    let mut occupied: Vec<_> = groups.iter_mut().filter(|open| open.group.occupied() > 0).collect();
    occupied.iter_mut().for_each(|open| open.passed_over += 1);
    let next = occupied.into_iter().max_by_key(|open| open.group.occupied() + open.passed_over)?;
    next.passed_over = 0;
    Some(next)
}

/// Islands of one topology, one per lane.
struct LaneGroup<S: Simd> {
    simd: S,
    /// An island of this topology.
    topology: Island,
    island_lanes: IslandLanes<Lanes<S>>,
    stepper: LaneStepper<Lanes<S>>,
    contacts: ContactLanes<Lanes<S>>,
    /// The span in each lane, `None` in idle lanes.
    occupants: Vec<Option<PendingSpan>>,
    /// Forces and state of one lane.
    at: Linearised,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// First half of a round, compiled for the instruction set of the lanes.
struct Round<'a, S: Simd>(&'a mut LaneGroup<S>);

impl<S: Simd> Vectorised for Round<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let LaneGroup { island_lanes, stepper, contacts, occupants, .. } = self.0;
        stepper.try_steps(island_lanes);
        contacts.record(stepper.time, &stepper.at, &mut |joint, lane, sample| {
            if let Some(pending) = &mut occupants[lane] {
                pending.span.state.recorder.histories[joint].add(sample);
            }
        });
    }
}

impl<S: Simd> Group for LaneGroup<S> {
    fn occupied(&self) -> usize {
        self.occupants.iter().flatten().count()
    }

    fn cpu_times(&self) -> Vec<CpuTime> {
        self.occupants.iter().flatten().map(PendingSpan::cpu_time).collect()
    }

    fn fill(&mut self, queue: &LaneQueue) {
        for lane in 0..S::F64_LANES {
            if self.occupants[lane].is_some() {
                continue;
            }
            let topology = &self.topology;
            let Some(pending) = queue.take(|span| same_topology(topology, &span.state.island)) else {
                return;
            };
            self.load(lane, pending);
        }
    }

    fn run(&mut self) -> usize {
        loop {
            run_in(self.simd, Round(self));
            let ended = self.finish_round();
            if ended > 0 {
                return ended;
            }
        }
    }
}

impl<S: Simd> LaneGroup<S> {
    /// A group with its first island; idle lanes compute steps from the same state.
    fn new(simd: S, first: PendingSpan) -> Self {
        let state = &first.span.state;
        let (topology, like) = (state.island.clone(), Lanes::all(simd, 0.0));
        let island_lanes = IslandLanes::new(&topology, like);
        let stepper = LaneStepper::new(like, island_lanes.linearised(), state.stepper.control.largest);
        let mut group = LaneGroup {
            at: topology.linearised(),
            q: state.q.clone(),
            v: state.v.clone(),
            contacts: ContactLanes::new(like, state.island.joints.len()),
            occupants: (0..S::F64_LANES).map(|_| None).collect(),
            simd,
            topology,
            island_lanes,
            stepper,
        };
        for lane in 0..S::F64_LANES {
            group.stepper.load_state(lane, &group.q, &group.v);
        }
        group.load(0, first);
        group
    }

    fn load(&mut self, lane: usize, pending: PendingSpan) {
        let state = &pending.span.state;
        self.island_lanes.set(lane, &state.island);
        self.stepper.load_state(lane, &state.q, &state.v);
        if pending.span.record {
            self.contacts.load(lane, &state.recorder, pending.span.time.start);
        }
        self.stepper.lanes[lane] = Some(LaneState::new(pending.span.time.clone(), state.stepper.control));
        self.occupants[lane] = Some(pending);
    }

    /// Second half of a round: records new states, decides about the steps tried, and returns the islands that have ended. The
    /// result is their number.
    fn finish_round(&mut self) -> usize {
        let mut ended = 0;
        for lane in 0..S::F64_LANES {
            let result = match self.check_and_record(lane).and_then(|()| self.stepper.finish_round(lane)) {
                Ok(LaneOutcome::UnderWay) => continue,
                Ok(LaneOutcome::Arrived) => Ok(()),
                Err(error) => Err(self.attribute_failure(lane, error)),
            };
            if let Some((pending, progress)) = self.unload(lane) {
                let island = &pending.span.state.island;
                match result {
                    Err(IntegrationError::Singular { time }) => {
                        pending.integrate_alone(time, progress.counts)
                    }
                    // It may lock itself, which only one island by itself finds out.
                    Err(IntegrationError::StepTooSmall { time, .. }) if island.has_friction() => {
                        pending.integrate_alone(time, progress.counts)
                    }
                    result => pending.complete(progress.counts, result),
                }
            }
            ended += 1;
        }
        ended
    }

    /// Checks the range of a new state of a lane and records its motion.
    fn check_and_record(&mut self, lane: usize) -> Result<(), IntegrationError> {
        let (Some(state), Some(pending)) = (&self.stepper.lanes[lane], &mut self.occupants[lane]) else {
            return Ok(());
        };
        if !state.is_fresh() {
            return Ok(());
        }
        let time = state.progress.time;
        if !self.stepper.has_reactions(lane) {
            return Err(IntegrationError::Singular { time });
        }
        if !self.stepper.is_finite(lane) {
            return Err(IntegrationError::NotFinite { time });
        }
        let IslandState { island, recorder, .. } = &mut pending.span.state;
        for (joint, (force, wearing)) in self.stepper.at.joints.iter().zip(&island.joints).enumerate() {
            let penetration = force.penetration.values()[lane];
            if penetration > wearing.contact.surface().deepest() {
                return Err(IntegrationError::OutOfRange { time, joint, penetration });
            }
        }
        if pending.span.record && !recorder.has_recorded(time) {
            if recorder.needs_joint_forces() {
                self.stepper.read_forces(lane, &mut self.at);
            } else {
                self.stepper.read_force(lane, &mut self.at);
            }
            self.stepper.read_state(lane, &mut self.q, &mut self.v);
            if recorder.full.as_ref().is_some_and(FullRecording::is_displayed) {
                island.set_state(time, &self.q, &self.v);
            }
            recorder.record_motion(island, time, &self.q, &self.v, &self.at);
        }
        Ok(())
    }

    /// Adds the joint with the largest error of a lane to an error of its integration.
    fn attribute_failure(&mut self, lane: usize, error: IntegrationError) -> IntegrationError {
        let Some(pending) = &self.occupants[lane] else { return error };
        self.stepper.read_forces(lane, &mut self.at);
        let island = &pending.span.state.island;
        let coordinate = worst_coordinate(self.stepper.errors(lane), island.scales());
        error.with_joint(coordinate.and_then(|coordinate| island.responsible_joint(coordinate, &self.at)))
    }

    /// Takes the island of a lane out of it, with its progress.
    fn unload(&mut self, lane: usize) -> Option<(PendingSpan, SpanProgress)> {
        let (lane_state, mut pending) = (self.stepper.lanes[lane].take()?, self.occupants[lane].take()?);
        let state = &mut pending.span.state;
        state.stepper.control = lane_state.progress.control;
        self.stepper.read_state(lane, &mut state.q, &mut state.v);
        if pending.span.record {
            self.contacts.unload(lane, &mut state.recorder);
        }
        self.island_lanes.read_memory(lane, &mut state.island);
        self.island_lanes.leave_idle(lane);
        Some((pending, lane_state.progress))
    }
}
