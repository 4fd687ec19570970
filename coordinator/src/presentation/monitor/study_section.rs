//! The status of a running study and its farm: its source, a section of the live page, and text.

use crate::farm::allocation::scale_sentence;
use crate::farm::dispatch::{StatusBoard, StatusHandle};
use crate::presentation::format::{count, duration, in_columns};
use crate::presentation::progress::{most_evaluations, per_second, reliability_so_far, remaining_time};
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
                @match (phase, remaining_time(study, rate)) {
                    (Some(Phase::Ending), _) => { ", computing the results" }
                    (_, Some((seconds, left))) => {
                        ", " (left) @if let Some(status) = status { (clock(status.clock_ms, seconds, most > study.planned)) }
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
                let StudyStatus { done, recalled, planned, .. } =
                    board.status(FarmStatus::default(), up).study;
                let (open, simulated) = (planned.saturating_sub(done), done.saturating_sub(recalled));
                let rate = simulated as f64 / up.as_secs_f64().max(1.0);
                let (name, slots) = ("this-process".to_owned(), *slots);
                let under_way = u32::try_from(open).unwrap_or(u32::MAX).min(slots);
                let workers = vec![WorkerStatus { name, slots, under_way, done: simulated, rate }];
                let under_way = u64::from(under_way);
                Some(board.status(FarmStatus { queued: open - under_way, under_way, rate, workers }, up))
            }
        }
    }
}

/// Phase, evaluations, queue, rate, current R, and one line per worker.
pub fn status_text(status: &Status) -> String {
    let (study, farm) = (&status.study, &status.farm);
    let [scene, purpose] = [&study.scene, &study.purpose].map(|text| printable(text));
    let purpose = if purpose.is_empty() { purpose } else { format!(", {purpose}") };
    let phase = match status.phase {
        Phase::Waiting => "waiting for workers",
        Phase::Simulating => "simulating",
        Phase::Learning => "learning, no simulation is running",
        Phase::Ending => "all evaluations done, computing the results",
    };
    let [done, planned, budget, failed, recalled] =
        [study.done, study.planned, study.budget, study.failed, study.recalled].map(count);
    let mut text = format!("{scene}{purpose}: {phase} (for {})\n", duration(status.up));
    text += &format!("evaluations: {done} of {planned} planned");
    for (number, part) in [
        (study.budget, format!(", budget {budget}")),
        (study.failed, format!(", {failed} failed")),
        (study.recalled, format!(", {recalled} from the campaign file")),
    ] {
        text += if number > 0 { part.as_str() } else { "" };
    }
    let [queued, under_way, slots] = [farm.queued, farm.under_way, farm.slots()].map(count);
    text += &format!("\nqueue: {queued} waiting, {under_way} running on {slots} slots\n");
    if farm.rate > 0.0 {
        let left = remaining_time(study, Some(farm.rate));
        let remaining = left.map(|(_, left)| format!(", {left}")).unwrap_or_default();
        text += &format!("rate: {} in the last minute{remaining}\n", per_second(farm.rate));
    }
    if let Some(so_far) = &study.reliability {
        let so_far = reliability_so_far(so_far.cycles, so_far.total, so_far.standard_error);
        text += &format!("reliability so far: {so_far}, after {} rounds\n", count(study.rounds));
    }
    if let Some(scale) = &status.scale {
        text += &format!("{}\n", printable(&scale_sentence(scale)));
    }
    let head = ["worker", "slots", "tasks", "done", "rate"].map(str::to_owned).to_vec();
    let row = |worker: &WorkerStatus| {
        let WorkerStatus { name, slots, under_way, done, rate } = worker;
        vec![printable(name), slots.to_string(), under_way.to_string(), count(*done), per_second(*rate)]
    };
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(farm.workers.iter().map(row)).collect();
    let of_workers = format!("\n{}", in_columns(&rows, &[0]));
    text += if farm.workers.is_empty() { "no worker is connected\n" } else { of_workers.as_str() };
    text.replace('\u{a0}', " ")
}

/// Received text without control characters, which could control a terminal.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::ReliabilitySoFar;

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

    #[test]
    fn a_status_has_workers_rates_and_the_current_r() {
        let worker =
            |name: &str| WorkerStatus { name: name.into(), slots: 2, under_way: 3, done: 40, rate: 0.65 };
        let status = Status {
            up: 130.0,
            phase: Phase::Simulating,
            study: StudyStatus {
                scene: "four-\u{1b}bar".into(),
                purpose: "round 3".into(),
                done: 84,
                planned: 120,
                budget: 400,
                failed: 1,
                rounds: 2,
                reliability: Some(ReliabilitySoFar { cycles: 66_000, total: 0.347, standard_error: 0.006 }),
                ..StudyStatus::default()
            },
            farm: FarmStatus {
                queued: 30,
                under_way: 6,
                rate: 1.3,
                workers: vec![worker("host-1"), worker("b")],
            },
            ..Status::default()
        };
        let text = status_text(&status);
        for part in [
            "four-bar, round 3: simulating (for 2 min 10 s)\n",
            "evaluations: 84 of 120 planned, budget 400, 1 failed\n",
            "queue: 30 waiting, 6 running on 4 slots\n",
            "rate: 1.30/s in the last minute, at most 4 min 03 s left\n",
            "R(66 000) = 0.347 ± 0.012 (95 % but for numerical error), after 2 rounds",
            "host-1      2      3    40  0.65/s\n",
        ] {
            assert!(text.contains(part), "no \"{part}\" in:\n{text}");
        }
        assert!(status_text(&Status::default()).ends_with("no worker is connected\n"));
    }
}
