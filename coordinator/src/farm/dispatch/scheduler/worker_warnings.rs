//! What the user is told about who is there: nobody while tasks wait, and workers that show no liveliness token.

use super::{SchedulerSettings, Warning};
use common::wire::WorkerId;
use std::collections::BTreeMap;
use std::time::Duration;

/// Claims without a liveliness token until the user is told: a token may be a moment late.
const STRANGE_CLAIMS: u32 = 10;
/// Workers without a liveliness token that are remembered.
const STRANGERS: usize = 1000;

/// Tasks wait and nobody is there.
#[derive(Debug)]
struct Unattended {
    since: Duration,
    /// When the user was told last, and of how many tasks.
    told: Option<(Duration, usize)>,
}

/// See the module.
#[derive(Debug, Default)]
pub(super) struct WorkerWarnings {
    unattended: Option<Unattended>,
    strangers: BTreeMap<WorkerId, u32>,
}

impl WorkerWarnings {
    /// A token is seen.
    pub fn appeared(&mut self, id: &WorkerId) {
        self.strangers.remove(id);
    }

    /// A claim without a token.
    pub fn strange_claim(&mut self, id: &WorkerId) -> Option<Warning> {
        if self.strangers.len() >= STRANGERS && !self.strangers.contains_key(id) {
            return None;
        }
        let claims = self.strangers.entry(id.clone()).or_default();
        *claims = claims.saturating_add(1);
        (*claims == STRANGE_CLAIMS).then(|| Warning::NoLiveliness { worker: id.clone() })
    }

    /// Looks whether somebody is there for the open tasks.
    pub fn check(
        &mut self,
        now: Duration,
        anybody: bool,
        open: usize,
        settings: &SchedulerSettings,
    ) -> Option<Warning> {
        if anybody || open == 0 {
            self.unattended = None;
            return None;
        }
        let Unattended { since, told } = self.unattended.get_or_insert(Unattended { since: now, told: None });
        let (last, patience) = match *told {
            Some((last, of)) if of == open => (last, settings.still_unattended),
            Some((last, _)) => (last, settings.unattended),
            None => (*since, settings.unattended),
        };
        if now.saturating_sub(last) < patience {
            return None;
        }
        *told = Some((now, open));
        Some(Warning::NoWorker { open, since: now.saturating_sub(*since) })
    }
}
