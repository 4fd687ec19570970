//! Runs evaluations side by side on one thread: polls each as far as it comes without motion, then runs the lanes.

use super::lanes::LanePool;
use super::queue::{CpuTime, LaneQueue};
use pulp::{Arch, Scalar, Simd, WithSimd};
use std::future::Future;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

/// Numbers that a SIMD lane group holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LaneWidth {
    /// As many as the vectors of this processor.
    Widest,
    /// At least this number, in the narrowest vectors that have as many: vectors wider than there are islands for cost time. One number takes
    /// the scalar instructions of any processor.
    Holding(usize),
    /// As many as islands of one topology wait for lanes when the group is opened: for one evaluation by itself.
    Fitting,
}

impl LaneWidth {
    /// The width of a group for this number of islands that wait.
    pub(super) fn for_waiting(self, islands: usize) -> Self {
        if self == LaneWidth::Fitting { LaneWidth::Holding(islands) } else { self }
    }

    /// Runs `work` in lanes of this width.
    pub(super) fn dispatch<W: WithSimd>(self, work: W) -> W::Output {
        match self {
            LaneWidth::Holding(..=1) => work.with_simd(Scalar::new()),
            #[cfg(target_arch = "x86_64")]
            LaneWidth::Holding(..=4) if let Some(avx2) = pulp::x86::V3::try_new() => {
                Simd::vectorize(avx2, work)
            }
            _ => Arch::new().dispatch(work),
        }
    }
}

/// Numbers in the widest vectors of this processor.
pub(crate) fn widest_lanes() -> usize {
    /// Counts the lanes that it is run in.
    struct Count;
    impl WithSimd for Count {
        type Output = usize;
        fn with_simd<S: Simd>(self, _simd: S) -> usize {
            S::F64_LANES
        }
    }
    LaneWidth::Widest.dispatch(Count)
}

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
        RunningEvaluation { cpu_time: queue.cpu_time(), stages: Box::pin(stages(queue)) }
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
    let mut pool = LanePool::new(width);
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
