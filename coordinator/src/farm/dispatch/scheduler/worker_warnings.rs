//! Warnings about workers: none connected while tasks wait, or no liveliness token.

use super::{SchedulerSettings, Warning};
use common::wire::{Offers, Refused, WorkerId};
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

/// Claims without a liveliness token before the warning: a token may arrive shortly after the first claim.
const CLAIMS_WITHOUT_TOKEN: u32 = 10;
/// Most workers without a liveliness token, or without the subject of the campaign, that are remembered.
const MOST_REMEMBERED: usize = 1000;

/// Tasks wait and no worker is connected.
#[derive(Debug)]
struct Unattended {
    since: Duration,
    /// Time and number of tasks of the last warning.
    warned: Option<(Duration, usize)>,
}

/// State of the warnings about workers.
#[derive(Debug, Default)]
pub(super) struct WorkerWarnings {
    unattended: Option<Unattended>,
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

    /// Counts a claim of a worker without liveliness token; returns a warning at the tenth.
    pub fn on_claim_without_token(&mut self, id: &WorkerId) -> Option<Warning> {
        if self.without_token.len() >= MOST_REMEMBERED && !self.without_token.contains_key(id) {
            return None;
        }
        let claims = self.without_token.entry(id.clone()).or_default();
        *claims = claims.saturating_add(1);
        (*claims == CLAIMS_WITHOUT_TOKEN).then(|| Warning::NoLiveliness(id.clone()))
    }

    /// Returns a warning at the first claim of a worker that does not offer the subject of the campaign.
    pub fn on_claim_without_subject(&mut self, id: &WorkerId, offers: Offers) -> Option<Warning> {
        let is_new = self.without_subject.len() < MOST_REMEMBERED && self.without_subject.insert(id.clone());
        is_new.then(|| Warning::NotOffered(id.clone(), offers))
    }

    /// Counts a claim that is not the newest of its worker; returns a warning at the first, second, fourth, ... one.
    pub fn on_outdated_claim(&mut self, id: &WorkerId) -> Option<Warning> {
        self.outdated.count().map(|count| Warning::OutdatedClaim(id.clone(), count))
    }

    /// Counts an outcome of another campaign in the same way.
    pub fn on_other_campaign(&mut self, id: &WorkerId) -> Option<Warning> {
        self.other_campaign.count().map(|count| Warning::OtherCampaign(id.clone(), count))
    }

    /// Returns a warning if `open` tasks have waited without any worker for `settings.unattended`; `open` is 0 while a
    /// worker is connected.
    pub fn check_unattended(
        &mut self,
        now: Duration,
        open: usize,
        settings: &SchedulerSettings,
    ) -> Option<Warning> {
        if open == 0 {
            self.unattended = None;
            return None;
        }
        let Unattended { since, warned } =
            self.unattended.get_or_insert(Unattended { since: now, warned: None });
        let (last, pause) = match *warned {
            Some((last, number)) if number == open => (last, settings.still_unattended),
            Some((last, _)) => (last, settings.unattended),
            None => (*since, settings.unattended),
        };
        if now.saturating_sub(last) < pause {
            return None;
        }
        *warned = Some((now, open));
        Some(Warning::NoWorker(open, now.saturating_sub(*since)))
    }
}
