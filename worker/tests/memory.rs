//! What one more evaluation costs in memory, at its most exact. On Linux alone: nowhere else is the peak of the resident set in a file.
#![cfg(target_os = "linux")]

mod peak;
mod standalone;

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use peak::peak_resident;
use standalone::standalone;
use std::sync::Barrier;
use worker::simulator::simulator;

/// The flapping-wing drive at its most exact, with the first cycle, for a short life: what is held of a life does not grow with
/// it but for some numbers per block.
#[test]
fn one_more_evaluation_takes_less_than_20_mb() {
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
                    let mut job = standalone(&cut, &means, Accuracy::reference());
                    job.task.with_first_cycle = true;
                    let found = simulator.simulate(&job);
                    assert!(found.is_ok_and(|evaluation| evaluation.first_cycle.is_some()));
                });
            }
        });
        peak_resident()
    };
    let one = together(1);
    let all = together(SLOTS);
    let each = (all - one) as f64 / (SLOTS - 1) as f64 / 1e6;
    println!("{:.1} MB with one, {each:.1} MB for each further one", one as f64 / 1e6);
    assert!(each < 20.0, "{each} MB");
}
