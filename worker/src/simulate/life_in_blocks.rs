//! The whole life after the settled first cycle: block after block of wear, with a measured cycle at the end of each.

use super::blocks::{at_checkpoints, block_ends};
use super::error_estimate::{ErrorEstimate, MeasuredLives};
use super::probe::is_probed;
use super::run::Run;
use super::several_cycles::{SeveralCycles, SeveralMotions};
use common::failure::SimulationFailure;
use common::scene::OutputKind;

/// Every output of the scene at every checkpoint `(outputs, m)` [SI].
#[derive(Debug, Clone, PartialEq)]
pub struct LifeHistory {
    /// Values of the outputs.
    pub histories: Vec<Vec<f64>>,
    /// Estimates of their errors.
    pub errors: Vec<Vec<f64>>,
    /// Values in the first cycle, before any wear `(outputs,)` [SI].
    pub start: Vec<f64>,
}

/// Model of the motion in the cycles between two blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CycleModel {
    /// Dynamic cycles, some of which are probed for their error.
    Dynamic,
    /// Quasi-static cycles, which are not probed.
    QuasiStatic,
    /// No cycle but the one measured, which is the whole life.
    Single,
}

/// Wears the bores to the end of life; `next_cycle` simulates the cycle of `model` after each block, except the last one of the
/// dynamics and all of a single cycle.
///
/// # Errors
/// The first error of the wear, of a probe or of `next_cycle`.
pub(crate) async fn simulate_life<E: From<SimulationFailure>>(
    run: &mut Run<'_>,
    next_cycle: impl AsyncFn(&mut Run) -> Result<(), E>,
    model: CycleModel,
) -> Result<LifeHistory, E> {
    let (scene, accuracy, dynamic) = (run.scene, run.accuracy, model != CycleModel::QuasiStatic);
    let (end, every) = (scene.life.cycles, scene.life.checkpoint_every);
    let lives = block_ends(end, accuracy.cycle_jump, every);
    let mut estimate = ErrorEstimate::new(every);
    let mut motions = None;
    if dynamic {
        let probe = run.probe(0).await?;
        motions = probe.rattles.then(SeveralMotions::default);
        estimate.add_probe(probe);
    }
    let mut measured = vec![measured_outputs(run, 0, motions.as_mut(), &mut estimate).await?];
    let mut wear = vec![vec![]; scene.outputs.len()];
    run.keep_bores(0);
    for block in lives.windows(2) {
        let (from, to) = (block[0], block[1]);
        let checkpoints: Vec<u32> = (from / every + 1..=to / every).map(|k| k * every).collect();
        let deepest = run.largest_depths();
        run.wear(from..to, &checkpoints, &mut wear)?;
        estimate.add_wear(run, from, &deepest);
        run.keep_bores(to);
        match model {
            CycleModel::Single => {}
            CycleModel::Dynamic if to == end => run.last_cycle().await?,
            CycleModel::Dynamic | CycleModel::QuasiStatic => next_cycle(run).await?,
        }
        measured.push(measured_outputs(run, to, motions.as_mut(), &mut estimate).await?);
        if model == CycleModel::Dynamic && motions.is_none() && is_probed(from..to, every, end) {
            estimate.add_probe(run.probe(to).await?);
        }
    }
    run.compare_bores();
    estimate.add_wear(run, end, &run.largest_depths());

    let cycles = scene.life.checkpoints();
    let measured = MeasuredLives { lives: &lives, outputs: &measured };
    let mut histories = Vec::with_capacity(scene.outputs.len());
    for (k, output) in scene.outputs.iter().enumerate() {
        histories.push(match output.kind {
            OutputKind::LargestWear { .. } => std::mem::take(&mut wear[k]),
            _ => at_checkpoints(&lives, &measured.of_output(k), &cycles),
        });
    }
    let errors = estimate.errors(scene, &histories, &measured, accuracy.largest_step);
    // An output of the wear is zero on the unworn bores, as is its measured value.
    Ok(LifeHistory { histories, errors, start: measured.outputs[0].clone() })
}

/// Outputs of the motion on the bores of `life` [cycles] `(outputs,)` [SI]: in the cycle just measured, or if there are several
/// `motions` their means over a cycle of each, whose spread is added to the `estimate`.
///
/// # Errors
/// [`SimulationFailure`] if a further cycle fails.
async fn measured_outputs(
    run: &mut Run<'_>,
    life: u32,
    motions: Option<&mut SeveralMotions>,
    estimate: &mut ErrorEstimate,
) -> Result<Vec<f64>, SimulationFailure> {
    let Some(motions) = motions else { return Ok(run.motion_outputs()) };
    let SeveralCycles { motion, spread } = motions.measure(run, life).await?;
    estimate.add_spread(spread);
    Ok(motion)
}
