//! Longer time steps in the cycles of a life, as long as they make no difference.
//!
//! The vibration of the contacts sets the length of the time steps throughout a cycle (`control.rs`), and it matters only where its damping
//! is low: late in the life of the flapping-wing drive, where the worn bores feed it. Before, longer steps change neither the wear
//! nor the outputs by a thousandth. Steps 2.5 times as long would be too long: with them the scheme itself feeds the vibration.
//!
//! A life starts with its own steps. On the unworn bores the cycle after the measured one has steps longer by [`FINER`], or as much longer
//! as [`LARGEST_TOLERANCE`] permits (by 1.26 for `draft`). If no output y of the motion and no wear rate w changes by more than
//!
//!   |dy| <= 0.002 |y|,   |dw| <= 0.005 w,
//!
//! the cycles after it have the longer steps. Some of them are checked: the cycle after such a one, on the same bores, has steps of the life's
//! own and is compared with it, as in a [`Probe`]. These are the ones that are probed otherwise, and those whose outputs of the motion have
//! moved by more than 0.5 % since the last check. Where the two differ by more than the bounds above, or a cycle with longer steps
//! fails, the life returns to the check before and goes on with its own steps to its end. (To keep the cycles in between, whose outputs have hardly moved,
//! was tried: in two of three lives of the drive the last of them differs as well, though it does not show it.) So it does after two thirds of the life if fewer than
//! [`FEWEST_BLOCKS_LEFT`] blocks are left, as with `draft`. What the checks find counts in the stated error as that of the probes. The
//! comparison on the unworn bores takes the place of the probe there, which costs more, if it finds no difference.
//!
//! Not used if the motion does not repeat itself on the unworn bores, for [`Tier::Dynamic`], and where the steps of the accuracy are so long
//! already that they could be longer by less than [`LEAST_FACTOR`]. Dynamic cycles beside the quasi-static model keep their steps
//! too: twice as long, they change the wear rates under `foundation` by 0.7 % on worn bores, which its comparison would state as an error of the wear.
//! Steps twice as long save another 5 % of the time of the drive, but state errors of the wear twice as large.
//!
//! # Source
//! Comparison of two step lengths: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.4. Factor and
//! bounds: measured here (`cargo bench -p worker --bench steps`).

use super::partial_life::{CycleModel, PartialLife};
use super::probe::{FINER, Probe, is_probed};
use super::run::Run;
use super::side_by_side::join;
use common::accuracy::{Accuracy, Tier};
use common::scene::Life;
use std::ops::Range;

/// Largest tolerance of the local error of longer steps [1], some four steps a period of the contact vibration.
const LARGEST_TOLERANCE: f64 = 5e-3;
/// Least factor by which they are longer [1]: shorter ones save less than a fifth of the steps, and the checks cost some of it.
const LEAST_FACTOR: f64 = 1.2;
/// Fewest blocks of a life that are worth them, and fewest after the check at two thirds of it.
const FEWEST_BLOCKS: usize = 8;
const FEWEST_BLOCKS_LEFT: usize = 4;
/// Largest relative change of an output of the motion, and of a wear rate, that is no difference [1].
const SAME_MOTION: f64 = 2e-3;
const SAME_WEAR: f64 = 5e-3;
/// Relative change of an output since the last check after which there is another one [1].
const MOVED: f64 = 5e-3;

/// Longer time steps in use, and the life at the last check.
pub struct LongerSteps<'a, M> {
    /// The model of the life, without probes.
    model: M,
    checked: Checked<'a>,
}

/// A life at a check that found no difference.
struct Checked<'a> {
    runs: Vec<Run<'a>>,
    life: PartialLife<'a>,
    /// Its cycles so far.
    cycles: u32,
}

impl<'a, M: CycleModel> LongerSteps<'a, M> {
    /// Starts a life under `model` in blocks between these `ends` [cycles] with the settled first cycles of the `runs`, which have been
    /// measured, and tries longer steps on the unworn bores if it may have them. None if they make a difference.
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
        if model.is_probed(&runs[0], None) && !runs.iter().any(Run::depends_on_last_impact) {
            let before = runs.to_vec();
            let mut life = PartialLife::start(runs, &plain).await?;
            let probes = compare(runs, 0, &accuracy).await;
            if let Some(probes) = probes {
                let steps = LongerSteps::taken(runs, plain, &mut life, probes, &accuracy);
                return Ok((life, Some(steps)));
            }
            runs.iter_mut().zip(before).for_each(|(run, before)| return_to(run, before));
        }
        let mut life = PartialLife::start(runs, model).await?;
        if life.estimate.conditions.iter().any(|c| c.probes.iter().any(|p| p.aperiodic)) {
            return Ok((life, None));
        }
        let probes = compare(runs, 0, &accuracy).await;
        let steps = probes.map(|probes| LongerSteps::taken(runs, plain, &mut life, probes, &accuracy));
        Ok((life, steps))
    }

    /// Longer steps, those of `accuracy`, from the unworn bores on, where `probes` have found no difference.
    fn taken(
        runs: &mut [Run<'a>],
        model: M,
        life: &mut PartialLife<'a>,
        probes: Vec<Probe>,
        accuracy: &Accuracy,
    ) -> Self {
        tracing::debug!("time steps are longer while they make no difference");
        note(life, probes);
        runs.iter_mut().for_each(|run| run.set_steps(accuracy));
        let checked = Checked { runs: runs.to_vec(), life: life.clone(), cycles: 0 };
        LongerSteps { model, checked }
    }

    /// Adds the first of the blocks between these `ends` [cycles] with longer steps, and checks the cycles at its end if that is due. If the
    /// steps are to have their own length from now on, the life [cycles] to go on from, which `runs` and `life` have then.
    pub(crate) async fn add_block(
        &mut self,
        runs: &mut [Run<'a>],
        life: &mut PartialLife<'a>,
        ends: &[u32],
    ) -> Option<u32> {
        let block = &(ends[0]..ends[1]);
        let added = life.add_block(runs, &self.model, block).await;
        if added.is_ok() && !self.is_due(life, block, &runs[0].scene.life) {
            return None;
        }
        let own = runs[0].accuracy;
        let probes = if added.is_ok() { compare(runs, block.end, own).await } else { None };
        let Some(probes) = probes else { return Some(self.go_back(runs, life)) };
        note(life, probes);
        let few_left = ends.len() - 2 < FEWEST_BLOCKS_LEFT && is_probed(block, &runs[0].scene.life);
        if block.start == self.checked.cycles || few_left {
            // A check after every block, or for a few last ones, would cost more than longer steps save.
            runs.iter_mut().for_each(|run| run.set_steps(own));
            return Some(block.end);
        }
        self.checked = Checked { runs: runs.to_vec(), life: life.clone(), cycles: block.end };
        None
    }

    /// True if the cycles at the end of `block` are to be checked, of a scene with this life.
    fn is_due(&self, life: &PartialLife, block: &Range<u32>, of: &Life) -> bool {
        let conditions = life.conditions.iter().zip(&self.checked.life.conditions);
        let moved = |(now, before): (&f64, &f64)| (now - before).abs() > MOVED * before.abs();
        is_probed(block, of)
            || conditions
                .filter_map(|(now, before)| Some((now.outputs.last()?, before.outputs.last()?)))
                .any(|(now, before)| now.iter().zip(before).any(moved))
    }

    /// Returns to the last check, with steps of the life's own length from there on; its cycles.
    fn go_back(&self, runs: &mut [Run<'a>], life: &mut PartialLife<'a>) -> u32 {
        let Checked { runs: before, life: checked, cycles } = &self.checked;
        tracing::debug!("longer time steps make a difference: back to cycle {cycles}");
        for (run, before) in runs.iter_mut().zip(before) {
            return_to(run, before.clone());
            run.set_steps(run.accuracy);
        }
        life.clone_from(checked);
        *cycles
    }
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

/// Returns a run to what it was `before`; its counts go on.
fn return_to<'a>(run: &mut Run<'a>, mut before: Run<'a>) {
    before.copy_counts(run);
    *run = before;
}

/// Compares the cycles just measured with further ones that have the time steps of `accuracy`, on the bores of `cycles`. What was found if
/// they make no difference.
async fn compare(runs: &mut [Run<'_>], cycles: u32, accuracy: &Accuracy) -> Option<Vec<Probe>> {
    let probes = join(runs.iter_mut().map(|run| run.compare_steps(cycles, accuracy))).await;
    let probes = probes.into_iter().collect::<Result<Vec<Probe>, _>>().ok()?;
    let is_same = probes.iter().zip(runs).all(|(probe, run)| makes_no_difference(probe, &run.measured));
    is_same.then_some(probes)
}

/// Adds what comparisons found, one for each condition, to the estimate of the error.
fn note(life: &mut PartialLife, probes: Vec<Probe>) {
    for (probe, estimate) in probes.into_iter().zip(&mut life.estimate.conditions) {
        // Its small change is that of the time steps.
        estimate.add_probe(Probe { aperiodic: false, ..probe });
    }
}

/// True if the changes that `probe` found are within the bounds, given the outputs `measured` `(outputs,)` [SI].
pub(crate) fn makes_no_difference(probe: &Probe, measured: &[f64]) -> bool {
    let mut motion = probe.motion.iter().zip(measured);
    motion.all(|(change, value)| *change <= SAME_MOTION * value.abs())
        && probe.wear.iter().all(|change| *change <= SAME_WEAR)
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
        let same = |motion, wear| makes_no_difference(&probe(motion, wear), &[-10.0, 0.0]);
        assert!(same([0.019, 0.0], 0.0049));
        assert!(!same([0.021, 0.0], 0.0) && !same([0.0, 1e-9], 0.0) && !same([0.0, 0.0], 0.0051));
        assert!(!same([f64::NAN, 0.0], 0.0));
    }
}
