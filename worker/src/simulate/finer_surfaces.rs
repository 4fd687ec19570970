//! What more control points change in the outputs of the motion: the measured cycle again on surfaces worn beside its own with twice and with
//! four times the points.
//!
//! The two surfaces have worn under the contacts of the same cycles (`wear/finer_bore.rs`); the cycle on them starts where the measured
//! one did. The error that follows from the outputs of the three: `probe.rs`.
//!
//! The cycles are compared where others are probed (`probe.rs`), and before where an output has moved.

use super::conditions::mix_contacts;
use super::motion_estimate::MeasuredLives;
use super::partial_life::{ConditionLife, PartialLife};
use super::probe::{FinerCycles, is_probed};
use super::quasi_static_island::wear_histories;
use super::{Run, Simulated, join};
use crate::wear::step_tolerance;
use common::scene::Life;
use std::ops::Range;

/// Relative change of an output since the last comparison after which there is another one [1].
const MOVED: f64 = 5e-3;
/// Least share of the life between two such comparisons [1].
const APART: u32 = 16;

/// Depths of all pairs of surfaces `(islands, pairs, depths)` [m].
type Depths = Vec<Vec<Vec<f64>>>;

impl<'a> PartialLife<'a> {
    /// Compares the cycles measured at the end of this `block` with those on finer surfaces, where that is due.
    ///
    /// # Errors
    /// [`SimulationFailure`] if one of these cycles fails.
    pub(crate) async fn compare_finer(&mut self, runs: &mut [Run<'a>], block: &Range<u32>) -> Simulated<()> {
        if runs[0].islands.iter().all(|state| state.finest.is_empty())
            || !self.is_due(&runs[0].scene.life, block)
        {
            return Ok(());
        }
        mix_contacts(runs);
        let [Some(twice), Some(four_times)] = [false, true].map(|finest| runs[0].finer_depths(finest)) else {
            return Ok(());
        };
        let depths = [twice, four_times];
        let cycles = join(runs.iter_mut().map(|run| run.finer_cycles(block.end, &depths))).await;
        for (cycles, estimate) in cycles.into_iter().zip(&mut self.estimate.conditions) {
            estimate.finer.push(cycles?);
        }
        Ok(())
    }

    /// True if cycles have been measured at the end of this `block` of motions that repeat themselves, and it is one of those that are probed, or
    /// an output has moved since the last comparison.
    fn is_due(&self, life: &Life, block: &Range<u32>) -> bool {
        let conditions =
            || self.conditions.iter().map(ConditionLife::measured).zip(&self.estimate.conditions);
        if conditions().any(|(now, of)| of.has_several_motions() || now.lives.last() != Some(&block.end)) {
            return false;
        }
        let last = self.estimate.conditions[0].finer.last().map_or(0, |cycles| cycles.life);
        let is_apart = block.end - last >= life.cycles / APART;
        is_probed(block, life) || is_apart && conditions().any(|(now, of)| has_moved(&now, of.finer.last()))
    }
}

/// True if an output has moved by [`MOVED`] since the `last` comparison, or since the unworn surfaces.
fn has_moved(now: &MeasuredLives, last: Option<&FinerCycles>) -> bool {
    let (Some(values), Some(unworn)) = (now.outputs.last(), now.outputs.first()) else { return false };
    let before = last.map_or(unworn, |cycles| &cycles.outputs[0]);
    values.iter().zip(before).any(|(now, before)| (now - before).abs() > MOVED * before.abs())
}

impl Run<'_> {
    /// Wears no copies: the stated errors leave out what they would show.
    pub(crate) fn leave_out_copies(&mut self) {
        self.islands.iter_mut().for_each(|state| state.finer.clear());
    }

    /// Wears the copies on which the motion is compared, if outputs depend on it and a joint wears.
    pub(crate) fn start_comparing_finer(&mut self) {
        if self.first_motion_output().is_some() && self.wears() && !self.scene.life.is_single_cycle() {
            let tolerance = step_tolerance(&self.scene.wear, self.accuracy.wear_tolerance);
            self.islands.iter_mut().for_each(|state| state.add_finest(tolerance));
        }
    }

    /// Depths of all pairs on twice or, if `finest`, four times the control points, worn as long as this run's own; `None` if the wear steps fail.
    fn finer_depths(&self, finest: bool) -> Option<Depths> {
        let islands = self.islands.iter().enumerate().map(|(index, state)| {
            let histories = wear_histories(&self.mixed, &self.quasi_static, &state.recorder, index);
            let copies = if finest { &state.finest } else { &state.finer };
            let pairs = state.island.pairs().zip(copies).zip(histories);
            let depths = pairs.map(|((pair, copy), history)| match pair.wears() {
                true => copy.depth_at_end(history),
                false => Some(vec![]),
            });
            depths.collect()
        });
        islands.collect()
    }

    /// Outputs of the cycle just measured, and of that on surfaces with twice and with four times the control points, worn to these `depths`
    /// at `life` [cycles].
    async fn finer_cycles(&mut self, life: u32, depths: &[Depths; 2]) -> Simulated<FinerCycles> {
        let own = self.measured.clone();
        let twice = self.outputs_on_finer(1, &depths[0]).await?;
        let four_times = self.outputs_on_finer(2, &depths[1]).await?;
        Ok(FinerCycles { life, outputs: [own, twice, four_times] })
    }

    /// Outputs of the cycle just measured, on surfaces with 2^`times` times the control points, worn to `depths`.
    async fn outputs_on_finer(&mut self, times: u32, depths: &Depths) -> Simulated<Vec<f64>> {
        let mut finer = self.clone();
        finer.begin_count();
        let (period, samples) = (self.scene.life.period, self.accuracy.wear_samples);
        for (state, depths) in finer.islands.iter_mut().zip(depths) {
            state.recorder.full = None;
            let histories = state.recorder.histories.iter_mut();
            for ((pair, depth), history) in state.island.pairs_mut().zip(depths).zip(histories) {
                if pair.wears() && pair.refine(times) {
                    pair.set_depth(depth);
                    *history = pair.empty_history(period, samples);
                }
            }
        }
        if self.accuracy.warm_up > 0.0 {
            finer.next_cycle().await?;
        } else {
            for state in &mut finer.islands {
                state.restore_cycle_start();
                state.stepper.control.after_jump();
            }
            finer.measure().await?;
        }
        finer.measure_after_transient().await?;
        self.add_counts(&finer);
        Ok(finer.measured)
    }
}
