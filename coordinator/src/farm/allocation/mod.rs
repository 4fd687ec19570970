//! Workers by a batch system: asks for jobs from the backlog of the study, at most a given number at once; idle workers leave by themselves.
//!
//! The number comes from `demand.rs`, the commands from `batch_system.rs`. A job that ends before its worker connected counts as failed,
//! and the next one is asked for later: after ten seconds, then twice as long each time, up to ten minutes.

mod batch_system;
mod demand;
mod jobs;

use super::dispatch::{StatusBoard, StatusHandle};
pub use batch_system::BatchSystem;
use common::wire::{ScaleStatus, Status};
use demand::JobDemand;
use jobs::Jobs;
pub use jobs::ScaleSettings;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Interval at which the backlog is looked at.
const TICK: Duration = Duration::from_secs(1);

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
