//! The life of a scene under numerical settings given on the command line, one line of JSON each:
//! `cargo run --release -p worker --example lsoda_hingewise -- SCENE REPEATS SETTING...`, where a setting is the name of a
//! preset or `step_tolerance,largest_step,wear_samples,cycle_jump,wear_tolerance`, the rest as in `draft`.
//!
//! Printed are the setting, the outputs by name at every checkpoint, SI, and counts of work, once after REPEATS evaluations: one after the
//! other, or with `x` before the number (`x16`) as a batch that shares the vector lanes of one core, as those of a study do.
//! The other side of the comparison, and what compares and times the two, is written in Python beside this file.

use common::accuracy::{Accuracy, Tier};
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use serde_json::json;
use worker::simulate::{LaneWidth, SimulateOptions, SimulationInput, simulate, simulate_side_by_side};

/// A setting as the command line writes it.
fn setting(text: &str) -> Option<Accuracy> {
    if let Some(preset) = Accuracy::by_name(text) {
        return Some(preset);
    }
    let mut parts = text.split(',');
    let accuracy = Accuracy {
        step_tolerance: parts.next()?.parse().ok()?,
        largest_step: parts.next()?.parse().ok()?,
        wear_samples: parts.next()?.parse().ok()?,
        cycle_jump: parts.next()?.parse().ok()?,
        wear_tolerance: parts.next()?.parse().ok()?,
        tier: Tier::Dynamic,
        ..Accuracy::draft()
    };
    parts.next().is_none().then_some(accuracy)
}

type Outcome = Result<Evaluation, SimulationFailure>;

/// Evaluations side by side at a time.
const AT_A_TIME: usize = 8;

/// One of `repeats` evaluations of a scene: `x16` are a batch.
fn evaluate(scene: &Scene, accuracy: &Accuracy, repeats: &str) -> Result<Outcome, String> {
    let options = SimulateOptions::default();
    let number = |text: &str| text.parse::<usize>().map_err(|_| format!("{repeats}: how many repeats?"));
    let mut found = None;
    if let Some(batch) = repeats.strip_prefix('x') {
        let input = || SimulationInput { scene: scene.clone(), accuracy: *accuracy, options };
        let mut left = number(batch)?;
        let mut next = || {
            left = left.checked_sub(1)?;
            Some(Ok(input()))
        };
        simulate_side_by_side(LaneWidth::Widest, AT_A_TIME, &mut next, &mut |_, outcome, _| {
            found = Some(outcome);
        });
    } else {
        for _ in 0..number(repeats)? {
            found = Some(simulate(scene, accuracy, options));
        }
    }
    found.ok_or_else(|| "no repeats".into())
}

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, repeats, settings @ ..] = arguments.as_slice() else {
        return Err("usage: SCENE REPEATS SETTING...".into());
    };
    let source = SceneSource::load(scene).map_err(|faults| faults.to_string())?;
    let scene = source.nominal();
    for text in settings {
        let accuracy = setting(text).ok_or_else(|| format!("{text}: no setting"))?;
        let line = match evaluate(scene, &accuracy, repeats)? {
            Ok(life) => {
                let names = scene.outputs.iter().map(|output| output.name.clone());
                let outputs: serde_json::Map<_, _> =
                    names.zip(life.histories.iter().map(|history| json!(history))).collect();
                let d = &life.diagnostics;
                json!({
                    "setting": text, "outputs": outputs, "steps": d.steps,
                    "rejected": d.rejected_steps, "forces": d.force_evaluations, "cycles": d.simulated_cycles,
                })
            }
            Err(failure) => json!({ "setting": text, "failure": failure.to_string() }),
        };
        println!("{line}");
    }
    Ok(())
}
