//! Who of several coordinators may have the next free place: the one that, with what it has under way, has had least of
//! the slots' time. So all that ask have as many tasks under way, and over time as much time. What one does not use the
//! others have.

use super::claim_event::ClaimEvent;
use std::sync::mpsc::Sender;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long tasks asked for keep their places free: a coordinator that is silent must not hold up the others.
const KEPT_FREE: Duration = Duration::from_millis(200);

/// What one coordinator has of the slots.
#[derive(Debug)]
struct Member {
    inbox: Sender<ClaimEvent>,
    /// Tasks begun or waiting.
    tasks: usize,
    /// Places for tasks it is asked for.
    asked: Option<(usize, Instant)>,
    /// It would be asked for tasks now, if there were a place.
    wants: bool,
    /// Tasks times the time they were here [s].
    used: f64,
}

impl Member {
    fn occupied(&self, now: Instant) -> usize {
        self.tasks + self.asked.map_or(0, |(places, since)| if now < since + KEPT_FREE { places } else { 0 })
    }
}

#[derive(Debug)]
struct ShareState {
    members: Vec<Member>,
    counted_until: Instant,
    /// Tasks that have ended.
    ended: usize,
    /// When the last task ended, unless there is one.
    idle_since: Instant,
}

impl ShareState {
    fn count_use(&mut self, now: Instant) {
        let past = now.saturating_duration_since(self.counted_until).as_secs_f64();
        self.members.iter_mut().for_each(|member| member.used += past * member.tasks as f64);
        self.counted_until = now;
    }

    /// What a task takes on average [s].
    fn usual(&self) -> f64 {
        let used: f64 = self.members.iter().map(|member| member.used).sum();
        (used / self.ended.max(1) as f64).max(f64::MIN_POSITIVE)
    }

    /// Wakes those that would take what another one leaves.
    fn tell_others(&self, but: usize) {
        for (k, member) in self.members.iter().enumerate() {
            if k != but && member.wants {
                // One that has left wants nothing; one that is leaving hears nothing.
                let _ = member.inbox.send(ClaimEvent::SlotFree);
            }
        }
    }

    /// What it had while nobody else wanted anything is not held against it, and nobody saves up.
    fn begin_to_want(&mut self, k: usize) {
        let others = self.members.iter().enumerate().filter(|(j, other)| *j != k && other.wants);
        let least = others.map(|(_, other)| other.used).min_by(f64::total_cmp);
        let own = &mut self.members[k];
        if !own.wants {
            own.wants = true;
            own.used = own.used.max(least.unwrap_or(own.used));
        }
    }
}

/// See the module.
#[derive(Debug)]
pub(super) struct FairShare(Mutex<ShareState>);

impl FairShare {
    /// For coordinators whose claims have these inboxes.
    pub fn new(inboxes: impl IntoIterator<Item = Sender<ClaimEvent>>) -> Self {
        let member = |inbox| Member { inbox, tasks: 0, asked: None, wants: false, used: 0.0 };
        let now = Instant::now();
        let members = inboxes.into_iter().map(member).collect();
        Self(Mutex::new(ShareState { members, counted_until: now, ended: 0, idle_since: now }))
    }

    /// How many tasks coordinator `k` may be asked for, of `places` for tasks in all. It is one of those that want some
    /// until [`FairShare::stop_competing`].
    pub fn allowance(&self, k: usize, places: usize, now: Instant) -> usize {
        let mut state = self.state();
        state.count_use(now);
        state.begin_to_want(k);
        let mut occupied: Vec<usize> = state.members.iter().map(|member| member.occupied(now)).collect();
        // Who has been asked, or is silent, gets nothing beyond that.
        let takes = |j: &usize| *j == k || (state.members[*j].wants && state.members[*j].asked.is_none());
        let takers: Vec<usize> = (0..occupied.len()).filter(takes).collect();
        let (usual, mut mine) = (state.usual(), 0);
        for _ in 0..places.saturating_sub(occupied.iter().sum()) {
            let has = |j: &usize| state.members[*j].used + usual * occupied[*j] as f64;
            let Some(&taker) = takers.iter().min_by(|a, b| has(a).total_cmp(&has(b))) else { break };
            occupied[taker] += 1;
            mine += usize::from(taker == k);
        }
        mine
    }

    /// Coordinator `k` is asked for so many tasks.
    pub fn ask(&self, k: usize, places: usize, now: Instant) {
        self.state().members[k].asked = Some((places, now));
    }

    /// It has answered, or will not, with so many tasks.
    pub fn answered(&self, k: usize, tasks: usize, now: Instant) {
        let mut state = self.state();
        state.count_use(now);
        let asked = state.members[k].asked.take();
        state.members[k].tasks += tasks;
        if asked.is_some_and(|(places, _)| tasks < places) {
            state.tell_others(k);
        }
    }

    /// It wants nothing now.
    pub fn stop_competing(&self, k: usize) {
        let mut state = self.state();
        if std::mem::replace(&mut state.members[k].wants, false) {
            state.tell_others(k);
        }
    }

    /// So many of its tasks have ended, or were dropped.
    pub fn ended(&self, k: usize, tasks: usize, now: Instant) {
        let mut state = self.state();
        state.count_use(now);
        state.members[k].tasks = state.members[k].tasks.saturating_sub(tasks);
        state.ended += tasks;
        state.idle_since = now;
        state.tell_others(k);
    }

    /// How long there has been no task of anybody.
    pub fn idle_for(&self, now: Instant) -> Duration {
        let state = self.state();
        let busy = state.members.iter().any(|member| member.tasks > 0);
        if busy { Duration::ZERO } else { now.saturating_duration_since(state.idle_since) }
    }

    fn state(&self) -> MutexGuard<'_, ShareState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
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

    /// Asks for all it may, and gets it.
    fn take(shares: &FairShare, k: usize, places: usize, now: Instant) -> usize {
        let mine = shares.allowance(k, places, now);
        shares.ask(k, mine, now);
        shares.answered(k, mine, now);
        mine
    }

    #[test]
    fn one_coordinator_has_all_places() {
        let (shares, _inboxes) = shares(1);
        let now = Instant::now();
        assert_eq!([take(&shares, 0, 6, now), take(&shares, 0, 6, now)], [6, 0]);
        shares.ended(0, 2, now);
        assert_eq!(take(&shares, 0, 6, now), 2);
    }

    #[test]
    fn a_second_one_gets_every_place_that_frees_until_both_have_as_many() {
        let (shares, inboxes) = shares(2);
        let now = Instant::now();
        assert_eq!([take(&shares, 0, 4, now), shares.allowance(1, 4, now)], [4, 0]);
        for _ in 0..2 {
            shares.ended(0, 1, now);
            assert!(matches!(inboxes[1].try_recv(), Ok(ClaimEvent::SlotFree)));
            assert_eq!([shares.allowance(0, 4, now), take(&shares, 1, 4, now)], [0, 1]);
        }
        // One that wants nothing leaves all to the other.
        shares.stop_competing(1);
        shares.ended(1, 2, now);
        assert_eq!(take(&shares, 0, 4, now), 2);
    }

    #[test]
    fn a_single_place_goes_by_the_time_used() {
        let (shares, _inboxes) = shares(2);
        let (start, second) = (Instant::now(), Duration::from_secs(1));
        let mut had = [Duration::ZERO; 2];
        let mut now = start;
        assert_eq!([shares.allowance(0, 1, now), shares.allowance(1, 1, now)], [1, 0]);
        // Tasks of the one take thrice as long as those of the other; the time is halved all the same.
        while now < start + 100 * second {
            let turn = usize::from(take(&shares, 0, 1, now) == 0);
            if turn == 1 {
                assert_eq!(take(&shares, 1, 1, now), 1);
            }
            let takes = if turn == 0 { 3 * second } else { second };
            (now, had[turn]) = (now + takes, had[turn] + takes);
            shares.ended(turn, 1, now);
            shares.allowance(1 - turn, 1, now);
        }
        assert!(had[0].abs_diff(had[1]) <= 3 * second, "{had:?}");
    }

    #[test]
    fn places_are_kept_for_a_silent_coordinator_for_a_moment_only() {
        let (shares, _inboxes) = shares(2);
        let now = Instant::now();
        shares.ask(1, shares.allowance(1, 2, now), now);
        assert_eq!(shares.allowance(0, 2, now), 0);
        assert_eq!(shares.allowance(0, 2, now + KEPT_FREE), 2);
    }

    #[test]
    fn idle_is_who_has_no_task_of_anybody() {
        let (shares, _inboxes) = shares(2);
        let now = Instant::now();
        assert_eq!(take(&shares, 1, 2, now), 2);
        let later = now + Duration::from_secs(9);
        assert_eq!(shares.idle_for(later), Duration::ZERO);
        shares.ended(1, 2, now + Duration::from_secs(2));
        assert_eq!(shares.idle_for(later), Duration::from_secs(7));
    }
}
