//! The progress of a study and its farm as a section of the live page.

use crate::farm::dispatch::{StatusBoard, StatusHandle};
use crate::presentation::format::{count, duration};
use crate::presentation::progress::{RemainingTime, most_evaluations, per_second};
use crate::presentation::report::table;
use common::wire::{FarmStatus, Phase, Status, StudyStatus, WorkerStatus};
use maud::{Markup, html};
use std::time::{Duration, Instant};

/// Style of the section.
pub const STYLE: &str = "#study progress{width:100%;max-width:64rem;height:1.1rem;accent-color:var(--series-1)}\
                         #study .ends{font-size:1.15rem;margin:.2rem 0}#study table{margin-top:.6rem}";

/// Evaluations, rate, expected end and workers; without a `status`, what was counted.
pub fn study_section(study: &StudyStatus, status: Option<&Status>) -> Markup {
    let StudyStatus { done, purpose, .. } = study;
    let rate = status.map(|status| status.farm.rate).filter(|rate| *rate > 0.0);
    let most = most_evaluations(study);
    let phase = status.map(|status| status.phase);
    html! {
        section id="study" aria-label="Progress of the study" {
            progress max=(most.max(1)) value=(done) { (done) " of " (most) }
            p.ends {
                (count(*done)) " of at most " (count(most)) " evaluations"
                @if !purpose.is_empty() { " (" (purpose) ")" }
                @if let Some(rate) = rate { ", " (per_second(rate)) }
                @match (phase, RemainingTime::of(study, rate)) {
                    (Some(Phase::Ending), _) => { ", computing the results" }
                    (_, Some(left)) => {
                        ", " (left) @if let Some(status) = status { (clock(status.clock_ms, left.seconds, left.is_bound)) }
                    }
                    (Some(Phase::Waiting), None) => { ", waiting for workers" }
                    _ => {}
                }
            }
            @if let Some(status) = status { (farm(status)) }
        }
    }
}

/// The expected end as a time of the day; the script of the page writes it in the reader's time zone.
fn clock(now_ms: u64, left: f64, is_bound: bool) -> Markup {
    let end = now_ms / 1000 + left.round() as u64;
    let (hour, minute) = (end / 3600 % 24, end / 60 % 60);
    html! {
        ", expected end " @if is_bound { "before " } @else { "about " }
        time data-seconds=(end) { (format!("{hour:02}:{minute:02} UTC")) }
    }
}

/// The workers as a table, and the queue.
fn farm(status: &Status) -> Markup {
    let farm = &status.farm;
    if farm.workers.is_empty() {
        return html! { p { "No worker is connected; " (count(farm.queued)) " evaluations wait." } };
    }
    html! {
        (table(&["worker", "slots", "running", "done", "rate"], farm.workers.iter().map(|worker| {
            let WorkerStatus { name, slots, under_way, done, rate } = worker;
            [name.clone(), slots.to_string(), under_way.to_string(), count(*done), per_second(*rate)]
        })))
        p.meta {
            (count(farm.queued)) " waiting, " (count(farm.under_way)) " running on " (count(farm.slots())) @if farm.slots() == 1 { " slot" } @else { " slots" } ", for "
            (duration(status.up))
        }
    }
}

/// Longest wait for the status of the farm.
const STATUS_TIMEOUT: Duration = Duration::from_secs(2);

/// Provider of the status of a running study.
#[derive(Debug, Clone)]
pub enum StatusSource {
    /// The dispatcher of a farm.
    Farm(StatusHandle),
    /// A study whose simulator runs on slots of this process.
    Alone {
        /// Board of the study.
        board: StatusBoard,
        /// Number of slots.
        slots: u32,
        /// Start of the study.
        since: Instant,
    },
}

impl StatusSource {
    /// The status now; `None` if the farm has ended or does not answer.
    pub fn status(&self) -> Option<Status> {
        match self {
            StatusSource::Farm(dispatcher) => dispatcher.status(STATUS_TIMEOUT),
            StatusSource::Alone { board, slots, since } => {
                let up = since.elapsed();
                let mut status = board.status(FarmStatus::default(), up);
                let StudyStatus { done, recalled, planned, .. } = status.study;
                let under_way = planned.saturating_sub(done);
                let rate = done.saturating_sub(recalled) as f64 / up.as_secs_f64().max(1.0);
                let worker = WorkerStatus {
                    name: "this-process".to_owned(),
                    slots: *slots,
                    under_way: u32::try_from(under_way).unwrap_or(u32::MAX).min(*slots),
                    done: done.saturating_sub(recalled),
                    rate,
                };
                let running = u64::from(worker.under_way);
                let queued = under_way - running;
                status =
                    board.status(FarmStatus { queued, under_way: running, rate, workers: vec![worker] }, up);
                Some(status)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::FarmStatus;

    #[test]
    fn progress_expected_end_and_workers_are_shown() {
        let worker = WorkerStatus { name: "<host>".into(), slots: 4, under_way: 3, done: 61, rate: 1.5 };
        let farm = FarmStatus { queued: 5, under_way: 3, rate: 1.5, workers: vec![worker] };
        // 2026-11-24 02:30:00 UTC.
        let status =
            Status { clock_ms: 1_795_487_400_000, phase: Phase::Simulating, farm, ..Status::default() };
        let purpose = "round 2".to_owned();
        let study = StudyStatus { done: 61, planned: 72, budget: 151, purpose, ..StudyStatus::default() };
        let text = study_section(&study, Some(&status)).0.replace('\u{a0}', " ");
        for piece in [
            "<progress max=\"151\" value=\"61\">",
            "61 of at most 151 evaluations (round 2), 1.50/s, at most 1 min 00 s left, expected end before ",
            "data-seconds=\"1795487460\">02:31 UTC</time>",
            "<td>&lt;host&gt;</td><td>4</td><td>3</td><td>61</td><td>1.50/s</td>",
        ] {
            assert!(text.contains(piece), "no {piece} in {text}");
        }
        let waiting = Status { phase: Phase::Waiting, ..Status::default() };
        let study = StudyStatus { planned: 1, budget: 40, ..StudyStatus::default() };
        let text = study_section(&study, Some(&waiting)).0;
        assert!(text.contains("waiting for workers") && text.contains("No worker is connected"), "{text}");
        assert!(!text.contains("expected end"), "{text}");
    }
}
