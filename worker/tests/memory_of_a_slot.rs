//! What one more slot of a worker costs in memory, with all that it has side by side. On Linux alone: nowhere else is the peak of the resident set in a file.
#![cfg(target_os = "linux")]

mod peak;

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use peak::peak_resident;
use std::sync::Barrier;
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate_side_by_side};
use worker::simulator::simulator;

/// What a slot holds at once at `balanced`, each of a life short enough: what is held of a life does not grow with it but for some numbers
/// per block. One of them is to show its first cycle, as the first evaluation of a study is.
#[test]
fn one_more_slot_takes_less_than_20_mb() {
    const SLOTS: usize = 5;
    let side_by_side = simulator().side_by_side();
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let slot = |start: &Barrier| {
        start.wait();
        let mut given = 0;
        let mut next = || {
            given += 1;
            let mut scene = source.nominal().clone();
            scene.life.cycles = 1000;
            let options = SimulateOptions { first_cycle: given == 1 };
            let accuracy = Accuracy::balanced();
            (given <= side_by_side).then_some(Ok(SimulationInput { scene, accuracy, options }))
        };
        simulate_side_by_side(LaneWidth::Widest, side_by_side, &mut next, &mut |_, found, _| {
            assert!(found.is_ok());
        });
    };
    let together = |slots: usize| {
        let start = Barrier::new(slots);
        std::thread::scope(|scope| (0..slots).for_each(|_| drop(scope.spawn(|| slot(&start)))));
        peak_resident()
    };
    let one = together(1);
    let all = together(SLOTS);
    let each = (all - one) as f64 / (SLOTS - 1) as f64 / 1e6;
    println!(
        "{:.1} MB with one slot of {side_by_side} evaluations side by side, {each:.1} MB for each further one",
        one as f64 / 1e6
    );
    assert!(each < 20.0, "{each} MB");
}
