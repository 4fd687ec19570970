//! Runs evaluations side by side on one thread: polls each as far as it comes without motion, then runs the lanes. Several stages of one evaluation
//! run at the same time, and their islands wait for lanes together.
//!
//! # Pool
//! The lane groups of one thread: which islands share lanes, which one is integrated by itself, and which group runs next.

use super::lanes::Group;
use super::queue::{CpuTime, LaneQueue, PendingSpan};
use super::width::LaneWidth;
use crate::integrate::StepCounts;
use crate::mechanism::same_topology;
use std::future::{Future, poll_fn};
use std::pin::Pin;
use std::rc::Rc;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

/// A running evaluation with the processor time charged to it: its own stages plus an equal share of every batch of lanes it took
/// part in.
pub struct RunningEvaluation<'a, T> {
    stages: Pin<Box<dyn Future<Output = T> + 'a>>,
    cpu_time: CpuTime,
}

impl<'a, T> RunningEvaluation<'a, T> {
    /// Starts an evaluation whose islands wait in `queue`.
    pub(crate) fn new<F: Future<Output = T> + 'a>(
        queue: &LaneQueue,
        stages: impl FnOnce(LaneQueue) -> F,
    ) -> Self {
        let queue = queue.for_another();
        RunningEvaluation { cpu_time: Rc::clone(&queue.cpu_time), stages: Box::pin(stages(queue)) }
    }

    fn poll(&mut self) -> Poll<T> {
        // No waker is needed: every evaluation is polled after each batch of lanes.
        let mut context = Context::from_waker(Waker::noop());
        let begun = Instant::now();
        let result = self.stages.as_mut().poll(&mut context);
        self.cpu_time.set(self.cpu_time.get() + begun.elapsed());
        result
    }
}

/// Runs one evaluation by itself, in lanes as wide as its islands fill, and returns its result.
pub(crate) fn run_alone<'a, T: 'a, F: Future<Output = T> + 'a>(stages: impl FnOnce(LaneQueue) -> F) -> T {
    let queue = LaneQueue::default();
    let mut evaluation = Some(RunningEvaluation::new(&queue, stages));
    let mut result = None;
    run_side_by_side(LaneWidth::Fitting, &queue, 1, &mut || evaluation.take(), &mut |_, done, _| {
        result = Some(done);
    });
    // Every evaluation that was started is run to its end.
    result.unwrap_or_else(|| unreachable!())
}

/// Runs the evaluations that `next` returns, at most `most` at a time, until it returns `None` and all have ended; `done` receives
/// each result with the number of its evaluation, counted from zero in the order of `next`, and its processor time.
pub(crate) fn run_side_by_side<'a, T>(
    width: LaneWidth,
    queue: &LaneQueue,
    most: usize,
    next: &mut dyn FnMut() -> Option<RunningEvaluation<'a, T>>,
    done: &mut dyn FnMut(usize, T, Duration),
) {
    let mut pool = LanePool { width, groups: vec![] };
    let mut running: Vec<(usize, RunningEvaluation<T>)> = vec![];
    let mut started = 0;
    loop {
        while running.len() < most
            && let Some(evaluation) = next()
        {
            running.push((started, evaluation));
            started += 1;
        }
        let before = running.len();
        running.retain_mut(|(number, evaluation)| match evaluation.poll() {
            Poll::Ready(result) => {
                done(*number, result, evaluation.cpu_time.get());
                false
            }
            Poll::Pending => true,
        });
        // An evaluation that ended makes room for another.
        if running.len() < before {
            continue;
        }
        if pool.run_group(queue) == 0 {
            return;
        }
    }
}

/// Runs the futures `stages` until all have ended; the results are in their order.
pub(crate) async fn join<'f, T, F: Future<Output = T> + 'f>(stages: impl IntoIterator<Item = F>) -> Vec<T> {
    type Stage<'f, T> = Pin<Box<dyn Future<Output = T> + 'f>>;
    let mut running: Vec<(Stage<'f, T>, Option<T>)> =
        stages.into_iter().map(|stage| (Box::pin(stage) as Stage<'f, T>, None)).collect();
    poll_fn(|context| {
        for (stage, result) in running.iter_mut().filter(|(_, result)| result.is_none()) {
            if let Poll::Ready(ended) = stage.as_mut().poll(context) {
                *result = Some(ended);
            }
        }
        if running.iter().all(|(_, result)| result.is_some()) { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
    running.into_iter().filter_map(|(_, result)| result).collect()
}

/// The lane groups of one thread.
pub struct LanePool {
    width: LaneWidth,
    /// Each with the number of times that another one was run since it was.
    groups: Vec<(Box<dyn Group>, usize)>,
}

impl LanePool {
    /// Loads the queued islands into lanes and runs one group until an island of it has ended, charging the time in equal shares to
    /// the evaluations in the group. Returns the number of islands that ended; zero if no island was queued.
    pub(crate) fn run_group(&mut self, queue: &LaneQueue) -> usize {
        let alone = self.load_queued(queue);
        if alone > 0 {
            return alone;
        }
        let Some(group) = next_group(&mut self.groups) else { return 0 };
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
            self.groups.retain(|(group, _)| group.occupied() > 0);
        }
        self.groups.iter_mut().for_each(|(group, _)| group.fill(queue));
        while let Some(first) = queue.take(|_| true) {
            let waiting = 1 + queue.count(|span| same_topology(&first.state.island, &span.state.island));
            // Empty groups of other topologies make room.
            self.groups.retain(|(group, _)| group.occupied() > 0);
            match self.width.open((waiting, first), integrate_alone) {
                Some(group) => self.groups.push((group, 0)),
                None => alone += 1,
            }
            self.groups.iter_mut().for_each(|(group, _)| group.fill(queue));
        }
        alone
    }
}

/// Integrates an island by itself, on the account of its evaluation.
fn integrate_alone(pending: PendingSpan) {
    let (cpu_time, begun, start) = (Rc::clone(&pending.cpu_time), Instant::now(), pending.time.start);
    pending.integrate_alone(start, StepCounts::default());
    cpu_time.set(cpu_time.get() + begun.elapsed());
}

/// The group to run next: the fullest, where every time a group was passed over counts as an occupant.
fn next_group(groups: &mut [(Box<dyn Group>, usize)]) -> Option<&mut dyn Group> {
    let mut occupied: Vec<_> = groups.iter_mut().filter(|(group, _)| group.occupied() > 0).collect();
    occupied.iter_mut().for_each(|(_, passed_over)| *passed_over += 1);
    let (group, passed_over) =
        occupied.into_iter().max_by_key(|(group, passed_over)| group.occupied() + passed_over)?;
    *passed_over = 0;
    Some(&mut **group)
}
