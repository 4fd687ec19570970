//! The whole life after the settled first cycle: block after block of wear, a measured cycle at the end of each.

use super::run::Run;
use crate::life::{at_checkpoints, boundaries};
use common::failure::SimulationFailure;
use common::scene::OutputKind;

/// One history per output of the scene at every checkpoint `(outputs, m)`, SI.
pub type Histories = Vec<Vec<f64>>;

/// Wears the bores to the end of life, with a measured cycle by `next_cycle` after each block.
///
/// # Errors
/// What the wear or `next_cycle` refused.
pub fn live<'a, E: From<SimulationFailure>>(
    run: &mut Run<'a>,
    next_cycle: impl Fn(&mut Run<'a>) -> Result<(), E>,
) -> Result<Histories, E> {
    let (scene, accuracy) = (run.scene, run.accuracy);
    let every = scene.life.checkpoint_every;
    let mut lives = vec![0];
    let mut measured = vec![run.motion_outputs()];
    let mut wear = vec![vec![]; scene.outputs.len()];
    for block in boundaries(scene.life.cycles, accuracy.cycle_jump, every).windows(2) {
        let checkpoints: Vec<u32> = (block[0] / every + 1..=block[1] / every).map(|k| k * every).collect();
        run.wear(block[0], block[1], &checkpoints, &mut wear)?;
        next_cycle(run)?;
        lives.push(block[1]);
        measured.push(run.motion_outputs());
    }
    let cycles = scene.life.checkpoints();
    Ok(scene
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
        .collect())
}
