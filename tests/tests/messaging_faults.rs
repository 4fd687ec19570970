//! Workers that die or leave, coordinators that stop acknowledging or restart: nothing is lost, nothing counted
//! twice, and what was finished is not done again.

use coordinator::farm::evaluate::{EvaluateError, Evaluator};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tests::{
    Barrier, Outcomes, PATIENCE, coordinator, coordinator_at, evaluate, expected, in_time, practice_result,
    requests, stop, worker, worker_at,
};
use worker::service::Departure;

/// A worker that never ends its simulations, in a process of its own.
struct Hanging {
    child: Child,
    started: Receiver<String>,
}

impl Hanging {
    fn start(endpoint: &str) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_practice_worker"))
            .args([endpoint, "hanging", "hang"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let (line, started) = channel();
        std::thread::spawn(move || lines.map_while(Result::ok).try_for_each(|said| line.send(said)));
        Self { child, started }
    }
}

impl Drop for Hanging {
    fn drop(&mut self) {
        // Ended already in the tests that end it themselves.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn what_a_killed_process_held_is_done_elsewhere_within_a_second() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints()[0].clone();
        let mut hanging = Hanging::start(&endpoint);
        assert!(coordinator.wait_for_workers(PATIENCE, |w| w.len() == 1));
        let killed = Arc::new(Mutex::new(None));
        let moment = Arc::clone(&killed);
        let other = std::thread::spawn(move || {
            assert_eq!(hanging.started.recv_timeout(PATIENCE).unwrap(), "started 0");
            let other = worker_at(&endpoint, "other", 1, practice_result);
            *moment.lock().unwrap() = Some(Instant::now());
            hanging.child.kill().unwrap();
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
fn what_a_frozen_process_held_is_done_elsewhere_and_its_return_is_harmless() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints()[0].clone();
        let frozen = Hanging::start(&endpoint);
        assert!(coordinator.wait_for_workers(PATIENCE, |w| w.len() == 1));
        let id = frozen.child.id().to_string();
        let signal = move |name: &str| Command::new("kill").args([name, &id]).status().unwrap().success();
        let stop_it = signal.clone();
        let other = std::thread::spawn(move || {
            assert_eq!(frozen.started.recv_timeout(PATIENCE).unwrap(), "started 0");
            assert!(stop_it("-STOP"));
            (worker_at(&endpoint, "other", 1, practice_result), frozen)
        });
        assert_eq!(evaluate(&mut coordinator, &requests(0..4)).unwrap(), expected(0..4));
        let (other, _frozen) = other.join().unwrap();
        assert!(coordinator.wait_for_workers(PATIENCE, |w| w.len() == 1), "only the other one is there");
        assert!(signal("-CONT"));
        assert!(coordinator.wait_for_workers(PATIENCE, |w| w.len() == 2), "it is back");
        assert_eq!(evaluate(&mut coordinator, &requests(4..8)).unwrap(), expected(4..8));
        coordinator.finish();
        assert_eq!(other.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn what_a_vanished_worker_held_is_done_elsewhere_and_counted_once() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints()[0].clone();
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
            vanishing.stopper().abort();
            assert_eq!(vanishing.join().unwrap(), Departure::Aborted);
            // Its simulations end after it has gone: nobody hears of them.
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
fn a_worker_that_is_asked_to_stop_gives_its_task_back() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints()[0].clone();
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
            leaving.stopper().stop();
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
fn a_task_that_ends_three_workers_is_given_up_by_name_and_the_rest_is_done() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints()[0].clone();
        let killing = std::thread::spawn(move || {
            for k in 0..3 {
                let (started, begun) = channel();
                let victim = worker_at(&endpoint, &format!("victim{k}"), 1, move |sample| {
                    // Evaluation 0 takes its worker with it: nothing is ever said again.
                    if sample[0] == 0.0 {
                        let _ = started.send(());
                        loop {
                            std::thread::park();
                        }
                    }
                    practice_result(sample)
                });
                begun.recv_timeout(PATIENCE).unwrap();
                victim.stopper().abort();
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
            matches!(&error, Err(EvaluateError::GivenUp { id: 0, reason }) if reason.contains("3 workers")),
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
        let hand = worker(&coordinator, "w", 1, move |sample| {
            count.fetch_add(1, Ordering::SeqCst);
            practice_result(sample)
        });
        let error = coordinator
            .evaluate(&requests(0..1), &mut |_| Err(EvaluateError::Record("the disk is full".into())));
        assert!(matches!(error, Err(EvaluateError::Record(_))));
        // Asked again, it comes from the worker's memory: simulated once.
        assert_eq!(evaluate(&mut coordinator, &requests(0..1)).unwrap(), expected(0..1));
        assert_eq!(calls.load(Ordering::SeqCst), 1);
        coordinator.finish();
        assert_eq!(hand.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn a_worker_that_is_there_before_its_coordinator_waits_for_it() {
    in_time(|| {
        let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", free.local_addr().unwrap());
        drop(free);
        let hand = worker_at(&endpoint, "early", 1, practice_result);
        let mut coordinator = coordinator_at(Some(&endpoint), Arc::default());
        assert_eq!(evaluate(&mut coordinator, &requests(0..3)).unwrap(), expected(0..3));
        coordinator.finish();
        assert_eq!(hand.join().unwrap(), Departure::CampaignEnded);
        // One that waits in vain can be stopped.
        let vain = worker_at(&endpoint, "vain", 1, practice_result);
        vain.stopper().stop();
        assert_eq!(vain.join().unwrap(), Departure::Stopped { lost: 0 });
    });
}

#[test]
fn a_restarted_coordinator_gets_what_was_finished_while_it_was_away() {
    in_time(|| {
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut first = coordinator_at(None, Arc::clone(&interrupted));
        let endpoint = first.endpoints()[0].clone();
        let calls = Arc::new(AtomicUsize::new(0));
        let hold = Arc::new(Barrier::default());
        let (count, held, flag) = (Arc::clone(&calls), Arc::clone(&hold), Arc::clone(&interrupted));
        let hand = worker_at(&endpoint, "w", 2, move |sample| {
            // Both slots are busy when the coordinator goes away.
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
        assert_eq!(hand.join().unwrap(), Departure::CampaignEnded);
    });
}
