//! Longer time steps in the cycles of a life, as long as they make no difference.
//!
//! The vibration of the contacts sets the length of the time steps throughout a cycle (`progress.rs`), and it matters only where its damping
//! is low: late in the life of the flapping-wing drive, where the worn bores feed it. Before, longer steps change neither the wear
//! nor the outputs by a thousandth. Steps 2.5 times as long would be too long: with them the scheme itself feeds the vibration.
//!
//! A life starts with its own steps. On the unworn bores the cycle after the measured one has steps longer by [`FINER`], or as much longer
//! as [`LARGEST_TOLERANCE`] permits (by 1.26 for `draft`). The islands whose longer steps change no output y of the motion and no wear rate w
//! by more than
//!
//!   |dy| <= 0.002 |y|,   |dw| <= 0.005 w
//!
//! have the longer steps in the cycles after it (`compared_islands.rs`): of the two wings of the drive one vibrates late in life, the other never.
//! Some of these cycles are checked: the cycle after such a one, on the same bores, has steps of the life's own and is compared with it, as in
//! a [`Probe`]. Checked are
//!
//! - the cycles that are probed otherwise, but for that at two thirds of the life if fewer than [`FEWEST_BLOCKS_LEFT`] blocks lie between it
//!   and the check before. At the end of life islands with steps of their own are probed in the same cycle;
//! - those whose outputs have moved by [`MOVED`] since the last check on account of an island with longer steps;
//! - those whose outputs have moved by [`FASTER`] in the last block, [`ACCELERATED`] times as fast as up to it: a vibration grows.
//!
//! Where the two cycles differ by more than the bounds above, the life returns to the check before, and the islands that make the difference
//! have their own steps from there to its end; all islands, if a cycle fails. (To keep the cycles in between, whose outputs have hardly moved,
//! was tried: in two of three lives of the drive the last of them differs as well, though it does not show it.) A check costs what longer steps
//! save in one to two blocks. An island therefore has its own steps also after a check that found no difference, if it has moved the outputs
//! by [`MOVED`] in a single block or moves them ever faster, and after that at two thirds of the life if fewer than [`FEWEST_BLOCKS_LEFT`] blocks are
//! left, as with `draft`. What the checks find counts in the stated error as that of the probes. The comparison on the unworn bores takes the place of
//! the probe there, which costs more, if it finds no difference.
//!
//! Not used if the motion does not repeat itself on the unworn bores, for [`Tier::Dynamic`], and where the steps of the accuracy are so long
//! already that they could be longer by less than [`LEAST_FACTOR`]. Dynamic cycles beside the quasi-static model keep their steps
//! too: twice as long, they change the wear rates under `foundation` by 0.7 % on worn bores, which its comparison would state as an error of the wear.
//! Steps twice as long save another 5 % of the time of the drive, but state errors of the wear twice as large.
//!
//! # Source
//! Comparison of two step lengths: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.4. Factor and
//! bounds: measured here (`cargo bench -p worker --bench steps`).

use super::compared_islands::{ComparedCycles, any_of, responsible};
use super::motion_estimate::MeasuredLives;
use super::partial_life::{ConditionLife, CycleModel, PartialLife};
use super::probe::{FINER, Probe, is_probed};
use super::{Run, join};
use common::accuracy::{Accuracy, Tier};

/// Largest tolerance of the local error of longer steps [1], some four steps a period of the contact vibration.
const LARGEST_TOLERANCE: f64 = 5e-3;
/// Least factor by which they are longer [1]: shorter ones save less than a fifth of the steps, and the checks cost some of it.
const LEAST_FACTOR: f64 = 1.2;
/// Fewest blocks of a life that are worth them.
const FEWEST_BLOCKS: usize = 8;
/// Fewest blocks around a check at two thirds of a life that are worth another one.
const FEWEST_BLOCKS_LEFT: usize = 4;
/// Largest relative change of an output of the motion, and of a wear rate, that is no difference [1].
const SAME_MOTION: f64 = 2e-3;
const SAME_WEAR: f64 = 5e-3;
/// Relative change of an output since the last check after which there is another one [1].
const MOVED: f64 = 5e-3;
/// Relative change of an output in a single block after which there is one, if it moves [`ACCELERATED`] times as fast as before [1].
const FASTER: f64 = 1e-3;
/// Speed of such an output in the last block, over its mean speed from the unworn bores to that block [1].
const ACCELERATED: f64 = 3.0;

/// Longer time steps in use, and the life at the last check.
pub struct LongerSteps<'a, M> {
    /// The model of the life, without probes.
    model: M,
    /// True for an island with longer steps, the same under all operating conditions `(islands,)`.
    islands: Vec<bool>,
    /// The life at the last check that found no difference, and its cycles.
    checked: (Vec<Run<'a>>, PartialLife<'a>, u32),
}

impl<'a, M: CycleModel> LongerSteps<'a, M> {
    /// Starts a life under `model` in blocks between these `ends` [cycles] with the settled first cycles of the `runs`, which have been
    /// measured, and tries longer steps on the unworn bores if it may have them. None if those of every island make a difference.
    ///
    /// # Errors
    /// The first error of a cycle, of a probe or of a check of the model.
    pub(crate) async fn start(
        runs: &mut [Run<'a>],
        model: &M,
        ends: &[u32],
    ) -> Result<(PartialLife<'a>, Option<Self>), M::Error> {
        let may_have_them = longer(runs[0].accuracy).filter(|_| is_long_enough(ends));
        let Some((plain, accuracy)) = model.without_probes().zip(may_have_them) else {
            return Ok((PartialLife::start(runs, model).await?, None));
        };
        let all = vec![true; runs[0].islands.len()];
        let steps = vec![accuracy; all.len()];
        if model.is_probed(&runs[0], None) && !runs.iter().any(Run::depends_on_last_impact) {
            let before = runs.to_vec();
            let mut life = PartialLife::start(runs, &plain).await?;
            let compared = compare(runs, 0, &steps, &all).await;
            if let Some((cycles, _)) = compared.filter(|(_, differing)| !differing.contains(&true)) {
                note(&mut life, changes(runs, &cycles, &all));
                let steps = LongerSteps::taken(runs, plain, &life, all);
                return Ok((life, Some(steps)));
            }
            runs.iter_mut().zip(before).for_each(|(run, before)| run.return_to(before));
        }
        let mut life = PartialLife::start(runs, model).await?;
        if life.estimate.conditions.iter().any(|c| c.probes.iter().any(|p| p.aperiodic)) {
            return Ok((life, None));
        }
        let Some((cycles, differing)) = compare(runs, 0, &steps, &all).await else { return Ok((life, None)) };
        let same: Vec<bool> = differing.iter().map(|differs| !differs).collect();
        if !same.contains(&true) {
            return Ok((life, None));
        }
        note(&mut life, changes(runs, &cycles, &same));
        let steps = LongerSteps::taken(runs, plain, &life, same);
        Ok((life, Some(steps)))
    }

    /// Longer steps of these `islands` from the unworn bores on.
    fn taken(runs: &mut [Run<'a>], model: M, life: &PartialLife<'a>, islands: Vec<bool>) -> Self {
        tracing::debug!("islands whose time steps are longer while they make no difference: {islands:?}");
        let steps = steps(runs[0].accuracy, &islands);
        runs.iter_mut().for_each(|run| run.set_steps(&steps));
        let checked = (runs.to_vec(), life.clone(), 0);
        LongerSteps { model, islands, checked }
    }

    /// True if an island still has longer steps.
    pub(crate) fn are_in_use(&self) -> bool {
        self.islands.contains(&true)
    }

    /// Adds the first of the blocks between these `ends` [cycles], and checks the cycles at its end if that is due. Returns the life [cycles] to go
    /// on from, which `runs` and `life` have then: the end of the block, or the last check that found no difference.
    pub(crate) async fn add_block(
        &mut self,
        runs: &mut [Run<'a>],
        life: &mut PartialLife<'a>,
        ends: &[u32],
    ) -> u32 {
        let block = &(ends[0]..ends[1]);
        let all = vec![true; self.islands.len()];
        if life.add_block(runs, &self.model, block).await.is_err() {
            return self.go_back(runs, life, &all);
        }
        let few_left = ends.len() - 2 < FEWEST_BLOCKS_LEFT;
        let is_probed = is_probed(block, &runs[0].scene.life) && (few_left || !self.is_recent(life));
        let is_faster = !self.islands.contains(&false) && moves_faster(life);
        let moved = self.moved(runs, life, if is_faster { FASTER } else { MOVED });
        if !is_probed && !moved.contains(&true) {
            return block.end;
        }
        let steps = self.steps_of_check(runs[0].accuracy, is_probed);
        let Some((cycles, differing)) = compare(runs, block.end, &steps, &self.islands).await else {
            return self.go_back(runs, life, &all);
        };
        if differing.contains(&true) {
            return self.go_back(runs, life, &differing);
        }
        if is_probed && self.islands.contains(&false) {
            let probes =
                join(runs.iter_mut().zip(&cycles).map(|(run, cycles)| run.probe_from(cycles, &steps)));
            let Ok(probes) = probes.await.into_iter().collect::<Result<Vec<Probe>, _>>() else {
                return self.go_back(runs, life, &all);
            };
            note(life, probes);
        } else {
            note(life, changes(runs, &cycles, &self.islands));
        }
        if is_faster || block.start == self.checked.2 {
            self.give_up(runs, &moved);
        } else if is_probed && few_left {
            self.give_up(runs, &all);
        }
        self.checked = (runs.to_vec(), life.clone(), block.end);
        block.end
    }

    /// True if the last check was a few blocks ago, and all islands have longer steps.
    fn is_recent(&self, life: &PartialLife) -> bool {
        let simulated = |life: &PartialLife| life.conditions[0].outputs.len();
        let since = simulated(life) - simulated(&self.checked.1);
        since < FEWEST_BLOCKS_LEFT && !self.islands.contains(&false)
    }

    /// Islands with longer steps that have moved an output since the last check by more than this `share` of it [1] `(islands,)`.
    fn moved(&self, runs: &[Run], life: &PartialLife, share: f64) -> Vec<bool> {
        let over_share = |now: &[f64], before: &[f64]| {
            let changes =
                now.iter().zip(before).map(|(now, before)| over((now - before).abs(), share * before.abs()));
            changes.fold(0.0, f64::max)
        };
        let lives = life.conditions.iter().zip(&self.checked.1.conditions);
        let conditions = runs.iter().zip(&self.checked.0).zip(lives);
        let moved = conditions.map(|((run, run_before), (now, before))| {
            let (Some(now), Some(before)) = (now.outputs.last(), before.outputs.last()) else {
                return vec![];
            };
            if over_share(now, before) <= 1.0 {
                return vec![];
            }
            let before = run_before.motion_outputs();
            responsible(&self.islands, |of| over_share(&run.outputs_with_islands(of, run_before), &before))
        });
        any_of(self.islands.len(), moved)
    }

    /// Time steps of a cycle that is compared with the one just measured `(islands,)`: `own` for islands with longer ones, and if the others `are_probed` finer
    /// ones for them.
    fn steps_of_check(&self, own: &Accuracy, are_probed: bool) -> Vec<Accuracy> {
        let others = if are_probed { own.refined(FINER) } else { *own };
        self.islands.iter().map(|is_longer| if *is_longer { *own } else { others }).collect()
    }

    /// Returns to the last check, with steps of the life's own for these islands from there on; its cycles.
    fn go_back(&mut self, runs: &mut [Run<'a>], life: &mut PartialLife<'a>, islands: &[bool]) -> u32 {
        let (before, checked, cycles) = &self.checked;
        let cycles = *cycles;
        tracing::debug!("longer time steps make a difference in islands {islands:?}: back to cycle {cycles}");
        for (run, before) in runs.iter_mut().zip(before) {
            run.return_to(before.clone());
        }
        life.clone_from(checked);
        self.give_up(runs, islands);
        cycles
    }

    /// Gives these islands steps of the life's own.
    fn give_up(&mut self, runs: &mut [Run<'a>], islands: &[bool]) {
        self.islands.iter_mut().zip(islands).for_each(|(is_longer, gives_up)| *is_longer &= !gives_up);
        tracing::debug!("longer time steps from now on in islands {:?}", self.islands);
        let steps = steps(runs[0].accuracy, &self.islands);
        runs.iter_mut().for_each(|run| run.set_steps(&steps));
    }
}

/// Time steps where these `islands` have longer ones than `own` `(islands,)`.
fn steps(own: &Accuracy, islands: &[bool]) -> Vec<Accuracy> {
    let longer = longer(own).unwrap_or(*own);
    islands.iter().map(|is_longer| if *is_longer { longer } else { *own }).collect()
}

/// `accuracy` with longer time steps, if they may be tried; the largest step stays.
pub(crate) fn longer(accuracy: &Accuracy) -> Option<Accuracy> {
    let factor = FINER.min((LARGEST_TOLERANCE / accuracy.step_tolerance).sqrt().sqrt());
    let step_tolerance = accuracy.refined(1.0 / factor).step_tolerance;
    let may_be_tried = accuracy.tier == Tier::Automatic && factor >= LEAST_FACTOR;
    may_be_tried.then_some(Accuracy { step_tolerance, ..*accuracy })
}

/// True if a life in blocks between these `ends` [cycles] is worth the checks.
pub(crate) fn is_long_enough(ends: &[u32]) -> bool {
    ends.len() > FEWEST_BLOCKS
}

/// What the further ones of the compared `cycles` change on account of these islands, under every condition.
fn changes(runs: &[Run], cycles: &[ComparedCycles], of: &[bool]) -> Vec<Probe> {
    // A change this small is that of the time steps.
    let periodic = |probe| Probe { aperiodic: false, ..probe };
    runs.iter().zip(cycles).map(|(run, cycles)| periodic(run.changes(cycles, of))).collect()
}

/// Compares the cycles just measured with further ones that have these time `steps` `(islands,)`, on the bores of `life` [cycles]: the two cycles
/// under every condition, and which of these islands make a difference `(islands,)`. None if a cycle fails.
async fn compare(
    runs: &mut [Run<'_>],
    life: u32,
    steps: &[Accuracy],
    of: &[bool],
) -> Option<(Vec<ComparedCycles>, Vec<bool>)> {
    let cycles = join(runs.iter_mut().map(|run| run.compare_next(life, steps))).await;
    let cycles = cycles.into_iter().collect::<Result<Vec<ComparedCycles>, _>>().ok()?;
    let differing = runs
        .iter()
        .zip(&cycles)
        .map(|(run, cycles)| responsible(of, |of| difference(&run.changes(cycles, of), &run.measured)));
    let differing = any_of(of.len(), differing);
    Some((cycles, differing))
}

/// True if an output of the motion has moved in the last block by more than [`FASTER`] of it, and [`ACCELERATED`] times as fast as before.
fn moves_faster(life: &PartialLife) -> bool {
    life.conditions.iter().map(ConditionLife::measured).any(|MeasuredLives { lives, outputs }| {
        let ([start, .., last, end], [first, .., before, now]) = (lives, outputs) else { return false };
        let speed_before = |k: usize| (before[k] - first[k]).abs() / f64::from(last - start);
        (0..now.len()).any(|k| {
            let change = (now[k] - before[k]).abs();
            change > FASTER * before[k].abs()
                && change / f64::from(end - last) > ACCELERATED * speed_before(k)
        })
    })
}

/// Adds what comparisons found, one for each condition, to the estimate of the error.
fn note(life: &mut PartialLife, probes: Vec<Probe>) {
    for (probe, estimate) in probes.into_iter().zip(&mut life.estimate.conditions) {
        estimate.add_probe(probe);
    }
}

/// Largest change that `probe` found, over the bound of what is no difference, given the outputs `measured` `(outputs,)` [SI].
pub(crate) fn difference(probe: &Probe, measured: &[f64]) -> f64 {
    let motion =
        probe.motion.iter().zip(measured).map(|(change, value)| over(*change, SAME_MOTION * value.abs()));
    motion.chain(probe.wear.iter().map(|change| over(*change, SAME_WEAR))).fold(0.0, f64::max)
}

/// A `change` over its `bound`; zero for none, infinity where it is not a number.
fn over(change: f64, bound: f64) -> f64 {
    if change == 0.0 {
        return 0.0;
    }
    let share = change / bound;
    if share.is_nan() { f64::INFINITY } else { share }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_accuracies_with_short_steps_are_tried_with_longer_ones() {
        let balanced = Accuracy::balanced();
        let steps = longer(&balanced).expect("longer ones").refined(FINER).step_tolerance;
        assert!((steps / balanced.step_tolerance - 1.0).abs() < 1e-15, "{steps}");
        assert!(longer(&balanced.refined(1.25)).is_some());
        let draft = longer(&Accuracy::draft()).expect("longer ones").step_tolerance;
        assert!((draft / LARGEST_TOLERANCE - 1.0).abs() < 1e-15, "{draft}");
        let longest = Accuracy { step_tolerance: 2.5e-3, ..Accuracy::draft() };
        assert!([longest, Accuracy::reference()].iter().all(|accuracy| longer(accuracy).is_none()));
    }

    #[test]
    fn every_output_and_every_wear_rate_has_to_stay() {
        let probe = |motion: [f64; 2], wear: f64| Probe {
            life: 0,
            motion: motion.to_vec(),
            wear: vec![0.0, wear],
            aperiodic: false,
            rattles: false,
        };
        let same = |motion, wear| difference(&probe(motion, wear), &[-10.0, 0.0]) <= 1.0;
        assert!(same([0.019, 0.0], 0.0049));
        assert!(!same([0.021, 0.0], 0.0) && !same([0.0, 1e-9], 0.0) && !same([0.0, 0.0], 0.0051));
        assert!(!same([f64::NAN, 0.0], 0.0));
    }
}
