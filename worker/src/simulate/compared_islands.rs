//! A measured cycle compared with the one after it on the same bores, and which islands make the difference.
//!
//! Islands do not act on each other, so that the recordings of two cycles can be combined: what the further cycle changes on account of some
//! islands S alone is
//!
//!   dy = y(recordings of S from the further cycle, of the others from the measured one) - y(measured cycle)
//!
//! for an output y of the motion, and the change of the wear rates in the joints of S.

use super::probe::{CycleValues, Probe, SURFACES};
use super::run::Run;
use crate::mechanism::WearingPair;
use crate::outputs::Recorder;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
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
    pub(crate) async fn compare_next(
        &mut self,
        life: u32,
        steps: &[Accuracy],
    ) -> Result<ComparedCycles, SimulationFailure> {
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
    ) -> Result<Probe, SimulationFailure> {
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
