//! The status of a running study as text.

use crate::farm::allocation::scale_sentence;
use crate::presentation::format::{count, duration, in_columns};
use crate::presentation::progress::{RemainingTime, per_second, reliability_so_far};
use common::wire::{Phase, Status, WorkerStatus};
use std::fmt::Write;

/// Phase, evaluations, queue, rate, current R, and one line per worker.
pub fn status_text(status: &Status) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = write_status(&mut text, status);
    text.replace('\u{a0}', " ")
}

/// Name of a phase.
fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Waiting => "waiting for workers",
        Phase::Simulating => "simulating",
        Phase::Learning => "learning, no simulation is running",
        Phase::Ending => "all evaluations done, computing the results",
    }
}

fn write_status(text: &mut String, status: &Status) -> std::fmt::Result {
    let (study, farm) = (&status.study, &status.farm);
    let purpose =
        if study.purpose.is_empty() { String::new() } else { format!(", {}", printable(&study.purpose)) };
    writeln!(
        text,
        "{}{purpose}: {} (for {})",
        printable(&study.scene),
        phase_name(status.phase),
        duration(status.up)
    )?;
    write!(text, "evaluations: {} of {} planned", count(study.done), count(study.planned))?;
    if study.budget > 0 {
        write!(text, ", budget {}", count(study.budget))?;
    }
    for (number, what) in [(study.failed, "failed"), (study.recalled, "from the campaign file")] {
        if number > 0 {
            write!(text, ", {} {what}", count(number))?;
        }
    }
    writeln!(text)?;
    let (queued, under_way, slots) = (count(farm.queued), count(farm.under_way), count(farm.slots()));
    writeln!(text, "queue: {queued} waiting, {under_way} running on {slots} slots")?;
    if farm.rate > 0.0 {
        let left = RemainingTime::of(study, Some(farm.rate));
        let remaining = left.map(|left| format!(", {left}")).unwrap_or_default();
        writeln!(text, "rate: {} in the last minute{remaining}", per_second(farm.rate))?;
    }
    if let Some(so_far) = &study.reliability {
        writeln!(
            text,
            "reliability so far: {}, after {} rounds",
            reliability_so_far(so_far.cycles, so_far.total, so_far.standard_error),
            count(study.rounds)
        )?;
    }
    if let Some(scale) = &status.scale {
        writeln!(text, "{}", printable(&scale_sentence(scale)))?;
    }
    if farm.workers.is_empty() {
        return writeln!(text, "no worker is connected");
    }
    let head = ["worker", "slots", "tasks", "done", "rate"].map(str::to_owned).to_vec();
    let row = |worker: &WorkerStatus| {
        let WorkerStatus { name, slots, under_way, done, rate } = worker;
        vec![printable(name), slots.to_string(), under_way.to_string(), count(*done), per_second(*rate)]
    };
    let rows: Vec<Vec<String>> = std::iter::once(head).chain(farm.workers.iter().map(row)).collect();
    write!(text, "\n{}", in_columns(&rows, &[0]))
}

/// Received text without control characters, which could control a terminal.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::{FarmStatus, ReliabilitySoFar, StudyStatus};

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
            "R(66 000) = 0.347 ± 0.012 (95 %), after 2 rounds",
            "host-1      2      3    40  0.65/s\n",
        ] {
            assert!(text.contains(part), "no \"{part}\" in:\n{text}");
        }
        assert!(status_text(&Status::default()).ends_with("no worker is connected\n"));
    }
}
