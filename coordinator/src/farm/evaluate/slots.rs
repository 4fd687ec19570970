//! Evaluations on a fixed number of slots, each with something of its own that lives on from batch to batch, e.g. a
//! process. A slot at work looks up often enough to stop at once when the user wants to.

use super::queue::{CloseAtEnd, Queue};
use super::{Beginnings, EvaluateError, Evaluator, Finished, Outcome, Pursuit, Request};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often anybody who waits looks whether to stop.
pub(super) const LOOK_UP: Duration = Duration::from_millis(50);

/// Tells a slot to stop: the user wants to, or its batch has ended early.
#[derive(Debug, Clone, Default)]
pub struct Stop {
    user: Arc<AtomicBool>,
    batch: Arc<AtomicBool>,
}

impl Stop {
    /// Whether to stop.
    pub fn asked(&self) -> bool {
        self.user.load(Ordering::Relaxed) || self.batch.load(Ordering::Relaxed)
    }

    /// Waits for a message, at most `patience`; looks up meanwhile.
    ///
    /// # Errors
    /// Why there is none.
    pub fn wait<T>(&self, messages: &Receiver<T>, patience: Duration) -> Result<T, NoMessage> {
        let started = Instant::now();
        loop {
            let left = patience.saturating_sub(started.elapsed());
            match messages.recv_timeout(left.min(LOOK_UP)) {
                Ok(message) => return Ok(message),
                Err(RecvTimeoutError::Disconnected) => return Err(NoMessage::Ended),
                Err(RecvTimeoutError::Timeout) if self.asked() => return Err(NoMessage::Stopped),
                Err(RecvTimeoutError::Timeout) if started.elapsed() >= patience => {
                    return Err(NoMessage::TooLate);
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

/// Why there is no message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoMessage {
    /// Patience has come to its end.
    TooLate,
    /// Nobody sends any more.
    Ended,
    /// [`Stop`].
    Stopped,
}

/// Evaluates one sample after another.
pub trait Slot: Send {
    /// One evaluation.
    ///
    /// # Errors
    /// What ends the whole batch; [`EvaluateError::Interrupted`] soon after `stop` asks for it.
    fn evaluate(&mut self, request: &Request, stop: &Stop) -> Result<Outcome, EvaluateError>;

    /// Name in results, e.g. `program/0`.
    fn name(&self) -> String;
}

/// Evaluates batches on slots, one thread each.
#[derive(Debug)]
pub struct SlotEvaluator<S> {
    slots: Vec<S>,
    interrupted: Arc<AtomicBool>,
}

impl<S: Slot> SlotEvaluator<S> {
    /// With these slots; a batch under way stops when `interrupted` becomes true.
    pub fn new(slots: Vec<S>, interrupted: Arc<AtomicBool>) -> Self {
        Self { slots, interrupted }
    }
}

impl<S: Slot> Evaluator for SlotEvaluator<S> {
    fn pursue(&mut self, pursuit: &mut dyn Pursuit) -> Result<(), EvaluateError> {
        let stop = Stop { user: Arc::clone(&self.interrupted), batch: Arc::default() };
        let queue = Queue::default();
        let (sender, outcomes) = channel();
        std::thread::scope(|scope| {
            for slot in &mut self.slots {
                let (sender, queue, stop) = (sender.clone(), &queue, &stop);
                scope.spawn(move || {
                    let _closed = CloseAtEnd(queue);
                    while !stop.asked()
                        && let Some(request) = queue.take()
                    {
                        let started = Instant::now();
                        let outcome = slot.evaluate(&request, stop);
                        let wall = started.elapsed().as_secs_f64();
                        let finished =
                            |outcome| Finished { id: request.id, outcome, worker: slot.name(), wall };
                        if sender.send(outcome.map(finished)).is_err() {
                            return;
                        }
                    }
                });
            }
            drop(sender);
            // Whatever happens here, the threads end.
            let _closed = CloseAtEnd(&queue);
            let collected = collect(pursuit, &queue, &outcomes, &stop);
            stop.batch.store(true, Ordering::Relaxed);
            collected
        })
    }
}

/// Begins what comes and records what is done until there is no more of either.
fn collect(
    pursuit: &mut dyn Pursuit,
    queue: &Queue,
    outcomes: &Receiver<Result<Finished, EvaluateError>>,
    stop: &Stop,
) -> Result<(), EvaluateError> {
    let (mut beginnings, mut open) = (Beginnings::default(), 0);
    loop {
        let requests = beginnings.take(pursuit)?;
        open += requests.len();
        queue.add(requests);
        if open == 0 && beginnings.ended() {
            return Ok(());
        }
        if stop.asked() {
            return Err(EvaluateError::Interrupted);
        }
        match outcomes.recv_timeout(super::LOOK_UP) {
            Ok(finished) => {
                pursuit.record(finished?)?;
                open -= 1;
            }
            Err(RecvTimeoutError::Timeout) => {}
            // They leave when asked to; a thread that panics is reported by the scope.
            Err(RecvTimeoutError::Disconnected) if stop.asked() => return Err(EvaluateError::Interrupted),
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::failure::SimulationFailure;
    use std::collections::BTreeSet;

    /// Fails every sample in its own words, `broken` with an error; waits for `stop` at sample `stuck`.
    struct Practice {
        broken: u64,
        stuck: u64,
        calls: u64,
    }

    impl Slot for Practice {
        fn evaluate(&mut self, request: &Request, stop: &Stop) -> Result<Outcome, EvaluateError> {
            self.calls += 1;
            if request.id == self.stuck {
                while !stop.asked() {
                    std::thread::yield_now();
                }
                return Err(EvaluateError::Interrupted);
            }
            if request.id == self.broken {
                return Err(EvaluateError::Transport("broken".into()));
            }
            Ok(Err(SimulationFailure::Reported { message: request.id.to_string() }))
        }

        fn name(&self) -> String {
            "practice/0".into()
        }
    }

    fn evaluator(count: usize, broken: u64, stuck: u64) -> SlotEvaluator<Practice> {
        let slot = |_| Practice { broken, stuck, calls: 0 };
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
                    assert!(seen.insert(finished.id) && finished.worker == "practice/0");
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
        assert!(matches!(error, EvaluateError::Transport(reason) if reason == "broken"));
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
