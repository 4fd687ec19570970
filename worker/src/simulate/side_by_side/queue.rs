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

/// An island and the span of time to integrate it over.
pub struct Span {
    /// State and tools of the island.
    pub state: IslandState,
    /// From the time of the state to the time wanted [s].
    pub time: Range<f64>,
    /// True if the island's recorder receives every accepted state.
    pub record: bool,
}

/// An island after its integration.
pub struct Integrated {
    /// The island at the last accepted state.
    pub state: IslandState,
    /// Work done in the span.
    pub counts: StepCounts,
    /// An error if the end of the span was not reached.
    pub result: Result<(), IntegrationError>,
}

/// Processor time charged to one evaluation.
pub type CpuTime = Rc<Cell<Duration>>;

/// Receives the integrated island for the evaluation that waits for it.
type Slot = Rc<RefCell<Option<Integrated>>>;

/// A span whose evaluation waits for it.
pub struct PendingSpan {
    /// The island and its span of time.
    pub span: Span,
    slot: Slot,
    /// Processor time of the evaluation that waits.
    pub(super) cpu_time: CpuTime,
}

impl PendingSpan {
    /// Returns the island to its evaluation.
    pub(crate) fn complete(self, counts: StepCounts, result: Result<(), IntegrationError>) {
        *self.slot.borrow_mut() = Some(Integrated { state: self.span.state, counts, result });
    }

    /// Integrates the island by itself from its state at `start` [s] to the end of its span, after the work `counts` in lanes.
    pub(crate) fn integrate_alone(mut self, start: f64, mut counts: StepCounts) {
        let Span { state, time, record } = &mut self.span;
        let IslandState { island, stepper, recorder, q, v, .. } = state;
        let time = start..time.end;
        let result = if *record {
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

    /// Integrates every span; the results are in the order of the spans.
    pub(crate) async fn integrate(&self, spans: Vec<Span>) -> Vec<Integrated> {
        let slots: Vec<Slot> = spans.into_iter().map(|span| self.submit(span)).collect();
        poll_fn(|_| {
            if slots.iter().any(|slot| slot.borrow().is_none()) {
                return Poll::Pending;
            }
            Poll::Ready(slots.iter().filter_map(|slot| slot.borrow_mut().take()).collect())
        })
        .await
    }

    /// Queues a span.
    fn submit(&self, span: Span) -> Slot {
        let slot = Slot::default();
        let pending = PendingSpan { span, slot: Rc::clone(&slot), cpu_time: Rc::clone(&self.cpu_time) };
        self.waiting.borrow_mut().push_back(pending);
        slot
    }

    /// Number of waiting spans that satisfy `fits`.
    pub(crate) fn count(&self, fits: impl Fn(&Span) -> bool) -> usize {
        self.waiting.borrow().iter().filter(|pending| fits(&pending.span)).count()
    }

    /// Removes the first waiting span that satisfies `fits`.
    pub(crate) fn take(&self, fits: impl Fn(&Span) -> bool) -> Option<PendingSpan> {
        let mut waiting = self.waiting.borrow_mut();
        let place = waiting.iter().position(|pending| fits(&pending.span))?;
        waiting.remove(place)
    }
}
