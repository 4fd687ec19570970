//! The lane groups of one thread: which islands share lanes, which one is integrated by itself, and which group runs next.

use super::lanes::Group;
use super::queue::{LaneQueue, PendingSpan};
use super::width::LaneWidth;
use crate::integrate::StepCounts;
use crate::mechanism::same_topology;
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

impl LanePool {
    /// A pool without groups.
    pub(crate) fn new(width: LaneWidth) -> Self {
        LanePool { width, groups: vec![] }
    }

    /// Loads the queued islands into lanes and runs one group until an island of it has ended, charging the time in equal shares to
    /// the evaluations in the group. Returns the number of islands that ended; zero if no island was queued.
    pub(crate) fn run_group(&mut self, queue: &LaneQueue) -> usize {
        let alone = self.load_queued(queue);
        if alone > 0 {
            return alone;
        }
        let Some(OpenGroup { group, .. }) = next_group(&mut self.groups) else { return 0 };
        let charged = group.cpu_times();
        let begun = Instant::now();
        let ended = group.run();
        let share = begun.elapsed() / charged.len().max(1) as u32;
        charged.iter().for_each(|cpu_time| cpu_time.set(cpu_time.get() + share));
        ended
    }

    /// Fills the idle lanes of every group, and opens groups for the topologies that have none. Islands that are never in lanes, or the only
    /// one of their topology, are integrated by themselves; their number.
    fn load_queued(&mut self, queue: &LaneQueue) -> usize {
        let mut alone = 0;
        while let Some(pending) = queue.take(|span| span.state.island.is_alone()) {
            integrate_alone(pending);
            alone += 1;
        }
        if self.width == LaneWidth::Fitting {
            // The next group may have to be wider.
            self.groups.retain(|open| open.group.occupied() > 0);
        }
        self.groups.iter_mut().for_each(|open| open.group.fill(queue));
        while let Some(first) = queue.take(|_| true) {
            let waiting = 1 + queue.count(|span| same_topology(&first.span.state.island, &span.state.island));
            // Empty groups of other topologies make room.
            self.groups.retain(|open| open.group.occupied() > 0);
            match self.width.for_waiting(waiting).vectors() {
                Some(vectors) => self.groups.push(OpenGroup { group: vectors.open(first), passed_over: 0 }),
                None => {
                    integrate_alone(first);
                    alone += 1;
                }
            }
            self.groups.iter_mut().for_each(|open| open.group.fill(queue));
        }
        alone
    }
}

/// Integrates an island by itself, on the account of its evaluation.
fn integrate_alone(pending: PendingSpan) {
    let (cpu_time, begun, start) = (pending.cpu_time(), Instant::now(), pending.span.time.start);
    pending.integrate_alone(start, StepCounts::default());
    cpu_time.set(cpu_time.get() + begun.elapsed());
}

/// The group to run next: the fullest, where every time a group was passed over counts as an occupant.
fn next_group(groups: &mut [OpenGroup]) -> Option<&mut OpenGroup> {
    let mut occupied: Vec<_> = groups.iter_mut().filter(|open| open.group.occupied() > 0).collect();
    occupied.iter_mut().for_each(|open| open.passed_over += 1);
    let next = occupied.into_iter().max_by_key(|open| open.group.occupied() + open.passed_over)?;
    next.passed_over = 0;
    Some(next)
}
