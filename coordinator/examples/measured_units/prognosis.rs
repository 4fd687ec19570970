//! Prognosis of the remaining life by `coordinator update`, measured as its field does, over units whose lives are known.
//!
//! Every unit is measured with noise at 0.1, 0.2, ... 0.9 of its life L. With all measurements up to the life n the median of the remaining
//! life is r(n), where L - n is true:
//!
//! | measure | definition |
//! |---|---|
//! | alpha-lambda accuracy | share of the units with \|r(n) - (L - n)\| <= alpha (L - n) at n = lambda L |
//! | prognostic horizon | L - n at the first measurement from which on \|r(n) - (L - n)\| <= alpha L, as a share of L |
//! | cumulative relative accuracy | mean over the measurements of 1 - \|r(n) - (L - n)\| / (L - n), not below 0 |
//!
//! The same where nothing but survival is known of the units shows what the measurements are worth.
//!
//! # Source
//! Saxena, Celaya, Saha, Saha, Goebel (2010), Metrics for offline evaluation of prognostic performance, International Journal of Prognostics
//! and Health Management 1(1).

use super::{SEED, Study, history, life, times};
use coordinator::analyses::update::{
    FleetSettings, Observable, Observation, ObservedUnit, Quantity, UnitReport, update,
};
use coordinator::study::{LifeModel, Observed, learn_from_results};
use rand::SeedableRng;
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;

/// Measurements of a unit, at equal shares of its life.
const MEASUREMENTS: usize = 9;
/// Accuracy alpha of the remaining life, and of the horizon as a share of the life [1].
const ALPHA: f64 = 0.2;
const OF_LIFE: f64 = 0.05;
/// Standard deviation of a measurement over the threshold [1].
const ERROR: f64 = 0.02;

/// Prints the measures over the first `count` units of the direct study that fail within it.
pub fn run(study: &Study, direct: &Study, count: usize) -> Result<(), Box<dyn Error>> {
    let (source, settings, summary, stored) = study;
    let scene = source.nominal();
    let limit = &scene.limit_states[0];
    let std = ERROR * limit.scale();
    let learned = learn_from_results(scene, scene, settings, stored)?;
    let model = LifeModel::new(scene, &learned);
    let simulated = direct.3.iter().skip(1).filter_map(|s| s.outcome.as_ref().ok());
    let failed: Vec<(&Observed, f64)> = simulated
        .map(|unit| (unit, life(scene, unit)))
        .filter(|(_, life)| life.is_finite())
        .take(count)
        .collect();
    let (mut measured, mut survived) = (Vec::new(), Vec::new());
    let mut rng = ChaCha12Rng::seed_from_u64(SEED);
    for (unit, life) in &failed {
        let mut observations: Vec<Observation> = Vec::new();
        for k in 1..=MEASUREMENTS {
            let cycles = life * k as f64 / (MEASUREMENTS + 1) as f64;
            let noise: f64 = StandardNormal.sample(&mut rng);
            let value =
                history(&times(scene), unit, limit.output).value_at(cycles).ok_or("no value there")?;
            let of = |quantity| Observation { line: 1, cycles, name: "measured".to_owned(), quantity };
            observations.push(of(Quantity::Survived));
            survived.push(ObservedUnit { name: String::new(), observations: vec![of(Quantity::Survived)] });
            let of_output = Observable::Output(limit.output);
            observations.push(of(Quantity::Measured {
                of: of_output,
                value: value + std * noise,
                error: std,
            }));
            measured.push(ObservedUnit { name: String::new(), observations: observations.clone() });
        }
    }
    println!("{} units, {MEASUREMENTS} measurements with an error of {ERROR} of the limit", failed.len());
    println!(
        "known of a unit | accuracy at 0.2, 0.5, 0.8 of the life (alpha {ALPHA}) | horizon ({OF_LIFE} of the life) | relative accuracy"
    );
    // The units were simulated with the numerical errors of the study.
    let settings = FleetSettings { numerical_errors: false, ..FleetSettings::new(settings.seed) };
    for (name, fleet) in [("survival", survived), ("measurements", measured)] {
        let report = update(scene, summary, &model, &fleet, &settings);
        let of_unit = report.units.chunks_exact(MEASUREMENTS).zip(failed.iter().map(|(_, life)| *life));
        // Error of the remaining life at every measurement [life].
        let errors: Vec<Vec<f64>> = of_unit.map(|(units, life)| errors(units, life)).collect();
        let accurate = |k: usize| share(&errors, |own| own[k - 1] <= ALPHA * left(k));
        let horizon = |own: &Vec<f64>| {
            let late = own.iter().rposition(|error| *error > OF_LIFE).map_or(1, |last| last + 2);
            if late > MEASUREMENTS { 0.0 } else { left(late) }
        };
        let relative = |own: &Vec<f64>| {
            let of = |(k, error): (usize, &f64)| (1.0 - error / left(k + 1)).max(0.0);
            own.iter().enumerate().map(of).sum::<f64>() / MEASUREMENTS as f64
        };
        println!(
            "{name} | {:.0} %, {:.0} %, {:.0} % | {:.2} | {:.3}",
            100.0 * accurate(2),
            100.0 * accurate(5),
            100.0 * accurate(8),
            errors.iter().map(horizon).sum::<f64>() / errors.len() as f64,
            errors.iter().map(relative).sum::<f64>() / errors.len() as f64,
        );
    }
    Ok(())
}

/// True remaining life at measurement `k` [life].
fn left(k: usize) -> f64 {
    1.0 - k as f64 / (MEASUREMENTS + 1) as f64
}

/// Errors of the median remaining life of one unit at its measurements; infinite where it lies beyond the study [life].
fn errors(units: &[UnitReport], life: f64) -> Vec<f64> {
    let of = |(k, unit): (usize, &UnitReport)| {
        unit.remaining.p50.map_or(f64::INFINITY, |found| (found / life - left(k + 1)).abs())
    };
    units.iter().enumerate().map(of).collect()
}

fn share(all: &[Vec<f64>], holds: impl Fn(&Vec<f64>) -> bool) -> f64 {
    all.iter().filter(|own| holds(own)).count() as f64 / all.len() as f64
}
