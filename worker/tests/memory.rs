//! What one more slot of a worker costs in memory. On Linux alone: nowhere else is the peak of the resident set in a file.
#![cfg(target_os = "linux")]

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use std::sync::Barrier;
use worker::simulator::simulator;

/// Most memory the process has had so far [bytes].
fn peak_resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux says how much memory is used");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line for the peak");
    let kilobytes = line.trim().strip_suffix(" kB").expect("in kB");
    1024 * kilobytes.trim().parse::<u64>().expect("a number")
}

/// The flapping-wing drive at its most exact, with the first cycle, for a short life: what is held of a life does not grow with
/// it but for some numbers per block.
#[test]
fn one_more_slot_takes_less_than_20_mb() {
    const SLOTS: usize = 5;
    let text = SceneSource::builtin("flapping-wing").expect("built in").text().to_owned();
    let cut = text.replace("cycles = 72000", "cycles = 1000");
    assert_ne!(cut, text, "the life is cut short");
    let means: Vec<f64> = SceneSource::parse(&cut, "cut")
        .expect("a scene")
        .variables()
        .iter()
        .map(|variable| variable.distribution.parent_mean())
        .collect();
    let simulator = simulator();
    let together = |slots: usize| {
        let start = Barrier::new(slots);
        std::thread::scope(|scope| {
            for _ in 0..slots {
                scope.spawn(|| {
                    start.wait();
                    let found = simulator.simulate(&cut, &means, &Accuracy::reference(), true);
                    assert!(found.is_ok_and(|evaluation| evaluation.first_cycle.is_some()));
                });
            }
        });
        peak_resident()
    };
    let one = together(1);
    let all = together(SLOTS);
    let each = (all - one) as f64 / (SLOTS - 1) as f64 / 1e6;
    println!("{:.1} MB with one slot, {each:.1} MB for each further one", one as f64 / 1e6);
    assert!(each < 20.0, "{each} MB");
}
