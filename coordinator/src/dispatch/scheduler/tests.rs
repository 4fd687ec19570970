//! The scheduler's rules, one by one, and then under everything a network and its machines can do.

use super::*;
use crate::evaluate::Request;
use common::failure::SimulationFailure;
use common::wire::Task;
use proptest::prelude::*;

const CAMPAIGN: u64 = 7;
const START: Duration = Duration::ZERO;

fn worker(name: &str) -> WorkerId {
    WorkerId { name: name.into(), epoch: 1 }
}

fn requests(ids: std::ops::Range<u64>) -> Vec<Request> {
    ids.map(|id| Request { id, sample: vec![id as f64, 0.5], with_first_cycle: false }).collect()
}

fn claim(who: &WorkerId, sequence: u64, credits: u32, finished: Vec<Outcome>, holding: &[u64]) -> Claim {
    let holding = holding.iter().map(|&task| TaskKey { campaign: CAMPAIGN, task }).collect();
    Claim { worker: who.clone(), sequence, slots: credits, credits, holding, finished, leaving: false }
}

fn outcome(task: &Task, who: &WorkerId) -> Outcome {
    let result = Err(SimulationFailure::NotModelled { what: format!("{}", task.key.task) });
    Outcome { task: task.clone(), worker: format!("{}/0", who.name), wall: 1.0, result }
}

fn scheduler(workers: &[&WorkerId], tasks: u64) -> Scheduler {
    let mut scheduler = Scheduler::new(Settings::new(CAMPAIGN));
    for id in workers {
        scheduler.on_event(START, Event::Appeared((*id).clone()));
    }
    scheduler.on_event(START, Event::Submit(requests(0..tasks)));
    scheduler
}

/// The reply in the commands: acknowledged numbers and tasks.
fn reply(commands: &[Command]) -> Option<(Vec<u64>, Vec<Task>)> {
    commands.iter().find_map(|command| match command {
        Command::Reply { acknowledged, assignment, .. } => {
            let tasks = if let Assignment::Work(tasks) = assignment { tasks.clone() } else { vec![] };
            Some((acknowledged.iter().map(|key| key.task).collect(), tasks))
        }
        _ => None,
    })
}

fn numbers(tasks: &[Task]) -> Vec<u64> {
    tasks.iter().map(|task| task.key.task).collect()
}

fn ask(scheduler: &mut Scheduler, now: Duration, claim: Claim) -> Vec<Command> {
    scheduler.on_event(now, Event::Claimed { token: claim.sequence, claim })
}

#[test]
fn an_outcome_is_acknowledged_only_when_it_is_durable() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 2);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    let commands = ask(&mut s, START, claim(&a, 2, 1, vec![outcome(&tasks[0], &a)], &[]));
    assert!(matches!(&commands[..], [Command::Deliver(finished)] if finished.id == 0), "{commands:?}");
    let (acknowledged, tasks) = reply(&s.on_event(START, Event::Recorded { task: 0 })).unwrap();
    assert_eq!((acknowledged, numbers(&tasks)), (vec![0], vec![1]));
}

#[test]
fn a_doubled_outcome_is_acknowledged_and_not_counted() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 1);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    ask(&mut s, START, claim(&a, 2, 0, vec![outcome(&tasks[0], &a)], &[]));
    // A second one while the first is being recorded waits with it; a third one after that is acknowledged.
    let second = ask(&mut s, START, claim(&b, 3, 0, vec![outcome(&tasks[0], &b)], &[]));
    assert_eq!(second, vec![]);
    let replies = s.on_event(START, Event::Recorded { task: 0 });
    assert_eq!(replies.len(), 2);
    let third = ask(&mut s, START, claim(&b, 4, 0, vec![outcome(&tasks[0], &b)], &[]));
    assert_eq!(reply(&third), Some((vec![0], vec![])));
    assert_eq!(third.len(), 1);
}

#[test]
fn what_a_lost_worker_held_goes_to_the_front_and_idle_workers_are_told() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 5);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 2, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [0, 1]);
    let commands = s.on_event(START, Event::Gone(a.clone()));
    assert!(commands.contains(&Command::Warn(Warning::WorkerLost { worker: a, tasks: vec![0, 1] })));
    assert!(commands.iter().any(|c| matches!(c, Command::Announce(points) if points.len() == 2)));
    let (_, tasks) = reply(&ask(&mut s, START, claim(&b, 2, 3, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [0, 1, 2]);
    assert_eq!(tasks.iter().map(|task| task.attempt).collect::<Vec<_>>(), [2, 2, 1]);
}

#[test]
fn a_task_that_three_workers_did_not_survive_is_given_up_by_name() {
    let mut s = scheduler(&[], 1);
    let mut last = vec![];
    for k in 0..3 {
        let id = worker(&format!("w{k}"));
        s.on_event(START, Event::Appeared(id.clone()));
        ask(&mut s, START, claim(&id, 1, 1, vec![], &[]));
        last = s.on_event(START, Event::Gone(id));
    }
    let given_up = last.iter().any(
        |c| matches!(c, Command::GiveUp { task: 0, reason } if reason == "3 workers were lost while they had it"),
    );
    assert!(given_up, "{last:?}");
    assert_eq!(s.open(), 0);
}

#[test]
fn a_worker_that_leaves_gives_its_tasks_back_without_blame() {
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
fn a_lease_the_worker_does_not_know_of_was_lost_on_the_way() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 3);
    ask(&mut s, START, claim(&a, 1, 2, vec![], &[]));
    // The reply to claim 1 never came; task 1 did by a miracle.
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 2, 1, vec![], &[1]))).unwrap();
    assert_eq!(numbers(&tasks), [0]);
    // An outdated claim gets nothing and changes nothing.
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 3, vec![], &[]))).unwrap();
    assert_eq!(numbers(&tasks), [] as [u64; 0]);
}

#[test]
fn a_claim_its_worker_no_longer_waits_for_gets_no_tasks() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 3);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    // Claim 2 waits for its record too long; the worker asks again without an answer.
    ask(&mut s, START, claim(&a, 2, 1, vec![outcome(&tasks[0], &a)], &[0]));
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 3, 1, vec![], &[0]))).unwrap();
    assert_eq!(numbers(&tasks), [1]);
    assert_eq!(reply(&s.on_event(START, Event::Recorded { task: 0 })), Some((vec![0], vec![])));
}

#[test]
fn an_outcome_nobody_asked_for_yet_stays_with_its_worker() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 0);
    let early = Task {
        key: TaskKey { campaign: CAMPAIGN, task: 0 },
        attempt: 1,
        sample: vec![0.0, 0.5],
        with_first_cycle: false,
    };
    let commands = ask(&mut s, START, claim(&a, 1, 0, vec![outcome(&early, &a)], &[]));
    assert_eq!(reply(&commands), Some((vec![], vec![])));
    s.on_event(START, Event::Submit(requests(0..1)));
    let commands = ask(&mut s, START, claim(&a, 2, 0, vec![outcome(&early, &a)], &[]));
    assert!(matches!(&commands[..], [Command::Deliver(_)]));
}

#[test]
fn an_outcome_of_another_campaign_or_sample_is_forgotten() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 1);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 1, vec![], &[]))).unwrap();
    let mut foreign = outcome(&tasks[0], &a);
    foreign.task.key.campaign = 8;
    assert_eq!(
        ask(&mut s, START, claim(&a, 2, 0, vec![foreign], &[0])),
        vec![Command::Reply {
            token: 2,
            acknowledged: vec![TaskKey { campaign: 8, task: 0 }],
            assignment: Assignment::Idle
        }]
    );
    let mut other = outcome(&tasks[0], &a);
    other.task.sample[1] = -0.5;
    let commands = ask(&mut s, START, claim(&a, 3, 0, vec![other], &[0]));
    assert_eq!(commands[0], Command::Warn(Warning::OtherSample { worker: a, task: 0 }));
    assert_eq!(reply(&commands), Some((vec![0], vec![])));
    assert_eq!(s.open(), 1);
}

#[test]
fn a_deadline_follows_the_longest_simulation() {
    let (a, b) = (worker("a"), worker("b"));
    let mut s = scheduler(&[&a, &b], 3);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 2, vec![], &[]))).unwrap();
    let hour = Duration::from_secs(3600);
    assert_eq!(s.on_event(hour, Event::Tick), vec![]);
    // One ends after 60 s of simulation: the other one is overdue after 600 s.
    let slow = Outcome { wall: 60.0, ..outcome(&tasks[0], &a) };
    ask(&mut s, START, claim(&a, 2, 0, vec![slow], &[1]));
    s.on_event(START, Event::Recorded { task: 0 });
    let late = Duration::from_secs(601);
    assert_eq!(s.on_event(Duration::from_secs(600), Event::Tick), vec![]);
    let commands = s.on_event(late, Event::Tick);
    assert_eq!(commands[0], Command::Warn(Warning::Overdue { worker: a.clone(), task: 1, after: late }));
    let (_, again) = reply(&ask(&mut s, late, claim(&b, 3, 1, vec![], &[]))).unwrap();
    assert_eq!(numbers(&again), [1]);
    // The first worker's outcome still counts when it comes first.
    let commands = ask(&mut s, late, claim(&a, 4, 0, vec![outcome(&tasks[1], &a)], &[]));
    assert!(matches!(&commands[..], [Command::Deliver(finished)] if finished.worker == "a/0"));
}

#[test]
fn nobody_there_and_nobody_alive_are_told_to_the_user() {
    let mut s = scheduler(&[], 4);
    let second = Duration::from_secs(1);
    assert_eq!(s.on_event(second, Event::Tick), vec![]);
    let commands = s.on_event(6 * second, Event::Tick);
    assert_eq!(commands, vec![Command::Warn(Warning::NoWorker { open: 4, since: 5 * second })]);
    // A worker without a liveliness token gets nothing, and is named once.
    let a = worker("a");
    let warnings: Vec<Command> = (1..40)
        .flat_map(|sequence| ask(&mut s, second, claim(&a, sequence, 1, vec![], &[])))
        .filter(|command| !matches!(command, Command::Reply { assignment: Assignment::Idle, .. }))
        .collect();
    assert_eq!(warnings, vec![Command::Warn(Warning::NoLiveliness { worker: a })]);
}

#[test]
fn cancelled_tasks_stay_with_their_workers_and_finish_sends_them_home() {
    let a = worker("a");
    let mut s = scheduler(&[&a], 2);
    let (_, tasks) = reply(&ask(&mut s, START, claim(&a, 1, 2, vec![], &[]))).unwrap();
    ask(&mut s, START, claim(&a, 2, 0, vec![outcome(&tasks[0], &a)], &[0, 1]));
    assert_eq!(reply(&s.on_event(START, Event::Cancel)), Some((vec![], vec![])));
    assert_eq!(s.on_event(START, Event::Recorded { task: 0 }), vec![]);
    assert_eq!(s.on_event(START, Event::Finish), vec![Command::AnnounceEnd]);
    let commands = ask(&mut s, START, claim(&a, 3, 2, vec![], &[0, 1]));
    assert!(matches!(&commands[..], [Command::Reply { assignment: Assignment::Leave, .. }]));
}

/// A worker of the simulated farm: what it holds, and the claims under way to the coordinator.
#[derive(Debug, Clone)]
struct Hand {
    id: WorkerId,
    alive: bool,
    sequence: u64,
    running: Vec<Task>,
    finished: Vec<Outcome>,
}

/// The farm around the scheduler: messages that may be lost, doubled, late and out of order.
struct Farm {
    scheduler: Scheduler,
    hands: Vec<Hand>,
    claims: Vec<(usize, Claim)>,
    replies: Vec<(WorkerId, u64, Vec<TaskKey>, Assignment)>,
    tokens: BTreeMap<Token, (WorkerId, u64)>,
    unrecorded: Vec<u64>,
    delivered: Vec<u64>,
    given_up: Vec<u64>,
    recorded: BTreeSet<u64>,
    now: Duration,
    submitted: u64,
}

impl Farm {
    fn new(hands: usize, losses_allowed: u32) -> Self {
        let hand = |k: usize| Hand {
            id: worker(&format!("w{k}")),
            alive: false,
            sequence: 0,
            running: vec![],
            finished: vec![],
        };
        Self {
            scheduler: Scheduler::new(Settings { losses_allowed, ..Settings::new(CAMPAIGN) }),
            hands: (0..hands).map(hand).collect(),
            claims: vec![],
            replies: vec![],
            tokens: BTreeMap::new(),
            unrecorded: vec![],
            delivered: vec![],
            given_up: vec![],
            recorded: BTreeSet::new(),
            now: START,
            submitted: 0,
        }
    }

    fn event(&mut self, event: Event) {
        for command in self.scheduler.on_event(self.now, event) {
            match command {
                Command::Deliver(finished) => {
                    self.delivered.push(finished.id);
                    self.unrecorded.push(finished.id);
                }
                Command::GiveUp { task, .. } => self.given_up.push(task),
                Command::Reply { token, acknowledged, assignment } => {
                    for key in &acknowledged {
                        let ended = self.recorded.contains(&key.task) || self.given_up.contains(&key.task);
                        assert!(ended, "task {} was acknowledged before it was durable", key.task);
                    }
                    let (id, sequence) = self.tokens.remove(&token).expect("each claim is answered once");
                    self.replies.push((id, sequence, acknowledged, assignment));
                }
                Command::Announce(_) | Command::AnnounceEnd | Command::Warn(_) => {}
            }
        }
    }

    fn send_claim(&mut self, k: usize) {
        let hand = &mut self.hands[k];
        hand.sequence += 1;
        let held = hand.running.iter().chain(hand.finished.iter().map(|o| &o.task));
        let holding: Vec<u64> = held.map(|task| task.key.task).collect();
        let credits = 3u32.saturating_sub(u32::try_from(hand.running.len()).unwrap());
        let claim =
            Claim { slots: 2, ..claim(&hand.id, hand.sequence, credits, hand.finished.clone(), &holding) };
        self.claims.push((k, claim));
    }

    fn deliver_claim(&mut self, at: usize, keep: bool) {
        let (_, claim) = self.claims[at].clone();
        if !keep {
            self.claims.swap_remove(at);
        }
        let token = self.tokens.keys().last().map_or(0, |last| last + 1);
        self.tokens.insert(token, (claim.worker.clone(), claim.sequence));
        self.event(Event::Claimed { token, claim });
    }

    fn deliver_reply(&mut self, at: usize) {
        let (id, sequence, acknowledged, assignment) = self.replies.swap_remove(at);
        let Some(hand) = self.hands.iter_mut().find(|hand| hand.id == id) else { return };
        // A worker listens only to the answer of its latest claim.
        if hand.sequence != sequence {
            return;
        }
        hand.finished.retain(|outcome| !acknowledged.contains(&outcome.task.key));
        if let Assignment::Work(tasks) = assignment {
            for task in tasks {
                let held = hand.finished.iter().map(|o| &o.task).chain(&hand.running);
                if !held.into_iter().any(|other| other.same_work(&task)) {
                    hand.running.push(task);
                }
            }
        }
    }

    fn record_one(&mut self, at: usize) {
        let task = self.unrecorded.swap_remove(at);
        assert!(self.recorded.insert(task), "task {task} was delivered twice");
        self.event(Event::Recorded { task });
    }

    fn step(&mut self, op: u8, choice: usize) {
        let k = choice % self.hands.len();
        match op {
            0 => {
                let more = 1 + choice as u64 % 4;
                self.event(Event::Submit(requests(self.submitted..self.submitted + more)));
                self.submitted += more;
            }
            1 | 2 => self.send_claim(k),
            3 | 4 if !self.claims.is_empty() => self.deliver_claim(choice % self.claims.len(), false),
            5 if !self.claims.is_empty() => self.deliver_claim(choice % self.claims.len(), true),
            6 if !self.claims.is_empty() => drop(self.claims.swap_remove(choice % self.claims.len())),
            7 | 8 if !self.replies.is_empty() => self.deliver_reply(choice % self.replies.len()),
            9 if !self.replies.is_empty() => drop(self.replies.swap_remove(choice % self.replies.len())),
            10 | 11 if !self.unrecorded.is_empty() => self.record_one(choice % self.unrecorded.len()),
            12 | 13 if !self.hands[k].running.is_empty() => {
                let hand = &mut self.hands[k];
                let task = hand.running.remove(0);
                hand.finished.push(outcome(&task, &hand.id));
            }
            14 => {
                self.hands[k].alive = true;
                self.event(Event::Appeared(self.hands[k].id.clone()));
            }
            // Cut off, and perhaps back later with all it had.
            15 => {
                self.hands[k].alive = false;
                self.event(Event::Gone(self.hands[k].id.clone()));
            }
            // Dead, and started again with nothing.
            16 => {
                self.event(Event::Gone(self.hands[k].id.clone()));
                let hand = &mut self.hands[k];
                hand.id.epoch += 1;
                (hand.alive, hand.sequence) = (true, 0);
                hand.running.clear();
                hand.finished.clear();
                self.event(Event::Appeared(self.hands[k].id.clone()));
            }
            17 => {
                self.now += Duration::from_secs(50 * (choice as u64 % 30));
                self.event(Event::Tick);
            }
            _ => {}
        }
    }

    /// From here on nothing more goes wrong: everybody is there and every message arrives.
    fn run_out(&mut self) {
        for k in 0..self.hands.len() {
            self.event(Event::Appeared(self.hands[k].id.clone()));
        }
        for _ in 0..10_000 {
            while !self.unrecorded.is_empty() {
                self.record_one(0);
            }
            if self.scheduler.open() == 0 {
                return;
            }
            for k in 0..self.hands.len() {
                for task in std::mem::take(&mut self.hands[k].running) {
                    let done = outcome(&task, &self.hands[k].id);
                    self.hands[k].finished.push(done);
                }
                self.send_claim(k);
                self.deliver_claim(self.claims.len() - 1, false);
                while !self.unrecorded.is_empty() {
                    self.record_one(0);
                }
                while !self.replies.is_empty() {
                    self.deliver_reply(self.replies.len() - 1);
                }
            }
        }
        panic!("{} tasks never ended", self.scheduler.open());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Whatever happens, in the end each task has ended exactly once and none was lost.
    #[test]
    fn every_task_ends_exactly_once(
        hands in 1usize..4,
        losses_allowed in prop_oneof![Just(2u32), Just(1000)],
        steps in proptest::collection::vec((0u8..18, any::<u16>()), 0..200),
    ) {
        let mut farm = Farm::new(hands, losses_allowed);
        farm.step(0, 3);
        for (op, choice) in steps {
            farm.step(op, usize::from(choice));
        }
        farm.run_out();
        let mut ended: Vec<u64> = farm.delivered.iter().chain(&farm.given_up).copied().collect();
        ended.sort_unstable();
        prop_assert_eq!(ended, (0..farm.submitted).collect::<Vec<_>>());
        prop_assert_eq!(farm.recorded.len(), farm.delivered.len());
        if losses_allowed == 1000 {
            prop_assert!(farm.given_up.is_empty());
        }
    }
}
