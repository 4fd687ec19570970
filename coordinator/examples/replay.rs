//! Active learning on the simulations of a direct Monte Carlo study: they take the place of the simulator, and their
//! samples are the population. The error of every round is therefore known, and a change of the learner can be judged
//! on a real mechanism in seconds.
//!
//! ```sh
//! coordinator run --scene four-bar --method monte-carlo --samples 1000 --out direct
//! cargo run --release -p coordinator --example replay -- direct --initial 40 --max-evaluations 100
//! ```

use clap::Parser;
use common::failure::SimulationFailure;
use common::scene::{Scene, SceneSource};
use coordinator::results::store::{CampaignFile, StoreError};
use coordinator::statistics::learning::{LearningFunction, StoppingTargets, curves};
use coordinator::statistics::surrogate::{Kernel, Trend};
use coordinator::study::{
    Campaign, Observed, Plan, Problem, Settings, SimulatedPoint, StopReason, StudyError, Surrogate,
    completed, first_failures,
};
use std::collections::HashMap;
use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;
use thiserror::Error;

/// Learn again from the samples of a direct Monte Carlo study
#[derive(Debug, Parser)]
struct Arguments {
    /// Folder of a study with --method monte-carlo
    dir: PathBuf,
    /// Use the first N samples only
    #[arg(long)]
    samples: Option<usize>,
    /// Evaluations of the initial design
    #[arg(long)]
    initial: Option<usize>,
    /// Budget of evaluations
    #[arg(long)]
    max_evaluations: Option<usize>,
    /// Evaluations under way at once
    #[arg(long)]
    batch: Option<usize>,
    /// Learning function
    #[arg(long)]
    learning: Option<LearningFunction>,
    /// Surrogate error at which learning may stop
    #[arg(long)]
    target_error: Option<f64>,
    /// Correlation kernel of the surrogates
    #[arg(long)]
    kernel: Option<Kernel>,
    /// Trend of the surrogates
    #[arg(long)]
    trend: Option<Trend>,
}

impl Arguments {
    /// The scene's settings with the options, and the seed of the study.
    fn settings(&self, scene: &Scene, seed: u64) -> Settings {
        let mut settings = Settings { seed, ..Settings::from(scene) };
        settings.initial = self.initial.unwrap_or(settings.initial);
        settings.max_evaluations = self.max_evaluations.unwrap_or(settings.max_evaluations);
        settings.batch = self.batch.unwrap_or(settings.batch);
        settings.learning = self.learning.unwrap_or(settings.learning);
        settings.target_error = self.target_error.or(settings.target_error);
        settings.forms.kernel = self.kernel.or(settings.forms.kernel);
        settings.forms.trend = self.trend.or(settings.forms.trend);
        settings
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let campaign = CampaignFile::look(&arguments.dir)?;
    let source = SceneSource::parse(&campaign.meta().scene_source, "study")?;
    let scene = source.nominal();
    let seed = Settings::from_stored(&campaign.meta().settings)?.seed;
    let mut samples = Vec::new();
    campaign.for_each(|stored| -> Result<(), StoreError> {
        if let Ok(evaluation) = stored.outcome {
            let observed = Observed::from_evaluation(evaluation);
            samples.push(SimulatedPoint { sample: stored.sample, observed });
        }
        Ok(())
    })?;
    if samples.len() < 2 {
        return Err("the study has no samples that were simulated".into());
    }
    let nominal = samples.remove(0);
    samples.truncate(arguments.samples.unwrap_or(usize::MAX));
    let settings = arguments.settings(scene, seed);
    if samples.len() < settings.initial {
        return Err(format!("{} samples are fewer than an initial design", samples.len()).into());
    }
    let found = replay(scene, &settings, &nominal, &samples)?;
    println!("learning again, with the {} simulated samples as the population", samples.len());
    println!(
        "evaluations | stated error | true error | ratio | uncertain | kernel, trend, Q2 left out, Q2 crossed, factor"
    );
    for round in &found.rounds {
        let uncertain = 100.0 * round.uncertain;
        println!(
            "{} | {:.4} | {:.4} | {:.2} | {uncertain:.1} % | {}",
            round.evaluations,
            round.stated_error,
            round.true_error,
            round.error_ratio,
            round.surrogates.join("; ")
        );
    }
    println!("stopped by {}, {:.1} s of learning", found.stopped_by, found.seconds);
    Ok(())
}

/// An error of a replay.
#[derive(Debug, Error)]
enum ReplayError {
    /// The samples are not the first points of the population of this seed.
    #[error(
        "sample {0} is not that of the study's seed; expected a direct Monte Carlo run (--method monte-carlo) without failed \
         simulations"
    )]
    Foreign(usize),
    /// The surrogates cannot be fitted, or too many simulations failed.
    #[error(transparent)]
    Study(StudyError),
}

/// One round of learning with its true error.
#[derive(Debug, Clone, PartialEq)]
struct Round {
    /// Number of evaluations so far.
    evaluations: usize,
    /// Largest error that the surrogates state for any curve at any checkpoint [1].
    stated_error: f64,
    /// Largest difference of any curve at any checkpoint from the simulated one [1].
    true_error: f64,
    /// Root mean square over curves and checkpoints of the grid of (difference / stated error) [1].
    error_ratio: f64,
    /// Share of the population with U_c < 2.
    uncertain: f64,
    /// Per limit state: kernel, trend, smallest Q2 by leaving one out and by cross-validation, and the factor on the predicted
    /// variances.
    surrogates: Vec<String>,
}

/// Rounds of a replayed study, and the reason of its stop.
#[derive(Debug, Clone, PartialEq)]
struct Replayed {
    /// Rounds in their order.
    rounds: Vec<Round>,
    /// The rule or budget that ended the learning.
    stopped_by: String,
    /// Time of learning [s].
    seconds: f64,
}

/// Learns from the nominal evaluation and the evaluations of the population's first points, in its order, as a study
/// with these settings and this population would.
///
/// # Errors
/// [`ReplayError`].
fn replay(
    scene: &Scene,
    settings: &Settings,
    nominal: &SimulatedPoint,
    samples: &[SimulatedPoint],
) -> Result<Replayed, ReplayError> {
    let problem = Problem::from_scene(scene);
    let settings = Settings { samples: samples.len(), ..settings.clone() };
    // The population is all there is: it neither grows nor becomes conditional.
    let targets = StoppingTargets { cov: f64::INFINITY, ..settings.targets() };
    let plan =
        Plan { largest_population: samples.len(), retry: false, targets, ..Plan::new(&settings, scene) };
    let simulated: Vec<Vec<u32>> = first_failures(scene, samples);
    let views: Vec<&[u32]> = simulated.iter().map(Vec::as_slice).collect();
    let truth = curves(&views, problem.checkpoints.len());
    let points: Vec<SimulatedPoint> = samples.iter().chain([nominal]).cloned().collect();
    let outcomes = completed(scene, &points);
    let known: HashMap<Vec<u64>, &Observed> =
        points.iter().map(|point| bits(&point.sample)).zip(&outcomes).collect();
    let campaign = Campaign::new(problem, plan);
    if let Some(foreign) = (0..samples.len()).find(|j| !known.contains_key(&bits(&campaign.sample(*j)))) {
        return Err(ReplayError::Foreign(foreign));
    }
    let started = Instant::now();
    let mut rounds: Vec<Round> = Vec::new();
    let simulate = |sample: &[f64]| -> Result<Observed, SimulationFailure> {
        let unknown =
            || SimulationFailure::NotModelled { what: "a sample that was not simulated".to_owned() };
        known.get(&bits(sample)).map(|observed| (*observed).clone()).ok_or_else(unknown)
    };
    let learned = campaign.learn_from(simulate, |campaign| {
        if campaign.rounds().len() > rounds.len()
            && let Some(round) = round_of(campaign, &truth)
        {
            rounds.push(round);
        }
    });
    let learned = learned.map_err(|error| ReplayError::Study(StudyError::from_campaign(error, scene)))?;
    let stopped_by = match learned.stop {
        StopReason::Budget => "budget".to_owned(),
        StopReason::Rule(rule) => format!("{rule:?}").to_lowercase(),
    };
    Ok(Replayed { rounds, stopped_by, seconds: started.elapsed().as_secs_f64() })
}

fn bits(sample: &[f64]) -> Vec<u64> {
    sample.iter().map(|x| x.to_bits()).collect()
}

fn round_of(campaign: &Campaign, truth: &[Vec<f64>]) -> Option<Round> {
    let assessment = campaign.assessment()?;
    let pairs = assessment.curves.iter().flatten().zip(truth.iter().flatten());
    let true_error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (mut squares, mut count) = (0.0, 0.0);
    for ((found, truth), errors) in assessment.curves.iter().zip(truth).zip(&assessment.errors.by_curve) {
        for (n, error) in assessment.grid.iter().zip(errors).filter(|(_, error)| **error > 1e-4) {
            squares += ((found[*n] - truth[*n]) / error).powi(2);
            count += 1.0;
        }
    }
    let describe = |surrogate: &Surrogate| {
        let model = &surrogate.model;
        let q2 = surrogate.leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min);
        let crossed = surrogate.cross_validation.as_ref().map_or(q2, |crossed| crossed.q2);
        let (kernel, trend) = (model.correlation().kernel.name(), model.trend().name());
        format!("{kernel} {trend} {q2:.4} {crossed:.4} {:.2}", surrogate.inflation())
    };
    Some(Round {
        evaluations: campaign.evaluations(),
        stated_error: assessment.errors.largest(),
        true_error,
        error_ratio: if count > 0.0 { f64::sqrt(squares / count) } else { 0.0 },
        uncertain: assessment.share_uncertain,
        surrogates: assessment.surrogates.iter().map(describe).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use coordinator::statistics::design::Population;

    /// A limit state that fails earlier with x + 0.1 x y, at nine tenths of the life on average.
    fn simulated(sample: Vec<f64>) -> SimulatedPoint {
        let bend = 0.5 * (sample[0] + 0.1 * sample[0] * sample[1]);
        let life = (1..=5).map(|n| 5.0 * f64::from(n) / 4.5 + bend).collect();
        SimulatedPoint { sample, observed: Observed::exact(vec![life]) }
    }

    #[test]
    fn a_replay_knows_the_error_of_every_round_and_refuses_other_samples() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\n\
            life = { cycles = 50, checkpoint_every = 10 }\noutputs = [{ name = \"a\" }]\n\
            limit_states = [{ name = \"high\", output = \"a\", threshold = 5 }]\n\
            variables = [{ name = \"x\", mean = 0, std = 1 }, { name = \"y\", mean = 0, std = 1 }]";
        let source = SceneSource::parse(text, "s").unwrap();
        let scene = source.nominal();
        let mut settings = Settings::from(scene);
        (settings.initial, settings.batch, settings.max_evaluations) = (20, 4, 60);
        settings.forms.kernel = Some(Kernel::Gaussian);
        let nominal = simulated(vec![0.0, 0.0]);
        let samples = |count: usize| -> Vec<SimulatedPoint> {
            let population = Population::draw(&Problem::from_scene(scene).inputs, count, scene.study.seed);
            (0..count).map(|j| simulated(population.physical(j))).collect()
        };
        let mut all = samples(2000);
        let found = replay(scene, &settings, &nominal, &all).unwrap();
        assert_eq!(found.rounds[0].evaluations, 20);
        let last = found.rounds.last().unwrap();
        assert!(last.true_error < 2e-3 && found.stopped_by != "budget", "{found:?}");
        // Few samples are learned completely.
        let few = replay(scene, &settings, &nominal, &samples(60)).unwrap();
        assert!(few.rounds.last().unwrap().evaluations <= 61, "{few:?}");
        all[7].sample[0] += 1e-9;
        let error = replay(scene, &settings, &nominal, &all).unwrap_err();
        assert!(matches!(error, ReplayError::Foreign(7)), "{error}");
    }
}
