//! A life whose cycles another program simulates, on the surfaces as worn so far: blocks, wear, checkpoints and stated errors are those of
//! lives of this program's own mechanics.
//!
//! A cycle gives for every joint and instant the normal force F [N] of the journal on the bushing, in the bushing's frame, and the sliding
//! speed v_t [m/s]. What the wear needs besides is the place of the contact:
//!
//! - with the eccentricity e [m] of the program, that and its penetration by the contact law of the joint on the surfaces of the request;
//! - without it, the equilibrium of F on the worn surfaces: e in the direction of F, with the penetration (F / K)^(2/3) [m] at first. Under
//!   `foundation` the wear finds the equilibrium again on every profile (`wear/conformal.rs`).
//!
//! Of a slider in a guide the cycle gives the force and the moment that both faces carry, and its position; how the faces share them follows from
//! their shape (`wear/rail_equilibrium.rs`), in both tiers.
//!
//! The cycles of a program with ideal joints depend on no surface: one of them serves the whole life.
//!
//! The stated error of the wear contains what the distance of the instants leaves, besides that of wear steps, blocks and control points.
//!
//! # Source
//! The loop: Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020, with a multibody
//! program for the cycles.

use super::conditions::condition_scenes;
use super::island_state::IslandState;
use super::partial_life::CycleModel;
use super::program_history::cycle_history;
use super::{FirstCycle, Run, SimulateOptions, finish, run_alone, simulate_life};
use crate::contact::{JointForce, equivalent_penetration};
use crate::mechanism::{Pose, WearingJoint, WearingPair, island_of_program};
use crate::outputs::RecordingRequest;
use crate::wear::{ContactHistory, ContactInstant, RailHistory, RailInstant, WearHistory};
use common::accuracy::NamedAccuracy;
use common::external::{
    CycleContacts, CycleReply, CycleRequest, CyclesOfLife, JointCycle, SlotError, WornSurfaces,
};
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Condition, CycleTier, JointKind, Scene};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::{ptr, thread};
use thiserror::Error;

/// Change of the depths between two requests, as a share of the clearance, from which on equal replies show a program that ignores them [1].
const NOTICED: f64 = 1e-3;

/// Why a life has no result.
#[derive(Debug, Error)]
pub enum CycleError {
    /// A failure of the sample.
    #[error(transparent)]
    Failed(#[from] SimulationFailure),
    /// The program cannot be used, or the life was stopped.
    #[error(transparent)]
    Slot(#[from] SlotError),
}

/// The life of the sample that gives `scene`, with the cycles of a program of this tier.
///
/// # Errors
/// [`CycleError`].
pub fn simulate_program_life(
    scene: &Scene,
    NamedAccuracy { name, accuracy }: &NamedAccuracy,
    tier: CycleTier,
    cycles: &mut CyclesOfLife,
    options: SimulateOptions,
) -> Result<Evaluation, CycleError> {
    let run = |queue, (scene, share): (_, f64)| {
        let scene: &Scene = scene;
        let nothing = vec![None; scene.bodies.len()];
        let pose = Pose { time: 0.0, q: nothing.clone(), v: nothing };
        let turns = vec![0.0; scene.bodies.len()];
        let island = island_of_program(scene);
        let state = IslandState::new(island, (&pose, &turns), scene, &RecordingRequest::default(), accuracy);
        let mut run = Run::of_islands(queue, scene, accuracy, vec![state]);
        run.share = share;
        run.display = options.first_cycle.then(Default::default);
        run
    };
    let answered = Answered { cycles, last: BTreeMap::new(), sampling_error: 0.0 };
    run_alone(async |queue| {
        let mut runs: Vec<Run> =
            condition_scenes(scene).into_iter().map(|condition| run(queue.clone(), condition)).collect();
        let model = ProgramCycles { name, tier, scene, answered: &RefCell::new(answered) };
        runs.iter_mut().try_for_each(|run| model.measure(run, 0))?;
        let first = runs.iter().map(|run| (run.share, model.first_cycle(run))).collect();
        let Some(first) = FirstCycle::of_conditions(first) else { unreachable!("at least one condition") };
        let mut life = simulate_life(&mut runs, model).await?;
        let share = model.answered.borrow().sampling_error;
        let outputs = scene.outputs.iter().zip(&life.histories).zip(&mut life.errors);
        for ((_, values), errors) in outputs.filter(|((output, _), _)| output.kind.wear().is_some()) {
            errors.iter_mut().zip(values).for_each(|(error, value)| *error += share * value.abs());
        }
        Ok(finish(&runs, life, first)?)
    })
}

/// Requests and replies of a life so far.
struct Answered<'a, 'c> {
    cycles: &'a mut CyclesOfLife<'c>,
    /// By condition the last reply, and the depths at which it was asked for, of all joints one after the other [m].
    last: BTreeMap<Option<&'a str>, (CycleReply, Vec<f64>)>,
    /// Largest relative error of the work of a joint by the distance of the instants [1].
    sampling_error: f64,
}

/// Cycles of a program.
#[derive(Clone, Copy)]
struct ProgramCycles<'m, 'a, 'c> {
    /// Name of the accuracy.
    name: &'m str,
    tier: CycleTier,
    /// The scene with its conditions.
    scene: &'a Scene,
    answered: &'m RefCell<Answered<'a, 'c>>,
}

impl CycleModel for ProgramCycles<'_, '_, '_> {
    type Error = CycleError;

    async fn simulate_cycle(&self, run: &mut Run<'_>, block: &Range<u32>) -> Result<bool, CycleError> {
        self.measure(run, block.end)?;
        // A cycle that serves the whole life is displayed as the first one.
        if block.end == run.scene.life.cycles && self.tier == CycleTier::Contact && run.display.is_some() {
            let last = self.of_measured(run, |joints| cycle_history(run.scene, joints));
            run.display.get_or_insert_default().1.get_or_insert_default().last_cycle = Some(last);
        }
        Ok(true)
    }

    fn is_probed(&self, _run: &Run, _block: Option<&Range<u32>>) -> bool {
        false
    }
}

impl<'a> ProgramCycles<'_, 'a, '_> {
    /// The operating condition of a run, if the scene has any.
    fn condition(&self, run: &Run) -> Option<&'a Condition> {
        self.scene.conditions.iter().find(|condition| ptr::eq(&condition.scene, run.scene))
    }

    /// Measures the cycle of the life `cycle` [cycles] on the surfaces of the run: its contacts and outputs.
    fn measure(&self, run: &mut Run, cycle: u32) -> Result<(), CycleError> {
        let condition = self.condition(run);
        let name = condition.map(|condition| &*condition.name);
        let mut answered = self.answered.borrow_mut();
        let Answered { cycles, last, sampling_error } = &mut *answered;
        let [state] = &mut run.islands[..] else { unreachable!("a program has one island") };
        let depths = state.depth.concat();
        let reply = match last.remove(&name) {
            Some((reply, _)) if self.tier == CycleTier::Reaction => reply,
            before => {
                let joints = surfaces(run.scene, state);
                let (scene, accuracy) = (run.scene, self.name);
                let request = CycleRequest { scene, condition, cycle, accuracy, joints: &joints };
                let reply = ask_and_wear_copies(cycles, &request, state)?;
                run.simulated += 1;
                let least = run.scene.joints.iter().filter_map(|joint| match &joint.kind {
                    JointKind::Clearance(clearance) => {
                        Some(clearance.bushing_radius - clearance.journal_radius)
                    }
                    JointKind::Guide(guide) => Some(guide.clearance),
                    _ => None,
                });
                let least = NOTICED * least.fold(f64::INFINITY, f64::min);
                if let Some((before, at)) = before
                    && before.joints == reply.joints
                    && at.iter().zip(&depths).any(|(before, now)| (now - before).abs() > least)
                {
                    let fault = format!(
                        "cycle {cycle}: joints have the same contacts as on the surfaces before: the program ignores the radii of the \
                         request (tier = \"reaction\" is for programs with ideal joints)"
                    );
                    return Err(cycles.broken(fault).into());
                }
                reply
            }
        };
        *sampling_error = sampling_error.max(reply.sampling_error);
        let pairs = state.island.pairs().zip(&mut state.recorder.histories);
        for (k, ((pair, history), cycle)) in pairs.zip(&reply.joints).enumerate() {
            match (history, &run.scene.joints[pair.scene_joint()].kind) {
                (WearHistory::Bore(history), _) => record(&state.island.joints[k], cycle, history),
                (WearHistory::Rail(history), JointKind::Guide(guide)) => {
                    record_guide(0.5 * guide.length, cycle, history);
                }
                _ => unreachable!("rails are of guides"),
            }
        }
        run.measured.clone_from(&reply.outputs);
        last.insert(name, (reply, depths));
        Ok(())
    }

    /// What `of` makes of the joints of the cycle measured last, with their names, in the order of the scene.
    fn of_measured<T>(&self, run: &Run, of: impl Fn(&[(&String, &JointCycle)]) -> T) -> T {
        let answered = self.answered.borrow();
        let name = self.condition(run).map(|condition| &*condition.name);
        let cycles = answered.last.get(&name).into_iter().flat_map(|(reply, _)| &reply.joints);
        let joints = run.islands.iter().flat_map(|state| state.island.pairs());
        let mut found: Vec<_> = joints.map(WearingPair::scene_joint).zip(cycles).collect();
        // Guides follow the hinges in a reply, and are where the scene has them in a result.
        found.sort_by_key(|(joint, _)| *joint);
        let named = found.into_iter().map(|(joint, cycle)| (&run.scene.joints[joint].name, cycle));
        of(&named.collect::<Vec<_>>())
    }

    /// Summary of the cycle measured last, with its history if cycles are displayed.
    fn first_cycle(&self, run: &Run) -> FirstCycle {
        let peak = |cycle: &JointCycle| cycle.normal.iter().copied().fold(0.0, f64::max);
        let free = |cycle: &JointCycle| {
            let at = (0..cycle.time.len()).filter(|&k| cycle.normal[k] == 0.0);
            at.map(|k| weight(&cycle.time, k)).sum::<f64>() / run.scene.life.period
        };
        self.of_measured(run, |joints| FirstCycle {
            history: run.display.as_ref().map(|_| cycle_history(run.scene, joints)),
            peaks: joints.iter().map(|(name, cycle)| ((*name).clone(), peak(cycle))).collect(),
            free_flight: joints.iter().map(|(name, cycle)| ((*name).clone(), free(cycle))).collect(),
            energy: None,
        })
    }
}

/// The reply to a request; the finer copies of the surfaces, which it does not depend on, are worn while the program simulates.
fn ask_and_wear_copies(
    cycles: &mut CyclesOfLife,
    request: &CycleRequest,
    state: &mut IslandState,
) -> Result<CycleReply, CycleError> {
    let reply = thread::scope(|scope| {
        let copies = thread::Builder::new().name("copies".to_owned());
        copies.spawn_scoped(scope, || state.wear_copies()).map_err(SlotError::Thread)?;
        cycles.ask(request)
    });
    Ok(reply??)
}

/// All surfaces as worn so far, by the names of the joints.
fn surfaces(scene: &Scene, state: &IslandState) -> BTreeMap<String, WornSurfaces> {
    let of_pair = |(k, (pair, depth)): (usize, (&dyn WearingPair, &Vec<f64>))| {
        let (first, second) = depth.split_at(pair.first_depths());
        let surfaces = match state.island.joints.get(k) {
            Some(joint) => {
                let unworn = joint.contact.surface().journal_radius;
                let bushing = first.iter().map(|depth| joint.profile.initial_radius + depth).collect();
                let mut journal: Vec<f64> = second.iter().map(|depth| unworn - depth).collect();
                journal.resize(first.len(), unworn);
                WornSurfaces::Bore { bushing, journal }
            }
            None => WornSurfaces::Guide { guide: first.to_vec(), slider: second.to_vec() },
        };
        (scene.joints[pair.scene_joint()].name.clone(), surfaces)
    };
    state.island.pairs().zip(&state.depth).enumerate().map(of_pair).collect()
}

/// Weight of an instant by the trapezoidal rule: half of the steps on both sides [s].
fn weight(time: &[f64], k: usize) -> f64 {
    0.5 * (time[(k + 1).min(time.len() - 1)] - time[k.saturating_sub(1)])
}

/// Replaces the `history` of a joint by the contacts of a cycle.
fn record(joint: &WearingJoint, cycle: &JointCycle, history: &mut ContactHistory) {
    history.clear();
    let CycleContacts::Bore { force, angle, eccentricity } = &cycle.contacts else { return };
    let surface = joint.contact.surface();
    for (k, (force, normal)) in force.iter().zip(&cycle.normal).enumerate() {
        let turn = angle.as_ref().map_or(0.0, |angle| angle[k]);
        let mut at = ContactInstant::default();
        if *normal > 0.0 {
            let direction = force.map(|f| f / normal);
            let of_force = equivalent_penetration(*normal, surface.stiffness);
            let balanced = || direction.map(|u| (surface.clearance + of_force) * u);
            let e = eccentricity.as_ref().map_or_else(balanced, |e| e[k]);
            // By another contact law the journal may not reach the wall here.
            let reached = eccentricity.as_ref().map(|_| joint.penetration(e, turn));
            let penetration = reached.filter(|depth| *depth > 0.0).unwrap_or(of_force);
            let sliding = cycle.sliding[k];
            let contact =
                JointForce { normal: *normal, direction, penetration, sliding, ..JointForce::default() };
            at = ContactInstant::new(e, &contact).turned(turn);
        }
        history.push(weight(&cycle.time, k), &at);
    }
    history.close_interval();
}

/// Replaces the `history` of a guide, with a slider of this half length [m], by the contacts of a cycle.
fn record_guide(half_length: f64, cycle: &JointCycle, history: &mut RailHistory) {
    history.clear();
    let CycleContacts::Guide { load, position } = &cycle.contacts else { return };
    for (k, load) in load.iter().enumerate() {
        let at = RailInstant::of_load(*load, cycle.normal[k], half_length, [position[k], cycle.sliding[k]]);
        history.push(weight(&cycle.time, k), &at);
    }
    history.close_interval();
}
