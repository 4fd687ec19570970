//! Workers that return to a restarted coordinator, tasks leased to two workers, shares by speed.

use super::tests::{CAMPAIGN, START, ask, claim, numbers, outcome, reply, requests, scheduler, worker};
use super::*;
use common::wire::Task;

const SECOND: Duration = Duration::from_secs(1);

/// A task as leased by an earlier coordinator.
fn given(task: u64) -> Task {
    Task {
        key: TaskKey { campaign: CAMPAIGN, task },
        attempt: 1,
        sample: vec![task as f64, 0.5],
        with_first_cycle: false,
        accuracy: None,
        level: 0,
    }
}

#[test]
fn tasks_of_an_earlier_coordinator_are_adopted() {
    let (a, b) = (worker("a"), worker("b"));
    for before in [true, false] {
        let mut s = scheduler(&[&a, &b], if before { 0 } else { 4 });
        // It runs task 1, and holds an outcome of task 2 that is not in this claim.
        ask(&mut s, START, claim(&a, 1, 0, vec![], &[1, 2]));
        if before {
            s.on_event(START, Event::Submit(requests(0..4)));
        }
        let (_, tasks) = reply(&ask(&mut s, START, claim(&b, 1, 4, vec![], &[]))).unwrap();
        assert_eq!(numbers(&tasks), [0, 3]);
        // Both are leased to the worker: its outcome counts, and its tasks are requeued when it is lost.
        let actions = ask(&mut s, SECOND, claim(&a, 2, 0, vec![outcome(&given(2), &a)], &[1]));
        assert!(matches!(&actions[..], [Action::Deliver(finished)] if finished.id == 2), "{actions:?}");
        s.on_event(SECOND, Event::WorkerLost(a.clone()));
        let (_, tasks) = reply(&ask(&mut s, SECOND, claim(&b, 2, 4, vec![], &[0, 3]))).unwrap();
        assert_eq!(numbers(&tasks), [1]);
    }
}

#[test]
fn a_task_of_a_worker_lost_before_the_request_goes_to_another_worker() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 0);
    ask(&mut s, START, claim(&a, 1, 0, vec![], &[0]));
    s.on_event(START, Event::WorkerLost(a));
    s.on_event(START, Event::Submit(requests(0..1)));
    let (_, tasks) = reply(&ask(&mut s, START, claim(&b, 1, 1, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [0]);
}

#[test]
fn after_a_restart_tasks_wait_for_the_workers_that_hold_them() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = Scheduler::new(SchedulerSettings { settle: SECOND, ..SchedulerSettings::new(CAMPAIGN) });
    s.on_event(START, Event::WorkerJoined(b.clone()));
    s.on_event(START, Event::Submit(requests(0..2)));
    assert_eq!(reply(&ask(&mut s, START, claim(&b, 1, 2, vec![], &[]))), Some((vec![], vec![])));
    s.on_event(SECOND / 2, Event::WorkerJoined(a.clone()));
    ask(&mut s, SECOND / 2, claim(&a, 1, 0, vec![], &[0]));
    assert_eq!(s.on_event(SECOND / 2, Event::Tick), vec![]);
    // Idle workers are notified of the remaining task.
    let actions = s.on_event(SECOND, Event::Tick);
    assert!(matches!(&actions[..], [Action::Announce(points)] if points.len() == 1 && points[0].0 == 1));
    assert_eq!(s.on_event(2 * SECOND, Event::Tick), vec![]);
    let (_, tasks) = reply(&ask(&mut s, 2 * SECOND, claim(&b, 2, 2, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [1]);
}

#[test]
fn a_task_on_its_last_chance_goes_to_a_worker_that_has_finished_one() {
    let steady = worker("steady");
    let mut s = scheduler(&[&steady], 3);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&steady, 1, 1, vec![], &[]))).unwrap();
    // Two workers without a finished task are lost with task 1; a third one gets a task that was not lost twice.
    for name in ["first", "second"] {
        let doomed = worker(name);
        s.on_event(START, Event::WorkerJoined(doomed.clone()));
        let (_, got) = reply(&ask(&mut s, START, claim(&doomed, 1, 1, vec![], &[]))).unwrap();
        assert_eq!(numbers(&got), [1]);
        s.on_event(START, Event::WorkerLost(doomed));
    }
    ask(&mut s, SECOND, claim(&steady, 2, 0, vec![outcome(&tasks[0], &steady)], &[]));
    let third = worker("third");
    s.on_event(SECOND, Event::WorkerJoined(third.clone()));
    let (_, got) = reply(&ask(&mut s, SECOND, claim(&third, 1, 5, vec![], &[]))).unwrap();
    assert_eq!(numbers(&got), [2]);
    let (_, got) = reply(&ask(&mut s, SECOND, claim(&steady, 3, 5, vec![], &[]))).unwrap();
    assert_eq!(numbers(&got), [1]);
    // With a third loss, the task is given up.
    let actions = s.on_event(SECOND, Event::WorkerLost(steady));
    assert!(actions.iter().any(|c| matches!(c, Action::GiveUp(1, _))), "{actions:?}");
}

#[test]
fn a_task_on_its_last_chance_goes_to_any_worker_if_none_has_finished_one() {
    let mut s = scheduler(&[], 1);
    for name in ["first", "second", "third"] {
        let doomed = worker(name);
        s.on_event(START, Event::WorkerJoined(doomed.clone()));
        let (_, got) = reply(&ask(&mut s, START, claim(&doomed, 1, 1, vec![], &[]))).unwrap();
        assert_eq!(numbers(&got), [0], "{name}");
        s.on_event(START, Event::WorkerLost(doomed));
    }
}

/// A router that fails again and again ends no task: the worker behind it has not crashed.
#[test]
fn a_loss_is_withdrawn_when_the_worker_returns_with_its_task() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 1);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    for sequence in 2..20 {
        let lost = s.on_event(START, Event::WorkerLost(a.clone()));
        assert!(!lost.iter().any(|action| matches!(action, Action::GiveUp(..))), "{lost:?}");
        s.on_event(START, Event::WorkerJoined(a.clone()));
        let (_, again) = reply(&ask(&mut s, START, claim(&a, sequence, 0, vec![], &[0]))).unwrap();
        assert!(numbers(&again).is_empty(), "it holds the task already");
    }
    let actions = ask(&mut s, START, claim(&a, 20, 0, vec![outcome(&tasks[0], &a)], &[]));
    assert!(matches!(&actions[..], [Action::Deliver(finished)] if finished.id == 0), "{actions:?}");
}

/// Other processes that are lost with the task still count, also under the name of the one that returned.
#[test]
fn losses_of_other_processes_are_not_withdrawn() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 1);
    ask(&mut s, START, claim(&a, 1, 1, vec![], &[]));
    s.on_event(START, Event::WorkerLost(a.clone()));
    let mut last = vec![];
    for epoch in 2..4 {
        let crashing = WorkerId { name: "a".into(), epoch };
        s.on_event(START, Event::WorkerJoined(crashing.clone()));
        ask(&mut s, START, claim(&crashing, 1, 1, vec![], &[]));
        last = s.on_event(START, Event::WorkerLost(crashing));
    }
    assert!(last.iter().any(|action| matches!(action, Action::GiveUp(0, _))), "{last:?}");
}

#[test]
fn tasks_found_in_the_campaign_file_are_acknowledged() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 0);
    // The study found 0 and 1 in its file and requests the rest.
    s.on_event(START, Event::Submit(requests(2..4)));
    let actions = ask(&mut s, START, claim(&a, 1, 0, vec![outcome(&given(0), &a)], &[1, 2, 7]));
    assert_eq!(reply(&actions), Some((vec![0, 1], vec![])));
}

#[test]
fn a_straggler_goes_to_an_idle_worker_too_and_the_first_outcome_counts() {
    let (a, b, c) = (worker("a"), worker("b"), worker("c"));
    let mut s = scheduler(&[&a, &b, &c], 2);
    let (_, at_a) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    let (_, at_b) = reply(&ask(&mut s, START, claim(&b, 1, 1, vec![], &[]))).unwrap();
    assert_eq!([numbers(&at_a), numbers(&at_b)], [[0], [1]]);
    // b takes 2 s; the task of a is a straggler after twice that.
    ask(&mut s, 2 * SECOND, claim(&b, 2, 1, vec![outcome(&at_b[0], &b)], &[]));
    let (acknowledged, tasks) = reply(&s.on_event(2 * SECOND, Event::Recorded(1))).unwrap();
    assert_eq!((acknowledged, tasks), (vec![1], vec![]), "not late yet");
    assert_eq!(
        reply(&ask(&mut s, 4 * SECOND, claim(&a, 2, 1, vec![], &[0]))).unwrap().1,
        [],
        "it holds the task already"
    );
    let (_, copy) = reply(&ask(&mut s, 4 * SECOND, claim(&b, 3, 1, vec![], &[]))).unwrap();
    assert_eq!((numbers(&copy), copy[0].attempt), (vec![0], 2));
    assert_eq!(
        reply(&ask(&mut s, 9 * SECOND, claim(&c, 1, 1, vec![], &[]))).unwrap().1,
        [],
        "two workers are enough"
    );
    // The loss of an idle worker has no effect.
    assert_eq!(s.on_event(9 * SECOND, Event::WorkerLost(c)), vec![], "it had nothing");
    let actions = ask(&mut s, 9 * SECOND, claim(&b, 4, 1, vec![outcome(&copy[0], &b)], &[]));
    assert!(matches!(&actions[0], Action::Deliver(finished) if finished.worker == "b/0"));
    s.on_event(9 * SECOND, Event::Recorded(0));
    // The other copy may be dropped or returned: it is not counted.
    assert_eq!(reply(&ask(&mut s, 9 * SECOND, claim(&a, 3, 0, vec![], &[0]))), Some((vec![0], vec![])));
    let late = ask(&mut s, 9 * SECOND, claim(&a, 4, 0, vec![outcome(&at_a[0], &a)], &[]));
    assert_eq!((late.len(), reply(&late)), (1, Some((vec![0], vec![]))));
}

#[test]
fn a_straggler_survives_either_of_its_workers() {
    for first in [true, false] {
        let (a, b) = (worker("a"), worker("b"));
        let mut s = scheduler(&[&a, &b], 2);
        ask(&mut s, START, claim(&a, 1, 1, vec![], &[]));
        let (_, at_b) = reply(&ask(&mut s, START, claim(&b, 1, 1, vec![], &[]))).unwrap();
        ask(&mut s, SECOND, claim(&b, 2, 0, vec![outcome(&at_b[0], &b)], &[]));
        s.on_event(SECOND, Event::Recorded(1));
        ask(&mut s, 9 * SECOND, claim(&b, 3, 1, vec![], &[]));
        let (dies, stays) = if first { (&a, &b) } else { (&b, &a) };
        let actions = s.on_event(9 * SECOND, Event::WorkerLost(dies.clone()));
        assert!(!actions.iter().any(|c| matches!(c, Action::Announce(_))), "{actions:?}");
        let actions = s.on_event(9 * SECOND, Event::WorkerLost(stays.clone()));
        assert!(actions.iter().any(|c| matches!(c, Action::Announce(points) if points[0].0 == 0)));
    }
}

#[test]
fn a_worker_twice_as_fast_gets_twice_as_many() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 32);
    for (id, wall) in [(&a, 1.0), (&b, 2.0)] {
        let (_, tasks) = reply(&ask(&mut s, START, claim(id, 1, 1, vec![], &[]))).unwrap();
        let done = Outcome { wall, ..outcome(&tasks[0], id) };
        ask(&mut s, START, claim(id, 2, 0, vec![done], &[]));
        s.on_event(START, Event::Recorded(tasks[0].key.task));
    }
    let mut got = |id| {
        let all = Claim { slots: 1, ..claim(id, 3, 100, vec![], &[]) };
        reply(&ask(&mut s, START, all)).unwrap().1.len()
    };
    assert_eq!((got(&a), got(&b)), (20, 10));
}
