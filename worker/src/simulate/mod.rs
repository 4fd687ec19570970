//! One evaluation: the whole life of one sample.
//!
//! assemble -> settle -> measure the first cycle -> [ wear a block -> warm up -> measure a cycle ] ... -> outputs
//!
//! A measured cycle serves twice: its contact history drives the wear of the block that follows, and its motion
//! gives the outputs of the profile it ran on. The value of a checkpoint belongs to the profile worn to it. At a few
//! lives the measured cycle is put to the test, from which the evaluation estimates its own error.
//!
//! Where wear is all that is asked for, the cycles between the first and the last may be quasi-static ones; where
//! nothing wears, one cycle is all there is.

mod error;
mod finish;
mod first_look;
mod guided;
mod life;
mod moving;
mod observe;
mod probe;
mod run;
mod unchanging;

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::Scene;
use guided::wear_alone;
use life::live;
use run::Run;

pub use first_look::{FirstLook, IslandModel, first_look};

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
    simulate_counting(scene, accuracy, with_first_cycle, &mut 0)
}

/// The same; adds the time steps tried, accepted and refused, to `steps`, those before a failure too.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_counting(
    scene: &Scene,
    accuracy: &Accuracy,
    with_first_cycle: bool,
    steps: &mut u64,
) -> Result<Evaluation, SimulationFailure> {
    let mut run = Run::assemble(scene, accuracy)?;
    let evaluation = evaluate(&mut run, with_first_cycle);
    *steps += run.stats.steps + run.stats.rejected;
    evaluation
}

/// Stage by stage.
fn evaluate(run: &mut Run, with_first_cycle: bool) -> Result<Evaluation, SimulationFailure> {
    run.watched = with_first_cycle;
    run.settle()?;
    run.show(true);
    run.measure()?;
    let first = run.first_seen(with_first_cycle);
    run.show(false);
    if !run.wears() {
        return run.unchanging(first);
    }

    let lived = match wear_alone(run) {
        Some(lived) => lived,
        None => live(run, Run::next_cycle, true)?,
    };
    run.finish(run.scene.life.checkpoints(), lived.histories, lived.errors, first)
}
