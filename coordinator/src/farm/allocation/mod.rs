//! Workers by a batch system: asks for jobs from the backlog of the study, at most a given number at once; idle workers leave by themselves.
//!
//! The number is a pure function of the backlog, the commands come from `batch_system.rs`. A job that ends before its worker connected counts
//! as failed, and the next one is asked for later: after ten seconds, then twice as long each time, up to ten minutes.

mod batch_system;
mod jobs;

use super::dispatch::{StatusBoard, StatusHandle};
pub use batch_system::BatchSystem;
use common::wire::{ScaleStatus, Status};
use jobs::Jobs;
pub use jobs::ScaleSettings;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval at which the backlog is looked at.
const TICK: Duration = Duration::from_secs(1);

/// Time within which the evaluations asked for are to be done by the jobs, as far as their number allows.
const HORIZON: Duration = Duration::from_secs(60);

/// Asks for jobs on a thread of its own until it is dropped, also where a study is interrupted: then the jobs that still wait are withdrawn,
/// and the processes of the others end; their workers have left or give up.
#[derive(Debug)]
pub struct Scaling(Option<(Sender<()>, JoinHandle<()>)>);

impl Scaling {
    /// Starts to ask for jobs whose workers connect to `endpoint`, for the campaign with this number; what it asked for is posted on the
    /// board.
    ///
    /// # Errors
    /// The thread could not be started.
    pub fn start(
        settings: ScaleSettings,
        (endpoint, campaign): (String, u64),
        status: StatusHandle,
        board: StatusBoard,
    ) -> std::io::Result<Self> {
        let (stop, stopped) = channel();
        let jobs = Jobs::new(settings, endpoint, format!("hingewise-{campaign:08x}"));
        let run = move || ask_until_stopped(jobs, &stopped, &status, &board);
        let thread = std::thread::Builder::new().name("coordinator-scale".into()).spawn(run)?;
        Ok(Scaling(Some((stop, thread))))
    }
}

impl Drop for Scaling {
    fn drop(&mut self) {
        if let Some((stop, thread)) = self.0.take() {
            drop(stop);
            // A panic there has ended the process.
            let _ = thread.join();
        }
    }
}

fn ask_until_stopped(mut jobs: Jobs, stopped: &Receiver<()>, status: &StatusHandle, board: &StatusBoard) {
    let mut under_way = None;
    while stopped.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
        let Some(status) = status.status(TICK) else { continue };
        let now = Instant::now();
        jobs.observe(now, status.farm.workers.iter().map(|worker| (worker.name.as_str(), worker.slots)));
        under_way = if status.farm.under_way > 0 { under_way.or(Some(now)) } else { None };
        let backlog = backlog(&status, &jobs, now, under_way);
        jobs.ask(now, backlog.jobs(jobs.settings.most));
        board.post_scale(jobs.status());
    }
    jobs.close();
}

/// What waits, and what is there to do it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct JobDemand {
    /// Evaluations that have not ended.
    open: u64,
    /// Mean time of an evaluation, or the time since tasks are under way without any that ended; `None` without either.
    duration: Option<Duration>,
    /// Slots of connected workers that are no jobs.
    other_slots: u64,
    /// Slots of the largest job that has connected; `None` before the first.
    slots_per_job: Option<u64>,
    /// Longest time that a job has been in the queue.
    queueing: Duration,
}

impl JobDemand {
    /// Number of jobs wanted, at most `most`.
    ///
    /// One job for each whole [`HORIZON`] of work on its slots that is left beyond the work of the other workers within it, at least one and
    /// at most as many as there are evaluations for their slots. The first job shows how many slots a job has and how long an evaluation
    /// takes; where it stays in the queue for longer than the horizon, an evaluation is taken to last as long as the horizon.
    fn jobs(&self, most: usize) -> usize {
        let slots = self.slots_per_job.unwrap_or(1).max(1);
        let assumed = if self.queueing > HORIZON { Some(HORIZON) } else { None };
        let horizon = HORIZON.as_secs_f64();
        let work = self.open as f64 * self.duration.or(assumed).unwrap_or_default().as_secs_f64();
        let left = work - self.other_slots as f64 * horizon;
        if self.open == 0 || (self.other_slots > 0 && left <= 0.0) {
            return 0;
        }
        let by_work = (left / (slots as f64 * horizon)).ceil().max(1.0) as usize;
        let by_tasks = usize::try_from(self.open.div_ceil(slots)).unwrap_or(usize::MAX);
        most.min(by_work).min(by_tasks)
    }
}

/// The backlog of a study in this status, some of whose tasks have been under way since `under_way`.
fn backlog(status: &Status, jobs: &Jobs, now: Instant, under_way: Option<Instant>) -> JobDemand {
    let simulated = status.study.done.saturating_sub(status.study.recalled);
    let mean = (simulated > 0).then(|| Duration::from_secs_f64(status.study.simulation / simulated as f64));
    let others = status.farm.workers.iter().filter(|worker| !jobs::is_job(&worker.name));
    JobDemand {
        open: status.farm.queued + status.farm.under_way,
        duration: mean.or(under_way.map(|since| now - since)),
        other_slots: others.map(|worker| u64::from(worker.slots)).sum(),
        slots_per_job: jobs.slots_per_job,
        queueing: jobs.longest_wait(now),
    }
}

/// One line about what was asked for.
pub fn scale_sentence(status: &ScaleStatus) -> String {
    let ScaleStatus { system, most, asked, waiting, running, failed, last_failure } = status;
    let mut text =
        format!("{system}: {waiting} jobs wait, {running} run, of at most {most}; {asked} asked for");
    if *failed > 0 {
        text += &format!(", {failed} failed (last: {last_failure})");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: JobDemand =
        JobDemand { open: 36, duration: None, other_slots: 0, slots_per_job: None, queueing: Duration::ZERO };

    #[test]
    fn the_first_job_shows_how_many_are_worth_their_while() {
        assert_eq!(START.jobs(20), 1);
        assert_eq!(JobDemand { open: 0, ..START }.jobs(20), 0);
        let started = JobDemand { slots_per_job: Some(16), ..START };
        let of = |seconds| JobDemand { duration: Some(Duration::from_secs_f64(seconds)), ..started };
        // 36 evaluations of 0.2 s are no work for a second job; of two minutes they are five times a minute on 16 slots, but 36 tasks fill
        // three jobs.
        assert_eq!((of(0.2).jobs(20), of(120.0).jobs(20)), (1, 3));
        assert_eq!(JobDemand { open: 200, ..of(120.0) }.jobs(20), 13);
        assert_eq!(JobDemand { open: 100_000, ..of(120.0) }.jobs(20), 20);
    }

    #[test]
    fn a_job_that_queues_for_long_is_not_waited_for_alone() {
        let queueing = |seconds| JobDemand { queueing: Duration::from_secs(seconds), ..START };
        assert_eq!((queueing(59).jobs(20), queueing(61).jobs(20)), (1, 20));
    }

    #[test]
    fn other_workers_do_what_they_can() {
        let local = JobDemand { other_slots: 2, duration: Some(Duration::from_secs(1)), ..START };
        assert_eq!(local.jobs(20), 0);
        // 600 s of work beyond the 120 s of two slots within a minute: ten jobs of one slot.
        assert_eq!(JobDemand { open: 720, ..local }.jobs(20), 10);
        // Before the first evaluation has ended nothing says that they are not enough.
        assert_eq!(JobDemand { duration: None, ..local }.jobs(20), 0);
    }
}
