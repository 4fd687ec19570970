//! The result of an evaluation.

use super::blocks::LifeHistory;
use super::cycle_history::FirstCycle;
use super::run::Run;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation, JointSummary, PointsError};

/// Assembles the result from the outputs over life: counts of the `runs` of all operating conditions, at least one, and bores and motion
/// of the first one, on which all others have run too.
///
/// # Errors
/// [`SimulationFailure::NotFinite`] if a value is not finite.
pub(crate) fn finish(
    runs: &[Run],
    life: LifeHistory,
    first: FirstCycle,
) -> Result<Evaluation, SimulationFailure> {
    let run = &runs[0];
    let sum = |count: fn(&Run) -> u64| runs.iter().map(count).sum();
    let LifeHistory { histories, errors, start } = life;
    let cycles = run.scene.life.checkpoints();
    for (output, history) in run.scene.outputs.iter().zip(&histories) {
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
        .zip(run.depths())
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
        worn: run.display.as_ref().and_then(|display| display.life.clone()),
        diagnostics: Diagnostics {
            steps: sum(|run| run.counts.steps),
            rejected_steps: sum(|run| run.counts.rejected),
            newton_iterations: sum(|run| run.newton),
            force_evaluations: sum(|run| run.counts.forces),
            simulated_cycles: sum(|run| run.simulated),
            wear_stages: run.wear_counts.stages,
            rejected_wear_steps: run.wear_counts.rejected,
            free_flight_fraction: first.free_flight,
            constraint_drift: runs.iter().fold(0.0, |a, run| run.counts.drift.max(a)),
            held_wear_points: run.wear_counts.held,
            narrow_grooves: run.grooves.clone(),
            control_points: worst(runs),
            unsettled: runs.iter().find_map(|run| run.repetition.unsettled.clone()),
            quasi_static: !run.quasi_static.is_empty(),
            energy: first.energy,
            worn_energy: run.display.as_ref().and_then(|display| display.energy),
        },
    })
}

/// What more control points change in each output of the motion, under the condition where that is most.
fn worst(runs: &[Run]) -> Vec<PointsError> {
    let mut all: Vec<PointsError> = runs[0].points_errors.clone();
    for run in &runs[1..] {
        for (worst, of_run) in all.iter_mut().zip(&run.points_errors) {
            if of_run.error > worst.error {
                worst.clone_from(of_run);
            }
        }
    }
    all
}
