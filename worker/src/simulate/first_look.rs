//! Model and cost of the evaluation of a scene, from its settled first cycle alone.

use super::blocks::block_ends;
use super::probe::{FINER, is_probed};
use super::run::Run;
use super::side_by_side::{LaneQueue, run_alone};
use crate::mechanism::Island;
use crate::quasi_static::Unsuitable;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::Scene;

/// The model of one island.
#[derive(Debug, Clone, PartialEq)]
pub struct IslandModel {
    /// Names of the bodies with unknowns.
    pub bodies: Vec<String>,
    /// Names of the joints with clearance.
    pub contacts: Vec<String>,
    /// Names of the ideal joints.
    pub ideal_joints: Vec<String>,
    /// Number of unknowns: three a body.
    pub unknowns: usize,
    /// Number of scalar constraints of the ideal joints.
    pub constraints: usize,
}

impl IslandModel {
    fn new(scene: &Scene, island: &Island) -> Self {
        let ideal_joints = island.constraints().iter().map(|c| scene.joints[c.scene_joint].name.clone());
        IslandModel {
            bodies: island.bodies.iter().map(|&b| scene.bodies[b].name.clone()).collect(),
            contacts: island.joints.iter().map(|j| j.name.clone()).collect(),
            ideal_joints: ideal_joints.collect(),
            unknowns: island.coordinates(),
            constraints: island.constraint_rows(),
        }
    }
}

/// Model and cost of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstLook {
    /// Islands, each integrated with its own time steps.
    pub islands: Vec<IslandModel>,
    /// True if a joint wears, so that more than one cycle is simulated.
    pub wears: bool,
    /// Largest relative difference of the quasi-static wear rates from those of the dynamics on the unworn bores [1], or the reason
    /// why the dynamics has to drive the wear.
    pub tier: Result<f64, Unsuitable>,
    /// Accepted time steps of the measured cycle, all islands together.
    pub steps_per_cycle: u64,
    /// Cycles that a whole evaluation simulates dynamically: settling, measuring, warming up, probing; a cycle with shorter time
    /// steps counts as more.
    pub dynamic_cycles: f64,
    /// Cycles that it simulates quasi-statically, warming up included.
    pub quasi_static_cycles: f64,
}

/// Assembles a scene, settles it, measures a cycle, and tries the quasi-static model on it.
///
/// # Errors
/// [`SimulationFailure`] as in an evaluation.
pub fn first_look(scene: &Scene, accuracy: &Accuracy) -> Result<FirstLook, SimulationFailure> {
    run_alone(|queue| examine(queue, scene, accuracy))
}

async fn examine(
    queue: LaneQueue,
    scene: &Scene,
    accuracy: &Accuracy,
) -> Result<FirstLook, SimulationFailure> {
    let mut run = Run::assemble(queue, scene, accuracy)?;
    let islands = run.islands.iter().map(|state| IslandModel::new(scene, &state.island)).collect();
    run.settle().await?;
    let before = run.counts.steps;
    run.measure().await?;
    let steps_per_cycle = run.counts.steps - before;
    let wears = run.wears();
    let tier = run.check_quasi_static();
    let settle = f64::from(scene.life.settle_cycles);
    let (mut dynamic_cycles, mut quasi_static_cycles) = (settle + 1.0, 0.0);
    if !wears {
        // A second run of the cycle, at half the step, for its error.
        dynamic_cycles += 2.0;
    } else {
        let (end, every) = (scene.life.cycles, scene.life.checkpoint_every);
        let lives = block_ends(end, accuracy.cycle_jump, every);
        let blocks = (lives.len() - 1) as f64;
        let warm = 1.0 + accuracy.warm_up;
        if tier.is_ok() {
            dynamic_cycles += warm;
            quasi_static_cycles = (blocks + 1.0) * warm;
        } else {
            let probes = lives.windows(2).filter(|w| is_probed(w[0]..w[1], every, end)).count() as f64;
            dynamic_cycles += blocks * warm + probes * FINER;
        }
    }
    Ok(FirstLook { islands, wears, tier, steps_per_cycle, dynamic_cycles, quasi_static_cycles })
}
