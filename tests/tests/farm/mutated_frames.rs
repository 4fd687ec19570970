//! Changed frames of Zenoh, and a coordinator whose messaging has stopped. `cargo run --release -p tests --example mutated_frames` takes
//! a given time.

use coordinator::farm::dispatch::{Watch, watch};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use tests::deployed::{HOST, certificates, configuration, has_openssl};
use tests::mutated_frames::{Attack, random_changes};
use tests::within;
use zenoh::Config;

/// Time limit of each test; only a defect takes longer.
const LONGEST: Duration = Duration::from_secs(120);
/// Time of the random changes.
const TIME: Duration = Duration::from_secs(6);

/// The byte changed in a key that a client declares.
fn forbidden_key() -> Box<tests::mutated_frames::Mutate> {
    let done = AtomicBool::new(false);
    Box::new(move |frame| {
        let at = frame.windows(3).position(|bytes| bytes == b"zz1").filter(|_| !done.load(Ordering::Relaxed));
        if let Some(at) = at {
            frame[at + 2] = b'?';
            done.store(true, Ordering::Relaxed);
        }
        at.is_some()
    })
}

#[test]
fn issue_one_malformed_declaration_left_a_coordinator_that_never_answered() {
    within(LONGEST, || {
        let folder = tempfile::tempdir().unwrap();
        let mut attack = Attack::start(folder.path(), None);
        let figures = attack.run(40, Instant::now() + LONGEST, forbidden_key());
        assert!(figures.changed > 0, "{figures:?}");
    });
}

#[test]
fn changed_frames_end_or_leave_a_coordinator_that_answers() {
    within(LONGEST, || {
        let folder = tempfile::tempdir().unwrap();
        let mut attack = Attack::start(folder.path(), None);
        let figures = attack.run(u64::MAX / 2, Instant::now() + TIME, random_changes(1));
        assert!(figures.changed > 50, "{figures:?}");
        println!("{figures:?}");
    });
}

#[test]
fn changed_frames_through_tls_end_or_leave_a_coordinator_that_answers() {
    if !has_openssl("frames through TLS") {
        return;
    }
    within(LONGEST, || {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(folder.path(), HOST);
        let tls = Some((configuration("zenoh-tls.json5", &own), own));
        let mut attack = Attack::start(folder.path(), tls);
        let figures = attack.run(u64::MAX / 2, Instant::now() + TIME, random_changes(2));
        assert!(figures.changed > 25, "{figures:?}");
        println!("{figures:?}");
    });
}

#[test]
fn a_coordinator_that_does_not_answer_its_own_questions_is_noticed() {
    within(LONGEST, || {
        let coordinator = tests::coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let often =
            Watch { every: Duration::from_millis(100), patience: Duration::from_secs(1), silences: 3 };
        let (said, failed) = channel();
        let watched = watch(endpoint.clone(), None, often, move || said.send(()).unwrap()).unwrap();
        assert_eq!(failed.recv_timeout(Duration::from_secs(2)), Err(RecvTimeoutError::Timeout));
        coordinator.finish();
        // Connections are accepted, and nobody answers.
        let mut config = Config::default();
        for (key, value) in [
            ("mode", "\"peer\""),
            ("scouting/multicast/enabled", "false"),
            ("listen/endpoints", &format!("[\"{endpoint}\"]")),
        ] {
            config.insert_json5(key, value).unwrap();
        }
        let _silent = sessions::open(config).unwrap();
        failed.recv_timeout(LONGEST).unwrap();
        drop(watched);
    });
}
