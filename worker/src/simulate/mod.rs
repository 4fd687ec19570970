//! One evaluation: the whole life of one sample.
//!
//! assemble -> settle -> measure the first cycle -> [ wear a block -> warm up -> measure a cycle ] ... -> outputs
//!
//! A measured cycle serves twice: its contact history drives the wear of the block that follows, and its motion
//! gives the outputs of the profile it ran on. The value of a checkpoint belongs to the profile worn to it.
//!
//! Where wear is all that is asked for, the cycles between the first and the last may be quasi-static ones.

mod guided;
mod life;
mod moving;
mod observe;
mod run;

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::Scene;
use guided::wear_alone;
use life::live;
use run::Run;

/// Simulates the whole life of a checked scene.
///
/// Returns every output at every checkpoint; the settled first cycle too if `with_first_cycle`.
///
/// # Errors
/// [`SimulationFailure`]: what the physics or the numerics refused, with time, cycle and joint.
pub fn simulate(
    scene: &Scene,
    accuracy: &Accuracy,
    with_first_cycle: bool,
) -> Result<Evaluation, SimulationFailure> {
    let mut run = Run::assemble(scene, accuracy)?;
    run.settle()?;
    run.show_forces(true);
    run.measure()?;
    let first_cycle = with_first_cycle.then(|| run.first_cycle());
    let (peaks, free_flight) = run.force_summary();
    run.show_forces(false);

    let histories = match wear_alone(&mut run) {
        Some(histories) => histories,
        None => live(&mut run, Run::next_cycle)?,
    };
    let cycles = scene.life.checkpoints();
    run.finish(cycles, histories, peaks, free_flight, first_cycle)
}
