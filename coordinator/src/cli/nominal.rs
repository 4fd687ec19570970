//! Warnings that need a simulation of the nominal mechanism: limits that it has passed before the first checkpoint.

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{LimitState, Scene, Warning};
use worker::simulate::{SimulateOptions, simulate};

/// Checkpoints up to the life of the nominal mechanism that resolve the lives of others: their spread is some tens of per cent.
const CHECKPOINTS_WITHIN_LIFE: f64 = 10.0;

/// Simulates the nominal mechanism at `draft` and compares its outputs with the limits of the scene; nothing is simulated for a scene
/// without limits.
pub fn nominal_warnings(scene: &Scene) -> Vec<Warning> {
    if scene.limit_states.is_empty() || scene.simulator.is_some() {
        return Vec::new();
    }
    past_limits(scene).unwrap_or_else(|failure| {
        vec![Warning {
            key: "scene".to_owned(),
            message: format!("the nominal mechanism cannot be simulated: {failure}"),
        }]
    })
}

fn past_limits(scene: &Scene) -> Result<Vec<Warning>, SimulationFailure> {
    let evaluation = simulate(scene, &Accuracy::draft(), SimulateOptions::default())?;
    let warnings = scene.limit_states.iter().filter_map(|limit| {
        let history = &evaluation.histories[limit.output];
        let unworn = evaluation.start.get(limit.output).copied().flatten()?;
        let message = warning(scene, limit, unworn, history[0])?;
        Some(Warning { key: format!("limit_states.{}", limit.name), message })
    });
    Ok(warnings.collect())
}

/// The warning about a limit, given the output on the `unworn` bores and at the `first` checkpoint [SI].
fn warning(scene: &Scene, limit: &LimitState, unworn: f64, first: f64) -> Option<String> {
    let unit = scene.outputs[limit.output].kind.unit();
    let shown = |value: f64| unit.after(&format!("{:.4}", unit.to_shown(value)));
    let (threshold, every) = (limit.threshold, scene.life.checkpoint_every);
    if unworn >= threshold {
        return Some(format!(
            "the nominal mechanism has {} in its first cycle, unworn, and has failed from the start: the limit is {}",
            shown(unworn),
            shown(threshold)
        ));
    }
    if first < threshold {
        return None;
    }
    let life = f64::from(every) * (threshold - unworn) / (first - unworn);
    let remedy = match finer_checkpoints(scene.life.cycles, life) {
        Some(finer) if finer < every => format!("checkpoint_every = {finer} resolves its life"),
        _ => "no distance between checkpoints resolves that".to_owned(),
    };
    Some(format!(
        "the nominal mechanism reaches the limit of {} after about {life:.0} cycles, before the first checkpoint at {every}, where it \
         has {}: {remedy}",
        shown(threshold),
        shown(first)
    ))
}

/// The longest distance between checkpoints of 1, 2 or 5 times a power of ten [cycles] that divides `cycles` and has
/// [`CHECKPOINTS_WITHIN_LIFE`] checkpoints within `life` [cycles]; none if the life is shorter than a cycle each.
fn finer_checkpoints(cycles: u32, life: f64) -> Option<u32> {
    let powers = (0..9).rev().map(|k| 10_u32.pow(k));
    let mut candidates = powers.flat_map(|power| [5, 2, 1].map(|digit: u32| digit.saturating_mul(power)));
    candidates
        .find(|every| f64::from(*every) <= life / CHECKPOINTS_WITHIN_LIFE && cycles.is_multiple_of(*every))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn issue_a_mechanism_past_its_limit_before_the_first_checkpoint_passed_without_a_word() {
        let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        assert_eq!(nominal_warnings(&scene), []);
        // 2.2 um are worn at the first checkpoint, after 1000 cycles.
        scene.limit_states[0].threshold = 1e-6;
        let found = nominal_warnings(&scene);
        assert_eq!(found.len(), 1, "{found:?}");
        let message = &found[0].message;
        assert_eq!(found[0].key, "limit_states.wear");
        assert!(message.contains("before the first checkpoint at 1000"), "{message}");
        assert!(message.ends_with("checkpoint_every = 20 resolves its life"), "{message}");
        // The joint turns at 424 r/min from the first cycle on.
        scene.limit_states[0] = LimitState { output: 1, threshold: 40.0, ..scene.limit_states[0].clone() };
        let found = nominal_warnings(&scene);
        assert!(found[0].message.contains("has failed from the start"), "{found:?}");
    }

    #[test]
    fn checkpoints_divide_the_life_and_resolve_it() {
        assert_eq!(finer_checkpoints(8000, 450.0), Some(20));
        assert_eq!(finer_checkpoints(100_000, 3000.0), Some(200));
        assert_eq!(finer_checkpoints(7, 100.0), Some(1));
        assert_eq!(finer_checkpoints(8000, 5.0), None);
    }
}
