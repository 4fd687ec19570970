//! The status of a running study in the text format of Prometheus.
//!
//! # Source
//! Prometheus, "Exposition formats", text format version 0.0.4.

use common::wire::{Phase, Status, WorkerStatus};
use std::fmt::Write;

/// Every metric with its help and type. Counters end in `_total`; times are in seconds.
pub fn metrics_text(status: &Status) -> String {
    let (study, farm) = (&status.study, &status.farm);
    let mut page = MetricsText::default();
    page.single("up_seconds", "Time since the start of the coordinator.", status.up);
    let phases = [Phase::Waiting, Phase::Simulating, Phase::Learning, Phase::Ending];
    page.family("phase", "1 for the current phase of the coordinator.");
    for phase in phases {
        page.sample("phase", &[("phase", phase.name())], f64::from(u8::from(phase == status.phase)));
    }
    page.single("evaluations_total", "Evaluations ended.", study.done as f64);
    page.single("evaluations_failed_total", "Evaluations ended without a result.", study.failed as f64);
    page.single(
        "evaluations_recalled_total",
        "Evaluations read from the campaign file.",
        study.recalled as f64,
    );
    page.single("simulation_seconds_total", "Simulation time of evaluations.", study.simulation);
    page.single("rounds_total", "Rounds of learning ended.", study.rounds as f64);
    page.single("warnings_total", "Warnings to the user.", study.warnings as f64);
    page.single("evaluations_planned", "Evaluations planned so far.", study.planned as f64);
    page.single("evaluations_budget", "Largest number of evaluations.", study.budget as f64);
    page.single("tasks_queued", "Evaluations waiting for a worker.", farm.queued as f64);
    page.single("tasks_under_way", "Evaluations at workers.", farm.under_way as f64);
    page.single("evaluation_rate", "Evaluations per second in the last minute.", farm.rate);
    page.single("workers", "Workers that are connected.", farm.workers.len() as f64);
    page.single("slots", "Simulations that can run at once.", farm.slots() as f64);
    if let Some(so_far) = &study.reliability {
        let cycles = so_far.cycles.to_string();
        for (name, help, value) in [
            (
                "reliability",
                "Current estimate of the reliability, at the checkpoint where it is nearest one half.",
                so_far.total,
            ),
            (
                "reliability_error",
                "Standard error of the current estimate, from surrogates and sampling.",
                so_far.standard_error,
            ),
        ] {
            page.family(name, help);
            page.sample(name, &[("cycles", &cycles)], value);
        }
    }
    if !farm.workers.is_empty() {
        worker_metrics(&mut page, &farm.workers);
    }
    page.0
}

/// A metric of one worker: name, help, value.
type WorkerMetric = (&'static str, &'static str, fn(&WorkerStatus) -> f64);

const WORKER_METRICS: [WorkerMetric; 4] = [
    ("worker_slots", "Threads of a worker.", |w| f64::from(w.slots)),
    ("worker_tasks", "Evaluations at a worker.", |w| f64::from(w.under_way)),
    ("worker_evaluations_total", "Evaluations ended by a worker.", |w| w.done as f64),
    ("worker_rate", "Evaluations per second of a worker in the last minute.", |w| w.rate),
];

fn worker_metrics(page: &mut MetricsText, workers: &[WorkerStatus]) {
    for (name, help, value) in WORKER_METRICS {
        page.family(name, help);
        for worker in workers {
            page.sample(name, &[("worker", &worker.name)], value(worker));
        }
    }
}

/// Prefix of every name.
const PREFIX: &str = "hingewise_";

#[derive(Default)]
struct MetricsText(String);

impl MetricsText {
    /// The head of a metric; the name of a counter ends in `_total`.
    fn family(&mut self, name: &str, help: &str) {
        let kind = if name.ends_with("_total") { "counter" } else { "gauge" };
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "# HELP {PREFIX}{name} {help}\n# TYPE {PREFIX}{name} {kind}");
    }

    fn sample(&mut self, name: &str, labels: &[(&str, &str)], value: f64) {
        let labels: Vec<String> =
            labels.iter().map(|(key, text)| format!("{key}=\"{}\"", escaped(text))).collect();
        let labels = if labels.is_empty() { String::new() } else { format!("{{{}}}", labels.join(",")) };
        let _ = writeln!(self.0, "{PREFIX}{name}{labels} {value}");
    }

    fn single(&mut self, name: &str, help: &str, value: f64) {
        self.family(name, help);
        self.sample(name, &[], value);
    }
}

/// A label's value: backslash, quote and line feed are escaped.
fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::wire::{FarmStatus, ReliabilitySoFar, StudyStatus};
    use std::collections::BTreeSet;

    #[test]
    fn the_page_follows_the_text_format() {
        let worker =
            |name: &str| WorkerStatus { name: name.into(), slots: 2, under_way: 3, done: 7, rate: 0.5 };
        let status = Status {
            study: StudyStatus {
                done: 12,
                reliability: Some(ReliabilitySoFar { cycles: 6000, total: 0.5, standard_error: 0.01 }),
                ..StudyStatus::default()
            },
            farm: FarmStatus { workers: vec![worker("a\"b"), worker("c")], ..FarmStatus::default() },
            ..Status::default()
        };
        let text = metrics_text(&status);
        assert!(text.ends_with('\n'));
        let mut declared = BTreeSet::new();
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("# TYPE ") {
                let (name, kind) = rest.split_once(' ').unwrap();
                assert_eq!(kind == "counter", name.ends_with("_total"), "{line}");
                assert!(declared.insert(name.to_owned()), "{name} is declared twice");
            } else if !line.starts_with("# HELP ") {
                let (sample, value) = line.rsplit_once(' ').unwrap();
                let name = sample.split('{').next().unwrap();
                assert!(name.bytes().all(|b| b.is_ascii_lowercase() || b == b'_'), "{name}");
                assert!(declared.contains(name), "{name} before its type");
                assert!(value.parse::<f64>().unwrap().is_finite(), "{line}");
            }
        }
        for line in [
            "hingewise_evaluations_total 12",
            "hingewise_reliability{cycles=\"6000\"} 0.5",
            "hingewise_worker_slots{worker=\"a\\\"b\"} 2",
            "hingewise_phase{phase=\"waiting\"} 1",
        ] {
            assert!(text.lines().any(|l| l == line), "no {line} in\n{text}");
        }
    }
}
