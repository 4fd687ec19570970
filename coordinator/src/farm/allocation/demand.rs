//! How many jobs of a batch system a study wants: a pure function of its backlog.

use std::time::Duration;

/// Time within which the evaluations asked for are to be done by the jobs, as far as their number allows.
const HORIZON: Duration = Duration::from_secs(60);

/// What waits, and what is there to do it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JobDemand {
    /// Evaluations that have not ended.
    pub open: u64,
    /// Mean time of an evaluation, or the time since tasks are under way without any that ended; `None` without either.
    pub duration: Option<Duration>,
    /// Slots of connected workers that are no jobs.
    pub other_slots: u64,
    /// Slots of the largest job that has connected; `None` before the first.
    pub slots_per_job: Option<u64>,
    /// Longest time that a job has been in the queue.
    pub queueing: Duration,
}

impl JobDemand {
    /// Number of jobs wanted, at most `most`.
    ///
    /// One job for each whole [`HORIZON`] of work on its slots that is left beyond the work of the other workers within it, at least one and
    /// at most as many as there are evaluations for their slots. The first job shows how many slots a job has and how long an evaluation
    /// takes; where it stays in the queue for longer than the horizon, an evaluation is taken to last as long as the horizon.
    pub fn jobs(&self, most: usize) -> usize {
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
