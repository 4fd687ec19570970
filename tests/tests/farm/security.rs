//! Authentication and permissions: certificates, users and passwords, access control, routers, message sizes.

use common::wire::{self, MAX_PAYLOAD, Notice, WorkerId, keys};
use coordinator::farm::dispatch::{Listen, ZenohEvaluator};
use coordinator::farm::evaluate::Evaluator;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tests::deployed::{
    HOST, NAMED, certificates, changed_configuration, configuration, has_openssl, session, user, with_users,
};
use tests::{
    ClosureSimulator, PATIENCE, campaign, coordinator, evaluate, expected, in_time, practice_result,
    requests, worker,
};
use worker::service::{self, Departure, ServiceConfig, ServiceError, WorkerHandle};
use zenoh::{Session, Wait};

/// A listening coordinator with this configuration, and its endpoint with the name in its certificate.
fn open(config: PathBuf) -> (ZenohEvaluator, String) {
    // Not a loopback address: accepted because the configuration authenticates clients.
    let listen = Listen { endpoint: Some("tls/0.0.0.0:0".into()), config: Some(config), insecure: false };
    let coordinator = ZenohEvaluator::open(campaign(), &listen, Arc::default()).unwrap();
    let port = coordinator.endpoints[0].rsplit(':').next().unwrap().to_owned();
    (coordinator, format!("tls/{HOST}:{port}"))
}

fn worker_with(config: &Path, endpoint: &str, give_up_after: Duration) -> WorkerHandle {
    let config = ServiceConfig {
        zenoh_config: Some(config.to_owned()),
        give_up_after: Some(give_up_after),
        ..ServiceConfig::new(endpoint, 1)
    };
    service::spawn(config, Arc::new(ClosureSimulator(practice_result))).unwrap()
}

/// True if a query on this key gets a reply.
fn is_answered(session: &Session, key: &str) -> bool {
    let replies = session.get(key).timeout(Duration::from_secs(1)).wait().unwrap();
    replies.into_iter().any(|reply| {
        let refusal = reply.result().err().map(|error| error.payload().to_bytes().into_owned());
        // Zenoh's text for a query without a reply.
        refusal.is_none_or(|text| text != b"Timeout")
    })
}

#[test]
fn only_certificates_of_the_authority_are_accepted() {
    if !has_openssl("TLS") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(&folder.path().join("ours"), HOST);
        let stranger = certificates(&folder.path().join("theirs"), HOST);
        // This client trusts the authority, but its certificate comes from another one.
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

/// A certificate for a worker is refused for listening, even if host names are not verified.
#[test]
fn a_workers_certificate_can_connect_and_not_listen() {
    if !has_openssl("certificates of workers") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(folder.path(), HOST);
        let own_worker = certificates(folder.path(), "worker:hand");
        let nameless = [("verify_name_on_connect: true", "verify_name_on_connect: false")];
        let config = changed_configuration("zenoh-tls.json5", &own_worker, &nameless);
        let (mut coordinator, endpoint) = open(configuration("zenoh-tls.json5", &own));
        let _welcome = worker_with(&config, &endpoint, PATIENCE);
        assert_eq!(evaluate(&mut coordinator, &requests(0..4)).unwrap(), expected(0..4));
        let (_false_one, endpoint) = open(config.clone());
        let careful = worker_with(&config, &endpoint, Duration::from_secs(1));
        assert!(matches!(careful.join(), Err(ServiceError::Unreachable { .. })));
        coordinator.finish();
    });
}

/// For both configurations with access control: a permitted worker gets tasks; messages of other clients are dropped, on
/// keys of the protocol and on others; and a permitted worker can send nothing beyond the protocol.
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
        let workers = [&own, &stranger].map(|folder| configuration("zenoh-tls.json5", folder));
        only_the_protocol(by_name, &workers[0], &workers[1]);

        let own = with_users(&folder.path().join("users"));
        let by_user = configuration("zenoh-password-coordinator.json5", &own);
        let [permitted, stranger] =
            [("worker", "change-me"), ("visitor", "visit")].map(|(n, p)| user(&own, n, p));
        only_the_protocol(by_user.clone(), &permitted, &stranger);
        // A user with permission for the status can query it, and cannot claim.
        let (_coordinator, endpoint) = open(by_user);
        let looker = session(&user(&own, "looker", "look"), &endpoint);
        assert!(is_answered(&looker, keys::STATUS) && !is_answered(&looker, keys::CLAIM));
    });
}

fn only_the_protocol(config: PathBuf, permitted: &Path, stranger: &Path) {
    let (mut coordinator, endpoint) = open(config);
    let stranger = session(stranger, &endpoint);
    let insider = session(permitted, &endpoint);
    for key in [keys::CLAIM, keys::STATUS, "hingewise/other", "elsewhere"] {
        assert!(!is_answered(&stranger, key), "{key}");
    }
    assert!(is_answered(&insider, keys::STATUS) && is_answered(&insider, keys::CLAIM));

    let served = worker_with(permitted, &endpoint, PATIENCE);
    assert!(coordinator.connected.wait_for(PATIENCE, |workers| workers.len() == 1));
    let false_worker = WorkerId { name: "false".into(), epoch: 1 };
    let _token = stranger.liveliness().declare_token(keys::alive(&false_worker)).wait().unwrap();
    let (sender, received) = std::sync::mpsc::channel();
    let other_insider = session(permitted, &endpoint);
    let _subscriber = other_insider
        .declare_subscriber("**")
        .callback(move |sample| _ = sender.send(sample.key_expr().to_string()))
        .wait()
        .unwrap();
    for client in [&stranger, &insider] {
        // A notice that only the coordinator may publish, and a queryable that only it may declare.
        let end = wire::encode(&Notice::Ended { campaign: campaign().id }).unwrap();
        client.put(keys::NOTICE, end).wait().unwrap();
        client.put("elsewhere", "anything").wait().unwrap();
        let thief =
            client.declare_queryable(keys::CLAIM).callback(|_| panic!("a claim was stolen")).wait().unwrap();
        // Earlier messages on the same connection have arrived before this reply.
        assert_eq!(is_answered(client, keys::STATUS), std::ptr::eq(client, &insider));
        assert_eq!(evaluate(&mut coordinator, &requests(0..5)).unwrap(), expected(0..5));
        thief.undeclare().wait().unwrap();
    }
    assert_eq!(coordinator.workers().len(), 1, "a liveliness token without permission was accepted");
    assert!(!served.has_ended());
    assert_eq!(
        received.try_iter().filter(|key| key != keys::NOTICE).collect::<Vec<_>>(),
        Vec::<String>::new()
    );
    coordinator.finish();
    assert_eq!(served.join().unwrap(), Departure::CampaignEnded);
}

#[test]
fn the_access_rules_name_exactly_the_keys_of_the_protocol() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["zenoh-tls-coordinator.json5", "zenoh-password-coordinator.json5", "zenoh-router.json5"] {
        let config = sessions::configuration(Some(&configuration(name, folder.path()))).unwrap();
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

#[test]
fn a_message_above_the_size_limit_is_dropped_without_effect() {
    in_time(|| {
        let mut coordinator = coordinator();
        let folder = tempfile::tempdir().unwrap();
        let plain = folder.path().join("plain.json5");
        std::fs::write(&plain, "{}").unwrap();
        let flood = session(&plain, &coordinator.endpoints[0]);
        let replies =
            flood.get(keys::CLAIM).payload(vec![0u8; 4 * MAX_PAYLOAD]).timeout(Duration::from_secs(1));
        let answered = replies.wait().unwrap().into_iter().any(|reply| reply.result().is_ok());
        assert!(!answered);
        let handle = worker(&coordinator, "w", 1, practice_result);
        assert_eq!(evaluate(&mut coordinator, &requests(0..8)).unwrap(), expected(0..8));
        coordinator.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
    });
}

/// Two sites, each with a router of the same configuration: a worker behind the remote router gets tasks; messages of a
/// client that its router does not list are dropped.
#[test]
fn workers_of_another_site_work_through_routers() {
    if !has_openssl("routers") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(folder.path(), HOST);
        let handle = certificates(folder.path(), "worker:worker-1.example");
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
            let configuration = changed_configuration("zenoh-router.json5", &at_site, &changes);
            let config = sessions::configuration(Some(&configuration)).unwrap();
            let router = sessions::open(config).unwrap();
            let endpoint = router.info().locators().wait()[0].to_string();
            (router, endpoint)
        };
        let (mut coordinator, at_coordinator) = open(configuration("zenoh-tls.json5", &own));
        let (_near, at_near) = router("near", &at_coordinator);
        let (_far, at_far) = router("far", &at_near);
        let stranger = session(&configuration("zenoh-tls.json5", &stranger), &at_far);
        let handle = worker_with(&configuration("zenoh-tls.json5", &handle), &at_far, PATIENCE);
        assert!(
            coordinator.connected.wait_for(PATIENCE, |workers| workers.len() == 1),
            "the liveliness token did not arrive"
        );
        assert_eq!(evaluate(&mut coordinator, &requests(0..20)).unwrap(), expected(0..20));
        assert!(!is_answered(&stranger, keys::CLAIM) && !is_answered(&stranger, keys::STATUS));
        coordinator.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
    });
}
