//! Who gets in, who does not, and what both sides say of it: certificates, users and passwords, access control, sizes.

use common::wire::{self, MAX_PAYLOAD, Notice, PROTOCOL_VERSION, WorkerId, keys};
use coordinator::dispatch::{Listen, ZenohEvaluator};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tests::deployed::{Talking, certificates, changed_configuration, configuration, has_openssl};
use tests::{
    PATIENCE, Practice, campaign, coordinator, evaluate, expected, in_time, practice_result, requests, worker,
};
use worker::service::{self, Departure, ServiceConfig, ServiceError, WorkerHandle};
use zenoh::{Config, Session, Wait};

const HOST: &str = "127.0.0.1";
/// Names in `zenoh-tls-coordinator.json5` of those who may work.
const NAMED: &str = "\"coordinator.example\", \"worker-1.example\", \"worker-2.example\"";

/// An open coordinator with this configuration; its endpoint under the name in its certificate.
fn open(config: PathBuf) -> (ZenohEvaluator, String) {
    // Not on loopback alone, and yet not refused.
    let listen = Listen { endpoint: Some("tls/0.0.0.0:0".into()), config: Some(config), insecure: false };
    let coordinator = ZenohEvaluator::open(campaign(), &listen, Arc::default()).unwrap();
    let port = coordinator.endpoints()[0].rsplit(':').next().unwrap().to_owned();
    (coordinator, format!("tls/{HOST}:{port}"))
}

fn worker_with(config: &Path, endpoint: &str, give_up_after: Duration) -> WorkerHandle {
    let config = ServiceConfig {
        zenoh_config: Some(config.to_owned()),
        give_up_after: Some(give_up_after),
        ..ServiceConfig::new(endpoint, 1)
    };
    service::spawn(config, Arc::new(Practice(practice_result))).unwrap()
}

/// A session that speaks no protocol of ours.
fn session(config: &Path, endpoint: &str) -> Session {
    let mut settings = Config::from_file(config).unwrap();
    for (key, value) in [
        ("mode", "\"client\""),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("listen/endpoints", "[]"),
        ("connect/endpoints", &format!("[\"{endpoint}\"]")),
    ] {
        settings.insert_json5(key, value).unwrap();
    }
    zenoh::open(settings).wait().unwrap()
}

/// Whether anybody answers a query on this key.
fn is_answered(session: &Session, key: &str) -> bool {
    let replies = session.get(key).timeout(Duration::from_secs(1)).wait().unwrap();
    replies.into_iter().any(|reply| {
        let refusal = reply.result().err().map(|error| error.payload().to_bytes().into_owned());
        // Zenoh's own word for a query that nobody has answered.
        refusal.is_none_or(|text| text != b"Timeout")
    })
}

/// Users of a coordinator with passwords, and its certificate; the folder.
fn with_users(folder: &Path) -> PathBuf {
    let own = certificates(folder, HOST);
    std::fs::write(
        own.join("users.txt"),
        "local:change-me-too\nworker:change-me\nlooker:look\nvisitor:visit\n",
    )
    .unwrap();
    own
}

/// The settings of a user.
fn user(own: &Path, name: &str, password: &str) -> PathBuf {
    let folder = own.join(format!("{name}-{password}"));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::copy(own.join("ca.pem"), folder.join("ca.pem")).unwrap();
    let (name, password) = (format!("user: \"{name}\""), format!("password: \"{password}\""));
    let changes = [("user: \"worker\"", name.as_str()), ("password: \"change-me\"", password.as_str())];
    changed_configuration("zenoh-password-worker.json5", &folder, &changes)
}

#[test]
fn certificates_let_workers_in_and_keep_strangers_out() {
    if !has_openssl("TLS") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(&folder.path().join("ours"), HOST);
        let stranger = certificates(&folder.path().join("theirs"), HOST);
        // They know our authority, as everybody may, but it does not know them.
        std::fs::copy(own.join("ca.pem"), stranger.join("ca.pem")).unwrap();
        let (mut coordinator, endpoint) = open(configuration("zenoh-tls.json5", &own));
        let refused =
            worker_with(&configuration("zenoh-tls.json5", &stranger), &endpoint, Duration::from_secs(1));
        assert!(matches!(refused.join(), Err(ServiceError::Unreachable { .. })));
        assert_eq!(coordinator.concurrency(), 0);
        let _welcome = worker_with(&configuration("zenoh-tls.json5", &own), &endpoint, PATIENCE);
        assert_eq!(evaluate(&mut coordinator, &requests(0..8)).unwrap(), expected(0..8));
        coordinator.finish();
    });
}

/// A certificate for a worker cannot listen as a coordinator, even where names are not looked at.
#[test]
fn a_workers_certificate_works_and_makes_no_coordinator() {
    if !has_openssl("certificates of workers") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(folder.path(), HOST);
        let hand = certificates(folder.path(), "worker:hand");
        let nameless = [("verify_name_on_connect: true", "verify_name_on_connect: false")];
        let config = changed_configuration("zenoh-tls.json5", &hand, &nameless);
        let (mut coordinator, endpoint) = open(configuration("zenoh-tls.json5", &own));
        let _welcome = worker_with(&config, &endpoint, PATIENCE);
        assert_eq!(evaluate(&mut coordinator, &requests(0..4)).unwrap(), expected(0..4));
        let (_false_one, endpoint) = open(config.clone());
        let careful = worker_with(&config, &endpoint, Duration::from_secs(1));
        assert!(matches!(careful.join(), Err(ServiceError::Unreachable { .. })));
        coordinator.finish();
    });
}

/// Under both configurations with access control: whoever may work works; whoever may not is heard by nobody, on keys of
/// the protocol or others; and whoever may work may do nothing else.
#[test]
fn access_control_lets_through_exactly_the_protocol() {
    if !has_openssl("access control") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(folder.path(), HOST);
        let stranger = certificates(folder.path(), "worker:visitor.example");
        let named = [(NAMED, "\"127.0.0.1\"")];
        let by_name = changed_configuration("zenoh-tls-coordinator.json5", &own, &named);
        let hands = [&own, &stranger].map(|folder| configuration("zenoh-tls.json5", folder));
        only_the_protocol(by_name, &hands[0], &hands[1]);

        let own = with_users(&folder.path().join("users"));
        let by_user = configuration("zenoh-password-coordinator.json5", &own);
        let [hand, stranger] = [("worker", "change-me"), ("visitor", "visit")].map(|(n, p)| user(&own, n, p));
        only_the_protocol(by_user.clone(), &hand, &stranger);
        // One who may look sees, and nobody sees him.
        let (_coordinator, endpoint) = open(by_user);
        let looker = session(&user(&own, "looker", "look"), &endpoint);
        assert!(is_answered(&looker, keys::STATUS) && !is_answered(&looker, keys::CLAIM));
    });
}

fn only_the_protocol(config: PathBuf, hand: &Path, stranger: &Path) {
    let (mut coordinator, endpoint) = open(config);
    let stranger = session(stranger, &endpoint);
    let insider = session(hand, &endpoint);
    for key in [keys::CLAIM, keys::STATUS, "hingewise/other", "elsewhere"] {
        assert!(!is_answered(&stranger, key), "{key}");
    }
    assert!(is_answered(&insider, keys::STATUS) && is_answered(&insider, keys::CLAIM));

    let served = worker_with(hand, &endpoint, PATIENCE);
    assert!(coordinator.wait_for_workers(PATIENCE, |workers| workers.len() == 1));
    let false_life = WorkerId { name: "false".into(), epoch: 1 };
    let _token = stranger.liveliness().declare_token(keys::alive(&false_life)).wait().unwrap();
    let (told, heard) = std::sync::mpsc::channel();
    let other_insider = session(hand, &endpoint);
    let _ear = other_insider
        .declare_subscriber("**")
        .callback(move |sample| _ = told.send(sample.key_expr().to_string()))
        .wait()
        .unwrap();
    for speaker in [&stranger, &insider] {
        // An end of the campaign that only the coordinator may tell, and claims that only it may take.
        let end = wire::encode(&Notice::Ended { campaign: campaign().id }).unwrap();
        speaker.put(keys::NOTICE, end).wait().unwrap();
        speaker.put("elsewhere", "anything").wait().unwrap();
        let thief =
            speaker.declare_queryable(keys::CLAIM).callback(|_| panic!("a claim was stolen")).wait().unwrap();
        // What was said before on the same line has come before the answer.
        assert_eq!(is_answered(speaker, keys::STATUS), std::ptr::eq(speaker, &insider));
        assert_eq!(evaluate(&mut coordinator, &requests(0..5)).unwrap(), expected(0..5));
        thief.undeclare().wait().unwrap();
    }
    assert_eq!(coordinator.workers().len(), 1, "a stranger's sign of life was seen");
    assert!(!served.has_ended());
    assert_eq!(heard.try_iter().filter(|key| key != keys::NOTICE).collect::<Vec<_>>(), Vec::<String>::new());
    coordinator.finish();
    assert_eq!(served.join().unwrap(), Departure::CampaignEnded);
}

#[test]
fn the_access_rules_name_the_keys_of_the_protocol_and_no_other() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["zenoh-tls-coordinator.json5", "zenoh-password-coordinator.json5", "zenoh-router.json5"] {
        let config = Config::from_file(configuration(name, folder.path())).unwrap();
        let rules: serde_json::Value =
            serde_json::from_str(&config.get_json("access_control/rules").unwrap()).unwrap();
        let named: BTreeSet<String> = rules
            .as_array()
            .unwrap()
            .iter()
            .filter(|rule| rule["id"] != "trunk")
            .flat_map(|rule| rule["key_exprs"].as_array().unwrap().clone())
            .map(|key| key.as_str().unwrap().to_owned())
            .collect();
        let ours = [keys::CLAIM, keys::NOTICE, keys::STATUS, keys::ALIVE_ALL].map(str::to_owned);
        assert_eq!(named, BTreeSet::from(ours), "{name}");
        assert_eq!(config.get_json("access_control/default_permission").unwrap(), "\"deny\"", "{name}");
    }
}

/// A coordinator as a process, and the endpoint under which it says that it waits.
fn talking(folder: &Path, name: &str, endpoint: &str, config: Option<&Path>) -> (Talking, String) {
    let out = folder.join(name);
    let mut arguments = vec!["run", "--scene", "four-bar", "--workers", "0", "--listen", endpoint, "--out"];
    arguments.push(out.to_str().unwrap());
    if let Some(config) = config {
        arguments.extend(["--config", config.to_str().unwrap()]);
    }
    let coordinator = Talking::start("coordinator", &arguments);
    let endpoint = coordinator.hear("waiting for workers: worker --connect ");
    (coordinator, endpoint)
}

/// Workers that are refused, with what they and the coordinator say.
fn refused(coordinator: &(Talking, String), cases: &[(&Path, &str, &str, &str)]) {
    let (listening, endpoint) = coordinator;
    let workers: Vec<Talking> = cases
        .iter()
        .map(|(config, protocol, ..)| {
            let endpoint =
                format!("{protocol}{}", endpoint.trim_start_matches("tls").trim_start_matches("tcp"));
            let config = config.to_str().unwrap();
            let arguments =
                ["--connect", &endpoint, "--slots", "1", "--give-up-after", "2", "--config", config];
            Talking::start("worker", &arguments)
        })
        .collect();
    for (mut worker, (_, _, worker_says, coordinator_says)) in workers.into_iter().zip(cases) {
        let end = worker.hear("worker: no coordinator answered at ");
        assert!(end.contains(worker_says), "no \"{worker_says}\" in: {end}");
        assert_eq!(worker.end(), Some(1));
        if !coordinator_says.is_empty() {
            listening.hear(coordinator_says);
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

        let mutual = talking(path, "mutual", "tls/127.0.0.1:0", Some(&tls(&own)));
        let named = talking(path, "named", "tls/127.0.0.1:0", Some(&tls(&other_name)));
        let password = talking(path, "password", "tls/127.0.0.1:0", Some(&dictionary));
        let denying = changed_configuration("zenoh-tls-coordinator.json5", &own, &[(NAMED, "\"127.0.0.1\"")]);
        let denying = talking(path, "denying", "tls/127.0.0.1:0", Some(&denying));
        let open = talking(path, "open", "tcp/127.0.0.1:0", None);

        refused(
            &mutual,
            &[
                (
                    &tls(&theirs),
                    "tls",
                    "signed by another authority than root_ca_certificate",
                    "its authority is another one",
                ),
                (
                    &tls(&mixed),
                    "tls",
                    "does not accept this worker's certificate",
                    "its certificate was signed by another authority",
                ),
                (
                    &no_certificate,
                    "tls",
                    "asks for a certificate and --config shows none",
                    "it showed no certificate",
                ),
                (&plain, "tcp", "does the coordinator listen with tls/", "it does not speak TLS"),
            ],
        );
        refused(
            &named,
            &[(
                &tls(&own),
                "tls",
                "certificate is for another name",
                "the name it connects to does not stand in it",
            )],
        );
        let nobody = path.join("nobody");
        std::fs::create_dir_all(&nobody).unwrap();
        std::fs::copy(users.join("ca.pem"), nobody.join("ca.pem")).unwrap();
        let no_user = [("user: \"worker\",", ""), ("password: \"change-me\",", "")];
        let no_user = changed_configuration("zenoh-password-worker.json5", &nobody, &no_user);
        let says = "refuses this worker's user and password";
        refused(
            &password,
            &[
                (&user(&users, "worker", "guess"), "tls", says, "it gave a wrong password"),
                (
                    &user(&users, "guest", "guess"),
                    "tls",
                    says,
                    "it gave a user that is not in the dictionary",
                ),
                (&no_user, "tls", says, "it gave no user and password"),
            ],
        );
        // Let in by the authority, and then heard by nobody: the registration comes to an end that says so.
        refused(
            &denying,
            &[(
                &tls(&visitor),
                "tls",
                "access_control does not let this worker ask",
                "connected without access",
            )],
        );
        refused(&open, &[(&tls(&own), "tls", "tls/ where the coordinator listens with tcp/", "")]);
    });
}

#[test]
fn a_message_larger_than_any_of_ours_is_not_put_together_and_hurts_nobody() {
    in_time(|| {
        let mut coordinator = coordinator();
        let folder = tempfile::tempdir().unwrap();
        let plain = folder.path().join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let flood = session(&plain, &coordinator.endpoints()[0]);
        let replies =
            flood.get(keys::CLAIM).payload(vec![0u8; 4 * MAX_PAYLOAD]).timeout(Duration::from_secs(1));
        let answered = replies.wait().unwrap().into_iter().any(|reply| reply.result().is_ok());
        assert!(!answered);
        let hand = worker(&coordinator, "w", 1, practice_result);
        assert_eq!(evaluate(&mut coordinator, &requests(0..8)).unwrap(), expected(0..8));
        coordinator.finish();
        assert_eq!(hand.join().unwrap(), Departure::CampaignEnded);
    });
}

/// Two sites, each with a router made of the same file: a worker behind the far one gets its work, somebody whom its
/// router does not name is heard by nobody.
#[test]
fn workers_of_another_site_work_through_routers() {
    if !has_openssl("routers") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(folder.path(), HOST);
        let hand = certificates(folder.path(), "worker:worker-1.example");
        let stranger = certificates(folder.path(), "worker:visitor.example");
        let trunk = (
            "\"coordinator.example\", \"gateway.site-a.example\", \"gateway.site-b.example\"",
            "\"127.0.0.1\"",
        );
        let router = |site: &str, towards: &str| {
            let at_site = folder.path().join(site);
            std::fs::create_dir_all(&at_site).unwrap();
            for file in ["ca.pem", "certificate.pem", "key.pem"] {
                std::fs::copy(own.join(file), at_site.join(file)).unwrap();
            }
            let up = ("tls/coordinator.example:7447", towards);
            let changes = [trunk, ("tls/0.0.0.0:7447", "tls/127.0.0.1:0"), up];
            let config =
                Config::from_file(changed_configuration("zenoh-router.json5", &at_site, &changes)).unwrap();
            let router = zenoh::open(config).wait().unwrap();
            let endpoint = router.info().locators().wait()[0].to_string();
            (router, endpoint)
        };
        let (mut coordinator, at_coordinator) = open(configuration("zenoh-tls.json5", &own));
        let (_near, at_near) = router("near", &at_coordinator);
        let (_far, at_far) = router("far", &at_near);
        let stranger = session(&configuration("zenoh-tls.json5", &stranger), &at_far);
        let hand = worker_with(&configuration("zenoh-tls.json5", &hand), &at_far, PATIENCE);
        assert!(
            coordinator.wait_for_workers(PATIENCE, |workers| workers.len() == 1),
            "no sign of life came through"
        );
        assert_eq!(evaluate(&mut coordinator, &requests(0..20)).unwrap(), expected(0..20));
        assert!(!is_answered(&stranger, keys::CLAIM) && !is_answered(&stranger, keys::STATUS));
        coordinator.finish();
        assert_eq!(hand.join().unwrap(), Departure::CampaignEnded);
    });
}

/// The version stands in every frame: what the worker says of another one, and the coordinator of it, is told in words.
#[test]
fn another_version_is_named_on_both_sides() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let (coordinator, endpoint) = talking(folder.path(), "study", "tcp/127.0.0.1:0", None);
        let plain = folder.path().join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let newer = session(&plain, &endpoint);
        let mut frame = wire::encode(&Notice::Ended { campaign: 1 }).unwrap();
        frame[4..6].copy_from_slice(&(PROTOCOL_VERSION + 1).to_le_bytes());
        let replies =
            newer.get(format!("{}?worker=newer", keys::CLAIM)).payload(frame).timeout(PATIENCE).wait();
        assert!(replies.unwrap().recv().unwrap().result().is_ok());
        let says = format!("worker newer is refused: it speaks protocol version {}", PROTOCOL_VERSION + 1);
        coordinator.hear(&says);
    });
}
