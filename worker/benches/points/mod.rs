//! Points of the flapping-wing drive that benchmarks compare settings at, and the difference of two evaluations.

use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};

/// Point number `point` of the drive: the nominal one is 0; of the others each variable lies at its own multiple of the golden ratio
/// within `share` of its range around its mean [1].
pub fn scene_at(source: &SceneSource, point: u32, share: f64) -> Scene {
    let shift = |k: usize| (f64::from(point) * 0.754_877 + k as f64 * 0.618_034).fract() - 0.5;
    let variables = source.variables().iter().zip(source.means()).enumerate();
    let sample: Vec<f64> = variables
        .map(|(k, (variable, mean))| {
            let (_, upper) = variable.distribution.limits();
            mean + 2.0 * share * shift(k) * (upper - mean)
        })
        .collect();
    let at = if point == 0 { source.means() } else { sample };
    source.resolve_sample(&at).expect("within the bounds of the variables")
}

/// Largest difference of output `k` up to the life `until` [cycles], relative to its threshold [1].
pub fn relative_difference(scene: &Scene, a: &Evaluation, b: &Evaluation, k: usize, until: u32) -> f64 {
    let threshold = scene.limit_states.iter().find(|l| l.output == k).map_or(1.0, |l| l.threshold);
    let pairs = a.cycles.iter().zip(a.histories[k].iter().zip(&b.histories[k]));
    let within = pairs.filter(|(cycles, _)| **cycles <= until);
    within.fold(0.0, |m: f64, (_, (x, y))| m.max((x - y).abs() / threshold))
}
