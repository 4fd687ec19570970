//! What the threads of an evaluator take their work from.

use super::Request;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};

/// Requests that no thread has taken.
#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Waiting {
    requests: VecDeque<Request>,
    closed: bool,
}

impl Queue {
    /// The next request, waited for; `None` once the queue is closed.
    pub(super) fn take(&self) -> Option<Request> {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let idle = |w: &mut Waiting| w.requests.is_empty() && !w.closed;
        let mut waiting = self.changed.wait_while(waiting, idle).unwrap_or_else(PoisonError::into_inner);
        if waiting.closed { None } else { waiting.requests.pop_front() }
    }

    pub(super) fn add(&self, requests: Vec<Request>) {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).requests.extend(requests);
        self.changed.notify_all();
    }
}

/// Closes a queue when it goes: at the end, at an error, and where a simulation panics.
pub(super) struct CloseAtEnd<'a>(pub &'a Queue);

impl Drop for CloseAtEnd<'_> {
    fn drop(&mut self) {
        self.0.waiting.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        self.0.changed.notify_all();
    }
}
