//! The stages of an evaluation: settle, measure a cycle, wear a block, warm up.

use super::failures::{Simulated, failure, refuse_unbounded_forces, wear_failure, worn_through};
use super::ideal_tracks::{ideal_tracks, left_open};
use super::island_state::{IslandState, StateSnapshot, kept_time};
use super::quasi_static_island::{QuasiStaticIsland, wear_histories};
use super::repetition::Repetition;
use super::side_by_side::LaneQueue;
use crate::integrate::StepCounts;
use crate::mechanism::{WearingPair, ideal_cycle, islands, turns_per_cycle};
use crate::outputs::{FullRecording, IdealTracks, recording_request, sample_times};
use crate::wear::{WearHistory, WearLaw, WearStepStats, WornAmounts, wear_output};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{EnergyBalance, NarrowGroove, PointsError, WornLife};
use common::scene::{Output, Scene};
use std::ops::Range;
use std::slice;

/// A running evaluation.
#[derive(Clone)]
pub struct Run<'a> {
    /// Integrates the islands.
    pub queue: LaneQueue,
    /// The scene, under one of its operating conditions if it has any.
    pub scene: &'a Scene,
    pub accuracy: &'a Accuracy,
    /// Share of the cycles of the life [1].
    pub share: f64,
    /// Contact histories of all conditions together, which wear the bores `(islands, pairs)`; empty with one condition.
    pub mixed: Vec<Vec<WearHistory>>,
    pub islands: Vec<IslandState>,
    /// States of the islands where the ideal mechanism has them at the start `(islands,)`.
    pub starts: Vec<StateSnapshot>,
    /// Cycles worn so far.
    cycle: u32,
    pub counts: StepCounts,
    pub wear_counts: WearStepStats,
    /// Grooves narrower than their journals, one at most for each joint.
    pub grooves: Vec<NarrowGroove>,
    /// Newton iterations of position analyses and of the quasi-static model.
    pub newton: u64,
    /// Cycles simulated so far.
    pub simulated: u64,
    /// Requested motion of the ideal mechanism.
    pub ideal: IdealTracks,
    /// Outputs of the motion in the cycle measured last `(outputs,)` [SI].
    pub measured: Vec<f64>,
    /// Islands on their ideal motion, if the quasi-static model drives the wear.
    pub quasi_static: Vec<QuasiStaticIsland>,
    /// Largest relative difference of the wear rates of the two models for each output, zero unless compared `(outputs,)` [1].
    pub tier_difference: Vec<f64>,
    /// What more control points change in the outputs of the motion, empty where that is not compared `(motion outputs,)`.
    pub points_errors: Vec<PointsError>,
    /// How the motion repeats itself.
    pub repetition: Repetition,
    /// What is displayed of the worn mechanism, if anything is: energy of the last cycle, bores through life and the last cycle itself, as far as they
    /// have been reached.
    pub display: Option<(Option<EnergyBalance>, Option<WornLife>)>,
}

/// Points per cycle of a path on the ideal mechanism; a cubic between two of them has a relative error of some 1e-11.
const PATH_POINTS: usize = 721;

impl<'a> Run<'a> {
    /// Assembles islands, contact laws and round bores; the bodies are where the ideal mechanism has them.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the mechanism cannot be assembled or moved, or an output is not modelled.
    pub(crate) fn assemble(queue: LaneQueue, scene: &'a Scene, accuracy: &'a Accuracy) -> Simulated<Self> {
        let mut newton = 0;
        let mut requested = recording_request(&scene.outputs);
        requested.bodies.extend(scene.life.turn_of);
        let islands = islands(scene)?;
        // A linkage that locks is found here, and not attributed to a contact.
        let samples = if requested.needs_ideal_motion() { PATH_POINTS } else { 2 };
        let poses = ideal_cycle(scene, samples, &mut newton)?;
        let of_ideal = |output: &&Output| recording_request(slice::from_ref(*output)).needs_ideal_motion();
        if let Some(output) = scene.outputs.iter().find(of_ideal).filter(|_| poses.len() < samples) {
            let what = format!(
                "output {}, since {}: an error against the ideal mechanism and a backlash need its motion",
                output.name,
                left_open(scene)
            );
            return Err(SimulationFailure::NotModelled { what });
        }
        let ideal = ideal_tracks(scene, &poses, &requested, &mut newton)?;
        let turns = turns_per_cycle(scene, &poses)?;
        let islands: Vec<IslandState> = islands
            .into_iter()
            .map(|island| IslandState::new(island, (&poses[0], &turns), scene, &requested, accuracy))
            .collect();
        let repetition = Repetition { is_determined: poses.len() > 1, ..Repetition::default() };
        Ok(Run { newton, ideal, repetition, ..Run::of_islands(queue, scene, accuracy, islands) })
    }

    /// A run of these islands, from whose states it starts, without a motion of the ideal mechanism.
    pub(crate) fn of_islands(
        queue: LaneQueue,
        scene: &'a Scene,
        accuracy: &'a Accuracy,
        islands: Vec<IslandState>,
    ) -> Self {
        Run {
            queue,
            scene,
            accuracy,
            share: 1.0,
            mixed: vec![],
            starts: islands.iter().map(|state| state.cycle_start.clone()).collect(),
            islands,
            cycle: 0,
            counts: StepCounts::default(),
            wear_counts: WearStepStats::default(),
            grooves: vec![],
            newton: 0,
            simulated: 0,
            ideal: IdealTracks::default(),
            measured: vec![0.0; scene.outputs.len()],
            quasi_static: vec![],
            tier_difference: vec![0.0; scene.outputs.len()],
            points_errors: vec![],
            repetition: Repetition::default(),
            display: None,
        }
    }

    /// Simulates a cycle from the present state without recording it; the time steps start small.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn settling_cycle(&mut self) -> Simulated<()> {
        self.islands.iter_mut().for_each(|state| state.stepper.control.after_jump());
        self.integrate(-self.scene.life.period..0.0, false).await?;
        self.simulated += 1;
        Ok(())
    }

    /// Counts from zero on.
    pub(crate) fn begin_count(&mut self) {
        (self.counts, self.simulated) = (StepCounts::default(), 0);
    }

    /// Adds what a run counted that was simulated for this one.
    pub(crate) fn add_counts(&mut self, of: &Run) {
        self.counts.add(&of.counts);
        self.simulated += of.simulated;
    }

    /// Copies the counts of an attempt that began as a copy of this run.
    pub(crate) fn copy_counts(&mut self, attempt: &Run) {
        self.counts = attempt.counts;
        self.wear_counts = attempt.wear_counts;
        self.newton = attempt.newton;
        self.simulated = attempt.simulated;
    }

    /// Takes over the bores of another run of the same mechanism.
    pub(crate) fn take_bores(&mut self, from: &Run) {
        self.cycle = from.cycle;
        for (to, from) in self.islands.iter_mut().zip(&from.islands) {
            to.depth.clone_from(&from.depth);
            to.island.pairs_mut().zip(&from.depth).for_each(|(pair, depth)| pair.set_depth(depth));
        }
    }

    /// True if a joint wears.
    pub(crate) fn wears(&self) -> bool {
        self.islands.iter().any(|m| m.island.pairs().any(WearingPair::wears))
    }

    /// Integrates from the state kept of the cycle before, on the profile as it is now, to the start of a cycle.
    async fn warm_up(&mut self) -> Simulated<()> {
        for state in &mut self.islands {
            state.restore(state.warm_up_start.clone());
            state.stepper.control.after_jump();
        }
        let period = self.scene.life.period;
        self.integrate(-self.accuracy.warm_up * period..0.0, false).await
    }

    /// Gives the islands the time steps of these accuracies in the following cycles `(islands,)`.
    pub(crate) fn set_steps(&mut self, steps: &[Accuracy]) {
        let islands = self.islands.iter_mut().zip(steps);
        islands.for_each(|(state, accuracy)| state.stepper.control.tolerance = accuracy.step_tolerance);
    }

    /// Returns to the start of the cycle just measured, with time steps of another accuracy.
    pub(crate) fn restart_cycle(&mut self, accuracy: &Accuracy) {
        for state in &mut self.islands {
            state.restore_cycle_start();
            let mut tools = state.tools_for(self.scene.life.period, accuracy);
            state.exchange_tools(&mut tools);
        }
    }

    /// Simulates and records one cycle; keeps the state from which the next warm-up starts.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn measure(&mut self) -> Simulated<()> {
        let (period, kept) = (self.scene.life.period, kept_time(self.scene, self.accuracy));
        for state in &mut self.islands {
            state.recorder.clear();
            state.cycle_start = state.snapshot();
        }
        if self.islands.iter().any(|state| state.recorder.full.is_some()) {
            self.start_full_recording();
        }
        if kept > 0.0 {
            self.integrate(0.0..kept, true).await?;
        }
        self.islands.iter_mut().for_each(|state| state.warm_up_start = state.snapshot());
        self.integrate(kept..period, true).await?;
        for state in &mut self.islands {
            state.recorder.finish();
            if kept == 0.0 {
                state.warm_up_start = state.snapshot();
            }
        }
        self.measured = self.motion_outputs();
        self.simulated += 1;
        Ok(())
    }

    /// Simulates warm-up and measured cycle on the profile as it is now.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn next_cycle(&mut self) -> Simulated<()> {
        self.warm_up().await?;
        self.measure().await
    }

    /// Simulates the last measured cycle by the dynamics, on the bores at the end of life; keeps it and its energy if cycles are
    /// displayed.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn last_cycle(&mut self) -> Simulated<()> {
        if self.display.is_none() {
            return self.next_settled_cycle().await;
        }
        self.start_full_recording();
        self.next_settled_cycle().await?;
        let (energy, history) = (self.energy(), self.cycle_history());
        let (balance, life) = self.display.get_or_insert_default();
        *balance = Some(energy);
        life.get_or_insert_default().last_cycle = Some(history);
        self.stop_full_recording();
        Ok(())
    }

    /// Simulates the cycle after the one just measured, on the same profile.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn further_cycle(&mut self) -> Simulated<()> {
        self.islands.iter_mut().for_each(|state| state.recorder.clear());
        self.integrate(0.0..self.scene.life.period, true).await?;
        self.islands.iter_mut().for_each(|state| state.recorder.finish());
        self.simulated += 1;
        Ok(())
    }

    /// Keeps the bores as they are at `life` [cycles], if cycles are displayed.
    pub(crate) fn keep_bores(&mut self, life: u32) {
        if self.display.is_none() {
            return;
        }
        let depths = self.depths().into_iter().map(|[bore, _]| bore).collect();
        let worn = self.display.get_or_insert_default().1.get_or_insert_default();
        worn.cycles.push(life);
        worn.wear_depth.push(depths);
    }

    /// Contact histories of the cycle simulated last under this condition `(islands, pairs)`.
    pub(crate) fn contact_histories(&self) -> impl Iterator<Item = &[WearHistory]> {
        let islands = self.islands.iter().enumerate();
        islands.map(|(index, state)| wear_histories(&[], &self.quasi_static, &state.recorder, index))
    }

    /// Integrates every island over a span of the cycle [s], recording it or not.
    pub(super) async fn integrate(&mut self, time: Range<f64>, record: bool) -> Simulated<()> {
        let period = self.scene.life.period;
        let mut islands = std::mem::take(&mut self.islands);
        islands.iter_mut().for_each(|state| state.begin(time.start, period));
        let mut first = Ok(());
        for (mut state, counts, result) in self.queue.integrate(islands, &time, record).await {
            state.time = time.end;
            self.counts.add(&counts);
            first = first.and(result.map_err(|error| failure(error, self.cycle, &state.island, self.scene)));
            first = first.and(refuse_unbounded_forces(self.scene, &state.island, counts.passages));
            self.islands.push(state);
        }
        first
    }

    /// Records the forces of all joints in the following cycles, and everything if cycles are displayed.
    pub(crate) fn start_full_recording(&mut self) {
        let shown = self.display.is_some().then(|| sample_times(self.scene));
        for state in &mut self.islands {
            state.recorder.full = Some(FullRecording::new(&state.island, shown.clone()));
        }
    }

    /// Records of the following cycles only what wear and outputs need.
    pub(crate) fn stop_full_recording(&mut self) {
        self.islands.iter_mut().for_each(|state| state.recorder.full = None);
    }

    /// Wears every bore over a block of the life [cycles] under the contact of the cycle just measured, and adds the wear outputs at
    /// the `checkpoints` within to `wear` `(outputs, m)` [m or m^3]. Finer copies are left to [`IslandState::wear_copies`].
    ///
    /// # Errors
    /// [`SimulationFailure`] if a wear step fails or a wall is worn through.
    pub(crate) fn wear(
        &mut self,
        block: Range<u32>,
        checkpoints: &[u32],
        wear: &mut [Vec<f64>],
    ) -> Simulated<()> {
        let Range { start: from, end: to } = block;
        let marks: Vec<f64> = checkpoints.iter().map(|&c| f64::from(c - from)).collect();
        // Wear at each checkpoint of each joint of the scene `(checkpoints, joints)`.
        let mut marked = vec![vec![WornAmounts::default(); self.scene.joints.len()]; marks.len()];
        for (index, state) in self.islands.iter_mut().enumerate() {
            let histories = wear_histories(&self.mixed, &self.quasi_static, &state.recorder, index);
            for (k, pair) in state.island.pairs_mut().enumerate() {
                if !pair.wears() {
                    continue;
                }
                let (rate, depth) = (&mut state.rates[k], &mut state.depth[k]);
                rate.freeze(&histories[k]);
                let (sizes, scene_joint) = (rate.sizes(), pair.scene_joint());
                let note = |mark: usize, depths: [&[f64]; 2]| {
                    marked[mark][scene_joint] = sizes.amounts_at(depths);
                };
                let length = f64::from(to - from);
                let within = marks.partition_point(|mark| *mark < length);
                if let Some(finer) = state.finer.get_mut(k) {
                    finer.next_marks = marks[..within].to_vec();
                }
                for finer in
                    [&mut state.finer, &mut state.finest].into_iter().filter_map(|all| all.get_mut(k))
                {
                    finer.freeze(&histories[k], length, sizes.amounts(depth));
                }
                let advanced =
                    state.steps[k].advance(rate, depth, length, &marks, note, &mut self.wear_counts);
                rate.release();
                advanced.map_err(|failed| wear_failure(&self.scene.joints[scene_joint], from, failed))?;
                if let Some(finer) = state.finer.get_mut(k) {
                    finer.next_marked = marked[..within].iter().map(|joints| joints[scene_joint]).collect();
                }
                let surfaces = depth.split_at(pair.first_depths());
                if let Some((depth, wall)) = worn_through(self.scene, scene_joint, surfaces.into()) {
                    let joint = self.scene.joints[scene_joint].name.clone();
                    return Err(SimulationFailure::WornThrough { cycle: to, joint, depth, wall });
                }
                pair.set_depth(depth);
            }
        }
        for (output, history) in self.scene.outputs.iter().zip(wear) {
            if let Some((quantity, joints)) = output.kind.wear() {
                let value = |worn: &Vec<_>| wear_output(quantity, joints.iter().map(|&j| worn[j]));
                history.extend(marked.iter().map(value));
            }
        }
        self.cycle = to;
        Ok(())
    }
}
