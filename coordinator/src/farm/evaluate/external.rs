//! Evaluates requests by the external simulator that a scene names, on slots of this process, one thread each. A slot keeps its
//! state between batches, e.g. a running process, and polls the stop signal while it waits.

use super::local::run_on_threads;
use super::{EvaluateError, Evaluator, Request, RequestSource};
use common::external::{SimulatorError, Slot, SlotRequest, StopSignal};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// An evaluator on these slots. The first program is started here, so that a program that cannot start is reported at once.
///
/// # Errors
/// [`SimulatorError`].
pub fn on_slots(
    mut slots: Vec<Box<dyn Slot>>,
    interrupted: Arc<AtomicBool>,
) -> Result<Box<dyn Evaluator>, SimulatorError> {
    if let Some(first) = slots.first_mut() {
        first.start()?;
    }
    Ok(Box::new(SlotEvaluator { slots, interrupted }))
}

/// Evaluator with one thread per slot. A run ends with [`EvaluateError::Interrupted`] when `interrupted` becomes true.
struct SlotEvaluator {
    slots: Vec<Box<dyn Slot>>,
    interrupted: Arc<AtomicBool>,
}

impl Evaluator for SlotEvaluator {
    fn concurrency(&self) -> u32 {
        self.slots.len() as u32
    }

    fn run(&mut self, source: &mut dyn RequestSource) -> Result<(), EvaluateError> {
        let threads = self.slots.iter_mut().map(|slot| {
            move |request: &Request, stop: &StopSignal| {
                let Request { id, level, with_first_cycle, ref sample, .. } = *request;
                let asked = SlotRequest { id, level, with_first_cycle, sample };
                let outcome = slot.evaluate(asked, stop)?;
                Ok((outcome, slot.name()))
            }
        });
        run_on_threads(threads, &self.interrupted, source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::external::{SampleResult, SlotError};
    use common::failure::SimulationFailure;
    use std::collections::BTreeSet;
    use std::sync::atomic::Ordering;

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
            SlotRequest { id, .. }: SlotRequest<'_>,
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
            format!("test/{}", self.calls)
        }
    }

    fn evaluator(count: usize, broken: u64, stuck: u64) -> SlotEvaluator {
        let slot = |_| -> Box<dyn Slot> { Box::new(TestSlot { broken, stuck, calls: 0 }) };
        SlotEvaluator { slots: (0..count).map(slot).collect(), interrupted: Arc::default() }
    }

    fn batch(count: u64) -> Vec<Request> {
        let request = |id| Request {
            id,
            sample: vec![],
            with_first_cycle: false,
            accuracy: None,
            level: 0,
            not_by: vec![],
        };
        (0..count).map(request).collect()
    }

    #[test]
    fn every_request_is_evaluated_once_and_slots_live_on() {
        for count in [1, 3] {
            let mut evaluator = evaluator(count, u64::MAX, u64::MAX);
            let mut workers = BTreeSet::new();
            for _ in 0..2 {
                let mut seen = BTreeSet::new();
                evaluator
                    .evaluate(&batch(50), &mut |finished| {
                        assert!(seen.insert(finished.id));
                        workers.insert(finished.worker);
                        Ok(())
                    })
                    .unwrap();
                assert_eq!(seen.len(), 50);
            }
            // Their calls are counted over both batches.
            assert!(count > 1 || workers.contains("test/100"), "{workers:?}");
        }
    }

    #[test]
    fn an_error_of_one_slot_ends_the_batch_and_stops_the_others() {
        let error = evaluator(2, 5, 3).evaluate(&batch(1000), &mut |_| Ok(())).unwrap_err();
        assert!(matches!(error, EvaluateError::Slot(SlotError::ThreadEnded("a test"))));
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
