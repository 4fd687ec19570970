//! Evaluates requests on threads of this process, which share a queue, without messaging: by a closure, or by what an evaluator of
//! this module gives to each thread.

use super::{
    EvaluateError, EvaluationResult, Evaluator, Finished, POLL_INTERVAL, Request, RequestSource,
    next_requests,
};
use common::external::StopSignal;
use common::locks::locked;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Evaluates requests by a closure `F` on a fixed number of threads.
#[derive(Debug)]
pub struct LocalEvaluator<F> {
    simulate: F,
    threads: usize,
    interrupted: Arc<AtomicBool>,
}

impl<F: Fn(&Request) -> EvaluationResult + Sync> LocalEvaluator<F> {
    /// An evaluator that calls `simulate` on `threads` threads (at least one).
    pub fn new(threads: usize, simulate: F) -> Self {
        Self { simulate, threads: threads.max(1), interrupted: Arc::default() }
    }

    /// Ends a run with [`EvaluateError::Interrupted`] when `interrupted` becomes true.
    pub fn interrupted_by(self, interrupted: Arc<AtomicBool>) -> Self {
        Self { interrupted, ..self }
    }
}

impl<F: Fn(&Request) -> EvaluationResult + Sync> Evaluator for LocalEvaluator<F> {
    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let simulate = &self.simulate;
        let threads = (0..self.threads).map(|thread| {
            move |request: &Request, _: &StopSignal| Ok((simulate(request), format!("local/{thread}")))
        });
        run_on_threads(threads, &self.interrupted, source)
    }

    fn concurrency(&self) -> u32 {
        self.threads as u32
    }
}

/// Runs until the source is exhausted and every request has been evaluated, each by one of `threads`, which returns what a
/// request gives and the name of its worker. The stop signal is set at the end and when `interrupted` becomes true, which
/// ends the run with [`EvaluateError::Interrupted`].
pub(super) fn run_on_threads<E>(
    threads: impl Iterator<Item = E>,
    interrupted: &Arc<AtomicBool>,
    source: &mut dyn RequestSource,
) -> Result<(), EvaluateError>
where
    E: FnMut(&Request, &StopSignal) -> Result<(EvaluationResult, String), EvaluateError> + Send,
{
    let has_ended = Arc::new(AtomicBool::new(false));
    let stop = StopSignal::new([Arc::clone(interrupted), Arc::clone(&has_ended)]);
    let (queue, requests) = channel::<Request>();
    let (requests, stop) = (&Mutex::new(requests), &stop);
    let (sender, outcomes) = channel();
    std::thread::scope(|scope| {
        for mut evaluate in threads {
            let (sender, end) = (sender.clone(), EndAll(Arc::clone(&has_ended)));
            scope.spawn(move || {
                let _end = end;
                let next = || locked(requests).recv().ok().filter(|_| !stop.is_set());
                while let Some(request) = next() {
                    let started = Instant::now();
                    let evaluated = evaluate(&request, stop);
                    let wall = started.elapsed().as_secs_f64();
                    let finished = |(outcome, worker)| Finished { id: request.id, outcome, worker, wall };
                    if sender.send(evaluated.map(finished)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        let _end = EndAll(has_ended);
        collect(source, queue, &outcomes, stop)
    })
}

/// Sets the stop signal when dropped: at the end, after an error, and when a simulation panics.
struct EndAll(Arc<AtomicBool>);

impl Drop for EndAll {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Queues requests and records outcomes until the source is exhausted and nothing is running.
fn collect(
    source: &mut dyn RequestSource,
    queue: Sender<Request>,
    outcomes: &Receiver<Result<Finished, EvaluateError>>,
    stop: &StopSignal,
) -> Result<(), EvaluateError> {
    let (mut exhausted, mut open) = (false, 0);
    loop {
        let requests = next_requests(source, &mut exhausted)?;
        open += requests.len();
        // A queue whose threads have ended takes no more.
        requests.into_iter().for_each(|request| _ = queue.send(request));
        if open == 0 && exhausted {
            return Ok(());
        }
        if stop.is_set() {
            return Err(EvaluateError::Interrupted);
        }
        match outcomes.recv_timeout(POLL_INTERVAL) {
            Ok(finished) => {
                source.record(finished?)?;
                open -= 1;
            }
            Err(RecvTimeoutError::Timeout) => {}
            // The threads end when the stop signal is set; a panic of a thread is reported by the scope.
            Err(RecvTimeoutError::Disconnected) if stop.is_set() => return Err(EvaluateError::Interrupted),
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::failure::SimulationFailure;
    use std::collections::BTreeMap;

    fn batch(count: u64) -> Vec<Request> {
        (0..count)
            .map(|id| Request {
                id,
                sample: vec![id as f64],
                with_first_cycle: false,
                accuracy: None,
                level: 0,
                not_by: vec![],
            })
            .collect()
    }

    fn refuse(request: &Request) -> EvaluationResult {
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
