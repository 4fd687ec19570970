//! What a task costs the coordinator without network and workers: its messages and the scheduler, and the campaign file.
//! `cargo run --release -p tests --example coordinator_alone [FOLDER]`; the campaign files are in the folder, by default the
//! current one.

use common::build::Build;
use common::wire::{self, Claim, Next, Offers, Outcome, Reply, Subject, Task, TaskKey, WorkOrder, WorkerId};
use coordinator::farm::dispatch::scheduler::{Action, Event, Scheduler, SchedulerSettings};
use coordinator::farm::evaluate::{Finished, Request, RequestSource};
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};
use tests::campaign;
use tests::journaled::Journaled;
use tests::practice_study::evaluation;

const TASKS: u64 = 50_000;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    println!("| part | microseconds per task | tasks per second |\n|---|---|---|");
    for (workers, together) in [(20, 8), (2000, 8), (2000, 1)] {
        print(&format!("messages and scheduler, {workers} workers, {together} tasks a claim"), {
            messages(workers, together)?
        });
    }
    for together in [16, 64, 256] {
        print(
            &format!("campaign file, {together} outcomes a transaction"),
            file(Path::new(&folder), together)?,
        );
    }
    Ok(())
}

fn print(part: &str, took: Duration) {
    let each = took.as_secs_f64() / TASKS as f64;
    println!("| {part} | {:.1} | {:.0} |", 1e6 * each, 1.0 / each);
}

/// A worker that returns its tasks with its next claim.
struct Hand {
    id: WorkerId,
    sequence: u64,
    tasks: Vec<Task>,
}

impl Hand {
    fn claim(&mut self, credits: u32) -> Claim {
        self.sequence += 1;
        let outcome = |task: Task| Outcome {
            result: evaluation(&task.sample),
            task,
            worker: format!("{}/0", self.id.name),
            wall: 1e-3,
        };
        let finished: Vec<Outcome> = self.tasks.drain(..).map(outcome).collect();
        Claim {
            worker: self.id.clone(),
            sequence: self.sequence,
            offers: Offers::Scenes(Build::default()),
            slots: 1,
            credits,
            holding: finished.iter().map(|outcome| outcome.task.key).collect(),
            finished,
            leaving: false,
        }
    }
}

/// Time of the coordinator for all tasks: decoding of claims, scheduler, encoding of replies.
fn messages(workers: usize, together: u32) -> Result<Duration, Box<dyn Error>> {
    let spec = campaign();
    let mut scheduler = Scheduler::new(SchedulerSettings {
        subject: Subject::Scene(spec.scene.clone()),
        ..SchedulerSettings::new(spec.id)
    });
    let order = WorkOrder {
        subject: Subject::Scene(spec.scene),
        accuracy: spec.accuracy,
        accuracy_name: spec.accuracy_name,
        licensed: false,
        tasks: vec![],
    };
    let mut hands: Vec<Hand> = (0..workers)
        .map(|k| Hand { id: WorkerId { name: format!("w{k}"), epoch: 1 }, sequence: 0, tasks: vec![] })
        .collect();
    let begun = Instant::now();
    let mut took = Duration::ZERO;
    for hand in &hands {
        scheduler.on_event(begun.elapsed(), Event::WorkerJoined(hand.id.clone()));
    }
    let requests = (0..TASKS).map(request).collect();
    scheduler.on_event(begun.elapsed(), Event::Submit(requests));
    let (mut recorded, mut token) = (0, 0);
    while recorded < TASKS {
        for hand in &mut hands {
            token += 1;
            let frame = wire::encode(&hand.claim(together))?;
            let handled = Instant::now();
            let claim = wire::decode::<Claim>(&frame)?;
            let mut actions = scheduler.on_event(begun.elapsed(), Event::Claimed(token, claim));
            let mut reply = None;
            while !actions.is_empty() {
                let mut next = vec![];
                for action in actions {
                    match action {
                        Action::Deliver(finished) => {
                            recorded += 1;
                            let task = finished.id;
                            next.extend(scheduler.on_event(begun.elapsed(), Event::Recorded(task)));
                        }
                        Action::Reply(_, acknowledged, assignment) => {
                            reply = Some(encoded(acknowledged, assignment, &order)?);
                        }
                        _ => {}
                    }
                }
                actions = next;
            }
            took += handled.elapsed();
            let reply = wire::decode::<Reply>(&reply.ok_or("a claim has no reply")?)?;
            if let Next::Work(order) = reply.next {
                hand.tasks = order.tasks;
            }
        }
    }
    Ok(took)
}

fn encoded(
    acknowledged: Vec<TaskKey>,
    tasks: Option<Vec<Task>>,
    order: &WorkOrder,
) -> Result<Vec<u8>, wire::WireError> {
    let next = match tasks {
        None => Next::Leave { campaign: campaign().id },
        Some(tasks) if tasks.is_empty() => Next::Idle { ask_again: 1000 },
        Some(tasks) => Next::Work(WorkOrder { tasks, ..order.clone() }),
    };
    wire::encode(&Reply { acknowledged, next })
}

fn request(id: u64) -> Request {
    let sample = vec![1e-13 * (1.0 + 1e-6 * id as f64), -0.8, 30e-6, 0.05];
    Request { id, sample, with_first_cycle: false, accuracy: None, level: 0, not_by: vec![] }
}

/// Time of the campaign file for all outcomes.
fn file(folder: &Path, together: u64) -> Result<Duration, Box<dyn Error>> {
    let mut journaled = Journaled::new(TASKS, folder);
    let mut took = Duration::ZERO;
    for first in (0..TASKS).step_by(usize::try_from(together)?) {
        let finished = (first..TASKS.min(first + together))
            .map(|id| Finished {
                id,
                outcome: evaluation(&request(id).sample),
                worker: "w/0".to_owned(),
                wall: 1e-3,
            })
            .collect();
        let begun = Instant::now();
        journaled.record_all(finished)?;
        took += begun.elapsed();
    }
    assert_eq!(journaled.recorded().0 as u64, TASKS, "every outcome is in the file");
    Ok(took)
}
