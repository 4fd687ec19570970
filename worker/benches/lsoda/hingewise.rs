//! The life of a scene under numerical settings given on the command line, one line of JSON each:
//! `cargo run --release -p worker --example lsoda_hingewise -- SCENE REPEATS SETTING...`, where a setting is the name of a
//! preset or `step_tolerance,largest_step,wear_samples,cycle_jump,wear_tolerance`, the rest as in `draft`.
//!
//! Printed are the setting, the outputs by name at every checkpoint, SI, and counts of work, once after REPEATS evaluations.
//! The other side of the comparison, and what compares and times the two, is written in Python beside this file.

use common::accuracy::{Accuracy, Tier};
use common::scene::SceneSource;
use serde_json::json;
use worker::simulate::{SimulateOptions, simulate};

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

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, repeats, settings @ ..] = arguments.as_slice() else {
        return Err("usage: SCENE REPEATS SETTING...".into());
    };
    let source = SceneSource::load(scene).map_err(|faults| faults.to_string())?;
    let scene = source.nominal();
    let repeats: u32 = repeats.parse().map_err(|_| format!("{repeats}: how many repeats?"))?;
    for text in settings {
        let accuracy = setting(text).ok_or_else(|| format!("{text}: no setting"))?;
        let mut found = simulate(scene, &accuracy, SimulateOptions::default());
        for _ in 1..repeats {
            found = simulate(scene, &accuracy, SimulateOptions::default());
        }
        let line = match found {
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
