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

use super::{Study, fleets, learning, simulated};
use common::random::{standard_normal_cdf, standard_normal_quantile};
use common::scene::SceneSource;
use coordinator::statistics::life_data::UnitLife;
use coordinator::study::{learn_from_results, result_of};
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
        Some(&|data, error, confidence, levels| exact(of_load, is_prior, data, error, confidence, levels)),
    )
}

/// Nodes of the quadrature over each of both parameters.
const NODES: u32 = 160;

/// Intervals of the lives at `levels` with the confidence `c`, by quadrature of the posterior of mean and spread of the rate.
fn exact(
    of_load: f64,
    is_prior: bool,
    data: &[UnitLife],
    error: f64,
    c: f64,
    levels: &[f64],
) -> Vec<[f64; 2]> {
    // Ranges of the logarithms: those of the flat priors, or five standard deviations of the stated ones.
    let reaches = if is_prior {
        [0, 1].map(|k| 5.0 * PRIOR_ERRORS[k] / RATE[k])
    } else {
        [0.5_f64.max(5.0 * RATE[1] / RATE[0]), 5.0_f64.ln()]
    };
    let node = |k: usize, i: u32| {
        let off = reaches[k] * (2.0 * (f64::from(i) + 0.5) / f64::from(NODES) - 1.0);
        let prior = if is_prior { -0.5 * (off / PRIOR_ERRORS[k] * RATE[k]).powi(2) } else { 0.0 };
        (RATE[k] * off.exp(), prior)
    };
    let mut posterior = Vec::new();
    for (i, j) in (0..NODES).flat_map(|i| (0..NODES).map(move |j| (i, j))) {
        let [(mean, of_mean), (std, of_std)] = [node(0, i), node(1, j)];
        let of_rate = (std / mean).powi(2).ln_1p();
        let (centre, variance) =
            ((1000.0 * LIMIT / mean).ln() + 0.5 * (of_rate + of_load), of_rate + of_load);
        let of_unit = |unit: &UnitLife| match *unit {
            UnitLife::Failed(t) => {
                let with_error = variance + (error / t).powi(2);
                -0.5 * (t.ln() - centre).powi(2) / with_error - 0.5 * with_error.ln()
            }
            UnitLife::Running(t) | UnitLife::Interval(_, t) => {
                standard_normal_cdf((centre - t.ln()) / variance.sqrt()).max(1e-300).ln()
            }
        };
        posterior.push((of_mean + of_std + data.iter().map(of_unit).sum::<f64>(), centre, variance.sqrt()));
    }
    let largest = posterior.iter().map(|(ln, _, _)| *ln).fold(f64::NEG_INFINITY, f64::max);
    let interval = |level: &f64| {
        let z = standard_normal_quantile(1.0 - level);
        let life =
            |(ln, centre, spread): &(f64, f64, f64)| ((centre + z * spread).exp(), (ln - largest).exp());
        let mut lives: Vec<(f64, f64)> = posterior.iter().map(life).collect();
        lives.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = lives.iter().map(|(_, w)| w).sum();
        [0.5 * (1.0 - c), 0.5 * (1.0 + c)].map(|p| {
            let mut sum = 0.0;
            let reached = lives.iter().find(|(_, w)| {
                sum += w;
                sum >= p * total
            });
            reached.map_or(f64::NAN, |(life, _)| *life)
        })
    };
    levels.iter().map(interval).collect()
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
    let settings = learning(scene, 20_000, SIMULATIONS);
    let stored = simulated(scene, SIMULATIONS, |sample, n| sample[0] * sample[1] * n / 1000.0);
    let learned = learn_from_results(scene, scene, &settings, &stored)?;
    let summary = result_of(scene, &settings, &learned, Instant::now()).summary;
    Ok((source, settings, summary, stored))
}
