//! SIMD lanes shared by several evaluations: when an island reaches its end time, the next queued island of the same
//! topology takes its lane.

use super::queue::{CpuTime, LaneQueue, PendingSpan};
use crate::integrate::{IntegrationError, LaneStepper, Linearised, SpanProgress, Stepped, worst_coordinate};
use crate::lanes::{Lanes, Real, Vectorised, run_in};
use crate::mechanism::{Island, IslandLanes, same_topology};
use crate::outputs::{ContactLanes, MotionRows};
use crate::simulate::island_state::IslandState;
use pulp::Simd;
use std::rc::Rc;

/// Islands of one topology in lanes of some width.
pub(super) trait Group {
    /// Number of lanes in use.
    fn occupied(&self) -> usize;
    /// Processor time of the evaluation of each island.
    fn cpu_times(&self) -> Vec<CpuTime>;
    /// Loads queued islands of this topology into the idle lanes.
    fn fill(&mut self, queue: &LaneQueue);
    /// Integrates until an island has ended; the number of those that have.
    fn run(&mut self) -> usize;
}

/// Islands of one topology, one per lane.
pub(super) struct LaneGroup<S: Simd> {
    simd: S,
    /// An island of this topology.
    topology: Island,
    island_lanes: IslandLanes<Lanes<S>>,
    stepper: LaneStepper<Lanes<S>>,
    contacts: ContactLanes<Lanes<S>>,
    /// States of lanes whose recorders need no forces of joints.
    motion: MotionRows<Lanes<S>>,
    /// Lanes whose recorders need these forces, and read every state when it is new.
    watched: Vec<usize>,
    /// The span in each lane, `None` in idle lanes.
    occupants: Vec<Option<PendingSpan>>,
    /// Forces and state of one lane.
    at: Linearised,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// Rounds until a lane stops, compiled for the instruction set of the lanes.
impl<S: Simd> Vectorised for &mut LaneGroup<S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let group = self;
        loop {
            let LaneGroup { island_lanes, stepper, contacts, occupants, .. } = group;
            stepper.try_steps(island_lanes);
            contacts.record(stepper.progress.time, &stepper.at, &mut |joint, lane, sample| {
                if let Some(pending) = &mut occupants[lane] {
                    let history = pending.state.recorder.histories[joint].bore_mut();
                    history.into_iter().for_each(|history| history.samples.push(sample));
                }
            });
            if !group.watched.is_empty() {
                let sound = group.stepper.sound(group.island_lanes.outside(&group.stepper.at));
                group.record_watched(sound);
            }
            if group.motion.is_full() {
                group.record_rows();
            }
            group.motion.push(&group.stepper);
            let outside = group.island_lanes.outside(&group.stepper.at);
            if group.stepper.finish_round(outside) {
                return;
            }
        }
    }
}

impl<S: Simd> Group for LaneGroup<S> {
    fn occupied(&self) -> usize {
        self.occupants.iter().flatten().count()
    }

    fn cpu_times(&self) -> Vec<CpuTime> {
        self.occupants.iter().flatten().map(|pending| Rc::clone(&pending.cpu_time)).collect()
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
        run_in(self.simd, &mut *self);
        self.take_stopped()
    }
}

impl<S: Simd> LaneGroup<S> {
    /// A group with its first island; idle lanes compute steps from the same state.
    pub(super) fn new(simd: S, first: PendingSpan) -> Self {
        let state = &first.state;
        let (topology, like) = (state.island.clone(), Lanes::all(simd, 0.0));
        let island_lanes = IslandLanes::new(&topology, like);
        let stepper = LaneStepper::new(like, island_lanes.linearised(), state.stepper.control.largest);
        let mut group = LaneGroup {
            at: topology.linearised(),
            q: state.q.clone(),
            v: state.v.clone(),
            contacts: ContactLanes::new(like, state.island.joints.len()),
            motion: MotionRows::new(like, state.q.len()),
            watched: vec![],
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
        let state = &pending.state;
        self.island_lanes.set(lane, &state.island);
        self.stepper.load_state(lane, &state.q, &state.v);
        if pending.record {
            self.contacts.load(lane, &state.recorder, pending.time.start);
            if state.recorder.needs_joint_forces() {
                self.watched.push(lane);
            } else {
                self.motion.set_recorded(lane, true);
            }
        }
        self.stepper.start(lane, pending.time.clone(), state.stepper.control);
        self.occupants[lane] = Some(pending);
    }

    /// Takes the islands out of the lanes that stopped in the round just finished and returns them to their evaluations; their number.
    fn take_stopped(&mut self) -> usize {
        let mut ended = 0;
        for lane in 0..S::F64_LANES {
            let Some(outcome) = self.stepper.outcome(lane, self.deepest(lane)) else { continue };
            let result = outcome.map_err(|error| self.attribute_failure(lane, error));
            if let Some((pending, progress)) = self.unload(lane, result.is_ok()) {
                let island = &pending.state.island;
                match result {
                    Err(IntegrationError::Singular(time)) => pending.integrate_alone(time, progress.counts()),
                    // It may lock itself, which only one island by itself finds out.
                    Err(IntegrationError::StepTooSmall { time, .. }) if island.ideal.friction.count() > 0 => {
                        pending.integrate_alone(time, progress.counts())
                    }
                    result => pending.complete(progress.counts(), result),
                }
            }
            ended += 1;
        }
        ended
    }

    /// Largest penetration of every joint of a lane in the range of its contact law `(joints,)` [m].
    fn deepest(&self, lane: usize) -> impl Iterator<Item = f64> + '_ {
        self.occupants[lane].iter().flat_map(|pending| pending.state.island.deepest())
    }

    /// Records the motion of the lanes whose recorders need the forces of the joints, where their states are new and `sound` is one.
    fn record_watched(&mut self, sound: Lanes<S>) {
        for index in 0..self.watched.len() {
            let lane = self.watched[index];
            let Some(pending) = &mut self.occupants[lane] else { continue };
            let IslandState { island, recorder, .. } = &mut pending.state;
            let time = self.stepper.progress.time.lane(lane);
            if sound.lane(lane) != 1.0 || self.stepper.fresh.lane(lane) != 1.0 || recorder.has_recorded(time)
            {
                continue;
            }
            self.stepper.read_forces(lane, &mut self.at);
            self.stepper.read_state(lane, &mut self.q, &mut self.v);
            if recorder.full.as_ref().is_some_and(|full| full.displayed.is_some()) {
                island.set_state(time, &self.q, &self.v);
            }
            recorder.record_motion(island, time, &self.q, &self.v, &self.at);
        }
    }

    /// Records the motion of all other lanes since this was done last.
    fn record_rows(&mut self) {
        for lane in 0..S::F64_LANES {
            self.record_rows_of(lane);
        }
        self.motion.clear();
    }

    fn record_rows_of(&mut self, lane: usize) {
        let Some(pending) = &mut self.occupants[lane] else { return };
        let IslandState { island, recorder, .. } = &mut pending.state;
        recorder.record_rows(island, (&self.motion, lane), (&mut self.q, &mut self.v, &mut self.at));
    }

    /// Adds the joint with the largest error of a lane to an error of its integration.
    fn attribute_failure(&mut self, lane: usize, error: IntegrationError) -> IntegrationError {
        let Some(pending) = &self.occupants[lane] else { return error };
        self.stepper.read_forces(lane, &mut self.at);
        let island = &pending.state.island;
        let coordinate = worst_coordinate(self.stepper.errors(lane), island.scales());
        error.with_joint(coordinate.and_then(|coordinate| island.responsible_joint(coordinate, &self.at)))
    }

    /// Takes the island of a lane out of it, with its progress; without the state of the last round unless that is `sound`.
    fn unload(&mut self, lane: usize, sound: bool) -> Option<(PendingSpan, SpanProgress)> {
        if !sound {
            self.motion.remove_last(lane);
        }
        self.record_rows_of(lane);
        self.motion.clear_lane(lane);
        self.motion.set_recorded(lane, false);
        self.watched.retain(|watched| *watched != lane);
        let mut pending = self.occupants[lane].take()?;
        let progress = self.stepper.stop(lane);
        let state = &mut pending.state;
        state.stepper.control = progress.control;
        self.stepper.read_state(lane, &mut state.q, &mut state.v);
        if pending.record {
            self.contacts.unload(lane, &mut state.recorder);
        }
        self.island_lanes.read_memory(lane, &mut state.island);
        self.island_lanes.leave_idle(lane);
        Some((pending, progress))
    }
}
