//! Workers that leave: idle, at the end of their run time, after a stop request; slow workers; and one worker for several
//! coordinators.

use coordinator::farm::dispatch::ZenohEvaluator;
use coordinator::farm::evaluate::{EvaluateError, Evaluator};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use tests::{
    Barrier, ClosureSimulator, PATIENCE, coordinator, coordinator_at, evaluate, expected, in_time,
    practice_result, requests, worker, worker_at,
};
use worker::service::{self, Departure, ServiceConfig, WorkerHandle};

/// A worker whose simulations take `takes` each, with their number.
fn counting(config: ServiceConfig, takes: Duration) -> (WorkerHandle, Arc<AtomicUsize>) {
    let count = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&count);
    let simulate = move |sample: &[f64]| {
        counted.fetch_add(1, Ordering::SeqCst);
        std::thread::sleep(takes);
        practice_result(sample)
    };
    (service::spawn(config, Arc::new(ClosureSimulator(simulate))).unwrap(), count)
}

fn named(name: &str, coordinator: &ZenohEvaluator, slots: usize) -> ServiceConfig {
    ServiceConfig { name: name.into(), ..ServiceConfig::new(&coordinator.endpoints[0], slots) }
}

#[test]
fn an_idle_worker_leaves_and_a_busy_one_stays() {
    in_time(|| {
        let mut coordinator = coordinator();
        let timeout = Duration::from_millis(400);
        let config = ServiceConfig { idle_timeout: Some(timeout), ..named("brief", &coordinator, 1) };
        // Its tasks take longer than the timeout in total.
        let (handle, count) = counting(config, timeout / 2);
        assert_eq!(evaluate(&mut coordinator, &requests(0..5)).unwrap(), expected(0..5));
        let idle = Instant::now();
        assert_eq!(handle.join().unwrap(), Departure::Idle);
        assert_eq!(count.load(Ordering::SeqCst), 5);
        assert!(idle.elapsed() < PATIENCE / 2);
        assert!(coordinator.connected.wait_for(PATIENCE, <[_]>::is_empty));
    });
}

#[test]
fn a_worker_leaves_in_time_and_starts_no_task_it_cannot_finish() {
    in_time(|| {
        let mut coordinator = coordinator();
        let walltime = Duration::from_secs(3);
        let config = ServiceConfig { walltime: Some(walltime), ..named("batch", &coordinator, 1) };
        let started = Instant::now();
        let (handle, count) = counting(config, Duration::from_millis(500));
        let endpoint = coordinator.endpoints[0].clone();
        let relay = std::thread::spawn(move || {
            let left = handle.join().unwrap();
            (left, started.elapsed(), worker_at(&endpoint, "after", 1, practice_result))
        });
        let mut by_it = 0;
        let mut outcomes = tests::Outcomes::new();
        coordinator
            .evaluate(&requests(0..20), &mut |finished| {
                by_it += usize::from(finished.worker.starts_with("batch"));
                assert!(outcomes.insert(finished.id, finished.outcome).is_none());
                Ok(())
            })
            .unwrap();
        assert_eq!(outcomes, expected(0..20));
        let (left, after, other) = relay.join().unwrap();
        assert_eq!(left, Departure::TimeUp { lost: 0 });
        assert!(after < walltime, "{after:?}");
        // Every task it started has finished.
        assert_eq!(count.load(Ordering::SeqCst), by_it);
        assert!(by_it >= 1);
        coordinator.finish();
        assert_eq!(other.join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn a_stopped_worker_finishes_its_task_within_the_drain_time() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let (begun, started) = channel();
        let hold = Arc::new(Barrier::default());
        let held = Arc::clone(&hold);
        let config = ServiceConfig { drain: PATIENCE, ..named("leaving", &coordinator, 1) };
        let simulate = move |sample: &[f64]| {
            let _ = begun.send(sample[0]);
            held.pass();
            practice_result(sample)
        };
        let leaving = service::spawn(config, Arc::new(ClosureSimulator(simulate))).unwrap();
        let others = AtomicUsize::new(0);
        let staying = std::thread::spawn(move || {
            assert_eq!(started.recv_timeout(PATIENCE).unwrap(), 0.0);
            leaving.stopper.stop();
            // Another worker evaluates the other tasks meanwhile.
            let staying = worker_at(&endpoint, "staying", 1, move |sample| {
                if others.fetch_add(1, Ordering::SeqCst) == 3 {
                    hold.open();
                }
                practice_result(sample)
            });
            // The campaign may end with its last outcome.
            let left = leaving.join().unwrap();
            assert!(matches!(left, Departure::Stopped { lost: 0 } | Departure::CampaignEnded), "{left:?}");
            assert!(started.try_recv().is_err(), "it started another task");
            staying
        });
        let mut names = vec![String::new(); 5];
        coordinator
            .evaluate(&requests(0..5), &mut |finished| {
                names[finished.id as usize] = finished.worker;
                Ok(())
            })
            .unwrap();
        assert_eq!(names, ["leaving/0", "staying/0", "staying/0", "staying/0", "staying/0"]);
        coordinator.finish();
        assert_eq!(staying.join().unwrap().join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn the_last_task_of_a_slow_worker_goes_to_an_idle_one_too() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let hold = Arc::new(Barrier::default());
        let held = Arc::clone(&hold);
        let (begun, started) = channel();
        let slow = worker(&coordinator, "slow", 1, move |sample| {
            let _ = begun.send(());
            held.pass();
            practice_result(sample)
        });
        let quick = std::thread::spawn(move || {
            started.recv_timeout(PATIENCE).unwrap();
            worker_at(&endpoint, "quick", 1, practice_result)
        });
        let mut names = vec![];
        coordinator
            .evaluate(&requests(0..10), &mut |finished| {
                names.push(finished.worker);
                Ok(())
            })
            .unwrap();
        assert_eq!(names, vec!["quick/0"; 10], "no outcome came from the slow worker");
        // Its late outcome is not counted.
        hold.open();
        assert_eq!(evaluate(&mut coordinator, &requests(10..20)).unwrap(), expected(10..20));
        coordinator.finish();
        assert_eq!(slow.join().unwrap(), Departure::CampaignEnded);
        assert_eq!(quick.join().unwrap().join().unwrap(), Departure::CampaignEnded);
    });
}

#[test]
fn two_studies_share_a_worker_and_one_gets_all_slots_when_the_other_ends() {
    in_time(|| {
        let (mut first, mut second) = (coordinator(), coordinator());
        let connect = vec![first.endpoints[0].clone(), second.endpoints[0].clone()];
        let config = ServiceConfig { connect, name: "shared".into(), ..ServiceConfig::new("", 2) };
        let (handle, _) = counting(config, Duration::from_millis(20));
        let both = |w: &[_]| w.len() == 1;
        assert!(first.connected.wait_for(PATIENCE, both) && second.connected.wait_for(PATIENCE, both));
        // The progress of the second study when the first has half of its outcomes; then the first one fails.
        let done = Arc::new(AtomicUsize::new(0));
        let (seen, half) = (Arc::clone(&done), 50);
        let dying = std::thread::spawn(move || {
            let (mut own, mut of_the_other) = (0, 0);
            let error = first.evaluate(&requests(0..100), &mut |_| {
                own += 1;
                if own == half {
                    of_the_other = seen.load(Ordering::SeqCst);
                    return Err(EvaluateError::Record("it dies".into()));
                }
                Ok(())
            });
            assert!(error.is_err());
            drop(first);
            of_the_other
        });
        let mut outcomes = tests::Outcomes::new();
        second
            .evaluate(&requests(0..200), &mut |finished| {
                done.fetch_add(1, Ordering::SeqCst);
                assert!(outcomes.insert(finished.id, finished.outcome).is_none());
                Ok(())
            })
            .unwrap();
        assert_eq!(outcomes, expected(0..200));
        let of_the_other = dying.join().unwrap();
        assert!(
            (half * 7 / 10..=half * 14 / 10).contains(&of_the_other),
            "{of_the_other} while the other study had {half}"
        );
        second.finish();
        // It left the second coordinator at the end of its campaign, and still tries to reach the first one.
        assert!(!handle.has_ended());
        handle.stopper.abort();
        assert_eq!(handle.join().unwrap(), Departure::Aborted);
    });
}

#[test]
fn a_staying_worker_serves_one_campaign_after_the_other() {
    in_time(|| {
        let first = coordinator();
        let endpoint = first.endpoints[0].clone();
        let config =
            ServiceConfig { next_campaign: true, give_up_after: None, ..named("staying", &first, 1) };
        let (handle, count) = counting(config, Duration::ZERO);
        let mut campaign = first;
        for round in 1..=2 {
            assert_eq!(evaluate(&mut campaign, &requests(0..4)).unwrap(), expected(0..4));
            assert_eq!(count.load(Ordering::SeqCst), 4 * round);
            campaign.finish();
            campaign = coordinator_at(Some(&endpoint), Arc::default());
        }
        handle.stopper.stop();
        assert_eq!(handle.join().unwrap(), Departure::Stopped { lost: 0 });
    });
}
