//! Fleets of a population whose lives are known in closed form: a wear rate and a load, both lognormal, wear to the limit h,
//!
//!   L = h / (rate load),   ln L normal with the mean ln h - m_rate - m_load and the variance s_rate^2 + s_load^2.
//!
//! Mean and spread of the rate are not known; of the scatter of ln L the load has a share that is known:
//!
//! | case | share of the load | population of a fleet |
//! |---|---|---|
//! | `none` | 0.0001 | the rate is 3 % above that of the study |
//! | `third` | 0.37, as in `four-bar` | the same |
//! | `prior` | 0.37 | drawn from stated priors, under which intervals are exact |

use super::{SEED, Study, fleets};
use common::random::standard_normal_quantile;
use common::scene::SceneSource;
use coordinator::statistics::design::{InputModel, Population};
use coordinator::study::{Observed, Settings, StoredOutcome, learn_from_results, result_of};
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use std::time::Instant;

/// Mean and standard deviation of the rate in the study, and of their priors [um per 1000 cycles].
const RATE: [f64; 2] = [25.0, 2.0];
const PRIOR_ERRORS: [f64; 2] = [1.5, 0.8];
/// Limit of the wear depth [um].
const LIMIT: f64 = 30.0;
/// Simulations of the study, and lives of a population.
const SIMULATIONS: usize = 60;
const LIVES: usize = 20_000;

/// Prints how often the intervals of fleets hold in a case.
pub fn run(case: &str, fleets: usize) -> Result<(), Box<dyn Error>> {
    let (share, is_prior) = match case {
        "none" => (1e-4, false),
        "third" => (0.37, false),
        "prior" => (0.37, true),
        other => return Err(format!("{other}: unknown, allowed: none, third, prior").into()),
    };
    // Variances of the logarithms.
    let variance = |mean: f64, std: f64| (std / mean).powi(2).ln_1p();
    let of_load = variance(RATE[0], RATE[1]) * share / (1.0 - share);
    let study = study(of_load.exp_m1().sqrt())?;
    let population = |rng: &mut ChaCha12Rng| {
        let [mean, std] = if is_prior {
            [0, 1].map(|k| RATE[k] * (PRIOR_ERRORS[k] / RATE[k] * normal(rng)).exp())
        } else {
            [1.03 * RATE[0], RATE[1]]
        };
        let of_rate = variance(mean, std);
        // The load has the mean 1.
        let centre = (1000.0 * LIMIT / mean).ln() + 0.5 * (of_rate + of_load);
        let life = |j: usize| {
            let z = standard_normal_quantile((j as f64 + 0.5) / LIVES as f64);
            (centre + (of_rate + of_load).sqrt() * z).exp()
        };
        (0..LIVES).map(life).collect()
    };
    let prior = |k: usize| if is_prior { format!("{},{}", RATE[k], PRIOR_ERRORS[k]) } else { ",".to_owned() };
    fleets::run(
        &study,
        population,
        fleets,
        &[format!("rate.mean,{}", prior(0)), format!("rate.std,{}", prior(1))],
    )
}

fn normal(rng: &mut ChaCha12Rng) -> f64 {
    StandardNormal.sample(rng)
}

/// The study of the closed form, with a load of this standard deviation.
fn study(load: f64) -> Result<Study, Box<dyn Error>> {
    let text = format!(
        r#"
scene = {{ name = "closed-form" }}
simulator = {{ program = ["closure"] }}
life = {{ cycles = 3000, checkpoint_every = 100 }}
outputs = [{{ name = "wear", unit = "um" }}]
limit_states = [{{ name = "worn", output = "wear", threshold = {LIMIT} }}]
variables = [
    {{ name = "rate", distribution = "lognormal", mean = {}, std = {} }},
    {{ name = "load", distribution = "lognormal", mean = 1, std = {load} }},
]
"#,
        RATE[0], RATE[1]
    );
    let source = SceneSource::parse(&text, "closed-form")?;
    let scene = source.nominal();
    let settings = Settings {
        samples: 20_000,
        initial: SIMULATIONS,
        max_evaluations: SIMULATIONS,
        ..Settings::from(scene)
    };
    let points = Population::draw(InputModel::from_scene(scene), SIMULATIONS, SEED);
    let outcome = |j: usize| {
        let sample = points.physical(j);
        let wear = |n: &u32| sample[0] * sample[1] * f64::from(*n) / 1000.0;
        let history = scene.life.checkpoints().iter().map(wear).collect();
        let observed = Observed { start: vec![Some(0.0)], ..Observed::exact(vec![history]) };
        StoredOutcome { sample, outcome: Ok(observed) }
    };
    let stored: Vec<StoredOutcome> = (0..SIMULATIONS).map(outcome).collect();
    let learned = learn_from_results(scene, scene, &settings, &stored)?;
    let summary = result_of(scene, &settings, &learned, Instant::now()).summary;
    Ok((source, settings, summary, stored))
}
