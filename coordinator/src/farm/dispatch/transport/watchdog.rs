//! Asks the coordinator for its status as any new client would. A session that was open before may go on where the messaging library
//! no longer serves new ones: no worker could join any more, and the loss of one would not be noticed.

use super::super::DispatchError;
use super::client_session::{ClientError, ClientSession};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

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

/// Asks the coordinator at `endpoint` in a thread, with the Zenoh settings of its own workers, and calls `failed` at most once: when it is
/// silent, also from its start on: the first clients may be the ones that stop the messaging. It is watched until what this returns is dropped.
///
/// # Errors
/// [`DispatchError::Thread`].
pub fn watch(
    endpoint: String,
    config: Option<PathBuf>,
    watch: Watch,
    failed: impl FnOnce() + Send + 'static,
) -> Result<Sender<()>, DispatchError> {
    let (until_dropped, dropped) = channel();
    let run = move || {
        let mut silences = 0;
        loop {
            match answers(&endpoint, config.as_deref(), watch.patience) {
                Some(true) => silences = 0,
                Some(false) => silences += 1,
                None => {}
            }
            if silences >= watch.silences {
                return failed();
            }
            if dropped.recv_timeout(watch.every) != Err(RecvTimeoutError::Timeout) {
                return;
            }
        }
    };
    let started = thread::Builder::new().name("coordinator-watch".into()).spawn(run);
    started.map(|_| until_dropped).map_err(DispatchError::Thread)
}

/// Whether the coordinator answers a new client within this time. `None` where it refuses the session: it may have all that it accepts,
/// but a listener that waits for ever for a lock refuses nothing.
fn answers(endpoint: &str, config: Option<&Path>, patience: Duration) -> Option<bool> {
    let begun = Instant::now();
    let session = ClientSession::open_within(endpoint, config, patience);
    let error = match session.and_then(|session| session.status(patience)) {
        Ok(_) => return Some(true),
        Err(error) => error,
    };
    tracing::debug!("the coordinator's own question: {error}");
    let is_silent = match error {
        ClientError::Silent(..) => true,
        ClientError::Unreachable(..) => begun.elapsed() >= patience.mul_f64(0.9),
        _ => false,
    };
    is_silent.then_some(false)
}

#[cfg(test)]
mod tests {
    use super::answers;
    use std::net::TcpListener;
    use std::time::Duration;

    #[test]
    fn issue_a_listener_that_no_longer_reads_was_not_noticed() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        // The system completes the connection, and nothing reads from it.
        assert_eq!(answers(&endpoint, None, Duration::from_millis(200)), Some(false));
        let closing = std::thread::spawn(move || drop((listener.accept(), listener.accept())));
        assert_eq!(answers(&endpoint, None, Duration::from_secs(20)), None);
        closing.join().unwrap();
        assert_eq!(answers(&endpoint, None, Duration::from_secs(20)), None, "nothing listens");
    }
}
