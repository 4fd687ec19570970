//! Workers that crash or leave, coordinators that stop acknowledging or restart: no outcome is lost, none is counted twice,
//! and finished evaluations are not repeated.

use coordinator::farm::evaluate::{EvaluateError, Evaluator};
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tests::process::Process;
use tests::{
    Barrier, Outcomes, PATIENCE, coordinator, coordinator_at, evaluate, expected, in_time, practice_result,
    requests, stop, worker, worker_at,
};
use worker::service::Departure;

/// A worker process whose simulations never end.
fn hanging_worker(endpoint: &str) -> Process {
    Process::start(Command::new(env!("CARGO_BIN_EXE_practice_worker")).args([endpoint, "hanging", "hang"]))
}

#[test]
fn the_task_of_a_killed_process_is_requeued_within_a_second() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let mut hanging = hanging_worker(&endpoint);
        assert!(coordinator.connected.wait_for(PATIENCE, |w| w.len() == 1));
        let killed = Arc::new(Mutex::new(None));
        let moment = Arc::clone(&killed);
        let other = std::thread::spawn(move || {
            assert_eq!(hanging.line("started", 1, PATIENCE).unwrap(), "0");
            let other = worker_at(&endpoint, "other", 1, practice_result);
            *moment.lock().unwrap() = Some(Instant::now());
            hanging.kill();
            other
        });
        let (mut outcomes, mut waited) = (Outcomes::new(), Duration::MAX);
        coordinator
            .evaluate(&requests(0..1), &mut |finished| {
                waited = killed.lock().unwrap().unwrap().elapsed();
                assert_eq!(finished.worker, "other/0");
                assert!(outcomes.insert(finished.id, finished.outcome).is_none());
                Ok(())
            })
            .unwrap();
        assert_eq!(outcomes, expected(0..1));
        assert!(waited < Duration::from_secs(1), "{waited:?}");
        coordinator.finish();
        assert_eq!(other.join().unwrap().join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn the_task_of_a_frozen_process_is_requeued_and_its_return_has_no_effect() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let frozen = Arc::new(hanging_worker(&endpoint));
        assert!(coordinator.connected.wait_for(PATIENCE, |w| w.len() == 1));
        let to_stop = Arc::clone(&frozen);
        let other = std::thread::spawn(move || {
            assert_eq!(to_stop.line("started", 1, PATIENCE).unwrap(), "0");
            to_stop.signal("STOP");
            worker_at(&endpoint, "other", 1, practice_result)
        });
        assert_eq!(evaluate(&mut coordinator, &requests(0..4)).unwrap(), expected(0..4));
        let other = other.join().unwrap();
        assert!(
            coordinator.connected.wait_for(PATIENCE, |w| w.len() == 1),
            "only the other worker is connected"
        );
        frozen.signal("CONT");
        assert!(coordinator.connected.wait_for(PATIENCE, |w| w.len() == 2), "it has reconnected");
        assert_eq!(evaluate(&mut coordinator, &requests(4..8)).unwrap(), expected(4..8));
        coordinator.finish();
        assert_eq!(other.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn the_tasks_of_an_aborted_worker_are_requeued_and_counted_once() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let (started, begun) = channel();
        let hold = Arc::new(Barrier::default());
        let held = Arc::clone(&hold);
        let vanishing = worker(&coordinator, "vanishing", 2, move |sample| {
            let _ = started.send(());
            held.pass();
            practice_result(sample)
        });
        let others = std::thread::spawn(move || {
            for _ in 0..2 {
                begun.recv_timeout(PATIENCE).unwrap();
            }
            let others = ["a", "b"].map(|name| worker_at(&endpoint, name, 1, practice_result));
            vanishing.stopper.abort();
            assert_eq!(vanishing.join().unwrap(), Departure::Aborted);
            // Its simulations end after the abort: their outcomes are discarded.
            hold.open();
            others
        });
        assert_eq!(evaluate(&mut coordinator, &requests(0..30)).unwrap(), expected(0..30));
        coordinator.finish();
        for other in others.join().unwrap() {
            assert_eq!(other.join().unwrap(), Departure::CampaignEnded);
        }
    });
}

#[test]
fn a_stopped_worker_returns_its_task() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let (started, begun) = channel();
        let hold = Arc::new(Barrier::default());
        let held = Arc::clone(&hold);
        let leaving = worker(&coordinator, "leaving", 1, move |sample| {
            let _ = started.send(());
            held.pass();
            practice_result(sample)
        });
        let staying = std::thread::spawn(move || {
            begun.recv_timeout(PATIENCE).unwrap();
            leaving.stopper.stop();
            assert_eq!(leaving.join().unwrap(), Departure::Stopped { lost: 0 });
            worker_at(&endpoint, "staying", 1, practice_result)
        });
        assert_eq!(evaluate(&mut coordinator, &requests(0..8)).unwrap(), expected(0..8));
        hold.open();
        coordinator.finish();
        assert_eq!(staying.join().unwrap().join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn a_task_that_crashes_three_workers_is_given_up_and_the_others_are_evaluated() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let killing = std::thread::spawn(move || {
            for k in 0..3 {
                let (started, begun) = channel();
                let victim = worker_at(&endpoint, &format!("victim{k}"), 1, move |sample| {
                    // Evaluation 0 never ends.
                    if sample[0] == 0.0 {
                        let _ = started.send(());
                        loop {
                            std::thread::park();
                        }
                    }
                    practice_result(sample)
                });
                begun.recv_timeout(PATIENCE).unwrap();
                victim.stopper.abort();
                assert_eq!(victim.join().unwrap(), Departure::Aborted);
            }
            worker_at(&endpoint, "survivor", 1, practice_result)
        });
        let mut recorded = Outcomes::new();
        let error = coordinator.evaluate(&requests(0..6), &mut |finished| {
            recorded.insert(finished.id, finished.outcome);
            Ok(())
        });
        assert!(
            matches!(&error, Err(EvaluateError::GivenUp(0, reason)) if reason.contains("3 workers")),
            "{error:?}"
        );
        assert_eq!(recorded, expected(1..6));
        coordinator.finish();
        assert_eq!(killing.join().unwrap().join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn an_outcome_that_could_not_be_recorded_is_kept_by_its_worker() {
    in_time(|| {
        let mut coordinator = coordinator();
        let calls = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&calls);
        let handle = worker(&coordinator, "w", 1, move |sample| {
            count.fetch_add(1, Ordering::SeqCst);
            practice_result(sample)
        });
        let error = coordinator
            .evaluate(&requests(0..1), &mut |_| Err(EvaluateError::Record("the disk is full".into())));
        assert!(matches!(error, Err(EvaluateError::Record(_))));
        // Requested again, the outcome comes from the worker: simulated once.
        assert_eq!(evaluate(&mut coordinator, &requests(0..1)).unwrap(), expected(0..1));
        assert_eq!(calls.load(Ordering::SeqCst), 1);
        coordinator.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn a_worker_that_starts_before_its_coordinator_waits_for_it() {
    in_time(|| {
        let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", free.local_addr().unwrap());
        drop(free);
        let handle = worker_at(&endpoint, "early", 1, practice_result);
        let mut coordinator = coordinator_at(Some(&endpoint), Arc::default());
        assert_eq!(evaluate(&mut coordinator, &requests(0..3)).unwrap(), expected(0..3));
        coordinator.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
        // A worker without a coordinator can be stopped.
        let vain = worker_at(&endpoint, "vain", 1, practice_result);
        vain.stopper.stop();
        assert_eq!(vain.join().unwrap(), Departure::Stopped { lost: 0 });
    });
}

#[test]
fn a_restarted_coordinator_gets_outcomes_finished_while_it_was_down() {
    in_time(|| {
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut first = coordinator_at(None, Arc::clone(&interrupted));
        let endpoint = first.endpoints[0].clone();
        let calls = Arc::new(AtomicUsize::new(0));
        let hold = Arc::new(Barrier::default());
        let (count, held, flag) = (Arc::clone(&calls), Arc::clone(&hold), Arc::clone(&interrupted));
        let handle = worker_at(&endpoint, "w", 2, move |sample| {
            // Both slots are busy when the coordinator stops.
            if count.fetch_add(1, Ordering::SeqCst) == 1 {
                stop(&flag);
            }
            held.pass();
            practice_result(sample)
        });
        assert!(matches!(evaluate(&mut first, &requests(0..6)), Err(EvaluateError::Interrupted)));
        drop(first);
        hold.open();
        let mut second = coordinator_at(Some(&endpoint), Arc::default());
        assert_eq!(evaluate(&mut second, &requests(0..6)).unwrap(), expected(0..6));
        assert_eq!(calls.load(Ordering::SeqCst), 6, "each was simulated once");
        second.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
    });
}
