//! Asks the coordinator for its status as any new client would. A session that was open before may go on where the messaging library
//! no longer serves new ones: no worker could join any more, and the loss of one would not be noticed.

use super::super::DispatchError;
use super::client_session::{ClientError, ClientSession};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Duration;

/// A frame on a stream, its length before it, that no version of Zenoh knows.
const NO_FRAME: [u8; 3] = [1, 0, 0xff];

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
/// silent. Nothing is concluded before it has answered once, nor where no session can be opened, since it may have all that it accepts,
/// unless its listener no longer reads either: with TLS that is not seen.
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
    let run = move || {
        let ask = || ClientSession::open(&endpoint, config.as_deref())?.status(watch.patience);
        let (mut has_answered, mut silences) = (false, 0);
        while silences < watch.silences {
            if dropped.recv_timeout(watch.every) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            match ask() {
                Ok(_) => (has_answered, silences) = (true, 0),
                Err(ClientError::Silent { .. }) if has_answered => silences += 1,
                Err(ClientError::Unreachable { .. })
                    if has_answered && is_frozen(&endpoint, watch.patience) =>
                {
                    silences += 1;
                }
                Err(error) => tracing::debug!("the coordinator's own question: {error}"),
            }
        }
        failed();
    };
    let started = thread::Builder::new().name("coordinator-watch".into()).spawn(run);
    started.map(|_| Watched { _until_dropped }).map_err(DispatchError::Thread)
}

/// True if the listener of an endpoint `tcp/...` leaves a frame that is none unread: otherwise it closes the connection, at the latest when
/// its time for a handshake is over, also when it accepts no more sessions.
fn is_frozen(endpoint: &str, patience: Duration) -> bool {
    let connected = endpoint.strip_prefix("tcp/").map(TcpStream::connect);
    let Some(Ok(mut stream)) = connected else { return false };
    let sent = stream.set_read_timeout(Some(patience)).and_then(|()| stream.write_all(&NO_FRAME));
    let is_late = |error: std::io::Error| matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut);
    sent.is_ok() && stream.read(&mut [0]).is_err_and(is_late)
}

#[cfg(test)]
mod tests {
    use super::is_frozen;
    use std::net::TcpListener;
    use std::time::Duration;

    #[test]
    fn issue_a_listener_that_no_longer_reads_was_not_noticed() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        // The system completes the connection, and nothing reads from it.
        assert!(is_frozen(&endpoint, Duration::from_millis(50)));
        let closing = std::thread::spawn(move || drop((listener.accept(), listener.accept())));
        assert!(!is_frozen(&endpoint, Duration::from_secs(20)));
        closing.join().unwrap();
        assert!(!is_frozen(&endpoint, Duration::from_secs(20)), "nothing listens");
    }
}
