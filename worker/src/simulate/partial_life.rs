//! A life as far as it has been simulated: its blocks of wear, and the cycles at their ends under every operating condition.

use super::conditions::{mix_contacts, share_bores};
use super::error_estimate::ErrorEstimate;
use super::island_state::IslandState;
use super::motion_estimate::{MeasuredLives, MotionEstimate};
use super::probe::Probe;
use super::several_cycles::SeveralMotions;
use super::{Run, Simulated, join};
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

    /// This model with cycles that are not probed, if its life may have longer time steps, which are checked in their own way
    /// (`longer_steps.rs`).
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
            run.repetition.is_irregular = probe.rattles;
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

    /// The outputs measured so far.
    pub(crate) fn measured(&self) -> MeasuredLives<'_> {
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
    pub wear: Vec<Vec<f64>>,
}

impl<'a> PartialLife<'a> {
    /// Starts a life with the settled first cycles of the `runs`, which have been measured.
    ///
    /// # Errors
    /// The first error of a cycle, of a probe or of a check of the model.
    pub(crate) async fn start<M: CycleModel>(runs: &mut [Run<'a>], model: &M) -> Result<Self, M::Error> {
        let scene = runs[0].scene;
        let mut estimate = ErrorEstimate::new(scene.life.checkpoint_every, runs.len());
        let starts = runs.iter_mut().zip(&mut estimate.conditions);
        let starts = starts.map(|(run, estimate)| {
            estimate.repetition = run.repetition.clone();
            (run, estimate)
        });
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
        runs[0].keep_bores(block.end);
        share_bores(runs);
        if runs[0].scene.simulator.is_none() {
            // Contacts that are no longer frozen take no memory while the next cycles are simulated.
            runs[0].islands.iter_mut().for_each(IslandState::wear_copies);
        }
        let conditions = runs.iter_mut().zip(&mut self.conditions).zip(&mut self.estimate.conditions);
        let cycles = conditions.map(|((run, life), estimate)| life.go_on(run, model, block, estimate));
        join(cycles).await.into_iter().collect::<Result<Vec<()>, _>>()?;
        // A model may have done so already, while it waited for its cycle.
        runs[0].islands.iter_mut().for_each(IslandState::wear_copies);
        self.estimate.add_wear(&runs[0], block.start, &worn);
        Ok(self.compare_finer(runs, block).await?)
    }
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
) -> Simulated<Vec<f64>> {
    let Some(motions) = motions else { return Ok(run.measured.clone()) };
    let (motion, spread) = motions.measure(run, life).await?;
    estimate.spreads.push(spread);
    Ok(motion)
}
