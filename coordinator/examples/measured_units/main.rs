//! Coverage of the remaining lives that `coordinator update` states: units of a direct Monte Carlo study are measured with noise,
//! and their true remaining lives, which that study simulated, are compared with the stated intervals. With a number of fleets the
//! coverage of the lives that `coordinator learn` states, see `fleets`; with `samples` that of `--confidence`.
//!
//! ```sh
//! coordinator run four-bar --accuracy draft --out study
//! coordinator run four-bar --accuracy draft --method monte-carlo --samples 200 --seed 11 --out direct
//! cargo run --release -p coordinator --example measured_units study direct
//! cargo run --release -p coordinator --example measured_units study direct prognosis 60
//! coordinator run four-bar --accuracy draft --set 'wear_coefficient=1.03e-13 1/Pa' --method monte-carlo --samples 3000 \
//!     --seed 11 --out changed
//! cargo run --release -p coordinator --example measured_units study changed 300 wear_coefficient.mean wear_coefficient.std
//! cargo run --release -p coordinator --example measured_units analytic third 300
//! cargo run --release -p coordinator --example measured_units samples 10 200
//! ```

mod analytic;
mod fleets;
mod prognosis;
mod samples;

use common::scene::{Scene, SceneSource};
use coordinator::analyses::update::{
    FleetSettings, Observable, Observation, ObservedUnit, Quantity, UnitReport, update,
};
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::store::{CampaignFile, StoreError};
use coordinator::results::summary::StudySummary;
use coordinator::statistics::design::{InputModel, Population};
use coordinator::statistics::reliability::Track;
use coordinator::study::{LifeModel, Observed, Settings, StoredOutcome, learn_from_results};
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use std::path::Path;

/// Share of the life at which a unit is measured [1].
const MEASURED_AT: f64 = 0.4;
/// Standard deviations of the measurement over the threshold of the limit state [1].
const ERRORS: [f64; 3] = [0.05, 0.02, 0.005];
const SEED: u64 = 2026;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [first, case, fleets] if first == "analytic" => return analytic::run(case, fleets.parse()?),
        [first, n, count] if first == "samples" => return samples::run(n.parse()?, count.parse()?),
        _ => {}
    }
    let [study, direct, fleets @ ..] = arguments.as_slice() else {
        return Err("expected two folders: a study by active learning, and a direct Monte Carlo study".into());
    };
    if let [first, rest @ ..] = fleets {
        let (study, direct) = (read(Path::new(study))?, read(Path::new(direct))?);
        return match (first.as_str(), rest) {
            ("prognosis", [count]) => prognosis::run(&study, &direct, count.parse()?),
            _ => {
                let scene = direct.0.nominal();
                // The first evaluation is the nominal point.
                let units = direct.3.iter().skip(1).filter_map(|s| s.outcome.as_ref().ok());
                let mut lives: Vec<f64> = units.map(|unit| life(scene, unit)).collect();
                lives.sort_unstable_by(f64::total_cmp);
                let unknown: Vec<String> = rest.iter().map(|name| format!("{name},,")).collect();
                fleets::run(&study, |_| lives.clone(), first.parse()?, &unknown, None)
            }
        };
    }
    let (source, settings, summary, stored) = read(Path::new(study))?;
    let scene = source.nominal();
    let (_, _, _, simulated) = read(Path::new(direct))?;
    let learned = learn_from_results(scene, scene, &settings, &stored)?;
    let model = LifeModel::new(scene, &learned);
    // The first evaluation is the nominal point.
    let units: Vec<&Observed> = simulated.iter().skip(1).filter_map(|s| s.outcome.as_ref().ok()).collect();
    let lives: Vec<f64> = units.iter().map(|unit| life(scene, unit)).collect();
    let median = median(&lives);
    println!(
        "{} units, median life {median:.0} cycles, study with {} simulations\n",
        units.len(),
        stored.len()
    );
    println!(
        "{:>16} {:>22} {:>18} {:>16} {:>10}",
        "measured at", "error over the limit", "90 % holds [%]", "width [cycles]", "moved [%]"
    );
    // The units were simulated with the same numerical errors as the study; the last rows leave these out of the likelihood.
    let rows =
        [("0.4 of its life", true, true), ("0.4 of median", false, true), ("0.4, same errors", true, false)];
    for (name, at_life, numerical_errors) in rows {
        for error in ERRORS {
            let limit = &scene.limit_states[0];
            let std = error * limit.scale();
            let mut rng = ChaCha12Rng::seed_from_u64(SEED);
            let mut fleet = Vec::new();
            for (j, unit) in units.iter().enumerate() {
                let own = if lives[j].is_finite() { lives[j] } else { model.end() };
                let cycles = MEASURED_AT * if at_life { own } else { median };
                let noise: f64 = StandardNormal.sample(&mut rng);
                let value =
                    history(&times(scene), unit, limit.output).value_at(cycles).ok_or("no value there")?;
                let quantity = Quantity::Measured {
                    of: Observable::Output(limit.output),
                    value: value + std * noise,
                    error: std,
                };
                let observation =
                    Observation { line: j as u64 + 1, cycles, name: "measured".to_owned(), quantity };
                fleet.push(ObservedUnit { name: j.to_string(), observations: vec![observation] });
            }
            let settings = FleetSettings { numerical_errors, ..FleetSettings::new(settings.seed) };
            let report = update(scene, &summary, &model, &fleet, &settings);
            print_row(name, error, &report.units, &lives, model.end());
        }
    }
    Ok(())
}

/// A row of the table: share of the units whose true remaining life lies within 5 to 95 %, and the mean width.
fn print_row(name: &str, error: f64, units: &[UnitReport], lives: &[f64], end: f64) {
    let holds = |(unit, life): &(&UnitReport, &f64)| {
        let left = **life - unit.observed_until;
        unit.remaining.p5.is_some_and(|low| low <= left) && unit.remaining.p95.is_none_or(|high| left <= high)
    };
    let n = units.len() as f64;
    let held = units.iter().zip(lives).filter(holds).count() as f64 / n;
    let width = |unit: &UnitReport| {
        let most = end - unit.observed_until;
        unit.remaining.p95.unwrap_or(most) - unit.remaining.p5.unwrap_or(most)
    };
    let mean = units.iter().map(width).sum::<f64>() / n;
    let moved = units.iter().filter(|unit| unit.stages > 0).count() as f64 / n;
    let share = format!("{:.1} ± {:.1}", 100.0 * held, 100.0 * (0.9 * 0.1 / n).sqrt());
    println!("{name:>16} {error:>22} {share:>18} {mean:>16.0} {:>10.0}", 100.0 * moved);
}

/// Scene, settings, summary and evaluations of a study.
type Study = (SceneSource, Settings, StudySummary, Vec<StoredOutcome>);

fn read(dir: &Path) -> Result<Study, Box<dyn Error>> {
    let campaign = CampaignFile::look(dir)?;
    let source = SceneSource::parse(&campaign.meta.scene_source, &dir.display().to_string())?;
    let settings = Settings::from_stored(&campaign.meta.settings)?;
    let summary = campaign.document(SUMMARY_DOCUMENT)?.ok_or("the study is not finished")?;
    let mut stored = Vec::new();
    campaign.for_each(|one| -> Result<(), StoreError> {
        // The units were simulated at the working accuracy, without corrections.
        if one.level == 0 {
            let outcome = one.outcome.map(Observed::from_evaluation);
            stored.push(StoredOutcome { sample: one.sample, outcome });
        }
        Ok(())
    })?;
    Ok((source, settings, summary, stored))
}

fn times(scene: &Scene) -> Vec<f64> {
    scene.life.checkpoints().into_iter().map(f64::from).collect()
}

/// The simulated history of an output.
fn history<'a>(times: &'a [f64], unit: &'a Observed, output: usize) -> Track<'a> {
    Track { times, values: &unit.histories[output], start: unit.start[output] }
}

/// Simulated life: the earliest crossing of a limit state, infinite beyond the last checkpoint [cycles].
fn life(scene: &Scene, unit: &Observed) -> f64 {
    let times = times(scene);
    let of_limit = |limit: &common::scene::LimitState| {
        let maxima = |largest: &mut f64, value: &f64| {
            *largest = largest.max(limit.response(*value));
            Some(*largest)
        };
        let values: Vec<f64> = unit.histories[limit.output].iter().scan(f64::NEG_INFINITY, maxima).collect();
        let start = unit.start[limit.output].map(|start| limit.response(start));
        let threshold = limit.response_threshold();
        let Some(k) = values.iter().position(|y| *y >= threshold) else { return f64::INFINITY };
        let before = if k == 0 { 0.0 } else { times[k - 1] };
        let crossing = Track { times: &times, values: &values, start }.crossing(k, threshold);
        before + crossing.best * (times[k] - before)
    };
    scene.limit_states.iter().map(of_limit).fold(f64::INFINITY, f64::min)
}

fn median(lives: &[f64]) -> f64 {
    let mut sorted = lives.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// Settings of a study of the scene that has all its simulations at first.
fn learning(scene: &Scene, samples: usize, simulations: usize) -> Settings {
    Settings { samples, initial: simulations, max_evaluations: simulations, ..Settings::from(scene) }
}

/// Simulations of the one output of the scene, the exact `value` of a sample at a number of cycles.
fn simulated(scene: &Scene, count: usize, value: impl Fn(&[f64], f64) -> f64) -> Vec<StoredOutcome> {
    let points = Population::draw(InputModel::from_scene(scene), count, SEED);
    let outcome = |j: usize| {
        let sample = points.physical(j);
        let history = scene.life.checkpoints().iter().map(|n| value(&sample, f64::from(*n))).collect();
        let start = vec![Some(value(&sample, 0.0))];
        StoredOutcome { sample, outcome: Ok(Observed { start, ..Observed::exact(vec![history]) }) }
    };
    (0..count).map(outcome).collect()
}
