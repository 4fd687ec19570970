//! The whole life after the settled first cycle: block after block of wear, with a measured cycle at the end of each.

use super::blocks::{at_checkpoints, block_ends};
use super::conditions::{mix_contacts, share_bores};
use super::error_estimate::ErrorEstimate;
use super::life_history::LifeHistory;
use super::motion_estimate::{MeasuredLives, MotionEstimate};
use super::probe::{Probe, is_probed};
use super::run::Run;
use super::several_cycles::{SeveralCycles, SeveralMotions};
use super::side_by_side::join;
use common::failure::SimulationFailure;
use std::ops::Range;

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
        estimate: &mut MotionEstimate,
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

/// One condition of a life: the outputs measured so far, and the motions if they are several.
struct ConditionLife<'a> {
    /// Lives at which a cycle was measured `(k,)` [cycles].
    lives: Vec<u32>,
    /// Outputs there `(k, outputs)` [SI].
    outputs: Vec<Vec<f64>>,
    motions: Option<SeveralMotions<'a>>,
}

impl<'a> ConditionLife<'a> {
    /// Starts a life with the settled first cycle of `run`, which has been measured.
    ///
    /// # Errors
    /// The first error of a cycle, of a probe or of a check of the model.
    async fn start<M: CycleModel>(
        run: &mut Run<'a>,
        model: &M,
        estimate: &mut MotionEstimate,
    ) -> Result<Self, M::Error> {
        let mut motions = None;
        if model.is_probed(run, None) {
            let probe = run.probe(0).await?;
            model.check_probe(&probe)?;
            motions = probe.rattles.then(SeveralMotions::default);
            estimate.add_probe(probe);
        }
        let outputs = vec![mean_outputs(run, 0, motions.as_mut(), estimate).await?];
        Ok(ConditionLife { lives: vec![0], outputs, motions })
    }

    /// Simulates, and where the model asks for it measures and probes, the cycle at the end of `block` [cycles].
    ///
    /// # Errors
    /// The first error of a cycle, of a probe or of a check of the model.
    async fn go_on<M: CycleModel>(
        &mut self,
        run: &mut Run<'a>,
        model: &M,
        block: &Range<u32>,
        estimate: &mut MotionEstimate,
    ) -> Result<(), M::Error> {
        if !model.simulate_cycle(run, block).await? {
            return Ok(());
        }
        self.lives.push(block.end);
        self.outputs.push(mean_outputs(run, block.end, self.motions.as_mut(), estimate).await?);
        if self.motions.is_none() && model.is_probed(run, Some(block)) {
            let probe = run.probe(block.end).await?;
            model.check_probe(&probe)?;
            estimate.add_probe(probe);
        }
        Ok(())
    }

    fn measured(&self) -> MeasuredLives<'_> {
        MeasuredLives { lives: &self.lives, outputs: &self.outputs }
    }
}

/// Wears the bores to the end of life under cycles of `model`. The `runs` are those of all operating conditions, at least one, on the
/// same bores; the first one wears them under the contacts of all.
///
/// # Errors
/// The first error of the wear, of a cycle, of a probe or of a check of the model.
pub(crate) async fn simulate_life<M: CycleModel>(
    runs: &mut [Run<'_>],
    model: M,
) -> Result<LifeHistory, M::Error> {
    let (scene, accuracy) = (runs[0].scene, runs[0].accuracy);
    let (end, every) = (scene.life.cycles, scene.life.checkpoint_every);
    let blocks = block_ends(end, accuracy.cycle_jump, every);
    let mut estimate = ErrorEstimate::new(every, runs.len());
    let starts = runs.iter_mut().zip(&mut estimate.conditions);
    let started = join(starts.map(|(run, estimate)| ConditionLife::start(run, &model, estimate))).await;
    let mut lives: Vec<ConditionLife> = started.into_iter().collect::<Result<_, _>>()?;
    let mut wear = vec![vec![]; scene.outputs.len()];
    runs[0].keep_bores(0);
    for (from, to) in blocks.windows(2).map(|life| (life[0], life[1])) {
        let checkpoints: Vec<u32> = (from / every + 1..=to / every).map(|k| k * every).collect();
        let worn = runs[0].worn_amounts();
        for (run, estimate) in runs.iter().zip(&mut estimate.conditions) {
            estimate.add_block(run, to - from);
        }
        mix_contacts(runs);
        runs[0].wear(from..to, &checkpoints, &mut wear)?;
        runs[0].note_grooves(to);
        estimate.add_wear(&runs[0], from, &worn);
        runs[0].keep_bores(to);
        share_bores(runs);
        let block = from..to;
        let conditions = runs.iter_mut().zip(&mut lives).zip(&mut estimate.conditions);
        let cycles = conditions.map(|((run, life), estimate)| life.go_on(run, &model, &block, estimate));
        join(cycles).await.into_iter().collect::<Result<(), _>>()?;
    }
    mix_contacts(runs);
    runs[0].compare_bores();
    estimate.add_wear(&runs[0], end, &runs[0].worn_amounts());

    for ((run, life), estimate) in runs.iter().zip(&lives).zip(&mut estimate.conditions) {
        model.check_life(run, &life.measured(), estimate)?;
    }
    let cycles = scene.life.checkpoints();
    let mut found = Vec::with_capacity(lives.len());
    for (condition, life) in lives.iter().enumerate() {
        let measured = life.measured();
        let outputs = scene.outputs.iter().enumerate();
        let histories: Vec<Vec<f64>> = outputs
            .map(|(k, output)| match output.kind.wear() {
                Some(_) => wear[k].clone(),
                None => at_checkpoints(measured.lives, &measured.of_output(k), &cycles),
            })
            .collect();
        let errors = estimate.errors(condition, scene, &histories, &measured, accuracy.largest_step);
        // An output of the wear is zero on the unworn bores, as is its measured value.
        found.push(LifeHistory { histories, errors, start: measured.outputs[0].clone() });
    }
    Ok(LifeHistory::worst(found, scene))
}

/// Outputs of the motion on the bores of `life` [cycles] `(outputs,)` [SI]: those of the cycle measured last, or if there are several
/// `motions` their means over a cycle of each, whose spread is added to the `estimate`.
///
/// # Errors
/// [`SimulationFailure`] if a further cycle fails.
async fn mean_outputs<'a>(
    run: &mut Run<'a>,
    life: u32,
    motions: Option<&mut SeveralMotions<'a>>,
    estimate: &mut MotionEstimate,
) -> Result<Vec<f64>, SimulationFailure> {
    let Some(motions) = motions else { return Ok(run.measured.clone()) };
    let SeveralCycles { motion, spread } = motions.measure(run, life).await?;
    estimate.add_spread(spread);
    Ok(motion)
}
