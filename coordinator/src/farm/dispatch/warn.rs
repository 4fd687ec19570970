//! Texts of the scheduler's warnings.

use super::scheduler::Warning;
use common::build::Build;
use common::wire::{Offers, Subject};

/// Simulators of a worker that are listed.
const SHOWN: usize = 5;

/// Logs a warning of a campaign on `subject` that uses results of one `build` of the program only, or of any.
pub(super) fn warn(warning: &Warning, subject: &Subject, build: Option<Build>) {
    match warning {
        Warning::NotOffered(worker, Offers::Scenes(theirs))
            if build.is_some_and(|ours| ours != *theirs) && matches!(subject, Subject::Scene(_)) =>
        {
            tracing::warn!(
                "worker {} gets no evaluations: its program is build {theirs}, that of the coordinator build {}, and their \
                 results may differ; start the worker with the program of the coordinator, or the study with --mixed-builds",
                worker.name,
                build.unwrap_or_default()
            );
        }
        Warning::NotOffered(worker, offers) => tracing::warn!(
            "worker {} gets no evaluations: the study is of {}, the worker offers {}",
            worker.name,
            wanted(subject),
            offered(offers)
        ),
        Warning::Unusable(worker, reason) => {
            tracing::warn!("worker {} gets no more evaluations: {reason}", worker.name);
        }
        Warning::NoWorker(open, since) => tracing::warn!(
            "{open} evaluations are waiting and no worker that can run them has been connected for {:.0} s",
            since.as_secs_f64()
        ),
        Warning::NoLiveliness(worker) => tracing::warn!(
            "worker {} claims tasks but has no liveliness token, so it gets none: does access_control allow \
             hingewise/alive/**?",
            worker.name
        ),
        Warning::WorkerLost(worker, tasks) => {
            tracing::warn!("worker {} was lost; its evaluations {tasks:?} are requeued", worker.name);
        }
        Warning::Overdue(worker, task, after) => tracing::warn!(
            "evaluation {task} has been running on worker {} for {:.0} s; another worker gets it too",
            worker.name,
            after.as_secs_f64()
        ),
        Warning::OutdatedClaim(worker, count) => tracing::warn!(
            "a claim of worker {} is refused ({count} so far): one with a later number was received, so it was delayed or repeated, or \
             another program claims under this name",
            worker.name
        ),
        Warning::OtherCampaign(worker, count) => tracing::warn!(
            "an outcome of worker {} is not used ({count} so far): it belongs to another study",
            worker.name
        ),
        Warning::OtherSample(worker, task) => tracing::warn!(
            "worker {} returned an outcome of another sample as evaluation {task}; it is not used",
            worker.name
        ),
    }
}

/// What a study needs of its workers, in words.
fn wanted(subject: &Subject) -> String {
    match subject {
        Subject::Scene(_) => "a mechanism".to_owned(),
        Subject::Simulator(id) => format!("simulator {id}"),
    }
}

/// What a worker offers, in words.
fn offered(offers: &Offers) -> String {
    match offers {
        Offers::Scenes(_) => "simulations of mechanisms".to_owned(),
        Offers::Simulators(all) => {
            let shown: Vec<String> = all.iter().take(SHOWN).map(ToString::to_string).collect();
            let more = if all.len() > SHOWN { ", ..." } else { "" };
            format!("{}{more}", shown.join(", "))
        }
    }
}
