//! Where evaluations hand in the stretches of motion they need, and get them back carried.
//!
//! An evaluation is written as one page of stages, but runs side by side with others: it waits at this desk while lanes
//! carry its islands. Islands that fit no lane are carried on the spot.

use super::moving::Moving;
use crate::integrate::{AdvanceError, AdvanceStats};
use crate::mechanism::fits_lanes;
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;
use std::time::Duration;

/// An island and the times of the cycle it is to be carried through.
pub struct Stretch {
    /// The island.
    pub moving: Moving,
    /// Where it is [s].
    pub from: f64,
    /// Where it is to go [s].
    pub to: f64,
    /// Whether its recorder watches.
    pub record: bool,
}

/// An island that has been carried.
pub struct Carried {
    /// The island, at the last state accepted.
    pub moving: Moving,
    /// What it took.
    pub stats: AdvanceStats,
    /// Whether it arrived.
    pub arrived: Result<(), AdvanceError>,
}

/// Time that one evaluation has taken of its thread.
pub type Spent = Rc<Cell<Duration>>;

/// Where the island will be handed back.
type Slot = Rc<RefCell<Option<Carried>>>;

/// A stretch under way.
pub struct Ticket {
    /// The stretch.
    pub stretch: Stretch,
    slot: Slot,
    spent: Spent,
}

impl Ticket {
    /// What its evaluation has taken so far.
    pub fn spent(&self) -> Spent {
        Rc::clone(&self.spent)
    }

    /// Hands the island back.
    pub fn close(self, stats: AdvanceStats, arrived: Result<(), AdvanceError>) {
        *self.slot.borrow_mut() = Some(Carried { moving: self.stretch.moving, stats, arrived });
    }
}

/// The desk, as one evaluation sees it.
#[derive(Clone, Default)]
pub struct Desk {
    waiting: Rc<RefCell<VecDeque<Ticket>>>,
    spent: Spent,
}

impl Desk {
    /// The same desk for another evaluation.
    pub fn for_another(&self) -> Self {
        Desk { waiting: Rc::clone(&self.waiting), spent: Spent::default() }
    }

    /// What its evaluation has taken so far.
    pub fn spent(&self) -> Spent {
        Rc::clone(&self.spent)
    }

    /// Has every stretch carried; in their order.
    pub async fn carry(&self, stretches: Vec<Stretch>) -> Vec<Carried> {
        let hand_in = |stretch: Stretch| -> Slot {
            let slot = Slot::default();
            let ticket = Ticket { stretch, slot: Rc::clone(&slot), spent: self.spent() };
            if fits_lanes(&ticket.stretch.moving.island) {
                self.waiting.borrow_mut().push_back(ticket);
            } else {
                carry_alone(ticket);
            }
            slot
        };
        let slots: Vec<Slot> = stretches.into_iter().map(hand_in).collect();
        poll_fn(|_| {
            if slots.iter().any(|slot| slot.borrow().is_none()) {
                return Poll::Pending;
            }
            Poll::Ready(slots.iter().filter_map(|slot| slot.borrow_mut().take()).collect())
        })
        .await
    }

    /// Takes the next stretch in line of those that `fits`.
    pub fn next(&self, fits: impl Fn(&Stretch) -> bool) -> Option<Ticket> {
        let mut waiting = self.waiting.borrow_mut();
        let place = waiting.iter().position(|ticket| fits(&ticket.stretch))?;
        waiting.remove(place)
    }
}

/// Carries one island by itself.
pub fn carry_alone(mut ticket: Ticket) {
    let Stretch { moving, from, to, record } = &mut ticket.stretch;
    let Moving { island, advance, recorder, q, v, .. } = moving;
    let mut stats = AdvanceStats::default();
    let arrived = if *record {
        advance.run(island, *from..*to, q, v, recorder, &mut stats)
    } else {
        advance.run(island, *from..*to, q, v, &mut (), &mut stats)
    };
    ticket.close(stats, arrived);
}
