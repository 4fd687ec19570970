//! The whole life after the settled first cycle: block after block of wear, a measured cycle at the end of each.

use super::error::Doubt;
use super::probe::due;
use super::run::Run;
use crate::life::{Course, at_checkpoints};
use common::failure::SimulationFailure;
use common::scene::{OutputKind, Scene};

/// What a life came to, for every output of the scene at every checkpoint `(outputs, m)`, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Lived {
    /// The outputs.
    pub histories: Vec<Vec<f64>>,
    /// Estimates of their errors.
    pub errors: Vec<Vec<f64>>,
}

/// Wears the bores to the end of life, with a measured cycle by `next_cycle` after each block; where these are
/// `dynamic`, some are put to the test.
///
/// # Errors
/// What the wear or `next_cycle` refused.
pub async fn live<E: From<SimulationFailure>>(
    run: &mut Run<'_>,
    next_cycle: impl AsyncFn(&mut Run) -> Result<(), E>,
    dynamic: bool,
) -> Result<Lived, E> {
    let (scene, accuracy) = (run.scene, run.accuracy);
    let every = scene.life.checkpoint_every;
    let (end, jump) = (scene.life.cycles, accuracy.cycle_jump);
    let mut course = Course::new(end, jump, every, accuracy.jump_tolerance, limits(scene));
    let mut doubt = Doubt::default();
    let mut measured = vec![run.motion_outputs()];
    if dynamic {
        doubt.probed(run.probe(0).await?);
    }
    let mut wear = vec![vec![]; scene.outputs.len()];
    let mut from = 0;
    course.measured(&measured[0]);
    run.keep_bores(0);
    while let Some(to) = course.next_life() {
        let checkpoints: Vec<u32> = (from / every + 1..=to / every).map(|k| k * every).collect();
        let depths = run.depths();
        run.wear(from, to, &checkpoints, &mut wear)?;
        doubt.worn(run, from, depths);
        run.keep_bores(to);
        if dynamic && to == end {
            run.last_cycle().await?;
        } else {
            next_cycle(run).await?;
        }
        let outputs = run.motion_outputs();
        course.measured(&outputs);
        measured.push(outputs);
        let (length, relative) = frozen(run);
        course.froze(length, relative);
        if dynamic && due(from, to, every, end) {
            doubt.probed(run.probe(to).await?);
        }
        from = to;
    }
    run.close_wear()?;
    doubt.worn(run, end, run.depths());

    let lives = course.lives();
    let cycles = scene.life.checkpoints();
    let histories: Vec<Vec<f64>> = scene
        .outputs
        .iter()
        .enumerate()
        .map(|(k, output)| match output.kind {
            OutputKind::LargestWear { .. } => std::mem::take(&mut wear[k]),
            _ => {
                let values: Vec<f64> = measured.iter().map(|m| m[k]).collect();
                at_checkpoints(lives, &values, &cycles)
            }
        })
        .collect();
    let errors = doubt.errors(scene, &histories, lives, &measured, accuracy.largest_step);
    Ok(Lived { histories, errors })
}

/// What the errors of the outputs are relative to: the lowest threshold of their limit states; infinity of wear and of
/// what has none, which do not ask for cycles to be simulated.
fn limits(scene: &Scene) -> Vec<f64> {
    let limit = |k: usize| match scene.outputs[k].kind {
        OutputKind::LargestWear { .. } => f64::INFINITY,
        _ => scene
            .limit_states
            .iter()
            .filter(|state| state.output == k)
            .fold(f64::INFINITY, |a, state| a.min(state.threshold.abs())),
    };
    (0..scene.outputs.len()).map(limit).collect()
}

/// Length of the last block but one, whose account is closed, and what having frozen its contact may have added to a
/// joint's depth, relative to its largest depth now.
fn frozen(run: &Run) -> (f64, f64) {
    let of = run.islands.iter().flat_map(|m| m.steps.iter().zip(&m.depth));
    of.fold((0.0, 0.0), |(length, relative): (f64, f64), (step, depth)| {
        let (block, added) = step.frozen();
        let deepest = depth.iter().fold(0.0_f64, |a, &b| a.max(b));
        (length.max(block), if deepest > 0.0 { relative.max(added / deepest) } else { relative })
    })
}
