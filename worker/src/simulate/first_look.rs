//! What an evaluation of a scene will do and cost, from its settled first cycle alone.

use super::desk::Desk;
use super::probe::due;
use super::run::Run;
use super::together::alone;
use crate::life::Course;
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
    /// Unknowns: three a body.
    pub unknowns: usize,
    /// Scalar constraints of the ideal joints.
    pub constraints: usize,
}

/// What was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstLook {
    /// Islands, each integrated with steps of its own.
    pub islands: Vec<IslandModel>,
    /// Whether anything wears, so that more than one cycle is simulated.
    pub wears: bool,
    /// Largest relative difference of the quasi-static tier's wear rates from the dynamics on the unworn bores, if it
    /// may drive the wear, or why not.
    pub tier: Result<f64, Unsuitable>,
    /// Time steps of the measured cycle, all islands together.
    pub steps_per_cycle: u64,
    /// Cycles that a whole evaluation simulates dynamically: settling, measuring, warming up, probing. Where the length
    /// of the blocks is chosen on the way, the fewest.
    pub dynamic_cycles: f64,
    /// Cycles that it simulates quasi-statically.
    pub quasi_static_cycles: f64,
}

/// Looks at a scene: assembles it, settles, measures a cycle, and tries the quasi-static tier on it.
///
/// # Errors
/// [`SimulationFailure`] as of an evaluation.
pub fn first_look(scene: &Scene, accuracy: &Accuracy) -> Result<FirstLook, SimulationFailure> {
    alone(|desk| look(desk, scene, accuracy))
}

async fn look(desk: Desk, scene: &Scene, accuracy: &Accuracy) -> Result<FirstLook, SimulationFailure> {
    let mut run = Run::assemble(desk, scene, accuracy)?;
    let names = |bodies: &[usize]| bodies.iter().map(|&b| scene.bodies[b].name.clone()).collect();
    let islands = run.islands.iter().map(|m| IslandModel {
        bodies: names(&m.island.bodies),
        contacts: m.island.joints.iter().map(|j| j.name.clone()).collect(),
        ideal_joints: m
            .island
            .constraints()
            .iter()
            .map(|c| scene.joints[c.scene_joint].name.clone())
            .collect(),
        unknowns: m.island.coordinates(),
        constraints: m.island.constraint_rows(),
    });
    let islands = islands.collect();
    run.settle().await?;
    let before = run.stats.steps;
    run.measure().await?;
    let steps_per_cycle = run.stats.steps - before;
    let wears = run.wears();
    let tier = run.usable_tier();
    let settle = f64::from(scene.life.settle_cycles);
    let (mut dynamic_cycles, mut quasi_static_cycles) = (settle + 1.0, 0.0);
    if !wears {
        // The cycle once more, at half the step, for its error.
        dynamic_cycles += 2.0;
    } else {
        let (end, every) = (scene.life.cycles, scene.life.checkpoint_every);
        let mut course = Course::new(end, accuracy.cycle_jump, every, accuracy.jump_tolerance, vec![]);
        while course.next_life().is_some() {}
        let lives = course.lives();
        let blocks = (lives.len() - 1) as f64;
        let warm = 1.0 + accuracy.warm_up;
        if tier.is_ok() {
            dynamic_cycles += warm;
            quasi_static_cycles = (blocks + 1.0) * warm;
        } else {
            let probes = lives.windows(2).filter(|w| due(w[0], w[1], every, end)).count() as f64;
            dynamic_cycles += blocks * warm + probes * super::probe::FINER;
        }
    }
    Ok(FirstLook { islands, wears, tier, steps_per_cycle, dynamic_cycles, quasi_static_cycles })
}
