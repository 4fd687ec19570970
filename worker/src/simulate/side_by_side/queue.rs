//! The queue of islands that wait to be integrated over a span of time.

use crate::integrate::{IntegrationError, StepCounts};
use crate::simulate::island_state::IslandState;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::future::poll_fn;
use std::ops::Range;
use std::rc::Rc;
use std::task::Poll;
use std::time::Duration;

/// An island after its integration, at the last accepted state, with the work done in the span, and an error if its end was not reached.
pub type Integrated = (IslandState, StepCounts, Result<(), IntegrationError>);

/// Processor time charged to one evaluation.
pub type CpuTime = Rc<Cell<Duration>>;

/// Receives the integrated island for the evaluation that waits for it.
type Slot = Rc<RefCell<Option<Integrated>>>;

/// An island and the span of time to integrate it over, for which its evaluation waits.
pub struct PendingSpan {
    /// State and tools of the island.
    pub state: IslandState,
    /// From the time of the state to the time wanted [s].
    pub time: Range<f64>,
    /// True if the island's recorder receives every accepted state.
    pub record: bool,
    slot: Slot,
    /// Processor time of the evaluation that waits.
    pub(super) cpu_time: CpuTime,
}

impl PendingSpan {
    /// Returns the island to its evaluation.
    pub(crate) fn complete(self, counts: StepCounts, result: Result<(), IntegrationError>) {
        *self.slot.borrow_mut() = Some((self.state, counts, result));
    }

    /// Integrates the island by itself from its state at `start` [s] to the end of its span, after the work `counts` in lanes.
    pub(crate) fn integrate_alone(mut self, start: f64, mut counts: StepCounts) {
        let IslandState { island, stepper, recorder, q, v, .. } = &mut self.state;
        let time = start..self.time.end;
        let result = if self.record {
            stepper.run(island, time, q, v, recorder, &mut counts)
        } else {
            stepper.run(island, time, q, v, &mut (), &mut counts)
        };
        self.complete(counts, result);
    }
}

/// Spans waiting for lanes, with the processor time of the evaluation that holds this handle.
#[derive(Clone, Default)]
pub struct LaneQueue {
    waiting: Rc<RefCell<VecDeque<PendingSpan>>>,
    /// Processor time charged to this evaluation so far.
    pub(super) cpu_time: CpuTime,
}

impl LaneQueue {
    /// A handle to this queue for another evaluation, with processor time of zero.
    pub(crate) fn for_another(&self) -> Self {
        LaneQueue { waiting: Rc::clone(&self.waiting), cpu_time: CpuTime::default() }
    }

    /// Integrates islands over a span of `time` [s], recording it or not; the results are in their order.
    pub(crate) async fn integrate(
        &self,
        islands: Vec<IslandState>,
        time: &Range<f64>,
        record: bool,
    ) -> Vec<Integrated> {
        let submit = |state| {
            let (slot, cpu_time) = (Slot::default(), Rc::clone(&self.cpu_time));
            let pending = PendingSpan { state, time: time.clone(), record, slot: Rc::clone(&slot), cpu_time };
            self.waiting.borrow_mut().push_back(pending);
            slot
        };
        let slots: Vec<Slot> = islands.into_iter().map(submit).collect();
        poll_fn(|_| {
            if slots.iter().any(|slot| slot.borrow().is_none()) {
                return Poll::Pending;
            }
            Poll::Ready(slots.iter().filter_map(|slot| slot.borrow_mut().take()).collect())
        })
        .await
    }

    /// Number of waiting spans that satisfy `fits`.
    pub(crate) fn count(&self, fits: impl Fn(&PendingSpan) -> bool) -> usize {
        self.waiting.borrow().iter().filter(|pending| fits(pending)).count()
    }

    /// Removes the first waiting span that satisfies `fits`.
    pub(crate) fn take(&self, fits: impl Fn(&PendingSpan) -> bool) -> Option<PendingSpan> {
        let mut waiting = self.waiting.borrow_mut();
        let place = waiting.iter().position(fits)?;
        waiting.remove(place)
    }
}
