//! The result of an evaluation.

use super::observe::FirstSeen;
use super::run::Run;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation, JointSummary};

impl Run<'_> {
    /// Puts the result together: `histories` and their `errors` `(outputs, m)` at the checkpoints `cycles`.
    ///
    /// # Errors
    /// [`SimulationFailure::NotFinite`] if a value is not.
    pub fn finish(
        &self,
        cycles: Vec<u32>,
        histories: Vec<Vec<f64>>,
        errors: Vec<Vec<f64>>,
        first: FirstSeen,
    ) -> Result<Evaluation, SimulationFailure> {
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
            .map(|((name, peak_force), wear_depth)| JointSummary { name, peak_force, wear_depth })
            .collect();
        Ok(Evaluation {
            cycles,
            histories,
            errors,
            joints,
            first_cycle: first.cycle,
            worn: self.worn.clone(),
            diagnostics: Diagnostics {
                steps: self.stats.steps,
                rejected_steps: self.stats.rejected,
                newton_iterations: self.newton,
                force_evaluations: self.stats.forces,
                simulated_cycles: self.simulated,
                wear_stages: self.wear_stats.stages,
                rejected_wear_steps: self.wear_stats.rejected,
                free_flight_fraction: first.free_flight,
                constraint_drift: self.stats.drift,
                held_wear_points: self.wear_stats.held,
                quasi_static: !self.guided.is_empty(),
                energy: first.energy,
                worn_energy: self.worn_energy,
            },
        })
    }
}
