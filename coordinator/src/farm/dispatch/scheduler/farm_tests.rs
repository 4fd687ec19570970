//! Property test of the scheduler: messages are lost, duplicated, delayed and out of order, workers crash, hang and return,
//! and the coordinator restarts.

use super::tests::{CAMPAIGN, START, claim, outcome, requests, worker};
use super::*;
use common::wire::Task;
use proptest::prelude::*;
use std::collections::BTreeMap;

/// A worker of the simulated farm, with its tasks and outcomes.
#[derive(Debug, Clone)]
struct Hand {
    id: WorkerId,
    alive: bool,
    sequence: u64,
    running: Vec<Task>,
    finished: Vec<Outcome>,
}

/// Worker and number of a claim, what the worker may discard, and its tasks; none to leave.
type SentReply = (WorkerId, u64, Vec<TaskKey>, Option<Vec<Task>>);

/// The scheduler with workers and the messages in transit.
struct Farm {
    scheduler: Scheduler,
    hands: Vec<Hand>,
    claims: Vec<(usize, Claim)>,
    replies: Vec<SentReply>,
    tokens: BTreeMap<Token, (WorkerId, u64)>,
    unrecorded: Vec<u64>,
    given_up: Vec<u64>,
    recorded: BTreeSet<u64>,
    now: Duration,
    submitted: u64,
}

impl Farm {
    fn new(hands: usize, losses_allowed: u32, settle: Duration) -> Self {
        let hand = |k: usize| Hand {
            id: worker(&format!("w{k}")),
            alive: false,
            sequence: 0,
            running: vec![],
            finished: vec![],
        };
        Self {
            scheduler: Scheduler::new(SchedulerSettings {
                losses_allowed,
                settle,
                ..SchedulerSettings::new(CAMPAIGN)
            }),
            hands: (0..hands).map(hand).collect(),
            claims: vec![],
            replies: vec![],
            tokens: BTreeMap::new(),
            unrecorded: vec![],
            given_up: vec![],
            recorded: BTreeSet::new(),
            now: START,
            submitted: 0,
        }
    }

    fn event(&mut self, event: Event) {
        for action in self.scheduler.on_event(self.now, event) {
            match action {
                Action::Deliver(finished) => {
                    let before =
                        self.unrecorded.contains(&finished.id) || self.recorded.contains(&finished.id);
                    assert!(!before, "task {} was delivered twice", finished.id);
                    self.unrecorded.push(finished.id);
                }
                Action::GiveUp(task, _) => self.given_up.push(task),
                Action::Reply(token, acknowledged, tasks) => {
                    for key in &acknowledged {
                        let ended = self.recorded.contains(&key.task) || self.given_up.contains(&key.task);
                        assert!(ended, "task {} was acknowledged before it was durable", key.task);
                    }
                    let (id, sequence) = self.tokens.remove(&token).expect("each claim is answered once");
                    self.replies.push((id, sequence, acknowledged, tasks));
                }
                Action::Announce(_) | Action::AnnounceEnd | Action::Warn(_) => {}
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
        self.event(Event::Claimed(token, claim));
    }

    fn deliver_reply(&mut self, at: usize) {
        let (id, sequence, acknowledged, tasks) = self.replies.swap_remove(at);
        let Some(hand) = self.hands.iter_mut().find(|hand| hand.id == id) else { return };
        // A worker ignores replies to all but its latest claim.
        if hand.sequence != sequence {
            return;
        }
        hand.finished.retain(|outcome| !acknowledged.contains(&outcome.task.key));
        hand.running.retain(|task| !acknowledged.contains(&task.key));
        for task in tasks.into_iter().flatten() {
            let held = hand.finished.iter().map(|o| &o.task).chain(&hand.running);
            if !held.into_iter().any(|other| other.same_work(&task)) {
                hand.running.push(task);
            }
        }
    }

    fn record_one(&mut self, at: usize) {
        let task = self.unrecorded.swap_remove(at);
        assert!(self.recorded.insert(task), "task {task} was recorded twice");
        self.event(Event::Recorded(task));
    }

    /// The study requests all evaluations without outcome again.
    fn ask_again(&mut self) {
        let mut open = requests(0..self.submitted);
        open.retain(|request| !self.recorded.contains(&request.id) && !self.given_up.contains(&request.id));
        self.event(Event::Submit(open));
    }

    /// The coordinator crashes, and a new one starts with the campaign file only.
    fn restart(&mut self) {
        self.scheduler = Scheduler::new(self.scheduler.settings.clone());
        self.tokens.clear();
        self.unrecorded.clear();
        let alive: Vec<WorkerId> = self.hands.iter().filter(|h| h.alive).map(|h| h.id.clone()).collect();
        // Some workers connect before the study requests evaluations, some after.
        let early = alive.len() / 2;
        alive[..early].iter().for_each(|id| self.event(Event::WorkerJoined(id.clone())));
        self.ask_again();
        alive[early..].iter().for_each(|id| self.event(Event::WorkerJoined(id.clone())));
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
                self.event(Event::WorkerJoined(self.hands[k].id.clone()));
            }
            // Disconnected; it may return later with its tasks.
            15 => {
                self.hands[k].alive = false;
                self.event(Event::WorkerLost(self.hands[k].id.clone()));
            }
            // Crashed, and restarted without tasks.
            16 => {
                self.event(Event::WorkerLost(self.hands[k].id.clone()));
                let hand = &mut self.hands[k];
                hand.id.epoch += 1;
                (hand.alive, hand.sequence) = (true, 0);
                hand.running.clear();
                hand.finished.clear();
                self.event(Event::WorkerJoined(self.hands[k].id.clone()));
            }
            17 => {
                self.now += Duration::from_secs(50 * (choice as u64 % 30));
                self.event(Event::Tick);
            }
            18 => {
                self.now += Duration::from_secs(3 * (choice as u64 % 3));
                self.event(Event::Tick);
            }
            19 if choice.is_multiple_of(4) => {
                self.event(Event::Cancel);
                self.unrecorded.clear();
                self.ask_again();
            }
            20 if choice.is_multiple_of(4) => self.restart(),
            _ => {}
        }
    }

    /// Runs to the end without further faults: all workers are connected, and every message arrives.
    fn run_out(&mut self) {
        for k in 0..self.hands.len() {
            self.event(Event::WorkerJoined(self.hands[k].id.clone()));
        }
        for _ in 0..10_000 {
            while !self.unrecorded.is_empty() {
                self.record_one(0);
            }
            if self.scheduler.tasks.open() == 0 {
                return;
            }
            self.now += Duration::from_secs(1);
            self.event(Event::Tick);
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
        panic!("{} tasks never ended", self.scheduler.tasks.open());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// After any sequence of events, each task ends exactly once and none is lost.
    #[test]
    fn every_task_ends_exactly_once(
        hands in 1usize..4,
        losses_allowed in prop_oneof![Just(2u32), Just(1000)],
        settle in prop_oneof![Just(0u64), Just(2)],
        steps in proptest::collection::vec((0u8..21, any::<u16>()), 0..200),
    ) {
        let mut farm = Farm::new(hands, losses_allowed, Duration::from_secs(settle));
        farm.step(0, 3);
        for (op, choice) in steps {
            farm.step(op, usize::from(choice));
        }
        farm.run_out();
        let mut ended: Vec<u64> = farm.recorded.iter().chain(&farm.given_up).copied().collect();
        ended.sort_unstable();
        prop_assert_eq!(ended, (0..farm.submitted).collect::<Vec<_>>());
        if losses_allowed == 1000 {
            prop_assert!(farm.given_up.is_empty());
        }
    }
}
