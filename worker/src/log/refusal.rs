//! Explains failed and refused connections by reading Zenoh's log messages. **Check this file at each update of Zenoh**:
//! the phrases in `phrases.txt` are those of the version pinned by the workspace, and the tests in
//! `tests/tests/farm/refusals.rs` provoke each of them.
//!
//! Zenoh's error for a failed connection is only "unable to connect", and a listener gets no error at all; the reason
//! appears in the log alone. `RefusalLayer` reads that log, independently of the level shown to the user:
//!
//! - The last failed connection of this process is kept for [`last_failure`].
//! - A refused connection to this process is logged as a warning with its cause, at the first, second, fourth, ... time:
//!   a port scan must not fill the log.

use common::locks::locked;
use common::wire::{keys, reason};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::{Debug, Write};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::{Duration, Instant};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer};

/// Modules of Zenoh that log why a connection failed, with the level of these messages.
pub const SOURCES: [(&str, Level); 5] = [
    ("zenoh::net::runtime::orchestrator", Level::DEBUG),
    ("zenoh::net::routing::interceptor::access_control", Level::TRACE),
    ("zenoh_link_tls", Level::WARN),
    ("zenoh_transport::unicast::establishment::accept", Level::DEBUG),
    ("zenoh_transport::unicast::manager", Level::TRACE),
];

/// The last failed connection: time and message.
static LAST_FAILURE: Mutex<Option<(Instant, String)>> = Mutex::new(None);

/// Most refusals that wait to be logged; more are dropped.
const MOST_WAITING: usize = 64;

/// Reason of the last failed connection of this process since `since`: Zenoh's message and, if known, its likely cause.
pub fn last_failure(since: Instant) -> Option<String> {
    let last = locked(&LAST_FAILURE);
    last.as_ref().filter(|(when, _)| *when >= since).map(|(_, text)| with_cause(text))
}

/// Reason why a session could not be opened since `since`: the logged one, otherwise `error`.
pub fn explain(error: &str, since: Instant) -> String {
    last_failure(since).unwrap_or_else(|| with_cause(error))
}

/// Reason why a query got no reply: the connection is down, or no coordinator answers behind the address.
pub fn no_answer(now: Instant) -> String {
    now.checked_sub(RECENT).and_then(last_failure).unwrap_or_else(|| {
        "connected, but queries get no reply: no coordinator runs behind that address, or its access_control does not \
         permit the query"
            .to_owned()
    })
}

/// Largest age of the last failed attempt while a connection is down: reconnection is tried more often than that.
const RECENT: Duration = Duration::from_secs(3);

/// A failure with its likely cause.
fn with_cause(text: &str) -> String {
    match cause(text) {
        Some(cause) => format!("{text}; {cause}"),
        None => text.to_owned(),
    }
}

/// Likely cause of a failed connection of this process.
fn cause(text: &str) -> Option<&'static str> {
    meaning("== connections of", &text.to_lowercase())
}

/// The first meaning in this section of the phrases of which one is in a text.
fn meaning(section: &str, text: &str) -> Option<&'static str> {
    let (_, rows) = include_str!("phrases.txt").split_once(section)?;
    let mut rows = rows.lines().take_while(|row| !row.is_empty()).filter_map(|row| row.split_once(" => "));
    rows.find(|(phrases, _)| phrases.split(" | ").any(|phrase| text.contains(phrase))).map(|(_, means)| means)
}

/// Warning for a message about a refused connection; `None` for other messages.
fn refused(text: &str) -> Option<String> {
    if text.contains("did not match any configured ACL subject") {
        let why = "no subject of access_control in --config matches it, so its messages are dropped";
        return Some(format!("a client connected without access: {why}"));
    }
    if let Some(number) =
        text.strip_prefix("Max transports reached (").and_then(|rest| rest.split(')').next())
    {
        return Some(format!(
            "a connection was refused: there are {number} sessions, as many as are accepted \
             (transport/unicast/max_sessions of --config, and ulimit -n); more workers can connect through a router \
             (zenohd), see deploy/README.md, Several sites"
        ));
    }
    let why = meaning("== connections to", text)?;
    Some(format!("a connection was refused: {why}"))
}

/// What only the coordinator may do, each with the action whose permission Zenoh computes before it for every key: such a pair is no message.
const FORGED: [(&str, &str); 4] =
    [("Put", "Reply"), ("Delete", "Put"), ("Reply", "Query"), ("Declare Queryable", "")];

thread_local! {
    /// The action of the last message of access control on this thread.
    static LAST_ACTION: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Warning for a message of access control about a client that acts as the coordinator; `None` for other messages.
fn forged(text: &str) -> Option<String> {
    let (_, what) = text.split_once("authorized to ")?;
    let (action, key) = what.split_once(" (ingress) on ")?;
    let before = LAST_ACTION.replace(action.to_owned());
    let (_, computed_after) = FORGED.into_iter().find(|(name, _)| *name == action)?;
    let key = [keys::NOTICE, keys::CLAIM, keys::STATUS].into_iter().find(|ours| key.contains(ours))?;
    (text.contains(" is unauthorized to ") && before != computed_after)
        .then(|| format!("a client tried to act as the coordinator and was refused: {action} on {key}"))
}

/// Log layer that reads Zenoh's messages about connections.
pub(super) struct RefusalLayer {
    refusals: SyncSender<String>,
}

impl RefusalLayer {
    /// Creates the layer, with a thread that logs refusals: a layer must not log by itself.
    pub fn start() -> Self {
        let (refusals, received) = sync_channel(MOST_WAITING);
        // Without the thread refusals are not logged; the program works all the same.
        let _ = std::thread::Builder::new().name("refusals".into()).spawn(move || log_refusals(&received));
        RefusalLayer { refusals }
    }
}

fn log_refusals(received: &Receiver<String>) {
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    while let Ok(sentence) = received.recv() {
        let count = counts.entry(sentence.clone()).or_default();
        *count += 1;
        if *count == 1 {
            tracing::warn!("{sentence}");
        } else if count.is_power_of_two() {
            tracing::warn!("{sentence} ({count} times so far)");
        }
    }
}

impl<S: Subscriber> Layer<S> for RefusalLayer {
    fn on_event(&self, event: &Event<'_>, _context: Context<'_, S>) {
        let mut message = Text(String::new());
        event.record(&mut message);
        if event.metadata().target() == SOURCES[0].0 {
            if let Some(failure) = failure(&message.0) {
                let mut last = locked(&LAST_FAILURE);
                *last = Some((Instant::now(), failure));
            }
        } else if let Some(sentence) = forged(&message.0).or_else(|| refused(&message.0)) {
            // A full queue contains enough refusals already.
            let _ = self.refusals.try_send(sentence);
        }
    }
}

/// Reason in a message about a failed connection, without the parts that differ between attempts.
fn failure(line: &str) -> Option<String> {
    let (_, what) = line.strip_prefix("Unable to connect to ")?.split_once('!')?;
    let what = reason(what.split(". Retry in").next()?);
    // The rest is Zenoh's internal state of the link.
    let what = what.split(" on: ").next()?.trim();
    (!what.is_empty()).then(|| what.to_owned())
}

/// Text of the field `message` of an event.
struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn Debug) {
        if field.name() == "message" {
            // Writing to a String cannot fail.
            let _ = write!(self.0, "{value:?}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::MAX_SESSIONS;

    #[test]
    fn a_failure_is_reported_without_the_state_of_the_link() {
        let line = "Unable to connect to configured peer tls/127.0.0.1:7! Received a close message (reason GENERIC) in \
                    response to an OpenSyn on: TransportLinkUnicast { link: Link { .. } } at /a/b.rs:5.. Retry in 200ms.";
        let reason = failure(line).unwrap();
        assert_eq!(reason, "Received a close message (reason GENERIC) in response to an OpenSyn");
        assert!(with_cause(&reason).contains("user and password"));
        assert_eq!(failure("Unable to connect to any of [Single(tls/127.0.0.1:7)]! "), None);
        assert_eq!(failure("Try to connect: tls/127.0.0.1:7"), None);
    }

    #[test]
    fn a_message_of_the_coordinator_by_a_client_is_named_and_a_permission_computed_beforehand_is_not() {
        let message = |decision: &str, action: &str| {
            forged(&format!("7a on all is {decision} to {action} (ingress) on hingewise/notice"))
        };
        let computed = [("authorized", "Query"), ("unauthorized", "Reply"), ("unauthorized", "Put")];
        assert!(computed.iter().all(|(decision, action)| message(decision, action).is_none()));
        assert_eq!(message("unauthorized", "Delete"), None);
        assert_eq!(message("authorized", "Query"), None);
        let forged = message("unauthorized", "Put").unwrap();
        assert!(forged.ends_with("refused: Put on hingewise/notice"), "{forged}");
        assert!(message("unauthorized", "Declare Queryable").is_some());
    }

    #[test]
    fn the_most_specific_cause_is_named() {
        for (text, means) in [
            ("Connection refused (os error 111)", "nothing listens there"),
            ("invalid peer certificate: certificate not valid for name \"a\"", "another name"),
            ("received fatal alert: CertificateRequired", "requires a client certificate"),
            ("received fatal alert: CertificateUnknown", "does not accept our certificate"),
            ("Read error on TCP link a => b: early eof", "closed the connection"),
        ] {
            assert!(cause(text).unwrap().contains(means), "{text}");
        }
        assert_eq!(with_cause("something new"), "something new");
    }

    #[test]
    fn a_full_coordinator_is_named_with_its_number_on_both_sides() {
        let line = "Max transports reached (12). Denying new transport with peer: 5ac1 at /a.rs:1.";
        assert!(refused(line).unwrap().contains("there are 12 sessions"));
        let line = "Received a close message (reason INVALID) in response to an OpenSyn";
        assert!(with_cause(line).contains(&format!("a coordinator {MAX_SESSIONS},")));
    }

    #[test]
    fn only_refusals_are_reported() {
        assert!(refused("UsrPwd extension - Recv OpenSyn. Invalid password. at /a.rs:1.").is_some());
        assert!(refused("New transport link accepted from a to b").is_none());
        assert!(refused("tls handshake eof. Hint: increase the system open file limit.").is_none());
    }
}
