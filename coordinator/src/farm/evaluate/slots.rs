//! Evaluates requests on a fixed number of slots of an external simulator, one thread each. A slot keeps its state between
//! batches, e.g. a running process, and polls the stop signal while it waits.

use super::queue::{CloseAtEnd, Queue};
use super::{EvaluateError, Evaluator, Finished, PendingRequests, RequestSource};
use common::external::{Slot, StopSignal};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Instant;

/// Evaluator with one thread per slot.
#[derive(Debug)]
pub struct SlotEvaluator<S> {
    slots: Vec<S>,
    interrupted: Arc<AtomicBool>,
}

impl<S: Slot> SlotEvaluator<S> {
    /// An evaluator with these slots. A run ends with [`EvaluateError::Interrupted`] when `interrupted` becomes true.
    pub fn new(slots: Vec<S>, interrupted: Arc<AtomicBool>) -> Self {
        Self { slots, interrupted }
    }
}

impl<S: Slot> Evaluator for SlotEvaluator<S> {
    fn concurrency(&self) -> u32 {
        self.slots.len() as u32
    }

    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let batch_ended = Arc::new(AtomicBool::new(false));
        let stop = StopSignal::new([Arc::clone(&self.interrupted), Arc::clone(&batch_ended)]);
        let queue = Queue::default();
        let (sender, outcomes) = channel();
        std::thread::scope(|scope| {
            for slot in &mut self.slots {
                let (sender, queue, stop) = (sender.clone(), &queue, &stop);
                scope.spawn(move || {
                    let _closed = CloseAtEnd(queue);
                    while !stop.is_set()
                        && let Some(request) = queue.take()
                    {
                        let started = Instant::now();
                        let outcome = slot.evaluate(request.id, &request.sample, stop);
                        let wall = started.elapsed().as_secs_f64();
                        let finished =
                            |outcome| Finished { id: request.id, outcome, worker: slot.name(), wall };
                        if sender.send(outcome.map(finished).map_err(EvaluateError::from)).is_err() {
                            return;
                        }
                    }
                });
            }
            drop(sender);
            // The threads end on every path out of this scope.
            let _closed = CloseAtEnd(&queue);
            let collected = collect(source, &queue, &outcomes, &stop);
            batch_ended.store(true, Ordering::Relaxed);
            collected
        })
    }
}

/// Queues requests and records outcomes until the source is exhausted and nothing is running.
fn collect(
    source: &mut dyn RequestSource,
    queue: &Queue,
    outcomes: &Receiver<Result<Finished, EvaluateError>>,
    stop: &StopSignal,
) -> Result<(), EvaluateError> {
    let (mut pending, mut open) = (PendingRequests::default(), 0);
    loop {
        let requests = pending.drain(source)?;
        open += requests.len();
        queue.add(requests);
        if open == 0 && pending.is_exhausted() {
            return Ok(());
        }
        if stop.is_set() {
            return Err(EvaluateError::Interrupted);
        }
        match outcomes.recv_timeout(super::POLL_INTERVAL) {
            Ok(finished) => {
                source.record(finished?)?;
                open -= 1;
            }
            Err(RecvTimeoutError::Timeout) => {}
            // The slots end when the stop signal is set; a panic of a thread is reported by the scope.
            Err(RecvTimeoutError::Disconnected) if stop.is_set() => return Err(EvaluateError::Interrupted),
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::farm::evaluate::Request;
    use common::external::{SampleResult, SlotError};
    use common::failure::SimulationFailure;
    use std::collections::BTreeSet;

    /// Fails every sample with its number as message; returns an error at sample `broken`; waits for `stop` at sample
    /// `stuck`.
    struct TestSlot {
        broken: u64,
        stuck: u64,
        calls: u64,
    }

    impl Slot for TestSlot {
        fn evaluate(
            &mut self,
            id: u64,
            _sample: &[f64],
            stop: &StopSignal,
        ) -> Result<SampleResult, SlotError> {
            self.calls += 1;
            if id == self.stuck {
                while !stop.is_set() {
                    std::thread::yield_now();
                }
                return Err(SlotError::Stopped);
            }
            if id == self.broken {
                return Err(SlotError::ThreadEnded("a test"));
            }
            Ok(Err(SimulationFailure::Reported { message: id.to_string() }))
        }

        fn name(&self) -> String {
            "test/0".into()
        }
    }

    fn evaluator(count: usize, broken: u64, stuck: u64) -> SlotEvaluator<TestSlot> {
        let slot = |_| TestSlot { broken, stuck, calls: 0 };
        SlotEvaluator::new((0..count).map(slot).collect(), Arc::default())
    }

    fn batch(count: u64) -> Vec<Request> {
        let request = |id| Request { id, sample: vec![], with_first_cycle: false, accuracy: None };
        (0..count).map(request).collect()
    }

    #[test]
    fn every_request_is_evaluated_once_and_slots_live_on() {
        let mut evaluator = evaluator(3, u64::MAX, u64::MAX);
        for _ in 0..2 {
            let mut seen = BTreeSet::new();
            evaluator
                .evaluate(&batch(50), &mut |finished| {
                    assert!(seen.insert(finished.id) && finished.worker == "test/0");
                    Ok(())
                })
                .unwrap();
            assert_eq!(seen.len(), 50);
        }
        assert_eq!(evaluator.slots.iter().map(|slot| slot.calls).sum::<u64>(), 100);
    }

    #[test]
    fn an_error_of_one_slot_ends_the_batch_and_stops_the_others() {
        let error = evaluator(2, 5, 3).evaluate(&batch(1000), &mut |_| Ok(())).unwrap_err();
        assert!(matches!(error, EvaluateError::ThreadEnded("a test")));
    }

    #[test]
    fn the_user_stops_slots_at_work() {
        let mut evaluator = evaluator(1, u64::MAX, 4);
        let interrupted = Arc::clone(&evaluator.interrupted);
        let mut recorded = 0;
        let error = evaluator.evaluate(&batch(1000), &mut |finished| {
            recorded += 1;
            interrupted.store(finished.id == 3, Ordering::Relaxed);
            Ok(())
        });
        assert!(matches!(error, Err(EvaluateError::Interrupted)));
        assert_eq!(recorded, 4);
    }
}
