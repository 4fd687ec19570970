//! The result of an evaluation.

use super::cycle_history::FirstCycle;
use super::life_in_blocks::LifeHistory;
use super::run::Run;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation, JointSummary};

impl Run<'_> {
    /// Assembles the result from the outputs over life.
    ///
    /// # Errors
    /// [`SimulationFailure::NotFinite`] if a value is not finite.
    pub(crate) fn finish(
        &self,
        life: LifeHistory,
        first: FirstCycle,
    ) -> Result<Evaluation, SimulationFailure> {
        let LifeHistory { histories, errors, start } = life;
        let cycles = self.scene.life.checkpoints();
        for (output, history) in self.scene.outputs.iter().zip(&histories) {
            if let Some(k) = history.iter().position(|x| !x.is_finite()) {
                return Err(SimulationFailure::NotFinite {
                    cycle: cycles[k],
                    time: 0.0,
                    quantity: output.name.clone(),
                });
            }
        }
        let joints = first
            .peaks
            .into_iter()
            .zip(self.depths())
            .map(|((name, peak_force), [wear_depth, journal_wear_depth])| JointSummary {
                name,
                peak_force,
                wear_depth,
                journal_wear_depth,
            })
            .collect();
        Ok(Evaluation {
            cycles,
            histories,
            errors,
            start: start.into_iter().map(|value| value.is_finite().then_some(value)).collect(),
            joints,
            first_cycle: first.history,
            worn: self.display.as_ref().and_then(|display| display.life.clone()),
            diagnostics: Diagnostics {
                steps: self.counts.steps,
                rejected_steps: self.counts.rejected,
                newton_iterations: self.newton,
                force_evaluations: self.counts.forces,
                simulated_cycles: self.simulated,
                wear_stages: self.wear_counts.stages,
                rejected_wear_steps: self.wear_counts.rejected,
                free_flight_fraction: first.free_flight,
                constraint_drift: self.counts.drift,
                held_wear_points: self.wear_counts.held,
                quasi_static: !self.quasi_static.is_empty(),
                energy: first.energy,
                worn_energy: self.display.as_ref().and_then(|display| display.energy),
            },
        })
    }
}
