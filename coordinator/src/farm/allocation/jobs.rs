//! The jobs asked for, as processes of ours that live as long as the jobs do.

use super::batch_system::BatchSystem;
use common::wire::ScaleStatus;
use rustix::process::{Pid, Signal, kill_process_group};
use std::io::{BufRead, BufReader, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Beginning of the names of the jobs' workers.
const NAME: &str = "job-";
/// Time until the next job is asked for after the first failure in a row, and its upper bound.
const PAUSE: Duration = Duration::from_secs(10);
const LONGEST_PAUSE: Duration = Duration::from_secs(600);
/// Time for a process to end after SIGTERM.
const GRACE: Duration = Duration::from_secs(2);

/// Whether a worker of this name is a job.
pub(super) fn is_job(worker: &str) -> bool {
    worker.starts_with(NAME)
}

/// How workers are asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScaleSettings {
    /// The batch system that is asked.
    pub system: BatchSystem,
    /// Most jobs at once.
    pub most: usize,
    /// Time after which a worker without tasks leaves.
    pub idle: Duration,
}

/// A job and its process.
#[derive(Debug)]
struct Job {
    worker: String,
    process: Child,
    /// The last line that the process wrote to standard error.
    complaint: JoinHandle<String>,
    asked: Instant,
    connected: bool,
}

/// All jobs of a campaign.
#[derive(Debug)]
pub(super) struct Jobs {
    pub(super) settings: ScaleSettings,
    endpoint: String,
    name: String,
    jobs: Vec<Job>,
    /// Slots of the largest job that has connected.
    pub(super) slots_per_job: Option<u64>,
    /// Workers of jobs that an earlier coordinator asked for.
    inherited: usize,
    failures_in_a_row: u32,
    next: Option<Instant>,
    /// What was asked for so far, without those that wait and run.
    counted: ScaleStatus,
}

impl Jobs {
    /// No jobs yet of the campaign whose jobs are called `name`; their workers connect to `endpoint`.
    pub(super) fn new(settings: ScaleSettings, endpoint: String, name: String) -> Self {
        let (system, most) = (settings.system.to_string(), settings.most as u64);
        Jobs {
            settings,
            endpoint,
            name,
            jobs: vec![],
            slots_per_job: None,
            inherited: 0,
            failures_in_a_row: 0,
            next: None,
            counted: ScaleStatus { system, most, ..ScaleStatus::default() },
        }
    }

    /// Longest time that a job has been waiting for its worker.
    pub(super) fn longest_wait(&self, now: Instant) -> Duration {
        let waiting = self.jobs.iter().filter(|job| !job.connected);
        waiting.map(|job| now - job.asked).max().unwrap_or_default()
    }

    /// Takes note of the connected workers (name and slots) and of jobs that have ended.
    pub(super) fn observe<'a>(&mut self, now: Instant, workers: impl Iterator<Item = (&'a str, u32)>) {
        self.inherited = 0;
        for (name, slots) in workers.filter(|(name, _)| is_job(name)) {
            let slots = Some(u64::from(slots)).filter(|slots| *slots > 0);
            self.slots_per_job = self.slots_per_job.max(slots);
            match self.jobs.iter_mut().find(|job| job.worker == name) {
                Some(job) => job.connected = true,
                None => self.inherited += 1,
            }
        }
        for index in (0..self.jobs.len()).rev() {
            if let Ok(None) = self.jobs[index].process.try_wait() {
                continue;
            }
            let job = self.jobs.swap_remove(index);
            if job.connected {
                self.failures_in_a_row = 0;
            } else {
                self.fail(now, job.complaint.join().unwrap_or_default());
            }
        }
    }

    fn fail(&mut self, now: Instant, reason: String) {
        let pause = PAUSE * 2_u32.saturating_pow(self.failures_in_a_row.min(16));
        self.next = Some(now + pause.min(LONGEST_PAUSE));
        self.failures_in_a_row += 1;
        self.counted.failed += 1;
        self.counted.last_failure =
            if reason.is_empty() { "ended before its worker connected".to_owned() } else { reason };
        if self.failures_in_a_row == 1 {
            tracing::warn!("a job of {} failed: {}", self.settings.system, self.counted.last_failure);
        }
    }

    /// Asks for jobs until there are `wanted`, one of them at a time after a failure.
    pub(super) fn ask(&mut self, now: Instant, wanted: usize) {
        let wanted = wanted.min(self.settings.most);
        if self.jobs.len() + self.inherited >= wanted || self.next.is_some_and(|next| now < next) {
            return;
        }
        let present = (self.jobs.len() + self.inherited).max(self.listed());
        let missing = wanted.saturating_sub(present);
        let missing = if self.failures_in_a_row > 0 { missing.min(1) } else { missing };
        for _ in 0..missing {
            if let Err(error) = self.submit(now) {
                self.fail(now, error.to_string());
                break;
            }
        }
    }

    /// Jobs of the campaign that the batch system lists; zero where it cannot be asked.
    fn listed(&self) -> usize {
        let [_, _, list, _] = self.settings.system.commands();
        if list.is_empty() {
            return 0;
        }
        let output = self.shell(list).stderr(Stdio::null()).output().map(|output| output.stdout);
        output.unwrap_or_default().split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).count()
    }

    fn submit(&mut self, now: Instant) -> std::io::Result<()> {
        self.counted.asked += 1;
        // Workers of an earlier coordinator may still be connected: their names are those of another process.
        let worker = format!("{NAME}{}-{}", std::process::id(), self.counted.asked);
        let [submit, script, ..] = self.settings.system.commands();
        let mut process = self
            .shell(submit)
            .env("WORKER_NAME", &worker)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .process_group(0)
            .spawn()?;
        // A command that does not read its input has ended, or needs none.
        let _ = process.stdin.take().map(|mut input| input.write_all(script.as_bytes()));
        let stderr = process.stderr.take();
        let complaint = std::thread::spawn(move || {
            let lines =
                stderr.into_iter().flat_map(|stderr| BufReader::new(stderr).lines().map_while(Result::ok));
            lines.filter(|line| !line.trim().is_empty()).last().unwrap_or_default()
        });
        tracing::info!("job {worker} asked for");
        self.jobs.push(Job { worker, process, complaint, asked: now, connected: false });
        Ok(())
    }

    fn shell(&self, command: &str) -> Command {
        let mut shell = Command::new("sh");
        shell.args(["-c", command]);
        shell.env("CONNECT", &self.endpoint).env("JOB_NAME", &self.name);
        shell.env("IDLE_TIMEOUT", self.settings.idle.as_secs().max(1).to_string());
        shell
    }

    /// What was asked for so far.
    pub(super) fn status(&self) -> ScaleStatus {
        let running = self.jobs.iter().filter(|job| job.connected).count();
        let (waiting, running) = (self.jobs.len() - running, running + self.inherited);
        ScaleStatus { waiting: waiting as u64, running: running as u64, ..self.counted.clone() }
    }

    /// Withdraws the jobs that wait, and ends the processes of all.
    pub(super) fn close(mut self) {
        let [.., withdraw] = self.settings.system.commands();
        if !withdraw.is_empty()
            && !self.jobs.is_empty()
            && let Err(error) = self.shell(withdraw).output()
        {
            tracing::warn!("waiting jobs could not be withdrawn: {error}");
        }
        self.signal(Signal::TERM);
        let begun = Instant::now();
        while begun.elapsed() < GRACE
            && self.jobs.iter_mut().any(|job| matches!(job.process.try_wait(), Ok(None)))
        {
            std::thread::sleep(Duration::from_millis(20));
        }
        self.signal(Signal::KILL);
        self.jobs.iter_mut().for_each(|job| _ = job.process.wait());
    }

    /// Sends a signal to the jobs' processes that run.
    fn signal(&mut self, signal: Signal) {
        for job in &mut self.jobs {
            if let Ok(None) = job.process.try_wait()
                && let Some(group) = i32::try_from(job.process.id()).ok().and_then(Pid::from_raw)
            {
                // It may have ended in between.
                let _ = kill_process_group(group, signal);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jobs(command: &str, most: usize) -> Jobs {
        let system = BatchSystem::Command(command.to_owned());
        let settings = ScaleSettings { system, most, idle: Duration::from_secs(60) };
        Jobs::new(settings, "tcp/127.0.0.1:1".into(), "hingewise-1".into())
    }

    /// Observes these workers until all jobs have ended.
    fn until_ended(jobs: &mut Jobs, workers: &[(&str, u32)]) {
        let begun = Instant::now();
        while !jobs.jobs.is_empty() {
            assert!(begun.elapsed() < Duration::from_secs(20), "a job has not ended");
            jobs.observe(Instant::now(), workers.iter().copied());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn never_more_jobs_than_allowed_and_all_end_at_the_end() {
        let mut jobs = jobs("exec sleep 600", 3);
        let now = Instant::now();
        jobs.ask(now, 50);
        jobs.ask(now, 50);
        let ids: Vec<u32> = jobs.jobs.iter().map(|job| job.process.id()).collect();
        let first = jobs.jobs[0].worker.clone();
        jobs.observe(now, [(first.as_str(), 16), ("job-9", 4), ("host", 8)].into_iter());
        let ScaleStatus { asked, waiting, running, failed, .. } = jobs.status();
        // One of them runs, as does one that an earlier coordinator asked for, which takes the place of another.
        assert_eq!((asked, waiting, running, failed, jobs.slots_per_job), (3, 2, 2, 0, Some(16)));
        jobs.close();
        for id in ids {
            let group = Pid::from_raw(i32::try_from(id).unwrap()).unwrap();
            assert!(rustix::process::test_kill_process(group).is_err(), "process {id} still runs");
        }
    }

    #[test]
    fn rejected_jobs_are_named_and_asked_for_more_and_more_seldom() {
        let mut jobs = jobs("echo 'no such partition' >&2; exit 1", 5);
        let mut now = Instant::now();
        jobs.ask(now, 2);
        until_ended(&mut jobs, &[]);
        assert_eq!((jobs.counted.failed, jobs.counted.last_failure.as_str()), (2, "no such partition"));
        jobs.ask(now, 2);
        assert_eq!(jobs.jobs.len(), 0, "not at once");
        for pause in [25, 45, 85] {
            now = Instant::now() + Duration::from_secs(pause);
            jobs.ask(now, 2);
            assert_eq!(jobs.jobs.len(), 1, "one at a time");
            until_ended(&mut jobs, &[]);
        }
        jobs.close();
    }

    #[test]
    fn jobs_that_are_cancelled_are_replaced() {
        let mut jobs = jobs("exec sleep 0.3", 1);
        jobs.ask(Instant::now(), 1);
        let first = jobs.jobs[0].worker.clone();
        jobs.observe(Instant::now(), [(first.as_str(), 2)].into_iter());
        until_ended(&mut jobs, &[(first.as_str(), 2)]);
        jobs.observe(Instant::now(), std::iter::empty());
        jobs.ask(Instant::now(), 1);
        assert_eq!((jobs.counted.asked, jobs.counted.failed), (2, 0));
        jobs.close();
    }
}
