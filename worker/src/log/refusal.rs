//! Why connections fail, in words. Zenoh tells its caller only that it is "unable to connect", and tells whoever listens
//! nothing at all; the reason stands in its log. [`RefusalLayer`] listens to that log, whatever of it is shown:
//!
//! - what this process could not connect to is kept for [`last_failure`];
//! - who could not connect to this process is logged as a warning in plain words, each reason at its first, second,
//!   fourth, ... time: a port scan must not fill the log.
//!
//! The texts are those of the very version of Zenoh that the workspace pins; tests provoke each of them.

use common::wire::reason;
use std::collections::BTreeMap;
use std::fmt::{Debug, Write};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer};

/// Modules of Zenoh that say why a connection failed, and the level at which they do.
pub const SOURCES: [(&str, Level); 4] = [
    ("zenoh::net::runtime::orchestrator", Level::DEBUG),
    ("zenoh::net::routing::interceptor::access_control", Level::INFO),
    ("zenoh_link_tls", Level::WARN),
    ("zenoh_transport::unicast::establishment::accept", Level::DEBUG),
];

/// The last connection that could not be made, and when.
static LAST_FAILURE: Mutex<Option<(Instant, String)>> = Mutex::new(None);

/// Refusals that may wait to be logged; more are dropped.
const MOST_WAITING: usize = 64;

/// What kept this process from connecting since then, as far as the log was heard: Zenoh's own words and, where they are
/// known, what they mean.
pub fn last_failure(since: Instant) -> Option<String> {
    let last = LAST_FAILURE.lock().unwrap_or_else(PoisonError::into_inner);
    last.as_ref().filter(|(when, _)| *when >= since).map(|(_, text)| in_words(text))
}

/// Why a session could not be opened since then: what the log says, else `error`.
pub fn explain(error: &str, since: Instant) -> String {
    last_failure(since).unwrap_or_else(|| in_words(error))
}

/// Why a query found nobody to answer it: the line is down, or there is nobody who would.
pub fn no_answer(now: Instant) -> String {
    now.checked_sub(RECENT).and_then(last_failure).unwrap_or_else(|| {
        "connected, but nobody answers: no coordinator is behind that address, or its access_control does not let us \
         ask"
            .to_owned()
    })
}

/// A failed attempt to connect again is no older while the line is down.
const RECENT: Duration = Duration::from_secs(3);

/// A failure with its likely cause.
fn in_words(text: &str) -> String {
    match cause(text) {
        Some(cause) => format!("{text}; {cause}"),
        None => text.to_owned(),
    }
}

/// Parts of what Zenoh says where this process connects, and what they mean.
const CAUSES: [(&[&str], &str); 13] = [
    (
        &["connection refused"],
        "nothing listens there: is the coordinator running, and is this its address and port?",
    ),
    (&["lookup", "name or service", "resolve"], "this machine does not know that host name"),
    (&["no route", "unreachable"], "this machine's network has no way there"),
    (
        &["not valid for name"],
        "the coordinator's certificate is for another name: connect by one that stands in it",
    ),
    (
        &["peer certificate: badsignature", "peer certificate: unknownissuer"],
        "the coordinator's certificate was signed by another authority than root_ca_certificate of --config",
    ),
    (
        &["peer certificate: expired"],
        "the coordinator's certificate has expired, or this machine's clock is wrong",
    ),
    (
        &["peer certificate: notvalidyet"],
        "the coordinator's certificate is not valid yet, or this machine's clock is wrong",
    ),
    (
        &["certificaterequired"],
        "the coordinator asks for a certificate and --config shows none: connect_private_key, connect_certificate, enable_mtls",
    ),
    (
        &[
            "fatal alert: decrypterror",
            "fatal alert: unknownca",
            "fatal alert: badcertificate",
            "fatal alert: certificate",
        ],
        "the coordinator does not accept our certificate (connect_certificate of --config): was it signed by the same authority?",
    ),
    (
        &[
            "close message (reason 0) in response to an initsyn",
            "close message (reason generic) in response to an opensyn",
        ],
        "the coordinator refuses our user and password (transport/auth/usrpwd of --config)",
    ),
    (&["corrupt message"], "there is no TLS at that port: does the coordinator listen with tcp/?"),
    (
        &["early eof", "connection reset"],
        "whoever listens there hung up: does the coordinator listen with tls/, or speak something else?",
    ),
    (
        &["timeout"],
        "nobody answered in time: a firewall, another program at that port, or tls/ where the coordinator listens with tcp/",
    ),
];

fn cause(text: &str) -> Option<&'static str> {
    let text = text.to_lowercase();
    CAUSES.iter().find(|(parts, _)| parts.iter().any(|part| text.contains(part))).map(|(_, cause)| *cause)
}

/// Parts of what Zenoh says where others connect to this process, and what is told of it. What is not here may be a line
/// that broke, or a program that looks at every port.
const REFUSALS: [(&str, &str); 11] = [
    ("Invalid password", "it gave a wrong password"),
    ("Invalid user", "it gave a user that is not in the dictionary"),
    ("Recv InitSyn. Expected extension", "it gave no user and password"),
    ("peer sent no certificates", "it showed no certificate (enable_mtls asks for one)"),
    ("peer certificate: BadSignature", "its certificate was signed by another authority"),
    ("peer certificate: UnknownIssuer", "its certificate was signed by another authority"),
    ("peer certificate: Expired", "its certificate has expired, or this machine's clock is wrong"),
    (
        "fatal alert: DecryptError",
        "it does not accept this coordinator's certificate: its authority is another one",
    ),
    (
        "fatal alert: UnknownCA",
        "it does not accept this coordinator's certificate: its authority is another one",
    ),
    (
        "fatal alert: BadCertificate",
        "it does not accept this coordinator's certificate: the name it connects to does not stand in it",
    ),
    ("received corrupt message", "it does not speak TLS: workers must connect with tls/ here"),
];

/// A sentence on somebody who could not connect, if the text is about that.
fn refused(text: &str) -> Option<String> {
    if text.contains("did not match any configured ACL subject") {
        let why = "it is in no subject of access_control in --config, so nothing it says is heard";
        return Some(format!("somebody has connected without access: {why}"));
    }
    let (_, why) = REFUSALS.iter().find(|(part, _)| text.contains(part))?;
    Some(format!("a connection was refused: {why}"))
}

/// Hears what Zenoh logs of connections.
pub(super) struct RefusalLayer {
    refusals: SyncSender<String>,
}

impl RefusalLayer {
    /// Ready to hear, with a thread that logs refusals: a layer must not log by itself.
    pub fn start() -> Self {
        let (refusals, heard) = sync_channel(MOST_WAITING);
        // Without the thread refusals are not told; that is no reason to do without the program.
        let _ = std::thread::Builder::new().name("refusals".into()).spawn(move || tell(&heard));
        RefusalLayer { refusals }
    }
}

fn tell(heard: &Receiver<String>) {
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    while let Ok(sentence) = heard.recv() {
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
                let mut last = LAST_FAILURE.lock().unwrap_or_else(PoisonError::into_inner);
                *last = Some((Instant::now(), failure));
            }
        } else if let Some(sentence) = refused(&message.0) {
            // A full queue holds enough to tell.
            let _ = self.refusals.try_send(sentence);
        }
    }
}

/// What went wrong, of a line about a connection that could not be made, without what changes from try to try.
fn failure(line: &str) -> Option<String> {
    let (_, what) = line.strip_prefix("Unable to connect to ")?.split_once('!')?;
    let what = reason(what.split(". Retry in").next()?);
    // What follows is Zenoh's own state of the link.
    let what = what.split(" on: ").next()?.trim();
    (!what.is_empty()).then(|| what.to_owned())
}

/// The message of an event.
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

    #[test]
    fn a_failure_is_told_without_the_state_of_the_link() {
        let line = "Unable to connect to configured peer tls/127.0.0.1:7! Received a close message (reason GENERIC) in \
                    response to an OpenSyn on: TransportLinkUnicast { link: Link { .. } } at /a/b.rs:5.. Retry in 200ms.";
        let told = failure(line).unwrap();
        assert_eq!(told, "Received a close message (reason GENERIC) in response to an OpenSyn");
        assert!(in_words(&told).contains("user and password"));
        assert_eq!(failure("Unable to connect to any of [Single(tls/127.0.0.1:7)]! "), None);
        assert_eq!(failure("Try to connect: tls/127.0.0.1:7"), None);
    }

    #[test]
    fn the_most_telling_cause_is_named() {
        for (text, means) in [
            ("Connection refused (os error 111)", "nothing listens there"),
            ("invalid peer certificate: certificate not valid for name \"a\"", "another name"),
            ("received fatal alert: CertificateRequired", "asks for a certificate"),
            ("received fatal alert: CertificateUnknown", "does not accept our certificate"),
            ("Read error on TCP link a => b: early eof", "hung up"),
        ] {
            assert!(cause(text).unwrap().contains(means), "{text}");
        }
        assert_eq!(in_words("something new"), "something new");
    }

    #[test]
    fn only_refusals_are_told() {
        assert!(refused("UsrPwd extension - Recv OpenSyn. Invalid password. at /a.rs:1.").is_some());
        assert!(refused("New transport link accepted from a to b").is_none());
        assert!(refused("tls handshake eof. Hint: increase the system open file limit.").is_none());
    }
}
