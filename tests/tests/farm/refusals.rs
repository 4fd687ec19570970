//! Log messages of both sides about refused connections and workers.

use common::build::Build;
use common::wire::{self, Claim, Notice, Offers, PROTOCOL_VERSION, WorkerId, keys};
use std::path::Path;
use std::time::{Duration, Instant};
use tests::deployed::{
    HOST, LoggedProcess, NAMED, certificates, changed_configuration, configuration, has_openssl, session,
    try_session, user, with_users,
};
use tests::{PATIENCE, in_time};
use zenoh::Wait;

/// A coordinator as a process, and the endpoint that it prints.
fn start_coordinator(
    folder: &Path,
    name: &str,
    endpoint: &str,
    config: Option<&Path>,
) -> (LoggedProcess, String) {
    let out = folder.join(name);
    let mut arguments = vec!["run", "four-bar", "--workers", "0", "--listen", endpoint, "--out"];
    arguments.push(out.to_str().unwrap());
    if let Some(config) = config {
        arguments.extend(["--config", config.to_str().unwrap()]);
    }
    let coordinator = LoggedProcess::start("coordinator", &arguments);
    let endpoint = coordinator.wait_for("waiting for workers: worker --connect ");
    (coordinator, endpoint)
}

/// A configuration, the protocol of the endpoint, and what worker and coordinator say of it.
type Case<'a> = (&'a Path, &'a str, &'a str, &'a str);

/// Starts workers that are refused, all at once; checks the messages of the workers and of their coordinators.
fn refused(groups: &[(&(LoggedProcess, String), &[Case<'_>])]) {
    let all =
        || groups.iter().flat_map(|(coordinator, cases)| cases.iter().map(move |case| (*coordinator, case)));
    let workers: Vec<LoggedProcess> = all()
        .map(|((_, endpoint), (config, protocol, ..))| {
            let endpoint =
                format!("{protocol}{}", endpoint.trim_start_matches("tls").trim_start_matches("tcp"));
            let config = config.to_str().unwrap();
            let arguments =
                ["--connect", &endpoint, "--slots", "1", "--give-up-after", "3", "--config", config];
            LoggedProcess::start("worker", &arguments)
        })
        .collect();
    for (mut worker, ((listening, _), (_, _, worker_says, coordinator_says))) in
        workers.into_iter().zip(all())
    {
        let end = worker.wait_for("worker: no coordinator answered at ");
        assert!(end.contains(worker_says), "no \"{worker_says}\" in: {end}");
        assert_eq!(worker.end(), Some(1));
        if !coordinator_says.is_empty() {
            listening.wait_for(coordinator_says);
        }
    }
}

#[test]
fn refusals_are_explained_on_both_sides() {
    if !has_openssl("refusals of TLS") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let own = certificates(&path.join("ours"), HOST);
        let other_name = certificates(&path.join("ours"), "other.example");
        let visitor = certificates(&path.join("ours"), "worker:visitor.example");
        let theirs = certificates(&path.join("theirs"), HOST);
        let mixed = certificates(&path.join("mixed"), HOST);
        std::fs::copy(own.join("ca.pem"), mixed.join("ca.pem")).unwrap();
        let tls = |own: &Path| configuration("zenoh-tls.json5", own);
        let users = with_users(&path.join("users"));
        let no_certificate = user(&own, "worker", "change-me");
        let plain = path.join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let dictionary = configuration("zenoh-password-coordinator.json5", &users);

        let mutual = start_coordinator(path, "mutual", "tls/127.0.0.1:0", Some(&tls(&own)));
        let named = start_coordinator(path, "named", "tls/127.0.0.1:0", Some(&tls(&other_name)));
        let password = start_coordinator(path, "password", "tls/127.0.0.1:0", Some(&dictionary));
        let denying = changed_configuration("zenoh-tls-coordinator.json5", &own, &[(NAMED, "\"127.0.0.1\"")]);
        let denying = start_coordinator(path, "denying", "tls/127.0.0.1:0", Some(&denying));
        let open = start_coordinator(path, "open", "tcp/127.0.0.1:0", None);

        let nobody = path.join("nobody");
        std::fs::create_dir_all(&nobody).unwrap();
        std::fs::copy(users.join("ca.pem"), nobody.join("ca.pem")).unwrap();
        let no_user = [("user: \"worker\",", ""), ("password: \"change-me\",", "")];
        let no_user = changed_configuration("zenoh-password-worker.json5", &nobody, &no_user);
        let says = "refuses our user and password";
        let [ours, others, mixed, visitor] = [&own, &theirs, &mixed, &visitor].map(|own| tls(own));
        let [guess, guest] = [("worker", "guess"), ("guest", "guess")].map(|(n, p)| user(&users, n, p));
        let of_mutual: [Case<'_>; 4] = [
            (
                &others,
                "tls",
                "signed by another authority than root_ca_certificate",
                "the client does not accept this coordinator's certificate: it was signed",
            ),
            (
                &mixed,
                "tls",
                "does not accept our certificate",
                "the client certificate was signed by another authority",
            ),
            (
                &no_certificate,
                "tls",
                "requires a client certificate, and --config names none",
                "no client certificate given",
            ),
            (&plain, "tcp", "does the coordinator listen with tls/", "the client does not use TLS"),
        ];
        let of_named: [Case<'_>; 1] =
            [(&ours, "tls", "certificate is for another name", "it does not list the name used to connect")];
        let of_password: [Case<'_>; 3] = [
            (&guess, "tls", says, "wrong password"),
            (&guest, "tls", says, "the user is not in the dictionary"),
            (&no_user, "tls", says, "no user and password given"),
        ];
        // The certificate is accepted, but access_control drops every message: both sides report it.
        let of_denying: [Case<'_>; 1] =
            [(&visitor, "tls", "access_control does not permit the query", "connected without access")];
        let of_open: [Case<'_>; 1] = [(&ours, "tls", "tls/ where the coordinator listens with tcp/", "")];
        refused(&[
            (&mutual, &of_mutual),
            (&named, &of_named),
            (&password, &of_password),
            (&denying, &of_denying),
            (&open, &of_open),
        ]);
    });
}

/// Beyond its number of sessions, a coordinator names the number, and both sides name the remedy. Those connected stay.
#[test]
fn a_full_coordinator_says_how_many_sessions_it_accepts() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let few = folder.path().join("few.json5");
        std::fs::write(&few, "{ transport: { unicast: { max_sessions: 1 } } }").unwrap();
        let plain = folder.path().join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let listening = start_coordinator(folder.path(), "full", "tcp/127.0.0.1:0", Some(&few));
        // The coordinator's own first question may have the one session for a moment.
        let begun = Instant::now();
        let connected = loop {
            match try_session(&plain, &listening.1) {
                Ok(session) => break session,
                Err(error) => assert!(begun.elapsed() < Duration::from_secs(30), "no session: {error}"),
            }
            std::thread::sleep(Duration::from_millis(50));
        };
        let case: Case<'_> = (
            plain.as_path(),
            "tcp",
            "it has as many sessions as it accepts (a coordinator 4000, unless its log names another number)",
            "there are 1 sessions, as many as are accepted",
        );
        refused(&[(&listening, &[case])]);
        let replies = connected.get(keys::STATUS).timeout(PATIENCE).wait().unwrap();
        assert!(replies.recv().unwrap().result().is_ok());
    });
}

/// Every frame carries the protocol version; the coordinator names a worker of another version in its log.
#[test]
fn another_version_is_named_on_both_sides() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let (coordinator, endpoint) = start_coordinator(folder.path(), "study", "tcp/127.0.0.1:0", None);
        let plain = folder.path().join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let newer = session(&plain, &endpoint);
        let mut frame = wire::encode(&Notice::Ended { campaign: 1 }).unwrap();
        frame[4..6].copy_from_slice(&(PROTOCOL_VERSION + 1).to_le_bytes());
        let replies =
            newer.get(format!("{}?worker=newer", keys::CLAIM)).payload(frame).timeout(PATIENCE).wait();
        assert!(replies.unwrap().recv().unwrap().result().is_ok());
        let says = format!("worker newer is refused: it uses protocol version {}", PROTOCOL_VERSION + 1);
        coordinator.wait_for(&says);
    });
}

/// A client that acts as the coordinator, and claims that are no longer the newest, have no effect and are logged.
#[test]
fn issue_forged_ends_and_answers_and_outdated_claims_were_refused_in_silence() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let plain = folder.path().join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let listening = start_coordinator(folder.path(), "forged", "tcp/127.0.0.1:0", None);
        forged_messages_are_logged(&listening, &plain);
    });
}

/// With mutual TLS every client has a certificate of the authority: that of a worker does not make it the coordinator.
#[test]
fn a_workers_certificate_cannot_act_as_the_coordinator() {
    if !has_openssl("forged messages with a worker's certificate") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = configuration("zenoh-tls.json5", &certificates(folder.path(), HOST));
        let worker = configuration("zenoh-tls.json5", &certificates(folder.path(), "worker:hand"));
        let listening = start_coordinator(folder.path(), "forged", "tls/127.0.0.1:0", Some(&own));
        forged_messages_are_logged(&listening, &worker);
    });
}

fn forged_messages_are_logged((coordinator, endpoint): &(LoggedProcess, String), client: &Path) {
    // Its workers follow the notices, so that the key is known.
    let other = session(client, endpoint);
    let _notices = other.declare_subscriber(keys::NOTICE).callback(|_| ()).wait().unwrap();
    let thief = session(client, endpoint);
    let end = wire::encode(&Notice::Ended { campaign: 5 }).unwrap();
    thief.put(keys::NOTICE, end).wait().unwrap();
    coordinator.wait_for("tried to act as the coordinator and was refused: Put on hingewise/notice");
    let _answers = thief.declare_queryable(keys::CLAIM).callback(|_| ()).wait().unwrap();
    coordinator.wait_for("was refused: Declare Queryable on hingewise/claim");
    let worker = WorkerId { name: "late".into(), epoch: 1 };
    let _token = other.liveliness().declare_token(keys::alive(&worker)).wait().unwrap();
    let claim = Claim {
        worker,
        sequence: 2,
        offers: Offers::Scenes(Build::default()),
        slots: 1,
        credits: 0,
        holding: vec![],
        finished: vec![],
        leaving: false,
    };
    // The first of them may arrive before the token.
    for _ in 0..3 {
        let query = other.get(format!("{}?worker=late", keys::CLAIM)).payload(wire::encode(&claim).unwrap());
        query.wait().unwrap().recv().unwrap();
    }
    coordinator.wait_for("a claim of worker late is refused (1 so far): one with a later number");
}
