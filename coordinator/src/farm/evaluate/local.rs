//! Evaluates requests by a closure on threads of this process, without messaging.

use super::queue::{CloseAtEnd, Queue};
use super::{EvaluateError, Evaluator, Finished, POLL_INTERVAL, PendingRequests, Request, RequestSource};
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Instant;

/// Evaluates requests by a closure `F` on a fixed number of threads.
#[derive(Debug)]
pub struct LocalEvaluator<F> {
    simulate: F,
    threads: usize,
    interrupted: Arc<AtomicBool>,
}

impl<F> LocalEvaluator<F>
where
    F: Fn(&Request) -> Result<Evaluation, SimulationFailure> + Sync,
{
    /// An evaluator that calls `simulate` on `threads` threads (at least one).
    pub fn new(threads: usize, simulate: F) -> Self {
        Self { simulate, threads: threads.max(1), interrupted: Arc::default() }
    }

    /// Ends a run with [`EvaluateError::Interrupted`] when `interrupted` becomes true.
    pub fn interrupted_by(self, interrupted: Arc<AtomicBool>) -> Self {
        Self { interrupted, ..self }
    }
}

impl<F> Evaluator for LocalEvaluator<F>
where
    F: Fn(&Request) -> Result<Evaluation, SimulationFailure> + Sync,
{
    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let (simulate, interrupted) = (&self.simulate, &*self.interrupted);
        let queue = Queue::default();
        let (sender, outcomes) = channel();
        std::thread::scope(|scope| {
            for thread in 0..self.threads {
                let (sender, queue) = (sender.clone(), &queue);
                scope.spawn(move || {
                    let _closed = CloseAtEnd(queue);
                    while let Some(request) = queue.take() {
                        let started = Instant::now();
                        let outcome = simulate(&request);
                        let wall = started.elapsed().as_secs_f64();
                        let worker = format!("local/{thread}");
                        if sender.send(Finished { id: request.id, outcome, worker, wall }).is_err() {
                            return;
                        }
                    }
                });
            }
            drop(sender);
            // The threads end on every path out of this scope.
            let _closed = CloseAtEnd(&queue);
            let (mut pending, mut open) = (PendingRequests::default(), 0);
            loop {
                if interrupted.load(Ordering::Relaxed) {
                    return Err(EvaluateError::Interrupted);
                }
                let requests = pending.drain(source)?;
                open += requests.len();
                queue.add(requests);
                if open == 0 && pending.is_exhausted() {
                    return Ok(());
                }
                match outcomes.recv_timeout(POLL_INTERVAL) {
                    Ok(finished) => {
                        source.record(finished)?;
                        open -= 1;
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    // A thread that panics is reported by the scope.
                    Err(RecvTimeoutError::Disconnected) => return Ok(()),
                }
            }
        })
    }

    fn concurrency(&self) -> u32 {
        self.threads as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn batch(count: u64) -> Vec<Request> {
        (0..count)
            .map(|id| Request { id, sample: vec![id as f64], with_first_cycle: false, accuracy: None })
            .collect()
    }

    fn refuse(request: &Request) -> Result<Evaluation, SimulationFailure> {
        Err(SimulationFailure::NotModelled { what: format!("{}", request.sample[0] * 2.0) })
    }

    #[test]
    fn every_request_is_evaluated_exactly_once_whatever_the_number_of_threads() {
        let recorded = |threads: usize| {
            let mut seen = BTreeMap::new();
            LocalEvaluator::new(threads, refuse)
                .evaluate(&batch(100), &mut |finished| {
                    assert!(seen.insert(finished.id, finished.outcome).is_none());
                    Ok(())
                })
                .unwrap();
            seen
        };
        let one = recorded(1);
        assert_eq!(one.len(), 100);
        assert_eq!(one, recorded(4));
    }

    #[test]
    fn it_ends_with_the_error_of_the_record() {
        let mut calls = 0;
        let error = LocalEvaluator::new(2, refuse).evaluate(&batch(1000), &mut |_| {
            calls += 1;
            if calls == 3 { Err(EvaluateError::Record("disk full".into())) } else { Ok(()) }
        });
        assert!(matches!(error, Err(EvaluateError::Record(reason)) if reason.to_string() == "disk full"));
        assert_eq!(calls, 3);
    }

    #[test]
    fn it_stops_when_interrupted_with_what_was_recorded_kept() {
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut evaluator = LocalEvaluator::new(2, refuse).interrupted_by(Arc::clone(&interrupted));
        let mut calls = 0;
        let error = evaluator.evaluate(&batch(1000), &mut |_| {
            calls += 1;
            interrupted.store(calls == 5, Ordering::Relaxed);
            Ok(())
        });
        assert!(matches!(error, Err(EvaluateError::Interrupted)));
        assert_eq!(calls, 5);
    }
}
