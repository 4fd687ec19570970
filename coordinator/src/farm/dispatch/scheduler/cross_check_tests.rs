//! Results that several workers make.

use super::tests::{CAMPAIGN, START, claim, numbers, reply, requests, worker};
use super::*;
use common::outputs::Evaluation;
use common::wire::Task;

/// Workers that claim in turns, each with its factor of the right results.
struct Farm {
    scheduler: Scheduler,
    sequence: u64,
    delivered: Vec<Finished>,
    given_up: Vec<(u64, String)>,
    warnings: Vec<String>,
}

impl Farm {
    fn new(names: &[&str], tasks: u64, check: CrossCheck) -> Self {
        let settings = SchedulerSettings { cross_check: Some(check), ..SchedulerSettings::new(CAMPAIGN) };
        let mut scheduler = Scheduler::new(settings);
        for name in names {
            scheduler.on_event(START, Event::WorkerJoined(worker(name)));
        }
        scheduler.on_event(START, Event::Submit(requests(0..tasks)));
        let mut farm = Farm { scheduler, sequence: 0, delivered: vec![], given_up: vec![], warnings: vec![] };
        // Their slots are known from their first claim.
        names.iter().for_each(|name| drop(farm.claims(name, 0, vec![], &[])));
        farm
    }

    fn claims(
        &mut self,
        name: &str,
        credits: u32,
        finished: Vec<Outcome>,
        holding: &[u64],
    ) -> (Vec<u64>, Vec<Task>) {
        self.sequence += 1;
        let mut claim = claim(&worker(name), self.sequence, credits, finished, holding);
        claim.slots = 1;
        let actions = self.scheduler.on_event(START, Event::Claimed(self.sequence, claim));
        self.take(&actions);
        let mut answer = reply(&actions);
        for done in actions {
            if let Action::Deliver(finished) = done {
                let recorded = self.scheduler.on_event(START, Event::Recorded(finished.id));
                answer = answer.or_else(|| reply(&recorded));
            }
        }
        answer.expect("each claim is answered")
    }

    fn take(&mut self, actions: &[Action]) {
        for action in actions {
            match action {
                Action::Deliver(finished) => self.delivered.push((**finished).clone()),
                Action::GiveUp(task, reason) => self.given_up.push((*task, reason.clone())),
                Action::Warn(warning) => self.warnings.push(warning.clone()),
                _ => {}
            }
        }
    }

    /// Lets the workers claim in turns until all tasks have ended or one is given up.
    fn run(&mut self, factors: &[(&str, f64)]) {
        let mut running: Vec<Option<Task>> = vec![None; factors.len()];
        for turn in 0..1000 {
            if self.scheduler.tasks.open() == 0 || !self.given_up.is_empty() {
                return;
            }
            let k = turn % factors.len();
            let (name, factor) = factors[k];
            let finished = running[k].take().map(|task| outcome(&task, name, factor)).into_iter().collect();
            running[k] = self.claims(name, 1, finished, &[]).1.pop();
        }
        panic!("tasks stay open: {:?}", self.scheduler);
    }
}

fn outcome(task: &Task, name: &str, factor: f64) -> Outcome {
    let value = factor * (1.0 + task.sample[0]);
    let evaluation = Evaluation {
        cycles: vec![1000],
        histories: vec![vec![value]],
        errors: vec![vec![1e-3]],
        ..Evaluation::default()
    };
    Outcome { task: task.clone(), worker: format!("{name}/0"), wall: 1.0, result: Ok(evaluation) }
}

const FIRST: CrossCheck = CrossCheck { share: 0.0, is_exact: true };

#[test]
fn issue_a_worker_with_other_results_was_believed() {
    for wrong in ["a", "b", "c"] {
        let mut farm = Farm::new(&["a", "b", "c"], 12, FIRST);
        let factors = ["a", "b", "c"].map(|name| (name, if name == wrong { 0.8 } else { 1.0 }));
        farm.run(&factors);
        assert_eq!(farm.given_up, [], "{wrong}");
        assert_eq!(farm.delivered.len(), 12, "{wrong}");
        assert!(farm.delivered.iter().all(|finished| !finished.worker.starts_with(wrong)), "{wrong}");
        let named = format!("worker {wrong} gets no more evaluations");
        assert!(
            farm.warnings.iter().any(|warning| warning.starts_with(&named)),
            "{wrong}: {:?}",
            farm.warnings
        );
    }
}

#[test]
fn two_workers_that_differ_end_the_study_by_name() {
    let mut farm = Farm::new(&["a", "b"], 4, FIRST);
    farm.run(&[("a", 1.0), ("b", 0.8)]);
    let [(_, reason)] = &farm.given_up[..] else { panic!("{:?}", farm.given_up) };
    assert!(reason.contains("workers a, b return different results"), "{reason}");
    assert_eq!(farm.delivered, []);
}

#[test]
fn a_worker_alone_is_not_checked_and_waits_for_nobody() {
    let mut farm = Farm::new(&["a"], 3, CrossCheck { share: 1.0, is_exact: true });
    farm.run(&[("a", 1.0)]);
    assert_eq!((farm.delivered.len(), farm.given_up.len()), (3, 0));
}

#[test]
fn what_waits_for_a_worker_that_is_lost_goes_on_without_it() {
    let mut farm = Farm::new(&["a", "b"], 1, FIRST);
    let (_, tasks) = farm.claims("a", 1, vec![], &[]);
    let (acknowledged, again) = farm.claims("a", 1, vec![outcome(&tasks[0], "a", 1.0)], &[]);
    assert_eq!((acknowledged, numbers(&again)), (vec![0], vec![]), "not given to the same worker");
    assert_eq!(farm.delivered, []);
    farm.scheduler.on_event(START, Event::WorkerLost(worker("b")));
    let actions = farm.scheduler.on_event(START, Event::Tick);
    farm.take(&actions);
    assert_eq!(farm.delivered.len(), 1);
}

#[test]
fn a_share_is_repeated_and_one_that_turns_wrong_ends_the_study_with_its_name() {
    let all = CrossCheck { share: 1.0, is_exact: true };
    let mut farm = Farm::new(&["a", "b", "c"], 6, all);
    farm.run(&[("a", 1.0), ("b", 1.0), ("c", 1.0)]);
    assert_eq!((farm.delivered.len(), farm.given_up.len()), (6, 0));
    farm.scheduler.on_event(START, Event::Submit(requests(6..12)));
    farm.run(&[("a", 1.0), ("b", 0.8), ("c", 1.0)]);
    let doubtful = farm.given_up.iter().any(|(_, reason)| reason.contains("--distrust b"));
    assert!(
        doubtful || farm.delivered.iter().all(|finished| finished.worker != "b/0"),
        "{:?}",
        farm.given_up
    );
}

#[test]
fn results_of_external_simulators_agree_within_their_stated_errors() {
    let mut farm = Farm::new(&["a", "b"], 4, CrossCheck { share: 1.0, is_exact: false });
    farm.run(&[("a", 1.0), ("b", 1.0 + 1e-4)]);
    assert_eq!((farm.delivered.len(), farm.given_up.len()), (4, 0));
    let mut farm = Farm::new(&["a", "b"], 4, CrossCheck { share: 1.0, is_exact: false });
    farm.run(&[("a", 1.0), ("b", 1.01)]);
    assert_eq!(farm.given_up.len(), 1);
}

#[test]
fn an_outlier_is_evaluated_again_by_another_worker_while_one_is_connected() {
    let repeated = || {
        let mut again = requests(0..1);
        again[0].not_by = vec!["a/0".into()];
        Event::Submit(again)
    };
    for others in [true, false] {
        let names: &[&str] = if others { &["a", "b", "ab"] } else { &["a"] };
        let mut farm = Farm::new(names, 0, CrossCheck { share: 0.0, is_exact: false });
        farm.scheduler.on_event(START, repeated());
        let (_, tasks) = farm.claims("a", 1, vec![], &[]);
        assert_eq!(tasks.is_empty(), others, "{names:?}");
        if others {
            assert_eq!(numbers(&farm.claims("ab", 1, vec![], &[]).1), [0]);
        }
    }
}
