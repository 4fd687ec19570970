//! The whole life after the settled first cycle: block after block of wear, with a measured cycle at the end of each.
//!
//! # Without wear
//! Scenes in which nothing wears: the outputs of one cycle are those of the whole life.
//!
//! The error follows from a second run of the cycle with time steps shorter by a factor r = 2 (Richardson): a scheme of order
//! p = 4 has the error |y - y_r| / (1 - r^-p) = 16/15 |y - y_r|, which is doubled for safety.
//!
//! Source:
//! Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I (1993), section II.4 (Richardson extrapolation).

use super::blocks::{at_checkpoints, simulated_lives};
use super::conditions::mix_contacts;
use super::longer_steps::LongerSteps;
use super::partial_life::{CycleModel, PartialLife};
use super::probe::{is_probed, points_errors};
use super::{LifeHistory, Run, Simulated};
use common::failure::SimulationFailure;
use std::ops::Range;

/// Cycles of the equations of motion, whose forces are integrated step by step; of a life of a single cycle the one measured first is all.
#[derive(Debug, Clone, Copy)]
pub struct DynamicCycles {
    /// True if some are probed for their error.
    pub probed: bool,
}

impl CycleModel for DynamicCycles {
    type Error = SimulationFailure;

    async fn simulate_cycle(&self, run: &mut Run<'_>, block: &Range<u32>) -> Simulated<bool> {
        if run.scene.life.is_single_cycle() {
            return Ok(true);
        }
        if block.end == run.scene.life.cycles {
            run.last_cycle().await?
        } else {
            run.next_settled_cycle().await?
        }
        Ok(true)
    }

    fn is_probed(&self, run: &Run, block: Option<&Range<u32>>) -> bool {
        let life = &run.scene.life;
        self.probed && block.is_none_or(|block| !life.is_single_cycle() && is_probed(block, life))
    }

    fn without_probes(&self) -> Option<Self> {
        Some(DynamicCycles { probed: false })
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
    let ends = simulated_lives(scene, accuracy);
    let (mut life, mut longer) = LongerSteps::start(runs, &model, &ends).await?;
    let mut simulated = 0;
    while simulated + 1 < ends.len() {
        longer = longer.filter(LongerSteps::are_in_use);
        let lasted = match &mut longer {
            Some(steps) => steps.add_block(runs, &mut life, &ends[simulated..]).await,
            None => {
                let block = ends[simulated]..ends[simulated + 1];
                life.add_block(runs, &model, &block).await?;
                block.end
            }
        };
        simulated = ends.partition_point(|&end| end < lasted);
    }
    mix_contacts(runs);
    runs[0].compare_bores();
    let PartialLife { conditions: lives, mut estimate, wear } = life;
    estimate.add_wear(&runs[0], end, &runs[0].worn_amounts());

    for ((run, life), estimate) in runs.iter().zip(&lives).zip(&mut estimate.conditions) {
        model.check_life(run, &life.measured(), estimate)?;
    }
    for (run, estimate) in runs.iter_mut().zip(&estimate.conditions) {
        run.points_errors = points_errors(scene, &estimate.finer);
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

/// Factor by which the time steps of the second run are shorter [1].
const FINER: f64 = 2.0;
/// Stated error over the difference of the two runs [1].
const SAFETY: f64 = 2.0;
/// Lower bound of the relative error of a value: rounding of some million steps [1].
const ROUNDING: f64 = 1e-10;

impl Run<'_> {
    /// Runs the cycle just measured a second time with shorter time steps, and returns the life that it stands for.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the second run fails.
    pub(crate) async fn life_without_wear(&mut self) -> Simulated<LifeHistory> {
        let values = self.measured.clone();
        let finer = self.accuracy.refined(FINER);
        self.restart_cycle(&finer);
        let to_come = self.repetition.to_come.clone();
        let to_come = |k: usize| to_come.as_ref().map_or(0.0, |(motion, _)| motion[k]);
        self.measure().await?;
        let again = self.measured.clone();
        let count = self.scene.life.checkpoints().len();
        let error = |value: f64, again: f64| (SAFETY * (value - again).abs()).max(ROUNDING * value.abs());
        let errors = values.iter().zip(again).enumerate();
        let errors = errors.map(|(k, (&v, a))| vec![to_come(k) + error(v, a); count]).collect();
        let histories = values.iter().map(|&v| vec![v; count]).collect();
        Ok(LifeHistory { histories, errors, start: values })
    }
}
