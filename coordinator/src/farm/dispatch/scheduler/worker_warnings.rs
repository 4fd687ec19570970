//! Warnings about workers: none connected while tasks wait, or no liveliness token.

use super::SchedulerSettings;
use common::wire::{Offers, Refused, WorkerId};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Time without any worker that offers the subject before a warning, and before the campaign is given up if all of
/// them have reported an unusable simulator; and before a repeated one if the number of tasks has changed.
pub(super) const UNATTENDED: Duration = Duration::from_secs(5);
/// Time before the warning is repeated with an unchanged number of tasks.
const STILL_UNATTENDED: Duration = Duration::from_secs(60);
/// Claims without a liveliness token before the warning: a token may arrive shortly after the first claim.
const CLAIMS_WITHOUT_TOKEN: u32 = 10;
/// Most workers without a liveliness token, or without the subject of the campaign, that are remembered.
const MOST_REMEMBERED: usize = 1000;

/// State of the warnings about workers.
#[derive(Debug, Default)]
pub(super) struct WorkerWarnings {
    /// Since when tasks have waited without a worker.
    unattended_since: Option<Duration>,
    /// Time and number of tasks of the last warning about that.
    warned: Option<(Duration, usize)>,
    without_token: BTreeMap<WorkerId, u32>,
    without_subject: BTreeSet<WorkerId>,
    outdated: Refused,
    other_campaign: Refused,
}

impl WorkerWarnings {
    /// The liveliness token of a worker appeared.
    pub fn on_worker_joined(&mut self, id: &WorkerId) {
        self.without_token.remove(id);
    }

    /// Counts a claim of a worker without liveliness token (access rules?); returns a warning at the tenth. Its loss could not be
    /// detected, so it gets no tasks.
    pub fn on_claim_without_token(&mut self, id: &WorkerId) -> Option<String> {
        if self.without_token.len() >= MOST_REMEMBERED && !self.without_token.contains_key(id) {
            return None;
        }
        let claims = self.without_token.entry(id.clone()).or_default();
        *claims = claims.saturating_add(1);
        (*claims == CLAIMS_WITHOUT_TOKEN).then(|| {
            format!(
                "worker {} claims tasks but has no liveliness token, so it gets none: does access_control allow \
                 hingewise/alive/**?",
                id.name
            )
        })
    }

    /// Returns a warning at the first claim of a worker that does not offer the subject of the campaign.
    pub fn on_claim_without_subject(
        &mut self,
        id: &WorkerId,
        offers: &Offers,
        settings: &SchedulerSettings,
    ) -> Option<String> {
        let is_new = self.without_subject.len() < MOST_REMEMBERED && self.without_subject.insert(id.clone());
        is_new.then(|| settings.not_offered(&id.name, offers))
    }

    /// Counts a claim that is not the newest of its worker; returns a warning at the first, second, fourth, ... one.
    pub fn on_outdated_claim(&mut self, id: &WorkerId) -> Option<String> {
        let count = self.outdated.count()?;
        Some(format!(
            "a claim of worker {} is refused ({count} so far): one with a later number was received, so it was delayed or repeated, or \
             another program claims under this name",
            id.name
        ))
    }

    /// Counts an outcome of another campaign in the same way.
    pub fn on_other_campaign(&mut self, id: &WorkerId) -> Option<String> {
        let (count, name) = (self.other_campaign.count()?, &id.name);
        Some(format!("an outcome of worker {name} is not used ({count} so far): it belongs to another study"))
    }

    /// Returns a warning if `open` tasks have waited without any worker for [`UNATTENDED`]; `open` is 0 while a
    /// worker is connected.
    pub fn check_unattended(&mut self, now: Duration, open: usize) -> Option<String> {
        if open == 0 {
            (self.unattended_since, self.warned) = (None, None);
            return None;
        }
        let since = *self.unattended_since.get_or_insert(now);
        let (last, pause) = match self.warned {
            Some((last, number)) if number == open => (last, STILL_UNATTENDED),
            Some((last, _)) => (last, UNATTENDED),
            None => (since, UNATTENDED),
        };
        if now.saturating_sub(last) < pause {
            return None;
        }
        self.warned = Some((now, open));
        Some(format!(
            "{open} evaluations are waiting and no worker that can run them has been connected for {:.0} s",
            now.saturating_sub(since).as_secs_f64()
        ))
    }
}
