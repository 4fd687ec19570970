//! The real scheduler with thousands of workers in simulated time: messages have a latency, claims cost time of the
//! coordinator, records become durable in groups, workers differ in speed and some crash.

use common::accuracy::Accuracy;
use common::build::Build;
use common::failure::SimulationFailure;
use common::wire::{Claim, Offers, Outcome, Task, TaskKey, WorkerId};
use coordinator::farm::dispatch::scheduler::{Action, Event, Scheduler, SchedulerSettings, Token};
use coordinator::farm::evaluate::Request;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::time::{Duration, Instant};

const CAMPAIGN: u64 = 1;
/// Time after which an idle worker claims again.
const CLAIM_AGAIN_AFTER: Duration = Duration::from_secs(1);
/// Simulated time after which the tasks that are open stay open.
const LONGEST: Duration = Duration::from_secs(30 * 24 * 3600);
const TICK: Duration = Duration::from_millis(500);
/// Shortest interval between two notices per worker, as the coordinator has it.
const INTERVAL_PER_WORKER: Duration = Duration::from_micros(100);

/// Parameters of a simulated farm.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Workers, of one slot each.
    pub workers: usize,
    /// Tasks in all.
    pub tasks: usize,
    /// Tasks submitted at the start.
    pub initial: usize,
    /// Tasks in progress afterwards, as long as there are others.
    pub batch: usize,
    /// Time in which the workers join, one after another.
    pub joining: Duration,
    /// Mean time of a task on a worker of mean speed; single tasks take 0.5 to 1.5 times as long.
    pub takes: Duration,
    /// Speed of the fastest worker over that of the slowest [1].
    pub spread: f64,
    /// Latency of a message.
    pub latency: Duration,
    /// Time of the coordinator for a claim.
    pub claim_cost: Duration,
    /// Time to make records durable, for all that have arrived meanwhile.
    pub flush: Duration,
    /// One in `deaths` tasks crashes its worker; 0: none.
    pub deaths: usize,
    /// Whether idle workers get stragglers too.
    pub stragglers: bool,
}

/// Results of a simulated farm.
#[derive(Debug, Clone, Copy)]
pub struct Figures {
    /// Time until the last record.
    pub makespan: Duration,
    /// Work done over what workers that are always busy from when they join to the last record would do [1].
    pub efficiency: f64,
    /// Efficiency until the first worker finds no task [1].
    pub efficiency_before_tail: f64,
    /// Tasks evaluated more than once.
    pub repeated: usize,
    /// Workers that crashed.
    pub deaths: usize,
    /// Wall time of the scheduler per event, on this machine.
    pub per_event: Duration,
}

enum Happening {
    Joins(usize),
    Claim(usize, u64),
    Handled(usize, u64),
    Reply(usize, u64, Vec<TaskKey>, Option<Vec<Task>>),
    TaskEnds(usize, u64, u64),
    Announcement,
    Notice(usize),
    ClaimAgain(usize, u64),
    Flushed(Vec<u64>),
    Lost(WorkerId),
    Tick,
}

struct SimulatedWorker {
    id: WorkerId,
    /// When it joins; later ones claim nothing.
    joins: Duration,
    speed: f64,
    sequence: u64,
    running: Option<Task>,
    finished: Vec<Outcome>,
    asks: bool,
    busy: Duration,
}

struct World {
    plan: Plan,
    scheduler: Scheduler,
    now: Duration,
    order: u64,
    queue: BinaryHeap<Reverse<(Duration, u64)>>,
    happenings: BTreeMap<u64, Happening>,
    hands: Vec<SimulatedWorker>,
    claims: BTreeMap<(usize, u64), Claim>,
    tokens: BTreeMap<Token, (usize, u64)>,
    coordinator_free: Duration,
    to_flush: Vec<u64>,
    flushing: bool,
    recorded: Vec<u32>,
    evaluated: Vec<u32>,
    open: usize,
    submitted: usize,
    earliest_notice: Duration,
    notice_waits: bool,
    first_idle: Option<Duration>,
    work: f64,
    work_before_tail: f64,
    deaths: usize,
    events: usize,
    spent: Duration,
}

/// A pseudo-random number in [0, 1) determined by `n`.
fn chance(n: u64) -> f64 {
    let mut x = n.wrapping_add(0x9E37_79B9_7F4A_7C15).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 29)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Runs the plan until every task is recorded.
///
/// # Panics
/// If a task is recorded twice, is given up, or never ends.
pub fn simulate(plan: Plan) -> Figures {
    let mut world = World::new(plan);
    for k in 0..plan.workers {
        world.at(world.hands[k].joins, Happening::Joins(k));
    }
    world.submit(plan.initial);
    world.at(TICK, Happening::Tick);
    while world.open > 0 {
        let Reverse((now, order)) = world.queue.pop().expect("a farm with open tasks goes on");
        assert!(now < LONGEST, "{} tasks are open for ever", world.open);
        world.now = now;
        let happening = world.happenings.remove(&order).expect("each happens once");
        world.happen(happening);
    }
    world.figures()
}

impl World {
    fn new(plan: Plan) -> Self {
        let hand = |k: usize| SimulatedWorker {
            id: WorkerId { name: format!("w{k}"), epoch: 1 },
            joins: plan.joining.mul_f64(k as f64 / plan.workers as f64),
            speed: plan.spread.powf(chance(k as u64) - 0.5),
            sequence: 0,
            running: None,
            finished: vec![],
            asks: false,
            busy: Duration::ZERO,
        };
        let usual = SchedulerSettings::new(CAMPAIGN);
        let straggler_factor = if plan.stragglers { usual.straggler_factor } else { f64::INFINITY };
        let settings = SchedulerSettings { losses_allowed: 100, straggler_factor, ..usual };
        World {
            plan,
            scheduler: Scheduler::new(settings),
            now: Duration::ZERO,
            order: 0,
            queue: BinaryHeap::new(),
            happenings: BTreeMap::new(),
            hands: (0..plan.workers).map(hand).collect(),
            claims: BTreeMap::new(),
            tokens: BTreeMap::new(),
            coordinator_free: Duration::ZERO,
            to_flush: vec![],
            flushing: false,
            recorded: vec![0; plan.tasks],
            evaluated: vec![0; plan.tasks],
            open: plan.tasks,
            submitted: 0,
            earliest_notice: Duration::ZERO,
            notice_waits: false,
            first_idle: None,
            work: 0.0,
            work_before_tail: 0.0,
            deaths: 0,
            events: 0,
            spent: Duration::ZERO,
        }
    }

    fn at(&mut self, when: Duration, happening: Happening) {
        self.order += 1;
        self.queue.push(Reverse((when, self.order)));
        self.happenings.insert(self.order, happening);
    }

    fn soon(&mut self, happening: Happening) {
        self.at(self.now + self.plan.latency, happening);
    }

    fn happen(&mut self, happening: Happening) {
        match happening {
            Happening::Joins(k) => {
                self.event(Event::WorkerJoined(self.hands[k].id.clone()));
                self.at(self.now + self.plan.latency.mul_f64(chance(k as u64)), Happening::Notice(k));
            }
            Happening::Claim(k, sequence) => {
                let at = self.coordinator_free.max(self.now);
                self.coordinator_free = at + self.plan.claim_cost;
                self.at(at, Happening::Handled(k, sequence));
            }
            Happening::Handled(k, sequence) => {
                let claim = self.claims.remove(&(k, sequence)).expect("each claim arrives once");
                let token = self.events as Token;
                self.tokens.insert(token, (k, sequence));
                self.event(Event::Claimed(token, claim));
            }
            Happening::Reply(k, sequence, acknowledged, assignment) => {
                self.replied(k, sequence, &acknowledged, assignment);
            }
            Happening::TaskEnds(k, task, epoch) if self.hands[k].id.epoch == epoch => self.task_ends(k, task),
            Happening::Announcement => self.announce(),
            Happening::Notice(k) => self.claim(k),
            Happening::ClaimAgain(k, sequence) if self.hands[k].sequence == sequence => self.claim(k),
            Happening::TaskEnds(..) | Happening::ClaimAgain(..) => {}
            Happening::Flushed(tasks) => {
                self.flushing = false;
                for task in tasks {
                    self.recorded[task as usize] += 1;
                    assert_eq!(self.recorded[task as usize], 1, "task {task} was recorded twice");
                    self.open -= 1;
                    self.event(Event::Recorded(task));
                }
                let in_progress = self.submitted + self.open - self.plan.tasks;
                self.submit(self.plan.batch.saturating_sub(in_progress));
                self.flush();
            }
            Happening::Lost(id) => self.event(Event::WorkerLost(id)),
            Happening::Tick => {
                self.event(Event::Tick);
                self.at(self.now + TICK, Happening::Tick);
            }
        }
    }

    fn event(&mut self, event: Event) {
        self.events += 1;
        let started = Instant::now();
        let actions = self.scheduler.on_event(self.now, event);
        self.spent += started.elapsed();
        for action in actions {
            match action {
                Action::Deliver(finished) => self.to_flush.push(finished.id),
                Action::Reply(token, acknowledged, assignment) => {
                    let (k, sequence) = self.tokens.remove(&token).expect("each claim is answered once");
                    self.soon(Happening::Reply(k, sequence, acknowledged, assignment));
                }
                Action::Announce(_) if !self.notice_waits => {
                    self.notice_waits = true;
                    self.at(self.earliest_notice.max(self.now), Happening::Announcement);
                }
                Action::GiveUp(task, reason) => panic!("task {task} was given up: {reason}"),
                Action::Announce(_) | Action::AnnounceEnd | Action::Warn(_) => {}
            }
        }
        self.flush();
    }

    fn submit(&mut self, count: usize) {
        let until = (self.submitted + count).min(self.plan.tasks);
        let request = |k| Request::at(k, vec![k as f64], Accuracy::draft());
        let requests: Vec<Request> = (self.submitted as u64..until as u64).map(request).collect();
        self.submitted = until;
        if !requests.is_empty() {
            self.event(Event::Submit(requests));
        }
    }

    fn announce(&mut self) {
        self.notice_waits = false;
        let workers = u32::try_from(self.hands.len()).unwrap_or(u32::MAX);
        self.earliest_notice = self.now + INTERVAL_PER_WORKER * workers;
        let is_idle = |hand: &SimulatedWorker| hand.running.is_none() && hand.joins <= self.now;
        let idle: Vec<usize> = (0..self.hands.len()).filter(|k| is_idle(&self.hands[*k])).collect();
        idle.into_iter().for_each(|k| self.soon(Happening::Notice(k)));
    }

    fn flush(&mut self) {
        if !self.flushing && !self.to_flush.is_empty() {
            self.flushing = true;
            let tasks = std::mem::take(&mut self.to_flush);
            self.at(self.now + self.plan.flush, Happening::Flushed(tasks));
        }
    }

    fn claim(&mut self, k: usize) {
        let hand = &mut self.hands[k];
        if hand.asks || (hand.running.is_some() && hand.finished.is_empty()) {
            return;
        }
        hand.asks = true;
        hand.sequence += 1;
        let held = hand.running.iter().chain(hand.finished.iter().map(|outcome| &outcome.task));
        let claim = Claim {
            worker: hand.id.clone(),
            sequence: hand.sequence,
            offers: Offers::Scenes(Build::default()),
            slots: 1,
            credits: u32::from(hand.running.is_none()),
            holding: held.map(|task| task.key).collect(),
            finished: hand.finished.clone(),
            leaving: false,
        };
        let sequence = hand.sequence;
        self.claims.insert((k, sequence), claim);
        self.soon(Happening::Claim(k, sequence));
    }

    fn replied(&mut self, k: usize, sequence: u64, acknowledged: &[TaskKey], tasks: Option<Vec<Task>>) {
        let now = self.now;
        let hand = &mut self.hands[k];
        if hand.sequence != sequence {
            return;
        }
        hand.asks = false;
        hand.finished.retain(|outcome| !acknowledged.contains(&outcome.task.key));
        let Some(mut tasks) = tasks.filter(|tasks| !tasks.is_empty()) else {
            self.first_idle.get_or_insert(now);
            let again = now + CLAIM_AGAIN_AFTER.mul_f64(1.0 - 0.25 * chance(sequence));
            self.at(again, Happening::ClaimAgain(k, sequence));
            return;
        };
        let task = tasks.pop().expect("a work order has a task");
        assert!(tasks.is_empty() && hand.running.is_none(), "more tasks than requested");
        let number = task.key.task;
        let takes = self.plan.takes.mul_f64((0.5 + chance(number)) / hand.speed);
        let (ends, epoch) = (now + takes, hand.id.epoch);
        let dies = self.plan.deaths > 0
            && task.attempt == 1
            && chance(number ^ 0xDEAD) * (self.plan.deaths as f64) < 1.0;
        hand.running = Some(task);
        hand.busy = takes;
        if dies {
            self.deaths += 1;
            let gone = std::mem::replace(&mut self.hands[k].id.epoch, epoch + 1);
            let id = WorkerId { epoch: gone, ..self.hands[k].id.clone() };
            let hand = &mut self.hands[k];
            (hand.running, hand.asks) = (None, false);
            hand.finished.clear();
            let new = hand.id.clone();
            self.at(now + takes / 2, Happening::Lost(id));
            self.event(Event::WorkerJoined(new));
            self.at(now + takes / 2, Happening::Notice(k));
        } else {
            self.at(ends, Happening::TaskEnds(k, number, epoch));
        }
    }

    fn task_ends(&mut self, k: usize, number: u64) {
        let hand = &mut self.hands[k];
        let Some(task) = hand.running.take() else { return };
        assert_eq!(task.key.task, number, "one task at a time");
        let done = hand.busy.as_secs_f64() * hand.speed;
        let result = Err(SimulationFailure::NotModelled { what: String::new() });
        hand.finished.push(Outcome {
            task,
            worker: hand.id.name.clone(),
            wall: hand.busy.as_secs_f64(),
            result,
        });
        self.evaluated[number as usize] += 1;
        if self.evaluated[number as usize] == 1 {
            self.work += done;
            if self.first_idle.is_none() {
                self.work_before_tail += done;
            }
        }
        self.claim(k);
    }

    fn figures(&self) -> Figures {
        let until = self.first_idle.unwrap_or(self.now);
        let possible = |until: Duration| -> f64 {
            self.hands.iter().map(|hand| hand.speed * until.saturating_sub(hand.joins).as_secs_f64()).sum()
        };
        let under_way = 0.5 * self.plan.takes.as_secs_f64() * self.plan.workers as f64;
        Figures {
            makespan: self.now,
            efficiency: self.work / possible(self.now),
            efficiency_before_tail: (self.work_before_tail + under_way) / possible(until),
            repeated: self.evaluated.iter().filter(|n| **n > 1).count(),
            deaths: self.deaths,
            per_event: self.spent / u32::try_from(self.events).unwrap_or(u32::MAX),
        }
    }
}
