//! A measured cycle compared with the one after it on the same bores, and which islands make the difference.
//!
//! Islands do not act on each other, so that the recordings of two cycles can be combined: what the further cycle changes on account of some
//! islands S alone is
//!
//!   dy = y(recordings of S from the further cycle, of the others from the measured one) - y(measured cycle)
//!
//! for an output y of the motion, and the change of the wear rates in the joints of S.

use super::probe::{CycleValues, Probe, SURFACES};
use super::{Run, Simulated};
use crate::mechanism::WearingPair;
use crate::outputs::Recorder;
use common::accuracy::Accuracy;
use std::mem::replace;

/// A measured cycle and the one after it.
pub struct ComparedCycles {
    /// Life of the bores [cycles].
    life: u32,
    measured: CycleValues,
    further: CycleValues,
    /// Recordings of the further cycle `(islands,)`.
    recorders: Vec<Recorder>,
}

impl Run<'_> {
    /// Simulates the cycle after the one just measured, on the bores of `life` [cycles], with the time steps of these accuracies
    /// `(islands,)`. All recordings of the measured cycle are kept.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the further cycle fails.
    pub(crate) async fn compare_next(&mut self, life: u32, steps: &[Accuracy]) -> Simulated<ComparedCycles> {
        let measured = self.measured_values(life)?;
        let kept: Vec<Recorder> = self.islands.iter().map(|state| state.recorder.clone()).collect();
        let mut tools = self.tools_for(steps);
        self.exchange_tools(&mut tools);
        let next = self.measure_next(life).await;
        self.exchange_tools(&mut tools);
        let islands = self.islands.iter_mut().zip(kept);
        let recorders = islands.map(|(state, kept)| replace(&mut state.recorder, kept)).collect();
        Ok(ComparedCycles { life, measured, further: next?, recorders })
    }

    /// What the further of the `compared` cycles, of which the other is the one measured last, changes on account of these islands
    /// `(islands,)`.
    pub(crate) fn changes(&self, compared: &ComparedCycles, of: &[bool]) -> Probe {
        let ComparedCycles { life, measured, further, recorders } = compared;
        let mut probe = Probe::unchanged(*life, measured);
        if of.iter().all(|is_of| *is_of) {
            probe.add_cycle(measured, further);
            return probe;
        }
        let islands = self.islands.iter().zip(recorders).zip(of);
        let motion = self.outputs_of_recordings(islands.map(|((state, further), is_of)| {
            (&state.island, if *is_of { further } else { &state.recorder })
        }));
        let mut wear = measured.wear.clone();
        for (state, _) in self.islands.iter().zip(of).filter(|(_, is_of)| **is_of) {
            for joint in state.island.pairs().map(WearingPair::scene_joint) {
                let surfaces = SURFACES * joint..SURFACES * (joint + 1);
                wear[surfaces.clone()].clone_from_slice(&further.wear[surfaces]);
            }
        }
        probe.add_cycle(measured, &CycleValues { motion, wear });
        probe
    }

    /// As a probe of the cycle measured last, of which the first further cycle, with these time `steps` `(islands,)`, is that of `compared`.
    ///
    /// # Errors
    /// [`SimulationFailure`] if another further cycle fails.
    pub(crate) async fn probe_from(
        &mut self,
        compared: &ComparedCycles,
        steps: &[Accuracy],
    ) -> Simulated<Probe> {
        let probe = self.changes(compared, &vec![true; steps.len()]);
        let life = compared.life;
        let is_enough = !self.depends_on_last_impact()
            && (!probe.aperiodic
                || self.repeats_itself(life, &compared.measured, &self.present_steps()).await?);
        if is_enough { Ok(probe) } else { self.probe_in_steps(life, steps).await }
    }

    /// Outputs of a cycle that has the recordings of some islands from this run `(islands,)`, and those of the others from the run `before` of the
    /// same mechanism `(outputs,)` [SI].
    pub(crate) fn outputs_with_islands(&self, of: &[bool], before: &Run) -> Vec<f64> {
        let islands = self.islands.iter().zip(&before.islands).zip(of);
        self.outputs_of_recordings(islands.map(|((now, before), is_of)| {
            let state = if *is_of { now } else { before };
            (&state.island, &state.recorder)
        }))
    }
}

/// Those of the islands `of` that are responsible for a change, where `size` tells how large that of some islands is, relative to what is still none:
/// as few as possible, those with the largest changes `(islands,)`.
pub(super) fn responsible(of: &[bool], size: impl Fn(&[bool]) -> f64) -> Vec<bool> {
    let mut rest = of.to_vec();
    let alone = |island: usize| size(&(0..of.len()).map(|k| k == island).collect::<Vec<bool>>());
    let mut largest_first: Vec<usize> = vec![];
    while rest.contains(&true) && size(&rest) > 1.0 {
        if largest_first.is_empty() {
            let mut sizes: Vec<(usize, f64)> =
                (0..of.len()).filter(|&k| of[k]).map(|k| (k, alone(k))).collect();
            sizes.sort_by(|a, b| a.1.total_cmp(&b.1));
            largest_first = sizes.into_iter().map(|(k, _)| k).collect();
        }
        if let Some(k) = largest_first.pop() {
            rest[k] = false;
        }
    }
    of.iter().zip(rest).map(|(of, rest)| *of && !rest).collect()
}

/// True for an island that is in one of these sets `(islands,)`.
pub(super) fn any_of(islands: usize, sets: impl Iterator<Item = Vec<bool>>) -> Vec<bool> {
    sets.fold(vec![false; islands], |mut any, set| {
        any.iter_mut().zip(set).for_each(|(any, is_in)| *any |= is_in);
        any
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::side_by_side::run_alone;
    use common::scene::SceneSource;

    #[test]
    fn islands_change_their_own_wear_and_together_what_the_whole_cycle_changes() {
        let scene = SceneSource::builtin("flapping-wing").expect("built in").nominal().clone();
        let accuracy = Accuracy::draft();
        run_alone(|queue| async {
            let mut run = Run::assemble(queue, &scene, &accuracy).expect("assembled");
            run.settle().await.expect("settled");
            run.measure().await.expect("measured");
            let (motion, wear) = (run.motion_outputs(), run.wear_rates(0).expect("rates"));
            let compared = run.compare_next(0, &[accuracy.refined(3.0); 2]).await.expect("compared");
            assert_eq!((run.motion_outputs(), run.wear_rates(0).expect("rates")), (motion, wear), "kept");
            let [none, all, right, left] =
                [[false; 2], [true; 2], [true, false], [false, true]].map(|of| run.changes(&compared, &of));
            assert!(none.motion.iter().chain(&none.wear).all(|change| *change == 0.0), "{none:?}");
            assert!(
                all.motion[1] > 0.0 && all.motion[1] <= 1.01 * (right.motion[1] + left.motion[1]),
                "{all:?}"
            );
            // Joints alternate between the wings, with a bore and a journal each.
            for (k, change) in all.wear.iter().enumerate() {
                let is_right = (k / SURFACES).is_multiple_of(2);
                assert_eq!(
                    [right.wear[k], left.wear[k]],
                    if is_right { [*change, 0.0] } else { [0.0, *change] }
                );
            }
            assert!(right.wear[0] > 0.0 && left.wear[SURFACES] > 0.0);
        });
    }

    /// Islands responsible where the changes of single ones add up.
    fn of_sums(of: &[bool], changes: &[f64]) -> Vec<bool> {
        responsible(of, |set| {
            set.iter().zip(changes).filter(|(is_in, _)| **is_in).map(|(_, change)| change).sum()
        })
    }

    #[test]
    fn as_few_islands_as_possible_are_responsible_for_a_change() {
        let all = [true; 3];
        assert_eq!(of_sums(&all, &[0.3, 0.3, 0.3]), [false; 3]);
        assert_eq!(of_sums(&all, &[0.3, 2.0, 0.3]), [false, true, false]);
        // No single one is above one, both together are.
        assert_eq!(of_sums(&all, &[0.2, 0.3, 0.9]), [false, false, true]);
        assert_eq!(of_sums(&all, &[3.0, 0.1, 2.0]), [true, false, true]);
        assert_eq!(of_sums(&[true, false, true], &[0.5, 7.0, 0.4]), [false; 3]);
        assert_eq!(of_sums(&[true, false, true], &[0.5, 7.0, 0.8]), [false, false, true]);
        assert_eq!(of_sums(&all, &[0.1, f64::INFINITY, 0.1]), [false, true, false]);
    }

    #[test]
    fn an_island_is_in_the_union_of_sets_that_contain_it() {
        let sets = [vec![true, false, false], vec![], vec![false, false, true]];
        assert_eq!(any_of(3, sets.into_iter()), [true, false, true]);
        assert_eq!(any_of(2, std::iter::empty()), [false, false]);
    }
}
