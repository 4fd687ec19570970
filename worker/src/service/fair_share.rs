//! Shares the slots fairly among coordinators. The next free slot goes to the competing coordinator with the least slot
//! time used, its running tasks included at the mean task time. So competing coordinators get equal slot time over time;
//! time not used by one is available to the others.

use super::ClaimEvent;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

/// Time for which requested tasks reserve their slots: a silent coordinator must not block the others.
const RESERVED_FOR: Duration = Duration::from_millis(200);

/// One coordinator's use of the slots.
#[derive(Debug)]
struct Member {
    inbox: Sender<ClaimEvent>,
    /// Tasks running or waiting for a slot.
    tasks: usize,
    /// Tasks requested from it, and the time of the request.
    requested: Option<(usize, Instant)>,
    /// It competes for free slots.
    competes: bool,
    /// Slot time used: tasks times the time they were here [s].
    used: f64,
}

impl Member {
    /// Slots occupied by tasks or reserved for requested ones.
    fn occupied(&self, now: Instant) -> usize {
        self.tasks
            + self.requested.map_or(0, |(tasks, since)| if now < since + RESERVED_FOR { tasks } else { 0 })
    }
}

/// Use of the slots by all coordinators.
#[derive(Debug)]
pub(super) struct FairShare {
    members: Vec<Member>,
    counted_until: Instant,
    /// Number of tasks ended.
    ended: usize,
    /// End of the last task; valid while no task is running.
    idle_since: Instant,
}

impl FairShare {
    /// Shares among coordinators; `inboxes` are those of their claim loops.
    pub(crate) fn new(inboxes: impl IntoIterator<Item = Sender<ClaimEvent>>) -> Self {
        let member = |inbox| Member { inbox, tasks: 0, requested: None, competes: false, used: 0.0 };
        let now = Instant::now();
        let members = inboxes.into_iter().map(member).collect();
        Self { members, counted_until: now, ended: 0, idle_since: now }
    }

    /// Adds the slot time since the last call to each coordinator.
    fn count_use(&mut self, now: Instant) {
        let past = now.saturating_duration_since(self.counted_until).as_secs_f64();
        self.members.iter_mut().for_each(|member| member.used += past * member.tasks as f64);
        self.counted_until = now;
    }

    /// Mean slot time of a task [s].
    fn mean_task_time(&self) -> f64 {
        let used: f64 = self.members.iter().map(|member| member.used).sum();
        (used / self.ended.max(1) as f64).max(f64::MIN_POSITIVE)
    }

    /// Notifies the competing coordinators other than `k` of a free slot.
    fn notify_others(&self, k: usize) {
        for (j, member) in self.members.iter().enumerate() {
            if j != k && member.competes {
                // The claim loop may have ended.
                let _ = member.inbox.send(ClaimEvent::SlotFree);
            }
        }
    }

    /// Coordinator `k` starts to compete. Its used time is raised to the least of the other competitors, so that time
    /// without competition counts for none of them.
    fn start_competing(&mut self, k: usize) {
        let others = self.members.iter().enumerate().filter(|(j, other)| *j != k && other.competes);
        let least = others.map(|(_, other)| other.used).min_by(f64::total_cmp);
        let own = &mut self.members[k];
        if !own.competes {
            own.competes = true;
            own.used = own.used.max(least.unwrap_or(own.used));
        }
    }

    /// Number of tasks that may be requested from coordinator `k`, of `slots` in all. The coordinator competes for slots
    /// until [`FairShare::stop_competing`].
    pub(crate) fn allowance(&mut self, k: usize, slots: usize, now: Instant) -> usize {
        self.count_use(now);
        self.start_competing(k);
        let mut occupied: Vec<usize> = self.members.iter().map(|member| member.occupied(now)).collect();
        // A coordinator with an open request gets no more slots.
        let takes =
            |j: &usize| *j == k || (self.members[*j].competes && self.members[*j].requested.is_none());
        let takers: Vec<usize> = (0..occupied.len()).filter(takes).collect();
        let (task_time, mut mine) = (self.mean_task_time(), 0);
        for _ in 0..slots.saturating_sub(occupied.iter().sum()) {
            let used = |j: &usize| self.members[*j].used + task_time * occupied[*j] as f64;
            let Some(&taker) = takers.iter().min_by(|a, b| used(a).total_cmp(&used(b))) else { break };
            occupied[taker] += 1;
            mine += usize::from(taker == k);
        }
        mine
    }

    /// Registers a request of `tasks` tasks from coordinator `k`.
    pub(crate) fn request(&mut self, k: usize, tasks: usize, now: Instant) {
        self.members[k].requested = Some((tasks, now));
    }

    /// Registers the reply of coordinator `k` with `tasks` tasks; zero if there is no reply.
    pub(crate) fn answered(&mut self, k: usize, tasks: usize, now: Instant) {
        self.count_use(now);
        let requested = self.members[k].requested.take();
        self.members[k].tasks += tasks;
        if requested.is_some_and(|(most, _)| tasks < most) {
            self.notify_others(k);
        }
    }

    /// Coordinator `k` stops competing for slots; the others are notified.
    pub(crate) fn stop_competing(&mut self, k: usize) {
        if std::mem::replace(&mut self.members[k].competes, false) {
            self.notify_others(k);
        }
    }

    /// Registers that `tasks` tasks of coordinator `k` have ended or were dropped.
    pub(crate) fn ended(&mut self, k: usize, tasks: usize, now: Instant) {
        self.count_use(now);
        self.members[k].tasks = self.members[k].tasks.saturating_sub(tasks);
        self.ended += tasks;
        self.idle_since = now;
        self.notify_others(k);
    }

    /// Time without tasks of any coordinator.
    pub(crate) fn idle_for(&self, now: Instant) -> Duration {
        let busy = self.members.iter().any(|member| member.tasks > 0);
        if busy { Duration::ZERO } else { now.saturating_duration_since(self.idle_since) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, channel};

    fn shares(members: usize) -> (FairShare, Vec<Receiver<ClaimEvent>>) {
        let (inboxes, received) = (0..members).map(|_| channel()).unzip::<_, _, Vec<_>, Vec<_>>();
        (FairShare::new(inboxes), received)
    }

    /// Requests the whole allowance, and gets it.
    fn take(shares: &mut FairShare, k: usize, slots: usize, now: Instant) -> usize {
        let mine = shares.allowance(k, slots, now);
        shares.request(k, mine, now);
        shares.answered(k, mine, now);
        mine
    }

    #[test]
    fn one_coordinator_gets_all_slots() {
        let (mut shares, _inboxes) = shares(1);
        let now = Instant::now();
        assert_eq!([take(&mut shares, 0, 6, now), take(&mut shares, 0, 6, now)], [6, 0]);
        shares.ended(0, 2, now);
        assert_eq!(take(&mut shares, 0, 6, now), 2);
    }

    #[test]
    fn a_second_coordinator_gets_every_free_slot_until_both_have_the_same_number() {
        let (mut shares, inboxes) = shares(2);
        let now = Instant::now();
        assert_eq!([take(&mut shares, 0, 4, now), shares.allowance(1, 4, now)], [4, 0]);
        for _ in 0..2 {
            shares.ended(0, 1, now);
            assert!(matches!(inboxes[1].try_recv(), Ok(ClaimEvent::SlotFree)));
            assert_eq!([shares.allowance(0, 4, now), take(&mut shares, 1, 4, now)], [0, 1]);
        }
        // A coordinator that does not compete leaves all slots to the other.
        shares.stop_competing(1);
        shares.ended(1, 2, now);
        assert_eq!(take(&mut shares, 0, 4, now), 2);
    }

    #[test]
    fn a_single_slot_is_shared_by_time_used() {
        let (mut shares, _inboxes) = shares(2);
        let (start, second) = (Instant::now(), Duration::from_secs(1));
        let mut had = [Duration::ZERO; 2];
        let mut now = start;
        assert_eq!([shares.allowance(0, 1, now), shares.allowance(1, 1, now)], [1, 0]);
        // Tasks of one coordinator take three times as long; both get half of the time.
        while now < start + 100 * second {
            let turn = usize::from(take(&mut shares, 0, 1, now) == 0);
            if turn == 1 {
                assert_eq!(take(&mut shares, 1, 1, now), 1);
            }
            let takes = if turn == 0 { 3 * second } else { second };
            (now, had[turn]) = (now + takes, had[turn] + takes);
            shares.ended(turn, 1, now);
            shares.allowance(1 - turn, 1, now);
        }
        assert!(had[0].abs_diff(had[1]) <= 3 * second, "{had:?}");
    }

    #[test]
    fn a_silent_coordinator_reserves_slots_for_a_short_time_only() {
        let (mut shares, _inboxes) = shares(2);
        let now = Instant::now();
        let all = shares.allowance(1, 2, now);
        shares.request(1, all, now);
        assert_eq!(shares.allowance(0, 2, now), 0);
        assert_eq!(shares.allowance(0, 2, now + RESERVED_FOR), 2);
    }

    #[test]
    fn a_worker_is_idle_without_tasks_of_any_coordinator() {
        let (mut shares, _inboxes) = shares(2);
        let now = Instant::now();
        assert_eq!(take(&mut shares, 1, 2, now), 2);
        let later = now + Duration::from_secs(9);
        assert_eq!(shares.idle_for(later), Duration::ZERO);
        shares.ended(1, 2, now + Duration::from_secs(2));
        assert_eq!(shares.idle_for(later), Duration::from_secs(7));
    }
}
