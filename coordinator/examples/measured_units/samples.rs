//! How often the lower bound holds that `--confidence` states of a life at R = 0.9 whose distribution, lognormal, is known from a few samples.
//!
//! The closed form is the tolerance bound by the noncentral t distribution, which holds exactly as often as stated.

use super::{SEED, learning, simulated};
use common::scene::SceneSource;
use coordinator::analyses::learn::{fitted_reliability, uncertain_fits};
use coordinator::statistics::design::InputModel;
use coordinator::study::{LifeModel, learn_from_results};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha12Rng;
use std::error::Error;

/// Mean and standard deviation of the lives, and their 10 % quantile [cycles].
const LIVES: [f64; 2] = [1000.0, 300.0];
/// Confidence of the bound [1].
const CONFIDENCE: f64 = 0.9;
/// Simulations of the study.
const SIMULATIONS: usize = 40;

/// The scene whose life is a variable with these keys.
fn scene_of(keys: &str) -> Result<SceneSource, Box<dyn Error>> {
    let text = format!(
        r#"
scene = {{ name = "samples" }}
simulator = {{ program = ["closure"] }}
life = {{ cycles = 6000, checkpoint_every = 100 }}
outputs = [{{ name = "excess" }}]
limit_states = [{{ name = "worn", output = "excess", threshold = 0 }}]
variables = [{{ name = "life", {keys} }}]
"#
    );
    Ok(SceneSource::parse(&text, "samples")?)
}

/// Prints how often the bound holds in `count` data sets of `n` samples.
pub fn run(n: usize, count: usize) -> Result<(), Box<dyn Error>> {
    let source = scene_of(&format!("distribution = \"lognormal\", mean = {}, std = {}", LIVES[0], LIVES[1]))?;
    let scene = source.nominal();
    let truth = &scene.variables[0].distribution;
    let exact = truth.quantile(0.1);
    let settings = learning(scene, 2000, SIMULATIONS);
    let stored = simulated(scene, SIMULATIONS, |sample, n| n - sample[0]);
    let learned = learn_from_results(scene, scene, &settings, &stored)?;
    let mut rng = ChaCha12Rng::seed_from_u64(SEED);
    let mut held = 0;
    for set in 0..count {
        let samples: Vec<f64> = (0..n).map(|_| truth.quantile(rng.random::<f64>())).collect();
        let fitted = scene_of(&format!("fit = \"lognormal\", samples = {samples:?}"))?;
        let model = LifeModel::new(scene, &learned).redistributed(InputModel::from_scene(fitted.nominal()));
        let fits = uncertain_fits(&model, &fitted.measured, scene).map_err(|names| names.join(", "))?;
        let found = fitted_reliability(scene, model, &fits, CONFIDENCE, SEED + set as u64);
        held += usize::from(found.lives[1].at_least.is_some_and(|life| life <= exact));
    }
    let share = 100.0 * held as f64 / count as f64;
    let error = 100.0 * (CONFIDENCE * (1.0 - CONFIDENCE) / count as f64).sqrt();
    println!(
        "{count} data sets of {n} samples: the lower 90 % bound of the life at R = 0.9 holds in {share:.1} ± {error:.1} %"
    );
    Ok(())
}
