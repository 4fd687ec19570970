//! The whole life after the settled first cycle: block after block of wear, a measured cycle at the end of each.

use super::error::Doubt;
use super::probe::probed;
use super::run::Run;
use crate::life::{at_checkpoints, boundaries};
use common::failure::SimulationFailure;
use common::scene::OutputKind;

/// What a life came to, for every output of the scene at every checkpoint `(outputs, m)`, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Lived {
    /// The outputs.
    pub histories: Vec<Vec<f64>>,
    /// Estimates of their errors.
    pub errors: Vec<Vec<f64>>,
}

/// Wears the bores to the end of life, with a measured cycle by `next_cycle` after each block; where these are
/// `dynamic`, some are put to the test.
///
/// # Errors
/// What the wear or `next_cycle` refused.
pub async fn live<E: From<SimulationFailure>>(
    run: &mut Run<'_>,
    next_cycle: impl AsyncFn(&mut Run) -> Result<(), E>,
    dynamic: bool,
) -> Result<Lived, E> {
    let (scene, accuracy) = (run.scene, run.accuracy);
    let every = scene.life.checkpoint_every;
    let lives = boundaries(scene.life.cycles, accuracy.cycle_jump, every);
    let probed = if dynamic { probed(&lives, every) } else { vec![] };
    let mut doubt = Doubt::default();
    let mut measured = vec![run.motion_outputs()];
    if dynamic {
        doubt.probed(run.probe(0).await?);
    }
    let mut wear = vec![vec![]; scene.outputs.len()];
    for block in lives.windows(2) {
        let checkpoints: Vec<u32> = (block[0] / every + 1..=block[1] / every).map(|k| k * every).collect();
        let depths = run.depths();
        run.wear(block[0], block[1], &checkpoints, &mut wear)?;
        doubt.worn(run, block[0], depths);
        if dynamic && block[1] == scene.life.cycles {
            run.last_cycle().await?;
        } else {
            next_cycle(run).await?;
        }
        measured.push(run.motion_outputs());
        if probed.contains(&block[1]) {
            doubt.probed(run.probe(block[1]).await?);
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
    Ok(Lived { histories, errors })
}
