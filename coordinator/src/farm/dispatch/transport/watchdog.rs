//! Asks the coordinator for its status as any new client would. A session that was open before may go on where the messaging library
//! no longer serves new ones: no worker could join any more, and the loss of one would not be noticed.

use super::super::DispatchError;
use super::client_session::{ClientError, ClientSession};
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

/// How often and how long to ask.
#[derive(Debug, Clone, Copy)]
pub struct Watch {
    /// Time between two questions.
    pub every: Duration,
    /// Longest wait for the answer.
    pub patience: Duration,
    /// Number of questions in a row without an answer after which the messaging has failed: a flood of messages passes, a standstill does not.
    pub silences: u32,
}

impl Default for Watch {
    fn default() -> Self {
        Self { every: Duration::from_secs(20), patience: Duration::from_secs(20), silences: 3 }
    }
}

/// The coordinator is watched until this is dropped.
#[derive(Debug)]
pub struct Watched {
    _until_dropped: Sender<()>,
}

/// Asks the coordinator at `endpoint` in a thread, with the Zenoh settings of its own workers, and calls `failed` at most once: when it is
/// silent. Nothing is concluded before it has answered once, nor where no session can be opened: it may have all that it accepts.
///
/// # Errors
/// [`DispatchError::Thread`].
pub fn watch(
    endpoint: String,
    config: Option<PathBuf>,
    watch: Watch,
    failed: impl FnOnce() + Send + 'static,
) -> Result<Watched, DispatchError> {
    let (_until_dropped, dropped) = channel();
    let ask = move || ClientSession::open(&endpoint, config.as_deref())?.status(watch.patience);
    let run = move || {
        let (mut has_answered, mut silences) = (false, 0);
        while silences < watch.silences {
            if dropped.recv_timeout(watch.every) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            match ask() {
                Ok(_) => (has_answered, silences) = (true, 0),
                Err(ClientError::Silent { .. }) if has_answered => silences += 1,
                Err(error) => tracing::debug!("the coordinator's own question: {error}"),
            }
        }
        failed();
    };
    let started = thread::Builder::new().name("coordinator-watch".into()).spawn(run);
    started.map(|_| Watched { _until_dropped }).map_err(DispatchError::Thread)
}
