//! Who gets tasks of an external simulator, how many at once, and what follows from a simulator that cannot be used.

use super::tests::{CAMPAIGN, START, ask, claim, numbers, outcome, reply, requests, warnings, worker};
use super::*;
use common::external::SimulatorId;
use common::wire::{Offers, Subject, Task};

const SECOND: Duration = Duration::from_secs(1);

fn beam() -> SimulatorId {
    SimulatorId { scene: "beam".into(), digest: 1 }
}

/// A scheduler for `beam` with these workers, tasks and licences.
fn scheduler(workers: &[&WorkerId], tasks: u64, licences: Option<u32>) -> Scheduler {
    let subject = Subject::Simulator(beam());
    let mut s = Scheduler::new(SchedulerSettings { subject, licences, ..SchedulerSettings::new(CAMPAIGN) });
    for id in workers {
        s.on_event(START, Event::WorkerJoined((*id).clone()));
    }
    s.on_event(START, Event::Submit(requests(0..tasks)));
    s
}

fn offering(ids: Vec<SimulatorId>, claim: Claim) -> Claim {
    Claim { offers: Offers::Simulators(ids), ..claim }
}

/// A claim of a worker with two slots that offers `beam`.
fn of_beam(who: &WorkerId, sequence: u64, finished: Vec<Outcome>, holding: &[u64]) -> Claim {
    let claim = claim(who, sequence, 2, finished, holding);
    offering(vec![beam()], Claim { credits: 4, ..claim })
}

fn tasks(s: &mut Scheduler, now: Duration, claim: Claim) -> Vec<Task> {
    reply(&ask(s, now, claim)).expect("a claim without outcomes is answered at once").1
}

/// Returns outcomes, records them, and the tasks in the reply.
fn exchange(s: &mut Scheduler, now: Duration, who: &WorkerId, sequence: u64, done: &[Task]) -> Vec<Task> {
    let outcomes = done.iter().map(|task| outcome(task, who)).collect();
    ask(s, now, of_beam(who, sequence, outcomes, &[]));
    let mut last = vec![];
    for task in done {
        last = s.on_event(now, Event::Recorded(task.key.task));
    }
    reply(&last).expect("all outcomes are durable").1
}

#[test]
fn only_workers_with_the_same_simulator_get_tasks() {
    let [plain, other, newer, right] = ["plain", "other", "newer", "right"].map(worker);
    let mut s = scheduler(&[&plain, &other, &newer, &right], 8, None);
    let bar = SimulatorId { scene: "bar".into(), digest: 1 };
    let version = SimulatorId { digest: 2, ..beam() };
    let claims = [
        claim(&plain, 1, 2, vec![], &[]),
        offering(vec![bar.clone()], claim(&other, 2, 2, vec![], &[])),
        offering(vec![version], claim(&newer, 3, 2, vec![], &[])),
    ];
    for claim in claims {
        let id = claim.worker.clone();
        let again = Claim { sequence: claim.sequence + 10, ..claim.clone() };
        let actions = ask(&mut s, START, claim);
        assert_eq!(reply(&actions), Some((vec![], vec![])), "{}", id.name);
        let expected = format!("worker {} gets no evaluations: the study is of simulator beam", id.name);
        assert!(warnings(&actions)[0].starts_with(&expected), "{actions:?}");
        // Once.
        assert_eq!(ask(&mut s, START, again).len(), 1);
    }
    // The share of the right one is not reduced by the others.
    let both = offering(vec![bar, beam()], Claim { credits: 9, ..claim(&right, 4, 2, vec![], &[]) });
    assert_eq!(numbers(&tasks(&mut s, START, both)), (0..8).collect::<Vec<_>>());
    assert_eq!(s.workers().map(|(_, slots)| slots).collect::<Vec<_>>(), [0, 0, 0, 2]);

    // And an external simulator gets no scene.
    let mut s = super::tests::scheduler(&[&right], 2);
    assert_eq!(reply(&ask(&mut s, START, of_beam(&right, 1, vec![], &[]))).unwrap().1, vec![]);
}

#[test]
fn licences_bound_the_tasks_of_all_workers_together() {
    let [a, b] = ["a", "b"].map(worker);
    let mut s = scheduler(&[&a, &b], 9, Some(3));
    let first = tasks(&mut s, START, of_beam(&a, 1, vec![], &[]));
    let second = tasks(&mut s, START, of_beam(&b, 2, vec![], &[]));
    // No task waits at a worker, and three run.
    assert_eq!((numbers(&first), numbers(&second)), (vec![0, 1], vec![2]));
    assert_eq!(numbers(&tasks(&mut s, SECOND, of_beam(&b, 3, vec![], &[2]))), [0_u64; 0]);
    // A finished task frees its licence for the same worker.
    let next = exchange(&mut s, SECOND, &b, 4, &second);
    assert_eq!(numbers(&next), [3]);
    // There is no second worker for a straggler.
    assert_eq!(numbers(&tasks(&mut s, 50 * SECOND, of_beam(&b, 5, vec![], &[3]))), [0_u64; 0]);
}

#[test]
fn licences_of_a_lost_worker_are_held_while_its_programs_may_run() {
    let [a, b] = ["a", "b"].map(worker);
    let mut s = scheduler(&[&a, &b], 9, Some(3));
    let lost = tasks(&mut s, START, of_beam(&a, 1, vec![], &[]));
    let kept = tasks(&mut s, START, of_beam(&b, 2, vec![], &[]));
    assert_eq!((lost.len(), kept.len()), (2, 1));
    // However short the evaluations are, those of the lost worker may be long ones.
    let next = exchange(&mut s, SECOND, &b, 3, &kept);
    s.on_event(SECOND, Event::WorkerLost(a.clone()));
    // It still has contact, but no token, so it gets no tasks and may go on: the time begins again.
    assert_eq!(tasks(&mut s, 2 * SECOND, of_beam(&a, 4, vec![], &[0, 1])), vec![]);
    let held_until = 2 * SECOND + LICENCE_HOLD;
    assert_eq!(s.on_event(SECOND + LICENCE_HOLD, Event::Tick), vec![]);
    assert_eq!(tasks(&mut s, SECOND + LICENCE_HOLD, of_beam(&b, 4, vec![], &[3])), vec![]);
    let freed = s.on_event(held_until, Event::Tick);
    assert!(matches!(&freed[..], [Action::Announce(points)] if points.len() == 7), "{freed:?}");
    assert_eq!(numbers(&tasks(&mut s, held_until, of_beam(&b, 5, vec![], &[next[0].key.task]))), [0]);

    // One that is back lists what it runs; one that leaves has a second to end its programs.
    let later = held_until + SECOND;
    s.on_event(later, Event::WorkerJoined(a.clone()));
    assert_eq!(tasks(&mut s, later, of_beam(&a, 9, vec![], &[1])), vec![]);
    let leaving = Claim { leaving: true, ..of_beam(&a, 10, vec![], &[]) };
    ask(&mut s, later, leaving);
    let done = vec![outcome(&next[0], &b)];
    let many = |sequence, done| Claim { slots: 9, credits: 9, ..of_beam(&b, sequence, done, &[0]) };
    ask(&mut s, later, many(6, done));
    let held = reply(&s.on_event(later, Event::Recorded(next[0].key.task))).unwrap().1;
    assert_eq!(held.len(), 1, "two run at b, and one licence is held");
    assert_eq!(s.on_event(later + SECOND, Event::Tick).len(), 1);
    let kept = [0, held[0].key.task];
    let freed = tasks(&mut s, later + SECOND, Claim { slots: 9, ..of_beam(&b, 7, vec![], &kept) });
    assert_eq!(freed.len(), 1, "its time is over");
}

#[test]
fn a_task_that_has_ended_elsewhere_keeps_its_licence_while_it_runs() {
    let [a, b] = ["a", "b"].map(worker);
    let mut s = scheduler(&[&a, &b], 9, Some(2));
    let one = |claim: Claim| Claim { credits: 1, ..claim };
    tasks(&mut s, START, one(of_beam(&a, 1, vec![], &[])));
    let mut mine = tasks(&mut s, START, one(of_beam(&b, 2, vec![], &[])));
    s.on_event(SECOND, Event::WorkerLost(a.clone()));
    for (sequence, next) in [(3, 0), (4, 2)] {
        mine = exchange(&mut s, 2 * SECOND, &b, sequence, &mine);
        assert_eq!(numbers(&mine), [next]);
    }
    // The lost worker is back and still runs what the other one has finished.
    s.on_event(3 * SECOND, Event::WorkerJoined(a.clone()));
    let back = reply(&ask(&mut s, 3 * SECOND, of_beam(&a, 5, vec![], &[0]))).unwrap();
    assert_eq!(back, (vec![0], vec![]));
    assert_eq!(tasks(&mut s, 4 * SECOND, of_beam(&b, 6, vec![], &[2])), vec![]);
    assert_eq!(numbers(&tasks(&mut s, 5 * SECOND, of_beam(&a, 7, vec![], &[]))), [3]);
}

#[test]
fn an_evaluation_of_the_earlier_coordinator_keeps_its_licence_until_it_is_requested_or_ends() {
    let [a, b] = ["a", "b"].map(worker);
    // A resumed study, whose first requests are tasks 0 to 4; worker `a` still runs task 7 of the earlier coordinator.
    let mut s = scheduler(&[&a, &b], 5, Some(2));
    let one = |claim: Claim| Claim { credits: 1, ..claim };
    assert_eq!(numbers(&tasks(&mut s, START, one(of_beam(&a, 1, vec![], &[7])))), [0]);
    assert_eq!(tasks(&mut s, START, of_beam(&b, 2, vec![], &[])), vec![]);
    // Its next claims show it again, and then its lease.
    assert_eq!(tasks(&mut s, SECOND, one(of_beam(&a, 3, vec![], &[0, 7]))), vec![]);
    assert_eq!(tasks(&mut s, SECOND, of_beam(&b, 4, vec![], &[])), vec![]);
    s.on_event(2 * SECOND, Event::Submit(requests(5..9)));
    assert_eq!(tasks(&mut s, 2 * SECOND, one(of_beam(&a, 5, vec![], &[0, 7]))), vec![]);
    assert_eq!(tasks(&mut s, 2 * SECOND, of_beam(&b, 6, vec![], &[])), vec![]);
    // One that ends without an outcome frees its licence.
    assert_eq!(tasks(&mut s, 3 * SECOND, Claim { credits: 0, ..of_beam(&a, 7, vec![], &[0]) }), vec![]);
    assert_eq!(numbers(&tasks(&mut s, 3 * SECOND, of_beam(&b, 8, vec![], &[]))), [7]);
}

fn unusable(task: &Task, who: &WorkerId) -> Outcome {
    let reason = "no licence file".to_owned();
    Outcome { result: Err(SimulationFailure::SimulatorUnusable { reason }), ..outcome(task, who) }
}

#[test]
fn a_worker_that_cannot_use_its_simulator_gets_no_more_tasks() {
    let [a, b] = ["a", "b"].map(worker);
    let mut s = scheduler(&[&a, &b], 2, None);
    let mine = tasks(&mut s, START, Claim { credits: 1, ..of_beam(&a, 1, vec![], &[]) });
    let actions = ask(&mut s, START, of_beam(&a, 2, vec![unusable(&mine[0], &a)], &[]));
    assert_eq!(warnings(&actions), ["worker a gets no more evaluations: no licence file"]);
    // It is acknowledged, nothing is delivered, and the task returns to the queue without a loss.
    assert_eq!(reply(&actions), Some((vec![0], vec![])));
    assert_eq!(tasks(&mut s, START, of_beam(&a, 3, vec![], &[])), vec![]);
    let again = tasks(&mut s, START, of_beam(&b, 4, vec![], &[]));
    assert_eq!(numbers(&again), [0, 1]);
    assert_eq!(s.on_event(60 * SECOND, Event::Tick), vec![]);

    // Once no worker is left, and none has joined for five seconds, the study ends with the report.
    ask(&mut s, 60 * SECOND, of_beam(&b, 5, vec![unusable(&again[1], &b)], &[0]));
    assert_eq!(s.on_event(64 * SECOND, Event::Tick), vec![]);
    let given_up = s.on_event(65 * SECOND, Event::Tick);
    let reason = "worker b: no licence file".to_owned();
    assert_eq!(given_up[0], Action::GiveUp(0, reason));
}
