//! The whole life after the settled first cycle: block after block of wear, with a measured cycle at the end of each.

use super::blocks::{at_checkpoints, block_ends};
use super::conditions::{mix_contacts, share_bores};
use super::error_estimate::ErrorEstimate;
use super::life_history::LifeHistory;
use super::longer_steps::LongerSteps;
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

    /// The same model without probes, if its cycles may be simulated with longer time steps (`longer_steps.rs`).
    fn without_probes(&self) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

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

/// Dynamic cycles.
#[derive(Debug, Clone, Copy)]
pub struct DynamicCycles {
    /// True if some are probed for their error.
    pub probed: bool,
}

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
        self.probed && block.is_none_or(|block| is_probed(block, &run.scene.life))
    }

    fn without_probes(&self) -> Option<Self> {
        Some(DynamicCycles { probed: false })
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
#[derive(Clone)]
pub struct ConditionLife<'a> {
    /// Lives at which a cycle was measured `(k,)` [cycles].
    lives: Vec<u32>,
    /// Outputs there `(k, outputs)` [SI].
    pub outputs: Vec<Vec<f64>>,
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

/// A life as far as it has been simulated.
#[derive(Clone)]
pub struct PartialLife<'a> {
    /// Its conditions, at least one.
    pub conditions: Vec<ConditionLife<'a>>,
    /// Probes and wear so far.
    pub estimate: ErrorEstimate,
    /// Values so far at the checkpoints of every output of the wear, empty for outputs of the motion `(outputs, m)` [m or m^3].
    wear: Vec<Vec<f64>>,
}

impl<'a> PartialLife<'a> {
    /// Starts a life with the settled first cycles of the `runs`, which have been measured.
    ///
    /// # Errors
    /// The first error of a cycle, of a probe or of a check of the model.
    async fn start<M: CycleModel>(runs: &mut [Run<'a>], model: &M) -> Result<Self, M::Error> {
        let scene = runs[0].scene;
        let mut estimate = ErrorEstimate::new(scene.life.checkpoint_every, runs.len());
        let starts = runs.iter_mut().zip(&mut estimate.conditions);
        let started = join(starts.map(|(run, estimate)| ConditionLife::start(run, model, estimate))).await;
        let conditions = started.into_iter().collect::<Result<_, _>>()?;
        runs[0].keep_bores(0);
        Ok(PartialLife { conditions, estimate, wear: vec![vec![]; scene.outputs.len()] })
    }

    /// Wears the bores of the `runs` over a `block` [cycles], and simulates the cycles at its end.
    ///
    /// # Errors
    /// The first error of the wear, of a cycle, of a probe or of a check of the model.
    pub(crate) async fn add_block<M: CycleModel>(
        &mut self,
        runs: &mut [Run<'a>],
        model: &M,
        block: &Range<u32>,
    ) -> Result<(), M::Error> {
        let every = runs[0].scene.life.checkpoint_every;
        let checkpoints: Vec<u32> =
            (block.start / every + 1..=block.end / every).map(|k| k * every).collect();
        let worn = runs[0].worn_amounts();
        for (run, estimate) in runs.iter().zip(&mut self.estimate.conditions) {
            estimate.add_block(run, block.end - block.start);
        }
        mix_contacts(runs);
        runs[0].wear(block.clone(), &checkpoints, &mut self.wear)?;
        runs[0].note_grooves(block.end);
        self.estimate.add_wear(&runs[0], block.start, &worn);
        runs[0].keep_bores(block.end);
        share_bores(runs);
        let conditions = runs.iter_mut().zip(&mut self.conditions).zip(&mut self.estimate.conditions);
        let cycles = conditions.map(|((run, life), estimate)| life.go_on(run, model, block, estimate));
        join(cycles).await.into_iter().collect()
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
    let end = scene.life.cycles;
    let ends = block_ends(end, accuracy.cycle_jump, scene.life.checkpoint_every);
    let mut life = PartialLife::start(runs, &model).await?;
    let mut longer = LongerSteps::tried(runs, &model, &mut life, &ends).await;
    let mut simulated = 0;
    while simulated + 1 < ends.len() {
        let block = ends[simulated]..ends[simulated + 1];
        match &mut longer {
            Some(steps) => {
                if let Some(lasted) = steps.add_block(runs, &mut life, &block).await {
                    simulated = ends.partition_point(|&end| end < lasted);
                    longer = None;
                    continue;
                }
            }
            None => life.add_block(runs, &model, &block).await?,
        }
        simulated += 1;
    }
    mix_contacts(runs);
    runs[0].compare_bores();
    let PartialLife { conditions: lives, mut estimate, wear } = life;
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
