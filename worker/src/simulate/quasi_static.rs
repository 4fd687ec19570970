//! A life whose wear is driven by the quasi-static model, compared with the dynamics on the unworn bores and on those at the
//! end of life.
//!
//! Outputs of the motion come from dynamic cycles at a few lives, on the bores worn so far, where the wear rates are compared too.
//! That needs a contact law that conserves energy: under another one vibrations may grow as the bores wear, from one cycle to the next.

use super::island_state::kept_time;
use super::motion_estimate::{MeasuredLives, MotionEstimate, largest_bend};
use super::partial_life::CycleModel;
use super::probe::{Probe, SURFACES, add_rates, contains_one_of, is_probed};
use super::quasi_static_island::QuasiStaticIsland;
use super::{LifeHistory, Run, simulate_life};
use crate::contact::Contact;
use crate::integrate::StepCounts;
use crate::mechanism::ideal_cycle;
use crate::quasi_static::{Unsuitable, ideal_motions, wear_rate_difference};
use common::accuracy::Tier;
use common::scene::{Life, Output};
use std::ops::Range;

/// Intervals of the tabulated ideal motion; twice as many change the wear of the built-in scenes by less than
/// 1e-4.
const IDEAL_INTERVALS: usize = 90;

/// Share of the tolerance of the wear by which outputs of the motion may be off from straight lines between the lives at which they are
/// measured [1].
const STRAIGHT: f64 = 0.25;

/// The whole life under the quasi-static model, if the accuracy and the outputs of the scene allow it and all
/// comparisons with the dynamics agree under every operating condition; else `None`, and of the `runs` only the counts have changed.
pub(crate) async fn try_quasi_static(runs: &mut [Run<'_>]) -> Option<LifeHistory> {
    let mut trials = runs.to_vec();
    match simulate_quasi_static_life(&mut trials).await {
        Ok(life) => {
            runs.clone_from_slice(&trials);
            Some(life)
        }
        Err(reason) => {
            tracing::debug!("the dynamics drives the wear: {reason}");
            runs.iter_mut().zip(&trials).for_each(|(run, trial)| run.copy_counts(trial));
            None
        }
    }
}

/// The whole life under the quasi-static model, from the settled first cycles just measured.
///
/// # Errors
/// [`Unsuitable`] if the dynamics has to drive the wear instead.
async fn simulate_quasi_static_life(runs: &mut [Run<'_>]) -> Result<LifeHistory, Unsuitable> {
    runs.iter_mut().try_for_each(Run::start_quasi_static)?;
    let mut life = simulate_life(runs, QuasiStaticCycles).await?;
    for (k, (errors, values)) in life.errors.iter_mut().zip(&life.histories).enumerate() {
        let share = runs.iter().map(|run| run.tier_difference[k]).fold(0.0, f64::max);
        errors.iter_mut().zip(values).for_each(|(error, value)| *error += share * value.abs());
    }
    Ok(life)
}

/// True if outputs of the motion are measured at the end of this block: the first one at or after the first checkpoint and after every
/// sixth of the life, and at the lives that are probed.
pub(crate) fn is_measured(block: &Range<u32>, life: &Life) -> bool {
    let first = life.checkpoint_every.clamp(1, life.cycles);
    is_probed(block, life)
        || contains_one_of(block, [first])
        || contains_one_of(block, [1, 2, 3, 5].map(|sixth| life.cycles / 6 * sixth))
}

/// Quasi-static cycles, and dynamic ones at the end of life and, if outputs of the motion are asked for, at some lives before; those
/// are probed.
struct QuasiStaticCycles;

impl CycleModel for QuasiStaticCycles {
    type Error = Unsuitable;

    async fn simulate_cycle(&self, run: &mut Run<'_>, block: &Range<u32>) -> Result<bool, Unsuitable> {
        run.quasi_static_cycle()?;
        // A dynamic cycle begins with the state that the gaps have reached.
        if block.end == run.scene.life.cycles {
            run.last_cycle().await?;
        } else if run.first_motion_output().is_some() && is_measured(block, &run.scene.life) {
            run.next_settled_cycle().await?;
        } else {
            return Ok(false);
        }
        run.check_against_dynamics()?;
        Ok(true)
    }

    fn is_probed(&self, run: &Run, block: Option<&Range<u32>>) -> bool {
        run.first_motion_output().is_some() && block.is_none_or(|block| is_probed(block, &run.scene.life))
    }

    /// Outputs that change from cycle to cycle have to be measured after every block.
    fn check_probe(&self, probe: &Probe) -> Result<(), Unsuitable> {
        if probe.aperiodic { Err(Unsuitable::Aperiodic) } else { Ok(()) }
    }

    /// Outputs have to be close to straight lines between the lives at which they are measured.
    fn check_life(
        &self,
        run: &Run,
        measured: &MeasuredLives,
        estimate: &mut MotionEstimate,
    ) -> Result<(), Unsuitable> {
        for (k, output) in run.scene.outputs.iter().enumerate() {
            let values = measured.of_output(k);
            let largest = values.iter().fold(0.0_f64, |a, value| a.max(value.abs()));
            let off = largest_bend(measured.lives, &values);
            if off > STRAIGHT * run.accuracy.wear_tolerance * largest {
                return Err(Unsuitable::Curved { output: output.name.clone(), share: off / largest });
            }
        }
        estimate.quasi_static = Some(run.largest_tier_difference());
        Ok(())
    }
}

impl Run<'_> {
    /// Starts the quasi-static model and compares it with the settled first cycle just measured, on the unworn bores.
    pub(crate) fn start_quasi_static(&mut self) -> Result<(), Unsuitable> {
        if self.accuracy.tier == Tier::Dynamic {
            return Err(Unsuitable::Unwanted);
        }
        self.assemble_quasi_static()?;
        self.quasi_static_cycle()?;
        self.check_against_dynamics()
    }

    /// Largest relative difference of the quasi-static wear rates from those of the dynamics found so far [1].
    pub(crate) fn largest_tier_difference(&self) -> f64 {
        self.tier_difference.iter().copied().fold(0.0, f64::max)
    }

    /// The first output of the scene that is not wear.
    pub(crate) fn first_motion_output(&self) -> Option<&Output> {
        self.scene.outputs.iter().find(|output| output.kind.wear().is_none())
    }

    /// True if the elastic forces of all joints with clearance have a potential, whatever the bore.
    fn conserves_energy(&self) -> bool {
        let mut joints = self.islands.iter().flat_map(|state| &state.island.joints);
        joints.all(|joint| matches!(joint.contact, Contact::Foundation(_)))
    }

    /// Puts every island on its ideal motion, with closed joints.
    fn assemble_quasi_static(&mut self) -> Result<(), Unsuitable> {
        if let Some(output) = self.first_motion_output().filter(|_| !self.conserves_energy()) {
            return Err(Unsuitable::Output(output.name.clone()));
        }
        let poses = ideal_cycle(self.scene, IDEAL_INTERVALS + 1, &mut self.newton)?;
        if poses.len() < 2 {
            return Err(Unsuitable::Undetermined);
        }
        let islands: Vec<_> = self.islands.iter().map(|state| &state.island).collect();
        let motions = ideal_motions(self.scene, &islands, &poses)?.into_iter().zip(islands);
        self.quasi_static = motions
            .map(|(ideal, island)| QuasiStaticIsland::new(ideal, island, self.scene, self.accuracy))
            .collect();
        Ok(())
    }

    /// One quasi-static cycle of every island on the bores as they are.
    ///
    /// # Errors
    /// [`Unsuitable`] if the gaps cannot be integrated.
    pub(crate) fn quasi_static_cycle(&mut self) -> Result<(), Unsuitable> {
        let (kept, period) = (kept_time(self.scene, self.accuracy), self.scene.life.period);
        let mut counts = StepCounts::default();
        let mut islands = self.islands.iter_mut().zip(&mut self.quasi_static);
        let done =
            islands.try_for_each(|(state, island)| island.run_cycle(state, (kept, period), &mut counts));
        self.counts.add(&counts);
        // Each evaluation of the force is one iteration of Newton's method.
        self.newton += counts.forces;
        self.simulated += 1;
        done
    }

    /// Compares the wear rates of the two cycles recorded last, quasi-static and dynamic, on the bores as they are, and keeps the
    /// largest difference of each output.
    ///
    /// # Errors
    /// [`Unsuitable::Disagrees`] if the rates of an output differ by more than the tolerance of the wear.
    fn check_against_dynamics(&mut self) -> Result<(), Unsuitable> {
        let none = || vec![vec![]; SURFACES * self.scene.joints.len()];
        let (mut quasi_static, mut dynamic) = (none(), none());
        for (state, island) in self.islands.iter_mut().zip(&self.quasi_static) {
            for (k, pair) in state.island.pairs().enumerate() {
                for (rates, recorder) in
                    [(&mut quasi_static, &island.recorder), (&mut dynamic, &state.recorder)]
                {
                    let measured = (&recorder.histories[k], &state.depth[k][..]);
                    add_rates(pair, &mut state.rates[k], measured, rates)
                        .map_err(|_| Unsuitable::Disagrees(f64::INFINITY))?;
                }
            }
        }
        for (output, largest) in self.scene.outputs.iter().zip(&mut self.tier_difference) {
            if let Some((_, joints)) = output.kind.wear() {
                let surfaces: Vec<usize> =
                    joints.iter().flat_map(|joint| [0, 1].map(|k| SURFACES * joint + k)).collect();
                let share = wear_rate_difference(&quasi_static, &dynamic, &surfaces);
                if share > self.accuracy.wear_tolerance {
                    return Err(Unsuitable::Disagrees(share));
                }
                *largest = largest.max(share);
            }
        }
        Ok(())
    }
}
