//! One evaluation: the whole life of one sample.
//!
//! assemble -> settle -> measure the first cycle -> [ wear a block -> warm up -> measure a cycle ] ... -> outputs
//!
//! A measured cycle serves twice: its contact history drives the wear of the block that follows, and its motion
//! gives the outputs of the profile it ran on. The value of a checkpoint belongs to the profile worn to it. At a few
//! lives the measured cycle is put to the test, from which the evaluation estimates its own error.

mod error;
mod finish;
mod moving;
mod observe;
mod probe;
mod run;
mod unchanging;

use crate::life::{at_checkpoints, boundaries};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{OutputKind, Scene};
use error::Doubt;
use probe::probed;
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
    let evaluation = live(&mut run, with_first_cycle);
    *steps += run.stats.steps + run.stats.rejected;
    evaluation
}

/// The life, stage by stage.
fn live(run: &mut Run, with_first_cycle: bool) -> Result<Evaluation, SimulationFailure> {
    let (scene, accuracy) = (run.scene, run.accuracy);
    run.settle()?;
    run.show(true);
    run.measure()?;
    let first = run.first_seen(with_first_cycle);
    run.show(false);
    if !run.wears() {
        return run.unchanging(first);
    }

    let every = scene.life.checkpoint_every;
    let lives = boundaries(scene.life.cycles, accuracy.cycle_jump, every);
    let probed = probed(&lives, every);
    let mut doubt = Doubt::default();
    let mut measured = vec![run.motion_outputs()];
    let mut wear = vec![vec![]; scene.outputs.len()];
    for block in lives.windows(2) {
        let checkpoints: Vec<u32> = (block[0] / every + 1..=block[1] / every).map(|k| k * every).collect();
        let depths = run.depths();
        run.wear(block[0], block[1], &checkpoints, &mut wear)?;
        doubt.worn(run, block[0], depths);
        run.warm_up()?;
        run.measure()?;
        measured.push(run.motion_outputs());
        if probed.contains(&block[1]) {
            doubt.probed(run.probe(block[1])?);
        }
    }
    run.close_wear()?;
    doubt.worn(run, scene.life.cycles, run.depths());

    let cycles = scene.life.checkpoints();
    let histories: Vec<Vec<f64>> = scene
        .outputs
        .iter()
        .enumerate()
        .map(|(k, output)| match output.kind {
            OutputKind::LargestWear { .. } => std::mem::take(&mut wear[k]),
            _ => {
                let values: Vec<f64> = measured.iter().map(|m| m[k]).collect();
                at_checkpoints(&lives, &values, &cycles)
            }
        })
        .collect();
    let errors = doubt.errors(scene, &histories, &lives, &measured, accuracy.largest_step);
    run.finish(cycles, histories, errors, first)
}
