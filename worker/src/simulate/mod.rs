//! One evaluation: the whole life of one sample.
//!
//! assemble -> settle -> measure the first cycle -> [ wear a block -> warm up -> measure a cycle ] ... -> outputs
//!
//! A measured cycle serves twice: its contact history drives the wear of the block that follows, and its motion
//! gives the outputs of the profile it ran on. The value of a checkpoint belongs to the profile worn to it. At a few
//! lives the measured cycle is probed, from which the evaluation estimates its own error.
//!
//! The cycles between the first and the last may be quasi-static, with dynamic ones at a few lives if the motion is asked for; if nothing
//! wears, one cycle represents the whole life. If the life is a single cycle, only that cycle is measured, and the wear follows from it.
//! Under several operating conditions each has its cycles, and all wear the bores together.
//!
//! | file | contents |
//! |---|---|
//! | `mod.rs` | the evaluation as a page of stages |
//! | `run.rs` | the stages: settle, measure a cycle, wear a block, warm up |
//! | `life_in_blocks.rs`, `partial_life.rs` | a life block by block; a life as far as it has been simulated |
//! | `blocks.rs` | the ends of the blocks; the outputs over a life |
//! | `life_in_blocks.rs`, `quasi_static.rs`, `quasi_static_island.rs` | lives without wear; wear by the quasi-static model |
//! | `longer_steps.rs`, `compared_islands.rs` | longer time steps while they make no difference, and which islands make one |
//! | `probe.rs`, `motion_estimate.rs`, `error_estimate.rs` | probes of a measured cycle, and the stated error |
//! | `partial_life.rs`, `probe.rs` | the motion on surfaces with more control points; the error that follows from it |
//! | `settling.rs`, `repetition.rs` | further cycles until the motion repeats itself; how it does |
//! | `turn_period.rs` | the period of a cycle that is one turn of a free body; several operating conditions on the same bores |
//! | `several_cycles.rs` | means over cycles of a motion that does not repeat |
//! | `cycle_history.rs` | outputs and history of a cycle; the result |
//! | `island_state.rs`, `worn_joints.rs` | an island with its state, stepper, recorder and wear; the wear of all joints, and their grooves |
//! | `failures.rs` | what ends an evaluation |
//! | `side_by_side/` | several evaluations in the SIMD lanes of one core |
//! | `control_points.rs` | arcs of the contacts in the first cycle; the number of control points by them |
//! | `program_cycles.rs`, `served_cycle.rs` | a life whose cycles another program simulates; one cycle on given surfaces, for others that wear them |
//! | `program_history.rs` | the cycle of a program as it is displayed |
//! | `first_look.rs` | model and cost of an evaluation beforehand |

mod blocks;
mod compared_islands;
mod conditions;
mod control_points;
mod cycle_history;
mod error_estimate;
mod failures;
mod finer_surfaces;
mod first_look;
mod ideal_tracks;
mod island_state;
mod life_in_blocks;
mod longer_steps;
mod motion_estimate;
mod partial_life;
mod probe;
mod program_cycles;
mod program_history;
mod quasi_static;
mod quasi_static_island;
mod repetition;
mod run;
mod served_cycle;
mod settling;
mod several_cycles;
mod side_by_side;
mod turn_period;
mod worn_joints;

use crate::mechanism::moved_to_origin;
use blocks::LifeHistory;
use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::Scene;
use conditions::assemble;
use control_points::{with_control_points, with_more_points};
use cycle_history::{FirstCycle, finish};
use failures::Simulated;
use life_in_blocks::{DynamicCycles, simulate_life};
use quasi_static::try_quasi_static;
use run::Run;
pub(crate) use side_by_side::widest_lanes;
use side_by_side::{LaneQueue, RunningEvaluation, join, run_alone, run_side_by_side};
use std::time::Duration;
use turn_period::with_period_of_turn;

pub use crate::quasi_static::Unsuitable;
pub use control_points::ContactArc;
pub use first_look::{FirstLook, IslandModel, first_look};
pub use program_cycles::{CycleError, simulate_program_life};
pub use served_cycle::{ServedCycle, simulate_one_cycle};
pub use side_by_side::LaneWidth;

/// What an evaluation returns besides its outputs; nothing by default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SimulateOptions {
    /// Returns the history of the settled first cycle, and of a mechanism that wears the bores through life and the last cycle,
    /// each cycle with its energy balance.
    pub first_cycle: bool,
}

impl SimulateOptions {
    /// The options that return the history of the first cycle and of the worn mechanism.
    pub const WITH_FIRST_CYCLE: Self = SimulateOptions { first_cycle: true };
}

/// Simulates the whole life of a checked scene and returns every output at every checkpoint.
///
/// # Errors
/// [`common::failure::SimulationFailure`]: the failure of the physics or the numerics, with time, cycle and joint.
pub fn simulate(scene: &Scene, accuracy: &Accuracy, options: SimulateOptions) -> Simulated<Evaluation> {
    simulate_counted(scene, accuracy, options).0
}

/// The evaluation, or its failure, and the number of time steps tried, accepted and refused, also those before a failure.
pub type CountedEvaluation = (Simulated<Evaluation>, u64);

/// Simulates like [`simulate`], and counts the time steps even if the evaluation fails.
pub fn simulate_counted(scene: &Scene, accuracy: &Accuracy, options: SimulateOptions) -> CountedEvaluation {
    run_alone(|queue| simulate_stages(queue, scene, accuracy, options))
}

/// One of several evaluations that run side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationInput {
    /// Scene of one sample.
    pub scene: Scene,
    /// Numerical settings of the evaluation.
    pub accuracy: Accuracy,
    /// What is returned besides the outputs.
    pub options: SimulateOptions,
}

/// Simulates the inputs that `next` returns until it returns `None`, at most `most` at a time, side by side in lanes of `width` on this
/// thread. An input that could not be made is its own result.
///
/// `done` receives each result with the number of its input, counted from zero, and its processor time: its own stages plus an equal
/// share of the lanes it was in. A result has the same bits as that of [`simulate`], whatever runs next to it.
pub fn simulate_side_by_side(
    width: LaneWidth,
    most: usize,
    next: &mut dyn FnMut() -> Option<Simulated<SimulationInput>>,
    done: &mut dyn FnMut(usize, Simulated<Evaluation>, Duration),
) {
    let queue = LaneQueue::default();
    let mut next_evaluation = || {
        let input = next()?;
        Some(RunningEvaluation::new(&queue, async move |queue| {
            let SimulationInput { scene, accuracy, options } = input?;
            simulate_stages(queue, &scene, &accuracy, options).await.0
        }))
    };
    run_side_by_side(width, &queue, most, &mut next_evaluation, done);
}

/// The evaluation with its count of time steps.
async fn simulate_stages(
    queue: LaneQueue,
    scene: &Scene,
    accuracy: &Accuracy,
    options: SimulateOptions,
) -> CountedEvaluation {
    let mut steps_tried = 0;
    let stages = async {
        let timed = with_period_of_turn(&queue, scene, accuracy).await?;
        let scene = timed.as_ref().unwrap_or(scene);
        // Coordinates from a point of the mechanism: far from it they would round away what small motions are.
        let local = moved_to_origin(scene);
        let scene = local.as_ref().map_or(scene, |(local, _)| local);
        let numbered = with_control_points(&queue, scene).await?;
        let scene = numbered.as_ref().map_or(scene, |(numbered, ..)| numbered);
        let finer = with_more_points(scene, accuracy.points);
        let scene = finer.as_ref().unwrap_or(scene);
        let mut runs = assemble(&queue, scene, accuracy)?;
        if let Some((_, counts, cycles)) = &numbered {
            runs[0].counts.add(counts);
            runs[0].simulated += cycles;
        }
        runs.iter_mut().for_each(|run| run.display = options.first_cycle.then(Default::default));
        if !accuracy.wear_error && !options.first_cycle {
            runs.iter_mut().for_each(Run::leave_out_copies);
        } else if !scene.control_points_of_model || options.first_cycle {
            runs[0].start_comparing_finer();
        }
        let mut result = evaluate(&mut runs).await;
        if let (Ok(evaluation), Some((_, origin))) = (&mut result, &local) {
            evaluation.move_histories(*origin);
        }
        steps_tried = runs.iter().map(|run| run.counts.steps + run.counts.rejected).sum();
        result
    };
    (stages.await, steps_tried)
}

/// The stages of an evaluation, each under every operating condition.
async fn evaluate(runs: &mut [Run<'_>]) -> Simulated<Evaluation> {
    let first = join(runs.iter_mut().map(measure_first)).await.into_iter().collect::<Result<Vec<_>, _>>()?;
    let Some(first) = FirstCycle::of_conditions(first) else { unreachable!("at least one condition") };
    let scene = runs[0].scene;
    let life = if !runs[0].wears() {
        let lives = join(runs.iter_mut().map(Run::life_without_wear)).await;
        LifeHistory::worst(lives.into_iter().collect::<Result<_, _>>()?, scene)
    } else if !scene.life.is_single_cycle()
        && let Some(life) = try_quasi_static(runs).await
    {
        life
    } else {
        simulate_life(runs, DynamicCycles { probed: true }).await?
    };
    finish(runs, life, first)
}

/// Settles the mechanism under one condition and measures its first cycle; its share of the cycles [1] with the summary.
async fn measure_first(run: &mut Run<'_>) -> Simulated<(f64, FirstCycle)> {
    run.settle().await?;
    run.start_full_recording();
    run.measure_first().await?;
    let first = run.first_cycle();
    run.stop_full_recording();
    Ok((run.share, first))
}
