//! The invariants of the scheduler, one by one; `farm_tests` checks them under random faults.

use super::*;
use crate::farm::evaluate::Request;
use common::build::Build;
use common::failure::SimulationFailure;
use common::wire::{Offers, Task};

pub(super) const CAMPAIGN: u64 = 7;
pub(super) const START: Duration = Duration::ZERO;

pub(super) fn worker(name: &str) -> WorkerId {
    WorkerId { name: name.into(), epoch: 1 }
}

pub(super) fn requests(ids: std::ops::Range<u64>) -> Vec<Request> {
    ids.map(|id| Request {
        id,
        sample: vec![id as f64, 0.5],
        with_first_cycle: false,
        accuracy: None,
        level: 0,
        not_by: vec![],
    })
    .collect()
}

pub(super) fn claim(
    who: &WorkerId,
    sequence: u64,
    credits: u32,
    finished: Vec<Outcome>,
    holding: &[u64],
) -> Claim {
    let holding = holding.iter().map(|&task| TaskKey { campaign: CAMPAIGN, task }).collect();
    let (worker, offers) = (who.clone(), Offers::Scenes(Build::default()));
    Claim { worker, sequence, offers, slots: credits, credits, holding, finished, leaving: false }
}

pub(super) fn outcome(task: &Task, who: &WorkerId) -> Outcome {
    let result = Err(SimulationFailure::NotModelled { what: format!("{}", task.key.task) });
    Outcome { task: task.clone(), worker: format!("{}/0", who.name), wall: 1.0, result }
}

pub(super) fn scheduler(workers: &[&WorkerId], tasks: u64) -> Scheduler {
    let mut scheduler = Scheduler::new(SchedulerSettings::new(CAMPAIGN));
    for id in workers {
        scheduler.on_event(START, Event::WorkerJoined((*id).clone()));
    }
    scheduler.on_event(START, Event::Submit(requests(0..tasks)));
    scheduler
}

/// The reply in the actions: acknowledged numbers and tasks.
pub(super) fn reply(actions: &[Action]) -> Option<(Vec<u64>, Vec<Task>)> {
    actions.iter().find_map(|action| match action {
        Action::Reply(_, acknowledged, tasks) => {
            let acknowledged = acknowledged.iter().map(|key| key.task).collect();
            Some((acknowledged, tasks.clone().unwrap_or_default()))
        }
        _ => None,
    })
}

/// The texts of the warnings among some actions.
pub(super) fn warnings(actions: &[Action]) -> Vec<&str> {
    let texts = actions.iter().filter_map(|action| match action {
        Action::Warn(warning) => Some(warning.as_str()),
        _ => None,
    });
    texts.collect()
}

pub(super) fn numbers(tasks: &[Task]) -> Vec<u64> {
    tasks.iter().map(|task| task.key.task).collect()
}

pub(super) fn ask(scheduler: &mut Scheduler, now: Duration, claim: Claim) -> Vec<Action> {
    scheduler.on_event(now, Event::Claimed(claim.sequence, claim))
}

#[test]
fn an_outcome_is_acknowledged_only_when_it_is_durable() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 2);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    let actions = ask(&mut s, START, claim(&a, 2, 1, vec![outcome(&tasks[0], &a)], &[]));
    assert!(matches!(&actions[..], [Action::Deliver(finished)] if finished.id == 0), "{actions:?}");
    let (acknowledged, tasks) = reply(&s.on_event(START, Event::Recorded(0))).unwrap();
    assert_eq!((acknowledged, numbers(&tasks)), (vec![0], vec![1]));
}

#[test]
fn a_doubled_outcome_is_acknowledged_and_not_counted() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 1);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    ask(&mut s, START, claim(&a, 2, 0, vec![outcome(&tasks[0], &a)], &[]));
    // A second outcome waits while the first is being recorded; a third one after that is acknowledged.
    let second = ask(&mut s, START, claim(&b, 3, 0, vec![outcome(&tasks[0], &b)], &[]));
    assert_eq!(second, vec![]);
    let replies = s.on_event(START, Event::Recorded(0));
    assert_eq!(replies.len(), 2);
    let third = ask(&mut s, START, claim(&b, 4, 0, vec![outcome(&tasks[0], &b)], &[]));
    assert_eq!(reply(&third), Some((vec![0], vec![])));
    assert_eq!(third.len(), 1);
}

#[test]
fn tasks_of_a_lost_worker_return_to_the_front_and_are_announced() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 5);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 2, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [0, 1]);
    let actions = s.on_event(START, Event::WorkerLost(a));
    assert_eq!(warnings(&actions), ["worker a was lost; its evaluations [0, 1] are requeued"]);
    assert!(actions.iter().any(|c| matches!(c, Action::Announce(points) if points.len() == 2)));
    let (_, tasks) = reply(&ask(&mut s, START, claim(&b, 2, 3, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [0, 1, 2]);
    assert_eq!(tasks.iter().map(|task| task.attempt).collect::<Vec<_>>(), [2, 2, 1]);
}

#[test]
fn a_task_lost_three_times_is_given_up() {
    let mut s = scheduler(&[], 1);
    let mut last = vec![];
    for k in 0..3 {
        let id = worker(&format!("w{k}"));
        s.on_event(START, Event::WorkerJoined(id.clone()));
        ask(&mut s, START, claim(&id, 1, 1, vec![], &[]));
        last = s.on_event(START, Event::WorkerLost(id));
    }
    let given_up = last
        .iter()
        .any(|c| matches!(c, Action::GiveUp(0, reason) if reason == "3 workers were lost while running it"));
    assert!(given_up, "{last:?}");
    assert_eq!(s.tasks.open(), 0);
}

#[test]
fn tasks_returned_by_a_leaving_worker_do_not_count_as_losses() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 1);
    for sequence in 1..10 {
        let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 2 * sequence, 1, vec![], &[]))).unwrap();
        assert_eq!(numbers(&tasks), [0]);
        let leaving = Claim { leaving: true, ..claim(&a, 2 * sequence + 1, 1, vec![], &[0]) };
        assert_eq!(reply(&ask(&mut s, START, leaving)), Some((vec![], vec![])));
    }
}

#[test]
fn a_lease_missing_from_the_claim_is_requeued() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 3);
    ask(&mut s, START, claim(&a, 1, 2, vec![], &[]));
    // Of the reply to claim 1, only task 1 is listed.
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 2, 1, vec![], &[1]))).unwrap();
    assert_eq!(numbers(&tasks), [0]);
    // An outdated claim gets nothing, changes nothing and is logged.
    let actions = ask(&mut s, START, claim(&a, 1, 3, vec![], &[]));
    assert_eq!(reply(&actions), Some((vec![], vec![])));
    assert!(warnings(&actions)[0].starts_with("a claim of worker a is refused (1 so far)"), "{actions:?}");
}

#[test]
fn a_claim_superseded_by_a_newer_one_gets_no_tasks() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 3);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    // Claim 2 waits too long for its record; the worker sends claim 3.
    ask(&mut s, START, claim(&a, 2, 1, vec![outcome(&tasks[0], &a)], &[0]));
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 3, 1, vec![], &[0]))).unwrap();
    assert_eq!(numbers(&tasks), [1]);
    assert_eq!(reply(&s.on_event(START, Event::Recorded(0))), Some((vec![0], vec![])));
}

#[test]
fn an_outcome_not_requested_yet_stays_with_its_worker() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 0);
    let early = Task {
        key: TaskKey { campaign: CAMPAIGN, task: 0 },
        attempt: 1,
        sample: vec![0.0, 0.5],
        with_first_cycle: false,
        accuracy: None,
        level: 0,
    };
    let actions = ask(&mut s, START, claim(&a, 1, 0, vec![outcome(&early, &a)], &[]));
    assert_eq!(reply(&actions), Some((vec![], vec![])));
    s.on_event(START, Event::Submit(requests(0..1)));
    let actions = ask(&mut s, START, claim(&a, 2, 0, vec![outcome(&early, &a)], &[]));
    assert!(matches!(&actions[..], [Action::Deliver(_)]));
}

#[test]
fn an_outcome_of_another_campaign_or_sample_is_acknowledged_and_not_used() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 1);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    let mut foreign = outcome(&tasks[0], &a);
    foreign.task.key.campaign = 8;
    let actions = ask(&mut s, START, claim(&a, 2, 0, vec![foreign], &[0]));
    assert!(
        warnings(&actions)[0].starts_with("an outcome of worker a is not used (1 so far)"),
        "{actions:?}"
    );
    let acknowledged = vec![TaskKey { campaign: 8, task: 0 }];
    assert_eq!(actions[1..], [Action::Reply(2, acknowledged, Some(vec![]))]);
    let mut other = outcome(&tasks[0], &a);
    other.task.sample[1] = -0.5;
    let actions = ask(&mut s, START, claim(&a, 3, 0, vec![other], &[0]));
    let expected = "worker a returned an outcome of another sample as evaluation 0; it is not used";
    assert_eq!(warnings(&actions), [expected]);
    assert_eq!(reply(&actions), Some((vec![0], vec![])));
    let mut otherwise = outcome(&tasks[0], &a);
    otherwise.task.accuracy = Some(common::accuracy::Accuracy::draft());
    let actions = ask(&mut s, START, claim(&a, 4, 0, vec![otherwise], &[0]));
    assert_eq!(warnings(&actions), [expected]);
    assert_eq!(s.tasks.open(), 1);
}

#[test]
fn a_deadline_follows_the_longest_simulation() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 3);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 2, vec![], &[]))).unwrap();
    let hour = Duration::from_secs(3600);
    assert_eq!(s.on_event(hour, Event::Tick), vec![]);
    // One simulation takes 60 s: the other task is overdue after 600 s.
    let slow = Outcome { wall: 60.0, ..outcome(&tasks[0], &a) };
    ask(&mut s, START, claim(&a, 2, 0, vec![slow], &[1]));
    s.on_event(START, Event::Recorded(0));
    let late = Duration::from_secs(601);
    assert_eq!(s.on_event(Duration::from_secs(600), Event::Tick), vec![]);
    let actions = s.on_event(late, Event::Tick);
    let expected = "evaluation 1 has been running on worker a for 601 s; another worker gets it too";
    assert_eq!(warnings(&actions), [expected]);
    let (_, again) = reply(&ask(&mut s, late, claim(&b, 3, 1, vec![], &[]))).unwrap();
    assert_eq!(numbers(&again), [1]);
    // An outcome of the first worker still counts if it arrives first.
    let actions = ask(&mut s, late, claim(&a, 4, 0, vec![outcome(&tasks[1], &a)], &[]));
    assert!(matches!(&actions[..], [Action::Deliver(finished)] if finished.worker == "a/0"));
}

#[test]
fn missing_workers_and_liveliness_tokens_are_reported() {
    let mut s = scheduler(&[], 4);
    let second = Duration::from_secs(1);
    assert_eq!(s.on_event(second, Event::Tick), vec![]);
    let actions = s.on_event(6 * second, Event::Tick);
    let warning = |open: usize, since: u32| {
        let text = "evaluations are waiting and no worker that can run them has been connected for";
        Action::Warn(format!("{open} {text} {since} s"))
    };
    assert_eq!(actions, [warning(4, 5)]);
    // The warning is repeated after a minute, with the total time, or at once if the number of tasks changes.
    let until = |s: &mut Scheduler, range: std::ops::RangeInclusive<u32>| -> Vec<(u32, Action)> {
        range.flat_map(|t| s.on_event(t * second, Event::Tick).into_iter().map(move |c| (t, c))).collect()
    };
    assert_eq!(until(&mut s, 7..=100), vec![(66, warning(4, 65))]);
    s.on_event(100 * second, Event::Submit(requests(4..6)));
    assert_eq!(until(&mut s, 101..=160), vec![(101, warning(6, 100))]);
    // A worker without a liveliness token gets no tasks, and is reported once.
    let a = worker("a");
    let others: Vec<Action> = (1..40)
        .flat_map(|sequence| ask(&mut s, second, claim(&a, sequence, 1, vec![], &[])))
        .filter(|action| !matches!(action, Action::Reply(.., Some(tasks)) if tasks.is_empty()))
        .collect();
    let [Action::Warn(warning)] = &others[..] else { panic!("{others:?}") };
    assert!(warning.starts_with("worker a claims tasks but has no liveliness token"), "{warning}");
}

#[test]
fn cancelled_tasks_stay_with_their_workers_and_all_leave_at_the_end() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 2);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 2, vec![], &[]))).unwrap();
    ask(&mut s, START, claim(&a, 2, 0, vec![outcome(&tasks[0], &a)], &[0, 1]));
    assert_eq!(reply(&s.on_event(START, Event::Cancel)), Some((vec![], vec![])));
    assert_eq!(s.on_event(START, Event::Recorded(0)), vec![]);
    assert_eq!(s.on_event(START, Event::Finish), vec![Action::AnnounceEnd]);
    let actions = ask(&mut s, START, claim(&a, 3, 2, vec![], &[0, 1]));
    assert!(matches!(&actions[..], [Action::Reply(.., None)]));
}
