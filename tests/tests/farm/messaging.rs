//! Coordinator and in-process workers over Zenoh, without faults: the outcomes do not depend on the workers, a late worker
//! gets its share, and a refused worker gets the reason.

use common::wire::{self, Claim, Next, Offers, PROTOCOL_VERSION, Reply, WireError, WorkerId, keys};
use coordinator::farm::dispatch::{DispatchError, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{EvaluateError, Evaluator};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use tests::{
    Barrier, PATIENCE, campaign, coordinator, coordinator_at, evaluate, expected, foreign_session, in_time,
    practice_result, requests, stop, worker, worker_at,
};
use worker::service::{Departure, ServiceError};
use zenoh::{Session, Wait};

/// Reply of the coordinator to a claim with this payload.
fn answer_to(session: &Session, payload: Vec<u8>) -> Result<Vec<u8>, String> {
    let replies = session.get(keys::CLAIM).payload(payload).timeout(PATIENCE).wait().unwrap();
    let reply = replies.recv_timeout(PATIENCE).unwrap().expect("the coordinator answers");
    match reply.into_result() {
        Ok(sample) => Ok(sample.payload().to_bytes().into_owned()),
        Err(error) => Err(String::from_utf8_lossy(&error.payload().to_bytes()).into_owned()),
    }
}

fn claim_of(name: &str) -> Claim {
    Claim {
        worker: WorkerId { name: name.into(), epoch: 1 },
        sequence: 1,
        offers: Offers::Scenes(worker::BUILD),
        slots: 1,
        credits: 1,
        holding: vec![],
        finished: vec![],
        leaving: false,
    }
}

fn as_version(version: u16, mut frame: Vec<u8>) -> Vec<u8> {
    frame[4..6].copy_from_slice(&version.to_le_bytes());
    frame
}

#[test]
fn one_two_or_four_workers_give_the_same_outcomes() {
    in_time(|| {
        for workers in [1, 2, 4] {
            let mut coordinator = coordinator();
            let handles: Vec<_> = (0..workers)
                .map(|k| worker(&coordinator, &format!("w{k}"), 1 + k % 2, practice_result))
                .collect();
            // Two batches with the same coordinator and workers.
            assert_eq!(evaluate(&mut coordinator, &requests(0..60)).unwrap(), expected(0..60));
            assert_eq!(evaluate(&mut coordinator, &requests(60..75)).unwrap(), expected(60..75));
            coordinator.finish();
            for handle in handles {
                assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
            }
        }
    });
}

#[test]
fn the_coordinator_lists_connected_workers_and_their_slots() {
    in_time(|| {
        let coordinator = coordinator();
        let handles =
            [worker(&coordinator, "a", 3, practice_result), worker(&coordinator, "b", 2, practice_result)];
        assert!(coordinator.connected.wait_for(PATIENCE, |w| w.iter().map(|w| w.slots).sum::<u32>() == 5));
        assert_eq!(coordinator.concurrency(), 5);
        let names: Vec<String> = coordinator.workers().into_iter().map(|w| w.name).collect();
        assert_eq!(names, ["a", "b"]);
        let [a, b] = handles;
        a.stopper.stop();
        assert_eq!(a.join().unwrap(), Departure::Stopped { lost: 0 });
        assert!(coordinator.connected.wait_for(PATIENCE, |w| w.len() == 1));
        b.stopper.abort();
        assert_eq!(b.join().unwrap(), Departure::Aborted);
        assert!(coordinator.connected.wait_for(PATIENCE, <[_]>::is_empty));
    });
}

#[test]
fn a_late_joiner_takes_its_share() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let (first, joined) = channel();
        let share = Arc::new(AtomicUsize::new(0));
        let enough = Arc::new(Barrier::default());
        // The early worker evaluates one task, then waits until the late one has evaluated ten.
        let wait = Arc::clone(&enough);
        let early = worker(&coordinator, "early", 1, move |sample| {
            if first.send(()).is_err() || sample[0] > 0.0 {
                wait.pass();
            }
            practice_result(sample)
        });
        let (count, gate) = (Arc::clone(&share), Arc::clone(&enough));
        let late = std::thread::spawn(move || {
            joined.recv_timeout(PATIENCE).unwrap();
            worker_at(&endpoint, "late", 1, move |sample| {
                if count.fetch_add(1, Ordering::SeqCst) + 1 == 10 {
                    gate.open();
                }
                practice_result(sample)
            })
        });
        assert_eq!(evaluate(&mut coordinator, &requests(0..40)).unwrap(), expected(0..40));
        assert!(share.load(Ordering::SeqCst) >= 10);
        coordinator.finish();
        assert_eq!(early.join().unwrap(), Departure::CampaignEnded);
        assert_eq!(late.join().unwrap().join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn a_stopped_study_ends_at_once() {
    in_time(|| {
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut coordinator = coordinator_at(None, Arc::clone(&interrupted));
        let (hold, flag) = (Arc::new(Barrier::default()), Arc::clone(&interrupted));
        let held = Arc::clone(&hold);
        let handle = worker(&coordinator, "w", 1, move |sample| {
            if sample[0] == 2.0 {
                stop(&flag);
                held.pass();
            }
            practice_result(sample)
        });
        let mut recorded = vec![];
        let error = coordinator.evaluate(&requests(0..5), &mut |finished| {
            recorded.push(finished.id);
            Ok(())
        });
        assert!(matches!(error, Err(EvaluateError::Interrupted)), "{error:?}");
        // The outcome of 1 may not have arrived yet: then it stays with its worker.
        assert!(recorded == [0] || recorded == [0, 1], "{recorded:?}");
        hold.open();
        handle.stopper.stop();
        // Evaluation 2 may have ended meanwhile; its outcome is no longer needed.
        assert!(matches!(handle.join().unwrap(), Departure::Stopped { .. }));
    });
}

#[test]
fn a_worker_of_another_version_is_refused_without_effect_on_others() {
    in_time(|| {
        let mut coordinator = coordinator();
        let session = foreign_session("connect/endpoints", &coordinator.endpoints[0]);
        let frame = as_version(PROTOCOL_VERSION + 1, wire::encode(&claim_of("newer")).unwrap());
        // The frame of the reply carries the version of the coordinator, which the newer worker refuses.
        let answer = answer_to(&session, frame).unwrap();
        assert_eq!(u16::from_le_bytes([answer[4], answer[5]]), PROTOCOL_VERSION);
        let ours = worker(&coordinator, "ours", 1, practice_result);
        assert_eq!(evaluate(&mut coordinator, &requests(0..5)).unwrap(), expected(0..5));
        coordinator.finish();
        assert_eq!(ours.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn a_worker_refuses_a_coordinator_of_another_version() {
    in_time(|| {
        let session = foreign_session("listen/endpoints", "tcp/127.0.0.1:0");
        let endpoint = session.info().locators().wait()[0].to_string();
        let reply = Reply { acknowledged: vec![], next: Next::Idle { ask_again: 10 } };
        let frame = as_version(PROTOCOL_VERSION + 4, wire::encode(&reply).unwrap());
        let _queryable = session
            .declare_queryable(keys::CLAIM)
            .callback(move |query| query.reply(keys::CLAIM, frame.clone()).wait().unwrap())
            .wait()
            .unwrap();
        let error = worker_at(&endpoint, "w", 1, practice_result).join().unwrap_err();
        assert!(
            matches!(&error, ServiceError::OtherVersion { theirs, ours, .. }
                if (*theirs, *ours) == (PROTOCOL_VERSION + 4, PROTOCOL_VERSION)),
            "{error}"
        );
    });
}

#[test]
fn malformed_claims_have_no_effect() {
    in_time(|| {
        let mut coordinator = coordinator();
        let session = foreign_session("connect/endpoints", &coordinator.endpoints[0]);
        let valid = wire::encode(&claim_of("stranger")).unwrap();
        for length in 0..valid.len() {
            assert!(answer_to(&session, valid[..length].to_vec()).is_err());
        }
        for value in 0..=255u8 {
            assert!(answer_to(&session, vec![value; 3 * usize::from(value)]).is_err());
        }
        // A valid claim without a liveliness token gets a reply and no task.
        let handle = worker(&coordinator, "w", 1, practice_result);
        assert_eq!(evaluate(&mut coordinator, &requests(0..20)).unwrap(), expected(0..20));
        let reply: Result<Reply, WireError> = wire::decode(&answer_to(&session, valid).unwrap());
        assert!(matches!(reply.unwrap().next, Next::Idle { .. }));
        coordinator.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn an_address_open_to_other_machines_requires_insecure() {
    let open = |endpoint: &str, insecure| {
        let listen = Listen { endpoint: Some(endpoint.into()), config: None, insecure };
        ZenohEvaluator::open(campaign(), &listen, Arc::default())
    };
    let error = open("tcp/0.0.0.0:0", false).unwrap_err();
    assert!(matches!(&error, DispatchError::Insecure(endpoint) if endpoint == "tcp/0.0.0.0:0"));
    assert!(error.is_bad_input());
    assert!(!open("tcp/0.0.0.0:0", true).unwrap().endpoints.is_empty());
    // An address in use is reported with its endpoint.
    let first = coordinator();
    let error = open(&first.endpoints[0], false).unwrap_err();
    assert!(matches!(&error, DispatchError::Endpoint(endpoint, ..) if endpoint == &first.endpoints[0]));
}
