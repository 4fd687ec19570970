//! Model and cost of the evaluation of a scene, from its settled first cycle and a first block of wear.

use super::blocks::simulated_lives;
use super::conditions::condition_scenes;
use super::control_points::contact_arcs;
use super::island_state::IslandState;
use super::longer_steps::{difference, is_long_enough, longer};
use super::probe::{FINER, is_probed};
use super::quasi_static::is_measured;
use super::several_cycles::MOTIONS;
use super::{ContactArc, LaneQueue, Run, Simulated, run_alone, with_control_points, with_period_of_turn};
use crate::mechanism::Island;
use crate::quasi_static::Unsuitable;
use common::accuracy::Accuracy;
use common::scene::Scene;
use std::ops::Range;
use std::time::{Duration, Instant};

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
        let ideal_joints = island.ideal.constraints.iter().map(|c| scene.joints[c.scene_joint].name.clone());
        IslandModel {
            bodies: island.bodies.iter().map(|&b| scene.bodies[b].name.clone()).collect(),
            contacts: island.contacts().map(|joint| scene.joints[joint].name.clone()).collect(),
            ideal_joints: ideal_joints.collect(),
            unknowns: island.coordinates(),
            constraints: island.ideal.rows,
        }
    }
}

/// Model and cost of an evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstLook {
    /// Islands, each integrated with its own time steps.
    pub islands: Vec<IslandModel>,
    /// Contact arcs of the joints that wear.
    pub arcs: Vec<ContactArc>,
    /// True if a joint wears, so that more than one cycle is simulated.
    pub wears: bool,
    /// True if an output other than wear is asked for.
    pub asks_for_motion: bool,
    /// Largest relative difference of the quasi-static wear rates from those of the dynamics on the unworn bores [1], or the reason
    /// why the dynamics has to drive the wear.
    pub tier: Result<f64, Unsuitable>,
    /// Accepted time steps of the measured cycle, all islands and operating conditions together.
    pub steps_per_cycle: u64,
    /// Cycles that a whole evaluation simulates dynamically: settling, measuring, warming up, probing; a cycle with shorter time
    /// steps counts as more, one with longer steps as less.
    pub dynamic_cycles: f64,
    /// Cycles that it simulates quasi-statically, warming up included.
    pub quasi_static_cycles: f64,
    /// Expected time of a whole evaluation.
    pub expected: Duration,
}

/// Assembles a scene, settles it, measures a cycle, tries the quasi-static model on it, probes it, and wears a copy of the bores over a
/// first block, each part timed.
///
/// # Errors
/// [`common::failure::SimulationFailure`] as in an evaluation.
pub fn first_look(scene: &Scene, accuracy: &Accuracy) -> Simulated<FirstLook> {
    let timed = run_alone(|queue| async move { with_period_of_turn(&queue, scene, accuracy).await })?;
    let scene = timed.as_ref().unwrap_or(scene);
    let numbered = run_alone(|queue| async move { with_control_points(&queue, scene).await })?;
    let scene = numbered.as_ref().map_or(scene, |(numbered, ..)| numbered);
    let look = |scene| run_alone(|queue| examine(queue, scene, accuracy));
    let mut conditions = condition_scenes(scene).into_iter().map(|(scene, _)| look(scene));
    let Some(first) = conditions.next() else { unreachable!("at least one condition") };
    conditions.try_fold(first?, |all, condition| Ok(all.with_condition(condition?)))
}

impl FirstLook {
    /// The costs of both; the quasi-static model drives the wear only if it may under either condition.
    fn with_condition(mut self, other: FirstLook) -> Self {
        self.steps_per_cycle += other.steps_per_cycle;
        self.dynamic_cycles += other.dynamic_cycles;
        self.quasi_static_cycles += other.quasi_static_cycles;
        self.expected += other.expected;
        self.arcs.iter_mut().zip(&other.arcs).for_each(|(arc, other)| arc.join(other));
        self.tier = match (self.tier, other.tier) {
            (Ok(one), Ok(other)) => Ok(one.max(other)),
            (Err(reason), _) | (_, Err(reason)) => Err(reason),
        };
        self
    }
}

/// Result of a stage, and the time it took.
async fn timed<T>(stage: impl Future<Output = Simulated<T>>) -> Simulated<(T, Duration)> {
    let begun = Instant::now();
    let result = stage.await?;
    Ok((result, begun.elapsed()))
}

async fn examine(queue: LaneQueue, scene: &Scene, accuracy: &Accuracy) -> Simulated<FirstLook> {
    let begun = Instant::now();
    let mut run = Run::assemble(queue, scene, accuracy)?;
    let islands = run.islands.iter().map(|state| IslandModel::new(scene, &state.island)).collect();
    run.settle().await?;
    run.start_full_recording();
    let before = (run.counts.steps, run.simulated);
    let settled = begun.elapsed();
    let ((), measured) = timed(run.measure_first()).await?;
    run.stop_full_recording();
    // More than one if the motion had not settled.
    let cycles = run.simulated - before.1;
    let cycle = measured / cycles as u32;
    let mut look = FirstLook {
        islands,
        arcs: contact_arcs(run.scene, &run.islands),
        wears: run.wears(),
        asks_for_motion: run.first_motion_output().is_some(),
        tier: Err(Unsuitable::Unwanted),
        steps_per_cycle: (run.counts.steps - before.0) / cycles,
        dynamic_cycles: run.simulated as f64,
        quasi_static_cycles: 0.0,
        expected: settled + measured,
    };
    if !look.wears {
        // A second run of the cycle, at half the step, for its error.
        look.dynamic_cycles += 2.0;
        look.expected += 2 * cycle;
        return Ok(look);
    }
    let begun = Instant::now();
    let mut worn = run.clone();
    look.tier = worn.start_quasi_static().map(|()| worn.largest_tier_difference());
    let tried = begun.elapsed();
    if look.tier.is_err() {
        worn = run.clone();
    }
    let life = &scene.life;
    let lives = simulated_lives(scene, accuracy);
    let blocks = lives.len() - 1;
    let count = |counts: &dyn Fn(&Range<u32>) -> bool| {
        lives.windows(2).filter(|ends| counts(&(ends[0]..ends[1]))).count() as f64
    };
    let probes = count(&|block| is_probed(block, life));
    let warm = 1.0 + accuracy.warm_up;
    let wear = worn.time_of_wear(&lives);
    look.expected += wear;
    // Time of a cycle on worn bores over that of the first one, where it begins with the state of the gaps.
    let slower = if look.tier.is_ok() && worn.quasi_static_cycle().is_ok() {
        let worn_cycle = timed(worn.next_cycle()).await;
        worn_cycle.map_or(1.0, |((), time)| time.as_secs_f64() / (warm * cycle.as_secs_f64()))
    } else {
        1.0
    };
    let probe = if look.tier.is_err() || look.asks_for_motion {
        let counted = run.simulated;
        let (probe, probing) = timed(run.probe(0)).await?;
        let cycles = (run.simulated - counted) as f64;
        look.dynamic_cycles += FINER * cycles;
        look.expected += probing;
        if look.tier.is_ok() && probe.aperiodic {
            look.tier = Err(Unsuitable::Aperiodic);
        }
        // A probe is as many cycles as on the unworn bores if the motion is irregular there, else one.
        let share = if probe.aperiodic { 1.0 } else { 1.0 / cycles.max(1.0) };
        Some((probe, share * cycles, probing.mul_f64(share)))
    } else {
        None
    };
    look.expected += tried;
    let measured = if look.tier.is_ok() {
        look.quasi_static_cycles = (blocks + 1) as f64 * warm;
        // What was tried is one quasi-static cycle with its comparison.
        look.expected += tried.mul_f64(blocks as f64);
        if let Some((_, cycles, probing)) = probe {
            look.dynamic_cycles += FINER * probes * cycles;
            look.expected += probing.mul_f64(slower * probes);
            count(&|block| is_measured(block, life)) * warm
        } else {
            warm
        }
    } else if life.is_single_cycle() {
        0.0
    } else if let Some((probe, cycles, probing)) = probe {
        if probe.rattles {
            // Every wear step has the contacts of all motions. Each further one starts with a settling cycle and a measured one.
            look.expected += wear * (MOTIONS - 1) as u32;
            MOTIONS as f64 * blocks as f64 * warm + 2.0 * (MOTIONS - 1) as f64
        } else {
            look.dynamic_cycles += FINER * probes * cycles;
            look.expected += probing.mul_f64(probes);
            let mut saved = 0.0;
            if let Some(steps) = longer(accuracy).filter(|_| !probe.aperiodic && is_long_enough(&lives)) {
                let before = run.counts.steps;
                let (trial, trying) = timed(run.compare_next(0, &vec![steps; run.islands.len()])).await?;
                let share = (run.counts.steps - before) as f64 / look.steps_per_cycle as f64;
                look.dynamic_cycles += share;
                look.expected += trying;
                let trial = run.changes(&trial, &vec![true; run.islands.len()]);
                if difference(&trial, &run.measured) <= 1.0 {
                    if !run.depends_on_last_impact() {
                        // The trial takes the place of the probe on the unworn bores.
                        look.dynamic_cycles -= FINER * cycles;
                        look.expected = look.expected.saturating_sub(probing);
                    }
                    // Longer steps are expected to last for two thirds of the life.
                    let early = |block: &Range<u32>| 3 * u64::from(block.end) <= 2 * u64::from(life.cycles);
                    saved = (1.0 - share) * count(&early);
                }
            }
            (blocks as f64 - saved) * warm
        }
    } else {
        blocks as f64 * warm
    };
    // Cycles on surfaces with twice and four times the control points, where others are probed.
    let is_compared = look.asks_for_motion && !scene.control_points_of_model && !life.is_single_cycle();
    let measured = measured + if is_compared { 2.0 * probes * warm } else { 0.0 };
    look.dynamic_cycles += measured;
    look.expected += cycle.mul_f64(slower * measured);
    Ok(look)
}

impl Run<'_> {
    /// Expected time of the wear steps of a whole life between the simulated `lives` [cycles]: the first ones up to the first whole block
    /// are timed, and one in the middle of the life, on bores worn so far at once. Between the two, and for blocks of other lengths, the
    /// time is interpolated: the stages of a longer block grow with the square root of its length. Leaves the bores worn to the middle
    /// of the life.
    fn time_of_wear(&mut self, lives: &[u32]) -> Duration {
        /// Blocks at the start that are timed.
        const FIRST: usize = 5;
        let (mut sum, mut last) = (Duration::ZERO, Duration::ZERO);
        let cycles = |block: &[u32]| f64::from(block[1] - block[0]);
        let mut blocks = lives.windows(2);
        let mut length = 1.0;
        for block in blocks.by_ref().take(FIRST) {
            (length, last) = (cycles(block), self.timed_wear(block[0]..block[1]).unwrap_or(last));
            sum += last;
        }
        let rest: Vec<&[u32]> = blocks.collect();
        let [first, _, ..] = rest[..] else { return sum + last * rest.len() as u32 };
        let middle = rest[rest.len() / 2];
        // What fails under the contact of the first cycle need not fail in an evaluation.
        let worn = self.timed_wear(first[0]..middle[0]);
        let in_middle = worn.and_then(|_| self.timed_wear(middle[0]..middle[1]));
        let per_root = |time: Duration, length: f64| time.as_secs_f64() / length.sqrt();
        let early = per_root(last, length);
        let late = in_middle.map_or(early, |time| per_root(time, cycles(middle)));
        for (k, block) in rest.iter().enumerate() {
            let share = (2.0 * k as f64 / rest.len() as f64).min(1.0);
            sum += Duration::from_secs_f64((early + share * (late - early)) * cycles(block).sqrt());
        }
        sum
    }

    /// Time of wearing a block under the contact of the cycle just measured; `None` if it fails.
    fn timed_wear(&mut self, block: Range<u32>) -> Option<Duration> {
        let begun = Instant::now();
        let mut wear = vec![vec![]; self.scene.outputs.len()];
        self.wear(block, &[], &mut wear).ok()?;
        self.islands.iter_mut().for_each(IslandState::wear_copies);
        Some(begun.elapsed())
    }
}
