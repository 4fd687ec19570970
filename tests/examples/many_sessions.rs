//! A coordinator with thousands of worker sessions on this machine: connection, tasks per second with empty simulations whose
//! outcomes are durable in a campaign file, shares of the workers, memory, and reconnection after the coordinator is killed.
//! `cargo run --release -p tests --example many_sessions [SESSIONS [TASKS [FOLDER [SECONDS]]]]`, by default 2000 sessions, in 8
//! processes, and 100 000 tasks that take no time; the campaign files are in the folder, by default the current one.

use common::wire::MAX_SESSIONS;
use coordinator::farm::dispatch::{CampaignSpec, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{Demand, EvaluateError, Evaluator, Finished, RequestSource};
use std::collections::BTreeMap;
use std::error::Error;
use std::net::TcpListener;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tests::journaled::Journaled;
use tests::practice_study::evaluation;
use tests::process::Process;
use tests::{ClosureSimulator, campaign};
use worker::service::{self, ServiceConfig};

const PROCESSES: usize = 8;
/// Time limit of each step; only a defect takes longer.
const LONGEST: Duration = Duration::from_secs(900);

/// Interval of reports about the connected workers.
const REPORT_EVERY: Duration = Duration::from_secs(10);

/// Ends of a coordinator's process.
const KILLED: &str = "killed";
const FINISHED: &str = "finished";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["coordinator", endpoint, sessions, tasks, folder, end] => {
            let evaluator = coordinate(endpoint, sessions.parse()?, tasks.parse()?, Path::new(folder))?;
            if end == KILLED {
                std::thread::sleep(LONGEST);
            }
            evaluator.finish();
            Ok(())
        }
        ["workers", endpoint, first, count, seconds] => {
            work(endpoint, first.parse()?, count.parse()?, Duration::from_secs_f64(seconds.parse()?))
        }
        _ => {
            let word = |k: usize, default: &str| words.get(k).map_or(default.to_owned(), |w| (*w).to_owned());
            measure(word(0, "2000").parse()?, &word(1, "100000"), &word(2, "."), &word(3, "0"))
        }
    }
}

/// Starts the processes and prints the table.
fn measure(sessions: usize, tasks: &str, folder: &str, seconds: &str) -> Result<(), Box<dyn Error>> {
    let endpoint = format!("tcp/{}", TcpListener::bind("127.0.0.1:0")?.local_addr()?);
    let own = std::env::current_exe()?;
    let coordinator = |end: &str| {
        let mut command = Command::new(&own);
        command.args(["coordinator", &endpoint, &sessions.to_string(), tasks, folder, end]);
        Process::start(&mut command)
    };
    let mut first = coordinator(KILLED);
    first.line("listening", 1, LONGEST).ok_or("the coordinator does not listen")?;
    let workers: Vec<Process> = (0..PROCESSES)
        .map(|k| {
            let [from, to] = [k, k + 1].map(|k| k * sessions / PROCESSES);
            let mut command = Command::new(&own);
            command.args(["workers", &endpoint, &from.to_string(), &(to - from).to_string(), seconds]);
            Process::start(&mut command)
        })
        .collect();
    println!("| {sessions} sessions in {PROCESSES} processes | measured |\n|---|---|");
    let print = |what: &str, process: &Process, word: &str| {
        let line = process.line(word, 1, LONGEST).ok_or("the coordinator has ended")?;
        println!("| {what} | {line} |");
        Ok::<(), Box<dyn Error>>(())
    };
    print("all have claimed, after", &first, "all")?;
    let idle = first.resident().unwrap_or(f64::NAN);
    let processor = |process: &Process| process.processor_time().unwrap_or(f64::NAN);
    let used = || (processor(&first), workers.iter().map(processor).sum::<f64>());
    let before = used();
    print(&format!("{tasks} tasks of {seconds} s"), &first, "ran")?;
    let after = used();
    let each = |seconds: f64| 1e6 * seconds / tasks.parse::<f64>().unwrap_or(f64::NAN);
    println!(
        "| processor time per task: coordinator, workers | {:.0} us, {:.0} us |",
        each(after.0 - before.0),
        each(after.1 - before.1)
    );
    print("tasks of a worker: least, a quarter below, median, a quarter above, most", &first, "shares")?;
    let busy = first.resident().unwrap_or(f64::NAN);
    println!("| memory of the coordinator: all connected, after the tasks | {idle:.0} MiB, {busy:.0} MiB |");
    let all: f64 = workers.iter().filter_map(Process::resident).sum();
    println!("| memory of the workers, per session | {:.2} MiB |", all / sessions as f64);
    if sessions as u32 >= MAX_SESSIONS {
        println!("| one more worker | {} |", one_more(&endpoint)?);
    }
    first.kill();
    std::thread::sleep(Duration::from_secs(3));
    let mut second = coordinator(FINISHED);
    print("coordinator killed, back after 3 s: all have claimed, after", &second, "all")?;
    print("the same tasks again", &second, "ran")?;
    if !second.end(LONGEST).success() {
        return Err("the coordinator failed".into());
    }
    for mut process in workers {
        if !process.end(LONGEST).success() {
            return Err("a worker failed".into());
        }
    }
    Ok(())
}

/// Runs the tasks and prints figures; returns the coordinator with its workers.
fn coordinate(
    endpoint: &str,
    sessions: usize,
    tasks: usize,
    folder: &Path,
) -> Result<ZenohEvaluator, Box<dyn Error>> {
    let listen = Listen { endpoint: Some(endpoint.into()), config: None, insecure: false };
    let campaign = CampaignSpec { resumed: true, ..campaign() };
    let mut evaluator = ZenohEvaluator::open(campaign, &listen, Arc::default())?;
    let listening = Instant::now();
    println!("listening");
    let have_claimed = |workers: &[coordinator::farm::dispatch::ConnectedWorker]| {
        workers.iter().filter(|worker| worker.slots > 0).count() == sessions
    };
    while !evaluator.connected.wait_for(REPORT_EVERY, have_claimed) {
        let workers = evaluator.workers();
        let claimed = workers.iter().filter(|worker| worker.slots > 0).count();
        eprintln!(
            "{:.0} s: {} connected, {claimed} have claimed",
            listening.elapsed().as_secs_f64(),
            workers.len()
        );
        if listening.elapsed() > LONGEST {
            return Err("not all workers have claimed".into());
        }
    }
    println!("all {:.2} s", listening.elapsed().as_secs_f64());
    let mut source = Counted { journaled: Journaled::new(tasks as u64, folder), tasks: BTreeMap::new() };
    let started = Instant::now();
    evaluator.run(&mut source)?;
    let seconds = started.elapsed().as_secs_f64();
    let (recorded, writes) = source.journaled.recorded();
    assert_eq!(recorded, tasks, "every outcome is in the file");
    println!(
        "ran {seconds:.1} s, {:.0} tasks per second, {:.0} outcomes per transaction",
        tasks as f64 / seconds,
        tasks as f64 / writes as f64
    );
    let mut shares: Vec<usize> = source.tasks.into_values().collect();
    shares.resize(sessions, 0);
    shares.sort_unstable();
    let quantile = |q: usize| shares[q * (shares.len() - 1) / 4].to_string();
    println!("shares {}", [0, 1, 2, 3, 4].map(quantile).join(" / "));
    Ok(evaluator)
}

/// A request source that counts the tasks of each worker.
struct Counted {
    journaled: Journaled,
    tasks: BTreeMap<String, usize>,
}

impl RequestSource for Counted {
    fn next(&mut self) -> Result<Demand, EvaluateError> {
        self.journaled.next()
    }

    fn record(&mut self, finished: Finished) -> Result<(), EvaluateError> {
        self.record_all(vec![finished])
    }

    fn record_all(&mut self, finished: Vec<Finished>) -> Result<(), EvaluateError> {
        for outcome in &finished {
            *self.tasks.entry(outcome.worker.clone()).or_default() += 1;
        }
        self.journaled.record_all(finished)
    }
}

/// What a worker reports that the coordinator does not accept.
fn one_more(endpoint: &str) -> Result<String, Box<dyn Error>> {
    let give_up_after = Some(Duration::from_secs(10));
    let config = ServiceConfig { give_up_after, ..ServiceConfig::new(endpoint, 1) };
    match service::run(config, Arc::new(ClosureSimulator(evaluation))) {
        Err(refused) => Ok(refused.to_string()),
        Ok(_) => Err("one more worker was accepted".into()),
    }
}

/// A process with `count` workers, numbered from `first`, each with a session and a slot of its own.
fn work(endpoint: &str, first: usize, count: usize, takes: Duration) -> Result<(), Box<dyn Error>> {
    let simulator = Arc::new(ClosureSimulator(move |sample: &[f64]| {
        std::thread::sleep(takes);
        evaluation(sample)
    }));
    let mut workers = Vec::new();
    for k in first..first + count {
        let config = ServiceConfig {
            name: format!("w{k}"),
            give_up_after: Some(LONGEST),
            ..ServiceConfig::new(endpoint, 1)
        };
        workers.push(service::spawn(config, simulator.clone())?);
    }
    for worker in workers {
        worker.join()?;
    }
    Ok(())
}
