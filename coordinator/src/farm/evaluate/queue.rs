//! Queue of requests shared by the threads of an evaluator.

use super::Request;
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, PoisonError};

/// Requests that no thread has taken yet.
#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: Mutex<QueueState>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct QueueState {
    requests: VecDeque<Request>,
    closed: bool,
}

impl Queue {
    /// Waits for the next request; `None` once the queue is closed.
    pub(super) fn take(&self) -> Option<Request> {
        let waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let idle = |w: &mut QueueState| w.requests.is_empty() && !w.closed;
        let mut waiting = self.changed.wait_while(waiting, idle).unwrap_or_else(PoisonError::into_inner);
        if waiting.closed { None } else { waiting.requests.pop_front() }
    }

    pub(super) fn add(&self, requests: Vec<Request>) {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).requests.extend(requests);
        self.changed.notify_all();
    }
}

/// Closes a queue when dropped: at the end, after an error, and when a simulation panics.
pub(super) struct CloseAtEnd<'a>(pub &'a Queue);

impl Drop for CloseAtEnd<'_> {
    fn drop(&mut self) {
        self.0.waiting.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        self.0.changed.notify_all();
    }
}
