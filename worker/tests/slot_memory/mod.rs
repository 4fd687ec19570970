//! Memory that one more slot of a worker takes, with all the evaluations that it has side by side.

use crate::peak::peak_resident;
use common::accuracy::Accuracy;
use common::scene::SceneSource;
use std::sync::Barrier;
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate_side_by_side};
use worker::simulator::simulator;

/// Memory of one more slot than one, with the drive at this accuracy over `cycles` of life [MB]. One of a slot's evaluations is to show its
/// first cycle, as the first evaluation of a study is. The test that calls it must be alone in its process, whose peak is measured.
pub fn of_one_more_slot(accuracy: Accuracy, cycles: u32, slots: usize) -> f64 {
    let side_by_side = simulator().side_by_side();
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let slot = |start: &Barrier| {
        start.wait();
        let mut given = 0;
        let mut next = || {
            given += 1;
            let mut scene = source.nominal().clone();
            scene.life.cycles = cycles;
            let options = SimulateOptions { first_cycle: given == 1 };
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
    let all = together(slots);
    let each = (all - one) as f64 / (slots - 1) as f64 / 1e6;
    println!(
        "{:.1} MB with one slot of {side_by_side} evaluations side by side, {each:.1} MB for each further one",
        one as f64 / 1e6
    );
    each
}
