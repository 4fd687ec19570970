//! One evaluation: the whole life of one sample.
//!
//! assemble -> settle -> measure the first cycle -> [ wear a block -> warm up -> measure a cycle ] ... -> outputs
//!
//! A measured cycle serves twice: its contact history drives the wear of the block that follows, and its motion
//! gives the outputs of the profile it ran on. The value of a checkpoint belongs to the profile worn to it. At a few
//! lives the measured cycle is put to the test, from which the evaluation estimates its own error.
//!
//! Where wear is all that is asked for, the cycles between the first and the last may be quasi-static ones; where
//! nothing wears, one cycle is all there is.

mod desk;
mod error;
mod finish;
mod first_look;
mod guided;
mod life;
mod moving;
mod observe;
mod pool;
mod probe;
mod run;
mod together;
mod unchanging;

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::Scene;
use desk::Desk;
use guided::wear_alone;
use life::live;
use run::Run;
use std::time::Duration;
use together::{Work, alone, together};

pub use together::Width;

pub use first_look::{FirstLook, IslandModel, first_look};

/// Simulates the whole life of a checked scene.
///
/// Returns every output at every checkpoint; the settled first cycle too if `with_first_cycle`.
///
/// # Errors
/// [`SimulationFailure`]: what the physics or the numerics refused, with time, cycle and joint.
pub fn simulate(
    scene: &Scene,
    accuracy: &Accuracy,
    with_first_cycle: bool,
) -> Result<Evaluation, SimulationFailure> {
    simulate_counting(scene, accuracy, with_first_cycle, &mut 0)
}

/// The same; adds the time steps tried, accepted and refused, to `steps`, those before a failure too.
///
/// # Errors
/// As [`simulate`].
pub fn simulate_counting(
    scene: &Scene,
    accuracy: &Accuracy,
    with_first_cycle: bool,
    steps: &mut u64,
) -> Result<Evaluation, SimulationFailure> {
    let (evaluation, tried) = alone(|desk| life_of(desk, scene, accuracy, with_first_cycle));
    *steps += tried;
    evaluation
}

/// One evaluation of several that run side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Order {
    /// The scene, of one sample.
    pub scene: Scene,
    /// How accurately.
    pub accuracy: Accuracy,
    /// Whether people want to see the first cycle.
    pub with_first_cycle: bool,
}

/// Evaluates what `next` gives, at most `most` at a time, side by side in the lanes of one core, of any width, until it gives
/// nothing; `done` takes each result with its number, counted from zero as they were given, and the time it took, its share
/// of what was done for several at once. What could not be made an
/// order comes back as it is. A result is the same, to the last bit, as by [`simulate`]: whatever ran beside.
pub fn simulate_together(
    width: Width,
    most: usize,
    next: &mut dyn FnMut() -> Option<Result<Order, SimulationFailure>>,
    done: &mut dyn FnMut(usize, Result<Evaluation, SimulationFailure>, Duration),
) {
    let desk = Desk::default();
    let mut work = || {
        let order = next()?;
        Some(Work::new(&desk, async move |desk| {
            let Order { scene, accuracy, with_first_cycle } = order?;
            life_of(desk, &scene, &accuracy, with_first_cycle).await.0
        }))
    };
    together(width, &desk, most, &mut work, done);
}

/// The evaluation, and the time steps it tried.
async fn life_of(
    desk: Desk,
    scene: &Scene,
    accuracy: &Accuracy,
    with_first_cycle: bool,
) -> (Result<Evaluation, SimulationFailure>, u64) {
    let mut run = match Run::assemble(desk, scene, accuracy) {
        Ok(run) => run,
        Err(failure) => return (Err(failure), 0),
    };
    let evaluation = evaluate(&mut run, with_first_cycle).await;
    (evaluation, run.stats.steps + run.stats.rejected)
}

/// Stage by stage.
async fn evaluate(run: &mut Run<'_>, with_first_cycle: bool) -> Result<Evaluation, SimulationFailure> {
    run.watched = with_first_cycle;
    run.settle().await?;
    run.show(true);
    run.measure().await?;
    let first = run.first_seen(with_first_cycle);
    run.show(false);
    if !run.wears() {
        return run.unchanging(first).await;
    }

    let lived = match wear_alone(run).await {
        Some(lived) => lived,
        None => live(run, async |run: &mut Run| run.next_cycle().await, true).await?,
    };
    run.finish(run.scene.life.checkpoints(), lived.histories, lived.errors, first)
}
