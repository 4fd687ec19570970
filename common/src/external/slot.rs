//! A slot evaluates one sample at a time with an external simulator, and polls a stop signal while it waits. Errors of external
//! simulators: programs that do not start or reply, servers whose model does not fit the scene.

use crate::failure::SimulationFailure;
use crate::outputs::Evaluation;
use std::fmt::Display;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Interval at which a waiting slot polls the stop signal.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Result of one sample. A failed simulation is a result, not an error of the slot.
pub type SampleResult = Result<Evaluation, SimulationFailure>;

/// Set when any of its flags is true. It also names the contact without which the program of the evaluation must end, if there
/// is one.
#[derive(Debug, Clone, Default)]
pub struct StopSignal {
    flags: Vec<Arc<AtomicBool>>,
    /// The contact that the program needs.
    pub(super) contact: Option<usize>,
}

impl StopSignal {
    /// A signal that is set when one of `flags` is true.
    pub fn new(flags: impl IntoIterator<Item = Arc<AtomicBool>>) -> Self {
        Self { flags: flags.into_iter().collect(), contact: None }
    }

    /// This signal for an evaluation whose program must end without `contact`; see `external::limit_contact`.
    pub fn needing(self, contact: Option<usize>) -> Self {
        Self { contact, ..self }
    }

    /// True if the slot is to stop.
    pub fn is_set(&self) -> bool {
        self.flags.iter().any(|flag| flag.load(Ordering::Relaxed))
    }

    /// Waits for a message for at most `timeout`; `None` once the signal is set.
    pub(super) fn wait<T>(
        &self,
        messages: &Receiver<T>,
        timeout: Duration,
    ) -> Option<Result<T, RecvTimeoutError>> {
        let started = Instant::now();
        loop {
            let left = timeout.saturating_sub(started.elapsed());
            match messages.recv_timeout(left.min(POLL_INTERVAL)) {
                Err(RecvTimeoutError::Timeout) if self.is_set() => return None,
                Err(RecvTimeoutError::Timeout) if started.elapsed() < timeout => {}
                received => return Some(received),
            }
        }
    }
}

/// Why a simulator cannot be used, in words: a program that cannot be started or ends without a reply, a reply that breaks the protocol, a
/// server or a model that does not fit the scene. A failure it reports for a single sample is a failed simulation instead.
#[derive(Debug, Error)]
#[error("simulator{0}")]
pub struct SimulatorError(String);

impl SimulatorError {
    /// The error of what the scene states at this key.
    pub(super) fn of_key(key: &str, fault: impl Display) -> Self {
        Self(format!(".{key}: {fault}"))
    }

    /// The error of a reply that breaks the protocol.
    pub(super) fn of_reply(simulator: &str, id: u64, fault: &str) -> Self {
        Self(format!(": invalid reply of {simulator} to evaluation {id}: {fault}"))
    }
}

/// Reasons for a slot to return no result: nothing is known about the sample.
#[derive(Debug, Error)]
pub enum SlotError {
    /// The stop signal was set, or the program was ended without contact.
    #[error("stopped")]
    Stopped,
    /// The operating system cannot start a thread.
    #[error("cannot start a thread: {0}")]
    Thread(std::io::Error),
    /// A thread has ended without reporting why: a defect of the program.
    #[error("{0} has ended unexpectedly")]
    ThreadEnded(&'static str),
    /// The simulator cannot be used.
    #[error(transparent)]
    Simulator(#[from] SimulatorError),
}

/// An evaluation that is asked for.
#[derive(Debug, Clone, Copy)]
pub struct SlotRequest<'a> {
    /// Number of the evaluation.
    pub id: u64,
    /// Level of accuracy, 0 for the first; a simulator without levels does not see it.
    pub level: u8,
    /// Whether the history of the first cycle and of the worn mechanism is returned too, by a simulator that knows it.
    pub with_first_cycle: bool,
    /// Values of the inputs `(d,)`, SI.
    pub sample: &'a [f64],
}

/// Evaluates one sample at a time.
pub trait Slot: Send {
    /// Starts what the slot needs before its first sample, so that a simulator that cannot start is reported at once.
    ///
    /// # Errors
    /// [`SimulatorError`].
    fn start(&mut self) -> Result<(), SimulatorError> {
        Ok(())
    }

    /// Evaluates one sample.
    ///
    /// # Errors
    /// [`SlotError`]; [`SlotError::Stopped`] once `stop` is set.
    fn evaluate(&mut self, request: SlotRequest<'_>, stop: &StopSignal) -> Result<SampleResult, SlotError>;

    /// Name of the slot in results, e.g. `program/0`.
    fn name(&self) -> String;
}
