//! Outputs of the cycle recorded last, and its history as it is displayed.
//!
//! # Finish
//! The result of an evaluation.

use super::island_state::IslandState;
use super::{LifeHistory, Run, Simulated};
use crate::mechanism::{Island, Prescribed};
use crate::outputs::{
    FullRecording, RecordedCycle, Recorder, motion_value, own_torque, sample_times, sum_of_islands,
};
use common::failure::SimulationFailure;
use common::outputs::{
    BodyMotion, BodyTrace, CycleHistory, Diagnostics, EnergyBalance, Evaluation, JointSummary, PointsError,
};
use common::scene::Motion;

/// Summary of the first cycle; joints in the scene's order.
pub struct FirstCycle {
    /// History of the cycle, if it is displayed.
    pub history: Option<CycleHistory>,
    /// Name and largest force of every joint [N].
    pub peaks: Vec<(String, f64)>,
    /// Name and share of the cycle in free flight of every joint with clearance [1].
    pub free_flight: Vec<(String, f64)>,
    /// Energy balance, if the cycle is displayed.
    pub energy: Option<EnergyBalance>,
}

impl FirstCycle {
    /// The summary of the first cycles of all conditions, at least one, with their shares [1]: the largest forces, the mean of the shares
    /// in free flight, and history and energy of the first condition.
    pub(crate) fn of_conditions(mut cycles: Vec<(f64, FirstCycle)>) -> Option<FirstCycle> {
        let first = cycles.first()?.0;
        let is_single = cycles.len() == 1;
        let mut all = cycles.remove(0).1;
        if is_single {
            return Some(all);
        }
        all.free_flight.iter_mut().for_each(|(_, free)| *free *= first);
        for (share, cycle) in cycles {
            let peaks = all.peaks.iter_mut().zip(cycle.peaks);
            peaks.for_each(|((_, largest), (_, peak))| *largest = largest.max(peak));
            let free_flight = all.free_flight.iter_mut().zip(cycle.free_flight);
            free_flight.for_each(|((_, mean), (_, free))| *mean += share * free);
        }
        Some(all)
    }
}

impl Run<'_> {
    /// Outputs of the scene that follow from the motion of the cycle recorded last, zero in the place of the others
    /// `(outputs,)` [SI].
    pub(crate) fn motion_outputs(&self) -> Vec<f64> {
        outputs_of(&self.recorded_cycle())
    }

    /// The same, where the cycle consists of these recordings, one for each island `(outputs,)` [SI].
    pub(crate) fn outputs_of_recordings<'r>(
        &'r self,
        islands: impl Iterator<Item = (&'r Island, &'r Recorder)>,
    ) -> Vec<f64> {
        outputs_of(&RecordedCycle { scene: self.scene, islands: islands.collect(), ideal: &self.ideal })
    }

    fn recorded_cycle(&self) -> RecordedCycle<'_> {
        RecordedCycle {
            scene: self.scene,
            islands: self.islands.iter().map(|state| (&state.island, &state.recorder)).collect(),
            ideal: &self.ideal,
        }
    }

    /// Energy balance of the cycle recorded last, which is displayed.
    pub(crate) fn energy(&self) -> EnergyBalance {
        let displayed =
            self.islands.iter().filter_map(|state| state.recorder.full.as_ref()?.displayed.as_ref());
        sum_of_islands(displayed.map(|motion| motion.balance))
    }

    /// Summary of the cycle recorded last, which was recorded fully; with its history if cycles are displayed.
    pub(crate) fn first_cycle(&self) -> FirstCycle {
        let period = self.scene.life.period;
        let has_clearance = |name: &str| {
            let mut joints = self.islands.iter().flat_map(|state| state.island.contacts());
            joints.any(|joint| self.scene.joints[joint].name == name)
        };
        let mut free_flight = self.joint_values(|full, joint| full.forces[joint].free / period);
        free_flight.retain(|(name, _)| has_clearance(name));
        FirstCycle {
            history: self.display.as_ref().map(|_| self.cycle_history()),
            peaks: self.joint_values(|full, joint| full.forces[joint].peak),
            free_flight,
            energy: self.display.as_ref().map(|_| self.energy()),
        }
    }

    /// Motion and joint forces of the cycle recorded last, which was recorded fully.
    pub(crate) fn cycle_history(&self) -> CycleHistory {
        let time = sample_times(self.scene);
        let cycle = self.recorded_cycle();
        let mut bodies: Vec<BodyTrace> = Vec::new();
        for body in self.scene.outputs.iter().filter_map(|output| output.kind.compared_bodies()).flatten() {
            if bodies.iter().any(|t| t.label == body.label) {
                continue;
            }
            let (angle, speed) = cycle.body(body.body).resample(&time);
            bodies.push(BodyTrace {
                label: body.label.clone(),
                angle: angle.into_iter().map(|x| x * body.sign).collect(),
                speed: speed.into_iter().map(|x| x * body.sign).collect(),
            });
        }
        let joint_force = self.joint_values(|full, joint| {
            full.displayed.as_ref().map_or_else(Vec::new, |motion| motion.force(joint))
        });
        let motion = self.body_motions(&time);
        let driving_torque = self.driving_torques(&time);
        CycleHistory { time, bodies, motion, joint_force, driving_torque, ..CycleHistory::default() }
    }

    /// Name of every driven body and its torque at the times `time` [s], in the scene's order.
    fn driving_torques(&self, time: &[f64]) -> Vec<(String, Vec<f64>)> {
        let of_body = |body: usize| {
            let own = own_torque(self.scene, body)?;
            let mut torque: Vec<f64> = time.iter().map(|t| own(*t)).collect();
            for IslandState { island, recorder, .. } in &self.islands {
                let displayed = recorder.full.as_ref().and_then(|full| full.displayed.as_ref());
                let slot = island.touched.iter().position(|touched| *touched == body);
                let Some((displayed, slot)) = displayed.zip(slot) else { continue };
                let moment = displayed.force(island.all_joints().count() + slot);
                torque.iter_mut().zip(moment).for_each(|(torque, moment)| *torque -= moment);
            }
            Some((self.scene.bodies[body].name.clone(), torque))
        };
        (0..self.scene.bodies.len()).filter_map(of_body).collect()
    }

    /// Motion of every body that moves, in the scene's order, at the times `time` [s].
    fn body_motions(&self, time: &[f64]) -> Vec<BodyMotion> {
        let mut found: Vec<BodyMotion> = Vec::new();
        for state in &self.islands {
            let displayed = state.recorder.full.iter().filter_map(|full| full.displayed.as_ref());
            found.extend(displayed.flat_map(|motion| motion.bodies(&state.island, self.scene)));
        }
        for body in &self.scene.bodies {
            if let (Motion::Driven { position, .. }, Some(motion)) =
                (&body.motion, Prescribed::from_body(body))
            {
                found.push(BodyMotion {
                    body: body.name.clone(),
                    position: vec![*position; time.len()],
                    angle: time.iter().map(|&t| motion.angle(t)).collect(),
                    speed: time.iter().map(|&t| motion.jet(t)[1]).collect(),
                });
            }
        }
        found.sort_by_key(|motion| self.scene.bodies.iter().position(|b| b.name == motion.body));
        found
    }

    /// Name of every joint and a value from the recording of its island, in the scene's order.
    fn joint_values<T>(&self, value: impl Fn(&FullRecording, usize) -> T) -> Vec<(String, T)> {
        let mut all: Vec<(usize, T)> = Vec::new();
        for state in &self.islands {
            let joints = state.island.all_joints();
            if let Some(full) = &state.recorder.full {
                all.extend(joints.enumerate().map(|(k, joint)| (joint, value(full, k))));
            }
        }
        all.sort_by_key(|(joint, _)| *joint);
        all.into_iter().map(|(joint, value)| (self.scene.joints[joint].name.clone(), value)).collect()
    }
}

/// Outputs that follow from the motion of a cycle, zero in the place of the others `(outputs,)` [SI].
fn outputs_of(cycle: &RecordedCycle) -> Vec<f64> {
    cycle.scene.outputs.iter().map(|output| motion_value(&output.kind, cycle)).collect()
}

/// Assembles the result from the outputs over life: counts of the `runs` of all operating conditions, at least one, and bores and motion
/// of the first one, on which all others have run too.
///
/// # Errors
/// [`SimulationFailure::NotFinite`] if a value is not finite.
pub(crate) fn finish(runs: &[Run], life: LifeHistory, first: FirstCycle) -> Simulated<Evaluation> {
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
        worn: run.display.as_ref().and_then(|(_, life)| life.clone()),
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
            worn_energy: run.display.as_ref().and_then(|(energy, _)| *energy),
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
