//! A probe of a measured cycle: the cycle after it on the same profile, with shorter time steps. Differences between the two are
//! due to the time steps or to motion that had not settled. A motion seen once is probed by its own cycle.
//!
//! With time steps shorter by the factor r = 1.75 a scheme of order 4 has 1 / r^4 = 1/9 of the error, so the difference of the two
//! cycles is 8/9 of the error of the measured one.
//!
//! # Source
//! Error estimation with two step lengths: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.4.
//!
//! # Finer cycles
//! Outputs of a measured cycle on surfaces with n, 2 n and 4 n control points, and the error that follows from them.
//!
//! With the values y1, y2 and y4 of an output on n, 2 n and 4 n points and r = |y4 - y2| / |y2 - y1| the stated error is
//!
//!   |y4 - y1| + r / (1 - r) |y4 - y2|              r < 3/4, what is left of a geometric series,
//!   2 max (|y2 - y1|, |y4 - y1|, |y4 - y2|)        else: the output does not converge with the points.
//!
//! Source:
//! Comparison of three grids: Roache, Verification and Validation in Computational Science and Engineering (1998), chapter 5.

use super::failures::wear_failure;
use super::island_state::{CycleTools, IslandState};
use super::{Run, Simulated};
use crate::mechanism::WearingPair;
use crate::wear::{NoEquilibrium, WearHistory, WearLaw, WearRate};
use common::accuracy::Accuracy;
use common::outputs::PointsError;
use common::scene::{Life, Output, Scene};
use std::ops::Range;

/// Factor by which the time steps of the further cycle are shorter [1]. At 1.5 the four-bar at 6 r/min still skips vibrations
/// that the measured cycle skipped too, and the difference shows a third of the error.
pub const FINER: f64 = 1.75;
/// Relative change of an output above which a motion counts as aperiodic [1]: the outputs of the flapping wing change by 0.01 %
/// from cycle to cycle, with a friction of 0.5 by up to 1 %.
const APERIODIC: f64 = 0.005;
/// That threshold for wear rates [1], which are noisy from control point to control point: 300 samples of the contact a cycle
/// change them by more than half a per cent.
const APERIODIC_WEAR: f64 = 0.02;
/// Largest number of further cycles of an aperiodic motion.
const MOST_CYCLES: usize = 3;

/// Factors of the damping that joints with a coefficient of restitution took from their last impact, one further cycle after the
/// other: 8 times, then an eighth [1]. A contact that begins anew in the cycle corrects it; one that lasts keeps the damping
/// of an impact during settling, which is arbitrary, and what depends on that is part of the error.
const DAMPING_FACTORS: [f64; 2] = [8.0, 1.0 / 64.0];

/// Surfaces of a joint: the bore, whose rates come first, and the journal.
pub const SURFACES: usize = 2;

/// Changes from the measured cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Life of the profile [cycles].
    pub life: u32,
    /// Largest change of every output of the motion `(outputs,)` [SI].
    pub motion: Vec<f64>,
    /// Largest relative change of the wear rate of every surface of every joint of the scene `(SURFACES joints,)` [1].
    pub wear: Vec<f64>,
    /// True if the motion does not repeat itself.
    pub aperiodic: bool,
    /// True if the wear rates of the second further cycle or a later one are not those of the cycle before; those of the first may
    /// differ where the motion had not settled.
    pub rattles: bool,
}

/// Outputs of the motion and wear rates of one cycle.
pub struct CycleValues {
    /// Outputs of the motion `(outputs,)` [SI].
    pub motion: Vec<f64>,
    /// Wear rates of every surface of every joint of the scene `(SURFACES joints, points)` [m per cycle].
    pub wear: Vec<Vec<f64>>,
}

impl Run<'_> {
    /// Simulates the cycle after the one just measured, on the profile of `life` [cycles], with time steps shorter by [`FINER`], and compares
    /// the two. The recording of contacts of the measured cycle is kept, not that of its motion.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the further cycle fails.
    pub(crate) async fn probe(&mut self, life: u32) -> Simulated<Probe> {
        self.probe_in_steps(life, &vec![self.accuracy.refined(FINER); self.islands.len()]).await
    }

    /// As [`Run::probe`], with the time steps of these accuracies `(islands,)`.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the further cycle fails.
    pub(crate) async fn probe_in_steps(&mut self, life: u32, steps: &[Accuracy]) -> Simulated<Probe> {
        let measured = self.measured_values(life)?;
        let own = self.present_steps();
        let mut tools = self.tools_for(steps);
        self.exchange_tools(&mut tools);
        let found = self.compare_further_cycles(life, &measured, &own).await;
        self.exchange_tools(&mut tools);
        found
    }

    /// Values of the cycle just measured, on the profile of `life` [cycles].
    ///
    /// # Errors
    /// [`SimulationFailure`] if a wear rate has no value.
    pub(super) fn measured_values(&mut self, life: u32) -> Simulated<CycleValues> {
        Ok(CycleValues { motion: self.measured.clone(), wear: self.wear_rates(life)? })
    }

    /// Values of the cycle after this one, on the profile of `life` [cycles].
    ///
    /// # Errors
    /// [`SimulationFailure`] if that cycle fails.
    pub(super) async fn measure_next(&mut self, life: u32) -> Simulated<CycleValues> {
        self.further_cycle().await?;
        let motion = self.motion_outputs();
        Ok(CycleValues { motion, wear: self.wear_rates(life)? })
    }

    /// Accuracies of the time steps that the islands have now `(islands,)`.
    pub(super) fn present_steps(&self) -> Vec<Accuracy> {
        let tolerances = self.islands.iter().map(|state| state.stepper.control.tolerance);
        tolerances.map(|step_tolerance| Accuracy { step_tolerance, ..*self.accuracy }).collect()
    }

    /// Tools for a cycle with the time steps of these accuracies `(islands,)`.
    pub(super) fn tools_for(&self, steps: &[Accuracy]) -> Vec<CycleTools> {
        let islands = self.islands.iter().zip(steps);
        islands.map(|(state, accuracy)| state.tools_for(self.scene.life.period, accuracy)).collect()
    }

    /// Exchanges the tools of all islands with these.
    pub(super) fn exchange_tools(&mut self, tools: &mut [CycleTools]) {
        self.islands.iter_mut().zip(tools).for_each(|(state, tools)| state.exchange_tools(tools));
    }

    /// Simulates further cycles and keeps the largest changes: one of a motion that repeats itself, up to [`MOST_CYCLES`] of others, and
    /// one for each damping factor. Of a motion seen once, the same cycle again, for each damping factor. The `measured` cycle had the time
    /// steps of `own`.
    async fn compare_further_cycles(
        &mut self,
        life: u32,
        measured: &CycleValues,
        own: &[Accuracy],
    ) -> Simulated<Probe> {
        let mut probe = Probe::unchanged(life, measured);
        let mut latest = measured.wear.clone();
        let (remembers, once) = (self.depends_on_last_impact(), self.scene.life.is_single_cycle());
        for cycle in 0..MOST_CYCLES {
            if once {
                self.islands.iter_mut().for_each(IslandState::restore_cycle_start);
            }
            if let Some(factor) = DAMPING_FACTORS.get(cycle).filter(|_| remembers) {
                let since_measured = || DAMPING_FACTORS[..=cycle].iter().product();
                self.scale_remembered_damping(if once { since_measured() } else { *factor });
            }
            let further = self.measure_next(life).await?;
            probe.rattles |= !once && cycle > 0 && is_other_wear(&further.wear, &latest);
            let aperiodic = probe.add_cycle(measured, &further);
            latest = further.wear;
            let factors_left = remembers && cycle + 1 < DAMPING_FACTORS.len();
            if probe.rattles || (once || aperiodic == 0) && !factors_left {
                break;
            }
            if cycle == 0 && !once && !remembers && self.repeats_itself(life, measured, own).await? {
                break;
            }
        }
        probe.aperiodic &= !once;
        Ok(probe)
    }

    /// True if a further cycle with the time steps of the `measured` one, `own`, has its values: what shorter steps changed is then due to
    /// their length, and more cycles with them would change the same.
    pub(super) async fn repeats_itself(
        &mut self,
        life: u32,
        measured: &CycleValues,
        own: &[Accuracy],
    ) -> Simulated<bool> {
        let mut tools = self.tools_for(own);
        self.exchange_tools(&mut tools);
        let again = self.measure_next(life).await;
        self.exchange_tools(&mut tools);
        Ok(Probe::unchanged(life, measured).add_cycle(measured, &again?) == 0)
    }

    /// True if the damping of a joint, or of a guide that wears, depends on the speed of its last impact.
    pub(crate) fn depends_on_last_impact(&self) -> bool {
        let mut joints = self.islands.iter().flat_map(|state| &state.island.joints);
        let mut guides = self.islands.iter().flat_map(|state| &state.island.guides);
        joints.any(|joint| joint.contact.surface().restitution.is_some())
            || guides.any(|guide| guide.wears() && guide.flat.restitution.is_some())
    }

    /// Multiplies the damping that such joints and guides took from their last impact.
    fn scale_remembered_damping(&mut self, factor: f64) {
        for joint in self.islands.iter_mut().flat_map(|state| &mut state.island.joints) {
            if joint.contact.surface().restitution.is_some() {
                let damping = joint.contact.surface().damping;
                joint.set_damping(factor * damping);
            }
        }
        for guide in self.islands.iter_mut().flat_map(|state| &mut state.island.guides) {
            if guide.wears() && guide.flat.restitution.is_some() {
                guide.flat.damping = guide.flat.damping.map(|damping| factor * damping);
            }
        }
    }

    /// Wear per cycle at every control point of every surface of every joint of the scene under the contact of the cycle recorded last;
    /// empty for a journal that does not wear, and for a joint that does not `(SURFACES joints, points)` [m per cycle].
    pub(crate) fn wear_rates(&mut self, cycle: u32) -> Simulated<Vec<Vec<f64>>> {
        let mut all = vec![Vec::new(); SURFACES * self.scene.joints.len()];
        for IslandState { island, recorder, rates, depth, .. } in &mut self.islands {
            for (k, pair) in island.pairs().enumerate().filter(|(_, pair)| pair.wears()) {
                let joint = &self.scene.joints[pair.scene_joint()];
                add_rates(pair, &mut rates[k], (&recorder.histories[k], &depth[k]), &mut all)
                    .map_err(|unbalanced| wear_failure(joint, cycle, unbalanced))?;
                rates[k].release();
            }
        }
        Ok(all)
    }
}

/// Puts the wear rates of a `pair` of surfaces worn to `depth` `(depths,)` [m], under this contact history, among those of `all` surfaces of all joints of
/// the scene `(SURFACES joints, points)` [m per cycle].
///
/// # Errors
/// [`NoEquilibrium`] as of [`WearLaw::rate`].
pub(super) fn add_rates(
    pair: &dyn WearingPair,
    rate: &mut WearRate,
    (history, depth): (&WearHistory, &[f64]),
    all: &mut [Vec<f64>],
) -> Result<(), NoEquilibrium> {
    let mut found = vec![0.0; depth.len()];
    rate.freeze(history);
    rate.rate(depth, &mut found)?;
    let second = found.split_off(pair.first_depths());
    all[SURFACES * pair.scene_joint()] = found;
    all[SURFACES * pair.scene_joint() + 1] = second;
    Ok(())
}

impl Probe {
    /// A probe of the `measured` cycle on the profile of `life` [cycles] that has found no change so far.
    pub(super) fn unchanged(life: u32, measured: &CycleValues) -> Self {
        let (motion, wear) = (vec![0.0; measured.motion.len()], vec![0.0; measured.wear.len()]);
        Probe { life, motion, wear, aperiodic: false, rattles: false }
    }

    /// Adds the changes of a further cycle. Returns how many of them are above the thresholds of an aperiodic motion.
    pub(super) fn add_cycle(&mut self, measured: &CycleValues, further: &CycleValues) -> usize {
        let mut above = 0;
        for ((largest, now), was) in self.motion.iter_mut().zip(&further.motion).zip(&measured.motion) {
            let change = (now - was).abs();
            *largest = largest.max(change);
            above += usize::from(change > APERIODIC * was.abs());
        }
        for ((largest, now), was) in self.wear.iter_mut().zip(&further.wear).zip(&measured.wear) {
            let change = relative_change(now, was);
            *largest = largest.max(change);
            above += usize::from(change > APERIODIC_WEAR);
        }
        self.aperiodic |= above > 0;
        above
    }
}

/// True if the wear rates `(surfaces, points)` of a surface are not those `before`.
fn is_other_wear(now: &[Vec<f64>], before: &[Vec<f64>]) -> bool {
    now.iter().zip(before).any(|(now, before)| relative_change(now, before) > APERIODIC_WEAR)
}

/// Relative change of the volume worn per cycle or of the largest rate, whichever is more, from `was` to `now` `(points,)` [1];
/// one if there was no wear before.
fn relative_change(now: &[f64], was: &[f64]) -> f64 {
    let volume = |rates: &[f64]| rates.iter().sum::<f64>();
    let largest = |rates: &[f64]| rates.iter().fold(0.0_f64, |a, &b| a.max(b));
    let change = |now: f64, was: f64| match (now, was) {
        (now, was) if now == was => 0.0,
        (_, was) if was > 0.0 => (now / was - 1.0).abs(),
        _ => 1.0,
    };
    change(volume(now), volume(was)).max(change(largest(now), largest(was)))
}

/// True if the cycle simulated at the end of this block of a life is probed: the first ones at or after two thirds of the life, and at
/// its end. With the trials and checks of longer steps (`longer_steps.rs`) they take 15 to 18 % of the time steps of the drive at
/// `balanced+jump-2000`.
pub(crate) fn is_probed(block: &Range<u32>, life: &Life) -> bool {
    let end = life.cycles;
    contains_one_of(block, [end / 3 * 2, end].map(|life| life.clamp(1, end)))
}

/// True if one of these `lives` is in `block`, beyond its start.
pub(crate) fn contains_one_of<const N: usize>(block: &Range<u32>, lives: [u32; N]) -> bool {
    lives.iter().any(|&life| block.start < life && life <= block.end)
}

/// Ratio of successive changes above which an output does not converge [1]: a spline through a scar with edges halves them.
const CONVERGES: f64 = 0.75;
/// Stated error over the largest change of such an output [1].
const SAFETY: f64 = 2.0;

/// Outputs of the motion of one cycle on surfaces with n, 2 n and 4 n control points.
#[derive(Debug, Clone, PartialEq)]
pub struct FinerCycles {
    /// Life of the surfaces [cycles].
    pub life: u32,
    /// The outputs `(3, outputs)` [SI].
    pub outputs: [Vec<f64>; 3],
}

impl FinerCycles {
    /// Estimated error of output `k` [SI], and whether it converges.
    pub(crate) fn error(&self, k: usize) -> (f64, bool) {
        let [own, twice, four_times] = &self.outputs;
        estimate([twice, four_times].map(|finer| finer[k] - own[k]))
    }
}

/// What more control points change in each output of the motion, at the one of the compared `lives` where that is most; empty without any.
pub(crate) fn points_errors(scene: &Scene, lives: &[FinerCycles]) -> Vec<PointsError> {
    let outputs = scene.outputs.iter().enumerate().filter(|(_, output)| output.kind.wear().is_none());
    let largest = |(k, output): (usize, &Output)| {
        let at = lives.iter().max_by(|a, b| a.error(k).0.total_cmp(&b.error(k).0))?;
        let (error, converges) = at.error(k);
        Some(PointsError {
            output: output.name.clone(),
            cycles: at.life,
            values: [0, 1, 2].map(|points: usize| at.outputs[points][k]),
            error,
            converges,
            stated: !scene.control_points_of_model,
        })
    };
    outputs.filter_map(largest).collect()
}

/// Error of a value that twice and four times the points change by these amounts, and whether it converges.
fn estimate([twice, four_times]: [f64; 2]) -> (f64, bool) {
    let (first, second) = (twice.abs(), (four_times - twice).abs());
    if second < CONVERGES * first {
        return (four_times.abs() + second * second / (first - second), true);
    }
    (SAFETY * first.max(second).max(four_times.abs()), second == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_worn_lives_are_probed_or_fewer() {
        let probed = |lives: &[u32], every: u32| -> Vec<u32> {
            let cycles = lives[lives.len() - 1];
            let life = Life { period: 1.0, cycles, checkpoint_every: every, settle_cycles: 1, turn_of: None };
            lives.windows(2).filter(|w| is_probed(&(w[0]..w[1]), &life)).map(|w| w[1]).collect()
        };
        assert_eq!(probed(&[0, 125, 250, 1000, 2000, 4000, 6000, 8000, 9000], 1000), [6000, 9000]);
        assert_eq!(probed(&[0, 1], 1), [1]);
    }

    #[test]
    fn change_is_that_of_the_volume_or_of_the_peak() {
        assert!((relative_change(&[2.0, 2.0], &[1.0, 3.0]) - 1.0 / 3.0).abs() < 1e-15);
        assert_eq!(relative_change(&[2.0, 6.0], &[1.0, 3.0]), 1.0);
        assert_eq!(relative_change(&[0.0], &[0.0]), 0.0);
        assert_eq!(relative_change(&[1.0], &[0.0]), 1.0);
        assert_eq!(relative_change(&[], &[]), 0.0);
    }
}

#[cfg(test)]
mod finer_cycles_tests {
    use super::*;

    #[test]
    fn changes_that_halve_state_their_limit_and_others_twice_the_largest() {
        // 1, 1/2, 1/4 ... add up to 2.
        assert_eq!(estimate([1.0, 1.5]), (2.0, true));
        assert_eq!(estimate([-1.0, -1.25]), (1.25 + 1.0 / 12.0, true));
        // The drive at 66 000 cycles: 24.58, 26.37 and 34.39 r/min.
        let (error, converges) = estimate([1.79, 9.81]);
        assert!((error - 19.62).abs() < 1e-12 && !converges);
        assert_eq!(estimate([0.0, 0.0]), (0.0, true));
        assert_eq!(estimate([0.0, 1.0]), (2.0, false));
    }
}
