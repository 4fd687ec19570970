//! The whole life after the settled first cycle: block after block of wear, with a measured cycle at the end of each.

use super::blocks::{at_checkpoints, block_ends};
use super::error_estimate::{ErrorEstimate, MeasuredLives};
use super::probe::{Probe, is_probed};
use super::run::Run;
use super::several_cycles::{SeveralCycles, SeveralMotions};
use common::failure::SimulationFailure;
use std::ops::Range;

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
pub trait CycleModel {
    /// Reason why a life under this model has no result.
    type Error: From<SimulationFailure>;

    /// Simulates the cycle at the end of `block`, on the bores worn so far. True if the motion was measured in a dynamic cycle.
    async fn simulate_cycle(&self, run: &mut Run<'_>, block: &Range<u32>) -> Result<bool, Self::Error>;

    /// True if a measured cycle is probed: that at the end of `block`, or without one that on the unworn bores.
    fn is_probed(&self, run: &Run, block: Option<&Range<u32>>) -> bool;

    /// Checks that the model may stay in use, where a probe has been made.
    fn check_probe(&self, probe: &Probe) -> Result<(), Self::Error> {
        let _ = probe;
        Ok(())
    }

    /// Checks the same at the end of life, with the outputs `measured`, and completes the estimate of the error.
    fn check_life(
        &self,
        run: &Run,
        measured: &MeasuredLives,
        estimate: &mut ErrorEstimate,
    ) -> Result<(), Self::Error> {
        let _ = (run, measured, estimate);
        Ok(())
    }
}

/// Dynamic cycles, some of which are probed for their error.
#[derive(Debug, Clone, Copy)]
pub struct DynamicCycles;

impl CycleModel for DynamicCycles {
    type Error = SimulationFailure;

    async fn simulate_cycle(&self, run: &mut Run<'_>, block: &Range<u32>) -> Result<bool, SimulationFailure> {
        if block.end == run.scene.life.cycles {
            run.last_cycle().await?
        } else {
            run.next_cycle().await?
        }
        Ok(true)
    }

    fn is_probed(&self, run: &Run, block: Option<&Range<u32>>) -> bool {
        block.is_none_or(|block| is_probed(block, &run.scene.life))
    }
}

/// No cycle but the one measured, which is the whole life.
#[derive(Debug, Clone, Copy)]
pub struct SingleCycle;

impl CycleModel for SingleCycle {
    type Error = SimulationFailure;

    async fn simulate_cycle(
        &self,
        _run: &mut Run<'_>,
        _block: &Range<u32>,
    ) -> Result<bool, SimulationFailure> {
        Ok(true)
    }

    fn is_probed(&self, _run: &Run, block: Option<&Range<u32>>) -> bool {
        block.is_none()
    }
}

/// Wears the bores to the end of life under cycles of `model`.
///
/// # Errors
/// The first error of the wear, of a cycle, of a probe or of a check of the model.
pub(crate) async fn simulate_life<M: CycleModel>(
    run: &mut Run<'_>,
    model: M,
) -> Result<LifeHistory, M::Error> {
    let (scene, accuracy) = (run.scene, run.accuracy);
    let (end, every) = (scene.life.cycles, scene.life.checkpoint_every);
    let lives = block_ends(end, accuracy.cycle_jump, every);
    let mut estimate = ErrorEstimate::new(every);
    let mut motions = None;
    if model.is_probed(run, None) {
        let probe = run.probe(0).await?;
        model.check_probe(&probe)?;
        motions = probe.rattles.then(SeveralMotions::default);
        estimate.add_probe(probe);
    }
    let mut measured_lives = vec![0];
    let mut measured = vec![measured_outputs(run, 0, motions.as_mut(), &mut estimate).await?];
    let mut wear = vec![vec![]; scene.outputs.len()];
    run.keep_bores(0);
    for (from, to) in lives.windows(2).map(|life| (life[0], life[1])) {
        let checkpoints: Vec<u32> = (from / every + 1..=to / every).map(|k| k * every).collect();
        let worn = run.worn_amounts();
        run.wear(from..to, &checkpoints, &mut wear)?;
        estimate.add_wear(run, from, &worn);
        run.keep_bores(to);
        if !model.simulate_cycle(run, &(from..to)).await? {
            continue;
        }
        measured_lives.push(to);
        measured.push(measured_outputs(run, to, motions.as_mut(), &mut estimate).await?);
        if motions.is_none() && model.is_probed(run, Some(&(from..to))) {
            let probe = run.probe(to).await?;
            model.check_probe(&probe)?;
            estimate.add_probe(probe);
        }
    }
    run.compare_bores();
    estimate.add_wear(run, end, &run.worn_amounts());

    let cycles = scene.life.checkpoints();
    let measured = MeasuredLives { lives: &measured_lives, outputs: &measured };
    model.check_life(run, &measured, &mut estimate)?;
    let mut histories = Vec::with_capacity(scene.outputs.len());
    for (k, output) in scene.outputs.iter().enumerate() {
        histories.push(match output.kind.wear() {
            Some(_) => std::mem::take(&mut wear[k]),
            None => at_checkpoints(measured.lives, &measured.of_output(k), &cycles),
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
